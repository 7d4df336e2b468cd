//! Nets of surfaces, networks of curves, and surfaces with common edges.

pub mod arcs;
mod between;
pub mod condition_text;
mod conditions;
pub mod curves;
pub mod grid;
mod line_patterns;
mod lines;
pub mod network;
mod passes;
pub(crate) mod patches;
pub mod report;
mod seam;
pub mod shapes;
mod sign_room;
pub mod strand;
mod tied;
pub mod toward;
