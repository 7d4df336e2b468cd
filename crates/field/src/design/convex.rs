//! Convex hulls of sets, and Minkowski sums of convex ones.

use super::discs::{CoaxialRing, of_discs, of_rings};
use super::hull::{HullBall, Prism, of_balls, outermost};
use crate::expr::form::Form;
use crate::query::separation::solid_within;
use crate::{FieldError, Primitive, Set};
use moldloft_num::{Axis, Real, Vec3};

/// Angles, and lengths relative to the size, below which values are zero.
const FLAT: f64 = 1e-9;

/// A disc across an axis, with a ball of radius `tube` at each of its points.
#[derive(Clone, Copy, Debug)]
struct Disc<T> {
    centre: Vec3<T>,
    normal: Vec3<T>,
    radius: T,
    tube: T,
}

/// Points, balls and discs whose hull the convex body is.
#[derive(Clone, Debug)]
struct Spanning<T> {
    balls: Vec<HullBall<T>>,
    discs: Vec<Disc<T>>,
}

fn no_hull<R>(found: impl Into<String>) -> Result<R, FieldError> {
    Err(FieldError::NoHull { found: found.into() })
}

/// A half-space n.x <= d.
struct PlaneBound<T> {
    normal: Vec3<T>,
    distance: T,
}

impl<T: Real> Spanning<T> {
    /// From an intersection of primitives; empty for an empty one.
    fn of(piece: &[Primitive<T>]) -> Result<Self, FieldError> {
        let mut planes = Vec::new();
        let mut round = Vec::new();
        for p in piece {
            match (p.form(), solid_within(&p.re())) {
                (Form::Plane(plane), Some(within)) => {
                    let n = crate::error::unit("normal", plane.normal)?;
                    let normal = if within { n } else { -n };
                    planes.push(PlaneBound { normal, distance: normal.dot(plane.point) });
                }
                (_, Some(true)) => round.push(p),
                (form, Some(false)) => {
                    return no_hull(format!("the outside of a {}", form.name()));
                }
                (form, None) => return no_hull(format!("a {}", form.name())),
            }
        }
        let balls = |balls| Ok(Self { balls, discs: Vec::new() });
        match round[..] {
            [] => balls(corners(&planes)?),
            [p] => match p.form() {
                Form::Sphere { centre, radius } if planes.is_empty() => {
                    balls(vec![HullBall { centre: *centre, radius: *radius }])
                }
                Form::Cylinder { axis, radius } => {
                    Self::of_revolution(axis, &planes, |_| Some(*radius))
                }
                Form::Cone { axis, angle } => {
                    let slope = (*angle * 0.5).tan();
                    Self::of_revolution(axis, &planes, |h| {
                        Some(if h.re() < 0.0 { -h * slope } else { h * slope })
                    })
                    .and_then(|found| one_nappe(axis, found))
                }
                Form::Torus { axis, major, minor } if planes.is_empty() => {
                    let normal = crate::error::unit("axis", axis.direction)?;
                    let disc = Disc { centre: axis.point, normal, radius: *major, tube: *minor };
                    Ok(Self { balls: Vec::new(), discs: vec![disc] })
                }
                form if planes.is_empty() => no_hull(format!("a {}", form.name())),
                form => no_hull(format!("a {} with planes", form.name())),
            },
            _ => no_hull("an intersection of two round primitives"),
        }
    }

    /// From a cylinder or cone between planes normal to its axis.
    fn of_revolution(
        axis: &Axis<T>,
        planes: &[PlaneBound<T>],
        radius: impl Fn(T) -> Option<T>,
    ) -> Result<Self, FieldError> {
        let a = crate::error::unit("axis", axis.direction)?;
        let mut ends: [Option<T>; 2] = [None, None];
        for plane in planes {
            let along = plane.normal.dot(a);
            if plane.normal.re().cross(a.re()).norm() > FLAT {
                return no_hull("a cylinder or cone with a plane that is not across its axis");
            }
            let h = plane.distance / along - a.dot(axis.point);
            let end = &mut ends[usize::from(along.re() > 0.0)];
            let sign = along.re().signum();
            *end = match *end {
                Some(old) if old.re() * sign <= h.re() * sign => Some(old),
                _ => Some(h),
            };
        }
        let [Some(low), Some(high)] = ends else {
            return no_hull("a cylinder or cone without an end");
        };
        let mut found = Self { balls: Vec::new(), discs: Vec::new() };
        if high.re() <= low.re() {
            return Ok(found);
        }
        for h in [low, high] {
            let (centre, radius) = (axis.point + a * h, radius(h).unwrap_or(h));
            found.discs.push(Disc { centre, normal: a, radius, tube: T::from(0.0) });
        }
        let size = found.discs.iter().map(|d| d.radius.re()).fold(high.re() - low.re(), f64::max);
        let (points, discs) = found.discs.iter().partition(|d| d.radius.re() <= FLAT * size);
        let points: Vec<Disc<T>> = points;
        found.discs = discs;
        found
            .balls
            .extend(points.iter().map(|d| HullBall { centre: d.centre, radius: T::from(0.0) }));
        Ok(found)
    }

