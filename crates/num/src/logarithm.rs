//! The logarithm to the base 10: of programs and of dimensions alike.

use crate::Real;

/// log₁₀ x, an integer for powers of ten (ln x / ln 10 is 2.9999999999999996 for 1000), with the
/// derivatives of ln x / ln 10.
///
/// ```
/// use moldloft_num::{Dual, log10};
/// assert_eq!(log10(1000.0), 3.0);
/// let x = log10(Dual::<1>::seeded(100.0, 0));
/// assert_eq!(x.re, 2.0);
/// assert!((x.eps[0] - 0.01 / std::f64::consts::LN_10).abs() < 1e-17);
/// ```
pub fn log10<T: Real>(x: T) -> T {
    let follows = x.ln() / std::f64::consts::LN_10;
    let exact = libm::log10(x.re());
    T::linear(exact, &[(1.0, follows)])
}
