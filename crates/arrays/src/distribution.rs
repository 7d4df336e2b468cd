//! Distributions of numbers along a stretch.

use crate::value::{Farray, farray};
use moldloft_num::Real;
use moldloft_registry::{Build, CallError, Context, FieldId, Kind, Scalar, Value};
use moldloft_spline::distribution::{self, DistributionError};

/// The longest row.
pub const MOST_NUMBERS: u32 = 1_000_000;

/// The arguments that limits and spacings of a distribution come from.
#[derive(Clone, Copy)]
pub struct DistributionArguments {
    /// The first limit, or the length.
    pub limits: FieldId,
    /// The first spacing; of a distribution without spacings, which cannot be wrong in them, as `limits`.
    pub spacings: FieldId,
}

/// The fault of a distribution made of these arguments.
pub fn fault(error: DistributionError, of: DistributionArguments) -> CallError {
    let fault = CallError::new("no-distribution", error.to_string());
    match error {
        DistributionError::TooFew { expected, actual } => {
            fault.expected(format!("at least {expected} numbers")).found(actual.to_string())
        }
        DistributionError::Limits { start, end } => fault
            .expected("two different finite limits")
            .found(format!("{start} and {end}"))
            .in_field(of.limits),
        DistributionError::Spacing { spacing } => fault
            .expected("a positive spacing")
            .found(spacing.to_string())
            .help("a spacing is a length: positive in either direction")
            .in_field(of.spacings),
        DistributionError::TwoSided { .. } => fault
            .help("d_tanh, d_tanhx and geometric2 take a spacing at both ends")
            .in_field(of.spacings),
        DistributionError::Unreachable { spacings: [a, b], length, cells } => {
            let mean = length / cells as f64;
            fault
                .expected(format!("spacings nearer to the mean, {mean}"))
                .found(format!("{a} and {b}"))
                .help("use another number of points: count_for(length, ds1, ds2, growth)")
                .in_field(of.spacings)
        }
    }
}

fn row<T: Real>(
    row: Result<Vec<T>, DistributionError>,
    [limits, spacings]: [FieldId; 2],
) -> Result<Value<T>, CallError> {
    row.map(farray).map_err(|error| fault(error, DistributionArguments { limits, spacings }))
}

/// The row with a number more in each interval, the others to the bit. Both parts of an interval grow as the intervals
/// around it do, so that a geometric row stays one.
pub fn halved<T: Real>(row: &[T]) -> Vec<T> {
    let count = row.len().saturating_sub(1);
    let step = |k: usize| row[k + 1] - row[k];
    let mut all = Vec::with_capacity(2 * count + 1);
    for k in 0..count {
        // The growth from an interval to the next.
        let growth = match k {
            _ if count == 1 => T::one(),
            0 => step(1) / step(0),
            _ if k + 1 == count => step(k) / step(k - 1),
            _ => (step(k + 1) / step(k - 1)).sqrt(),
        };
        all.push(row[k]);
        all.push(row[k] + step(k) / (T::one() + growth.sqrt()));
    }
    all.extend(row.last());
    all
}

/// `n` numbers in equal steps from `start` to `end`, both included.
#[derive(Kind)]
#[kind(class = Numbers, function, cheap, name = "uniform", example = "farray s = uniform(0, 1, 11);")]
pub struct Uniform<T: Real> {
    /// First number.
    start: T,
    /// Last number.
    end: T,
    /// Number of values.
    #[field(min = 2, max = MOST_NUMBERS)]
    n: u32,
}

impl<T: Real> Build<T> for Uniform<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        row(
            distribution::uniform(self.start, self.end, self.n as usize),
            [Self::START, Self::START],
        )
    }
}

/// `n` numbers from `start` to `end`, dense at both: start + (end - start) (1 - cos pi x) / 2 for
/// uniform x.
#[derive(Kind)]
#[kind(class = Numbers, function, cheap, name = "cosine", example = "farray s = cosine(0, 1, 11);")]
pub struct Cosine<T: Real> {
    /// First number.
    start: T,
    /// Last number.
    end: T,
    /// Number of values.
    #[field(min = 2, max = MOST_NUMBERS)]
    n: u32,
}

impl<T: Real> Build<T> for Cosine<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        row(distribution::cosine(self.start, self.end, self.n as usize), [Self::START, Self::START])
    }
}

/// `n` numbers from `start` to `end` with steps in geometric progression; the first step is `ds1`.
///
/// The ratio solves ds1 (r^N - 1) / (r - 1) = |end - start| for N = n - 1 steps; it is below 1 if
/// `ds1` exceeds the mean step.
#[derive(Kind)]
#[kind(
    class = Numbers,
    function,
    name = "geometric",
    example = "farray s = geometric(0, 1, 0.01, 25); assert abs(s[2] - 0.01) < 1e-15;"
)]
pub struct Geometric<T: Real> {
    /// First number.
    start: T,
    /// Last number.
    end: T,
    /// First step, a positive length.
    ds1: T,
    /// Number of values.
    #[field(min = 2, max = MOST_NUMBERS)]
    n: u32,
}

