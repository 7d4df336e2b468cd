//! The finished body: faces of an object at their positions, with curves in place of corners.
//!
//! The drawing keeps its sharp corners, so that a radius stays a parameter; here they are replaced
//! (routines DELCOR, DEL4CR, DEL4EL). A corner between two lines becomes two tangent points and an
//! arc; the third line at the corner becomes two, with a ruled patch between them (a cylinder if
//! its other end has the same arc, a cone if it has none).

pub mod arrangement;
mod balance;
mod blend;
mod blend_order;
mod blend_tool;
pub(crate) mod body_tree;
mod border_places;
pub(crate) mod coincidence;
pub mod combine;
mod common_normals;
mod corners;
pub mod curve;
mod drill;
mod edge_trace;
pub(crate) mod edges;
pub(crate) mod face_place;
pub mod faces;
mod facet_source;
pub mod feature;
mod finer_mesh;
pub(crate) mod gradient;
mod hole;
mod joined_round;
mod kept_bodies;
mod loft;
pub(crate) mod mass;
mod meeting;
pub mod merge;
mod meshing;
mod near_misses;
mod nearness;
mod offset;
mod offset_section;
mod one_sided;
pub mod operation;
mod outline;
mod outline_offset;
mod outline_pieces;
mod outline_sides;
mod pierced;
pub mod place;
mod revolved;
pub(crate) mod ruled_faces;
pub mod shapes;
pub mod surface;
mod sweep_path;
mod swept;
mod tangent_ruling;
mod text;
mod turn;
pub mod validity;

use crate::solid::curve::{CurveFault, CurveKind, SketchCurve, SmoothPiece, Traced, trace};
use crate::solid::mass::{DirectedEdge, Mass, MassIntegrals};
use crate::{DimensionLayout, FaceId, Planes, PointId, SketchObject};
use moldloft_num::{Real, Vec3};
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::Arc;
use surface::FaceSurface;

/// A vertex of a solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex<T> {
    /// The label of the point, or the next free one for a tangent point.
    pub id: PointId,
    /// Position.
    pub at: Vec3<T>,
}

/// An edge of a solid.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SolidEdge<T> {
    /// Indices of its vertices.
    pub ends: [usize; 2],
    /// Its curve from the first to the second; straight when `None`.
    pub piece: Option<SmoothPiece<T>>,
    /// The curve's index in the object.
    pub curve: Option<usize>,
    /// Its points, if it has no closed form: the edge of a combined body.
    pub trace: Option<IntersectionEdge<T>>,
    /// The name of the face that it becomes, if its line or curve in a drawing does not tell.
    pub(crate) name: Option<Arc<str>>,
    /// Its ends as its own two surfaces move them, where more surfaces meet at a vertex than fix it.
    pub(crate) own_ends: Option<[Vec3<T>; 2]>,
}

/// An edge at the intersection of two surfaces.
#[derive(Clone, Debug, PartialEq)]
pub struct IntersectionEdge<T> {
    /// Points along it, its ends included.
    pub points: Vec<Vec3<T>>,
    /// Gauss nodes along it: points, and weighted tangents.
    pub(crate) nodes: Vec<(Vec3<T>, Vec3<T>)>,
    /// By round face beside it, u, v and the weighted change of u at the nodes.
    pub(crate) places: Vec<(usize, Vec<[T; 3]>)>,
    /// The curve of closed form that it is a part of, where it has one: the only thing that fixes a
    /// point of it where the surfaces beside it are tangent.
    pub(crate) carrier: Option<SmoothPiece<T>>,
}

/// A round face with borders that are not all parameter lines.
#[derive(Clone, Debug, PartialEq)]
pub struct Trim<T> {
    /// Its surface.
    pub surface: FaceSurface<T>,
    pub(crate) face: usize,
}

/// The mesh of a body that was combined: its parts do not follow from edges alone.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct CombinedMesh<T> {
    /// The vertices of the body, then points on edges and faces.
    pub points: Vec<Vec3<T>>,
    /// Triangles by face.
    pub faces: Vec<Vec<[u32; 3]>>,
    /// The points along each edge.
    pub chains: Vec<Vec<u32>>,
    /// The vertices of the facets used in the combination, and for each face its parts of these
    /// facets: facets of one surface stay in their planes through all combinations. Empty if they
    /// are the triangles.
    pub flat: Vec<Vec3>,
    pub parts: Vec<Vec<FacetPart>>,
}

/// A part of a facet.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FacetPart {
    /// The outward unit normal of the facet.
    pub normal: Vec3,
    /// Cycles of points, counter-clockwise about the normal; holes clockwise.
    pub loops: Vec<Vec<u32>>,
}

