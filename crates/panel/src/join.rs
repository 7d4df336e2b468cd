//! Which vertices are one: those at the same place of a root, at the same point object, at the same
//! division of a stretch, and images of such. Never because they look close.

use crate::roots::{PlaceId, StretchId};
use crate::topology::{Frame, Rim, Skeleton};
use moldloft_num::trace::Key;
use moldloft_num::union_find::UnionFind;
use std::collections::HashMap;

/// Numbers of vertices before they are joined: patch by patch, `[i * (nv + 1) + j]` in each.
pub(crate) struct Grids {
    first: Vec<u32>,
}

impl Grids {
    pub fn new(skeleton: &Skeleton) -> Self {
        let mut first = vec![0];
        let mut count = 0;
        for frame in &skeleton.frames {
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
    pub fn edge(&self, frame: &Frame, patch: usize, k: usize) -> Vec<u32> {
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
    pub fn boundary(&self, frame: &Frame, patch: usize) -> Vec<u32> {
        (0..4).flat_map(|k| self.edge(frame, patch, k)).collect()
    }
}

pub(crate) struct Joiner<'s> {
    skeleton: &'s Skeleton,
    pub grids: Grids,
    pub joined: UnionFind,
    /// A vertex at each place.
    places: Vec<Option<u32>>,
    points: HashMap<Key, u32>,
    /// The vertices of a stretch with so many divisions, in the direction of its root.
    stretches: HashMap<(StretchId, u32), Vec<u32>>,
    images: HashMap<(u32, u32), u32>,
}

impl<'s> Joiner<'s> {
    pub fn new(skeleton: &'s Skeleton) -> Self {
        let grids = Grids::new(skeleton);
        let joined = UnionFind::new(grids.count() as usize);
        let mut joiner = Self {
            skeleton,
            grids,
            joined,
            places: vec![None; skeleton.points.len()],
            points: HashMap::new(),
            stretches: HashMap::new(),
            images: HashMap::new(),
        };
        for patch in 0..skeleton.frames.len() {
            joiner.join_edges(patch);
        }
        joiner
    }

    fn at_point(&mut self, vertex: u32, point: Key) {
        let known = *self.points.entry(point).or_insert(vertex);
        self.joined.join(known, vertex);
    }

    fn at_place(&mut self, vertex: u32, place: PlaceId) {
        match self.places[place as usize] {
            Some(known) => self.joined.join(known, vertex),
            None => {
                self.places[place as usize] = Some(vertex);
                let skeleton = self.skeleton;
                for &point in &skeleton.points[place as usize] {
                    self.at_point(vertex, point);
                }
            }
        }
    }

    fn join_edges(&mut self, patch: usize) {
        let skeleton = self.skeleton;
        let frame = &skeleton.frames[patch];
        let edges: [Vec<u32>; 4] = std::array::from_fn(|k| self.grids.edge(frame, patch, k));
        let [nu, nv] = frame.divisions;
        let corners = [edges[0][0], edges[0][nu], edges[2][nu], edges[3][nv]];
        for (vertex, point) in corners.into_iter().zip(frame.corners) {
            if let Some(point) = point {
                self.at_point(vertex, point);
            }
        }
        for (rim, vertices) in frame.rims.iter().zip(&edges) {
            match rim {
                Rim::Along(spans) => {
                    let mut at = 0;
                    for (span, count) in spans {
                        let end = at + *count as usize;
                        self.at_place(vertices[at], span.ends[0]);
                        self.at_place(vertices[end], span.ends[1]);
                        if let Some(stretch) = span.stretch {
                            self.along_stretch(stretch, &vertices[at..=end], span.backwards);
                        }
                        at = end;
                    }
                }
                Rim::Loose([from, to]) => {
                    self.at_place(vertices[0], *from);
                    self.at_place(vertices[vertices.len() - 1], *to);
                }
                Rim::Same(other) => {
                    let others = &edges[usize::from(*other)];
                    if others.len() == vertices.len() {
                        for (&a, &b) in vertices.iter().zip(others) {
                            self.joined.join(a, b);
                        }
                    }
                }
                Rim::Pole(point) => {
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

    fn along_stretch(&mut self, stretch: StretchId, vertices: &[u32], backwards: bool) {
        let n = vertices.len() - 1;
        let mut inside: Vec<u32> = vertices[1..n].to_vec();
        if backwards {
            inside.reverse();
        }
        let known = self.stretches.entry((stretch, n as u32)).or_insert_with(|| inside.clone());
        for (&a, &b) in known.iter().zip(&inside) {
            self.joined.join(a, b);
        }
    }

    /// Images of joined vertices under the same map are joined; a vertex that is its own image, as
    /// `fixed` says of (patch, vertex of the boundary), is joined to the original.
    pub fn join_images(&mut self, fixed: impl Fn(usize, usize) -> bool) {
        let skeleton = self.skeleton;
        for (patch, frame) in skeleton.frames.iter().enumerate() {
            let Some((original, map)) = frame.image else { continue };
            if skeleton.frames[original].divisions != frame.divisions {
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
