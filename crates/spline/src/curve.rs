//! B-spline curves of any degree, rational ones among them.

use crate::{Basis, KnotError, KnotVector, PiecewiseCubic};
use moldloft_num::{Curve, CurveJet, Order, Rational, Real, Vec3};
use std::fmt;

/// Reason why there is no such spline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SplineError {
    /// The knots are at fault.
    Knots(KnotError),
    /// The knots do not cover exactly [0, 1]; see [`KnotVector::normalized`].
    Domain {
        /// The first parameter.
        start: f64,
        /// The last parameter.
        end: f64,
    },
    /// The number of control points or weights does not fit the knots.
    Count {
        /// The number required by the knots.
        expected: usize,
        /// The number given.
        actual: usize,
    },
    /// A control point is NaN or infinite.
    NotFinite {
        /// Its index.
        index: usize,
    },
    /// A weight is not a positive number.
    Weight {
        /// Its index.
        index: usize,
        /// The weight.
        weight: f64,
    },
    /// The parameter of a split or insertion is not inside (0, 1).
    Outside {
        /// The parameter.
        t: f64,
    },
}

impl From<KnotError> for SplineError {
    fn from(error: KnotError) -> Self {
        Self::Knots(error)
    }
}

impl fmt::Display for SplineError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // For people, who count from one.
        match *self {
            Self::Knots(error) => error.fmt(f),
            Self::Domain { start, end } => {
                write!(f, "expected knots over [0, 1], found [{start}, {end}]")
            }
            Self::Count { expected, actual } => {
                write!(f, "expected {expected} control points and weights, found {actual}")
            }
            Self::NotFinite { index } => write!(f, "control point {} is not finite", index + 1),
            Self::Weight { index, weight } => {
                write!(f, "weight {} is {weight}, expected a positive number", index + 1)
            }
            Self::Outside { t } => write!(f, "expected a parameter inside (0, 1), found {t}"),
        }
    }
}

impl std::error::Error for SplineError {}

/// Checks for both curves and surfaces.
pub(crate) fn check_net<T: Real>(
    knots: &[&KnotVector],
    points: &[Vec3<T>],
    weights: Option<&[T]>,
) -> Result<(), SplineError> {
    for k in knots {
        let (start, end) = k.domain();
        if (start, end) != (0.0, 1.0) {
            return Err(SplineError::Domain { start, end });
        }
    }
    let expected = knots.iter().map(|k| k.points()).product();
    for actual in [points.len(), weights.map_or(expected, <[T]>::len)] {
        if actual != expected {
            return Err(SplineError::Count { expected, actual });
        }
    }
    if let Some(index) = points.iter().position(|p| !p.is_finite()) {
        return Err(SplineError::NotFinite { index });
    }
    for (index, w) in weights.unwrap_or_default().iter().enumerate() {
        if !(w.is_finite() && w.re() > 0.0) {
            return Err(SplineError::Weight { index, weight: w.re() });
        }
    }
    Ok(())
}

/// A B-spline curve of any degree on [0, 1], rational if it has weights.
///
/// Outside [0, 1] the polynomial of the first or last span continues.
#[derive(Clone, Debug, PartialEq)]
pub struct BSplineCurve<T> {
    pub(crate) knots: KnotVector,
    pub(crate) points: Vec<Vec3<T>>,
    pub(crate) weights: Option<Vec<T>>,
}

impl<T: Real> BSplineCurve<T> {
    /// The curve of these knots (over [0, 1]), control points and optional weights.
    ///
    /// # Errors
    /// [`SplineError`] when they do not fit each other or are not finite.
    pub fn new(
        knots: KnotVector,
        control_points: Vec<Vec3<T>>,
        weights: Option<Vec<T>>,
    ) -> Result<Self, SplineError> {
        check_net(&[&knots], &control_points, weights.as_deref())?;
        Ok(Self { knots, points: control_points, weights })
    }

    /// The polynomial curve with clamped uniform knots.
    ///
    /// # Errors
    /// [`SplineError`] when there are at most `degree` points or one is not finite.
    pub fn uniform(degree: usize, control_points: Vec<Vec3<T>>) -> Result<Self, SplineError> {
        let knots = KnotVector::clamped_uniform(degree, control_points.len())?;
        Self::new(knots, control_points, None)
    }

    /// The polynomial degree.
    pub fn degree(&self) -> usize {
        self.knots.degree()
    }

    /// The knots.
    pub fn knots(&self) -> &KnotVector {
        &self.knots
    }

    /// The control points.
    pub fn control_points(&self) -> &[Vec3<T>] {
        &self.points
    }

    /// The weights, for a rational curve.
    pub fn weights(&self) -> Option<&[T]> {
        self.weights.as_deref()
    }

