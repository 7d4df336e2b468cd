//! The picture that EXPORT SVG writes: sketches as drawn with their planes and dimensions, or bodies
//! from a side.

use crate::command::Picture;
use crate::format::json_format::ObjectData;
use crate::{CoordinateAxis, MeasuredQuantity, Projection, SketchObject, SketchSolid};
use moldloft_num::{Real, Vec3};
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
    Stroke { from: [f64; 2], to: [f64; 2], colour: &'static str, width: f64, dashed: bool },
    Area { loops: Vec<Vec<[f64; 2]>>, fill: String },
    Text { at: [f64; 2], shift: [f64; 2], text: String, colour: &'static str },
}

/// The picture of objects; `page` is the part of the page that is drawn on.
pub(crate) fn svg(
    objects: &[(&SketchObject, &ObjectData)],
    picture: &Picture,
    page: [f64; 4],
) -> String {
    let view = match picture.view.as_str() {
        "TOP" => Some(Projection { angle_deg: [0.0, 90.0, 0.0], scale: [1.0, 1.0, 0.0] }),
        "FRONT" => Some(Projection { angle_deg: [0.0, 0.0, 90.0], scale: [1.0, 0.0, 1.0] }),
        "SIDE" => Some(Projection { angle_deg: [0.0, 0.0, 90.0], scale: [0.0, 1.0, 1.0] }),
        name => Projection::preset(name),
    };
    let mut items = Vec::new();
    for (object, data) in objects {
        match (&view, &data.solid) {
            (Some(view), Some(solid)) => body(solid, view, object, picture, &mut items),
            _ => sketch(object, data, picture, page, &mut items),
        }
    }
    // The page with the witness lines that leave it; of a view what is seen.
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
            SvgElement::Stroke { from, to, .. } => [from, to].into_iter().for_each(&mut take),
            SvgElement::Area { loops, .. } => loops.iter().flatten().for_each(&mut take),
            SvgElement::Text { .. } => {}
        }
    }
    (b[0] <= b[2] && b[1] <= b[3]).then(|| {
        let least = 1e-6 * (b[2] - b[0]).max(b[3] - b[1]).max(1e-300);
        [b[0] - least, b[1] - least, b[2] + least, b[3] + least]
    })
}

/// A sketch as drawn.
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
/// that each runs inside its plane), and the dimensions between them.
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
    // Dimensions on several axes between the same points are reported one below the other.
    let mut told: BTreeMap<(crate::PointId, crate::PointId), f64> = BTreeMap::new();
    for (key, dimension) in &object.dimensions {
        let MeasuredQuantity::Along { axis, p, q } = dimension.measure else { continue };
        let (Some(a), Some(b)) = (d.points.get(&p), d.points.get(&q)) else { continue };
        let value =
            data.dimensions.iter().find(|x| x.0.eq_ignore_ascii_case(key)).and_then(|x| x.2);
        let value = value.map_or_else(|| "?".to_owned(), plain);
        let (from, to) = ([a.u, a.v], [b.u, b.v]);
        let colour = axis_colour(axis);
        items.push(SvgElement::Stroke { from, to, colour, width: 0.8, dashed: true });
        let at = [(a.u + b.u) / 2.0, (a.v + b.v) / 2.0];
        let text = format!("{} {value}", dimension.name);
        let row = told.entry((p.min(q), p.max(q))).or_insert(0.0);
        items.push(SvgElement::Text { at, shift: [3.0, 3.0 + 15.0 * *row], text, colour });
        *row += 1.0;
    }
}

/// A body from a side: faces that look at the viewer from far to near, hidden edges dashed.
fn body(
    solid: &SketchSolid<f64>,
    view: &Projection,
    object: &SketchObject,
    picture: &Picture,
    items: &mut Vec<SvgElement>,
) {
    let sight = view.sight(object.drawing.letters.up).normalized().unwrap_or_default();
    let mut seen = vec![false; solid.edges.len()];
    let mut front: Vec<(f64, usize, f64)> = Vec::new();
    for (k, face) in solid.faces.iter().enumerate() {
        let mut vector = Vec3::zero();
        let (mut depth, mut count) = (0.0, 0.0);
        for cycle in &face.loops {
            let way = walk(solid, cycle);
            for (n, p) in way.iter().enumerate() {
                let q = way[(n + 1) % way.len()];
                vector += (*p - way[0]).cross(q - way[0]);
                depth += p.dot(sight);
                count += 1.0;
            }
        }
        let normal = vector.normalized().unwrap_or_default();
        let facing = if solid.flat { normal.dot(sight).abs() } else { normal.dot(sight) };
        // A patch of a curve may turn towards the viewer in part.
        if facing > 1e-9 || face.ruled {
            face.loops.iter().flatten().for_each(|h| seen[h.0] = true);
        }
        if facing > 1e-9 {
            front.push((depth / Real::max(count, 1.0), k, facing));
        }
    }
    front.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    for (_, k, facing) in front {
        let face = &solid.faces[k];
        let flat = |p: &Vec3| view.project(*p);
        let loops: Vec<Vec<[f64; 2]>> =
            face.loops.iter().map(|c| walk(solid, c).iter().map(flat).collect()).collect();
        let chosen = face.id.is_some() && face.id == picture.face;
        items.push(SvgElement::Area { loops, fill: shade(facing, chosen) });
        for &(e, _) in face.loops.iter().flatten() {
            edge(solid, e, view, "#222", false, items);
        }
    }
    for (e, seen) in seen.iter().enumerate() {
        if !seen {
            edge(solid, e, view, "#9ab", true, items);
        }
    }
    if picture.labels {
        for v in &solid.vertices {
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

fn edge(
    solid: &SketchSolid<f64>,
    e: usize,
    view: &Projection,
    colour: &'static str,
    dashed: bool,
    items: &mut Vec<SvgElement>,
) {
    let way: Vec<[f64; 2]> = solid.polyline(e, CHORDS).iter().map(|p| view.project(*p)).collect();
    let width = if dashed { 0.9 } else { 1.4 };
    items.extend(way.windows(2).map(|w| SvgElement::Stroke {
        from: w[0],
        to: w[1],
        colour,
        width,
        dashed,
    }));
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
                writeln!(out, "<path d=\"{path}\" fill=\"{fill}\" fill-rule=\"evenodd\"/>")
            }
            SvgElement::Text { at, shift, text, colour } => {
                let [x, y] = place(*at);
                let [x, y] = apart([x + shift[0], y + shift[1]], text, &mut taken);
                writeln!(
                    out,
                    "<text x=\"{x:.2}\" y=\"{y:.2}\" fill=\"{colour}\" stroke=\"#fff\" \
                     stroke-width=\"3\" paint-order=\"stroke\">{}</text>",
                    escaped(text)
                )
            }
        };
    }
    out.push_str("</svg>\n");
    out
}

/// Where a text that should begin at `at` stands clear of those before it: there, else up to four lines
/// lower or higher, whichever is nearest; where none is free, there all the same. Letters count as 0.56
/// of their height, which is about their mean in sans-serif types.
pub fn apart(at: [f64; 2], text: &str, taken: &mut Vec<[f64; 4]>) -> [f64; 2] {
    const LINE: f64 = 15.0;
    let width = 13.0 * 0.56 * text.chars().count() as f64;
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
