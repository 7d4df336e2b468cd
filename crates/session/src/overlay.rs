//! Meshes and point tables laid over the model, and their distances from it.

use crate::frame::ReplyFrame;
use moldloft_budget::Budget;
use moldloft_document::Document;
use moldloft_document::searches::{NearestPoints, Searches};
use moldloft_mesh::{Mesh, is_triangle};
use moldloft_num::{Order, Vec3};
use moldloft_registry::Value as Quantity;
use serde_json::{Value, json};

/// Maximum number of vertices of all overlays.
const MOST_VERTICES: usize = 2_000_000;

/// A mesh or point table laid over the model.
pub struct Overlay {
    name: String,
    points: Vec<Vec3>,
    triangles: Vec<u32>,
    edges: Vec<u32>,
}

/// The overlays, and the shapes prepared for their distances.
#[derive(Default)]
pub struct Overlays {
    all: Vec<Overlay>,
    searches: Searches,
}

impl Overlays {
    /// Adds a file: an STL, OBJ, PLY, OFF or GDF mesh by its extension, otherwise a table of
    /// points.
    ///
    /// # Errors
    /// The error of the file.
    pub fn add(&mut self, name: &str, data: &str) -> Result<(), String> {
        let bytes = from_base64(data).ok_or("the file came damaged")?;
        let said = |e: moldloft_io::ReadError| format!("{name}: {e}");
        let ending = name.rsplit('.').next().unwrap_or_default().to_ascii_lowercase();
        let overlay = match &*ending {
            "stl" => of_mesh(name, &moldloft_io::stl::read(&bytes).map_err(said)?.mesh),
            "obj" => of_mesh(name, &moldloft_io::obj::read(&bytes).map_err(said)?.mesh),
            "ply" => of_mesh(name, &moldloft_io::ply::read(&bytes).map_err(said)?.mesh),
            "off" => of_mesh(name, &moldloft_io::off::read(&bytes).map_err(said)?.mesh),
            "gdf" => of_mesh(name, &moldloft_io::gdf::read(&bytes).map_err(said)?.1),
            _ => of_points(name, &moldloft_io::points::read(&bytes).map_err(said)?),
        };
        self.all.retain(|o| o.name != name);
        let count: usize = self.all.iter().map(|o| o.points.len()).sum();
        if count + overlay.points.len() > MOST_VERTICES {
            return Err(format!("{name}: overlays have at most {MOST_VERTICES} vertices"));
        }
        self.all.push(overlay);
        Ok(())
    }

    /// Removes one overlay, or all.
    pub fn remove(&mut self, name: Option<&str>) {
        self.all.retain(|o| name.is_some_and(|n| o.name != n));
    }

    /// Adds the overlays to a reply, each vertex with its signed distance from the nearest surface
    /// of the model, positive on the side of the normal. In a mirrored model the smaller distance
    /// of a point and its image counts.
    pub fn put(&self, document: &mut Document, frame: &mut ReplyFrame, shapes: bool) {
        let symmetry = document.symmetry();
        let mirrors: Vec<usize> =
            (0..3).filter(|&k| symmetry.contains(['x', 'y', 'z'][k])).collect();
        let mut parts = Vec::new();
        for overlay in &self.all {
            let found = self.distances(document, &overlay.points, &mirrors);
            let mut part = json!({"name": overlay.name});
            if shapes {
                let flat = |p: &Vec3| p.to_array().map(|x| x as f32);
                let positions: Vec<f32> = overlay.points.iter().flat_map(flat).collect();
                part["position"] = frame.floats("position", &positions);
                part["triangle"] = frame.numbers("triangle", &overlay.triangles);
                part["edge"] = frame.numbers("edge", &overlay.edges);
            }
            part["deviation"] = match &found {
                Some(d) => {
                    frame.floats("deviation", &d.iter().map(|&x| x as f32).collect::<Vec<_>>())
                }
                None => Value::Null,
            };
            if let Some(d) = found.filter(|d| !d.is_empty()) {
                let n = d.len() as f64;
                let most = d.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
                part["rms"] =
                    crate::facts::number((d.iter().map(|x| x * x).sum::<f64>() / n).sqrt());
                part["largest"] = crate::facts::number(most);
            }
            parts.push(part);
        }
        frame.put("overlays", parts);
    }

