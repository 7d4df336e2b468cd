//! Bodies combined, and one made valid: from facets back to exact faces, edges and vertices.
//!
//! The arrangement works on facets, so it only says which surfaces meet where. Here every vertex, edge
//! and face of its result is placed again by the surfaces themselves, over any scalar: vertices are
//! points of three surfaces, or of an edge and a surface; edges between planes are straight, others
//! carry points at Gauss's nodes found by Newton's method, for integrals to rounding. Derivatives come
//! from one more step in the scalar (implicit function theorem).

use super::arrangement::{self, ArrangeError, Arrangement, Facet, INNER};
use super::coincidence::{self, Kink, part, rates};
use super::facet_source::{FacetSource, ON_SURFACE, along, newell, settled};
use super::joined_round::{joined_surface, seams, shared_surfaces};
use super::near_misses::NearMissSearch;
use super::nearness::Nearness;
use super::revolved::{moves, patch_parameters};
use super::surface::{FaceSurface, Jet};
use super::tangent_ruling::{TangentRuling, rulings};
use super::{FacetPart, SketchSolid, SolidEdge, SolidFace, Trim, Vertex};
use crate::PointId;
use crate::solid::operation::Operation;
use moldloft_mesh::triangulate;
use moldloft_num::{Real, Vec3};
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::Arc;

/// Reason why bodies cannot be combined.
#[derive(Clone, Debug, PartialEq)]
pub enum CombineError {
    /// A body is open, or surfaces nearly coincide, at this position.
    Open(Vec3),
    /// Round surfaces are tangent or nearly so at this position.
    Touching(Vec3),
    /// Facets do not determine the order of several nearly intersecting surfaces at these
    /// positions, one or more.
    Coarse(Vec<Vec3>),
    /// The faces of the body do not close within rounding; the largest gap is at this position.
    Unbalanced(Vec3),
    /// One of these reasons, found on facets.
    AtFacets(Box<FacetAttempt>),
    /// The number of pieces exceeds the limit.
    TooLarge,
    /// Nothing is left.
    Empty,
}

/// A combination that failed on facets.
#[derive(Clone, Debug, PartialEq)]
pub struct FacetAttempt {
    facets: usize,
    /// Rulings in which cylinders are touched.
    rulings: Vec<TangentRuling>,
    why: CombineError,
}

impl CombineError {
    /// The reason itself.
    pub fn cause(&self) -> &CombineError {
        match self {
            CombineError::AtFacets(attempt) => attempt.why.cause(),
            other => other,
        }
    }

    /// The positions that it names.
    pub(super) fn places(&self) -> Vec<Vec3> {
        match self.cause() {
            CombineError::Coarse(all) => all.clone(),
            CombineError::Touching(p) | CombineError::Unbalanced(p) | CombineError::Open(p) => {
                vec![*p]
            }
            _ => Vec::new(),
        }
    }

    /// The number of facets, if known.
    pub(super) fn facets(&self) -> usize {
        if let CombineError::AtFacets(attempt) = self { attempt.facets } else { 0 }
    }

    pub(super) fn rulings(&self) -> &[TangentRuling] {
        if let CombineError::AtFacets(attempt) = self { &attempt.rulings } else { &[] }
    }
}

impl From<ArrangeError> for CombineError {
    fn from(e: ArrangeError) -> CombineError {
        match e {
            ArrangeError::Inconsistent(p) => CombineError::Open(p),
            ArrangeError::TooLarge => CombineError::TooLarge,
        }
    }
}

/// The body of two by an operation.
///
/// # Errors
/// [`CombineError`], with the position.
pub fn combined<T: Real>(
    bodies: [&SketchSolid<T>; 2],
    operation: Operation,
) -> Result<SketchSolid<T>, CombineError> {
    let rule = move |w: [i32; 2]| operation.holds(w[0] > 0, w[1] > 0);
    build(&bodies, &[0, 1], [false; 2], &rule).map(|b| b.0)
}

/// Combination of a body with any number of tools, which may intersect each other. Edges of tools
/// on faces of the body are edges of the result, so that faces may be tangent along them.
///
/// # Errors
/// [`CombineError`], with the position.
pub fn combined_with<T: Real>(
    body: &SketchSolid<T>,
    tools: &[SketchSolid<T>],
    operation: Operation,
) -> Result<SketchSolid<T>, CombineError> {
    let rule = move |w: [i32; 2]| operation.holds(w[0] > 0, w[1] > 0);
    let bodies: Vec<&SketchSolid<T>> = std::iter::once(body).chain(tools).collect();
    let mut operands = vec![1; bodies.len()];
    operands[0] = 0;
    build(&bodies, &operands, [true; 2], &rule).map(|b| b.0)
}

/// The region around which a self-intersecting surface winds once or more. The flag is true if it
/// differs from the body that the surface bounds.
///
/// # Errors
/// [`CombineError`], with the position.
pub fn resolved<T: Real>(body: &SketchSolid<T>) -> Result<(SketchSolid<T>, bool), CombineError> {
    build(&[body], &[0], [true, false], &|w| w[0] > 0)
}