impl FacetPart {
    fn turn_over(&mut self) {
        self.normal = -self.normal;
        self.loops.iter_mut().for_each(|c| c.reverse());
    }
}

/// A face of a solid.
#[derive(Clone, Debug, PartialEq)]
pub struct SolidFace {
    /// The face of the object; `None` for the patch of a curve.
    pub id: Option<FaceId>,
    /// True for a ruled patch from its first edge to its third (to a point if there are three).
    pub ruled: bool,
    /// Directed edges, counter-clockwise from outside: outer cycle, then holes.
    pub loops: Vec<Vec<(usize, bool)>>,
    /// For a round face other than a ruled patch between its edges, its index in
    /// [`SketchSolid::trims`].
    pub trim: Option<usize>,
    /// Its names in a feature, which are stable under changes of dimensions: the names of the faces
    /// that it is a part of.
    pub names: Vec<Arc<str>>,
}

/// A curve that could not be built in.
#[derive(Clone, Debug, PartialEq)]
pub struct UnbuiltCurve {
    /// Its name.
    pub curve: String,
    /// Why.
    pub why: UnbuiltReason,
}

/// Reason why a curve was not built in.
#[derive(Clone, Debug, PartialEq)]
pub enum UnbuiltReason {
    /// It cannot be drawn at all.
    Curve(CurveFault),
    /// Its corner has more than three lines or faces.
    Crowded(PointId),
    /// Another curve uses the same corner or line.
    Taken(PointId),
    /// A face is not in the curve's plane and has not four edges.
    Face(FaceId),
    /// Its lines are not edges of the solid.
    NoEdge,
    /// Two tangent points on one line are in the wrong order.
    Overlap(PointId, PointId),
}

/// A body bounded by faces, or the faces of a flat figure.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SketchSolid<T> {
    /// Its vertices, without those that have no edges.
    pub vertices: Vec<Vertex<T>>,
    /// Its edges.
    pub edges: Vec<SolidEdge<T>>,
    /// Its faces.
    pub faces: Vec<SolidFace>,
    /// True for a flat figure.
    pub flat: bool,
    /// Curves traced, by index, whether built in or not.
    pub curves: BTreeMap<usize, Traced<T>>,
    /// Curves that could not be built in.
    pub unbuilt: Vec<UnbuiltCurve>,
    /// Round faces with borders of any kind.
    pub trims: Vec<Trim<T>>,
    pub(crate) facets: Option<CombinedMesh<T>>,
    /// By plane face of a body that was combined, a point of its plane and the normal, with their derivatives: those of
    /// its vertices do not tell them where more planes meet than fix a vertex.
    pub(crate) planes: BTreeMap<usize, [Vec3<T>; 2]>,
    /// Parts of plane faces that move otherwise than the rest of them.
    pub(crate) strays: Vec<coincidence::StrayPart<T>>,
    /// Points at which measures have no derivative.
    pub(crate) kinks: Vec<coincidence::Kink>,
    /// Derivatives of measures that both sides of a kink have.
    pub(crate) rates: Vec<one_sided::MassRate>,
    /// Subdivision of the chords of round edges in combinations with other bodies.
    pub(crate) density: outline::FacetDensity,
    steps: BTreeMap<usize, u32>,
}

struct RoundedCorner<T> {
    curve: usize,
    ends: [PointId; 2],
    tangents: [Vec3<T>; 2],
    /// Curve from the first tangent point to the second.
    piece: SmoothPiece<T>,
    /// Labels of the tangent points.
    ids: [PointId; 2],
}

/// The valid body of an object; `None` while positions are undetermined, faces are missing, or it
/// is not valid ([`feature::body`] gives the reason).
pub fn solid<T: Real>(
    object: &SketchObject,
    planes: &Planes,
    layout: &DimensionLayout<T>,
) -> Option<SketchSolid<T>> {
    feature::body(object, planes, layout).ok()
}

