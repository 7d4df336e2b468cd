//! The directed sides of the faces, matched by their pair of vertices.

use crate::{Topology, is_triangle};

/// A side of a face, from one corner to the next in the face's own direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct HalfEdge {
    pub from: u32,
    pub to: u32,
    /// Four times the face plus the corner `from`.
    pub corner: u32,
}

impl HalfEdge {
    pub fn face(self) -> usize {
        self.corner as usize / 4
    }

    /// The corner of the same face at `to`.
    pub fn next_corner(self, faces: &[[u32; 4]]) -> u32 {
        let sides = if is_triangle(faces[self.face()]) { 3 } else { 4 };
        let base = self.corner & !3;
        base + (self.corner - base + 1) % sides
    }

    fn ends(self) -> (u32, u32) {
        (self.from.min(self.to), self.from.max(self.to))
    }
}

/// All half edges, those between the same two vertices next to each other; edges ordered by their
/// lower vertex, then their higher one; within an edge by face.
///
/// A counting sort by the lower vertex and small sorts inside: linear time for bounded valence.
pub(crate) fn half_edges(topology: &Topology) -> Vec<HalfEdge> {
    let faces = topology.faces();
    let sides = || {
        faces.iter().enumerate().flat_map(|(f, &face)| {
            let n = if is_triangle(face) { 3 } else { 4 };
            (0..n).map(move |k| HalfEdge {
                from: face[k],
                to: face[(k + 1) % n],
                corner: (4 * f + k) as u32,
            })
        })
    };
    let mut start = vec![0usize; topology.vertex_count() + 1];
    for side in sides() {
        start[side.ends().0 as usize + 1] += 1;
    }
    for v in 1..start.len() {
        start[v] += start[v - 1];
    }
    let empty = HalfEdge { from: 0, to: 0, corner: 0 };
    let mut sorted = vec![empty; *start.last().unwrap_or(&0)];
    let mut free = start.clone();
    for side in sides() {
        let slot = &mut free[side.ends().0 as usize];
        sorted[*slot] = side;
        *slot += 1;
    }
    for bucket in start.windows(2) {
        sorted[bucket[0]..bucket[1]].sort_unstable_by_key(|e| (e.ends().1, e.corner));
    }
    sorted
}

/// Groups of half edges between the same two vertices.
pub(crate) fn edges(sorted: &[HalfEdge]) -> impl Iterator<Item = &[HalfEdge]> {
    sorted.chunk_by(|a, b| a.ends() == b.ends())
}

impl Topology {
    /// The edges at the rims of patches (edges of one face only, and edges between faces of
    /// different patches), lower vertex first, ordered by vertex.
    pub fn borders(&self) -> Vec<[u32; 2]> {
        let sorted = half_edges(self);
        let owner = |e: &HalfEdge| self.patch_of(e.face());
        edges(&sorted)
            .filter(|edge| edge.len() == 1 || edge.iter().any(|e| owner(e) != owner(&edge[0])))
            .map(|edge| edge[0].ends().into())
            .collect()
    }
}
