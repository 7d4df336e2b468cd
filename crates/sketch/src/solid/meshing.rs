//! A body as a mesh: chords of its round edges, facets of its faces.

use super::curve::SmoothPiece;
use super::surface::FaceSurface;
use super::{CombinedMesh, Quick, SketchSolid, SolidFace, outline};
use moldloft_mesh::{Mesh, PatchInfo, TopologyBuilder, triangulate};
use moldloft_num::{Real, Vec3};
use std::collections::HashMap;

impl<T: Real> SketchSolid<T> {
    /// Number of chords per edge: that of its curve if requested, otherwise `usual`; opposite sides
    /// of a patch agree.
    fn chords(&self, usual: &dyn Fn(&SmoothPiece<T>) -> usize, asked: bool) -> Vec<usize> {
        let mut chords: Vec<usize> = (self.edges.iter())
            .map(|e| match (e.piece, e.curve.filter(|_| asked).and_then(|c| self.steps.get(&c))) {
                (None, _) => 1,
                (Some(_), Some(&steps)) => steps.clamp(1, 720) as usize,
                (Some(piece), None) => usual(&piece),
            })
            .collect();
        loop {
            let mut changed = false;
            let patch = |f: &&SolidFace| (f.ruled || f.trim.is_some()) && f.loops[0].len() == 4;
            for face in self.faces.iter().filter(patch) {
                for [a, b] in [[0, 2], [1, 3]].map(|p| p.map(|k: usize| face.loops[0][k].0)) {
                    let most = chords[a].max(chords[b]);
                    changed |= chords[a] != chords[b];
                    (chords[a], chords[b]) = (most, most);
                }
            }
            if !changed {
                return chords;
            }
        }
    }

    /// A mesh of triangles and quads within `tolerance` of curves and round faces; the faces are
    /// its patches. Curves with a given number of steps keep it.
    pub fn mesh(&self, tolerance: f64) -> Mesh<T> {
        if let Some(facets) = &self.facets {
            return self.mesh_from_facets(&self.finer(facets, tolerance));
        }
        // The error of facets of doubly curved faces is the sum of the errors of chords in both
        // directions.
        let bent = self.trims.iter().any(|t| match &t.surface {
            FaceSurface::Turned { profile, .. } => profile.chords(tolerance) > 1,
            FaceSurface::Ruled { .. } | FaceSurface::Plane { .. } => false,
        });
        let share = if bent { 0.5 * tolerance } else { tolerance };
        self.mesh_of(self.chords(&|piece| piece.chords(share), true))
    }

    /// As `mesh`, with a chord for each 5° of a round curve and 20 for each cubic, as in 1983: the
    /// number of triangles is independent of size.
    pub fn faceted(&self) -> Mesh<T> {
        self.mesh_of(self.chords(&by_angle, true))
    }

    /// Chords per edge, one for each 5° of a round curve, each cut in three that many times.
    pub(super) fn angular_chords(&self, times: u32) -> Vec<usize> {
        let more = 3usize.pow(times);
        self.chords(
            &|piece| match piece {
                SmoothPiece::Cubic(_) if by_angle(piece) == 1 => 1,
                _ => by_angle(piece) * more,
            },
            false,
        )
    }

    fn mesh_of(&self, chords: Vec<usize>) -> Mesh<T> {
        if let Some(facets) = &self.facets {
            return self.mesh_from_facets(facets);
        }
        let mut places: Vec<Vec3<T>> = self.vertices.iter().map(|v| v.at).collect();
        let mut inner: Vec<Vec<u32>> = Vec::new();
        for (e, &n) in chords.iter().enumerate() {
            let piece = self.piece((e, true));
            let own = (1..n).map(|k| {
                places.push(piece.at(T::from(k as f64 / n as f64)));
                places.len() as u32 - 1
            });
            inner.push(own.collect());
        }
        let run = |(e, forward): (usize, bool)| -> Vec<u32> {
            let [a, b] = self.edges[e].ends.map(|v| v as u32);
            let mut way: Vec<u32> =
                [a].into_iter().chain(inner[e].iter().copied()).chain([b]).collect();
            if !forward {
                way.reverse();
            }
            way
        };
        let mut parts: Vec<(String, Vec<[u32; 4]>)> = Vec::new();
        for (k, face) in self.faces.iter().enumerate() {
            parts.push((self.face_name(k), self.facets(face, &run, &mut places)));
        }
        mesh_from(places, parts)
    }

    fn mesh_from_facets(&self, facets: &CombinedMesh<T>) -> Mesh<T> {
        let named = facets.faces.iter().enumerate().map(|(k, triangles)| {
            let corners = triangles.iter().map(|&[a, b, c]| [a, b, c, c]).collect();
            (self.face_name(k), corners)
        });
        mesh_from(facets.points.clone(), named.collect())
    }

