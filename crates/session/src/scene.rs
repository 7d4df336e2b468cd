//! Scene of a document: named patches, curves, points, wires and contours.
//! The scene is rebuilt at each change; unchanged items keep their stamps, so that viewers receive
//! only changes. An item whose object has lost its value through an error keeps its last state and
//! has the reason.

use crate::patches::{self, Connections, Prepared, PreparedPatch};
use moldloft_diag::Diagnostic;
use moldloft_document::{ContourSection, Document};
use moldloft_io::NamedGrid;
use moldloft_mesh::{Mesh, Topology};
use moldloft_model::Object;
use moldloft_num::{Box3, Order, Vec3};
use moldloft_picture::patch_colour;
use moldloft_registry::{CurveRef, SolidRef, Value};
use rustc_hash::{FxHashMap, FxHashSet};
use std::sync::Arc;

/// Minimum and maximum number of steps along a curve.
const STEPS: [usize; 2] = [32, 256];

/// Panels along the edges of a solid.
const SOLID_PANELS: usize = 8;

/// Ratio of distance from the origin to size above which items have a local origin: 32-bit floats
/// would lose digits.
const FAR: f64 = 64.0;

/// Kind of an item of the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SceneItemKind {
    /// Panels of a surface or a body.
    Patch,
    /// A curve or snake.
    Curve,
    /// A point, bead, magnet or ring.
    Point,
    /// Wires of a body.
    Wire,
    /// Lines of a section.
    Contour,
    /// A grid of points.
    Grid,
    /// Axes of a frame.
    Frame,
}

impl SceneItemKind {
    /// Its name in replies.
    pub fn word(self) -> &'static str {
        match self {
            SceneItemKind::Patch => "patch",
            SceneItemKind::Curve => "curve",
            SceneItemKind::Point => "point",
            SceneItemKind::Wire => "wire",
            SceneItemKind::Contour => "contour",
            SceneItemKind::Grid => "grid",
            SceneItemKind::Frame => "frame",
        }
    }
}

/// An item of the scene.
#[derive(Clone, Debug)]
pub struct SceneItem {
    /// Unique in the scene.
    pub name: Arc<str>,
    /// The object that it belongs to.
    pub object: Arc<str>,
    /// Its kind.
    pub kind: SceneItemKind,
    /// Its colour in pictures, sRGB.
    pub colour: [u8; 3],
    /// A number that differs from that of adjacent patches.
    pub hue: u8,
    /// Reason why it is out of date; empty if it is current.
    pub stale: Arc<str>,
    /// Origin of the positions.
    pub origin: [f64; 3],
    /// Positions, three numbers each.
    pub positions: Arc<Vec<f32>>,
    /// Normals of a patch.
    pub normals: Arc<Vec<f32>>,
    /// Triangles and edges; for lines edges only.
    pub connections: Arc<Connections>,
    /// Increases when appearance changes.
    pub head_stamp: u64,
    /// Increases when positions change.
    pub stamp: u64,
    /// Increases when connectivity changes.
    pub topology_stamp: u64,
    /// Index of its patch in the mesh.
    pub patch: Option<usize>,
    /// Clock value of the last change of its curve.
    clock: u64,
}

impl SceneItem {
    fn new(kind: SceneItemKind, name: &str, object: &str) -> Self {
        Self {
            name: name.into(),
            object: object.into(),
            kind,
            colour: [0x5d, 0x6b, 0x7a],
            hue: 0,
            stale: "".into(),
            origin: [0.0; 3],
            positions: Arc::default(),
            normals: Arc::default(),
            connections: Arc::default(),
            head_stamp: 0,
            stamp: 0,
            topology_stamp: 0,
            patch: None,
            clock: 0,
        }
    }

    fn at(mut self, points: &[Vec3]) -> Self {
        (self.origin, self.positions) = relative(points);
        self
    }

    /// Polylines through lists of points.
    fn lines(self, runs: &[Vec<Vec3>]) -> Self {
        let mut edges = Vec::new();
        let mut points = Vec::new();
        for run in runs.iter().filter(|run| run.iter().all(|p| p.is_finite())) {
            let first = points.len() as u32;
            points.extend_from_slice(run);
            edges.extend((first..first + run.len().max(1) as u32 - 1).flat_map(|k| [k, k + 1]));
        }
        let connections = Arc::new(Connections { edges, ..Connections::default() });
        Self { connections, ..self }.at(&points)
    }
}

