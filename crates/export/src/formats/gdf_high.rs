//! WAMIT's high-order geometry: the surfaces themselves as B-spline patches.

use crate::format::{Format, Holds, Lids, SymmetryPlanes};
use crate::spline_patches::spline_patches;
use crate::{Export, ExportFailure, GRAVITY};
use moldloft_io::gdf::{self, Header};
use moldloft_io::vtk::NamedFile;

pub const FORMAT: Format = Format {
    name: "gdf-high",
    suffix: "high.gdf",
    about: "WAMIT high-order B-spline patches (.high.gdf)",
    holds: Holds::Surfaces,
    symmetry: SymmetryPlanes::Both,
    lids: Lids::Asked,
    text: true,
    write,
    ..Format::PANELS
};

fn write(export: &mut Export<'_>) -> Result<Vec<NamedFile>, ExportFailure> {
    let (tolerance, lids) = (export.options.tolerance, export.options.lids);
    export.require_closed_skin()?;
    let patches = spline_patches(export.document, tolerance, lids)?;
    let symmetry = export.document.symmetry();
    let header = Header {
        title: export.stem().into(),
        length: 1.0,
        gravity: GRAVITY / export.metres(),
        mirror_x: symmetry.contains('x'),
        mirror_y: symmetry.contains('y'),
    };
    Ok(export.main_file(gdf::write_patches(&patches, &header)))
}
