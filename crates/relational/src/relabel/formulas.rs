//! Reparametrizations by formulas: B-spline, cosine, geometric, hyperbolic tangent.

use moldloft_num::Real;
use moldloft_registry::{
    Build, CallError, Class, Context, FromValue, Kind, ReparametrizationRef, Value,
};
use moldloft_spline as spline;
use moldloft_spline::{Dense, RelabelError};
use std::sync::Arc;

/// End or ends at which a law is dense, by its name in the language.
pub struct DenseAt(Dense);

impl<T: Real> FromValue<T> for DenseAt {
    const CLASS: Class = Class::Text;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        let text = Arc::<str>::from_value(value)?;
        Ok(DenseAt(match &*text {
            "both" => Dense::Both,
            "start" => Dense::Start,
            "end" => Dense::End,
            other => {
                return Err(CallError::new("unknown-end", format!("unknown end \"{other}\""))
                    .expected("\"both\", \"start\" or \"end\"")
                    .found(format!("\"{other}\"")));
            }
        }))
    }
}

fn law<T: Real>(
    law: Result<spline::ReparametrizationForm<T>, RelabelError>,
    place: impl Fn(CallError, &RelabelError) -> CallError,
) -> Result<Value<T>, CallError> {
    match law {
        Ok(law) => Ok(Value::Relabel(ReparametrizationRef::new(law, 0))),
        Err(error) => {
            let message = error.to_string();
            let fault = match &error {
                RelabelError::Ends { first, last } => CallError::new("wrong-ends", message)
                    .expected("0 at the start and 1 at the end")
                    .found(format!("{first} and {last}")),
                RelabelError::NotMonotone { value, before, .. } => {
                    CallError::new("not-monotone", message)
                        .expected(format!("a value greater than {before}"))
                        .found(value.to_string())
                }
                RelabelError::ZeroSlope { at } => CallError::new("zero-slope", message)
                    .expected("values that ascend everywhere inside")
                    .found(format!("no slope at t = {at}"))
                    .help("separate neighbouring values"),
                RelabelError::Range { value, min, max, .. } => {
                    CallError::new("out-of-range", message)
                        .expected(format!("a number from {min} to {max}"))
                        .found(value.to_string())
                }
                RelabelError::Unordered { .. } => CallError::new("not-monotone", message)
                    .expected("parameters in ascending order"),
                RelabelError::Lengths { parameters, values } => {
                    CallError::new("wrong-length", message)
                        .expected("two or more parameters, and as many values")
                        .found(format!("{parameters} and {values}"))
                }
                RelabelError::Knots(_) => CallError::new("no-spline", message),
            };
            Err(place(fault, &error))
        }
    }
}

/// A redistribution by a B-spline function of the parameter: R(t) = sum N_i(t) r_i, with clamped
/// uniform knots, as in a B-sub-curve.
///
/// The values increase from 0 to 1. With `partial = 1` they increase between any two values, and
/// the law covers a part of the curve or its continuation beyond the ends. For N values the degree
/// is at most N - 1; a higher one is lowered. Degree 1 is linear between its breaks, so parts of
/// other curves stay parts of them.
#[derive(Kind)]
#[kind(
    class = Relabel,
    columns = "degree values",
    example = "Relabel r({0, 0.1, 0.6, 0.8, 1}, degree = 2); AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); \
               Line l(A, B, relabel = r);"
)]
pub struct Relabel<T: Real> {
    /// Values from 0 to 1, two or more.
    #[field(min_items = 2)]
    values: Vec<T>,
    /// Polynomial degree.
    #[field(default = 3, min = 1, max = 25)]
    degree: usize,
    /// 1 when the values may start and end at other numbers than 0 and 1.
    #[field(default = 0, min = 0, max = 1)]
    partial: u32,
}

impl<T: Real> Build<T> for Relabel<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let degree = self.degree.min(self.values.len().saturating_sub(1)).max(1);
        let made = match self.partial {
            0 => spline::ReparametrizationForm::spline(degree, self.values),
            _ => spline::ReparametrizationForm::partial(degree, self.values),
        };
        law(made, |fault, error| match error {
            RelabelError::NotMonotone { index, .. } => fault.in_item(*index).in_field(Self::VALUES),
            RelabelError::Ends { .. } => fault
                .help("or add partial = 1 to leave a part of the curve out")
                .in_field(Self::VALUES),
            _ => fault.in_field(Self::VALUES),
        })
    }
}

