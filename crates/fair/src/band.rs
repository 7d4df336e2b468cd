//! Symmetric positive definite band matrices.

use crate::FairError;
use moldloft_num::Real;

/// The most numbers that a factor may hold (8 bytes each).
pub(crate) const LARGEST: usize = 1 << 28;

/// The lower half of a symmetric matrix with entries only at 0 <= row - column <= `width`. Row i
/// is stored whole, columns `i - width ..= i`, so that factoring runs over contiguous memory.
#[derive(Clone, Debug)]
pub(crate) struct Band {
    n: usize,
    width: usize,
    data: Vec<f64>,
}

/// The inner product in four interleaved sums: quick, and the same bits everywhere.
#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0f64; 4];
    let (a4, b4) = (a.chunks_exact(4), b.chunks_exact(4));
    let mut rest = 0.0;
    for (x, y) in a4.remainder().iter().zip(b4.remainder()) {
        rest += x * y;
    }
    for (x, y) in a4.zip(b4) {
        for k in 0..4 {
            sums[k] += x[k] * y[k];
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}

impl Band {
    /// The zero matrix.
    ///
    /// # Errors
    /// [`FairError::TooLarge`].
    pub fn zero(n: usize, width: usize) -> Result<Self, FairError> {
        let needed = n.saturating_mul(width + 1);
        if needed > LARGEST {
            return Err(FairError::TooLarge { needed, allowed: LARGEST });
        }
        Ok(Self { n, width, data: vec![0.0; needed] })
    }

    /// Sets all entries to zero.
    pub fn clear(&mut self) {
        self.data.fill(0.0);
    }

    /// Adds to the entry at (i, j) and, by symmetry, at (j, i).
    #[inline(always)]
    pub fn add(&mut self, i: usize, j: usize, x: f64) {
        let (i, j) = if i >= j { (i, j) } else { (j, i) };
        self.data[i * (self.width + 1) + self.width + j - i] += x;
    }

    /// Replaces the matrix by its Cholesky factor. A pivot that is not positive beside the largest
    /// diagonal entry is replaced by a huge one, which holds that unknown still.
    pub fn factor(&mut self) {
        let (w, stride) = (self.width, self.width + 1);
        let largest = (0..self.n).map(|i| self.data[i * stride + w]).fold(0.0, f64::max);
        let least = largest * 1e-300;
        for i in 0..self.n {
            let first = i.saturating_sub(w);
            let (done, rest) = self.data.split_at_mut(i * stride);
            let row = &mut rest[..stride];
            for j in first..i {
                let start = first.max(j.saturating_sub(w));
                let above = &done[j * stride..(j + 1) * stride];
                let a = &row[w + start - i..w + j - i];
                let b = &above[w + start - j..w];
                row[w + j - i] = (row[w + j - i] - dot(a, b)) / above[w];
            }
            let own = &row[w + first - i..w];
            let diagonal = row[w];
            let pivot = diagonal - dot(own, own);
            let small = pivot <= 1e-15 * diagonal || pivot <= least;
            row[w] = if small { 1e100 } else { pivot.sqrt() };
        }
    }

    /// Solves with the factor for numbers of any kind, in place.
    pub fn solve_any<T: Real>(&self, x: &mut [T]) {
        let (w, stride) = (self.width, self.width + 1);
        for i in 0..self.n {
            let first = i.saturating_sub(w);
            let row = &self.data[i * stride..(i + 1) * stride];
            let mut value = x[i];
            for (&x, &l) in x[first..i].iter().zip(&row[w + first - i..w]) {
                value -= x * l;
            }
            x[i] = value / row[w];
        }
        for i in (0..self.n).rev() {
            let first = i.saturating_sub(w);
            let row = &self.data[i * stride..(i + 1) * stride];
            let value = x[i] / row[w];
            x[i] = value;
            for (x, &l) in x[first..i].iter_mut().zip(&row[w + first - i..w]) {
                *x -= value * l;
            }
        }
    }

    /// Solves with the factor, in place.
    pub fn solve(&self, x: &mut [f64]) {
        let (w, stride) = (self.width, self.width + 1);
        for i in 0..self.n {
            let first = i.saturating_sub(w);
            let row = &self.data[i * stride..(i + 1) * stride];
            x[i] = (x[i] - dot(&row[w + first - i..w], &x[first..i])) / row[w];
        }
        for i in (0..self.n).rev() {
            let first = i.saturating_sub(w);
            let row = &self.data[i * stride..(i + 1) * stride];
            let value = x[i] / row[w];
            x[i] = value;
            for (x, l) in x[first..i].iter_mut().zip(&row[w + first - i..w]) {
                *x -= l * value;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;

    #[test]
    fn solves_what_the_matrix_maps() {
        let mut random = Random::new(11);
        for (n, w) in [(1, 0), (7, 3), (40, 5), (23, 9)] {
            let mut dense = vec![0.0; n * n];
            let mut band = Band::zero(n, w).unwrap();
            for i in 0..n {
                for j in i.saturating_sub(w)..=i {
                    let x = if i == j { 3.0 + w as f64 } else { random.unit() };
                    band.add(j, i, x);
                    (dense[i * n + j], dense[j * n + i]) = (x, x);
                }
            }
            let x: Vec<f64> = (0..n).map(|_| random.unit()).collect();
            let mut b: Vec<f64> =
                (0..n).map(|i| (0..n).map(|j| dense[i * n + j] * x[j]).sum()).collect();
            band.factor();
            let mut other = b.clone();
            band.solve(&mut b);
            band.solve_any(&mut other);
            assert!(other.iter().zip(&x).all(|(p, q)| (p - q).abs() < 1e-12));
            assert!(b.iter().zip(&x).all(|(p, q)| (p - q).abs() < 1e-12));
        }
        assert!(matches!(Band::zero(1 << 20, 1 << 12), Err(FairError::TooLarge { .. })));
    }
}
