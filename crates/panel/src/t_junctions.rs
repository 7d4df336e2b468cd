//! Coincident but unjoined elements: edges of patches, and corners on edges of others.

use crate::draft::indices;
use crate::edges::along_edge;
use crate::notes::PanelNote;
use crate::panelling::Panelling;
use crate::patch_values::PatchValues;
use crate::topology::EdgeRun;
use moldloft_mesh::Tag;
use moldloft_model::Graph;
use moldloft_num::{Order, Vec3};
use std::collections::{BTreeMap, HashMap, HashSet};

/// Relative distance, in model sizes, within which positions coincide: the accuracy of projections
/// and of coordinates typed with few digits.
const SAME_PLACE: f64 = 1e-7;

/// The most that are reported one by one.
const MOST_REPORTED: usize = 20;

/// An open panel edge at the rim of a patch.
struct OpenPanelEdge {
    patch: usize,
    edge: u8,
    /// Parameters along the edge, and the vertices, at both ends.
    ts: [f64; 2],
    vertices: [u32; 2],
    ends: [Vec3; 2],
}

type Cell = [i64; 3];

/// Panels of one edge that are on another.
#[derive(Clone, Copy, Debug, Default)]
struct Coincidence {
    panels: usize,
    length: f64,
    at: Vec3,
    /// True if both edges coincide from end to end.
    whole: bool,
}

/// The open panel edges, and those that come near each cell of space.
struct OpenEdges {
    sides: Vec<OpenPanelEdge>,
    cells: HashMap<Cell, Vec<usize>>,
    /// The length of a cell: that of the longest panel edge.
    longest: f64,
    /// The size of all of them.
    size: f64,
}

impl OpenEdges {
    /// `None` without open edges.
    fn new(sides: Vec<OpenPanelEdge>) -> Option<Self> {
        let size = sides
            .iter()
            .flat_map(|s| s.ends)
            .fold(moldloft_num::Box3::EMPTY, |b, p| b.including(p))
            .diagonal();
        // Cells as large as the longest panel edge: each edge meets few of them.
        let longest = sides.iter().map(|s| s.ends[0].distance(s.ends[1])).fold(0.0, f64::max);
        if longest == 0.0 || size == 0.0 {
            return None;
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
        Some(Self { sides, cells, longest, size })
    }

    /// The open edges that may be near a position.
    fn near(&self, p: Vec3) -> impl Iterator<Item = &OpenPanelEdge> {
        let cell = p.to_array().map(|x| (x / self.longest).floor() as i64);
        self.cells.get(&cell).into_iter().flatten().map(|&k| &self.sides[k])
    }
}

/// Two edges of patches, the second of which comes later.
type EdgePair = [(usize, u8); 2];

impl Panelling {
    /// Coincident but unjoined elements, for checks: edges of patches, and corners on open edges of
    /// other patches, in the middle of a panel's edge (a T-junction) or at another vertex. It takes
    /// longer than the panelling.
    pub fn junctions(&self, graph: &Graph<f64>) -> Vec<PanelNote> {
        let Some(open) = OpenEdges::new(self.sides(graph)) else { return Vec::new() };
        let known = PatchValues::new(graph, &self.structure, &self.names);
        let pairs = self.coincident(&open, &known);
        let whole: HashSet<[usize; 2]> =
            pairs.iter().filter(|(_, c)| c.whole).map(|(pair, _)| [pair[0].0, pair[1].0]).collect();
        let corners = self.loose_corners(&open, &known, |patches: [usize; 2]| {
            whole.contains(&[patches[0].min(patches[1]), patches[0].max(patches[1])])
        });
        let mut remarks: Vec<PanelNote> = Vec::new();
        for (pair, found) in pairs {
            let [a, b] = [pair[0].0, pair[1].0];
            let name = |k: usize| self.structure.patches[k].name.to_string();
            let said = corners.iter().any(|note| match note {
                PanelNote::Junction { patches, .. } => {
                    *patches == [name(a), name(b)] || *patches == [name(b), name(a)]
                }
                _ => false,
            });
            // For parts of edges the note of a corner is more specific.
            if found.whole || !said {
                remarks.push(PanelNote::Unjoined {
                    patches: [name(a), name(b)],
                    edges: [pair[0].1, pair[1].1],
                    panels: found.panels,
                    length: found.length,
                    whole: found.whole,
                    at: found.at,
                });
            }
        }
        remarks.extend(corners);
        if remarks.len() > MOST_REPORTED {
            let more = remarks.len() - MOST_REPORTED;
            remarks.truncate(MOST_REPORTED);
            remarks.push(PanelNote::More(more));
        }
        remarks
    }

