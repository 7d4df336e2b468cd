//! Curves that bend no more often than they have to.

use crate::curve::data::{Data, DataFit, DataOptions};
use crate::curve::job::Job;
use crate::interrogate::shape::{self, Sample};
use crate::interrogate::soft_counts::{EARLY, LATE, SoftCounts};
use crate::interrogate::spans::SpanBasis;
use crate::optimum::goal::GoalOptimum;
use crate::{FairError, Measure, Space};
use moldloft_num::Vec3;

/// Fraction of a tolerance from which it counts as reached.
const REACHED: f64 = 1.0 - 1e-4;

/// Steps from the measure to that of bending.
const STEPS: usize = 8;

/// Excess of an inflection from which a curve has it.
pub(super) const HELD: f64 = 0.5;

/// Counts of a curve, on the same samples.
#[derive(Clone, Copy, Debug)]
pub(super) struct BendCounts {
    /// Changes of the curvature's sign.
    pub signs: usize,
    /// Monotone pieces of the curvature.
    pub pieces: usize,
}

impl BendCounts {
    pub fn of(samples: &[Sample]) -> Self {
        let pieces = shape::monotone_pieces(samples, shape::UNCOUNTED);
        Self { signs: shape::inflections(samples), pieces }
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

    pub fn soft(&self, points: &[Vec3<f64>], ramp: [f64; 2]) -> SoftCounts {
        SoftCounts::of(&self.samples(points), &self.space.corners(), ramp)
    }
}

impl Data {
    /// The curve of a goal, or a nearby one without unnecessary inflections. Third derivatives may
    /// trade smoothness for a turn; then bending is added to the measure, until the curve has no
    /// more inflections than the one of least bending. How much is an integral of counts in which
    /// an inflection counts by its height, and therefore a continuous function of the data.
    pub(super) fn without_bends(
        &self,
        options: &DataOptions,
        job: &Job,
        plain: DataFit,
        counter: &BendCounter<'_>,
    ) -> Result<DataFit, FairError> {
        let space = &self.layout.space;
        let counted = |points: &[Vec3<f64>], ramp| counter.soft(points, ramp).inflections;
        let own = counted(&plain.points, EARLY);
        if own == 0.0 {
            return Ok(plain);
        }
        let stiffest = self.least_bending(options, job)?;
        let most = counted(&stiffest, LATE);
        let over = |points: &[Vec3<f64>]| ((counted(points, EARLY) - most) / HELD).clamp(0.0, 1.0);
        let mut excess = over(&plain.points);
        if excess == 0.0 {
            return Ok(plain);
        }
        let norm = options.measure.norm();
        let rows = options.measure.rows(space)?;
        let stiff = Measure::Bending.rows(space)?;
        let (low, high) = (plain.certificate.value, stiff.sum_sq(&plain.points));
        let ratio = low.max(f64::MIN_POSITIVE) / high.max(f64::MIN_POSITIVE);
        // Of several optima the nearest is one of bending.
        let bending = DataOptions { measure: Measure::Bending, ..options.clone() };
        let mut parts = self.parts(options, job)?;
        let mut made = |s: f64| {
            if s <= 0.0 {
                return Ok(plain.clone());
            }
            if s >= 1.0 {
                return Ok(self.between_optima(stiffest.clone(), 0.0, job));
            }
            let odds = s / (1.0 - s);
            let weight = ratio * odds * odds * odds * odds;
            parts.measure = rows.clone().joined(&stiff.clone().scaled(weight.sqrt()));
            self.along(&bending, job, &mut parts)
        };
        let mut s = 0.0;
        for k in 0..STEPS {
            if k > 0 {
                excess = excess.min(over(&made(k as f64 / STEPS as f64)?.points));
            }
            if excess == 0.0 {
                break;
            }
            s += excess / STEPS as f64;
        }
        let mut made = made(s)?;
        // The gap includes the cost of fewer inflections.
        made.certificate.value = crate::measure::value(&rows, norm, &made.points);
        made.certificate.gap = made.certificate.gap.max(made.certificate.value - plain.least);
        (made.least, made.fairest_used) = (plain.least, plain.fairest_used);
        Ok(made)
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
