//! Rational B-spline curves whose knots are scalars, so that derivatives by the knots are known.

use crate::curve::SplineError;
use crate::{KnotError, KnotVector, MAX_DEGREE};
use moldloft_num::{Banded, CurveFormula, Jet, Order, Rational, Real, Vec3};
use smallvec::{SmallVec, smallvec};

/// A rational B-spline curve on [0, 1] whose knots may carry derivatives. Outside, the polynomial
/// of the first or last span continues.
///
/// [`crate::BSplineCurve`] is quicker where the knots are plain numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct SplineWithKnotDerivatives<T> {
    degree: usize,
    knots: Vec<T>,
    /// The points times their weights, and the weights.
    points: Vec<(Vec3<T>, T)>,
    rational: bool,
}

impl<T: Real> SplineWithKnotDerivatives<T> {
    /// The curve of these control points; knots with any range (default: clamped and uniform) and
    /// weights (default: 1).
    ///
    /// # Errors
    /// [`SplineError`] when they do not fit each other or are not finite.
    pub fn new(
        degree: usize,
        knots: Option<Vec<T>>,
        points: Vec<Vec3<T>>,
        weights: Option<Vec<T>>,
    ) -> Result<Self, SplineError> {
        if !(1..=MAX_DEGREE).contains(&degree) {
            return Err(KnotError::Degree { degree }.into());
        }
        let count = points.len();
        let knots = match knots {
            Some(knots) => knots,
            None => {
                let uniform = KnotVector::clamped_uniform(degree, count)?;
                uniform.as_slice().iter().map(|&k| T::from(k)).collect()
            }
        };
        // The plain knots are checked as those of any other spline.
        let plain = KnotVector::new(degree, knots.iter().map(|k| k.re()).collect())?;
        if plain.points() != count {
            return Err(SplineError::Count { expected: plain.points(), actual: count });
        }
        if let Some(index) = points.iter().position(|p| !p.is_finite()) {
            return Err(SplineError::NotFinite { index });
        }
        if let Some(weights) = &weights {
            if weights.len() != count {
                return Err(SplineError::Count { expected: count, actual: weights.len() });
            }
            for (index, w) in weights.iter().enumerate() {
                if !(w.is_finite() && w.re() > 0.0) {
                    return Err(SplineError::Weight { index, weight: w.re() });
                }
            }
        }
        let (start, end) = (knots[degree], knots[count]);
        let scale = end - start;
        let knots =
            knots.into_iter().map(|k| if k.bits_eq(end) { T::one() } else { (k - start) / scale });
        let knots = knots.collect();
        let rational = weights.is_some();
        let weights = weights.unwrap_or_else(|| vec![T::one(); count]);
        let points = points.into_iter().zip(weights).map(|(p, w)| (p * w, w)).collect();
        Ok(Self { degree, knots, points, rational })
    }

