//! The picture of a model: its panels, contours and wires.

use crate::export::lines_and_points;
use crate::lines_drawing::points;
use moldloft_diag::Diagnostic;
use moldloft_document::{ContourSection, Document};
use moldloft_lang::functions::plots::{DrawnArrays, picture_of};
use moldloft_picture::{Camera, Options, PictureError, StyledPolyline, render};
use std::borrow::Cow;
use std::collections::BTreeSet;

/// Contours on pictures: dark grey, so that they show on every patch.
const CONTOUR_COLOUR: [u8; 3] = [0x30, 0x36, 0x40];

/// In picture points.
const CONTOUR_WIDTH: f32 = 1.5;

/// Wires of bodies: dark and broad, so that they are seen against nothing.
const WIRE_COLOUR: [u8; 3] = [0x1b, 0x25, 0x33];
const WIRE_WIDTH: f32 = 3.0;

/// A picture of the model's panels, its contours as lines, and its mirror images; for a program
/// without any of these, of the arrays of points among its variables.
///
/// `only`: the names of the objects, patches, contours and arrays that are drawn, with their parts
/// (`hull` has `hull.top`, `parts` has `parts[2]`); all of them if empty. Arrays beside panels are
/// drawn as their lines.
///
/// # Errors
/// An impossible size; an unknown name; nothing to see.
pub fn picture(
    document: &mut Document,
    width: usize,
    height: usize,
    only: &[String],
) -> Result<Vec<u8>, Vec<Diagnostic>> {
    let takes = |name: &str| only.is_empty() || only.iter().any(|whole| is_part(name, whole));
    let sections = document.sections();
    let wires = lines_and_points(document).wires;
    let mut grids = document.grids();
    let failed = |error: PictureError| vec![Diagnostic::error("no-picture", error.to_string())];
    let panelled = document.panelled().map_err(|d| vec![d])?;
    let patches = panelled.mesh.patches().iter().map(|patch| patch.info.name.as_str());
    let contours = sections.iter().map(|section| section.contours.as_str());
    let names = patches.chain(contours).chain(wires.iter().map(|(name, _)| name.as_str()));
    all_are_among(only, names.chain(grids.iter().map(|grid| grid.name.as_str())).collect())?;

    let taken = sections.iter().filter(|section| takes(&section.contours));
    let mut lines: Vec<StyledPolyline> = taken.flat_map(drawn).collect();
    let wires = wires.into_iter().filter(|(name, _)| takes(name));
    lines.extend(wires.map(|(_, points)| StyledPolyline {
        points,
        colour: WIRE_COLOUR,
        width: WIRE_WIDTH,
        on_surface: false,
    }));
    grids.retain(|grid| takes(&grid.name));
    let mesh = match only {
        [] => Cow::Borrowed(&panelled.mesh),
        _ => {
            let selected = panelled.mesh.selected(|patch| takes(&patch.name));
            Cow::Owned(selected.map_err(|e| vec![Diagnostic::error("no-picture", e.to_string())])?)
        }
    };
    let symmetry = document.symmetry();
    let mirrors = ['x', 'y', 'z'].map(|axis| symmetry.contains(axis));
    let options = Options { width, height, mirrors, ..Options::default() };
    if !(mesh.faces().is_empty() && lines.is_empty()) {
        if !only.is_empty() {
            lines.extend(grids.iter().flat_map(|g| g.grid.lines()).map(|points| StyledPolyline {
                points,
                colour: CONTOUR_COLOUR,
                width: CONTOUR_WIDTH,
                on_surface: false,
            }));
        }
        return render(&mesh, &lines, &options).map_err(failed);
    }
    let arrays = picture_of(grids, &document.budget()).map_err(|d| vec![d])?;
    let Some(DrawnArrays { mesh, curves, view: [azimuth_deg, elevation_deg] }) = arrays else {
        return Err(vec![
            Diagnostic::error("no-picture", "there is nothing to see")
                .expected("surfaces or bodies that are shown, contours, or arrays of points")
                .help("points that were never set are all at {0, 0, 0}"),
        ]);
    };
    let camera = Camera { azimuth_deg, elevation_deg, ..Camera::default() };
    render(&mesh, &curves, &Options { camera, ..options }).map_err(failed)
}

/// Refuses chosen names that are none of the `names` and no whole of one.
fn all_are_among(only: &[String], names: BTreeSet<&str>) -> Result<(), Vec<Diagnostic>> {
    let known = |whole: &String| names.iter().any(|name| is_part(name, whole));
    let Some(unknown) = only.iter().find(|whole| !known(whole)) else { return Ok(()) };
    let message = format!("nothing that can be drawn is named `{unknown}`");
    Err(vec![
        Diagnostic::error("no-picture", message)
            .expected("shown surfaces or bodies, contours, or arrays of points")
            .suggest(unknown, names.iter().copied()),
    ])
}

/// True for a name that is `whole` or a part of it: `hull.top` of `hull`, `parts[2]` of `parts`.
fn is_part(name: &str, whole: &str) -> bool {
    let rest = name.strip_prefix(whole);
    rest.is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[', ' ']))
}

fn drawn(section: &ContourSection) -> Vec<StyledPolyline> {
    let lines = section.lines.iter().flat_map(|(_, lines)| lines);
    lines
        .map(|line| StyledPolyline {
            points: points(line),
            colour: CONTOUR_COLOUR,
            width: CONTOUR_WIDTH,
            on_surface: true,
        })
        .collect()
}
