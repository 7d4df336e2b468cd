//! Points found on curves, and on snakes.

use super::arguments::{Along, AlongSnake, Target};
use super::equations::{Between, FootOnCurve, LevelOf, OnLevel, Pierced};
use super::magnets::BESIDE;
use super::outcome::{diverged, found, no_intersection, tangent};
use moldloft_locate::curve_pairs::curve_curve;
use moldloft_locate::implicit::refined;
use moldloft_locate::roots::{curve_level, curve_surface};
use moldloft_locate::{
    LocateStatus, PlainCurve, PlainSurface, nearest_on_curve, nearest_on_surface,
};
use moldloft_num::period::corner_rate;
use moldloft_num::{Order, Plane, Real, Vec3};
use moldloft_registry::{Build, CallError, Context, FieldId, Kind, Point, SearchReport, Value};
use std::sync::Arc;

const ANOTHER: &str = "to choose another one, give a bead near it instead of the curve";

fn bead<T: Real>(along: Along<T>, (t, found): (T, SearchReport)) -> Result<Value<T>, CallError> {
    Ok(Value::Point(Box::new(Point::on_curve(along.curve, t).with_found(found))))
}

/// The parameter at which the curve crosses a level.
fn on_level<T: Real>(
    along: &Along<T>,
    level: LevelOf<T>,
    name: &str,
) -> Result<(T, SearchReport), CallError> {
    let plain = PlainCurve(&*along.curve);
    let field = level.plain_field();
    let solution = curve_level(&plain, &level.plain(&field), along.start)
        .map_err(|report| no_intersection(&report, "curve", name))?;
    let system = OnLevel { curve: &along.curve, level };
    let [t] = refined(&system, solution.at, T::zero()).ok_or_else(tangent)?;
    Ok((t, found(&solution.report, ANOTHER)))
}

/// The parameter at which the curve meets the target.
pub(super) fn crossing<T: Real>(
    along: &Along<T>,
    target: &Target<T>,
    point: Option<Vec3<T>>,
    field: FieldId,
    context: &Context,
) -> Result<(T, SearchReport), CallError> {
    match target {
        Target::Plane(plane) => {
            let point = point.unwrap_or(plane.point);
            on_level(along, LevelOf::Plane(Plane { point, normal: plane.normal }), "plane")
        }
        Target::Point(centre) => {
            let Some(point) = point else {
                return Err(CallError::new(
                    "missing-argument",
                    "a sphere about a point needs a radius",
                )
                .expected("a point on the sphere")
                .found("nothing")
                .in_field(field));
            };
            let radius = (point - *centre).norm();
            if radius.re() <= 0.0 {
                return Err(CallError::new("coincident-points", "the sphere has no radius")
                    .expected("a point away from the centre")
                    .found("the centre itself")
                    .in_field(field));
            }
            on_level(along, LevelOf::Sphere { centre: *centre, radius }, "sphere")
        }
        Target::Field(field) => on_level(along, LevelOf::Field(field.clone()), "field"),
        Target::Surface(onto) => {
            let (t, found, _) = piercing(along, onto)?;
            Ok((t, found))
        }
        Target::Curve(other) => {
            let (a, b) = (PlainCurve(&*along.curve), PlainCurve(&*other.curve));
            let here =
                |c: &PlainCurve<'_, T>, t: f64| moldloft_num::Curve::jet(c, t, Order::Zero)[0];
            let start = match (along.start, other.start) {
                (Some(t), Some(s)) => Some([t, s]),
                (Some(t), None) => Some([t, nearest_on_curve(&b, here(&a, t), None).at[0]]),
                (None, Some(s)) => Some([nearest_on_curve(&a, here(&b, s), None).at[0], s]),
                (None, None) => None,
            };
            let solution = curve_curve(&a, &b, start, context.tolerance)
                .map_err(|report| no_intersection(&report, "curve", "other curve"))?;
            let system = Between { a: &along.curve, b: &other.curve };
            let [t, _] = refined(&system, solution.at, T::zero()).ok_or_else(tangent)?;
            Ok((t, found(&solution.report, ANOTHER)))
        }
    }
}

