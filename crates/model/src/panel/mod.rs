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

mod bodies;
mod divide;
mod facing;
mod hems;
mod join;
mod junction;
mod remark;
mod roots;
mod skeleton;
mod spread;

pub(crate) use join::UnionFind;
pub use remark::{ChainStep, Remark};

use crate::{Graph, Object};
use bodies::Body;
use facing::Facing;
use hems::HemCounts;
use join::Joiner;
use moldloft_mesh::{Mesh, MeshError, PatchInfo, Tag, Topology, TopologyBuilder};
use moldloft_num::trace::{Edges, Key};
use moldloft_num::{Box3, Real, Vec3};
use moldloft_registry::{Fault, Point, Scalar, SurfaceRef, Value};
use rayon::prelude::*;
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

/// An edge, or a whole patch, within this share of the model's size from a coordinate plane lies in
/// it: rounding of a sine must not open a seam or leave slivers at a plane of symmetry.
const IN_PLANE: f64 = 1e-12;

/// Which vertices there are and who computes them; independent of the scalar.
#[derive(Clone, Debug)]
pub struct Panelling {
    skeleton: Arc<Skeleton>,
    joint: Arc<Joint>,
    /// Bodies of triangles; their vertices come after all others.
    bodies: Arc<Vec<Body>>,
    /// The joint's topology and that of the bodies.
    topology: Arc<Topology>,
    /// The points of each patch by itself, in the order of the skeleton, at the state that this was
    /// made of: as they were evaluated, and with exact zeros.
    raw: Vec<Arc<Vec<Vec3>>>,
    points: Vec<Arc<Vec<Vec3>>>,
    /// Parts of patches whose coordinate is exactly zero: patch, edge (4 for all of it), axis.
    zeros: Vec<(u32, u8, u8)>,
    /// Point objects whose parameters divide edges, by their identity where this was made.
    names: Arc<HashMap<Key, Arc<str>>>,
    remarks: Vec<Remark>,
    measured: bool,
    /// What the graph called its last change then.
    clock: u64,
}

/// What follows from a skeleton alone, but for the vertices that are their own images and the side
/// that panels face.
#[derive(Debug)]
struct Joint {
    topology: Arc<Topology>,
    /// The vertex of each point of each patch; those that only patches without panels have come
    /// after the topology's.
    vertices: Vec<Vec<u32>>,
    count: u32,
    /// For each patch, which points of its boundary are their own images.
    fixed: Vec<Vec<bool>>,
    /// Panel edges with one panel: patch and the places of both ends in its grid.
    rim: Vec<RimEdge>,
    facing: Facing,
    /// For each patch, whether its panels run against its natural normal.
    turned: Vec<bool>,
}

/// A panel edge with one panel: the patch and the places of both ends in its grid.
type RimEdge = (u32, u32, u32);

