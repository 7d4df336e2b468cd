//! Panels of surfaces: patches from their own parameters and divisions, joined by identity.
//!
//! `surfaces -> drafts -> roots cut into intervals -> counts -> structure -> joined vertices -> panels`
//!
//! A patch of nu x nv divisions has a grid of vertices. Its edges consist of stretches of roots
//! (see `moldloft_num::trace` and [`crate::roots`]); counts propagate from patch to patch along
//! these ([`crate::counts`]), and the ends of several stretches of an edge are at divisions
//! ([`crate::edges`]). Vertices of different patches are identical if they are the same division of
//! the same stretch, or at the same point object ([`crate::join`]); never by proximity. The
//! position of a shared vertex is computed once, by the first patch in the order of declaration.

use crate::conformal::{conform, is_sound};
use crate::draft::{Draft, SharedKnuckles, drafts, indices};
use crate::edges::{EdgePlan, along_edge, net, parameters};
use crate::identity::Identities;
use crate::joined_patches::JoinedPatches;
use crate::knuckles::is_creased;
use crate::notes::PanelNote;
use crate::outward::{SewnPart, faces_wrongly};
use crate::patch_values::{PatchValues, evaluated_all, names};
use crate::roots::RootTable;
use crate::topology::{self, Counts, EdgeRun, Nominal, PanelTopology, PatchTopology};
use crate::triangle_bodies::{self, MeshedBody};
use moldloft_budget::Spent;
use moldloft_hydro::{USUAL_ACCURACY, surface_measures};
use moldloft_mesh::{Mesh, MeshError, Panel, Topology};
use moldloft_model::{Graph, Object};
use moldloft_num::trace::Key;
use moldloft_num::{Box3, Fineness, Order, Real, Vec3};
use moldloft_registry::{CallError, Scalar, SurfaceRef};
use std::cell::LazyCell;
use std::collections::HashMap;
use std::sync::Arc;

/// Bytes that a panel takes while it is made and joined.
const BYTES: u64 = 200;

/// Maximum number of refinements until panels are accurate enough.
const MAX_ROUNDS: usize = 4;

/// Maximum number of panels of a model.
pub const MOST_PANELS: u64 = 20_000_000;

/// The error of a model with `count` panels, at the object `name` that has most of them, `most`.
fn too_many_panels(graph: &Graph<f64>, count: u64, name: &str, most: u64) -> CallError {
    CallError::new(
        "too-many-panels",
        format!("{count} panels are too many, {most} of them of `{name}`"),
    )
    .expected(format!("at most {MOST_PANELS}"))
    .found(count.to_string())
    .help(format!("lower the divisions of `{name}`"))
    .related(graph.find(name), "most of the panels")
}

/// Refuses a patch with positions that are not finite, such as the limit at a pole that an object
/// does not take.
fn check_finite(graph: &Graph<f64>, name: &str, points: &[Vec3]) -> Result<(), CallError> {
    // Zero times a number is zero, times infinity or NaN it is NaN.
    let sum: f64 = points.iter().map(|p| p.x * 0.0 + p.y * 0.0 + p.z * 0.0).sum();
    if sum == 0.0 {
        return Ok(());
    }
    let bad = points.iter().filter(|p| !p.is_finite()).count();
    let message = format!("`{name}` has {bad} vertices that are not finite");
    Err(CallError::new("not-finite", message)
        .expected("finite coordinates")
        .found("NaN or infinity")
        .help("look for edges of length zero and zero tangents in its parents")
        .help(format!("or hide it: {name}(..., visible = 0)"))
        .related(graph.find(name), "the surface"))
}

/// Distance of a panel edge, or a whole patch, from a coordinate plane, relative to the model's
/// size, within which it is in the plane: rounding of a sine must not open a seam or leave slivers
/// at a plane of symmetry.
const IN_PLANE: f64 = 1e-12;

