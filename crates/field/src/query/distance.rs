//! Distance of two sets.

use super::foot;
use super::separation::{Gauge, proved as separation, suggested};
use crate::expr::interval::{Interval, octants, sides};
use crate::expr::tape::{ExprTape, NO_LEAF, RangeRoom};
use crate::set::Membership;
use crate::set::body::SurfacedSet;
use crate::{FieldError, Set};
use moldloft_num::{Box3, Vec3};
use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::sync::Arc;

/// The distance of two sets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SetDistance {
    /// The distance of the two points; 0 where the sets overlap or touch.
    pub distance: f64,
    /// Proved: no two points of the sets in the box are closer.
    pub at_least: f64,
    /// A point of the first set.
    pub first: Vec3,
    /// A point of the second set.
    pub second: Vec3,
}

type Sides = [Interval; 3];

struct DistanceBox {
    sides: Sides,
    tape: Arc<ExprTape<f64>>,
    /// True when all of it is in the set.
    solid: bool,
    /// True when it is away from the faces of the whole box.
    within: bool,
    /// The range of the gradient, where one primitive decides away from these faces.
    slope: Option<Sides>,
}

/// The part of a box in which a primitive with these slopes can be zero; `None` if empty.
fn contracted(
    tape: &ExprTape<f64>,
    mut sides: Sides,
    slope: &Sides,
    room: &mut RangeRoom,
) -> Option<Sides> {
    let centre = sides.map(|s| Interval::point(s.middle()));
    let value = tape.range(&centre, &mut room.ranges);
    for k in 0..3 {
        if slope[k].contains(0.0) {
            continue;
        }
        // 0 = f(c) + sum of g (x - c), solved for x along one axis.
        let mut rest = value;
        for j in (0..3).filter(|j| *j != k) {
            rest = rest + slope[j] * (sides[j] - centre[j]);
        }
        let place = centre[k] - rest * slope[k].reciprocal();
        let (low, high) = (sides[k].low.max(place.low), sides[k].high.min(place.high));
        if low > high {
            return None;
        }
        sides[k] = Interval { low, high };
    }
    Some(sides)
}

/// True if no nearest pair of points can be in two separate boxes: inside a solid, or if the
/// direction between them is nowhere along the gradient, outward.
fn can_prune(pair: &[Arc<DistanceBox>; 2]) -> bool {
    (0..2).any(|k| {
        let (own, other) = (&pair[k], &pair[1 - k]);
        if own.within && own.solid {
            return true;
        }
        let Some(g) = own.slope else { return false };
        let way = [0, 1, 2].map(|axis| other.sides[axis] - own.sides[axis]);
        let along = way[0] * g[0] + way[1] * g[1] + way[2] * g[2];
        along.high < 0.0
            || (0..3).any(|k| {
                let (a, b) = ((k + 1) % 3, (k + 2) % 3);
                !(way[a] * g[b] - way[b] * g[a]).contains(0.0)
            })
    })
}

struct Pair {
    distance: f64,
    depth: u32,
    parts: [Arc<DistanceBox>; 2],
}

impl PartialEq for Pair {
    fn eq(&self, o: &Self) -> bool {
        self.cmp(o) == Ordering::Equal
    }
}
impl Eq for Pair {}
impl PartialOrd for Pair {
    fn partial_cmp(&self, o: &Self) -> Option<Ordering> {
        Some(self.cmp(o))
    }
}
impl Ord for Pair {
    /// The nearest first; of equally near ones the smallest, then by coordinates.
    fn cmp(&self, o: &Self) -> Ordering {
        let place = |p: &Self| {
            let low = |k: usize| p.parts[k].sides.map(|s| s.low);
            let ([a, b, c], [d, e, f]) = (low(0), low(1));
            [a, b, c, d, e, f]
        };
        let by_place = place(o).into_iter().zip(place(self)).map(|(a, b)| a.total_cmp(&b));
        o.distance
            .total_cmp(&self.distance)
            .then(self.depth.cmp(&o.depth))
            .then(by_place.fold(Ordering::Equal, Ordering::then))
    }
}

/// The most pairs of boxes to look at.
const MOST: usize = 40_000;
/// Boxes are halved this often at most.
const DEPTH: u32 = 60;
/// Number of alternating projections at the end.
const TURNS: usize = 100;

