//! Inverse functions of distributions: number of points, spacing.

use crate::distribution::{DistributionArguments, MOST_NUMBERS, fault};
use crate::value::{Numbers, VectorArray};
use moldloft_num::Real;
use moldloft_registry::{Build, CallError, Class, Context, FromValue, Kind, Scalar, Value};
use moldloft_spline::distribution::{count_for, first_for, growth};

/// The fewest numbers with which `d_tanhx(0, length, ds1, ds2, n)` grows by at most the factor
/// `growth` from step to step; a step of 0 means a free end.
///
/// The value is an integer and has no derivatives.
#[derive(Kind)]
#[kind(
    class = Number,
    function,
    name = "count_for",
    example = "int n = count_for(1, 0.001, 0.02, 1.15); \
               assert growth(d_tanhx(0, 1, 0.001, 0.02, n)) <= 1.15; \
               assert growth(d_tanhx(0, 1, 0.001, 0.02, n - 1)) > 1.15;"
)]
pub struct CountFor<T: Real> {
    /// The length to be divided.
    #[field(min = 0)]
    length: T,
    /// First step; 0 leaves it free.
    #[field(min = 0)]
    ds1: T,
    /// Last step; 0 leaves it free.
    #[field(min = 0)]
    ds2: T,
    /// The largest ratio of neighbouring steps, more than 1.
    #[field(default = 1.2, min = 1)]
    growth: T,
}

impl<T: Real> Build<T> for CountFor<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let [length, a, b, most] = [self.length, self.ds1, self.ds2, self.growth].map(T::re);
        let of = DistributionArguments { limits: Self::LENGTH, spacings: Self::DS1 };
        let n = count_for(length, a, b, most, MOST_NUMBERS as usize);
        let n = n.map_err(|error| fault(error, of))?;
        n.map(|n| Value::Number(T::from(n as f64))).ok_or_else(|| {
            let message = format!("no number of points divides {length} with that growth");
            CallError::new("no-distribution", message)
                .expected(format!("a growth that steps from {a} to {b} allow"))
                .found(format!("a growth of {most}"))
                .help("allow more growth, or bring the two spacings nearer to each other")
                .in_field(Self::GROWTH)
        })
    }
}

/// The first step of `n` numbers over `length` with steps that grow by the factor `growth`: length
/// (growth - 1) / (growth^(n-1) - 1).
#[derive(Kind)]
#[kind(
    class = Number,
    function,
    name = "first_for",
    example = "float ds = first_for(1, 1.1, 25); \
               assert abs(growth(geometric(0, 1, ds, 25)) - 1.1) < 1e-11;"
)]
pub struct FirstFor<T: Real> {
    /// The length to be divided.
    #[field(min = 0)]
    length: T,
    /// Ratio of a step to the one before it; below 1 for steps that shrink.
    #[field(min = 1e-6, max = 1e6)]
    growth: T,
    /// Number of values.
    #[field(min = 2, max = MOST_NUMBERS)]
    n: u32,
}

impl<T: Real> Build<T> for FirstFor<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        Ok(Value::Number(first_for(self.length, self.growth, self.n as usize)))
    }
}

/// Steps between the neighbours of a row of numbers or of points.
pub struct Steps<T>(Vec<T>);

impl<T: Scalar> FromValue<T> for Steps<T> {
    const CLASS: Class = Class::Any;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        let steps: Vec<T> = match value {
            Value::Numbers(_) => match Numbers::from_value(value)? {
                Numbers::Many(a) => a.row()?.windows(2).map(|w| (w[1] - w[0]).abs()).collect(),
                Numbers::One(_) => Vec::new(),
            },
            Value::Vectors(_) => {
                let VectorArray { shape, items } = VectorArray::from_value(value)?;
                if !matches!(shape, moldloft_registry::ArrayShape::Row(_)) {
                    let message = format!("expected one row, found a surface {shape}");
                    return Err(CallError::new("wrong-shape", message)
                        .expected("an farray [n] or a curve [n]")
                        .help("take one of its lines: s[1,] or s[,1]"));
                }
                items.windows(2).map(|w| w[0].distance(w[1])).collect()
            }
            other => {
                let found = other.class().with_article();
                let message = format!("expected a row of numbers or of points, found {found}");
                return Err(CallError::new("wrong-class", message)
                    .expected("an farray or a curve")
                    .found(found));
            }
        };
        if steps.is_empty() {
            return Err(CallError::new("too-few-items", "one element has no spacing")
                .expected("at least two elements"));
        }
        Ok(Self(steps))
    }
}

/// The first step of a row: |a[2] - a[1]|, of numbers or of points.
///
/// The spacing that makes a neighbour's cells match: `d_tanhx(0, 1, last_cell(before), 0.1, n)`.
#[derive(Kind)]
#[kind(
    class = Number,
    function,
    name = "first_cell",
    example = "assert first_cell(d_tanhx(0, 1, 0.07, 0.01, 60)) == 0.07;"
)]
pub struct FirstCell<T: Scalar> {
    /// Numbers or points, two or more.
    row: Steps<T>,
}

impl<T: Scalar> Build<T> for FirstCell<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        Ok(Value::Number(self.row.0[0]))
    }
}

/// The last step of a row: |a[n] - a[n-1]|, of numbers or of points.
#[derive(Kind)]
#[kind(
    class = Number,
    function,
    name = "last_cell",
    example = "farray s = d_tanhx(0, 1, 0.07, 0.01, 60); \
               farray next = d_tanhx(1, 3, last_cell(s), 0.2, 30); \
               assert abs(first_cell(next) - 0.01) < 1e-14;"
)]
pub struct LastCell<T: Scalar> {
    /// Numbers or points, two or more.
    row: Steps<T>,
}

impl<T: Scalar> Build<T> for LastCell<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        Ok(Value::Number(self.row.0[self.row.0.len() - 1]))
    }
}

/// The largest ratio of neighbouring steps of a row, of numbers or of points; 1 or more.
#[derive(Kind)]
#[kind(
    class = Number,
    function,
    name = "growth",
    example = "assert abs(growth(d_tanh(0, 1, 0.07, 0.01, 60)) - 1.1380126) < 1e-7;"
)]
pub struct Growth<T: Scalar> {
    /// Numbers or points, three or more.
    row: Steps<T>,
}

impl<T: Scalar> Build<T> for Growth<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        Ok(Value::Number(growth(&self.row.0)))
    }
}
