//! The scalar that all geometry is generic over. Transcendental functions are those of `libm`, so that the bits are
//! the same on every platform.

use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// The scalar type of all geometry: `f64`, a [`crate::Dual`], a [`crate::Rev`], or a
/// [`crate::Jet`].
///
/// Comparisons and branches look at [`Real::re`] only, so control flow is the same for every
/// scalar. Elementary functions are those of `libm`: the same bits on every platform.
pub trait Real:
    Copy
    + Debug
    + Default
    + PartialEq
    + Send
    + Sync
    + 'static
    + From<f64>
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
{
    /// Number of plain numbers in it: itself and its derivatives.
    const PARTS: usize;

    /// True when the parts after the first are first derivatives, each in a direction of its own.
    const FIRST_ORDER: bool;

    /// True when derivatives are on a tape: the parts after the first do not exist.
    const TAPED: bool = false;

    /// The real part: the number without its derivatives.
    fn re(self) -> f64;

    /// Part `k` of [`Self::PARTS`]; part 0 is the real part.
    fn part(self, k: usize) -> f64;

    /// Part `k` for decisions, such as how fine a fit must be; of numbers of a tape the derivative in one direction,
    /// which is zero by chance only.
    #[inline(always)]
    fn probe(self, k: usize) -> f64 {
        self.part(k)
    }

    /// The number whose part `k` is `part(k)`.
    fn from_parts(part: impl FnMut(usize) -> f64) -> Self;

    /// The number `value` with the derivatives of the sum of `rate * x`.
    #[inline(always)]
    fn linear(value: f64, terms: &[(f64, Self)]) -> Self {
        Self::from_parts(|k| match k {
            0 => value,
            _ => terms.iter().map(|(rate, x)| x.part(k) * rate).sum(),
        })
    }

    /// True when the number and all its derivatives are finite.
    fn is_finite(self) -> bool;

    /// True when both numbers, derivatives included, have the same bits.
    fn bits_eq(self, other: Self) -> bool;

    /// True when every derivative part is zero.
    fn is_constant(self) -> bool;

    /// Square root; the derivative at zero is infinite.
    fn sqrt(self) -> Self;
    /// Sine of an angle in radians.
    fn sin(self) -> Self;
    /// Cosine of an angle in radians.
    fn cos(self) -> Self;
    /// Tangent of an angle in radians.
    fn tan(self) -> Self;
    /// Arc sine in radians.
    fn asin(self) -> Self;
    /// Arc cosine in radians.
    fn acos(self) -> Self;
    /// Arc tangent in radians.
    fn atan(self) -> Self;
    /// Angle of the point (`x`, `self`) in radians, in (-pi, pi].
    fn atan2(self, x: Self) -> Self;
    /// Exponential.
    fn exp(self) -> Self;
    /// Natural logarithm.
    fn ln(self) -> Self;
    /// Hyperbolic sine.
    fn sinh(self) -> Self;
    /// Hyperbolic cosine.
    fn cosh(self) -> Self;
    /// Hyperbolic tangent.
    fn tanh(self) -> Self;
    /// Real power of a non-negative base.
    fn powf(self, exponent: Self) -> Self;

    /// Integer power by repeated multiplication, exact for small exponents.
    fn powi(self, exponent: i32) -> Self {
        let mut base = if exponent < 0 { Self::from(1.0) / self } else { self };
        let mut left = exponent.unsigned_abs();
        let mut power = Self::from(1.0);
        while left > 0 {
            if left & 1 == 1 {
                power *= base;
            }
            left >>= 1;
            if left > 0 {
                base *= base;
            }
        }
        power
    }

    /// Absolute value; at zero the derivative is that of `self`.
    fn abs(self) -> Self {
        if self.re() < 0.0 { -self } else { self }
    }

    /// The smaller by real part; `self` on a tie.
    fn min(self, other: Self) -> Self {
        if other.re() < self.re() { other } else { self }
    }

    /// The larger by real part; `self` on a tie.
    fn max(self, other: Self) -> Self {
        if other.re() > self.re() { other } else { self }
    }

    /// Zero.
    fn zero() -> Self {
        Self::from(0.0)
    }

    /// One.
    fn one() -> Self {
        Self::from(1.0)
    }
}

