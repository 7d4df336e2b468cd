//! Arc length of curves, integrals along them and the inverse of the length, with derivatives.

use moldloft_num::period::{breaks_between, corner_rate};
use moldloft_num::{Curve, Order, Real, integrate};
use std::fmt;

/// A length that extends beyond an end of the curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeyondEnd {
    /// The given length.
    pub asked: f64,
    /// The available length from the starting point to that end of the curve.
    pub available: f64,
}

impl fmt::Display for BeyondEnd {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { asked, available } = self;
        write!(f, "the length {asked} is beyond the end of the curve, at {available}")
    }
}

impl std::error::Error for BeyondEnd {}

/// The parameters `a`, the breaks strictly between, `b`, in that order; each break with the
/// derivatives of its parameter.
pub fn smooth_pieces<T: Real>(curve: &dyn Curve<T>, a: T, b: T) -> Vec<T> {
    let (low, high) = (a.re().min(b.re()), a.re().max(b.re()));
    let breaks = breaks_between(&curve.breaks(), curve.closed(), low, high);
    let mut all = vec![a];
    for (k, &t) in breaks.iter().enumerate() {
        let before = if k == 0 { low } else { breaks[k - 1] };
        let after = breaks.get(k + 1).copied().unwrap_or(high);
        let near = (0.25 * (t - before).min(after - t)).min(1e-9);
        all.push(T::from(t) + corner_rate(curve, t, near).unwrap_or_else(T::zero));
    }
    if b.re() < a.re() {
        all[1..].reverse();
    }
    all.push(b);
    all
}

/// The length of the curve from `a` to `b`, negative when `b < a`, to about `accuracy` (an
/// estimate, reached on smooth pieces; the integrals between breaks are refined until two levels
/// agree).
///
/// Derivatives in `T` are those of the length, by the same integration.
///
/// # Example
/// ```
/// use moldloft_num::Vec3;
/// use moldloft_spline::{CircularArc, arclen};
/// let p = [[1., 0., 0.], [0., 0., 0.], [0., 1., 0.]].map(Vec3::from);
/// let circle = CircularArc::<f64>::circle(p[0], p[1], p[2]).unwrap();
/// assert!((arclen(&circle, 0.25, 0.75, 1e-12) - std::f64::consts::PI).abs() < 1e-12);
/// ```
pub fn arclen<T: Real>(curve: &dyn Curve<T>, a: T, b: T, accuracy: f64) -> T {
    curve_integral(curve, a, b, accuracy, |t| speed(curve, t))
}

/// The integral of `f` over the parameters from `a` to `b` of a curve, piece by piece between its
/// breaks, which may move; as [`arclen`].
pub fn curve_integral<T: Real>(
    curve: &dyn Curve<T>,
    a: T,
    b: T,
    accuracy: f64,
    f: impl Fn(T) -> T,
) -> T {
    let ends = smooth_pieces(curve, a, b);
    let share = accuracy / (ends.len() - 1) as f64;
    let mut sum = T::zero();
    for w in ends.windows(2) {
        sum += integrate(w[0], w[1], share, &f);
    }
    sum
}

fn speed<T: Real>(curve: &dyn Curve<T>, t: T) -> T {
    curve.jet(t, Order::First)[1].norm()
}

/// Maximum number of turns of a length around a closed curve.
const MOST_TURNS: f64 = 1e3;

/// The parameter at the signed length `s` along the curve from `a`, to `accuracy` of length: in [0,
/// 1] unless the curve is closed; a closed curve continues across its seam.
///
/// The root is found in plain numbers, by Newton's method between brackets; one more step in `T`
/// gives its derivatives (implicit function theorem).
///
/// # Errors
/// [`BeyondEnd`] when the curve is too short on that side.
pub fn inv_arclen<T: Real>(
    curve: &dyn Curve<T>,
    a: T,
    s: T,
    accuracy: f64,
) -> Result<T, BeyondEnd> {
    if s.re() == 0.0 && s.is_constant() {
        return Ok(a);
    }
    let far = match (curve.closed(), s.re() < 0.0) {
        (false, true) => 0.0,
        (false, false) => 1.0,
        (true, backwards) => {
            let total = integrate(T::zero(), T::from(1.0), accuracy, |t| speed(curve, t)).re();
            let turns = (s.re().abs() / total).ceil() + 1.0;
            if turns.is_nan() || turns > MOST_TURNS {
                return Err(BeyondEnd { asked: s.re(), available: MOST_TURNS * total });
            }
            a.re() + if backwards { -turns } else { turns }
        }
    };
    let ends = smooth_pieces(curve, T::from(a.re()), T::from(far));
    let share = 0.1 * accuracy / ends.len() as f64;
    let length =
        |a: f64, b: f64| integrate(T::from(a), T::from(b), share, |t| speed(curve, t)).re();
    let (mut passed, mut found) = (0.0, None);
    for w in ends.windows(2) {
        let (from, to) = (w[0].re(), w[1].re());
        let piece = length(from, to);
        let rest = s.re() - passed;
        // Lengths have the sign of s throughout.
        if rest.abs() <= piece.abs() {
            let ahead = |t: f64| length(from, t) - rest;
            let slope = |t: f64| speed(curve, T::from(t)).re();
            found = Some(bracketed_newton(ahead, slope, from, to, rest / piece, 0.1 * accuracy));
            break;
        }
        passed += piece;
    }
    let t = match found {
        Some(t) => t,
        None if (s.re() - passed).abs() <= accuracy => far,
        None => return Err(BeyondEnd { asked: s.re(), available: passed }),
    };
    let rate = speed(curve, T::from(t)).re();
    let residual = s - arclen(curve, a, T::from(t), accuracy);
    // Only the derivatives of the step are needed; the root has converged.
    Ok(residual / rate - residual.re() / rate + t)
}

/// The root of the monotone `f` between `from` and `to`, starting at the fraction `guess`.
fn bracketed_newton(
    f: impl Fn(f64) -> f64,
    slope: impl Fn(f64) -> f64,
    from: f64,
    to: f64,
    guess: f64,
    accuracy: f64,
) -> f64 {
    let (mut low, mut high) = (from.min(to), from.max(to));
    let mut t = (from + (to - from) * guess).clamp(low, high);
    // Newton doubles the digits or the bracket halves: far fewer than 64 steps are ever needed.
    for _ in 0..64 {
        let value = f(t);
        if value.abs() <= accuracy * 1e-3 || low >= high {
            break;
        }
        if value > 0.0 {
            high = t;
        } else {
            low = t;
        }
        let next = t - value / slope(t);
        let next = if low < next && next < high { next } else { 0.5 * (low + high) };
        if next == t {
            break;
        }
        t = next;
    }
    t
}
