//! A picture of the panels.

use crate::format::{Format, Holds};
use crate::picture::picture;
use crate::{Export, ExportFailure};
use moldloft_io::vtk::NamedFile;
use moldloft_picture::Options;

pub const FORMAT: Format = Format {
    name: "png",
    suffix: "png",
    about: "a picture",
    holds: Holds::Drawing,
    write,
    ..Format::PANELS
};

fn write(export: &mut Export<'_>) -> Result<Vec<NamedFile>, ExportFailure> {
    let Options { width, height, .. } = Options::default();
    let bytes = picture(export.document, width, height, &[])?;
    Ok(export.main_file(bytes))
}
