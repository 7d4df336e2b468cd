//! Functions on rows of numbers and on curves.

use moldloft_num::{Order, Real, Vec3, gauss_legendre};
use moldloft_registry::{Array, Build, Context, CurveRef, Fault, Kind, Value, Vectors};
use moldloft_spline::arclen;
use moldloft_spline::distribution::{self, DistributionError};
use std::sync::Arc;

/// The longest row.
const MOST_NUMBERS: u32 = 1_000_000;

fn numbers<T: Real>(row: Result<Vec<T>, DistributionError>) -> Result<Value<T>, Fault> {
    match row {
        Ok(row) => Ok(Value::Numbers(Arc::new(Array::row(row)))),
        Err(error) => Err(Fault::new("no-distribution", error.to_string()).in_field(0)),
    }
}

/// `n` numbers in equal steps from `start` to `end`, both included.
#[derive(Kind)]
#[kind(class = Numbers, function, name = "uniform", example = "farray s = uniform(0, 1, 11);")]
pub struct Uniform<T: Real> {
    /// First number.
    start: T,
    /// Last number.
    end: T,
    /// How many numbers.
    #[field(min = 2, max = MOST_NUMBERS)]
    n: u32,
}

impl<T: Real> Build<T> for Uniform<T> {
    fn build(self, _: &Context) -> Result<Value<T>, Fault> {
        numbers(distribution::uniform(self.start, self.end, self.n as usize))
    }
}

/// `n` numbers from `start` to `end`, dense at both: start + (end - start) (1 - cos pi x) / 2 for
/// uniform x.
#[derive(Kind)]
#[kind(class = Numbers, function, name = "cosine", example = "farray s = cosine(0, 1, 11);")]
pub struct Cosine<T: Real> {
    /// First number.
    start: T,
    /// Last number.
    end: T,
    /// How many numbers.
    #[field(min = 2, max = MOST_NUMBERS)]
    n: u32,
}

impl<T: Real> Build<T> for Cosine<T> {
    fn build(self, _: &Context) -> Result<Value<T>, Fault> {
        numbers(distribution::cosine(self.start, self.end, self.n as usize))
    }
}

/// `n` numbers from `start` to `end` by the hyperbolic tangent law with given slopes at the ends
/// (Vinokur, J. Comput. Phys. 50, 1983).
///
/// `ds1` and `ds2` are steps per index at the two ends; 0 leaves an end free, both 0 is uniform. The
/// first and last cells differ from them by the curvature of the law.
#[derive(Kind)]
#[kind(
    class = Numbers,
    function,
    name = "d_tanh",
    example = "farray s = d_tanh(0, 1, 0.01, 0.05, 60);"
)]
pub struct DTanh<T: Real> {
    /// First number.
    start: T,
    /// Last number.
    end: T,
    /// Slope at the start, per index; 0 leaves it free.
    #[field(min = 0)]
    ds1: T,
    /// Slope at the end, per index; 0 leaves it free.
    #[field(min = 0)]
    ds2: T,
    /// How many numbers.
    #[field(min = 2, max = MOST_NUMBERS)]
    n: u32,
}

impl<T: Real> Build<T> for DTanh<T> {
    fn build(self, _: &Context) -> Result<Value<T>, Fault> {
        let Self { start, end, ds1, ds2, n } = self;
        numbers(distribution::d_tanh(start, end, ds1, ds2, n as usize))
    }
}

/// The points of a curve at given parameters: C(s[1]), C(s[2]), ...
///
/// Parameters lie in [0, 1]; at 0 and 1 the points are the curve's ends to the bit.
#[derive(Kind)]
#[kind(
    class = Vectors,
    function,
    name = "distc",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); BCurve c({A, B, C}); \
               farray s = cosine(0, 1, 11); curve points = distc(c, s);"
)]
pub struct Distc<T: Real> {
    /// The curve.
    curve: CurveRef<T>,
    /// Parameters.
    parameters: Vec<T>,
}

impl<T: Real> Build<T> for Distc<T> {
    fn build(self, _: &Context) -> Result<Value<T>, Fault> {
        let Self { curve, parameters } = self;
        let inside = |t: &T| (0.0..=1.0).contains(&t.re());
        if let Some(k) = parameters.iter().position(|t| !inside(t)) {
            let found = parameters[k].re();
            return Err(Fault::new("out-of-range", format!("parameter {} is {found}", k + 1))
                .expected("parameters from 0 to 1")
                .found(found.to_string())
                .in_item(k)
                .in_field(1));
        }
        let points: Vec<Vec3<T>> = if parameters.iter().all(|t| t.is_constant()) {
            let ts: Vec<f64> = parameters.iter().map(|t| t.re()).collect();
            let mut points = vec![Vec3::zero(); ts.len()];
            curve.grid(&ts, &mut points);
            points
        } else {
            parameters.iter().map(|&t| curve.jet(t, Order::Zero)[0]).collect()
        };
        Ok(Value::Vectors(Arc::new(Vectors::row(points))))
    }
}

/// The length of a curve: the integral of |C'(t)| from 0 to 1, to about twelve digits.
#[derive(Kind)]
#[kind(
    class = Number,
    function,
    name = "length",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); BCurve c({A, B, C}); \
               float l = length(c);"
)]
pub struct Length<T: Real> {
    /// The curve.
    curve: CurveRef<T>,
}

impl<T: Real> Build<T> for Length<T> {
    fn build(self, _: &Context) -> Result<Value<T>, Fault> {
        let curve = &*self.curve;
        let speed = |t: f64| curve.jet(T::from(t), Order::First)[1].re().norm();
        let rough = gauss_legendre(0.0, 1.0, speed);
        if rough == 0.0 {
            return Ok(Value::Number(T::zero()));
        }
        Ok(Value::Number(arclen(curve, T::zero(), T::one(), 1e-12 * rough)))
    }
}
