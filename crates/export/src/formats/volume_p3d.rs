//! The cells of solids as Plot3D.

use super::{Format, Holds};
use crate::{Export, Failure};
use moldloft_io::plot3d::{Variant, write_blocks};
use moldloft_io::vtk::NamedFile;

pub const FORMAT: Format = Format {
    name: "volume-p3d",
    suffix: "volume.p3d",
    about: "the cells of solids as Plot3D volume grids",
    holds: Holds::Volumes,
    write,
    ..Format::PANELS
};

fn write(export: &mut Export<'_>) -> Result<Vec<NamedFile>, Failure> {
    let blocked = export.blocks()?;
    Ok(export.main_file(write_blocks(&blocked.blocks, Variant::USUAL)?))
}
