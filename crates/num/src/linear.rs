//! Linear systems: dense by elimination with partial pivoting, and banded ones. A singular matrix is an error, never
//! a plausible solution.

use crate::{Real, Vec3};

/// The matrix of a linear system is singular to working precision.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SingularMatrix {
    /// The row without a pivot.
    pub row: usize,
}

/// Solves the dense n x n system `a x = b` in place by elimination with partial pivoting;
/// `a` is row-major. `b` holds the solution afterwards.
///
/// # Errors
/// [`SingularMatrix`] when a pivot is zero.
pub fn solve_dense<T: Real>(a: &mut [T], b: &mut [T]) -> Result<(), SingularMatrix> {
    let n = b.len();
    assert_eq!(a.len(), n * n, "the matrix of {n} unknowns is {n} by {n}");
    for k in 0..n {
        let size = |r: usize| a[r * n + k].re().abs();
        let pivot = (k..n).fold(k, |best, r| if size(r) > size(best) { r } else { best });
        if size(pivot) == 0.0 {
            return Err(SingularMatrix { row: k });
        }
        if pivot != k {
            for c in 0..n {
                a.swap(k * n + c, pivot * n + c);
            }
            b.swap(k, pivot);
        }
        for r in k + 1..n {
            let factor = a[r * n + k] / a[k * n + k];
            for c in k..n {
                let upper = a[k * n + c];
                a[r * n + c] -= factor * upper;
            }
            let upper = b[k];
            b[r] -= factor * upper;
        }
    }
    for k in (0..n).rev() {
        let mut x = b[k];
        for (c, &solved) in b.iter().enumerate().skip(k + 1) {
            x -= a[k * n + c] * solved;
        }
        b[k] = x / a[k * n + k];
    }
    Ok(())
}

/// Pivots below this are zero, relative to the largest.
const NO_PIVOT: f64 = 1e-11;

/// The solution of a small system, by elimination with full pivoting on rows scaled to equal size;
/// `None` if singular or not finite.
pub fn solve_pivoting_fully(matrix: &[Vec<f64>], right: &[f64]) -> Option<Vec<f64>> {
    let n = right.len();
    let mut a: Vec<Vec<f64>> = Vec::with_capacity(n);
    for (row, b) in matrix.iter().zip(right) {
        let size = row.iter().fold(0.0f64, |m, x| m.max(x.abs()));
        if size == 0.0 || !size.is_finite() {
            return None;
        }
        a.push(row.iter().chain([b]).map(|x| x / size).collect());
    }
    let mut columns: Vec<usize> = (0..n).collect();
    for k in 0..n {
        let places = (k..n).flat_map(|i| (k..n).map(move |j| (i, j)));
        let (i, j) = places.fold((k, k), |best, at| {
            if a[at.0][at.1].abs() > a[best.0][best.1].abs() { at } else { best }
        });
        // Written so that NaN is refused.
        let sound = a[i][j].abs() > NO_PIVOT;
        if !sound {
            return None;
        }
        a.swap(k, i);
        columns.swap(k, j);
        a.iter_mut().for_each(|row| row.swap(k, j));
        let pivot = a[k].clone();
        for row in &mut a[k + 1..] {
            let factor = row[k] / pivot[k];
            for (x, p) in row[k..].iter_mut().zip(&pivot[k..]) {
                *x -= factor * p;
            }
        }
    }
    let mut x = vec![0.0; n];
    for k in (0..n).rev() {
        let known: f64 = (k + 1..n).map(|j| a[k][j] * x[columns[j]]).sum();
        x[columns[k]] = (a[k][n] - known) / a[k][k];
    }
    Some(x)
}

/// The determinant of a square matrix given by rows, by elimination with row pivots.
pub fn determinant(matrix: &[f64], n: usize) -> f64 {
    let mut a = matrix.to_vec();
    let mut product = 1.0;
    for k in 0..n {
        let pivot = (k..n).max_by(|&i, &j| a[i * n + k].abs().total_cmp(&a[j * n + k].abs()));
        let Some(pivot) = pivot.filter(|&r| a[r * n + k] != 0.0) else { return 0.0 };
        if pivot != k {
            (0..n).for_each(|c| a.swap(k * n + c, pivot * n + c));
            product = -product;
        }
        let own = a[k * n + k];
        product *= own;
        for r in k + 1..n {
            let part = a[r * n + k] / own;
            (k..n).for_each(|c| a[r * n + c] -= part * a[k * n + c]);
        }
    }
    product
}

/// A square matrix whose entries are zero except those with |row - column| <= `width`, solved
/// without pivoting (for the diagonally dominant or totally positive systems of splines).
#[derive(Clone, Debug)]
pub struct Banded<T> {
    n: usize,
    width: usize,
    rows: Vec<T>,
}

