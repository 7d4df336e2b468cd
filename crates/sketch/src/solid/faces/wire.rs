//! A clean wireframe: welded, split where edges touch or cross, without loose ends.

use moldloft_num::Vec3;
use std::collections::BTreeMap;

/// An edge between two vertices.
#[derive(Clone, Copy, Debug)]
pub(super) struct WireEdge {
    pub ends: [usize; 2],
    /// Added where two candidate faces cross; drawn by nobody.
    pub cut: bool,
}

/// Vertices and edges that meet at vertices only.
pub(super) struct Wireframe {
    pub vertices: Vec<Vec3>,
    /// The input's vertices come first; `kept[k]` is the vertex that input vertex `k` became.
    pub kept: Vec<usize>,
    pub edges: Vec<WireEdge>,
    pub tolerance: f64,
    known: BTreeMap<(usize, usize), usize>,
    /// Vertices by cells of a coarse grid, to find equal ones.
    grid: BTreeMap<[i64; 3], Vec<usize>>,
}

fn key(a: usize, b: usize) -> (usize, usize) {
    (a.min(b), a.max(b))
}

impl Wireframe {
    /// Builds the wireframe; the tolerance is 1e-7 of the diagonal.
    pub fn new(positions: &[Vec3], edges: &[[usize; 2]]) -> Wireframe {
        let mut low: Vec3 = Vec3::of(f64::INFINITY, f64::INFINITY, f64::INFINITY);
        let mut high = -low;
        for p in positions {
            low = Vec3::new(low.x.min(p.x), low.y.min(p.y), low.z.min(p.z));
            high = Vec3::new(high.x.max(p.x), high.y.max(p.y), high.z.max(p.z));
        }
        let diagonal = if positions.is_empty() { 1.0 } else { (high - low).norm() };
        let tolerance = (1e-7 * diagonal).max(f64::MIN_POSITIVE);
        let mut wire = Wireframe {
            vertices: Vec::new(),
            kept: Vec::new(),
            edges: Vec::new(),
            tolerance,
            known: BTreeMap::new(),
            grid: BTreeMap::new(),
        };
        for &p in positions {
            // Every input vertex has an entry, so that numbers stay; equal ones share the first.
            let same = wire.find(p);
            let own = wire.push(p);
            wire.kept.push(same.unwrap_or(own));
        }
        for &[a, b] in edges {
            let (a, b) = (wire.kept[a], wire.kept[b]);
            wire.insert(a, b, false);
        }
        wire
    }

    fn cell(&self, p: Vec3) -> [i64; 3] {
        let size = self.tolerance * 4.0;
        p.to_array().map(|x| (x / size).floor().clamp(-9e15, 9e15) as i64)
    }

    fn push(&mut self, p: Vec3) -> usize {
        let cell = self.cell(p);
        self.grid.entry(cell).or_default().push(self.vertices.len());
        self.vertices.push(p);
        self.vertices.len() - 1
    }

    fn find(&self, p: Vec3) -> Option<usize> {
        let [x, y, z] = self.cell(p);
        let mut best = None;
        for dx in -1..=1 {
            for dy in -1..=1 {
                for dz in -1..=1 {
                    for &v in self.grid.get(&[x + dx, y + dy, z + dz]).into_iter().flatten() {
                        if self.vertices[v].distance(p) <= self.tolerance {
                            best = Some(best.map_or(v, |b: usize| b.min(v)));
                        }
                    }
                }
            }
        }
        best
    }

    /// The vertex at `p`, made if needed; edges that contain it are split.
    pub fn vertex(&mut self, p: Vec3) -> usize {
        if let Some(v) = self.find(p) {
            return v;
        }
        let v = self.push(p);
        self.split_at(v);
        v
    }

    /// Parameter of the point along `ends`, if it is inside the edge.
    fn inside(&self, ends: [usize; 2], p: Vec3) -> Option<f64> {
        let (a, b) = (self.vertices[ends[0]], self.vertices[ends[1]]);
        let d = b - a;
        let t = (p - a).dot(d) / d.norm_sq();
        let margin = self.tolerance / d.norm();
        (t > margin && t < 1.0 - margin && (a + d * t).distance(p) <= self.tolerance).then_some(t)
    }

