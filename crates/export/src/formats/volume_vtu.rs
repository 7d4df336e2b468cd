//! The cells of solids as VTK unstructured hexahedra.

use crate::export::FileName;
use crate::format::{Format, SolidCells};
use moldloft_io::WriteError;
use moldloft_io::vtk::{self, NamedFile};

pub const FORMAT: Format = Format {
    name: "volume-vtu",
    suffix: "volume.vtu",
    about: "the cells of solids as VTK unstructured hexahedra",
    volume: Some(encode),
    ..Format::VOLUME
};

fn encode(cells: &SolidCells<'_>, name: &FileName<'_>) -> Result<Vec<NamedFile>, WriteError> {
    Ok(name.main_file(vtk::unstructured(cells.blocks)?))
}
