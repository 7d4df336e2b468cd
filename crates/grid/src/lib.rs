//! Structured grids: interpolation from their edges, smoothing, marching, and their quality.
//!
//! A surface grid is a [`SurfaceGrid`] of m by n points kept as three component planes; a volume grid
//! a [`VolumeGrid`]. All functions are generic over the scalar, so a grid carries its derivatives;
//! all give the same bits at any number of threads.
//!
//! `edges -> transfinite -> elliptic -> quality`, `surface, heights -> hyperbolic -> layers`
//!
//! Invariant: this crate knows no entity, no file and no language, and depends on `num` only.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
// `!(a > b)` refuses NaN, `a <= b` lets it pass.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

mod blend;
mod block;
mod block_quality;
mod control;
mod elliptic;
mod error;
mod hex_mesh;
mod lines;
mod marching;
mod periodic;
mod pole_cells;
mod quality;
mod surface_grid;
mod volume_elliptic;
mod volume_grid;
mod zebra;

pub use blend::{Blend, transfinite, transfinite_until};
pub use block::{Faces, transfinite_block, transfinite_block_until};
pub use block_quality::{BlockMetric, block_quality, block_quality_until};
pub use control::{WallReport, wall_cells};
pub use elliptic::{Elliptic, Method, PeriodicEdges, Smoothed, Wall, elliptic, elliptic_until};
pub use error::{Corner, GridError};
pub use hex_mesh::{
    BoundaryPatch, FaceNames, HEX_FACES, HexMesh, MeshCheck, shared_nodes, shared_nodes_within,
};
pub use marching::{
    FailureCause, Hyperbolic, JoinFault, MarchBoundary, MarchFailure, MarchPlace, MarchReport,
    Marched, MarchedBlocks, OpenFrontEdges, Stop, StopReason, Support, hyperbolic,
    hyperbolic_curve, hyperbolic_curve_until, hyperbolic_surfaces, hyperbolic_surfaces_until,
    hyperbolic_until,
};
pub use pole_cells::PoleCell;
pub use quality::{QualityMetric, folded_cells, folded_cells_until, quality, quality_until};
pub use surface_grid::{GridSide, SurfaceGrid, framed};
pub use volume_elliptic::{
    EllipticVolume, FaceWall, FaceWallReport, SmoothedVolume, elliptic_volume_until,
};
pub use volume_grid::{GridFace, VolumeGrid};
