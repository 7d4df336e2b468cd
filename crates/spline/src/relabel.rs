//! Closed forms of reparametrizations: B-spline, cosine, geometric, hyperbolic tangent, tables.
//! Each is monotone and maps 0 to 0 and 1 to 1 exactly, or is refused.

use crate::even_functions::{cos_of_sq, sinc_of_sq};
use crate::{KnotError, KnotVector};
use moldloft_num::{Jet, Order, Real, Reparametrization, ReparametrizationJet};
use std::f64::consts::{FRAC_PI_2, PI};
use std::fmt;

/// Reason why a law is not a relabelling.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RelabelError {
    /// The values do not start with 0 and end with 1.
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
    /// The law has a zero tangent inside (0, 1).
    ZeroSlope {
        /// Parameter.
        at: f64,
    },
    /// Two parameters of a table are not in ascending order.
    Unordered {
        /// The index of the later one.
        index: usize,
    },
    /// The numbers of parameters and values differ, or are less than two.
    Lengths {
        /// Parameters.
        parameters: usize,
        /// Values.
        values: usize,
    },
    /// A number of the law is outside its range.
    Range {
        /// Name of the number.
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
            Self::ZeroSlope { at } => {
                write!(f, "a relabel must increase strictly inside; its slope is zero at t = {at}")
            }
            Self::Unordered { index } => {
                write!(f, "the parameters must increase; number {} does not", index + 1)
            }
            Self::Lengths { parameters, values } => {
                write!(f, "{parameters} parameters do not go with {values} values")
            }
            Self::Knots(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for RelabelError {}

/// Dense ends of a spacing law.
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
/// use moldloft_spline::{Dense, ReparametrizationForm};
/// let cosine = ReparametrizationForm::<f64>::cosine(Dense::Both, 1.0).unwrap();
/// assert!((cosine.at(0.25) - (2.0 - 2f64.sqrt()) / 4.0).abs() < 1e-16);
/// assert_eq!((cosine.at(0.0), cosine.at(1.0)), (0.0, 1.0));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReparametrizationForm<T> {
    law: Formula<T>,
}

#[derive(Clone, Debug, Default, PartialEq)]
enum Formula<T> {
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
    /// Cubic pieces between nodes, with the slopes there.
    Table {
        nodes: Vec<T>,
        values: Vec<T>,
        slopes: Vec<T>,
    },
}

impl<T: Real> ReparametrizationForm<T> {
    /// R(t) = t.
    pub fn identity() -> Self {
        Self { law: Formula::Identity }
    }

    /// True for the law R(t) = t.
    pub fn is_identity(&self) -> bool {
        matches!(self.law, Formula::Identity)
    }

    /// The clamped uniform B-spline function with these coefficients, as in B-sub-curves. They must
    /// ascend, which makes R monotone (and is necessary for degrees 1 and 2). The first and the
    /// last are constants without derivatives.
    ///
    /// # Errors
    /// [`RelabelError`] if the values decrease, do not extend from 0 to 1, are too few, or if
    /// enough of them are equal to give R a zero tangent inside.
    pub fn spline(degree: usize, mut values: Vec<T>) -> Result<Self, RelabelError> {
        if let [first, .., last] = values.as_mut_slice() {
            let ends = (first.re(), last.re());
            if ends != (0.0, 1.0) {
                return Err(RelabelError::Ends { first: ends.0, last: ends.1 });
            }
            (*first, *last) = (T::zero(), T::one());
        }
        Self::partial(degree, values)
    }

    /// As [`Self::spline`], with any first and last value: a law that omits parts of a curve or
    /// extends it beyond its ends.
    ///
    /// # Errors
    /// As for [`Self::spline`], but for the ends.
    pub fn partial(degree: usize, values: Vec<T>) -> Result<Self, RelabelError> {
        let knots =
            KnotVector::clamped_uniform(degree, values.len()).map_err(RelabelError::Knots)?;
        for (k, w) in values.windows(2).enumerate() {
            let (before, value) = (w[0].re(), w[1].re());
            // Written so that NaN is refused.
            let ascends = value >= before;
            if !ascends {
                return Err(RelabelError::NotMonotone { index: k + 1, before, value });
            }
        }
        let mut ends = knots.as_slice().to_vec();
        ends.dedup();
        let law = Self { law: Formula::Spline { knots, values } };
        // The slope is a spline with non-negative coefficients: inside a span it vanishes
        // everywhere or nowhere.
        let middles = ends.windows(2).map(|w| 0.5 * (w[0] + w[1]));
        for t in middles.chain(ends[1..ends.len() - 1].iter().copied()) {
            // A degree of 1 has a corner there, with the slopes of both sides.
            let at_knot = law.is_straight() && ends.contains(&t);
            if !at_knot && law.jet(T::from(t), Order::First)[1].re() <= 0.0 {
                return Err(RelabelError::ZeroSlope { at: t });
            }
        }
        Ok(law)
    }

    /// The monotone piecewise cubic through (parameter, value) pairs (Fritsch and Carlson 1980):
    /// slopes of the parabolas through three neighbours, limited to the circle of radius 3 where
    /// the cubic would overshoot. The first and the last pair are fixed at (0, 0) and (1, 1).
    ///
    /// # Errors
    /// [`RelabelError`] when the lengths differ, the first pair is not (0, 0) or the last not (1,
    /// 1), the parameters do not ascend, or the values decrease or repeat.
    pub fn table(mut nodes: Vec<T>, mut values: Vec<T>) -> Result<Self, RelabelError> {
        let n = nodes.len();
        if n != values.len() || n < 2 {
            return Err(RelabelError::Lengths { parameters: n, values: values.len() });
        }
        for list in [&nodes, &values] {
            let (first, last) = (list[0].re(), list[n - 1].re());
            if (first, last) != (0.0, 1.0) {
                return Err(RelabelError::Ends { first, last });
            }
        }
        for k in 1..n {
            // Written so that NaN is refused.
            let ascends = nodes[k].re() > nodes[k - 1].re();
            if !ascends {
                return Err(RelabelError::Unordered { index: k });
            }
            let (before, value) = (values[k - 1].re(), values[k].re());
            if value == before {
                return Err(RelabelError::ZeroSlope { at: nodes[k].re() });
            }
            let ascends = value > before;
            if !ascends {
                return Err(RelabelError::NotMonotone { index: k, before, value });
            }
        }
        for list in [&mut nodes, &mut values] {
            (list[0], list[n - 1]) = (T::zero(), T::one());
        }
        let steps: Vec<T> = nodes.windows(2).map(|w| w[1] - w[0]).collect();
        let rates: Vec<T> =
            values.windows(2).zip(&steps).map(|(w, &h)| (w[1] - w[0]) / h).collect();
        let mut slopes = vec![rates[0]; n];
        if n > 2 {
            let end = |h: T, next: T, rate: T, other: T| {
                let slope = ((h * 2.0 + next) * rate - h * other) / (h + next);
                if slope.re() > 0.0 { slope } else { T::zero() }
            };
            slopes[0] = end(steps[0], steps[1], rates[0], rates[1]);
            slopes[n - 1] = end(steps[n - 2], steps[n - 3], rates[n - 2], rates[n - 3]);
            for k in 1..n - 1 {
                let (h, g) = (steps[k - 1], steps[k]);
                slopes[k] = (g * rates[k - 1] + h * rates[k]) / (h + g);
            }
        }
        for (k, &rate) in rates.iter().enumerate() {
            let (a, b) = (slopes[k] / rate, slopes[k + 1] / rate);
            let size = (a * a + b * b).sqrt();
            if size.re() > 3.0 {
                let shrink = rate * 3.0 / size;
                (slopes[k], slopes[k + 1]) = (a * shrink, b * shrink);
            }
        }
        Ok(Self { law: Formula::Table { nodes, values, slopes } })
    }

    /// (1 - weight) t + weight R(t) with R = (1 - cos pi t) / 2, 1 - cos(pi t / 2) or
    /// sin(pi t / 2), dense at both ends, the start or the end.
    ///
    /// # Errors
    /// [`RelabelError::Range`] unless the weight is in [0, 1].
    pub fn cosine(dense: Dense, weight: T) -> Result<Self, RelabelError> {
        within("weight", weight, 0.0, 1.0)?;
        Ok(Self { law: Formula::Cosine { dense, weight } })
    }

    /// (q^t - 1) / (q - 1): equal steps of t grow geometrically, the last being q times the first
    /// for infinitely many. Smooth through q = 1, where it is the identity.
    ///
    /// # Errors
    /// [`RelabelError::Range`] unless the ratio is positive and finite.
    pub fn geometric(ratio: T) -> Result<Self, RelabelError> {
        within("ratio", ratio, f64::MIN_POSITIVE, f64::MAX)?;
        Ok(Self { law: Formula::Geometric { log_ratio: ratio.ln() } })
    }

    /// The hyperbolic tangent law (Vinokur 1983): 1/2 + tanh(d (t - 1/2)) / (2 tanh(d/2)) dense at
    /// both ends, 1 + tanh(d (t-1)) / tanh d at the start, and that mirrored at the end; d is the
    /// `strength`, 0 the identity.
    ///
    /// # Errors
    /// [`RelabelError::Range`] unless the strength is in [0, 100].
    pub fn tanh(dense: Dense, strength: T) -> Result<Self, RelabelError> {
        within("strength", strength, 0.0, 100.0)?;
        Ok(Self { law: Formula::Tanh { dense, strength } })
    }

    /// R(t), with t possibly a jet.
    pub fn at<J: Jet<T>>(&self, t: J) -> J {
        match &self.law {
            Formula::Identity => t,
            Formula::Spline { knots, values } => {
                let basis = knots.basis(t, Order::Zero);
                let mut sum = J::zero();
                for (b, &value) in basis.rows[0].iter().zip(&values[basis.first..]) {
                    sum += b.scaled(value);
                }
                sum
            }
            Formula::Cosine { dense, weight } => {
                let law = match dense {
                    Dense::Both => -(t * PI).cos() * 0.5 + 0.5,
                    // 1 - cos x as the sine of the angle left: exactly 1 at the end.
                    Dense::Start => -((-t + 1.0) * FRAC_PI_2).sin() + 1.0,
                    Dense::End => (t * FRAC_PI_2).sin(),
                };
                t.scaled(-*weight + 1.0) + law.scaled(*weight)
            }
            Formula::Geometric { log_ratio } => {
                // With r = ln q: exp(r (t-1) / 2) sinh(r t / 2) / sinh(r / 2).
                let half = *log_ratio * 0.5;
                let square = -(half * half);
                let growth = (t - 1.0).scaled(half).exp();
                let share = sinc_of_sq((t * t).scaled(square)) / J::fixed(sinc_of_sq(square));
                growth * t * share
            }
            Formula::Table { nodes, values, slopes } => {
                let at = nodes.partition_point(|x| x.re() <= t.re()).clamp(1, nodes.len() - 1) - 1;
                let h = nodes[at + 1] - nodes[at];
                let x = (t - J::fixed(nodes[at])).scaled(T::one() / h);
                let y = -x + 1.0;
                // Hermite's form, exact at both ends of a piece.
                let ends = (x * x * (-x * 2.0 + 3.0)).scaled(values[at + 1])
                    + (y * y * (x * 2.0 + 1.0)).scaled(values[at]);
                let [a, b] = [slopes[at] * h, slopes[at + 1] * h];
                ends + (x * y) * (y.scaled(a) - x.scaled(b))
            }
            Formula::Tanh { dense, strength } => match dense {
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

impl<T: Real> Reparametrization<T> for ReparametrizationForm<T> {
    fn jet(&self, t: T, order: Order) -> ReparametrizationJet<T> {
        moldloft_num::reparametrization_jet_of!(self, ReparametrizationForm::at, t, order)
    }

    fn breaks(&self) -> Vec<f64> {
        match &self.law {
            Formula::Spline { knots, .. } => knots.breaks(),
            Formula::Table { nodes, .. } => {
                nodes[1..nodes.len() - 1].iter().map(|x| x.re()).collect()
            }
            _ => Vec::new(),
        }
    }

    fn is_straight(&self) -> bool {
        match &self.law {
            Formula::Identity => true,
            Formula::Spline { knots, .. } => knots.degree() == 1,
            _ => false,
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