    /// The same curve as polynomials between its knots, which are faster to evaluate; `None` for
    /// degrees above 3, weights or multiple interior knots.
    pub fn power_form(&self) -> Option<PiecewiseCubic<T>> {
        let knots = &self.knots.as_slice()[self.degree()..=self.knots.points()];
        let simple = knots.is_sorted_by(|a, b| a < b);
        if self.degree() > 3 || self.weights.is_some() || !simple {
            return None;
        }
        let jets: Vec<CurveJet<T>> =
            knots.iter().map(|&t| self.jet(T::from(t), Order::Second)).collect();
        let coefficients = knots.windows(2).zip(jets.windows(2)).map(|(knots, jets)| {
            let [a, b, second] = jets[0];
            // The second derivative is continuous, and linear between simple knots of a cubic.
            let d = if self.degree() == 3 {
                let shrink = T::from(6.0 * (knots[1] - knots[0]));
                (jets[1][2] - second) / shrink
            } else {
                Vec3::zero()
            };
            let half = T::from(0.5);
            [a, b, if self.degree() == 1 { Vec3::zero() } else { second * half }, d]
        });
        let end = jets[jets.len() - 1][0];
        let knots: Vec<T> = knots.iter().map(|&t| T::from(t)).collect();
        Some(PiecewiseCubic::closed_off(&knots, coefficients.collect(), end))
    }

    /// The jet from basis functions; `times` multiplies a coordinate with a basis function, which
    /// is a plain number wherever the parameter is.
    #[inline(always)]
    fn combine<S: Real>(&self, basis: &Basis<S>, times: impl Fn(T, S) -> T) -> CurveJet<T> {
        let mut a = CurveJet::default();
        let Some(weights) = &self.weights else {
            for (a, row) in a.iter_mut().zip(&basis.rows) {
                for (&b, p) in row.iter().zip(&self.points[basis.first..]) {
                    *a += p.map(|x| times(x, b));
                }
            }
            return a;
        };
        let mut w = [T::zero(); 3];
        for (k, row) in basis.rows.iter().enumerate() {
            for (r, &b) in row.iter().enumerate() {
                let share = times(weights[basis.first + r], b);
                a[k] += self.points[basis.first + r] * share;
                w[k] += share;
            }
        }
        quotient(a, w)
    }
}

/// The jet of a(t) / w(t) (Piegl and Tiller 1997, eq. 4.8).
#[inline(always)]
fn quotient<T: Real>(a: CurveJet<T>, w: [T; 3]) -> CurveJet<T> {
    let c = a[0] / w[0];
    let d = (a[1] - c * w[1]) / w[0];
    [c, d, (a[2] - d * (w[1] * 2.0) - c * w[2]) / w[0]]
}

impl<T: Real> Curve<T> for BSplineCurve<T> {
    fn jet(&self, t: T, order: Order) -> CurveJet<T> {
        if t.is_constant() {
            self.combine(&self.knots.basis(t.re(), order), |x, b: f64| x * b)
        } else {
            self.combine(&self.knots.basis(t, order), |x, b: T| x * b)
        }
    }

    fn grid(&self, ts: &[f64], out: &mut [Vec3<T>]) {
        for (x, &t) in out.iter_mut().zip(ts) {
            *x = self.combine(&self.knots.basis(t, Order::Zero), |x, b: f64| x * b)[0];
        }
    }

    fn breaks(&self) -> Vec<f64> {
        self.knots.breaks()
    }

    fn joints(&self) -> Vec<f64> {
        self.knots.joints()
    }

    fn rational(&self) -> Rational<1> {
        let Some(weights) = &self.weights else { return Rational::none() };
        let weights: Vec<f64> = weights.iter().map(|w| w.re()).collect();
        let knots = self.knots.clone();
        let weight = move |[t]: [f64; 1]| {
            let basis = knots.basis(t, Order::Zero);
            basis.rows[0].iter().zip(&weights[basis.first..]).map(|(b, w)| b * w).sum()
        };
        Rational { weight: Some(Box::new(weight)), ..Rational::none() }
    }

    moldloft_num::curve_facts!(kinks_at_breaks, open);
}

#[cfg(test)]
mod tests {
    use super::*;
    use moldloft_num::Dual;

    #[test]
    fn the_power_form_is_the_same_curve() {
        for degree in 1..=3 {
            for n in degree + 1..degree + 8 {
                let point = |k: usize| {
                    let x = Dual::<2>::seeded((k * k) as f64 * 0.3 - k as f64, k % 2);
                    Vec3::new(x, x * 0.5 + 1.0, Dual::from((k as f64).sin()))
                };
                let curve = BSplineCurve::uniform(degree, (0..n).map(point).collect()).unwrap();
                let power = curve.power_form().expect("low degree, simple knots");
                for step in -1..=41 {
                    let t = Dual::from(step as f64 / 40.0);
                    let (a, b) = (curve.jet(t, Order::Second), power.jet(t, Order::Second));
                    for (order, (a, b)) in a.into_iter().zip(b).enumerate() {
                        let scale = (n as f64).powi(2 + order as i32);
                        assert!((a - b).re().norm() < 1e-14 * scale, "{degree} {n} {step}");
                        for k in 0..2 {
                            let gap = (a - b).map(|x| x.eps[k]).norm();
                            assert!(gap < 1e-14 * scale, "{degree} {n} {step}");
                        }
                    }
                }
            }
        }
        let quartic = BSplineCurve::<f64>::uniform(4, vec![Vec3::zero(); 9]).unwrap();
        assert!(quartic.power_form().is_none());
    }
}