/// The distance of two boxes, rounded down, and the points of them that are that near.
fn apart(a: &Sides, b: &Sides) -> (f64, [Vec3; 2]) {
    let mut points = [[0.0; 3]; 2];
    for k in 0..3 {
        let (x, y) = if a[k].high < b[k].low {
            (a[k].high, b[k].low)
        } else if b[k].high < a[k].low {
            (a[k].low, b[k].high)
        } else {
            let m = 0.5 * (a[k].low.max(b[k].low) + a[k].high.min(b[k].high));
            (m, m)
        };
        (points[0][k], points[1][k]) = (x, y);
    }
    let [p, q] = points.map(Vec3::from);
    (p.distance(q) * (1.0 - 4.0 * f64::EPSILON), [p, q])
}

/// The distance of two sets within a box, to `accuracy`; `None` when one of them has no point in
/// the box.
///
/// Pairs of boxes are visited by their distance, without those proved to be air, until no other is
/// nearer than the best pair of points by more than `accuracy`, or 40 000 pairs were visited:
/// `at_least` is the proved bound. Parallel faces, concentric balls, coaxial cylinders and the like
/// are solved directly (`separation`).
///
/// # Errors
/// A box without volume; an accuracy that is not above zero.
///
/// # Example
/// ```
/// use moldloft_field::{Primitive, Set, distance};
/// use moldloft_num::{Box3, Vec3};
///
/// let ball = |x: f64| Primitive::sphere(Vec3::of(x, 0.0, 0.0), 1.0).map(|f| Set::new(&f));
/// let over = Box3 { low: Vec3::of(-2.0, -2.0, -2.0), high: Vec3::of(7.0, 2.0, 2.0) };
/// let found = distance(&ball(0.0)?, &ball(5.0)?, &over, 1e-6)?.unwrap();
/// assert!((found.distance - 3.0).abs() < 1e-6 && found.at_least <= 3.0);
/// # Ok::<(), moldloft_field::FieldError>(())
/// ```
pub fn distance(
    a: &Set,
    b: &Set,
    over: &Box3,
    accuracy: f64,
) -> Result<Option<SetDistance>, FieldError> {
    crate::error::positive("accuracy", accuracy)?;
    let over = crate::error::solid_box(*over)?;
    let near = 1e-9 * over.diagonal();
    let sets = [a, b];
    let mut room = RangeRoom::default();
    let bodies = sets.map(Set::as_body);
    let mut part = |k: usize, sides: Sides, tape: &Arc<ExprTape<f64>>| {
        let range = tape.range(&sides, &mut room.ranges);
        if range.low > 0.0 {
            return None;
        }
        let tape = tape.pruned(&room.ranges).map_or_else(|| tape.clone(), Arc::new);
        let state = bodies[k].one_state(&tape);
        if state == Some(Membership::Air) {
            return None;
        }
        let solid = range.high < 0.0 || state == Some(Membership::Solid);
        let within = (0..3).all(|k| sides[k].low > over.low[k] && sides[k].high < over.high[k]);
        let alone = !solid && tape.leaf.last().is_some_and(|l| *l != NO_LEAF);
        // Points that are nearest are on the surface, or in a face of the whole box.
        let mut part = DistanceBox { sides, tape, solid, within, slope: None };
        if alone && within {
            let range = part.tape.mean_value(&part.sides, &mut room);
            part.sides = contracted(&part.tape, part.sides, &range.slope, &mut room)?;
            part.slope = Some(range.slope);
        }
        Some(Arc::new(part))
    };
    let whole = sides(&over);
    let starts = [0, 1].map(|k| part(k, whole, &bodies[k].compiled.tape));
    let [Some(first), Some(second)] = starts else { return Ok(None) };
    let mut heap = BinaryHeap::from([Pair { distance: 0.0, depth: 0, parts: [first, second] }]);
    let mut best: Option<(f64, [Vec3; 2])> = None;
    let mut seen = 0;
    // The distance of the nearest pair of boxes that was not divided further.
    let mut left = f64::INFINITY;
    let gauges = suggested(sets);
    let mut proved = gauges.iter().map(|g| separation(g, sets, &over)).fold(0.0, f64::max);
    while let Some(Pair { distance: apart_by, depth, parts }) = heap.pop() {
        let distance = apart_by.max(proved);
        if let Some((found, [p, q])) = best
            && (distance >= found - accuracy || seen >= MOST)
        {
            let at_least = distance.min(left.max(proved));
            return Ok(Some(result(&bodies, (found, [p, q]), at_least, near)));
        }
        seen += 1;
        if seen > 10 * MOST {
            return Err(FieldError::TooFine { boxes: seen as f64, limit: 10.0 * MOST as f64 });
        }
        let (_, [p, q]) = apart(&parts[0].sides, &parts[1].sides);
        if let Some(pair) = tried(&bodies, &parts, [p, q], near) {
            let found = pair[0].distance(pair[1]);
            if best.is_none_or(|b| found < b.0) {
                best = Some((found, pair));
                if let Some(way) = (pair[1] - pair[0]).normalized() {
                    proved = proved.max(separation(&Gauge::Along(way), sets, &over));
                }
            }
        }
        if parts.iter().all(|p| p.solid) {
            continue;
        }
        if depth == DEPTH {
            left = left.min(apart_by);
            continue;
        }
        // The larger box that is not all solid.
        let size = |k: usize| {
            let widest = parts[k].sides.iter().map(|s| s.width()).fold(0.0, f64::max);
            if parts[k].solid { -1.0 } else { widest }
        };
        let k = usize::from(size(1) > size(0));
        let old = &parts[k];
        for half in octants(&old.sides) {
            let Some(new) = part(k, half, &old.tape) else { continue };
            let mut pair = parts.clone();
            pair[k] = new;
            let distance = apart(&pair[0].sides, &pair[1].sides).0;
            if distance > 0.0 && can_prune(&pair) {
                continue;
            }
            if best.is_none_or(|b| distance < b.0) {
                heap.push(Pair { distance, depth: depth + 1, parts: pair });
            }
        }
    }
    let at_least = |distance: f64| (distance - accuracy).min(left).max(proved);
    Ok(best.map(|best| result(&bodies, best, at_least(best.0), near)))
}

