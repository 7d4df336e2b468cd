//! HydroStar's panels.

use crate::format::{Format, SymmetryPlanes};
use crate::{Export, ExportFailure};
use moldloft_io::hydrostar;
use moldloft_io::vtk::NamedFile;

pub const FORMAT: Format = Format {
    name: "hydrostar",
    aliases: &["hst"],
    suffix: "hst",
    about: "HydroStar panels (.hst)",
    symmetry: SymmetryPlanes::YThenX,
    write,
    ..Format::PANEL_CODE
};

fn write(export: &mut Export<'_>) -> Result<Vec<NamedFile>, ExportFailure> {
    let (mesh, options) = export.panels_of_code()?;
    Ok(export.main_file(hydrostar::write(&mesh, export.stem(), options)?))
}