/// Builds the body of an object, valid or not.
pub(crate) fn unchecked<T: Real>(
    object: &SketchObject,
    planes: &Planes,
    layout: &DimensionLayout<T>,
) -> Option<SketchSolid<T>> {
    if object.faces.is_empty() {
        return None;
    }
    let place = Places { labels: Labels::new(planes.ids()), at: layout.positions(planes)? };
    let mut around: BTreeMap<PointId, BTreeSet<PointId>> = BTreeMap::new();
    if !object.curves.is_empty() {
        for cycle in object.faces.values().flat_map(|f| f.loops()) {
            let n = cycle.len();
            for k in 0..n {
                around
                    .entry(cycle[k])
                    .or_default()
                    .extend([cycle[(k + n - 1) % n], cycle[(k + 1) % n]]);
            }
        }
    }
    let mut build = SolidBuilder {
        object,
        place,
        around,
        corners: BTreeMap::new(),
        bent: BTreeMap::new(),
        curves: BTreeMap::new(),
        unbuilt: Vec::new(),
        next: object.drawing.next_point().0,
    };
    for (k, curve) in object.curves.values().enumerate() {
        let traced = trace(curve, &|p| build.place.get(p), &layout.values);
        match traced {
            Ok(traced) => {
                let result = if curve.replaces { build.take(k, curve, &traced) } else { Ok(()) };
                build.curves.insert(k, traced);
                if let Err(why) = result {
                    build.unbuilt.push(UnbuiltCurve { curve: curve.name.clone(), why });
                }
            }
            Err(fault) => {
                let (curve, why) = (curve.name.clone(), UnbuiltReason::Curve(fault));
                build.unbuilt.push(UnbuiltCurve { curve, why });
            }
        }
    }
    build.share_tangents();
    Some(build.finish())
}

/// Indices of labels in a list: by a table where the labels are dense, else by search.
struct Labels<'a> {
    ids: &'a [PointId],
    table: Vec<u32>,
}

impl<'a> Labels<'a> {
    fn new(ids: &'a [PointId]) -> Labels<'a> {
        let last = ids.last().map_or(0, |p| p.0 as usize);
        let mut table = Vec::new();
        if last <= 4 * ids.len() + 64 {
            table.resize(last + 1, u32::MAX);
            ids.iter().enumerate().for_each(|(k, p)| table[p.0 as usize] = k as u32);
        }
        Labels { ids, table }
    }

    fn index(&self, p: PointId) -> Option<usize> {
        if self.table.is_empty() {
            return self.ids.binary_search(&p).ok();
        }
        self.table.get(p.0 as usize).filter(|k| **k != u32::MAX).map(|k| *k as usize)
    }
}

/// Positions of the drawing's points.
struct Places<'a, T> {
    labels: Labels<'a>,
    at: Vec<Vec3<T>>,
}

impl<T: Real> Places<'_, T> {
    fn get(&self, p: PointId) -> Option<Vec3<T>> {
        self.labels.index(p).map(|k| self.at[k])
    }

    /// The position of a point of a face or curve: those exist.
    fn of(&self, p: PointId) -> Vec3<T> {
        self.get(p).unwrap_or_default()
    }
}

fn pair(a: PointId, b: PointId) -> (PointId, PointId) {
    (a.min(b), a.max(b))
}

struct SolidBuilder<'a, T> {
    object: &'a SketchObject,
    place: Places<'a, T>,
    /// Points that share an edge of a face, where there are curves.
    around: BTreeMap<PointId, BTreeSet<PointId>>,
    corners: BTreeMap<PointId, RoundedCorner<T>>,
    /// Edges that become curves: from the lower label to the higher.
    bent: BTreeMap<(PointId, PointId), (usize, SmoothPiece<T>)>,
    curves: BTreeMap<usize, Traced<T>>,
    unbuilt: Vec<UnbuiltCurve>,
    next: u32,
}

