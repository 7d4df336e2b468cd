//! Positions at which round faces or edges are so close to others that facets do not determine
//! whether they intersect.
//!
//! The intersection of two shapes changes its topology only where one of them passes a critical
//! value of their distance: where points of two faces, edges or vertices have a common normal.
//! Facets are off their surfaces by the height of a chord, so their topology is right unless there
//! is such a pair at a distance below those heights: a bar that protrudes from a wall by less than
//! a chord, two tubes at a very small distance, the corner of a block just below a round face.
//! Every pair of facets, of sides and of vertices that are close enough, by boxes of facets
//! extended by their own heights, is the start of a Newton search for such a pair.

use super::arrangement::{Facet, INNER, overlapping};
use super::common_normals::SurfaceAbout;
use super::curve::SmoothPiece;
use super::facet_source::{FacetSource, along};
use super::revolved::RevolvedSurface;
use super::surface::FaceSurface;
use moldloft_num::{Axis, Real, Vec3};
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// Distance, relative to the bodies, below which two elements touch; and the same for edges known
/// by points.
const TOUCHING: [f64; 2] = [1e-9, 1e-6];

/// Maximum distance of the ends of a common normal beyond their facets, relative to the width of
/// these.
const BEYOND: f64 = 0.02;

/// Safety factor on the error of facets within which a pair is critical.
const SAFE: f64 = 2.0;

/// Distance of positions, relative to the bodies, within which they are the same.
const SAME: f64 = 1e-5;

/// Distance, relative to the bodies, from which facets of coaxial elements are in the order of these.
const ORDERED: f64 = 1e-7;

/// Tolerance of one axis, relative to the bodies, and of one direction from it.
const ONE_AXIS: f64 = 1e-11;
const ONE_DIRECTION: f64 = 1e-9;

/// Change of a surface's point by u, relative to that by v, below which it is at a pole.
const POLE: f64 = 1e-5;

const STEPS: usize = 24;

/// Facets of bodies, with their origin.
pub(super) struct NearMissSearch<'a, T> {
    pub points: &'a [Vec3],
    /// By point: whether it is a vertex of its body.
    pub vertex: &'a [bool],
    pub facets: &'a [Facet],
    pub sources: &'a [FacetSource<T>],
    pub scale: f64,
}