/// An origin, and positions relative to it as 32-bit floats.
fn relative(points: &[Vec3]) -> ([f64; 3], Arc<Vec<f32>>) {
    let bounds = Box3::around(points.iter().copied());
    let origin = match bounds.is_empty() {
        false if bounds.centre().norm() > FAR * bounds.diagonal() => bounds.centre(),
        _ => Vec3::zero(),
    };
    (origin.to_array(), Arc::new(flat(points, |p| p - origin)))
}

/// Prepared patches of a topology, with their last buffers.
struct KnownPatches {
    topology: Arc<Topology>,
    hues: Vec<u8>,
    patches: Vec<KnownPatch>,
}

struct KnownPatch {
    /// Unique in the scene.
    name: Arc<str>,
    /// The object that it belongs to.
    owner: Arc<str>,
    prepared: PreparedPatch,
    points: Vec<Vec3>,
    origin: [f64; 3],
    positions: Arc<Vec<f32>>,
    normals: Arc<Vec<f32>>,
    connections: Arc<Connections>,
}

impl KnownPatches {
    fn new(mesh: &Mesh) -> Self {
        let mut twice: FxHashMap<&str, usize> = FxHashMap::default();
        let mut patches = Vec::with_capacity(mesh.patches().len());
        for patch in mesh.patches() {
            let name = &patch.info.name;
            let count = twice.entry(name).or_default();
            *count += 1;
            patches.push(KnownPatch {
                name: if *count == 1 {
                    name.as_str().into()
                } else {
                    format!("{name} ({count})").into()
                },
                owner: "".into(),
                prepared: PreparedPatch::new(mesh, patch),
                points: Vec::new(),
                origin: [0.0; 3],
                positions: Arc::default(),
                normals: Arc::default(),
                connections: Arc::default(),
            });
        }
        Self { topology: mesh.topology().clone(), hues: patches::hues(mesh), patches }
    }
}

/// The items to draw.
#[derive(Default)]
pub struct Scene {
    items: Vec<SceneItem>,
    /// The next stamp.
    clock: u64,
    /// The patches of a topology.
    known: Option<KnownPatches>,
    /// Reason why shown surfaces have no panels.
    fault: Option<Diagnostic>,
    /// True to draw sections.
    pub contours: bool,
    /// Names of hidden objects to draw.
    pub revealed: FxHashSet<String>,
}

impl Scene {
    /// The items, in the order of the model.
    pub fn items(&self) -> &[SceneItem] {
        &self.items
    }

    /// A diagnostic in addition to those of the document.
    pub fn fault(&self) -> Option<&Diagnostic> {
        self.fault.as_ref()
    }

    /// Updates the scene to the state of the document.
    pub fn update(&mut self, document: &mut Document) {
        let before: FxHashMap<(KindKey, Arc<str>), usize> = self
            .items
            .iter()
            .enumerate()
            .map(|(k, i)| ((i.kind as u8, i.name.clone()), k))
            .collect();
        let mut made = self.patches(document);
        self.objects(document, &before, &mut made);
        if self.contours {
            made.extend(document.sections().iter().enumerate().map(contour));
        }
        made.extend(grids(document));
        let mut seen: FxHashSet<(KindKey, Arc<str>)> = FxHashSet::default();
        made.retain(|item| seen.insert((item.kind as u8, item.name.clone())));
        for item in &mut made {
            let old = before.get(&(item.kind as u8, item.name.clone())).map(|&k| &self.items[k]);
            stamp(item, old, &mut self.clock);
        }
        if document.has_errors() || self.fault.is_some() {
            let reasons = reasons(document);
            let otherwise: Arc<str> = match &self.fault {
                Some(fault) => fault.message.as_str().into(),
                None => "not made: the text has errors".into(),
            };
            for item in &self.items {
                let key = (item.kind as u8, item.name.clone());
                if seen.contains(&key) || item.kind == SceneItemKind::Contour && !self.contours {
                    continue;
                }
                let unpanelled = self.fault.is_some() && item.kind == SceneItemKind::Patch;
                if !document.has_errors() && !unpanelled {
                    continue;
                }
                let mut item = item.clone();
                let why = reasons.get(&*item.object).cloned().unwrap_or_else(|| otherwise.clone());
                if item.stale != why {
                    self.clock += 1;
                    item.stale = why;
                    item.head_stamp = self.clock;
                }
                item.patch = None;
                made.push(item);
            }
        }
        self.items = made;
    }

