//! From surfaces to panels: patches from their own parameters and divisions, joined by identity.
//!
//! A patch of nu x nv divisions has a grid of vertices. Vertices of different patches become one
//! when they lie on the same root (see `moldloft_num::trace`) between the same ends at the same
//! division, or at the same point object; never because they look close. The position of a shared
//! vertex is computed once, by the first patch in the order of declaration.

use crate::{Graph, Object};
use moldloft_mesh::{Mesh, MeshError, PatchInfo, Tag, Topology, TopologyBuilder};
use moldloft_num::trace::{Edge, Edges, Key, Mark, Piece, Root};
use moldloft_num::{Real, Vec3};
use moldloft_registry::{Fault, Scalar, SurfaceRef, Value};
use std::collections::HashMap;
use std::sync::Arc;

/// The most panels of a model.
pub const MOST_PANELS: u64 = 20_000_000;

/// The fault of `count` panels.
pub fn too_many_panels(count: u64) -> Fault {
    Fault::new("too-many-panels", format!("{count} panels are too many"))
        .expected(format!("at most {MOST_PANELS}"))
        .found(count.to_string())
        .help("lower the divisions of the surfaces")
}

/// Two patches whose shared vertices disagree by more than this share of the model's size are
/// reported.
const JOIN_ACCURACY: f64 = 1e-9;

/// Which vertices there are and who computes them; independent of the scalar.
#[derive(Clone, Debug)]
pub struct Panelling {
    topology: Arc<Topology>,
    patches: Vec<PatchPlan>,
    remarks: Vec<Remark>,
}

#[derive(Clone, Debug)]
struct PatchPlan {
    name: Arc<str>,
    divisions: [usize; 2],
    /// Vertex of (i, j) at `[i * (nv + 1) + j]`.
    vertices: Vec<u32>,
}

/// Something about the joins that the user may want to know.
#[derive(Clone, Debug, PartialEq)]
pub enum Remark {
    /// Two patches run along the same curve but are divided differently, so they are not joined.
    Divisions {
        /// The patches.
        patches: [String; 2],
        /// Their divisions along it.
        divisions: [usize; 2],
    },
    /// A shared vertex is not in the same place on both patches.
    Apart {
        /// The patches.
        patches: [String; 2],
        /// How far apart the two positions are.
        distance: f64,
        /// Where.
        at: Vec3,
    },
}

impl std::fmt::Display for Remark {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        match self {
            Remark::Divisions { patches: [a, b], divisions: [m, n] } => write!(
                f,
                "`{a}` and `{b}` share a curve but have {m} and {n} divisions along it, so their \
                 panels do not join"
            ),
            Remark::Apart { patches: [a, b], distance, at } => write!(
                f,
                "`{a}` and `{b}` share an edge but lie {distance:.3e} apart at ({}, {}, {})",
                at.x, at.y, at.z
            ),
        }
    }
}

/// Where a vertex is, by identity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Spot {
    /// At a point object.
    Point(Key),
    /// At a place on a root that has no point object: the bits of the parameter.
    OnRoot(Root, u64),
    /// Division `at` of `of` between two marks of a root.
    Division { root: Root, from: MarkId, to: MarkId, at: u32, of: u32 },
    /// The image of a vertex under a map, given as the first object made by it.
    Image { map: u32, of: u32 },
}

/// The identity of a mark on a root.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum MarkId {
    Point(Key),
    At(u64),
}

fn mark_id<T: Real>(mark: &Mark<T>) -> MarkId {
    mark.point.map_or(MarkId::At(mark.t.re().to_bits()), MarkId::Point)
}

fn mark_spot<T: Real>(root: Root, mark: &Mark<T>) -> Spot {
    mark.point.map_or(Spot::OnRoot(root, mark.t.re().to_bits()), Spot::Point)
}

impl Panelling {
    /// The panelling of all shown surfaces that have a value.
    ///
    /// # Errors
    /// A [`Fault`] when there would be too many panels.
    pub fn new(graph: &Graph<f64>) -> Result<Self, Fault> {
        Planner::new(graph)?.plan()
    }

    /// The connectivity.
    pub fn topology(&self) -> &Arc<Topology> {
        &self.topology
    }

