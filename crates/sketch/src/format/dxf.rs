//! Drawings of other programs as sketches.

use crate::format::page_shapes::PageShapes;
use crate::format::page_spline::spline_curves;
use crate::format::svg_transform::SvgTransform;
use std::collections::BTreeMap;

/// Blocks inserted in one another deeper than this are left out.
const MAX_DEPTH: usize = 16;

/// The lines and curves of a DXF text: LINE, LWPOLYLINE and POLYLINE with their bulges, ARC, CIRCLE, ELLIPSE, SPLINE of
/// degree 1 to 3, seen from above, and INSERT of blocks of them; other entities are counted.
///
/// # Errors
/// Says where the text is not a DXF.
pub fn dxf_shapes(text: &str) -> Result<PageShapes, String> {
    let mut lines = text.lines();
    let mut file = DxfFile::default();
    let mut entity = Entity::default();
    let mut number = 0;
    let (mut known, mut begins, mut section, mut variable) = (false, false, "ENTITIES", "");
    while let Some(code) = lines.next() {
        number += 1;
        let code = code.trim();
        if code.is_empty() && lines.clone().all(|l| l.trim().is_empty()) {
            break;
        }
        let code: i32 = code.parse().map_err(|_| format!("line {number} is not a group code"))?;
        let value = lines.next().ok_or("the last group has no value")?.trim();
        number += 1;
        match code {
            0 => {
                known |= value == "SECTION";
                begins = value == "SECTION";
                // The vertices of a POLYLINE are entities of their own.
                if value == "VERTEX" && entity.kind == "POLYLINE" {
                    continue;
                }
                file.add(std::mem::take(&mut entity), section);
                entity.kind = value.to_owned();
            }
            2 if begins => {
                section = value;
                begins = false;
            }
            2 => entity.name = value.to_owned(),
            9 => variable = value,
            70 if section == "HEADER" && variable == "$INSUNITS" => file.unit = unit(value),
            _ => entity.read(code, value).map_err(|why| format!("line {number} is not {why}"))?,
        }
    }
    file.add(entity, section);
    if !known {
        return Err("it has no section".into());
    }
    let mut shapes = PageShapes { unit: file.unit, ..PageShapes::default() };
    file.draw(&file.entities, SvgTransform::NONE, 0, &mut shapes);
    Ok(shapes)
}

/// The unit of length of a value of $INSUNITS.
fn unit(code: &str) -> Option<&'static str> {
    match code {
        "1" => Some("IN"),
        "2" => Some("FT"),
        "4" => Some("MM"),
        "5" => Some("CM"),
        "6" => Some("M"),
        _ => None,
    }
}

/// The plane of an entity whose normal points down.
const BEHIND: SvgTransform = SvgTransform([-1.0, 0.0, 0.0, 1.0, 0.0, 0.0]);

/// Most copies of a block that one INSERT makes.
const MOST_COPIES: f64 = 10_000.0;

#[derive(Default)]
struct DxfFile {
    entities: Vec<Entity>,
    /// Base point and entities by name.
    blocks: BTreeMap<String, ([f64; 2], Vec<Entity>)>,
    block: Option<String>,
    unit: Option<&'static str>,
}

impl DxfFile {
    fn add(&mut self, entity: Entity, section: &str) {
        match (section, entity.kind.as_str()) {
            ("BLOCKS", "BLOCK") => {
                let base = entity.vertices.first().map_or([0.0; 2], |v| v.0);
                self.blocks.insert(entity.name.clone(), (base, Vec::new()));
                self.block = Some(entity.name);
            }
            ("BLOCKS", "ENDBLK") => self.block = None,
            ("BLOCKS", _) => {
                let block = self.block.as_ref().and_then(|name| self.blocks.get_mut(name));
                block.into_iter().for_each(|b| b.1.push(entity.clone()));
            }
            ("ENTITIES", _) => self.entities.push(entity),
            _ => {}
        }
    }

    fn draw(
        &self,
        entities: &[Entity],
        place: SvgTransform,
        depth: usize,
        shapes: &mut PageShapes,
    ) {
        for entity in entities {
            if entity.kind == "INSERT" {
                match self.blocks.get(&entity.name).zip(entity.placements()) {
                    Some(((base, inner), all)) if depth < MAX_DEPTH => {
                        let from_base = SvgTransform([1.0, 0.0, 0.0, 1.0, -base[0], base[1]]);
                        for own in all {
                            self.draw(inner, place.after(own).after(from_base), depth + 1, shapes);
                        }
                    }
                    _ => shapes.leave_out("INSERT"),
                }
                continue;
            }
            let mut own = PageShapes::default();
            entity.draw(&mut own);
            // Those with a plane of their own are seen from behind if its normal points down.
            let behind = entity.mirrored && !["LINE", "ELLIPSE", "SPLINE"].contains(&&*entity.kind);
            let own_place = if behind { place.after(BEHIND) } else { place };
            own_place.put(own, shapes);
        }
    }
}

