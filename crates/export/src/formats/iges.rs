//! The shape itself as IGES.

use crate::brep::{brep, fitted, metres, thin};
use crate::format::{Format, Holds};
use crate::{Export, ExportFailure};
use moldloft_brep::SurfaceShape;
use moldloft_diag::Diagnostic;
use moldloft_io::iges::{self, IgesHeader};
use moldloft_io::vtk::NamedFile;

pub const FORMAT: Format = Format {
    name: "iges",
    aliases: &["igs"],
    suffix: "igs",
    other_suffix: "iges",
    about: "IGES 5.3: trimmed surfaces as NURBS",
    holds: Holds::Surfaces,
    text: true,
    write,
    ..Format::PANELS
};

fn write(export: &mut Export<'_>) -> Result<Vec<NamedFile>, ExportFailure> {
    let stem = export.stem().to_string();
    let brep = brep(export.document, export.options.tolerance, &stem)?;
    let mut images = brep.faces.iter().filter(|f| matches!(f.surface, SurfaceShape::Image(_)));
    let in_space = images.next().map(|face| {
        Diagnostic::remark(
            "curves-in-space",
            format!("edges of `{}` and its like have no curves in the parameters of their surfaces", face.name),
        )
        .help("programs recompute these, and may misread a face that crosses its seam; STEP can hold the same faces")
    });
    let reported = [thin(&brep, export.document), fitted(&brep, export.document), in_space];
    let reported = reported.into_iter().flatten().collect();
    export.document.set_export_remarks(reported);
    let metres = metres(export.document);
    let header = IgesHeader { title: &stem, metres, version: env!("CARGO_PKG_VERSION") };
    Ok(export.main_file(iges::write(&brep, &header)?))
}