impl<T: Real> SolidBuilder<'_, T> {
    /// Records the lines that a curve replaces.
    fn take(
        &mut self,
        k: usize,
        curve: &SketchCurve,
        traced: &Traced<T>,
    ) -> Result<(), UnbuiltReason> {
        match (curve.kind, &curve.points[..]) {
            (CurveKind::Quadratic, p) if p.len() == 3 => {
                self.bend(k, &[(p[0], p[1]), (p[1], p[2])], &traced.pieces)
            }
            (CurveKind::Cubic, p) => {
                let edges: Vec<_> = p.windows(2).map(|w| (w[0], w[1])).collect();
                self.bend(k, &edges[1..edges.len() - 1], &traced.pieces)
            }
            (CurveKind::Arc | CurveKind::EllipticalArc | CurveKind::Bezier, &[a, m, b]) => {
                let tangents = traced.tangents.ok_or(UnbuiltReason::NoEdge)?;
                self.corner(k, m, [a, b], tangents, traced.pieces[0])
            }
            (CurveKind::Circle | CurveKind::Ellipse, &[a, m, b]) => self.ring(k, [a, m, b], traced),
            _ => Err(UnbuiltReason::NoEdge),
        }
    }

    fn bend(
        &mut self,
        k: usize,
        edges: &[(PointId, PointId)],
        pieces: &[SmoothPiece<T>],
    ) -> Result<(), UnbuiltReason> {
        let drawing = &self.object.drawing;
        for &(p, q) in edges {
            if drawing.line_between(p, q).is_none() {
                return Err(UnbuiltReason::NoEdge);
            }
            if self.bent.contains_key(&pair(p, q)) {
                return Err(UnbuiltReason::Taken(p));
            }
        }
        for (&(p, q), piece) in edges.iter().zip(pieces) {
            let forward = if p < q { *piece } else { piece.reversed() };
            self.bent.insert(pair(p, q), (k, forward));
        }
        Ok(())
    }

    fn corner(
        &mut self,
        curve: usize,
        at: PointId,
        ends: [PointId; 2],
        tangents: [Vec3<T>; 2],
        piece: SmoothPiece<T>,
    ) -> Result<(), UnbuiltReason> {
        if self.corners.contains_key(&at) {
            return Err(UnbuiltReason::Taken(at));
        }
        self.corner_is_free(at, ends)?;
        let ids = [PointId(self.next), PointId(self.next.saturating_add(1))];
        self.next = self.next.saturating_add(2);
        self.corners.insert(at, RoundedCorner { curve, ends, tangents, piece, ids });
        Ok(())
    }

    /// Checks that a curve between two of its lines can replace a corner. A third line becomes two
    /// with a patch between them in a solid; a flat figure cannot have one.
    fn corner_is_free(&self, at: PointId, ends: [PointId; 2]) -> Result<(), UnbuiltReason> {
        let neighbours = self.neighbours(at);
        if !ends.iter().all(|e| neighbours.contains(e)) {
            return Err(UnbuiltReason::NoEdge);
        }
        let most = if self.object.drawing.section.is_some() { 2 } else { 3 };
        if neighbours.len() > most { Err(UnbuiltReason::Crowded(at)) } else { Ok(()) }
    }

    /// The points that share an edge of a face with `at`.
    fn neighbours(&self, at: PointId) -> BTreeSet<PointId> {
        self.around.get(&at).cloned().unwrap_or_default()
    }

    /// A full circle or ellipse inscribed in the parallelogram of its lines: four corners at once.
    fn ring(
        &mut self,
        k: usize,
        [a, m, b]: [PointId; 3],
        traced: &Traced<T>,
    ) -> Result<(), UnbuiltReason> {
        let [pa, pm, pb] = [a, m, b].map(|p| self.place.of(p));
        let fourth = pa + pb - pm;
        let size = (pa - pm).re().norm() + (pb - pm).re().norm();
        let close = |p: Vec3<T>, q: Vec3<T>| (p - q).re().norm() <= 1e-9 * size;
        let drawing = &self.object.drawing;
        let c = (self.place.labels.ids.iter().zip(&self.place.at))
            .find(|(id, p)| {
                let linked = |other| drawing.line_between(**id, other).is_some();
                close(**p, fourth) && linked(a) && linked(b)
            })
            .map(|(id, _)| *id)
            .ok_or(UnbuiltReason::NoEdge)?;
        let [t1, t2] = traced.tangents.ok_or(UnbuiltReason::NoEdge)?;
        let half = T::from(0.5);
        if !close(t1, (pa + pm) * half) || !close(t2, (pb + pm) * half) {
            // Not inscribed: the sides stay as they are.
            return Err(UnbuiltReason::NoEdge);
        }
        let centre = (pa + pb) * half;
        let way = [(b, m, a), (m, a, c), (a, c, b), (c, b, m)];
        if way.iter().any(|(_, at, _)| self.corners.contains_key(at)) {
            return Err(UnbuiltReason::Taken(m));
        }
        // All four corners or none.
        for (from, at, to) in way {
            self.corner_is_free(at, [from, to])?;
        }
        for (from, at, to) in way {
            let [pf, p, pt] = [from, at, to].map(|id| self.place.of(id));
            let tangents = [(pf + p) * half, (p + pt) * half];
            let sweep = T::from(0.5 * std::f64::consts::PI);
            let piece = SmoothPiece::Conic {
                centre,
                a: tangents[0] - centre,
                b: tangents[1] - centre,
                sweep,
            };
            self.corner(k, at, [from, to], tangents, piece)?;
        }
        Ok(())
    }

    /// Gives tangent points that meet in the middle of a line one label, and refuses crossed ones.
    fn share_tangents(&mut self) {
        let on_line =
            |c: &RoundedCorner<T>, other: PointId| c.ends.iter().position(|e| *e == other);
        let keys: Vec<PointId> = self.corners.keys().copied().collect();
        for &p in &keys {
            for side in 0..2 {
                let Some(own) = self.corners.get(&p) else { continue };
                let (q, tangent, id) = (own.ends[side], own.tangents[side], own.ids[side]);
                let Some(other) = self.corners.get(&q).filter(|_| p < q) else { continue };
                let Some(back) = on_line(other, p) else { continue };
                let (from, to) = (self.place.of(p).re(), self.place.of(q).re());
                let length = from.distance(to);
                let reach = from.distance(tangent.re()) + to.distance(other.tangents[back].re());
                if reach > length * (1.0 + 1e-9) {
                    let curve = other.curve;
                    let curve = self.object.curves[curve].name.clone();
                    self.unbuilt.push(UnbuiltCurve { curve, why: UnbuiltReason::Overlap(p, q) });
                    self.corners.remove(&q);
                } else if reach >= length * (1.0 - 1e-9)
                    && let Some(other) = self.corners.get_mut(&q)
                {
                    other.ids[back] = id;
                    other.tangents[back] = tangent;
                }
            }
        }
    }

    /// Replacement of corner `p` on the line between it and `other`.
    fn stand_in(&self, p: PointId, other: PointId) -> Option<(PointId, Vec3<T>)> {
        match self.corners.get(&p) {
            None => Some((p, self.place.of(p))),
            Some(c) => {
                let side = c.ends.iter().position(|e| *e == other)?;
                Some((c.ids[side], c.tangents[side]))
            }
        }
    }

    fn finish(mut self) -> SketchSolid<T> {
        self.drop_unsupported();
        let halves: usize = self
            .object
            .faces
            .values()
            .map(|f| f.loops().map(<[PointId]>::len).sum::<usize>())
            .sum();
        let mut out = TopologyTable {
            vertices: Vec::with_capacity(self.place.at.len()),
            number: HashMap::with_capacity_and_hasher(self.place.at.len(), Quick::default()),
            edges: Vec::with_capacity(halves / 2),
            known: HashMap::with_capacity_and_hasher(halves / 2, Quick::default()),
        };
        let mut faces: Vec<SolidFace> = Vec::new();
        // Per third line of a corner, how a face runs its two successors.
        let mut seams: BTreeMap<PointId, PointId> = BTreeMap::new();
        for (&id, face) in &self.object.faces {
            let mut loops = Vec::new();
            for cycle in face.loops() {
                let edges = self.cycle(cycle, &mut out, &mut seams);
                if edges.len() >= 3 || edges.iter().any(|&(e, _)| out.edges[e].piece.is_some()) {
                    loops.push(edges);
                }
            }
            if !loops.is_empty() {
                let ruled = self.ruled_face(&loops, &out);
                if ruled == Some(true) {
                    // A ruled patch starts with a curved edge.
                    let bent = |h: &(usize, bool)| out.edges[h.0].piece.is_some();
                    let first = loops[0].iter().position(bent).unwrap_or(0);
                    loops[0].rotate_left(first);
                }
                if ruled.is_none() {
                    for k in loops.iter().flatten().filter_map(|h| out.edges[h.0].curve) {
                        let curve = self.object.curves[k].name.clone();
                        let unbuilt = UnbuiltCurve { curve, why: UnbuiltReason::Face(id) };
                        if !self.unbuilt.contains(&unbuilt) {
                            self.unbuilt.push(unbuilt);
                        }
                    }
                }
                let ruled = ruled == Some(true);
                faces.push(SolidFace { id: Some(id), ruled, loops, trim: None, names: vec![] });
            }
        }
        faces.extend(self.patches(&mut out, &seams));
        let steps = (self.object.curves.values().enumerate())
            .filter_map(|(k, c)| Some((k, c.steps?)))
            .collect();
        SketchSolid {
            vertices: out.vertices,
            edges: out.edges,
            faces,
            flat: self.object.drawing.section.is_some(),
            curves: self.curves,
            unbuilt: self.unbuilt,
            steps,
            trims: Vec::new(),
            facets: None,
            planes: BTreeMap::new(),
            strays: Vec::new(),
            kinks: Vec::new(),
            rates: Vec::new(),
            density: outline::FacetDensity::default(),
        }
    }

    /// A corner whose third line ends in a corner that has it as a side cannot be patched.
    fn drop_unsupported(&mut self) {
        let keys: Vec<PointId> = self.corners.keys().copied().collect();
        for p in keys {
            let Some(c) = self.corners.get(&p) else { continue };
            let third = self.neighbours(p).into_iter().find(|n| !c.ends.contains(n));
            let blocked =
                third.filter(|t| self.corners.get(t).is_some_and(|far| far.ends.contains(&p)));
            if blocked.is_some() {
                let curve = self.object.curves[c.curve].name.clone();
                self.unbuilt.push(UnbuiltCurve { curve, why: UnbuiltReason::Taken(p) });
                self.corners.remove(&p);
            }
        }
    }

    /// The edges that a cycle of points becomes.
    fn cycle(
        &self,
        cycle: &[PointId],
        out: &mut TopologyTable<T>,
        seams: &mut BTreeMap<PointId, PointId>,
    ) -> Vec<(usize, bool)> {
        let n = cycle.len();
        let mut edges = Vec::new();
        for k in 0..n {
            let (before, p, q) = (cycle[(k + n - 1) % n], cycle[k], cycle[(k + 1) % n]);
            if let Some(c) = self.corners.get(&p)
                && c.ends.contains(&before)
                && c.ends.contains(&q)
            {
                let forward = c.ends[0] == before;
                let [a, b] = [0, 1].map(|s| out.vertex(c.ids[s], c.tangents[s]));
                let e = out.edge([a, b], Some((c.curve, c.piece)));
                edges.push((e, forward));
            }
            // Points at which the line leaves p and arrives at q.
            let seam = |at: PointId, other: PointId, side: PointId| {
                self.stand_in(at, other).or_else(|| self.stand_in(at, side))
            };
            let after = cycle[(k + 2) % n];
            let (Some(from), Some(to)) = (seam(p, q, before), seam(q, p, after)) else { continue };
            if let Some(c) = self.corners.get(&p).filter(|c| !c.ends.contains(&q)) {
                // This face runs the third line outwards beside the end `before`.
                if c.ends.contains(&before) {
                    seams.insert(p, before);
                }
            }
            if from.0 == to.0 {
                continue;
            }
            let (a, b) = (out.vertex(from.0, from.1), out.vertex(to.0, to.1));
            let bent = self.bent.get(&pair(p, q)).filter(|_| from.0 == p && to.0 == q);
            let e = match bent {
                Some(&(curve, piece)) => {
                    let piece = if p < q { piece } else { piece.reversed() };
                    out.edge([a, b], Some((curve, piece)))
                }
                None => out.edge([a, b], None),
            };
            edges.push((e, out.edges[e].ends[0] == a));
        }
        edges
    }

    /// `Some(false)` plane, `Some(true)` ruled, `None` neither.
    fn ruled_face(&self, loops: &[Vec<(usize, bool)>], out: &TopologyTable<T>) -> Option<bool> {
        let all = || loops.iter().flatten();
        if all().all(|h| out.edges[h.0].piece.is_none()) {
            return Some(false);
        }
        let mut vector = Vec3::zero();
        let mut samples: Vec<Vec3> = Vec::new();
        let apex = out.vertices[out.edges[loops[0][0].0].ends[0]].at.re();
        for &(e, forward) in all() {
            let edge = &out.edges[e];
            let [p, q] = edge.ends.map(|v| out.vertices[v].at.re() - apex);
            let (p, q) = if forward { (p, q) } else { (q, p) };
            vector += p.cross(q);
            samples.push(p);
            if let Some(piece) = edge.piece {
                let thirds = [0.25, 0.5, 0.75].map(|s| piece.at(T::from(s)).re() - apex);
                let turned = if forward { thirds } else { [thirds[2], thirds[1], thirds[0]] };
                let way = [p, turned[0], turned[1], turned[2], q];
                vector -= p.cross(q);
                way.windows(2).for_each(|w| vector += w[0].cross(w[1]));
                samples.extend(thirds);
            }
        }
        let size = samples.iter().map(|s| s.norm()).fold(0.0, f64::max);
        let flat = vector
            .normalized()
            .is_some_and(|n| samples.iter().all(|s| s.dot(n).abs() <= 1e-7 * size));
        if flat {
            return Some(false);
        }
        (loops.len() == 1 && loops[0].len() == 4).then_some(true)
    }

    /// The patches of the third lines at corners.
    fn patches(
        &self,
        out: &mut TopologyTable<T>,
        seams: &BTreeMap<PointId, PointId>,
    ) -> Vec<SolidFace> {
        let mut faces = Vec::new();
        let mut done = BTreeSet::new();
        for (&p, c) in &self.corners {
            let third = self.neighbours(p).into_iter().find(|n| !c.ends.contains(n));
            let Some(q) = third.filter(|q| done.insert(pair(p, *q))) else { continue };
            // The face beside `out_end` runs the line outwards, so the patch runs it back there.
            let Some(&out_end) = seams.get(&p) else { continue };
            let side = usize::from(c.ends[1] == out_end);
            let arc = [0, 1].map(|s| out.vertex(c.ids[s], c.tangents[s]));
            let near = out.edge(arc, Some((c.curve, c.piece)));
            // Along the arc away from `out_end`, out along the other line, back to the first.
            let mut cycle = vec![(near, side == 0)];
            let [a, b] = [arc[side], arc[1 - side]];
            let (far_a, far_b, far) = match self.corners.get(&q) {
                None => {
                    let apex = out.vertex(q, self.place.of(q));
                    (apex, apex, None)
                }
                Some(other) => {
                    let beside = |end: PointId| {
                        other.ends.iter().position(|&e| self.same_face([end, p, q, e]))
                    };
                    let (Some(x), Some(y)) = (beside(c.ends[side]), beside(c.ends[1 - side]))
                    else {
                        continue;
                    };
                    let [va, vb] = [x, y].map(|s| out.vertex(other.ids[s], other.tangents[s]));
                    let ends = [0, 1].map(|s| out.vertex(other.ids[s], other.tangents[s]));
                    let e = out.edge(ends, Some((other.curve, other.piece)));
                    // From the far end of b to that of a.
                    (va, vb, Some((e, y == 0)))
                }
            };
            let mut run = |from: usize, to: usize| {
                let e = out.edge([from, to], None);
                (e, out.edges[e].ends[0] == from)
            };
            cycle.push(run(b, far_b));
            cycle.extend(far);
            cycle.push(run(far_a, a));
            let loops = vec![cycle];
            faces.push(SolidFace { id: None, ruled: true, loops, trim: None, names: vec![] });
        }
        faces
    }

    /// True if a face contains these points consecutively, in either direction.
    fn same_face(&self, way: [PointId; 4]) -> bool {
        self.object.faces.values().flat_map(|f| f.loops()).any(|cycle| {
            let n = cycle.len();
            (0..n).any(|k| {
                (0..4).all(|i| cycle[(k + i) % n] == way[i])
                    || (0..4).all(|i| cycle[(k + i) % n] == way[3 - i])
            })
        })
    }
}

