//! Structured patches as CGNS zones with their interfaces.

use crate::export::FileName;
use crate::format::{Format, Holds, SymmetryPlanes};
use crate::{Export, ExportFailure};
use moldloft_io::cgns::{self, USUAL_TOLERANCE};
use moldloft_io::vtk::NamedFile;
use moldloft_io::{StructuredGrid, WriteError};

pub const FORMAT: Format = Format {
    name: "cgns",
    suffix: "cgns",
    about: "CGNS structured surface zones with interfaces",
    holds: Holds::Grids,
    symmetry: SymmetryPlanes::Both,
    write,
    grids: Some(encode_grids),
    ..Format::PANELS
};

fn write(export: &mut Export<'_>) -> Result<Vec<NamedFile>, ExportFailure> {
    let mesh = export.panels()?;
    let (length, symmetry) = (export.stated_length(), export.document.symmetry());
    Ok(export.main_file(cgns::write_mesh(&mesh, export.stem(), &length, &symmetry)?))
}

fn encode_grids(
    grids: &[StructuredGrid],
    names: &[String],
    name: &FileName<'_>,
) -> Result<Vec<NamedFile>, WriteError> {
    Ok(name.main_file(cgns::write_surfaces(grids, names, name.stem(), USUAL_TOLERANCE)?))
}