/// The union of any number of bodies, in one step.
///
/// # Errors
/// [`CombineError`], with the position.
pub fn united<T: Real>(bodies: &[&SketchSolid<T>]) -> Result<SketchSolid<T>, CombineError> {
    build(bodies, &vec![0; bodies.len()], [true, false], &|w| w[0] > 0).map(|b| b.0)
}

/// The facets of bodies, with their origin.
pub(super) struct Facetted<T> {
    pub(super) points: Vec<Vec3<T>>,
    /// The same points where the facets meet.
    pub(super) flat: Vec<Vec3>,
    pub(super) facets: Vec<Facet>,
    pub(super) sources: Vec<FacetSource<T>>,
    /// By point: whether it is a vertex of its body.
    pub(super) vertex: Vec<bool>,
    /// By point: the surfaces of its body there, by operand and tag.
    pub(super) around: Vec<BTreeSet<(usize, u32)>>,
    /// Points at which the bodies themselves have no derivative.
    pub(super) kinks: Vec<Kink>,
}

fn build<T: Real>(
    bodies: &[&SketchSolid<T>],
    operand_of: &[usize],
    [crossing, fitted]: [bool; 2],
    rule: &dyn Fn([i32; 2]) -> bool,
) -> Result<(SketchSolid<T>, bool), CombineError> {
    // Tools are fitted to faces and edges, not to facets.
    let all = facetted(bodies, operand_of, !fitted);
    let facets = all.facets.len();
    if facets > MOST_FACETS {
        return Err(CombineError::TooLarge);
    }
    arranged(bodies, all, [crossing, fitted], rule).map_err(|why| match why {
        CombineError::TooLarge | CombineError::Empty => why,
        why => {
            CombineError::AtFacets(Box::new(FacetAttempt { facets, rulings: rulings(bodies), why }))
        }
    })
}

fn arranged<T: Real>(
    bodies: &[&SketchSolid<T>],
    mut all: Facetted<T>,
    [crossing, fitted]: [bool; 2],
    rule: &dyn Fn([i32; 2]) -> bool,
) -> Result<(SketchSolid<T>, bool), CombineError> {
    let plain: Vec<Vec3> = all.points.iter().map(|p| p.re()).collect();
    let unclear = all.unclear(&plain, crossing);
    if !unclear.is_empty() {
        return Err(CombineError::Coarse(unclear));
    }
    let scale = extent(&plain);
    let shared = shared_surfaces(&all.sources, scale);
    let seams = seams(&all.sources, &shared);
    let mut facets = std::mem::take(&mut all.facets);
    for facet in &mut facets {
        facet.side = shared.get(&(facet.operand, facet.tag)).copied();
    }
    let ways = [crossing, T::PARTS > 1];
    let arranged = arrangement::arrange(&all.flat, facets, ways, &seams, rule)?;
    if arranged.faces.is_empty() {
        return Err(CombineError::Empty);
    }
    let body = Placing::new(&all, &arranged, scale, fitted).finish(bodies[0].flat)?;
    let mut body = if body.facets.is_some() { body } else { body.balanced()? };
    if T::PARTS > 1 {
        body.kinks.append(&mut all.kinks);
        let rushing = coincidence::rushing(&body, &all.points);
        body.kinks.extend(rushing);
        for (operand, source) in all.sources.iter().enumerate() {
            let used =
                |tag: u32| arranged.faces.iter().any(|f| f.sources.contains(&(operand, tag)));
            body.kinks.extend(source.warped.iter().filter(|w| used(w.0)).map(|w| w.1));
        }
        let own =
            coincidence::kinks(&arranged.shared, &arranged.points, &all.sources, scale, fitted);
        body.kinks.extend(own);
        // At a contact in an edge, or beside round faces, the volume has no derivative, as the
        // area.
        let mut uses = vec![0; body.edges.len()];
        body.faces.iter().flat_map(|f| f.loops.iter().flatten()).for_each(|h| uses[h.0] += 1);
        if !body.trims.is_empty() || uses.iter().any(|n| *n > 2) {
            body.kinks.iter_mut().for_each(|kink| kink.volume = true);
        }
    }
    Ok((body, arranged.changed))
}

/// Positions at which a body's own faces or edges, except neighbours, are closer than the accuracy
/// of facets: it may or may not intersect itself there by less than a chord.
pub(super) fn unclear<T: Real>(body: &SketchSolid<T>) -> Vec<Vec3> {
    if body.edges.iter().all(|e| e.piece.is_none() && e.trace.is_none()) {
        return Vec::new();
    }
    let all = facetted(&[body], &[0], false);
    let plain: Vec<Vec3> = all.points.iter().map(|p| p.re()).collect();
    all.unclear(&plain, true)
}

