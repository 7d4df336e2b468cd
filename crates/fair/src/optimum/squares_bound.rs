//! A bound on a sum of squares beside the cones of an interior point: one more force, and a matrix of
//! one more rank.
//!
//! sum |R_k x|^2 + s = most, s > 0, with the force m > 0 of the bound and m s on its way to zero.
//! What the bound adds to the matrix is 2 m R'R, which has its band, and (m / s) a a' with the slope
//! a = 2 R'R x, which is answered by Sherman and Morrison's formula.

use crate::SparseRows;
use crate::optimum::band::Band;
use crate::optimum::interior_point::{add_block, apply, identity, spread};
use crate::optimum::second_order_cone::{V, axpy, dot};

/// A bound on a sum of squares over unknowns, with its slack and its force.
pub(crate) struct SquaresBound<const D: usize> {
    rows: SparseRows,
    /// Values of the rows without a displacement.
    offsets: Vec<V<D>>,
    most: f64,
    slack: f64,
    pub force: f64,
    /// The slope of the sum, and what the inverse of the band makes of it.
    slope: Vec<V<D>>,
    answer: Vec<V<D>>,
    /// Their product.
    bend: f64,
}

/// Changes of a bound by a Newton step.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct BoundStep {
    slack: f64,
    force: f64,
    /// The slope along the step, and the sum of squares of the step itself.
    along: f64,
    square: f64,
}

impl BoundStep {
    pub fn sum(&self) -> f64 {
        self.slack + self.force
    }
}

impl<const D: usize> SquaresBound<D> {
    pub fn new(rows: SparseRows, offsets: Vec<V<D>>, most: f64, unknowns: usize) -> Self {
        let zero = vec![[0.0; D]; unknowns];
        let (slope, answer) = (zero.clone(), zero);
        Self { rows, offsets, most, slack: most, force: 0.0, slope, answer, bend: 0.0 }
    }

    /// Row `k` at a displacement.
    fn row_at(&self, k: usize, x: &[V<D>]) -> V<D> {
        let mut r = apply(&self.rows, k, x);
        if let Some(offset) = self.offsets.get(k) {
            axpy(&mut r, 1.0, *offset);
        }
        r
    }

    fn sum_sq(&self, x: &[V<D>]) -> f64 {
        let of = |k: usize| {
            let r = apply(&self.rows, k, x);
            dot(r, r)
        };
        (0..self.rows.len()).map(of).sum()
    }

    /// Begins at a displacement inside the bound with a complementarity.
    pub fn start(&mut self, complementarity: f64, x: &[V<D>]) {
        self.follow(x);
        self.force = complementarity / self.slack;
    }

    /// Slope and slack at a displacement.
    fn follow(&mut self, x: &[V<D>]) {
        self.slope.fill([0.0; D]);
        let mut squares = 0.0;
        for k in 0..self.rows.len() {
            let r = self.row_at(k, x);
            squares += dot(r, r);
            spread(&self.rows, k, r.map(|c| 2.0 * c), &mut self.slope);
        }
        self.slack = (self.most - squares).max(1e-16 * self.most);
    }

    pub fn complementarity(&self) -> f64 {
        self.slack * self.force
    }

    /// Adds the part of the matrix that is a band.
    pub fn assemble(&self, band: &mut Band) {
        let w = identity::<D>().map(|row| row.map(|x| 2.0 * self.force * x));
        for k in 0..self.rows.len() {
            add_block(band, &self.rows, k, &w);
        }
    }

    /// Updates the rank-one term of the matrix by the inverse of its band.
    pub fn factored(&mut self, inverse: impl FnOnce(&mut [V<D>])) {
        self.answer.copy_from_slice(&self.slope);
        inverse(&mut self.answer);
        self.bend = self.slope.iter().zip(&self.answer).map(|(a, b)| dot(*a, *b)).sum();
    }

    /// Turns what the inverse of the band makes of a vector into what that of the whole matrix does.
    pub fn correct(&self, x: &mut [f64]) {
        let along: f64 = self.slope.as_flattened().iter().zip(&*x).map(|(a, b)| a * b).sum();
        let stiff = self.force / self.slack;
        let by = stiff * along / (1.0 + stiff * self.bend);
        for (x, a) in x.iter_mut().zip(self.answer.as_flattened()) {
            *x -= by * a;
        }
    }

    /// The change of the complementarity that is aimed at: towards the centre `mu` with the second-order term of
    /// an earlier step, or to zero.
    fn goal(&self, towards: Option<(f64, &BoundStep)>) -> f64 {
        let taken = -self.slack * self.force;
        towards.map_or(taken, |(mu, before)| taken + mu - before.slack * before.force)
    }

    /// Adds the forces that a step begins with; `before` is the displacement of the earlier step.
    pub fn push(&self, towards: Option<(f64, &BoundStep, &[V<D>])>, sum: &mut [V<D>]) {
        let goal = self.goal(towards.map(|(mu, step, _)| (mu, step)));
        let square = towards.map_or(0.0, |(_, step, _)| step.square);
        let push = self.force + (goal + self.force * square) / self.slack;
        for (sum, a) in sum.iter_mut().zip(&self.slope) {
            axpy(sum, -push, *a);
        }
        if let Some((_, step, x)) = towards {
            // The slope changes along the step while the force does.
            for k in 0..self.rows.len() {
                let r = apply(&self.rows, k, x);
                spread(&self.rows, k, r.map(|c| -2.0 * step.force * c), sum);
            }
        }
    }

    /// The changes that accompany a displacement.
    pub fn change(&self, towards: Option<(f64, &BoundStep)>, x: &[V<D>]) -> BoundStep {
        let along: f64 = self.slope.iter().zip(x).map(|(a, b)| dot(*a, *b)).sum();
        let slack = -along - towards.map_or(0.0, |(_, before)| before.square);
        let force = (self.goal(towards) - self.force * slack) / self.slack;
        BoundStep { slack, force, along, square: self.sum_sq(x) }
    }

    /// The longest part of a step along which slack and force stay positive, at most `step`.
    pub fn longest(&self, d: &BoundStep, mut step: f64) -> f64 {
        if d.force < 0.0 {
            step = step.min(-self.force / d.force);
        }
        // slack - t along - t^2 square > 0
        let root = (d.along * d.along + 4.0 * d.square * self.slack).sqrt();
        let under = d.along + root;
        if under > 0.0 { step.min(2.0 * self.slack / under) } else { step }
    }

    /// Follows the unknowns by a step.
    pub fn step(&mut self, d: &BoundStep, by: f64, x: &[V<D>]) {
        self.force = (self.force + by * d.force).max(f64::MIN_POSITIVE);
        self.follow(x);
    }

    /// Adds the contribution of the force to the slope at `x`, and returns its contribution to the
    /// gap: no point within the bound is farther along the slope than the convex sum of squares
    /// allows.
    pub fn certify(&self, x: &[V<D>], slope: &mut [V<D>]) -> f64 {
        let mut squares = 0.0;
        for k in 0..self.rows.len() {
            let r = self.row_at(k, x);
            squares += dot(r, r);
            spread(&self.rows, k, r.map(|c| 2.0 * self.force * c), slope);
        }
        self.force * (self.most - squares).max(0.0)
    }
}
