//! The cells of solids as Plot3D.

use crate::export::FileName;
use crate::format::Format;
use moldloft_io::WriteError;
use moldloft_io::plot3d::{Variant, write_blocks};
use moldloft_io::vtk::NamedFile;
use moldloft_mesh::Blocks;

pub const FORMAT: Format = Format {
    name: "volume-p3d",
    suffix: "volume.p3d",
    about: "the cells of solids as Plot3D volume grids",
    volume: Some(encode),
    ..Format::VOLUME
};

fn encode(blocks: &Blocks, name: &FileName<'_>) -> Result<Vec<NamedFile>, WriteError> {
    Ok(name.main_file(write_blocks(blocks, Variant::USUAL)?))
}
