//! Even functions, as entire functions of the square: smooth where the root is not, and the same
//! formula for circular (positive square) and hyperbolic (negative square) arguments.

use moldloft_num::Real;

/// Below this |q| the Taylor series is used: its terms then fall fast and without cancellation.
const SERIES: f64 = 1.0;

/// The factors 1 / ((k0 + 2k - 1) (k0 + 2k)) of the series for k = 1 … 12. Made beforehand: twelve
/// quotients took longer than all the rest of a sum.
const fn factors(k0: f64) -> [f64; 12] {
    let mut all = [0.0; 12];
    let mut k = 0;
    while k < 12 {
        let n = k0 + 2.0 * (k as f64 + 1.0);
        all[k] = 1.0 / (n * (n - 1.0));
        k += 1;
    }
    all
}

const SINE: [f64; 12] = factors(1.0);
const COSINE: [f64; 12] = factors(0.0);

/// Horner's rule for the series sum of (-q)^k / ((k0 + 1) (k0 + 2) … (k0 + 2k)).
#[inline(always)]
fn series<T: Real>(q: T, factors: &[f64; 12]) -> T {
    // Twelve terms: the first left out is below 1 / 24! < 1e-23.
    let mut sum = T::one();
    for &factor in factors.iter().rev() {
        sum = -(q * sum) * factor + 1.0;
    }
    sum
}

/// sin(sqrt q) / sqrt q; for negative q it is sinh(sqrt -q) / sqrt -q.
#[inline(always)]
pub(crate) fn sinc_of_sq<T: Real>(q: T) -> T {
    if q.re().abs() < SERIES {
        series(q, &SINE)
    } else if q.re() > 0.0 {
        let r = q.sqrt();
        r.sin() / r
    } else {
        let r = (-q).sqrt();
        r.sinh() / r
    }
}

/// cos(sqrt q); for negative q it is cosh(sqrt -q).
#[inline(always)]
pub(crate) fn cos_of_sq<T: Real>(q: T) -> T {
    if q.re().abs() < SERIES {
        series(q, &COSINE)
    } else if q.re() > 0.0 {
        q.sqrt().cos()
    } else {
        (-q).sqrt().cosh()
    }
}

/// atan(sqrt q) / sqrt q for q >= 0.
pub(crate) fn atanc_of_sq<T: Real>(q: T) -> T {
    if q.re() < 0.04 {
        // Terms (-q)^k / (2 k + 1): the first left out, k = 12, is below 7e-19.
        (0..12).rev().fold(T::zero(), |sum, k| -(q * sum) + 1.0 / f64::from(2 * k + 1))
    } else {
        let r = q.sqrt();
        r.atan() / r
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use moldloft_num::Dual;

    #[test]
    fn series_and_closed_form_meet() {
        let at = |q: f64| Dual::<1>::seeded(q, 0);
        for (low, high) in [(1.0 - 1e-12, 1.0 + 1e-12), (-1.0 + 1e-12, -1.0 - 1e-12)] {
            for f in [sinc_of_sq, cos_of_sq] {
                let (a, b) = (f(at(low)), f(at(high)));
                assert!((a.re - b.re).abs() < 2e-12 && (a.eps[0] - b.eps[0]).abs() < 1e-12);
            }
        }
        let (a, b) = (atanc_of_sq(at(0.04 - 1e-13)), atanc_of_sq(at(0.04 + 1e-13)));
        assert!((a.re - b.re).abs() < 1e-12 && (a.eps[0] - b.eps[0]).abs() < 1e-11);
    }

    #[test]
    fn values_are_the_known_ones() {
        let x = 0.7f64;
        assert!((sinc_of_sq(x * x) - x.sin() / x).abs() < 2e-16);
        assert!((sinc_of_sq(-x * x) - x.sinh() / x).abs() < 3e-16);
        assert!((cos_of_sq(x * x) - x.cos()).abs() < 2e-16);
        assert!((cos_of_sq(-9.0) - 3f64.cosh()).abs() < 1e-14);
        assert!((atanc_of_sq(0.01) - 0.1f64.atan() / 0.1).abs() < 2e-16);
        assert_eq!(sinc_of_sq(Dual::<1>::seeded(0.0, 0)).eps[0], -1.0 / 6.0);
    }
}
