//! From surfaces to panels: patches from their own parameters and divisions, joined by identity.
//!
//! `surfaces -> drafts -> roots cut into stretches -> counts -> skeleton -> joined vertices -> panels`
//!
//! A patch of nu x nv divisions has a grid of vertices. Its edges run along stretches of roots (see
//! `moldloft_num::trace` and [`roots`]); counts flow from patch to patch along these ([`divide`]),
//! and where an edge has several stretches their ends fall on divisions ([`spread`]). Vertices of
//! different patches become one when they are the same division of the same stretch, or lie at the
//! same point object ([`join`]); never because they look close. The position of a shared vertex is
//! computed once, by the first patch in the order of declaration.

mod divide;
mod join;
mod remark;
mod roots;
mod skeleton;
mod spread;

pub use remark::{ChainStep, Remark};

use crate::{Graph, Object};
use join::{Grids, Joiner};
use moldloft_mesh::{Mesh, MeshError, PatchInfo, Tag, Topology, TopologyBuilder};
use moldloft_num::trace::{Edges, Key};
use moldloft_num::{Box3, Real, Vec3};
use moldloft_registry::{Fault, Point, Scalar, SurfaceRef, Value};
use roots::Roots;
use skeleton::{Rim, Skeleton};
use spread::{EdgePlan, Places, along_edge, evaluated};
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
    skeleton: Arc<Skeleton>,
    /// The vertices of each patch that has panels, that of (i, j) at `[i * (nv + 1) + j]`.
    vertices: Arc<Vec<Vec<u32>>>,
    /// The points of each patch by itself, in the order of the skeleton.
    points: Vec<Arc<Vec<Vec3>>>,
    /// Point objects whose parameters divide edges, by their identity where this was made.
    names: Arc<HashMap<Key, Arc<str>>>,
    remarks: Vec<Remark>,
    measured: bool,
}

/// The counts of divisions of another state of a model, to be kept where they are free.
#[derive(Clone, Debug, Default)]
pub struct Nominal(HashMap<Arc<str>, Counts>);

#[derive(Clone, Debug)]
struct Counts {
    divisions: [usize; 2],
    edges: [Vec<u32>; 4],
}

impl Panelling {
    /// The panelling of all shown surfaces that have a value.
    ///
    /// # Errors
    /// A [`Fault`] when there would be too many panels.
    pub fn new(graph: &Graph<f64>) -> Result<Self, Fault> {
        Self::like(graph, None)
    }

    /// The same with the counts of `nominal` wherever nothing else determines them.
    ///
    /// # Errors
    /// A [`Fault`] when there would be too many panels.
    pub fn like(graph: &Graph<f64>, nominal: Option<&Nominal>) -> Result<Self, Fault> {
        let drafts = drafts(graph);
        let made = skeleton::make(graph, Roots::new(graph, &drafts), &drafts, nominal);
        let count = |frame: &skeleton::Frame| frame.divisions[0] as u64 * frame.divisions[1] as u64;
        let total: u64 = made.skeleton.frames.iter().map(count).sum();
        if total > MOST_PANELS {
            return Err(too_many_panels(total));
        }
        let skeleton = Arc::new(made.skeleton);
        let mut panelling = Self {
            topology: Arc::default(),
            names: Arc::new(names(graph, &skeleton)),
            points: Vec::new(),
            vertices: Arc::default(),
            skeleton,
            remarks: made.remarks,
            measured: made.measured,
        };
        let evaluated = panelling.evaluated(graph);
        // Every draft has a value in its own graph.
        panelling.points = evaluated.into_iter().flatten().collect();
        panelling.join().map_err(|e| Fault::new("too-many-panels", e.to_string()))?;
        Ok(panelling)
    }

    /// The connectivity.
    pub fn topology(&self) -> &Arc<Topology> {
        &self.topology
    }

    /// What was noticed at the joins.
    pub fn remarks(&self) -> &[Remark] {
        &self.remarks
    }

    /// True when some count follows from lengths, so that it may change with the shape.
    pub fn is_measured(&self) -> bool {
        self.measured
    }

    /// Its counts, for [`Self::like`].
    pub fn nominal(&self) -> Nominal {
        let counts = self.skeleton.frames.iter().map(|frame| {
            let edges = std::array::from_fn(|k| match &frame.rims[k] {
                Rim::Along(spans) => {
                    spans.iter().filter(|(s, _)| s.stretch.is_some()).map(|(_, n)| *n).collect()
                }
                _ => Vec::new(),
            });
            (frame.name.clone(), Counts { divisions: frame.divisions, edges })
        });
        Nominal(counts.collect())
    }

