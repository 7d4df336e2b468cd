//! Dual numbers: a value with its exact first derivatives in several directions.

use crate::real::{Real, real_by_chain};
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// A number with its exact first derivatives in `N` directions (forward differentiation).
///
/// # Example
/// ```
/// use moldloft_num::{Dual, Real};
/// let x = Dual::<2>::seeded(3.0, 0);
/// let y = Dual::<2>::seeded(4.0, 1);
/// let length = (x * x + y * y).sqrt();
/// assert_eq!(length.re, 5.0);
/// assert!((length.eps[0] - 0.6).abs() < 1e-15 && (length.eps[1] - 0.8).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<const N: usize> {
    /// The number itself.
    pub re: f64,
    /// Its derivative in each direction.
    pub eps: [f64; N],
}

/// The dual number for derivatives in four directions at once.
pub type Dual4 = Dual<4>;

impl<const N: usize> Default for Dual<N> {
    fn default() -> Self {
        Self { re: 0.0, eps: [0.0; N] }
    }
}

impl<const N: usize> Dual<N> {
    /// `re` with derivative 1 in `direction` and 0 in the others.
    ///
    /// # Panics
    /// When `direction >= N`.
    pub fn seeded(re: f64, direction: usize) -> Self {
        let mut eps = [0.0; N];
        eps[direction] = 1.0;
        Self { re, eps }
    }

    #[inline(always)]
    fn constant(re: f64) -> Self {
        Self { re, eps: [0.0; N] }
    }
    #[inline(always)]
    fn value(self) -> f64 {
        self.re
    }
    #[inline(always)]
    fn value_mut(&mut self) -> &mut f64 {
        &mut self.re
    }
    #[inline(always)]
    fn chain(self, f: f64, d1: f64, _d2: f64) -> Self {
        let mut eps = self.eps;
        for e in &mut eps {
            // A zero direction stays zero where the slope is infinite (sqrt at 0).
            *e = if *e == 0.0 { 0.0 } else { *e * d1 };
        }
        Self { re: f, eps }
    }
    #[inline(always)]
    fn times(self, o: Self) -> Self {
        let mut eps = [0.0; N];
        for k in 0..N {
            eps[k] = self.eps[k] * o.re + self.re * o.eps[k];
        }
        Self { re: self.re * o.re, eps }
    }
    #[inline(always)]
    fn zip(self, o: Self, mut f: impl FnMut(f64, f64) -> f64) -> Self {
        let mut eps = [0.0; N];
        for k in 0..N {
            eps[k] = f(self.eps[k], o.eps[k]);
        }
        Self { re: f(self.re, o.re), eps }
    }
    #[inline(always)]
    fn map(self, mut f: impl FnMut(f64) -> f64) -> Self {
        let mut eps = self.eps;
        for e in &mut eps {
            *e = f(*e);
        }
        Self { re: f(self.re), eps }
    }
    #[inline(always)]
    fn nth_part(self, k: usize) -> f64 {
        if k == 0 { self.re } else { self.eps[k - 1] }
    }
    #[inline(always)]
    fn of_parts(mut part: impl FnMut(usize) -> f64) -> Self {
        Self { re: part(0), eps: std::array::from_fn(|k| part(k + 1)) }
    }
    fn all(self, f: impl Fn(f64) -> bool) -> bool {
        f(self.re) && self.eps.iter().all(|&e| f(e))
    }
}

real_by_chain!(impl[const N: usize] Dual<N>, base = f64, parts = N + 1, first_order = true);

#[cfg(test)]
mod tests {
    use super::*;

    type D = Dual<1>;

    /// Every elementary function against central differences.
    #[test]
    fn derivatives_equal_central_differences() {
        let functions: &[(&str, fn(D) -> D, f64)] = &[
            ("sqrt", D::sqrt, 0.7),
            ("sin", D::sin, 0.7),
            ("cos", D::cos, 0.7),
            ("tan", D::tan, 0.7),
            ("asin", D::asin, 0.3),
            ("acos", D::acos, 0.3),
            ("atan", D::atan, 1.3),
            ("exp", D::exp, 0.7),
            ("ln", D::ln, 0.7),
            ("sinh", D::sinh, 0.7),
            ("cosh", D::cosh, 0.7),
            ("tanh", D::tanh, 0.7),
            ("powf", |x| x.powf(D::from(1.7)), 0.7),
            ("powx", |x| x.powf(x), 0.7),
            ("powi", |x| x.powi(-3), 0.7),
            ("atan2 steep", |x| x.atan2(D::from(0.2)), 0.7),
            ("atan2 left", |x| x.atan2(D::from(-2.0)), 0.7),
            ("abs", D::abs, -0.7),
            ("quotient", |x| D::from(2.0) / (x + 1.0), 0.7),
        ];
        for (name, f, x) in functions {
            let h = 1e-6;
            let exact = f(D::seeded(*x, 0)).eps[0];
            let centred = (f(D::from(x + h)).re - f(D::from(x - h)).re) / (2.0 * h);
            assert!((exact - centred).abs() < 1e-8, "{name}: {exact} against {centred}");
        }
    }

    #[test]
    fn a_power_of_zero_does_not_change_with_its_exponent() {
        let power = D::from(0.0).powf(D::seeded(2.2, 0));
        assert_eq!((power.re, power.eps[0]), (0.0, 0.0));
        // By the base it is as with a constant exponent.
        assert_eq!(D::seeded(0.0, 0).powf(D::seeded(1.0, 0)).eps[0], 1.0);
    }

    #[test]
    fn functions_have_the_bits_of_the_plain_ones() {
        for k in 1..400 {
            let x = f64::from(k) * 0.0173;
            let (d, e) = (D::seeded(x, 0), D::seeded(1.3, 0));
            let pairs = [
                (d.sin().re, Real::sin(x)),
                (d.cos().re, Real::cos(x)),
                (d.tan().re, Real::tan(x)),
                (d.exp().re, Real::exp(x)),
                (d.ln().re, Real::ln(x)),
                (d.sinh().re, Real::sinh(x)),
                (d.cosh().re, Real::cosh(x)),
                (d.tanh().re, Real::tanh(x)),
                (d.atan().re, Real::atan(x)),
                ((d * 0.1).asin().re, Real::asin(x * 0.1)),
                ((d * 0.1).acos().re, Real::acos(x * 0.1)),
                (d.atan2(e).re, Real::atan2(x, 1.3)),
                (d.powf(e).re, Real::powf(x, 1.3)),
                (d.powf(D::from(1.3)).re, Real::powf(x, 1.3)),
            ];
            for (dual, plain) in pairs {
                assert_eq!(dual.to_bits(), plain.to_bits());
            }
        }
    }

    #[test]
    fn real_part_is_the_plain_result() {
        let (a, b) = (D::seeded(0.1, 0), D::seeded(0.3, 0));
        assert_eq!((a / b).re.to_bits(), (0.1f64 / 0.3).to_bits());
        assert_eq!((a * b - a).re.to_bits(), (0.1f64 * 0.3 - 0.1).to_bits());
        assert!(D::from(2.0).is_constant() && !a.is_constant());
        assert_eq!(D::from_parts(|k| a.part(k)), a);
    }

    #[test]
    fn a_direction_that_is_not_asked_stays_zero_at_a_kink() {
        assert_eq!(D::from(0.0).sqrt().eps, [0.0]);
        assert!(!D::seeded(0.0, 0).sqrt().is_finite());
    }
}