    /// What was noticed at the joins.
    pub fn remarks(&self) -> &[Remark] {
        &self.remarks
    }

    /// The names of the patches' surfaces, in the order of the topology's patches.
    pub fn surfaces(&self) -> impl Iterator<Item = &Arc<str>> {
        self.patches.iter().map(|p| &p.name)
    }

    /// The positions of all vertices, evaluated with the scalar of `graph`; `None` when a surface
    /// has no value there.
    pub fn positions<T: Scalar>(&self, graph: &Graph<T>) -> Option<Vec<Vec3<T>>> {
        let mut positions = vec![Vec3::zero(); self.topology.vertex_count()];
        // Backwards, so that the first patch has the last word.
        for patch in self.patches.iter().rev() {
            let surface = surface_of(graph.get(graph.find(&patch.name)?)?)?;
            for (&vertex, p) in patch.vertices.iter().zip(grid(surface, patch.divisions)) {
                positions[vertex as usize] = p;
            }
        }
        Some(positions)
    }

    /// The mesh, evaluated with the scalar of `graph`.
    pub fn mesh<T: Scalar>(&self, graph: &Graph<T>) -> Option<Mesh<T>> {
        Mesh::new(self.topology.clone(), self.positions(graph)?).ok()
    }
}

fn surface_of<T: Scalar>(object: &Object<T>) -> Option<&SurfaceRef<T>> {
    match object.value()? {
        Value::Surface(surface) => Some(surface),
        _ => None,
    }
}

/// The divisions of a surface: its own or, for an image without any, those of its original.
pub fn divisions<T: Scalar>(graph: &Graph<T>, object: &Object<T>) -> [u32; 2] {
    let mut at = object;
    while !at.head.divided
        && let Some((key, _)) = surface_of(at).and_then(|s| s.image_of())
        && let Some(original) = graph.get(key)
    {
        at = original;
    }
    at.head.divisions
}

fn uniform(n: usize) -> Vec<f64> {
    (0..=n).map(|i| i as f64 / n as f64).collect()
}

fn grid<T: Real>(surface: &SurfaceRef<T>, [nu, nv]: [usize; 2]) -> Vec<Vec3<T>> {
    let mut points = vec![Vec3::zero(); (nu + 1) * (nv + 1)];
    surface.grid(&uniform(nu), &uniform(nv), &mut points, None);
    points
}

struct Draft<'g> {
    object: &'g Object<f64>,
    surface: &'g SurfaceRef<f64>,
    divisions: [usize; 2],
    points: Vec<Vec3>,
    /// Number of its first vertex among all drafts'.
    first: u32,
    /// False for a hidden surface of which a shown one is the image.
    meshed: bool,
    reversed: bool,
}

impl Draft<'_> {
    fn vertex(&self, i: usize, j: usize) -> u32 {
        self.first + (i * (self.divisions[1] + 1) + j) as u32
    }

    /// The vertices of edge 0..4 (v = 0, u = 1, v = 1, u = 0) in increasing parameter.
    fn edge(&self, k: usize) -> Vec<u32> {
        let [nu, nv] = self.divisions;
        match k {
            0 => (0..=nu).map(|i| self.vertex(i, 0)).collect(),
            1 => (0..=nv).map(|j| self.vertex(nu, j)).collect(),
            2 => (0..=nu).map(|i| self.vertex(i, nv)).collect(),
            _ => (0..=nv).map(|j| self.vertex(0, j)).collect(),
        }
    }

    fn boundary(&self) -> Vec<u32> {
        (0..4).flat_map(|k| self.edge(k)).collect()
    }

    fn point(&self, vertex: u32) -> Vec3 {
        self.points[(vertex - self.first) as usize]
    }
}

struct Planner<'g> {
    drafts: Vec<Draft<'g>>,
    /// The draft of a surface object.
    by_key: HashMap<Key, usize>,
    joined: UnionFind,
    spots: HashMap<Spot, u32>,
    /// Which divisions each stretch of a root was given, and by which draft.
    stretches: HashMap<(Root, MarkId, MarkId), (usize, usize)>,
    remarks: Vec<Remark>,
}

