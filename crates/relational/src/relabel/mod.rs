//! Relabels: laws that redistribute the parameter of a curve, or the second one of a surface.

mod by_length;
mod derived;
mod formulas;

pub use by_length::ArcLenRelabel;
pub use derived::{ComposeRelabel, CopyRelabel, InvRelabel};
pub use formulas::{CosRelabel, GeoRelabel, Relabel, TableRelabel, TanhRelabel};
