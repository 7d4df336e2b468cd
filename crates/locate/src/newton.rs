//! Damped Newton iteration in a box of parameters.

use crate::implicit::solve;
use moldloft_num::period::principal;

/// Maximum length of a step in any parameter.
pub const LONGEST_STEP: f64 = 0.2;

/// Maximum excess of a solution beyond [0, 1].
pub const OUTSIDE: f64 = 1e-6;

/// Maximum number of steps.
pub const MOST_STEPS: u32 = 50;

/// Relative residual that counts as zero.
pub const ACCURACY: f64 = 1e-12;

/// Result of an iteration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NewtonResult<const N: usize> {
    /// The last unknowns.
    pub at: [f64; N],
    /// Norm of the residual at the solution.
    pub residual: f64,
    /// Steps that were taken.
    pub iterations: u32,
    /// True when the residual is zero to [`ACCURACY`].
    pub found: bool,
    /// True when the matrix was singular, or nearly so, in the last step.
    pub singular: bool,
}

/// The bounds of an unknown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnknownBounds {
    /// Least value.
    pub low: f64,
    /// Greatest value.
    pub high: f64,
    /// Longest step.
    pub step: f64,
}

impl<const N: usize> NewtonResult<N> {
    /// The solution with the parameters of closed shapes reduced to their first period.
    pub fn within(mut self, closed: &[bool; N]) -> Self {
        for (x, _) in self.at.iter_mut().zip(closed).filter(|(_, closed)| **closed) {
            *x = principal(*x);
        }
        self
    }
}

impl UnknownBounds {
    /// A shape's parameter: [0, 1] widened by `OUTSIDE`.
    pub const PARAMETER: UnknownBounds =
        UnknownBounds { low: -OUTSIDE, high: 1.0 + OUTSIDE, step: LONGEST_STEP };

    /// The parameter of a closed shape, extended by a period on both sides.
    pub const ROUND: UnknownBounds = UnknownBounds { low: -1.0, high: 2.0, step: LONGEST_STEP };

    /// The range of a shape's parameter.
    pub const fn parameter(closed: bool) -> UnknownBounds {
        if closed { UnknownBounds::ROUND } else { UnknownBounds::PARAMETER }
    }

    /// An unknown without bounds.
    pub const FREE: UnknownBounds =
        UnknownBounds { low: f64::NEG_INFINITY, high: f64::INFINITY, step: f64::INFINITY };
}

/// The root of `f` from `start`: full Newton steps limited to the longest of the ranges, halved
/// while the residual does not decrease, and confined to the ranges. [`ACCURACY`] is relative to
/// the length `size`; `f` gives residuals in lengths and their derivatives.
pub fn newton<const N: usize>(
    start: [f64; N],
    ranges: &[UnknownBounds; N],
    size: f64,
    mut f: impl FnMut([f64; N]) -> ([f64; N], [[f64; N]; N]),
) -> NewtonResult<N> {
    let norm = |r: &[f64; N]| r.iter().map(|x| x * x).sum::<f64>().sqrt();
    let mut x = start;
    let (mut r, mut j) = f(x);
    let mut residual = norm(&r);
    let goal = ACCURACY * size;
    let mut walk =
        NewtonResult { at: x, residual, iterations: 0, found: residual <= goal, singular: false };
    let mut polished = false;
    while walk.iterations < MOST_STEPS && residual.is_finite() {
        let Some(mut step) = solve(&j, r) else {
            walk.singular = true;
            break;
        };
        let mut cut: f64 = 1.0;
        for (s, range) in step.iter().zip(ranges) {
            cut = cut.min(range.step / s.abs());
        }
        // A step of hundreds of times the allowed length has no direction that means anything.
        if step.iter().any(|s| !s.is_finite()) || cut < 1e-3 {
            walk.singular = true;
            break;
        }
        step = step.map(|s| -s * cut.min(1.0));
        let mut share = 1.0;
        let mut better = false;
        for _ in 0..12 {
            let next: [f64; N] = std::array::from_fn(|k| {
                (x[k] + share * step[k]).clamp(ranges[k].low, ranges[k].high)
            });
            if next == x {
                break;
            }
            let (r2, j2) = f(next);
            let residual2 = norm(&r2);
            if residual2 < residual {
                (x, r, j, residual) = (next, r2, j2, residual2);
                better = true;
                break;
            }
            if walk.found {
                break;
            }
            share *= 0.5;
        }
        walk.iterations += u32::from(better);
        walk.at = x;
        walk.residual = residual;
        // One step more than the accuracy requires: it doubles the digits.
        if !better || polished {
            break;
        }
        polished = walk.found;
        walk.found = residual <= goal;
    }
    walk.found = residual <= goal;
    walk
}
