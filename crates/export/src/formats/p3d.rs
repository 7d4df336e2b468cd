//! Structured patches as Plot3D.

use super::{Format, Holds};
use crate::{Export, Failure};
use moldloft_io::plot3d::{Variant, write_mesh};
use moldloft_io::vtk::NamedFile;

pub const FORMAT: Format = Format {
    name: "p3d",
    aliases: &["plot3d", "xyz"],
    suffix: "p3d",
    about: "Plot3D surface grids",
    holds: Holds::Grids,
    write,
    ..Format::PANELS
};

fn write(export: &mut Export<'_>) -> Result<Vec<NamedFile>, Failure> {
    let mesh = export.panels()?;
    Ok(export.main_file(write_mesh(&mesh, Variant::USUAL)?))
}
