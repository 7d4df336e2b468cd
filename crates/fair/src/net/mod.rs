//! Nets of surfaces, networks of curves, and surfaces with common edges.

mod conditions;
pub mod grid;
mod lines;
pub mod network;
pub(crate) mod patches;
