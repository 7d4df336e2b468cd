//! Nearest points and intersections of curves and surfaces.
//!
//! `shape -> pieces with bounds -> candidates -> Newton on the shape itself -> solution + report`
//!
//! From a given start the solution is the one that a damped Newton iteration leads to; if that
//! fails, or without a start, subdivision finds all solutions and takes the nearest. Each answer
//! depends on the shapes and the start only, never on earlier answers, and has a [`LocateReport`].
//! Searches use plain numbers ([`PlainCurve`], [`PlainSurface`] are such views of shapes of any
//! scalar); derivatives follow from the solution by the implicit function theorem ([`implicit`]).
//!
//! Guarantees of completeness are stated in [`pieces`], [`roots`], [`curve_pairs`] and
//! [`branches`].
//!
//! Invariant: this crate knows no entity, no registry and no file.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
// The report is needed after a failed search; it is made once per search.
#![allow(clippy::result_large_err)]

mod batch;
pub mod branches;
mod cells;
pub mod common;
pub mod curve_pairs;
pub mod implicit;
pub mod march;
mod nearest;
mod newton;
pub mod pieces;
mod plain;
mod predictor;
mod report;
pub mod roots;
mod slab_tree;
mod tree;

pub use batch::{Nearest, NearestCurve, NearestSurface, by_place};
pub use nearest::{nearest_in_curve, nearest_in_surface, nearest_on_curve, nearest_on_surface};
pub use newton::{
    ACCURACY, LONGEST_STEP, MOST_STEPS, NewtonResult, OUTSIDE, UnknownBounds, newton,
};
pub use plain::{PlainCurve, PlainSurface};
pub use report::{Alternative, FoundRoot, LocateReport, LocateStatus, Parameters, Roots, Solution};
pub use roots::Level;
pub use tree::{Boxes, CurveTree, Node, SurfaceTree};
