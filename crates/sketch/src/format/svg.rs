//! The picture that EXPORT SVG writes: sketches as drawn with their planes and dimensions, or bodies
//! from a side.

use crate::command::Picture;
use crate::format::dimension_marks::{DimensionMark, Page, dimension_marks};
use crate::format::hidden_lines::{self, SeenStroke, seen_strokes};
use crate::format::json_format::ObjectData;
use crate::format::painted_faces::painted_faces;
use crate::{CoordinateAxis, Projection, SketchObject, SketchSolid};
use moldloft_num::Vec3;
use moldloft_syntax::number::plain;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Points along a curve.
const CHORDS: usize = 24;

/// Red, green and blue are the axes, two-coloured planes are orange, oblique is grey.
fn colour(free: Option<crate::Free>) -> &'static str {
    match free.map(crate::Free::spelling) {
        Some("X") => "#c22",
        Some("Y") => "#292",
        Some("Z") => "#22c",
        Some("O") => "#777",
        Some(_) => "#a60",
        None => "#c0c",
    }
}

fn axis_colour(axis: CoordinateAxis) -> &'static str {
    colour(Some(crate::Free::along(axis)))
}

/// Elements on the page, v up, before they are put on paper.
enum SvgElement {
    Stroke {
        from: [f64; 2],
        to: [f64; 2],
        colour: &'static str,
        width: f64,
        dashed: bool,
    },
    Area {
        loops: Vec<Vec<[f64; 2]>>,
        fill: String,
    },
    Text {
        at: [f64; 2],
        shift: [f64; 2],
        text: String,
        colour: &'static str,
    },
    /// A dimension line with its arrows.
    Span {
        from: [f64; 2],
        to: [f64; 2],
        colour: &'static str,
    },
    Centred {
        at: [f64; 2],
        text: String,
        colour: &'static str,
    },
}

/// The projection of a view of the body; `None` for the sketch as drawn.
pub(crate) fn projection(view: &str) -> Option<Projection> {
    match view {
        "TOP" => Some(Projection { angle_deg: [0.0, 90.0, 0.0], scale: [1.0, 1.0, 0.0] }),
        "FRONT" => Some(Projection { angle_deg: [0.0, 0.0, 90.0], scale: [1.0, 0.0, 1.0] }),
        "SIDE" => Some(Projection { angle_deg: [0.0, 0.0, 90.0], scale: [0.0, 1.0, 1.0] }),
        name => Projection::preset(name),
    }
}

/// The picture of objects; `page` is the part of the page that is drawn on.
pub(crate) fn svg(
    objects: &[(&SketchObject, &ObjectData)],
    picture: &Picture,
    page: [f64; 4],
) -> String {
    let view = projection(&picture.view);
    let mut items = Vec::new();
    for (object, data) in objects {
        match (&view, &data.solid) {
            (Some(view), Some(solid)) => {
                body(solid, view, object, picture, &mut items);
                if picture.planes || picture.dimensions {
                    dimensions(object, data, Some(view), &mut items);
                }
            }
            _ => sketch(object, data, picture, page, &mut items),
        }
    }
    // The page with the witness lines that leave it; for a view the visible part.
    let bounds = match (&view, around(&items)) {
        (Some(_), seen) => seen.unwrap_or(page),
        (None, Some(s)) => {
            [page[0].min(s[0]), page[1].min(s[1]), page[2].max(s[2]), page[3].max(s[3])]
        }
        (None, None) => page,
    };
    let window = match picture.window {
        // ZOOM speaks of the page; of a view it shows the same share.
        Some(w) if view.is_some() => {
            let share = |k: usize, x: f64| (x - page[k]) / (page[k + 2] - page[k]);
            let put = |k: usize, x: f64| bounds[k] + share(k, x) * (bounds[k + 2] - bounds[k]);
            [put(0, w[0]), put(1, w[1]), put(0, w[2]), put(1, w[3])]
        }
        Some(w) => w,
        None => bounds,
    };
    paper(&items, window)
}

fn around(items: &[SvgElement]) -> Option<[f64; 4]> {
    let mut b = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
    let mut take =
        |p: &[f64; 2]| b = [b[0].min(p[0]), b[1].min(p[1]), b[2].max(p[0]), b[3].max(p[1])];
    for item in items {
        match item {
            SvgElement::Stroke { from, to, .. } | SvgElement::Span { from, to, .. } => {
                [from, to].into_iter().for_each(&mut take);
            }
            SvgElement::Area { loops, .. } => loops.iter().flatten().for_each(&mut take),
            SvgElement::Text { .. } | SvgElement::Centred { .. } => {}
        }
    }
    (b[0] <= b[2] && b[1] <= b[3]).then(|| {
        let least = 1e-6 * (b[2] - b[0]).max(b[3] - b[1]).max(1e-300);
        [b[0] - least, b[1] - least, b[2] + least, b[3] + least]
    })
}

