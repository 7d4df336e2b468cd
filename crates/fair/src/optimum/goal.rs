//! Goals among the results within the tolerances, and the path to them from the fairest.
//!
//! The results on the way are the optima of the measure plus a weight times the squared residuals
//! over tolerances: the fairest at weight 0, the data at the end. Each is the fairest of all whose
//! residuals are no larger, and the nearest of all that are as fair.

use crate::curve::moving::{MapReal, MovingRows};
use crate::optimum::problem::CertifiedSolution;
use crate::optimum::{Bend, BudgetOptimum, Optimum, Parts, Solved};
use crate::{Certificate, FairError, RowNorm, SparseRows};
use moldloft_num::{Dual4, Real, Vec3};

/// Goal among the curves within the tolerances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Goal {
    /// Minimum of the measure.
    Fairest,
    /// Minimum of the measure among the curves whose squared residuals, each relative to its
    /// tolerance, have a mean of at most this fraction of 1/3; noise that fills the tolerance
    /// evenly has a mean of 1/3.
    Budget(f64),
    /// That minimum as far as it is worth a move: data whose own curve measures less than one and a
    /// half times as much do not move at all, and from three times on they move all the way.
    /// Exact data stay. In a network whose fairest takes no more of the squares than noise has, give
    /// or take half as much again as its standard deviation, the data do not speak against that, and
    /// it is taken, if these are 40 or more; the budget falls from there to the share as it takes a
    /// quarter more. Of a grid of as many data the budget falls to 0.3 where the fairest surface takes
    /// more than that, and of both to 0.05 where it takes much more.
    Near(f64),
    /// The curve nearest to the data (in the sum of the same squares) whose measure exceeds the
    /// minimum by at most this fraction. Data that are already as fair do not move.
    Nearest(f64),
    /// The curve nearest to the data whose measure is at most this.
    Energy(f64),
    /// The curve nearest to the data that has the shape and meets the conditions, whatever its
    /// measure. Data that already do so do not move.
    Closest,
}

/// Solutions at most on the way to a goal.
const MOST_SOLUTIONS: usize = 60;

/// Ratio of the measure of the data's own curve to that of the optimum at which moves begin, and at
/// which they are complete.
const STAYS: f64 = 1.5;
const MOVES: f64 = 3.0;

/// The fraction of the path that a gain is worth: a smooth step.
pub(crate) fn worth<T: Real>(gain: T) -> T {
    worth_beside(gain, 0.0)
}

/// [`worth`] where the measure differs by `foreign` from one that suits the data, and therefore
/// tells less about the gain.
fn worth_beside<T: Real>(gain: T, foreign: f64) -> T {
    let own = 1.0 - foreign;
    let (stays, moves) = (1.0 + (STAYS - 1.0) * own, 1.0 + (MOVES - 1.0) * own);
    let share = (gain - stays) / (moves - stays).max(f64::EPSILON);
    if share.re() <= 0.0 {
        T::zero()
    } else if share.re() >= 1.0 {
        T::one()
    } else {
        share * share * (T::from(3.0) - share * 2.0)
    }
}

/// How far beyond what noise has, give or take `DEVIATIONS`, the fairest network's squares are where
/// its measure is none of the hull, and the budget is the goal's own. Of 36 networks of six hulls one
/// that the measure has is below, by 1.07 of the squares at most, and the others are at 1.17 and more.
const FOREIGN: f64 = 0.25;

/// Fewer moving points do not tell noise from a hull that the measure does not have: their deviations
/// are as wide as `FOREIGN`.
const FEWEST: usize = 40;

/// Standard deviations that noise may exceed its mean by.
const DEVIATIONS: f64 = 1.5;

/// The budget of the goal `near` in a network of `count` moving points whose fairest takes `used`; none
/// where the fairest itself is within what noise has.
pub(crate) fn allowed<T: Real>(share: f64, used: T, count: usize) -> Option<T> {
    let foreign = beyond(used, count) / FOREIGN;
    if count < FEWEST {
        return Some(T::from(share));
    }
    if foreign.re() <= 0.0 {
        return None;
    }
    if foreign.re() >= 1.0 || used.re() <= share {
        return Some(towards(T::from(share), STRANGE_BUDGET, strange_to(used, count)));
    }
    Some(used + (T::from(share) - used) * foreign)
}

/// True if the budget of a network is between that of the fairest and the goal's own.
pub(crate) fn is_between(used: f64, count: usize) -> bool {
    let foreign = beyond(used, count) / FOREIGN;
    count >= FEWEST && foreign > 0.0 && foreign < 1.0
}

