//! The nearest point of a set's surface, and plane sections.

use crate::expr::interval::{Interval, sides};
use crate::expr::tape::{ExprTape, NO_LEAF, RangeRoom};
use crate::facet::Facets;
use crate::facet::vertex::Solver;
use crate::set::body::SurfacedSet;
use crate::{FieldError, Primitive, Set, ValueGradient};
use moldloft_num::{Box3, Plane, Vec3};
use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::sync::Arc;

/// A box that may contain the surface, by its distance from the point.
struct Candidate {
    distance: f64,
    sides: [Interval; 3],
    depth: u32,
    tape: Arc<ExprTape<f64>>,
}

impl PartialEq for Candidate {
    fn eq(&self, o: &Self) -> bool {
        self.cmp(o) == Ordering::Equal
    }
}
impl Eq for Candidate {}
impl PartialOrd for Candidate {
    fn partial_cmp(&self, o: &Self) -> Option<Ordering> {
        Some(self.cmp(o))
    }
}
impl Ord for Candidate {
    /// The nearest first; of equally near ones the smallest, then by coordinates.
    fn cmp(&self, o: &Self) -> Ordering {
        let place = |c: &Self| c.sides.map(|s| s.low);
        let by_place = place(o).into_iter().zip(place(self)).map(|(a, b)| a.total_cmp(&b));
        o.distance
            .total_cmp(&self.distance)
            .then(self.depth.cmp(&o.depth))
            .then(by_place.fold(Ordering::Equal, Ordering::then))
    }
}

/// The nearest point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CertifiedNearest {
    /// The point.
    pub point: Vec3,
    /// Its distance.
    pub distance: f64,
    /// A proved bound: no point of the surface in the box is closer.
    pub at_least: f64,
}

/// Boxes are halved this often along each axis, at most.
const DEPTH: u32 = 48;
/// The most boxes to look at.
const MOST: usize = 100_000;

/// The point of a set's surface in a box that is nearest to `p`; `None` without a surface.
///
/// Boxes are visited by their distance, without those proved all solid or all air, until no other
/// is nearer than the best point by more than `accuracy`, or 100 000 were visited: `at_least` is
/// the proved bound.
///
/// # Errors
/// A box without volume, an accuracy that is not above zero.
///
/// # Example
/// ```
/// use moldloft_field::{Primitive, Set, nearest};
/// use moldloft_num::{Box3, Vec3};
///
/// let ball = Set::new(&Primitive::sphere(Vec3::zero(), 1.0)?);
/// let over = Box3 { low: Vec3::of(-2.0, -2.0, -2.0), high: Vec3::of(2.0, 2.0, 2.0) };
/// let found = nearest(&ball, Vec3::of(3.0, 4.0, 0.0), &over, 1e-6)?.unwrap();
/// assert!((found.distance - 4.0).abs() < 1e-6 && found.at_least <= 4.0);
/// # Ok::<(), moldloft_field::FieldError>(())
/// ```
pub fn nearest(
    set: &Set,
    p: Vec3,
    over: &Box3,
    accuracy: f64,
) -> Result<Option<CertifiedNearest>, FieldError> {
    crate::error::positive("accuracy", accuracy)?;
    let over = crate::error::solid_box(*over)?;
    let body = set.as_body();
    let compiled = &body.compiled;
    let mut best: Option<(Vec3, f64)> = None;
    let mut heap = BinaryHeap::new();
    let mut room = Vec::new();
    let mut solver = Solver::default();
    let start = sides(&over);
    let distance = reach(&start, p);
    heap.push(Candidate { distance, sides: start, depth: 0, tape: compiled.tape.clone() });
    let mut seen = 0;
    // The distance of the nearest box that was not divided further.
    let mut left = f64::INFINITY;
    // From a centre of symmetry every point is nearest: boxes could not prove that in reasonable
    // time, distances do.
    let proved = super::separation::from_point(set, p);
    while let Some(Candidate { distance, sides, depth, tape }) = heap.pop() {
        let distance = distance.max(proved);
        if let Some((point, found)) = best
            && (distance >= found - accuracy || seen >= MOST)
        {
            // Near a minimum the distance determines the position only to the square root of
            // rounding; Newton's method refines it.
            let point = crate::query::foot::polished(&body, p, point, 1e-9 * over.diagonal());
            let found = point.distance(p).min(found);
            return Ok(Some(CertifiedNearest {
                point,
                distance: found,
                at_least: distance.min(left.max(proved)).min(found),
            }));
        }
        seen += 1;
        if seen > 2 * MOST {
            return Err(FieldError::TooFine { boxes: seen as f64, limit: 2.0 * MOST as f64 });
        }
        let range = tape.range(&sides, &mut room);
        if range.low > 0.0 || range.high < 0.0 {
            continue;
        }
        let tape = tape.pruned(&room).map_or(tape, Arc::new);
        if body.one_state(&tape).is_some() {
            // The remaining surfaces are hidden inside the body.
            continue;
        }
        let smooth = surface_point(&body, &tape, &sides, p);
        let sharp = edge_point(&body, &tape, &sides, p, &mut solver);
        for point in [smooth, sharp].into_iter().flatten() {
            let found = point.distance(p);
            if best.is_none_or(|b| found < b.1) && inside(point, &over) {
                best = Some((point, found));
            }
        }
        if no_foot(&tape, &sides, p, &over) {
            continue;
        }
        if depth == DEPTH {
            left = left.min(distance);
            continue;
        }
        for k in 0..8 {
            let half = [0, 1, 2].map(|axis| {
                let middle = sides[axis].middle();
                if k >> axis & 1 == 0 {
                    Interval::new(sides[axis].low, middle)
                } else {
                    Interval::new(middle, sides[axis].high)
                }
            });
            let distance = reach(&half, p);
            if best.is_none_or(|b| distance < b.1) {
                heap.push(Candidate {
                    distance,
                    sides: half,
                    depth: depth + 1,
                    tape: tape.clone(),
                });
            }
        }
    }
    Ok(best.map(|(point, distance)| CertifiedNearest {
        point,
        distance,
        at_least: (distance - accuracy).min(left).max(proved).min(distance),
    }))
}

