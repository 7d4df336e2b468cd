//! Whole faces beside patches: on cylinders and cones, and their images. A face around its axis is
//! divided by a plane through the axis.
//!
//! `triangles -> cut by planes, a label for each half -> ... -> sides between faces that are lines and ellipses, or near
//! enough -> faces on their surfaces`
//!
//! Corners that are on the plane of a cut, and apexes, leave a surface to the patches.

use crate::labelled::{faced, span};
use crate::patches::PatchedBody;
use crate::seams::{FacetNet, ordered};
use crate::{
    BrepEdge, BrepFace, Coedge, ExactCurve, FacetFault, FacetFaultKind, LabelledFacets,
    SurfaceAxes, SurfaceShape, meet,
};
use moldloft_num::Vec3;
use moldloft_spline::nurbs::Nurbs;
use rustc_hash::{FxHashMap, FxHashSet};
use std::f64::consts::PI;

/// Directions of planes that are tried.
const CHOICES: usize = 48;

/// Minimum distance of corners from a cut, in cells; closer vertices are moved onto the cut.
const CLEAR: f64 = 0.5;
const ONTO: f64 = 0.2;

/// Distance, relative to the size, below which a point is on a curve.
const NEAR: f64 = 1e-9;

/// Maximum distance of the sides of whole faces from these, relative to the accuracy: they meet
/// exact edges of the same face, and must not intersect them where both are nearly parallel.
const STRAY: f64 = 0.05;

/// Surfaces with whole faces, and the cuts made for them.
#[derive(Default)]
pub struct WholeSurfaces {
    /// For each label whether its faces are whole ones on a cylinder, a cone or an image.
    pub round: Vec<bool>,
    /// For each label that which it was.
    pub before: Vec<u32>,
    /// The planes of cuts.
    pub planes: Vec<(Vec3, Vec3)>,
    /// For both labels beside a cut the number of its plane.
    pub cuts: FxHashMap<(u32, u32), usize>,
}

impl WholeSurfaces {
    /// Labels without a whole one.
    pub fn none(count: usize) -> Self {
        let before = (0..count as u32).collect();
        Self { round: vec![false; count], before, ..Self::default() }
    }

    /// The surfaces at a point: where both sides of a cut surface meet, the plane of the cut
    /// replaces one of them.
    pub fn with_cuts(&self, labels: &[u32]) -> Vec<u32> {
        let mut own = labels.to_vec();
        for i in 0..own.len() {
            for j in 0..i {
                if let Some(plane) = self.cuts.get(&ordered(own[i], own[j])) {
                    own[i] = (self.round.len() + plane) as u32;
                }
            }
        }
        own
    }
}

/// The surface of revolution of a face that may be whole, its axes, and points in its coordinates.
struct RoundSurface<'a> {
    shape: &'a SurfaceShape,
    of: &'a SurfaceShape,
}

impl<'a> RoundSurface<'a> {
    fn new(shape: &'a SurfaceShape) -> Option<Self> {
        let of = match shape {
            SurfaceShape::Image(image) => image.of(),
            other => other,
        };
        matches!(of, SurfaceShape::Cylinder { .. } | SurfaceShape::Cone { .. })
            .then_some(Self { shape, of })
    }

    fn axes(&self) -> SurfaceAxes {
        let none = SurfaceAxes::about(Vec3::zero(), Vec3::of(0.0, 0.0, 1.0));
        self.of.axes().copied().unwrap_or(none)
    }

    fn local(&self, p: Vec3) -> Vec3 {
        match self.shape {
            SurfaceShape::Image(image) => image.local(p),
            _ => p,
        }
    }

    fn angle(&self, p: Vec3) -> f64 {
        self.axes().angle(self.local(p))
    }

    /// The plane through the axis at an angle.
    fn plane(&self, angle: f64) -> Option<(Vec3, Vec3)> {
        let axes = self.axes();
        let x = axes.x * libm::cos(angle) + axes.y() * libm::sin(angle);
        let normal = axes.z.cross(x);
        match self.shape {
            SurfaceShape::Image(image) => {
                let normal = image.gradient(normal).normalized()?;
                Some((image.world(axes.origin), normal))
            }
            _ => Some((axes.origin, normal)),
        }
    }
}

