//! Fields at the vertices of patches, for colouring: curvature, quality, derivatives.

use crate::scene::{SceneItem, SceneItemKind};
use moldloft_diag::Diagnostic;
use moldloft_document::Document;
use moldloft_mesh::{
    Mesh, MeshError, PatchInfo, PatchQuality, TopologyBuilder, is_triangle, qualities,
};
use std::collections::HashMap;

/// The fields without a parameter; `derivative` takes one.
pub const FIELDS: [&str; 10] = [
    "gaussian_curvature",
    "mean_curvature",
    "largest_curvature",
    "smallest_curvature",
    "aspect",
    "skew",
    "warp",
    "jump",
    "normal",
    "derivative",
];

/// Field of one patch.
pub struct PatchNumbers<'s> {
    /// The patch.
    pub item: &'s SceneItem,
    /// Numbers per vertex.
    pub components: usize,
    /// Values, in the order of the vertices.
    pub values: Vec<f32>,
}

/// A field at the vertices of all patches that have it.
///
/// # Errors
/// An unknown field or parameter; a model without panels.
pub fn field<'s>(
    document: &mut Document,
    items: &'s [SceneItem],
    field: &str,
    by: Option<&str>,
) -> Result<Vec<PatchNumbers<'s>>, Vec<Diagnostic>> {
    if !FIELDS.contains(&field) {
        let error = Diagnostic::error("unknown-field", format!("there is no field `{field}`"));
        return Err(vec![error.expected(FIELDS.join(", ")).suggest(field, FIELDS)]);
    }
    let panelled = document.panelled().map_err(|d| vec![d])?;
    let mesh = &panelled.mesh;
    let drawn = items.iter().filter(|i| i.kind == SceneItemKind::Patch);
    let drawn = drawn.filter_map(|i| Some((i, &mesh.patches()[i.patch?])));
    let with_copies = |item: &'s SceneItem, components: usize, mut values: Vec<f32>| {
        for &copy in &item.connections.copies {
            let at = copy as usize * components;
            values.extend_from_within(at..at + components);
        }
        PatchNumbers { item, components, values }
    };
    let global = |item: &SceneItem, patch: &moldloft_mesh::Patch| -> Vec<u32> {
        if let Some(block) = &patch.block {
            return block.vertices.clone();
        }
        let count = item.positions.len() / 3 - item.connections.copies.len();
        let mut seen = rustc_hash::FxHashSet::default();
        let corners = mesh.faces()[patch.faces.clone()].iter().flatten();
        corners.copied().filter(|v| seen.insert(*v)).take(count).collect()
    };
    if let Some(measure) = measure(field) {
        let panels = panel_qualities(mesh);
        let panels =
            panels.map_err(|e| vec![Diagnostic::error("too-many-panels", e.to_string())])?;
        // The worst value of the panels at each vertex.
        let of_patch = |(item, patch): (&'s SceneItem, &moldloft_mesh::Patch)| {
            let mut worst: HashMap<u32, f64> = HashMap::new();
            for index in patch.faces.clone() {
                let Some(quality) = &panels[index] else { continue };
                let (face, value) = (mesh.faces()[index], measure(quality));
                for &v in if is_triangle(face) { &face[..3] } else { &face[..] } {
                    let at = worst.entry(v).or_insert(value);
                    *at = at.max(value);
                }
            }
            let vertices = global(item, patch);
            let at = |v: &u32| worst.get(v).copied().unwrap_or(f64::NAN) as f32;
            with_copies(item, 1, vertices.iter().map(at).collect())
        };
        return Ok(drawn.map(of_patch).collect());
    }
    if field == "derivative" {
        let by = by.ok_or_else(|| {
            vec![Diagnostic::error("no-parameter", "a derivative is by a parameter")]
        })?;
        let jacobian = document.jacobian(&[by.to_string()])?;
        let column = &jacobian[0];
        let of_patch = |(item, patch): (&'s SceneItem, &moldloft_mesh::Patch)| {
            let vertices = global(item, patch);
            let values = vertices.iter().flat_map(|&v| column[v as usize].to_array());
            with_copies(item, 3, values.map(|x| x as f32).collect())
        };
        return Ok(drawn.map(of_patch).collect());
    }
    let all: HashMap<String, (usize, Vec<f64>)> = document
        .patch_fields()
        .map_err(|d| vec![d])?
        .into_iter()
        .filter_map(|p| {
            let found = p.fields.into_iter().find(|f| f.name == field)?;
            Some((p.patch, (found.components, found.values)))
        })
        .collect();
    let of_patch = |(item, patch): (&'s SceneItem, &moldloft_mesh::Patch)| {
        let (components, values) = all.get(&patch.info.name)?;
        let wanted = item.positions.len() / 3 - item.connections.copies.len();
        (values.len() == wanted * components)
            .then(|| with_copies(item, *components, values.iter().map(|&x| x as f32).collect()))
    };
    Ok(drawn.filter_map(of_patch).collect())
}

/// A panel quality measure by name.
fn measure(name: &str) -> Option<fn(&PatchQuality) -> f64> {
    Some(match name {
        "aspect" => |q| q.aspect.max,
        "skew" => |q| q.skew.max,
        "warp" => |q| q.warp.max,
        "jump" => |q| q.jump.max,
        _ => return None,
    })
}

/// The quality of each panel, computed as that of a one-panel patch.
fn panel_qualities(mesh: &Mesh) -> Result<Vec<Option<PatchQuality>>, MeshError> {
    let mut builder = TopologyBuilder::new();
    builder.add_vertices(mesh.positions().len())?;
    for &face in mesh.faces() {
        builder.add_faces(PatchInfo::default(), [face])?;
    }
    Ok(qualities(&Mesh::new(builder.build().into(), mesh.positions().to_vec())?))
}
