//! Relation of a refined run to the coarse one.

use std::collections::HashMap;

/// Results of `refined` and `refined_step`, by their bits, with their values in the coarse run.
pub(crate) struct RefinedNumbers<T> {
    pub counts: HashMap<u64, f64>,
    pub steps: HashMap<u64, T>,
}

impl<T> Default for RefinedNumbers<T> {
    fn default() -> Self {
        Self { counts: HashMap::new(), steps: HashMap::new() }
    }
}