/// A budget moved towards the minimum by a fraction.
fn towards<T: Real>(from: T, least: f64, by: T) -> T {
    if from.re() <= least || by.re() <= 0.0 {
        from
    } else if by.re() >= 1.0 {
        T::from(least)
    } else {
        from + by * (T::from(least) - from)
    }
}

/// Degree to which the points do not resolve what the measure lacks.
fn strange_to<T: Real>(used: T, count: usize) -> T {
    (beyond(used, count) - STRANGE_SURFACE) / STRANGE_WIDTH
}

/// Excess of the squares of the fairest over those of noise and its deviations.
fn beyond<T: Real>(used: T, count: usize) -> T {
    // The square of even noise has the mean 1/3 and the variance 4/45.
    let deviation = (0.8 / count.max(1) as f64).sqrt();
    used - (1.0 + DEVIATIONS * deviation)
}

/// The budget of the goal `near` of a grid of `count` pulling data whose fairest surface takes `used`: the
/// goal's own, or where the data speak against the measure as small as [`FOREIGN_BUDGET`], and as
/// [`STRANGE_BUDGET`] where they do so more and more.
pub(crate) fn tightened<T: Real>(share: f64, used: T, count: usize) -> T {
    if count < FEWEST {
        return T::from(share);
    }
    let foreign = towards(T::from(share), FOREIGN_BUDGET, foreign_to(used, count));
    towards(foreign, STRANGE_BUDGET, strange_to(used, count))
}

/// Degree to which the measure is not that of the surface, from 0 to 1.
fn foreign_to<T: Real>(used: T, count: usize) -> T {
    let share = (beyond(used, count) - FOREIGN_SURFACE) / FOREIGN_WIDTH;
    if count < FEWEST || share.re() <= 0.0 {
        T::zero()
    } else if share.re() >= 1.0 {
        T::one()
    } else {
        share
    }
}

/// From where the measure is none of a surface's, beyond what noise has, and how far it goes until it is none at
/// all. Of 64 grids of eight hulls the best budget is 0.8 up to 0.2 beyond, 0.5 at 0.3 and 0.4, and 0.3 to 0.5 at
/// 0.5 and 0.6; the goal's own takes parallel bodies farther from the truth than their data.
const FOREIGN_SURFACE: f64 = 0.25;
const FOREIGN_WIDTH: f64 = 0.3;

/// The budget of a surface whose data the measure does not have: with that of others a hull with a parallel
/// body ends farther from the truth than its data.
const FOREIGN_BUDGET: f64 = 0.3;

/// From where the points do not resolve what the measure does not have, and how far it goes until hardly
/// anything may move, with the budget there: of the same grids the best is 0.1 to 0.3 at 0.8, 0.03 to 0.15 from
/// 1 on.
const STRANGE_SURFACE: f64 = 0.55;
const STRANGE_WIDTH: f64 = 0.4;
const STRANGE_BUDGET: f64 = 0.05;

/// The weight of data beside the measure of their own curve where the nearest of a shape is wanted.
const CLOSEST: f64 = 1e6;

/// Accuracy of budgets and shares.
const GOAL_ACCURACY: f64 = 1e-7;

/// The same where further solutions are quick.
const DECIDED: f64 = 1e-11;

/// The difference of the weights' logarithms from which on a value that is no better is due to rounding, and
/// the logarithm of the squares that rounding leaves of an optimum whose limits it hides.
const NOISY: f64 = 1e-5;

/// Solutions that come no nearer after which others are not looked for where these are quick.
const MOST_IDLE: usize = 3;

/// So many residuals make each search worth saving: beyond, one at a weight takes longer than what further digits
/// of a budget are worth where rounding hides the limits.
const MANY: usize = 100;

/// Steps of the logarithm of the weight until the goal is between two weights.
const FIRST_STRIDE: f64 = 2.0;
const LARGEST_STRIDE: f64 = 6.0;

/// The difference of the weights' logarithms below which the solution of one shows the limits of the other.
const NEIGHBOURS: f64 = 0.1;

/// The measure that rounding of the points alone may leave.
pub(crate) fn rounding(rows: &SparseRows, norm: RowNorm, points: &[Vec3<f64>]) -> f64 {
    let of = |k: usize| {
        let (columns, factors) = rows.row(k);
        let size: f64 =
            columns.iter().zip(factors).map(|(&c, f)| f.abs() * points[c as usize].norm()).sum();
        let noise = 64.0 * f64::EPSILON * size;
        if norm == RowNorm::Square { noise * noise } else { noise }
    };
    (0..rows.len()).map(of).sum()
}