/// A part of a shape: a vertex, or a point in an edge or a face, by up to two parameters.
#[derive(Clone, Copy)]
enum Stratum<'a, T> {
    Vertex(Vec3),
    Plane {
        at: Vec3,
        normal: Vec3,
    },
    Line {
        at: Vec3,
        way: Vec3,
    },
    Edge(&'a SmoothPiece<T>),
    /// Through points of an edge that has no closed form.
    Traced([Vec3; 4]),
    Face(&'a FaceSurface<T>),
}

impl<T: Real> Stratum<'_, T> {
    /// Number of parameters of a search: points of planes and lines are those nearest to the
    /// other's.
    fn unknowns(&self) -> usize {
        match self {
            Stratum::Vertex(_) | Stratum::Plane { .. } | Stratum::Line { .. } => 0,
            Stratum::Edge(_) | Stratum::Traced(_) => 1,
            Stratum::Face(_) => 2,
        }
    }

    fn straight(&self) -> bool {
        self.unknowns() == 0
    }

    fn about(&self) -> Option<SurfaceAbout> {
        match self {
            Stratum::Face(surface) => SurfaceAbout::of(surface),
            Stratum::Plane { at, normal } => {
                SurfaceAbout::of(&FaceSurface::Plane { at: *at, normal: *normal })
            }
            _ => None,
        }
    }

    /// True at the pole of a surface, where its directions are not known; it is a vertex, which is searched for itself.
    fn at_pole(&self, x: &[f64]) -> bool {
        let Stratum::Face(surface) = self else { return false };
        let [_, du, dv] = surface.jet(T::from(x[0]), T::from(x[1])).map(Vec3::re);
        du.norm() <= POLE * dv.norm()
    }

    /// The axis of a circle or surface of revolution about which its facets are divided.
    fn axis(&self) -> Option<Axis<f64>> {
        match self {
            Stratum::Edge(SmoothPiece::Conic { centre, a, b, .. }) => {
                let [point, a, b] = [*centre, *a, *b].map(Vec3::re);
                let size = a.norm_sq();
                let round = (size - b.norm_sq()).abs().max(a.dot(b).abs()) <= ONE_AXIS * size;
                let direction = a.cross(b).normalized()?;
                round.then_some(Axis { point, direction })
            }
            Stratum::Face(surface) => {
                let Axis { point, direction } = RevolvedSurface::of(surface)?.axis;
                Some(Axis { point: point.re(), direction: direction.re() })
            }
            _ => None,
        }
    }

    /// The point and its directions: one of an edge, two of a face, unit ones.
    fn at(&self, x: &[f64], near: Vec3) -> (Vec3, Vec<Vec3>) {
        let unit = |v: Vec3| v.normalized().unwrap_or_default();
        match self {
            Stratum::Vertex(p) => (*p, vec![]),
            Stratum::Plane { at, normal } => {
                let u = unit(normal.perpendicular());
                (near - *normal * normal.dot(near - *at), vec![u, normal.cross(u)])
            }
            Stratum::Line { at, way } => (*at + *way * way.dot(near - *at), vec![*way]),
            Stratum::Edge(piece) => {
                let s = T::from(x[0]);
                (piece.at(s).re(), vec![unit(piece.velocity(s).re())])
            }
            Stratum::Traced(points) => {
                let at = |s: f64| lagrange(points, s);
                (at(x[0]), vec![unit(at(x[0] + 1e-4) - at(x[0] - 1e-4))])
            }
            Stratum::Face(surface) => {
                let [p, u, v] = surface.jet(T::from(x[0]), T::from(x[1])).map(Vec3::re);
                (p, vec![unit(u), unit(v)])
            }
        }
    }

    fn parameters(&self, p: Vec3) -> Vec<f64> {
        match self {
            Stratum::Vertex(_) | Stratum::Plane { .. } | Stratum::Line { .. } => vec![],
            Stratum::Edge(piece) => vec![along(piece, p)],
            Stratum::Traced(points) => {
                let way = points[3] - points[0];
                vec![way.dot(p - points[0]) / way.norm_sq().max(f64::MIN_POSITIVE)]
            }
            Stratum::Face(surface) => surface.parameters(p).to_vec(),
        }
    }
}

/// The cubic through four points at 0, 1/3, 2/3 and 1.
fn lagrange(points: &[Vec3; 4], s: f64) -> Vec3 {
    let node = |k: usize| k as f64 / 3.0;
    (0..4).fold(Vec3::zero(), |sum, k| {
        let rest = (0..4).filter(|j| *j != k);
        sum + points[k] * rest.map(|j| (s - node(j)) / (node(k) - node(j))).product::<f64>()
    })
}

/// A facet, a side of one on an edge, or a vertex.
struct Element<'a, T> {
    operand: usize,
    stratum: Stratum<'a, T>,
    corners: Vec<Vec3>,
    middle: Vec3,
    /// Its unit normal, or direction of a side.
    way: Vec3,
    /// Distance from its exact element.
    off: f64,
    /// Maximum angle between its normal or direction and those of its exact element.
    turn: f64,
    size: f64,
    /// The mean width of a facet, which is often a long strip; the length of a side.
    width: f64,
    /// The vertices of its face or edge, and a number of it.
    rim: (u32, usize),
    traced: bool,
    loops: &'a [Vec<u32>],
}