/// A point of a patch whose coordinate along an axis is exactly zero.
#[derive(Clone, Copy, Debug)]
struct Zero {
    patch: u32,
    point: u32,
    axis: u8,
}

/// The vertices and the patches that compute them; independent of the scalar.
#[derive(Clone, Debug)]
pub struct Panelling {
    pub(crate) structure: Arc<PanelTopology>,
    pub(crate) joined: Arc<JoinedPatches>,
    /// Bodies of triangles; their vertices come after all others.
    pub(crate) bodies: Arc<Vec<MeshedBody>>,
    /// The joint's topology and that of the bodies.
    topology: Arc<Topology>,
    /// The points of each patch, in the order of the skeleton, in the original state of the graph:
    /// as evaluated, and with exact zeros.
    raw: Vec<Arc<Vec<Vec3>>>,
    pub(crate) points: Vec<Arc<Vec<Vec3>>>,
    /// Points whose coordinate is exactly zero.
    zeros: Vec<Zero>,
    /// Point objects whose parameters divide edges, by their identity where this was made.
    pub(crate) names: Arc<HashMap<Key, Arc<str>>>,
    remarks: Vec<PanelNote>,
    measured: bool,
    knuckles: HashMap<Key, SharedKnuckles>,
    /// The graph's last change at that time.
    clock: u64,
}

impl Panelling {
    /// The panelling of all shown surfaces that have a value.
    ///
    /// # Errors
    /// A [`CallError`] when there would be too many panels.
    pub fn new(graph: &Graph<f64>) -> Result<Self, CallError> {
        Self::made(graph, None, None, None)
    }

    /// The panelling with enough divisions for this accuracy; stated divisions are a minimum.
    /// Bodies without a border are unchanged, which is reported unless their triangles are their
    /// surface. Panels that remain farther away are reported as a warning.
    ///
    /// # Errors
    /// A [`CallError`] when there would be too many panels.
    pub fn within(graph: &Graph<f64>, fineness: &Fineness) -> Result<Self, CallError> {
        let mut asked = *fineness;
        for round in 1.. {
            let mut made = Self::made(graph, None, None, Some(&asked))?;
            made.remarks.extend(made.bodies.iter().filter_map(MeshedBody::undivided));
            let (patch, distance) = made.farthest(graph).unwrap_or((0, 0.0));
            if distance <= fineness.chord {
                return Ok(made);
            }
            if round == MAX_ROUNDS {
                let patch = made.structure.patches[patch].name.to_string();
                let tolerance = fineness.chord;
                made.remarks.push(PanelNote::Coarse { patch, distance, tolerance });
                return Ok(made);
            }
            asked.chord *= (0.8 * fineness.chord / distance).max(0.1);
        }
        unreachable!("the last round returns")
    }

    /// The patch whose panels are farthest from its surface: the distance of their centres, including half of
    /// their warp.
    fn farthest(&self, graph: &Graph<f64>) -> Option<(usize, f64)> {
        let parameters = self.parameters(graph)?;
        let meshed =
            (0..self.structure.patches.len()).filter(|&k| self.structure.patches[k].meshed);
        let mut farthest: Option<(usize, f64)> = None;
        for ((surface, uv), patch) in parameters.into_iter().zip(meshed) {
            let [nu, nv] = self.structure.patches[patch].divisions;
            let points = &self.points[patch];
            let corners = (0..nu).flat_map(|i| (0..nv).map(move |j| i * (nv + 1) + j));
            let corners = corners.map(|k| [k, k + nv + 1, k + nv + 2, k + 1]);
            let middles: Vec<[f64; 2]> = corners
                .clone()
                .map(|c| [0, 1].map(|axis| c.map(|k| uv[k][axis]).iter().sum::<f64>() / 4.0))
                .collect();
            let mut places = vec![Vec3::zero(); middles.len()];
            surface.scattered(&middles, &mut places);
            for (corners, place) in corners.zip(places) {
                let [a, b, c, d] = corners.map(|k| points[k]);
                let Some(normal) = (c - a).cross(d - b).normalized() else { continue };
                let warp = (a + c - b - d).dot(normal).abs() / 4.0;
                let off = (place - (a + b + c + d) / 4.0).dot(normal).abs() + warp;
                if farthest.is_none_or(|(_, most)| off > most) {
                    farthest = Some((patch, off));
                }
            }
        }
        farthest
    }

