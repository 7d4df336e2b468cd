//! Panels as OFF, which programs of computational geometry read.

use crate::format::Format;
use crate::{Export, ExportFailure};
use moldloft_io::off;
use moldloft_io::vtk::NamedFile;

pub const FORMAT: Format = Format {
    name: "off",
    suffix: "off",
    about: "Object File Format, text",
    text: true,
    write,
    ..Format::PANELS
};

fn write(export: &mut Export<'_>) -> Result<Vec<NamedFile>, ExportFailure> {
    let mesh = export.panels()?;
    Ok(export.main_file(off::write(&mesh)?))
}
