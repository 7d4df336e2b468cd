//! Points found on surfaces.

use super::arguments::{Along, Onto};
use super::beads::{axis_number, piercing};
use super::equations::{FootOnSurface, Moving, OnRay, Rays};
use super::outcome::{diverged, found, no_intersection, tangent};
use moldloft_locate::implicit::refined;
use moldloft_locate::roots::line_surface;
use moldloft_locate::{LocateStatus, PlainSurface, Solution, nearest_on_surface};
use moldloft_num::period::crease_rate;
use moldloft_num::{Order, Real, Vec3};
use moldloft_registry::{
    Build, CallError, Context, Kind, MirrorArgument, Point, SearchReport, Value,
};
use std::sync::Arc;

pub(super) const ANOTHER: &str =
    "to choose another one, give a magnet near it instead of the surface";

/// Along which lines a mirror projects: `None` is along the surface's normals.
pub(super) fn rays<T: Real>(mirror: &MirrorArgument<T>) -> Rays<T> {
    match mirror {
        MirrorArgument::Plane(plane) => Rays::Along(plane.normal),
        MirrorArgument::Line(line) => Rays::Along(line.direction),
        MirrorArgument::Point(point) => Rays::From(*point),
    }
}

fn magnet<T: Real>(
    onto: Onto<T>,
    ([u, v], found): ([T; 2], SearchReport),
) -> Result<Value<T>, CallError> {
    Ok(Value::Point(Box::new(Point::on_surface(onto.surface, u, v).with_found(found))))
}

/// The foot of a point on a surface. With `edges` a foot on an edge is admissible, and the result
/// is the nearest of the whole surface.
pub(super) fn foot<T: Real>(
    onto: &Onto<T>,
    point: Vec3<T>,
    edges: bool,
) -> Result<([T; 2], SearchReport), CallError> {
    let plain = PlainSurface(&*onto.surface);
    let start = if edges { None } else { onto.from() };
    let mut solution = nearest_on_surface(&plain, point.re(), start);
    if solution.report.status == LocateStatus::Diverged {
        return Err(diverged(&solution.report));
    }
    let uv = foot_refined(onto, point, &solution)?;
    if edges && solution.report.status == LocateStatus::EdgeClamped {
        solution.report.status = LocateStatus::Ok;
    }
    Ok((uv, found(&solution.report, ANOTHER)))
}

/// Offset in the parameter on both sides of a knuckle.
pub(super) const BESIDE: f64 = 1e-9;

fn foot_refined<T: Real>(
    onto: &Onto<T>,
    point: Vec3<T>,
    solution: &Solution<2>,
) -> Result<[T; 2], CallError> {
    let at = solution.at;
    let j = onto.surface.jet(T::from(at[0]), T::from(at[1]), Order::First);
    let away = (j.p - point).re();
    let closed = onto.surface.closed();
    // Held where the distance still falls beyond the edge, and at a knuckle.
    let held = [0, 1].map(|k| {
        let (q, d) = (at[k], [j.u, j.v][k]);
        if solution.joint[k] {
            let sides = [BESIDE; 2];
            return Some(T::from(q) + crease_rate::<T>(&*onto.surface, k, q, sides));
        }
        let slope = d.re().dot(away);
        let counts = slope.abs() > 1e-9 * d.re().norm() * (away.norm() + 1e-300);
        let beyond = q <= 0.0 && slope > 0.0 || q >= 1.0 && slope < 0.0;
        (counts && beyond && !closed[k]).then_some(T::from(q))
    });
    let point = Moving::Fixed(point);
    let system = FootOnSurface { surface: &onto.surface, point: &point, held };
    refined(&system, at, T::zero()).ok_or_else(tangent)
}

