//! Goals of networks: the fairest, near the data, under a budget.

use crate::curve::exact::{all_exact, between_breaks};
use crate::curve::moving::MovingRows;
use crate::net::between::LimitsBetween;
use crate::net::lines::{LineNumbers, LineRound};
use crate::net::shapes::{EquationSpan, KEPT, MET, ROUNDS, SETTLED};
use crate::net::strand::NetworkCurve;
use crate::optimum::goal::{
    Adaptation, Goal, GoalOptimum, GoalVariation, RegularizationPath, allowed, check_decided,
    check_unique, is_between, moved, rounding,
};
use crate::optimum::{Bounded, ControlInequality, Optimum, Parts};
use crate::{Bound, Certificate, Condition, FairError, Measure, Motion, Network, SparseRows};
use moldloft_num::{Real, Vec3};

/// Rounds in which the rest of conditions is put right.
const LAST_ROUNDS: usize = 3;

/// A goal reached, with the rows that pull and the points whose rows these are.
struct ReachedGoal<'a> {
    found: GoalOptimum,
    pull: SparseRows,
    owners: Vec<usize>,
    /// Line by line: the rounds of the fairest, then those under a budget.
    rounds: Vec<Vec<LineRound<'a>>>,
    /// Limits between points, of all lines together.
    between: LimitsBetween,
}

impl Network {
    /// True if all curves through their points are exact between breaks.
    fn exact(&self) -> bool {
        let curve = |strand: &NetworkCurve| {
            let own: Vec<Vec3<f64>> = strand.points.iter().map(|&i| self.points[i]).collect();
            between_breaks(&own, &strand.marks, strand.space.is_closed())
        };
        self.strands.iter().all(|s| s.at.is_some())
            && all_exact(self.strands.iter().flat_map(curve))
    }