/// The counts of divisions of another state of a model, to be kept where they are free.
#[derive(Clone, Debug, Default)]
pub struct Nominal(HashMap<(Arc<str>, Option<u32>), Counts>);

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
        Self::renewed(graph, None, None)
    }

    /// The same with the counts of `nominal` wherever nothing else determines them. Of `before`, a
    /// panelling of the same graph at an earlier state, what has not changed is taken over; the
    /// result is the same without it.
    ///
    /// # Errors
    /// A [`Fault`] when there would be too many panels.
    pub fn renewed(
        graph: &Graph<f64>,
        nominal: Option<&Nominal>,
        before: Option<&Panelling>,
    ) -> Result<Self, Fault> {
        let drafts = drafts(graph);
        let made = skeleton::make(graph, Roots::new(graph, &drafts), &drafts, nominal);
        let count = |frame: &skeleton::Frame| frame.divisions[0] as u64 * frame.divisions[1] as u64;
        let mut bodies = bodies::bodies(graph);
        let total = made.skeleton.frames.iter().map(count).sum::<u64>()
            + bodies.iter().map(Body::panels).sum::<u64>();
        if total > MOST_PANELS {
            return Err(too_many_panels(total));
        }
        let before = before.filter(|b| *b.skeleton == made.skeleton);
        let skeleton = before.map_or_else(|| Arc::new(made.skeleton), |b| b.skeleton.clone());
        let names = match before {
            Some(before) => before.names.clone(),
            None => Arc::new(names(graph, &skeleton)),
        };
        // Divisions that hang on marks of other objects move with these.
        let hangs = |frame: &skeleton::Frame| {
            frame.plans.iter().any(|p| matches!(p, EdgePlan::Segments(_) | EdgePlan::Like(_)))
        };
        let kept = |patch: usize| {
            let before = before?;
            let unchanged = drafts[patch].object.changed_at <= before.clock;
            (unchanged && !hangs(&skeleton.frames[patch])).then(|| before.raw[patch].clone())
        };
        let evaluated = evaluated_all(&skeleton, &names, graph, kept);
        // Every draft has a value in its own graph.
        let raw: Vec<_> = evaluated.into_iter().flatten().collect();
        let mut points = raw.clone();
        let size = points.iter().flat_map(|p| p.iter()).fold(Box3::EMPTY, |b, &p| b.including(p));
        let zeros = zeros(&skeleton, &points, size.diagonal());
        set_zeros(&skeleton, &zeros, &mut points);
        let fixed = fixed(&skeleton, &points);
        let joint = match before.filter(|b| b.joint.fixed == fixed) {
            Some(before) if before.joint.turned == before.joint.facing(&skeleton, &points) => {
                before.joint.clone()
            }
            _ => {
                let joint = Joint::new(&skeleton, &points, fixed);
                Arc::new(joint.map_err(|e| Fault::new("too-many-panels", e.to_string()))?)
            }
        };
        let mut remarks = made.remarks;
        remarks.extend(joint.apart(&skeleton, &points, size.diagonal()));
        {
            let known = if bodies.iter().any(Body::has_border) {
                Known::new(graph, &skeleton, &names)
            } else {
                Known::empty(graph, &skeleton, &names)
            };
            let clock = before.map_or(0, |b| b.clock);
            let unchanged = |object: &Object<f64>| object.changed_at <= clock;
            let earlier = before.map(|b| (b.bodies.as_slice(), &unchanged as _));
            remarks.extend(bodies::sewn(&mut bodies, &known, &joint, earlier));
        }
        let whole = before.filter(|b| {
            let alike = b.bodies.len() == bodies.len()
                && b.bodies.iter().zip(&bodies).all(|(a, b)| a.is_like(b));
            alike && Arc::ptr_eq(&b.joint, &joint)
        });
        let topology = match whole {
            Some(before) => before.topology.clone(),
            None if bodies.is_empty() => joint.topology.clone(),
            None => bodies::with_bodies(&joint.topology, &bodies)
                .map_err(|e| Fault::new("too-many-panels", e.to_string()))?,
        };
        Ok(Self {
            skeleton,
            joint,
            bodies: Arc::new(bodies),
            topology,
            raw,
            points,
            zeros,
            names,
            remarks,
            measured: made.measured,
            clock: graph.last_change(),
        })
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
            ((frame.name.clone(), frame.hem), Counts { divisions: frame.divisions, edges })
        });
        Nominal(counts.collect())
    }

    /// The names of the patches' surfaces, in the order of the topology's patches; bodies of
    /// triangles come after them.
    pub fn surfaces(&self) -> impl Iterator<Item = &Arc<str>> {
        self.skeleton.frames.iter().filter(|f| f.meshed).map(|f| &f.name)
    }

    /// The positions of all vertices, evaluated with the scalar of `graph`; `None` when a surface
    /// has no value there.
    pub fn positions<T: Scalar>(&self, graph: &Graph<T>) -> Option<Vec<Vec3<T>>> {
        let points = evaluated_all(&self.skeleton, &self.names, graph, |_| None);
        let mut points = points.into_iter().collect::<Option<Vec<_>>>()?;
        set_zeros(&self.skeleton, &self.zeros, &mut points);
        Some(self.gathered(&points, &self.body_points(graph, &points)?))
    }

    /// Of each structured patch, in the order of the topology's: its surface, and (u, v) of each
    /// vertex of its block; `None` when a surface has no value.
    pub fn parameters(&self, graph: &Graph<f64>) -> Option<Vec<(SurfaceRef<f64>, Vec<[f64; 2]>)>> {
        let known = Known::new(graph, &self.skeleton, &self.names);
        let meshed = (0..self.skeleton.frames.len()).filter(|&k| self.skeleton.frames[k].meshed);
        meshed
            .map(|patch| {
                let edge = |k: usize| along_edge(k, patch as u32, &known);
                let edges = [edge(0)?, edge(1)?, edge(2)?, edge(3)?];
                Some((known.surfaces[patch].clone()?, spread::parameters(&edges)))
            })
            .collect()
    }

    /// The mesh, evaluated with the scalar of `graph`.
    pub fn mesh<T: Scalar>(&self, graph: &Graph<T>) -> Option<Mesh<T>> {
        Mesh::new(self.topology().clone(), self.positions(graph)?).ok()
    }

    /// The mesh at the state that the panelling was made of.
    pub fn own_mesh(&self) -> Option<Mesh<f64>> {
        Mesh::new(self.topology().clone(), self.gathered(&self.points, &self.own_body_points()))
            .ok()
    }

    /// The vertices' positions from those of the patches by themselves, and those of the bodies.
    fn gathered<T: Real>(&self, points: &[Arc<Vec<Vec3<T>>>], bodies: &[Vec3<T>]) -> Vec<Vec3<T>> {
        let mut positions = vec![Vec3::zero(); self.topology().vertex_count()];
        let last = positions.len() - bodies.len();
        positions[last..].copy_from_slice(bodies);
        let patches = self.skeleton.frames.iter().zip(points).zip(&self.joint.vertices);
        // Backwards, so that the first patch has the last word.
        for ((_, points), vertices) in patches.rev().filter(|((f, _), _)| f.meshed) {
            for (&vertex, &p) in vertices.iter().zip(points.iter()) {
                positions[vertex as usize] = p;
            }
        }
        positions
    }
}

