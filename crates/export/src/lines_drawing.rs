//! The lines drawing: contours of the model, and cuts at round coordinates along the axes without
//! contours, arranged as body plan, waterlines and buttocks.

use crate::{ExportFailure, length_unit};
use moldloft_diag::Diagnostic;
use moldloft_document::{ContourSection, Document};
use moldloft_io::drawing::{self, View};
use moldloft_io::vtk::NamedFile;
use moldloft_num::Vec3;
use moldloft_panel::{Contour, ContourCutter};
use moldloft_registry::{Family, Value};

/// The lines drawing: body plan, waterlines and buttocks, a sheet each.
///
/// # Errors
/// Panels that cannot be made.
pub(crate) fn lines_drawing(
    document: &mut Document,
    stem: &str,
) -> Result<Vec<NamedFile>, ExportFailure> {
    let (contours, options) = cut(document, stem)?;
    let views = [
        (View::BodyPlan, "body-plan"),
        (View::Waterlines, "waterlines"),
        (View::Buttocks, "buttocks"),
    ];
    let sheet = |(view, word): (View, &str)| {
        let bytes = drawing::draw(view, &contours, &options);
        NamedFile { name: format!("{stem}.{word}.svg"), bytes }
    };
    Ok(views.into_iter().map(sheet).collect())
}

/// The lines plan on one landscape A3 sheet: profile, half-breadth plan and body plan at one scale,
/// as SVG.
///
/// # Errors
/// Panels that cannot be made.
pub fn lines_sheet(document: &mut Document, title: &str) -> Result<Vec<u8>, Vec<Diagnostic>> {
    let cut = cut(document, title).map_err(|failure| failure.diagnostics("a lines plan"));
    let (contours, options) = cut?;
    Ok(drawing::draw_plan(&contours, &drawing::DrawingOptions { width_mm: 400.0, ..options }))
}

/// The contours of a model, and how they are drawn.
fn cut(
    document: &mut Document,
    title: &str,
) -> Result<(Vec<drawing::PlaneCut>, drawing::DrawingOptions), ExportFailure> {
    let mut contours: Vec<drawing::PlaneCut> =
        document.sections().into_iter().map(contour).collect();
    let panelled = document.entire_panels()?;
    let bounds = panelled.mesh.bounds();
    for axis in 0..3 {
        // Axes without contours are cut at round coordinates.
        if contours.iter().all(|c| c.axis != axis) {
            let values = round_values(bounds.low[axis], bounds.high[axis]);
            contours.extend(cuts(document, axis, &values));
        }
    }
    let (unit, unit_mm) = length_unit(document);
    let title = title.into();
    let options = drawing::DrawingOptions { title, unit, unit_mm, ..Default::default() };
    Ok((contours, options))
}

fn contour(section: ContourSection) -> drawing::PlaneCut {
    let lines = section.lines.iter().flat_map(|(_, lines)| lines);
    contour_of(section.axis, section.value, lines.map(points).collect())
}

fn contour_of(axis: usize, value: f64, lines: Vec<Vec<Vec3>>) -> drawing::PlaneCut {
    let plain = |line: Vec<Vec3>| line.into_iter().map(Vec3::to_array).collect();
    drawing::PlaneCut {
        name: moldloft_syntax::number::plain(value),
        axis,
        value,
        polylines: lines.into_iter().map(plain).collect(),
        width_mm: None,
    }
}

/// The points of a line, the first again at the end of a closed one.
pub(crate) fn points(line: &Contour) -> Vec<Vec3> {
    let again = line.points.first().filter(|_| line.closed);
    line.points.iter().chain(again).copied().collect()
}

/// Cuts of all shown surfaces with planes that the model does not name.
fn cuts(document: &Document, axis: usize, values: &[f64]) -> Vec<drawing::PlaneCut> {
    let mut lines = vec![Vec::new(); values.len()];
    for object in document.graph().objects().filter(|o| o.head.shown()) {
        let Some(Value::Surface(surface)) = object.value() else { continue };
        let sectioned = ContourCutter::new(surface, &object.head);
        for (lines, &value) in lines.iter_mut().zip(values) {
            lines.extend(sectioned.section(&Family::coordinate(axis), value).iter().map(points));
        }
    }
    let cut = values.iter().zip(lines).filter(|(_, lines)| !lines.is_empty());
    cut.map(|(&value, lines)| contour_of(axis, value, lines)).collect()
}

/// About ten multiples of a round step strictly between two numbers.
fn round_values(low: f64, high: f64) -> Vec<f64> {
    let rough = (high - low) / 10.0;
    if !(rough.is_finite() && rough > 0.0) {
        return Vec::new();
    }
    let ten = libm::pow(10.0, libm::log10(rough).floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|k| k * ten).into_iter().find(|&s| s >= rough);
    let step = step.unwrap_or(10.0 * ten);
    let first = (low / step).floor() as i64 + 1;
    (first..).map(|k| k as f64 * step).take_while(|&x| x < high).collect()
}