impl Real for f64 {
    const PARTS: usize = 1;
    const FIRST_ORDER: bool = true;
    #[inline(always)]
    fn re(self) -> f64 {
        self
    }
    #[inline(always)]
    fn part(self, _: usize) -> f64 {
        self
    }
    #[inline(always)]
    fn from_parts(mut part: impl FnMut(usize) -> f64) -> Self {
        part(0)
    }
    #[inline(always)]
    fn is_finite(self) -> bool {
        f64::is_finite(self)
    }
    #[inline(always)]
    fn bits_eq(self, other: Self) -> bool {
        self.to_bits() == other.to_bits()
    }
    #[inline(always)]
    fn is_constant(self) -> bool {
        true
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        // IEEE 754 demands a correctly rounded square root: the hardware's is libm's.
        f64::sqrt(self)
    }
    fn sin(self) -> Self {
        libm::sin(self)
    }
    fn cos(self) -> Self {
        libm::cos(self)
    }
    fn tan(self) -> Self {
        libm::tan(self)
    }
    fn asin(self) -> Self {
        libm::asin(self)
    }
    fn acos(self) -> Self {
        libm::acos(self)
    }
    fn atan(self) -> Self {
        libm::atan(self)
    }
    fn atan2(self, x: Self) -> Self {
        libm::atan2(self, x)
    }
    fn exp(self) -> Self {
        libm::exp(self)
    }
    fn ln(self) -> Self {
        libm::log(self)
    }
    fn sinh(self) -> Self {
        libm::sinh(self)
    }
    fn cosh(self) -> Self {
        libm::cosh(self)
    }
    fn tanh(self) -> Self {
        libm::tanh(self)
    }
    fn powf(self, exponent: Self) -> Self {
        libm::pow(self, exponent)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        f64::abs(self)
    }
}

