//! The functions `fair`, `jumps` and `curvature`.

use super::direct::{CurveMethod, DirectCurve};
use super::{ArgumentFields, Intent, PointRole, faithful, fault, measure};
use crate::{FairError, KnotRemovalOptions, Space};
use moldloft_num::{Order, Real, Vec3};
use moldloft_registry::{Array, Build, CallError, Context, CurveRef, Kind, Value, Vectors};
use std::sync::Arc;

/// Faired points, each within a tolerance of the original.
///
/// The points are faired as control points of a uniform cubic; on uniform points this is the same
/// as fairing the interpolated points, because interpolation and fourth differences commute. Open
/// rows keep their first and last two points. Points on a line, conic, plane cubic or helix do not
/// move.
#[derive(Kind)]
#[kind(
    forward,
    class = Vectors,
    function,
    name = "fair",
    example = "Line l({0, 0, 0}, {1, 0, 0}); curve p = distc(l, uniform(0, 1, 9)); \
               curve q = fair(p, 0.01);"
)]
pub struct Fair<T: Real> {
    /// Points, at least 5 (closed: 8).
    #[field(min_items = 5)]
    points: Vec<Vec3<T>>,
    /// Largest move of each point, in units of length; 0: unchanged.
    #[field(min = 0)]
    tolerance: T,
    /// Measure to minimise; see `FairCurve`.
    #[field(default = "second")]
    measure: Arc<str>,
    /// "optimum" or "faithful"; see `FairCurve`.
    #[field(default = "optimum")]
    mode: Arc<str>,
    /// 1: closed row; the first point is not repeated.
    #[field(default = 0, min = 0, max = 1)]
    closed: usize,
}

impl<T: Real> Build<T> for Fair<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let method = if faithful(&self.mode, Self::MODE)? {
            CurveMethod::Steps(KnotRemovalOptions::faithful(0), None)
        } else {
            CurveMethod::Optimum
        };
        let intent = Intent {
            tolerance: self.tolerance,
            degree: 3,
            closed: self.closed == 1,
            measure: Some(measure(&self.measure, Self::MEASURE)?),
            ends: [Some(crate::EndContinuity::Points(2)); 2],
            breaks: Vec::new(),
            spacing: crate::ParameterSpacing::Uniform,
            goal: crate::Goal::Near(super::BUDGET),
            motion: crate::Motion::Ball,
        };
        let curve = DirectCurve {
            intent,
            role: PointRole::Points,
            method,
            bound: None,
            joins: [None; 2],
            own: super::GivenKnots::default(),
            count: None,
            tolerances: None,
            fixed: Vec::new(),
            conditions: Vec::new(),
        };
        let places = ArgumentFields {
            points: Self::POINTS,
            tolerance: Self::TOLERANCE,
            degree: Self::POINTS,
            breaks: Self::POINTS,
        };
        let plain: Vec<Vec3<f64>> = self.points.iter().map(|p| p.re()).collect();
        if curve.stays(&plain, &[]) {
            return Ok(Value::Vectors(Arc::new(Vectors::row(self.points))));
        }
        let faired = curve.faired_points(&self.points).map_err(|e| fault(e, &places))?;
        Ok(Value::Vectors(Arc::new(Vectors::row(faired))))
    }
}

/// Jumps of the third derivative of the uniform cubic with given control points, a measure of
/// unfairness: `|d[i-2] - 4 d[i-1] + 6 d[i] - 4 d[i+1] + d[i+2]|` at each knot.
///
/// An open row of n points has n - 4 jumps, a closed one n.
#[derive(Kind)]
#[kind(
    forward,
    class = Numbers,
    function,
    name = "jumps",
    example = "Line l({0, 0, 0}, {1, 0, 0}); curve p = distc(l, uniform(0, 1, 9)); \
               farray e = jumps(p);"
)]
pub struct Jumps<T: Real> {
    /// Control points, at least 5 (closed: 8).
    #[field(min_items = 5)]
    points: Vec<Vec3<T>>,
    /// 1: closed row; the first point is not repeated.
    #[field(default = 0, min = 0, max = 1)]
    closed: usize,
}

impl<T: Real> Build<T> for Jumps<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let n = self.points.len();
        let space = match (self.closed, n) {
            (1, _) => Space::closed(3, n),
            (_, ..5) => Err(FairError::TooFew { expected: 5, actual: n }),
            _ => Space::floating(3, n),
        };
        let places = ArgumentFields {
            points: Self::POINTS,
            tolerance: Self::POINTS,
            degree: Self::POINTS,
            breaks: Self::POINTS,
        };
        let jumps = crate::KnotJumps::of(&space.map_err(|e| fault(e, &places))?);
        let length = |k: usize| {
            let (columns, factors) = jumps.rows.row(k);
            let entries = columns.iter().zip(factors);
            let sum: Vec3<T> = entries
                .fold(Vec3::zero(), |s, (&c, &a)| s + self.points[c as usize].map(|x| x * a));
            // The length of a zero jump is not differentiable; its derivative is set to zero.
            if sum.norm_sq().re() == 0.0 { T::zero() } else { sum.norm() }
        };
        let row = (0..jumps.rows.len()).map(length).collect();
        Ok(Value::Numbers(Arc::new(Array::row(row))))
    }
}

/// Curvature |C' x C''| / |C'|^3 of a curve at a parameter or an array of parameters.
#[derive(Kind)]
#[kind(
    forward,
    class = Any,
    function,
    name = "curvature",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 0, 0); BCurve c({A, B, C}); \
               float k = curvature(c, 0.5);"
)]
pub struct Curvature<T: Real> {
    /// The curve.
    curve: CurveRef<T>,
    /// A parameter, from 0 to 1, or an array of them.
    t: Value<T>,
}

impl<T: Real> Build<T> for Curvature<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let at = |t: T| {
            let [_, d1, d2] = self.curve.jet(t, Order::Second);
            let speed = d1.norm();
            if speed.re() == 0.0 {
                return Err(CallError::new(
                    "stands-still",
                    format!("zero tangent at t = {}", t.re()),
                )
                .expected("a parameter with a non-zero tangent")
                .in_field(Self::T));
            }
            let cross = d1.cross(d2);
            // On a straight part the norm is not differentiable; its derivative is set to zero.
            let bend = if cross.norm_sq().re() == 0.0 { T::zero() } else { cross.norm() };
            Ok(bend / (speed * speed * speed))
        };
        match &self.t {
            Value::Number(t) => at(*t).map(Value::Number),
            Value::Numbers(a) => {
                let items: Result<_, _> = a.items.iter().map(|&t| at(t)).collect();
                Ok(Value::Numbers(Arc::new(Array { shape: a.shape, items: items? })))
            }
            other => Err(CallError::wrong_class(moldloft_registry::Class::Number, other.class())
                .expected("a number or an farray")
                .in_field(Self::T)),
        }
    }
}
