//! Panels, wires and points as Wavefront OBJ.

use crate::format::{Format, Holds};
use crate::{Export, ExportFailure};
use moldloft_io::obj;
use moldloft_io::vtk::NamedFile;

pub const FORMAT: Format = Format {
    name: "obj",
    suffix: "obj",
    about: "Wavefront OBJ",
    holds: Holds::PanelsAndLines,
    text: true,
    write,
    ..Format::PANELS
};

fn write(export: &mut Export<'_>) -> Result<Vec<NamedFile>, ExportFailure> {
    let (mesh, lines) = (export.panels()?, export.lines_and_points());
    Ok(export.main_file(obj::write_with(&mesh, &lines)?))
}