impl<T: Real> Element<'_, T> {
    /// How far a point of a face of revolution is from its facet along a direction, in the plane
    /// through the axis.
    fn bulge(&self, axis: &Axis<f64>, p: Vec3, way: Vec3) -> f64 {
        if !matches!(self.stratum, Stratum::Face(_)) {
            return 0.0;
        }
        let Some(out) = (p - axis.foot(p)).normalized() else { return 0.0 };
        // Distance from the axis and height of each corner.
        let flat = |p: Vec3| [p.distance(axis.foot(p)), axis.direction.dot(p - axis.point)];
        let corners = self.corners.iter().map(|p| flat(*p));
        let first = flat(self.corners[0]);
        let far = |c: &[f64; 2]| (c[0] - first[0]).powi(2) + (c[1] - first[1]).powi(2);
        let Some(last) = corners.max_by(|c, d| far(c).total_cmp(&far(d))) else { return 0.0 };
        let normal = [last[1] - first[1], first[0] - last[0]];
        let own = flat(p);
        let (rise, rate) = (
            normal[0] * (own[0] - first[0]) + normal[1] * (own[1] - first[1]),
            normal[0] * out.dot(way) + normal[1] * axis.direction.dot(way),
        );
        if rate == 0.0 { f64::INFINITY } else { rise / rate }
    }
}