    /// As `new`, with the counts of `nominal` where lengths would decide. Unchanged parts of
    /// `before`, a panelling of the same graph at an earlier state, are reused, with the same
    /// result.
    ///
    /// # Errors
    /// A [`CallError`] when there would be too many panels.
    pub fn renewed(
        graph: &Graph<f64>,
        nominal: Option<&Nominal>,
        before: Option<&Panelling>,
    ) -> Result<Self, CallError> {
        Self::made(graph, nominal, before, None)
    }

    fn made(
        graph: &Graph<f64>,
        nominal: Option<&Nominal>,
        before: Option<&Panelling>,
        fineness: Option<&Fineness>,
    ) -> Result<Self, CallError> {
        let mut drafts = drafts(graph, before.map(|b| (&b.knuckles, b.clock)), fineness)?;
        let identities = Identities::new(graph, &drafts);
        identities.collapse(&mut drafts);
        let roots = RootTable::new(graph, &drafts, identities);
        let mut made = topology::solve(graph, roots, &drafts, nominal);
        let cut_off = settle_nets(graph, &mut made.structure, &drafts);
        let knuckles = drafts.iter().filter(|d| d.border_curve.is_none());
        let knuckles = knuckles.map(|d| (d.object.key, d.knuckles.clone())).collect();
        let count = |frame: &PatchTopology| frame.divisions[0] as u64 * frame.divisions[1] as u64;
        let mut bodies = triangle_bodies::bodies(graph, fineness)?;
        let of_patches = made.structure.patches.iter().map(|patch| (count(patch), &patch.name));
        let counts = of_patches.chain(bodies.iter().map(|body| (body.panels(), &body.name)));
        let total = counts.clone().map(|(count, _)| count).sum::<u64>();
        if let Some((most, name)) = counts.max_by_key(|(count, _)| *count)
            && total > MOST_PANELS
        {
            return Err(too_many_panels(graph, total, name, most));
        }
        graph.budget().grow(total * BYTES)?;
        let before = before.filter(|b| *b.structure == made.structure);
        let structure = before.map_or_else(|| Arc::new(made.structure), |b| b.structure.clone());
        let names = match before {
            Some(before) => before.names.clone(),
            None => Arc::new(names(graph, &structure)),
        };
        // Divisions that depend on marks of other objects move with these.
        let hangs = |frame: &PatchTopology| {
            frame.plans.iter().any(|p| matches!(p, EdgePlan::Segments(_) | EdgePlan::Like(_)))
        };
        let kept = |patch: usize| {
            let before = before?;
            let unchanged = drafts[patch].object.changed_at <= before.clock;
            (unchanged && !hangs(&structure.patches[patch])).then(|| before.raw[patch].clone())
        };
        let evaluated = evaluated_all(&structure, &names, graph, kept);
        // Every draft has a value in its own graph, unless the budget is spent.
        let raw = evaluated.into_iter().collect::<Option<Vec<_>>>();
        let raw = raw.ok_or_else(|| graph.budget().poll().err().unwrap_or(Spent::Cancelled))?;
        for (patch, points) in structure.patches.iter().zip(&raw) {
            check_finite(graph, &patch.name, points)?;
        }
        let mut points = raw.clone();
        let size = points.iter().flat_map(|p| p.iter()).fold(Box3::EMPTY, |b, &p| b.including(p));
        let zeros = zeros(&structure, &points, size.diagonal());
        set_zeros(&zeros, &mut points);
        let fixed = fixed(&structure, &points, &size);
        let joined = joined_after(before, &structure, &points, fixed)?;
        let mut remarks = made.remarks;
        remarks.extend(cut_off.into_iter().map(|(patch, uv)| {
            knuckle_note(&drafts[patch], structure.patches[patch].divisions, &points[patch], uv)
        }));
        remarks.extend(joined.apart(&structure, &points, size.diagonal()));
        {
            let known = if bodies.iter().any(MeshedBody::has_border) {
                PatchValues::new(graph, &structure, &names)
            } else {
                PatchValues::empty(graph, &structure, &names)
            };
            let clock = before.map_or(0, |b| b.clock);
            let unchanged = |object: &Object<f64>| object.changed_at <= clock;
            let earlier = before.map(|b| (b.bodies.as_slice(), &unchanged as _));
            remarks.extend(triangle_bodies::sewn(&mut bodies, &known, &joined, earlier));
        }
        let topology = topology_after(before, &joined, &bodies)?;
        let made = Self {
            structure,
            joined,
            bodies: Arc::new(bodies),
            topology,
            raw,
            points,
            zeros,
            names,
            remarks,
            measured: made.measured,
            knuckles,
            clock: graph.last_change(),
        };
        made.facing_outward(graph)
    }