    /// The pairs of edges that coincide without common vertices.
    fn coincident(
        &self,
        open: &OpenEdges,
        known: &PatchValues<f64>,
    ) -> Vec<(EdgePair, Coincidence)> {
        let mut found: BTreeMap<EdgePair, [Coincidence; 2]> = BTreeMap::new();
        for side in &open.sides {
            let Some(surface) = &known.surfaces[side.patch] else { continue };
            let own = |share: f64| {
                let [u, v] = on_edge(side.edge, side.ts[0] + (side.ts[1] - side.ts[0]) * share);
                surface.jet(u, v, Order::Zero).p
            };
            let length = side.ends[0].distance(side.ends[1]);
            let near = SAME_PLACE * open.size;
            if length <= 8.0 * near {
                continue;
            }
            // Edges that only cross meet in one of the two at most.
            let there = |share: f64| -> HashSet<(usize, u8)> {
                let p = own(share);
                let meets = |other: &OpenPanelEdge| {
                    let itself = (other.patch, other.edge) == (side.patch, side.edge);
                    let Some(surface) = &known.surfaces[other.patch] else { return false };
                    let point = |t: f64| {
                        let [u, v] = on_edge(other.edge, t);
                        surface.jet(u, v, Order::Zero).p
                    };
                    !itself && nearest(&point, other.ts, p).1 <= near
                };
                open.near(p).filter(|o| meets(o)).map(|o| (o.patch, o.edge)).collect()
            };
            let first = there(0.3);
            if first.is_empty() {
                continue;
            }
            let second = there(0.7);
            for &other in first.intersection(&second) {
                let own = (side.patch, side.edge);
                let beside = self.of_symmetry(own.0) != self.of_symmetry(other.0);
                if beside || self.along_one_curve(own, other) {
                    continue;
                }
                let pair = [own.min(other), own.max(other)];
                let part = &mut found.entry(pair).or_default()[usize::from(own > other)];
                if part.panels == 0 {
                    part.at = side.ends[0];
                }
                part.panels += 1;
                part.length += length;
            }
        }
        let divisions =
            |(patch, k): (usize, u8)| self.structure.patches[patch].divisions[usize::from(k) % 2];
        let merged = found.into_iter().map(|(pair, [mut a, b])| {
            a.whole = a.panels == divisions(pair[0]) && b.panels == divisions(pair[1]);
            if a.panels == 0 {
                a = Coincidence { whole: false, ..b };
            }
            (pair, a)
        });
        merged.collect()
    }

    /// True for a part of a plane of symmetry.
    fn of_symmetry(&self, patch: usize) -> bool {
        let tags = &self.structure.patches[patch].tags;
        Tag::among(tags.iter().map(|t| &**t)) == Tag::Symmetry
    }

    /// True for edges along a common stretch: their counts contradict, which is reported
    /// separately.
    fn along_one_curve(&self, a: (usize, u8), b: (usize, u8)) -> bool {
        let intervals = |(patch, k): (usize, u8)| {
            self.structure.patches[patch].runs[usize::from(k)].intervals()
        };
        let of_a = intervals(a);
        intervals(b).iter().any(|i| of_a.contains(i))
    }

    /// True for a corner on an edge whose counts contradict those along it, so that no vertex of
    /// the edge is there: that is reported separately.
    fn at_loose_place(&self, patch: usize, [u, v]: [u8; 2], edge: (usize, u8)) -> bool {
        let EdgeRun::Loose(spans) = &self.structure.patches[edge.0].runs[usize::from(edge.1)]
        else {
            return false;
        };
        let beside = [if v == 0 { 0 } else { 2 }, if u == 0 { 3 } else { 1 }];
        let number = [[0, 3], [1, 2]][usize::from(u)][usize::from(v)];
        let key = self.structure.patches[patch].corners[number];
        beside.into_iter().any(|k| self.along_one_curve((patch, k), edge))
            || key.is_some_and(|key| {
                spans
                    .iter()
                    .flat_map(|s| s.ends)
                    .any(|place| self.structure.points[place as usize].contains(&key))
            })
    }

