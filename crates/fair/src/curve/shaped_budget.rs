//! Budgets under a shape: larger ones where the curves of the goal's own do not have it.

use crate::FairError;
use crate::curve::data::{Data, DataFit, DataOptions};
use crate::curve::job::Job;
use crate::optimum::goal::Goal;

/// Steps from the goal's budget to that of the fairest.
const BUDGET_STEPS: usize = 4;

/// Minimum ratio of the last budget to the first.
const LEAST_WAY: f64 = 1.05;

impl Data {
    /// The curve of the goal `near` or `budget` with the required shape. If no curve of the budget has it, the
    /// budget rises towards that of the fairest curve that has.
    pub(super) fn budgeted_shape(
        &self,
        options: &DataOptions,
        job: &Job,
    ) -> Result<DataFit, FairError> {
        let (Goal::Near(budget) | Goal::Budget(budget)) = options.goal else {
            return self.under_shape(options, job);
        };
        if self.meets(&options.shape, job) {
            return self.gated_shape(options, job);
        }
        // A search for the fairest takes a tenth of the time, and ends where there is no such curve.
        let shape = options.shape.without_pieces();
        let fairest = DataOptions { goal: Goal::Fairest, shape, ..options.clone() };
        let fairest = self.under_shape(&fairest, job)?;
        let end = fairest.used.max(LEAST_WAY * budget);
        for k in 0..=BUDGET_STEPS {
            let own = budget * libm::pow(end / budget, k as f64 / BUDGET_STEPS as f64);
            let goal = match options.goal {
                Goal::Near(_) => Goal::Near(own),
                _ => Goal::Budget(own),
            };
            match self.gated_shape(&DataOptions { goal, ..options.clone() }, job) {
                Err(FairError::Shape { .. }) => {}
                other => return other,
            }
        }
        Ok(DataFit { fairer: 1.0, arcs: options.shape.arcs.clone(), ..fairest })
    }
}