/// A hash of small numbers: multiplication mixes their low bits into the high ones (Knuth, The Art
/// of Computer Programming, volume 3, section 6.4).
#[derive(Clone, Copy, Default)]
struct IndexHasher(u64);

impl std::hash::Hasher for IndexHasher {
    fn finish(&self) -> u64 {
        self.0 ^ (self.0 >> 32)
    }

    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|b| self.write_u64(u64::from(*b)));
    }

    fn write_u32(&mut self, n: u32) {
        self.write_u64(u64::from(n));
    }

    fn write_u8(&mut self, n: u8) {
        self.write_u64(u64::from(n));
    }

    fn write_usize(&mut self, n: usize) {
        self.write_u64(n as u64);
    }

    fn write_u64(&mut self, n: u64) {
        self.0 = (self.0.rotate_left(23) ^ n).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    }
}

type Quick = std::hash::BuildHasherDefault<IndexHasher>;

/// Vertices and edges, each made once.
struct TopologyTable<T> {
    vertices: Vec<Vertex<T>>,
    // Only for look-ups, never iterated, so that the hash order has no influence.
    number: HashMap<PointId, usize, Quick>,
    edges: Vec<SolidEdge<T>>,
    known: HashMap<(usize, usize, bool), usize, Quick>,
}

impl<T: Real> TopologyTable<T> {
    fn vertex(&mut self, id: PointId, at: Vec3<T>) -> usize {
        *self.number.entry(id).or_insert_with(|| {
            self.vertices.push(Vertex { id, at });
            self.vertices.len() - 1
        })
    }