/// The way from the fairest curve to the data as their weight grows.
pub(crate) struct RegularizationPath<'a, E, S> {
    /// The measure at points.
    pub energy: E,
    /// The sum of squared residuals over tolerances.
    pub squares: S,
    /// The number of residuals.
    pub count: usize,
    /// The measure that rounding leaves.
    pub noise: f64,
    pub original: &'a [Vec3<f64>],
    /// Dependence of the budget of `near` on the squares of the fairest.
    pub adapts: Adaptation,
    /// The optimum under the budget, nearly, where it is known.
    pub known: Option<BudgetOptimum>,
    /// Fraction of the move from an original that is the nearest of few control points; else by the gain.
    pub moves: Option<f64>,
    /// Of several fairest the nearest to the original.
    pub nearest: Option<&'a dyn Fn(Optimum) -> Result<Optimum, FairError>>,
    /// The fairest, where it is known.
    pub fairest: Option<Optimum>,
}

/// Dependence of the budget of `near` on the squares of the fairest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Adaptation {
    /// The goal's own.
    None,
    /// Smaller where noise does not explain the fairest: [`tightened`].
    Surface,
    /// Tightened likewise, and the fairest itself where noise explains it: [`allowed`].
    Network,
}

/// The end of the path.
#[derive(Clone)]
pub(crate) struct GoalOptimum {
    pub optimum: Optimum,
    /// Fraction of the straight path from the original to the optimum of the weight.
    pub share: f64,
    pub used: f64,
    pub least: f64,
    pub weight: f64,
    /// The fairest, where it was looked for, and what it takes of the squares.
    pub fairest: Option<Optimum>,
    pub fairest_used: f64,
    /// True if the budget depends on the squares of the fairest.
    pub between: bool,
    /// True if it is the nearest of several fairest.
    pub several: bool,
}

impl GoalOptimum {
    /// The original itself; the gap is 0 where nothing may move.
    pub fn unmoved(points: &[Vec3<f64>], value: f64, still: bool) -> Self {
        let certificate = Certificate { value, gap: if still { 0.0 } else { value } };
        let optimum = Optimum { points: points.to_vec(), certificate, iterations: 0, active: 0 };
        Self {
            optimum,
            share: 0.0,
            used: 0.0,
            least: value,
            weight: 0.0,
            fairest: None,
            fairest_used: 0.0,
            between: false,
            several: false,
        }
    }
}

/// Optima of the measure plus a weight times the squares.
struct WeightedSolver<'a, 'p> {
    parts: &'a mut Parts<'p>,
    pull: &'a SparseRows,
    /// The last solution with its weight: near it the next begins.
    last: Option<(f64, CertifiedSolution)>,
    /// True if solutions may begin near the last one.
    warm: bool,
}

impl WeightedSolver<'_, '_> {
    /// The optimum of a weight; true if it is known which limits are reached.
    fn solve(&mut self, weight: f64) -> Result<(Optimum, bool), FairError> {
        let close = |l: &&(f64, CertifiedSolution)| libm::log(l.0 / weight).abs() < NEIGHBOURS;
        let near = self.last.as_ref().filter(|l| self.warm && close(l));
        self.parts.pull = (weight > 0.0).then(|| self.pull.clone().scaled(weight.sqrt()));
        let (optimum, solution) = self.parts.solve_after(near.map(|l| &l.1))?;
        let decided = solution.active.is_some();
        self.last = Some((weight, solution));
        Ok((optimum, decided))
    }
}

/// The two ends of the path, and the goal between them.
struct PathEnds {
    goal: Goal,
    norm: RowNorm,
    conditioned: bool,
    /// True if the original is no result.
    held: bool,
    /// The squares of noise that fills the tolerances evenly.
    mean: f64,
    /// The measure of the original.
    begin: f64,
    /// The fairest, its measure, and what it takes of the squares.
    fairest: Optimum,
    least: f64,
    squares: f64,
    /// True if it is the nearest of several.
    several: bool,
    /// True if the budget depends on the squares of the fairest.
    between: bool,
    /// Degree to which the measure is not that of the surface.
    foreign: f64,
}

/// A bracket of the logarithm of the goal's weight, with the values at its ends: regula falsi, the
/// stale end halved (Illinois).
struct WeightBracket {
    low: Option<(f64, f64)>,
    high: Option<(f64, f64)>,
    /// 1 if the last value was at the low end, -1 at the high end.
    side: i32,
    stride: f64,
    stepped: f64,
    /// True if the first weight is near that of the goal.
    near: bool,
}

