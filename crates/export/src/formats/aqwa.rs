//! AQWA's geometry decks, always cut at the water: the code takes no panel across it.

use crate::format::Format;
use crate::{Export, ExportFailure};
use moldloft_io::aqwa;
use moldloft_io::vtk::NamedFile;

pub const FORMAT: Format = Format {
    name: "aqwa",
    suffix: "dat",
    about: "AQWA geometry decks (.dat)",
    write,
    ..Format::PANEL_CODE
};

fn write(export: &mut Export<'_>) -> Result<Vec<NamedFile>, ExportFailure> {
    export.options.immersed = true;
    let (mesh, options) = export.panels_of_code()?;
    Ok(export.main_file(aqwa::write(&mesh, export.stem(), options)?))
}