/// Intersection of the surface and the line through a point.
pub(super) fn on_ray<T: Real>(
    onto: &Onto<T>,
    point: Vec3<T>,
    rays: Rays<T>,
) -> Result<([T; 2], SearchReport), CallError> {
    let plain = PlainSurface(&*onto.surface);
    let point = Moving::Fixed(point);
    let system = OnRay { surface: &onto.surface, point: &point, rays };
    let [p, d] = system.ray::<T>(T::zero()).map(Vec3::re);
    if d.norm() == 0.0 {
        return Err(CallError::new("zero-length-axis", "the projection has no direction")
            .expected("a point away from the one that is projected")
            .found("the point itself"));
    }
    let solution = line_surface(&plain, p, d, onto.from())
        .map_err(|report| no_intersection(&report, "line of projection", "surface"))?;
    let [u, v, _] = refined(&system, solution.at, T::zero()).ok_or_else(tangent)?;
    let mut found = found(&solution.report, ANOTHER);
    // The last unknown is a length along the line, of no interest.
    found.last.truncate(2);
    found.start.truncate(2);
    found.alternatives.iter_mut().for_each(|(q, _)| q.truncate(2));
    Ok(([u, v], found))
}

/// The projection of a point onto a surface: along the surface's normal (the foot of the
/// perpendicular), along a direction, or away from a point.
///
/// From a magnet it is the foot found by Newton's method; without one, the nearest of all. A foot
/// beyond an edge is clamped to the edge and reported.
#[derive(Kind)]
#[kind(
    class = Magnet,
    columns = "point mirror surface",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 3, 2); AbsPoint D(4, 3, 1); \
               Line l(A, B); Line m(C, D); RuledSurf S(l, m); AbsPoint P(1, 2, 4); \
               ProjMagnet foot(P, S); ProjMagnet below(P, S, \"z=0\"); AbsPoint eye(1, 1, 9); \
               AbsMagnet near(S, 0.3, 0.5); ProjMagnet shadow(P, near, eye);"
)]
pub struct ProjMagnet<T: Real> {
    /// The point to project.
    point: Point<T>,
    /// The surface, or a magnet on it near the intended point.
    surface: Onto<T>,
    /// Direction of projection: a plane's normal, a line's direction, or rays from a point.
    /// Default: the surface's own normal.
    mirror: Option<MirrorArgument<T>>,
}

impl<T: Real> Build<T> for ProjMagnet<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let place = match &self.mirror {
            None => foot(&self.surface, self.point.xyz, false),
            Some(mirror) => on_ray(&self.surface, self.point.xyz, rays(mirror)),
        };
        magnet(self.surface, place.map_err(|fault| fault.in_field(Self::SURFACE))?)
    }
}

/// The point of a surface nearest to a given point, among all points of the surface and its edges.
/// Equally near points are reported.
#[derive(Kind)]
#[kind(
    class = Magnet,
    columns = "point surface",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 3, 2); AbsPoint D(4, 3, 1); \
               Line l(A, B); Line m(C, D); RuledSurf S(l, m); AbsPoint P(1, 2, 4); ProxMagnet m1(P, S);"
)]
pub struct ProxMagnet<T: Real> {
    /// The given point.
    point: Point<T>,
    /// The surface.
    surface: Onto<T>,
}

impl<T: Real> Build<T> for ProxMagnet<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let place = foot(&self.surface, self.point.xyz, true)?;
        magnet(self.surface, place)
    }
}

/// The intersection of a curve with a surface, as a point of the surface: C(t) = S(u, v).
///
/// The bead names the curve and a start t, the magnet the surface and a start (u, v).
#[derive(Kind)]
#[kind(
    class = Magnet,
    columns = "curve surface",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 3, 2); AbsPoint D(4, 3, 1); \
               Line l(A, B); Line m(C, D); RuledSurf S(l, m); AbsPoint P(1, 2, 4); AbsPoint Q(2, 1, -3); \
               Line n(P, Q); IntMagnet hit(n, S);"
)]
pub struct IntMagnet<T: Real> {
    /// The curve, or a bead on it.
    curve: Along<T>,
    /// The surface, or a magnet on it.
    surface: Onto<T>,
}

