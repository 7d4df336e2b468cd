//! A model as a boundary representation: its surfaces as NURBS, sewn where their panels are.
//!
//! `outlines of panels -> NURBS of surfaces -> runs of sides between common vertices -> edges -> shells -> parts`
//!
//! Two sides are one edge when they pass through the same vertices of the mesh, which are one by
//! identity, and their curves do not differ by more than the accuracy allows: positions are
//! compared to refuse a join, never to make one.

mod bodies;
mod edges;
mod faces;
mod faceted;
mod lines;
mod parents;
mod polyhedra;
mod sketches;
mod wires;

use crate::{ExportFailure, length_unit};
use edges::Sewing;
use moldloft_brep::{Brep, Part, Shell};
use moldloft_diag::Diagnostic;
use moldloft_document::{Document, has_no_area};
use moldloft_io::WriteError;
use moldloft_mesh::Mesh;

/// Default accuracy of fits, relative to the model's diagonal.
const ACCURACY: f64 = 1e-6;

/// Distance from a plane of symmetry, relative to the size, of points in the plane.
const SIDE: f64 = 1e-6;

/// The shown surfaces of a model, with their images in its planes of symmetry, as a boundary representation. A model
/// that shows no surface gives its shown curves.
///
/// # Errors
/// Panels that cannot be made; an accuracy that is not positive; surfaces that no fit comes near enough to; bodies that
/// have no faces on surfaces.
pub fn brep(
    document: &mut Document,
    accuracy: Option<f64>,
    stem: &str,
) -> Result<Brep, ExportFailure> {
    let (brep, refused) = brep_or_facets(document, accuracy, stem)?;
    match refused.into_iter().next() {
        None => Ok(brep),
        Some(fault) => Err(fault.into()),
    }
}

/// As [`brep`], with triangles for bodies that have no faces on surfaces; and the reason for each
/// of these.
///
/// # Errors
/// As [`brep`], but for such bodies.
pub fn brep_or_facets(
    document: &mut Document,
    accuracy: Option<f64>,
    stem: &str,
) -> Result<(Brep, Vec<Diagnostic>), ExportFailure> {
    let panelled = document.entire_panels();
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
    if let Some(none) = outlines.iter().find(|outline| has_no_area(&outline.surface)) {
        let message = format!("`{}` has no area: all of it is one line or point", none.name);
        let help = "hide it, or give it other curves; formats of panels hold it";
        return Err(Diagnostic::error("cannot-write", message).help(help).into());
    }
    outlines.iter_mut().for_each(parents::on_parent);
    let faces = faces::all(&outlines, accuracy)?;
    let mut brep = Sewing::new(&outlines, &faces, positions, accuracy, size).finish()?;
    let panelled = document.panelled()?;
    let mut refused = Vec::new();
    for name in bodies {
        let mesh = &panelled.mesh;
        let made = exact_body(&mut brep, document, mesh, &name, [accuracy, size]);
        if let Err(fault) = made {
            let reported = fault.diagnostics("step");
            // Parts missed by the facets too, and exceeded limits, are errors.
            let faces_only = reported.iter().all(|d| d.id == "curved-body");
            if !faces_only || reported.is_empty() {
                return Err(ExportFailure::from(reported));
            }
            brep.faceted.push(faceted::part(document, mesh, &name));
            refused.extend(reported.into_iter().take(1));
        }
    }
    for (axis, letter) in ['x', 'y', 'z'].into_iter().enumerate() {
        if symmetry.contains(letter) {
            check_side(&brep, axis, letter, size)?;
            brep = brep.with_image(axis);
        }
    }
    let shells = brep.shells();
    brep.parts = named(&brep, shells, stem)?;
    if brep.faceted.is_empty() {
        wires::add(&mut brep, document, accuracy)?;
    }
    lines::add(&mut brep, document, [accuracy, size], &symmetry)?;
    Ok((brep, refused))
}

/// Adds a body as faces on surfaces: those of a sketch, those of a set, or the planes of its facets.
fn exact_body(
    brep: &mut Brep,
    document: &Document,
    mesh: &Mesh,
    name: &str,
    [accuracy, size]: [f64; 2],
) -> Result<(), ExportFailure> {
    if sketches::add(brep, document, mesh, name, accuracy)?
        || bodies::add(brep, document, mesh, name, [accuracy, size])?
    {
        return Ok(());
    }
    polyhedra::add(brep, mesh, name, size)
}

/// Refuses faces of a half that extend to both sides of its plane of symmetry, or are on both:
/// their images would double them.
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