    /// The control points of a curve without weights.
    pub fn control_points(&self) -> impl Iterator<Item = Vec3<T>> + '_ {
        self.points.iter().map(|(p, _)| *p)
    }

    /// True if the curve starts at its first control point and ends at its last.
    pub fn clamped_ends(&self) -> [bool; 2] {
        let (p, n) = (self.degree, self.points.len());
        let all = |from: usize, to: usize| {
            (from..to).all(|k| self.knots[k].re() == self.knots[k + 1].re())
        };
        [all(0, p), all(n, n + p)]
    }

    /// The polynomial curve with a given number of control points that fits samples (parameter,
    /// position) by least squares, and starts and ends at the first and the last sample; knots as
    /// for [`SplineWithKnotDerivatives::new`], which must be clamped.
    ///
    /// # Errors
    /// [`SplineError`] for knots that do not fit, [`SplineError::Count`] when the samples leave a
    /// control point undetermined.
    pub fn fitted(
        degree: usize,
        knots: Option<Vec<T>>,
        points: usize,
        samples: &[(f64, Vec3<T>)],
    ) -> Result<Self, SplineError> {
        let few = || SplineError::Count { expected: points, actual: samples.len() };
        let (Some(first), Some(last)) = (samples.first(), samples.last()) else {
            return Err(few());
        };
        let mut curve = Self::new(degree, knots, vec![Vec3::zero(); points], None)?;
        let inner = points.saturating_sub(2);
        let mut matrix = Banded::<T>::zero(inner, degree.min(inner.saturating_sub(1)));
        let mut right = vec![Vec3::zero(); inner];
        let of_inner = |k: usize| (1..=inner).contains(&k).then(|| k - 1);
        for &(t, sample) in samples {
            let (begin, basis) = curve.basis(T::from(t));
            let mut rest = sample;
            for (r, &b) in basis.iter().enumerate() {
                match begin + r {
                    0 => rest -= first.1 * b,
                    k if k == points - 1 => rest -= last.1 * b,
                    _ => {}
                }
            }
            for (r, &b) in basis.iter().enumerate() {
                let Some(row) = of_inner(begin + r) else { continue };
                right[row] += rest * b;
                for (c, &a) in basis.iter().enumerate() {
                    if let Some(column) = of_inner(begin + c) {
                        *matrix.entry(row, column) += a * b;
                    }
                }
            }
        }
        if inner > 0 {
            matrix.solve(&mut right).map_err(|_| few())?;
        }
        if !right.iter().all(|p| p.is_finite()) {
            return Err(few());
        }
        for (k, p) in right.into_iter().enumerate() {
            curve.points[k + 1].0 = p;
        }
        curve.points[0].0 = first.1;
        curve.points[points - 1].0 = last.1;
        Ok(curve)
    }

    /// Index of the first basis function that does not vanish at `t`, and the values of it and
    /// the others (Piegl and Tiller 1997, A2.2).
    fn basis(&self, t: T) -> (usize, SmallVec<[T; 8]>) {
        let (p, k) = (self.degree, self.span(t.re()));
        let mut values: SmallVec<[T; 8]> = smallvec![T::one()];
        for degree in 1..=p {
            let mut saved = T::zero();
            for (r, value) in values.iter_mut().enumerate() {
                let (left, right) = (self.knots[k + 1 + r - degree], self.knots[k + r + 1]);
                let share = *value / (right - left);
                *value = saved + (right - t) * share;
                saved = (t - left) * share;
            }
            values.push(saved);
        }
        (k - p, values)
    }

    /// The span in charge at `t`: that of the last knot of the domain not above it.
    fn span(&self, t: f64) -> usize {
        let (p, n) = (self.degree, self.points.len());
        let inner = &self.knots[p + 1..n];
        let k = p + inner.iter().filter(|k| k.re() <= t).count();
        // Repeated knots: the last of equal ones, but a span of some width.
        let mut k = k;
        while self.knots[k].re() >= self.knots[k + 1].re() && k > p {
            k -= 1;
        }
        k
    }
}

impl<T: Real> CurveFormula for SplineWithKnotDerivatives<T> {
    type Scalar = T;

    /// De Boor's algorithm (de Boor 1978, ch. X).
    fn at<J: Jet<T>>(&self, t: J) -> Vec3<J> {
        let (p, k) = (self.degree, self.span(t.re()));
        let mut d: SmallVec<[(Vec3<J>, J); 8]> =
            self.points[k - p..=k].iter().map(|(x, w)| (x.map(J::fixed), J::fixed(*w))).collect();
        for level in 1..=p {
            for j in (level..=p).rev() {
                let (low, high) = (self.knots[k - p + j], self.knots[k + 1 + j - level]);
                let share = (t - J::fixed(low)) / J::fixed(high - low);
                let rest = -share + 1.0;
                d[j] = (d[j - 1].0 * rest + d[j].0 * share, d[j - 1].1 * rest + d[j].1 * share);
            }
        }
        let (x, w) = d[p];
        if self.rational { x / w } else { x }
    }

    fn breaks(&self) -> Vec<f64> {
        let (p, n) = (self.degree, self.points.len());
        let mut breaks: Vec<f64> = self.knots[p + 1..n].iter().map(|k| k.re()).collect();
        breaks.retain(|t| *t > 0.0 && *t < 1.0);
        breaks.dedup();
        breaks
    }

    fn rational(&self) -> Rational<1> {
        let knots = KnotVector::new(self.degree, self.knots.iter().map(|k| k.re()).collect());
        let Some(knots) = knots.ok().filter(|_| self.rational) else { return Rational::none() };
        let weights: Vec<f64> = self.points.iter().map(|(_, w)| w.re()).collect();
        let weight = move |[t]: [f64; 1]| {
            let basis = knots.basis(t, Order::Zero);
            basis.rows[0].iter().zip(&weights[basis.first..]).map(|(b, w)| b * w).sum()
        };
        Rational { weight: Some(Box::new(weight)), ..Rational::none() }
    }

    moldloft_num::curve_facts!(broken, open);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::BSplineCurve;
    use moldloft_num::{Curve, Dual};

    fn points(n: usize) -> Vec<Vec3> {
        (0..n).map(|k| Vec3::of(k as f64, (k * k % 5) as f64, 0.3 * k as f64)).collect()
    }

