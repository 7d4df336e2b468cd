//! What is remembered of the skin of a model: its surfaces, and its body at an accuracy.

use moldloft_hydro::Body;
use moldloft_panel::Skin;

/// The skin of a model, and its body at an accuracy.
#[derive(Debug)]
pub(crate) struct Bodied {
    /// When it was made.
    pub clock: u64,
    pub accuracy: f64,
    pub skin: Skin,
    pub body: Body<f64>,
}
