use crate::even::{cos_of_sq, sinc_of_sq};
use crate::{KnotError, KnotVector};
use moldloft_num::{Jet, Order, Real};
use std::f64::consts::{FRAC_PI_2, PI};
use std::fmt;

/// Why a law is no relabelling.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RelabelError {
    /// The values do not begin with 0 and end with 1.
    Ends {
        /// The first value.
        first: f64,
        /// The last value.
        last: f64,
    },
    /// A value is smaller than the one before.
    NotMonotone {
        /// Its index.
        index: usize,
        /// The value before it.
        before: f64,
        /// The value.
        value: f64,
    },
    /// A number of the law lies outside its range.
    Range {
        /// What the number is.
        name: &'static str,
        /// The number.
        value: f64,
        /// The smallest allowed.
        min: f64,
        /// The largest allowed.
        max: f64,
    },
    /// The degree does not fit the number of values.
    Knots(KnotError),
}

impl fmt::Display for RelabelError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Ends { first, last } => {
                write!(f, "a relabelling runs from 0 to 1, found {first} to {last}")
            }
            Self::NotMonotone { index, before, value } => write!(
                f,
                "a relabelling must not run back: value {} is {value}, after {before}",
                index + 1
            ),
            Self::Range { name, value, min, max } => {
                write!(f, "expected a {name} from {min} to {max}, found {value}")
            }
            Self::Knots(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for RelabelError {}

/// Where a spacing law is dense.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dense {
    /// At 0 and 1.
    Both,
    /// At 0.
    Start,
    /// At 1.
    End,
}

/// A monotone reparameterisation R of [0, 1], with R(0) = 0 and R(1) = 1 exactly: a curve C is
/// relabelled to C(R(t)).
///
/// # Example
/// ```
/// use moldloft_spline::{Dense, Relabel};
/// let cosine = Relabel::<f64>::cosine(Dense::Both, 1.0).unwrap();
/// assert!((cosine.at(0.25) - (2.0 - 2f64.sqrt()) / 4.0).abs() < 1e-16);
/// assert_eq!((cosine.at(0.0), cosine.at(1.0)), (0.0, 1.0));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Relabel<T> {
    law: Law<T>,
}

#[derive(Clone, Debug, Default, PartialEq)]
enum Law<T> {
    #[default]
    Identity,
    Spline {
        knots: KnotVector,
        values: Vec<T>,
    },
    Cosine {
        dense: Dense,
        weight: T,
    },
    /// `log_ratio` = ln(R'(1) / R'(0)).
    Geometric {
        log_ratio: T,
    },
    Tanh {
        dense: Dense,
        strength: T,
    },
}

impl<T: Real> Relabel<T> {
    /// R(t) = t.
    pub fn identity() -> Self {
        Self { law: Law::Identity }
    }

    /// True for the law R(t) = t.
    pub fn is_identity(&self) -> bool {
        matches!(self.law, Law::Identity)
    }

    /// The clamped uniform B-spline function with these coefficients, as B-sub-curves use it. They
    /// must ascend, which is enough (and for degrees 1 and 2 necessary) for R to be monotone.
    ///
    /// # Errors
    /// [`RelabelError`] when the values run back, do not run from 0 to 1, or are too few.
    pub fn spline(degree: usize, values: Vec<T>) -> Result<Self, RelabelError> {
        let knots =
            KnotVector::clamped_uniform(degree, values.len()).map_err(RelabelError::Knots)?;
        let (first, last) = (values[0].re(), values[values.len() - 1].re());
        if (first, last) != (0.0, 1.0) {
            return Err(RelabelError::Ends { first, last });
        }
        for (k, w) in values.windows(2).enumerate() {
            let (before, value) = (w[0].re(), w[1].re());
            // Written so that NaN is refused.
            let ascends = value >= before;
            if !ascends {
                return Err(RelabelError::NotMonotone { index: k + 1, before, value });
            }
        }
        Ok(Self { law: Law::Spline { knots, values } })
    }