impl<T: Real> NearMissSearch<'_, T> {
    /// Positions at which facets do not determine whether surfaces intersect; with `within` also
    /// inside operands, not only between them.
    pub fn unclear(&self, within: bool) -> Vec<Vec3> {
        if self.sources.iter().all(|s| s.edges.iter().all(|e| straight(e.0.as_ref()))) {
            return Vec::new();
        }
        let mut rims: Vec<BTreeSet<u32>> = Vec::new();
        let near: Vec<&Facet> =
            if within { self.facets.iter().collect() } else { self.near_other().collect() };
        let elements = self.elements(&near, &mut rims);
        let first = elements.iter().filter(|e| e.operand == 0).count();
        let grown: Vec<[Vec3; 2]> = (elements.iter())
            .map(|e| {
                let by = Vec3::new(1.0, 1.0, 1.0) * (SAFE * e.off + TOUCHING[0] * self.scale);
                let [low, high] = bounds(&e.corners);
                [low - by, high + by]
            })
            .collect();
        let mut near: Vec<(usize, usize)> = Vec::new();
        let apart = if within { usize::MAX } else { first };
        overlapping(&grown, 0.0, apart, |i, j| near.push((i, j)));
        near.sort_unstable();
        let mut places: Vec<Vec3> = Vec::new();
        let mut lengths: HashMap<(usize, usize), Option<Vec<f64>>> = HashMap::new();
        for place in near.into_iter().filter_map(|(i, j)| {
            let (a, b) = (&elements[i], &elements[j]);
            if a.stratum.straight() && b.stratum.straight() {
                return None;
            }
            if let ((0, f), (0, g)) = (a.rim, b.rim) {
                let known = lengths.entry((f, g)).or_insert_with(|| {
                    let [a, b] = [a.stratum.about()?, b.stratum.about()?];
                    a.common_normals(&b, self.scale)
                });
                let (same, reach) = (TOUCHING[0] * self.scale, SAFE * (a.off + b.off));
                let clear = |length: &f64| *length <= 0.5 * same || *length > 1.001 * reach + same;
                if known.as_ref().is_some_and(|all| all.iter().all(clear)) {
                    return None;
                }
            }
            let joined = || {
                let (r, s) = (&rims[a.rim.1], &rims[b.rim.1]);
                a.rim == b.rim || r.intersection(s).next().is_some()
            };
            if a.operand == b.operand && joined() {
                return None;
            }
            self.pair(a, b)
        }) {
            // Neighbouring facets find the same position.
            if places.iter().all(|p| p.distance(place) > SAME * self.scale) {
                places.push(place);
            }
        }
        places
    }

    /// Facets that may be near enough to the box of the other operand: no point of a facet or its sides is farther from
    /// its exact element than they are wide.
    fn near_other(&self) -> impl Iterator<Item = &Facet> {
        let wide = |f: &Facet| {
            let corners: Vec<Vec3> =
                f.loops.iter().flatten().map(|&v| self.points[v as usize]).collect();
            let [low, high] = bounds(&corners);
            let by = SAFE * (high - low).norm() + TOUCHING[0] * self.scale;
            let by = Vec3::new(by, by, by);
            [low - by, high + by]
        };
        let boxes: Vec<[Vec3; 2]> = self.facets.iter().map(wide).collect();
        let all = [0, 1].map(|operand| {
            let own = self.facets.iter().zip(&boxes).filter(|(f, _)| f.operand == operand);
            let corners: Vec<Vec3> = own.flat_map(|(_, b)| *b).collect();
            (!corners.is_empty()).then(|| bounds(&corners))
        });
        self.facets.iter().zip(boxes).filter_map(move |(f, [low, high])| {
            let [from, to] = all[1 - f.operand]?;
            (0..3).all(|k| low[k] <= to[k] && high[k] >= from[k]).then_some(f)
        })
    }

    fn elements<'a>(
        &'a self,
        facets: &[&'a Facet],
        rims: &mut Vec<BTreeSet<u32>>,
    ) -> Vec<Element<'a, T>> {
        // Vertices of faces and edges: only elements without a common one can have a false
        // intersection.
        let mut face_rim: BTreeMap<(usize, u32), usize> = BTreeMap::new();
        let mut edge_rim: BTreeMap<(usize, u32), usize> = BTreeMap::new();
        let mut sides: BTreeMap<(u32, u32), (usize, u32)> = BTreeMap::new();
        let mut corners: BTreeMap<u32, usize> = BTreeMap::new();
        let new = |rims: &mut Vec<BTreeSet<u32>>| {
            rims.push(BTreeSet::new());
            rims.len() - 1
        };
        for &f in facets {
            let face = *face_rim.entry((f.operand, f.tag)).or_insert_with(|| new(rims));
            for (cycle, tags) in f.loops.iter().zip(&f.edges) {
                for k in 0..cycle.len() {
                    let (a, b) = (cycle[k], cycle[(k + 1) % cycle.len()]);
                    let vertices = [a, b].into_iter().filter(|v| self.vertex[*v as usize]);
                    for v in vertices.clone() {
                        rims[face].insert(v);
                        corners.insert(v, f.operand);
                    }
                    if tags[k] == INNER {
                        continue;
                    }
                    let key = (f.operand, tags[k]);
                    let edge = *edge_rim.entry(key).or_insert_with(|| new(rims));
                    rims[edge].extend(vertices);
                    sides.insert((a.min(b), a.max(b)), key);
                }
            }
        }
        let mut out: Vec<Element<'a, T>> = Vec::new();
        let mut known: HashMap<(usize, u32, u32), Option<Vec3>> = HashMap::new();
        let mut last: HashMap<(usize, u32), [f64; 2]> = HashMap::new();
        for &f in facets {
            let source = &self.sources[f.operand];
            let surface = &source.surfaces[f.tag as usize];
            let own: Vec<u32> = f.loops.iter().flatten().copied().collect();
            let at: Vec<Vec3> = own.iter().map(|&v| self.points[v as usize]).collect();
            let (mut off, mut turn) = (0.0f64, 0.0f64);
            let stratum = match surface {
                FaceSurface::Plane { .. } => Stratum::Plane { at: at[0], normal: f.normal },
                surface => {
                    let normals: Vec<Vec3> = (own.iter().zip(&at))
                        .map(|(&v, &p)| {
                            let normal = *known.entry((f.operand, f.tag, v)).or_insert_with(|| {
                                let from = last.get(&(f.operand, f.tag)).copied();
                                let place = follow(surface, p, from);
                                last.insert((f.operand, f.tag), place);
                                normal_at(surface, place)
                            });
                            // The apex of a cone has the normals of the lines that end there.
                            normal.or_else(|| beside_pole(surface, p, &at)).unwrap_or(f.normal)
                        })
                        .collect();
                    // Over a chord e between normals m and n a surface rises e·(n - m) / 8.
                    for i in 0..at.len() {
                        turn = turn.max(normals[i].cross(f.normal).norm());
                        for j in 0..i {
                            let rise = (at[i] - at[j]).dot(normals[i] - normals[j]).abs() / 8.0;
                            off = off.max(rise);
                        }
                    }
                    Stratum::Face(surface)
                }
            };
            let rim = (0, face_rim[&(f.operand, f.tag)]);
            let way = f.normal;
            out.push(element(f.operand, stratum, at, way, (1.2 * off, turn), rim, &f.loops));
        }
        for (&(a, b), key) in &sides {
            let source = &self.sources[key.0];
            let ends = [a, b].map(|v| self.points[v as usize]);
            let Some(way) = (ends[1] - ends[0]).normalized() else { continue };
            let middle = (ends[0] + ends[1]) * 0.5;
            let reach = ends[0].distance(ends[1]);
            let piece = source.edges[key.1 as usize].0.as_ref();
            let nodes = &source.traced[key.1 as usize];
            let (stratum, top) = match piece {
                Some(piece) if !straight(Some(piece)) => {
                    let s = T::from(along(piece, middle));
                    (Stratum::Edge(piece), piece.at(s).re())
                }
                None if !nodes.is_empty() => {
                    // The nodes nearest to the thirds of the chord.
                    let part = |p: Vec3| way.dot(p - ends[0]) / reach;
                    let nearest = |third: f64| {
                        let at = ends[0].lerp(ends[1], third);
                        nodes
                            .iter()
                            .map(|n| n.0)
                            .min_by(|p, q| p.distance(at).total_cmp(&q.distance(at)))
                    };
                    let [Some(p), Some(q)] = [1.0 / 3.0, 2.0 / 3.0].map(nearest) else { continue };
                    let through = [(0.0, ends[0]), (part(p), p), (part(q), q), (1.0, ends[1])];
                    let points = [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0].map(|s| between(&through, s));
                    let top = between(&through, 0.5);
                    (Stratum::Traced(points), top)
                }
                _ => (Stratum::Line { at: ends[0], way }, middle),
            };
            let off = top.distance(middle);
            // Over a chord of height h and length l a circle turns by 4 h / l to either side.
            let turn = (4.0 * off / reach).min(1.0);
            let rim = (1, edge_rim[key]);
            out.push(element(key.0, stratum, ends.to_vec(), way, (1.2 * off, turn), rim, &[]));
        }
        for (&v, &operand) in &corners {
            rims.push(BTreeSet::from([v]));
            let p = self.points[v as usize];
            let rim = (2, rims.len() - 1);
            let stratum = Stratum::Vertex(p);
            out.push(element(operand, stratum, vec![p], Vec3::zero(), (0.0, 0.0), rim, &[]));
        }
        out.sort_by_key(|e| e.operand);
        out
    }

    /// The point of a common normal of two elements for which facets are too coarse.
    fn pair(&self, a: &Element<'_, T>, b: &Element<'_, T>) -> Option<Vec3> {
        // Tangent directions of one are perpendicular to normals of the other, up to the turn of
        // facets.
        let slack = a.turn + b.turn + 0.03;
        match (a.rim.0, b.rim.0) {
            (0, 0) if a.way.cross(b.way).norm() > slack => return None,
            (0, 1) | (1, 0) if a.way.dot(b.way).abs() > slack => return None,
            _ => {}
        }
        let reach = SAFE * (a.off + b.off);
        let size = a.size.min(b.size).max(reach);
        // A search between a large facet and a small one starts at the small one.
        let small = if a.size <= b.size { a } else { b };
        let (n, m) = (a.stratum.unknowns(), b.stratum.unknowns());
        let start = |e: &Element<'_, T>| {
            let p = if std::ptr::eq(e, small) { e.middle } else { small.middle };
            e.stratum.parameters(p)
        };
        let mut x: Vec<f64> = start(a);
        x.extend(start(b));
        let places = |x: &[f64]| {
            let free =
                |s: &Stratum<'_, T>| matches!(s, Stratum::Plane { .. } | Stratum::Line { .. });
            if free(&a.stratum) {
                let (q, dq) = b.stratum.at(&x[n..], Vec3::zero());
                let (p, dp) = a.stratum.at(&[], q);
                ((p, dp), (q, dq))
            } else {
                let (p, dp) = a.stratum.at(&x[..n], Vec3::zero());
                let (q, dq) = b.stratum.at(&x[n..], p);
                ((p, dp), (q, dq))
            }
        };
        let residual = |x: &[f64]| -> Vec<f64> {
            let ((p, dp), (q, dq)) = places(x);
            let gap = (p - q) / size;
            let face = |d: &[Vec3]| d[0].cross(d[1]).normalized().unwrap_or_default();
            // Normals are parallel where a face is; the gap is square to a face or to both edges.
            match (dp.len(), dq.len()) {
                (2, 2) => {
                    let nq = face(&dq);
                    let mut all: Vec<f64> = dp.iter().map(|d| d.dot(nq)).collect();
                    if n > 0 && m > 0 {
                        all.extend(dq.iter().map(|d| gap.dot(*d)));
                    }
                    all
                }
                (2, 1) => {
                    let np = face(&dp);
                    let mut all = vec![dq[0].dot(np)];
                    all.extend(dp.iter().map(|d| gap.dot(*d)));
                    all
                }
                (1, 2) => {
                    let nq = face(&dq);
                    let mut all = vec![dp[0].dot(nq)];
                    all.extend(dq.iter().map(|d| gap.dot(*d)));
                    all
                }
                _ => dp.iter().chain(&dq).map(|d| gap.dot(*d)).collect(),
            }
        };
        let mut r = residual(&x);
        let mut settled = false;
        for _ in 0..STEPS {
            let rows = r.len();
            let mut columns: Vec<Vec<f64>> = Vec::with_capacity(n + m);
            for k in 0..n + m {
                let h = 1e-6;
                let mut moved = x.clone();
                moved[k] += h;
                let s = residual(&moved);
                columns.push((0..rows).map(|i| (s[i] - r[i]) / h).collect());
            }
            let step = least(&columns, &r);
            let longest = step.iter().fold(0.0f64, |l, s| l.max(s.abs()));
            if !longest.is_finite() {
                return None;
            }
            let held = if longest > 0.5 { 0.5 / longest } else { 1.0 };
            x.iter_mut().zip(&step).for_each(|(x, s)| *x -= held * s);
            r = residual(&x);
            if longest < 1e-12 {
                settled = true;
                break;
            }
        }
        let left = r.iter().fold(0.0f64, |l, s| l.max(s.abs()));
        // At coincident corners with a common tangent a search converges to the corners slowly.
        let shared = || {
            let same = TOUCHING[0] * self.scale;
            a.corners.iter().any(|p| b.corners.iter().any(|q| p.distance(*q) <= same))
        };
        if !settled && (left > 1e-7 || shared()) {
            return None;
        }
        let ((p, _), (q, _)) = places(&x);
        let gap = p.distance(q);
        let same = TOUCHING[usize::from(a.traced || b.traced)] * self.scale;
        if gap <= same || gap > reach || !self.covers(a, p) || !self.covers(b, q) {
            return None;
        }
        let ordered = gap > ORDERED * self.scale && self.keep_order([a, b], [p, q]);
        if ordered || a.stratum.at_pole(&x[..n]) || b.stratum.at_pole(&x[n..]) {
            return None;
        }
        // Another solution than a common normal, as at poles.
        (left <= 1e-6).then_some((p + q) * 0.5)
    }

    /// True if two elements are about one axis, or one is a plane across it, and their facets are in
    /// the order of the points of a common normal. No corner of one may be between those of the
    /// other: at any angle the facets of both are then nearer to the axis by one factor, and their
    /// order is that of chords in a plane through the axis.
    fn keep_order(&self, [a, b]: [&Element<'_, T>; 2], [p, q]: [Vec3; 2]) -> bool {
        let across = |e: &Element<'_, T>| match e.stratum {
            Stratum::Plane { normal, .. } => Some(normal),
            _ => None,
        };
        let axis = match (a.stratum.axis(), b.stratum.axis()) {
            (Some(axis), Some(other)) => {
                let turned = axis.direction.cross(other.direction).norm();
                let apart = other.point.distance(axis.foot(other.point));
                (turned <= ONE_AXIS && apart <= ONE_AXIS * self.scale).then_some(axis)
            }
            (Some(axis), None) | (None, Some(axis)) => {
                let normal = across(a).or_else(|| across(b));
                normal.filter(|n| axis.direction.cross(*n).norm() <= ONE_AXIS).map(|_| axis)
            }
            (None, None) => None,
        };
        let Some((axis, way)) = axis.zip((p - q).normalized()) else { return false };
        let gap = (p - q).dot(way) - a.bulge(&axis, p, way) + b.bulge(&axis, q, way);
        if gap <= ORDERED * self.scale {
            return false;
        }
        if across(a).or_else(|| across(b)).is_some() {
            return true;
        }
        let ways = |e: &Element<'_, T>| -> Vec<Vec3> {
            let arms = e.corners.iter().map(|p| *p - axis.foot(*p));
            arms.filter(|arm| arm.norm() > ONE_DIRECTION * self.scale)
                .filter_map(Vec3::normalized)
                .collect()
        };
        let (p, q) = (ways(a), ways(b));
        let turn = |a: &Vec3, b: &Vec3| axis.direction.dot(a.cross(*b));
        let between = |x: &Vec3, own: &[Vec3]| {
            let sides = own.iter().map(|w| turn(x, w));
            let (low, high) = sides.fold((0.0f64, 0.0f64), |(l, h), s| (l.min(s), h.max(s)));
            low < -ONE_DIRECTION && high > ONE_DIRECTION && own.iter().all(|w| w.dot(*x) > 0.0)
        };
        !p.iter().any(|x| between(x, &q)) && !q.iter().any(|x| between(x, &p))
    }

    /// True if a point is over a facet, side or vertex.
    fn covers(&self, e: &Element<'_, T>, p: Vec3) -> bool {
        let margin = BEYOND * e.width + SAFE * e.off;
        match e.rim.0 {
            0 => {
                let u = e.way.perpendicular().normalized().unwrap_or_default();
                let v = e.way.cross(u);
                let flat = |p: Vec3| [u.dot(p - e.middle), v.dot(p - e.middle)];
                let [x, y] = flat(p);
                let mut inside = false;
                for cycle in e.loops {
                    for k in 0..cycle.len() {
                        let ends = [cycle[k], cycle[(k + 1) % cycle.len()]];
                        let [s, t] = ends.map(|v| flat(self.points[v as usize]));
                        if (s[1] > y) != (t[1] > y)
                            && x < s[0] + (y - s[1]) / (t[1] - s[1]) * (t[0] - s[0])
                        {
                            inside = !inside;
                        }
                        let (d, w) = ([t[0] - s[0], t[1] - s[1]], [x - s[0], y - s[1]]);
                        let long = (d[0] * d[0] + d[1] * d[1]).max(f64::MIN_POSITIVE);
                        let part = ((d[0] * w[0] + d[1] * w[1]) / long).clamp(0.0, 1.0);
                        let miss = [w[0] - part * d[0], w[1] - part * d[1]];
                        if miss[0] * miss[0] + miss[1] * miss[1] <= margin * margin {
                            return true;
                        }
                    }
                }
                inside
            }
            1 => {
                let part = e.way.dot(p - e.corners[0]);
                (-margin..=e.size + margin).contains(&part)
            }
            _ => true,
        }
    }
}

