//! Cached results of the whole model: its skin, its body at an accuracy, its numbers.

use moldloft_hydro::Body;
use moldloft_panel::Skin;
use moldloft_registry::Value;

/// The skin of a model, and its body at an accuracy.
#[derive(Debug)]
pub(crate) struct Bodied {
    /// Clock value at its creation.
    pub clock: u64,
    pub accuracy: f64,
    pub skin: Skin,
    pub body: Body<f64>,
}

/// Numbers of the whole model by their names.
pub(crate) type Numbers = Vec<(&'static str, Value<f64>)>;

/// The numbers of `mesh` or `hydrostatics`.
pub(crate) struct Whole {
    /// Clock value at their computation.
    pub clock: u64,
    /// The symmetry planes used.
    pub symmetry: String,
    /// The numbers.
    pub numbers: Numbers,
}