/// The best pair, as near as points of the surfaces there are: nearest ones of each by turns, until neither moves.
fn result(
    bodies: &[SurfacedSet; 2],
    (found, pair): (f64, [Vec3; 2]),
    at_least: f64,
    near: f64,
) -> SetDistance {
    let (mut distance, mut points) = (found, pair);
    for _ in 0..TURNS {
        let before = distance;
        for k in 0..2 {
            let foot = foot::polished(&bodies[k], points[1 - k], points[k], near);
            let now = foot.distance(points[1 - k]);
            if now < distance && bodies[k].member(foot, near, &[]) != Membership::Air {
                (points[k], distance) = (foot, now);
            }
        }
        if before - distance <= 1e-15 * before {
            break;
        }
    }
    let [first, second] = points;
    SetDistance { distance, at_least: at_least.min(distance), first, second }
}

/// Points of both sets near the given ones: the points themselves where they are in the sets, else
/// nearest ones of the surfaces there, by turns.
fn tried(
    bodies: &[SurfacedSet; 2],
    parts: &[Arc<DistanceBox>; 2],
    at: [Vec3; 2],
    near: f64,
) -> Option<[Vec3; 2]> {
    let inside = |k: usize, p: Vec3| bodies[k].member(p, near, &[]) != Membership::Air;
    let mut pair = at;
    for turn in 0..6 {
        for k in 0..2 {
            let (goal, from) = (pair[1 - k], pair[k]);
            if turn == 0 {
                // Down to the surface from the box.
                pair[k] = match inside(k, from) {
                    true => from,
                    false => onto(&bodies[k], from, near)?,
                };
            }
            if inside(k, goal) {
                pair[k] = goal;
            } else {
                let foot = foot::polished(&bodies[k], goal, pair[k], near);
                if foot.distance(goal) < pair[k].distance(goal) {
                    pair[k] = foot;
                }
            }
        }
    }
    let reach = |k: usize| {
        let widest = parts[k].sides.iter().map(|s| s.width()).fold(0.0, f64::max);
        pair[k].distance(at[k]) <= 1e3 * (widest + near)
    };
    let both = (0..2).all(|k| inside(k, pair[k]) && reach(k));
    both.then_some(pair)
}

/// A point of the set's surface down the primitive that decides at `p`.
fn onto(body: &SurfacedSet, p: Vec3, near: f64) -> Option<Vec3> {
    let leaves = &body.compiled.leaves;
    let mut q = p;
    for _ in 0..30 {
        let (value, leaf) = body.winner(q);
        if value <= 0.0 {
            return Some(q);
        }
        let g = leaves[leaf?].primitive.gradient(q);
        let size = g.slope.norm_sq();
        if size == 0.0 {
            return None;
        }
        q -= g.slope * (g.value / size);
        if g.value.abs() <= 1e-3 * near * size.sqrt() {
            return (body.member(q, near, &[]) != Membership::Air).then_some(q);
        }
    }
    None
}
