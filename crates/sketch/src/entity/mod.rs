//! Kinds that bring sketches into a model.
//!
//! A loaded sketch also declares points (`AbsPoint`) and lines (`DrawnLine`); see `lang`.

mod arc;
mod body;
mod chain;
mod patch;

pub use body::MeshBody;

use moldloft_registry::Row;
use moldloft_registry::export::StaticRow;

/// All kinds of this crate, in the order of the reference.
///
/// # Example
/// ```
/// let rows = moldloft_sketch::entity::rows();
/// assert!(rows.iter().any(|row| row.name == "FacePatch"));
/// ```
pub fn rows() -> Vec<Row> {
    vec![
        <arc::ConjugateArc<f64> as StaticRow>::row(),
        <chain::CubicChain<f64> as StaticRow>::row(),
        <patch::FacePatch<f64> as StaticRow>::row(),
        <body::MeshBody<f64> as StaticRow>::row(),
    ]
}
