//! Warnings about curves of zero length, surfaces and bodies of zero area, and surfaces that
//! overlap themselves: valid for the kernel and rarely intended.

use moldloft_model::{Graph, Object};
use moldloft_num::{Order, Pace, Real, Vec3};
use moldloft_registry::{CurveRef, Scalar, SurfaceRef, TriangleBody, Value};
use std::f64::consts::TAU;

/// Ids of these warnings.
pub const IDS: [&str; 3] = ["zero-length", "zero-area", "more-than-one-turn"];

/// Distance, relative to the coordinates, below which two points coincide.
const ONE_PLACE: f64 = 1e-12;

/// Sine of the angle between the tangents of a surface below which they are parallel.
const ONE_LINE: f64 = 1e-9;

/// Sampled parameters; the first ones decide most cases.
const PLACES: [f64; 5] = [0.37, 0.81, 0.5, 0.07, 0.96];

/// Warning about the size of an object: id, message, advice.
pub fn remark<T: Scalar>(
    object: &Object<T>,
    graph: &Graph<T>,
) -> Option<(&'static str, &'static str, &'static str)> {
    match object.value()? {
        // A curve made of a single point object is a point on purpose, and so are its parts.
        Value::Curve(curve)
            if object.parents.len() != 1
                && is_point(curve)
                && !is_along_pole(curve)
                && !is_part(object, graph) =>
        {
            Some((
                "zero-length",
                "the curve has no length: all of it is one point",
                "its points coincide; a point can be used wherever a curve is expected",
            ))
        }
        Value::Surface(surface) if has_no_area(surface) => Some((
            "zero-area",
            "the surface has no area: all of it is one line or point",
            "its curves coincide, or are on its axis",
        )),
        Value::Surface(surface) if turns_on(surface) => Some((
            "more-than-one-turn",
            "the surface turns by more than one turn and covers itself: area and volume count each turn",
            "angles are in radians; without them it is a whole turn",
        )),
        Value::Body(body) if is_flat(body) => Some((
            "zero-area",
            "the body has no area: its triangles are lines or points",
            "its points coincide or are collinear",
        )),
        _ => None,
    }
}

/// True when a parent, or the curve that a parent is on, is itself a point: the warning belongs
/// there.
fn is_part<T: Scalar>(object: &Object<T>, graph: &Graph<T>) -> bool {
    let values = object.parents.iter().filter_map(|parent| graph.get(*parent)?.value());
    values.into_iter().any(|value| match value {
        Value::Curve(curve) => is_point(curve),
        Value::Point(point) => point.on_curve.as_ref().is_some_and(|place| is_point(&place.0)),
        _ => false,
    })
}

fn is_point<T: Real>(curve: &CurveRef<T>) -> bool {
    let at = |t: f64| curve.jet(T::from(t), Order::Zero)[0].re();
    let first = at(0.0);
    let size = largest(first);
    PLACES.iter().chain(&[1.0]).all(|t| first.distance(at(*t)) <= ONE_PLACE * size)
}

/// True for a snake along the pole of its surface: a side of a part of it.
fn is_along_pole<T: Real>(curve: &CurveRef<T>) -> bool {
    let at = |t: f64| curve.on_surface(T::from(t), Order::Zero).map(|[w, ..]| w.re());
    let ends = at(0.0).zip(at(1.0));
    ends.is_some_and(|(from, to)| from.distance(to) > ONE_PLACE)
}

/// True for a surface that is degenerate to a line or point.
pub fn has_no_area<T: Real>(surface: &SurfaceRef<T>) -> bool {
    let flat = |u: f64, v: f64| {
        let j = surface.jet(T::from(u), T::from(v), Order::First);
        let (a, b) = (j.u.re(), j.v.re());
        let (long, small) = (a.norm() * b.norm(), ONE_PLACE * largest(j.p.re()));
        a.cross(b).norm() <= ONE_LINE * long || a.norm().min(b.norm()) <= small
    };
    PLACES.iter().all(|u| PLACES.iter().all(|v| flat(*u, *v)))
}

/// True for a surface of revolution of more than 360°.
fn turns_on<T: Real>(surface: &SurfaceRef<T>) -> bool {
    const ROUNDING: f64 = 1e-9;
    let turn = |pace: &Pace| matches!(pace, Pace::Angle(angle) if angle.abs() > TAU + ROUNDING);
    surface.rational().paces[1..].iter().any(turn)
}

fn is_flat<T: Real>(body: &TriangleBody<T>) -> bool {
    let size = body.points.iter().map(|p| largest(p.re())).fold(0.0, f64::max);
    !body.triangles.is_empty() && body.of_triangles.area.re() <= ONE_PLACE * size * size
}

fn largest(p: Vec3) -> f64 {
    p.x.abs().max(p.y.abs()).max(p.z.abs())
}
