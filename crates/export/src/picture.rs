//! The picture of a model: its panels, contours and wires.

use crate::export::lines_and_points;
use crate::lines_drawing::points;
use moldloft_diag::Diagnostic;
use moldloft_document::{ContourSection, Document};
use moldloft_lang::functions::plots::{DrawnArrays, arrays_of_program};
use moldloft_picture::{Camera, Options, PictureError, StyledPolyline, render};
use moldloft_registry::Value;

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
/// # Errors
/// An impossible size; nothing to see.
pub fn picture(
    document: &mut Document,
    width: usize,
    height: usize,
) -> Result<Vec<u8>, Vec<Diagnostic>> {
    let mut lines: Vec<StyledPolyline> = document.sections().iter().flat_map(drawn).collect();
    let wires = lines_and_points(document).wires.into_iter();
    lines.extend(wires.map(|(_, points)| StyledPolyline {
        points,
        colour: WIRE_COLOUR,
        width: WIRE_WIDTH,
        on_surface: false,
    }));
    let symmetry = document.symmetry();
    let mirrors = ['x', 'y', 'z'].map(|axis| symmetry.contains(axis));
    let failed = |error: PictureError| vec![Diagnostic::error("no-picture", error.to_string())];
    let panelled = document.panelled().map_err(|d| vec![d])?;
    let options = Options { width, height, mirrors, ..Options::default() };
    if !(panelled.mesh.faces().is_empty() && lines.is_empty()) {
        return render(&panelled.mesh, &lines, &options).map_err(failed);
    }
    let variables: Vec<(String, Value<f64>)> =
        document.variables().into_iter().map(|(name, _, value)| (name, value)).collect();
    let arrays = arrays_of_program(&variables, &document.budget()).map_err(|d| vec![d])?;
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
