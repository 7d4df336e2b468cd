//! Render buffers of a patch: vertices, normals, triangles, panel edges and rim.
//! Patches do not share vertices, so that shading and colours are not interpolated across a rim. A
//! vertex at a crease has one copy per normal of the panels around it.

use moldloft_mesh::{Mesh, Patch, is_triangle};
use moldloft_num::Vec3;
use rustc_hash::FxHashMap;
use std::sync::Arc;

/// Cosine of 40 degrees: a sharper turn between panels is a crease.
const CREASE: f64 = 0.766;

/// Cosine of 20 degrees: panels within this angle of one normal are within the crease angle of each
/// other.
const HALF_CREASE: f64 = 0.94;

/// Connectivity of a patch, unchanged while it moves.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Connections {
    /// Corners of the triangles.
    pub triangles: Vec<u32>,
    /// Vertex pairs of panel edges inside the patch.
    pub edges: Vec<u32>,
    /// Vertex pairs of panel edges along its rim.
    pub rim: Vec<u32>,
    /// For each copied vertex its original; copies come last.
    pub copies: Vec<u32>,
}

/// Render buffers of panels in one state.
#[derive(Clone)]
pub struct PatchBuffers {
    /// Positions.
    pub points: Vec<Vec3>,
    /// Unit normals, outward.
    pub normals: Vec<Vec3>,
    /// Connectivity; the same allocation while it does not change.
    pub connections: Arc<Connections>,
}

/// Panels with patch-local vertices.
struct Local {
    /// Index in the mesh of each vertex.
    global: Vec<u32>,
    faces: Vec<[u32; 4]>,
}

impl Local {
    fn new(mesh: &Mesh, patch: &Patch) -> Self {
        let faces = &mesh.faces()[patch.faces.clone()];
        // Grid order of a structured patch, in which fields have their values.
        if let Some(block) = &patch.block {
            let mut own = Vec::with_capacity(faces.len());
            for i in 0..block.nu.saturating_sub(1) {
                for j in 0..block.nv.saturating_sub(1) {
                    let at = |i: usize, j: usize| (i * block.nv + j) as u32;
                    let mut corners = vec![at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                    if block.reversed {
                        corners.swap(1, 3);
                    }
                    let same =
                        |a: u32, b: u32| block.vertices[a as usize] == block.vertices[b as usize];
                    corners.dedup_by(|b, a| same(*a, *b));
                    if corners.len() > 1 && same(corners[0], corners[corners.len() - 1]) {
                        corners.pop();
                    }
                    match corners[..] {
                        [a, b, c, d] => own.push([a, b, c, d]),
                        [a, b, c] => own.push([a, b, c, c]),
                        _ => {}
                    }
                }
            }
            return Self { global: block.vertices.clone(), faces: own };
        }
        let mut number = FxHashMap::default();
        let mut global = Vec::new();
        let mut own = Vec::with_capacity(faces.len());
        for face in faces {
            own.push(face.map(|v| {
                *number.entry(v).or_insert_with(|| {
                    global.push(v);
                    global.len() as u32 - 1
                })
            }));
        }
        Self { global, faces: own }
    }
}

/// A patch of a topology, prepared for any positions of its vertices.
pub struct PreparedPatch {
    global: Vec<u32>,
    panels: Prepared,
}

impl PreparedPatch {
    /// Prepares a patch.
    pub fn new(mesh: &Mesh, patch: &Patch) -> Self {
        let local = Local::new(mesh, patch);
        // Patch-local indices of vertex identities.
        let mut number = FxHashMap::default();
        let identity: Vec<u32> = local
            .global
            .iter()
            .map(|v| {
                let next = number.len() as u32;
                *number.entry(*v).or_insert(next)
            })
            .collect();
        Self { panels: Prepared::new(local.faces, identity), global: local.global }
    }

    /// The positions of its vertices in a mesh of its topology.
    pub fn points(&self, mesh: &Mesh) -> Vec<Vec3> {
        self.global.iter().map(|&v| mesh.positions()[v as usize]).collect()
    }

    /// Render buffers for these positions.
    pub fn drawn(&mut self, points: &[Vec3]) -> PatchBuffers {
        self.panels.drawn(points.to_vec())
    }
}

/// Panels, prepared for any positions of their vertices.
pub struct Prepared {
    faces: Vec<[u32; 4]>,
    /// Identity of each vertex; vertices with the same identity share a normal.
    identity: Vec<u32>,
    /// Number of identities.
    count: usize,
    /// Connectivity of the last buffers.
    known: Arc<Connections>,
}

impl Prepared {
    /// Panels of vertices whose identities are numbered from 0.
    pub fn new(faces: Vec<[u32; 4]>, identity: Vec<u32>) -> Self {
        let count = identity.iter().copied().max().map_or(0, |v| v as usize + 1);
        let mut known = Connections::default();
        sides(&faces, &identity, &mut known);
        Self { faces, identity, count, known: Arc::new(known) }
    }

