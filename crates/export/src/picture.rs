//! The picture of a model: its panels, contours and wires.

use crate::export::lines_and_points;
use crate::lines_drawing::points;
use moldloft_diag::Diagnostic;
use moldloft_document::{ContourSection, Document};
use moldloft_picture::{Options, StyledPolyline, render};

/// Contours on pictures: dark grey, so that they show on every patch.
const CONTOUR_COLOUR: [u8; 3] = [0x30, 0x36, 0x40];

/// In picture points.
const CONTOUR_WIDTH: f32 = 1.5;

/// Wires of bodies: dark and broad, so that they are seen against nothing.
const WIRE_COLOUR: [u8; 3] = [0x1b, 0x25, 0x33];
const WIRE_WIDTH: f32 = 3.0;

/// A picture of the model's panels, its contours as lines, and its mirror images.
///
/// # Errors
/// An impossible size.
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
    let panelled = document.panelled().map_err(|d| vec![d])?;
    let options = Options { width, height, mirrors, ..Options::default() };
    render(&panelled.mesh, &lines, &options)
        .map_err(|error| vec![Diagnostic::error("no-picture", error.to_string())])
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
