//! `plot`: curves, surfaces and blocks of a program as a picture, PNG or SVG by the ending of the file's name.

use crate::functions::grid_values::grid_of;
use crate::run::usage::spent;
use moldloft_budget::Budget;
use moldloft_diag::Diagnostic;
use moldloft_io::{NamedGrid, StructuredGrid};
use moldloft_mesh::{Mesh, PatchInfo, TopologyBuilder};
use moldloft_num::{Box3, Vec3};
use moldloft_picture::{Camera, Options, PALETTE, PictureError, StyledPolyline, render_while};
use moldloft_registry::Value;
use std::fmt::Write as _;

/// Picture points across and down.
const WIDTH: usize = 1200;
const HEIGHT: usize = 800;
/// Curves on pictures: dark and broad enough to be seen against panels and nothing.
const CURVE_COLOUR: [u8; 3] = [0x1b, 0x25, 0x33];
const CURVE_WIDTH: f32 = 2.0;
/// Extent, relative to the largest, below which it is zero.
const FLAT: f64 = 1e-9;
/// Colours of the palette that show as thin lines on white.
const LINE_COLOURS: [usize; 7] = [1, 4, 2, 5, 3, 6, 0];
/// The words that choose a view.
const VIEWS: &str = "x, y, z, -x, -y, -z or iso";

/// Direction of the view: degrees about z and above the horizon.
fn view(word: &str) -> Option<[f64; 2]> {
    Some(match word {
        "x" => [0.0, 0.0],
        "-x" => [180.0, 0.0],
        "y" => [90.0, 0.0],
        "-y" => [-90.0, 0.0],
        "z" => [-90.0, 90.0],
        "-z" => [-90.0, -90.0],
        "iso" => [-130.0, 25.0],
        _ => return None,
    })
}

/// Default view: flat arrays along their normal axis, others obliquely.
fn usual(low: Vec3, high: Vec3) -> &'static str {
    let size = [high.x - low.x, high.y - low.y, high.z - low.z];
    let most = size.into_iter().fold(0.0, f64::max);
    let flat = |k: usize| size[k] <= FLAT * most;
    match (flat(0), flat(1), flat(2)) {
        (_, _, true) => "z",
        (_, true, _) => "-y",
        (true, _, _) => "x",
        _ => "iso",
    }
}

/// The faces of a grid: of a surface itself, of a block the six around it, as corners by number.
fn faces(grid: &StructuredGrid) -> Vec<[u32; 4]> {
    let [ni, nj, nk] = grid.size;
    let at = |i: usize, j: usize, k: usize| (i + ni * (j + nj * k)) as u32;
    let mut found = Vec::new();
    if nk == 1 {
        for j in 1..nj {
            for i in 1..ni {
                found.push([at(i - 1, j - 1, 0), at(i, j - 1, 0), at(i, j, 0), at(i - 1, j, 0)]);
            }
        }
        return found;
    }
    for (k, turned) in [(0, true), (nk - 1, false)] {
        for j in 1..nj {
            for i in 1..ni {
                let face = [at(i - 1, j - 1, k), at(i, j - 1, k), at(i, j, k), at(i - 1, j, k)];
                found.push(if turned { [face[3], face[2], face[1], face[0]] } else { face });
            }
        }
    }
    for j in [0, nj - 1] {
        for k in 1..nk {
            for i in 1..ni {
                found.push([at(i - 1, j, k - 1), at(i, j, k - 1), at(i, j, k), at(i - 1, j, k)]);
            }
        }
    }
    for i in [0, ni - 1] {
        for k in 1..nk {
            for j in 1..nj {
                found.push([at(i, j - 1, k - 1), at(i, j, k - 1), at(i, j, k), at(i, j - 1, k)]);
            }
        }
    }
    found
}

/// The picture of grids under the names that are written; `words` choose the view.
///
/// # Errors
/// Unknown words or extensions, and content without extent.
pub(crate) fn plot(
    path: &str,
    words: &str,
    grids: &[StructuredGrid],
    names: &[String],
    budget: &Budget,
) -> Result<Vec<u8>, Diagnostic> {
    let points = || {
        let planes = grids.iter().map(|g| &g.planes);
        planes.flat_map(|[x, y, z]| x.iter().zip(y).zip(z)).map(|((x, y), z)| Vec3::of(*x, *y, *z))
    };
    let bounds = Box3::around(points());
    let (low, high) = (bounds.low, bounds.high);
    let nothing = || {
        Diagnostic::error("no-picture", "there is nothing to see")
            .expected("curves, surfaces or blocks with an extent")
            .help("points that were never set are all at {0, 0, 0}")
    };
    // Comparisons that NaN fails.
    if !(high - low).norm().is_normal() || grids.iter().all(|g| g.size.iter().all(|n| *n < 2)) {
        return Err(nothing());
    }
    let word = match words.trim() {
        "" => usual(low, high),
        word => word,
    };
    let Some([azimuth, elevation]) = view(word) else {
        return Err(Diagnostic::error("unknown-word", format!("plot has no view \"{word}\""))
            .expected(VIEWS));
    };
    match path.rsplit('.').next().unwrap_or("").to_ascii_lowercase().as_str() {
        "png" => png(grids, names, [azimuth, elevation], budget),
        "svg" => {
            let text = svg(grids, names, [azimuth, elevation], word, budget)?;
            Ok(text.ok_or_else(nothing)?.into_bytes())
        }
        _ => Err(Diagnostic::error("unknown-format", format!("plot cannot write `{path}`"))
            .expected("a name that ends in .png or .svg")),
    }
}