/// True if one primitive alone decides in the box, away from the faces of the whole box, and its
/// gradient is nowhere parallel to the direction from `p`: then the nearest point is elsewhere.
fn no_foot(tape: &ExprTape<f64>, sides: &[Interval; 3], p: Vec3, over: &Box3) -> bool {
    let alone = tape.leaf.last().is_some_and(|l| *l != NO_LEAF);
    let within = (0..3).all(|k| sides[k].low > over.low[k] && sides[k].high < over.high[k]);
    if !alone || !within {
        return false;
    }
    let g = tape.mean_value(sides, &mut RangeRoom::default()).slope;
    let way = [0, 1, 2].map(|k| sides[k] - Interval::point(p[k]));
    (0..3).any(|k| {
        let (a, b) = ((k + 1) % 3, (k + 2) % 3);
        !(way[a] * g[b] - way[b] * g[a]).contains(0.0)
    })
}

fn inside(p: Vec3, b: &Box3) -> bool {
    (0..3).all(|k| p[k] >= b.low[k] && p[k] <= b.high[k])
}

/// The distance of a box from a point, rounded down.
fn reach(sides: &[Interval; 3], p: Vec3) -> f64 {
    let clamped = Vec3::new(
        p.x.clamp(sides[0].low, sides[0].high),
        p.y.clamp(sides[1].low, sides[1].high),
        p.z.clamp(sides[2].low, sides[2].high),
    );
    clamped.distance(p) * (1.0 - 4.0 * f64::EPSILON)
}

/// A point of the set's surface near the point of a box that is nearest to `p`: on the primitive that
/// decides there, the foot of the normal from `p`, if the set shows it.
fn surface_point(
    body: &SurfacedSet,
    tape: &ExprTape<f64>,
    sides: &[Interval; 3],
    p: Vec3,
) -> Option<Vec3> {
    let start = Vec3::new(
        p.x.clamp(sides[0].low, sides[0].high),
        p.y.clamp(sides[1].low, sides[1].high),
        p.z.clamp(sides[2].low, sides[2].high),
    );
    let mut values = Vec::new();
    tape.eval::<f64>(&start, &mut values);
    let leaf = tape.leaf[tape.winner(&values, |v: f64| v)];
    if leaf == NO_LEAF {
        return None;
    }
    let f = body.compiled.leaves[leaf as usize].primitive.of_sheet();
    let q = foot(f, start, p)?;
    let size = 1.0 + q.norm();
    let shown = body.member(q, 1e-12 * size, std::slice::from_ref(f));
    (shown == crate::Membership::Surface).then_some(q)
}

