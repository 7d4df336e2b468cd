//! Typed rough sketches that become exact parametric solids by a few dimensions.
//!
//! An object is drawn roughly, once, as a flat picture. Not its accuracy but its topology and the
//! *types* of its lines carry the meaning: a type says which of x, y, z change along a line, so every
//! line makes its ends share one or two planes perpendicular to axes. N planes on an axis need N - 1
//! dimensions. When all are given the sketch is exact in space; faces, volume and curves follow.
//!
//! `picture -> types -> planes -> dimensions -> coordinates -> faces -> solid`
//!
//! Source: R. E. Brewer, J. A. Jortner, W. N. Waggenspack, *Reference Manual: Computer Graphics
//! Program for Generation of Engineering Geometry (SKETCH)*, WES Technical Report K-83-3, 1983.
//!
//! Invariant: this crate reads no file and no clock, and no line given to it makes it panic.

mod axis;
pub mod curve;
mod derived;
mod drawing;
mod estimate;
mod expr;
pub mod faces;
pub mod json;
mod layout;
mod mass;
mod object;
mod planes;
mod projection;
pub mod solid;
mod triangulate;
mod typing;

pub use axis::{Axis, Free, Letters, Naming};
pub use derived::scale;
pub use drawing::{Align, Drawing, FaceId, Line, LineId, Point, PointId, Source};
pub use estimate::{Estimate, FreeDepth, MAX_PLANES};
pub use expr::{Expr, FUNCTIONS, NoValue};
pub use layout::{Count, DimensionFault, Layout, Loose, agree, chain, chain_text, solve};
pub use mass::Mass;
pub use object::{Dimension, Face, Measure, Object, Reference, Role, Variable};
pub use planes::{Planes, Reason, TypeFault, why};
pub use projection::Projection;
pub use solid::{Solid, solid};
pub use triangulate::triangulate;
pub use typing::{DOUBTFUL, NAMING_TOLERANCE};
