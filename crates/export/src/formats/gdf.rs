//! WAMIT's low-order panels.

use crate::format::Format;
use crate::{Export, ExportFailure, GRAVITY};
use moldloft_io::gdf::{self, Header};
use moldloft_io::vtk::NamedFile;

pub const FORMAT: Format = Format {
    name: "gdf",
    aliases: &["wamit"],
    suffix: "gdf",
    about: "WAMIT low-order panels",
    write,
    ..Format::PANEL_CODE
};

fn write(export: &mut Export<'_>) -> Result<Vec<NamedFile>, ExportFailure> {
    let (mesh, options) = export.panels_of_code()?;
    let header = Header {
        title: export.stem().into(),
        length: 1.0,
        gravity: GRAVITY / export.metres(),
        mirror_x: options.mirror_x,
        mirror_y: options.mirror_y,
    };
    Ok(export.main_file(gdf::write(&mesh, &header, options.lids)?))
}
