//! Formats by name: from a document to the writers.

use moldloft_diag::Diagnostic;
use moldloft_io::drawing::{self, View};
use moldloft_io::vtk::NamedFile;
use moldloft_io::{gdf, obj, plot3d, stl, vtk};
use moldloft_lang::{Document, Section};
use moldloft_model::{Polyline, Sectioned};
use moldloft_num::Vec3;
use moldloft_picture::{Line, Options, render};
use moldloft_registry::Value;

/// Contours on pictures: dark grey, so that they show on every patch.
const CONTOUR_COLOUR: [u8; 3] = [0x30, 0x36, 0x40];

/// In picture points.
const CONTOUR_WIDTH: f32 = 1.5;

type Outcome<R> = Result<R, Vec<Diagnostic>>;

/// The files of the model's panels in one format.
///
/// # Errors
/// What the format cannot hold.
pub fn files(document: &mut Document, format: &str, stem: &str) -> Outcome<Vec<NamedFile>> {
    if format == "svg" {
        return lines(document, stem);
    }
    if format == "png" {
        let Options { width, height, .. } = Options::default();
        let bytes = picture(document, width, height)?;
        return Ok(vec![NamedFile { name: format!("{stem}.png"), bytes }]);
    }
    let symmetry = document.symmetry();
    let panelled = document.panelled().map_err(|d| vec![d])?;
    let mesh = &panelled.mesh;
    let one = |bytes: Vec<u8>| vec![NamedFile { name: format!("{stem}.{format}"), bytes }];
    let files = match format {
        "gdf" => {
            let header = gdf::Header {
                title: stem.into(),
                mirror_x: symmetry.contains('x'),
                mirror_y: symmetry.contains('y'),
                ..gdf::Header::default()
            };
            gdf::write(mesh, &header, false).map(one)
        }
        "stl" => stl::write(mesh, stem).map(one),
        "obj" => obj::write(mesh).map(one),
        "vtp" => vtk::polydata(mesh).map(one),
        "vts" => vtk::structured_files(mesh, stem),
        "p3d" => plot3d::write(mesh, plot3d::Layout::Stream).map(one),
        _ => {
            let message = format!("there is no format `{format}`");
            return Err(vec![Diagnostic::error("unknown-format", message)]);
        }
    };
    files.map_err(|error| {
        let message = format!("cannot write {format}: {error}");
        vec![Diagnostic::error("cannot-write", message)]
    })
}

/// The lines drawing: body plan, waterlines and buttocks, a sheet each.
fn lines(document: &mut Document, stem: &str) -> Outcome<Vec<NamedFile>> {
    let mut contours: Vec<drawing::Contour> =
        document.sections().into_iter().map(contour).collect();
    let panelled = document.panelled().map_err(|d| vec![d])?;
    let bounds = panelled.mesh.bounds();
    for axis in 0..3 {
        // What the model does not ask for is cut at round coordinates.
        if contours.iter().all(|c| c.axis != axis) {
            let values = round_values(bounds.low[axis], bounds.high[axis]);
            contours.extend(cuts(document, axis, &values));
        }
    }
    let views = [
        (View::BodyPlan, "body-plan"),
        (View::Waterlines, "waterlines"),
        (View::Buttocks, "buttocks"),
    ];
    let sheet = |(view, word): (View, &str)| {
        let (unit, unit_mm) = length_unit(document);
        let title = stem.into();
        let options = drawing::Options { title, unit, unit_mm, ..drawing::Options::default() };
        let bytes = drawing::draw(view, &contours, &options);
        NamedFile { name: format!("{stem}.{word}.svg"), bytes }
    };
    Ok(views.into_iter().map(sheet).collect())
}

/// The model's unit of length and its size in millimetres; metres when it names none that is known.
fn length_unit(document: &Document) -> (String, f64) {
    const KNOWN: [(&str, f64); 5] =
        [("m", 1000.0), ("cm", 10.0), ("mm", 1.0), ("ft", 304.8), ("in", 25.4)];
    let header = document.graph().objects().find(|o| o.row.name == "Model");
    let units = header.and_then(|o| match o.args.get(o.row.field("units")?) {
        Some(Value::Text(units)) => Some(units.to_lowercase()),
        _ => None,
    });
    let length = units.as_deref().and_then(|units| units.split_whitespace().next());
    let known = KNOWN.into_iter().find(|(name, _)| Some(*name) == length);
    let (name, size) = known.unwrap_or(KNOWN[0]);
    (name.into(), size)
}

fn contour(section: Section) -> drawing::Contour {
    let lines = section.lines.iter().flat_map(|(_, lines)| lines);
    contour_of(section.axis, section.value, lines.map(points).collect())
}

fn contour_of(axis: usize, value: f64, lines: Vec<Vec<Vec3>>) -> drawing::Contour {
    let plain = |line: Vec<Vec3>| line.into_iter().map(Vec3::to_array).collect();
    drawing::Contour {
        name: moldloft_syntax::number::plain(value),
        axis,
        value,
        polylines: lines.into_iter().map(plain).collect(),
        width_mm: None,
    }
}

/// The points of a line, the first again at the end of a closed one.
fn points(line: &Polyline) -> Vec<Vec3> {
    let again = line.points.first().filter(|_| line.closed);
    line.points.iter().chain(again).copied().collect()
}

/// Cuts of all shown surfaces with planes that the model does not name.
fn cuts(document: &Document, axis: usize, values: &[f64]) -> Vec<drawing::Contour> {
    let mut lines = vec![Vec::new(); values.len()];
    for object in document.graph().objects().filter(|o| o.head.shown()) {
        let Some(Value::Surface(surface)) = object.value() else { continue };
        let sectioned = Sectioned::new(surface, &object.head);
        for (lines, &value) in lines.iter_mut().zip(values) {
            lines.extend(sectioned.section(axis, value).iter().map(points));
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
    let ten = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|k| k * ten).into_iter().find(|&s| s >= rough);
    let step = step.unwrap_or(10.0 * ten);
    let first = (low / step).floor() as i64 + 1;
    (first..).map(|k| k as f64 * step).take_while(|&x| x < high).collect()
}

/// A picture of the model's panels, its contours as lines, and its mirror image.
///
/// # Errors
/// An impossible size.
pub fn picture(document: &mut Document, width: usize, height: usize) -> Outcome<Vec<u8>> {
    let lines: Vec<Line> = document.sections().iter().flat_map(drawn).collect();
    let mirror = document.symmetry().contains('y');
    let panelled = document.panelled().map_err(|d| vec![d])?;
    let options = Options { width, height, mirror, ..Options::default() };
    render(&panelled.mesh, &lines, &options)
        .map_err(|error| vec![Diagnostic::error("no-picture", error.to_string())])
}

fn drawn(section: &Section) -> Vec<Line> {
    let lines = section.lines.iter().flat_map(|(_, lines)| lines);
    lines
        .map(|line| Line { points: points(line), colour: CONTOUR_COLOUR, width: CONTOUR_WIDTH })
        .collect()
}
