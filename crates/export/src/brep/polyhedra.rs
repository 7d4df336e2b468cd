//! Bodies of triangles as faces: connected coplanar triangles are one plane face.

use crate::ExportFailure;
use moldloft_brep::{Brep, BrepEdge, BrepFace, Coedge, SurfaceShape};
use moldloft_diag::Diagnostic;
use moldloft_mesh::Mesh;
use moldloft_num::Vec3;
use moldloft_picture::PALETTE;
use std::collections::HashMap;

/// Distance of vertices from a plane, relative to the size, within which they are in it.
const IN_PLANE: f64 = 1e-9;

/// The most triangles not connected with others in their plane, before a body counts as curved.
const MOST_ALONE: usize = 64;

/// Adds the faces of the body of that name.
///
/// # Errors
/// A body with curved faces.
pub fn add(brep: &mut Brep, mesh: &Mesh, name: &str, size: f64) -> Result<(), ExportFailure> {
    let body = MeshTriangles::of(mesh, name, size);
    let parts = body.plane_parts();
    let alone = parts.counts.iter().filter(|&&n| n == 1).count();
    if alone > MOST_ALONE && 3 * alone > parts.counts.len() {
        return Err(Diagnostic::error(
            "curved-body",
            format!("`{name}` has curved faces that exist only as triangles"),
        )
        .found(format!("{alone} triangles that share their plane with no other"))
        .help("write it as stl, 3mf or obj, or hide it; plane-faced sets, sketches and surfaces are written")
        .into());
    }
    let round = body.parts_round(&parts);
    let mut added = AddedEdges::default();
    for (border, (seed, normal)) in body.borders(&parts).into_iter().zip(&parts.seeds) {
        let loops = body.loops(border, &round, *normal);
        let Some(first) = loops.first() else { continue };
        let axis = (body.at(first[1]) - body.at(first[0])).normalized().unwrap_or_default();
        let axis = (axis - *normal * axis.dot(*normal)).normalized().unwrap_or_default();
        let origin = body.at(first[0]);
        let patch = &mesh.patches()[body.triangles[*seed].1].info;
        let loops = loops.iter().map(|cycle| added.sides(brep, &body, cycle)).collect();
        brep.faces.push(BrepFace {
            name: patch.name.clone(),
            colour: patch.colour.map(|c| PALETTE[usize::from(c & 15)]),
            layers: patch.tags.clone(),
            surface: SurfaceShape::Plane { origin, normal: *normal, axis },
            reversed: false,
            loops,
            error: body.near,
            exact: true,
            extent: None,
        });
        brep.gap = brep.gap.max(body.near);
    }
    Ok(())
}

/// The triangles of a body.
struct MeshTriangles<'a> {
    mesh: &'a Mesh,
    /// Corners, and the patch.
    triangles: Vec<([u32; 3], usize)>,
    /// The triangle to the left of each directed edge.
    across: HashMap<(u32, u32), usize>,
    size: f64,
    /// Distance within which a vertex is in a plane.
    near: f64,
}

/// Connected triangles in one plane, as parts.
#[derive(Default)]
struct PlaneParts {
    /// The part of each triangle.
    of: Vec<usize>,
    /// The largest triangle of each part, and its normal.
    seeds: Vec<(usize, Vec3)>,
    /// The number of triangles of each part.
    counts: Vec<usize>,
}

impl<'a> MeshTriangles<'a> {
    fn of(mesh: &'a Mesh, name: &str, size: f64) -> Self {
        let mut triangles: Vec<([u32; 3], usize)> = Vec::new();
        let prefix = format!("{name}.");
        for (p, patch) in mesh.patches().iter().enumerate() {
            if patch.info.name == name || patch.info.name.starts_with(&prefix) {
                for &[a, b, c, d] in &mesh.faces()[patch.faces.clone()] {
                    triangles.push(([a, b, c], p));
                    if d != c {
                        triangles.push(([a, c, d], p));
                    }
                }
            }
        }
        let mut across = HashMap::new();
        for (k, (t, _)) in triangles.iter().enumerate() {
            for i in 0..3 {
                across.insert((t[i], t[(i + 1) % 3]), k);
            }
        }
        Self { mesh, triangles, across, size, near: IN_PLANE * size }
    }

    fn at(&self, v: u32) -> Vec3 {
        self.mesh.positions()[v as usize]
    }

    /// Twice the area, along the normal.
    fn area(&self, k: usize) -> Vec3 {
        let [a, b, c] = self.triangles[k].0.map(|v| self.at(v));
        (b - a).cross(c - a)
    }

    /// Parts that grow from their largest triangles.
    fn plane_parts(&self) -> PlaneParts {
        let mut order: Vec<usize> = (0..self.triangles.len()).collect();
        order.sort_by(|&a, &b| self.area(b).norm().total_cmp(&self.area(a).norm()));
        let mut parts = PlaneParts { of: vec![usize::MAX; order.len()], ..PlaneParts::default() };
        for seed in order {
            if parts.of[seed] != usize::MAX {
                continue;
            }
            let normal = self.area(seed).normalized().unwrap_or_default();
            let count = self.grow(seed, normal, parts.seeds.len(), &mut parts.of);
            parts.seeds.push((seed, normal));
            parts.counts.push(count);
        }
        parts
    }

