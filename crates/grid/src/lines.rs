//! The rows of a grid in two colours, and control terms.

use moldloft_num::Real;
use moldloft_parallel::prelude::*;

/// Components of a grid (those that vary) with its even rows apart from its odd ones.
#[derive(Clone)]
pub struct ZebraRows<T> {
    pub m: usize,
    pub n: usize,
    /// The even rows and the odd rows of each component.
    pub colours: [Vec<Vec<T>>; 2],
}

/// The terms of first derivatives, P and Q of the literature: `along` multiplies the derivative
/// along a row, `across` that from row to row. Whole planes, row by row.
#[derive(Clone)]
pub struct Control<T> {
    pub along: Vec<T>,
    pub across: Vec<T>,
}

impl<T: Real> ZebraRows<T> {
    /// The rows of planes of m by n numbers.
    pub fn of(m: usize, n: usize, planes: &[Vec<T>]) -> Self {
        let colour = |colour: usize, plane: &Vec<T>| -> Vec<T> {
            plane.chunks(n).skip(colour).step_by(2).flatten().copied().collect()
        };
        let colours = [0, 1].map(|c| planes.iter().map(|plane| colour(c, plane)).collect());
        Self { m, n, colours }
    }

    /// The planes.
    pub fn planes(&self) -> Vec<Vec<T>> {
        let n = self.n;
        let row = |c: usize, i: usize| &self.colours[i % 2][c][i / 2 * n..][..n];
        let plane = |c: usize| (0..self.m).flat_map(|i| row(c, i).iter().copied()).collect();
        (0..self.colours[0].len()).map(plane).collect()
    }

    /// Rows become columns.
    pub fn transposed(&self) -> Self {
        let (m, n) = (self.n, self.m);
        let colours = [0, 1].map(|colour| {
            let count = (m + 1 - colour) / 2;
            (0..self.colours[0].len())
                .map(|c| {
                    let mut plane = vec![T::zero(); count * n];
                    let chunk = 8;
                    plane.par_chunks_mut(chunk * n).enumerate().for_each(|(k, rows)| {
                        // A few rows at once, so that each cache line read serves all of them.
                        let height = rows.len() / n;
                        for i in 0..n {
                            let column = &self.colours[i % 2][c][i / 2 * self.n..][..self.n];
                            for r in 0..height {
                                rows[r * n + i] = column[2 * (k * chunk + r) + colour];
                            }
                        }
                    });
                    plane
                })
                .collect()
        });
        Self { m, n, colours }
    }
}

/// Control terms with the two directions exchanged.
pub fn transposed_control<T: Real>(control: &Control<T>, m: usize, n: usize) -> Control<T> {
    let turn = |plane: &Vec<T>| (0..m * n).map(|k| plane[k % m * n + k / m]).collect();
    Control { along: turn(&control.across), across: turn(&control.along) }
}

/// The larger of two changes; NaN wins, so that divergence shows.
pub fn larger(most: Change, x: Change) -> Change {
    if x <= most { most } else { x }
}

/// Result of a pass: the square of the largest step.
pub type Change = f64;