impl<T: Real> Build<T> for Geometric<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        row(
            distribution::geometric(self.start, self.end, self.ds1, self.n as usize),
            [Self::START, Self::DS1],
        )
    }
}

/// `n` numbers from `start` to `end` with steps that grow by one ratio from both ends inward; the
/// first step is `ds1`, the last `ds2`.
///
/// The step at which the two progressions meet is chosen so that they meet as evenly as whole
/// numbers of steps allow.
#[derive(Kind)]
#[kind(
    class = Numbers,
    function,
    name = "geometric2",
    example = "farray s = geometric2(0, 1, 0.001, 0.02, 40);"
)]
pub struct Geometric2<T: Real> {
    /// First number.
    start: T,
    /// Last number.
    end: T,
    /// First step, a positive length.
    ds1: T,
    /// Last step, a positive length.
    ds2: T,
    /// Number of values, at least 4.
    #[field(min = 2, max = MOST_NUMBERS)]
    n: u32,
}

impl<T: Real> Build<T> for Geometric2<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Self { start, end, ds1, ds2, n } = self;
        row(distribution::geometric2(start, end, ds1, ds2, n as usize), [Self::START, Self::DS1])
    }
}

/// `n` numbers from `start` to `end` by the hyperbolic sine law with a given slope at one end
/// (Thompson, Warsi and Mastin 1985): nearer to equal steps at that end than `d_tanh`, coarser at the
/// other.
///
/// One of `ds1` and `ds2` must be 0; both 0 is uniform.
#[derive(Kind)]
#[kind(
    class = Numbers,
    function,
    name = "d_sinh",
    example = "farray s = d_sinh(0, 1, 0.01, 0, 25);"
)]
pub struct DSinh<T: Real> {
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
    /// Number of values.
    #[field(min = 2, max = MOST_NUMBERS)]
    n: u32,
}

impl<T: Real> Build<T> for DSinh<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Self { start, end, ds1, ds2, n } = self;
        row(distribution::d_sinh(start, end, ds1, ds2, n as usize), [Self::START, Self::DS1])
    }
}

/// `n` numbers from `start` to `end` by the hyperbolic tangent law with given slopes at the ends
/// (Vinokur, J. Comput. Phys. 50, 1983).
///
/// `ds1` and `ds2` are steps per index at the two ends; 0 leaves that end free, both 0 gives uniform spacing. The
/// first and last cells differ from them by the curvature of the law; `d_tanhx` has exact cells.
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
    /// Number of values.
    #[field(min = 2, max = MOST_NUMBERS)]
    n: u32,
}

impl<T: Real> Build<T> for DTanh<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Self { start, end, ds1, ds2, n } = self;
        row(distribution::d_tanh(start, end, ds1, ds2, n as usize), [Self::START, Self::DS1])
    }
}

/// `n` numbers from `start` to `end` by the hyperbolic tangent law, with first and last steps of
/// exactly `ds1` and `ds2`.
///
/// A step of 0 leaves that end free; two give uniform spacing. On coarse rows `d_tanh`, whose `ds1`
/// and `ds2` are slopes, misses the requested cells by up to a third; this function solves for the
/// slopes that give them.
#[derive(Kind)]
#[kind(
    class = Numbers,
    function,
    name = "d_tanhx",
    example = "farray s = d_tanhx(0, 1, 0.07, 0.01, 60); assert s[2] == 0.07;"
)]
pub struct DTanhX<T: Real> {
    /// First number.
    start: T,
    /// Last number.
    end: T,
    /// First step; 0 leaves it free.
    #[field(min = 0)]
    ds1: T,
    /// Last step; 0 leaves it free.
    #[field(min = 0)]
    ds2: T,
    /// Number of values, at least 4.
    #[field(min = 2, max = MOST_NUMBERS)]
    n: u32,
}

impl<T: Real> Build<T> for DTanhX<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Self { start, end, ds1, ds2, n } = self;
        row(distribution::d_tanhx(start, end, ds1, ds2, n as usize), [Self::START, Self::DS1])
    }
}

/// `n` numbers distributed like those of a given row: its linear interpolation by index, with
/// identical ends.
#[derive(Kind)]
#[kind(
    class = Numbers,
    function,
    name = "redist",
    example = "farray s = redist(d_tanh(0, 1, 0.01, 0.05, 60), 31); assert s[31] == 1;"
)]
pub struct Redist<T: Scalar> {
    /// The row.
    given: Farray<T>,
    /// Number of values.
    #[field(min = 2, max = MOST_NUMBERS)]
    n: u32,
}

impl<T: Scalar> Build<T> for Redist<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let given = self.given.row().map_err(|fault| fault.in_field(Self::GIVEN))?;
        distribution::redist(&given, self.n as usize).map(farray).map_err(|error| {
            fault(error, DistributionArguments { limits: Self::GIVEN, spacings: Self::GIVEN })
        })
    }
}
