//! VTK's XML formats: `.vtp` for panels, `.vts` for a structured patch or block, `.vtm` for several,
//! `.vtu` for all hexahedra of a volume mesh in one.
//!
//! Arrays follow the XML as raw little-endian bytes, each after its length in 64 bits ("VTK File
//! Formats", vtk.org, section "XML File Formats").

mod grid;
mod mesh;
mod volume;
mod xml;

pub use grid::{grid_files, grid_with_fields, structured_files};
pub use mesh::{polydata, polydata_with};
pub use volume::{block_files, unstructured};
pub use xml::{NamedFile, PatchFields, VtkArray};

#[cfg(test)]
mod tests;
