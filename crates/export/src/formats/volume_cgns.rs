//! The cells of solids as CGNS zones.

use crate::export::FileName;
use crate::format::{Format, SolidCells, SymmetryPlanes};
use moldloft_io::vtk::NamedFile;
use moldloft_io::{WriteError, cgns};

pub const FORMAT: Format = Format {
    name: "volume-cgns",
    suffix: "volume.cgns",
    about: "the cells of solids as CGNS zones",
    symmetry: SymmetryPlanes::Both,
    volume: Some(encode),
    ..Format::VOLUME
};

fn encode(cells: &SolidCells<'_>, name: &FileName<'_>) -> Result<Vec<NamedFile>, WriteError> {
    let SolidCells { blocks, symmetry, length } = cells;
    Ok(name.main_file(cgns::write_blocks(blocks, name.stem(), length, symmetry)?))
}