    #[test]
    fn it_is_the_plain_spline_where_knots_are_plain() {
        for degree in 1..=5 {
            let n = degree + 4;
            let knots = KnotVector::clamped_uniform(degree, n).unwrap();
            let weights: Vec<f64> = (0..n).map(|k| 1.0 + 0.2 * (k % 3) as f64).collect();
            let plain = BSplineCurve::new(knots.clone(), points(n), Some(weights.clone())).unwrap();
            let shifted = knots.as_slice().iter().map(|k| 3.0 + 2.0 * k).collect();
            let moving =
                SplineWithKnotDerivatives::new(degree, Some(shifted), points(n), Some(weights))
                    .unwrap();
            assert_eq!(moving.clamped_ends(), [true, true]);
            for t in [-0.1, 0.0, 0.21, 0.5, 0.77, 1.0, 1.05] {
                let (a, b) = (plain.jet(t, Order::Second), moving.jet(t, Order::Second));
                for k in 0..3 {
                    assert!((a[k] - b[k]).norm() < 1e-10 * (1.0 + a[k].norm()), "{degree} {t} {k}");
                }
            }
        }
    }

    #[test]
    fn weights_make_a_quarter_circle() {
        let points = [[1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| Vec3::of(x, y, 0.0));
        let weights = vec![1.0, 0.5f64.sqrt(), 1.0];
        let arc = SplineWithKnotDerivatives::new(2, None, points.to_vec(), Some(weights)).unwrap();
        for t in [0.0, 0.3, 0.5, 0.9, 1.0] {
            assert!((arc.jet(t, Order::Zero)[0].norm() - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn knots_have_derivatives() {
        type D = Dual<1>;
        let at = |x: D| {
            let knots = [0.0, 0.0, 0.0, 0.4, 0.7, 1.0, 1.0, 1.0];
            let mut knots: Vec<D> = knots.iter().map(|&k| D::from(k)).collect();
            knots[3] = x;
            let points = points(5).into_iter().map(Vec3::lifted).collect();
            let curve = SplineWithKnotDerivatives::new(2, Some(knots), points, None).unwrap();
            curve.jet(D::from(0.5), Order::First)
        };
        let (h, exact) = (1e-6, at(D::seeded(0.4, 0)));
        let (high, low) = (at(D::from(0.4 + h)), at(D::from(0.4 - h)));
        for k in 0..2 {
            let centred = (high[k] - low[k]).map(|x| x.re * 0.5 / h);
            assert!((exact[k].map(|x| x.eps[0]) - centred).norm() < 1e-8);
        }
    }

    #[test]
    fn fits_reproduce_what_they_can() {
        // A cubic with a knot where the fit has one.
        let knots = vec![0.0, 0.0, 0.0, 0.0, 0.3, 1.0, 1.0, 1.0, 1.0];
        let curve =
            SplineWithKnotDerivatives::new(3, Some(knots.clone()), points(5), None).unwrap();
        let samples: Vec<_> = (0..=40)
            .map(|k| f64::from(k) / 40.0)
            .map(|t| (t, curve.jet(t, Order::Zero)[0]))
            .collect();
        let fit = SplineWithKnotDerivatives::fitted(3, Some(knots), 5, &samples).unwrap();
        for t in [0.0, 0.17, 0.5, 0.99, 1.0] {
            let d = fit.jet(t, Order::Zero)[0].distance(curve.jet(t, Order::Zero)[0]);
            assert!(d < 1e-13, "{t} {d}");
        }
        // The error of a smooth curve falls with the fourth power of the spans.
        let gap = |n: usize| {
            let samples: Vec<_> = (0..=400)
                .map(|k| f64::from(k) / 400.0)
                .map(|t| (t, Vec3::of(Real::sin(3.0 * t), Real::cos(3.0 * t), t)))
                .collect();
            let fit = SplineWithKnotDerivatives::fitted(3, None, n, &samples).unwrap();
            let far = |(t, p): &(f64, Vec3)| fit.jet(*t, Order::Zero)[0].distance(*p);
            samples.iter().map(far).fold(0.0, f64::max)
        };
        let ratio = gap(3 + 8) / gap(3 + 16);
        assert!(ratio > 12.0 && ratio < 20.0, "{ratio}");
        assert!(SplineWithKnotDerivatives::fitted(3, None, 40, &samples[..10]).is_err());
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let of = |knots: &[f64], weights: &[f64]| {
            SplineWithKnotDerivatives::new(
                2,
                Some(knots.to_vec()),
                points(3),
                Some(weights.to_vec()),
            )
            .err()
        };
        let sound = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
        assert_eq!(of(&sound, &[1.0; 3]), None);
        assert!(matches!(of(&sound, &[1.0, 0.0, 1.0]), Some(SplineError::Weight { index: 1, .. })));
        assert!(matches!(of(&sound, &[1.0; 2]), Some(SplineError::Count { .. })));
        assert!(of(&[0.0, 0.0, 0.5, 0.4, 1.0, 1.0], &[1.0; 3]).is_some());
        assert!(of(&sound[..5], &[1.0; 3]).is_some());
    }
}
