//! Identity of vertices: at the same position on a root, at the same point object, at the same
//! division of a stretch, and images of such; never by proximity.

use crate::roots::{IntervalId, RootPlaceId};
use crate::topology::{EdgeRun, PanelTopology, PatchTopology};
use moldloft_num::trace::Key;
use moldloft_num::union_find::UnionFind;
use std::collections::HashMap;

/// Numbers of vertices before they are joined: patch by patch, `[i * (nv + 1) + j]` in each.
pub(crate) struct Grids {
    first: Vec<u32>,
}

impl Grids {
    pub fn new(structure: &PanelTopology) -> Self {
        let mut first = vec![0];
        let mut count = 0;
        for frame in &structure.patches {
            count += ((frame.divisions[0] + 1) * (frame.divisions[1] + 1)) as u32;
            first.push(count);
        }
        Self { first }
    }

    pub fn count(&self) -> u32 {
        *self.first.last().unwrap_or(&0)
    }

    /// The first vertex of a patch.
    pub fn first(&self, patch: usize) -> u32 {
        self.first[patch]
    }

    /// All vertices of a patch.
    pub fn all(&self, patch: usize) -> std::ops::Range<u32> {
        self.first[patch]..self.first[patch + 1]
    }

    /// The vertices of edge 0..4 (v = 0, u = 1, v = 1, u = 0) in increasing parameter.
    pub fn edge(&self, frame: &PatchTopology, patch: usize, k: usize) -> Vec<u32> {
        let [nu, nv] = frame.divisions;
        let at = |i: usize, j: usize| self.first[patch] + (i * (nv + 1) + j) as u32;
        match k {
            0 => (0..=nu).map(|i| at(i, 0)).collect(),
            1 => (0..=nv).map(|j| at(nu, j)).collect(),
            2 => (0..=nu).map(|i| at(i, nv)).collect(),
            _ => (0..=nv).map(|j| at(0, j)).collect(),
        }
    }

    /// The vertices of all four edges; corners come twice.
    pub fn boundary(&self, frame: &PatchTopology, patch: usize) -> Vec<u32> {
        (0..4).flat_map(|k| self.edge(frame, patch, k)).collect()
    }
}

pub(crate) struct Joiner<'s> {
    structure: &'s PanelTopology,
    pub grids: Grids,
    pub joined: UnionFind,
    /// A vertex at each position.
    places: Vec<Option<u32>>,
    points: HashMap<Key, u32>,
    /// The vertices of a stretch with a given number of divisions, in the direction of its root.
    intervals: HashMap<(IntervalId, u32), Vec<u32>>,
    images: HashMap<(u32, u32), u32>,
}

impl<'s> Joiner<'s> {
    pub fn new(structure: &'s PanelTopology) -> Self {
        let grids = Grids::new(structure);
        let joined = UnionFind::new(grids.count() as usize);
        let mut joiner = Self {
            structure,
            grids,
            joined,
            places: vec![None; structure.points.len()],
            points: HashMap::new(),
            intervals: HashMap::new(),
            images: HashMap::new(),
        };
        for patch in 0..structure.patches.len() {
            joiner.join_edges(patch);
        }
        joiner
    }

    fn at_point(&mut self, vertex: u32, point: Key) {
        let known = *self.points.entry(point).or_insert(vertex);
        self.joined.join(known, vertex);
    }

    fn at_place(&mut self, vertex: u32, place: RootPlaceId) {
        match self.places[place as usize] {
            Some(known) => self.joined.join(known, vertex),
            None => {
                self.places[place as usize] = Some(vertex);
                let structure = self.structure;
                for &point in &structure.points[place as usize] {
                    self.at_point(vertex, point);
                }
            }
        }
    }

    fn join_edges(&mut self, patch: usize) {
        let structure = self.structure;
        let frame = &structure.patches[patch];
        let edges: [Vec<u32>; 4] = std::array::from_fn(|k| self.grids.edge(frame, patch, k));
        let [nu, nv] = frame.divisions;
        let corners = [edges[0][0], edges[0][nu], edges[2][nu], edges[3][nv]];
        for (vertex, point) in corners.into_iter().zip(frame.corners) {
            if let Some(point) = point {
                self.at_point(vertex, point);
            }
        }
        for (run, vertices) in frame.runs.iter().zip(&edges) {
            match run {
                EdgeRun::Along(spans) => {
                    let mut at = 0;
                    for (span, count) in spans {
                        let end = at + *count as usize;
                        self.at_place(vertices[at], span.ends[0]);
                        self.at_place(vertices[end], span.ends[1]);
                        if let Some(interval) = span.interval {
                            self.along_interval(interval, &vertices[at..=end], span.backwards);
                        }
                        at = end;
                    }
                }
                EdgeRun::Loose(spans) => {
                    let ends = spans.first().zip(spans.last());
                    if let Some((first, last)) = ends {
                        self.at_place(vertices[0], first.ends[0]);
                        self.at_place(vertices[vertices.len() - 1], last.ends[1]);
                    }
                }
                EdgeRun::Same(other) => {
                    let others = &edges[usize::from(*other)];
                    if others.len() == vertices.len() {
                        for (&a, &b) in vertices.iter().zip(others) {
                            self.joined.join(a, b);
                        }
                    }
                }
                EdgeRun::Pole(point) => {
                    for &vertex in &vertices[1..] {
                        self.joined.join(vertices[0], vertex);
                    }
                    if let Some(point) = point {
                        self.at_point(vertices[0], *point);
                    }
                }
            }
        }
    }

    fn along_interval(&mut self, interval: IntervalId, vertices: &[u32], backwards: bool) {
        let n = vertices.len() - 1;
        let mut inside: Vec<u32> = vertices[1..n].to_vec();
        if backwards {
            inside.reverse();
        }
        let known = self.intervals.entry((interval, n as u32)).or_insert_with(|| inside.clone());
        for (&a, &b) in known.iter().zip(&inside) {
            self.joined.join(a, b);
        }
    }

    /// Images of joined vertices under the same map are joined; a vertex that is its own image, as
    /// `fixed` says of (patch, vertex of the boundary), is joined to the original.
    pub fn join_images(&mut self, fixed: impl Fn(usize, usize) -> bool) {
        let structure = self.structure;
        for (patch, frame) in structure.patches.iter().enumerate() {
            let Some((original, map)) = frame.image else { continue };
            if structure.patches[original].divisions != frame.divisions {
                continue;
            }
            let (first, shift) = (self.grids.first(patch), self.grids.first(original));
            for (k, vertex) in self.grids.boundary(frame, patch).into_iter().enumerate() {
                let twin = vertex - first + shift;
                if fixed(patch, k) {
                    self.joined.join(twin, vertex);
                } else {
                    let of = self.joined.find(twin);
                    let known = *self.images.entry((map, of)).or_insert(vertex);
                    self.joined.join(known, vertex);
                }
            }
        }
    }
}
