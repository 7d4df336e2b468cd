//! Drawings of other programs as sketches.

use crate::{Drawing, DrawnLine, DrawnPoint, LineTypeSource, PointId};

/// A straight stroke on the page.
pub type Stroke = [[f64; 2]; 2];

/// The straight lines of a DXF text: LINE, LWPOLYLINE and POLYLINE, seen from above.
///
/// # Errors
/// Says where the text is not a DXF.
pub fn dxf_lines(text: &str) -> Result<Vec<Stroke>, String> {
    let mut lines = text.lines();
    let mut strokes = Vec::new();
    // The entity under way: its kind, its vertices, whether it is closed.
    let mut kind = String::new();
    let mut vertices: Vec<[f64; 2]> = Vec::new();
    let mut closed = false;
    let mut number = 0;
    let mut known = false;
    while let Some(code) = lines.next() {
        number += 1;
        let code = code.trim();
        if code.is_empty() && lines.clone().all(|l| l.trim().is_empty()) {
            break;
        }
        let code: i32 = code.parse().map_err(|_| format!("line {number} is not a group code"))?;
        let value = lines.next().ok_or("the last group has no value")?.trim();
        number += 1;
        let coordinate = || {
            let x: f64 = value.parse().map_err(|_| format!("line {number} is not a number"))?;
            if x.is_finite() { Ok(x) } else { Err(format!("line {number} is not finite")) }
        };
        match code {
            0 => {
                known |= value == "SECTION";
                // The vertices of a POLYLINE are entities of their own.
                if value == "VERTEX" && kind == "POLYLINE" {
                    continue;
                }
                finish(&kind, &vertices, closed, &mut strokes);
                value.clone_into(&mut kind);
                vertices.clear();
                closed = false;
            }
            10 | 11 if matches!(kind.as_str(), "LINE" | "LWPOLYLINE" | "POLYLINE") => {
                vertices.push([coordinate()?, 0.0]);
            }
            20 | 21 => {
                if let Some(last) = vertices.last_mut() {
                    last[1] = coordinate()?;
                }
            }
            70 if kind.ends_with("POLYLINE") => {
                closed |= value.parse::<i32>().unwrap_or(0) & 1 == 1
            }
            _ => {}
        }
    }
    finish(&kind, &vertices, closed, &mut strokes);
    if known { Ok(strokes) } else { Err("it has no section".into()) }
}

fn finish(kind: &str, vertices: &[[f64; 2]], closed: bool, strokes: &mut Vec<Stroke>) {
    // The first vertex of a POLYLINE is its elevation.
    let vertices = match kind {
        "POLYLINE" if vertices.len() > 1 => &vertices[1..],
        "LINE" | "LWPOLYLINE" => vertices,
        _ => return,
    };
    strokes.extend(vertices.windows(2).map(|w| [w[0], w[1]]));
    if let ([first, _, .., last], true) = (vertices, closed) {
        strokes.push([*last, *first]);
    }
}

/// Adds strokes to a drawing, ends within `tolerance` being one point; the numbers of new points and
/// lines.
pub fn draw(drawing: &mut Drawing, strokes: &[Stroke], tolerance: f64) -> (usize, usize) {
    let cell = |x: f64| (x / (2.0 * tolerance.max(f64::MIN_POSITIVE))).round() as i64;
    let mut known: std::collections::BTreeMap<[i64; 2], Vec<PointId>> = Default::default();
    for (&id, p) in &drawing.points {
        known.entry([cell(p.u), cell(p.v)]).or_default().push(id);
    }
    let (mut points, mut lines) = (0, 0);
    let mut next_point = drawing.next_point().0;
    let mut next_line = drawing.next_line().0;
    let mut joined: std::collections::BTreeSet<(PointId, PointId)> =
        drawing.lines.values().map(|l| (l.p.min(l.q), l.p.max(l.q))).collect();
    for stroke in strokes {
        let [p, q] = stroke.map(|[u, v]| {
            let [i, j] = [cell(u), cell(v)];
            let around = (-1..=1).flat_map(|a| (-1..=1).map(move |b| [i + a, j + b]));
            let near = around.filter_map(|c| known.get(&c)).flatten().copied().find(|id| {
                let p = drawing.points[id];
                (p.u - u).abs().max((p.v - v).abs()) <= tolerance
            });
            near.unwrap_or_else(|| {
                let id = PointId(next_point);
                next_point += 1;
                points += 1;
                drawing.points.insert(id, DrawnPoint { u, v });
                known.entry([i, j]).or_default().push(id);
                id
            })
        });
        if p != q && joined.insert((p.min(q), p.max(q))) {
            let id = crate::LineId(next_line);
            next_line += 1;
            lines += 1;
            let line =
                DrawnLine { p, q, free: None, source: LineTypeSource::Auto, confidence: 0.0 };
            drawing.lines.insert(id, line);
            drawing.type_by_slope(id);
        }
    }
    (points, lines)
}