/// A cosine redistribution: R(t) = (1 - w) t + w f(t), with f = (1 - cos pi t) / 2 dense at both ends,
/// 1 - cos(pi t / 2) at the start or sin(pi t / 2) at the end.
#[derive(Kind)]
#[kind(
    class = Relabel,
    columns = "dense weight",
    example = "CosRelabel r(); CosRelabel s(\"start\", 0.8);"
)]
pub struct CosRelabel<T: Real> {
    /// Dense end: "both", "start" or "end".
    #[field(default = "both")]
    dense: DenseAt,
    /// Weight w of the cosine, 0 to 1.
    #[field(default = 1, min = 0, max = 1)]
    weight: T,
}

impl<T: Real> Build<T> for CosRelabel<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        law(spline::ReparametrizationForm::cosine(self.dense.0, self.weight), |fault, _| {
            fault.in_field(Self::WEIGHT)
        })
    }
}

/// A geometric redistribution: R(t) = (q^t - 1) / (q - 1). For many equal steps of t, the last is q
/// times the first; q = 1 is the identity.
#[derive(Kind)]
#[kind(class = Relabel, columns = "ratio", example = "GeoRelabel r(4);")]
pub struct GeoRelabel<T: Real> {
    /// Ratio q of the last step to the first; below 1 the law is dense at the end.
    #[field(min = 1e-9, max = 1e9)]
    ratio: T,
}

impl<T: Real> Build<T> for GeoRelabel<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        law(spline::ReparametrizationForm::geometric(self.ratio), |fault, _| {
            fault.in_field(Self::RATIO)
        })
    }
}

/// A hyperbolic tangent redistribution (Vinokur, J. Comput. Phys. 50, 1983): dense at both ends
/// R(t) = 1/2 + tanh(d (t - 1/2)) / (2 tanh(d/2)), at the start 1 + tanh(d (t - 1)) / tanh d, at the end
/// the mirror image of that.
#[derive(Kind)]
#[kind(
    class = Relabel,
    columns = "strength dense",
    example = "TanhRelabel r(3); TanhRelabel s(2.5, \"end\");"
)]
pub struct TanhRelabel<T: Real> {
    /// Strength d, 0 to 100; 0 is the identity.
    #[field(min = 0, max = 100)]
    strength: T,
    /// Dense end: "both", "start" or "end".
    #[field(default = "both")]
    dense: DenseAt,
}

impl<T: Real> Build<T> for TanhRelabel<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        law(spline::ReparametrizationForm::tanh(self.dense.0, self.strength), |fault, _| {
            fault.in_field(Self::STRENGTH)
        })
    }
}

/// A redistribution by a table: the monotone piecewise cubic through (parameter, value) pairs
/// (Fritsch and Carlson, SIAM J. Numer. Anal. 17, 1980).
///
/// The pairs range from (0, 0) to (1, 1); both columns increase.
#[derive(Kind)]
#[kind(
    class = Relabel,
    columns = "parameters values",
    example = "TableRelabel r({0, 0.25, 0.5, 1}, {0, 0.15, 0.4, 1});"
)]
pub struct TableRelabel<T: Real> {
    /// Parameters t from 0 to 1.
    #[field(min_items = 2)]
    parameters: Vec<T>,
    /// Values R(t) from 0 to 1, as many.
    #[field(min_items = 2)]
    values: Vec<T>,
}

impl<T: Real> Build<T> for TableRelabel<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let ends = [0.0, 1.0].map(Some);
        let run = [self.parameters.first(), self.parameters.last()].map(|x| x.map(|x| x.re()));
        let table = spline::ReparametrizationForm::table(self.parameters, self.values);
        law(table, |fault, error| match error {
            RelabelError::NotMonotone { index, .. } => fault.in_item(*index).in_field(Self::VALUES),
            RelabelError::Unordered { index } => fault.in_item(*index).in_field(Self::PARAMETERS),
            RelabelError::Ends { .. } => {
                fault.in_field(if run == ends { Self::VALUES } else { Self::PARAMETERS })
            }
            _ => fault.in_field(Self::VALUES),
        })
    }
}
