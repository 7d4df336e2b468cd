//! The curve of a goal while a tolerance slides: within the tolerances and under the budget as always, but one
//! bound on the squares finds it instead of a search for their weight, and its bends are as they come.

use crate::Certificate;
use crate::FairError;
use crate::curve::data::{Data, DataFit, DataOptions};
use crate::curve::job::Job;
use crate::optimum::goal::{Goal, GoalOptimum, rounding, worth};
use crate::optimum::{BudgetOptimum, Optimum};

impl Data {
    /// The draft of a curve: the optimum of its goal to the accuracy of one bound, whatever it bends.
    pub(super) fn drafted(&self, options: &DataOptions) -> Result<DataFit, FairError> {
        let options = DataOptions { bends: true, ..options.clone() };
        let job = self.job()?;
        let mut parts = self.parts(&options, &job)?;
        let still = self.limit.radii.iter().all(|&r| r == 0.0);
        let plain = options.conditions.is_empty() && options.shape.is_empty() && !still;
        let share = match options.goal {
            Goal::Near(share) | Goal::Budget(share) => Some(share),
            _ => None,
        };
        let own = plain && self.layout.interpolates() && !self.exact_parts();
        if let (true, Some(share)) = (own, share) {
            let pull = self.pull(&parts);
            let mean = pull.len() as f64 / 3.0;
            if let Some(mut found) = parts.within(&pull, share * mean)? {
                let energy =
                    |points: &[_]| crate::measure::value(&parts.measure, parts.norm, points);
                if let Some(order) = options.measure.derivative_order() {
                    let near = found.optimum.clone();
                    let near = self.nearest_fairest(order, &parts.frozen, near)?;
                    let both = near.points.iter().zip(&job.points);
                    let moved: Vec<_> = both.map(|(p, q)| *p - *q).collect();
                    let noise = rounding(&parts.measure, parts.norm, &job.points);
                    let least = energy(&near.points) <= energy(&found.optimum.points).max(noise);
                    if least && pull.sum_sq(&moved) <= share * mean {
                        found.optimum = near;
                    }
                }
                return Ok(self.settled(&options, &job, found, energy));
            }
            parts.pull = None;
        }
        if plain || options.shape.is_empty() {
            return self.along(&options, &job, &mut parts);
        }
        self.under_shape(&options, &job)
    }

    /// The curve under a budget as far from the data as it is worth to move.
    fn settled(
        &self,
        options: &DataOptions,
        job: &Job,
        found: BudgetOptimum,
        energy: impl Fn(&[moldloft_num::Vec3<f64>]) -> f64,
    ) -> DataFit {
        let (begin, value) = (energy(&job.points), energy(&found.optimum.points));
        let gain = worth(begin / value.max(f64::MIN_POSITIVE));
        let share = if matches!(options.goal, Goal::Near(_)) { gain } else { 1.0 };
        let both = job.points.iter().zip(&found.optimum.points);
        let points: Vec<_> =
            both.map(|(q, p)| if share < 1.0 { *q + (*p - *q) * share } else { *p }).collect();
        let now = energy(&points);
        let gap = found.optimum.certificate.gap + (now - value).max(0.0);
        let mut made = GoalOptimum::unmoved(&points, now, false);
        made.optimum =
            Optimum { points, certificate: Certificate { value: now, gap }, ..found.optimum };
        (made.share, made.weight, made.least) = (share, found.weight, value);
        let fit = self.fit(made, job);
        let used = self.used(&fit.residuals);
        DataFit { used, ..fit }
    }
}