/// Implements [`Real`] and the operators for a number `f + nilpotent` over a base scalar, from the
/// chain rule `chain(f(x), f'(x), f''(x))`. `$base` is the scalar of the parts; the implementor
/// provides `value`, `constant`, `chain`, `mul`, `zip`, `map`, `nth_part` and `of_parts`.
macro_rules! real_by_chain {
    (impl[$($gen:tt)*] $ty:ty, base = $base:ty, parts = $parts:expr, first_order = $first:expr) => {
        impl<$($gen)*> From<f64> for $ty {
            #[inline(always)]
            fn from(x: f64) -> Self { Self::constant(<$base>::from(x)) }
        }
        impl<$($gen)*> Neg for $ty {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self { self.map(|a| -a) }
        }
        impl<$($gen)*> Add for $ty {
            type Output = Self;
            #[inline(always)]
            fn add(self, o: Self) -> Self { self.zip(o, |a, b| a + b) }
        }
        impl<$($gen)*> Sub for $ty {
            type Output = Self;
            #[inline(always)]
            fn sub(self, o: Self) -> Self { self.zip(o, |a, b| a - b) }
        }
        impl<$($gen)*> Mul for $ty {
            type Output = Self;
            #[inline(always)]
            fn mul(self, o: Self) -> Self { self.times(o) }
        }
        impl<$($gen)*> Div for $ty {
            type Output = Self;
            #[inline(always)]
            fn div(self, o: Self) -> Self {
                let mut quotient = self.times(o.reciprocal());
                // The real part is the plain quotient, so every scalar takes the same branches.
                *quotient.value_mut() = self.value() / o.value();
                quotient
            }
        }
        impl<$($gen)*> Add<f64> for $ty {
            type Output = Self;
            #[inline(always)]
            fn add(mut self, o: f64) -> Self { *self.value_mut() = self.value() + o; self }
        }
        impl<$($gen)*> Sub<f64> for $ty {
            type Output = Self;
            #[inline(always)]
            fn sub(mut self, o: f64) -> Self { *self.value_mut() = self.value() - o; self }
        }
        impl<$($gen)*> Mul<f64> for $ty {
            type Output = Self;
            #[inline(always)]
            fn mul(self, o: f64) -> Self { self.map(|a| a * o) }
        }
        impl<$($gen)*> Div<f64> for $ty {
            type Output = Self;
            #[inline(always)]
            fn div(self, o: f64) -> Self { self.map(|a| a / o) }
        }
        impl<$($gen)*> AddAssign for $ty {
            #[inline(always)]
            fn add_assign(&mut self, o: Self) { *self = *self + o; }
        }
        impl<$($gen)*> SubAssign for $ty {
            #[inline(always)]
            fn sub_assign(&mut self, o: Self) { *self = *self - o; }
        }
        impl<$($gen)*> MulAssign for $ty {
            #[inline(always)]
            fn mul_assign(&mut self, o: Self) { *self = *self * o; }
        }
        impl<$($gen)*> $ty {
            #[inline(always)]
            fn reciprocal(self) -> Self {
                let r = <$base>::from(1.0) / self.value();
                self.chain(r, -(r * r), r * r * r * 2.0)
            }
        }
        impl<$($gen)*> Real for $ty {
            const PARTS: usize = $parts;
            const FIRST_ORDER: bool = $first;
            const TAPED: bool = <$base as Real>::TAPED;
            #[inline(always)]
            fn linear(value: f64, terms: &[(f64, Self)]) -> Self {
                let mut sum = Self::from(0.0);
                for (rate, x) in terms {
                    sum += x.map(|a| a * *rate);
                }
                *sum.value_mut() = <$base as Real>::linear(value, &[(1.0, sum.value())]);
                sum
            }
            #[inline(always)]
            fn re(self) -> f64 { self.value().re() }
            #[inline(always)]
            fn part(self, k: usize) -> f64 { self.nth_part(k) }
            #[inline(always)]
            fn from_parts(part: impl FnMut(usize) -> f64) -> Self { Self::of_parts(part) }
            fn is_finite(self) -> bool { self.all(|a| a.is_finite()) }
            fn bits_eq(self, o: Self) -> bool {
                let mut same = true;
                let _ = self.zip(o, |a, b| { same &= a.bits_eq(b); a });
                same
            }
            fn is_constant(self) -> bool {
                self.value().is_constant() && {
                    let mut rest = self;
                    *rest.value_mut() = <$base>::from(0.0);
                    rest.all(|a| a == <$base>::from(0.0))
                }
            }
            // The functions of the base are called by their trait: on a plain `f64` a method call
            // would be the standard library's, whose last bits differ from platform to platform.
            fn sqrt(self) -> Self {
                let s = Real::sqrt(self.value());
                let d = <$base>::from(0.5) / s;
                self.chain(s, d, -(d / self.value()) * 0.5)
            }
            fn sin(self) -> Self {
                let (s, c) = (Real::sin(self.value()), Real::cos(self.value()));
                self.chain(s, c, -s)
            }
            fn cos(self) -> Self {
                let (s, c) = (Real::sin(self.value()), Real::cos(self.value()));
                self.chain(c, -s, -c)
            }
            fn tan(self) -> Self {
                let t = Real::tan(self.value());
                let d = t * t + 1.0;
                self.chain(t, d, t * d * 2.0)
            }
            fn asin(self) -> Self {
                let x = self.value();
                let d = <$base>::from(1.0) / Real::sqrt(-(x * x) + 1.0);
                self.chain(Real::asin(x), d, x * d * d * d)
            }
            fn acos(self) -> Self {
                let x = self.value();
                let d = <$base>::from(-1.0) / Real::sqrt(-(x * x) + 1.0);
                self.chain(Real::acos(x), d, x * d * d * d)
            }
            fn atan(self) -> Self {
                let x = self.value();
                let d = <$base>::from(1.0) / (x * x + 1.0);
                self.chain(Real::atan(x), d, -(x * d * d) * 2.0)
            }
            fn atan2(self, x: Self) -> Self {
                // atan2(y, x) has the derivatives of atan(y/x) or, better conditioned where
                // |y| > |x|, of -atan(x/y); only the value differs by a constant.
                let mut angle = if self.re().abs() > x.re().abs() {
                    -(x / self).atan()
                } else {
                    (self / x).atan()
                };
                *angle.value_mut() = Real::atan2(self.value(), x.value());
                angle
            }
            fn exp(self) -> Self {
                let e = Real::exp(self.value());
                self.chain(e, e, e)
            }
            fn ln(self) -> Self {
                let d = <$base>::from(1.0) / self.value();
                self.chain(Real::ln(self.value()), d, -(d * d))
            }
            fn sinh(self) -> Self {
                let (s, c) = (Real::sinh(self.value()), Real::cosh(self.value()));
                self.chain(s, c, s)
            }
            fn cosh(self) -> Self {
                let (s, c) = (Real::sinh(self.value()), Real::cosh(self.value()));
                self.chain(c, s, c)
            }
            fn tanh(self) -> Self {
                let t = Real::tanh(self.value());
                let d = -(t * t) + 1.0;
                self.chain(t, d, -(t * d) * 2.0)
            }
            fn powf(self, exponent: Self) -> Self {
                let x = self.value();
                // x^p ln x, the derivative by the exponent, tends to 0 with x.
                if exponent.is_constant() || (x.re() == 0.0 && exponent.re() > 0.0) {
                    let e = exponent.value();
                    let slope = |k: $base, value: $base| if k.re() == 0.0 { <$base>::from(0.0) } else { value };
                    let d1 = slope(e, e * Real::powf(x, e - 1.0));
                    let d2 = slope(e * (e - 1.0), e * (e - 1.0) * Real::powf(x, e - 2.0));
                    return self.chain(Real::powf(x, e), d1, d2);
                }
                let mut power = (self.ln() * exponent).exp();
                *power.value_mut() = Real::powf(x, exponent.value());
                power
            }
        }
    };
}
pub(crate) use real_by_chain;
