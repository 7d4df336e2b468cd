//! The shape itself as STEP.

use crate::brep::{brep, metres};
use crate::format::{Format, Holds};
use crate::{Export, ExportFailure};
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
    let brep = brep(export.document, export.options.tolerance, &stem)?;
    let header = StepHeader {
        title: &stem,
        metres: metres(export.document),
        version: env!("CARGO_PKG_VERSION"),
        protocol: Protocol::Ap242,
    };
    Ok(export.main_file(step::write(&brep, &header)?))
}
