//! The cells of solids as VTK unstructured hexahedra.

use crate::export::FileName;
use crate::format::Format;
use moldloft_io::WriteError;
use moldloft_io::vtk::{self, NamedFile};
use moldloft_mesh::Blocks;

pub const FORMAT: Format = Format {
    name: "volume-vtu",
    suffix: "volume.vtu",
    about: "the cells of solids as VTK unstructured hexahedra",
    volume: Some(encode),
    ..Format::VOLUME
};

fn encode(blocks: &Blocks, name: &FileName<'_>) -> Result<Vec<NamedFile>, WriteError> {
    Ok(name.main_file(vtk::unstructured(blocks)?))
}