fn sketch(
    object: &SketchObject,
    data: &ObjectData,
    picture: &Picture,
    page: [f64; 4],
    items: &mut Vec<SvgElement>,
) {
    let d = &object.drawing;
    let size = (page[2] - page[0]).max(page[3] - page[1]);
    let at = |p: crate::PointId| d.points.get(&p).map_or([0.0; 2], |p| [p.u, p.v]);
    if let Some(face) = picture.face.and_then(|id| object.faces.get(&id)) {
        let loops = face.loops().map(|c| c.iter().map(|p| at(*p)).collect()).collect();
        items.push(SvgElement::Area { loops, fill: "#fd8".into() });
    }
    if picture.planes {
        planes(object, data, size, items);
    }
    if picture.planes || picture.dimensions {
        dimensions(object, data, None, items);
    }
    for line in d.lines.values() {
        let colour = if picture.types { colour(line.free) } else { "#333" };
        let (from, to) = (at(line.p), at(line.q));
        items.push(SvgElement::Stroke { from, to, colour, width: 1.8, dashed: false });
    }
    if picture.labels {
        for (id, p) in &d.points {
            let text = id.to_string();
            items.push(SvgElement::Text {
                at: [p.u, p.v],
                shift: [4.0, -4.0],
                text,
                colour: "#000",
            });
        }
    }
}

/// A witness line for each dimensioning plane, from its first point (X-, Y-, Z-planes along Z, X, Y, so
/// that each runs inside its plane).
fn planes(object: &SketchObject, data: &ObjectData, size: f64, items: &mut Vec<SvgElement>) {
    let d = &object.drawing;
    let derived = crate::Planes::of(d);
    let middle = {
        let n = d.points.len().max(1) as f64;
        let sum = d.points.values().fold([0.0; 2], |s, p| [s[0] + p.u, s[1] + p.v]);
        [sum[0] / n, sum[1] / n]
    };
    let known: BTreeMap<crate::PointId, [Option<f64>; 3]> = data.points.iter().copied().collect();
    for axis in CoordinateAxis::ALL.into_iter().filter(|a| d.section != Some(*a)) {
        let inside = match (axis, d.section) {
            (CoordinateAxis::X, Some(CoordinateAxis::Z)) => CoordinateAxis::Y,
            (CoordinateAxis::Y, Some(CoordinateAxis::X)) => CoordinateAxis::Z,
            (CoordinateAxis::Z, Some(CoordinateAxis::Y)) | (CoordinateAxis::Y, None | Some(_)) => {
                CoordinateAxis::X
            }
            (CoordinateAxis::X, _) => CoordinateAxis::Z,
            (CoordinateAxis::Z, _) => CoordinateAxis::Y,
        };
        let [du, dv] = d.projection.unit(inside);
        for plane in 0..derived.counts()[axis.index()] {
            let Some(&first) = derived.members(axis, plane).first() else { continue };
            let Some(p) = d.points.get(&first) else { continue };
            let outwards = (p.u - middle[0]) * du + (p.v - middle[1]) * dv;
            let reach = 0.09 * size * if outwards < 0.0 { -1.0 } else { 1.0 };
            let to = [p.u + reach * du, p.v + reach * dv];
            let colour = axis_colour(axis);
            items.push(SvgElement::Stroke {
                from: [p.u, p.v],
                to,
                colour,
                width: 0.7,
                dashed: false,
            });
            let place = known.get(&first).and_then(|x| x[axis.index()]);
            let text =
                place.map_or_else(|| format!("{axis} free"), |x| format!("{axis} {}", plain(x)));
            items.push(SvgElement::Text { at: to, shift: [2.0, 4.0], text, colour });
        }
    }
}

/// The dimensions of an object with their lines, on the page or in a view.
fn dimensions(
    object: &SketchObject,
    data: &ObjectData,
    view: Option<&Projection>,
    items: &mut Vec<SvgElement>,
) {
    for mark in marks(object, &crate::Planes::of(&object.drawing), data, view) {
        let colour = mark.axis.map_or("#555", axis_colour);
        for [from, to] in mark.witnesses {
            items.push(SvgElement::Stroke { from, to, colour, width: 0.5, dashed: false });
        }
        if let Some([from, to]) = mark.line {
            items.push(SvgElement::Span { from, to, colour });
        }
        items.push(SvgElement::Centred { at: mark.at, text: mark.text, colour });
    }
}