/// Finds the surfaces whose faces may be whole, and cuts faces around an axis; `shown` marks those
/// needed.
pub fn cut_round(
    net: &mut FacetNet,
    facets: &mut LabelledFacets,
    shown: &mut Vec<bool>,
) -> WholeSurfaces {
    let count = facets.surfaces.len();
    let mut whole = WholeSurfaces::none(count);
    for label in 0..count {
        let Some(shape) = facets.surfaces[label].clone().filter(|_| shown[label]) else { continue };
        let Some(surface) = RoundSurface::new(&shape) else { continue };
        let members: Vec<usize> =
            (0..net.triangles.len()).filter(|k| net.labels[*k] == label as u32).collect();
        if members.is_empty() {
            continue;
        }
        let near_apex = shape.apex().is_some_and(|apex| {
            let places = members.iter().flat_map(|k| net.corners(*k));
            places.into_iter().any(|p| p.distance(apex) <= 3.0 * facets.step)
        });
        if near_apex {
            continue;
        }
        if groups(net, &members).values().all(|own| gap(net, own, &surface).is_some()) {
            whole.round[label] = true;
            continue;
        }
        let Some(plane) = clear_plane(net, &members, &surface, facets.step) else { continue };
        let other = facets.surfaces.len() as u32;
        divide(net, label as u32, other, plane, ONTO * facets.step);
        whole.round[label] = true;
        whole.round.push(true);
        whole.before.push(label as u32);
        whole.cuts.insert((label as u32, other), whole.planes.len());
        whole.planes.push(plane);
        facets.surfaces.push(Some(shape));
        facets.names.push(facets.names[label].clone());
        facets.colours.push(facets.colours[label]);
        facets.layers.push(facets.layers[label].clone());
        shown.push(true);
    }
    whole
}

fn groups(net: &FacetNet, members: &[usize]) -> FxHashMap<u32, Vec<usize>> {
    let mut found: FxHashMap<u32, Vec<usize>> = FxHashMap::default();
    for &k in members {
        found.entry(net.groups[k]).or_default().push(k);
    }
    found
}

fn gap(net: &FacetNet, members: &[usize], surface: &RoundSurface<'_>) -> Option<f64> {
    net.gap(members, &|p| Some(surface.angle(p)))
}

/// A plane through the axis that is clear of the vertices of three surfaces.
fn clear_plane(
    net: &FacetNet,
    members: &[usize],
    surface: &RoundSurface<'_>,
    step: f64,
) -> Option<(Vec3, Vec3)> {
    let mut round: FxHashMap<u32, Vec<u32>> = FxHashMap::default();
    for (t, label) in net.triangles.iter().zip(&net.labels) {
        for v in t {
            let own = round.entry(*v).or_default();
            if !own.contains(label) {
                own.push(*label);
            }
        }
    }
    let mut corners: Vec<u32> = members.iter().flat_map(|k| net.triangles[*k]).collect();
    corners.sort_unstable();
    corners.dedup();
    corners.retain(|v| round[v].len() > 2);
    let far = |(origin, normal): &(Vec3, Vec3)| {
        let off = |v: &u32| (net.positions[*v as usize] - *origin).dot(*normal).abs();
        corners.iter().map(off).fold(f64::INFINITY, f64::min)
    };
    // No simple angles: the cuts would pass through vertices.
    let all = (0..CHOICES).filter_map(|k| surface.plane(0.013_77 + PI * k as f64 / CHOICES as f64));
    let all: Vec<((Vec3, Vec3), f64)> = all.map(|plane| (plane, far(&plane))).collect();
    // The first of those that are clear enough: the same one for the same body.
    let most = all.iter().map(|(_, far)| *far).fold(0.0, f64::max);
    let enough = (0.9 * most).min(4.0 * step);
    let (plane, far) = all.into_iter().find(|(_, far)| *far >= enough)?;
    (far >= CLEAR * step).then_some(plane)
}

