//! The lines drawing: body plan, waterlines and buttocks, a sheet each.

use crate::format::{Format, Holds};
use crate::lines_drawing::lines_drawing;
use crate::{Export, ExportFailure};
use moldloft_io::vtk::NamedFile;

pub const FORMAT: Format = Format {
    name: "svg",
    suffix: "svg",
    about: "body plan, waterlines and buttocks, each with its scale",
    holds: Holds::Drawing,
    text: true,
    write,
    ..Format::PANELS
};

fn write(export: &mut Export<'_>) -> Result<Vec<NamedFile>, ExportFailure> {
    let stem = export.stem().to_owned();
    lines_drawing(export.document, &stem)
}
