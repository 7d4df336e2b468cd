//! Patches whose shared vertices are one: numbers of vertices, free edges, sides, connectivity.

use crate::draft::indices;
use crate::join::Joiner;
use crate::notes::PanelNote;
use crate::orientation::{FreeEdge, Orientation};
use crate::topology::{EdgeRun, PanelTopology};
use moldloft_mesh::{MeshError, PatchInfo, Tag, Topology, TopologyBuilder};
use moldloft_num::Vec3;
use std::collections::HashMap;
use std::sync::Arc;

/// Difference of the positions of shared vertices, relative to the model's size, from which two
/// patches are reported.
const JOIN_ACCURACY: f64 = 1e-9;

/// Data that depend on a skeleton alone, except for the vertices that are their own images and the
/// orientation of panels.
#[derive(Debug)]
pub(crate) struct JoinedPatches {
    pub topology: Arc<Topology>,
    /// The vertex of each point of each patch; those that only patches without panels have come
    /// after the topology's.
    pub vertices: Vec<Vec<u32>>,
    pub count: u32,
    /// For each patch, which points of its boundary are their own images.
    pub fixed: Vec<Vec<bool>>,
    /// Panel edges with one panel: patch and the indices of both ends in its grid.
    pub free_edges: Vec<FreeEdge>,
    pub orientation: Orientation,
    /// For each patch, true if trimmed faces close its body, which is turned round thereby.
    turned_with_body: Vec<bool>,
    /// For each patch, true if its panels are opposite to its natural normal.
    pub turned: Vec<bool>,
}

impl JoinedPatches {
    /// Joins the vertices, numbers them and turns the panels.
    pub fn new(
        structure: &PanelTopology,
        points: &[Arc<Vec<Vec3>>],
        fixed: Vec<Vec<bool>>,
    ) -> Result<Self, MeshError> {
        let mut joiner = Joiner::new(structure);
        joiner.join_images(|patch, at| fixed[patch].get(at) == Some(&true));
        let Joiner { grids, mut joined, .. } = joiner;
        let mut number = vec![u32::MAX; grids.count() as usize];
        let mut count = 0u32;
        let mut used = 0;
        let mut vertices = vec![Vec::new(); structure.patches.len()];
        for meshed in [true, false] {
            for (patch, frame) in structure.patches.iter().enumerate() {
                if frame.meshed != meshed {
                    continue;
                }
                let numbered = grids.all(patch).map(|v| {
                    let number = &mut number[joined.find(v) as usize];
                    if *number == u32::MAX {
                        *number = count;
                        count += 1;
                    }
                    *number
                });
                vertices[patch] = numbered.collect();
            }
            if meshed {
                used = count;
            }
        }
        let free_edges = free_edges(structure, &vertices);
        let topology = Arc::default();
        let orientation = Orientation::new(structure, &vertices, &free_edges);
        let turned = orientation.turned(structure, points, &free_edges);
        let turned_with_body = vec![false; structure.patches.len()];
        let mut made = Self {
            topology,
            vertices,
            count,
            fixed,
            free_edges,
            orientation,
            turned_with_body,
            turned,
        };
        made.topology = made.numbered(structure, used as usize)?;
        Ok(made)
    }

    /// The panels of all patches.
    fn numbered(&self, structure: &PanelTopology, used: usize) -> Result<Arc<Topology>, MeshError> {
        let mut builder = TopologyBuilder::new();
        builder.add_vertices(used)?;
        for (patch, frame) in structure.patches.iter().enumerate() {
            let vertices = &self.vertices[patch];
            if !frame.meshed {
                continue;
            }
            let [nu, nv] = frame.divisions;
            let info = PatchInfo {
                name: frame.name.to_string(),
                tag: Tag::among(frame.tags.iter().map(|t| &**t)),
                tags: frame.tags.iter().map(|t| t.to_string()).collect(),
                colour: Some((frame.colour & 15) as u8),
                kind: frame.kind.to_string(),
            };
            builder.add_block(info, nu + 1, nv + 1, vertices.clone(), self.turned[patch])?;
        }
        Ok(builder.build().into())
    }