    /// The same with closed bodies of whole and trimmed faces turned outward, and cavities inward.
    fn facing_outward(mut self, graph: &Graph<f64>) -> Result<Self, CallError> {
        let frames = self.structure.patches.iter().enumerate().filter(|(_, frame)| frame.meshed);
        let frames: Vec<usize> = frames.map(|(patch, _)| patch).collect();
        let is_open = |&patch: &usize| !self.joined.orientation.is_closed(patch);
        let decides = frames.iter().any(is_open) || self.bodies.iter().any(|body| body.cavity);
        if !self.bodies.iter().any(MeshedBody::is_sewn) || !decides {
            return Ok(self);
        }
        let Some(own) = self.body_points(graph, &self.points) else { return Ok(self) };
        let positions = self.gathered(&self.points, &own);
        let patches = self.topology.patches();
        let whole = frames.iter().zip(patches).map(|(patch, at)| SewnPart {
            faces: at.faces.clone(),
            counts: is_open(patch),
            whole: true,
            cavity: self.structure.patches[*patch].cavity,
        });
        let mut next = frames.len();
        let trimmed = self.bodies.iter().map(|body| {
            let first = next;
            next += body.facets.groups.len().max(1);
            let faces = patches[first].faces.start..patches[next - 1].faces.end;
            SewnPart { faces, counts: body.is_sewn(), whole: false, cavity: body.cavity }
        });
        let members: Vec<SewnPart> = whole.chain(trimmed).collect();
        let wrong = faces_wrongly(&self.topology, &positions, &members);
        if !wrong.contains(&true) {
            return Ok(self);
        }
        let mut round = vec![false; self.structure.patches.len()];
        frames.iter().zip(&wrong).for_each(|(patch, wrong)| round[*patch] = *wrong);
        let mut bodies = self.bodies.to_vec();
        for (body, wrong) in bodies.iter_mut().zip(&wrong[frames.len()..]) {
            body.reversed ^= wrong;
        }
        let too_many = |e: MeshError| CallError::new("too-many-panels", e.to_string());
        let joined = self.joined.turned_round(&self.structure, &round).map_err(too_many)?;
        self.joined = Arc::new(joined);
        self.topology =
            triangle_bodies::with_bodies(&self.joined.topology, &bodies).map_err(too_many)?;
        self.bodies = Arc::new(bodies);
        Ok(self)
    }

    /// The connectivity.
    pub fn topology(&self) -> &Arc<Topology> {
        &self.topology
    }

    /// Notes about the joins.
    pub fn remarks(&self) -> &[PanelNote] {
        &self.remarks
    }

    /// True when a count depends on lengths, so that it may change with the shape.
    pub fn is_measured(&self) -> bool {
        self.measured
    }

