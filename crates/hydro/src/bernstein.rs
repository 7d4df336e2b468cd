//! Polynomials in one variable on [0, 1] in Bernstein form: values, derivatives, subdivision,
//! roots.

use moldloft_num::{Real, Vec3};

/// Maximum degree.
pub(crate) const MOST_DEGREE: usize = 10;

/// A row of coefficients on the stack.
pub(crate) type Row<T> = [T; MOST_DEGREE + 1];

/// The Bernstein polynomials of a degree at `t`, and their derivatives.
#[inline]
pub(crate) fn basis<T: Real>(degree: usize, t: T) -> (Row<T>, Row<T>) {
    let (zero, one) = (T::zero(), T::one());
    let mut b = [zero; MOST_DEGREE + 1];
    let mut slope = [zero; MOST_DEGREE + 1];
    b[0] = one;
    let s = one - t;
    for k in 1..=degree {
        if k == degree {
            // From the basis of one degree less: n (B_{i-1} - B_i).
            let n = degree as f64;
            for i in 0..=degree {
                let before = if i > 0 { b[i - 1] } else { zero };
                let here = if i < degree { b[i] } else { zero };
                slope[i] = (before - here) * n;
            }
        }
        let mut left = zero;
        for i in 0..=k {
            let here = if i < k { b[i] } else { zero };
            b[i] = left * t + here * s;
            left = here;
        }
    }
    (b, slope)
}

/// The value and the derivative of a polynomial at `t`.
#[inline]
pub(crate) fn value_and_slope<T: Real>(row: &[T], t: T) -> (T, T) {
    let (b, slope) = basis(row.len() - 1, t);
    let mut sums = (T::zero(), T::zero());
    for (k, &c) in row.iter().enumerate() {
        sums.0 += c * b[k];
        sums.1 += c * slope[k];
    }
    sums
}

/// The point and the tangent of a Bézier curve at `t`.
#[inline]
pub(crate) fn place_and_tangent<T: Real>(row: &[Vec3<T>], t: T) -> (Vec3<T>, Vec3<T>) {
    let (b, slope) = basis(row.len() - 1, t);
    let mut sums = (Vec3::zero(), Vec3::zero());
    for (k, &c) in row.iter().enumerate() {
        sums.0 += c * b[k];
        sums.1 += c * slope[k];
    }
    sums
}

/// A coefficient: a number or a point.
pub(crate) trait Coefficient: Copy {
    /// Midpoint to another coefficient.
    fn half_way(self, other: Self) -> Self;
}

impl Coefficient for f64 {
    fn half_way(self, other: Self) -> Self {
        0.5 * (self + other)
    }
}

impl<T: Real> Coefficient for Vec3<T> {
    fn half_way(self, other: Self) -> Self {
        (self + other) * T::from(0.5)
    }
}

/// The polynomial on [0, 1/2] and on [1/2, 1] (de Casteljau).
pub(crate) fn halves<C: Coefficient>(row: &[C]) -> [Vec<C>; 2] {
    let n = row.len();
    let mut work = row.to_vec();
    let mut low = Vec::with_capacity(n);
    let mut high = vec![row[n - 1]; n];
    for k in 0..n {
        low.push(work[0]);
        high[n - 1 - k] = work[n - 1 - k];
        for i in 0..n - 1 - k {
            work[i] = work[i].half_way(work[i + 1]);
        }
    }
    [low, high]
}

/// Maximum depth of bisection; a multiple root is the middle of the last interval.
const DEEPEST: u32 = 44;

/// The roots in (0, 1) at which the polynomial may change sign, ascending. None is missed, since
/// the sign changes of the coefficients bound their number. Coefficients within `epsilon` count as
/// zero.
pub(crate) fn sign_changes(row: &[f64], epsilon: f64) -> Vec<f64> {
    let mut found = Vec::new();
    let mut stack = vec![(row.to_vec(), 0.0, 1.0, 0u32)];
    while let Some((row, a, b, depth)) = stack.pop() {
        let signs = row.iter().filter(|c| c.abs() > epsilon).map(|c| *c > 0.0);
        let (changes, _) =
            signs.fold((0, None), |(n, before), s| (n + u32::from(before == Some(!s)), Some(s)));
        if changes == 0 {
            continue;
        }
        let ends = row[0] * row[row.len() - 1] < 0.0;
        if changes == 1 && ends {
            found.push(a + (b - a) * bracketed(&row));
            continue;
        }
        if depth == DEEPEST {
            found.push(0.5 * (a + b));
            continue;
        }
        let middle = 0.5 * (a + b);
        let [low, high] = halves(&row);
        if low[low.len() - 1] == 0.0 {
            found.push(middle);
        }
        stack.push((high, middle, b, depth + 1));
        stack.push((low, a, middle, depth + 1));
    }
    found.sort_by(f64::total_cmp);
    found.dedup();
    found
}

/// The root of a polynomial with a single sign change and opposite signs at the ends, by bracketed
/// Newton steps.
pub(crate) fn bracketed(row: &[f64]) -> f64 {
    let rising = row[row.len() - 1] > 0.0;
    let (mut low, mut high) = (0.0, 1.0);
    let mut t = 0.5;
    for _ in 0..80 {
        let (x, slope) = value_and_slope(row, t);
        if x == 0.0 {
            break;
        }
        if (x > 0.0) == rising {
            high = t
        } else {
            low = t
        }
        let newton = t - x / slope;
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        // Beyond this, steps only follow rounding.
        if (next - t).abs() <= 4.0 * f64::EPSILON || high - low <= f64::EPSILON {
            t = next;
            break;
        }
        t = next;
    }
    t
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_slopes_and_halves() {
        // 1 + 2 t + 3 t^2 - t^3.
        let row = [1.0, 1.0 + 2.0 / 3.0, 1.0 + 4.0 / 3.0 + 1.0, 5.0];
        let f = |t: f64| 1.0 + 2.0 * t + 3.0 * t * t - t * t * t;
        let [low, high] = halves(&row);
        for t in [0.0, 0.3, 1.0] {
            let (x, slope) = value_and_slope(&row, t);
            assert!((x - f(t)).abs() < 1e-15);
            assert!((slope - (2.0 + 6.0 * t - 3.0 * t * t)).abs() < 1e-14);
            assert!((value_and_slope(&low, t).0 - f(0.5 * t)).abs() < 1e-15);
            assert!((value_and_slope(&high, t).0 - f(0.5 + 0.5 * t)).abs() < 1e-15);
        }
    }

    #[test]
    fn all_sign_changes() {
        // (t - 0.1)(t - 0.5)(t - 0.7) in Bernstein form by interpolation of its coefficients.
        let [a, b, c] = [0.1, 0.5, 0.7];
        let p = [-a * b * c, a * b + a * c + b * c, -(a + b + c), 1.0];
        let row = [
            p[0],
            p[0] + p[1] / 3.0,
            p[0] + 2.0 * p[1] / 3.0 + p[2] / 3.0,
            p[0] + p[1] + p[2] + p[3],
        ];
        let found = sign_changes(&row, 0.0);
        assert_eq!(found.len(), 3);
        for (x, y) in found.iter().zip([a, b, c]) {
            assert!((x - y).abs() < 1e-13, "{found:?}");
        }
        assert!(sign_changes(&[1.0, 0.5, 2.0], 0.0).is_empty());
    }
}