    fn split_at(&mut self, v: usize) {
        for e in 0..self.edges.len() {
            let WireEdge { ends, cut } = self.edges[e];
            if self.inside(ends, self.vertices[v]).is_some() {
                self.known.remove(&key(ends[0], ends[1]));
                self.edges[e].ends = [ends[0], v];
                self.known.insert(key(ends[0], v), e);
                self.add(v, ends[1], cut);
            }
        }
    }

    fn add(&mut self, a: usize, b: usize, cut: bool) {
        match self.known.get(&key(a, b)) {
            Some(&e) => self.edges[e].cut &= cut,
            None => {
                self.known.insert(key(a, b), self.edges.len());
                self.edges.push(WireEdge { ends: [a, b], cut });
            }
        }
    }

    /// Adds the straight line from `a` to `b` in pieces between all vertices and edges on it.
    pub fn insert(&mut self, a: usize, b: usize, cut: bool) {
        if a == b {
            return;
        }
        self.split_at(a);
        self.split_at(b);
        let (p, q) = (self.vertices[a], self.vertices[b]);
        let mut crossings = Vec::new();
        for edge in &self.edges {
            let (r, s) = (self.vertices[edge.ends[0]], self.vertices[edge.ends[1]]);
            if let Some(x) = crossing([p, q], [r, s], self.tolerance) {
                crossings.push(x);
            }
        }
        for x in crossings {
            self.vertex(x);
        }
        let mut way: Vec<(f64, usize)> = (0..self.vertices.len())
            .filter(|&v| self.kept.get(v).is_none_or(|&k| k == v))
            .filter_map(|v| Some((self.inside([a, b], self.vertices[v])?, v)))
            .collect();
        way.sort_by(|x, y| x.0.total_cmp(&y.0));
        let mut from = a;
        for v in way.into_iter().map(|w| w.1).chain([b]) {
            if v != from {
                self.add(from, v, cut);
            }
            from = v;
        }
    }

    /// Removes edges with an end that no other edge shares, repeatedly; returns them.
    pub fn prune(&mut self) -> Vec<[usize; 2]> {
        let mut gone = Vec::new();
        loop {
            let mut degree = vec![0; self.vertices.len()];
            for e in &self.edges {
                e.ends.iter().for_each(|&v| degree[v] += 1);
            }
            let before = self.edges.len();
            self.edges.retain(|e| {
                let loose = e.ends.iter().any(|&v| degree[v] < 2);
                if loose {
                    gone.push(e.ends);
                }
                !loose
            });
            if self.edges.len() == before {
                break;
            }
        }
        self.known = (0..self.edges.len())
            .map(|e| (key(self.edges[e].ends[0], self.edges[e].ends[1]), e))
            .collect();
        gone
    }
}

/// Intersection of two segments inside both, if they are within `tolerance`.
fn crossing([p, q]: [Vec3; 2], [r, s]: [Vec3; 2], tolerance: f64) -> Option<Vec3> {
    let apart = |k: usize| {
        let (a, b) = (p[k].min(q[k]), p[k].max(q[k]));
        let (c, d) = (r[k].min(s[k]), r[k].max(s[k]));
        a > d + tolerance || c > b + tolerance
    };
    if (0..3).any(apart) {
        return None;
    }
    let (d, e, w) = (q - p, s - r, p - r);
    let (dd, de, ee) = (d.norm_sq(), d.dot(e), e.norm_sq());
    let det = dd * ee - de * de;
    if det <= 1e-18 * dd * ee {
        return None;
    }
    let t = (de * e.dot(w) - ee * d.dot(w)) / det;
    let u = (dd * e.dot(w) - de * d.dot(w)) / det;
    let (x, y) = (p + d * t, r + e * u);
    let (mt, mu) = (tolerance / d.norm(), tolerance / e.norm());
    let inner = t > mt && t < 1.0 - mt && u > mu && u < 1.0 - mu;
    (inner && x.distance(y) <= tolerance).then_some(y)
}