/// The facets of bodies by operand; faces and edges of bodies of one operand are numbered on.
fn facetted<T: Real>(bodies: &[&SketchSolid<T>], operand_of: &[usize], flat: bool) -> Facetted<T> {
    let mut all = Facetted {
        points: Vec::new(),
        flat: Vec::new(),
        facets: Vec::new(),
        sources: Vec::new(),
        vertex: Vec::new(),
        around: Vec::new(),
        kinks: Vec::new(),
    };
    let mut operands: Vec<FacetSource<T>> = Vec::new();
    for (body, &operand) in bodies.iter().zip(operand_of) {
        if operand >= operands.len() {
            operands.push(FacetSource {
                surfaces: Vec::new(),
                names: Vec::new(),
                edges: Vec::new(),
                borders: Vec::new(),
                ranges: Vec::new(),
                traced: Vec::new(),
                ends: Vec::new(),
                warped: Vec::new(),
            });
        }
        add_facets(body, operand, flat, &mut operands[operand], &mut all);
    }
    all.sources = operands;
    all
}

impl<T: Real> Facetted<T> {
    fn unclear(&self, points: &[Vec3], within: bool) -> Vec<Vec3> {
        let scale = extent(points);
        let (vertex, facets, sources) = (&self.vertex[..], &self.facets[..], &self.sources[..]);
        NearMissSearch { points, vertex, facets, sources, scale }.unclear(within)
    }
}

/// The greatest distance from the first point.
fn extent(points: &[Vec3]) -> f64 {
    points.iter().map(|p| p.distance(points[0])).fold(0.0, f64::max).max(f64::MIN_POSITIVE)
}

/// The facets of a body: plane faces whole, round ones in strips.
fn add_facets<T: Real>(
    body: &SketchSolid<T>,
    operand: usize,
    flat: bool,
    source: &mut FacetSource<T>,
    all: &mut Facetted<T>,
) {
    let first_point = all.points.len() as u32;
    let first_edge = source.edges.len() as u32;
    let (outline, plain, normals) = match flat {
        true => body.flat_outline(),
        false => (body.outline(), Vec::new(), Vec::new()),
    };
    all.points.extend_from_slice(&outline.points);
    match flat {
        true => all.flat.extend(plain),
        false => all.flat.extend(outline.points.iter().map(|p| p.re())),
    }
    all.vertex.extend((0..outline.points.len()).map(|k| k < body.vertices.len()));
    all.around.resize(all.points.len(), BTreeSet::new());
    for k in 0..body.edges.len() {
        let edge = &body.edges[k];
        let piece = match &edge.trace {
            Some(trace) => trace.carrier,
            None => Some(body.piece((k, true))),
        };
        let outer = edge.trace.as_ref().and_then(|trace| {
            let (first, last) = (trace.points.first()?, trace.points.last()?);
            Some([first.re(), last.re()])
        });
        // A closed edge is all of its curve.
        let open = outer.filter(|[first, last]| first != last);
        let ends = open.zip(piece.as_ref()).map(|(ends, piece)| ends.map(|p| along(piece, p)));
        source.ends.push(outer.unwrap_or_else(|| edge.ends.map(|v| body.vertices[v].at.re())));
        source.ranges.push(ends.unwrap_or([0.0, 1.0]));
        let nodes = edge.trace.iter().filter(|_| piece.is_none()).flat_map(|t| &t.nodes);
        source.traced.push(nodes.map(|n| (n.0.re(), n.1.re())).collect());
        source.edges.push((piece, Vec::new()));
    }
    let size = outline.points.iter().map(|p| p.re().distance(outline.points[0].re()));
    let size = size.fold(0.0, f64::max);
    let mut kinks = body.kinks.clone();
    for stray in &body.strays {
        // A face has one plane here.
        let strays = |k: &usize| stray.ahead.iter().any(|x| x.part(*k) != 0.0);
        let kink = |part| Kink { part, at: stray.corners[0], volume: true };
        kinks.extend((1..T::PARTS).filter(strays).map(kink));
    }
    let mut put = |source: &mut FacetSource<T>,
                   surface: FaceSurface<T>,
                   facets: Vec<LoopsAndTags>,
                   own: &[Vec3]| {
        let tag = source.surfaces.len() as u32;
        let plane = matches!(surface, FaceSurface::Plane { .. });
        source.surfaces.push(surface);
        for (k, (loops, tags)) in facets.into_iter().enumerate() {
            for t in tags.iter().flatten().filter(|t| **t != INNER) {
                let beside = &mut source.edges[(first_edge + t) as usize].1;
                if !beside.contains(&tag) {
                    beside.push(tag);
                }
            }
            let at = |v: &u32| outline.points[*v as usize].re();
            let normal = match (&surface, own.get(k)) {
                (FaceSurface::Plane { normal, .. }, _) => Some(normal.re()),
                (_, Some(normal)) => normal.normalized(),
                (_, None) => newell(&loops[0].iter().map(at).collect::<Vec<_>>()).normalized(),
            };
            let Some(normal) = normal else { continue };
            for &v in loops.iter().flatten() {
                all.around[(v + first_point) as usize].insert((operand, tag));
            }
            let shift = |c: Vec<u32>| c.into_iter().map(|v| v + first_point).collect();
            let mark = |t: u32| if t == INNER { INNER } else { t + first_edge };
            let tags = tags.into_iter().map(|c| c.into_iter().map(mark).collect()).collect();
            let loops = loops.into_iter().map(shift).collect();
            all.facets.push(Facet::new(operand, tag, plane, normal, loops, tags));
        }
    };
    for f in 0..body.faces.len() {
        while source.names.len() < source.surfaces.len() {
            // A face that is not plane has one surface for each of its triangles.
            let last = f.checked_sub(1).map(|f| body.faces[f].names.clone());
            source.names.push(last.unwrap_or_default());
        }
        let at = |v: u32| outline.points[v as usize];
        let ring: Vec<(u32, bool)> =
            body.faces[f].loops.iter().flatten().map(|h| (h.0 as u32 + first_edge, h.1)).collect();
        if let Some(surface) = body.surface(f) {
            let strips = outline.strips(f).to_vec();
            let outward = along_normal(&surface, &strips, &|v| at(v).re());
            source.borders.push((ring, outward));
            let own = normals.get(f).map_or(&[][..], |own| own);
            put(source, surface, strips, own);
            continue;
        }
        let border = ring;
        let (loops, tags) = outline.loops(body, f);
        let ring: Vec<Vec3<T>> = loops[0].iter().map(|&v| at(v)).collect();
        let Some(normal) = newell(&ring).normalized() else { continue };
        let off = |v: &u32| normal.re().dot(at(*v).re() - ring[0].re()).abs();
        let warped = loops.iter().flatten().map(off).fold(0.0, f64::max) > 1e-10 * size;
        if !warped {
            source.borders.push((border, true));
            let plane = match body.planes.get(&f) {
                Some(plane) => carried(plane, ring[0].re(), normal.re()),
                None => {
                    let all = loops.iter().flatten().map(|&v| at(v));
                    let tag = source.surfaces.len() as u32;
                    let warped = warping(normal, ring[0], all, size).into_iter();
                    source.warped.extend(warped.map(|kink| (tag, kink)));
                    FaceSurface::Plane { at: ring[0], normal }
                }
            };
            put(source, plane, vec![(loops, tags)], &[]);
            continue;
        }
        // A face that is not plane is its triangles, each with a plane of its own.
        let side: HashMap<(u32, u32), u32> = loops
            .iter()
            .zip(&tags)
            .flat_map(|(c, t)| (0..c.len()).map(|k| ((c[k], c[(k + 1) % c.len()]), t[k])))
            .collect();
        for [a, b, c] in triangles_of(&loops, &|v| at(v).re(), normal.re()) {
            let ring = [at(a), at(b), at(c)];
            let Some(normal) = newell(&ring).normalized() else { continue };
            let tags = [(a, b), (b, c), (c, a)].map(|e| *side.get(&e).unwrap_or(&INNER));
            let facet = (vec![vec![a, b, c]], vec![tags.to_vec()]);
            source.borders.push((vec![], true));
            put(source, FaceSurface::Plane { at: ring[0], normal }, vec![facet], &[]);
        }
    }
    let last = body.faces.last().map(|f| f.names.clone()).unwrap_or_default();
    source.names.resize(source.surfaces.len(), last);
    all.kinks.append(&mut kinks);
}