impl<T: Real> Banded<T> {
    /// The zero matrix of `n` rows and half band width `width`.
    pub fn zero(n: usize, width: usize) -> Self {
        Self { n, width, rows: vec![T::zero(); n * (2 * width + 1)] }
    }

    /// The entry at (`row`, `column`), which must be in the band.
    pub fn entry(&mut self, row: usize, column: usize) -> &mut T {
        debug_assert!(row < self.n && column < self.n && row.abs_diff(column) <= self.width);
        &mut self.rows[row * (2 * self.width + 1) + column + self.width - row]
    }

    fn get(&self, row: usize, column: usize) -> T {
        self.rows[row * (2 * self.width + 1) + column + self.width - row]
    }

    /// Solves for vectors on the right-hand side, in place, in O(n width^2).
    ///
    /// # Errors
    /// [`SingularMatrix`] when a pivot is zero.
    pub fn solve(mut self, b: &mut [Vec3<T>]) -> Result<(), SingularMatrix> {
        assert_eq!(b.len(), self.n);
        for k in 0..self.n {
            let pivot = self.get(k, k);
            if pivot.re() == 0.0 {
                return Err(SingularMatrix { row: k });
            }
            let end = (k + self.width + 1).min(self.n);
            for r in k + 1..end {
                let factor = self.get(r, k) / pivot;
                if factor == T::zero() {
                    continue;
                }
                for c in k..end {
                    let upper = self.get(k, c);
                    *self.entry(r, c) -= factor * upper;
                }
                let upper = b[k];
                b[r] -= upper * factor;
            }
        }
        for k in (0..self.n).rev() {
            let end = (k + self.width + 1).min(self.n);
            let mut x = b[k];
            for (c, &solved) in b.iter().enumerate().take(end).skip(k + 1) {
                x -= solved * self.get(k, c);
            }
            b[k] = x / self.get(k, k);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dense_needs_its_pivot() {
        let mut a = [0.0, 2.0, 1.0, 3.0, 1.0, -1.0, 1.0, 1.0, 1.0];
        let mut b = [7.0, 2.0, 6.0];
        solve_dense(&mut a, &mut b).unwrap();
        for (x, e) in b.iter().zip([1.0, 2.0, 3.0]) {
            assert!((x - e).abs() < 1e-14);
        }
        let err = solve_dense(&mut [1.0, 2.0, 2.0, 4.0], &mut [1.0, 1.0]);
        assert_eq!(err, Err(SingularMatrix { row: 1 }));
    }

    #[test]
    fn banded_equals_dense() {
        let n = 7;
        let mut banded = Banded::zero(n, 2);
        let mut dense = vec![0.0; n * n];
        for r in 0..n {
            for c in r.saturating_sub(2)..(r + 3).min(n) {
                let x = if r == c { 5.0 } else { 1.0 / (1.0 + (2 * r + c) as f64) };
                *banded.entry(r, c) = x;
                dense[r * n + c] = x;
            }
        }
        let mut b: Vec<_> = (0..n).map(|i| Vec3::of(i as f64, 1.0, -2.0)).collect();
        let mut x: Vec<f64> = b.iter().map(|v| v.x).collect();
        banded.solve(&mut b).unwrap();
        solve_dense(&mut dense, &mut x).unwrap();
        for (p, q) in b.iter().zip(x) {
            assert!((p.x - q).abs() < 1e-14);
        }
    }

    #[test]
    fn small_systems_are_pivoted_fully() {
        let a = vec![vec![0.0, 2e6, 1e6], vec![1.0, 1.0, 0.0], vec![0.0, 1e-5, 3e-5]];
        let x = solve_pivoting_fully(&a, &[8e6, 3.0, 7e-5]).unwrap();
        let expected = [-0.4, 3.4, 1.2];
        assert!(x.iter().zip(expected).all(|(x, e)| (x - e).abs() < 1e-12), "{x:?}");
        assert_eq!(solve_pivoting_fully(&[vec![1.0, 2.0], vec![2.0, 4.0]], &[1.0, 2.0]), None);
        assert_eq!(solve_pivoting_fully(&[vec![0.0]], &[1.0]), None);
    }

    #[test]
    fn determinants_change_sign_with_their_rows() {
        assert_eq!(determinant(&[0.0, 2.0, 3.0, 1.0], 2), -6.0);
        assert_eq!(determinant(&[3.0, 1.0, 0.0, 2.0], 2), 6.0);
        assert_eq!(determinant(&[1.0, 2.0, 2.0, 4.0], 2), 0.0);
        assert_eq!(determinant(&[], 0), 1.0);
    }
}
