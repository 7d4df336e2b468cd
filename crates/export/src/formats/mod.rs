//! THE table of formats: a row and a module for each.
//!
//! To add a format, write its module with its row, and name it below.

mod aqwa;
mod cgns;
mod gdf;
mod gdf_high;
mod glb;
mod hams;
mod hydrostar;
mod iges;
mod model_file;
mod msh;
mod nemoh;
mod obj;
mod off;
mod p3d;
mod ply;
mod png;
mod program;
mod step;
mod stl;
mod stl_text;
mod su2;
mod svg;
mod threemf;
mod volume_cgns;
mod volume_p3d;
mod volume_vts;
mod volume_vtu;
mod vtp;
mod vts;

use crate::format::Format;
use moldloft_diag::Diagnostic;

/// All formats, in the order in which help lists them.
pub static FORMATS: &[Format] = &[
    gdf::FORMAT,
    gdf_high::FORMAT,
    nemoh::FORMAT,
    hydrostar::FORMAT,
    hams::FORMAT,
    aqwa::FORMAT,
    stl::FORMAT,
    stl_text::FORMAT,
    threemf::FORMAT,
    obj::FORMAT,
    off::FORMAT,
    ply::FORMAT,
    msh::FORMAT,
    su2::FORMAT,
    glb::FORMAT,
    vtp::FORMAT,
    vts::FORMAT,
    p3d::FORMAT,
    cgns::FORMAT,
    volume_p3d::FORMAT,
    volume_vts::FORMAT,
    volume_vtu::FORMAT,
    volume_cgns::FORMAT,
    step::FORMAT,
    iges::FORMAT,
    svg::FORMAT,
    png::FORMAT,
    program::FORMAT,
    model_file::FORMAT,
];

/// The format of that name or alias, ignoring case.
///
/// # Errors
/// No such format, with the nearest name; `dat`, which files of two codes end in.
pub fn format_named(name: &str) -> Result<&'static Format, Diagnostic> {
    let wanted = name.to_lowercase();
    let is = |f: &&Format| f.name == wanted || f.aliases.contains(&wanted.as_str());
    if let Some(format) = FORMATS.iter().find(is) {
        return Ok(format);
    }
    let ends = FORMATS.iter().filter(|f| [f.suffix, f.other_suffix].contains(&wanted.as_str()));
    let ends: Vec<String> = ends.map(|f| format!("`{}`", f.name)).collect();
    let names = FORMATS.iter().map(|f| f.name);
    let error = Diagnostic::error("unknown-format", format!("unknown format `{name}`"));
    Err(match &ends[..] {
        [] => error.expected(names.clone().collect::<Vec<_>>().join(", ")).suggest(name, names),
        codes => error.expected(codes.join(" or ")),
    })
}
