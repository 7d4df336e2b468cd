//! Panels as SU2's format, a marker for each patch.

use crate::format::Format;
use crate::{Export, ExportFailure};
use moldloft_io::su2;
use moldloft_io::vtk::NamedFile;

pub const FORMAT: Format = Format {
    name: "su2",
    suffix: "su2",
    about: "SU2 panels with a marker for each patch",
    text: true,
    write,
    ..Format::PANELS
};

fn write(export: &mut Export<'_>) -> Result<Vec<NamedFile>, ExportFailure> {
    let mesh = export.panels()?;
    Ok(export.main_file(su2::write(&mesh)?))
}