    /// Marks the triangles of a part, and counts them.
    fn grow(&self, seed: usize, normal: Vec3, part: usize, part_of: &mut [usize]) -> usize {
        let origin = self.at(self.triangles[seed].0[0]);
        let mut count = 0;
        let mut queue = vec![seed];
        part_of[seed] = part;
        while let Some(k) = queue.pop() {
            count += 1;
            let (t, patch) = self.triangles[k];
            for i in 0..3 {
                let Some(&other) = self.across.get(&(t[(i + 1) % 3], t[i])) else { continue };
                let (u, its) = self.triangles[other];
                let level = u.iter().all(|&v| (self.at(v) - origin).dot(normal).abs() <= self.near);
                // Slivers have no side of their own.
                let alike = self.area(other).dot(normal) >= -self.near * self.size;
                if part_of[other] == usize::MAX && its == patch && level && alike {
                    part_of[other] = part;
                    queue.push(other);
                }
            }
        }
        count
    }

    /// The parts around each vertex.
    fn parts_round(&self, parts: &PlaneParts) -> HashMap<u32, Vec<usize>> {
        let mut round: HashMap<u32, Vec<usize>> = HashMap::new();
        for ((t, _), part) in self.triangles.iter().zip(&parts.of) {
            for &v in t {
                let around = round.entry(v).or_default();
                if !around.contains(part) {
                    around.push(*part);
                }
            }
        }
        round
    }

    /// The directed edges at the border of each part, by their starts.
    fn borders(&self, parts: &PlaneParts) -> Vec<HashMap<u32, Vec<u32>>> {
        let mut borders: Vec<HashMap<u32, Vec<u32>>> = vec![HashMap::new(); parts.seeds.len()];
        for ((t, _), part) in self.triangles.iter().zip(&parts.of) {
            for i in 0..3 {
                let (a, b) = (t[i], t[(i + 1) % 3]);
                if self.across.get(&(b, a)).is_none_or(|&other| parts.of[other] != *part) {
                    borders[*part].entry(a).or_default().push(b);
                }
            }
        }
        borders
    }

    /// The loops of a border, the outer one first. A vertex of only two parts, on a straight line,
    /// is left out.
    fn loops(
        &self,
        border: HashMap<u32, Vec<u32>>,
        round: &HashMap<u32, Vec<usize>>,
        normal: Vec3,
    ) -> Vec<Vec<u32>> {
        let mut loops: Vec<(f64, Vec<u32>)> = Vec::new();
        for cycle in cycles(border) {
            let keep = |k: &usize| round[&cycle[*k]].len() > 2 || !self.is_straight(&cycle, *k);
            let kept: Vec<u32> = (0..cycle.len()).filter(keep).map(|k| cycle[k]).collect();
            if kept.len() < 3 {
                continue;
            }
            let o = self.at(kept[0]);
            let area = (1..kept.len() - 1)
                .map(|k| (self.at(kept[k]) - o).cross(self.at(kept[k + 1]) - o).dot(normal))
                .sum::<f64>();
            loops.push((area, kept));
        }
        // The outer loop has the largest area.
        loops.sort_by(|a, b| b.0.total_cmp(&a.0));
        loops.into_iter().map(|(_, cycle)| cycle).collect()
    }

    fn is_straight(&self, cycle: &[u32], k: usize) -> bool {
        let n = cycle.len();
        let [a, b, c] = [(k + n - 1) % n, k, (k + 1) % n].map(|k| self.at(cycle[k]));
        let d = (c - a).normalized().unwrap_or_default();
        ((b - a) - d * (b - a).dot(d)).norm() <= self.near
    }
}

/// Closed chains of directed edges.
fn cycles(mut next: HashMap<u32, Vec<u32>>) -> Vec<Vec<u32>> {
    let mut cycles = Vec::new();
    let mut starts: Vec<u32> = next.keys().copied().collect();
    starts.sort_unstable();
    for start in starts {
        while next.get(&start).is_some_and(|n| !n.is_empty()) {
            let mut cycle = vec![start];
            let mut v = start;
            while let Some(to) = next.get_mut(&v).and_then(Vec::pop) {
                if to == start {
                    break;
                }
                cycle.push(to);
                v = to;
            }
            cycles.push(cycle);
        }
    }
    cycles
}

/// The vertices and edges of the body that a boundary representation has by now.
#[derive(Default)]
struct AddedEdges {
    vertices: HashMap<u32, usize>,
    edges: HashMap<[usize; 2], usize>,
}

impl AddedEdges {
    /// The sides of a loop; adds those that are new.
    fn sides(&mut self, brep: &mut Brep, body: &MeshTriangles<'_>, cycle: &[u32]) -> Vec<Coedge> {
        let mut sides = Vec::new();
        for k in 0..cycle.len() {
            let ends = [cycle[k], cycle[(k + 1) % cycle.len()]];
            let [a, b] = ends.map(|v| {
                *self.vertices.entry(v).or_insert_with(|| {
                    brep.vertices.push(body.at(v));
                    brep.vertices.len() - 1
                })
            });
            let ends = [a.min(b), a.max(b)];
            let edge = *self.edges.entry(ends).or_insert_with(|| {
                let [p, q] = ends.map(|v| brep.vertices[v]);
                let curve = BrepEdge::segment(p, q);
                brep.edges.push(BrepEdge { ends, curve, ellipse: None });
                brep.edges.len() - 1
            });
            sides.push(Coedge { edge, forward: a < b, trace: None, alike: true });
        }
        sides
    }
}
