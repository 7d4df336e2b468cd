//! The cells of solids as VTK structured grids.

use crate::export::FileName;
use crate::format::{Format, SolidCells};
use moldloft_io::WriteError;
use moldloft_io::vtk::{self, NamedFile};

pub const FORMAT: Format = Format {
    name: "volume-vts",
    suffix: "volume.vts",
    about: "the cells of solids as VTK structured grids, one per block, and a .vtm",
    volume: Some(encode),
    ..Format::VOLUME
};

fn encode(cells: &SolidCells<'_>, name: &FileName<'_>) -> Result<Vec<NamedFile>, WriteError> {
    Ok(name.renamed("vts", vtk::block_files(cells.blocks, name.stem())?))
}
