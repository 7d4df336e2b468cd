//! Orientation of the panels of each patch: consistent with neighbours, and outward for bodies.

use crate::draft::indices;
use crate::topology::{PanelTopology, PatchTopology};
use moldloft_num::Vec3;
use moldloft_num::union_find::SignedUnionFind;
use std::sync::Arc;

/// Distance of an edge from a coordinate plane, relative to its length, within which it is in the
/// plane.
const IN_PLANE: f64 = 1e-9;

/// Volume of the cones of an open body, relative to their absolute volumes, below which it does not
/// determine the outside.
const NEARLY_FLAT: f64 = 0.05;

/// Relative volume of closed bodies, whose cones are their volume: a thin shell has little of it, but has one.
pub(crate) const NO_VOLUME: f64 = 1e-9;

/// A panel edge with one panel: the patch and the indices of both ends in its grid.
pub(crate) type FreeEdge = (u32, u32, u32);

/// Connectivity of the patches of a mesh.
#[derive(Clone, Debug, Default)]
pub(crate) struct Orientation {
    /// For each patch the first one of its body, and whether it is turned against that one.
    sides: Vec<(usize, bool)>,
    /// For the first patch of each body, whether it has no rim.
    closed: Vec<bool>,
}

impl Orientation {
    /// From the vertices of the patches, and the panel edges with one panel.
    pub fn new(structure: &PanelTopology, vertices: &[Vec<u32>], free_edges: &[FreeEdge]) -> Self {
        let mut bodies = SignedUnionFind::new(structure.patches.len());
        let mut all: Vec<((u32, u32), usize, bool)> = Vec::new();
        for (patch, frame) in structure.patches.iter().enumerate().filter(|(_, f)| f.meshed) {
            for k in 0..4 {
                // A walk around the patch follows its edges 0 and 1, and the reverse of 2 and 3.
                let walk: Vec<u32> =
                    indices(frame.divisions, k).map(|at| vertices[patch][at]).collect();
                for ends in walk.windows(2).filter(|ends| ends[0] != ends[1]) {
                    let pair = (ends[0].min(ends[1]), ends[0].max(ends[1]));
                    all.push((pair, patch, (ends[0] < ends[1]) == (k < 2)));
                }
            }
        }
        all.sort_unstable();
        for run in all.chunk_by(|a, b| a.0 == b.0) {
            if let [(_, p, forward), (_, q, again)] = *run
                && p != q
            {
                // Neighbours of equal orientation have a common edge in opposite directions.
                bodies.join(p, q, forward == again);
            }
        }
        join_along_intervals(structure, &mut bodies);
        let sides: Vec<(usize, bool)> =
            (0..structure.patches.len()).map(|p| bodies.find(p)).collect();
        let mut closed = vec![true; sides.len()];
        for &(patch, _, _) in free_edges {
            closed[sides[patch as usize].0] = false;
        }
        Self { sides, closed }
    }

    /// For each patch, true if its panels are opposite to its natural normal.
    ///
    /// Neighbours face alike, as the first of them says; a closed body faces outward: its volume is
    /// positive, however thin it is; a cavity faces inward. Open ones keep their sides towards one another and face outward together: the cone
    /// from the middle of their rims (in the planes that close them) is positive. Nearly flat ones face as their surfaces
    /// say.
    pub fn turned(
        &self,
        structure: &PanelTopology,
        points: &[Arc<Vec<Vec3>>],
        free_edges: &[FreeEdge],
    ) -> Vec<bool> {
        let patches = &structure.patches;
        let stated = |patch: usize| {
            let (first, against) = self.sides[patch];
            patches[first].reversed != against
        };
        let centre = apex(points, free_edges);
        // The open bodies count as one, the last.
        let mut cones = vec![(0.0, 0.0); patches.len() + 1];
        for (patch, frame) in patches.iter().enumerate().filter(|(_, f)| f.meshed) {
            let sum = &mut cones[self.body(patch)];
            let (volume, size) = cone(frame, &points[patch], centre);
            sum.0 += if stated(patch) { -volume } else { volume };
            sum.1 += size;
        }
        let mut cavity = vec![false; patches.len() + 1];
        for (patch, _) in patches.iter().enumerate().filter(|(_, f)| f.meshed && f.cavity) {
            // Open ones have no inside.
            let body = self.body(patch);
            cavity[body] |= body < patches.len();
        }
        let wrongly = |patch: usize| {
            let body = self.body(patch);
            let flat = if body < patches.len() { NO_VOLUME } else { NEARLY_FLAT };
            let (volume, size) = cones[body];
            (if cavity[body] { -volume } else { volume }) < -flat * size
        };
        (0..patches.len()).map(|patch| stated(patch) != wrongly(patch)).collect()
    }

    /// True for a patch of a body without a rim.
    pub fn is_closed(&self, patch: usize) -> bool {
        self.closed[self.sides[patch].0]
    }

    fn body(&self, patch: usize) -> usize {
        let first = self.sides[patch].0;
        if self.closed[first] { first } else { self.sides.len() }
    }
}

/// Patches along one interval are neighbours even if their counts contradict and none of their
/// panels meet.
fn join_along_intervals(structure: &PanelTopology, bodies: &mut SignedUnionFind) {
    let mut all: Vec<(u32, usize, bool)> = Vec::new();
    for (patch, frame) in structure.patches.iter().enumerate().filter(|(_, f)| f.meshed) {
        for (k, run) in frame.runs.iter().enumerate() {
            let along = run.spans().filter_map(|s| Some((s.interval?, s.backwards)));
            all.extend(along.map(|(interval, backwards)| (interval, patch, (k < 2) != backwards)));
        }
    }
    all.sort_unstable();
    for run in all.chunk_by(|a, b| a.0 == b.0) {
        if let [(_, p, forward), (_, q, again)] = *run
            && p != q
        {
            bodies.join(p, q, forward == again);
        }
    }
}

/// The centroid of the rims; if all of them are in coordinate planes, in which mirrors or the water
/// close the bodies, a point of these planes: from there the closing parts have no cone.
fn apex(points: &[Arc<Vec<Vec3>>], free_edges: &[FreeEdge]) -> Vec3 {
    let (mut centre, mut length) = (Vec3::<f64>::zero(), 0.0);
    let (mut used, mut closing) = ([false; 3], true);
    for &(patch, a, b) in free_edges {
        let [a, b] = [a, b].map(|k| points[patch as usize][k as usize]);
        let step = a.distance(b);
        centre += (a + b) * (0.5 * step);
        length += step;
        let plane = (0..3).find(|&axis| a[axis].abs().max(b[axis].abs()) <= IN_PLANE * step);
        match plane {
            Some(axis) => used[axis] = true,
            None => closing = false,
        }
    }
    if length == 0.0 {
        return Vec3::zero();
    }
    let c = (centre / length).to_array();
    let [x, y, z] = [0, 1, 2].map(|axis| if closing && used[axis] { 0.0 } else { c[axis] });
    Vec3::of(x, y, z)
}

/// Six times the signed and the absolute volume of the cones from `centre` to the panels.
fn cone(frame: &PatchTopology, points: &[Vec3], centre: Vec3) -> (f64, f64) {
    let [nu, nv] = frame.divisions;
    let at = |i: usize, j: usize| points[i * (nv + 1) + j] - centre;
    let (mut volume, mut size) = (0.0, 0.0);
    for (i, j) in (0..nu).flat_map(|i| (0..nv).map(move |j| (i, j))) {
        let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
        let cone = (a + c).dot((c - a).cross(d - b));
        volume += cone;
        size += cone.abs();
    }
    (volume, size)
}
