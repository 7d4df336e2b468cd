//! Drawings of other programs as sketches.

use crate::format::page_shapes::PageShapes;
use crate::{Drawing, DrawnLine, DrawnPoint, LineTypeSource, PointId};
use std::collections::BTreeMap;

/// A straight stroke on the page.
pub type Stroke = [[f64; 2]; 2];

/// The lines, arcs, circles and ellipses of a DXF text: LINE, LWPOLYLINE and POLYLINE with their bulges, ARC, CIRCLE,
/// full ELLIPSE, seen from above; what else there is is counted.
///
/// # Errors
/// Says where the text is not a DXF.
pub fn dxf_shapes(text: &str) -> Result<PageShapes, String> {
    let mut lines = text.lines();
    let mut shapes = PageShapes::default();
    let mut entity = Entity::default();
    let mut number = 0;
    let (mut known, mut section, mut entities) = (false, false, true);
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
                section = value == "SECTION";
                // The vertices of a POLYLINE are entities of their own.
                if value == "VERTEX" && entity.kind == "POLYLINE" {
                    continue;
                }
                entity.finish(entities, &mut shapes);
                entity = Entity { kind: value.to_owned(), ..Entity::default() };
            }
            2 if section => {
                // Blocks are drawn where they are inserted only.
                entities = value == "ENTITIES";
                section = false;
            }
            10 => entity.vertices.push(([coordinate()?, 0.0], 0.0)),
            11 if entity.kind == "LINE" => entity.vertices.push(([coordinate()?, 0.0], 0.0)),
            11 if entity.kind == "ELLIPSE" => entity.vertices.push(([coordinate()?, 0.0], 0.0)),
            20 | 21 if code == 20 || matches!(entity.kind.as_str(), "LINE" | "ELLIPSE") => {
                if let Some(last) = entity.vertices.last_mut() {
                    last.0[1] = coordinate()?;
                }
            }
            40 | 41 | 50 | 51 if matches!(entity.kind.as_str(), "ARC" | "CIRCLE" | "ELLIPSE") => {
                entity.numbers.insert(code, coordinate()?);
            }
            42 if entity.kind == "ELLIPSE" => {
                entity.numbers.insert(code, coordinate()?);
            }
            42 if entity.kind.ends_with("POLYLINE") => {
                if let Some(last) = entity.vertices.last_mut() {
                    last.1 = coordinate()?;
                }
            }
            70 if entity.kind.ends_with("POLYLINE") => {
                // Vertices of a POLYLINE have flags of their own.
                let own = entity.kind == "LWPOLYLINE" || entity.vertices.len() < 2;
                entity.closed |= own && value.parse::<i32>().unwrap_or(0) & 1 == 1;
            }
            230 => entity.mirrored = coordinate()? < 0.0,
            _ => {}
        }
    }
    entity.finish(entities, &mut shapes);
    if known { Ok(shapes) } else { Err("it has no section".into()) }
}

/// The entity under way.
#[derive(Default)]
struct Entity {
    kind: String,
    /// Places, each with its bulge.
    vertices: Vec<([f64; 2], f64)>,
    numbers: BTreeMap<i32, f64>,
    closed: bool,
    /// Whether it is seen from behind.
    mirrored: bool,
}

impl Entity {
    fn finish(&self, drawn: bool, shapes: &mut PageShapes) {
        let number = |code: i32| self.numbers.get(&code).copied();
        let turn = crate::format::page_shapes::TURN;
        let first = self.vertices.first().map(|v| v.0);
        if !drawn {
            return;
        }
        let round = ["ARC", "CIRCLE", "ELLIPSE"].contains(&self.kind.as_str());
        if self.mirrored && (round || self.vertices.iter().any(|v| v.1 != 0.0)) {
            shapes.leave_out(&format!("{} seen from behind", self.kind));
            return;
        }
        match (self.kind.as_str(), first) {
            ("POLYLINE" | "LINE" | "LWPOLYLINE", _) => {
                // The first vertex of a POLYLINE is its elevation.
                let skip = usize::from(self.kind == "POLYLINE" && self.vertices.len() > 1);
                let vertices = &self.vertices[skip.min(self.vertices.len())..];
                for w in vertices.windows(2) {
                    shapes.bulged(w[0].0, w[1].0, w[0].1);
                }
                if let ([first, .., last], true) = (vertices, self.closed)
                    && (vertices.len() > 2 || last.1 != 0.0)
                {
                    shapes.bulged(last.0, first.0, last.1);
                }
            }
            ("CIRCLE", Some(centre)) => {
                if let Some(r) = number(40).filter(|r| *r > 0.0) {
                    shapes.rounds.push([centre, [r, 0.0], [0.0, r]]);
                }
            }
            ("ARC", Some(centre)) => {
                let angles = [number(50), number(51)].map(|a| a.unwrap_or(0.0).to_radians());
                let sweep = (angles[1] - angles[0]).rem_euclid(turn);
                let sweep = if sweep == 0.0 { turn } else { sweep };
                if let Some(r) = number(40).filter(|r| *r > 0.0) {
                    shapes.arc(centre, r, angles[0], sweep);
                }
            }
            ("ELLIPSE", Some(centre)) => {
                let whole =
                    (number(42).unwrap_or(turn) - number(41).unwrap_or(0.0) - turn).abs() < 1e-9;
                match (self.vertices.get(1), number(40)) {
                    (Some((a, _)), Some(ratio)) if whole && ratio > 0.0 => {
                        shapes.rounds.push([centre, *a, [-a[1] * ratio, a[0] * ratio]]);
                    }
                    _ => shapes.leave_out("arc of an ELLIPSE"),
                }
            }
            ("" | "SECTION" | "ENDSEC" | "EOF" | "SEQEND" | "VERTEX", _) => {}
            (other, _) => shapes.leave_out(other),
        }
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