    fn joined(all: Vec<Self>) -> Self {
        let mut out = Self { balls: Vec::new(), discs: Vec::new() };
        for mut part in all {
            out.balls.append(&mut part.balls);
            out.discs.append(&mut part.discs);
        }
        out
    }

    /// Without the parts inside balls.
    fn reduced(mut self) -> Self {
        self.balls = outermost(&self.balls);
        let covered = |d: &Disc<T>| {
            self.balls.iter().any(|b| {
                let to = d.centre.re() - b.centre.re();
                let n = d.normal.re();
                let aside = (to - n * n.dot(to)).norm() + d.radius.re();
                libm::hypot(aside, n.dot(to)) + d.tube.re() <= b.radius.re() * (1.0 + 1e-9)
            })
        };
        self.discs.retain(|d| !covered(d));
        self
    }

    /// As the extrusion of an outline across the axis of its discs.
    fn prism(&self) -> Result<Prism<T>, FieldError> {
        let Some(first) = self.discs.first() else { return no_hull("a body without discs") };
        let axis = first.normal;
        let n = axis.re();
        if self.discs.iter().any(|d| d.normal.re().cross(n).norm() > FLAT) {
            return no_hull("cylinders or cones of different axes");
        }
        let discs = self.discs.iter().map(|d| HullBall { centre: d.centre, radius: d.radius });
        let all: Vec<HullBall<T>> = self.balls.iter().copied().chain(discs).collect();
        let heights: Vec<f64> = all.iter().map(|b| n.dot(b.centre.re())).collect();
        let low = heights.iter().copied().fold(f64::INFINITY, f64::min);
        let high = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let reach = |b: &HullBall<T>| b.centre.re().distance(all[0].centre.re()) + b.radius.re();
        let slack = FLAT * all.iter().map(reach).fold(0.0, f64::max);
        if self.balls.iter().any(|b| b.radius.re() > slack) {
            return no_hull("balls beside cylinders or cones");
        }
        let at = |level: f64| -> Vec<HullBall<T>> {
            let there = heights.iter().zip(&all).filter(|(h, _)| (**h - level).abs() <= slack);
            outermost(&there.map(|(_, b)| *b).collect::<Vec<_>>())
        };
        let (bottom, top) = (at(low), at(high));
        // Discs between the ends, as in sums of prisms, add nothing within the outline of an end.
        let level = |(h, d): (&f64, &HullBall<T>)| {
            let ends = (h - low).abs() <= slack || (h - high).abs() <= slack;
            let within = |t: &HullBall<T>| {
                let to = d.centre.re() - t.centre.re();
                (to - n * n.dot(to)).norm() + d.radius.re() <= t.radius.re() + slack
            };
            ends || top.iter().any(within)
        };
        let beside = |b: &HullBall<T>| {
            let flat = |v: Vec3| v - n * n.dot(v);
            top.iter().any(|t| {
                flat(t.centre.re() - b.centre.re()).norm() <= slack
                    && (t.radius.re() - b.radius.re()).abs() <= slack
            })
        };
        if !heights.iter().zip(&all).all(level)
            || bottom.len() != top.len()
            || !bottom.iter().all(beside)
        {
            return no_hull(
                "cylinders, cones or prisms that do not lie between the same two planes",
            );
        }
        let ends = [bottom[0].centre, top[0].centre];
        Ok(Prism { axis, ends, discs: bottom })
    }

    fn hull(self) -> Result<Set<T>, FieldError> {
        let found = self.reduced();
        match (&found.discs[..], &found.balls[..]) {
            ([], []) => Ok(Set::nothing()),
            ([], balls) => of_balls(balls),
            _ => found.across_one_axis(),
        }
    }

