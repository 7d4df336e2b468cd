//! Cache of compiled regions in a run.

use super::code::{CodeRegion, Generation, RegionStart};
use crate::source::module::Name;
use moldloft_num::Real;
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// The code of a region, as far as there is some.
pub(super) enum RegionState<T: Real> {
    /// The code, once for each meaning of its names that was met.
    Kept(Vec<Arc<CodeRegion<T>>>),
    Never(Generation),
}

pub(crate) struct ScalarCode<T: Real> {
    pub(super) regions: HashMap<(usize, RegionStart), RegionState<T>>,
    /// The names that `global` declarations in routines make, and whether all routines are known to load nothing.
    pub(super) of_file: Option<(Generation, Arc<HashSet<Name>>, bool)>,
}

impl<T: Real> Default for ScalarCode<T> {
    fn default() -> Self {
        Self { regions: HashMap::new(), of_file: None }
    }
}
