//! The cells of solids as Plot3D.

use crate::export::FileName;
use crate::format::{Format, SolidCells};
use moldloft_io::WriteError;
use moldloft_io::plot3d::{Variant, write_blocks};
use moldloft_io::vtk::NamedFile;

pub const FORMAT: Format = Format {
    name: "volume-p3d",
    suffix: "volume.p3d",
    about: "the cells of solids as Plot3D volume grids",
    volume: Some(encode),
    ..Format::VOLUME
};

fn encode(cells: &SolidCells<'_>, name: &FileName<'_>) -> Result<Vec<NamedFile>, WriteError> {
    Ok(name.main_file(write_blocks(cells.blocks, Variant::USUAL)?))
}
