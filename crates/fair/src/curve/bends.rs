//! Curves that bend no more often than they have to.

use crate::curve::data::{Data, DataFit, DataOptions, SignSearch};
use crate::curve::job::Job;
use crate::interrogate::shape::{self, Sample};
use crate::interrogate::spans::SpanBasis;
use crate::optimum::goal::{Goal, GoalOptimum};
use crate::{FairError, Measure, ShapeConstraints, Space};
use moldloft_num::Vec3;

/// Search under signs, when its only purpose is to remove turns: relative change of the measure at
/// convergence, maximum number of linearisations, and the number of those after the signs hold.
const SETTLED: f64 = 1e-3;
const ROUNDS: usize = 12;
const FEW: usize = 4;

/// Fraction of a tolerance from which it counts as reached.
const REACHED: f64 = 1.0 - 1e-4;

/// If there are more points, and the fairest curve has more turns than this, the turns are due to
/// rounding: sixth differences of such short steps have no digits left, and their signs are
/// meaningless.
const MANY: usize = 2000;
const ROUNDED_TURNS: usize = 32;

/// Steps, and halvings of one of them, of the interpolation between two curves.
const SHARES: usize = 32;
const HALVINGS: usize = 6;

/// Counts of a curve, all on the same samples.
#[derive(Clone, Copy, Debug)]
pub(super) struct BendCounts {
    /// Reversals of the tangent's turning.
    turns: usize,
    /// Changes of the curvature's sign.
    pub signs: usize,
    /// Monotone pieces of the curvature.
    pub pieces: usize,
}

impl BendCounts {
    pub fn of(samples: &[Sample]) -> Self {
        Self {
            turns: shape::reversals(samples),
            signs: shape::inflections(samples),
            pieces: shape::monotone_pieces(samples, shape::UNCOUNTED),
        }
    }
}

/// Counts the bends of the curves of one space.
pub(super) struct BendCounter<'a> {
    space: &'a Space,
    basis: std::cell::OnceCell<SpanBasis>,
}

impl<'a> BendCounter<'a> {
    pub fn new(space: &'a Space) -> Self {
        Self { space, basis: std::cell::OnceCell::new() }
    }

    pub fn samples(&self, points: &[Vec3<f64>]) -> Vec<Sample> {
        let basis = self.basis.get_or_init(|| shape::counting_basis(self.space));
        basis.samples(self.space, points)
    }

    pub fn of(&self, points: &[Vec3<f64>]) -> BendCounts {
        BendCounts::of(&self.samples(points))
    }
}