    /// Render buffers for these positions.
    pub fn drawn(&mut self, mut points: Vec<Vec3>) -> PatchBuffers {
        let turned = |f: &[u32; 4]| {
            let [a, b, c, d] = f.map(|v| points[v as usize]);
            (c - a).cross(d - b)
        };
        let flat: Vec<Vec3> = self.faces.iter().map(turned).collect();
        let unit: Vec<Option<Vec3>> = flat.iter().map(|n| n.normalized()).collect();
        let mut sums = vec![Vec3::zero(); self.count];
        for (face, normal) in self.faces.iter().zip(&flat) {
            for &v in corners(face) {
                sums[self.identity[v as usize] as usize] += *normal;
            }
        }
        let mut normals: Vec<Vec3> = self
            .identity
            .iter()
            .map(|&v| sums[v as usize].normalized().unwrap_or(Vec3::of(0.0, 0.0, 1.0)))
            .collect();
        // Panels around a vertex share its normal unless one turns by more than the crease angle.
        let mut creased = vec![false; self.count];
        for (face, unit) in self.faces.iter().zip(&unit) {
            for &v in corners(face) {
                let sharp = unit.is_some_and(|n| n.dot(normals[v as usize]) < HALF_CREASE);
                creased[self.identity[v as usize] as usize] |= sharp;
            }
        }
        let mut around: Vec<Vec<u32>> = vec![Vec::new(); self.count];
        for (k, face) in self.faces.iter().enumerate() {
            for &v in corners(face) {
                let at = self.identity[v as usize] as usize;
                if creased[at] {
                    around[at].push(k as u32);
                }
            }
        }
        let unit_at = |k: u32| unit[k as usize];
        let own = points.len() as u32;
        let mut copies: Vec<u32> = Vec::new();
        let mut made: FxHashMap<(u32, [u64; 3]), u32> = FxHashMap::default();
        let mut triangles = Vec::with_capacity(6 * self.faces.len());
        for (face, unit) in self.faces.iter().zip(&unit) {
            let mut drawn = *face;
            for v in &mut drawn[..corners(face).len()] {
                let at = *v;
                let near = &around[self.identity[at as usize] as usize];
                let Some(unit) = unit.filter(|_| !near.is_empty()) else { continue };
                // The panels at this vertex within the crease angle of this one.
                let sum = near
                    .iter()
                    .filter(|&&k| unit_at(k).is_some_and(|n| n.dot(unit) >= CREASE))
                    .fold(Vec3::zero(), |sum, &k| sum + flat[k as usize]);
                let normal = sum.normalized().unwrap_or(unit);
                let bits = normal.to_array().map(f64::to_bits);
                *v = *made.entry((at, bits)).or_insert_with(|| {
                    copies.push(at);
                    points.push(points[at as usize]);
                    normals.push(normal);
                    own + copies.len() as u32 - 1
                });
            }
            let [a, b, c, d] = drawn;
            triangles.extend([a, b, c]);
            if !is_triangle(*face) {
                triangles.extend([a, c, d]);
            }
        }
        if self.known.triangles != triangles || self.known.copies != copies {
            let (edges, rim) = (self.known.edges.clone(), self.known.rim.clone());
            self.known = Arc::new(Connections { triangles, edges, rim, copies });
        }
        PatchBuffers { points, normals, connections: self.known.clone() }
    }
}

fn corners(face: &[u32; 4]) -> &[u32] {
    if is_triangle(*face) { &face[..3] } else { face }
}

/// The panel edges: those of a single panel are the rim, the others inside.
fn sides(faces: &[[u32; 4]], identity: &[u32], connections: &mut Connections) {
    let mut all: Vec<([u32; 2], [u32; 2])> = Vec::with_capacity(4 * faces.len());
    for face in faces {
        let corners = corners(face);
        for (k, &a) in corners.iter().enumerate() {
            let b = corners[(k + 1) % corners.len()];
            let (p, q) = (identity[a as usize], identity[b as usize]);
            all.push(([p.min(q), p.max(q)], [a, b]));
        }
    }
    all.sort_unstable();
    for run in all.chunk_by(|a, b| a.0 == b.0) {
        let into = if run.len() == 1 { &mut connections.rim } else { &mut connections.edges };
        into.extend(run[0].1);
    }
}

/// A number for each patch, usually below six, that differs from those of adjacent patches, for
/// distinct colours. It does not change when later patches are added.
pub fn hues(mesh: &Mesh) -> Vec<u8> {
    let mut owner: FxHashMap<[u32; 2], u32> = FxHashMap::default();
    let patches = mesh.patches();
    let mut neighbours: Vec<Vec<u32>> = vec![Vec::new(); patches.len()];
    for (k, patch) in patches.iter().enumerate() {
        for face in &mesh.faces()[patch.faces.clone()] {
            let corners = corners(face);
            for (at, &a) in corners.iter().enumerate() {
                let b = corners[(at + 1) % corners.len()];
                let before = owner.insert([a.min(b), a.max(b)], k as u32);
                if let Some(other) = before.filter(|&o| o != k as u32)
                    && !neighbours[k].contains(&other)
                {
                    neighbours[k].push(other);
                    neighbours[other as usize].push(k as u32);
                }
            }
        }
    }
    let mut hues: Vec<u8> = Vec::with_capacity(patches.len());
    for near in &neighbours {
        let taken = |hue: u8| near.iter().any(|&o| hues.get(o as usize) == Some(&hue));
        hues.push((0..=u8::MAX).find(|&h| !taken(h)).unwrap_or(0));
    }
    hues
}

#[cfg(test)]
mod tests {
    use super::*;
    use moldloft_mesh::{PatchInfo, TopologyBuilder};

