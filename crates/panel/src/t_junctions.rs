//! Corners that lie on an edge of another patch without being joined to it.

use crate::draft::indices;
use crate::edges::along_edge;
use crate::notes::PanelNote;
use crate::panelling::Panelling;
use crate::patch_values::PatchValues;
use moldloft_model::Graph;
use moldloft_num::{Order, Vec3};
use std::collections::{HashMap, HashSet};

/// Two places count as one within this share of the model's size: what a designer would call the
/// same place, found by a projection or typed with few digits.
const SAME_PLACE: f64 = 1e-7;

/// The most that are reported one by one.
const MOST_REPORTED: usize = 20;

/// An open panel edge at the rim of a patch.
struct OpenEdge {
    patch: usize,
    edge: u8,
    /// Parameters along the edge, and the vertices, at both ends.
    ts: [f64; 2],
    vertices: [u32; 2],
    ends: [Vec3; 2],
}

type Cell = [i64; 3];

impl Panelling {
    /// Corners of patches that lie on open edges of others and are not joined to them: in the
    /// middle of a panel's edge (a T-junction), or at another vertex in the same place. For
    /// checks: it takes longer than panelling itself.
    pub fn junctions(&self, graph: &Graph<f64>) -> Vec<PanelNote> {
        let sides = self.sides(graph);
        let size = sides
            .iter()
            .flat_map(|s| s.ends)
            .fold(moldloft_num::Box3::EMPTY, |b, p| b.including(p))
            .diagonal();
        // Cells as large as the longest panel edge: each edge meets few of them.
        let longest = sides.iter().map(|s| s.ends[0].distance(s.ends[1])).fold(0.0, f64::max);
        if longest == 0.0 || size == 0.0 {
            return Vec::new();
        }
        let mut cells: HashMap<Cell, Vec<usize>> = HashMap::new();
        for (k, side) in sides.iter().enumerate() {
            // An edge strays from its chord by less than its length, as far as it is searched.
            let (a, b) = (side.ends[0], side.ends[1]);
            let stray = 0.25 * a.distance(b) + SAME_PLACE * size;
            let cell = |x: f64| (x / longest).floor() as i64;
            let range = |axis: usize| {
                let (x, y) = (a[axis].min(b[axis]) - stray, a[axis].max(b[axis]) + stray);
                cell(x)..=cell(y)
            };
            for i in range(0) {
                for j in range(1) {
                    for l in range(2) {
                        cells.entry([i, j, l]).or_default().push(k);
                    }
                }
            }
        }
        let known = PatchValues::new(graph, &self.structure, &self.names);
        let mut open: HashSet<u32> = HashSet::new();
        sides.iter().for_each(|s| open.extend(s.vertices));
        let mut reported = HashSet::new();
        let mut remarks = Vec::new();
        let mut more = 0;
        for (patch, frame) in self.structure.patches.iter().enumerate().filter(|(_, f)| f.meshed) {
            let [nu, nv] = frame.divisions;
            for corner in [[0, 0], [1, 0], [1, 1], [0, 1]] {
                let at = usize::from(corner[0]) * nu * (nv + 1) + usize::from(corner[1]) * nv;
                let (vertex, p) = (self.joined.vertices[patch][at], self.points[patch][at]);
                if !open.contains(&vertex) {
                    continue;
                }
                let cell = p.to_array().map(|x| (x / longest).floor() as i64);
                for &k in cells.get(&cell).into_iter().flatten() {
                    let side = &sides[k];
                    if side.patch == patch || side.vertices.contains(&vertex) {
                        continue;
                    }
                    let Some(surface) = &known.surfaces[side.patch] else { continue };
                    let point = |t: f64| {
                        let [u, v] = on_edge(side.edge, t);
                        surface.jet(u, v, Order::Zero).p
                    };
                    let (t, distance) = nearest(&point, side.ts, p);
                    if distance > SAME_PLACE * size || !reported.insert((patch, corner, side.patch))
                    {
                        continue;
                    }
                    if remarks.len() == MOST_REPORTED {
                        more += 1;
                        continue;
                    }
                    let twin = side.ends.iter().any(|q| q.distance(p) <= SAME_PLACE * size);
                    let name = |k: usize| self.structure.patches[k].name.to_string();
                    remarks.push(PanelNote::Junction {
                        patches: [name(patch), name(side.patch)],
                        corner,
                        edge: (side.edge, t),
                        twin,
                        at: p,
                    });
                }
            }
        }
        if more > 0 {
            remarks.push(PanelNote::More(more));
        }
        remarks
    }

    /// The open panel edges.
    fn sides(&self, graph: &Graph<f64>) -> Vec<OpenEdge> {
        let known = PatchValues::new(graph, &self.structure, &self.names);
        let open: HashSet<(u32, u32, u32)> = self.joined.free_edges.iter().copied().collect();
        let mut sides = Vec::with_capacity(open.len());
        for (patch, frame) in self.structure.patches.iter().enumerate().filter(|(_, f)| f.meshed) {
            for k in 0..4u8 {
                let Some(ts) = along_edge(usize::from(k), patch as u32, &known) else { continue };
                let places: Vec<usize> = indices(frame.divisions, k).collect();
                for (m, pair) in places.windows(2).enumerate() {
                    if !open.contains(&(patch as u32, pair[0] as u32, pair[1] as u32)) {
                        continue;
                    }
                    let [a, b] = [pair[0], pair[1]];
                    sides.push(OpenEdge {
                        patch,
                        edge: k,
                        ts: [ts[m], ts[m + 1]],
                        vertices: [a, b].map(|at| self.joined.vertices[patch][at]),
                        ends: [a, b].map(|at| self.points[patch][at]),
                    });
                }
            }
        }
        sides
    }
}

/// (u, v) at the parameter of an edge.
fn on_edge(edge: u8, t: f64) -> [f64; 2] {
    match edge {
        0 => [t, 0.0],
        1 => [1.0, t],
        2 => [t, 1.0],
        _ => [0.0, t],
    }
}

/// The parameter in a short range where a curve is nearest to a point, and how near.
fn nearest(curve: &impl Fn(f64) -> Vec3, [from, to]: [f64; 2], p: Vec3) -> (f64, f64) {
    let distance = |t: f64| curve(t).distance(p);
    // By golden sections (Kiefer 1953) to the accuracy that distances have near a minimum.
    let golden = (5f64.sqrt() - 1.0) / 2.0;
    let (mut a, mut b) = (from, to);
    let (mut c, mut d) = (b - golden * (b - a), a + golden * (b - a));
    let (mut at_c, mut at_d) = (distance(c), distance(d));
    for _ in 0..60 {
        if at_c < at_d {
            (b, d, at_d) = (d, c, at_c);
            c = b - golden * (b - a);
            at_c = distance(c);
        } else {
            (a, c, at_c) = (c, d, at_d);
            d = a + golden * (b - a);
            at_d = distance(d);
        }
    }
    let best = [from, to, 0.5 * (a + b)].into_iter().map(|t| (t, distance(t)));
    best.min_by(|x, y| x.1.total_cmp(&y.1)).unwrap_or((from, f64::INFINITY))
}