/// A plane through a point with the derivatives of one that it is.
fn carried<T: Real>([base, turn]: &[Vec3<T>; 2], at: Vec3, normal: Vec3) -> FaceSurface<T> {
    let sign = if turn.re().dot(normal) < 0.0 { -1.0 } else { 1.0 };
    let off = turn.dot(Vec3::lifted(at) - *base);
    let moved = rates(|k| turn.re() * -off.part(k));
    let turned = rates(|k| part(*turn, k) * sign);
    FaceSurface::Plane { at: Vec3::lifted(at) + moved, normal: Vec3::lifted(normal) + turned }
}

/// The parts in which a plane face does not stay one.
fn warping<T: Real>(
    normal: Vec3<T>,
    base: Vec3<T>,
    corners: impl Iterator<Item = Vec3<T>>,
    size: f64,
) -> Vec<Kink> {
    let mut out: Vec<Kink> = Vec::new();
    for p in corners {
        let off = normal.dot(p - base);
        for k in 1..T::PARTS {
            let most = part(p, k).norm() + part(base, k).norm() + size * part(normal, k).norm();
            if moves(off.part(k), most) && out.iter().all(|kink| kink.part != k) {
                out.push(Kink { part: k, at: p.re(), volume: true });
            }
        }
    }
    out
}