    /// The corners of patches that are on open edges of others and are not joined to them, except
    /// for the pairs of patches in `skipped`.
    fn loose_corners(
        &self,
        open: &OpenEdges,
        known: &PatchValues<f64>,
        skipped: impl Fn([usize; 2]) -> bool,
    ) -> Vec<PanelNote> {
        let size = open.size;
        let pole = self.poles(size);
        let place = |vertex: u32| pole.get(&vertex).copied().unwrap_or(vertex);
        let mut vertices: HashSet<u32> = HashSet::new();
        open.sides.iter().for_each(|s| vertices.extend(s.vertices));
        let mut reported = HashSet::new();
        let mut remarks = Vec::new();
        for (patch, frame) in self.structure.patches.iter().enumerate().filter(|(_, f)| f.meshed) {
            let [nu, nv] = frame.divisions;
            for corner in [[0, 0], [1, 0], [1, 1], [0, 1]] {
                let at = usize::from(corner[0]) * nu * (nv + 1) + usize::from(corner[1]) * nv;
                let (vertex, p) = (self.joined.vertices[patch][at], self.points[patch][at]);
                if !vertices.contains(&vertex) {
                    continue;
                }
                for side in open.near(p) {
                    let shared = side.vertices.iter().any(|&v| place(v) == place(vertex));
                    let itself = side.patch == patch || shared;
                    let known_loose =
                        || self.at_loose_place(patch, corner, (side.patch, side.edge));
                    let beside = self.of_symmetry(patch) != self.of_symmetry(side.patch);
                    if itself || beside || skipped([patch, side.patch]) || known_loose() {
                        continue;
                    }
                    let Some(surface) = &known.surfaces[side.patch] else { continue };
                    let point = |t: f64| {
                        let [u, v] = on_edge(side.edge, t);
                        surface.jet(u, v, Order::Zero).p
                    };
                    // All parameters of a side without length are the same point, which the
                    // adjacent sides contain too.
                    let [from, to] = side.ts;
                    let first = point(from);
                    let same = |t: f64| point(t).distance(first) <= SAME_PLACE * size;
                    if same(0.5 * (from + to)) && same(to) {
                        continue;
                    }
                    let (t, distance) = nearest(&point, side.ts, p);
                    if distance > SAME_PLACE * size || !reported.insert((patch, corner, side.patch))
                    {
                        continue;
                    }
                    let twin = side.ends.iter().any(|q| q.distance(p) <= SAME_PLACE * size);
                    let name = |k: usize| self.structure.patches[k].name.to_string();
                    let own = known.surfaces[patch].as_ref();
                    let part = own.and_then(|own| {
                        let on_own = |[u, v]: [f64; 2]| own.jet(u, v, Order::Zero).p;
                        part_along(&on_own, corner, &point, SAME_PLACE * size)
                    });
                    remarks.push(PanelNote::Junction {
                        patches: [name(patch), name(side.patch)],
                        corner,
                        edge: (side.edge, t),
                        part,
                        twin,
                        at: p,
                    });
                }
            }
        }
        remarks
    }

    /// For each vertex along an edge without length, the first of the coincident ones.
    fn poles(&self, size: f64) -> HashMap<u32, u32> {
        let mut first: HashMap<u32, u32> = HashMap::new();
        for (patch, frame) in self.structure.patches.iter().enumerate().filter(|(_, f)| f.meshed) {
            for k in 0..4u8 {
                let places: Vec<usize> = indices(frame.divisions, k).collect();
                let at = |m: usize| self.points[patch][m];
                if places.iter().any(|&m| at(m).distance(at(places[0])) > SAME_PLACE * size) {
                    continue;
                }
                let own = places.iter().map(|&m| self.joined.vertices[patch][m]);
                let known: HashSet<u32> =
                    own.map(|v| first.get(&v).copied().unwrap_or(v)).collect();
                let Some(&one) = known.iter().min() else { continue };
                first.values_mut().filter(|v| known.contains(v)).for_each(|v| *v = one);
                first.extend(known.iter().map(|&v| (v, one)));
            }
        }
        first
    }

    fn sides(&self, graph: &Graph<f64>) -> Vec<OpenPanelEdge> {
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
                    sides.push(OpenPanelEdge {
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
/// The edge of a patch that runs from a corner along another edge, and the parameters of its ends there.
fn part_along(
    own: &impl Fn([f64; 2]) -> Vec3,
    [u, v]: [u8; 2],
    other: &impl Fn(f64) -> Vec3,
    near: f64,
) -> Option<(u8, [f64; 2])> {
    const SAMPLES: usize = 64;
    let on_other = |p: Vec3| {
        let intervals = (0..SAMPLES).map(|k| [k, k + 1].map(|k| k as f64 / SAMPLES as f64));
        let found = intervals.map(|interval| nearest(other, interval, p));
        found
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .filter(|found| found.1 <= near)
            .map(|found| found.0)
    };
    let edges = [(if v == 0 { 0 } else { 2 }, u), (if u == 0 { 3 } else { 1 }, v)];
    edges.into_iter().find_map(|(edge, end)| {
        let from = f64::from(end);
        let at = |share: f64| own(on_edge(edge, from + (1.0 - 2.0 * from) * share));
        on_other(at(0.5))?;
        Some((edge, [on_other(at(0.0))?, on_other(at(1.0))?]))
    })
}

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