    /// Distances of points from the shown surfaces; `None` without surfaces.
    fn distances(
        &self,
        document: &mut Document,
        points: &[Vec3],
        mirrors: &[usize],
    ) -> Option<Vec<f64>> {
        let mut best: Option<Vec<f64>> = None;
        let never = Budget::default();
        for image in 0..1usize << mirrors.len() {
            let flips = mirrors.iter().enumerate().filter(|(k, _)| image >> k & 1 == 1);
            let flips: Vec<usize> = flips.map(|(_, &axis)| axis).collect();
            let at = |p: &Vec3| {
                let mut p = p.to_array();
                for &axis in &flips {
                    p[axis] = -p[axis];
                }
                Vec3::from(p)
            };
            let moved: Vec<Vec3> = points.iter().map(at).collect();
            for object in document.graph().objects().filter(|o| o.head.shown()) {
                let Some(value @ Quantity::Surface(surface)) = object.value() else { continue };
                let found = self.searches.nearest(&object.name, value, &moved, &never);
                let Some(NearestPoints::Surface(feet)) = found else { continue };
                let best = best.get_or_insert_with(|| vec![f64::INFINITY; points.len()]);
                for ((foot, p), best) in feet.iter().zip(&moved).zip(best) {
                    if foot.distance < best.abs() {
                        let jet = surface.jet(foot.at[0], foot.at[1], Order::First);
                        let side = jet.u.cross(jet.v).dot(*p - foot.xyz);
                        *best = if side < 0.0 { -foot.distance } else { foot.distance };
                    }
                }
            }
        }
        best
    }
}

fn of_mesh(name: &str, mesh: &Mesh) -> Overlay {
    let (mut triangles, mut edges) = (Vec::new(), Vec::new());
    for face in mesh.faces() {
        let [a, b, c, d] = *face;
        triangles.extend([a, b, c]);
        if is_triangle(*face) {
            edges.extend([a, b, b, c, c, a]);
        } else {
            triangles.extend([a, c, d]);
            edges.extend([a, b, b, c, c, d, d, a]);
        }
    }
    let points = mesh.positions().to_vec();
    Overlay { name: name.into(), points, triangles, edges: once(&edges) }
}

/// Edges without duplicates.
fn once(ends: &[u32]) -> Vec<u32> {
    let mut sides: Vec<[u32; 2]> =
        ends.chunks_exact(2).map(|e| [e[0].min(e[1]), e[0].max(e[1])]).collect();
    sides.sort_unstable();
    sides.dedup();
    sides.into_iter().flatten().collect()
}

fn of_points(name: &str, table: &moldloft_io::points::PointTable) -> Overlay {
    let runs = table.blocks.iter().flat_map(|b| b.clone().zip(b.clone().skip(1)));
    let edges = runs.flat_map(|(a, b)| [a as u32, b as u32]).collect();
    Overlay { name: name.into(), points: table.rows.clone(), triangles: Vec::new(), edges }
}

/// Decodes padded base64.
fn from_base64(text: &str) -> Option<Vec<u8>> {
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3);
    let (mut word, mut bits) = (0u32, 0);
    for c in text.trim_end_matches('=').bytes() {
        let digit = match c {
            b'A'..=b'Z' => c - b'A',
            b'a'..=b'z' => c - b'a' + 26,
            b'0'..=b'9' => c - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            _ => return None,
        };
        word = word << 6 | u32::from(digit);
        bits += 6;
        if bits >= 8 {
            bits -= 8;
            bytes.push((word >> bits) as u8);
            word &= (1 << bits) - 1;
        }
    }
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_come_in_base64() {
        for (text, bytes) in [
            ("", &b""[..]),
            ("TQ==", b"M"),
            ("TWE=", b"Ma"),
            ("TWFu", b"Man"),
            ("//79", &[255, 254, 253]),
        ] {
            assert_eq!(from_base64(text).as_deref(), Some(bytes));
        }
        assert_eq!(from_base64("a b"), None);
    }
}
