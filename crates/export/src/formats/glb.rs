//! Panels with names and colours as binary glTF.

use crate::format::Format;
use crate::{Export, ExportFailure};
use moldloft_io::gltf;
use moldloft_io::vtk::NamedFile;
use moldloft_picture::patch_colour;

pub const FORMAT: Format = Format {
    name: "glb",
    suffix: "glb",
    about: "glTF with patch names and colours",
    write,
    ..Format::PANELS
};

fn write(export: &mut Export<'_>) -> Result<Vec<NamedFile>, ExportFailure> {
    let mesh = export.panels()?;
    let bytes = gltf::write(&mesh, export.stem(), export.metres(), patch_colour)?;
    Ok(export.main_file(bytes))
}