impl<'g> Planner<'g> {
    fn new(graph: &'g Graph<f64>) -> Result<Self, Fault> {
        let mut drafts: Vec<Draft> = Vec::new();
        let mut total = 0u64;
        let mut draft = |object: &'g Object<f64>, meshed: bool, divisions: [u32; 2]| {
            let surface = surface_of(object)?;
            total += u64::from(divisions[0]) * u64::from(divisions[1]);
            Some(Draft {
                object,
                surface,
                divisions: divisions.map(|n| n as usize),
                points: Vec::new(),
                first: 0,
                meshed,
                reversed: false,
            })
        };
        let mut by_key = HashMap::new();
        for object in graph.objects().filter(|o| o.head.shown()) {
            if let Some(d) = draft(object, true, divisions(graph, object)) {
                by_key.insert(object.key, drafts.len());
                drafts.push(d);
            }
        }
        // Hidden originals of images take part without panels, so that the images still join.
        let mut at = 0;
        while at < drafts.len() {
            let original = drafts[at].surface.image_of().map(|(key, _)| key);
            let same = divisions(graph, drafts[at].object);
            at += 1;
            let Some(object) = original.and_then(|key| graph.get(key)) else { continue };
            if let std::collections::hash_map::Entry::Vacant(slot) = by_key.entry(object.key)
                && let Some(d) = draft(object, false, same)
            {
                slot.insert(drafts.len());
                drafts.push(d);
            }
        }
        if total > MOST_PANELS {
            return Err(too_many_panels(total));
        }
        let mut first = 0;
        for draft in &mut drafts {
            draft.first = first;
            draft.points = grid(draft.surface, draft.divisions);
            draft.reversed = reversed(graph, draft.object);
            first += draft.points.len() as u32;
        }
        Ok(Self {
            drafts,
            by_key,
            joined: UnionFind::new(first as usize),
            spots: HashMap::new(),
            stretches: HashMap::new(),
            remarks: Vec::new(),
        })
    }

    fn plan(mut self) -> Result<Panelling, Fault> {
        for at in 0..self.drafts.len() {
            self.join_edges(at);
        }
        self.join_images();
        self.check_joins();
        self.assemble().map_err(|e| Fault::new("too-many-panels", e.to_string()))
    }

    fn settle(&mut self, vertex: u32, spot: Spot) {
        let known = *self.spots.entry(spot).or_insert(vertex);
        self.joined.join(known, vertex);
    }

    fn join_edges(&mut self, at: usize) {
        let Edges { edges, corners } = self.drafts[at].surface.edges();
        let key = self.drafts[at].object.key;
        let [nu, nv] = self.drafts[at].divisions;
        let corner_vertices = [(0, 0), (nu, 0), (nu, nv), (0, nv)];
        for ((i, j), point) in corner_vertices.into_iter().zip(corners) {
            if let Some(point) = point {
                let vertex = self.drafts[at].vertex(i, j);
                self.settle(vertex, Spot::Point(point));
            }
        }
        for (k, edge) in edges.iter().enumerate() {
            let vertices = self.drafts[at].edge(k);
            match edge {
                Edge::Own => {
                    let end = |t: f64| Mark { t, point: None };
                    let whole = Piece {
                        root: Root::Edge(key, k as u8),
                        from: end(0.0),
                        to: end(1.0),
                        until: 1.0,
                    };
                    self.join_chain(at, &vertices, &[whole]);
                }
                Edge::Pieces(pieces) => self.join_chain(at, &vertices, pieces),
                Edge::SameAs(other) => {
                    let others = self.drafts[at].edge(usize::from(*other));
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
                        self.settle(vertices[0], Spot::Point(*point));
                    }
                }
            }
        }
    }

    /// Joins the vertices of an edge along a chain of pieces, as far as divisions fall on the
    /// pieces' ends.
    fn join_chain(&mut self, at: usize, vertices: &[u32], pieces: &[Piece<f64>]) {
        let n = vertices.len() - 1;
        let mut begin = 0.0;
        for piece in pieces {
            let (low, high) = (begin * n as f64, piece.until * n as f64);
            begin = piece.until;
            let (first, last) = (low.round(), high.round());
            // A break between divisions leaves this piece unjoined; rounding of k/n is forgiven.
            if (low - first).abs() > 1e-9 || (high - last).abs() > 1e-9 || last <= first {
                continue;
            }
            self.join_piece(at, &vertices[first as usize..=last as usize], piece);
        }
    }

    fn join_piece(&mut self, at: usize, vertices: &[u32], piece: &Piece<f64>) {
        let n = vertices.len() - 1;
        let backwards = piece.from.t > piece.to.t;
        let (from, to) = if backwards { (piece.to, piece.from) } else { (piece.from, piece.to) };
        let (low, high) = (mark_id(&from), mark_id(&to));
        let known = *self.stretches.entry((piece.root, low, high)).or_insert((at, n));
        if known.1 != n {
            let name = |d: usize| self.drafts[d].object.name.to_string();
            self.remarks.push(Remark::Divisions {
                patches: [name(known.0), name(at)],
                divisions: [known.1, n],
            });
        }
        for (m, &vertex) in vertices.iter().enumerate() {
            let m = if backwards { n - m } else { m };
            let spot = if m == 0 {
                mark_spot(piece.root, &from)
            } else if m == n {
                mark_spot(piece.root, &to)
            } else {
                Spot::Division { root: piece.root, from: low, to: high, at: m as u32, of: n as u32 }
            };
            self.settle(vertex, spot);
        }
    }

    /// Images of joined vertices under the same map are joined; a vertex that is its own image is
    /// joined to the original.
    fn join_images(&mut self) {
        let mut maps: HashMap<String, u32> = HashMap::new();
        for at in 0..self.drafts.len() {
            let draft = &self.drafts[at];
            let Some((of, _)) = draft.surface.image_of() else { continue };
            let Some(&original) = self.by_key.get(&of) else { continue };
            if self.drafts[original].divisions != draft.divisions {
                continue;
            }
            let next = maps.len() as u32;
            let map = *maps.entry(map_identity(draft.object, of)).or_insert(next);
            let shift = self.drafts[original].first;
            let first = draft.first;
            for vertex in draft.boundary() {
                let twin = vertex - first + shift;
                let (p, q) = (self.drafts[at].point(vertex), self.drafts[original].point(twin));
                // -0 and 0 are one place.
                if p == q {
                    self.joined.join(twin, vertex);
                } else {
                    let of = self.joined.find(twin);
                    self.settle(vertex, Spot::Image { map, of });
                }
            }
        }
    }

    fn check_joins(&mut self) {
        let size = self
            .drafts
            .iter()
            .flat_map(|d| &d.points)
            .fold(moldloft_num::Box3::EMPTY, |b, &p| b.including(p))
            .diagonal();
        let mut owner: HashMap<u32, (usize, Vec3)> = HashMap::new();
        let mut worst: HashMap<(usize, usize), (f64, Vec3)> = HashMap::new();
        for at in 0..self.drafts.len() {
            for vertex in self.drafts[at].boundary() {
                let p = self.drafts[at].point(vertex);
                let (first, q) = *owner.entry(self.joined.find(vertex)).or_insert((at, p));
                let distance = p.distance(q);
                if distance > JOIN_ACCURACY * size {
                    let entry = worst.entry((first, at)).or_insert((0.0, p));
                    if distance > entry.0 {
                        *entry = (distance, p);
                    }
                }
            }
        }
        let mut worst: Vec<_> = worst.into_iter().collect();
        worst.sort_by_key(|(pair, _)| *pair);
        for ((a, b), (distance, at)) in worst {
            let name = |d: usize| self.drafts[d].object.name.to_string();
            self.remarks.push(Remark::Apart { patches: [name(a), name(b)], distance, at });
        }
    }

    /// True when the panels as a whole, turned as their surfaces say, face inward: then all of
    /// them are turned round. A closed mesh has a negative volume then; of an open one, the cone
    /// from the middle of its rim has. A flat one faces as its surface says.
    fn faces_inward(&mut self) -> bool {
        let mut rim: HashMap<(u32, u32), (u32, Vec3, Vec3)> = HashMap::new();
        for at in 0..self.drafts.len() {
            if !self.drafts[at].meshed {
                continue;
            }
            for k in 0..4 {
                for pair in self.drafts[at].edge(k).windows(2) {
                    let (a, b) = (self.joined.find(pair[0]), self.joined.find(pair[1]));
                    if a != b {
                        let ends = (self.drafts[at].point(pair[0]), self.drafts[at].point(pair[1]));
                        rim.entry((a.min(b), a.max(b))).or_insert((0, ends.0, ends.1)).0 += 1;
                    }
                }
            }
        }
        let mut open: Vec<_> = rim.into_iter().filter(|(_, (count, ..))| *count == 1).collect();
        // In a fixed order, so that the sum has the same bits every time.
        open.sort_unstable_by_key(|(edge, _)| *edge);
        let (mut centre, mut length) = (Vec3::zero(), 0.0);
        for (_, (_, a, b)) in open {
            let step = a.distance(b);
            centre += (a + b) * (0.5 * step);
            length += step;
        }
        if length > 0.0 {
            centre = centre / length;
        }
        let (mut volume, mut size) = (0.0, 0.0);
        for draft in self.drafts.iter().filter(|d| d.meshed) {
            let [nu, nv] = draft.divisions;
            let sign = if draft.reversed { -1.0 } else { 1.0 };
            let at = |i: usize, j: usize| draft.points[i * (nv + 1) + j] - centre;
            for (i, j) in (0..nu).flat_map(|i| (0..nv).map(move |j| (i, j))) {
                let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
                let cone = (a + c).dot((c - a).cross(d - b));
                volume += sign * cone;
                size += cone.abs();
            }
        }
        volume < -1e-6 * size
    }

    fn assemble(mut self) -> Result<Panelling, MeshError> {
        let mut builder = TopologyBuilder::new();
        let mut number: HashMap<u32, u32> = HashMap::new();
        let mut patches = Vec::new();
        let mut count = 0u32;
        for draft in self.drafts.iter().filter(|d| d.meshed) {
            let vertices: Vec<u32> = (draft.first..draft.first + draft.points.len() as u32)
                .map(|v| {
                    *number.entry(self.joined.find(v)).or_insert_with(|| {
                        count += 1;
                        count - 1
                    })
                })
                .collect();
            patches.push(PatchPlan {
                name: draft.object.name.clone(),
                divisions: draft.divisions,
                vertices,
            });
        }
        builder.add_vertices(count as usize)?;
        let inward = self.faces_inward();
        let meshed = self.drafts.iter().filter(|d| d.meshed);
        for (patch, draft) in patches.iter().zip(meshed) {
            let [nu, nv] = patch.divisions;
            let info = PatchInfo {
                name: patch.name.to_string(),
                tag: Tag::Wetted,
                colour: Some((draft.object.head.colour & 15) as u8),
                kind: draft.object.row.name.to_string(),
            };
            let reversed = draft.reversed != inward;
            builder.add_block(info, nu + 1, nv + 1, patch.vertices.clone(), reversed)?;
        }
        Ok(Panelling { topology: builder.build().into(), patches, remarks: self.remarks })
    }
}