impl WeightBracket {
    fn width(&self) -> f64 {
        self.low.zip(self.high).map_or(f64::INFINITY, |(l, h)| h.0 - l.0)
    }

    fn take(&mut self, trial: f64, value: f64) {
        let side = if value > 0.0 { 1 } else { -1 };
        let (own, other) = if side == 1 {
            (&mut self.low, &mut self.high)
        } else {
            (&mut self.high, &mut self.low)
        };
        if self.side == side
            && let Some(stale) = other
        {
            stale.1 *= 0.5;
        }
        *own = Some((trial, value));
        self.side = side;
        if self.near && self.low.is_none() != self.high.is_none() {
            // The goal is near: beyond it by about as much as it is short.
            let beyond = 4.0 * value.abs().max(GOAL_ACCURACY);
            self.stride = beyond.min(LARGEST_STRIDE).max(2.0 * self.stepped);
            self.stepped = self.stride;
        }
    }

    /// The next logarithm; `None` if the bracket is narrower than `close`.
    fn next(&mut self, close: f64) -> Option<f64> {
        let trial = match (self.low, self.high) {
            (Some(l), Some(h)) if h.0 - l.0 < close => return None,
            (Some(l), Some(h)) => {
                let share = l.1 / (l.1 - h.1);
                l.0 + (h.0 - l.0) * share.clamp(0.01, 0.99)
            }
            (None, Some(h)) => h.0 - self.stride,
            (Some(l), None) => l.0 + self.stride,
            (None, None) => unreachable!("one of them was set"),
        };
        if !self.near {
            self.stride = (2.0 * self.stride).min(LARGEST_STRIDE);
        }
        Some(trial)
    }
}

