//! Signs of a plane curve's curvature and of its slope on a span, by Bernstein coefficients.
//!
//! x' x x'' and the numerator of the curvature's slope are polynomials on each span. If all
//! Bernstein coefficients of a polynomial have one sign, so does the polynomial: a proof, not a
//! sample.

use moldloft_num::{Dual4, Real};

/// A point of the plane.
pub(crate) type P<T> = [T; 2];

fn binomial(n: usize, k: usize) -> f64 {
    (0..k).fold(1.0, |b, i| b * (n - i) as f64 / (i + 1) as f64)
}

/// The coefficients of a product whose factors multiply by `times`.
fn product<A: Copy, B: Copy, T: Real>(a: &[A], b: &[B], times: impl Fn(A, B) -> T) -> Vec<T> {
    let (m, n) = (a.len() - 1, b.len() - 1);
    let mut out = vec![T::zero(); m + n + 1];
    for (i, &x) in a.iter().enumerate() {
        for (j, &y) in b.iter().enumerate() {
            let share = binomial(m, i) * binomial(n, j) / binomial(m + n, i + j);
            out[i + j] += times(x, y) * share;
        }
    }
    out
}

fn differences<T: Real>(a: &[P<T>]) -> Vec<P<T>> {
    a.windows(2).map(|w| [w[1][0] - w[0][0], w[1][1] - w[0][1]]).collect()
}

fn cross<T: Real>(a: P<T>, b: P<T>) -> T {
    a[0] * b[1] - a[1] * b[0]
}

fn dot<T: Real>(a: P<T>, b: P<T>) -> T {
    a[0] * b[0] + a[1] * b[1]
}

/// Polynomial whose sign is constrained.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SignedQuantity {
    /// The curvature: x' x x''.
    Turn,
    /// The curvature's slope: det(x', x''') |x'|^2 - 3 det(x', x'') (x' . x'').
    Slope,
}

impl SignedQuantity {
    /// The Bernstein coefficients on a span with these Bézier points, up to a positive factor.
    pub fn coefficients<T: Real>(self, bezier: &[P<T>]) -> Vec<T> {
        // With p points less one, x' = p D, x'' = p (p - 1) E, x''' = p (p - 1) (p - 2) F.
        let d = differences(bezier);
        let e = differences(&d);
        let p = d.len() as f64;
        let turn = product(&d, &e, cross);
        match self {
            Self::Turn => turn,
            Self::Slope => {
                let f = if e.len() > 1 { differences(&e) } else { vec![[T::zero(); 2]] };
                let third = product(&d, &f, cross);
                let speed = product(&d, &d, dot);
                let along = product(&d, &e, dot);
                let times = |a: T, b: T| a * b;
                let first = product(&third, &speed, times);
                let second = product(&turn, &along, times);
                // For quadratics the first product is zero and has its own degree.
                let first = if e.len() > 1 { first } else { vec![T::zero(); second.len()] };
                let both = first.into_iter().zip(second);
                both.map(|(a, b)| a * (p - 2.0) - b * (3.0 * (p - 1.0))).collect()
            }
        }
    }

    /// The Bernstein coefficients with their derivatives by the points' coordinates, as `[point][coordinate]`.
    pub fn linear(self, bezier: &[P<f64>]) -> Vec<(f64, Vec<P<f64>>)> {
        let n = bezier.len();
        let mut out: Vec<(f64, Vec<P<f64>>)> =
            self.coefficients(bezier).into_iter().map(|v| (v, vec![[0.0; 2]; n])).collect();
        let places: Vec<(usize, usize)> = (0..n).flat_map(|i| [(i, 0), (i, 1)]).collect();
        for four in places.chunks(4) {
            let mut moved: Vec<P<Dual4>> = bezier.iter().map(|b| b.map(Dual4::from)).collect();
            for (part, &(i, c)) in four.iter().enumerate() {
                let x = bezier[i][c];
                moved[i][c] = Dual4::from_parts(|k| match k {
                    0 => x,
                    k if k == part + 1 => 1.0,
                    _ => 0.0,
                });
            }
            for (value, (_, slope)) in self.coefficients(&moved).into_iter().zip(&mut out) {
                for (part, &(i, c)) in four.iter().enumerate() {
                    slope[i][c] = value.part(part + 1);
                }
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bernstein coefficients as the polynomial's value.
    fn value(c: &[f64], t: f64) -> f64 {
        let n = c.len() - 1;
        let term = |i: usize| binomial(n, i) * t.powi(i as i32) * (1.0 - t).powi((n - i) as i32);
        c.iter().enumerate().map(|(i, c)| c * term(i)).sum()
    }

    #[test]
    fn coefficients_are_those_of_the_curvature_and_its_slope() {
        for bezier in [
            vec![[0.0, 0.0], [1.0, 0.4], [1.7, 1.5], [1.1, 2.2]],
            vec![[0.0, 0.0], [1.0, 0.4], [1.7, 1.5]],
            vec![[0.0, 0.0], [0.5, -0.3], [1.2, 0.2], [1.7, 0.9], [2.0, 0.1]],
        ] {
            let n = bezier.len() - 1;
            let at = |t: f64, order: usize| -> P<f64> {
                let mut c: Vec<P<f64>> = bezier.clone();
                let mut factor = 1.0;
                for k in 0..order.min(n) {
                    c = differences(&c);
                    factor *= (n - k) as f64;
                }
                if order > n {
                    return [0.0; 2];
                }
                [0, 1].map(|a| factor * value(&c.iter().map(|p| p[a]).collect::<Vec<_>>(), t))
            };
            let (turn, slope) = (
                SignedQuantity::Turn.coefficients(&bezier),
                SignedQuantity::Slope.coefficients(&bezier),
            );
            let p = n as f64;
            for t in [0.0, 0.2, 0.55, 1.0] {
                let [x, y, z] = [1, 2, 3].map(|k| at(t, k));
                let wanted = cross(x, y);
                let own = value(&turn, t) * p * p * (p - 1.0);
                assert!((own - wanted).abs() < 1e-12 * (1.0 + wanted.abs()), "{own} {wanted}");
                let wanted = cross(x, z) * dot(x, x) - 3.0 * cross(x, y) * dot(x, y);
                let own = value(&slope, t) * p.powi(4) * (p - 1.0);
                assert!((own - wanted).abs() < 1e-11 * (1.0 + wanted.abs()), "{own} {wanted}");
            }
            for sign in [SignedQuantity::Turn, SignedQuantity::Slope] {
                let all = sign.linear(&bezier);
                for (i, c) in [(0, 0), (1, 1), (2, 0)] {
                    let mut moved = bezier.clone();
                    moved[i][c] += 1e-6;
                    for ((v, slope), w) in all.iter().zip(sign.coefficients(&moved)) {
                        assert!(((w - v) / 1e-6 - slope[i][c]).abs() < 1e-4);
                    }
                }
            }
        }
    }
}
