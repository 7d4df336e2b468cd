//! Panels as Gmsh's format, a physical group for each patch.

use crate::format::Format;
use crate::{Export, ExportFailure};
use moldloft_io::msh;
use moldloft_io::vtk::NamedFile;

pub const FORMAT: Format = Format {
    name: "msh",
    aliases: &["gmsh"],
    suffix: "msh",
    about: "Gmsh 2.2 with a physical group for each patch",
    text: true,
    write,
    ..Format::PANELS
};

fn write(export: &mut Export<'_>) -> Result<Vec<NamedFile>, ExportFailure> {
    let mesh = export.panels()?;
    Ok(export.main_file(msh::write(&mesh)?))
}
