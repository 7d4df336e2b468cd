//! Formats by name: from a document to the writers.

use moldloft_diag::Diagnostic;
use moldloft_document::{Document, Section};
use moldloft_io::drawing::{self, View};
use moldloft_io::vtk::NamedFile;
use moldloft_io::{
    Skin, Strands, WriteError, aqwa, gdf, gltf, hams, hydrostar, nemoh, obj, plot3d, ply, stl,
    threemf, vtk,
};
use moldloft_mesh::Mesh;
use moldloft_num::Vec3;
use moldloft_panel::{Polyline, Sectioned};
use moldloft_picture::{Line, Options, patch_colour, render};
use moldloft_registry::{Family, Value};

/// Contours on pictures: dark grey, so that they show on every patch.
const CONTOUR_COLOUR: [u8; 3] = [0x30, 0x36, 0x40];

/// In picture points.
const CONTOUR_WIDTH: f32 = 1.5;

/// Wires of bodies: dark and broad, so that they are seen against nothing.
const WIRE_COLOUR: [u8; 3] = [0x1b, 0x25, 0x33];
const WIRE_WIDTH: f32 = 3.0;

type Outcome<R> = Result<R, Vec<Diagnostic>>;

/// Standard gravity in metres per second squared (ISO 80000-3).
pub const GRAVITY: f64 = 9.80665;

/// What a user may ask of the files of panel codes.
#[derive(Clone, Debug, Default)]
pub struct Wishes {
    /// Lids among the panels, or in a file of their own where the code wants that.
    pub lids: bool,
    /// Only what is below z = 0, cut there.
    pub immersed: bool,
    /// Only patches with one of these tags; all when there are none.
    pub tags: Vec<String>,
}

/// The patches with one of the tags; `None` for the whole mesh when no tags are given.
///
/// # Errors
/// When no patch has any of them.
pub fn tagged(mesh: &Mesh, tags: &[String]) -> Outcome<Option<Mesh>> {
    if tags.is_empty() {
        return Ok(None);
    }
    if let Some(tag) = tags.iter().find(|tag| !mesh.patches().iter().any(|p| p.info.is(tag))) {
        let infos = mesh.patches().iter().map(|p| &p.info);
        let mut known: Vec<&str> =
            infos.flat_map(|i| i.tags.iter().map(String::as_str).chain([i.tag.word()])).collect();
        known.sort_unstable();
        known.dedup();
        return Err(vec![
            Diagnostic::error("unknown-tag", format!("no patch has the tag `{tag}`"))
                .expected(known.join(", "))
                .suggest(tag, known.iter().copied()),
        ]);
    }
    let part = mesh.selected(|info| tags.iter().any(|tag| info.is(tag)));
    part.map(Some).map_err(|e| vec![Diagnostic::error("too-large", e.to_string())])
}

/// The files of the model's panels in one format.
///
/// # Errors
/// What the format cannot hold.
pub fn files(
    document: &mut Document,
    format: &str,
    stem: &str,
    wishes: Wishes,
) -> Outcome<Vec<NamedFile>> {
    if format == "svg" {
        return lines(document, stem);
    }
    if format == "png" {
        let Options { width, height, .. } = Options::default();
        let bytes = picture(document, width, height)?;
        return Ok(vec![NamedFile { name: format!("{stem}.png"), bytes }]);
    }
    let symmetry = document.symmetry();
    let metres = length_unit(document).1 / 1000.0;
    let panelled = document.panelled().map_err(|d| vec![d])?;
    let part = tagged(&panelled.mesh, &wishes.tags)?;
    let mesh = part.as_ref().unwrap_or(&panelled.mesh);
    let one = |bytes: Vec<u8>| vec![NamedFile { name: format!("{stem}.{format}"), bytes }];
    let strands = strands(document);
    if !strands.is_empty() && !matches!(format, "obj" | "vtp") {
        let name = format_name(format);
        strands.refused(name).map_err(|error| cannot_write(format, &error))?;
    }
    let files = match format {
        "gdf" | "nemoh" | "hydrostar" | "hams" | "aqwa" => {
            solver_files(mesh, format, stem, &symmetry, GRAVITY / metres, &wishes)
        }
        "stl" => stl::write(mesh, stem).map(one),
        "obj" => obj::write_with(mesh, &strands).map(one),
        "3mf" => threemf::write(mesh, stem, threemf_unit(metres), patch_colour).map(one),
        "ply" => ply::write(mesh).map(one),
        "glb" => gltf::write(mesh, stem, metres, patch_colour).map(one),
        "vtp" => vtk::polydata_with(mesh, &strands, &looks(document)?).map(one),
        "vts" => vtk::structured_files(mesh, stem, &looks(document)?),
        "p3d" => plot3d::write(mesh, plot3d::Layout::Stream).map(one),
        _ => {
            let message = format!("there is no format `{format}`");
            return Err(vec![Diagnostic::error("unknown-format", message)]);
        }
    };
    files.map_err(|error| cannot_write(format, &error))
}