/// Arrays of points for a picture.
pub struct DrawnArrays {
    /// Surfaces, and the faces of blocks.
    pub mesh: Mesh,
    /// Curves.
    pub curves: Vec<StyledPolyline>,
    /// Direction of the view: degrees about z and above the horizon.
    pub view: [f64; 2],
}

/// The curves, surfaces and blocks of points among the variables of a program, with those in records
/// and lists (`name.member`, `name[number]`), that have an extent.
pub fn grids_of<'a>(
    variables: impl IntoIterator<Item = (&'a str, &'a Value<f64>)>,
) -> Vec<NamedGrid> {
    let mut found = Vec::new();
    for (name, value) in variables {
        gather(name, value, &mut found);
    }
    found
}

/// The picture of grids; `None` if there are none.
///
/// # Errors
/// A budget that is spent.
pub fn picture_of(
    grids: Vec<NamedGrid>,
    budget: &Budget,
) -> Result<Option<DrawnArrays>, Diagnostic> {
    let (names, grids): (Vec<_>, Vec<_>) = grids.into_iter().map(|g| (g.name, g.grid)).unzip();
    if grids.is_empty() {
        return Ok(None);
    }
    let points = grids.iter().flat_map(StructuredGrid::points);
    let bounds = Box3::around(points);
    let [azimuth, elevation] = view(usual(bounds.low, bounds.high)).unwrap_or([-130.0, 25.0]);
    let (mesh, curves) = drawn(&grids, &names, budget)?;
    Ok(Some(DrawnArrays { mesh, curves, view: [azimuth, elevation] }))
}

/// Adds the grids that a value holds and that have an extent.
fn gather(name: &str, value: &Value<f64>, found: &mut Vec<NamedGrid>) {
    match value {
        Value::List(items) => {
            for (k, item) in items.iter().enumerate() {
                gather(&format!("{name}[{}]", k + 1), item, found);
            }
        }
        Value::Record(record) => {
            for (member, value) in record.names.iter().zip(&record.values) {
                gather(&format!("{name}.{member}"), value, found);
            }
        }
        value => {
            let Ok(grid) = grid_of(value, name) else { return };
            let bounds = Box3::around(grid.points());
            if (bounds.high - bounds.low).norm().is_normal() {
                found.push(NamedGrid { name: name.to_string(), grid });
            }
        }
    }
}

fn png(
    grids: &[StructuredGrid],
    names: &[String],
    [azimuth_deg, elevation_deg]: [f64; 2],
    budget: &Budget,
) -> Result<Vec<u8>, Diagnostic> {
    let (mesh, curves) = drawn(grids, names, budget)?;
    let camera = Camera { azimuth_deg, elevation_deg, view_angle_deg: None };
    let options = Options { width: WIDTH, height: HEIGHT, camera, ..Options::default() };
    render_while(&mesh, &curves, &options, &|| !budget.is_spent()).map_err(|e| {
        match budget.poll() {
            Err(reason) if e == PictureError::Ended => spent(reason),
            _ => Diagnostic::error("no-picture", e.to_string()),
        }
    })
}

/// Surfaces and blocks as one mesh, curves as lines.
fn drawn(
    grids: &[StructuredGrid],
    names: &[String],
    budget: &Budget,
) -> Result<(Mesh, Vec<StyledPolyline>), Diagnostic> {
    let failed = |why: String| Diagnostic::error("no-picture", why);
    let mut builder = TopologyBuilder::new();
    let mut positions = Vec::new();
    let mut curves = Vec::new();
    for (grid, name) in grids.iter().zip(names) {
        budget.poll().map_err(spent)?;
        if grid.size.iter().filter(|n| **n > 1).count() < 2 {
            curves.extend(grid.lines().into_iter().map(|points| StyledPolyline {
                points,
                colour: CURVE_COLOUR,
                width: CURVE_WIDTH,
                on_surface: false,
            }));
            continue;
        }
        let first = positions.len() as u32;
        positions.extend(grid.points());
        builder.add_vertices(grid.planes[0].len()).map_err(|e| failed(e.to_string()))?;
        let faces = faces(grid).into_iter().map(|face| face.map(|v| v + first));
        let patch = PatchInfo::new(name.as_str());
        builder.add_faces(patch, faces).map_err(|e| failed(e.to_string()))?;
    }
    let mesh = Mesh::new(builder.build().into(), positions).map_err(|e| failed(e.to_string()))?;
    Ok((mesh, curves))
}

