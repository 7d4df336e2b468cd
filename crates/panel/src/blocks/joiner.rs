//! Identity of the vertices of blocks.

use super::draft::{BlockDraft, FaceId, RootInterval, face_axes, face_id, grid, interval};
use super::marks::{Marks, runs};
use super::notes::BlockNote;
use moldloft_num::trace::{Edge, Edges, Face, Key, LayerLaw, Mark, Piece, Root, Turn};
use moldloft_num::union_find::UnionFind;
use moldloft_num::{Box3, Vec3};
use std::collections::{HashMap, HashSet};

/// Difference of the positions of shared vertices, relative to the model's size, from which blocks
/// are reported.
const JOIN_ACCURACY: f64 = 1e-9;

#[derive(Clone, Debug, PartialEq, Eq, Hash)]
enum VertexIdentity {
    Point(Key),
    OnRoot(Root, u64),
    Division(RootInterval, u32, u32),
    /// Point (i, j) of a face divided m x n times, in the surface's own parameters.
    OnFace(FaceId, [u32; 2], [u32; 2]),
    /// Division `at` of `of` of a line along w between vertices that are one.
    OnLine(Vec<u32>, LayerLaw, u32, u32),
}

/// Vertices of a surface's grid in its own parameters.
struct FaceGrid {
    /// Divisions along u and v.
    size: [usize; 2],
    /// At `[i * (size[1] + 1) + j]`.
    vertices: Vec<u32>,
}

impl FaceGrid {
    fn at(&self, i: usize, j: usize) -> u32 {
        self.vertices[i * (self.size[1] + 1) + j]
    }

    fn edge(&self, k: usize) -> Vec<u32> {
        let [nu, nv] = self.size;
        match k {
            0 => (0..=nu).map(|i| self.at(i, 0)).collect(),
            1 => (0..=nv).map(|j| self.at(nu, j)).collect(),
            2 => (0..=nu).map(|i| self.at(i, nv)).collect(),
            _ => (0..=nv).map(|j| self.at(0, j)).collect(),
        }
    }
}

pub(crate) struct BlockJoiner<'a, 'g> {
    pub drafts: &'a [BlockDraft<'g>],
    divisions: &'a [[usize; 3]],
    /// The first vertex of each block.
    pub first: Vec<u32>,
    /// The first vertex of each inner layer of each block: layers 1, 2, ... of a loft.
    layers: Vec<Vec<u32>>,
    pub joined: UnionFind,
    spots: HashMap<VertexIdentity, u32>,
    /// Faces of solids that are surfaces elsewhere.
    named_faces: HashSet<(Key, u8)>,
    pub marks: Marks,
}