impl<E, S> RegularizationPath<'_, E, S>
where
    E: Fn(&[Vec3<f64>]) -> f64,
    S: Fn(&[Vec3<f64>]) -> f64,
{
    /// The optimum of a goal. The sum of squares falls and the measure rises with the weight, both
    /// continuously, so the goal is found between two weights.
    pub fn follow(
        &self,
        goal: Goal,
        norm: RowNorm,
        conditioned: bool,
        parts: &mut Parts<'_>,
        pull: &SparseRows,
    ) -> Result<GoalOptimum, FairError> {
        let begin = (self.energy)(self.original);
        let held = conditioned || self.moves == Some(1.0);
        if !held && (begin <= self.noise || goal == Goal::Closest) {
            // Nothing is left but rounding: not a bit moves.
            return Ok(GoalOptimum::unmoved(self.original, begin, false));
        }
        let warm = self.adapts != Adaptation::Network;
        let mut solver = WeightedSolver { parts, pull, last: None, warm };
        let mut several = false;
        let fairest = match (&self.fairest, self.nearest) {
            (Some(known), _) => known.clone(),
            (None, None) => solver.solve(0.0)?.0,
            (None, Some(nearest)) => {
                let (solved, _) = solver.solve(0.0)?;
                let fairest = nearest(solved.clone())?;
                several = fairest.points != solved.points;
                fairest
            }
        };
        let mut ends = PathEnds {
            goal,
            norm,
            conditioned,
            held,
            mean: (self.count as f64 / 3.0).max(f64::MIN_POSITIVE),
            begin,
            least: (self.energy)(&fairest.points),
            squares: (self.squares)(&fairest.points),
            fairest,
            several,
            between: false,
            foreign: 0.0,
        };
        self.adapt(&mut ends);
        if let Some(found) = self.at_an_end(&ends, &mut solver)? {
            return Ok(found);
        }
        if norm != RowNorm::Square {
            return Err(FairError::Goal(
                "budget and share do not apply to a sum of lengths: use `fairest`",
            ));
        }
        let (weight, optimum) = self.search(&ends, &mut solver)?;
        Ok(self.settle(&ends, optimum, weight))
    }

    /// Adapts the budget of `near` to the squares of the fairest.
    fn adapt(&self, ends: &mut PathEnds) {
        let Goal::Near(share) = ends.goal else { return };
        let used = ends.squares / ends.mean;
        match self.adapts {
            Adaptation::Network if ends.norm == RowNorm::Square => {
                let own = allowed(share, used, self.count);
                ends.between = own.is_some_and(|own| own != share);
                ends.goal = Goal::Near(own.unwrap_or(f64::INFINITY));
            }
            Adaptation::Surface if ends.norm == RowNorm::Square && !ends.conditioned => {
                ends.foreign = foreign_to(used, self.count);
                let own = tightened(share, used, self.count);
                ends.between = ![share, FOREIGN_BUDGET, STRANGE_BUDGET].contains(&own);
                ends.goal = Goal::Near(own);
            }
            _ => {}
        }
    }

    /// The optimum of a goal that is met without a search: by the fairest, the original, or at a
    /// weight that is known.
    fn at_an_end(
        &self,
        ends: &PathEnds,
        solver: &mut WeightedSolver<'_, '_>,
    ) -> Result<Option<GoalOptimum>, FairError> {
        let &PathEnds { held, mean, begin, least, squares, .. } = ends;
        let fairest = || Ok(Some(self.ended(ends, ends.fairest.clone(), 0.0)));
        match ends.goal {
            Goal::Closest => {
                // Beside this weight the measure is a trace that decides where data do not.
                let weight = CLOSEST * begin.max(least).max(f64::MIN_POSITIVE) / mean;
                let (optimum, _) = solver.solve(weight)?;
                return Ok(Some(self.ended(ends, optimum, weight)));
            }
            Goal::Energy(most) => {
                if most.is_nan() || most <= 0.0 {
                    return Err(FairError::Goal("a bound on the measure is positive"));
                }
                if least > most * (1.0 + GOAL_ACCURACY) {
                    return Err(FairError::Energy { asked: most, least });
                }
                if !held && begin <= most {
                    return Ok(Some(self.left_as_it_is(ends)));
                }
                if squares == 0.0 || least >= most {
                    return fairest();
                }
            }
            Goal::Fairest => return fairest(),
            Goal::Budget(share) | Goal::Near(share) => {
                if share.is_nan() || share <= 0.0 {
                    return Err(FairError::Goal("a budget is a positive share"));
                }
                if squares <= share * mean || ends.norm != RowNorm::Square {
                    return Ok(Some(self.settle(ends, ends.fairest.clone(), 0.0)));
                }
            }
            Goal::Nearest(share) => {
                if share.is_nan() || share < 0.0 {
                    return Err(FairError::Goal("a share of the measure is 0 or more"));
                }
                if share == 0.0 || squares == 0.0 {
                    return fairest();
                }
                if !held && begin <= (1.0 + share) * least + self.noise {
                    return Ok(Some(self.left_as_it_is(ends)));
                }
            }
        }
        Ok(None)
    }

    /// The weight that meets the goal, and its optimum.
    fn search(
        &self,
        ends: &PathEnds,
        solver: &mut WeightedSolver<'_, '_>,
    ) -> Result<(f64, Optimum), FairError> {
        let nearly = self.nearly(ends, solver)?;
        let near = nearly.is_some();
        let mut trial =
            nearly.as_ref().map_or_else(|| self.balance(ends), |found| libm::log(found.weight));
        let known = nearly.filter(|found| found.good).map(|found| found.optimum);
        let (low, high) = (None, None);
        let mut bracket =
            WeightBracket { low, high, side: 0, stride: FIRST_STRIDE, stepped: 0.0, near };
        let mut idle = 0;
        let mut best: Option<(f64, f64, Optimum)> = None;
        for _ in 0..MOST_SOLUTIONS {
            let (optimum, decided) = solver.solve(libm::exp(trial))?;
            let value = self.missing(ends, &optimum);
            // Conditions may keep the data farther off than the budget.
            let settled = bracket.low.is_some_and(|l| l.1 - value < 1e-6);
            if ends.held && bracket.high.is_none() && value > 0.0 && settled {
                best = Some((trial, value, optimum));
                break;
            }
            let better = best.as_ref().is_none_or(|b| value.abs() < b.1.abs());
            if better {
                best = Some((trial, value, optimum));
            }
            // Between weights so near to each other what is left is rounding of the optima.
            let many = self.count > MANY;
            let undecided = near && many && !decided;
            let rounded = undecided && value.abs() <= NOISY;
            if let Some(bounded) = known.as_ref().filter(|_| undecided && !rounded) {
                // No digits are left to move the weight by: what was found under the budget is the
                // optimum.
                best = Some((trial, value, bounded.clone()));
                break;
            }
            // If it is known which limits are reached, or there are few, each further solution is
            // fast.
            let cheap = known.is_some() && (decided || !many);
            let close = if cheap { DECIDED } else { GOAL_ACCURACY };
            idle = if better { 0 } else { idle + 1 };
            let noisy = if cheap { idle >= MOST_IDLE } else { !better && bracket.width() < NOISY };
            if value.abs() <= close || rounded || noisy {
                break;
            }
            bracket.take(trial, value);
            let Some(next) = bracket.next(close) else { break };
            trial = next;
        }
        let (weight, _, optimum) = best.expect("one solution at least");
        Ok((libm::exp(weight), optimum))
    }

    /// The optimum under the budget, nearly.
    fn nearly(
        &self,
        ends: &PathEnds,
        solver: &mut WeightedSolver<'_, '_>,
    ) -> Result<Option<BudgetOptimum>, FairError> {
        match ends.goal {
            Goal::Budget(_) if self.known.is_some() => Ok(self.known.clone()),
            Goal::Budget(share) | Goal::Near(share)
                if !ends.conditioned && self.adapts != Adaptation::Network =>
            {
                solver.parts.pull = None;
                solver.parts.within(solver.pull, share * ends.mean)
            }
            _ => Ok(None),
        }
    }

    /// A falling function of the weight's logarithm, negative when the goal is met.
    fn missing(&self, ends: &PathEnds, optimum: &Optimum) -> f64 {
        match ends.goal {
            Goal::Fairest => -1.0,
            Goal::Budget(share) | Goal::Near(share) => {
                libm::log((self.squares)(&optimum.points) / (share * ends.mean))
            }
            Goal::Nearest(share) => {
                // Of curves near enough to the least the one nearest to the data: towards the data
                // the measure rises.
                let most = (1.0 + share) * ends.least + self.noise;
                libm::log(most / (self.energy)(&optimum.points))
            }
            Goal::Energy(most) => libm::log(most / (self.energy)(&optimum.points)),
            Goal::Closest => 0.0,
        }
    }

    /// The logarithm of the weight that balances the measure at the fairest, about: its force there towards
    /// the original is that of the limits, which the weight replaces.
    fn balance(&self, ends: &PathEnds) -> f64 {
        let &PathEnds { begin, least, squares, .. } = ends;
        // The measure is a parabola along the line between them; its slope is read where the square
        // term does not cover it.
        let s = (least / begin).sqrt().clamp(1e-6, 0.5);
        let fairest = &ends.fairest.points;
        let between: Vec<_> =
            fairest.iter().zip(self.original).map(|(p, q)| *p + (*q - *p) * s).collect();
        let rise = (self.energy)(&between) - least - s * s * (begin - least);
        let weight = 0.5 * rise / (s * (1.0 - s) * squares);
        let floor = 1e-30 * begin / squares;
        if weight > floor && weight.is_finite() {
            libm::log(weight)
        } else {
            libm::log(least.max(1e-6 * begin) / squares)
        }
    }

    /// The result between the original and the optimum of a weight, by what there is to gain: both
    /// are within the tolerances, and so is all between them.
    fn settle(&self, ends: &PathEnds, optimum: Optimum, weight: f64) -> GoalOptimum {
        if ends.held || !matches!(ends.goal, Goal::Near(_)) {
            return self.ended(ends, optimum, weight);
        }
        let value = (self.energy)(&optimum.points);
        let gain = || worth_beside(ends.begin / value.max(f64::MIN_POSITIVE), ends.foreign);
        let share = self.moves.unwrap_or_else(gain);
        if share >= 1.0 {
            return self.ended(ends, optimum, weight);
        }
        let between = |(p, q): (&Vec3<f64>, &Vec3<f64>)| {
            if share == 0.0 { *q } else { *q + (*p - *q) * share }
        };
        let points: Vec<_> = optimum.points.iter().zip(self.original).map(between).collect();
        let now = (self.energy)(&points);
        let gap = optimum.certificate.gap + (now - value).max(0.0);
        let certificate = Certificate { value: now, gap };
        let active = if share == 0.0 { 0 } else { optimum.active };
        let optimum = Optimum { points, certificate, active, ..optimum };
        GoalOptimum { share, ..self.ended(ends, optimum, weight) }
    }

    /// The optimum of a weight as the result.
    fn ended(&self, ends: &PathEnds, optimum: Optimum, weight: f64) -> GoalOptimum {
        let value = (self.energy)(&optimum.points);
        let certificate = Certificate { value, ..optimum.certificate };
        GoalOptimum {
            share: 1.0,
            used: (self.squares)(&optimum.points) / ends.mean,
            optimum: Optimum { certificate, ..optimum },
            least: ends.least,
            weight,
            fairest: Some(ends.fairest.clone()),
            fairest_used: ends.squares / ends.mean,
            between: ends.between,
            several: ends.several && weight == 0.0,
        }
    }

    /// The original as the result.
    fn left_as_it_is(&self, ends: &PathEnds) -> GoalOptimum {
        let fairest = &ends.fairest;
        let mut left = GoalOptimum::unmoved(self.original, ends.begin, false);
        left.optimum.certificate.gap = ends.begin - ends.least + fairest.certificate.gap;
        left.optimum.iterations = fairest.iterations;
        left.least = ends.least;
        left.fairest_used = ends.squares / ends.mean;
        left.fairest = Some(fairest.clone());
        left
    }
}