/// Divides the triangles of a label by a plane; those on its positive side get the other label.
fn divide(net: &mut FacetNet, label: u32, other: u32, (origin, normal): (Vec3, Vec3), onto: f64) {
    let height = |p: Vec3| (p - origin).dot(normal);
    let of_label =
        |net: &FacetNet| (0..net.triangles.len()).filter(|k| net.labels[*k] == label).collect();
    let members: Vec<usize> = of_label(net);
    let mut on: FxHashSet<u32> = FxHashSet::default();
    for v in members.iter().flat_map(|k| net.triangles[*k]) {
        if height(net.positions[v as usize]).abs() <= onto {
            on.insert(v);
        }
    }
    let mut crossed = Vec::new();
    let mut seen = FxHashSet::default();
    for &k in &members {
        let t = net.triangles[k];
        for i in 0..3 {
            let (a, b) = ordered(t[i], t[(i + 1) % 3]);
            if on.contains(&a) || on.contains(&b) || !seen.insert((a, b)) {
                continue;
            }
            let [p, q] = [a, b].map(|v| net.positions[v as usize]);
            let (f, g) = (height(p), height(q));
            if (f > 0.0) != (g > 0.0) {
                crossed.push(((a, b), p.lerp(q, f / (f - g))));
            }
        }
    }
    crossed.sort_by_key(|c| c.0);
    for ((a, b), at) in crossed {
        on.insert(net.split(a, b, at));
    }
    let members: Vec<usize> = of_label(net);
    for k in members {
        let t = net.triangles[k];
        let clear = t.iter().filter(|v| !on.contains(v)).map(|v| net.positions[*v as usize]);
        let side: f64 = clear.map(height).sum();
        let [a, b, c] = net.corners(k);
        let above = if side == 0.0 { height((a + b + c) / 3.0) > 0.0 } else { side > 0.0 };
        if above {
            net.labels[k] = other;
        }
    }
    net.settle();
    net.groups = net.connected();
}