impl<'a, 'g> BlockJoiner<'a, 'g> {
    pub fn new(drafts: &'a [BlockDraft<'g>], divisions: &'a [[usize; 3]]) -> Self {
        let (mut first, mut layers) = (Vec::new(), Vec::new());
        let mut next = 0u32;
        for (draft, [nu, nv, nw]) in drafts.iter().zip(divisions) {
            first.push(next);
            next += ((nu + 1) * (nv + 1) * (nw + 1)) as u32;
            let inner =
                draft.faces.layers.as_ref().map_or(0, |l| l.surfaces.len().saturating_sub(2));
            let sheet = ((nu + 1) * (nv + 1)) as u32;
            layers.push((0..inner as u32).map(|l| next + l * sheet).collect());
            next += inner as u32 * sheet;
        }
        let all = drafts.iter().flat_map(|d| &d.faces.faces);
        let named_faces = all.filter_map(|face| match face {
            Face::On { face_of, .. } => *face_of,
            _ => None,
        });
        Self {
            drafts,
            divisions,
            first,
            layers,
            joined: UnionFind::new(next as usize),
            spots: HashMap::new(),
            named_faces: named_faces.collect(),
            marks: Marks::new(drafts),
        }
    }

    pub fn vertex(&self, b: usize, [i, j, k]: [usize; 3]) -> u32 {
        let [_, nv, nw] = self.divisions[b];
        self.first[b] + ((i * (nv + 1) + j) * (nw + 1) + k) as u32
    }

    /// The vertex at a corner, u, v, w being bits 0, 1 and 2 of its number.
    pub fn corner(&self, b: usize, c: usize) -> u32 {
        let n = self.divisions[b];
        self.vertex(b, [0, 1, 2].map(|axis| if c >> axis & 1 == 1 { n[axis] } else { 0 }))
    }

    /// The vertices of face 0..6 of a block in the parameters of a surface turned so.
    fn sheet(&self, b: usize, face: usize, turn: Turn) -> FaceGrid {
        let n = self.divisions[b];
        let [p, q] = face_axes(face);
        let size = if turn.swaps() { [n[q], n[p]] } else { [n[p], n[q]] };
        let mut vertices = Vec::with_capacity((size[0] + 1) * (size[1] + 1));
        for i in 0..=size[0] {
            for j in 0..=size[1] {
                let i = if turn.flips(0) { size[0] - i } else { i };
                let j = if turn.flips(1) { size[1] - j } else { j };
                let (a, c) = if turn.swaps() { (j, i) } else { (i, j) };
                let mut place = [0; 3];
                (place[p], place[q]) = (a, c);
                place[face / 2] = if face % 2 == 1 { n[face / 2] } else { 0 };
                vertices.push(self.vertex(b, place));
            }
        }
        FaceGrid { size, vertices }
    }

    /// The vertices of layer `l` of a block: of its faces w = 0 and w = 1, or of an inner one.
    fn layer(&self, b: usize, l: usize, count: usize) -> FaceGrid {
        if l == 0 {
            return self.sheet(b, 4, Turn::default());
        }
        if l + 1 == count {
            return self.sheet(b, 5, Turn::default());
        }
        let [nu, nv, _] = self.divisions[b];
        let first = self.layers[b][l - 1];
        let vertices = (first..first + ((nu + 1) * (nv + 1)) as u32).collect();
        FaceGrid { size: [nu, nv], vertices }
    }

    fn identify(&mut self, vertex: u32, spot: VertexIdentity) {
        let known = *self.spots.entry(spot).or_insert(vertex);
        self.joined.join(known, vertex);
    }

    pub fn join_all(&mut self) {
        let drafts = self.drafts;
        for (b, draft) in drafts.iter().enumerate() {
            for (c, point) in draft.faces.corners.iter().enumerate() {
                if let Some(point) = point {
                    self.identify(self.corner(b, c), VertexIdentity::Point(*point));
                }
            }
            for (f, face) in draft.faces.faces.iter().enumerate() {
                self.join_face(b, f, face);
            }
            if let Some(layers) = &draft.faces.layers {
                let count = layers.surfaces.len();
                for (l, (_, edges)) in layers.surfaces.iter().enumerate() {
                    // The outer ones of a loft are faces; the one of a moved surface, too.
                    if l > 0 && l + 1 < count {
                        let sheet = self.layer(b, l, count);
                        self.join_edges(&sheet, edges);
                    }
                }
            }
        }
        for b in 0..drafts.len() {
            self.join_lines(b);
        }
    }

    fn join_face(&mut self, b: usize, f: usize, face: &Face<f64>) {
        let own = self.drafts[b].object.key;
        match face {
            Face::Own => {
                if self.named_faces.contains(&(own, f as u8)) {
                    let sheet = self.sheet(b, f, Turn::default());
                    self.join_places(&sheet, FaceId::Solid(own, f as u8));
                }
            }
            Face::On { surface, face_of, turn, edges } => {
                let sheet = self.sheet(b, f, *turn);
                self.join_edges(&sheet, edges);
                if let Some(id) = face_id(*surface, *face_of) {
                    self.join_places(&sheet, id);
                }
                if self.named_faces.contains(&(own, f as u8)) {
                    let sheet = self.sheet(b, f, Turn::default());
                    self.join_places(&sheet, FaceId::Solid(own, f as u8));
                }
            }
            Face::SameAs(other) => {
                let (a, c) = (
                    self.sheet(b, f, Turn::default()),
                    self.sheet(b, usize::from(*other), Turn::default()),
                );
                for (v, w) in a.vertices.into_iter().zip(c.vertices) {
                    self.joined.join(v, w);
                }
            }
        }
    }

    /// Joins the vertices of a whole face with those of the same face elsewhere.
    fn join_places(&mut self, sheet: &FaceGrid, id: FaceId) {
        let [nu, nv] = sheet.size;
        let size = sheet.size.map(|n| n as u32);
        for i in 0..=nu {
            for j in 0..=nv {
                self.identify(
                    sheet.at(i, j),
                    VertexIdentity::OnFace(id, [i as u32, j as u32], size),
                );
            }
        }
    }

    fn join_edges(&mut self, sheet: &FaceGrid, edges: &Edges<f64>) {
        let [nu, nv] = sheet.size;
        for ((i, j), point) in [(0, 0), (nu, 0), (nu, nv), (0, nv)].into_iter().zip(edges.corners) {
            if let Some(point) = point {
                self.identify(sheet.at(i, j), VertexIdentity::Point(point));
            }
        }
        for (k, edge) in edges.edges.iter().enumerate() {
            let vertices = sheet.edge(k);
            match edge {
                Edge::Own => {}
                Edge::Pieces(pieces) => self.join_chain(&vertices, pieces),
                Edge::SameAs(other) => {
                    let others = sheet.edge(usize::from(*other));
                    if others.len() == vertices.len() {
                        for (a, b) in vertices.into_iter().zip(others) {
                            self.joined.join(a, b);
                        }
                    }
                }
                Edge::Pole(point) => {
                    for &vertex in &vertices {
                        self.joined.join(vertices[0], vertex);
                    }
                    if let Some(point) = point {
                        self.identify(vertices[0], VertexIdentity::Point(*point));
                    }
                }
            }
        }
    }

    /// Joins an edge along a chain of pieces, as far as divisions fall on the ends of their parts.
    fn join_chain(&mut self, vertices: &[u32], pieces: &[Piece<f64>]) {
        for (first, last, piece) in runs(&self.marks.parts(pieces), vertices.len() - 1) {
            let part = &vertices[first..=last];
            let (id, backwards) = interval(&piece);
            let (from, to) =
                if backwards { (&piece.to, &piece.from) } else { (&piece.from, &piece.to) };
            let count = part.len() - 1;
            for (m, &vertex) in part.iter().enumerate() {
                let m = if backwards { count - m } else { m };
                let end = |mark: &Mark<f64>| match mark.point {
                    Some(point) => VertexIdentity::Point(point),
                    None => VertexIdentity::OnRoot(piece.root, mark.t.to_bits()),
                };
                let spot = match m {
                    0 => end(from),
                    m if m == count => end(to),
                    m => VertexIdentity::Division(id, m as u32, count as u32),
                };
                self.identify(vertex, spot);
            }
        }
    }

    /// Representatives of the vertices of all layers at (i, j).
    pub fn roots(&mut self, b: usize, [i, j]: [usize; 2]) -> Vec<u32> {
        let count = self.drafts[b].faces.layers.as_ref().map_or(0, |l| l.surfaces.len());
        let [_, nv, nw] = self.divisions[b];
        (0..count)
            .map(|l| {
                let vertex = match l {
                    0 => self.vertex(b, [i, j, 0]),
                    l if l + 1 == count => self.vertex(b, [i, j, nw]),
                    l => self.layers[b][l - 1] + (i * (nv + 1) + j) as u32,
                };
                self.joined.find(vertex)
            })
            .collect()
    }

    /// Joins the lines along w at the rim of the layers.
    fn join_lines(&mut self, b: usize) {
        let Some(law) = self.drafts[b].faces.layers.as_ref().map(|l| l.law) else { return };
        if matches!(law, LayerLaw::Along(None, _)) {
            return;
        }
        let [nu, nv, nw] = self.divisions[b];
        // A moved surface has no layer at w = 1; a loft has.
        let last = if matches!(law, LayerLaw::Along(..)) { nw } else { nw - 1 };
        for i in 0..=nu {
            for j in 0..=nv {
                if i > 0 && i < nu && j > 0 && j < nv {
                    continue;
                }
                let mut roots = self.roots(b, [i, j]);
                // A loft is the same one from its other end.
                let turned = !matches!(law, LayerLaw::Along(..)) && roots.last() < roots.first();
                if turned {
                    roots.reverse();
                }
                for k in 1..=last {
                    let at = if turned { nw - k } else { k };
                    let spot = VertexIdentity::OnLine(roots.clone(), law, at as u32, nw as u32);
                    self.identify(self.vertex(b, [i, j, k]), spot);
                }
            }
        }
    }

    /// Shared vertices with different positions.
    pub fn apart(&mut self) -> Vec<BlockNote> {
        let mut owner: HashMap<u32, (usize, Vec3)> = HashMap::new();
        let mut worst: HashMap<(usize, usize), (f64, Vec3)> = HashMap::new();
        let grids: Vec<Vec<Vec3>> =
            self.drafts.iter().zip(self.divisions).map(|(d, &n)| grid(d.solid, n)).collect();
        let size = Box3::around(grids.iter().flatten().copied()).diagonal();
        for (b, points) in grids.iter().enumerate() {
            for (v, &p) in points.iter().enumerate() {
                let root = self.joined.find(self.first[b] + v as u32);
                let (first, q) = *owner.entry(root).or_insert((b, p));
                let distance = p.distance(q);
                if distance > JOIN_ACCURACY * size {
                    let entry = worst.entry((first, b)).or_insert((0.0, p));
                    if distance > entry.0 {
                        *entry = (distance, p);
                    }
                }
            }
        }
        let mut worst: Vec<_> = worst.into_iter().collect();
        worst.sort_by_key(|(pair, _)| *pair);
        let name = |b: usize| self.drafts[b].object.name.to_string();
        let remark = |((a, b), (distance, at))| BlockNote::Apart {
            blocks: [name(a), name(b)],
            distance,
            at,
        };
        worst.into_iter().map(remark).collect()
    }
}