    fn face_name(&self, k: usize) -> String {
        self.faces[k].id.map_or_else(|| format!("patch {}", k + 1), |f| format!("face {f}"))
    }

    fn facets(
        &self,
        face: &SolidFace,
        run: &dyn Fn((usize, bool)) -> Vec<u32>,
        places: &mut Vec<Vec3<T>>,
    ) -> Vec<[u32; 4]> {
        if let Some(trim) = face.trim {
            let even = |h: (usize, bool)| {
                let n = run(h).len() - 1;
                (0..=n).map(|k| k as f64 / n as f64).collect()
            };
            return outline::patch(&self.trims[trim].surface, &face.loops[0], run, &even, places);
        }
        if face.ruled {
            let cycle = &face.loops[0];
            let near = run(cycle[0]);
            return match cycle[..] {
                [_, right, far, left] => {
                    let mut far = run(far);
                    far.reverse();
                    let (mut left, right) = (run(left), run(right));
                    left.reverse();
                    self.grid([&near, &far, &left, &right], places)
                }
                [_, out, _] => {
                    let apex = self.edges[out.0].ends[usize::from(out.1)] as u32;
                    near.windows(2).map(|w| [w[0], w[1], apex, apex]).collect()
                }
                _ => vec![],
            };
        }
        let loops: Vec<Vec<usize>> = (face.loops.iter())
            .map(|cycle| {
                let way = cycle.iter().flat_map(|&h| {
                    let mut way = run(h);
                    way.pop();
                    way
                });
                way.map(|v| v as usize).collect()
            })
            .collect();
        let flat = |v: usize| places[v].re();
        let mut normal = Vec3::zero();
        for cycle in &loops {
            let first = flat(cycle[0]);
            for k in 0..cycle.len() {
                let (p, q) = (flat(cycle[k]), flat(cycle[(k + 1) % cycle.len()]));
                normal += (p - first).cross(q - first);
            }
        }
        let used: Vec<usize> = loops.iter().flatten().copied().collect();
        let points: Vec<Vec3> = used.iter().map(|&v| flat(v)).collect();
        // A vertex common to two cycles has the same first index in both, so that it stays one.
        let mut first: HashMap<usize, usize, Quick> = HashMap::default();
        for (k, &v) in used.iter().enumerate() {
            first.entry(v).or_insert(k);
        }
        let loops: Vec<Vec<usize>> =
            loops.iter().map(|c| c.iter().map(|v| first[v]).collect()).collect();
        triangulate(&points, &loops, normal)
            .into_iter()
            .map(|t| t.map(|k| used[k] as u32))
            .map(|[a, b, c]| [a, b, c, c])
            .collect()
    }

    /// Quads between two runs of equal length; `left` and `right` lead from near to far.
    fn grid(
        &self,
        [near, far, left, right]: [&Vec<u32>; 4],
        places: &mut Vec<Vec3<T>>,
    ) -> Vec<[u32; 4]> {
        let (n, m) = (near.len(), left.len());
        if far.len() != n || right.len() != m {
            return vec![];
        }
        let mut rows = vec![near.clone()];
        for j in 1..m - 1 {
            let t = T::from(j as f64 / (m - 1) as f64);
            let mut row = vec![left[j]];
            for i in 1..n - 1 {
                places.push(places[near[i] as usize].lerp(places[far[i] as usize], t));
                row.push(places.len() as u32 - 1);
            }
            row.push(right[j]);
            rows.push(row);
        }
        rows.push(far.clone());
        let mut quads = Vec::new();
        for w in rows.windows(2) {
            for i in 0..n - 1 {
                quads.push([w[0][i], w[0][i + 1], w[1][i + 1], w[1][i]]);
            }
        }
        quads
    }
}

fn mesh_from<T: Real>(places: Vec<Vec3<T>>, parts: Vec<(String, Vec<[u32; 4]>)>) -> Mesh<T> {
    let mut topology = TopologyBuilder::new();
    // Both fit: the counts are those of the builder itself.
    let _ = topology.add_vertices(places.len());
    for (name, facets) in parts {
        let _ = topology.add_faces(PatchInfo::new(name), facets);
    }
    let empty = || Mesh::new(TopologyBuilder::new().build().into(), vec![]);
    match Mesh::new(topology.build().into(), places).or_else(|_| empty()) {
        Ok(mesh) => mesh,
        Err(_) => unreachable!("an empty mesh fits its topology"),
    }
}

/// A chord for each 5° of a round curve, 20 for a cubic that is not straight.
pub(super) fn by_angle<T: Real>(piece: &SmoothPiece<T>) -> usize {
    match piece {
        SmoothPiece::Conic { sweep, .. } => {
            let n = (sweep.re().abs().to_degrees() / 5.0 - 1e-9).ceil();
            if n.is_finite() { (n as usize).clamp(1, 720) } else { 1 }
        }
        SmoothPiece::Cubic(_) => 20,
    }
}
