//! What refined runs know of the coarse one.

use std::collections::HashMap;

/// The numbers that `refined` and `refined_step` gave, by their bits, and what they are in the coarse run.
pub(crate) struct RefinedNumbers<T> {
    pub counts: HashMap<u64, f64>,
    pub steps: HashMap<u64, T>,
}

impl<T> Default for RefinedNumbers<T> {
    fn default() -> Self {
        Self { counts: HashMap::new(), steps: HashMap::new() }
    }
}
