//! Signs of curvature that conditions and crossing lines leave room for.
//!
//! Each line's signs fit its own tolerances; those of all lines together may not. The fewest are given
//! up: the sum of what signs are missed by is minimised under all other conditions, which is a linear
//! program whose solutions miss few, and again with weights by the solution before, which miss fewer
//! (reweighted l1 minimisation: Candès, Wakin and Boyd 2008).

use crate::optimum::problem::{self, Problem};
use crate::optimum::{MotionAxes, Parts};
use crate::{FairError, RowNorm, SparseRows};
use moldloft_num::Vec3;

/// Rounds of weights.
const ROUNDS: usize = 4;

/// Miss of a sign, relative to what the tolerances let it vary, below which it is kept, and which the
/// weights of missed signs take as small.
const MISSED: f64 = 1e-5;
const SMALL: f64 = 0.01;

/// The same distance from a sign's limit, below which the other conditions do not allow the sign.
const TIGHT: f64 = 1e-6;

/// Accuracy of the linear program, relative to its value and to a miss of one sign.
const ACCURACY: f64 = 1e-6;
const FLOOR: f64 = 1e-7;

/// Start of a miss beyond that of the start, in mean tolerances.
const BEGIN: f64 = 0.1;

/// The left side of a half-space.
fn sum(entries: &[(usize, problem::V)], x: &[problem::V]) -> f64 {
    let product =
        |(i, f): &(usize, problem::V)| -> f64 { f.iter().zip(x[*i]).map(|(f, x)| f * x).sum() };
    entries.iter().map(product).sum()
}

/// A network that misses few signs.
pub(super) struct SignRoom {
    /// Signs that it misses.
    pub missed: Vec<bool>,
    /// Signs that the other conditions do not allow.
    pub tight: Vec<bool>,
    /// Its displacements from the positions of ties; none where the conditions have no solution.
    pub moves: Vec<Vec3<f64>>,
}

impl SignRoom {
    /// The room of the half-spaces from `first` on, each counted by its cost.
    ///
    /// # Errors
    /// Those of the solver.
    pub fn of(parts: &Parts<'_>, first: usize, costs: &[f64]) -> Result<Self, FairError> {
        let frame = MotionAxes::of(parts.limit.motion, parts.points, &parts.conditions);
        let base = parts.problem(&frame);
        let count = parts.points.len();
        let finite = || parts.limit.radii.iter().filter(|r| r.is_finite() && **r > 0.0);
        let unit = finite().sum::<f64>() / finite().count().max(1) as f64;
        let mut problem = Problem { norm: RowNorm::Length, ..base };
        // Points without a tolerance need a bound where nothing else is minimised.
        let far = parts.points.iter().map(|p| (*p - parts.points[0]).norm()).fold(0.0, f64::max);
        for i in 0..count {
            if parts.limit.radii[i].is_infinite() && !problem.frozen[i] {
                problem.bounds.rows.push([(i, 1.0)]);
                problem.bounds.radii.push(far);
                if !problem.bounds.offsets.is_empty() {
                    problem.bounds.offsets.push([0.0; 3]);
                }
                problem.reach[i] = far;
            }
        }
        // One more unknown for each sign: the miss, in lengths, which begins beyond that of the start.
        let signs = problem.halves.len() - first;
        problem.begin.resize(count, [0.0; 3]);
        for (j, half) in problem.halves[first..].iter_mut().enumerate() {
            let scale = half.scale.max(f64::MIN_POSITIVE);
            let miss = (sum(&half.entries, &problem.begin) - half.room) / scale;
            half.entries.push((count + j, [-scale / unit, 0.0, 0.0]));
            problem.begin.push([unit * (miss.max(0.0) + BEGIN), 0.0, 0.0]);
        }
        problem.frozen.resize(count + signs, false);
        problem.reach.resize(count + signs, far);
        problem.offsets = vec![[0.0; 3]; signs];
        let mut weights = costs.to_vec();
        let mut room = Self { missed: Vec::new(), tight: Vec::new(), moves: Vec::new() };
        for _ in 0..ROUNDS {
            problem.measure = SparseRows::new();
            for (j, weight) in weights.iter().enumerate() {
                problem.measure.push([(count + j, *weight)]);
            }
            let solution = problem::solve(&problem, ACCURACY, FLOOR * unit, 0.0, None)?;
            if solution.misses.iter().any(|&miss| miss.is_nan() || miss > 1e-7) {
                // The conditions alone have no solution.
                let (missed, tight) = (vec![true; signs], vec![true; signs]);
                return Ok(Self { missed, tight, moves: Vec::new() });
            }
            let miss = |j: usize| solution.x[count + j][0] / unit;
            let inside = |half: &problem::InequalityConstraint| {
                let others = &half.entries[..half.entries.len() - 1];
                (half.room - sum(others, &solution.x)) / half.scale.max(f64::MIN_POSITIVE)
            };
            // What a sign is missed by may be less than its unknown, where a search ends early.
            let missed: Vec<bool> =
                problem.halves[first..].iter().map(|h| inside(h) < -MISSED).collect();
            let lost = |all: &[bool]| -> f64 {
                all.iter().zip(costs).filter(|(missed, _)| **missed).map(|(_, cost)| cost).sum()
            };
            if room.moves.is_empty() || lost(&missed) < lost(&room.missed) {
                room.missed = missed;
                room.tight = problem.halves[first..].iter().map(|h| inside(h) < TIGHT).collect();
                room.moves = solution.x[..count].iter().map(|&x| frame.up(x)).collect();
            }
            if !room.missed.contains(&true) {
                break;
            }
            for (j, (weight, cost)) in weights.iter_mut().zip(costs).enumerate() {
                *weight = cost * SMALL / (miss(j).max(0.0) + SMALL);
            }
        }
        Ok(room)
    }
}