/// A point of the zero set of `f` near `start` whose normal passes through `p`: first onto the
/// surface, then along it towards `p` and back, by shorter steps where that leads away because the
/// surface bends more.
fn foot(f: &Primitive, start: Vec3, p: Vec3) -> Option<Vec3> {
    /// Numbers of Newton steps, and of steps along the surface.
    const ONTO: usize = 40;
    const ALONG: usize = 60;
    /// Relative distance of the foot at which the distance is known to rounding.
    const NEAR_FOOT: f64 = 1e-9;
    let small = |step: f64, q: Vec3| step <= 1e-15 * (1.0 + q.norm());
    let onto = |mut q: Vec3| {
        for _ in 0..ONTO {
            let ValueGradient { value, slope } = f.gradient(q);
            let step = slope * (value / slope.norm_sq());
            q -= step;
            if small(step.norm(), q) {
                break;
            }
        }
        q
    };
    let along = |q: Vec3| {
        let ValueGradient { slope, .. } = f.gradient(q);
        let towards = p - q;
        towards - slope * (towards.dot(slope) / slope.norm_sq())
    };
    let mut q = onto(start);
    let (mut way, mut pace) = (along(q), 0.5);
    for _ in 0..ALONG {
        let next = onto(q + way * pace);
        let rest = along(next);
        if rest.norm() > way.norm() {
            pace *= 0.5;
            continue;
        }
        let step = next.distance(q);
        (q, way) = (next, rest);
        if step <= NEAR_FOOT * (1.0 + q.norm()) {
            break;
        }
    }
    let ValueGradient { value, slope } = f.gradient(q);
    let on = value.abs() <= 1e-12 * (1.0 + q.norm()) * slope.norm();
    (q.is_finite() && on).then_some(q)
}

/// A point of an edge or a corner in a box where two or three primitives meet.
fn edge_point(
    body: &SurfacedSet,
    tape: &ExprTape<f64>,
    sides: &[Interval; 3],
    p: Vec3,
    solver: &mut Solver,
) -> Option<Vec3> {
    let leaves = &body.compiled.leaves;
    let surfaces: Vec<u32> = tape.leaf.iter().copied().filter(|l| *l != NO_LEAF).collect();
    if !(2..=3).contains(&surfaces.len()) {
        return None;
    }
    let low = Vec3::new(sides[0].low, sides[1].low, sides[2].low);
    let high = Vec3::new(sides[0].high, sides[1].high, sides[2].high);
    let start =
        Vec3::new(p.x.clamp(low.x, high.x), p.y.clamp(low.y, high.y), p.z.clamp(low.z, high.z));
    let goal = 1e-13 * (1.0 + low.norm().max(high.norm()));
    let placed = solver.place(leaves, &surfaces, start, &Box3 { low, high }, goal);
    let known: Vec<Primitive> =
        surfaces.iter().map(|&k| leaves[k as usize].primitive.clone()).collect();
    let shown = placed.residual <= goal
        && body.member(placed.point, goal, &known) == crate::Membership::Surface;
    shown.then_some(placed.point)
}

/// A contour of a set in a plane.
#[derive(Clone, Debug, PartialEq)]
pub struct SetContour {
    /// Its points, in the plane and on the surface; the first is not repeated when it is closed.
    pub points: Vec<Vec3>,
    /// True when it ends where it began.
    pub closed: bool,
}

impl Facets {
    /// The contours in which a plane cuts the body: contours of the triangles, with each point then
    /// moved in the plane onto the primitive with the least absolute value there.
    ///
    /// # Errors
    /// A plane whose normal has no direction.
    pub fn section(&self, plane: &Plane<f64>) -> Result<Vec<SetContour>, FieldError> {
        let plane = Plane::new(plane.point, plane.normal)
            .ok_or(FieldError::Degenerate { what: "normal of the plane" })?;
        let lines = moldloft_mesh::section(&self.mesh, &plane);
        let used: Vec<&Primitive> =
            self.patch_leaves.iter().map(|&l| &self.leaves[l].primitive).collect();
        let place = |p: Vec3| {
            let distance = |f: &Primitive| {
                let g = f.gradient(p);
                (g.value / g.slope.norm()).abs()
            };
            let nearest = used.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
            let Some(f) = nearest else { return p };
            let mut q = p;
            for _ in 0..8 {
                let g = f.gradient(q);
                let slope = g.slope - plane.normal * plane.normal.dot(g.slope);
                if slope.norm_sq() <= 1e-12 * g.slope.norm_sq() {
                    return p;
                }
                q -= slope * (g.value / slope.norm_sq());
            }
            // A step beyond the cell would leave this piece of the surface.
            if q.distance(p) <= self.step { q } else { p }
        };
        Ok(lines
            .into_iter()
            .map(|line| SetContour {
                points: line.points.into_iter().map(place).collect(),
                closed: line.closed,
            })
            .collect())
    }
}
