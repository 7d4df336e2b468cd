//! The outside of bodies of whole and of trimmed faces: known when the trimmed ones are sewn to the others.

use crate::orientation::NO_VOLUME;
use moldloft_mesh::Topology;
use moldloft_num::Vec3;
use moldloft_num::union_find::UnionFind;
use std::ops::Range;

/// A patch, or the patches of one body, by its faces in the mesh.
pub(crate) struct SewnPart {
    pub faces: Range<usize>,
    /// False for one whose outside is known.
    pub counts: bool,
    /// True for faces divided as a grid.
    pub whole: bool,
    /// True for a face of a cavity.
    pub cavity: bool,
}

/// For each member, true if it is of a closed body of whole and other faces that faces inward, or of a cavity that
/// faces outward.
pub(crate) fn faces_wrongly(
    topology: &Topology,
    positions: &[Vec3],
    members: &[SewnPart],
) -> Vec<bool> {
    let mut edges: Vec<((u32, u32), usize, bool)> = Vec::new();
    let counted = members.iter().enumerate().filter(|(_, member)| member.counts);
    for (k, member) in counted {
        for &[a, b, c, d] in &topology.faces()[member.faces.clone()] {
            let sides = [(a, b), (b, c), (c, d), (d, a)].into_iter().filter(|(p, q)| p != q);
            edges.extend(sides.map(|(p, q)| ((p.min(q), p.max(q)), k, p < q)));
        }
    }
    edges.sort_unstable();
    let mut bodies = UnionFind::new(members.len());
    let mut open = Vec::new();
    for run in edges.chunk_by(|a, b| a.0 == b.0) {
        run.iter().for_each(|edge| bodies.join(run[0].1 as u32, edge.1 as u32));
        let sum: i64 = run.iter().map(|edge| if edge.2 { 1 } else { -1 }).sum();
        if sum != 0 {
            open.push(run[0].1);
        }
    }
    let body: Vec<usize> = (0..members.len()).map(|k| bodies.find(k)).collect();
    let mut closed = vec![true; members.len()];
    open.into_iter().for_each(|k| closed[body[k]] = false);
    let (mut whole, mut cavity) = (vec![false; members.len()], vec![false; members.len()]);
    let mut cones = vec![(0.0, 0.0); members.len()];
    let mut apex: Vec<Option<Vec3>> = vec![None; members.len()];
    for (k, member) in members.iter().enumerate().filter(|(_, member)| member.counts) {
        whole[body[k]] |= member.whole;
        cavity[body[k]] |= member.cavity;
        for face in &topology.faces()[member.faces.clone()] {
            let corners = face.map(|v| positions[v as usize]);
            let from = *apex[body[k]].get_or_insert(corners[0]);
            let [a, b, c, d] = corners.map(|p| p - from);
            let cone = (a + c).dot((c - a).cross(d - b));
            cones[body[k]].0 += cone;
            cones[body[k]].1 += cone.abs();
        }
    }
    let wrongly = |k: usize| {
        let (volume, size) = cones[body[k]];
        let inward = if cavity[body[k]] { -volume } else { volume };
        // Trimmed faces alone face as they are stated.
        let decides = whole[body[k]] || cavity[body[k]];
        members[k].counts && closed[body[k]] && decides && inward < -NO_VOLUME * size
    };
    (0..members.len()).map(wrongly).collect()
}