/// Intersection of a curve with a surface: t, the report, and (u, v).
pub(super) fn piercing<T: Real>(
    along: &Along<T>,
    onto: &super::Onto<T>,
) -> Result<(T, SearchReport, [T; 2]), CallError> {
    let (curve, surface) = (PlainCurve(&*along.curve), PlainSurface(&*onto.surface));
    let start = match (along.start, onto.from()) {
        (Some(t), Some([u, v])) => Some([t, u, v]),
        (Some(t), None) => {
            let x = along.curve.jet(T::from(t), Order::Zero)[0].re();
            let [u, v] = nearest_on_surface(&surface, x, None).at;
            Some([t, u, v])
        }
        (None, Some([u, v])) => {
            let x = onto.surface.jet(T::from(u), T::from(v), Order::Zero).p.re();
            Some([nearest_on_curve(&curve, x, None).at[0], u, v])
        }
        (None, None) => None,
    };
    let solution = curve_surface(&curve, &surface, start)
        .map_err(|report| no_intersection(&report, "curve", "surface"))?;
    let system = Pierced { curve: &along.curve, surface: &onto.surface };
    let [t, u, v] = refined(&system, solution.at, T::zero()).ok_or_else(tangent)?;
    let advice = "to choose another one, give a bead or a magnet near it instead of the curve or \
                  the surface";
    Ok((t, found(&solution.report, advice), [u, v]))
}

/// The foot of a point on a curve. With `ends`, an end counts as a foot.
pub(super) fn foot<T: Real>(
    along: &Along<T>,
    point: Vec3<T>,
    ends: bool,
) -> Result<(T, SearchReport), CallError> {
    let plain = PlainCurve(&*along.curve);
    let start = if ends { None } else { along.start };
    let mut solution = nearest_on_curve(&plain, point.re(), start);
    let clamped = solution.report.status == LocateStatus::EdgeClamped;
    if solution.report.status == LocateStatus::Diverged {
        return Err(diverged(&solution.report));
    }
    if ends && clamped {
        solution.report.status = LocateStatus::Ok;
    }
    let place = solution.at[0];
    let at_end = !along.curve.closed() && (place == 0.0 || place == 1.0);
    let t = if solution.joint[0] {
        let rate = corner_rate::<T>(&*along.curve, place, BESIDE).unwrap_or_else(T::zero);
        T::from(place) + rate
    } else if clamped || at_end && solution.report.residual > 0.0 {
        T::from(place)
    } else {
        let system = FootOnCurve { curve: &along.curve, point };
        refined(&system, solution.at, T::zero()).ok_or_else(tangent)?[0]
    };
    Ok((t, found(&solution.report, ANOTHER)))
}

fn axis_plane<T: Real>(axis: &str, value: T, field: FieldId) -> Result<LevelOf<T>, CallError> {
    let k = axis_number(axis, field)?;
    let mut normal = [0.0; 3];
    normal[k] = 1.0;
    let normal = Vec3::lifted(Vec3::from(normal));
    Ok(LevelOf::Plane(Plane { point: normal * value, normal }))
}

/// 0, 1, 2 for "x", "y", "z".
pub(super) fn axis_number(axis: &str, field: FieldId) -> Result<usize, CallError> {
    ["x", "y", "z"].iter().position(|name| *name == axis).ok_or_else(|| {
        CallError::new("unknown-axis", format!("unknown axis \"{axis}\""))
            .expected("\"x\", \"y\" or \"z\"")
            .found(format!("\"{axis}\""))
            .in_field(field)
    })
}

