//! The cells of solids as VTK structured grids.

use super::{Format, Holds};
use crate::{Export, Failure};
use moldloft_io::vtk::{self, NamedFile};

pub const FORMAT: Format = Format {
    name: "volume-vts",
    suffix: "volume.vts",
    about: "the cells of solids as VTK structured grids, one per block, and a .vtm",
    holds: Holds::Volumes,
    write,
    ..Format::PANELS
};

fn write(export: &mut Export<'_>) -> Result<Vec<NamedFile>, Failure> {
    let blocked = export.blocks()?;
    Ok(export.renamed(vtk::block_files(&blocked.blocks, export.stem())?))
}