    /// The names of the patches' surfaces, in the order of the topology's patches.
    pub fn surfaces(&self) -> impl Iterator<Item = &Arc<str>> {
        self.skeleton.frames.iter().filter(|f| f.meshed).map(|f| &f.name)
    }

    /// The positions of all vertices, evaluated with the scalar of `graph`; `None` when a surface
    /// has no value there.
    pub fn positions<T: Scalar>(&self, graph: &Graph<T>) -> Option<Vec<Vec3<T>>> {
        let points: Option<Vec<_>> = self.evaluated(graph).into_iter().collect();
        Some(self.gathered(&points?))
    }

    /// The mesh, evaluated with the scalar of `graph`.
    pub fn mesh<T: Scalar>(&self, graph: &Graph<T>) -> Option<Mesh<T>> {
        Mesh::new(self.topology.clone(), self.positions(graph)?).ok()
    }

    /// The mesh at the state that the panelling was made of.
    pub fn own_mesh(&self) -> Option<Mesh<f64>> {
        Mesh::new(self.topology.clone(), self.gathered(&self.points)).ok()
    }

    /// The vertices' positions from those of the patches by themselves.
    fn gathered<T: Real>(&self, points: &[Arc<Vec<Vec3<T>>>]) -> Vec<Vec3<T>> {
        let mut positions = vec![Vec3::zero(); self.topology.vertex_count()];
        let meshed = self.skeleton.frames.iter().zip(points).filter(|(f, _)| f.meshed);
        let patches: Vec<_> = meshed.map(|(_, p)| p).zip(self.vertices.iter()).collect();
        // Backwards, so that the first patch has the last word.
        for (points, vertices) in patches.into_iter().rev() {
            for (&vertex, &p) in vertices.iter().zip(points.iter()) {
                positions[vertex as usize] = p;
            }
        }
        positions
    }

    /// The points of each patch by itself, evaluated with the scalar of `graph`.
    fn evaluated<T: Scalar>(&self, graph: &Graph<T>) -> Vec<Option<Arc<Vec<Vec3<T>>>>> {
        let frames = &self.skeleton.frames;
        let known = Known::new(graph, &self.skeleton, &self.names);
        frames
            .iter()
            .enumerate()
            .map(|(patch, _)| {
                let surface = known.surfaces[patch].as_ref()?;
                let edge = |k: usize| along_edge(k, patch as u32, &known);
                let edges = [edge(0)?, edge(1)?, edge(2)?, edge(3)?];
                Some(Arc::new(evaluated(surface, &edges)))
            })
            .collect()
    }

    /// Joins the vertices and numbers them.
    fn join(&mut self) -> Result<(), MeshError> {
        let skeleton = self.skeleton.clone();
        let mut joiner = Joiner::new(&skeleton);
        let points = &self.points;
        joiner.join_images(|patch, at| {
            let Some((original, _)) = skeleton.frames[patch].image else { return false };
            let vertex = boundary_index(&skeleton.frames[patch], at);
            // -0 and 0 are one place.
            points[patch][vertex] == points[original][vertex]
        });
        let Joiner { grids, mut joined, .. } = joiner;
        self.remarks.extend(apart(&skeleton, points, &grids, &mut joined));
        let inward = faces_inward(&skeleton, points, &grids, &mut joined);
        let mut builder = TopologyBuilder::new();
        let mut number = vec![u32::MAX; grids.count() as usize];
        let mut count = 0u32;
        let mut patches = Vec::new();
        for (patch, _) in skeleton.frames.iter().enumerate().filter(|(_, f)| f.meshed) {
            let vertices = grids.all(patch).map(|v| {
                let number = &mut number[joined.find(v) as usize];
                if *number == u32::MAX {
                    *number = count;
                    count += 1;
                }
                *number
            });
            patches.push(vertices.collect::<Vec<u32>>());
        }
        builder.add_vertices(count as usize)?;
        let meshed = skeleton.frames.iter().filter(|f| f.meshed);
        for (vertices, frame) in patches.iter().zip(meshed) {
            let [nu, nv] = frame.divisions;
            let info = PatchInfo {
                name: frame.name.to_string(),
                tag: Tag::Wetted,
                colour: Some((frame.colour & 15) as u8),
                kind: frame.kind.to_string(),
            };
            let reversed = frame.reversed != inward;
            builder.add_block(info, nu + 1, nv + 1, vertices.clone(), reversed)?;
        }
        self.topology = builder.build().into();
        self.vertices = Arc::new(patches);
        Ok(())
    }
}

