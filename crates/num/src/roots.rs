//! The root of a function of one variable in a bracket.

/// Reason why no root was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NoRoot {
    /// The function has the same sign at both ends.
    NotBracketed {
        /// Value at the low end.
        at_low: f64,
        /// Value at the high end.
        at_high: f64,
    },
    /// The function returned a number that is not finite.
    NotFinite {
        /// Position.
        at: f64,
    },
}

/// The root of `f` in `low`, `high`, to the last bits: bisection with secant steps (the Illinois
/// rule), which converges for every continuous function.
///
/// # Errors
/// [`NoRoot`] when the ends do not bracket a root or a value is not finite.
///
/// # Example
/// ```
/// let root = moldloft_num::find_root(|x| x * x - 2.0, 0.0, 2.0).unwrap();
/// assert!((root - 2f64.sqrt()).abs() < 1e-15);
/// ```
pub fn find_root(f: impl Fn(f64) -> f64, low: f64, high: f64) -> Result<f64, NoRoot> {
    let (mut a, mut b) = (low, high);
    let (mut fa, mut fb) = (f(a), f(b));
    for (x, fx) in [(a, fa), (b, fb)] {
        if !fx.is_finite() {
            return Err(NoRoot::NotFinite { at: x });
        }
        if fx == 0.0 {
            return Ok(x);
        }
    }
    if fa.signum() == fb.signum() {
        return Err(NoRoot::NotBracketed { at_low: fa, at_high: fb });
    }
    let mut side = 0;
    for step in 0..200 {
        // Every third step bisects, which bounds the number of steps whatever f does.
        let mut x = (a * fb - b * fa) / (fb - fa);
        let inside = x > a.min(b) && x < a.max(b);
        if step % 3 == 2 || !inside {
            x = 0.5 * (a + b);
        }
        if x == a || x == b {
            break;
        }
        let fx = f(x);
        if !fx.is_finite() {
            return Err(NoRoot::NotFinite { at: x });
        }
        if fx == 0.0 {
            return Ok(x);
        }
        if fx.signum() == fa.signum() {
            (a, fa) = (x, fx);
            if side == 1 {
                fb *= 0.5;
            }
            side = 1;
        } else {
            (b, fb) = (x, fx);
            if side == -1 {
                fa *= 0.5;
            }
            side = -1;
        }
        if (b - a).abs() <= 2.0 * f64::EPSILON * a.abs().max(b.abs()) {
            break;
        }
    }
    Ok(0.5 * (a + b))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_flat_and_steep_roots() {
        for (f, low, high, root) in [
            ((|x: f64| x.powi(9)) as fn(f64) -> f64, -1.0, 2.0, 0.0),
            (|x| x.exp() - 1e6, 0.0, 100.0, 1e6f64.ln()),
            (|x| (x - 0.3).cbrt(), -5.0, 5.0, 0.3),
        ] {
            let found = find_root(f, low, high).unwrap();
            assert!((found - root).abs() < 1e-12 + 1e-2 * f64::from(root == 0.0), "{found} {root}");
        }
        assert!(matches!(find_root(|x| x * x + 1.0, -1.0, 1.0), Err(NoRoot::NotBracketed { .. })));
        assert!(matches!(find_root(|x| 1.0 / x, 0.0, 1.0), Err(NoRoot::NotFinite { .. })));
    }
}
