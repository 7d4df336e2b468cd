//! Triangles as text STL, a solid for each patch.

use crate::format::Format;
use crate::{Export, ExportFailure};
use moldloft_io::stl;
use moldloft_io::vtk::NamedFile;

pub const FORMAT: Format = Format {
    name: "stl-text",
    suffix: "ascii.stl",
    other_suffix: "stl",
    about: "triangles, text STL with a solid for each patch",
    text: true,
    write,
    ..Format::PANELS
};

fn write(export: &mut Export<'_>) -> Result<Vec<NamedFile>, ExportFailure> {
    let mesh = export.panels()?;
    Ok(export.main_file(stl::write_text(&mesh)?))
}