impl<T: Real> Build<T> for IntMagnet<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let (_, found, uv) =
            piercing(&self.curve, &self.surface).map_err(|fault| fault.in_field(Self::SURFACE))?;
        magnet(self.surface, (uv, found))
    }
}

/// The point of a surface with two given coordinates.
#[derive(Kind)]
#[kind(
    class = Magnet,
    columns = "surface axis1 value1 axis2 value2",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 3, 2); AbsPoint D(4, 3, 1); \
               Line l(A, B); Line m(C, D); RuledSurf S(l, m); XYZMagnet m1(S, \"x\", 1, \"z\", 0.75);"
)]
pub struct XYZMagnet<T: Real> {
    /// The surface, or a magnet on it near the intended point.
    surface: Onto<T>,
    /// The first coordinate: "x", "y" or "z".
    axis1: Arc<str>,
    /// Value of the first coordinate.
    value1: T,
    /// The second coordinate, different from the first.
    axis2: Arc<str>,
    /// Value of the second coordinate.
    value2: T,
}

impl<T: Real> Build<T> for XYZMagnet<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let (a, b) =
            (axis_number(&self.axis1, Self::AXIS1)?, axis_number(&self.axis2, Self::AXIS2)?);
        if a == b {
            return Err(CallError::new("same-axis", "the two coordinates are the same one")
                .expected("two different axes")
                .found(format!("\"{}\" twice", self.axis1))
                .in_field(Self::AXIS2));
        }
        let mut p = [T::zero(); 3];
        (p[a], p[b]) = (self.value1, self.value2);
        let mut d = [T::zero(); 3];
        d[3 - a - b] = T::one();
        // From the middle of the surface, which selects the middle one of several.
        p[3 - a - b] = T::from(
            self.surface.surface.jet(T::from(0.5), T::from(0.5), Order::Zero).p.re()[3 - a - b],
        );
        let place = on_ray(&self.surface, Vec3::from(p), Rays::Along(Vec3::from(d)))
            .map_err(|fault| fault.in_field(Self::VALUE1))?;
        magnet(self.surface, place)
    }
}

/// The point of a surface near another magnet, at distances measured in its tangent plane: the foot
/// on the surface of S + a e1 + b e2, with e1 the direction of S_u and e2 the one perpendicular to
/// it towards S_v.
#[derive(Kind)]
#[kind(
    class = Magnet,
    columns = "magnet a b",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 3, 2); AbsPoint D(4, 3, 1); \
               Line l(A, B); Line m(C, D); RuledSurf S(l, m); AbsMagnet p(S, 0.5, 0.5); \
               TanMagnet q(p, 0.5, -0.25);"
)]
pub struct TanMagnet<T: Real> {
    /// Reference magnet.
    magnet: crate::arguments::Magnet<T>,
    /// Distance along u.
    #[field(default = 0)]
    a: T,
    /// Distance across.
    #[field(default = 0)]
    b: T,
}

impl<T: Real> Build<T> for TanMagnet<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let crate::arguments::Magnet { surface, uv: [u, v], .. } = self.magnet;
        let j = surface.jet(u, v, Order::First);
        let singular = || {
            CallError::new("singular-normal", "the surface has no tangent plane at the magnet")
                .expected("a magnet away from poles and cusps")
                .found(format!("(u, v) = ({}, {})", u.re(), v.re()))
                .in_field(Self::MAGNET)
        };
        let e1 = j.u.normalized().ok_or_else(singular)?;
        let e2 = (j.v - e1 * e1.dot(j.v)).normalized().ok_or_else(singular)?;
        let target = j.p + e1 * self.a + e2 * self.b;
        let onto = Onto { surface, start: Some([u, v]) };
        let place = foot(&onto, target, false)?;
        magnet(onto, place)
    }
}
