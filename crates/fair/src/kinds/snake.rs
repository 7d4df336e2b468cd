//! `FairSnake`: a fair curve in the parameters of a surface.

use super::shapes::{self, SplineOnSurface};
use super::{ArgumentFields, Intent, PointRole, end, faithful, fault, measure};
use moldloft_num::{Real, Vec3};
use moldloft_registry::{
    Build, CallError, Class, Context, CurveRef, FromValue, Kind, Point, SurfaceRef, Value,
};
use std::sync::Arc;

/// A point on a surface.
struct SurfacePoint<T: Real> {
    point: Point<T>,
    surface: SurfaceRef<T>,
    uv: [T; 2],
}

impl<T: Real> FromValue<T> for SurfacePoint<T> {
    const CLASS: Class = Class::Magnet;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        if let Value::Point(p) = value
            && let Some(place) = &p.on_surface
        {
            return Ok(Self { point: (**p).clone(), surface: place.0.clone(), uv: place.1 });
        }
        Err(CallError::wrong_class(Class::Magnet, value.class()))
    }
}

/// A fair curve on a surface: its path in the parameter plane is faired within a tolerance.
///
/// The path passes through the magnets' parameters before it is faired; the tolerance is a
/// distance in the parameter plane, and so are its members. See `FairCurve`.
#[derive(Kind)]
#[kind(
    class = Snake,
    example = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 0, 3); AbsPoint D(4, 1, 3); \
               Line l(A, B); Line m(C, D); RuledSurf S(l, m); AbsMagnet p(S, 0, 0.2); \
               AbsMagnet q(S, 0.3, 0.32); AbsMagnet r(S, 0.5, 0.29); AbsMagnet s(S, 0.7, 0.33); \
               AbsMagnet t(S, 1, 0.2); FairSnake f({p, q, r, s, t}, 0.02);"
)]
pub struct FairSnake<T: Real> {
    /// Magnets of one surface, at least degree + 2 of them.
    #[field(min_items = 3)]
    magnets: Vec<SurfacePoint<T>>,
    /// Largest distance from the path through the magnets, in u and v.
    #[field(min = 0)]
    tolerance: T,
    /// The measure to minimise; see `FairCurve`.
    #[field(default = "second")]
    measure: Arc<str>,
    /// Kept at the ends: "position", "tangent" or "curvature".
    #[field(default = "tangent")]
    ends: Arc<str>,
    /// "optimum" or "faithful".
    #[field(default = "optimum")]
    mode: Arc<str>,
    /// Polynomial degree of the path.
    #[field(default = 3, min = 2, max = 9)]
    degree: usize,
}

impl<T: Real> Build<T> for FairSnake<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let [first, .., last] = self.magnets.as_slice() else {
            return Err(
                CallError::new("too-few-items", "a snake needs magnets").in_field(Self::MAGNETS)
            );
        };
        let surface = first.surface.clone();
        for (k, magnet) in self.magnets.iter().enumerate() {
            let named = surface.key.is_some() || magnet.surface.key.is_some();
            let same = if named {
                surface.key == magnet.surface.key
            } else {
                surface.same(&magnet.surface)
            };
            if !same {
                let message = format!("magnet {} is on another surface than magnet 1", k + 1);
                return Err(CallError::new("wrong-surface", message)
                    .expected("magnets of one surface")
                    .found("two different surfaces")
                    .related(magnet.point.key, "is on another surface")
                    .in_item(k)
                    .in_field(Self::MAGNETS));
            }
        }
        let end = match end(&self.ends, Self::ENDS)? {
            crate::EndContinuity::Free => crate::EndContinuity::Position,
            kept => kept,
        };
        let intent = Intent {
            tolerance: self.tolerance,
            degree: self.degree,
            closed: false,
            role: PointRole::Fit,
            measure: measure(&self.measure, Self::MEASURE)?,
            faithful: faithful(&self.mode, Self::MODE)?,
            end,
            breaks: Vec::new(),
            joins: [None; 2],
            own: super::GivenKnots::default(),
            spacing: crate::ParameterSpacing::Chord,
            turning: false,
            goal: crate::Goal::Near(super::BUDGET),
            motion: crate::Motion::Ball,
        };
        let places = ArgumentFields {
            points: Self::MAGNETS,
            tolerance: Self::TOLERANCE,
            degree: Self::DEGREE,
            breaks: Self::MAGNETS,
        };
        let path: Vec<_> =
            self.magnets.iter().map(|m| Vec3::new(m.uv[0], m.uv[1], T::zero())).collect();
        let ends = [first.point.key, last.point.key];
        if !intent.faithful {
            let (path, figures) = intent
                .near(&path, &super::demands::Demands::none())
                .map_err(|e| fault(e, &places))?;
            let shape = SplineOnSurface { surface: surface.clone(), path, ends };
            let snake = CurveRef::snake(shape, surface, context.nesting);
            return Ok(Value::Curve(snake.with_figures(&figures.members())));
        }
        let (space, control, figures) = intent.spline(&path).map_err(|e| fault(e, &places))?;
        let path = shapes::curve(&space, &control)
            .map_err(|e| CallError::new("no-spline", e.to_string()).in_field(Self::MAGNETS))?;
        let shape = SplineOnSurface { surface: surface.clone(), path, ends };
        let snake = CurveRef::snake(shape, surface, context.nesting);
        Ok(Value::Curve(snake.with_figures(&figures.members_of_moves())))
    }
}