/// True if facets of a round face, counter-clockwise from outside, have the surface's normal.
fn along_normal<T: Real>(
    surface: &FaceSurface<T>,
    facets: &[LoopsAndTags],
    at: &dyn Fn(u32) -> Vec3,
) -> bool {
    let mut sum = 0.0;
    for (loops, _) in facets.iter().take(8) {
        let ring: Vec<Vec3> = loops[0].iter().map(|&v| at(v)).collect();
        let middle = ring.iter().fold(Vec3::zero(), |s, p| s + *p) / ring.len() as f64;
        let [u, v] = surface.parameters(middle);
        let [_, du, dv] = surface.jet(T::from(u), T::from(v)).map(Vec3::re);
        sum += du.cross(dv).dot(newell(&ring));
    }
    sum >= 0.0
}

/// The loops of a facet, and the edge of the body for each side.
pub(super) type LoopsAndTags = (Vec<Vec<u32>>, Vec<Vec<u32>>);

/// The triangles of loops of numbered points.
pub(super) fn triangles_of(
    loops: &[Vec<u32>],
    at: &dyn Fn(u32) -> Vec3,
    normal: Vec3,
) -> Vec<[u32; 3]> {
    if let [ring] = loops
        && let &[a, b, c] = &ring[..]
    {
        return vec![[a, b, c]];
    }
    let used: Vec<u32> = loops.iter().flatten().copied().collect();
    let points: Vec<Vec3> = used.iter().map(|&v| at(v)).collect();
    // A point common to two cycles has the same first index in both, so that it stays one.
    let mut first: HashMap<u32, usize> = HashMap::new();
    for (k, &v) in used.iter().enumerate() {
        first.entry(v).or_insert(k);
    }
    let cycles: Vec<Vec<usize>> =
        loops.iter().map(|c| c.iter().map(|v| first[v]).collect()).collect();
    triangulate(&points, &cycles, normal).into_iter().map(|t| t.map(|k| used[k])).collect()
}

/// Number of facets above which a combination is refused at once: it would take minutes.
const MOST_FACETS: usize = 200_000;

/// Two faces beside a side, and the edge of a body that it is part of.
pub(super) type Kind = (usize, usize, Option<(usize, u32)>);

/// True if edges cross in a point, by its sides: two have no common neighbour.
fn crosses(sides: &BTreeSet<(Kind, u32)>) -> bool {
    let mut by_edge: BTreeMap<Kind, BTreeSet<u32>> = BTreeMap::new();
    for &(kind, end) in sides {
        by_edge.entry(kind).or_default().insert(end);
    }
    let ends: Vec<&BTreeSet<u32>> = by_edge.values().collect();
    (1..ends.len()).any(|k| (0..k).any(|j| ends[j].is_disjoint(ends[k])))
}

/// Placing of the result of an arrangement.
pub(super) struct Placing<'a, T> {
    pub(super) all: &'a Facetted<T>,
    pub(super) arranged: &'a Arrangement,
    pub(super) scale: f64,
    /// True if edges of the second operand are those of the result along their length: tools that
    /// touch the first one's faces along them.
    pub(super) fitted: bool,
    /// The number of the given point of a vertex of a body, by point of the arrangement.
    pub(super) original: HashMap<u32, u32>,
    /// By point of the arrangement, where it is when it is on an edge.
    pub(super) placed: HashMap<u32, Vec3<T>>,
    /// Corners of more faces than fix them, in some part not moved by all of them.
    pub(super) parted: BTreeSet<u32>,
    /// The surfaces of faces that are joined of parts of several round faces.
    joined: HashMap<usize, FaceSurface<T>>,
    pub(super) kinks: Vec<Kink>,
}

impl<'a, T: Real> Placing<'a, T> {
    fn new(all: &'a Facetted<T>, arranged: &'a Arrangement, scale: f64, fitted: bool) -> Self {
        let mut original = HashMap::new();
        for (k, &v) in arranged.given.iter().enumerate() {
            if all.vertex[k] {
                original.entry(v).or_insert(k as u32);
            }
        }
        let (mut joined, mut kinks) = (HashMap::new(), Vec::new());
        for (f, face) in arranged.faces.iter().enumerate() {
            if let Some((surface, own)) = joined_surface(face, &all.sources) {
                joined.insert(f, surface);
                kinks.extend(own);
            }
        }
        let (placed, parted) = Default::default();
        Placing { all, arranged, scale, fitted, original, placed, parted, joined, kinks }
    }

    pub(super) fn surface(&self, face: usize) -> &FaceSurface<T> {
        if let Some(surface) = self.joined.get(&face) {
            return surface;
        }
        let (operand, tag) = self.arranged.faces[face].sources[0];
        &self.all.sources[operand].surfaces[tag as usize]
    }

