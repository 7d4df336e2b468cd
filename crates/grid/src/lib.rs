//! Structured grids: interpolation from their edges, smoothing, marching, and their quality.
//!
//! A surface grid is a [`SurfaceGrid`] of m by n points kept as three component planes; a volume grid is
//! a list of grids. All functions are generic over the scalar, so a grid carries its derivatives;
//! all give the same bits at any number of threads.
//!
//! `edges -> transfinite -> elliptic -> quality`, `surface, heights -> hyperbolic -> layers`
//!
//! Invariant: this crate knows no entity, no file and no language, and depends on `num` only.

// `!(a > b)` refuses NaN, `a <= b` lets it pass.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

mod blend;
mod block;
mod control;
mod elliptic;
mod error;
mod hyperbolic;
mod lines;
mod quality;
mod surface_grid;
mod zebra;

pub use blend::{Blend, transfinite};
pub use block::{Faces, transfinite_block};
pub use elliptic::{Elliptic, Method, Smoothed, Wall, elliptic, elliptic_until};
pub use error::{Corner, GridError};
pub use hyperbolic::{Hyperbolic, Side, hyperbolic, hyperbolic_curve};
pub use quality::{Metric, folded_cells, quality};
pub use surface_grid::{Edge, SurfaceGrid, framed};