macro_rules! bead_and_ring {
    (
        $bead:ident, $ring:ident, $what:literal, $columns:literal, $ring_columns:literal,
        [$($(#[doc = $help:literal])* $(#[field($($option:tt)*)])? $field:ident: $type:ty,)*],
        $example:literal, $ring_example:literal, |$along:ident, $this:ident, $context:ident| $body:expr
    ) => {
        #[doc = $what]
        #[derive(Kind)]
        #[kind(class = Bead, columns = $columns, example = $example)]
        pub struct $bead<T: Real> {
            /// The curve, or a bead on it near the intended point.
            curve: Along<T>,
            $($(#[doc = $help])* $(#[field($($option)*)])? $field: $type,)*
        }

        impl<T: Real> Build<T> for $bead<T> {
            fn build(self, $context: &Context) -> Result<Value<T>, CallError> {
                let $along = &self.curve;
                let $this = &self;
                let found = $body?;
                bead(self.curve, found)
            }
        }

        #[doc = $what]
        ///
        /// A ring is such a point on a snake.
        #[derive(Kind)]
        #[kind(class = Ring, columns = $ring_columns, example = $ring_example)]
        pub struct $ring<T: Real> {
            /// The snake, or a ring on it near the intended point.
            snake: AlongSnake<T>,
            $($(#[doc = $help])* $(#[field($($option)*)])? $field: $type,)*
        }

        impl<T: Real> Build<T> for $ring<T> {
            fn build(self, $context: &Context) -> Result<Value<T>, CallError> {
                let $along = &self.snake.0;
                let $this = &self;
                let found = $body?;
                bead(self.snake.0, found)
            }
        }
    };
}

bead_and_ring!(
    IntBead, IntRing,
    "The intersection of a curve with a plane, a surface, another curve or a sphere: C(t) on the \
     target. From a bead it is found by damped Newton iteration; without one it is the \
     intersection nearest to t = 0.5, and the others are reported.",
    "curve target point", "snake target point",
    [
        /// A plane, surface (or magnet), curve (or bead), or the centre of a sphere.
        target: Target<T>,
        /// With a plane: selects the parallel plane through this point. With a centre: a point of
        /// the sphere.
        point: Option<Point<T>>,
    ],
    "AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); AbsPoint D(4, 0, 1); \
     BCurve c({A, B, C, D}); XPlane middle(2); IntBead b(c, middle); AbsBead near(c, 0.1); \
     IntBead d(near, \"y=0\", {0, 1, 0});",
    "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 0, 2); AbsPoint D(4, 1, 3); \
     Line l(A, B); Line m(C, D); RuledSurf S(l, m); UVSnake s(S, \"v\", 0.4); XPlane p(1.5); \
     IntRing r(s, p);",
    |along, this, context| {
        crossing(along, &this.target, this.point.as_ref().map(|p| p.xyz), Self::POINT, context)
            .map_err(|fault| fault.in_field(Self::TARGET))
    }
);

bead_and_ring!(
    XYZBead, XYZRing,
    "The point of a curve with a given coordinate x, y or z. From a bead it is found by damped \
     Newton iteration; without one it is the point nearest to t = 0.5.",
    "curve axis value", "snake axis value",
    [
        /// The coordinate: "x", "y" or "z".
        axis: Arc<str>,
        /// Value of the coordinate.
        value: T,
    ],
    "AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); BCurve c({A, B, C}); \
     XYZBead b(c, \"x\", 1.25);",
    "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 0, 2); AbsPoint D(4, 1, 3); \
     Line l(A, B); Line m(C, D); RuledSurf S(l, m); UVSnake s(S, \"u\", 0.4); \
     XYZRing r(s, \"z\", 1);",
    |along, this, _context| {
        axis_plane(&this.axis, this.value, Self::AXIS)
            .and_then(|level| on_level(along, level, "plane").map_err(|fault| fault.in_field(Self::VALUE)))
    }
);

bead_and_ring!(
    ProjBead, ProjRing,
    "The foot of the perpendicular from a point to a curve: C'(t) . (C(t) - P) = 0, where the distance is \
     least. From a bead it is the foot found by descent; without one, the nearest of all. If the \
     foot is beyond an end, the end is the result and is reported.",
    "point curve", "point snake",
    [
        /// The point to project.
        point: Point<T>,
    ],
    "AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); BCurve c({A, B, C}); \
     AbsPoint P(1, 3, 1); ProjBead b(c, P);",
    "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 0, 2); AbsPoint D(4, 1, 3); \
     Line l(A, B); Line m(C, D); RuledSurf S(l, m); UVSnake s(S, \"u\", 0.4); \
     AbsPoint P(1, 3, 1); ProjRing r(s, P);",
    |along, this, _context| foot(along, this.point.xyz, false)
);

bead_and_ring!(
    ProxBead, ProxRing,
    "The point of a curve nearest to a given point, of the whole curve and ends included. Equally near ones \
     are reported.",
    "point curve", "point snake",
    [
        /// The point to be near to.
        point: Point<T>,
    ],
    "AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); BCurve c({A, B, C}); \
     AbsPoint P(1, 3, 1); ProxBead b(c, P);",
    "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 0, 2); AbsPoint D(4, 1, 3); \
     Line l(A, B); Line m(C, D); RuledSurf S(l, m); UVSnake s(S, \"u\", 0.4); \
     AbsPoint P(1, 3, 1); ProxRing r(s, P);",
    |along, this, _context| foot(along, this.point.xyz, true)
);