#[derive(Clone, Default)]
struct Entity {
    kind: String,
    /// Name of a block, or of the inserted block.
    name: String,
    /// Vertices with their bulges.
    vertices: Vec<([f64; 2], f64)>,
    numbers: BTreeMap<i32, f64>,
    /// Of a spline.
    knots: Vec<f64>,
    weights: Vec<f64>,
    closed: bool,
    /// True if its normal points down.
    mirrored: bool,
}

impl Entity {
    /// Reads a group; the error is the expected type of its value.
    fn read(&mut self, code: i32, value: &str) -> Result<(), &'static str> {
        let coordinate = || {
            let x: f64 = value.parse().map_err(|_| "a number")?;
            if x.is_finite() { Ok(x) } else { Err("finite") }
        };
        let polyline = self.kind.ends_with("POLYLINE");
        match (code, self.kind.as_str()) {
            (10, _) | (11, "LINE" | "ELLIPSE") => self.vertices.push(([coordinate()?, 0.0], 0.0)),
            (20, _) | (21, "LINE" | "ELLIPSE") => {
                if let Some(last) = self.vertices.last_mut() {
                    last.0[1] = coordinate()?;
                }
            }
            (40, "SPLINE") => self.knots.push(coordinate()?),
            (41, "SPLINE") => self.weights.push(coordinate()?),
            (40 | 41 | 50 | 51, "ARC" | "CIRCLE" | "ELLIPSE")
            | (42, "ELLIPSE")
            | (71 | 74, "SPLINE")
            | (41 | 42 | 44 | 45 | 50 | 70 | 71, "INSERT") => {
                self.numbers.insert(code, coordinate()?);
            }
            (42, _) if polyline => {
                if let Some(last) = self.vertices.last_mut() {
                    last.1 = coordinate()?;
                }
            }
            (70, _) if polyline => {
                // Vertices of a POLYLINE have flags of their own.
                let own = self.kind == "LWPOLYLINE" || self.vertices.len() < 2;
                self.closed |= own && value.parse::<i32>().unwrap_or(0) & 1 == 1;
            }
            (230, _) => self.mirrored = coordinate()? < 0.0,
            _ => {}
        }
        Ok(())
    }

    /// Transformations of an INSERT's block, one for each of its rows and columns.
    fn placements(&self) -> Option<Vec<SvgTransform>> {
        let number = |code: i32, other: f64| self.numbers.get(&code).copied().unwrap_or(other);
        let [columns, rows] = [number(70, 1.0), number(71, 1.0)].map(|n| n.max(1.0));
        if columns * rows > MOST_COPIES {
            return None;
        }
        let [x, y] = self.vertices.first()?.0;
        let (sx, sy, angle) = (number(41, 1.0), number(42, 1.0), number(50, 0.0));
        let [c, s] = match angle.rem_euclid(360.0) {
            0.0 => [1.0, 0.0],
            90.0 => [0.0, 1.0],
            180.0 => [-1.0, 0.0],
            270.0 => [0.0, -1.0],
            a => [libm::cos(a.to_radians()), libm::sin(a.to_radians())],
        };
        let side = if self.mirrored { BEHIND } else { SvgTransform::NONE };
        let all = (0..rows as usize).flat_map(|j| (0..columns as usize).map(move |i| [i, j]));
        let place = |[i, j]: [usize; 2]| {
            let (u, v) = (i as f64 * number(44, 0.0), j as f64 * number(45, 0.0));
            let [x, y] = [x + c * u - s * v, y + s * u + c * v];
            // As of SVG, where y runs down.
            side.after(SvgTransform([sx * c, -sx * s, sy * s, sy * c, x, -y]))
        };
        Some(all.map(place).collect())
    }

    fn draw(&self, shapes: &mut PageShapes) {
        let number = |code: i32| self.numbers.get(&code).copied();
        let turn = crate::format::page_shapes::TURN;
        let first = self.vertices.first().map(|v| v.0);
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
                let (from, to) = (number(41).unwrap_or(0.0), number(42).unwrap_or(turn));
                if let (Some((a, _)), Some(ratio)) = (self.vertices.get(1), number(40))
                    && ratio > 0.0
                {
                    let ratio = if self.mirrored { -ratio } else { ratio };
                    let b = [-a[1] * ratio, a[0] * ratio];
                    let sweep = (to - from).rem_euclid(turn);
                    if sweep < 1e-9 || turn - sweep < 1e-9 {
                        shapes.rounds.push([centre, *a, b]);
                    } else {
                        shapes.elliptical(centre, [*a, b], from, sweep);
                    }
                }
            }
            ("SPLINE", _) => {
                let points: Vec<[f64; 2]> = self.vertices.iter().map(|v| v.0).collect();
                let degree = number(71).unwrap_or(3.0) as usize;
                match spline_curves(degree, &self.knots, &points, &self.weights) {
                    Ok(curves) => shapes.curves.extend(curves),
                    Err(why) => shapes.leave_out(&why),
                }
            }
            ("" | "SECTION" | "ENDSEC" | "EOF" | "SEQEND" | "VERTEX", _) => {}
            (other, _) => shapes.leave_out(other),
        }
    }
}