/// True when panels run against the natural normal: by the user's word, or because the surface
/// is a mirror image, whose natural normal points the other way.
fn reversed(graph: &Graph<f64>, object: &Object<f64>) -> bool {
    let mut turned = false;
    let mut at = Some(object);
    while let Some(object) = at {
        turned ^= object.head.orientation == 1;
        at = surface_of(object).and_then(|s| s.image_of()).and_then(|(key, turns)| {
            turned ^= turns;
            graph.get(key)
        });
    }
    turned
}

/// The map of an image: its kind and its arguments other than the original.
fn map_identity(object: &Object<f64>, original: Key) -> String {
    let rest: Vec<_> = object
        .args
        .iter()
        .filter(|arg| !matches!(arg, Value::Object(key) if *key == original))
        .collect();
    format!("{}{rest:?}", object.row.name)
}

/// Sets of vertices that are one; the smallest number stands for the set.
struct UnionFind {
    parent: Vec<u32>,
}

impl UnionFind {
    fn new(n: usize) -> Self {
        Self { parent: (0..n as u32).collect() }
    }

    fn find(&mut self, mut v: u32) -> u32 {
        while self.parent[v as usize] != v {
            let above = self.parent[self.parent[v as usize] as usize];
            self.parent[v as usize] = above;
            v = above;
        }
        v
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        self.parent[a.max(b) as usize] = a.min(b);
    }
}
