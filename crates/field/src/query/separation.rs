//! Lower bounds of distances by functions that change no faster than distance does.
//!
//! A function with |phi(x) - phi(y)| <= |x - y| that is at most a on one set and at least b on another proves that
//! these are b - a apart. For the distance along a normal, from a point or from an axis the extremes over planes,
//! balls, cylinders and tori are known in closed form, and those over their unions and intersections follow: so parallel
//! faces, concentric balls and coaxial pipes take one evaluation, where boxes would need the square of the accuracy.

use crate::expr::interval::sides;
use crate::{Form, Primitive, Set};
use moldloft_num::{Axis, Box3, Vec3};

/// A function that changes no faster than distance does.
#[derive(Clone, Copy, Debug)]
pub(super) enum Gauge {
    /// Along a unit vector.
    Along(Vec3),
    /// Distance from a point.
    Point(Vec3),
    /// Distance from a line with a unit direction.
    Axis(Axis<f64>),
}

/// Directions that differ by less are parallel; the resulting error over the box is subtracted from
/// the bound.
const PARALLEL: f64 = 1e-12;

fn from_line(p: Vec3, axis: &Axis<f64>) -> f64 {
    let d = p - axis.point;
    (d - axis.direction * axis.direction.dot(d)).norm()
}

fn unit(axis: &Axis<f64>) -> Option<Axis<f64>> {
    Some(Axis { point: axis.point, direction: axis.direction.normalized()? })
}

fn parallel(u: Vec3, v: Vec3) -> bool {
    u.cross(v).norm() <= PARALLEL
}

fn across(u: Vec3, v: Vec3) -> bool {
    u.dot(v).abs() <= PARALLEL
}

/// A point within the surface of a form, by which one knows on which side the primitive is solid.
fn inner(form: &Form<f64>) -> Option<Vec3> {
    match form {
        Form::Plane(p) => Some(p.point - p.normal),
        Form::Sphere { centre, .. } => Some(*centre),
        Form::Cylinder { axis, .. } => Some(axis.point),
        Form::Cone { axis, .. } => Some(axis.point + axis.direction.normalized()?),
        Form::Torus { axis, major, .. } => {
            let out = axis.direction.perpendicular().normalized()?;
            Some(axis.point + out * *major)
        }
        _ => None,
    }
}

/// True when the primitive is solid within the surface of its form, false when it is solid outside.
pub(crate) fn solid_within(f: &Primitive) -> Option<bool> {
    let value = f.value(inner(f.form())?);
    (value != 0.0 && value.is_finite()).then_some(value < 0.0)
}

/// The least and the greatest value of a gauge on the solid side of a primitive, or bounds of them.
fn leaf_range(gauge: &Gauge, f: &Primitive) -> [f64; 2] {
    let all = match gauge {
        Gauge::Along(_) => [f64::NEG_INFINITY, f64::INFINITY],
        _ => [0.0, f64::INFINITY],
    };
    let Some(within) = solid_within(f) else { return all };
    let about = |middle: f64, radius: f64| match within {
        true => [(middle - radius).max(all[0]), middle + radius],
        false => all,
    };
    // The solid outside a round surface excludes the points about the centre.
    let outside = |offset: f64, radius: f64| match within {
        true => [(offset - radius).max(0.0), offset + radius],
        false => [(radius - offset).max(0.0), f64::INFINITY],
    };
    match (gauge, f.form()) {
        (Gauge::Along(n), Form::Plane(p)) if parallel(*n, p.normal) => {
            let (at, same) = (n.dot(p.point), n.dot(p.normal) > 0.0);
            if same == within { [all[0], at] } else { [at, all[1]] }
        }
        (Gauge::Along(n), Form::Sphere { centre, radius }) => about(n.dot(*centre), *radius),
        (Gauge::Along(n), Form::Cylinder { axis, radius }) => match unit(axis) {
            Some(a) if across(*n, a.direction) => about(n.dot(a.point), *radius),
            _ => all,
        },
        (Gauge::Along(n), Form::Torus { axis, major, minor }) => match unit(axis) {
            Some(a) => {
                let tilt = (1.0 - n.dot(a.direction).powi(2)).max(0.0).sqrt();
                about(n.dot(a.point), major * tilt + minor)
            }
            None => all,
        },
        (Gauge::Point(c), Form::Sphere { centre, radius }) => outside(c.distance(*centre), *radius),
        (Gauge::Point(c), Form::Plane(p)) => {
            let d = p.normal.dot(*c - p.point);
            [if within { d } else { -d }.max(0.0), f64::INFINITY]
        }
        (Gauge::Point(c), Form::Cylinder { axis, radius }) => match unit(axis) {
            Some(a) => [outside(from_line(*c, &a), *radius)[0], f64::INFINITY],
            None => all,
        },
        (Gauge::Point(c), Form::Torus { axis, major, minor }) => match unit(axis) {
            Some(a) => {
                let d = *c - a.point;
                let (h, rho) = (a.direction.dot(d), from_line(*c, &a));
                let (near, far) = (libm::hypot(rho - major, h), libm::hypot(rho + major, h));
                match within {
                    true => [(near - minor).max(0.0), far + minor],
                    false => [(minor - near).max(0.0), f64::INFINITY],
                }
            }
            None => all,
        },
        (Gauge::Axis(a), Form::Cylinder { axis, radius }) => match unit(axis) {
            Some(b) if parallel(a.direction, b.direction) => {
                outside(from_line(b.point, a), *radius)
            }
            _ => all,
        },
        (Gauge::Axis(a), Form::Sphere { centre, radius }) if within => {
            outside(from_line(*centre, a), *radius)
        }
        (Gauge::Axis(a), Form::Torus { axis, major, minor }) => match unit(axis) {
            Some(b) if parallel(a.direction, b.direction) && within => {
                let d = from_line(b.point, a);
                let near = (major - d).max(d - major).max(0.0);
                [(near - minor).max(0.0), d + major + minor]
            }
            _ => all,
        },
        (Gauge::Axis(a), Form::Plane(p)) if across(a.direction, p.normal) => {
            let d = p.normal.dot(a.point - p.point);
            [if within { d } else { -d }.max(0.0), f64::INFINITY]
        }
        _ => all,
    }
}