/// The place in the patch's grid of entry `at` of [`Grids::boundary`].
fn boundary_index(frame: &skeleton::Frame, mut at: usize) -> usize {
    let [nu, nv] = frame.divisions;
    let index = |i: usize, j: usize| i * (nv + 1) + j;
    if at <= nu {
        return index(at, 0);
    }
    at -= nu + 1;
    if at <= nv {
        return index(nu, at);
    }
    at -= nv + 1;
    if at <= nu {
        return index(at, nv);
    }
    index(0, at - nu - 1)
}

fn surface_of<T: Scalar>(object: &Object<T>) -> Option<&SurfaceRef<T>> {
    match object.value()? {
        Value::Surface(surface) => Some(surface),
        _ => None,
    }
}

/// The divisions of a surface by itself: its own or, for an image without any, those of its
/// original; where it leaves them to its neighbours, the usual ones.
pub fn divisions<T: Scalar>(graph: &Graph<T>, object: &Object<T>) -> [u32; 2] {
    let mut at = object;
    while !at.head.divided
        && let Some((key, _)) = surface_of(at).and_then(|s| s.image_of())
        && let Some(original) = graph.get(key)
    {
        at = original;
    }
    at.head.own_divisions()
}

/// A surface to be panelled.
struct Draft<'g> {
    object: &'g Object<f64>,
    surface: &'g SurfaceRef<f64>,
    edges: Edges<f64>,
    /// The draft of which it is the image, and the number of the map.
    image: Option<(usize, u32)>,
    /// False for a hidden surface of which a shown one is the image.
    meshed: bool,
    reversed: bool,
}

/// The surfaces that take part, in the order of declaration, hidden ones last.
fn drafts(graph: &Graph<f64>) -> Vec<Draft<'_>> {
    let mut drafts: Vec<Draft> = Vec::new();
    let draft = |object, meshed| {
        let surface = surface_of(object)?;
        let (edges, reversed) = (surface.edges(), reversed(graph, object));
        Some(Draft { object, surface, edges, image: None, meshed, reversed })
    };
    let mut by_key = HashMap::new();
    for object in graph.objects().filter(|o| o.head.shown()) {
        if let Some(d) = draft(object, true) {
            by_key.insert(object.key, drafts.len());
            drafts.push(d);
        }
    }
    // Hidden originals of images take part without panels, so that the images still join.
    let mut maps: HashMap<String, u32> = HashMap::new();
    let mut at = 0;
    while at < drafts.len() {
        let original = drafts[at].surface.image_of().and_then(|(key, _)| graph.get(key));
        if let Some(object) = original {
            if let std::collections::hash_map::Entry::Vacant(slot) = by_key.entry(object.key)
                && let Some(d) = draft(object, false)
            {
                slot.insert(drafts.len());
                drafts.push(d);
            }
            let next = maps.len() as u32;
            let map = map_identity(drafts[at].object, object.key);
            let map = *maps.entry(map).or_insert(next);
            drafts[at].image = by_key.get(&object.key).map(|&original| (original, map));
        }
        at += 1;
    }
    drafts
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

/// The names of the point objects that plans of edges refer to.
fn names(graph: &Graph<f64>, skeleton: &Skeleton) -> HashMap<Key, Arc<str>> {
    let mut names = HashMap::new();
    for plan in skeleton.frames.iter().flat_map(|f| &f.plans) {
        let EdgePlan::Segments(segments) = plan else { continue };
        for segment in segments {
            if let roots::Stop::Inside(_, source) = segment.until
                && let roots::MarkSource::Bead(key) | roots::MarkSource::Magnet(key, _) = source
                && let Some(object) = graph.get(key)
            {
                names.insert(key, object.name.clone());
            }
        }
    }
    names
}

/// What a graph, of any scalar, says of the patches of a skeleton.
struct Known<'a, T: Scalar> {
    graph: &'a Graph<T>,
    skeleton: &'a Skeleton,
    names: &'a HashMap<Key, Arc<str>>,
    keys: Vec<Option<Key>>,
    surfaces: Vec<Option<SurfaceRef<T>>>,
    edges: Vec<Option<Edges<T>>>,
}

