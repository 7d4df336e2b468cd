//! The model: named objects that depend on each other, evaluated again only where they changed.
//!
//! `declarations -> Graph -> values`
//!
//! [`Graph::apply`] alone changes a model, for a run of a program as for a direct edit. The graph
//! is generic over the scalar: a graph of dual numbers, made by running the same program with
//! seeded numbers, gives exact derivatives of all that is computed from it.
//!
//! Invariant: this crate knows no particular kind, no mesh, no syntax and no file.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod graph;
mod memo;
mod object;
mod sweep;

pub use graph::{Applied, DEEPEST_NESTING, Declaration, Extent, Graph, Run};
pub use memo::number_count;
pub use object::{Failure, Object, State};
