//! The cells of solids as VTK structured grids.

use crate::export::FileName;
use crate::format::Format;
use moldloft_io::WriteError;
use moldloft_io::vtk::{self, NamedFile};
use moldloft_mesh::Blocks;

pub const FORMAT: Format = Format {
    name: "volume-vts",
    suffix: "volume.vts",
    about: "the cells of solids as VTK structured grids, one per block, and a .vtm",
    volume: Some(encode),
    ..Format::VOLUME
};

fn encode(blocks: &Blocks, name: &FileName<'_>) -> Result<Vec<NamedFile>, WriteError> {
    Ok(name.renamed("vts", vtk::block_files(blocks, name.stem())?))
}
