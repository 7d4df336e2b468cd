//! Points that move together: one unknown in place of as many equations.

use crate::optimum::problem::V;
use crate::{Condition, SparseRows};
use moldloft_num::Vec3;

/// Points that move together, each from a position where the equations between them hold.
#[derive(Clone, Debug, Default)]
pub(crate) struct Ties {
    /// The point by which each point moves; empty without ties.
    pub leader: Vec<usize>,
    /// Displacements of the points from the given ones to these positions.
    pub shift: Vec<Vec3<f64>>,
    /// The equations that hold by this.
    pub equations: Vec<Condition>,
    /// Sum of the squared displacements over tolerances that these equations require, and how many
    /// points have no displacement of their own.
    pub forced: f64,
    pub removed: usize,
}

impl Ties {
    pub fn is_empty(&self) -> bool {
        self.leader.is_empty()
    }

    /// The point by which a point moves.
    pub fn leader(&self, point: usize) -> usize {
        self.leader.get(point).copied().unwrap_or(point)
    }

    /// The displacement of a point to its position in the ties.
    pub fn shift(&self, point: usize) -> Vec3<f64> {
        self.shift.get(point).copied().unwrap_or_default()
    }

    /// Points at their positions in the ties.
    pub fn shifted(&self, points: &[Vec3<f64>]) -> Vec<Vec3<f64>> {
        if self.is_empty() {
            return points.to_vec();
        }
        points.iter().enumerate().map(|(i, &p)| p + self.shift(i)).collect()
    }

    /// Rows over leaders.
    pub fn rows(&self, rows: SparseRows) -> SparseRows {
        if self.is_empty() {
            return rows;
        }
        let mut out = SparseRows::new();
        for k in 0..rows.len() {
            let (columns, factors) = rows.row(k);
            let each = columns.iter().zip(factors);
            out.push(each.map(|(&c, &f)| (self.leader(c as usize), f)));
        }
        out
    }

    /// Entries over leaders.
    pub fn entries(&self, entries: Vec<(usize, V)>) -> Vec<(usize, V)> {
        if self.is_empty() {
            return entries;
        }
        let mut out: Vec<(usize, V)> = Vec::new();
        for (i, f) in entries {
            let leader = self.leader(i);
            match out.iter_mut().find(|(j, _)| *j == leader) {
                Some((_, sum)) => sum.iter_mut().zip(f).for_each(|(s, x)| *s += x),
                None => out.push((leader, f)),
            }
        }
        out
    }
}