/// The inexact faces, with their accuracy; `None` if all are exact.
pub(crate) fn fitted(brep: &Brep, document: &Document) -> Option<Diagnostic> {
    const NAMED: usize = 3;
    let mut names: Vec<&str> = Vec::new();
    for face in brep.faces.iter().filter(|f| !f.exact) {
        let name = face.name.split('.').next().unwrap_or("");
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let lines = brep.parts.iter().flat_map(|part| &part.wires).filter(|w| !w.curve.exact);
    for name in lines.map(|wire| wire.name.split('.').next().unwrap_or("")) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let shown = names.iter().take(NAMED).map(|n| format!("`{n}`")).collect::<Vec<_>>().join(", ");
    let more = match names.len().checked_sub(NAMED) {
        None | Some(0) if names.is_empty() => return None,
        None | Some(0) => String::new(),
        Some(n) => format!(" and {n} more"),
    };
    let unit = length_unit(document).0;
    let message = format!("{shown}{more}: fitted within {:.2e} {unit}", brep.error());
    Some(
        Diagnostic::remark("fitted-surfaces", message)
            .help("`tolerance` changes the accuracy of fits"),
    )
}

/// Plane faces that are thinner than fits are exact: which of their edges come first is not known there, and programs
/// that test for it find the file invalid.
pub(crate) fn thin(brep: &Brep, document: &Document) -> Option<Diagnostic> {
    let error = brep.error().max(brep.gap);
    if brep.exact() {
        return None;
    }
    let found = brep.thin_faces(error);
    let &(face, place) = found.first()?;
    let name = brep.faces[face].name.split('.').next().unwrap_or("");
    let unit = length_unit(document).0;
    let faces = match found.len() {
        1 => "1 plane face is".to_string(),
        n => format!("{n} plane faces are"),
    };
    let message =
        format!("`{name}`: {faces} thinner than the accuracy of fits, {error:.2e} {unit}");
    let remark = Diagnostic::warning("thin-faces", message)
        .found(format!("the first near ({:.6}, {:.6}, {:.6})", place.x, place.y, place.z))
        .help(
            "another `tolerance` may avoid them; otherwise check the file in the program that reads it",
        );
    Some(remark)
}

/// The metres of the model's unit.
pub(crate) fn metres(document: &Document) -> f64 {
    length_unit(document).1 / 1000.0
}

/// A part for each shell: of one face, that face's name; of one object's faces, the object's; of several, theirs.
/// Cavities belong to the part of the body that they are in.
fn named(brep: &Brep, shells: Vec<Shell>, stem: &str) -> Result<Vec<Part>, ExportFailure> {
    const LONGEST: usize = 60;
    let inward = |shell: &Shell| {
        let known = shell.faces.first().and_then(|&f| brep.faces[f].extent);
        known.map_or_else(
            || brep.volume_of_polyhedron(shell).is_some_and(|v| v < 0.0),
            |(_, cavity)| cavity,
        )
    };
    let (cavities, shells): (Vec<Shell>, Vec<Shell>) = shells.into_iter().partition(inward);
    let mut taken = std::collections::HashMap::new();
    let mut part = |shell: Shell| {
        let mut name = objects(brep, &shell).join(", ");
        if name.chars().count() > LONGEST || name.is_empty() {
            name = stem.to_string();
        }
        let count: &mut usize = taken.entry(name.clone()).or_insert(0);
        *count += 1;
        if *count > 1 {
            name = format!("{name} {count}");
        }
        Part { name, shells: vec![shell], ..Part::default() }
    };
    let mut parts: Vec<Part> = shells.into_iter().map(&mut part).collect();
    for cavity in cavities {
        let own = objects(brep, &cavity);
        let inner = bounds(brep, &cavity);
        let round = |part: &&mut Part| {
            let shell = &part.shells[0];
            shell.closed && objects(brep, shell) == own && contains(bounds(brep, shell), inner)
        };
        let mut bodies: Vec<&mut Part> = parts.iter_mut().filter(round).collect();
        match &mut bodies[..] {
            // Surfaces that face inward, round nothing else.
            [] => parts.push(part(cavity)),
            [body] => body.shells.push(Shell { cavity: true, ..cavity }),
            _ => {
                let message = format!("`{}` has a cavity in one of several bodies", own.join(", "));
                let help = "write it as stl, 3mf or obj, or make a set of each body";
                return Err(Diagnostic::error("cavity", message).help(help).into());
            }
        }
    }
    Ok(parts)
}

/// The objects that the faces of a shell come from.
fn objects<'a>(brep: &'a Brep, shell: &Shell) -> Vec<&'a str> {
    let mut names: Vec<&str> = Vec::new();
    for &f in &shell.faces {
        let name = brep.faces[f].name.split('.').next().unwrap_or("");
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}

/// Least and greatest coordinates of a shell's edges.
fn bounds(brep: &Brep, shell: &Shell) -> [[f64; 3]; 2] {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for ([from, to], _) in shell.faces.iter().filter_map(|&f| brep.faces[f].extent) {
        for axis in 0..3 {
            low[axis] = low[axis].min(from[axis]);
            high[axis] = high[axis].max(to[axis]);
        }
    }
    for side in shell.faces.iter().flat_map(|&f| brep.faces[f].loops.iter().flatten()) {
        for p in &brep.edges[side.edge].curve.points {
            for axis in 0..3 {
                low[axis] = low[axis].min(p[axis]);
                high[axis] = high[axis].max(p[axis]);
            }
        }
    }
    [low, high]
}

fn contains([low, high]: [[f64; 3]; 2], [from, to]: [[f64; 3]; 2]) -> bool {
    (0..3).all(|axis| low[axis] < from[axis] && to[axis] < high[axis])
}
