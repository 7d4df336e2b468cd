//! Meshes of a model: surfaces into panels, solids into blocks of cells, and contour lines.
//!
//! `Graph -> Panelling -> Mesh`, `Graph -> Blocking -> Blocks`, `surface -> ContourCutter -> contours`
//!
//! [`Panelling`] and [`Blocking`] hold the connectivity, which is independent of the scalar: both give
//! positions, and their derivatives, from a graph of any scalar.
//!
//! Invariant: this crate knows no particular kind, no syntax and no file. Vertices are one by identity (the
//! same division of the same interval of a root curve, the same point object), never because they look close.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod blocks;
mod border_curves;
mod conformal;
mod contour;
mod contour_integrals;
mod counts;
mod draft;
mod edges;
mod identity;
mod join;
mod joined_patches;
mod knuckles;
mod notes;
mod orientation;
mod outlines;
mod outward;
mod panelling;
mod patch_values;
#[cfg(not(target_family = "wasm"))]
mod pulled;
mod roots;
mod shared_edges;
mod skin;
mod t_junctions;
mod topology;
mod triangle_bodies;

pub use blocks::{BlockNote, Blocking};
pub use contour::{Contour, ContourCutter, body_section};
pub use contour_integrals::{ContourPiece, body_integrals, contour_piece};
pub use draft::divisions;
pub use notes::{ChainStep, PanelNote};
pub use outlines::{FaceOutline, OutlineCurve, OutlineSide};
pub use panelling::{MOST_PANELS, Panelling};
pub use shared_edges::{EdgeStretch, PatchEdge};
pub use skin::{Skin, object_measures};
pub use topology::Nominal;