/// Positions of an object's dimensions, on the page as drawn or in a view of the body.
pub(crate) fn marks(
    object: &SketchObject,
    planes: &crate::Planes,
    data: &ObjectData,
    view: Option<&Projection>,
) -> Vec<DimensionMark> {
    let known: BTreeMap<crate::PointId, [Option<f64>; 3]> = data.points.iter().copied().collect();
    let values: BTreeMap<String, f64> =
        (data.dimensions.iter()).filter_map(|d| Some((d.0.to_lowercase(), d.2?))).collect();
    let value = |key: &str| values.get(key).copied();
    match view {
        Some(view) => {
            let place = |p: crate::PointId| {
                let [x, y, z] = *known.get(&p)?;
                Some(view.project(Vec3::new(x?, y?, z?)))
            };
            let page = Page { place: &place, unit: &|axis| view.unit(axis) };
            dimension_marks(object, planes, &page, &value)
        }
        None => {
            let drawing = &object.drawing;
            let place = |p: crate::PointId| drawing.points.get(&p).map(|p| [p.u, p.v]);
            let page = Page { place: &place, unit: &|axis| drawing.projection.unit(axis) };
            dimension_marks(object, planes, &page, &value)
        }
    }
}

/// A body from a side: faces that look at the viewer from far to near, then its edges and outlines, hidden parts dashed.
fn body(
    solid: &SketchSolid<f64>,
    view: &Projection,
    object: &SketchObject,
    picture: &Picture,
    items: &mut Vec<SvgElement>,
) {
    let sight = view.sight(object.drawing.letters.up).normalized().unwrap_or_default();
    let loops = |f: usize| -> Vec<Vec<[f64; 2]>> {
        let flat = |p: &Vec3| view.project(*p);
        (solid.faces[f].loops.iter()).map(|c| walk(solid, c).iter().map(flat).collect()).collect()
    };
    let mesh = hidden_lines::mesh(solid);
    for painted in painted_faces(solid, &mesh, view, sight, &loops) {
        let id = solid.faces[painted.face].id;
        let chosen = id.is_some() && id == picture.face;
        for (loops, facing) in painted.areas {
            items.push(SvgElement::Area { loops, fill: shade(facing, chosen) });
        }
    }
    for SeenStroke { from, to, hidden } in seen_strokes(solid, &mesh, view, sight) {
        let (colour, width) = if hidden { ("#9ab", 0.9) } else { ("#222", 1.4) };
        items.push(SvgElement::Stroke { from, to, colour, width, dashed: hidden });
    }
    if picture.labels {
        for v in solid.vertices.iter().filter(|v| object.drawing.points.contains_key(&v.id)) {
            let (at, text) = (view.project(v.at), v.id.to_string());
            items.push(SvgElement::Text { at, shift: [4.0, -4.0], text, colour: "#000" });
        }
    }
}

/// Light for faces that look at the viewer, darker for slanting ones; a chosen face is yellow.
fn shade(facing: f64, chosen: bool) -> String {
    let light = 150.0 + 90.0 * facing.clamp(0.0, 1.0);
    let [r, g, b] = if chosen { [1.0, 0.88, 0.5] } else { [0.93, 0.96, 1.0] };
    let part = |x: f64| (x * light) as u8;
    format!("#{:02x}{:02x}{:02x}", part(r), part(g), part(b))
}

/// The points of a cycle of edges, the last of each left to the next.
fn walk(solid: &SketchSolid<f64>, cycle: &[(usize, bool)]) -> Vec<Vec3> {
    let mut way = Vec::new();
    for &(e, forward) in cycle {
        let mut own = solid.polyline(e, CHORDS);
        if !forward {
            own.reverse();
        }
        own.pop();
        way.extend(own);
    }
    way
}

