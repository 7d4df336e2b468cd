//! The cells of solids as VTK unstructured hexahedra.

use super::{Format, Holds};
use crate::{Export, Failure};
use moldloft_io::vtk::{self, NamedFile};

pub const FORMAT: Format = Format {
    name: "volume-vtu",
    suffix: "volume.vtu",
    about: "the cells of solids as VTK unstructured hexahedra",
    holds: Holds::Volumes,
    write,
    ..Format::PANELS
};

fn write(export: &mut Export<'_>) -> Result<Vec<NamedFile>, Failure> {
    let blocked = export.blocks()?;
    Ok(export.main_file(vtk::unstructured(&blocked.blocks)?))
}
