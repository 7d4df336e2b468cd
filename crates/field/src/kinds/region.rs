//! The box over which a set is looked at.

use super::read::fault;
use crate::{Set, bounds};
use moldloft_num::{Box3, Real, Vec3};
use moldloft_registry::{CallError, FieldId, Point};

/// The box of two corners, if both are given; `field` is the second.
pub fn corners<T: Real>(
    low: &Option<Point<T>>,
    high: &Option<Point<T>>,
    field: FieldId,
) -> Result<Option<Box3>, CallError> {
    match (low, high) {
        (Some(low), Some(high)) => {
            let over = Box3 { low: low.xyz.re(), high: high.xyz.re() };
            crate::error::solid_box(over).map(Some).map_err(|e| fault(&e).in_field(field))
        }
        (None, None) => Ok(None),
        _ => Err(CallError::new("missing-argument", "a box has two corners, and one is missing")
            .expected("low and high, or neither")
            .in_field(field)),
    }
}

/// A box with its corners as the language gave them, when it did.
pub struct Region<T> {
    pub over: Box3,
    pub corners: Option<[Vec3<T>; 2]>,
}

/// Relative margin of an automatic box, so that the set is strictly inside its faces. The three
/// differ and are no simple fractions, so that the grid coincides with no symmetry plane.
const WIDENED: [f64; 3] = [0.0213, 0.0231, 0.0197];

/// The box that was given, or one found around the set: the arguments of the set and of the second corner.
///
/// # Errors
/// A set without end, or without a point.
pub fn region<T: Real>(
    set: &Set<f64>,
    low: &Option<Point<T>>,
    high: &Option<Point<T>>,
    [of, second]: [FieldId; 2],
) -> Result<Region<T>, CallError> {
    if let Some(over) = corners(low, high, second)? {
        let corners = low.as_ref().zip(high.as_ref()).map(|(l, h)| [l.xyz, h.xyz]);
        return Ok(Region { over, corners });
    }
    let over = around(set).map_err(|e| fault(&e).in_field(of))?;
    match over {
        Some(over) => Ok(Region { over, corners: None }),
        None => Err(CallError::new("empty-set", "the set is empty: it has no box")
            .expected("a set with points in it, or a box")
            .in_field(of)),
    }
}

/// No side of a box around sheets and wires is less than this of the longest: four cells where those
/// are a sixteenth of it.
const LEAST_SIDE: f64 = 0.25;

/// A box around a set, with a margin; `None` for an empty set.
///
/// # Errors
/// A set without end.
pub fn around(set: &Set<f64>) -> Result<Option<Box3>, crate::FieldError> {
    let mut accuracy = 0.5;
    let mut found = bounds(set, accuracy)?;
    // To a hundredth of its size.
    while let Some(over) = found {
        let size = over.diagonal();
        if accuracy <= 0.01 * size || accuracy < 1e-9 {
            break;
        }
        accuracy = if size < 4.0 * accuracy { accuracy / 16.0 } else { 0.01 * size };
        found = bounds(set, accuracy)?;
    }
    Ok(found.map(|mut over| {
        let sides = [0, 1, 2].map(|k| over.high[k] - over.low[k]);
        let size = sides.into_iter().fold(0.0, f64::max).max(1e-9);
        // Sheets and wires have no thickness of their own, but the cells about them have.
        let thin = set.leaves().iter().any(|leaf| leaf.primitive.is_sheet());
        let more = Vec3::from([0, 1, 2].map(|k| {
            let missing = if thin { 0.5 * (LEAST_SIDE * size - sides[k]) } else { 0.0 };
            missing.max(WIDENED[k] * size)
        }));
        over.low -= more;
        over.high += more;
        over
    }))
}

/// Sample points at which a change of coordinates is tested for being a rotation, and the relative
/// tolerance.
const TURNED_AT: [[f64; 3]; 6] = [
    [0.31, -0.42, 0.17],
    [-1.73, 0.55, 2.61],
    [3.16, 2.21, -5.3],
    [-0.07, -9.2, 0.93],
    [12.7, 4.4, 31.1],
    [0.61, 0.27, -77.0],
];
const TURNED: f64 = 1e-9;

/// The box about the z axis that contains a set after a change of coordinates that preserves
/// heights and distances from the axis; `None` for other changes, and for an unbounded set.
pub(crate) fn box_of_turns<T: Real>(
    set: &Set<T>,
    coordinates: &[crate::Primitive<T>; 3],
) -> Option<Set<f64>> {
    let [x, y, z] = [0, 1, 2].map(|k| coordinates[k].re());
    let turns = TURNED_AT.into_iter().all(|at| {
        let p = Vec3::from(at);
        let (a, b) = (libm::hypot(x.value(p), y.value(p)), libm::hypot(p.x, p.y));
        (a - b).abs() <= TURNED * (1.0 + b) && z.value(p) == p.z
    });
    if !turns {
        return None;
    }
    let over = around(&set.re()).ok().flatten()?;
    let far = |k: usize| over.low[k].abs().max(over.high[k].abs());
    let reach = libm::hypot(far(0), far(1));
    let low = Vec3::of(-reach, -reach, over.low.z);
    Set::cuboid(low, Vec3::of(reach, reach, over.high.z)).ok()
}