    fn edge(&mut self, ends: [usize; 2], bent: Option<(usize, SmoothPiece<T>)>) -> usize {
        let key = (ends[0].min(ends[1]), ends[0].max(ends[1]), bent.is_some());
        *self.known.entry(key).or_insert_with(|| {
            let (curve, piece) = bent.unzip();
            self.edges.push(SolidEdge { ends, piece, curve, ..SolidEdge::default() });
            self.edges.len() - 1
        })
    }
}

impl<T: Real> SketchSolid<T> {
    /// The curve of an edge in the direction it is run.
    pub(crate) fn piece(&self, (e, forward): (usize, bool)) -> SmoothPiece<T> {
        let edge = &self.edges[e];
        let [p, q] = edge.ends.map(|v| self.vertices[v].at);
        let piece = edge.piece.unwrap_or_else(|| SmoothPiece::straight(p, q));
        if forward { piece } else { piece.reversed() }
    }

    /// Length of an edge.
    pub fn length(&self, edge: usize) -> T {
        let e = &self.edges[edge];
        if let Some(trace) = &e.trace {
            return trace.nodes.iter().fold(T::zero(), |s, n| s + n.1.norm());
        }
        match e.piece {
            Some(piece) => piece.length(),
            None => self.vertices[e.ends[0]].at.distance(self.vertices[e.ends[1]].at),
        }
    }