    /// A cube of one patch: eight vertices, six panels.
    fn cube() -> Mesh {
        let mut builder = TopologyBuilder::new();
        builder.add_vertices(8).unwrap();
        let faces =
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        builder.add_faces(PatchInfo::new("cube"), faces.to_vec()).unwrap();
        let at = |k: usize| Vec3::of((k & 1) as f64, (k >> 1 & 1) as f64, (k >> 2) as f64);
        Mesh::new(builder.build().into(), (0..8).map(at).collect()).unwrap()
    }

    #[test]
    fn creases_are_sharp() {
        let cube = cube();
        let mut patch = PreparedPatch::new(&cube, &cube.patches()[0]);
        let points = patch.points(&cube);
        let drawn = patch.drawn(&points);
        // Unchanged entries are identical.
        assert!(Arc::ptr_eq(&patch.drawn(&points).connections, &drawn.connections));
        // Every corner turns by more than 40 degrees from each of its faces.
        assert_eq!(drawn.points.len(), 8 + 24);
        assert_eq!(drawn.connections.triangles.len(), 36);
        for t in drawn.connections.triangles.chunks(3) {
            let [a, b, c] = [t[0], t[1], t[2]].map(|v| v as usize);
            let p = &drawn.points;
            let flat = (p[b] - p[a]).cross(p[c] - p[a]).normalized().unwrap();
            for v in [a, b, c] {
                assert!(drawn.normals[v].distance(flat) < 1e-12);
            }
        }
        assert_eq!((drawn.connections.edges.len(), drawn.connections.rim.len()), (24, 0));
    }

    #[test]
    fn planes_that_meet_at_a_crease_are_even() {
        // A long slab and a low step at its end: the large plane outweighs the small one, and neither is tilted.
        let mut builder = TopologyBuilder::new();
        builder.add_vertices(6).unwrap();
        builder.add_faces(PatchInfo::new("step"), vec![[0, 1, 3, 2], [2, 3, 5, 4]]).unwrap();
        let points = [
            Vec3::of(0.0, 0.0, 0.0),
            Vec3::of(0.0, 1.0, 0.0),
            Vec3::of(100.0, 0.0, 0.0),
            Vec3::of(100.0, 1.0, 0.0),
            Vec3::of(100.0, 0.0, 0.1),
            Vec3::of(100.0, 1.0, 0.1),
        ];
        let step = Mesh::new(builder.build().into(), points.to_vec()).unwrap();
        let mut patch = PreparedPatch::new(&step, &step.patches()[0]);
        let drawn = patch.drawn(&patch.points(&step));
        let p = &drawn.points;
        for t in drawn.connections.triangles.chunks(3) {
            let [a, b, c] = [t[0], t[1], t[2]].map(|v| v as usize);
            let flat = (p[b] - p[a]).cross(p[c] - p[a]).normalized().unwrap();
            assert!([a, b, c].iter().all(|&v| drawn.normals[v].distance(flat) < 1e-12));
        }
    }

    #[test]
    fn neighbours_have_different_hues() {
        let mut builder = TopologyBuilder::new();
        builder.add_vertices(8).unwrap();
        for k in 0..3u32 {
            let name = format!("p{k}");
            let vertices = vec![2 * k, 2 * k + 1, 2 * k + 2, 2 * k + 3];
            builder.add_block(PatchInfo::new(name), 2, 2, vertices, false).unwrap();
        }
        let points = (0..8).map(|k| Vec3::of((k / 2) as f64, (k % 2) as f64, 0.0)).collect();
        let strip = Mesh::new(builder.build().into(), points).unwrap();
        assert_eq!(hues(&strip), [0, 1, 0]);
    }
}
