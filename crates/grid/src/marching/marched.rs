//! Grids that were marched, with the report.

use super::outcome::MarchReport;
use crate::{SurfaceGrid, VolumeGrid};

/// A marched grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Marched<T> {
    /// The layers, the wall first; off a curve one grid whose line s\[k,\] is layer k.
    pub layers: Vec<SurfaceGrid<T>>,
    /// Report of the march.
    pub report: MarchReport,
}

/// Blocks marched off several surfaces.
#[derive(Clone, Debug, PartialEq)]
pub struct MarchedBlocks<T> {
    /// One for each surface, which is its layer k = 1; points of faces that two blocks share are identical.
    pub blocks: Vec<VolumeGrid<T>>,
    /// Report of the march.
    pub report: MarchReport,
}
