//! The box around a set.

use crate::expr::interval::Interval;
use crate::expr::tape::ExprTape;
use crate::{FieldError, Primitive, Set};
use moldloft_num::{Box3, Real, Vec3};
use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::sync::Arc;

/// Half sides of the searched space: the smaller, and the larger if that is empty or the set
/// reaches its end.
const WORLDS: [f64; 2] = [(1u64 << 20) as f64, (1u64 << 60) as f64];
/// The most boxes to look at for one side.
const MOST: usize = 100_000;

struct ReachBox {
    /// Upper bound of the coordinate in the searched direction.
    reach: f64,
    depth: u32,
    sides: [Interval; 3],
    tape: Arc<ExprTape<f64>>,
}

impl PartialEq for ReachBox {
    fn eq(&self, o: &Self) -> bool {
        self.cmp(o) == Ordering::Equal
    }
}
impl Eq for ReachBox {}
impl PartialOrd for ReachBox {
    fn partial_cmp(&self, o: &Self) -> Option<Ordering> {
        Some(self.cmp(o))
    }
}
impl Ord for ReachBox {
    /// The farthest first; of equally far ones the smallest, so that flat ends are not searched over.
    fn cmp(&self, o: &Self) -> Ordering {
        let places = o.sides.into_iter().zip(self.sides).map(|(a, b)| a.low.total_cmp(&b.low));
        self.reach
            .total_cmp(&o.reach)
            .then(self.depth.cmp(&o.depth))
            .then(places.fold(Ordering::Equal, Ordering::then))
    }
}

/// A box proved to contain a set, each side within `accuracy` of the best that ranges can prove;
/// `None` for a set proved to be empty.
///
/// # Errors
/// [`FieldError::Unbounded`] when the set reaches 2^60 from the origin, or that cannot be excluded;
/// an accuracy that is not above zero.
///
/// # Example
/// ```
/// use moldloft_field::{Primitive, Set, bounds};
/// use moldloft_num::Vec3;
///
/// let ball = Set::new(&Primitive::sphere(Vec3::of(1.0, 2.0, 3.0), 0.5)?);
/// let around = bounds(&ball, 1e-3)?.unwrap();
/// assert!((around.low.x - 0.5).abs() < 2e-3 && (around.high.z - 3.5).abs() < 2e-3);
/// # Ok::<(), moldloft_field::FieldError>(())
/// ```
pub fn bounds(set: &Set, accuracy: f64) -> Result<Option<Box3>, FieldError> {
    crate::error::positive("accuracy", accuracy)?;
    let tape = set.compiled_within_memory()?.tape;
    if set.is_nothing() {
        return Ok(None);
    }
    match within(&tape, accuracy, WORLDS[0]) {
        Err(FieldError::Unbounded { .. }) | Ok(None) => within(&tape, accuracy, WORLDS[1]),
        found => found,
    }
}

/// The box of a set within that distance of the origin along each axis.
fn within(
    tape: &Arc<ExprTape<f64>>,
    accuracy: f64,
    world: f64,
) -> Result<Option<Box3>, FieldError> {
    let (mut low, mut high) = ([0.0; 3], [0.0; 3]);
    let (start, tape) = about_origin(tape, world);
    for axis in 0..3 {
        for (sign, end) in [(1.0, &mut high), (-1.0, &mut low)] {
            match farthest(&tape, axis, sign, accuracy, [start, world])? {
                Some(reach) => end[axis] = sign * reach,
                None => return Ok(None),
            }
        }
    }
    Ok(Some(Box3 { low: Vec3::from(low), high: Vec3::from(high) }))
}

/// Half side of the smallest cube about the origin, of halves of `world` and not below 1, outside
/// of which ranges over six slabs prove that there is nothing; and the tape in it.
fn about_origin(tape: &Arc<ExprTape<f64>>, world: f64) -> (f64, Arc<ExprTape<f64>>) {
    let mut room = Vec::new();
    let mut tape = tape.clone();
    let mut size = world;
    while size > 1.0 {
        let half = 0.5 * size;
        let empty = (0..6).all(|k| {
            let mut slab = [Interval::new(-size, size); 3];
            slab[k / 2] = match k % 2 {
                0 => Interval::new(-size, -half),
                _ => Interval::new(half, size),
            };
            tape.range(&slab, &mut room).low > 0.0
        });
        if !empty {
            break;
        }
        size = half;
        tape.range(&[Interval::new(-size, size); 3], &mut room);
        tape = tape.pruned(&room).map_or(tape, Arc::new);
    }
    (size, tape)
}