    /// The hull of discs with one axis, and of balls.
    fn across_one_axis(&self) -> Result<Set<T>, FieldError> {
        if self.discs.iter().all(|d| d.tube.re() == 0.0)
            && let Ok(prism) = self.prism()
        {
            return prism.hull();
        }
        let axis = Axis { point: self.discs[0].centre, direction: self.discs[0].normal };
        let n = axis.direction.re();
        if self.discs.iter().any(|d| d.normal.re().cross(n).norm() > FLAT) {
            return no_hull("cylinders or cones of different axes");
        }
        let zero = T::from(0.0);
        let all: Vec<Disc<T>> = (self.discs.iter().copied())
            .chain(self.balls.iter().map(|b| Disc {
                centre: b.centre,
                normal: axis.direction,
                radius: zero,
                tube: b.radius,
            }))
            .collect();
        let reach =
            |d: &Disc<T>| d.centre.re().distance(axis.point.re()) + d.radius.re() + d.tube.re();
        let slack = FLAT * all.iter().map(reach).fold(0.0, f64::max);
        let height = |d: &Disc<T>| axis.direction.dot(d.centre - axis.point);
        let off = |d: &Disc<T>| (d.centre - axis.point).re().cross(n).norm();
        if all.iter().all(|d| off(d) <= slack) {
            let ring =
                |d: &Disc<T>| CoaxialRing { height: height(d), radius: d.radius, tube: d.tube };
            return of_rings(axis, &all.iter().map(ring).collect::<Vec<_>>());
        }
        if all.iter().any(|d| d.tube.re() > slack) {
            return no_hull("balls or tori beside the axis of cylinders, cones or tori");
        }
        let flat = |d: &Disc<T>| HullBall { centre: d.centre, radius: d.radius };
        of_discs(axis.direction, &all.iter().map(flat).collect::<Vec<_>>())
    }

    fn sum(&self, o: &Self) -> Result<Set<T>, FieldError> {
        match (&self.discs[..], &o.discs[..]) {
            ([], []) => {
                let each = |a: &HullBall<T>| {
                    let a = *a;
                    o.balls.iter().map(move |b| HullBall {
                        centre: a.centre + b.centre,
                        radius: a.radius + b.radius,
                    })
                };
                let balls: Vec<HullBall<T>> = self.balls.iter().flat_map(each).collect();
                Self { balls, discs: Vec::new() }.hull()
            }
            ([], _) => o.sum(self),
            (_, []) if o.balls.len() == 1 && o.balls[0].radius.re() > 0.0 => {
                let ball = o.balls[0];
                let mut prism = self.clone().reduced().prism()?;
                prism.ends = prism.ends.map(|p| p + ball.centre);
                prism.discs.iter_mut().for_each(|d| d.centre += ball.centre);
                prism.rounded(ball.radius)
            }
            _ => {
                let all = |s: &Self| -> Vec<Disc<T>> {
                    let normal = self.discs[0].normal;
                    let points = s.balls.iter().map(|b| Disc {
                        centre: b.centre,
                        normal,
                        radius: T::from(0.0),
                        tube: b.radius,
                    });
                    s.discs.iter().copied().chain(points).collect()
                };
                let (mine, others) = (all(self), all(o));
                let each = |a: &Disc<T>| {
                    let a = *a;
                    others.iter().map(move |b| {
                        let normal =
                            if b.radius.re() > a.radius.re() { b.normal } else { a.normal };
                        Disc {
                            centre: a.centre + b.centre,
                            normal,
                            radius: a.radius + b.radius,
                            tube: a.tube + b.tube,
                        }
                    })
                };
                let across =
                    |d: &&Disc<T>| d.normal.re().cross(self.discs[0].normal.re()).norm() > FLAT;
                if o.discs.iter().find(across).is_some() {
                    return no_hull("cylinders or cones of different axes");
                }
                let discs = mine.iter().flat_map(each).collect();
                Self { balls: Vec::new(), discs }.across_one_axis()
            }
        }
    }
}

/// Refuses a cone on both sides of its apex.
fn one_nappe<T: Real>(axis: &Axis<T>, found: Spanning<T>) -> Result<Spanning<T>, FieldError> {
    let heights: Vec<f64> =
        found.discs.iter().map(|d| axis.direction.re().dot((d.centre - axis.point).re())).collect();
    match heights[..] {
        [a, b] if a * b < 0.0 => no_hull("a cone on both sides of its apex"),
        _ => Ok(found),
    }
}