    fn patches(&mut self, document: &mut Document) -> Vec<SceneItem> {
        let panelled = match document.panelled() {
            Ok(panelled) => panelled,
            Err(fault) => {
                // Without a surface this is not an error.
                self.fault = (fault.id != "no-mesh").then_some(fault);
                return Vec::new();
            }
        };
        self.fault = None;
        let mesh = &panelled.mesh;
        let known = match self.known.take() {
            Some(known) if Arc::ptr_eq(&known.topology, mesh.topology()) => known,
            _ => KnownPatches::new(mesh),
        };
        let known = self.known.insert(known);
        let mut made = Vec::with_capacity(mesh.patches().len());
        let none: Arc<str> = "".into();
        for (k, (patch, known_patch)) in mesh.patches().iter().zip(&mut known.patches).enumerate() {
            let points = known_patch.prepared.points(mesh);
            if points != known_patch.points || known_patch.positions.is_empty() {
                let drawn = known_patch.prepared.drawn(&points);
                (known_patch.origin, known_patch.positions) = relative(&drawn.points);
                known_patch.normals = Arc::new(flat(&drawn.normals, |n| n));
                known_patch.connections = drawn.connections;
                known_patch.points = points;
            }
            let owner = owner(document, &patch.info.name);
            if *known_patch.owner != *owner {
                known_patch.owner = owner.into();
            }
            // All fields at once: replacing default values would double the cost.
            made.push(SceneItem {
                name: known_patch.name.clone(),
                object: known_patch.owner.clone(),
                kind: SceneItemKind::Patch,
                stale: none.clone(),
                head_stamp: 0,
                stamp: 0,
                topology_stamp: 0,
                clock: 0,
                colour: patch_colour(patch, k),
                hue: known.hues.get(k).copied().unwrap_or(0),
                origin: known_patch.origin,
                positions: known_patch.positions.clone(),
                normals: known_patch.normals.clone(),
                connections: known_patch.connections.clone(),
                patch: Some(k),
            });
        }
        made
    }

    fn objects(
        &self,
        document: &Document,
        before: &FxHashMap<(KindKey, Arc<str>), usize>,
        made: &mut Vec<SceneItem>,
    ) {
        for object in document.graph().objects() {
            let named = self.revealed.contains(&*object.name);
            if !object.head.shown() && !named {
                continue;
            }
            let new = |kind| SceneItem::new(kind, &object.name, &object.name);
            match object.value() {
                Some(Value::Curve(curve)) => {
                    let key = (SceneItemKind::Curve as u8, object.name.clone());
                    let old = before.get(&key).map(|&k| &self.items[k]);
                    let item =
                        match old.filter(|o| o.clock == object.changed_at && o.stale.is_empty()) {
                            Some(old) => old.clone(),
                            None => new(SceneItemKind::Curve).lines(&[sampled(curve, object)]),
                        };
                    made.push(SceneItem { clock: object.changed_at, ..item });
                }
                Some(Value::Point(point)) if point.xyz.is_finite() => {
                    made.push(new(SceneItemKind::Point).at(&[point.xyz]));
                }
                Some(Value::Solid(solid)) => made.push(faces(new(SceneItemKind::Patch), solid)),
                Some(Value::Body(body)) => {
                    if !body.wires.is_empty() {
                        made.push(new(SceneItemKind::Wire).lines(&body.wires));
                    }
                    for (k, dot) in body.dots.iter().enumerate() {
                        let name = format!("{}.{}", object.name, k + 1);
                        made.push(
                            SceneItem::new(SceneItemKind::Point, &name, &object.name).at(&[*dot]),
                        );
                    }
                }
                Some(Value::Frame(frame)) => {
                    let axes = frame.axes.map(|a| vec![frame.origin, frame.origin + a]);
                    made.push(new(SceneItemKind::Frame).lines(&axes));
                }
                _ => {}
            }
        }
    }
}

/// [`SceneItemKind`] as a key.
type KindKey = u8;

/// Keeps the stamps of the previous item for unchanged parts.
fn stamp(item: &mut SceneItem, old: Option<&SceneItem>, clock: &mut u64) {
    *clock += 1;
    let now = *clock;
    (item.head_stamp, item.stamp, item.topology_stamp) = (now, now, now);
    let Some(old) = old else { return };
    let looks = |i: &SceneItem| (i.colour, i.hue, i.stale.clone(), i.object.clone());
    if looks(item) == looks(old) {
        item.head_stamp = old.head_stamp;
    }
    if item.origin == old.origin
        && same_bits(&item.positions, &old.positions)
        && same_bits(&item.normals, &old.normals)
    {
        (item.stamp, item.positions, item.normals) =
            (old.stamp, old.positions.clone(), old.normals.clone());
    }
    if Arc::ptr_eq(&item.connections, &old.connections) || item.connections == old.connections {
        (item.topology_stamp, item.connections) = (old.topology_stamp, old.connections.clone());
    }
}