/// Upper bound of a coordinate of the set within a cube of half side `start`; `None` if it is
/// empty.
fn farthest(
    tape: &Arc<ExprTape<f64>>,
    axis: usize,
    sign: f64,
    accuracy: f64,
    [start, world]: [f64; 2],
) -> Result<Option<f64>, FieldError> {
    let side = Interval::new(-start, start);
    let mut heap = BinaryHeap::new();
    heap.push(ReachBox { reach: start, depth: 0, sides: [side; 3], tape: tape.clone() });
    let mut room = Vec::new();
    let mut seen = 0;
    while let Some(ReachBox { reach, depth, sides, tape }) = heap.pop() {
        let range = tape.range(&sides, &mut room);
        if range.low > 0.0 {
            continue;
        }
        seen += 1;
        let solid = range.high < 0.0;
        if seen > MOST
            || sides[axis].width() <= accuracy.max(4.0 * f64::EPSILON * sides[axis].magnitude())
            || solid
        {
            if reach >= world {
                return Err(FieldError::Unbounded { axis, sign });
            }
            return Ok(Some(reach));
        }
        let tape = tape.pruned(&room).map_or(tape, Arc::new);
        for k in 0..8 {
            let half = [0, 1, 2].map(|a| {
                let middle = sides[a].middle();
                if k >> a & 1 == 0 {
                    Interval::new(sides[a].low, middle)
                } else {
                    Interval::new(middle, sides[a].high)
                }
            });
            let reach = if sign > 0.0 { half[axis].high } else { -half[axis].low };
            heap.push(ReachBox { reach, depth: depth + 1, sides: half, tape: tape.clone() });
        }
    }
    Ok(None)
}

/// Relative margin of an automatic box, so that the set is strictly inside its faces. The three
/// differ and are no simple fractions, so that the grid coincides with no symmetry plane.
const WIDENED: [f64; 3] = [0.0213, 0.0231, 0.0197];

/// No side of a box around sheets and wires is less than this of the longest: four cells where those
/// are a sixteenth of it.
const LEAST_SIDE: f64 = 0.25;

/// A box around a set, slightly enlarged; `None` for an empty set.
///
/// # Errors
/// A set without end.
pub fn around(set: &Set<f64>) -> Result<Option<Box3>, FieldError> {
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

/// The box about the z axis in which a set stays when its coordinates are replaced by ones that keep heights and distances from
/// the axis; `None` for others, and for a set without end.
///
/// # Errors
/// [`FieldError::Spent`].
pub(crate) fn box_of_turns<T: Real>(
    set: &Set<T>,
    coordinates: &[Primitive<T>; 3],
) -> Result<Option<Set<f64>>, FieldError> {
    let [x, y, z] = [0, 1, 2].map(|k| coordinates[k].re());
    let turns = TURNED_AT.into_iter().all(|at| {
        let p = Vec3::from(at);
        let (a, b) = (libm::hypot(x.value(p), y.value(p)), libm::hypot(p.x, p.y));
        (a - b).abs() <= TURNED * (1.0 + b) && z.value(p) == p.z
    });
    if !turns {
        return Ok(None);
    }
    let over = match around(&set.re()) {
        Err(spent @ FieldError::Spent(_)) => return Err(spent),
        Ok(Some(over)) => over,
        _ => return Ok(None),
    };
    let far = |k: usize| over.low[k].abs().max(over.high[k].abs());
    let reach = libm::hypot(far(0), far(1));
    let low = Vec3::of(-reach, -reach, over.low.z);
    Ok(Set::cuboid(low, Vec3::of(reach, reach, over.high.z)).ok())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Affine;
    use moldloft_num::Axis;

    fn v(x: f64, y: f64, z: f64) -> Vec3 {
        Vec3::of(x, y, z)
    }

    #[test]
    fn boxes_fit_and_contain() {
        let a = Axis { point: v(0.1, 0.2, 0.3), direction: v(0.6, 0.0, 0.8) };
        let turn = Affine::rotation(&a, 0.7);
        let corners = [v(-1.0, -0.7, -0.5), v(0.9, 0.8, 0.6)];
        let block = Set::cuboid(corners[0], corners[1]).unwrap().mapped(&turn).unwrap();
        let exact = Box3::around((0..8).map(|k| {
            let pick = |axis: usize| corners[k >> axis & 1][axis];
            turn.apply(v(pick(0), pick(1), pick(2)))
        }));
        let found = bounds(&block, 1e-3).unwrap().unwrap();
        for k in 0..3 {
            assert!(found.low[k] <= exact.low[k] && found.low[k] > exact.low[k] - 2e-3);
            assert!(found.high[k] >= exact.high[k] && found.high[k] < exact.high[k] + 2e-3);
        }
        let small = Set::new(&Primitive::sphere(v(1e4, 0.0, 0.0), 1e-3).unwrap());
        let found = bounds(&small, 1e-5).unwrap().unwrap();
        assert!((found.high.x - 1e4 - 1e-3).abs() < 2e-5);
    }

    #[test]
    fn endless_sets_are_refused_and_empty_ones_have_no_box() {
        let z = Axis { point: v(0.0, 0.0, 0.0), direction: v(0.0, 0.0, 1.0) };
        let pipe = Set::new(&Primitive::cylinder(z, 1.0).unwrap());
        assert_eq!(bounds(&pipe, 1e-2), Err(FieldError::Unbounded { axis: 2, sign: 1.0 }));
        assert!(matches!(bounds(&Set::everything(), 1.0), Err(FieldError::Unbounded { .. })));
        assert_eq!(bounds(&Set::nothing(), 1.0), Ok(None));
        let ball = |x: f64| Set::new(&Primitive::sphere(v(x, 0.0, 0.0), 1.0).unwrap());
        assert_eq!(bounds(&(ball(0.0) & ball(9.0)), 1e-2), Ok(None));
        assert!(matches!(bounds(&pipe, 0.0), Err(FieldError::NotPositive { .. })));
    }
}
