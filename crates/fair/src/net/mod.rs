//! Nets of surfaces, networks of curves, and surfaces with common edges.

mod conditions;
pub mod curves;
pub mod grid;
mod line_patterns;
mod lines;
pub mod network;
pub(crate) mod patches;
