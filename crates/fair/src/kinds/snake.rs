//! `FairSnake`: a fair curve on a surface.

use super::faired::{CurveContext, FairedSpline};
use super::options::{curve_options, shared_options};
use super::shapes::SplineOnSurface;
use crate::EndContinuity;
use moldloft_num::{Real, Vec3};
use moldloft_registry::{
    Build, CallError, Class, Context, CurveRef, FromValue, Kind, Point, SurfaceRef, Value,
};
use std::sync::Arc;

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

shared_options! {
    {
        /// A fair curve on a surface near magnets: its path in the parameter plane is faired.
        ///
        /// The tolerance and the members are distances in the parameter plane. The options are
        /// those of `FairCurve`, applied to the path: directions are {u, v, 0}, "x" is u and "y" is
        /// v. There are no `joins` and no `keep`, which refer to space.
        #[derive(Kind)]
        #[kind(
            forward,
            class = Snake,
            example = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 0, 3); AbsPoint D(4, 1, 3); \
                       Line l(A, B); Line m(C, D); RuledSurf S(l, m); AbsMagnet p(S, 0, 0.2); \
                       AbsMagnet q(S, 0.3, 0.32); AbsMagnet r(S, 0.5, 0.29); AbsMagnet s(S, 0.7, 0.33); \
                       AbsMagnet t(S, 1, 0.2); FairSnake f({p, q, r, s, t}, 0.02);"
        )]
        pub struct FairSnake<T: Real>
    }
    {
        /// Magnets on one surface, at least degree + 2 (closed: 2 degree + 2).
        #[field(min_items = 3)]
        magnets: Vec<SurfacePoint<T>>,
        /// Largest distance of each magnet from the path, in u and v; 0: interpolation.
        #[field(min = 0)]
        tolerance: T,
        /// Measure to minimise; see `FairCurve`.
        #[field(default)]
        measure: Option<Arc<str>>,
        /// Condition at the ends: "position", "tangent" or "curvature". Default: "position".
        #[field(default)]
        ends: Option<Arc<str>>,
        /// "optimum", or a stepwise mode; see `FairCurve`.
        #[field(default = "optimum")]
        mode: Arc<str>,
        /// Polynomial degree of the path.
        #[field(default = 3, min = 2, max = 9)]
        degree: usize,
        /// Parametrisation of the magnets along the path, as for `FairCurve`: "chord",
        /// "centripetal", "x" (u) or "y" (v) if monotone, "index" or "curvature". "auto" is
        /// "chord", with control points "index".
        #[field(default = "auto")]
        spacing: Arc<str>,
    }
    [goal] [share]
    {
        /// Numbers of magnets, from 1, that are intended breaks: they do not move, and the path has
        /// corners there.
        #[field(default)]
        breaks: Option<Vec<usize>>,
    }
    [curve] [along] [knots]
    {
        /// Magnets on the path at `through_at`. No derivatives.
        #[field(default)]
        through: Option<Vec<SurfacePoint<T>>>,
        /// Role of the magnets; see `FairCurve`.
        #[field(default)]
        r#as: Option<Arc<str>>,
        /// 1: closed path; the first magnet is not repeated.
        #[field(default = 0, min = 0, max = 1)]
        closed: usize,
    }
}

const SPACINGS: [&str; 7] = ["auto", "chord", "centripetal", "x", "y", "index", "curvature"];

impl<T: Real> FairSnake<T> {
    /// Refuses magnets on another surface.
    fn check_surface(
        &self,
        magnets: &[SurfacePoint<T>],
        field: moldloft_registry::FieldId,
    ) -> Result<(), CallError> {
        let Some(first) = self.magnets.first() else { return Ok(()) };
        let surface = &first.surface;
        for (k, magnet) in magnets.iter().enumerate() {
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
                    .in_field(field));
            }
        }
        Ok(())
    }

    /// Refuses directions with a z component.
    fn check_plane(&self) -> Result<(), CallError> {
        let tangents = self.tangents.iter().flatten().map(|d| (d, Self::TANGENTS));
        let all = self.along.iter().map(|d| (d, Self::ALONG)).chain(tangents);
        for (direction, field) in all {
            if direction.z.re() != 0.0 {
                return Err(CallError::new(
                    "zero-direction",
                    "a direction leaves the parameter plane",
                )
                .expected("{u, v, 0}")
                .found(format!("z = {}", direction.z.re()))
                .in_field(field));
            }
        }
        Ok(())
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
        self.check_surface(&self.magnets, Self::MAGNETS)?;
        self.check_surface(self.through.as_deref().unwrap_or_default(), Self::THROUGH)?;
        self.check_plane()?;
        let options = curve_options!(self, MAGNETS);
        let place = |m: &SurfacePoint<T>| Vec3::new(m.uv[0], m.uv[1], T::zero());
        let path: Vec<_> = self.magnets.iter().map(place).collect();
        let asked = CurveContext {
            joins: [None; 2],
            through: self.through.iter().flatten().map(place).collect(),
            keep: Vec::new(),
            keep_field: Self::MAGNETS,
            least_end: Some(EndContinuity::Position),
            budget: super::BUDGET,
            turns: false,
            spacings: &SPACINGS,
        };
        let FairedSpline { curve, members, kept } = options.faired(&path, asked, |_| None)?;
        let end = |at: usize, magnet: &SurfacePoint<T>| magnet.point.key.filter(|_| kept[at]);
        let ends = [end(0, first), end(1, last)];
        let shape = SplineOnSurface { surface: surface.clone(), path: curve, ends };
        let snake = CurveRef::snake(shape, surface, context.nesting);
        Ok(Value::Curve(snake.with_figures(&members)))
    }
}