    /// Points along an edge: its ends, and for a curve also `chords - 1` points between them.
    pub fn polyline(&self, edge: usize, chords: usize) -> Vec<Vec3<T>> {
        let e = &self.edges[edge];
        if let Some(trace) = &e.trace {
            return trace.points.clone();
        }
        let n = if e.piece.is_some() { chords.max(1) } else { 1 };
        let piece = self.piece((edge, true));
        let inner = (1..n).map(|k| piece.at(T::from(k as f64 / n as f64)));
        let [p, q] = e.ends.map(|v| self.vertices[v].at);
        std::iter::once(p).chain(inner).chain([q]).collect()
    }

    /// Area, volume, centroid, inertia.
    pub fn mass(&self) -> Mass<T> {
        one_sided::settled(self.integrals().finish(self.flat), self)
    }

    /// The middle of the vertices.
    pub(crate) fn middle(&self) -> Vec3 {
        let n = self.vertices.len().max(1) as f64;
        self.vertices.iter().fold(Vec3::<f64>::zero(), |s, v| s + v.at.re()) / n
    }

    /// The integrals over all faces, from the middle.
    pub(crate) fn integrals(&self) -> MassIntegrals<T> {
        let centre = self.middle();
        let mut sums = MassIntegrals::new(Vec3::lifted(centre));
        for (f, face) in self.faces.iter().enumerate() {
            if face.ruled {
                self.ruled_sums(face, &mut sums);
                continue;
            }
            if let Some(trim) = face.trim {
                let surface = &self.trims[trim].surface;
                let nodes: Vec<[T; 3]> =
                    face.loops.iter().flat_map(|c| self.cycle_places(f, surface, c)).collect();
                sums.begin_patch();
                surface.sweep(&nodes, |p, area, size| sums.patch_element(p, area, size));
                sums.end_patch();
                continue;
            }
            let mut edges = Vec::new();
            for cycle in &face.loops {
                for (k, &(e, forward)) in cycle.iter().enumerate() {
                    let edge = &self.edges[e];
                    let [p, q] = self.ends((e, forward));
                    let side = match (&edge.trace, edge.piece) {
                        (Some(trace), _) => {
                            let sign = T::from(if forward { 1.0 } else { -1.0 });
                            let turned = trace.nodes.iter().map(|n| (n.0, n.1 * sign));
                            DirectedEdge::Nodes(turned.collect())
                        }
                        (None, Some(_)) => DirectedEdge::Piece(self.piece((e, forward))),
                        (None, None) => DirectedEdge::Straight,
                    };
                    edges.push((p, q, side));
                    let next = cycle[(k + 1) % cycle.len()];
                    if self.parts((e, forward), next) {
                        edges.push((q, self.ends(next)[0], DirectedEdge::Straight));
                    }
                }
            }
            sums.plane(&edges);
        }
        self.strays.iter().for_each(|s| sums.moved(s.corners, s.ahead));
        sums
    }