/// Lines at true proportions, names below, extents beside the axes; `None` if the view shows a
/// point.
fn svg(
    grids: &[StructuredGrid],
    names: &[String],
    [azimuth, elevation]: [f64; 2],
    word: &str,
    budget: &Budget,
) -> Result<Option<String>, Diagnostic> {
    const MARGIN: f64 = 60.0;
    let (sa, ca) = sin_cos(azimuth);
    let (se, ce) = sin_cos(elevation);
    let across = Vec3::of(-sa, ca, 0.0);
    let up = Vec3::of(-se * ca, -se * sa, ce);
    let drawn: Vec<Vec<Vec<[f64; 2]>>> = grids
        .iter()
        .map(|grid| {
            let seen = |line: Vec<Vec3>| line.iter().map(|p| [p.dot(across), p.dot(up)]).collect();
            grid.lines().into_iter().map(seen).collect()
        })
        .collect();
    let all = || drawn.iter().flatten().flatten();
    let bounds = |c: usize| {
        let least = all().map(|p| p[c]).fold(f64::INFINITY, f64::min);
        let most = all().map(|p| p[c]).fold(f64::NEG_INFINITY, f64::max);
        [least, most]
    };
    let ([x0, x1], [y0, y1]) = (bounds(0), bounds(1));
    let (width, height) = (WIDTH as f64, HEIGHT as f64);
    let scale = ((width - 2.0 * MARGIN) / (x1 - x0)).min((height - 2.0 * MARGIN) / (y1 - y0));
    if !scale.is_finite() {
        return Ok(None);
    }
    let tall = ((y1 - y0) * scale + 2.0 * MARGIN).max(2.0 * MARGIN + 20.0 * names.len() as f64);
    let middle = [0.5 * width - 0.5 * scale * (x0 + x1), 0.5 * tall + 0.5 * scale * (y0 + y1)];
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{tall:.0}\" \
         viewBox=\"0 0 {WIDTH} {tall:.0}\">\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n"
    );
    for (k, (lines, name)) in drawn.iter().zip(names).enumerate() {
        let [r, g, b] = PALETTE[LINE_COLOURS[k % LINE_COLOURS.len()]];
        let broad = if grids[k].size.iter().filter(|n| **n > 1).count() < 2 { 1.5 } else { 0.6 };
        let _ = writeln!(
            text,
            "<g fill=\"none\" stroke=\"#{r:02x}{g:02x}{b:02x}\" stroke-width=\"{broad}\">\n<title>{}</title>",
            escaped(name)
        );
        for line in lines {
            budget.poll().map_err(spent)?;
            text.push_str("<polyline points=\"");
            for [x, y] in line {
                let _ = write!(text, "{:.2},{:.2} ", middle[0] + scale * x, middle[1] - scale * y);
            }
            text.truncate(text.trim_end().len());
            text.push_str("\"/>\n");
        }
        text.push_str("</g>\n");
        let _ = writeln!(
            text,
            "<text x=\"12\" y=\"{}\" font-family=\"sans-serif\" font-size=\"14\" fill=\"#{r:02x}{g:02x}{b:02x}\">{}</text>",
            22 + 18 * k,
            escaped(name)
        );
    }
    // Labels of the sides of the picture, if these are axes of the model.
    let names = match word {
        "x" => Some(["y", "z"]),
        "-y" => Some(["x", "z"]),
        "z" => Some(["x", "y"]),
        _ => None,
    };
    if let Some([a, b]) = names {
        let _ = writeln!(
            text,
            "<text x=\"{}\" y=\"{}\" text-anchor=\"end\" font-family=\"sans-serif\" font-size=\"13\" \
             fill=\"#444\">{a} {x0:.6} to {x1:.6}, {b} {y0:.6} to {y1:.6}</text>",
            WIDTH - 12,
            tall - 12.0
        );
    }
    text.push_str("</svg>\n");
    Ok(Some(text))
}

/// Sine and cosine in degrees, exact along the axes.
fn sin_cos(degrees: f64) -> (f64, f64) {
    match degrees.rem_euclid(360.0) {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        180.0 => (0.0, -1.0),
        270.0 => (-1.0, 0.0),
        _ => (libm::sin(degrees.to_radians()), libm::cos(degrees.to_radians())),
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
