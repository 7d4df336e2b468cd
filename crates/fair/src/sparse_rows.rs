//! Sparse rows over control points: values, measures, bounds.

use moldloft_num::Vec3;

/// A sparse matrix by rows: each row is a linear combination of a few control points.
///
/// Measures, Bézier points and step formulas are all such lists, so that one solver serves every
/// degree, knot vector, curve, net and network.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SparseRows {
    starts: Vec<usize>,
    columns: Vec<u32>,
    factors: Vec<f64>,
}

impl SparseRows {
    /// No rows yet.
    pub fn new() -> Self {
        Self { starts: vec![0], columns: Vec::new(), factors: Vec::new() }
    }

    /// One row per column, holding a single 1.
    pub fn identity(n: usize) -> Self {
        Self { starts: (0..=n).collect(), columns: (0..n as u32).collect(), factors: vec![1.0; n] }
    }

    /// Appends a row; entries of the same column are added up, zeros are dropped.
    pub fn push(&mut self, entries: impl IntoIterator<Item = (usize, f64)>) {
        let start = self.columns.len();
        for (column, factor) in entries {
            let column = column as u32;
            match self.columns[start..].iter().position(|&c| c == column) {
                Some(at) => self.factors[start + at] += factor,
                None => {
                    self.columns.push(column);
                    self.factors.push(factor);
                }
            }
        }
        self.starts.push(self.columns.len());
    }

    /// The number of rows.
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// True without rows.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The diagonal of P'P by unknowns.
    pub(crate) fn gram_diagonal(&self, unknowns: usize) -> Vec<f64> {
        let mut h = vec![0.0; unknowns];
        for k in 0..self.len() {
            let (columns, factors) = self.row(k);
            for (&c, &a) in columns.iter().zip(factors) {
                h[c as usize] += a * a;
            }
        }
        h
    }

    /// The columns and factors of row `k`.
    #[inline(always)]
    pub fn row(&self, k: usize) -> (&[u32], &[f64]) {
        let range = self.starts[k]..self.starts[k + 1];
        (&self.columns[range.clone()], &self.factors[range])
    }

    /// Row `k` times the points.
    #[inline(always)]
    pub fn apply(&self, k: usize, points: &[Vec3<f64>]) -> Vec3<f64> {
        let (columns, factors) = self.row(k);
        let mut sum = Vec3::zero();
        for (&c, &a) in columns.iter().zip(factors) {
            let p = points[c as usize];
            sum += Vec3::of(a * p.x, a * p.y, a * p.z);
        }
        sum
    }

    /// Sum of the squared lengths of all rows times the points.
    pub fn sum_sq(&self, points: &[Vec3<f64>]) -> f64 {
        chunked_sum(self.len(), |k| self.apply(k, points).norm_sq())
    }

    /// Sum of the lengths of all rows times the points.
    pub fn sum_abs(&self, points: &[Vec3<f64>]) -> f64 {
        chunked_sum(self.len(), |k| self.apply(k, points).norm())
    }

    /// Adds the transpose times `x` to `sum`.
    pub fn add_transposed(&self, x: impl Fn(usize) -> Vec3<f64>, sum: &mut [Vec3<f64>]) {
        for k in 0..self.len() {
            let value = x(k);
            let (columns, factors) = self.row(k);
            for (&c, &a) in columns.iter().zip(factors) {
                sum[c as usize] += value * a;
            }
        }
    }

    /// Calls `add` with each column's contribution to the transpose times `x`.
    pub(crate) fn add_transposed_into(
        &self,
        x: &[Vec3<f64>],
        mut add: impl FnMut(usize, Vec3<f64>),
    ) {
        for (k, value) in x.iter().enumerate() {
            let (columns, factors) = self.row(k);
            for (&c, &a) in columns.iter().zip(factors) {
                add(c as usize, *value * a);
            }
        }
    }

    /// The rows with the entries of column j multiplied by `scale[j]`.
    pub fn with_columns_scaled(mut self, scale: &[f64]) -> Self {
        for (c, a) in self.columns.iter().zip(&mut self.factors) {
            *a *= scale[*c as usize];
        }
        self
    }

    /// The rows times a number.
    pub fn scaled(mut self, by: f64) -> Self {
        self.factors.iter_mut().for_each(|f| *f *= by);
        self
    }

