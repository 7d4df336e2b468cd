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
    let mut triangles: Vec<([u32; 3], usize)> = Vec::new();
    let prefix = format!("{name}.");
    for (p, patch) in mesh.patches().iter().enumerate() {
        if patch.info.name == name || patch.info.name.starts_with(&prefix) {
            let faces = &mesh.faces()[patch.faces.clone()];
            for &[a, b, c, d] in faces {
                triangles.push(([a, b, c], p));
                if d != c {
                    triangles.push(([a, c, d], p));
                }
            }
        }
    }
    let at = |v: u32| mesh.positions()[v as usize];
    let near = IN_PLANE * size;
    let area = |t: &[u32; 3]| (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0]));
    let mut across: HashMap<(u32, u32), usize> = HashMap::new();
    for (k, (t, _)) in triangles.iter().enumerate() {
        for i in 0..3 {
            across.insert((t[i], t[(i + 1) % 3]), k);
        }
    }
    // Grow each face from its largest triangle.
    let mut order: Vec<usize> = (0..triangles.len()).collect();
    order.sort_by(|&a, &b| area(&triangles[b].0).norm().total_cmp(&area(&triangles[a].0).norm()));
    let mut face_of = vec![usize::MAX; triangles.len()];
    let mut seeds: Vec<(usize, Vec3)> = Vec::new();
    let mut counts = Vec::new();
    for k in order {
        if face_of[k] != usize::MAX {
            continue;
        }
        let face = seeds.len();
        let normal = area(&triangles[k].0).normalized().unwrap_or_default();
        let origin = at(triangles[k].0[0]);
        seeds.push((k, normal));
        let mut count = 0;
        let mut queue = vec![k];
        face_of[k] = face;
        while let Some(k) = queue.pop() {
            count += 1;
            let (t, patch) = triangles[k];
            for i in 0..3 {
                let Some(&other) = across.get(&(t[(i + 1) % 3], t[i])) else { continue };
                let (u, its) = triangles[other];
                let level = u.iter().all(|&v| (at(v) - origin).dot(normal).abs() <= near);
                // Slivers have no side of their own.
                let alike = area(&u).dot(normal) >= -near * size;
                if face_of[other] == usize::MAX && its == patch && level && alike {
                    face_of[other] = face;
                    queue.push(other);
                }
            }
        }
        counts.push(count);
    }
    let alone = counts.iter().filter(|&&n| n == 1).count();
    if alone > MOST_ALONE && 3 * alone > counts.len() {
        return Err(Diagnostic::error(
            "curved-body",
            format!("`{name}` has curved faces that exist only as triangles"),
        )
        .found(format!("{alone} triangles in planes of their own"))
        .help("write it as stl, 3mf or obj, or hide it; plane-faced sets, sketches and surfaces are written")
        .into());
    }
    let base = |v: u32, brep: &mut Brep, known: &mut HashMap<u32, usize>| {
        *known.entry(v).or_insert_with(|| {
            brep.vertices.push(at(v));
            brep.vertices.len() - 1
        })
    };
    // A vertex of only two faces, on a straight line, is left out.
    let mut round: HashMap<u32, Vec<usize>> = HashMap::new();
    for (k, (t, _)) in triangles.iter().enumerate() {
        for &v in t {
            let faces = round.entry(v).or_default();
            if !faces.contains(&face_of[k]) {
                faces.push(face_of[k]);
            }
        }
    }
    let mut vertices = HashMap::new();
    let mut edges: HashMap<(usize, usize), usize> = HashMap::new();
    let mut borders: Vec<HashMap<u32, Vec<u32>>> = vec![HashMap::new(); seeds.len()];
    for (k, (t, _)) in triangles.iter().enumerate() {
        for i in 0..3 {
            let (a, b) = (t[i], t[(i + 1) % 3]);
            let inside = across.get(&(b, a)).is_some_and(|&o| face_of[o] == face_of[k]);
            if !inside {
                borders[face_of[k]].entry(a).or_default().push(b);
            }
        }
    }
    for (face, (seed, normal)) in seeds.iter().enumerate() {
        let patch = &mesh.patches()[triangles[*seed].1].info;
        let mut cycles: Vec<Vec<u32>> = Vec::new();
        let next = &mut borders[face];
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
        let straight = |cycle: &[u32], k: usize| {
            let n = cycle.len();
            let [a, b, c] = [cycle[(k + n - 1) % n], cycle[k], cycle[(k + 1) % n]].map(at);
            let d = (c - a).normalized().unwrap_or_default();
            ((b - a) - d * (b - a).dot(d)).norm() <= near
        };
        let mut loops: Vec<(f64, Vec<u32>)> = Vec::new();
        for cycle in cycles {
            let keep = |k: &usize| round[&cycle[*k]].len() > 2 || !straight(&cycle, *k);
            let kept: Vec<u32> = (0..cycle.len()).filter(keep).map(|k| cycle[k]).collect();
            if kept.len() < 3 {
                continue;
            }
            let o = at(kept[0]);
            let sum = (1..kept.len() - 1)
                .map(|k| (at(kept[k]) - o).cross(at(kept[k + 1]) - o).dot(*normal))
                .sum::<f64>();
            loops.push((sum, kept));
        }
        // The outer loop has the largest area.
        loops.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut made = Vec::new();
        for (_, cycle) in &loops {
            let mut sides = Vec::new();
            for k in 0..cycle.len() {
                let ends = [cycle[k], cycle[(k + 1) % cycle.len()]];
                let [a, b] = ends.map(|v| base(v, brep, &mut vertices));
                let edge = *edges.entry((a.min(b), a.max(b))).or_insert_with(|| {
                    let [p, q] = [a.min(b), a.max(b)].map(|v| brep.vertices[v]);
                    let ends = [a.min(b), a.max(b)];
                    brep.edges.push(BrepEdge {
                        ends,
                        curve: BrepEdge::segment(p, q),
                        ellipse: None,
                    });
                    brep.edges.len() - 1
                });
                sides.push(Coedge { edge, forward: a < b, trace: None, alike: true });
            }
            made.push(sides);
        }
        let Some((_, first)) = loops.first() else { continue };
        let axis = (at(first[1]) - at(first[0])).normalized().unwrap_or_default();
        let axis = (axis - *normal * axis.dot(*normal)).normalized().unwrap_or_default();
        brep.faces.push(BrepFace {
            name: patch.name.clone(),
            colour: patch.colour.map(|c| PALETTE[usize::from(c & 15)]),
            layers: patch.tags.clone(),
            surface: SurfaceShape::Plane { origin: at(first[0]), normal: *normal, axis },
            reversed: false,
            loops: made,
            error: near,
            exact: true,
            extent: None,
        });
        brep.gap = brep.gap.max(near);
    }
    Ok(())
}