/// Refuses derivatives of a fairest that measures nothing: it is one of many, and which one the solver
/// takes says nothing about how they move.
///
/// # Errors
/// [`FairError::NoDerivative`].
pub(crate) fn check_single(found: &GoalOptimum, begin: f64) -> Result<(), FairError> {
    if found.weight == 0.0 && found.share > 0.0 && found.least <= NOTHING * begin {
        return Err(FairError::NoDerivative(
            "several results within the tolerance have measure 0, so no derivatives are \
            available: use a smaller tolerance",
        ));
    }
    Ok(())
}

/// Weight of the data, relative to the one that balances the measure, that moves one of many
/// fairest results to the data, and the distance of that move, in tolerances.
const LIGHT: f64 = 1e-6;
const APART: f64 = 0.05;

/// Refuses derivatives of a fairest that is one of many: a trace of the data's weight takes another. Of a
/// network limits that are reached on one line may leave others free.
///
/// # Errors
/// [`FairError::NoDerivative`]; those of the solver.
pub(crate) fn check_unique(
    parts: &mut Parts<'_>,
    found: &GoalOptimum,
    pull: &SparseRows,
) -> Result<(), FairError> {
    if found.weight > 0.0 || found.share == 0.0 || parts.norm != RowNorm::Square {
        return Ok(());
    }
    if found.several {
        return Err(FairError::NoDerivative(SEVERAL));
    }
    // Between the data and the optimum: where that is, the solver says again.
    parts.pull = None;
    let fairest = parts.solve()?.points;
    let away: Vec<Vec3<f64>> = fairest.iter().zip(parts.points).map(|(p, q)| *p - *q).collect();
    let squares = pull.sum_sq(&away);
    if squares == 0.0 {
        return Ok(());
    }
    let weight = LIGHT * found.least.max(f64::MIN_POSITIVE) / squares;
    parts.pull = Some(pull.clone().scaled(weight.sqrt()));
    let other = parts.solve()?.points;
    parts.pull = None;
    let between: Vec<Vec3<f64>> = other.iter().zip(&fairest).map(|(p, q)| *p - *q).collect();
    let far = (0..pull.len()).map(|k| pull.apply(k, &between).norm()).fold(0.0, f64::max);
    if far > APART {
        return Err(FairError::NoDerivative(SEVERAL));
    }
    Ok(())
}