    /// The rows for which `keep` holds of (columns, factors).
    pub fn filtered(&self, keep: impl Fn(&[u32], &[f64]) -> bool) -> Self {
        let mut out = Self::new();
        for k in 0..self.len() {
            let (c, a) = self.row(k);
            if keep(c, a) {
                out.columns.extend_from_slice(c);
                out.factors.extend_from_slice(a);
                out.starts.push(out.columns.len());
            }
        }
        out
    }

    /// The rows with other numbers for their columns, ascending in each row; entries of columns
    /// whose number is `u32::MAX` are dropped.
    pub(crate) fn renumbered(&self, number: &[u32]) -> Self {
        let mut out = Self::new();
        let mut entries: Vec<(u32, f64)> = Vec::new();
        for k in 0..self.len() {
            let (c, a) = self.row(k);
            entries.clear();
            entries.extend(c.iter().zip(a).map(|(&c, &a)| (number[c as usize], a)));
            entries.retain(|e| e.0 != u32::MAX);
            entries.sort_unstable_by_key(|e| e.0);
            out.columns.extend(entries.iter().map(|e| e.0));
            out.factors.extend(entries.iter().map(|e| e.1));
            out.starts.push(out.columns.len());
        }
        out
    }

    /// All rows of both.
    pub fn joined(mut self, other: &SparseRows) -> Self {
        for k in 0..other.len() {
            let (c, a) = other.row(k);
            self.columns.extend_from_slice(c);
            self.factors.extend_from_slice(a);
            self.starts.push(self.columns.len());
        }
        self
    }

    /// The transpose, with `n` rows; entries in ascending order of the old rows.
    pub fn transposed(&self, n: usize) -> Self {
        let mut starts = vec![0; n + 1];
        for &c in &self.columns {
            starts[c as usize + 1] += 1;
        }
        for k in 0..n {
            starts[k + 1] += starts[k];
        }
        let mut fill = starts.clone();
        let mut out = Self {
            starts,
            columns: vec![0; self.columns.len()],
            factors: vec![0.0; self.columns.len()],
        };
        for k in 0..self.len() {
            let (c, a) = self.row(k);
            for (&c, &a) in c.iter().zip(a) {
                let at = &mut fill[c as usize];
                out.columns[*at] = k as u32;
                out.factors[*at] = a;
                *at += 1;
            }
        }
        out
    }

    /// The symmetric product of the transpose with the rows, `n` by `n`, columns ascending.
    pub fn gram(&self, n: usize) -> Self {
        let transposed = self.transposed(n);
        let mut out = Self::new();
        let mut entries: Vec<(u32, f64)> = Vec::new();
        for j in 0..n {
            entries.clear();
            let (rows, factors) = transposed.row(j);
            for (&k, &a) in rows.iter().zip(factors) {
                let (c, b) = self.row(k as usize);
                entries.extend(c.iter().zip(b).map(|(&c, &b)| (c, a * b)));
            }
            // A stable sort keeps the order of summation, so the product is exactly symmetric.
            entries.sort_by_key(|e| e.0);
            for run in entries.chunk_by(|a, b| a.0 == b.0) {
                out.columns.push(run[0].0);
                out.factors.push(run.iter().map(|e| e.1).sum());
            }
            out.starts.push(out.columns.len());
        }
        out
    }
}

/// The sum of `f` over `0..n`, in chunks of fixed length: the same bits on any machine, and an
/// error that grows with the chunk length only.
pub(crate) fn chunked_sum(n: usize, f: impl Fn(usize) -> f64) -> f64 {
    let mut total = 0.0;
    let mut start = 0;
    while start < n {
        let end = (start + 1024).min(n);
        total += (start..end).map(&f).sum::<f64>();
        start = end;
    }
    total
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gram_is_the_product_and_symmetric() {
        let mut rows = SparseRows::new();
        rows.push([(0, 1.0), (1, -2.0), (2, 1.0)]);
        rows.push([(1, 1.0), (2, -2.0), (3, 1.0)]);
        rows.push([(3, 0.5), (3, 0.5)]);
        let gram = rows.gram(4);
        assert_eq!(gram.row(1), (&[0, 1, 2, 3][..], &[-2.0, 5.0, -4.0, 1.0][..]));
        assert_eq!(gram.row(3), (&[1, 2, 3][..], &[1.0, -2.0, 2.0][..]));
        assert_eq!(gram.transposed(4), gram);
        let points = [0.0, 1.0, 4.0, 9.0].map(|x| Vec3::of(x, 0.0, 1.0));
        assert_eq!(rows.sum_sq(&points), 4.0 + 4.0 + 82.0);
    }
}