    fn found<'a>(
        &'a self,
        parts: &mut Parts<'a>,
        measure: Measure,
        goal: Goal,
        conditioned: bool,
    ) -> Result<ReachedGoal<'a>, FairError> {
        if self.conditions.is_empty() {
            return self.found_near(parts, measure, goal, conditioned);
        }
        let base = parts.clone();
        let lines = self.strands.len();
        let most = MET * self.extent();
        let finite = || self.limit.radii.iter().filter(|r| r.is_finite() && **r > 0.0);
        let mean = finite().sum::<f64>() / finite().count().max(1) as f64;
        let mut at = self.points.clone();
        let mut made: Option<ReachedGoal<'a>> = None;
        let mut missed = (f64::INFINITY, 0);
        for _ in 0..ROUNDS {
            let linear = self.linear_conditions(&at)?;
            let kept = linear.left.0 <= KEPT * mean;
            let before =
                std::mem::replace(&mut missed, if kept { linear.missed } else { linear.left });
            if let Some(made) = made.take_if(|_| kept && missed.0 <= most) {
                return Ok(made);
            }
            // The rest is rounding once the conditions do not change any more.
            if kept
                && missed.0 <= SETTLED * mean
                && missed.0 > 0.5 * before.0
                && let Some(mut made) = made.take()
            {
                for _ in 0..LAST_ROUNDS {
                    let points = &made.found.optimum.points;
                    let mut all = base.conditions.clone();
                    all.extend(self.linear_conditions(points)?.equations.into_iter().map(|e| e.0));
                    let nearest = EquationSpan::of(self, &all).nearest(self, points);
                    made.found.optimum.points = nearest;
                }
                return Ok(made);
            }
            let equations = self.independent(linear.equations)?;
            *parts = base.clone();
            // Limits all along curves do not hold at the positions of ties.
            let direct = matches!(parts.bounded, Bounded::ControlPoints) && !self.limits_between();
            let equations = if direct {
                let (ties, others, frozen) = self.tied(equations)?;
                (parts.ties, parts.frozen) = (ties, frozen);
                others
            } else {
                equations
            };
            let owners: Vec<usize> = equations.iter().map(|e| e.1).collect();
            parts.conditions.extend(equations.into_iter().map(|e| e.0));
            // Combinations that the equations determine have no sign.
            let span = EquationSpan::of(self, &parts.equations());
            // A search that begins where the equations hold keeps them.
            if direct && self.limit.motion != Motion::Box && !parts.conditions.is_empty() {
                let moves = span.within(self).into_iter().enumerate();
                parts.begin = moves.map(|(i, v)| v - parts.ties.shift(i)).collect();
            }
            // The first owners are the lines, of the signs that these hold themselves.
            let own = linear.halves.into_iter().filter(|h| !span.determines(&h.entries));
            parts.halves.extend(own.map(|h| ControlInequality { owner: lines + h.owner, ..h }));
            let found =
                self.found_near(parts, measure, goal, true).map_err(|error| match error {
                    FairError::Shape { shapes, miss } => {
                        let shapes =
                            shapes.into_iter().filter_map(|k| k.checked_sub(lines)).collect();
                        FairError::Shape { shapes, miss }
                    }
                    FairError::Contradiction { conditions, ends, miss } => {
                        let owner =
                            |k: usize| owners.get(k.checked_sub(base.conditions.len())?).copied();
                        let mut shapes: Vec<usize> =
                            conditions.iter().filter_map(|&k| owner(k)).collect();
                        shapes.dedup();
                        if shapes.is_empty() {
                            return FairError::Contradiction { conditions, ends, miss };
                        }
                        FairError::Shape { shapes, miss }
                    }
                    other => other,
                })?;
            at.clone_from(&found.found.optimum.points);
            made = Some(found);
        }
        Err(FairError::Shape { shapes: vec![missed.1], miss: missed.0 })
    }

    fn found_near<'a>(
        &'a self,
        parts: &mut Parts<'a>,
        measure: Measure,
        goal: Goal,
        conditioned: bool,
    ) -> Result<ReachedGoal<'a>, FairError> {
        let shaped = !self.conditions.is_empty();
        let (pull, owners) = self.pull(&parts.frozen);
        let (rows, norm) = (parts.measure.clone(), parts.norm);
        let (mut rounds, mut between) = (Vec::new(), LimitsBetween::default());
        if let (Goal::Near(share), true) = (goal, shaped || !conditioned) {
            if !shaped && self.exact() {
                let value = crate::measure::value(&rows, norm, &self.points);
                let found = GoalOptimum::unmoved(&self.points, value, false);
                return Ok(ReachedGoal { found, pull, owners, rounds, between });
            }
            if self.has_lines(norm) && !pull.is_empty() {
                rounds.push(self.by_lines(parts, measure, &pull, None)?);
                let fairest_used = rounds[0][rounds[0].len() - 1].found.used;
                if let Some(share) = allowed(share, fairest_used, owners.len()) {
                    rounds.push(self.by_lines(parts, measure, &pull, Some(share))?);
                }
                let last =
                    rounds.last().and_then(|own| own.last()).map(|round| round.found.clone());
                let mut found = last.expect("there are rounds");
                found.fairest_used = fairest_used;
                return Ok(ReachedGoal { found, pull, owners, rounds, between });
            }
        }
        let path = RegularizationPath {
            energy: |points: &[Vec3<f64>]| crate::measure::value(&rows, norm, points),
            squares: |points: &[Vec3<f64>]| {
                let moved: Vec<_> = points.iter().zip(&self.points).map(|(p, q)| *p - *q).collect();
                pull.sum_sq(&moved)
            },
            count: pull.len(),
            noise: rounding(&rows, norm, &self.points),
            original: &self.points,
            adapts: if conditioned { Adaptation::None } else { Adaptation::Network },
            known: None,
            moves: None,
            nearest: None,
            fairest: None,
        };
        let mut found = path.follow(goal, norm, conditioned, parts, &pull)?;
        while self.limits_between() && between.extend(self, &found.optimum.points)? {
            parts.bounded = between.bounded(self);
            found = path.follow(goal, norm, conditioned, parts, &pull)?;
        }
        Ok(ReachedGoal { found, pull, owners, rounds, between })
    }

    /// The result of a goal, with a ball round each point; see [`Goal`].
    ///
    /// # Errors
    /// As [`Network::optimum`]; [`FairError::Goal`].
    pub fn toward(
        &self,
        measure: Measure,
        goal: Goal,
        conditions: Vec<Condition>,
        accuracy: f64,
    ) -> Result<(Optimum, f64), FairError> {
        let (found, _) = self.reached(measure, goal, conditions, accuracy)?;
        Ok((found.optimum, found.used))
    }

    /// The result of a goal with the curves that bend more than their points require.
    pub(super) fn reached(
        &self,
        measure: Measure,
        goal: Goal,
        conditions: Vec<Condition>,
        accuracy: f64,
    ) -> Result<(GoalOptimum, Vec<usize>), FairError> {
        let conditioned = !conditions.is_empty();
        let mut parts = self.parts(measure, self.first_bound(), conditions, accuracy)?;
        let reached = self.found(&mut parts, measure, goal, conditioned)?;
        let last = reached.rounds.last().and_then(|rounds| rounds.last());
        let bent = last.map_or_else(Vec::new, |round| round.bent.clone());
        Ok((reached.found, bent))
    }

    /// As `toward`, for numbers that carry derivatives: points, tolerances, and the parameters of
    /// each curve that has them. Returns notes with the points.
    ///
    /// # Errors
    /// As [`Network::toward`].
    pub fn toward_with<T: Real>(
        &self,
        measure: Measure,
        goal: Goal,
        accuracy: f64,
        points: &[Vec3<T>],
        tolerances: &[T],
        ats: &[Option<Vec<T>>],
    ) -> Result<(Vec<Vec3<T>>, NetworkFit), FairError> {
        let mut parts = self.parts(measure, self.first_bound(), Vec::new(), accuracy)?;
        let reached = self.found(&mut parts, measure, goal, false)?;
        let ReachedGoal { found, pull, owners, rounds, between } = reached;
        let fit = NetworkFit {
            certificate: found.optimum.certificate,
            active: found.optimum.active,
            used: found.used,
            fairest_used: found.fairest_used,
        };
        let mut numbers = points.iter().flat_map(|p| p.to_array());
        if numbers.all(T::is_constant) && tolerances.iter().all(|t| t.is_constant()) {
            return Ok((found.optimum.points.iter().map(|&p| Vec3::lifted(p)).collect(), fit));
        }
        if !self.conditions.is_empty() {
            return Err(FairError::NoDerivative(
                "no derivatives are available for a network with shapes and other conditions",
            ));
        }
        if found.share == 0.0 {
            return Ok((points.to_vec(), fit));
        }
        self.check_derivable(&found, goal, owners.len())?;
        if !rounds.is_empty() {
            let pulling = (&pull, &owners[..]);
            let rows = &self.all_moving_rows(measure, ats)?;
            let numbers = LineNumbers { points, tolerances, rows, ats };
            let moved = self.budget_moved(goal, &rounds, pulling, &numbers)?;
            return Ok((moved, fit));
        }
        check_unique(&mut parts, &found, &pull)?;
        if parts.norm != crate::RowNorm::Square
            && (found.share < 1.0 || ats.iter().any(Option::is_some))
        {
            return Err(FairError::NoDerivative(
                "no derivatives are available for a sum of lengths with moving parameters: use \
                another measure, or spacing \"index\"",
            ));
        }
        parts.pull = (found.weight > 0.0).then(|| pull.clone().scaled(found.weight.sqrt()));
        let solved = parts.whole()?;
        check_decided(&found, &solved)?;
        between.check(&solved, &parts.bounded, &parts.frozen, ats)?;
        let own_tolerances = between.tolerances(tolerances);
        let each = self.all_moving_rows(measure, ats)?;
        let rows = MovingRows { rows: each.into_iter().flat_map(|own| own.rows).collect() };
        let forces = if parts.norm == crate::RowNorm::Square {
            rows.forces(&solved.optimum.points)
        } else {
            Vec::new()
        };
        let moving = |forces, budget| GoalVariation {
            originals: points.to_vec(),
            tolerances: &own_tolerances,
            pulled: owners.iter().map(|&i| tolerances[i]).collect(),
            targets: &[],
            forces,
            rows: &rows,
            bends: &[],
            budget,
            start: points,
        };
        let mut budget = T::zero();
        if let (Goal::Near(share), true) = (goal, found.between) {
            // The squares of the fairest change, too.
            let mut parts = self.parts(measure, Bound::ControlPoints, Vec::new(), accuracy)?;
            if !between.is_empty() {
                parts.bounded = between.bounded(self);
            }
            let fairest = parts.whole()?;
            between.check(&fairest, &parts.bounded, &parts.frozen, ats)?;
            let optimum = fairest.optimum.clone();
            let whole = GoalOptimum { share: 1.0, weight: 0.0, optimum, ..found.clone() };
            let own = moving(rows.forces(&fairest.optimum.points), T::zero());
            let at = moved(&parts, &fairest, Goal::Fairest, &whole, &pull, own)?;
            let used = used_of(&at, &owners, points, tolerances);
            budget =
                allowed(share, used, owners.len()).unwrap_or(used) * (owners.len() as f64 / 3.0);
        }
        let moving = moving(forces, budget);
        Ok((moved(&parts, &solved, goal, &found, &pull, moving)?, fit))
    }

    /// Refuses derivatives of results that move the points of `count` rows that pull, where limits
    /// are along curves or the fairest is one of many.
    fn check_derivable(
        &self,
        found: &GoalOptimum,
        goal: Goal,
        count: usize,
    ) -> Result<(), FairError> {
        if self.first_bound() != Bound::ControlPoints {
            return Err(FairError::NoDerivative(
                "no derivatives are available for a network with limits along its curves: limit \
                its points",
            ));
        }
        let explained = allowed(0.0, found.used, count).is_none();
        let free = match goal {
            Goal::Near(share) => found.used > share,
            Goal::Fairest => explained,
            _ => false,
        };
        if found.weight == 0.0 && free {
            // Limits at one line leave the others' parabolas free, and which of them the solver takes
            // says nothing about how they move.
            return Err(FairError::NoDerivative(
                "several networks may be equally fair, so no derivatives are available: use the \
                goal \"budget\"",
            ));
        }
        Ok(())
    }

    /// The result of a goal line by line with derivatives.
    fn budget_moved<T: Real>(
        &self,
        goal: Goal,
        rounds: &[Vec<LineRound<'_>>],
        pulling: (&SparseRows, &[usize]),
        numbers: &LineNumbers<'_, T>,
    ) -> Result<Vec<Vec3<T>>, FairError> {
        let (Goal::Near(share), [fairest, budgeted @ ..]) = (goal, rounds) else {
            return Ok(numbers.points.to_vec());
        };
        let count = pulling.1.len();
        let used = fairest.last().map_or(0.0, |round| round.found.used);
        if is_between(used, count) {
            return Err(FairError::NoDerivative(
                "the budget of this network depends on the fairest one, which may not be unique, \
                so no derivatives are available: use the goal \"budget\"",
            ));
        }
        let mut most = T::from(share);
        if allowed(share, used, count) != Some(share) {
            // The squares of the fairest change, too.
            let at = self.lines_moved(fairest, pulling, most, numbers)?;
            let used = used_of(&at, pulling.1, numbers.points, numbers.tolerances);
            most = allowed(share, used, count).unwrap_or(used);
        }
        let last = budgeted.first().unwrap_or(fairest);
        self.lines_moved(last, pulling, most, numbers)
    }

    /// The points that pull: those that may move, over their tolerances.
    fn pull(&self, frozen: &[bool]) -> (SparseRows, Vec<usize>) {
        let (mut pull, mut owners) = (SparseRows::new(), Vec::new());
        for (i, &radius) in self.limit.radii.iter().enumerate() {
            if !frozen[i] && radius.is_finite() {
                pull.push([(i, 1.0 / radius)]);
                owners.push(i);
            }
        }
        (pull, owners)
    }
}

/// The squares of moves relative to those of noise of the tolerances.
fn used_of<T: Real>(at: &[Vec3<T>], owners: &[usize], points: &[Vec3<T>], tolerances: &[T]) -> T {
    let square = |&i: &usize| {
        let off = at[i] - points[i];
        off.dot(off) / (tolerances[i] * tolerances[i])
    };
    let sum = owners.iter().fold(T::zero(), |sum, i| sum + square(i));
    sum / (owners.len() as f64 / 3.0)
}

/// Figures of the result of a goal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NetworkFit {
    /// The measure of all curves and the optimality gap within the limits.
    pub certificate: Certificate,
    /// Limits that are reached.
    pub active: usize,
    /// Three times the mean of the squared moves over tolerances.
    pub used: f64,
    /// The same mean for the fairest network; 3 if all moves reach their tolerances.
    pub fairest_used: f64,
}
