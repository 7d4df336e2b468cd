//! Bodies that have no faces on surfaces, as the triangles of their panels.

use super::bodies::set_and_box;
use moldloft_brep::FacetedPart;
use moldloft_document::Document;
use moldloft_mesh::Mesh;
use moldloft_num::Vec3;
use moldloft_picture::PALETTE;
use std::collections::HashMap;

/// The triangles of the body of that name, as they are shown.
pub fn part(document: &Document, mesh: &Mesh, name: &str) -> FacetedPart {
    let mut made = FacetedPart { name: name.to_string(), ..FacetedPart::default() };
    let mut numbers: HashMap<u32, u32> = HashMap::new();
    let prefix = format!("{name}.");
    for patch in mesh.patches() {
        if patch.info.name != name && !patch.info.name.starts_with(&prefix) {
            continue;
        }
        made.colour = made.colour.or(patch.info.colour.map(|c| PALETTE[usize::from(c & 15)]));
        for tag in &patch.info.tags {
            if !made.layers.contains(tag) {
                made.layers.push(tag.clone());
            }
        }
        for &[a, b, c, d] in &mesh.faces()[patch.faces.clone()] {
            let [a, b, c, d] = [a, b, c, d].map(|v| {
                *numbers.entry(v).or_insert_with(|| {
                    made.positions.push(mesh.positions()[v as usize]);
                    made.positions.len() as u32 - 1
                })
            });
            made.triangles.push([a, b, c]);
            if d != c {
                made.triangles.push([a, c, d]);
            }
        }
    }
    made.error = error(document, name, &made);
    made
}

/// Distance of the centres of a set's triangles from its surfaces, to first order.
fn error(document: &Document, name: &str, part: &FacetedPart) -> Option<f64> {
    let graph = document.graph();
    let object = graph.find(name).and_then(|key| graph.get(key))?;
    let (set, over) = set_and_box(document, object)?;
    let leaves = set.leaves();
    let from_box = |p: Vec3| {
        let side = |k: usize| (p[k] - over.low[k]).abs().min((p[k] - over.high[k]).abs());
        (0..3).map(side).fold(f64::INFINITY, f64::min)
    };
    let distance = |p: Vec3| {
        let own = leaves.iter().map(|leaf| {
            let primitive = leaf.primitive.of_sheet();
            let g = primitive.gradient(p);
            if g.value == 0.0 { 0.0 } else { (g.value / g.slope.norm()).abs() }
        });
        own.filter(|d| d.is_finite()).fold(from_box(p), f64::min)
    };
    let middles = part.triangles.iter().map(|t| {
        let [a, b, c] = t.map(|v| part.positions[v as usize]);
        (a + b + c) / 3.0
    });
    Some(middles.map(distance).fold(0.0, f64::max))
}