impl<'a, T: Scalar> Known<'a, T> {
    fn new(graph: &'a Graph<T>, skeleton: &'a Skeleton, names: &'a HashMap<Key, Arc<str>>) -> Self {
        let keys: Vec<Option<Key>> = skeleton.frames.iter().map(|f| graph.find(&f.name)).collect();
        let surface = |key: &Option<Key>| surface_of(graph.get((*key)?)?).cloned();
        let surfaces: Vec<_> = keys.iter().map(surface).collect();
        let edges = surfaces.iter().map(|s| Some(s.as_ref()?.edges())).collect();
        Self { graph, skeleton, names, keys, surfaces, edges }
    }
}

impl<T: Scalar> Places<T> for Known<'_, T> {
    fn plans(&self, draft: u32) -> &[EdgePlan; 4] {
        &self.skeleton.frames[draft as usize].plans
    }

    fn edges(&self, draft: u32) -> Option<&Edges<T>> {
        self.edges[draft as usize].as_ref()
    }

    fn owner(&self, draft: u32) -> Key {
        self.keys[draft as usize].unwrap_or(Key(u32::MAX))
    }

    fn point(&self, key: Key) -> Option<&Point<T>> {
        let object = self.graph.get(self.graph.find(self.names.get(&key)?)?)?;
        match object.value()? {
            Value::Point(point) => Some(point),
            _ => None,
        }
    }
}

/// The pairs of patches whose shared vertices are not in one place.
fn apart(
    skeleton: &Skeleton,
    points: &[Arc<Vec<Vec3>>],
    grids: &Grids,
    joined: &mut join::UnionFind,
) -> Vec<Remark> {
    let all = points.iter().flat_map(|p| p.iter());
    let size = all.fold(Box3::EMPTY, |b, &p| b.including(p)).diagonal();
    const NONE: u32 = u32::MAX;
    let mut owner: Vec<(u32, Vec3)> = vec![(NONE, Vec3::zero()); grids.count() as usize];
    let mut worst: HashMap<(u32, u32), (f64, Vec3)> = HashMap::new();
    for (patch, frame) in skeleton.frames.iter().enumerate() {
        for vertex in grids.boundary(frame, patch) {
            let p = points[patch][(vertex - grids.first(patch)) as usize];
            let slot = &mut owner[joined.find(vertex) as usize];
            if slot.0 == NONE {
                *slot = (patch as u32, p);
            }
            let distance = p.distance(slot.1);
            if distance > JOIN_ACCURACY * size {
                let entry = worst.entry((slot.0, patch as u32)).or_insert((0.0, p));
                if distance > entry.0 {
                    *entry = (distance, p);
                }
            }
        }
    }
    let mut worst: Vec<_> = worst.into_iter().collect();
    worst.sort_by_key(|(pair, _)| *pair);
    let name = |patch: u32| skeleton.frames[patch as usize].name.to_string();
    worst
        .into_iter()
        .map(|((a, b), (distance, at))| Remark::Apart { patches: [name(a), name(b)], distance, at })
        .collect()
}

/// True when the panels as a whole, turned as their surfaces say, face inward: then all of
/// them are turned round. A closed mesh has a negative volume then; of an open one, the cone
/// from the middle of its rim has. A flat one faces as its surface says.
fn faces_inward(
    skeleton: &Skeleton,
    points: &[Arc<Vec<Vec3>>],
    grids: &Grids,
    joined: &mut join::UnionFind,
) -> bool {
    let meshed = || skeleton.frames.iter().enumerate().filter(|(_, f)| f.meshed);
    let mut rim: HashMap<(u32, u32), (u32, Vec3, Vec3)> = HashMap::new();
    for (patch, frame) in meshed() {
        let point = |vertex: u32| points[patch][(vertex - grids.first(patch)) as usize];
        for k in 0..4 {
            for pair in grids.edge(frame, patch, k).windows(2) {
                let (a, b) = (joined.find(pair[0]), joined.find(pair[1]));
                if a != b {
                    let ends = (point(pair[0]), point(pair[1]));
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
    for (patch, frame) in meshed() {
        let [nu, nv] = frame.divisions;
        let sign = if frame.reversed { -1.0 } else { 1.0 };
        let at = |i: usize, j: usize| points[patch][i * (nv + 1) + j] - centre;
        for (i, j) in (0..nu).flat_map(|i| (0..nv).map(move |j| (i, j))) {
            let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
            let cone = (a + c).dot((c - a).cross(d - b));
            volume += sign * cone;
            size += cone.abs();
        }
    }
    volume < -1e-6 * size
}