fn element<'a, T: Real>(
    operand: usize,
    stratum: Stratum<'a, T>,
    corners: Vec<Vec3>,
    way: Vec3,
    (off, turn): (f64, f64),
    rim: (u32, usize),
    loops: &'a [Vec<u32>],
) -> Element<'a, T> {
    let middle = corners.iter().fold(Vec3::zero(), |s, p| s + *p) / corners.len() as f64;
    let [low, high] = bounds(&corners);
    let traced = matches!(stratum, Stratum::Traced(_));
    let size = (high - low).norm();
    let width = match rim.0 {
        0 => {
            let (mut rest, mut twice) = (&corners[..], Vec3::zero());
            for cycle in loops {
                let (ring, more) = rest.split_at(cycle.len());
                (rest, twice) = (more, twice + super::facet_source::newell(ring));
            }
            twice.norm() / (2.0 * size).max(f64::MIN_POSITIVE)
        }
        _ => size,
    };
    Element { operand, stratum, corners, middle, way, off, turn, size, width, rim, traced, loops }
}

fn bounds(points: &[Vec3]) -> [Vec3; 2] {
    points.iter().fold([points[0]; 2], |[l, h], p| {
        [
            Vec3::new(l.x.min(p.x), l.y.min(p.y), l.z.min(p.z)),
            Vec3::new(h.x.max(p.x), h.y.max(p.y), h.z.max(p.z)),
        ]
    })
}

