//! Structured patches as VTK structured grids, with the fields of surfaces.

use super::{Format, Holds};
use crate::{Export, Failure};
use moldloft_io::vtk::{self, NamedFile};

pub const FORMAT: Format = Format {
    name: "vts",
    suffix: "vts",
    about: "VTK structured grids, one per patch",
    holds: Holds::Grids,
    write,
    ..Format::PANELS
};

fn write(export: &mut Export<'_>) -> Result<Vec<NamedFile>, Failure> {
    let (mesh, fields) = (export.panels()?, export.surface_fields()?);
    Ok(export.renamed(vtk::structured_files(&mesh, export.stem(), &fields)?))
}