/// The polylines and points of the shown bodies.
fn strands(document: &Document) -> Strands {
    let mut strands = Strands::default();
    for object in document.graph().objects().filter(|o| o.head.shown()) {
        if let Some(Value::Mesh(body)) = object.value() {
            let name = object.name.to_string();
            strands.wires.extend(body.wires.iter().map(|w| (name.clone(), w.clone())));
            strands.dots.extend(body.dots.iter().map(|p| (name.clone(), *p)));
        }
    }
    strands
}

/// The name of a format for messages.
fn format_name(format: &str) -> &'static str {
    const NAMES: [&str; 11] =
        ["gdf", "nemoh", "hydrostar", "hams", "aqwa", "stl", "ply", "glb", "vts", "p3d", "3mf"];
    NAMES.into_iter().find(|name| *name == format).unwrap_or("this format")
}

/// The unit of a 3MF file that is so many metres long; metres where it has none.
fn threemf_unit(metres: f64) -> &'static str {
    const UNITS: [(f64, &str); 5] = [
        (1e-3, "millimeter"),
        (1e-2, "centimeter"),
        (0.0254, "inch"),
        (0.3048, "foot"),
        (1.0, "meter"),
    ];
    let found = UNITS.into_iter().find(|(size, _)| (size - metres).abs() < 1e-9 * metres);
    found.map_or("meter", |(_, name)| name)
}

/// What viewers show of the surfaces, for VTK's files.
fn looks(document: &mut Document) -> Outcome<Vec<vtk::PatchFields>> {
    let told = document.patch_fields().map_err(|d| vec![d])?;
    let field = |f: moldloft_fair::surface::Field| vtk::Field {
        name: f.name.into(),
        components: f.components,
        values: f.values,
    };
    let patch = |p: moldloft_document::PatchFields| vtk::PatchFields {
        patch: p.patch,
        fields: p.fields.into_iter().map(field).collect(),
    };
    Ok(told.into_iter().map(patch).collect())
}

fn cannot_write(format: &str, error: &WriteError) -> Vec<Diagnostic> {
    vec![Diagnostic::error("cannot-write", format!("cannot write {format}: {error}"))]
}

/// The files of a panel code. A symmetry that the code has no flag for is written out, the image
/// with its original.
fn solver_files(
    mesh: &Mesh,
    format: &str,
    stem: &str,
    symmetry: &str,
    gravity: f64,
    wishes: &Wishes,
) -> Result<Vec<NamedFile>, WriteError> {
    let large = |_| WriteError::TooLarge { what: "vertices", count: mesh.positions().len() };
    let (mirror_x, mirror_y) = (symmetry.contains('x'), symmetry.contains('y'));
    let flag_x = match format {
        "nemoh" => false,
        "hydrostar" => mirror_y,
        _ => true,
    };
    let wet = (wishes.immersed || format == "aqwa").then(|| mesh.immersed(0.0)).transpose();
    let wet = wet.map_err(large)?;
    let mesh = wet.as_ref().unwrap_or(mesh);
    let whole = (mirror_x && !flag_x).then(|| mesh.with_mirror_image(0, ".mirror")).transpose();
    let whole = whole.map_err(large)?;
    let mesh = whole.as_ref().unwrap_or(mesh);
    let skin = Skin { mirror_x: mirror_x && flag_x, mirror_y, lids: wishes.lids };
    let file = |name: String, bytes| NamedFile { name, bytes };
    Ok(match format {
        "nemoh" => vec![file(format!("{stem}.mar"), nemoh::write(mesh, skin)?)],
        "hydrostar" => vec![file(format!("{stem}.hst"), hydrostar::write(mesh, stem, skin)?)],
        "aqwa" => vec![file(format!("{stem}.dat"), aqwa::write(mesh, stem, skin)?)],
        "hams" => {
            // HAMS reads lids from a file of their own.
            let hull = Skin { lids: false, ..skin };
            let mut files = vec![file(format!("{stem}.pnl"), hams::write(mesh, hull)?)];
            if let Some(lids) = hams::write_lids(mesh, hull)?.filter(|_| wishes.lids) {
                files.push(file(format!("{stem}.waterplane.pnl"), lids));
            }
            files
        }
        _ => {
            let (mirror_x, title) = (skin.mirror_x, stem.into());
            let header = gdf::Header { title, gravity, mirror_x, mirror_y, length: 1.0 };
            vec![file(format!("{stem}.gdf"), gdf::write(mesh, &header, wishes.lids)?)]
        }
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
pub fn length_unit(document: &Document) -> (String, f64) {
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
    let mut lines: Vec<Line> = document.sections().iter().flat_map(drawn).collect();
    let wires = strands(document).wires.into_iter();
    lines.extend(wires.map(|(_, points)| Line { points, colour: WIRE_COLOUR, width: WIRE_WIDTH }));
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