    /// Its counts, for panels with the same counts.
    pub fn nominal(&self) -> Nominal {
        let counts = self.structure.patches.iter().map(|frame| {
            let edges = std::array::from_fn(|k| match &frame.runs[k] {
                EdgeRun::Along(spans) => {
                    spans.iter().filter(|(s, _)| s.interval.is_some()).map(|(_, n)| *n).collect()
                }
                _ => Vec::new(),
            });
            ((frame.name.clone(), frame.border_curve), Counts { divisions: frame.divisions, edges })
        });
        Nominal(Arc::new(counts.collect()))
    }

    /// The names of the patches' surfaces, in the order of the topology's patches; bodies of
    /// triangles follow.
    pub fn surfaces(&self) -> impl Iterator<Item = &Arc<str>> {
        self.structure.patches.iter().filter(|f| f.meshed).map(|f| &f.name)
    }

    /// The positions of all vertices, evaluated with the scalar of `graph`; `None` when a surface
    /// has no value in that graph.
    pub fn positions<T: Scalar>(&self, graph: &Graph<T>) -> Option<Vec<Vec3<T>>> {
        let points = evaluated_all(&self.structure, &self.names, graph, |_| None);
        let mut points = points.into_iter().collect::<Option<Vec<_>>>()?;
        set_zeros(&self.zeros, &mut points);
        Some(self.gathered(&points, &self.body_points(graph, &points)?))
    }

    /// For each structured patch, in the order of the topology: its surface, and (u, v) of each
    /// vertex of its block; `None` if a surface has no value.
    pub fn parameters(&self, graph: &Graph<f64>) -> Option<Vec<(SurfaceRef<f64>, Vec<[f64; 2]>)>> {
        let known = PatchValues::new(graph, &self.structure, &self.names);
        let meshed =
            (0..self.structure.patches.len()).filter(|&k| self.structure.patches[k].meshed);
        meshed
            .map(|patch| {
                let edge = |k: usize| along_edge(k, patch as u32, &known);
                let edges = [edge(0)?, edge(1)?, edge(2)?, edge(3)?];
                let surface = known.surfaces[patch].clone()?;
                let uv = net(&surface, &self.structure.patches[patch], &edges);
                Some((surface, uv))
            })
            .collect()
    }

    /// The mesh, evaluated with the scalar of `graph`.
    pub fn mesh<T: Scalar>(&self, graph: &Graph<T>) -> Option<Mesh<T>> {
        Mesh::new(self.topology().clone(), self.positions(graph)?).ok()
    }

    /// The mesh of the state from which the panelling was made.
    pub fn own_mesh(&self) -> Option<Mesh<f64>> {
        Mesh::new(self.topology().clone(), self.gathered(&self.points, &self.own_body_points()))
            .ok()
    }

    /// The vertices of the bodies' own, evaluated with the scalar of `graph`; `None` when one has no
    /// value there, or other triangles. `patches` are the points of the patches.
    fn body_points<T: Scalar>(
        &self,
        graph: &Graph<T>,
        patches: &[Arc<Vec<Vec3<T>>>],
    ) -> Option<Vec<Vec3<T>>> {
        if self.bodies.is_empty() {
            return Some(Vec::new());
        }
        let known = LazyCell::new(|| PatchValues::new(graph, &self.structure, &self.names));
        let mut points = Vec::new();
        for body in self.bodies.iter() {
            let facets = body.facets_in(graph, || &*known)?;
            points.extend(body.own_points(&facets, patches));
        }
        Some(points)
    }

    /// The bodies' own vertices at the state that the panelling was made of.
    fn own_body_points(&self) -> Vec<Vec3> {
        self.bodies.iter().flat_map(|b| b.own_points(&b.facets, &self.points)).collect()
    }