impl PatchedBody<'_> {
    /// True if faces on a surface are whole ones on a cylinder, a cone or an image.
    pub fn is_round(&self, label: u32) -> bool {
        self.whole.round[label as usize]
    }

    /// True if faces on a surface are whole, including plane ones.
    pub fn is_whole(&self, label: u32) -> bool {
        let surface = &self.facets.surfaces[label as usize];
        self.is_round(label) || matches!(surface, Some(SurfaceShape::Plane { .. }))
    }

    /// The labels on the left and on the right of a side.
    fn beside(&self, a: u32, b: u32) -> [u32; 2] {
        [(a, b), (b, a)].map(|side| self.net.labels[self.net.across[&side] as usize])
    }

    /// The line or ellipse of a side between two whole faces, if it is one.
    pub fn exact_side(&self, a: u32, b: u32) -> Option<ExactCurve> {
        let [l, r] = self.beside(a, b);
        if l == r || !(self.is_whole(l) && self.is_whole(r)) {
            return None;
        }
        if !(self.is_round(l) || self.is_round(r)) {
            return None;
        }
        let curves = self.meeting.get(&ordered(l, r))?;
        let places = [a, b].map(|v| self.net.positions[v as usize]);
        let far =
            |c: &ExactCurve| places.map(|p| c.near(p).distance(p)).into_iter().fold(0.0, f64::max);
        let best = curves.iter().map(|c| (far(c), *c)).min_by(|x, y| x.0.total_cmp(&y.0));
        best.filter(|(far, _)| *far <= self.accuracy.max(NEAR * self.size)).map(|(_, c)| c)
    }

    /// Finds the lines and ellipses in which whole faces meet.
    pub fn find_meetings(&mut self) {
        let mut pairs: Vec<(u32, u32)> = self
            .net
            .across
            .keys()
            .map(|&(a, b)| self.beside(a, b))
            .filter(|[l, r]| l < r && self.is_whole(*l) && self.is_whole(*r))
            .filter(|[l, r]| self.is_round(*l) || self.is_round(*r))
            .map(|[l, r]| (l, r))
            .collect();
        pairs.sort_unstable();
        pairs.dedup();
        for (l, r) in pairs {
            let shape = |label: u32| self.facets.surfaces[label as usize].clone();
            let other = match self.whole.cuts.get(&(l, r)) {
                Some(&plane) => {
                    let (origin, normal) = self.whole.planes[plane];
                    Some(SurfaceShape::Plane { origin, normal, axis: normal.perpendicular() })
                }
                None => shape(r),
            };
            if let Some((one, other)) = shape(l).zip(other) {
                self.meeting.insert((l, r), meet(&one, &other, NEAR * self.size, self.size));
            }
        }
    }

    /// Sides of round whole faces, and of faces beside others that are not wanted, that are too far
    /// from these, to be halved; `near` are those that are known to be near.
    pub fn strayed_sides(
        &mut self,
        near: &mut FxHashMap<(u32, u32), f64>,
    ) -> Result<Vec<(f64, (u32, u32))>, FacetFault> {
        let mut sides: Vec<(u32, u32)> = self
            .net
            .across
            .keys()
            .copied()
            .filter(|(a, b)| a < b && !near.contains_key(&(*a, *b)))
            .filter(|(a, b)| {
                let [l, r] = self.beside(*a, *b);
                let beside = self.is_shown_surface(l) != self.is_shown_surface(r);
                l != r && (self.is_round(l) || self.is_round(r) || beside)
            })
            .collect();
        sides.sort_unstable();
        let mut found = Vec::new();
        for (a, b) in sides {
            let [p, q] = [a, b].map(|v| self.net.positions[v as usize]);
            if self.exact_side(a, b).is_some() {
                near.insert((a, b), 0.0);
                continue;
            }
            self.make_side(a, b)?;
            let net = self.side(a, b);
            let bounds = |l: &u32| self.is_whole(*l) || !self.is_shown_surface(*l);
            let labels: Vec<u32> = self.beside(a, b).into_iter().filter(bounds).collect();
            let labels = self.whole.with_cuts(&labels);
            let off = labels
                .iter()
                .map(|l| self.basis.distance_of_curve(&net, *l, &*self.field))
                .fold(0.0, f64::max);
            if off <= STRAY * self.accuracy {
                near.insert((a, b), off);
            } else {
                let long = p.distance(q);
                if long < 1e-7 * self.size {
                    return Err(self.fault(FacetFaultKind::Edge, &labels, p));
                }
                found.push((long, (a, b)));
            }
        }
        Ok(found)
    }

    /// The edge along a line or an ellipse through vertices between two points.
    pub fn exact_edge(
        &self,
        curve: ExactCurve,
        chain: &[u32],
        ends: [Vec3; 2],
    ) -> Option<(Nurbs<1>, Option<ExactCurve>)> {
        match curve {
            ExactCurve::Line { .. } => Some((BrepEdge::segment(ends[0], ends[1]), None)),
            ExactCurve::Cubic(_) => None,
            ExactCurve::Ellipse { .. } => {
                let inner = chain[1..chain.len() - 1].iter();
                let inner = inner.map(|v| self.net.positions[*v as usize]);
                let closed = chain.first() == chain.last();
                span(curve, ends, inner, closed).map(|(curve, own)| (curve, Some(own)))
            }
        }
    }

    /// A face on a cylinder, a cone or an image.
    pub fn round_face(
        &self,
        members: &[usize],
        loops: Vec<Vec<Coedge>>,
        extent: ([[f64; 3]; 2], bool),
    ) -> Result<BrepFace, FacetFault> {
        let label = self.net.labels[members[0]];
        let place = self.net.corners(members[0])[0];
        let seam = || self.fault(FacetFaultKind::Seam, &[label], place);
        let shape = self.facets.surfaces[label as usize].as_ref().ok_or_else(seam)?;
        let surface = RoundSurface::new(shape).ok_or_else(seam)?;
        let angle = gap(&self.net, members, &surface).ok_or_else(seam)?;
        let mut axes = surface.axes();
        axes.x = axes.x * libm::cos(angle) + axes.y() * libm::sin(angle);
        let (surface, reversed) = faced(shape, Some(&axes), &self.net, members);
        Ok(BrepFace {
            name: self.facets.names[label as usize].clone(),
            colour: self.facets.colours[label as usize],
            layers: self.facets.layers[label as usize].clone(),
            surface,
            reversed,
            loops,
            error: 0.0,
            exact: true,
            extent: Some(extent),
        })
    }

    /// The middles of the triangles of round whole faces, on these, but for those at borders.
    pub fn round_places(&self) -> Vec<Vec3> {
        let mut border: FxHashSet<u32> = FxHashSet::default();
        for &(a, b) in self.net.across.keys() {
            let [l, r] = self.beside(a, b);
            if l != r {
                border.extend([a, b]);
            }
        }
        let clear = |k: &usize| self.net.triangles[*k].iter().all(|v| !border.contains(v));
        let place = |k: usize| {
            let label = self.net.labels[k];
            let [a, b, c] = self.net.corners(k);
            let shape = self.facets.surfaces[label as usize].as_ref();
            shape.filter(|_| self.is_round(label)).map(|s| s.onto((a + b + c) / 3.0))
        };
        (0..self.net.triangles.len()).filter(clear).filter_map(place).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Brep;
    use std::f64::consts::TAU;

    const ROUND: usize = 24;
    const RISE: f64 = 0.3;

    /// A cylinder of radius 1 on a plane, below the paraboloid z = 1 + 0.3 (x^2 + y^2).
    fn cup() -> LabelledFacets {
        let top = |r: f64| 1.0 + RISE * r * r;
        // Rings from the centre of the bottom to that of the top: radius, height, label of the
        // surface below.
        let mut rings = vec![(0.0, 0.0, 0), (0.5, 0.0, 0), (1.0, 0.0, 0)];
        rings.extend((1..=4).map(|k| (1.0, top(1.0) * f64::from(k) / 4.0, 1)));
        rings.extend([(0.6, top(0.6), 2), (0.3, top(0.3), 2), (0.0, top(0.0), 2)]);
        let mut numbers: Vec<Vec<u32>> = Vec::new();
        let mut facets = LabelledFacets {
            positions: Vec::new(),
            triangles: Vec::new(),
            labels: Vec::new(),
            surfaces: vec![
                Some(SurfaceShape::Plane {
                    origin: Vec3::zero(),
                    normal: Vec3::of(0.0, 0.0, -1.0),
                    axis: Vec3::of(1.0, 0.0, 0.0),
                }),
                Some(SurfaceShape::Cylinder {
                    axes: SurfaceAxes::about(Vec3::zero(), Vec3::of(0.0, 0.0, 1.0)),
                    radius: 1.0,
                }),
                None,
            ],
            names: ["low", "round", "top"].map(String::from).into(),
            colours: vec![None; 3],
            layers: vec![Vec::new(); 3],
            step: 0.26,
            certain: true,
        };
        for (r, z, label) in rings {
            let count = if r == 0.0 { 1 } else { ROUND };
            let first = facets.positions.len() as u32;
            for k in 0..count {
                let (s, c) = libm::sincos(TAU * (k as f64 + 0.21) / ROUND as f64);
                facets.positions.push(Vec3::of(r * c, r * s, z));
            }
            let own: Vec<u32> = (0..ROUND).map(|k| first + (k % count) as u32).collect();
            if let Some(before) = numbers.last() {
                for k in 0..ROUND {
                    let l = (k + 1) % ROUND;
                    for t in [[before[k], before[l], own[l]], [before[k], own[l], own[k]]] {
                        if t[0] != t[1] && t[1] != t[2] && t[2] != t[0] {
                            facets.triangles.push(t);
                            facets.labels.push(label);
                        }
                    }
                }
            }
            numbers.push(own);
        }
        facets
    }

    fn field(label: u32, p: Vec3) -> (f64, Vec3) {
        match label {
            0 => (-p.z, Vec3::of(0.0, 0.0, -1.0)),
            1 => (p.x * p.x + p.y * p.y - 1.0, Vec3::of(2.0 * p.x, 2.0 * p.y, 0.0)),
            _ => (
                p.z - 1.0 - RISE * (p.x * p.x + p.y * p.y),
                Vec3::of(-2.0 * RISE * p.x, -2.0 * RISE * p.y, 1.0),
            ),
        }
    }

    #[test]
    fn a_cylinder_below_patches_is_two_faces() {
        let mut brep = Brep::default();
        brep.add_patches(cup(), &field, 1e-5, 2.0, [true, false]).unwrap();
        let named = |name: &str| brep.faces.iter().filter(|f| f.name == name).collect::<Vec<_>>();
        assert_eq!((named("low").len(), named("round").len()), (1, 2));
        assert!(named("round").iter().all(|f| f.exact && f.loops.len() == 1));
        assert!(named("top").iter().all(|f| !f.exact && f.error <= 1e-5));
        let shells = brep.shells();
        assert_eq!((shells.len(), shells[0].closed), (1, true));
        assert_eq!(brep.faults(), []);
        // The circle below is two edges, between the lines of the cut.
        assert_eq!(brep.edges.iter().filter(|e| e.ellipse.is_some()).count(), 2);
        let ts: Vec<f64> = (0..=10).map(|k| f64::from(k) / 10.0).collect();
        for face in named("round") {
            for side in face.loops.iter().flatten() {
                for p in
                    brep.edges[side.edge].curve.grid(std::slice::from_ref(&ts).try_into().unwrap())
                {
                    assert!(face.surface.distance(p).unwrap().abs() <= 1e-5);
                }
            }
        }
    }
}
