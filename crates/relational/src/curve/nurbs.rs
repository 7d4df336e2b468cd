//! Rational B-spline curves.

use super::{Ended, bcurve};
use moldloft_num::{Real, Vec3};
use moldloft_registry::{Build, CallError, Context, CurveRef, FieldId, Kind, Point, Value};
use moldloft_spline::{KnotError, SplineError, SplineWithKnotDerivatives};

/// A rational B-spline curve: C(t) = sum w_i N_i(t) P_i / sum w_i N_i(t).
///
/// The list contains all knots, end knots included: number of points + degree + 1. Their range is
/// mapped to [0, 1]. By default the knots are clamped and uniform and all weights are 1.
#[derive(Kind)]
#[kind(
    class = Curve,
    columns = "relabel degree knots points weights",
    example = "AbsPoint A(1, 0, 0); AbsPoint B(1, 1, 0.2); AbsPoint C(0, 1, 0); \
               NURBCurve quarter({A, B, C}, 2, weights = {1, 0.7, 1}); \
               NURBCurve c({A, B, C}, 1, {0, 0, 0.45, 1, 1});"
)]
pub struct NURBCurve<T: Real> {
    /// Control points, two or more.
    #[field(min_items = 2)]
    points: Vec<Point<T>>,
    /// Polynomial degree.
    #[field(default = 3, min = 1, max = 25)]
    degree: usize,
    /// Knots, end knots included, ascending.
    knots: Option<Vec<T>>,
    /// Weights of the points, positive.
    weights: Option<Vec<T>>,
}

impl<T: Real> Build<T> for NURBCurve<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let names = bcurve::ends(&self.points, Self::POINTS)?;
        let points = self.points.iter().map(|p| p.xyz).collect();
        let fields = [Self::POINTS, Self::DEGREE, Self::KNOTS, Self::WEIGHTS];
        let curve = spline(points, self.degree, self.knots, self.weights, fields)?;
        let clamped = curve.clamped_ends();
        let ends = [0, 1].map(|k| if clamped[k] { names[k] } else { None });
        Ok(Value::Curve(CurveRef::new(Ended::between(curve, ends), 0)))
    }
}

/// The rational spline of points, degree, knots and weights, which are those of `fields`.
pub fn spline<T: Real>(
    points: Vec<Vec3<T>>,
    degree: usize,
    knots: Option<Vec<T>>,
    weights: Option<Vec<T>>,
    [of, number, list, each]: [FieldId; 4],
) -> Result<SplineWithKnotDerivatives<T>, CallError> {
    // The default degree is lowered for few points; beside explicit knots it is binding.
    let degree = if knots.is_none() { degree.min(points.len() - 1) } else { degree };
    let count = points.len();
    SplineWithKnotDerivatives::new(degree, knots, points, weights).map_err(|error| {
        let fault = CallError::new("no-spline", error.to_string());
        match error {
            SplineError::Knots(KnotError::Degree { degree }) => {
                fault.expected("a degree from 1 to 25").found(degree.to_string()).in_field(number)
            }
            SplineError::Knots(_) | SplineError::Domain { .. } => fault
                .expected(format!("{} ascending knots", count + degree + 1))
                .help(
                    "list all knots: those of the ends as well, degree + 1 times for an end \
                       at a point",
                )
                .in_field(list),
            SplineError::Weight { index, weight } => fault
                .expected("a positive weight")
                .found(weight.to_string())
                .in_item(index)
                .in_field(each),
            SplineError::Count { expected, actual } => fault
                .expected(format!("{expected} weights"))
                .found(actual.to_string())
                .in_field(each),
            SplineError::NotFinite { index } => fault.in_item(index).in_field(of),
            SplineError::Outside { .. } => fault.in_field(list),
        }
    })
}