    fn finish(mut self, flat: bool) -> Result<SketchSolid<T>, CombineError> {
        let faces = &self.arranged.faces;
        // The face to the left of each directed side.
        let mut left: HashMap<(u32, u32), Vec<usize>> = HashMap::new();
        for (f, face) in faces.iter().enumerate() {
            for c in &face.loops {
                for k in 0..c.len() {
                    left.entry((c[k], c[(k + 1) % c.len()])).or_default().push(f);
                }
            }
        }
        // Bodies that touch in a line with round faces: whose edge it is does not tell how it moves.
        let touching = left.iter().filter(|(_, own)| own.len() > 1);
        let round = touching.filter(|(_, own)| own.iter().any(|&f| !faces[f].plane));
        if let Some((a, _)) = round.map(|(side, _)| *side).min() {
            let at = self.arranged.points[a as usize];
            let all = (1..T::PARTS).map(|part| Kink { part, at, volume: true });
            self.kinks.extend(all);
        }
        let source = |a: u32, b: u32| -> Option<(usize, u32)> {
            let known = |e: &&(usize, u32)| self.all.sources[e.0].edges[e.1 as usize].0.is_some();
            let all = self.arranged.edges.get(&(a.min(b), a.max(b)))?;
            let tool = |e: &&(usize, u32)| self.fitted && e.0 == 1 && known(e);
            all.iter().find(tool).or_else(|| all.iter().find(known)).copied()
        };
        // Of the coincident edges of several bodies, that of the two faces.
        let between = |a: u32, b: u32, pair: [usize; 2]| -> Option<(usize, u32)> {
            let first = source(a, b)?;
            if self.fitted && first.0 == 1 {
                return Some(first);
            }
            let edge = |e: &(usize, u32)| &self.all.sources[e.0].edges[e.1 as usize];
            let beside = |e: &(usize, u32), f: usize| {
                let mut own = faces[f].sources.iter();
                own.any(|s| s.0 == e.0 && edge(e).1.contains(&s.1))
            };
            let all = self.arranged.edges.get(&(a.min(b), a.max(b)))?;
            let both =
                |e: &&(usize, u32)| edge(e).0.is_some() && pair.iter().all(|&f| beside(e, f));
            all.iter().find(both).copied().or(Some(first))
        };
        let kind = |a: u32, b: u32, own: usize| -> Kind {
            // Of several faces at an edge, those with the same index in both lists are neighbours.
            let place = left[&(a, b)].iter().position(|f| *f == own).unwrap_or(0);
            let other = left.get(&(b, a)).and_then(|l| l.get(place).or(l.last()));
            let other = other.copied().unwrap_or(own);
            let round = !faces[own].plane || !faces[other].plane;
            let edge = if round { between(a, b, [own, other]) } else { None };
            (own.min(other), own.max(other), edge)
        };
        let mut corners: BTreeSet<u32> = BTreeSet::new();
        // The sides at each point, by the other end.
        let mut sides: BTreeMap<u32, BTreeSet<(Kind, u32)>> = BTreeMap::new();
        for (f, face) in faces.iter().enumerate() {
            for c in &face.loops {
                let n = c.len();
                let kinds: Vec<Kind> = (0..n).map(|k| kind(c[k], c[(k + 1) % n], f)).collect();
                for k in 0..n {
                    if kinds[k] != kinds[(k + n - 1) % n] {
                        corners.insert(c[k]);
                    }
                    let (a, b) = (c[k], c[(k + 1) % n]);
                    sides.entry(a).or_default().insert((kinds[k], b));
                    sides.entry(b).or_default().insert((kinds[k], a));
                }
            }
        }
        // At a contact of bodies, an edge of one crosses one of the other although no loop turns
        // from it into that one. Edges that coincide through a point do not cross there.
        corners.extend(sides.iter().filter(|(_, own)| crosses(own)).map(|(v, _)| *v));
        for face in faces {
            for c in &face.loops {
                let any = c.iter().any(|v| corners.contains(v));
                if !any {
                    // A closed edge: its lowest point is its vertex.
                    corners.extend(c.iter().min());
                }
            }
        }
        // Faces and edges at each corner.
        let mut around: BTreeMap<u32, (BTreeSet<usize>, BTreeSet<(usize, u32)>)> = BTreeMap::new();
        for (f, face) in faces.iter().enumerate() {
            for c in &face.loops {
                let n = c.len();
                for k in 0..n {
                    let (a, b) = (c[k], c[(k + 1) % n]);
                    // Between planes too: two that are parts of one do not fix a corner.
                    let edge = source(a, b);
                    for v in [a, b].into_iter().filter(|v| corners.contains(v)) {
                        let entry = around.entry(v).or_default();
                        entry.0.insert(f);
                        entry.1.extend(edge);
                    }
                }
            }
        }
        for (&v, (own, edges)) in &around {
            let at = self.corner(v, own, edges)?;
            if let Some(at) = at {
                let (at, parts) = self.moved_with_all(at, (own, edges));
                if parts {
                    self.parted.insert(v);
                }
                self.placed.insert(v, at);
            }
        }
        let near = Nearness { sources: &self.all.sources, scale: self.scale };
        let mut unclear = Vec::new();
        for (v, (own, _)) in &around {
            let Some(at) = self.placed.get(v) else { continue };
            for &f in own {
                let all = &faces[f].sources;
                if all.iter().all(|&source| near.outside(at.re(), source)) {
                    unclear.push(at.re());
                    break;
                }
            }
        }
        if !unclear.is_empty() {
            return Err(CombineError::Coarse(unclear));
        }
        let mut number: HashMap<u32, usize> = HashMap::new();
        let mut vertices: Vec<Vertex<T>> = Vec::new();
        let mut edges: Vec<SolidEdge<T>> = Vec::new();
        let mut chains: Vec<Vec<u32>> = Vec::new();
        let mut known: HashMap<(u32, u32), usize> = HashMap::new();
        let mut out: Vec<SolidFace> = Vec::new();
        let mut trims: Vec<Trim<T>> = Vec::new();
        let mut planes = BTreeMap::new();
        for (f, face) in faces.iter().enumerate() {
            let mut loops = Vec::new();
            for c in &face.loops {
                let n = c.len();
                let first = (0..n).find(|&k| corners.contains(&c[k])).unwrap_or(0);
                let mut cycle = Vec::new();
                let mut from = 0;
                while from < n {
                    let mut chain = vec![c[(first + from) % n]];
                    loop {
                        from += 1;
                        let v = c[(first + from) % n];
                        chain.push(v);
                        if from >= n || corners.contains(&v) {
                            break;
                        }
                    }
                    let pair = |a: u32, b: u32| (a.min(b), a.max(b));
                    let m = chain.len();
                    let key = pair(chain[0], chain[1]).min(pair(chain[m - 2], chain[m - 1]));
                    if let Some(&e) = known.get(&key) {
                        let forward = chains[e][0] == chain[0] && chains[e][1] == chain[1];
                        cycle.push((e, forward));
                        continue;
                    }
                    let kind = kind(chain[0], chain[1], f);
                    let mut ends = [0; 2];
                    for (end, v) in [chain[0], chain[m - 1]].into_iter().enumerate() {
                        ends[end] = *number.entry(v).or_insert_with(|| {
                            let at = self.placed.get(&v).copied();
                            let at = at.unwrap_or(Vec3::lifted(self.arranged.points[v as usize]));
                            vertices.push(Vertex { id: PointId(vertices.len() as u32 + 1), at });
                            vertices.len() - 1
                        });
                    }
                    let straight = faces[kind.0].plane && faces[kind.1].plane;
                    let own = self.own_ends([chain[0], chain[m - 1]], kind);
                    let own_ends = own.map(|ends| {
                        ends.map(|(at, kink)| {
                            self.kinks.extend(kink);
                            at
                        })
                    });
                    let trace = match straight {
                        true => None,
                        false => Some(self.trace(&chain, kind, own_ends)?),
                    };
                    if let Some(trace) = &trace {
                        for (&v, at) in chain.iter().zip(&trace.points) {
                            self.placed.entry(v).or_insert(*at);
                        }
                        // A closed edge has found the position of its vertex itself.
                        if ends[0] == ends[1] {
                            vertices[ends[0]].at = trace.points[0];
                        }
                    }
                    known.insert(key, edges.len());
                    cycle.push((edges.len(), true));
                    edges.push(SolidEdge { ends, trace, own_ends, ..SolidEdge::default() });
                    chains.push(chain);
                }
                loops.push(cycle);
            }
            let trim = (!face.plane).then(|| {
                trims.push(Trim { surface: *self.surface(f), face: f });
                trims.len() - 1
            });
            if let (true, FaceSurface::Plane { at, normal }) = (T::PARTS > 1, self.surface(f)) {
                planes.insert(f, [*at, *normal]);
            }
            let mut names: Vec<Arc<str>> = Vec::new();
            for &(operand, tag) in &face.sources {
                for name in &self.all.sources[operand].names[tag as usize] {
                    if !names.contains(name) {
                        names.push(name.clone());
                    }
                }
            }
            out.push(SolidFace { id: None, ruled: false, loops, trim, names });
        }
        let facets = (!trims.is_empty()).then(|| self.facets(&chains, &number, &vertices));
        let mut solid = SketchSolid { vertices, edges, faces: out, flat, ..SketchSolid::default() };
        solid.trims = trims;
        (solid.planes, solid.kinks) = (planes, std::mem::take(&mut self.kinks));
        solid.strays = self.strays();
        solid.facets = facets;
        self.agrees(&solid)?;
        Ok(solid)
    }