/// Bounds of a gauge over a set; the lower one is not below the upper where they prove that it is empty.
fn range_in_space(gauge: &Gauge, set: &Set) -> [f64; 2] {
    let none = [f64::INFINITY, f64::NEG_INFINITY];
    let every = [f64::NEG_INFINITY, f64::INFINITY];
    let leaf = |f: &Primitive| leaf_range(gauge, f);
    let join = |union: bool, [a, b]: [f64; 2], [c, d]: [f64; 2]| match union {
        true => [a.min(c), b.max(d)],
        false => [a.max(c), b.min(d)],
    };
    set.folded(&leaf, every, none, &join)
}

/// True when a gauge proves that a set has no inside: that it is empty, or at most a part of a surface.
pub(crate) fn is_void(set: &Set) -> bool {
    suggested([set, set]).iter().any(|gauge| {
        let [low, high] = range_in_space(gauge, set);
        let size = 1.0 + if low.is_finite() { low.abs() } else { 0.0 };
        low >= high - 8.0 * PARALLEL * size
    })
}

/// Bounds of a gauge over the part of a set in a box; `None` when there is no such part.
fn set_range(gauge: &Gauge, set: &Set, over: &Box3) -> Option<[f64; 2]> {
    let [low, high] = range_in_space(gauge, set);
    let all = match gauge {
        Gauge::Along(n) => Primitive::linear(*n, 0.0).range(over),
        Gauge::Point(c) => {
            let s = sides(over);
            let far = [0, 1, 2].map(|k| (s[k].low - c[k]).abs().max((s[k].high - c[k]).abs()));
            let near = [0, 1, 2].map(|k| (s[k].low - c[k]).max(c[k] - s[k].high).max(0.0));
            let norm = |x: [f64; 3]| Vec3::<f64>::from(x).norm();
            crate::Interval::new(norm(near), norm(far))
        }
        Gauge::Axis(a) => {
            let middle = from_line(over.centre(), a);
            let half = 0.5 * over.diagonal();
            crate::Interval::new((middle - half).max(0.0), middle + half)
        }
    };
    let range = [low.max(all.low), high.min(all.high)];
    (range[0] <= range[1]).then_some(range)
}

pub(super) fn suggested(sets: [&Set; 2]) -> Vec<Gauge> {
    const MOST: usize = 64;
    let mut out = Vec::new();
    for leaf in sets.iter().flat_map(|s| s.leaves()) {
        if out.len() >= MOST {
            break;
        }
        let along = |v: Vec3| v.normalized().map(Gauge::Along);
        match leaf.primitive.form() {
            Form::Plane(p) => out.extend(along(p.normal)),
            Form::Sphere { centre, .. } => out.push(Gauge::Point(*centre)),
            Form::Cylinder { axis, .. } | Form::Cone { axis, .. } => {
                out.extend(unit(axis).map(Gauge::Axis));
            }
            Form::Torus { axis, .. } => {
                out.extend(along(axis.direction));
                out.push(Gauge::Point(axis.point));
                out.extend(unit(axis).map(Gauge::Axis));
            }
            _ => {}
        }
    }
    out
}

/// The distance that a gauge proves between the parts of two sets in a box.
pub(super) fn proved(gauge: &Gauge, [a, b]: [&Set; 2], over: &Box3) -> f64 {
    let (Some(p), Some(q)) = (set_range(gauge, a, over), set_range(gauge, b, over)) else {
        return 0.0;
    };
    let size = over.diagonal() + over.low.norm().max(over.high.norm());
    ((q[0] - p[1]).max(p[0] - q[1]) - 8.0 * PARALLEL * size).max(0.0)
}

/// The distance from the surface of a primitive, negative in the solid, or a lower bound of it in size.
fn signed_distance(f: &Primitive, p: Vec3) -> Option<f64> {
    let within = solid_within(f)?;
    let d = match f.form() {
        Form::Plane(plane) => plane.normal.dot(p - plane.point),
        Form::Sphere { centre, radius } => p.distance(*centre) - radius,
        Form::Cylinder { axis, radius } => from_line(p, &unit(axis)?) - radius,
        Form::Cone { axis, angle } => {
            let a = unit(axis)?;
            let (h, rho) = (a.direction.dot(p - a.point).abs(), from_line(p, &a));
            let half = 0.5 * angle;
            rho * libm::cos(half) - h * libm::sin(half)
        }
        Form::Torus { axis, major, minor } => {
            let a = unit(axis)?;
            libm::hypot(from_line(p, &a) - major, a.direction.dot(p - a.point)) - minor
        }
        _ => return None,
    };
    Some(if within { d } else { -d })
}

/// A proved bound: no point of the set's surface is nearer to `p`.
pub(super) fn from_point(set: &Set, p: Vec3) -> f64 {
    let leaf = |f: &Primitive| signed_distance(f, p).unwrap_or(f64::NAN);
    let join = |union: bool, a: f64, b: f64| {
        if a.is_nan() || b.is_nan() {
            f64::NAN
        } else if union {
            a.min(b)
        } else {
            a.max(b)
        }
    };
    let phi = set.folded(&leaf, f64::NEG_INFINITY, f64::INFINITY, &join);
    if phi.is_finite() { phi.abs() * (1.0 - 1e-14) } else { 0.0 }
}
