//! CGNS files of structured zones (SIDS 4.4 in its mapping to HDF5).
//!
//! A node is a group with the attributes `name`, `label`, `type` and `flags`, its numbers the array ` data` in it.
//! Written are zones with their points, one-to-one and periodic interfaces, and boundaries with families; read are
//! names and points of the zones.

mod read;
mod surfaces;
mod volume;
mod write;

pub use read::read;
pub use surfaces::{USUAL_TOLERANCE, write_mesh, write_surfaces};
pub use volume::{block_boundaries, write_blocks, write_volume};
pub use write::{BlockJoint, FacePart, PeriodicJoint};
