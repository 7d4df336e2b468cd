//! Bodies of sketches: the exact surfaces of their faces.

use crate::ExportFailure;
use moldloft_brep::Brep;
use moldloft_diag::Diagnostic;
use moldloft_document::Document;
use moldloft_mesh::Mesh;
use moldloft_picture::PALETTE;

/// Adds the faces of the body of that name, if it is one of a sketch; false for other bodies.
///
/// # Errors
/// Faces that are not a plane, cylinder, cone, sphere, torus or extruded curve; edges that are not found.
pub fn add(
    brep: &mut Brep,
    document: &Document,
    mesh: &Mesh,
    name: &str,
    accuracy: f64,
) -> Result<bool, ExportFailure> {
    let Some(solid) = document.sketch_body(name) else { return Ok(false) };
    let prefix = format!("{name}.");
    let own = |name_of: &str| name_of == name || name_of.starts_with(&prefix);
    let info = mesh.patches().iter().map(|p| &p.info).find(|p| own(&p.name));
    let colour = info.and_then(|p| p.colour).map(|c| PALETTE[usize::from(c & 15)]);
    let layers = info.map(|p| p.tags.clone()).unwrap_or_default();
    let made = solid.brep(name, colour, &layers, accuracy).map_err(|fault| {
        Diagnostic::error("curved-body", format!("`{name}` is not written exactly: {fault}"))
            .help("write it as stl, 3mf or obj, or hide it")
    })?;
    brep.append(made);
    Ok(true)
}