/// Patches of fewer points than this are evaluated on the calling thread.
const WORTH_A_THREAD: usize = 4096;

/// The points of each patch by itself, evaluated with the scalar of `graph`; those that `kept` has
/// are not evaluated again.
fn evaluated_all<T: Scalar>(
    skeleton: &Skeleton,
    names: &HashMap<Key, Arc<str>>,
    graph: &Graph<T>,
    kept: impl Fn(usize) -> Option<Arc<Vec<Vec3<T>>>> + Sync,
) -> Vec<Option<Arc<Vec<Vec3<T>>>>> {
    let known = Known::new(graph, skeleton, names);
    let one = |patch: usize| {
        if let Some(points) = kept(patch) {
            return Some(points);
        }
        let surface = known.surfaces[patch].as_ref()?;
        let edge = |k: usize| along_edge(k, patch as u32, &known);
        let edges = [edge(0)?, edge(1)?, edge(2)?, edge(3)?];
        Some(Arc::new(evaluated(surface, &edges)))
    };
    let count = skeleton.frames.len();
    let points = |f: &skeleton::Frame| (f.divisions[0] + 1) * (f.divisions[1] + 1);
    if count < 2 || skeleton.frames.iter().map(points).sum::<usize>() < WORTH_A_THREAD {
        return (0..count).map(one).collect();
    }
    (0..count).into_par_iter().map(one).collect()
}

/// The points of edge 0..4 of a patch's grid, or (4) all of them.
fn indices([nu, nv]: [usize; 2], part: u8) -> impl Iterator<Item = usize> {
    let ((i0, i1), (j0, j1)) = match part {
        0 => ((0, nu), (0, 0)),
        1 => ((nu, nu), (0, nv)),
        2 => ((0, nu), (nv, nv)),
        3 => ((0, 0), (0, nv)),
        _ => ((0, nu), (0, nv)),
    };
    (i0..=i1).flat_map(move |i| (j0..=j1).map(move |j| i * (nv + 1) + j))
}

/// The parts of patches that lie in a coordinate plane but for rounding.
fn zeros(skeleton: &Skeleton, points: &[Arc<Vec<Vec3>>], size: f64) -> Vec<(u32, u8, u8)> {
    let near = IN_PLANE * size;
    let mut found = Vec::new();
    for (patch, (frame, points)) in skeleton.frames.iter().zip(points).enumerate() {
        for axis in 0..3u8 {
            let at = |k: usize| points[k][usize::from(axis)];
            let inside = |part| indices(frame.divisions, part).all(|k| at(k).abs() <= near);
            let edges: Vec<u8> = (0..4).filter(|&k| inside(k)).collect();
            let whole = edges.len() == 4 && inside(4);
            let parts = if whole { vec![4] } else { edges };
            for part in parts {
                found.push((patch as u32, part, axis));
            }
        }
    }
    found
}

