//! Gauss-Legendre rules of any small number of points on [0, 1].

use std::sync::OnceLock;

/// The most points of a rule.
pub(crate) const MOST_POINTS: usize = 24;

/// The places and weights of the rule of `n` points on [0, 1], `1 <= n <= MOST_POINTS`.
pub(crate) fn gauss(n: usize) -> &'static [(f64, f64)] {
    static RULES: OnceLock<Vec<Vec<(f64, f64)>>> = OnceLock::new();
    let rules = RULES.get_or_init(|| (0..=MOST_POINTS).map(rule).collect());
    &rules[n]
}

/// The roots of the Legendre polynomial of degree `n` by Newton steps from Chebyshev's (Abramowitz and Stegun
/// 1964, 25.4.29 and 22.7.10).
fn rule(n: usize) -> Vec<(f64, f64)> {
    let place = |k: usize| {
        let mut x = libm::cos(std::f64::consts::PI * (k as f64 + 0.75) / (n as f64 + 0.5));
        let mut slope = 1.0;
        for _ in 0..8 {
            let (mut p, mut q) = (1.0, 0.0);
            for m in 0..n {
                let m = m as f64;
                (p, q) = (((2.0 * m + 1.0) * x * p - m * q) / (m + 1.0), p);
            }
            slope = n as f64 * (x * p - q) / (x * x - 1.0);
            x -= p / slope;
        }
        (0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..n).map(place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_to_twice_the_points() {
        for n in 1..=MOST_POINTS {
            for power in 0..2 * n as i32 {
                let sum: f64 = gauss(n).iter().map(|(x, w)| w * x.powi(power)).sum();
                assert!((sum - 1.0 / f64::from(power + 1)).abs() < 1e-15, "{n} {power} {sum}");
            }
        }
    }
}