    /// (1 - weight) t + weight R(t) with R = (1 - cos pi t) / 2, 1 - cos(pi t / 2) or
    /// sin(pi t / 2), dense at both ends, the start or the end.
    ///
    /// # Errors
    /// [`RelabelError::Range`] unless the weight is in [0, 1].
    pub fn cosine(dense: Dense, weight: T) -> Result<Self, RelabelError> {
        within("weight", weight, 0.0, 1.0)?;
        Ok(Self { law: Law::Cosine { dense, weight } })
    }

    /// (q^t - 1) / (q - 1): equal steps of t grow geometrically, the last being q times the first
    /// for infinitely many. Smooth through q = 1, where it is the identity.
    ///
    /// # Errors
    /// [`RelabelError::Range`] unless the ratio is positive and finite.
    pub fn geometric(ratio: T) -> Result<Self, RelabelError> {
        within("ratio", ratio, f64::MIN_POSITIVE, f64::MAX)?;
        Ok(Self { law: Law::Geometric { log_ratio: ratio.ln() } })
    }

    /// The hyperbolic tangent law (Vinokur 1983): 1/2 + tanh(d (t - 1/2)) / (2 tanh(d/2)) dense at
    /// both ends, 1 + tanh(d (t-1)) / tanh d at the start, and that mirrored at the end; d is the
    /// `strength`, 0 the identity.
    ///
    /// # Errors
    /// [`RelabelError::Range`] unless the strength is in [0, 100].
    pub fn tanh(dense: Dense, strength: T) -> Result<Self, RelabelError> {
        within("strength", strength, 0.0, 100.0)?;
        Ok(Self { law: Law::Tanh { dense, strength } })
    }

    /// R(t), with t possibly a jet.
    pub fn at<J: Jet<T>>(&self, t: J) -> J {
        match &self.law {
            Law::Identity => t,
            Law::Spline { knots, values } => {
                let basis = knots.basis(t, Order::Zero);
                let mut sum = J::zero();
                for (b, &value) in basis.rows[0].iter().zip(&values[basis.first..]) {
                    sum += b.scaled(value);
                }
                sum
            }
            Law::Cosine { dense, weight } => {
                let law = match dense {
                    Dense::Both => -(t * PI).cos() * 0.5 + 0.5,
                    // 1 - cos x as the sine of the angle left: exactly 1 at the end.
                    Dense::Start => -((-t + 1.0) * FRAC_PI_2).sin() + 1.0,
                    Dense::End => (t * FRAC_PI_2).sin(),
                };
                t.scaled(-*weight + 1.0) + law.scaled(*weight)
            }
            Law::Geometric { log_ratio } => {
                // With r = ln q: exp(r (t-1) / 2) sinh(r t / 2) / sinh(r / 2).
                let half = *log_ratio * 0.5;
                let square = -(half * half);
                let growth = (t - 1.0).scaled(half).exp();
                let share = sinc_of_sq((t * t).scaled(square)) / J::fixed(sinc_of_sq(square));
                growth * t * share
            }
            Law::Tanh { dense, strength } => match dense {
                Dense::Both => {
                    let c = t - 0.5;
                    c * tanh_share(c, 0.5, *strength) + 0.5
                }
                Dense::Start => (t - 1.0) * tanh_share(t - 1.0, 1.0, *strength) + 1.0,
                Dense::End => t * tanh_share(t, 1.0, *strength),
            },
        }
    }
}

/// (tanh(d c) / c) / (tanh(d e) / e), where e is the far end of the range of c: the factor that
/// bends the straight law, 1 at the end.
fn tanh_share<T: Real, J: Jet<T>>(c: J, end: f64, strength: T) -> J {
    let square = -(strength * strength);
    let q = (c * c).scaled(square);
    let at_end = square * (end * end);
    let whole = sinc_of_sq(at_end) / cos_of_sq(at_end);
    sinc_of_sq(q) / cos_of_sq(q) / J::fixed(whole)
}

fn within<T: Real>(name: &'static str, x: T, min: f64, max: f64) -> Result<(), RelabelError> {
    let value = x.re();
    if x.is_finite() && (min..=max).contains(&value) {
        return Ok(());
    }
    Err(RelabelError::Range { name, value, min, max })
}