const SEVERAL: &str = "several results within the tolerance are equally fair, so no derivatives are \
    available: use the goal \"budget\"";

/// Refuses derivatives of a fairest of which it is not decided which limits it reaches: what the solver
/// has then is near the optimum and does not move as it does.
///
/// # Errors
/// [`FairError::NoDerivative`].
pub(crate) fn check_decided(found: &GoalOptimum, solved: &Solved) -> Result<(), FairError> {
    if found.weight == 0.0 && found.share > 0.0 && !solved.is_decided() {
        return Err(FairError::NoDerivative(
            "the tolerances that the fairest result reaches are undecided within rounding, so no \
            derivatives are available: use the goal \"budget\"",
        ));
    }
    Ok(())
}

/// Fraction of the data's own measure that counts as zero.
const NOTHING: f64 = 1e-9;

/// Variations of the data of a result.
pub(crate) struct GoalVariation<'a, T: Real> {
    /// The originals, as they and the limits move.
    pub originals: Vec<Vec3<T>>,
    /// Tolerances of the limits.
    pub tolerances: &'a [T],
    /// The tolerance of each row that pulls.
    pub pulled: Vec<T>,
    /// Values of the caller's conditions.
    pub targets: &'a [T],
    /// Changes of half the measure's slope that come from its rows and the limits' rows.
    pub forces: Vec<Vec3<T>>,
    /// The rows of the measure as they change.
    pub rows: &'a MovingRows<T>,
    /// Changes of the factors of the parts' conditions.
    pub bends: &'a [Bend<T>],
    /// The bound on the sum of squares, as it changes.
    pub budget: T,
    /// The original itself, which the originals are but for what its limits' rows change by.
    pub start: &'a [Vec3<T>],
}

