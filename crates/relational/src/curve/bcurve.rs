//! B-spline curves.

use crate::curve::Ended;
use crate::curve::ended::polyline;
use crate::faults;
use moldloft_num::Real;
use moldloft_num::trace::Trace;
use moldloft_registry::{Build, CallError, Context, CurveRef, FieldId, Kind, Point, Value};
use moldloft_spline::BSplineCurve;

/// A B-spline curve: C(t) = sum N_i(t) P_i with clamped uniform knots (de Boor 1978).
///
/// It begins at the first point and ends at the last, tangent to the polygon there, and is only
/// attracted by the others. With N points the degree is at most N - 1: a higher one is lowered to
/// that.
#[derive(Kind)]
#[kind(
    class = Curve,
    columns = "relabel degree points",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); AbsPoint D(4, 0, 1); \
               BCurve c({A, B, C, D}, degree = 2);"
)]
pub struct BCurve<T: Real> {
    /// Control points, two or more.
    #[field(min_items = 2)]
    points: Vec<Point<T>>,
    /// Polynomial degree: 1 is a polyline, 2 quadratic, 3 cubic.
    #[field(default = 3, min = 1, max = 25)]
    degree: usize,
}

impl<T: Real> Build<T> for BCurve<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Self { points, degree } = self;
        let ends = ends(&points, Self::POINTS)?;
        let degree = degree.min(points.len() - 1);
        let curve = BSplineCurve::uniform(degree, points.iter().map(|p| p.xyz).collect())
            .map_err(|error| faults::of_spline(error, Self::POINTS, Self::DEGREE))?;
        let sides = points.len() - 1;
        let shares = (1..=sides).map(|k| T::from(k as f64 / sides as f64)).collect();
        let trace = match degree {
            1 => polyline(&points, shares),
            _ => Trace::Own(ends),
        };
        Ok(Value::Curve(match curve.power_form() {
            Some(curve) => CurveRef::new(Ended { curve, trace }, 0),
            None => CurveRef::new(Ended { curve, trace }, 0),
        }))
    }
}

/// The objects of the first and the last point.
pub(crate) fn ends<T: Real>(
    points: &[Point<T>],
    field: FieldId,
) -> Result<[Option<moldloft_num::trace::Key>; 2], CallError> {
    match points {
        [first, .., last] => Ok([first.key, last.key]),
        _ => Err(CallError::new("too-few-items", "a curve needs at least 2 points")
            .expected("at least 2 points")
            .found(points.len().to_string())
            .in_field(field)),
    }
}
