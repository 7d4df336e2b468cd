//! `FairSnake`: a fair curve in the parameters of a surface.

use super::demands::{Demands, one_each, shapes_of};
use super::shapes::{self, SplineOnSurface};
use super::{ArgumentFields, Intent, PointRole, end, faithful, fault, measure};
use crate::FairError;
use moldloft_num::{Real, Vec3};
use moldloft_registry::{
    Build, CallError, Class, Context, CurveRef, FieldId, FromValue, Kind, Point, SurfaceRef, Value,
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
    /// How magnets get their parameters along the path, as for `FairCurve`: "chord", "centripetal", "x" (u) or
    /// "y" (v) where it rises, or "curvature".
    #[field(default = "chord")]
    spacing: Arc<str>,
    /// Which of the paths within the tolerance; see `FairCurve`.
    #[field(default = "near")]
    goal: Arc<str>,
    /// The share of the goals "near" and "budget" (0.8) and "nearest" (0.1), or the measure of "energy".
    #[field(default)]
    share: Option<T>,
    /// Numbers of magnets, from 1, that are intended breaks: the path has corners there.
    #[field(default)]
    breaks: Option<Vec<usize>>,
    /// The shape that the path has in the parameter plane; see `FairCurve`. No derivatives.
    #[field(default)]
    shape: Option<Vec<Arc<str>>>,
    /// Tolerances of the magnets one by one, instead of `tolerance`.
    #[field(default)]
    tolerances: Option<Vec<T>>,
    /// Numbers of magnets, from 1, through which the path passes.
    #[field(default)]
    fixed: Option<Vec<usize>>,
    /// Numbers of magnets, from 1, that are wrong: the path may leave them.
    #[field(default)]
    release: Option<Vec<usize>>,
    /// 0 to have no more inflections in the parameter plane than the path of least bending within the
    /// tolerances; no derivatives then.
    #[field(default = 1, min = 0, max = 1)]
    bends: usize,
}

impl<T: Real> FairSnake<T> {
    /// What is asked of a path near its magnets.
    fn demands(&self) -> Result<Demands<T>, CallError> {
        let n = self.magnets.len();
        one_each("tolerances", self.tolerances.as_deref(), n, Self::TOLERANCES)?;
        Ok(Demands {
            shape: shapes_of(self.shape.as_deref(), n, Self::SHAPE)?,
            conditions: Vec::new(),
            tolerances: self.tolerances.clone(),
            fixed: self.fixed.clone().unwrap_or_default(),
            release: self.release.clone().unwrap_or_default(),
            bends: self.bends == 1,
            at: None,
        })
    }

    /// The first of what the mode "faithful" has not that is given.
    fn near_only(&self) -> Option<(&'static str, FieldId)> {
        let given = [
            (&*self.spacing != "chord", "spacing", Self::SPACING),
            (&*self.goal != "near", "goal", Self::GOAL),
            (self.share.is_some(), "share", Self::SHARE),
            (self.shape.is_some(), "shape", Self::SHAPE),
            (self.tolerances.is_some(), "tolerances", Self::TOLERANCES),
            (self.fixed.is_some(), "fixed", Self::FIXED),
            (self.release.is_some(), "release", Self::RELEASE),
            (self.bends == 0, "bends", Self::BENDS),
        ];
        given.into_iter().find(|g| g.0).map(|g| (g.1, g.2))
    }
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
        let turning = &*self.spacing == "curvature";
        let intent = Intent {
            tolerance: self.tolerance,
            degree: self.degree,
            closed: false,
            role: PointRole::Fit,
            measure: measure(&self.measure, Self::MEASURE)?,
            faithful: faithful(&self.mode, Self::MODE)?,
            end,
            breaks: self.breaks.clone().unwrap_or_default(),
            joins: [None; 2],
            own: super::GivenKnots::default(),
            spacing: super::spacing(if turning { "chord" } else { &self.spacing }, Self::SPACING)?,
            turning,
            goal: super::goal_of(
                &self.goal,
                self.share.map(|s| s.re()),
                super::BUDGET,
                [Self::GOAL, Self::SHARE],
            )?,
            motion: crate::Motion::Ball,
        };
        if matches!(intent.spacing, crate::ParameterSpacing::Uniform) {
            let known = ["chord", "centripetal", "x", "y", "curvature"];
            return Err(super::unknown("spacing", &self.spacing, &known, Self::SPACING));
        }
        let demands = self.demands()?;
        if let Some((what, field)) = self.near_only().filter(|_| intent.faithful) {
            return Err(CallError::new("not-near", format!("`{what}` is for the optimum"))
                .expected("mode = \"optimum\"")
                .in_field(field));
        }
        let places = ArgumentFields {
            points: Self::MAGNETS,
            tolerance: Self::TOLERANCE,
            degree: Self::DEGREE,
            breaks: Self::BREAKS,
        };
        let about = |e: FairError| match e {
            FairError::Goal(why) => CallError::new("no-goal", why).in_field(Self::GOAL),
            FairError::Energy { .. } => {
                CallError::new("no-goal", e.to_string()).in_field(Self::SHARE)
            }
            FairError::TurnsAlong { index } => {
                CallError::new("runs-back", e.to_string()).in_item(index).in_field(Self::SPACING)
            }
            FairError::Shape { ref shapes, .. } => {
                let fault = CallError::new("no-shape", e.to_string());
                shapes.first().map_or(fault.clone(), |&k| fault.in_item(k)).in_field(Self::SHAPE)
            }
            FairError::Shapeless { shape, why } => {
                CallError::new("no-shape", why).in_item(shape).in_field(Self::SHAPE)
            }
            other => fault(other, &places),
        };
        let path: Vec<_> =
            self.magnets.iter().map(|m| Vec3::new(m.uv[0], m.uv[1], T::zero())).collect();
        let ends = [first.point.key, last.point.key];
        if !intent.faithful {
            let (path, figures) = intent.near(&path, &demands).map_err(about)?;
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
