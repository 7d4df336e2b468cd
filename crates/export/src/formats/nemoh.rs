//! Nemoh's panels.

use crate::format::{Format, SymmetryPlanes};
use crate::{Export, ExportFailure};
use moldloft_io::nemoh;
use moldloft_io::vtk::NamedFile;

pub const FORMAT: Format = Format {
    name: "nemoh",
    aliases: &["mar"],
    suffix: "mar",
    other_suffix: "dat",
    about: "Nemoh panels (.mar)",
    symmetry: SymmetryPlanes::Y,
    write,
    ..Format::PANEL_CODE
};

fn write(export: &mut Export<'_>) -> Result<Vec<NamedFile>, ExportFailure> {
    let (mesh, options) = export.panels_of_code()?;
    Ok(export.main_file(nemoh::write(&mesh, options)?))
}
