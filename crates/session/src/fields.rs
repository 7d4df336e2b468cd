//! Numbers at the vertices of the scene's patches, for colours: curvatures, quality, derivatives.

use crate::scene::{Item, ItemKind};
use moldloft_diag::Diagnostic;
use moldloft_document::Document;
use std::collections::HashMap;

/// The fields that need no parameter; `derivative` is by one.
pub const FIELDS: [&str; 6] = [
    "gaussian_curvature",
    "mean_curvature",
    "largest_curvature",
    "smallest_curvature",
    "normal",
    "derivative",
];

/// Numbers of one patch: how many for each vertex, and all of them.
pub struct PatchNumbers<'s> {
    /// The patch.
    pub item: &'s Item,
    /// Numbers a vertex.
    pub components: usize,
    /// In the order of the vertices.
    pub values: Vec<f32>,
}

/// A field at the vertices of all patches that have it.
///
/// # Errors
/// An unknown field or parameter; a model without panels.
pub fn field<'s>(
    document: &mut Document,
    items: &'s [Item],
    field: &str,
    by: Option<&str>,
) -> Result<Vec<PatchNumbers<'s>>, Vec<Diagnostic>> {
    if !FIELDS.contains(&field) {
        let error = Diagnostic::error("unknown-field", format!("there is no field `{field}`"));
        return Err(vec![error.expected(FIELDS.join(", ")).suggest(field, FIELDS)]);
    }
    let panelled = document.panelled().map_err(|d| vec![d])?;
    let mesh = &panelled.mesh;
    let drawn = items.iter().filter(|i| i.kind == ItemKind::Patch);
    let drawn = drawn.filter_map(|i| Some((i, &mesh.patches()[i.patch?])));
    let with_copies = |item: &'s Item, components: usize, mut values: Vec<f32>| {
        for &copy in &item.connections.copies {
            let at = copy as usize * components;
            values.extend_from_within(at..at + components);
        }
        PatchNumbers { item, components, values }
    };
    let global = |item: &Item, patch: &moldloft_mesh::Patch| -> Vec<u32> {
        if let Some(block) = &patch.block {
            return block.vertices.clone();
        }
        let count = item.positions.len() / 3 - item.connections.copies.len();
        let mut seen = rustc_hash::FxHashSet::default();
        let corners = mesh.faces()[patch.faces.clone()].iter().flatten();
        corners.copied().filter(|v| seen.insert(*v)).take(count).collect()
    };
    if field == "derivative" {
        let by = by.ok_or_else(|| {
            vec![Diagnostic::error("no-parameter", "a derivative is by a parameter")]
        })?;
        let jacobian = document.jacobian(&[by.to_string()])?;
        let column = &jacobian[0];
        let of_patch = |(item, patch): (&'s Item, &moldloft_mesh::Patch)| {
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
    let of_patch = |(item, patch): (&'s Item, &moldloft_mesh::Patch)| {
        let (components, values) = all.get(&patch.info.name)?;
        let wanted = item.positions.len() / 3 - item.connections.copies.len();
        (values.len() == wanted * components).then(|| {
            with_copies(item, *components, values.iter().map(|&x| x as f32).collect())
        })
    };
    Ok(drawn.filter_map(of_patch).collect())
}