    /// Exact faces and facets must tell of one body: that they differ by more than chords do means that
    /// an edge was followed to a wrong place. The faces must close.
    fn agrees(&self, solid: &SketchSolid<T>) -> Result<(), CombineError> {
        let Some(facets) = &solid.facets else { return Ok(()) };
        let origin = facets.points.first().map_or(Vec3::zero(), |p| p.re());
        let (mut volume, mut area) = (0.0, 0.0);
        for t in facets.faces.iter().flatten() {
            let [a, b, c] = t.map(|k| facets.points[k as usize].re() - origin);
            volume += a.dot(b.cross(c)) / 6.0;
            area += (b - a).cross(c - a).norm() / 2.0;
        }
        let integrals = solid.integrals();
        let mass = integrals.clone().finish(solid.flat);
        let far = facets.points.iter().map(|p| p.re().distance(origin)).fold(0.0, f64::max);
        let off = (mass.volume.re() - volume).abs() > 2e-3 * area * far
            || (mass.area.re() - area).abs() > 0.02 * area;
        if off {
            let place = solid.trims.first().and_then(|t| solid.faces[t.face].loops[0].first());
            let place = place.map_or(origin, |h| solid.vertices[solid.edges[h.0].ends[0]].at.re());
            return Err(CombineError::Touching(place));
        }
        solid.closes(&integrals)
    }

