//! Division with remainder, rounded down: of numbers of programs and of dimensions alike.

use crate::Real;

/// a - b floor(a / b) without rounding.
pub fn remainder(a: f64, b: f64) -> f64 {
    let r = a % b;
    if r != 0.0 && (r < 0.0) != (b < 0.0) { r + b } else { r }
}

/// floor(a / b), exact even if a / b rounds to the next integer.
pub fn whole_quotient(a: f64, b: f64) -> f64 {
    let q = (a / b).floor();
    // Rounding can reach a whole number from below, and only from there.
    if q == a / b && remainder(a, b) / b > 0.5 { q - 1.0 } else { q }
}

/// The [`remainder`] with the derivatives of a - b q, where q is the integer quotient.
pub fn modulo<T: Real>(a: T, b: T) -> T {
    let exact = remainder(a.re(), b.re());
    let follows = a - b * T::from(whole_quotient(a.re(), b.re()));
    if follows.is_finite() { follows - follows.re() + exact } else { T::from(exact) }
}
