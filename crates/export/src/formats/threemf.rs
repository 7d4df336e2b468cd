//! Triangles with names and colours as 3MF.

use crate::format::Format;
use crate::units::threemf_unit;
use crate::{Export, ExportFailure};
use moldloft_io::threemf;
use moldloft_io::vtk::NamedFile;
use moldloft_picture::patch_colour;

pub const FORMAT: Format = Format {
    name: "3mf",
    suffix: "3mf",
    about: "triangles with names and colours, for printers",
    write,
    ..Format::PANELS
};

fn write(export: &mut Export<'_>) -> Result<Vec<NamedFile>, ExportFailure> {
    let mesh = export.panels()?;
    let unit = threemf_unit(export.metres());
    Ok(export.main_file(threemf::write(&mesh, export.stem(), unit, patch_colour)?))
}
