//! A model as a boundary representation: its surfaces as NURBS, sewn where their panels are.
//!
//! `outlines of panels -> NURBS of surfaces -> runs of sides between common vertices -> edges -> shells -> parts`
//!
//! Two sides are one edge when they run through the same vertices of the mesh, which are one by identity, and their
//! curves do not part by more than the accuracy allows: places are compared to refuse a join, never to make one.

mod edges;
mod faces;
mod parents;
mod polyhedra;
mod wires;

use crate::{ExportFailure, length_unit};
use edges::Sewing;
use moldloft_brep::{Brep, Part, Shell};
use moldloft_diag::Diagnostic;
use moldloft_document::Document;
use moldloft_io::WriteError;

/// Accuracy of fits, as a share of the model's diagonal, when none is asked for.
const ACCURACY: f64 = 1e-6;

/// Distance from a plane of symmetry, as a share of the size, that counts as in the plane.
const SIDE: f64 = 1e-6;

/// The shown surfaces of a model, with their images in its planes of symmetry, as a boundary representation. A model
/// that shows no surface gives its shown curves.
///
/// # Errors
/// Panels that cannot be made; an accuracy that is not positive; surfaces that no fit comes near enough to.
pub fn brep(
    document: &mut Document,
    accuracy: Option<f64>,
    stem: &str,
) -> Result<Brep, ExportFailure> {
    let panelled = document.panelled();
    let size = match &panelled {
        Ok(p) if p.mesh.bounds().diagonal() > 0.0 => p.mesh.bounds().diagonal(),
        _ => 1.0,
    };
    let accuracy = accuracy.unwrap_or(ACCURACY * size);
    if accuracy.is_nan() || accuracy <= 0.0 {
        let message = format!("a tolerance is a positive number, not {accuracy}");
        return Err(Diagnostic::error("bad-tolerance", message).into());
    }
    let symmetry = document.symmetry();
    let panelled = panelled?;
    let positions = panelled.mesh.positions();
    if !positions.iter().all(|p| p.is_finite()) {
        return Err(Diagnostic::error("cannot-write", "a position is not a finite number").into());
    }
    let Some((mut outlines, bodies)) = panelled.panelling.outlines(document.graph()) else {
        return Err(Diagnostic::error("cannot-write", "a surface has no value").into());
    };
    outlines.iter_mut().for_each(|outline| parents::on_parent(document, outline));
    let faces = faces::all(&outlines, accuracy)?;
    let mut brep = Sewing::new(&outlines, &faces, positions, accuracy, size).finish()?;
    for name in bodies {
        polyhedra::add(&mut brep, &panelled.mesh, &name, size)?;
    }
    for (axis, letter) in ['x', 'y', 'z'].into_iter().enumerate() {
        if symmetry.contains(letter) {
            check_side(&brep, axis, letter, size)?;
            brep = brep.with_image(axis);
        }
    }
    let shells = brep.shells();
    brep.parts = named(&brep, shells, stem);
    wires::add(&mut brep, document, accuracy)?;
    Ok(brep)
}

/// Refuses faces of a half that reach to both sides of its plane of symmetry, or lie on both: their images would
/// double them.
fn check_side(brep: &Brep, axis: usize, letter: char, size: f64) -> Result<(), ExportFailure> {
    let (mut low, mut high) = (None, None);
    for face in &brep.faces {
        for side in face.loops.iter().flatten() {
            for p in &brep.edges[side.edge].curve.points {
                if p[axis] < -SIDE * size {
                    low = Some(&face.name);
                } else if p[axis] > SIDE * size {
                    high = Some(&face.name);
                }
            }
        }
    }
    match (low, high) {
        (Some(patch), Some(_)) => {
            Err(WriteError::BothSides { axis: letter, patch: patch.clone() }.into())
        }
        _ => Ok(()),
    }
}

/// The metres of the model's unit.
pub(crate) fn metres(document: &Document) -> f64 {
    length_unit(document).1 / 1000.0
}

/// A part for each shell: of one face, that face's name; of one object's faces, the object's; of several, theirs.
fn named(brep: &Brep, shells: Vec<Shell>, stem: &str) -> Vec<Part> {
    const LONGEST: usize = 60;
    let mut taken = std::collections::HashMap::new();
    let part = |shell: Shell| {
        let mut names: Vec<&str> = Vec::new();
        for &f in &shell.faces {
            let name = brep.faces[f].name.split('.').next().unwrap_or("");
            if !names.contains(&name) {
                names.push(name);
            }
        }
        let mut name = names.join(", ");
        if name.chars().count() > LONGEST || name.is_empty() {
            name = stem.to_string();
        }
        let count: &mut usize = taken.entry(name.clone()).or_insert(0);
        *count += 1;
        if *count > 1 {
            name = format!("{name} {count}");
        }
        Part { name, shells: vec![shell], wires: Vec::new() }
    };
    shells.into_iter().map(part).collect()
}