impl Data {
    /// The curve of a goal, or a nearby one without unnecessary turns. Third derivatives may trade
    /// smoothness for a turn; then the signs of curvature of the fairest curve, or of the one with
    /// the least bending, become conditions. If no such curve is found, the result is an
    /// interpolation between the curve and the fairest, which is within the tolerances because both
    /// are.
    pub(super) fn without_bends(
        &self,
        options: &DataOptions,
        job: &Job,
        plain: DataFit,
        fairest: Vec<Vec3<f64>>,
        counter: &BendCounter<'_>,
    ) -> Result<DataFit, FairError> {
        let space = &self.layout.space;
        let counted = |points: &[Vec3<f64>]| counter.of(points);
        let (own_counts, signs) = (counted(&plain.points), counted(&job.points).signs);
        if own_counts.turns == 0 && own_counts.signs <= signs {
            return Ok(plain);
        }
        let fairest = if fairest.is_empty() { self.fairest(options, job)? } else { fairest };
        let mut starts = vec![(counted(&fairest).turns, fairest)];
        let stiffest = self.least_bending(options, job)?;
        let count = counted(&stiffest).turns;
        starts.insert(usize::from(count >= starts[0].0), (count, stiffest));
        let most = starts[0].0;
        let well = |points: &[Vec3<f64>]| {
            let counts = counted(points);
            counts.turns <= most && counts.signs <= signs
        };
        if well(&plain.points) {
            return Ok(plain);
        }
        let least = plain.least;
        // The gap includes the cost of the signs.
        let priced = |mut made: DataFit| {
            made.certificate.gap = made.certificate.gap.max(made.certificate.value - least);
            made.least = least;
            made.fairest_used = plain.fairest_used;
            made
        };
        let known = job.points.len() <= MANY || most <= ROUNDED_TURNS;
        for (_, start) in starts.iter().filter(|s| known && s.0 <= most) {
            let Some(shape) = ShapeConstraints::pattern(space, start) else { continue };
            // First with the weight of the goal's own curve: without signs that curve is optimal in
            // the weighted sum, which therefore is a lower bound.
            let search = SignSearch {
                weight: Some(plain.weight),
                settled: SETTLED,
                rounds: ROUNDS,
                least: self.weighed_value(&plain),
            };
            let signed = DataOptions { shape: shape.clone(), ..options.clone() };
            let first = match self.with_signs(&signed, job, shape.clone(), start, search) {
                Ok(first) if well(&first.points) => first,
                Ok(_) | Err(FairError::Shape { .. }) => continue,
                Err(other) => return Err(other),
            };
            if options.goal == Goal::Fairest {
                return Ok(priced(first));
            }
            let then = SignSearch { settled: f64::INFINITY, rounds: FEW, ..SignSearch::WHOLE };
            return match self.with_signs(&signed, job, shape, &first.points, then) {
                Ok(more) if well(&more.points) => Ok(priced(more)),
                Ok(_) | Err(FairError::Shape { .. }) => Ok(priced(first)),
                Err(other) => Err(other),
            };
        }
        let norm = options.measure.norm();
        let rows = options.measure.rows(space)?;
        // As much bending beside the measure as keeps the turns.
        let stiff = Measure::Bending.rows(space)?;
        let (low, high) = (plain.certificate.value, stiff.sum_sq(&plain.points));
        let ratio = low.max(f64::MIN_POSITIVE) / high.max(f64::MIN_POSITIVE);
        let mut parts = self.parts(options, job)?;
        for factor in [0.1, 1.0, 10.0, 100.0].into_iter().filter(|_| known) {
            parts.measure = rows.clone().joined(&stiff.clone().scaled(factor * ratio.sqrt()));
            let mut made = self.along(options, job, &mut parts)?;
            if well(&made.points) {
                made.certificate.value = crate::measure::value(&rows, norm, &made.points);
                return Ok(priced(made));
            }
        }
        let (_, start) = &starts[0];
        let between = |share: f64| -> Vec<Vec3<f64>> {
            let both = start.iter().zip(&plain.points);
            both.map(|(p, q)| *p + (*q - *p) * share).collect()
        };
        let shares = (0..SHARES).rev().map(|k| k as f64 / SHARES as f64);
        if let Some(mut low) = shares.into_iter().find(|&s| well(&between(s))) {
            let mut high = low + 1.0 / SHARES as f64;
            for _ in 0..HALVINGS {
                let middle = 0.5 * (low + high);
                *(if well(&between(middle)) { &mut low } else { &mut high }) = middle;
            }
            let points = between(low);
            let value = crate::measure::value(&rows, norm, &points);
            let mut made = self.between_optima(points, value, job);
            made.certificate.gap = value;
            return Ok(priced(made));
        }
        let bends = own_counts.signs.saturating_sub(signs);
        if bends == 0 || !options.conditions.is_empty() || !self.layout.interpolates() {
            return Ok(DataFit { bends, ..plain });
        }
        // The curve through the data bends no more often than itself.
        let value = crate::measure::value(&rows, norm, &job.points);
        let mut kept = self.fit(GoalOptimum::unmoved(&job.points, value, false), job);
        kept.least = least;
        kept.bends = bends;
        Ok(kept)
    }

    /// The fit of a curve between optima; its gap is set by the caller.
    pub(super) fn between_optima(&self, points: Vec<Vec3<f64>>, value: f64, job: &Job) -> DataFit {
        let mut made = self.fit(GoalOptimum::unmoved(&points, value, false), job);
        let radii = &self.limit.radii;
        let reached = made.residuals.iter().zip(radii).filter(|(r, a)| **r >= **a * REACHED);
        made.active = reached.count();
        made.used = self.used(&made.residuals);
        made
    }
}