/// Makes the coordinates zero; their derivatives stay.
fn set_zeros<T: Real>(
    skeleton: &Skeleton,
    zeros: &[(u32, u8, u8)],
    points: &mut [Arc<Vec<Vec3<T>>>],
) {
    for &(patch, part, axis) in zeros {
        let divisions = skeleton.frames[patch as usize].divisions;
        let points = &mut points[patch as usize];
        let zero = |k: usize| points[k][usize::from(axis)].re().to_bits() == 0;
        if indices(divisions, part).all(zero) {
            continue;
        }
        let points = Arc::make_mut(points);
        for k in indices(divisions, part) {
            let mut p = points[k].to_array();
            let x = &mut p[usize::from(axis)];
            *x = T::from_parts(|part| if part == 0 { 0.0 } else { x.part(part) });
            points[k] = p.into();
        }
    }
}

/// For each patch that is an image, which points of its boundary are those of its original.
fn fixed(skeleton: &Skeleton, points: &[Arc<Vec<Vec3>>]) -> Vec<Vec<bool>> {
    let of_patch = |(patch, frame): (usize, &skeleton::Frame)| {
        let Some((original, _)) = frame.image else { return Vec::new() };
        if skeleton.frames[original].divisions != frame.divisions {
            return Vec::new();
        }
        let boundary = (0..4).flat_map(|k| indices(frame.divisions, k));
        // -0 and 0 are one place.
        boundary.map(|k| points[patch][k] == points[original][k]).collect()
    };
    skeleton.frames.iter().enumerate().map(of_patch).collect()
}

impl Joint {
    /// Joins the vertices, numbers them and turns the panels.
    fn new(
        skeleton: &Skeleton,
        points: &[Arc<Vec<Vec3>>],
        fixed: Vec<Vec<bool>>,
    ) -> Result<Self, MeshError> {
        let mut joiner = Joiner::new(skeleton);
        joiner.join_images(|patch, at| fixed[patch].get(at) == Some(&true));
        let Joiner { grids, mut joined, .. } = joiner;
        let mut number = vec![u32::MAX; grids.count() as usize];
        let mut count = 0u32;
        let mut used = 0;
        let mut vertices = vec![Vec::new(); skeleton.frames.len()];
        for meshed in [true, false] {
            for (patch, frame) in skeleton.frames.iter().enumerate() {
                if frame.meshed != meshed {
                    continue;
                }
                let numbered = grids.all(patch).map(|v| {
                    let number = &mut number[joined.find(v) as usize];
                    if *number == u32::MAX {
                        *number = count;
                        count += 1;
                    }
                    *number
                });
                vertices[patch] = numbered.collect();
            }
            if meshed {
                used = count;
            }
        }
        let rim = rim(skeleton, &vertices);
        let topology = Arc::default();
        let facing = Facing::new(skeleton, &vertices, &rim);
        let turned = facing.turned(skeleton, points, &rim);
        let mut joint = Self { topology, vertices, count, fixed, rim, facing, turned };
        let mut builder = TopologyBuilder::new();
        builder.add_vertices(used as usize)?;
        for (patch, frame) in skeleton.frames.iter().enumerate() {
            let vertices = &joint.vertices[patch];
            if !frame.meshed {
                continue;
            }
            let [nu, nv] = frame.divisions;
            let info = PatchInfo {
                name: frame.name.to_string(),
                tag: Tag::among(frame.tags.iter().map(|t| &**t)),
                tags: frame.tags.iter().map(|t| t.to_string()).collect(),
                colour: Some((frame.colour & 15) as u8),
                kind: frame.kind.to_string(),
            };
            builder.add_block(info, nu + 1, nv + 1, vertices.clone(), joint.turned[patch])?;
        }
        joint.topology = builder.build().into();
        Ok(joint)
    }

    fn facing(&self, skeleton: &Skeleton, points: &[Arc<Vec<Vec3>>]) -> Vec<bool> {
        self.facing.turned(skeleton, points, &self.rim)
    }

