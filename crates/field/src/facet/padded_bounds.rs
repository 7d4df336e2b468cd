//! Boxes with a minimum thickness.
//!
//! Sheets, wires and points are found as faces, edges and corners of solids, which must be thicker than the cells of
//! a grid. Beside a face of the box they may not be; but where a sheet does not reach that face, it cuts nothing off
//! and may as well be further away. That it does not is proved by intervals.

use crate::expr::interval::{Interval, sides};
use crate::expr::tape::ExprTape;
use crate::{Primitive, Set};
use moldloft_num::{Box3, Vec3};
use std::sync::Arc;

/// Minimum side relative to the longest, and minimum widening relative to the longest: four and two
/// cells where the longest has sixteen.
const LEAST: f64 = 0.25;
const MORE: f64 = 0.125;
/// Number of boxes with possible content after which a face is left where it is.
const MOST_BOXES: usize = 4096;

/// The box with its sides widened, unless points of `set` on all `surfaces` would be in the added
/// part.
pub(crate) fn padded_bounds(over: &Box3, set: &Set, surfaces: &[&Primitive]) -> Box3 {
    let mut over = *over;
    let size = (0..3).map(|k| over.high[k] - over.low[k]).fold(0.0, f64::max);
    let mut search = SurfaceSearch::of(set, surfaces);
    for axis in 0..3 {
        let missing = 0.5 * (LEAST * size - (over.high[axis] - over.low[axis]));
        let missing = missing.max(MORE * size);
        let step = Vec3::from([0, 1, 2].map(|k| if k == axis { missing } else { 0.0 }));
        let below = Box3 { low: over.low - step, high: clipped(over.high, axis, over.low[axis]) };
        let above = Box3 { low: clipped(over.low, axis, over.high[axis]), high: over.high + step };
        if search.empty(&below) {
            over.low -= step;
        }
        if search.empty(&above) {
            over.high += step;
        }
    }
    over
}

fn clipped(corner: Vec3, axis: usize, at: f64) -> Vec3 {
    Vec3::from([0, 1, 2].map(|k| if k == axis { at } else { corner[k] }))
}

/// Looks for points of a set on some surfaces.
struct SurfaceSearch {
    set: Arc<ExprTape<f64>>,
    surfaces: Vec<Arc<ExprTape<f64>>>,
    ranges: Vec<Interval>,
}

impl SurfaceSearch {
    fn of(set: &Set, surfaces: &[&Primitive]) -> Self {
        let surfaces = surfaces.iter().map(|f| f.tape().clone()).collect();
        Self { set: set.compiled().tape, surfaces, ranges: Vec::new() }
    }

    /// True when it is proved that no such point is in the box.
    fn empty(&mut self, over: &Box3) -> bool {
        let mut stack = vec![*over];
        for _ in 0..MOST_BOXES {
            let Some(part) = stack.pop() else { return true };
            let at = sides(&part);
            let ranges = &mut self.ranges;
            let off = |f: &Arc<ExprTape<f64>>, ranges: &mut Vec<Interval>| {
                let range = f.range(&at, ranges);
                range.low > 0.0 || range.high < 0.0
            };
            if self.surfaces.iter().any(|f| off(f, ranges)) || self.set.range(&at, ranges).low > 0.0
            {
                continue;
            }
            // Across its longest side.
            let length = |k: usize| part.high[k] - part.low[k];
            let axis = (1..3).fold(0, |a, k| if length(k) > length(a) { k } else { a });
            let middle = part.centre()[axis];
            stack.push(Box3 { low: part.low, high: clipped(part.high, axis, middle) });
            stack.push(Box3 { low: clipped(part.low, axis, middle), high: part.high });
        }
        false
    }
}
