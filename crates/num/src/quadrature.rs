//! Gauss-Legendre quadrature: rules of any small number of points, and adaptive use to an accuracy.

use crate::Real;
use std::sync::OnceLock;

/// Nodes and weights on [-1, 1] of the Gauss-Legendre rule with 8 points, exact for polynomials
/// of degree 15 (Abramowitz and Stegun 1964, table 25.4).
const GAUSS_8: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
];

/// Nodes of the 2-point rule on [0, 1], (1 -+ 1/sqrt(3)) / 2, exact to degree 3; both weights are 1/2.
pub const GAUSS_2_UNIT: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];

/// Nodes and weights of the 4-point rule on [-1, 1], exact to degree 7.
pub const GAUSS_4: [(f64, f64); 4] = [
    (-0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
    (-0.339_981_043_584_856_3, 0.652_145_154_862_546_2),
    (0.339_981_043_584_856_3, 0.652_145_154_862_546_2),
    (0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
];

/// Nodes and weights of the 8-point rule on [0, 1].
pub const GAUSS_8_UNIT: [(f64, f64); 8] = [
    (0.019_855_071_751_231_856, 0.050_614_268_145_188_13),
    (0.101_666_761_293_186_64, 0.111_190_517_226_687_24),
    (0.237_233_795_041_835_5, 0.156_853_322_938_943_65),
    (0.408_282_678_752_175_1, 0.181_341_891_689_181),
    (0.591_717_321_247_825, 0.181_341_891_689_181),
    (0.762_766_204_958_164_5, 0.156_853_322_938_943_65),
    (0.898_333_238_706_813_4, 0.111_190_517_226_687_24),
    (0.980_144_928_248_768_1, 0.050_614_268_145_188_13),
];

/// Maximum number of points of a rule.
pub const MAX_GAUSS_POINTS: usize = 24;

/// The nodes and weights of the rule of `n` points on [0, 1], `1 <= n <= MAX_GAUSS_POINTS`.
pub fn gauss_rule(n: usize) -> &'static [(f64, f64)] {
    static RULES: OnceLock<Vec<Vec<(f64, f64)>>> = OnceLock::new();
    let rules = RULES.get_or_init(|| (0..=MAX_GAUSS_POINTS).map(rule).collect());
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

/// The integral of `f` over [`a`, `b`] by the 8-point Gauss-Legendre rule.
pub fn gauss_legendre<T: Real>(a: T, b: T, mut f: impl FnMut(T) -> T) -> T {
    let (half, mid) = ((b - a) * 0.5, (a + b) * 0.5);
    let mut sum = T::zero();
    for (x, w) in GAUSS_8 {
        let step = half * x;
        sum += (f(mid - step) + f(mid + step)) * w;
    }
    sum * half
}

/// The nodes and weights of the 8-point Gauss-Legendre rule on [`a`, `b`], in pairs about the
/// middle.
pub fn gauss_points(a: f64, b: f64) -> [(f64, f64); 8] {
    let (half, mid) = (0.5 * (b - a), 0.5 * (a + b));
    std::array::from_fn(|k| {
        let (x, w) = GAUSS_8[k / 2];
        (if k % 2 == 0 { mid - half * x } else { mid + half * x }, w * half)
    })
}

/// Maximum number of halvings of an interval: down to the rounding of a number inside it.
const DEEPEST: i32 = 44;

/// Number of intervals after which the depth is limited.
const MANY: usize = 1 << 12;
const DEEP: i32 = 12;

/// The integral of `f` over `a`, `b` to about `accuracy` (absolute, an estimate and not a bound):
/// intervals are halved until two levels agree. The choice of intervals follows the real parts, so
/// a dual number is integrated over the same ones.
///
/// A kink of `f` that is not declared is closed in upon: otherwise the derivatives of the integral
/// would be wrong by the width of its interval.
pub fn integrate<T: Real>(a: T, b: T, accuracy: f64, mut f: impl FnMut(T) -> T) -> T {
    let mut stack = vec![(a, b, gauss_legendre(a, b, &mut f), 0)];
    let mut sum = T::zero();
    let mut count = 0;
    while let Some((a, b, whole, level)) = stack.pop() {
        count += 1;
        let mid = (a + b) * 0.5;
        let left = gauss_legendre(a, mid, &mut f);
        let right = gauss_legendre(mid, b, &mut f);
        let halves = left + right;
        let small = (halves - whole).re().abs() <= accuracy * (0.5f64).powi(level);
        let deepest = if count < MANY { DEEPEST } else { DEEP };
        if small || level >= deepest || !halves.re().is_finite() {
            sum += halves;
        } else {
            stack.push((mid, b, right, level + 1));
            stack.push((a, mid, left, level + 1));
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Dual;

    #[test]
    fn exact_to_degree_fifteen_and_with_derivatives() {
        let x14 = gauss_legendre(0.0, 2.0, |x: f64| x.powi(14));
        assert!((x14 - 2f64.powi(15) / 15.0).abs() < 1e-10);
        // d/dk of the integral of exp(k x) over [0, 1], at k = 2.
        let k = Dual::<1>::seeded(2.0, 0);
        let i = integrate(Dual::from(0.0), Dual::from(1.0), 1e-13, |x| (k * x).exp());
        let e2 = 2f64.exp();
        assert!((i.re - (e2 - 1.0) / 2.0).abs() < 1e-13);
        assert!((i.eps[0] - (e2 / 2.0 - (e2 - 1.0) / 4.0)).abs() < 1e-12);
        // A kink that moves: d/dk of the integral of |x - k|, which is 2k - 1.
        let k = Dual::<1>::seeded(0.3, 0);
        let i = integrate(Dual::from(0.0), Dual::from(1.0), 1e-13, |x| (x - k).abs());
        assert!((i.re - 0.29).abs() < 1e-13);
        assert!((i.eps[0] + 0.4).abs() < 1e-10, "{}", i.eps[0]);
        let root = integrate(0.0, 1.0, 1e-12, |x: f64| x.sqrt());
        assert!((root - 2.0 / 3.0).abs() < 1e-8);
    }

    #[test]
    fn rules_are_exact_to_twice_their_points() {
        for n in 1..=MAX_GAUSS_POINTS {
            for power in 0..2 * n as i32 {
                let sum: f64 = gauss_rule(n).iter().map(|(x, w)| w * x.powi(power)).sum();
                assert!((sum - 1.0 / f64::from(power + 1)).abs() < 1e-15, "{n} {power} {sum}");
            }
        }
    }
}
