//! Panels as binary PLY.

use crate::format::Format;
use crate::{Export, ExportFailure};
use moldloft_io::ply;
use moldloft_io::vtk::NamedFile;

pub const FORMAT: Format =
    Format { name: "ply", suffix: "ply", about: "binary PLY", write, ..Format::PANELS };

fn write(export: &mut Export<'_>) -> Result<Vec<NamedFile>, ExportFailure> {
    let mesh = export.panels()?;
    Ok(export.main_file(ply::write(&mesh)?))
}
