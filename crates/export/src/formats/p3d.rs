//! Structured patches as Plot3D.

use crate::export::FileName;
use crate::format::{Format, Holds};
use crate::{Export, ExportFailure};
use moldloft_io::plot3d::{self, Variant, write_mesh};
use moldloft_io::vtk::NamedFile;
use moldloft_io::{StructuredGrid, WriteError};

pub const FORMAT: Format = Format {
    name: "p3d",
    aliases: &["plot3d", "xyz"],
    suffix: "p3d",
    about: "Plot3D surface grids",
    holds: Holds::Grids,
    write,
    grids: Some(encode_grids),
    ..Format::PANELS
};

fn write(export: &mut Export<'_>) -> Result<Vec<NamedFile>, ExportFailure> {
    let mesh = export.panels()?;
    Ok(export.main_file(write_mesh(&mesh, Variant::USUAL)?))
}

fn encode_grids(
    grids: &[StructuredGrid],
    _: &[String],
    name: &FileName<'_>,
) -> Result<Vec<NamedFile>, WriteError> {
    Ok(name.main_file(plot3d::write(grids, Variant::USUAL)?))
}
