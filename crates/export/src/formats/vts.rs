//! Structured patches as VTK structured grids, with the fields of surfaces.

use crate::export::FileName;
use crate::format::{Format, Holds};
use crate::{Export, ExportFailure};
use moldloft_io::vtk::{self, NamedFile};
use moldloft_io::{StructuredGrid, WriteError};

pub const FORMAT: Format = Format {
    name: "vts",
    suffix: "vts",
    about: "VTK structured grids, one per patch",
    holds: Holds::Grids,
    write,
    grids: Some(encode_grids),
    ..Format::PANELS
};

fn write(export: &mut Export<'_>) -> Result<Vec<NamedFile>, ExportFailure> {
    let (mesh, fields) = (export.panels()?, export.surface_fields()?);
    Ok(export.main.renamed("vts", vtk::structured_files(&mesh, export.stem(), &fields)?))
}

fn encode_grids(
    grids: &[StructuredGrid],
    names: &[String],
    name: &FileName<'_>,
) -> Result<Vec<NamedFile>, WriteError> {
    Ok(name.renamed("vts", vtk::grid_files(grids, names, name.stem())?))
}
