//! B-splines fitted to curves by least squares, with an error if the requested accuracy is not
//! reached.

use super::Ended;
use moldloft_num::{Curve, Order, Real};
use moldloft_registry::{
    Build, CallError, Context, CurveRef, FieldId, Kind, SearchReport, SearchStatus, Value,
};
use moldloft_spline::{SplineError, SplineWithKnotDerivatives};

/// A B-spline fitted to a curve by least squares, with clamped uniform knots and the same ends:
/// minimises the sum of squared distances at equal parameters.
///
/// The number of control points determines the accuracy. The member `residual` is the greatest
/// distance between curve and fit at equal parameters; a residual above `accuracy` is an error.
#[derive(Kind)]
#[kind(
    class = Curve,
    columns = "relabel curve degree points",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); AbsPoint D(4, 0, 1); \
               CCurve c({A, B, C, D}); BFitCurve fit(c, 3, 6, 0.05);"
)]
pub struct BFitCurve<T: Real> {
    /// The curve to approximate.
    curve: CurveRef<T>,
    /// Polynomial degree.
    #[field(default = 3, min = 1, max = 25)]
    degree: usize,
    /// Number of control points, more than the degree.
    #[field(default = 8, min = 2, max = 10_000)]
    points: usize,
    /// Maximum distance between the two curves at equal parameters.
    #[field(min = 0)]
    accuracy: Option<T>,
}

impl<T: Real> Build<T> for BFitCurve<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Self { curve, degree, points, accuracy } = self;
        fit(&curve, degree, None, points, accuracy, [Self::POINTS, Self::ACCURACY])
    }
}

/// A B-spline fitted to a curve as in BFitCurve, with given knots.
#[derive(Kind)]
#[kind(
    class = Curve,
    columns = "relabel curve degree knots",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); AbsPoint D(4, 0, 1); \
               CCurve c({A, B, C, D}); NUBFitCurve fit(c, 3, {0, 0.3, 0.55, 1});"
)]
pub struct NUBFitCurve<T: Real> {
    /// The curve to come near to.
    curve: CurveRef<T>,
    /// Polynomial degree.
    #[field(default = 3, min = 1, max = 25)]
    degree: usize,
    /// The parameters of the joints between pieces, from 0 to 1, each once.
    #[field(min_items = 2)]
    knots: Vec<T>,
    /// The greatest distance allowed between the two at equal parameters.
    #[field(min = 0)]
    accuracy: Option<T>,
}

impl<T: Real> Build<T> for NUBFitCurve<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Self { curve, degree, knots, accuracy } = self;
        let points = knots.len() + degree - 1;
        let all = clamped(degree, &knots, Self::KNOTS)?;
        fit(&curve, degree, Some(all), points, accuracy, [Self::KNOTS, Self::ACCURACY])
    }
}

/// Points of the curve compared per control point.
const SAMPLES: usize = 8;

fn fit<T: Real>(
    curve: &CurveRef<T>,
    degree: usize,
    knots: Option<Vec<T>>,
    points: usize,
    accuracy: Option<T>,
    [of, within]: [FieldId; 2],
) -> Result<Value<T>, CallError> {
    let count = (SAMPLES * points).max(64);
    let samples: Vec<_> = (0..=count)
        .map(|k| k as f64 / count as f64)
        .map(|t| (t, curve.jet(T::from(t), Order::Zero)[0]))
        .collect();
    let spline = SplineWithKnotDerivatives::fitted(degree, knots, points, &samples);
    let spline = spline.map_err(|error| no_fit(error).in_field(of))?;
    let residual = {
        let gap = |(t, p): &(f64, moldloft_num::Vec3<T>)| {
            spline.jet(T::from(*t), Order::Zero)[0].re().distance(p.re())
        };
        samples.iter().map(gap).fold(0.0, f64::max)
    };
    near_enough(residual, accuracy, "curve")
        .map_err(|fault| fault.related(curve.key, "is the curve").in_field(within))?;
    let ends = curve.end_points();
    let fitted = CurveRef::new(Ended::between(spline, ends), 0).with_found(report(residual));
    Ok(Value::Curve(fitted))
}

/// Error of a fit with unusable knots or counts.
pub fn no_fit(error: SplineError) -> CallError {
    let fault = CallError::new("no-fit", error.to_string());
    match error {
        SplineError::Count { .. } => fault
            .expected("knots farther apart")
            .found("a control point that the original does not determine"),
        _ => fault.expected("ascending knots, and more points than the degree"),
    }
}

/// Error if the fit of a `noun` misses the accuracy.
pub fn near_enough<T: Real>(
    residual: f64,
    accuracy: Option<T>,
    noun: &str,
) -> Result<(), CallError> {
    match accuracy {
        // Written so that NaN is refused.
        Some(accuracy) if residual.is_nan() || residual > accuracy.re() => {
            let message = format!("the fit does not approximate the {noun} within the accuracy");
            Err(CallError::new("no-fit", message)
                .expected(format!("a distance of at most {}", accuracy.re()))
                .found(format!("{residual}"))
                .help("give it more control points or knots"))
        }
        _ => Ok(()),
    }
}

/// Report of a fit by its residual.
pub fn report(residual: f64) -> SearchReport {
    SearchReport {
        status: SearchStatus::Ok,
        residual,
        iterations: 1,
        start: Vec::new(),
        last: Vec::new(),
        alternatives: Vec::new(),
        advice: "",
    }
}

/// The knot vector of pieces that meet at `knots`, which are those of field `field`.
pub fn clamped<T: Real>(degree: usize, knots: &[T], field: FieldId) -> Result<Vec<T>, CallError> {
    let (first, last) = (knots.first().map(|k| k.re()), knots.last().map(|k| k.re()));
    if (first, last) != (Some(0.0), Some(1.0)) || knots.len() < 2 {
        let ends = |x: Option<f64>| x.map_or("nothing".into(), |x| x.to_string());
        return Err(CallError::new("out-of-range", "the knots of a fit run from 0 to 1")
            .expected("knots from 0 to 1")
            .found(format!("knots from {} to {}", ends(first), ends(last)))
            .in_field(field));
    }
    let mut all = vec![T::zero(); degree + 1];
    all.extend_from_slice(&knots[1..knots.len() - 1]);
    all.extend(vec![T::one(); degree + 1]);
    Ok(all)
}
