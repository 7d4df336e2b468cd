//! The spline space of one parameter: knots, interpolation at their means, evaluation.

use super::data::Value;
use crate::KnotVector;
use moldloft_num::Order;

/// The splines of one parameter.
#[derive(Clone, Debug)]
pub struct SplineSpace {
    pub degree: usize,
    /// The ends of the spans, from 0 to 1.
    pub ends: Vec<f64>,
    /// Multiplicity of each of them except the first and last.
    pub repeats: Vec<usize>,
    /// True when the shape is not such a spline, so that its knots may be added to.
    pub fitted: bool,
}

impl SplineSpace {
    pub fn knots(&self) -> Vec<f64> {
        let mut knots = vec![0.0; self.degree + 1];
        for (end, &times) in self.ends[1..].iter().zip(&self.repeats) {
            knots.extend(std::iter::repeat_n(*end, times));
        }
        knots.extend(std::iter::repeat_n(1.0, self.degree + 1));
        knots
    }

    /// The mean of each control point's knots (Greville's abscissae): where it is interpolated.
    pub fn means(&self) -> Vec<f64> {
        let (p, knots) = (self.degree, self.knots());
        let count = knots.len() - p - 1;
        let mean = |i: usize| {
            let own = &knots[i + 1..=i + p];
            if own[0] == own[p - 1] { own[0] } else { own.iter().sum::<f64>() / p as f64 }
        };
        (0..count).map(mean).collect()
    }

    /// Halves the spans of these indices, in ascending order.
    pub fn halve(&mut self, spans: &[usize]) {
        for &k in spans.iter().rev() {
            let middle = 0.5 * (self.ends[k] + self.ends[k + 1]);
            self.ends.insert(k + 1, middle);
            self.repeats.insert(k, 1);
        }
    }
}

/// One row of basis functions: the first one's index, and their values.
pub type BasisRow = (usize, Vec<f64>);

/// The basis functions at parameters.
pub fn basis_rows(degree: usize, knots: &[f64], at: &[f64]) -> Vec<BasisRow> {
    let knots = KnotVector::new(degree, knots.to_vec()).expect("clamped ascending knots");
    let row = |&t: &f64| {
        let basis = knots.basis(t, Order::Zero);
        (basis.first, basis.rows[0].to_vec())
    };
    at.iter().map(row).collect()
}

/// The sums of basis functions times the values of a line.
pub fn apply(rows: &[BasisRow], line: &[Value], out: &mut [Value]) {
    for (out, (first, row)) in out.iter_mut().zip(rows) {
        *out = [0.0; 4];
        for (b, value) in row.iter().zip(&line[*first..]) {
            for (o, x) in out.iter_mut().zip(value) {
                *o += b * x;
            }
        }
    }
}

/// The matrix of interpolation at the means of knots, in triangular factors.
///
/// It is totally positive and banded (de Boor 1978, chapter XIII): elimination needs no pivots.
pub struct Interpolation {
    width: usize,
    /// Rows of `2 width + 1` entries about the diagonal; below it the factors of elimination.
    rows: Vec<f64>,
}

impl Interpolation {
    pub fn new(axis: &SplineSpace) -> Self {
        let (means, width) = (axis.means(), axis.degree);
        let n = means.len();
        let stride = 2 * width + 1;
        let mut rows = vec![0.0; n * stride];
        for (r, (first, row)) in
            basis_rows(axis.degree, &axis.knots(), &means).into_iter().enumerate()
        {
            for (k, b) in row.into_iter().enumerate() {
                let c = first + k;
                // At a mean the functions further off than the degree vanish.
                if c.abs_diff(r) <= width {
                    rows[r * stride + c + width - r] = b;
                }
            }
        }
        for k in 0..n {
            for r in k + 1..(k + width + 1).min(n) {
                let factor = rows[r * stride + k + width - r] / rows[k * stride + width];
                rows[r * stride + k + width - r] = factor;
                if factor != 0.0 {
                    for c in k + 1..(k + width + 1).min(n) {
                        let upper = rows[k * stride + c + width - k];
                        rows[r * stride + c + width - r] -= factor * upper;
                    }
                }
            }
        }
        Self { width, rows }
    }

    /// The control points of the spline through these values at the means.
    pub fn solve(&self, values: &[Value], out: &mut [Value]) {
        let (n, width, stride) = (values.len(), self.width, 2 * self.width + 1);
        out.copy_from_slice(values);
        for r in 0..n {
            for c in r.saturating_sub(width)..r {
                let factor = self.rows[r * stride + c + width - r];
                let known = out[c];
                for (x, k) in out[r].iter_mut().zip(known) {
                    *x -= factor * k;
                }
            }
        }
        for r in (0..n).rev() {
            for c in r + 1..(r + width + 1).min(n) {
                let factor = self.rows[r * stride + c + width - r];
                let known = out[c];
                for (x, k) in out[r].iter_mut().zip(known) {
                    *x -= factor * k;
                }
            }
            let pivot = self.rows[r * stride + width];
            for x in &mut out[r] {
                *x /= pivot;
            }
        }
    }
}
