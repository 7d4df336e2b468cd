//! Symmetric positive definite band matrices.

use crate::FairError;
use moldloft_num::Real;

/// The most numbers that a factor may hold (8 bytes each).
pub(crate) const LARGEST: usize = 1 << 28;

/// The lower half of a symmetric matrix with entries only at 0 <= row - column <= `width`. Row i
/// is stored whole, columns `i - width ..= i`, so that factoring runs over contiguous memory. The
/// factor's diagonal holds the reciprocals of its pivots.
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

/// Calls the method with the number of stored columns as a constant where the band is narrow, as
/// curves have it: loops of known length are unrolled, which makes it four times as quick.
macro_rules! by_stride {
    ($self:ident, $narrow:ident, $wide:ident $(, $argument:expr)*) => {
        match $self.width + 1 {
            2 => $self.$narrow::<2>($($argument),*),
            3 => $self.$narrow::<3>($($argument),*),
            4 => $self.$narrow::<4>($($argument),*),
            5 => $self.$narrow::<5>($($argument),*),
            6 => $self.$narrow::<6>($($argument),*),
            8 => $self.$narrow::<8>($($argument),*),
            9 => $self.$narrow::<9>($($argument),*),
            10 => $self.$narrow::<10>($($argument),*),
            12 => $self.$narrow::<12>($($argument),*),
            15 => $self.$narrow::<15>($($argument),*),
            _ => $self.$wide($($argument),*),
        }
    };
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

    /// Takes over the entries of a matrix of the same form.
    pub fn copy(&mut self, other: &Band) {
        self.data.copy_from_slice(&other.data);
    }

    /// The number of stored entries.
    pub fn size(&self) -> usize {
        self.data.len()
    }

    /// Adds to the entry at (i, j) and, by symmetry, at (j, i).
    #[cfg(test)]
    pub fn add(&mut self, i: usize, j: usize, x: f64) {
        let (i, j) = if i >= j { (i, j) } else { (j, i) };
        self.data[i * (self.width + 1) + self.width + j - i] += x;
    }

    /// Adds `factor` times a symmetric block at the places of two points, `high` not before `low`.
    #[inline(always)]
    pub fn add_block<const D: usize>(
        &mut self,
        high: usize,
        low: usize,
        factor: f64,
        block: &[[f64; D]; D],
    ) {
        debug_assert!(high >= low, "the blocks above the diagonal are not kept");
        for r in 0..D {
            let i = high * D + r;
            let start = i * (self.width + 1) + self.width + low * D - i;
            let last = if high == low { r + 1 } else { D };
            for (entry, b) in self.data[start..start + last].iter_mut().zip(&block[r]) {
                *entry += factor * b;
            }
        }
    }

    /// Restricts the matrix to symmetric projections of the coordinates of single points: what they
    /// take away has a diagonal of its own, so that the matrix stays positive definite.
    pub fn restrict<const D: usize>(&mut self, held: &[(usize, [[f64; D]; D])]) {
        let (w, stride) = (self.width, self.width + 1);
        let projected = |projection: &[[f64; D]; D], v: [f64; D]| -> [f64; D] {
            std::array::from_fn(|r| (0..D).map(|c| projection[r][c] * v[c]).sum())
        };
        for (point, projection) in held {
            let first = point * D;
            let most = (0..D).map(|d| self.data[(first + d) * stride + w]).fold(0.0, f64::max);
            // The point's rows left of its own block.
            for column in (first + D - 1).saturating_sub(w)..first {
                let at: [usize; D] =
                    std::array::from_fn(|d| (first + d) * stride + w + column - first - d);
                let new = projected(projection, at.map(|k| self.data[k]));
                at.iter().zip(new).for_each(|(&k, x)| self.data[k] = x);
            }
            // Its columns below.
            for row in first + D..(first + w + 1).min(self.n) {
                let at: [usize; D] = std::array::from_fn(|d| row * stride + w + first + d - row);
                let new = projected(projection, at.map(|k| self.data[k]));
                at.iter().zip(new).for_each(|(&k, x)| self.data[k] = x);
            }
            let entry = |r: usize, c: usize| {
                let (r, c) = if r < c { (c, r) } else { (r, c) };
                (first + r) * stride + w + c - r
            };
            let block: [[f64; D]; D] =
                std::array::from_fn(|r| std::array::from_fn(|c| self.data[entry(r, c)]));
            // The block is symmetric: P B, then P (P B)'.
            let half: [[f64; D]; D] = {
                let columns = block.map(|column| projected(projection, column));
                std::array::from_fn(|r| std::array::from_fn(|c| columns[c][r]))
            };
            let both = half.map(|row| projected(projection, row));
            for r in 0..D {
                for c in 0..=r {
                    let unit = f64::from(u8::from(r == c));
                    self.data[entry(r, c)] = both[r][c] + most * (unit - projection[r][c]);
                }
            }
        }
    }

    /// Replaces the matrix by its Cholesky factor. A pivot that is not positive beside the largest
    /// diagonal entry is replaced by a huge one, which holds that unknown still.
    pub fn factor(&mut self) {
        let (w, stride) = (self.width, self.width + 1);
        let largest = (0..self.n).map(|i| self.data[i * stride + w]).fold(0.0, f64::max);
        by_stride!(self, factor_narrow, factor_rows, 0, largest * 1e-300);
    }

    /// The reciprocal of a pivot.
    #[inline(always)]
    fn reciprocal(diagonal: f64, pivot: f64, least: f64) -> f64 {
        let small = pivot <= 1e-15 * diagonal || pivot <= least;
        if small { 1e-100 } else { 1.0 / pivot.sqrt() }
    }

    /// Factors the rows from `from` on.
    fn factor_rows(&mut self, from: usize, least: f64) {
        self.factor_some(from..self.n, least);
    }

    fn factor_some(&mut self, rows: std::ops::Range<usize>, least: f64) {
        let (w, stride) = (self.width, self.width + 1);
        for i in rows {
            let first = i.saturating_sub(w);
            let (done, rest) = self.data.split_at_mut(i * stride);
            let row = &mut rest[..stride];
            for j in first..i {
                let start = first.max(j.saturating_sub(w));
                let above = &done[j * stride..(j + 1) * stride];
                let a = &row[w + start - i..w + j - i];
                let b = &above[w + start - j..w];
                row[w + j - i] = (row[w + j - i] - dot(a, b)) * above[w];
            }
            let own = &row[w + first - i..w];
            let diagonal = row[w];
            row[w] = Self::reciprocal(diagonal, diagonal - dot(own, own), least);
        }
    }

    fn factor_narrow<const S: usize>(&mut self, from: usize, least: f64) {
        let w = S - 1;
        self.factor_some(from..w.min(self.n), least);
        let rows = self.data.as_chunks_mut::<S>().0;
        for i in w..rows.len() {
            let (done, rest) = rows.split_at_mut(i);
            let above = &done[i - w..];
            let row = &mut rest[0];
            for j in 0..w {
                let other = &above[j];
                let mut value = row[j];
                for k in 0..j {
                    value -= row[k] * other[w - j + k];
                }
                row[j] = value * other[w];
            }
            let diagonal = row[w];
            let mut pivot = diagonal;
            for k in 0..w {
                pivot -= row[k] * row[k];
            }
            row[w] = Self::reciprocal(diagonal, pivot, least);
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
            x[i] = value * row[w];
        }
        for i in (0..self.n).rev() {
            let first = i.saturating_sub(w);
            let row = &self.data[i * stride..(i + 1) * stride];
            let value = x[i] * row[w];
            x[i] = value;
            for (x, &l) in x[first..i].iter_mut().zip(&row[w + first - i..w]) {
                *x -= value * l;
            }
        }
    }

    /// Solves with the factor, in place.
    pub fn solve(&self, x: &mut [f64]) {
        by_stride!(self, solve_narrow, solve_wide, x);
    }

    fn solve_wide(&self, x: &mut [f64]) {
        self.forward(0..self.n, x);
        self.backward(0..self.n, x);
    }

    fn forward(&self, rows: std::ops::Range<usize>, x: &mut [f64]) {
        let (w, stride) = (self.width, self.width + 1);
        for i in rows {
            let first = i.saturating_sub(w);
            let row = &self.data[i * stride..(i + 1) * stride];
            x[i] = (x[i] - dot(&row[w + first - i..w], &x[first..i])) * row[w];
        }
    }

    fn backward(&self, rows: std::ops::Range<usize>, x: &mut [f64]) {
        let (w, stride) = (self.width, self.width + 1);
        for i in rows.rev() {
            let first = i.saturating_sub(w);
            let row = &self.data[i * stride..(i + 1) * stride];
            let value = x[i] * row[w];
            x[i] = value;
            for (x, l) in x[first..i].iter_mut().zip(&row[w + first - i..w]) {
                *x -= l * value;
            }
        }
    }

    fn solve_narrow<const S: usize>(&self, x: &mut [f64]) {
        let w = S - 1;
        let head = w.min(self.n);
        self.forward(0..head, x);
        let rows = self.data.as_chunks::<S>().0;
        for i in w..self.n {
            // The newest value comes last, so that the next row waits for one product only.
            let (row, near) = (&rows[i], &x[i - w..=i]);
            let mut value = near[w];
            for k in 0..w {
                value -= row[k] * near[k];
            }
            x[i] = value * row[w];
        }
        for i in (w..self.n).rev() {
            let (row, near) = (&rows[i], &mut x[i - w..=i]);
            let value = near[w] * row[w];
            near[w] = value;
            for k in (0..w).rev() {
                near[k] -= row[k] * value;
            }
        }
        self.backward(0..head, x);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use moldloft_testing::Lcg;

    #[test]
    fn solves_what_the_matrix_maps() {
        let mut random = Lcg::new(11);
        // All strides with a path of their own, some without, and matrices smaller than their band.
        let sizes = [(1, 0), (7, 3), (40, 5), (23, 9), (3, 7), (60, 20), (9, 15), (30, 14)];
        for (n, w) in sizes.into_iter().chain((1..16).map(|w| (25, w))) {
            let mut dense = vec![0.0; n * n];
            let mut band = Band::zero(n, w).unwrap();
            for i in 0..n {
                for j in i.saturating_sub(w)..=i {
                    let x = if i == j { 3.0 + w as f64 } else { random.centred() };
                    band.add(j, i, x);
                    (dense[i * n + j], dense[j * n + i]) = (x, x);
                }
            }
            let x: Vec<f64> = (0..n).map(|_| random.centred()).collect();
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

    #[test]
    fn restricted_matrices_keep_directions() {
        let mut random = Lcg::new(12);
        // Five points of two coordinates, each beside its neighbours.
        let mut band = Band::zero(10, 3).unwrap();
        let mut dense = [[0.0; 10]; 10];
        for i in 0..10usize {
            for j in (2 * (i / 2)).saturating_sub(2)..=i {
                let x = if i == j { 5.0 } else { random.centred() };
                band.add(i, j, x);
                (dense[i][j], dense[j][i]) = (x, x);
            }
        }
        // Point 1 moves along (0.6, 0.8), point 3 not along y.
        let (a, b) = ([0.6, 0.8], [1.0, 0.0]);
        let outer = |v: [f64; 2]| v.map(|r| v.map(|c| r * c));
        band.restrict(&[(1, outer(a)), (3, outer(b))]);
        band.factor();
        let mut x: Vec<f64> = (0..10).map(|k| f64::from(k) - 4.5).collect();
        let along = 0.6 * x[2] + 0.8 * x[3];
        (x[2], x[3], x[7]) = (0.6 * along, 0.8 * along, 0.0);
        let right = x.clone();
        band.solve(&mut x);
        assert!((0.8 * x[2] - 0.6 * x[3]).abs() < 1e-14 && x[7] == 0.0);
        // The residual is across the directions of the points.
        let off: Vec<f64> =
            (0..10).map(|i| (0..10).map(|j| dense[i][j] * x[j]).sum::<f64>() - right[i]).collect();
        for (k, off) in off.iter().enumerate() {
            assert!([2, 3, 7].contains(&k) || off.abs() < 1e-12, "{k}: {off}");
        }
        assert!((0.6 * off[2] + 0.8 * off[3]).abs() < 1e-12);
    }

    #[test]
    fn blocks_are_added_symmetrically() {
        let mut band = Band::zero(6, 3).unwrap();
        band.add_block(2, 1, 2.0, &[[1.0, 3.0], [3.0, 5.0]]);
        band.add_block(1, 1, 1.0, &[[4.0, 1.0], [1.0, 4.0]]);
        let mut wanted = Band::zero(6, 3).unwrap();
        for (i, j, x) in
            [(4, 2, 2.0), (4, 3, 6.0), (5, 2, 6.0), (5, 3, 10.0), (2, 2, 4.0), (3, 2, 1.0)]
        {
            wanted.add(i, j, x);
        }
        wanted.add(3, 3, 4.0);
        assert_eq!(band.data, wanted.data);
    }
}
