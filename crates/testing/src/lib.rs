//! Common parts of tests: random numbers that are equal on every machine, derivatives by
//! differences, comparisons and the switch for long runs.
//!
//! ```
//! use moldloft_testing::{Random, close, ridders};
//!
//! let x = Random::new(1).between(0.5, 1.0);
//! close(ridders(f64::sin, x, 0.1), x.cos(), 1e-10);
//! ```
//!
//! Invariant: a development dependency only; no crate of the product uses it.

mod compare;
mod differences;
mod random;

pub use compare::{AbsoluteDistance, close, close_relative};
pub use differences::{ridders, ridders_vector, ridders_vectors};
pub use random::{Lcg, Random, Xorshift};

/// True in a long run: `MOLDLOFT_SOAK=1`.
pub fn soak() -> bool {
    std::env::var("MOLDLOFT_SOAK").is_ok_and(|value| value == "1")
}

/// The number of rounds: `quick` in the ordinary suite, `long` in a long run.
pub fn rounds(quick: usize, long: usize) -> usize {
    if soak() { long } else { quick }
}