fn same_bits(a: &Arc<Vec<f32>>, b: &Arc<Vec<f32>>) -> bool {
    Arc::ptr_eq(a, b)
        || a.len() == b.len() && a.iter().zip(b.iter()).all(|(x, y)| x.to_bits() == y.to_bits())
}

/// Three numbers per vector. Written in place: an iterator of arrays takes twice as long.
fn flat(vectors: &[Vec3], of: impl Fn(Vec3) -> Vec3) -> Vec<f32> {
    let mut all = vec![0.0; 3 * vectors.len()];
    let (places, _) = all.as_chunks_mut();
    for (place, v) in places.iter_mut().zip(vectors) {
        *place = of(*v).to_array().map(|x| x as f32);
    }
    all
}

/// The object that a patch belongs to: by its name, or by the part before a dot.
fn owner<'n>(document: &Document, name: &'n str) -> &'n str {
    let graph = document.graph();
    let dots = name.char_indices().rev().filter(|(_, c)| *c == '.').map(|(k, _)| &name[..k]);
    std::iter::once(name).chain(dots).find(|n| graph.find(n).is_some()).unwrap_or(name)
}

/// The reasons why objects have no value.
fn reasons(document: &Document) -> FxHashMap<String, Arc<str>> {
    let mut found = FxHashMap::default();
    for diagnostic in document.diagnostics() {
        if let Some(name) = diagnostic.object.clone().filter(|_| diagnostic.is_error()) {
            found.entry(name).or_insert_with(|| diagnostic.message.as_str().into());
        }
    }
    let graph = document.graph();
    for object in graph.objects() {
        if let Some(by) = object.blocked_by().and_then(|by| graph.get(by)) {
            let why = format!("waits for `{}`, which failed", by.name);
            found.entry(object.name.to_string()).or_insert_with(|| why.as_str().into());
        }
    }
    found
}

fn sampled(curve: &CurveRef<f64>, object: &Object<f64>) -> Vec<Vec3> {
    let wanted = 4 * (object.head.own_divisions()[0] as usize).max(8);
    let steps = wanted.clamp(STEPS[0], STEPS[1]);
    let mut ts: Vec<f64> = (0..=steps).map(|k| k as f64 / steps as f64).collect();
    ts.extend(curve.breaks());
    ts.sort_by(f64::total_cmp);
    ts.dedup();
    ts.iter().map(|&t| curve.jet(t, Order::Zero)[0]).collect()
}

/// The six faces of a solid.
fn faces(item: SceneItem, solid: &SolidRef<f64>) -> SceneItem {
    let along: Vec<f64> = (0..=SOLID_PANELS).map(|k| k as f64 / SOLID_PANELS as f64).collect();
    let n = along.len();
    let (mut points, mut panels) = (Vec::new(), Vec::new());
    for (axis, end) in (0..3).flat_map(|axis| [(axis, 0.0), (axis, 1.0)]) {
        let fixed = [end];
        let ranges: [&[f64]; 3] =
            std::array::from_fn(|k| if k == axis { &fixed[..] } else { &along[..] });
        let first = points.len();
        points.resize(first + n * n, Vec3::zero());
        solid.grid(ranges[0], ranges[1], ranges[2], &mut points[first..]);
        let outward = (end > 0.5) != (axis == 1);
        for (i, j) in (0..n - 1).flat_map(|i| (0..n - 1).map(move |j| (i, j))) {
            let at = |i: usize, j: usize| (first + i * n + j) as u32;
            let corners = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            let [a, b, c, d] = corners;
            panels.push(if outward { corners } else { [a, d, c, b] });
        }
    }
    let identity: Vec<u32> = (0..points.len() as u32).collect();
    let drawn = Prepared::new(panels, identity).drawn(points);
    let normals = Arc::new(flat(&drawn.normals, |n| n));
    SceneItem { normals, connections: drawn.connections, ..item.at(&drawn.points) }
}

fn contour((k, section): (usize, &ContourSection)) -> SceneItem {
    let lines = section.lines.iter().flat_map(|(_, lines)| lines).map(|line| {
        let again = line.points.first().filter(|_| line.closed);
        line.points.iter().chain(again).copied().collect()
    });
    let name = format!("{} {k}", section.contours);
    SceneItem::new(SceneItemKind::Contour, &name, &section.contours)
        .lines(&lines.collect::<Vec<_>>())
}

/// Curves, surfaces and blocks of points computed by a program.
fn grids(document: &Document) -> Vec<SceneItem> {
    let made = |NamedGrid { name, grid }: NamedGrid| {
        let variable = name.split(['[', '.']).next().unwrap_or(&name);
        SceneItem::new(SceneItemKind::Grid, &name, variable).lines(&grid.lines())
    };
    document.grids().into_iter().map(made).collect()
}
