//! Panels, wires and points as VTK polygons, with the fields of surfaces.

use crate::format::{Format, Holds};
use crate::{Export, ExportFailure};
use moldloft_io::vtk::{self, NamedFile};

pub const FORMAT: Format = Format {
    name: "vtp",
    suffix: "vtp",
    about: "VTK polygons",
    holds: Holds::PanelsAndLines,
    write,
    ..Format::PANELS
};

fn write(export: &mut Export<'_>) -> Result<Vec<NamedFile>, ExportFailure> {
    let (mesh, lines) = (export.panels()?, export.lines_and_points());
    let fields = export.surface_fields()?;
    Ok(export.main_file(vtk::polydata_with(&mesh, &lines, &fields)?))
}