/// The result of a goal with derivatives. `parts` has the pull of the weight found, `solved` is their
/// optimum, `pull` the rows that pull at weight 1.
pub(crate) fn moved<T: Real>(
    parts: &Parts<'_>,
    solved: &Solved,
    goal: Goal,
    found: &GoalOptimum,
    pull: &SparseRows,
    moving: GoalVariation<'_, T>,
) -> Result<Vec<Vec3<T>>, FairError> {
    if found.share == 0.0 {
        return Ok(moving.start.to_vec());
    }
    let n = parts.points.len();
    let at = &solved.optimum.points;
    let away: Vec<Vec3<f64>> = at.iter().zip(parts.points).map(|(p, q)| *p - *q).collect();
    let weight = found.weight;
    let zero = |all: &[T], k: usize| all[k] - T::from(all[k].re());
    let mut forces = moving.forces;
    if forces.is_empty() {
        forces = vec![Vec3::zero(); n];
    }
    // Residuals over tolerances: wider tolerances pull less.
    let residuals: Vec<Vec3<f64>> = (0..pull.len()).map(|k| pull.apply(k, &away)).collect();
    let stretch = |k: usize| zero(&moving.pulled, k) / moving.pulled[k].re();
    for (k, r) in residuals.iter().enumerate() {
        let (columns, factors) = pull.row(k);
        for (&c, &f) in columns.iter().zip(factors) {
            let change = stretch(k) * (-2.0 * weight * f);
            forces[c as usize] += r.map_real(|x| change * x);
        }
    }
    let mut out = parts.answer(
        solved,
        &moving.originals,
        moving.tolerances,
        moving.targets,
        moving.bends,
        &forces,
    )?;
    if weight > 0.0 {
        // The weight answers, too, so that the budget is kept.
        let mut slope = vec![Vec3::<Dual4>::zero(); n];
        pull.add_transposed_into(&residuals, |c, v| {
            slope[c] += v.map_real(|x| Dual4::from_parts(|k| if k == 1 { x } else { 0.0 }));
        });
        let plain: Vec<Vec3<Dual4>> = parts.points.iter().map(|&p| Vec3::lifted(p)).collect();
        let still = |all: &[T]| all.iter().map(|t| Dual4::from(t.re())).collect::<Vec<_>>();
        let (tolerances, targets) = (still(moving.tolerances), still(moving.targets));
        let answer = parts.answer(solved, &plain, &tolerances, &targets, &[], &slope)?;
        let by_weight: Vec<Vec3<f64>> =
            answer.iter().map(|p| Vec3::of(p.x.part(1), p.y.part(1), p.z.part(1))).collect();
        let (change, rate) = match goal {
            Goal::Nearest(_) | Goal::Energy(_) | Goal::Closest => {
                return Err(FairError::NoDerivative(
                    "no derivatives are available for the nearest curve: use `near`, `budget` or \
                    `fairest`",
                ));
            }
            _ => {
                let mut change = T::zero();
                let mut rate = 0.0;
                for (k, r) in residuals.iter().enumerate() {
                    let (columns, factors) = pull.row(k);
                    let mut moved = Vec3::zero();
                    for (&c, &f) in columns.iter().zip(factors) {
                        let c = c as usize;
                        let own = out[c] - moving.originals[c];
                        let own = own - Vec3::lifted(own.re());
                        moved += own.map(|x| x * f);
                    }
                    change += (moved.x * r.x + moved.y * r.y + moved.z * r.z) * 2.0;
                    change -= stretch(k) * (2.0 * r.norm_sq());
                    rate += 2.0 * r.dot(pull.apply(k, &by_weight));
                }
                (change - (moving.budget - moving.budget.re()), rate)
            }
        };
        if rate != 0.0 {
            let more = change * (-1.0 / rate);
            for (p, z) in out.iter_mut().zip(&by_weight) {
                *p += z.map_real(|x| more * x);
            }
        }
    }
    if found.share < 1.0 {
        let (begin, end) = (moving.rows.sum_sq(moving.start), moving.rows.sum_sq(&out));
        let share = worth(begin / end);
        let both = out.iter().zip(moving.start).zip(&found.optimum.points);
        return Ok(both
            .map(|((p, q), real)| {
                let mixed = *q + (*p - *q).map(|x| x * share);
                mixed - Vec3::lifted(mixed.re() - *real)
            })
            .collect());
    }
    // The solution may have been found from another one: its bits count.
    let found = out.iter().zip(&found.optimum.points);
    Ok(found.map(|(p, real)| *p - Vec3::lifted(p.re() - *real)).collect())
}