    /// The mesh: parts of faces with their points where the exact edges run.
    fn facets(
        &self,
        chains: &[Vec<u32>],
        number: &HashMap<u32, usize>,
        vertices: &[Vertex<T>],
    ) -> super::CombinedMesh<T> {
        let mut points: Vec<Vec3<T>> = vertices.iter().map(|v| v.at).collect();
        let mut flat = vec![Vec3::zero(); points.len()];
        number.iter().for_each(|(v, k)| flat[*k] = self.arranged.points[*v as usize]);
        let mut index: HashMap<u32, u32> = number.iter().map(|(v, k)| (*v, *k as u32)).collect();
        let given: HashMap<u32, usize> = {
            let pairs = self.arranged.given.iter().enumerate().rev();
            pairs.map(|(k, v)| (*v, k)).collect()
        };
        let mut name = |v: u32| -> u32 {
            *index.entry(v).or_insert_with(|| {
                let at = match (self.placed.get(&v), given.get(&v)) {
                    (Some(at), _) => *at,
                    (None, Some(&k)) => self.all.points[k],
                    _ => Vec3::lifted(self.arranged.points[v as usize]),
                };
                points.push(at);
                flat.push(self.arranged.points[v as usize]);
                points.len() as u32 - 1
            })
        };
        let chains: Vec<Vec<u32>> =
            chains.iter().map(|c| c.iter().map(|&v| name(v)).collect()).collect();
        let mut faces: Vec<Vec<[u32; 3]>> = Vec::new();
        let mut parts: Vec<Vec<FacetPart>> = Vec::new();
        for face in &self.arranged.faces {
            let mut triangles = Vec::new();
            for part in &face.parts {
                let flat = |v: u32| self.arranged.points[v as usize];
                let ring: Vec<Vec3> = part[0].iter().map(|&v| flat(v)).collect();
                let normal = newell(&ring);
                let own = triangles_of(part, &flat, normal);
                triangles.extend(own.into_iter().map(|t| t.map(&mut name)));
            }
            faces.push(triangles);
            let mut named = |part: &Vec<Vec<u32>>| -> Vec<Vec<u32>> {
                part.iter().map(|c| c.iter().map(|&v| name(v)).collect()).collect()
            };
            let both = face.parts.iter().zip(&face.normals);
            let own = both.map(|(part, normal)| FacetPart { normal: *normal, loops: named(part) });
            parts.push(if face.plane { Vec::new() } else { own.collect() });
        }
        super::CombinedMesh { points, faces, chains, flat, parts }
    }
}

/// The parameters u, v of a point on a surface, and the change of u as the point moves by `by`.
pub(super) fn located<T: Real>(
    surface: &FaceSurface<T>,
    p: Vec3<T>,
    by: Vec3<T>,
    from: Option<[f64; 2]>,
) -> Option<[T; 3]> {
    let at = match patch_parameters(surface, p.re(), from.unwrap_or([0.5; 2])) {
        Some(at) => {
            let [s, du, dv] = surface.jet(T::from(at[0]), T::from(at[1])).map(Vec3::re);
            let on = s.distance(p.re()) <= ON_SURFACE * (du.norm() + dv.norm());
            on.then_some(at)?
        }
        None => {
            let start = from.unwrap_or_else(|| surface.parameters(p.re()));
            // Beside a pole a search may pass it and stay on its other side.
            let grid = (0..81).map(|k| [f64::from(k % 9) / 8.0, f64::from(k / 9) / 8.0]);
            let mut starts = std::iter::once(start).chain(grid);
            starts.find_map(|start| settled(surface, p.re(), start, ON_SURFACE))?
        }
    };
    let lifted = at.map(T::from);
    let step = |[_, du, dv]: Jet<T>, r: Vec3<T>| {
        let (a, b, c) = (du.norm_sq(), du.dot(dv), dv.norm_sq());
        let det = a * c - b * b;
        let (x, y) = (du.dot(r), dv.dot(r));
        (det.re() > 0.0).then(|| [(c * x - b * y) / det, (a * y - b * x) / det])
    };
    let jet = surface.jet(lifted[0], lifted[1]);
    let Some(last) = step(jet, p - jet[0]) else {
        // At a pole: the direction does not matter there.
        return Some([lifted[0], lifted[1], T::zero()]);
    };
    let [u, v] = [lifted[0] + last[0], lifted[1] + last[1]];
    // The change of the parameter along the surface, which the rate must follow.
    let by = step(surface.jet(u, v), by).map_or(T::zero(), |d| d[0]);
    Some([u, v, by])
}
