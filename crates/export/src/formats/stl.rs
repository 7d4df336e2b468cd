//! Triangles as binary STL.

use super::Format;
use crate::{Export, Failure};
use moldloft_io::stl;
use moldloft_io::vtk::NamedFile;

pub const FORMAT: Format = Format {
    name: "stl",
    suffix: "stl",
    about: "triangles, binary STL",
    write,
    ..Format::PANELS
};

fn write(export: &mut Export<'_>) -> Result<Vec<NamedFile>, Failure> {
    let mesh = export.panels()?;
    Ok(export.main_file(stl::write(&mesh, export.stem())?))
}
