//! Triangles as binary STL.

use crate::export::FileName;
use crate::format::Format;
use crate::{Export, ExportFailure};
use moldloft_io::vtk::NamedFile;
use moldloft_io::{StructuredGrid, WriteError, stl};

pub const FORMAT: Format = Format {
    name: "stl",
    suffix: "stl",
    about: "triangles, binary STL",
    write,
    grids: Some(encode_grids),
    ..Format::PANELS
};

fn write(export: &mut Export<'_>) -> Result<Vec<NamedFile>, ExportFailure> {
    let mesh = export.panels()?;
    Ok(export.main_file(stl::write(&mesh, export.stem())?))
}

fn encode_grids(
    grids: &[StructuredGrid],
    _: &[String],
    name: &FileName<'_>,
) -> Result<Vec<NamedFile>, WriteError> {
    Ok(name.main_file(stl::write_grids(grids, name.stem(), false, &|| true)?))
}