    /// Start and end of a directed edge.
    pub(super) fn ends(&self, (e, forward): (usize, bool)) -> [Vec3<T>; 2] {
        let edge = &self.edges[e];
        let [p, q] = edge.own_ends.unwrap_or_else(|| edge.ends.map(|v| self.vertices[v].at));
        if forward { [p, q] } else { [q, p] }
    }

    /// True if the end of an edge and the start of the next one separate.
    pub(super) fn parts(&self, edge: (usize, bool), next: (usize, bool)) -> bool {
        let own = |h: (usize, bool)| self.edges[h.0].own_ends.is_some();
        let way = || (self.ends(next)[0] - self.ends(edge)[1]).to_array();
        (own(edge) || own(next)) && way().iter().any(|x| !x.is_constant())
    }

    pub(crate) fn surface(&self, face: usize) -> Option<FaceSurface<T>> {
        let f = &self.faces[face];
        if let Some(trim) = f.trim {
            return Some(self.trims[trim].surface);
        }
        let cycle = f.loops.first().filter(|_| f.ruled)?;
        let near = self.piece(cycle[0]);
        let far = match cycle[..] {
            [_, _, far, _] => self.piece(far).reversed(),
            [_, out, _] => {
                let apex = self.vertices[self.edges[out.0].ends[usize::from(out.1)]].at;
                SmoothPiece::straight(apex, apex)
            }
            _ => return None,
        };
        Some(FaceSurface::Ruled { near, far })
    }

    fn ruled_sums(&self, face: &SolidFace, sums: &mut MassIntegrals<T>) {
        let cycle = &face.loops[0];
        let near = self.piece(cycle[0]);
        match cycle[..] {
            [_, _, far, _] => {
                // Run against its direction in the cycle, it starts where the first edge starts.
                let far = self.piece(far).reversed();
                sums.ruled(&near, &|s| (far.at(s), far.velocity(s)));
            }
            [_, out, _] => {
                let apex = self.vertices[self.edges[out.0].ends[usize::from(out.1)]].at;
                sums.ruled(&near, &|_| (apex, Vec3::zero()));
            }
            _ => {}
        }
    }
}
