//! The model: named objects that depend on each other, evaluated again only where they changed.
//!
//! `declarations -> Graph -> shapes -> Panelling -> Mesh`
//!
//! [`Graph::apply`] is the one way to change a model, for a run of a program and for a direct edit
//! alike. The graph is generic over the scalar: a graph of dual numbers, made by running the same
//! program with seeded numbers, gives exact derivatives of all that is computed from it.
//!
//! Invariant: this crate knows no particular kind, no syntax and no file.

mod blocks;
mod blocks_marks;
mod blocks_solve;
mod contour;
mod graph;
mod memo;
mod object;
mod panel;
mod sweep;

pub use blocks::{BlockRemark, Blocking, MOST_CELLS, grid as solid_grid};
pub use contour::{Polyline, Sectioned, body_section};
pub use graph::{Applied, DEEPEST_NESTING, Declaration, Extent, Graph, Run};
pub use object::{Failure, Object, State};
pub use panel::{ChainStep, MOST_PANELS, Nominal, Panelling, Remark, divisions, too_many_panels};