    /// The vertices' positions, from the separate positions of the patches and from those of the
    /// bodies.
    fn gathered<T: Real>(&self, points: &[Arc<Vec<Vec3<T>>>], bodies: &[Vec3<T>]) -> Vec<Vec3<T>> {
        let mut positions = vec![Vec3::zero(); self.topology().vertex_count()];
        let last = positions.len() - bodies.len();
        positions[last..].copy_from_slice(bodies);
        self.for_each_place(|vertex, patch, at| positions[vertex] = points[patch][at]);
        positions
    }

    /// The points of patches that are a vertex: vertex, patch, index in the patch. The last one counts.
    pub(crate) fn for_each_place(&self, mut each: impl FnMut(usize, usize, usize)) {
        let patches = self.structure.patches.iter().zip(&self.joined.vertices).enumerate();
        // Backwards, so that the first patch has the last word.
        for (patch, (_, vertices)) in patches.rev().filter(|(_, (f, _))| f.meshed) {
            for (at, &vertex) in vertices.iter().enumerate() {
                each(vertex as usize, patch, at);
            }
        }
    }

    /// The points of a patch as evaluated, at the state that the panelling was made of.
    pub(crate) fn own_points(&self, patch: usize) -> &[Vec3] {
        &self.raw[patch]
    }
}