    /// The pairs of patches whose shared vertices are not in one place.
    fn apart(&self, skeleton: &Skeleton, points: &[Arc<Vec<Vec3>>], size: f64) -> Vec<Remark> {
        const NONE: u32 = u32::MAX;
        let mut owner: Vec<(u32, Vec3)> = vec![(NONE, Vec3::zero()); self.count as usize];
        let mut worst: HashMap<(u32, u32), (f64, Vec3)> = HashMap::new();
        for (patch, frame) in skeleton.frames.iter().enumerate() {
            for k in (0..4).flat_map(|k| indices(frame.divisions, k)) {
                let p = points[patch][k];
                let slot = &mut owner[self.vertices[patch][k] as usize];
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
            .map(|((a, b), (distance, at))| {
                let patches = [name(a), name(b)];
                Remark::Apart { patches, distance, at }
            })
            .collect()
    }
}

/// The panel edges at the rims of patches that have one panel, in the order of their vertices.
fn rim(skeleton: &Skeleton, vertices: &[Vec<u32>]) -> Vec<RimEdge> {
    let mut all: Vec<((u32, u32), RimEdge)> = Vec::new();
    for (patch, frame) in skeleton.frames.iter().enumerate().filter(|(_, f)| f.meshed) {
        for k in 0..4 {
            let mut before: Option<usize> = None;
            for at in indices(frame.divisions, k) {
                if let Some(last) = before {
                    let (a, b) = (vertices[patch][last], vertices[patch][at]);
                    if a != b {
                        let places = (patch as u32, last as u32, at as u32);
                        all.push(((a.min(b), a.max(b)), places));
                    }
                }
                before = Some(at);
            }
        }
    }
    all.sort_unstable();
    let alone = all.chunk_by(|a, b| a.0 == b.0).filter(|run| run.len() == 1);
    alone.map(|run| run[0].1).collect()
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

/// A surface to be panelled, or the hem of a sheet.
struct Draft<'g> {
    object: &'g Object<f64>,
    surface: SurfaceRef<f64>,
    hem: Option<HemCounts>,
    edges: Edges<f64>,
    /// The draft of which it is the image, and the number of the map.
    image: Option<(usize, u32)>,
    /// False for a hidden surface of which a shown one is the image.
    meshed: bool,
    reversed: bool,
}

impl Draft<'_> {
    /// The divisions that are stated along u and v.
    fn stated(&self) -> [Option<u32>; 2] {
        match self.hem {
            Some(hem) => [hem.stated, None],
            None => self.object.head.stated_divisions(),
        }
    }

    /// The divisions when nothing else determines them.
    fn usual(&self) -> [u32; 2] {
        match self.hem {
            Some(hem) => [hem.usual, 1],
            None => self.object.head.own_divisions(),
        }
    }

    /// What tells it from all others, in any graph.
    fn identity(&self) -> (Arc<str>, Option<u32>) {
        (self.object.name.clone(), self.hem.map(|h| h.index))
    }
}

/// The surfaces that take part, in the order of declaration, hidden ones after them, and the hems of
/// sheets last.
fn drafts(graph: &Graph<f64>) -> Vec<Draft<'_>> {
    let mut drafts: Vec<Draft> = Vec::new();
    let draft = |object, meshed| {
        let surface = surface_of(object)?.clone();
        let (edges, reversed) = (surface.edges(), reversed(graph, object));
        Some(Draft { object, surface, hem: None, edges, image: None, meshed, reversed })
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
    for object in graph.objects().filter(|o| o.head.shown()) {
        let Some(border) = hems::border(object) else { continue };
        for (index, hem) in border.hems().iter().enumerate() {
            let Some(surface) = hems::line(hem) else { continue };
            let counts = HemCounts { index: index as u32, stated: hem.stated, usual: hem.usual };
            drafts.push(Draft {
                object,
                edges: surface.edges(),
                surface,
                hem: Some(counts),
                image: None,
                meshed: false,
                reversed: false,
            });
        }
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
        let surface = |(key, frame): (&Option<Key>, &skeleton::Frame)| {
            let object = graph.get((*key)?)?;
            match frame.hem {
                Some(hem) => hems::line(hems::border(object)?.hems().get(hem as usize)?),
                None => surface_of(object).cloned(),
            }
        };
        let surfaces: Vec<_> = keys.iter().zip(&skeleton.frames).map(surface).collect();
        let edges = surfaces.iter().map(|s| Some(s.as_ref()?.edges())).collect();
        Self { graph, skeleton, names, keys, surfaces, edges }
    }

    /// What says nothing of any patch, for where nothing is asked.
    fn empty(
        graph: &'a Graph<T>,
        skeleton: &'a Skeleton,
        names: &'a HashMap<Key, Arc<str>>,
    ) -> Self {
        Self { graph, skeleton, names, keys: vec![], surfaces: vec![], edges: vec![] }
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