/// The point of a curve through four points at a part of the chord.
fn between(through: &[(f64, Vec3); 4], s: f64) -> Vec3 {
    (0..4).fold(Vec3::zero(), |sum, k| {
        let rest = (0..4).filter(|j| *j != k);
        let weight = rest.map(|j| (s - through[j].0) / (through[k].0 - through[j].0));
        sum + through[k].1 * weight.product::<f64>()
    })
}

fn straight<T: Real>(piece: Option<&SmoothPiece<T>>) -> bool {
    match piece {
        Some(SmoothPiece::Cubic(p)) => {
            let [p, q, r, e] = p.map(Vec3::re);
            let long = p.distance(e);
            [q, r].iter().all(|x| (*x - p).cross(e - p).norm() <= 1e-12 * long * long)
        }
        _ => false,
    }
}

/// The unit normal of a surface; `None` at a pole.
fn normal_at<T: Real>(surface: &FaceSurface<T>, [u, v]: [f64; 2]) -> Option<Vec3> {
    let [_, du, dv] = surface.jet(T::from(u), T::from(v)).map(Vec3::re);
    // Rounding leaves a direction of no length a little.
    let some = du.norm().min(dv.norm()) > 1e-9 * du.norm().max(dv.norm());
    some.then(|| du.cross(dv).normalized()).flatten()
}