/// Leaves the nets with knuckles as rows that have no folds. Patches of which a sharp edge is no row, each with a point of it.
fn settle_nets(
    graph: &Graph<f64>,
    structure: &mut PanelTopology,
    drafts: &[Draft<'_>],
) -> Vec<(usize, [f64; 2])> {
    let unsound: Vec<usize> = if structure.patches.iter().any(|frame| frame.conformal) {
        let names = names(graph, structure);
        let known = PatchValues::new(graph, structure, &names);
        let sound = |patch: usize, frame: &PatchTopology| {
            let edge = |k: usize| along_edge(k, patch as u32, &known);
            let edges = [edge(0)?, edge(1)?, edge(2)?, edge(3)?];
            let mut uv = parameters(&edges);
            conform(known.surfaces[patch].as_ref()?, frame.knuckles.as_deref()?, &edges, &mut uv)?;
            is_sound(frame.divisions, &uv).then_some(())
        };
        let patches = structure.patches.iter().enumerate();
        let nets = patches.filter(|(_, frame)| frame.conformal);
        nets.filter(|(patch, frame)| sound(*patch, frame).is_none()).map(|(k, _)| k).collect()
    } else {
        Vec::new()
    };
    unsound.iter().for_each(|&patch| structure.patches[patch].conformal = false);
    let meshed = drafts.iter().enumerate().filter(|(_, d)| d.meshed && d.border_curve.is_none());
    let cut_off = meshed.filter_map(|(patch, draft)| {
        let line = unsound.contains(&patch).then(|| draft.knuckles.across.first()).flatten();
        let place = draft.knuckles.loose.or(line.map(|line| line.middle()))?;
        is_creased(&*draft.surface, place).then_some((patch, place))
    });
    cut_off.collect()
}

/// The note about a patch of which a knuckle is no row.
fn knuckle_note(
    draft: &Draft<'_>,
    [nu, nv]: [usize; 2],
    points: &[Vec3],
    uv: [f64; 2],
) -> PanelNote {
    let at = draft.surface.jet(uv[0], uv[1], Order::Zero).p;
    let corners = (0..nu).flat_map(|i| (0..nv).map(move |j| i * (nv + 1) + j));
    let corners = corners.map(|k| [k, k + nv + 1, k + nv + 2, k + 1]);
    let panels = corners.map(|c| Panel::Quad(c.map(|k| points[k])).area()).sum();
    let surface = surface_measures(&*draft.surface, USUAL_ACCURACY);
    let area = surface.map(|measures| [panels, measures.area]);
    PanelNote::Knuckle { patch: draft.object.name.to_string(), uv, at, area }
}

/// The points of patches that are in a coordinate plane except for rounding, with the axis: those of
/// whole patches, and of panel edges at the borders of patches.
fn zeros(structure: &PanelTopology, points: &[Arc<Vec<Vec3>>], size: f64) -> Vec<Zero> {
    let near = IN_PLANE * size;
    let mut found = Vec::new();
    for (patch, (frame, points)) in structure.patches.iter().zip(points).enumerate() {
        for axis in 0..3u8 {
            let inside = |k: &usize| points[*k][usize::from(axis)].abs() <= near;
            let zero = |point: usize| Zero { patch: patch as u32, point: point as u32, axis };
            if indices(frame.divisions, 4).all(|k| inside(&k)) {
                found.extend(indices(frame.divisions, 4).map(zero));
                continue;
            }
            for edge in 0..4 {
                let edge: Vec<usize> = indices(frame.divisions, edge).collect();
                let ends = edge.windows(2).filter(|ends| ends.iter().all(inside));
                let mut ends: Vec<usize> = ends.flatten().copied().collect();
                ends.dedup();
                found.extend(ends.into_iter().map(zero));
            }
        }
    }
    found
}

/// Makes the coordinates zero; their derivatives stay.
fn set_zeros<T: Real>(zeros: &[Zero], points: &mut [Arc<Vec<Vec3<T>>>]) {
    for &Zero { patch, point, axis } in zeros {
        let (point, axis) = (point as usize, usize::from(axis));
        let points = &mut points[patch as usize];
        let x = points[point][axis];
        if x.re().to_bits() != 0 {
            let mut p = points[point].to_array();
            p[axis] = T::linear(0.0, &[(1.0, x)]);
            Arc::make_mut(points)[point] = p.into();
        }
    }
}

/// For each patch that is an image, which points of its boundary are those of its original, but for rounding.
fn fixed(structure: &PanelTopology, points: &[Arc<Vec<Vec3>>], all: &Box3) -> Vec<Vec<bool>> {
    let far = all.low.norm().max(all.high.norm());
    let near = IN_PLANE * all.diagonal() + 64.0 * f64::EPSILON * far;
    let of_patch = |(patch, frame): (usize, &PatchTopology)| {
        let Some((original, _)) = frame.image else { return Vec::new() };
        if structure.patches[original].divisions != frame.divisions {
            return Vec::new();
        }
        let boundary = (0..4).flat_map(|k| indices(frame.divisions, k));
        boundary.map(|k| points[patch][k].distance(points[original][k]) <= near).collect()
    };
    structure.patches.iter().enumerate().map(of_patch).collect()
}

/// The joined patches, those of before where nothing differs.
fn joined_after(
    before: Option<&Panelling>,
    structure: &PanelTopology,
    points: &[Arc<Vec<Vec3>>],
    fixed: Vec<Vec<bool>>,
) -> Result<Arc<JoinedPatches>, CallError> {
    Ok(match before.filter(|b| b.joined.fixed == fixed) {
        Some(before) if before.joined.turned == before.joined.orientation(structure, points) => {
            before.joined.clone()
        }
        _ => {
            let joined = JoinedPatches::new(structure, points, fixed);
            Arc::new(joined.map_err(|e| CallError::new("too-many-panels", e.to_string()))?)
        }
    })
}

/// The connectivity of patches and bodies, that of before where nothing differs.
fn topology_after(
    before: Option<&Panelling>,
    joined: &Arc<JoinedPatches>,
    bodies: &[MeshedBody],
) -> Result<Arc<Topology>, CallError> {
    let whole = before.filter(|b| {
        let alike = b.bodies.len() == bodies.len()
            && b.bodies.iter().zip(bodies).all(|(a, b)| a.is_like(b));
        alike && Arc::ptr_eq(&b.joined, joined)
    });
    Ok(match whole {
        Some(before) => before.topology.clone(),
        None if bodies.is_empty() => joined.topology.clone(),
        None => triangle_bodies::with_bodies(&joined.topology, bodies)
            .map_err(|e| CallError::new("too-many-panels", e.to_string()))?,
    })
}
