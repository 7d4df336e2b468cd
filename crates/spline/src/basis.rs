//! The B-spline basis functions that do not vanish on a span, and their derivatives.

use crate::KnotVector;
use moldloft_num::{Order, Real};
use smallvec::{SmallVec, smallvec};

/// One number per basis function of a span; on the stack up to degree 7.
type Row<S> = SmallVec<[S; 8]>;

/// The `degree + 1` nonzero basis functions on a span at one parameter, with their derivatives.
#[derive(Clone, Debug)]
pub struct Basis<S> {
    /// Index of the first of them and of its control point.
    pub first: usize,
    /// Values, first and second derivatives; rows above the requested order are empty.
    pub rows: [Row<S>; 3],
}

impl KnotVector {
    /// The basis functions at `t` and their derivatives to `order`. The span follows the real part
    /// of `t`; outside the domain the polynomials of the first or last span continue.
    ///
    /// Values by Piegl and Tiller 1997, A2.2; derivatives by their eq. 2.7 from the basis of one
    /// degree less, which the triangle of A2.2 passes through.
    #[inline]
    pub fn basis<S: Real>(&self, t: S, order: Order) -> Basis<S> {
        self.basis_in(self.find_span(t.re()), t, order)
    }

    /// As `basis`, with the polynomials of a given non-empty `span`.
    pub fn basis_in<S: Real>(&self, span: usize, t: S, order: Order) -> Basis<S> {
        let (p, knots) = (self.degree(), self.as_slice());
        let mut values: Row<S> = smallvec![S::one()];
        let mut lower: [Row<S>; 2] = Default::default();
        for degree in 1..=p {
            if order >= Order::First && degree == p {
                lower[0] = values.clone();
            }
            if order == Order::Second && degree + 1 == p {
                lower[1] = values.clone();
            }
            self.raise(span, degree, t, &mut values);
        }
        let mut rows = [values, Row::new(), Row::new()];
        if order >= Order::First {
            rows[1] = slopes(knots, span, p, &lower[0]);
        }
        if order == Order::Second {
            rows[2] = match p {
                1 => smallvec![S::zero(); 2],
                _ => slopes(knots, span, p, &slopes(knots, span, p - 1, &lower[1])),
            };
        }
        Basis { first: span - p, rows }
    }

    /// One step of A2.2: the basis of `degree` from that of `degree - 1`, in place.
    #[inline(always)]
    fn raise<S: Real>(&self, span: usize, degree: usize, t: S, values: &mut Row<S>) {
        let knots = self.as_slice();
        let mut saved = S::zero();
        for r in 0..degree {
            let (left, right) = (knots[span + 1 + r - degree], knots[span + r + 1]);
            let share = values[r] / (right - left);
            values[r] = saved + (-t + right) * share;
            saved = (t - left) * share;
        }
        values.push(saved);
    }
}

/// Derivatives of the basis functions of degree `p` on a span from the functions (or derivatives)
/// of degree `p - 1` (Piegl and Tiller 1997, eq. 2.7).
#[inline(always)]
fn slopes<S: Real>(knots: &[f64], span: usize, p: usize, lower: &[S]) -> Row<S> {
    let mut out: Row<S> = smallvec![S::zero(); p + 1];
    for (r, &value) in lower.iter().enumerate() {
        let width = knots[span + r + 1] - knots[span + r + 1 - p];
        let share = value * (p as f64 / width);
        out[r] -= share;
        out[r + 1] += share;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use moldloft_num::Dual;

    fn some_knots() -> Vec<KnotVector> {
        let mut all = vec![
            KnotVector::new(2, vec![0.0, 0.0, 0.0, 0.3, 0.3, 0.8, 1.0, 1.0, 1.0]).unwrap(),
            KnotVector::new(3, vec![-0.3, -0.1, -0.1, 0.0, 0.4, 1.0, 1.5, 2.0, 2.0]).unwrap(),
        ];
        all.extend((1..=7).map(|p| KnotVector::clamped_uniform(p, p + 4).unwrap()));
        all.push(KnotVector::clamped_uniform(25, 30).unwrap());
        all
    }

    #[test]
    fn basis_is_a_partition_of_unity_everywhere() {
        for knots in some_knots() {
            for t in [-0.1, 0.0, 0.1, 0.3, 0.5, 0.79, 1.0, 1.05] {
                let basis = knots.basis(t, Order::Second);
                let size = 1e-14 * basis.rows[0].iter().map(|b| b.abs()).sum::<f64>().max(10.0);
                for (k, want) in [1.0, 0.0, 0.0].iter().enumerate() {
                    let scale = (1u32..=k as u32).fold(1.0, |s, _| s * 900.0);
                    let sum: f64 = basis.rows[k].iter().sum();
                    assert!((sum - want).abs() < size * scale, "{knots:?} {t} {k} {sum}");
                }
            }
        }
    }

    #[test]
    fn derivative_rows_equal_dual_numbers() {
        for knots in some_knots() {
            for t in [0.05, 0.31, 0.77] {
                let plain = knots.basis(t, Order::Second);
                let dual = knots.basis(Dual::<1>::seeded(t, 0), Order::First);
                for r in 0..=knots.degree() {
                    let scale = plain.rows[2].iter().fold(1.0, |m: f64, b| m.max(b.abs()));
                    assert_eq!(plain.rows[0][r], dual.rows[0][r].re);
                    assert!((plain.rows[1][r] - dual.rows[0][r].eps[0]).abs() < 1e-13 * scale);
                    assert!((plain.rows[2][r] - dual.rows[1][r].eps[0]).abs() < 1e-12 * scale);
                }
            }
        }
    }
}