/// The corners of a bounded polyhedron.
fn corners<T: Real>(planes: &[PlaneBound<T>]) -> Result<Vec<HullBall<T>>, FieldError> {
    let normals: Vec<Vec3> = planes.iter().map(|p| p.normal.re()).collect();
    let unbounded = |d: Vec3| normals.iter().all(|n| n.dot(d) <= 1e-12);
    let count = planes.len();
    for i in 0..count {
        for j in i + 1..count {
            let Some(d) = normals[i].cross(normals[j]).normalized() else { continue };
            if unbounded(d) || unbounded(-d) {
                return no_hull("an unbounded polyhedron");
            }
        }
    }
    let parallel = |i: usize| normals[i].cross(normals[0]).norm() < 1e-12;
    if (0..count).all(parallel) {
        return no_hull("an unbounded polyhedron");
    }
    let meet = |[i, j, k]: [usize; 3]| -> Option<Vec3<T>> {
        let [a, b, c] = [i, j, k].map(|m| &planes[m]);
        let det = a.normal.dot(b.normal.cross(c.normal));
        let sum = b.normal.cross(c.normal) * a.distance
            + c.normal.cross(a.normal) * b.distance
            + a.normal.cross(b.normal) * c.distance;
        (det.re().abs() > 1e-9).then(|| sum / det)
    };
    let mut found: Vec<HullBall<T>> = Vec::new();
    let far = planes.iter().map(|p| p.distance.re().abs()).fold(0.0, f64::max);
    for i in 0..count {
        for j in i + 1..count {
            for k in j + 1..count {
                let Some(p) = meet([i, j, k]) else { continue };
                let over = |h: &PlaneBound<T>| h.normal.re().dot(p.re()) - h.distance.re();
                if planes.iter().all(|h| over(h) <= 1e-11 * (far + p.re().norm())) {
                    found.push(HullBall { centre: p, radius: T::from(0.0) });
                }
            }
        }
    }
    Ok(outermost(&found))
}

impl<T: Real> Set<T> {
    fn spanning(&self) -> Result<Vec<Spanning<T>>, FieldError> {
        self.pieces()?.iter().map(|piece| Spanning::of(piece)).collect()
    }
}

/// The convex hull of sets: the smallest convex set that holds all of them.
///
/// Its surface is of planes, balls, cylinders, cones and tori. The sets are unions of bounded polyhedra and balls; or of
/// polyhedra, cylinders and cones of one axis direction; or of cylinders, cones, tori and balls about one axis.
///
/// # Errors
/// [`FieldError::NoHull`] for other sets; [`FieldError::Degenerate`] for a hull without volume.
///
/// # Example
/// ```
/// use moldloft_field::{Primitive, Set, convex_hull, mass};
/// use moldloft_num::{Box3, Vec3};
///
/// let ball = |x: f64| Set::new(&Primitive::sphere(Vec3::of(x, 0.0, 0.0), 1.0).unwrap());
/// let capsule = convex_hull(&[ball(0.0), ball(3.0)])?;
/// let over = Box3 { low: Vec3::of(-1.1, -1.2, -1.3), high: Vec3::of(4.2, 1.1, 1.2) };
/// let volume = mass(&capsule, &over, &Default::default())?.best.volume();
/// assert!((volume - (3.0 + 4.0 / 3.0) * std::f64::consts::PI).abs() < 1e-6);
/// # Ok::<(), moldloft_field::FieldError>(())
/// ```
pub fn convex_hull<T: Real>(sets: &[Set<T>]) -> Result<Set<T>, FieldError> {
    let mut all = Vec::new();
    for set in sets {
        all.extend(set.spanning()?);
    }
    Spanning::joined(all).hull()
}

/// The Minkowski sum of two sets: all sums of a point of one and a point of the other.
///
/// With a ball it is the set grown by its radius, with round edges. Each set is a union of convex parts, as for
/// [`convex_hull`]; a cylinder or prism may be added to another of its axis, or to a ball.
///
/// # Errors
/// As [`convex_hull`].
pub fn minkowski_sum<T: Real>(a: &Set<T>, b: &Set<T>) -> Result<Set<T>, FieldError> {
    let (mine, others) = (a.spanning()?, b.spanning()?);
    let mut all = Set::nothing();
    // A torus is not convex.
    if mine.iter().chain(&others).any(|s| s.discs.iter().any(|d| d.tube.re() > 0.0)) {
        return no_hull("a torus");
    }
    for p in &mine {
        for q in &others {
            all = all | p.sum(q)?;
        }
    }
    Ok(all)
}
