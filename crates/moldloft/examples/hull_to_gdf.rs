//! A model as WAMIT's panels: `cargo run -p moldloft --example hull_to_gdf -- MODEL.sdl > hull.gdf`.
//!
//! Without a model: half a hull of three B-spline stations and its transom, its beam changed before it is panelled.

use moldloft::{
    Diagnostic, Document, FileWorld, NoFiles, WriteOptions, format_named, registry, render, write,
};
use std::io::Write;
use std::process::ExitCode;

const HULL: &str = "
    param float beam = 5 in [3, 7];
    Model info(symmetry = \"y\", units = \"m\");
    AbsPoint P11(0, 0, 0); AbsPoint P12(0.3, 0, -0.4); AbsPoint P13(0.9, 0, -0.8);
    AbsPoint P21(8, 0.5 * beam, 0); AbsPoint P22(8, 0.5 * beam, -1.4); AbsPoint P23(8, 0, -1.4);
    AbsPoint P31(16, 0.4 * beam, 0); AbsPoint P32(16, 0.4 * beam, -0.5); AbsPoint P33(16, 0, -0.5);
    BCurve MC1({P11, P12, P13}, degree = 2); BCurve MC2({P21, P22, P23}, degree = 2);
    BCurve MC3({P31, P32, P33}, degree = 2);
    CLoftSurf hull({MC1, MC2, MC3}, divisions = {16, 8});
    AbsPoint P34(16, 0, 0); Line centre(P34, P33); RuledSurf transom(MC3, centre, divisions = {0, 4});
";

/// The panels of the model at `path`, or of the hull above, as WAMIT reads them; else its faults.
pub fn panels(path: Option<&str>) -> Result<Vec<u8>, String> {
    let mut model = match path {
        Some(path) => Document::open(registry(), Box::new(FileWorld::around(path, &[])), path),
        None => Document::from_text(registry(), Box::new(NoFiles), "hull.sdl", HULL),
    };
    let shown = |model: &Document, faults: &[Diagnostic]| -> String {
        faults.iter().map(|fault| render(fault, model.sources())).collect()
    };
    if model.has_errors() {
        return Err(shown(&model, &model.diagnostics()));
    }
    if path.is_none() {
        model.set(&[("beam".into(), 5.5)]).map_err(|faults| shown(&model, &faults))?;
    }
    let gdf = format_named("gdf").map_err(|fault| shown(&model, &[fault]))?;
    let files = write(&mut model, gdf, "hull.gdf", &WriteOptions::default());
    let files = files.map_err(|faults| shown(&model, &faults))?;
    Ok(files.into_iter().next().map(|file| file.bytes).unwrap_or_default())
}

/// Writes the panels, or the errors.
#[cfg_attr(test, allow(dead_code))]
pub fn main() -> ExitCode {
    match panels(std::env::args().nth(1).as_deref()) {
        Ok(bytes) if std::io::stdout().write_all(&bytes).is_ok() => ExitCode::SUCCESS,
        Ok(_) => ExitCode::FAILURE,
        Err(faults) => {
            eprint!("{faults}");
            ExitCode::FAILURE
        }
    }
}