/// The elements on paper of 800 units.
fn paper(items: &[SvgElement], [l, b, r, t]: [f64; 4]) -> String {
    const MARGIN: f64 = 60.0;
    let size = (r - l).max(t - b).max(f64::MIN_POSITIVE);
    let scale = 800.0 / size;
    let place = |p: [f64; 2]| [(p[0] - l) * scale + MARGIN, (t - p[1]) * scale + MARGIN];
    let (w, h) = ((r - l) * scale + 2.0 * MARGIN, (t - b) * scale + 2.0 * MARGIN);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {w:.1} {h:.1}\" \
         font-family=\"sans-serif\" font-size=\"13\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n"
    );
    let mut taken = Vec::new();
    for item in items {
        let _ = match item {
            SvgElement::Stroke { from, to, colour, width, dashed } => {
                let ([x1, y1], [x2, y2]) = (place(*from), place(*to));
                let dash = if *dashed { " stroke-dasharray=\"5 4\"" } else { "" };
                writeln!(
                    out,
                    "<line x1=\"{x1:.2}\" y1=\"{y1:.2}\" x2=\"{x2:.2}\" y2=\"{y2:.2}\" \
                     stroke=\"{colour}\" stroke-width=\"{width}\" stroke-linecap=\"round\"{dash}/>"
                )
            }
            SvgElement::Area { loops, fill } => {
                let mut path = String::new();
                for cycle in loops {
                    for (k, p) in cycle.iter().enumerate() {
                        let [x, y] = place(*p);
                        let _ = write!(path, "{}{x:.2} {y:.2} ", if k == 0 { "M" } else { "L" });
                    }
                    path.push_str("Z ");
                }
                // The border in the same colour closes the hairlines between facets.
                writeln!(
                    out,
                    "<path d=\"{path}\" fill=\"{fill}\" fill-rule=\"evenodd\" \
                     stroke=\"{fill}\" stroke-width=\"0.6\" stroke-linejoin=\"round\"/>"
                )
            }
            SvgElement::Text { at, shift, text, colour } => {
                let [x, y] = place(*at);
                let at = apart([x + shift[0], y + shift[1]], text, &mut taken);
                out.push_str(&haloed(at, text, colour));
                Ok(())
            }
            SvgElement::Centred { at, text, colour } => {
                let [x, y] = place(*at);
                let at = apart([x - 0.5 * text_width(text), y + 4.0], text, &mut taken);
                out.push_str(&haloed(at, text, colour));
                Ok(())
            }
            SvgElement::Span { from, to, colour } => {
                out.push_str(&span(place(*from), place(*to), colour));
                Ok(())
            }
        };
    }
    out.push_str("</svg>\n");
    out
}

/// A text before a white border of its own letters: two texts, as SVG 1.1 paints the border over the letters.
fn haloed([x, y]: [f64; 2], text: &str, colour: &str) -> String {
    let text = escaped(text);
    format!(
        "<text x=\"{x:.2}\" y=\"{y:.2}\" fill=\"#fff\" stroke=\"#fff\" stroke-width=\"3\" \
         stroke-linejoin=\"round\">{text}</text>\n\
         <text x=\"{x:.2}\" y=\"{y:.2}\" fill=\"{colour}\">{text}</text>\n"
    )
}

/// A dimension line with arrows at its ends; if it is too short for them they are outside.
fn span(from: [f64; 2], to: [f64; 2], colour: &str) -> String {
    const ARROW: [f64; 2] = [9.0, 2.6];
    let d = [to[0] - from[0], to[1] - from[1]];
    let length = libm::hypot(d[0], d[1]);
    if length < 1e-6 {
        return String::new();
    }
    let d = [d[0] / length, d[1] / length];
    let outside = length < 3.0 * ARROW[0];
    let tail = if outside { 2.0 * ARROW[0] } else { 0.0 };
    let along = |p: [f64; 2], by: f64| [p[0] + by * d[0], p[1] + by * d[1]];
    let ([x1, y1], [x2, y2]) = (along(from, -tail), along(to, tail));
    let mut out = format!(
        "<line x1=\"{x1:.2}\" y1=\"{y1:.2}\" x2=\"{x2:.2}\" y2=\"{y2:.2}\" stroke=\"{colour}\" stroke-width=\"0.8\"/>\n"
    );
    for (tip, turn) in [(from, 1.0), (to, -1.0)] {
        let [x, y] = along(tip, turn * if outside { -ARROW[0] } else { ARROW[0] });
        let n = [-ARROW[1] * d[1], ARROW[1] * d[0]];
        let _ = writeln!(
            out,
            "<polygon points=\"{:.2},{:.2} {:.2},{:.2} {:.2},{:.2}\" fill=\"{colour}\"/>",
            tip[0],
            tip[1],
            x + n[0],
            y + n[1],
            x - n[0],
            y - n[1]
        );
    }
    out
}

/// The width of a text on paper: letters count as 0.56 of their height, which is about their mean in sans-serif types.
fn text_width(text: &str) -> f64 {
    13.0 * 0.56 * text.chars().count() as f64
}

/// Position for a text near `at` that overlaps no earlier text: `at`, or the nearest free one up to
/// four lines lower or higher, or `at` if there is none.
pub fn apart(at: [f64; 2], text: &str, taken: &mut Vec<[f64; 4]>) -> [f64; 2] {
    const LINE: f64 = 15.0;
    let width = text_width(text);
    let of = |[x, y]: [f64; 2]| [x, y - 11.0, x + width, y + 3.0];
    let free = |b: &[f64; 4]| {
        let clear = |t: &[f64; 4]| b[0] >= t[2] || b[2] <= t[0] || b[1] >= t[3] || b[3] <= t[1];
        taken.iter().all(clear)
    };
    let lower = |k: i32| [at[0], at[1] + LINE * f64::from(k)];
    let tried = [0, 1, -1, 2, -2, 3, -3, 4, -4].map(lower);
    let place = tried.into_iter().find(|p| free(&of(*p))).unwrap_or(at);
    taken.push(of(place));
    place
}

/// Names come from people: never markup.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
