//! The shape itself as STEP.

use crate::brep::{brep_or_facets, fitted, metres, thin};
use crate::format::{Format, Holds};
use crate::{Export, ExportFailure};
use moldloft_diag::Diagnostic;
use moldloft_io::step::{self, Protocol, StepHeader};
use moldloft_io::vtk::NamedFile;

pub const FORMAT: Format = Format {
    name: "step",
    aliases: &["stp", "ap242"],
    suffix: "step",
    other_suffix: "stp",
    about: "STEP AP242: surfaces as NURBS and planes, sewn into shells and solids",
    holds: Holds::Surfaces,
    text: true,
    write,
    ..Format::PANELS
};

fn write(export: &mut Export<'_>) -> Result<Vec<NamedFile>, ExportFailure> {
    let stem = export.stem().to_string();
    let (brep, refused) = brep_or_facets(export.document, export.options.tolerance, &stem)?;
    let reported = brep.faceted.iter().zip(&refused).map(|(part, why)| {
        let count = part.triangles.len();
        let remark = Diagnostic::warning(
            "as-triangles",
            format!("`{}` is written as {count} triangles, without surfaces", part.name),
        )
        .found(why.message.clone())
        .help("programs without AP242 tessellation ignore it; 3mf and stl hold the same triangles");
        match part.error {
            Some(error) => {
                remark.note(format!("their centres are up to {error:.2e} from the shape"))
            }
            None => remark,
        }
    });
    let reported = reported
        .chain(thin(&brep, export.document))
        .chain(fitted(&brep, export.document))
        .collect();
    export.document.set_export_remarks(reported);
    let header = StepHeader {
        title: &stem,
        metres: metres(export.document),
        version: env!("CARGO_PKG_VERSION"),
        protocol: Protocol::Ap242,
    };
    Ok(export.main_file(step::write(&brep, &header)?))
}
