//! Relabels: laws that redistribute the parameter of a curve, or the second one of a surface.

mod derived;
mod formulas;

pub use derived::{ArcLenRelabel, ComposeRelabel, CopyRelabel, InvRelabel};
pub use formulas::{CosRelabel, GeoRelabel, Relabel, TableRelabel, TanhRelabel};
