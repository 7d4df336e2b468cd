//! Check that the sides of a patch meet at its corners.

use moldloft_num::Vec3;
use moldloft_registry::{CallError, FieldId};

/// A corner: side `a` at its end `s` is side `b` at its end `t`.
type Corner = [(usize, usize); 2];

/// The corners of four sides v = 0, u = 1, v = 1, u = 0, each in increasing parameter.
const FOUR: [Corner; 4] = [[(0, 1), (1, 0)], [(1, 1), (2, 1)], [(2, 0), (3, 1)], [(3, 0), (0, 0)]];

/// The corners of three, the fourth being the point where the first and the third begin.
const THREE: [Corner; 3] = [[(0, 1), (1, 0)], [(1, 1), (2, 1)], [(2, 0), (0, 0)]];

/// Corners of a patch of `count` sides.
pub fn of(count: usize) -> &'static [Corner] {
    if count == 3 { &THREE } else { &FOUR }
}

/// Error for sides (in the list of field `field`) whose ends are farther apart than `tolerance` by
/// `distance`; `place` formats a position.
pub fn check(
    ends: &[[Vec3<f64>; 2]],
    tolerance: f64,
    distance: impl Fn(Vec3<f64>, Vec3<f64>) -> f64,
    place: impl Fn(Vec3<f64>) -> String,
    field: FieldId,
) -> Result<(), CallError> {
    let corners = of(ends.len());
    let meets = |mask: u32, [(a, s), (b, t)]: Corner| {
        let at = |side: usize, end: usize| ends[side][end ^ (mask >> side & 1) as usize];
        distance(at(a, s), at(b, t)) <= tolerance
    };
    let Some(&[(a, s), (b, t)]) = corners.iter().find(|&&c| !meets(0, c)) else { return Ok(()) };
    let says = |side: usize, end: usize| {
        let which = if end == 0 { "begins" } else { "ends" };
        format!("side {} {which} at {}", side + 1, place(ends[side][end]))
    };
    let fault = CallError::new("open-corner", format!("sides {} and {} do not meet", a + 1, b + 1))
        .expected("the edges v = 0, u = 1, v = 1, u = 0, each in increasing parameter")
        .found(format!("{}, but {}", says(a, s), says(b, t)))
        .in_item(b)
        .in_field(field);
    let turned = (1..1u32 << ends.len()).find(|&m| corners.iter().all(|&c| meets(m, c)));
    Err(match turned {
        Some(mask) => {
            let sides = (0..ends.len()).filter(|k| mask >> k & 1 == 1);
            let list = sides.map(|k| (k + 1).to_string()).collect::<Vec<_>>().join(", ");
            fault.help(format!("they do when these sides are reversed: {list}"))
        }
        None => fault.help("let neighbouring sides end in common points"),
    })
}