    /// The same with some patches turned round, with the bodies that trimmed faces close.
    pub fn turned_round(
        &self,
        structure: &PanelTopology,
        round: &[bool],
    ) -> Result<Self, MeshError> {
        let both = |all: &[bool]| all.iter().zip(round).map(|(a, b)| a != b).collect();
        let mut made = Self {
            topology: Arc::default(),
            vertices: self.vertices.clone(),
            count: self.count,
            fixed: self.fixed.clone(),
            free_edges: self.free_edges.clone(),
            orientation: self.orientation.clone(),
            turned_with_body: both(&self.turned_with_body),
            turned: both(&self.turned),
        };
        made.topology = made.numbered(structure, self.topology.vertex_count())?;
        Ok(made)
    }

    pub fn orientation(&self, structure: &PanelTopology, points: &[Arc<Vec<Vec3>>]) -> Vec<bool> {
        let turned = self.orientation.turned(structure, points, &self.free_edges);
        turned.iter().zip(&self.turned_with_body).map(|(a, b)| a != b).collect()
    }

    /// The pairs of patches whose shared vertices do not coincide.
    pub fn apart(
        &self,
        structure: &PanelTopology,
        points: &[Arc<Vec<Vec3>>],
        size: f64,
    ) -> Vec<PanelNote> {
        const NONE: u32 = u32::MAX;
        let mut owner: Vec<(u32, Vec3)> = vec![(NONE, Vec3::zero()); self.count as usize];
        let mut worst: HashMap<(u32, u32), (f64, Vec3)> = HashMap::new();
        let allowed = self.allowed(structure);
        for (patch, frame) in structure.patches.iter().enumerate() {
            for k in (0..4).flat_map(|k| indices(frame.divisions, k)) {
                let p = points[patch][k];
                let slot = &mut owner[self.vertices[patch][k] as usize];
                if slot.0 == NONE {
                    *slot = (patch as u32, p);
                }
                let distance = p.distance(slot.1);
                let near = allowed.get(&self.vertices[patch][k]).copied().unwrap_or(0.0);
                if distance > (JOIN_ACCURACY * size).max(near) {
                    let entry = worst.entry((slot.0, patch as u32)).or_insert((0.0, p));
                    if distance > entry.0 {
                        *entry = (distance, p);
                    }
                }
            }
        }
        let mut worst: Vec<_> = worst.into_iter().collect();
        worst.sort_by_key(|(pair, _)| *pair);
        let name = |patch: u32| structure.patches[patch as usize].name.to_string();
        worst
            .into_iter()
            .map(|((a, b), (distance, at))| {
                let patches = [name(a), name(b)];
                PanelNote::Apart { patches, distance, at }
            })
            .collect()
    }
}

impl JoinedPatches {
    /// Maximum distance of the positions of vertices on declared joins.
    fn allowed(&self, structure: &PanelTopology) -> HashMap<u32, f64> {
        let mut allowed: HashMap<u32, f64> = HashMap::new();
        if structure.declared.is_empty() {
            return allowed;
        }
        let declared: HashMap<_, f64> = structure.declared.iter().copied().collect();
        for (patch, frame) in structure.patches.iter().enumerate() {
            for (k, run) in frame.runs.iter().enumerate() {
                let EdgeRun::Along(spans) = run else { continue };
                let tolerances =
                    spans.iter().filter_map(|(span, _)| declared.get(&span.interval?).copied());
                let Some(near) = tolerances.reduce(f64::max) else { continue };
                for at in indices(frame.divisions, k as u8) {
                    let slot = allowed.entry(self.vertices[patch][at]).or_insert(0.0);
                    *slot = slot.max(near);
                }
            }
        }
        allowed
    }
}

/// The panel edges at the rims of patches that have one panel, in the order of their vertices.
fn free_edges(structure: &PanelTopology, vertices: &[Vec<u32>]) -> Vec<FreeEdge> {
    let mut all: Vec<((u32, u32), FreeEdge)> = Vec::new();
    for (patch, frame) in structure.patches.iter().enumerate().filter(|(_, f)| f.meshed) {
        for k in 0..4 {
            let mut before: Option<usize> = None;
            for at in indices(frame.divisions, k) {
                if let Some(last) = before {
                    let (a, b) = (vertices[patch][last], vertices[patch][at]);
                    if a != b {
                        let places = (patch as u32, last as u32, at as u32);
                        all.push(((a.min(b), a.max(b)), places));
                    }
                }
                before = Some(at);
            }
        }
    }
    all.sort_unstable();
    let alone = all.chunk_by(|a, b| a.0 == b.0).filter(|run| run.len() == 1);
    alone.map(|run| run[0].1).collect()
}