/// The normal at a pole, as a facet there comes to it.
fn beside_pole<T: Real>(surface: &FaceSurface<T>, pole: Vec3, corners: &[Vec3]) -> Option<Vec3> {
    let middle = corners.iter().fold(Vec3::zero(), |s, p| s + *p) / corners.len() as f64;
    normal_at(surface, surface.parameters(pole.lerp(middle, 1e-3)))
}

/// The parameters of a point of a surface, from those of a neighbour.
fn follow<T: Real>(surface: &FaceSurface<T>, p: Vec3, from: Option<[f64; 2]>) -> [f64; 2] {
    let Some(mut at) = from else { return surface.parameters(p) };
    for _ in 0..6 {
        let [s, du, dv] = surface.jet(T::from(at[0]), T::from(at[1])).map(Vec3::re);
        let r = p - s;
        let (a, b, c) = (du.norm_sq(), du.dot(dv), dv.norm_sq());
        let det = a * c - b * b;
        if r.norm_sq() <= 1e-20 * (a + c) {
            return at;
        }
        if det <= 1e-14 * a * c {
            break;
        }
        let (x, y) = (du.dot(r), dv.dot(r));
        at[0] = (at[0] + (c * x - b * y) / det).clamp(-0.2, 1.2);
        at[1] = (at[1] + (a * y - b * x) / det).clamp(-0.2, 1.2);
    }
    surface.parameters(p)
}

/// The shortest step that solves columns for a right side as well as can be, lightly damped.
fn least(columns: &[Vec<f64>], right: &[f64]) -> Vec<f64> {
    let n = columns.len();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let trace: f64 = columns.iter().map(|c| dot(c, c)).sum();
    let mut matrix = vec![0.0; n * n];
    for i in 0..n {
        for j in 0..n {
            matrix[i * n + j] = dot(&columns[i], &columns[j]);
        }
        matrix[i * n + i] += 1e-11 * trace + f64::MIN_POSITIVE;
    }
    let mut sides: Vec<f64> = columns.iter().map(|c| dot(c, right)).collect();
    match moldloft_num::solve_dense(&mut matrix, &mut sides) {
        Ok(_) => sides,
        Err(_) => vec![0.0; n],
    }
}
