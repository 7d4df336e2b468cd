//! Panel meshes: connectivity, size and quality.
//!
//! `vertices and blocks -> Topology (+ positions) = Mesh -> report, measures, quality, sections`
//!
//! The connectivity ([`Topology`]) is separate from the positions, so the same panels are measured
//! with plain numbers or with dual numbers. All measures are generic over [`moldloft_num::Real`];
//! the report of a topology, the quality and the sections use real parts.
//!
//! Conventions: panels are counter-clockwise seen from outside, so their normals point from the solid
//! to the air or water; z points up; lengths are in the model's unit. A triangle is a face whose
//! last index is repeated.
//!
//! ```
//! use moldloft_mesh::{Mesh, PatchInfo, TopologyBuilder, measure};
//! use moldloft_num::Vec3;
//!
//! let mut builder = TopologyBuilder::new();
//! builder.add_vertices(6)?;
//! builder.add_block(PatchInfo::new("plate"), 3, 2, (0..6).collect(), false)?;
//! let positions = (0..6).map(|k| Vec3::of((k / 2) as f64, (k % 2) as f64, 0.0)).collect();
//! let plate = Mesh::<f64>::new(builder.build().into(), positions)?;
//! assert_eq!(measure(&plate).area, 2.0);
//! assert_eq!(plate.report().open_loops.len(), 1);
//! # Ok::<(), moldloft_mesh::MeshError>(())
//! ```
//!
//! Invariant: this crate knows vertices by number only, never by the entity they came from; it
//! opens no files. Sums are taken over fixed chunks in fixed order, so their bits do not depend on
//! threads.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod clip;
mod closure;
mod error;
mod half_edge;
mod inside;
mod measure;
mod mesh;
mod panel;
mod planar;
mod pulled;
mod quality;
mod report;
mod sagitta;
mod section;
mod select;
mod skin;
mod sum;
mod topology;
mod triangulate;
mod union;
mod volume;

pub use closure::{Closes, Closure, EdgeName, OpenEdge, closure};
pub use error::MeshError;
pub use inside::{InnerSkin, inner_skins};
pub use measure::{Measures, measure, measure_patch};
pub use mesh::Mesh;
pub use panel::Panel;
pub use planar::{planar_triangles, planar_triangles_along};
pub use pulled::pulled_measures;
pub use quality::{
    PatchQuality, Statistics, WorstPanel, pulled_quality, qualities, quality, worst_quality,
};
pub use report::{OpenLoop, TopologyReport};
pub use sagitta::sagittas;
pub use section::{Polyline, section, section_where};
pub use topology::{Block, Patch, PatchInfo, Tag, Topology, TopologyBuilder, is_triangle};
pub use triangulate::triangulate;
pub use union::{NotUnited, UnitedSkin, united};
pub use volume::{
    BadCell, BlockFace, BlockQuality, Blocks, BlocksReport, Boundary, HexBlock, Hexahedron,
    Interface, interfaces_of,
};
