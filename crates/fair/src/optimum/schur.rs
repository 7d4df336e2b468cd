//! The dense system of the conditions' multipliers.

use crate::optimum::second_order_cone::{V, axpy, dot};
use moldloft_num::Real;

/// A condition over unknowns.
pub(crate) struct LinearConstraint<const D: usize> {
    pub entries: Vec<(usize, V<D>)>,
    pub value: f64,
}

/// The left side of a condition.
pub(crate) fn met<const D: usize>(condition: &LinearConstraint<D>, x: &[V<D>]) -> f64 {
    condition.entries.iter().map(|(i, factor)| dot(*factor, x[*i])).sum()
}

/// The dense system of the conditions' multipliers.
pub(crate) struct Schur {
    /// Solutions of the band matrix for each condition.
    columns: Vec<Vec<f64>>,
    /// Conditions over the unknowns.
    rows: Vec<Vec<f64>>,
    matrix: Vec<f64>,
    /// The products of the conditions themselves, by which what rounding leaves of them is taken out.
    products: Option<Vec<f64>>,
}

impl Schur {
    /// The system of `n` conditions; `inverse` solves with the factored matrix, in place. With `refined` directions meet
    /// them to rounding.
    pub fn new<const D: usize>(
        conditions: &[LinearConstraint<D>],
        unknowns: usize,
        inverse: &dyn Fn(&mut [f64]),
        refined: bool,
    ) -> Self {
        let row = |c: &LinearConstraint<D>| {
            let mut by_point = vec![[0.0; D]; unknowns];
            for (i, factor) in &c.entries {
                axpy(&mut by_point[*i], 1.0, *factor);
            }
            by_point.as_flattened().to_vec()
        };
        let rows: Vec<Vec<f64>> = conditions.iter().map(row).collect();
        let columns: Vec<Vec<f64>> = rows
            .iter()
            .map(|row| {
                let mut y = row.clone();
                inverse(&mut y);
                y
            })
            .collect();
        let m = rows.len();
        let products = |with: &[Vec<f64>]| {
            let mut matrix = vec![0.0; m * m];
            for i in 0..m {
                for j in 0..m {
                    matrix[i * m + j] = rows[i].iter().zip(&with[j]).map(|(a, b)| a * b).sum();
                }
            }
            // Conditions that repeat each other leave a singular matrix: a trace of weight decides.
            for i in 0..m {
                let own = &mut matrix[i * m + i];
                // One on what does not move has no row.
                *own = if *own == 0.0 { 1.0 } else { *own * (1.0 + 1e-13) };
            }
            matrix
        };
        let (matrix, products) = (products(&columns), refined.then(|| products(&rows)));
        Self { columns, rows, matrix, products }
    }

    /// Turns the unconstrained direction into one that meets the conditions; returns their
    /// multipliers.
    pub fn solve<const D: usize>(
        &self,
        conditions: &[LinearConstraint<D>],
        now: &[V<D>],
        x: &mut [f64],
    ) -> Vec<f64> {
        let m = self.rows.len();
        if m == 0 {
            return Vec::new();
        }
        let mut nu: Vec<f64> = (0..m)
            .map(|k| {
                let here: f64 = self.rows[k].iter().zip(&*x).map(|(a, b)| a * b).sum();
                here - (conditions[k].value - met(&conditions[k], now))
            })
            .collect();
        let mut matrix = self.matrix.clone();
        if moldloft_num::solve_dense(&mut matrix, &mut nu).is_err() {
            return vec![0.0; m];
        }
        for (column, nu) in self.columns.iter().zip(&nu) {
            for (x, y) in x.iter_mut().zip(column) {
                *x -= nu * y;
            }
        }
        if let Some(products) = &self.products {
            self.refine(products.clone(), conditions, now, x);
        }
        nu
    }

    /// The smallest change of a direction by which it meets the conditions to rounding, whatever the matrix has
    /// left of them.
    fn refine<const D: usize>(
        &self,
        mut products: Vec<f64>,
        conditions: &[LinearConstraint<D>],
        now: &[V<D>],
        x: &mut [f64],
    ) {
        let short = |(row, condition): (&Vec<f64>, &LinearConstraint<D>)| {
            let here: f64 = row.iter().zip(&*x).map(|(a, b)| a * b).sum();
            condition.value - met(condition, now) - here
        };
        let mut by: Vec<f64> = self.rows.iter().zip(conditions).map(short).collect();
        if moldloft_num::solve_dense(&mut products, &mut by).is_err() {
            return;
        }
        for (row, by) in self.rows.iter().zip(&by) {
            for (x, a) in x.iter_mut().zip(row) {
                *x += by * a;
            }
        }
    }

    /// The smallest change of a direction of numbers of any kind, whose conditions should come to `wanted`.
    pub fn answer<T: Real>(&self, wanted: &[T], x: &mut [T]) -> Vec<T> {
        let short = |(row, &wanted): (&Vec<f64>, &T)| {
            row.iter().zip(&*x).fold(T::zero(), |s, (a, b)| s + *b * *a) - wanted
        };
        let mut nu: Vec<T> = self.rows.iter().zip(wanted).map(short).collect();
        let mut matrix: Vec<T> = self.matrix.iter().map(|&a| T::from(a)).collect();
        if moldloft_num::solve_dense(&mut matrix, &mut nu).is_err() {
            return vec![T::zero(); nu.len()];
        }
        for (column, nu) in self.columns.iter().zip(&nu) {
            for (x, y) in x.iter_mut().zip(column) {
                *x -= *nu * *y;
            }
        }
        nu
    }
}
