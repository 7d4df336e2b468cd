//! Explicit splines: two coordinates as functions of the third.

use super::{Ended, bcurve};
use crate::arguments::{AxisName, EndRule};
use crate::faults;
use moldloft_num::Real;
use moldloft_registry::{Build, CallError, Context, CurveRef, Kind, Point, Value};
use moldloft_spline::{InterpolatingSpline, InterpolationError};

/// An explicit spline: one coordinate is linear in t; the other two are cubic splines of that
/// coordinate through the points.
///
/// That coordinate increases or decreases strictly from point to point.
#[derive(Kind)]
#[kind(
    class = Curve,
    columns = "relabel axis points",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); AbsPoint D(4, 0, 1); \
               XCurve c(\"x\", {A, B, C, D}); XCurve d(1, {D, C, B, A}, ends = \"natural\");"
)]
pub struct XCurve<T: Real> {
    /// Coordinate linear in t: "x", "y" or "z", or 1, 2 or 3.
    axis: AxisName,
    /// The points it passes through, two or more.
    #[field(min_items = 2)]
    points: Vec<Point<T>>,
    /// End conditions: "notaknot", "natural", "bessel", "quadratic" or "periodic".
    #[field(default = "notaknot")]
    ends: EndRule,
}

impl<T: Real> Build<T> for XCurve<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let names = bcurve::ends(&self.points, Self::POINTS)?;
        let AxisName(axis) = self.axis;
        let points: Vec<_> = self.points.iter().map(|p| p.xyz).collect();
        let (first, last) = (points[0][axis], points[points.len() - 1][axis]);
        let rising = last.re() > first.re();
        // Written so that NaN is refused.
        let runs_on = |k: &usize| {
            let step = (points[*k][axis] - points[k - 1][axis]).re();
            if rising { step > 0.0 } else { step < 0.0 }
        };
        if let Some(k) = (1..points.len()).find(|k| !runs_on(k)) {
            let name = ["x", "y", "z"][axis];
            let message = format!("{name} is not monotone from point {k} to point {}", k + 1);
            return Err(CallError::new("not-monotone", message)
                .expected(format!("{name} ascending from point to point, or descending"))
                .found(format!("{} after {}", points[k][axis].re(), points[k - 1][axis].re()))
                .in_item(k)
                .in_field(Self::POINTS));
        }
        let Some(ends) = self.ends.ends() else {
            return Err(CallError::new("unknown-ends", "an explicit spline cannot be clamped")
                .expected("\"notaknot\", \"natural\", \"bessel\", \"quadratic\" or \"periodic\"")
                .found("\"clamped\"")
                .in_field(Self::ENDS));
        };
        let mut knots: Vec<T> = points.iter().map(|p| (p[axis] - first) / (last - first)).collect();
        knots[0] = T::zero();
        knots[points.len() - 1] = T::one();
        let curve = InterpolatingSpline::with_knots(&knots, &points, ends).map_err(|error| {
            let fault =
                faults::of_interpolation(error, "point", [Self::POINTS, Self::AXIS, Self::ENDS]);
            match error {
                InterpolationError::NotClosed { .. } => fault.help(
                    "an explicit spline cannot be closed: its coordinate along the axis is monotonic",
                ),
                _ => fault,
            }
        })?;
        Ok(Value::Curve(CurveRef::new(Ended::between(curve, names), 0)))
    }
}
