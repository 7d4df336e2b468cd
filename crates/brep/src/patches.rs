//! Bodies with faces on any surfaces: plane faces, whole ones on cylinders and cones, and elsewhere
//! small patches within an accuracy of the surface.
//!
//! `triangles, each with its surface -> vertices and sides on their surfaces -> quadrilaterals and triangles -> patches`
//!
//! Patches with an error above the accuracy, or with folds, have their longest side halved, with
//! the neighbour's. Two patches share one edge with the same control points.

use crate::foot::foot;
use crate::labelled::extent;
use crate::patch::{FittedPatch, PatchBasis, SurfaceField};
use crate::seams::{FacetNet, ordered};
use crate::whole::{WholeSurfaces, cut_round};
use crate::{
    Brep, BrepEdge, BrepFace, Coedge, ExactCurve, FacetFault, FacetFaultKind, LabelledFacets,
    SurfaceShape,
};
use moldloft_num::{Pace, Vec3};
use moldloft_parallel::prelude::*;
use moldloft_spline::nurbs::Nurbs;
use rustc_hash::{FxHashMap, FxHashSet};
use std::collections::BTreeMap;

/// Most triangles that become patches of a body.
const MOST: usize = 48_000;

/// Ratio of expected to allowed patches at which subdivision is abandoned.
const MUCH: f64 = 4.0;

/// Maximum rounds of halving sides and correcting triangles, without patience and with it.
const ROUNDS: [usize; 2] = [16, 48];

/// Maximum rounds of corrections with patience: later ones concern slivers from halvings.
const CORRECTIONS: usize = 6;

/// Number of remaining faulty patches, and more than four times the minimum so far, that indicates
/// a kink.
const MANY: usize = 200;
const SMOOTH_AFTER: usize = 4;

/// The least sine of the corners of a quadrilateral.
const LEAST_CORNER: f64 = 0.25;

/// Degrees of patches; the higher one for accuracies below this fraction of the size.
const DEGREES: [usize; 2] = [3, 5];
const FINE: f64 = 3e-8;

impl Brep {
    /// Adds the faces of a body whose surfaces need not be planes, cylinders, cones, spheres or tori; returns points on
    /// them. With `whole` its cylinders and cones are whole faces, else patches as well; with `patient` more rounds of
    /// halving are tried, and less is corrected.
    ///
    /// # Errors
    /// Vertices and sides that are not on their surfaces; surfaces that no patches come near enough to.
    pub fn add_patches(
        &mut self,
        facets: LabelledFacets,
        field: &SurfaceField<'_>,
        accuracy: f64,
        size: f64,
        [whole, patient]: [bool; 2],
    ) -> Result<Vec<Vec3>, FacetFault> {
        let shown = vec![true; facets.surfaces.len()];
        let mut body = PatchedBody::new(facets, shown, field, [accuracy, size], whole)?;
        let patches = body.fit(patient)?;
        body.into_brep(self, patches)
    }

    /// Adds the faces of a body that are on the surfaces marked by `shown`; returns points on them.
    /// The other surfaces only bound these faces.
    ///
    /// # Errors
    /// As [`Self::add_patches`].
    pub fn add_sheet(
        &mut self,
        facets: LabelledFacets,
        shown: Vec<bool>,
        field: &SurfaceField<'_>,
        accuracy: f64,
        size: f64,
    ) -> Result<Vec<Vec3>, FacetFault> {
        let mut body = PatchedBody::new(facets, shown, field, [accuracy, size], false)?;
        let patches = body.fit(true)?;
        body.into_brep(self, patches)
    }
}

/// A patch by its corners; of a triangle the first one twice.
type Corners = [u32; 4];

pub struct PatchedBody<'a> {
    pub net: FacetNet,
    pub facets: LabelledFacets,
    pub field: Box<SurfaceField<'a>>,
    /// For each surface, whether its faces are wanted.
    shown: Vec<bool>,
    pub whole: WholeSurfaces,
    /// The lines and ellipses in which whole faces meet, by their labels.
    pub meeting: FxHashMap<(u32, u32), Vec<ExactCurve>>,
    /// For each surface 1 where its gradient points outwards, else -1; known once triangles are corrected.
    pub signs: Vec<f64>,
    pub basis: PatchBasis,
    pub accuracy: f64,
    pub size: f64,
    /// Distance of edges from whole faces.
    stray: f64,
    /// Control points of sides, from the lower vertex.
    sides: FxHashMap<(u32, u32), Vec<Vec3>>,
}

impl<'a> PatchedBody<'a> {
    fn new(
        mut facets: LabelledFacets,
        mut shown: Vec<bool>,
        field: &'a SurfaceField<'a>,
        [accuracy, size]: [f64; 2],
        wholly: bool,
    ) -> Result<Self, FacetFault> {
        let degree = DEGREES[usize::from(accuracy < FINE * size)];
        let positions = std::mem::take(&mut facets.positions);
        let place = positions.first().copied().unwrap_or_default();
        let is_curved = |label: u32| {
            let plane = matches!(facets.surfaces[label as usize], Some(SurfaceShape::Plane { .. }));
            shown[label as usize] && !plane
        };
        // Halving only makes more.
        let curved = facets.labels.iter().filter(|label| is_curved(**label)).count();
        if !wholly && curved > MOST {
            return Err(FacetFault { kind: FacetFaultKind::Many, surfaces: Vec::new(), place });
        }
        let triangles = std::mem::take(&mut facets.triangles);
        let labels = std::mem::take(&mut facets.labels);
        let open =
            |place| FacetFault { kind: FacetFaultKind::NotClosed, surfaces: Vec::new(), place };
        let mut net = FacetNet::new(positions, triangles, labels).map_err(open)?;
        let whole = if wholly {
            cut_round(&mut net, &mut facets, &mut shown)
        } else {
            WholeSurfaces::none(facets.surfaces.len())
        };
        let (before, planes) = (whole.before.clone(), whole.planes.clone());
        // Labels behind those of surfaces are planes of cuts.
        let field = move |label: u32, p: Vec3| match before.get(label as usize) {
            Some(known) => field(*known, p),
            None => {
                let (origin, normal) = planes[label as usize - before.len()];
                ((p - origin).dot(normal), normal)
            }
        };
        let basis = PatchBasis::new(degree);
        let mut body = Self {
            net,
            facets,
            field: Box::new(field),
            shown,
            whole,
            meeting: FxHashMap::default(),
            signs: Vec::new(),
            basis,
            accuracy,
            size,
            stray: 0.0,
            sides: FxHashMap::default(),
        };
        if wholly && body.curved() > MOST {
            return Err(body.fault(FacetFaultKind::Many, &[], place));
        }
        body.absorb_pieces();
        body.place_vertices()?;
        body.untangle(None);
        body.find_meetings();
        Ok(body)
    }

    /// True if a triangle belongs to a requested face.
    fn is_shown(&self, triangle: usize) -> bool {
        self.is_shown_surface(self.net.labels[triangle])
    }

    /// True if faces on a surface are requested.
    pub fn is_shown_surface(&self, label: u32) -> bool {
        self.shown[label as usize]
    }

    /// True if a triangle becomes a part of a patch.
    fn is_curved(&self, triangle: usize) -> bool {
        self.is_shown(triangle) && !self.is_whole(self.net.labels[triangle])
    }

    /// Number of triangles that become parts of patches.
    fn curved(&self) -> usize {
        (0..self.net.triangles.len()).filter(|k| self.is_curved(*k)).count()
    }

    fn plane(&self, triangle: usize) -> Option<&SurfaceShape> {
        let surface = self.facets.surfaces[self.net.labels[triangle] as usize].as_ref();
        surface.filter(|s| matches!(s, SurfaceShape::Plane { .. }))
    }

    pub fn fault(&self, kind: FacetFaultKind, labels: &[u32], place: Vec3) -> FacetFault {
        let mut surfaces: Vec<String> = Vec::new();
        for &label in labels {
            // Cutting planes have no inner side.
            if let Some(name) = self.facets.names.get(label as usize)
                && !surfaces.contains(name)
            {
                surfaces.push(name.clone());
            }
        }
        FacetFault { kind, surfaces, place }
    }

    /// Moves all vertices onto the surfaces of their triangles.
    fn place_vertices(&mut self) -> Result<(), FacetFault> {
        let mut labels: Vec<Vec<u32>> = vec![Vec::new(); self.net.positions.len()];
        for (t, label) in self.net.triangles.iter().zip(&self.net.labels) {
            for &v in t {
                let own = &mut labels[v as usize];
                if !own.contains(label) {
                    own.push(*label);
                }
            }
        }
        let reach = 2.0 * self.facets.step;
        let placed: Vec<Option<Vec3>> = labels
            .par_iter()
            .zip(&self.net.positions)
            .map(|(own, start)| self.foot(own, *start, reach))
            .collect();
        for (v, place) in placed.into_iter().enumerate() {
            let start = self.net.positions[v];
            if !labels[v].iter().any(|l| self.shown[*l as usize]) {
                continue;
            }
            self.net.positions[v] =
                place.ok_or_else(|| self.fault(FacetFaultKind::Vertex, &labels[v], start))?;
        }
        Ok(())
    }

    /// The point near another that is on all these surfaces within the accuracy.
    pub fn foot(&self, labels: &[u32], start: Vec3, reach: f64) -> Option<Vec3> {
        let scale = [self.accuracy, self.size];
        if self.whole.cuts.is_empty() {
            return foot(&*self.field, labels, start, reach, scale);
        }
        foot(&*self.field, &self.whole.with_cuts(labels), start, reach, scale)
    }

    /// The surfaces on both sides of a side.
    fn both(&self, a: u32, b: u32) -> Vec<u32> {
        let mut labels: Vec<u32> = [(a, b), (b, a)]
            .iter()
            .map(|side| self.net.labels[self.net.across[side] as usize])
            .collect();
        labels.dedup();
        labels
    }

    /// Both faces of a side are plane: it is straight.
    fn straight(&self, a: u32, b: u32) -> bool {
        [(a, b), (b, a)].iter().all(|s| self.plane(self.net.across[s] as usize).is_some())
    }

    /// The curve of a side, from its lower vertex.
    fn side_curve(&self, (a, b): (u32, u32)) -> Result<Vec<Vec3>, FacetFault> {
        let [p, q] = [a, b].map(|v| self.net.positions[v as usize]);
        let labels = self.both(a, b);
        let straight = self.straight(a, b);
        let last = self.basis.degree;
        let mut through = Vec::with_capacity(last + 1);
        for (k, t) in self.basis.at.iter().enumerate() {
            let chord = p + (q - p) * *t;
            let place = match k {
                0 => Some(p),
                k if k == last => Some(q),
                _ if straight => Some(chord),
                _ => self.foot(&labels, chord, 0.5 * p.distance(q)),
            };
            let Some(place) = place else {
                return Err(self.fault(FacetFaultKind::Edge, &labels, chord));
            };
            through.push(place);
        }
        Ok(self.basis.curve(&through))
    }

    /// Makes the curve of a side, if it is not known.
    pub fn make_side(&mut self, a: u32, b: u32) -> Result<(), FacetFault> {
        let key = ordered(a, b);
        if !self.sides.contains_key(&key) {
            let net = self.side_curve(key)?;
            self.sides.insert(key, net);
        }
        Ok(())
    }

    /// Makes these patches and their sides in parallel; an error if a side fails.
    fn make_patches(&mut self, which: &[(Corners, u32)]) -> Vec<Result<FittedPatch, FacetFault>> {
        let around = |[a, b, c, d]: Corners| [(a, b), (b, c), (c, d), (d, a)];
        let mut keys: Vec<(u32, u32)> = which
            .iter()
            .flat_map(|(corners, _)| around(*corners))
            .filter(|(a, b)| a != b)
            .map(|(a, b)| ordered(a, b))
            .filter(|key| !self.sides.contains_key(key))
            .collect();
        keys.sort_unstable();
        keys.dedup();
        let made: Vec<_> = keys.par_iter().map(|key| self.side_curve(*key)).collect();
        let mut faults: FxHashMap<(u32, u32), FacetFault> = FxHashMap::default();
        for (key, side) in keys.into_iter().zip(made) {
            match side {
                Ok(net) => drop(self.sides.insert(key, net)),
                Err(fault) => drop(faults.insert(key, fault)),
            }
        }
        let patch = |(corners, label): &(Corners, u32)| {
            let fault = around(*corners).into_iter().find_map(|(a, b)| faults.get(&ordered(a, b)));
            fault.map_or_else(|| Ok(self.patch(*corners, *label)), |fault| Err(fault.clone()))
        };
        which.par_iter().map(patch).collect()
    }

    /// The control points of a side from one vertex to the other.
    pub fn side(&self, a: u32, b: u32) -> Vec<Vec3> {
        if a == b {
            return vec![self.net.positions[a as usize]; self.basis.degree + 1];
        }
        let mut net = self.sides[&ordered(a, b)].clone();
        if a > b {
            net.reverse();
        }
        net
    }

    /// Quadrilaterals of two triangles of one surface, the best first, and the triangles that are left.
    fn pairs(&self, apart: &FxHashSet<Corners>) -> Vec<(Corners, u32)> {
        let at = |v: u32| self.net.positions[v as usize];
        let mut candidates: Vec<(f64, Corners, [usize; 2])> = Vec::new();
        for (k, t) in self.net.triangles.iter().enumerate() {
            if !self.is_curved(k) {
                continue;
            }
            for i in 0..3 {
                let [a, b, c] = [0, 1, 2].map(|j| t[(i + j) % 3]);
                let other = self.net.across[&(b, a)] as usize;
                if a > b || self.net.labels[other] != self.net.labels[k] {
                    continue;
                }
                let Some(d) =
                    self.net.triangles[other].iter().copied().find(|v| *v != a && *v != b)
                else {
                    continue;
                };
                let corners = [a, d, b, c];
                if d == c || apart.contains(&corners) {
                    continue;
                }
                let p = corners.map(at);
                let normal = (p[2] - p[0]).cross(p[3] - p[1]).normalized().unwrap_or_default();
                let sine = |i: usize| {
                    let [u, v] = [p[(i + 1) % 4] - p[i], p[(i + 3) % 4] - p[i]];
                    u.cross(v).dot(normal) / (u.norm() * v.norm())
                };
                let least = (0..4).map(sine).fold(f64::INFINITY, f64::min);
                if least > LEAST_CORNER {
                    candidates.push((least, corners, [k, other]));
                }
            }
        }
        candidates.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut used = vec![false; self.net.triangles.len()];
        let mut made = Vec::new();
        for (_, corners, [k, l]) in candidates {
            if !used[k] && !used[l] {
                (used[k], used[l]) = (true, true);
                made.push((corners, k as u32));
            }
        }
        for (k, t) in self.net.triangles.iter().enumerate() {
            if !used[k] && self.is_curved(k) {
                made.push((self.corners_of(*t), k as u32));
            }
        }
        made
    }

    /// A triangle as a quadrilateral that begins where its corner is sharpest.
    fn corners_of(&self, t: [u32; 3]) -> Corners {
        let at = |i: usize| self.net.positions[t[i % 3] as usize];
        let cosine = |i: usize| {
            let [u, v] = [at(i + 1) - at(i), at(i + 2) - at(i)];
            u.dot(v) / (u.norm() * v.norm())
        };
        let i = (0..3).max_by(|&a, &b| cosine(a).total_cmp(&cosine(b))).unwrap_or(0);
        [t[i], t[i], t[(i + 1) % 3], t[(i + 2) % 3]]
    }

    /// The patch between sides that are made.
    fn patch(&self, corners: Corners, label: u32) -> FittedPatch {
        let [a, b, c, d] = corners;
        let [low, right, high, left] =
            [self.side(a, b), self.side(b, c), self.side(d, c), self.side(a, d)];
        let n = self.basis.degree;
        let line = |net: &[Vec3]| self.basis.at_places(net);
        let [l, r, h, e] = [line(&low), line(&right), line(&high), line(&left)];
        let reach = [a, b, c, d]
            .map(|v| self.net.positions[v as usize].distance(self.net.positions[c as usize]))
            .into_iter()
            .fold(0.0, f64::max);
        let mut through = vec![vec![Vec3::zero(); n + 1]; n + 1];
        for (i, &u) in self.basis.at.iter().enumerate() {
            for (j, &v) in self.basis.at.iter().enumerate() {
                through[i][j] = if i == 0 {
                    e[j]
                } else if i == n {
                    r[j]
                } else if j == 0 {
                    l[i]
                } else if j == n {
                    h[i]
                } else {
                    let bilinear = l[0] * ((1.0 - u) * (1.0 - v))
                        + l[n] * (u * (1.0 - v))
                        + h[0] * ((1.0 - u) * v)
                        + h[n] * (u * v);
                    let guess =
                        l[i] * (1.0 - v) + h[i] * v + e[j] * (1.0 - u) + r[j] * u - bilinear;
                    match self.foot(&[label], guess, reach) {
                        Some(p) => p,
                        // Recognised by its distance.
                        None => guess,
                    }
                };
            }
        }
        let net = self.basis.patch(&through, [&left, &right, &low, &high]);
        let error = self.basis.distance(&net, label, &*self.field, self.accuracy);
        if error > self.accuracy {
            return FittedPatch { net, error, folded: false };
        }
        let [p, q, s, t] = corners.map(|v| self.net.positions[v as usize]);
        let out = (s - p).cross(t - q);
        let (_, slope) = (self.field)(label, self.basis.middle(&net));
        let sign = if out.dot(slope) < 0.0 { -1.0 } else { 1.0 };
        let folded = self.basis.folds(&net, label, sign, &*self.field);
        FittedPatch { net, error, folded }
    }

    /// Patches that are near enough, with sides halved until they are. With patience more rounds are tried, and
    /// triangles corrected in some of them only, as halving and correcting may undo each other.
    fn fit(&mut self, patient: bool) -> Result<Vec<(Corners, u32, FittedPatch)>, FacetFault> {
        let mut known: FxHashMap<Corners, FittedPatch> = FxHashMap::default();
        let mut apart: FxHashSet<Corners> = FxHashSet::default();
        let mut last = None;
        let mut fewest = usize::MAX;
        let (mut corrected, mut corrections) = (false, 0);
        let mut near_sides: FxHashMap<(u32, u32), f64> = FxHashMap::default();
        for round in 0..ROUNDS[usize::from(patient)] {
            let all = self.pairs(&apart);
            let mut halved: Vec<(f64, (u32, u32))> = Vec::new();
            let mut before = apart.len();
            let new: Vec<(Corners, u32)> = all
                .iter()
                .filter(|(corners, _)| !known.contains_key(corners))
                .map(|(corners, k)| (*corners, self.net.labels[*k as usize]))
                .collect();
            for ((corners, _), patch) in new.iter().zip(self.make_patches(&new)) {
                let patch = patch.unwrap_or_else(|fault| {
                    last = Some(fault);
                    FittedPatch { net: Vec::new(), error: f64::INFINITY, folded: false }
                });
                known.insert(*corners, patch);
            }
            for (corners, triangle) in &all {
                let label = self.net.labels[*triangle as usize];
                let patch = &known[corners];
                let near = patch.error <= self.accuracy;
                let quadrilateral = corners[0] != corners[1];
                if near && patch.folded && quadrilateral {
                    apart.insert(*corners);
                } else if !near || patch.folded {
                    let side = self.longest(*corners);
                    let [p, q] = [side.0, side.1].map(|v| self.net.positions[v as usize]);
                    let long = p.distance(q);
                    if long < 1e-7 * self.size {
                        return Err(self.fault(FacetFaultKind::Patch, &[label], p));
                    }
                    if last.is_none() {
                        last = Some(self.fault(FacetFaultKind::Patch, &[label], p));
                    }
                    halved.push((long, side));
                }
            }
            let strayed = self.strayed_sides(&mut near_sides)?;
            if let (None, Some((_, (a, b)))) = (&last, strayed.first()) {
                let place = self.net.positions[*a as usize];
                last = Some(self.fault(FacetFaultKind::Edge, &self.both(*a, *b), place));
            }
            halved.extend(strayed);
            if round == 0 && self.expected(&all, &known) > MUCH * MOST as f64 {
                return Err(self.too_many());
            }
            if halved.is_empty() && before == apart.len() {
                self.stray = near_sides.values().fold(0.0, |m, off| m.max(*off));
                return Ok(all
                    .into_iter()
                    .map(|(corners, k)| (corners, k, known[&corners].clone()))
                    .collect());
            }
            // Along a kink there are twice as many after each halving.
            fewest = fewest.min(halved.len());
            if round >= SMOOTH_AFTER && halved.len() > MANY.max(4 * fewest) {
                break;
            }
            // After some rounds the remaining faults may be inverted triangles.
            let bad = |(corners, _): &&(Corners, u32)| {
                let patch = &known[corners];
                patch.error > self.accuracy || patch.folded
            };
            let turn = !patient || !corrected && corrections < CORRECTIONS;
            corrected = turn && round >= SMOOTH_AFTER;
            corrections += usize::from(corrected);
            let round_bad: Option<FxHashSet<u32>> =
                patient.then(|| all.iter().filter(bad).flat_map(|(corners, _)| *corners).collect());
            if corrected && let Some(moved) = self.untangle(round_bad.as_ref()) {
                self.sides.retain(|(a, b), _| !moved.contains(a) && !moved.contains(b));
                // Sides may have been replaced, too.
                near_sides.clear();
                known.retain(|corners, _| corners.iter().all(|v| !moved.contains(v)));
                apart.retain(|corners| corners.iter().all(|v| !moved.contains(v)));
                last = None;
                continue;
            }
            before = self.net.triangles.len();
            self.halve(halved)?;
            if self.curved() > MOST {
                break;
            }
            if self.net.triangles.len() > before {
                last = None;
            }
        }
        let place = self.net.positions.first().copied().unwrap_or_default();
        Err(last.unwrap_or_else(|| self.fault(FacetFaultKind::Patch, &[], place)))
    }

    /// Expected number of triangles until all patches are accurate, by the order of their errors.
    fn expected(&self, all: &[(Corners, u32)], known: &FxHashMap<Corners, FittedPatch>) -> f64 {
        let order = 2.0 / (self.basis.degree + 1) as f64;
        let of = |(corners, _): &(Corners, u32)| {
            let times = known[corners].error / self.accuracy;
            if times > 1.0 && times.is_finite() { libm::pow(times, order) } else { 1.0 }
        };
        2.0 * all.iter().map(of).sum::<f64>()
    }

    fn too_many(&self) -> FacetFault {
        let place = self.net.positions.first().copied().unwrap_or_default();
        self.fault(FacetFaultKind::Many, &[], place)
    }

    fn longest(&self, [a, b, c, d]: Corners) -> (u32, u32) {
        let at = |v: u32| self.net.positions[v as usize];
        let long = |s: &(u32, u32)| at(s.0).distance(at(s.1));
        let sides = [(a, b), (b, c), (c, d), (d, a)];
        let side = sides.into_iter().max_by(|s, t| long(s).total_cmp(&long(t))).unwrap_or((a, c));
        ordered(side.0, side.1)
    }

    /// Puts a vertex on the sides, the longest first, on at most one of each triangle.
    fn halve(&mut self, mut sides: Vec<(f64, (u32, u32))>) -> Result<(), FacetFault> {
        sides.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        sides.dedup();
        let mut touched: FxHashSet<u32> = FxHashSet::default();
        let mut fault = None;
        for (long, (a, b)) in sides {
            let Some((&k, &l)) = self.net.across.get(&(a, b)).zip(self.net.across.get(&(b, a)))
            else {
                continue;
            };
            if touched.contains(&k) || touched.contains(&l) {
                continue;
            }
            let labels = self.both(a, b);
            let [p, q] = [a, b].map(|v| self.net.positions[v as usize]);
            let start = match self.sides.get(&ordered(a, b)) {
                Some(net) => self.basis.on_curve(net, 0.5),
                None => (p + q) * 0.5,
            };
            let Some(place) = self.foot(&labels, start, long) else {
                fault = Some(self.fault(FacetFaultKind::Edge, &labels, start));
                continue;
            };
            let count = self.net.triangles.len() as u32;
            self.net.split(a, b, place);
            touched.extend([k, l, count, count + 1]);
            self.sides.remove(&ordered(a, b));
        }
        match fault {
            Some(fault) if touched.is_empty() => Err(fault),
            _ => Ok(()),
        }
    }

    fn into_brep(
        mut self,
        brep: &mut Brep,
        patches: Vec<(Corners, u32, FittedPatch)>,
    ) -> Result<Vec<Vec3>, FacetFault> {
        let middles = patches.iter().map(|(.., patch)| self.basis.middle(&patch.net));
        let mut places: Vec<Vec3> = middles.collect();
        places.extend(self.round_places());
        // Faces: whole ones, by connected triangles, and each patch.
        let mut group = self.net.connected();
        let plane_groups = group.iter().max().map_or(0, |g| g + 1);
        for (number, (corners, triangle, _)) in patches.iter().enumerate() {
            let own = plane_groups + number as u32;
            group[*triangle as usize] = own;
            if corners[0] != corners[1] {
                let [a, _, b, _] = *corners;
                group[self.net.across[&(a, b)] as usize] = own;
                group[self.net.across[&(b, a)] as usize] = own;
            }
        }
        self.net.groups = group;
        let chains = self.chains();
        let mut vertices: BTreeMap<u32, usize> = BTreeMap::new();
        let mut first: FxHashMap<(u32, u32), (usize, bool)> = FxHashMap::default();
        let mut border: FxHashSet<(u32, u32)> = FxHashSet::default();
        let mut edges = Vec::with_capacity(chains.len());
        for (k, chain) in chains.iter().enumerate() {
            let n = chain.len();
            border.extend(chain.windows(2).flat_map(|w| [(w[0], w[1]), (w[1], w[0])]));
            first.insert((chain[0], chain[1]), (k, true));
            first.insert((chain[n - 1], chain[n - 2]), (k, false));
            let ends = [chain[0], chain[n - 1]].map(|v| {
                *vertices.entry(v).or_insert_with(|| {
                    brep.vertices.push(self.net.positions[v as usize]);
                    brep.vertices.len() - 1
                })
            });
            let [p, q] = ends.map(|v| brep.vertices[v]);
            let (curve, ellipse) = if self.straight(chain[0], chain[1]) {
                (BrepEdge::segment(p, q), None)
            } else if let Some(exact) = self.exact_side(chain[0], chain[1]) {
                let made = self.exact_edge(exact, chain, [p, q]);
                made.ok_or_else(|| {
                    self.fault(FacetFaultKind::Edge, &self.both(chain[0], chain[1]), p)
                })?
            } else {
                self.make_side(chain[0], chain[1])?;
                (self.basis.nurbs(self.side(chain[0], chain[1]), 0.0), None)
            };
            edges.push(brep.edges.len());
            brep.edges.push(BrepEdge { ends, curve, ellipse });
        }
        // No side of a sheet is the outer one.
        let whole = self.shown.iter().all(|s| *s);
        let cavities = self.net.cavities().into_iter().map(|c| c && whole).collect::<Vec<_>>();
        let mut by_group: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        for (k, g) in self.net.groups.iter().enumerate() {
            by_group.entry(*g).or_default().push(k);
        }
        let mut gap = self.stray.max(1e-14 * self.size);
        for (own, members) in by_group {
            if !self.is_shown(members[0]) {
                continue;
            }
            let label = self.net.labels[members[0]] as usize;
            let extent = extent(members.iter().flat_map(|&k| self.net.corners(k)));
            let patch = own.checked_sub(plane_groups).map(|k| &patches[k as usize]);
            let (surface, loops, error) = match patch {
                Some((corners, _, patch)) => {
                    let surface = self.basis.nurbs(patch.net.clone(), patch.error);
                    let cycle = self.round(*corners, &first, &edges);
                    (SurfaceShape::Nurbs(Box::new(surface)), vec![cycle], patch.error)
                }
                None => {
                    let mut loops = self.net.loops(&members, &border, &first, &edges);
                    loops.sort_by(|a, b| long(brep, b).total_cmp(&long(brep, a)));
                    if self.is_round(label as u32) {
                        let extent = (extent, cavities[members[0]]);
                        brep.faces.push(self.round_face(&members, loops, extent)?);
                        continue;
                    }
                    let area = |&k: &usize| {
                        let [a, b, c] = self.net.corners(k);
                        (b - a).cross(c - a)
                    };
                    let out = members.iter().map(area).fold(Vec3::zero(), |s, a| s + a);
                    let Some(SurfaceShape::Plane { origin, normal, axis }) = self.plane(members[0])
                    else {
                        return Err(self.fault(FacetFaultKind::NotClosed, &[], extent[0].into()));
                    };
                    let normal = if normal.dot(out) < 0.0 { -*normal } else { *normal };
                    for side in loops.iter().flatten() {
                        for p in &brep.edges[side.edge].curve.points {
                            gap = gap.max((*p - *origin).dot(normal).abs());
                        }
                    }
                    (SurfaceShape::Plane { origin: *origin, normal, axis: *axis }, loops, 0.0)
                }
            };
            brep.faces.push(BrepFace {
                name: self.facets.names[label].clone(),
                colour: self.facets.colours[label],
                layers: self.facets.layers[label].clone(),
                surface,
                reversed: false,
                loops,
                error,
                exact: patch.is_none(),
                extent: Some((extent, cavities[members[0]])),
            });
        }
        brep.gap = brep.gap.max(gap);
        Ok(places)
    }

    /// The sides between faces; those between two planes in one, from corner to corner.
    fn chains(&self) -> Vec<Vec<u32>> {
        let mut next: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for (&(a, b), &k) in &self.net.across {
            let other = self.net.across[&(b, a)];
            if self.net.groups[k as usize] != self.net.groups[other as usize] {
                next.entry(a).or_default().push(b);
            }
        }
        next.values_mut().for_each(|n| n.sort_unstable());
        // A line or an ellipse continues between the same two faces.
        let exact = |a: u32, b: u32| {
            let sides = [(a, b), (b, a)].map(|s| self.net.groups[self.net.across[&s] as usize]);
            self.exact_side(a, b).map(|curve| (ordered(sides[0], sides[1]), curve))
        };
        let through = |v: u32| {
            let around = &next[&v];
            let &[a, b] = &around[..] else { return false };
            let both_straight = self.straight(v, a) && self.straight(v, b);
            both_straight || exact(v, a).is_some_and(|known| exact(v, b) == Some(known))
        };
        let mut chains = Vec::new();
        let mut seen: FxHashSet<(u32, u32)> = FxHashSet::default();
        // Rings without corners begin anywhere.
        let mut starts: Vec<u32> = next.keys().copied().filter(|v| !through(*v)).collect();
        starts.extend(next.keys().filter(|v| through(**v)));
        for start in starts {
            let corner = !through(start);
            for &to in &next[&start] {
                // Sides between others say where chains end, too.
                let beside = [(start, to), (to, start)].map(|s| self.net.across[&s] as usize);
                if !beside.into_iter().any(|k| self.is_shown(k))
                    || seen.contains(&ordered(start, to))
                {
                    continue;
                }
                if !corner && exact(start, to).is_none() {
                    continue;
                }
                seen.insert(ordered(start, to));
                let mut chain = vec![start, to];
                while let Some(&here) = chain.last()
                    && here != start
                    && through(here)
                {
                    let before = chain[chain.len() - 2];
                    let Some(&on) = next[&here].iter().find(|w| **w != before) else { break };
                    seen.insert(ordered(here, on));
                    chain.push(on);
                }
                chains.push(chain);
            }
        }
        chains
    }

    /// The loop of a patch, with its straight curves in parameters.
    fn round(
        &self,
        [a, b, c, d]: Corners,
        first: &FxHashMap<(u32, u32), (usize, bool)>,
        edges: &[usize],
    ) -> Vec<Coedge> {
        let uv = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[u, v]| Vec3::of(u, v, 0.0));
        let corners = [a, b, c, d];
        let mut cycle = Vec::new();
        for k in 0..4 {
            let next = (k + 1) % 4;
            let Some(&(chain, forward)) = first.get(&(corners[k], corners[next])) else { continue };
            let [from, to] = if forward { [uv[k], uv[next]] } else { [uv[next], uv[k]] };
            let trace = Nurbs {
                degrees: [1],
                knots: [vec![0.0, 0.0, 1.0, 1.0]],
                points: vec![from, to],
                weights: None,
                error: 0.0,
                exact: true,
                paces: [Pace::Even],
            };
            cycle.push(Coedge { edge: edges[chain], forward, trace: Some(trace), alike: true });
        }
        cycle
    }
}

/// The size of a loop.
fn long(brep: &Brep, cycle: &[Coedge]) -> f64 {
    let points = cycle.iter().flat_map(|side| &brep.edges[side.edge].curve.points);
    let [low, high] = extent(points.copied());
    Vec3::from(high).distance(low.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plane_sheet_ends_at_the_planes_beside_it() {
        // A block whose top face is needed; each side of a face consists of the edges of two
        // triangles.
        let corner = |k: u32| Vec3::from([0, 1, 2].map(|axis| f64::from(k >> axis & 1)));
        let quads =
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let mut facets = LabelledFacets {
            positions: (0..8).map(corner).collect(),
            triangles: Vec::new(),
            labels: Vec::new(),
            surfaces: Vec::new(),
            names: (0..6).map(|k| format!("face {k}")).collect(),
            colours: vec![None; 6],
            layers: vec![Vec::new(); 6],
            step: 0.5,
            certain: true,
        };
        for (k, q) in quads.into_iter().enumerate() {
            facets.triangles.extend([[q[0], q[1], q[2]], [q[0], q[2], q[3]]]);
            facets.labels.extend([k as u32; 2]);
            let [a, b, c] = [q[0], q[1], q[2]].map(corner);
            let normal = (b - a).cross(c - a);
            facets.surfaces.push(Some(SurfaceShape::Plane { origin: a, normal, axis: b - a }));
        }
        let planes: Vec<(Vec3, Vec3)> = quads
            .iter()
            .map(|q| {
                let [a, b, c] = [q[0], q[1], q[2]].map(corner);
                (a, (b - a).cross(c - a))
            })
            .collect();
        let field = move |k: u32, p: Vec3| {
            let (origin, normal) = planes[k as usize];
            ((p - origin).dot(normal), normal)
        };
        let shown = (0..6).map(|k| k == 1).collect();
        let mut brep = Brep::default();
        brep.add_sheet(facets, shown, &field, 1e-6, 2.0).unwrap();
        assert_eq!((brep.faces.len(), brep.edges.len(), brep.vertices.len()), (1, 4, 4));
        assert_eq!(brep.faces[0].loops.iter().map(Vec::len).collect::<Vec<_>>(), [4]);
    }

    /// A disc of radius 1 as a coarse prism, of whose faces the top one is wanted.
    fn disc() -> (LabelledFacets, Vec<bool>) {
        const SIDES: u32 = 7;
        let ring = |z: f64| {
            (0..SIDES).map(move |k| {
                let (sin, cos) =
                    libm::sincos(f64::from(k) * std::f64::consts::TAU / f64::from(SIDES));
                Vec3::of(cos, sin, z)
            })
        };
        let mut positions: Vec<Vec3> = ring(0.0).chain(ring(1.0)).collect();
        let [low, top] = [2 * SIDES, 2 * SIDES + 1];
        positions.extend([Vec3::zero(), Vec3::of(0.0, 0.0, 1.0)]);
        let (mut triangles, mut labels) = (Vec::new(), Vec::new());
        for a in 0..SIDES {
            let b = (a + 1) % SIDES;
            let [c, d] = [a + SIDES, b + SIDES];
            triangles.extend([[low, b, a], [top, c, d], [a, b, d], [a, d, c]]);
            labels.extend([0, 1, 2, 2]);
        }
        let up = Vec3::of(0.0, 0.0, 1.0);
        let plane = |origin| {
            Some(SurfaceShape::Plane { origin, normal: up, axis: Vec3::of(1.0, 0.0, 0.0) })
        };
        let axes = crate::SurfaceAxes::about(Vec3::zero(), up);
        let surfaces = vec![
            plane(Vec3::zero()),
            plane(up),
            Some(SurfaceShape::Cylinder { axes, radius: 1.0 }),
        ];
        let facets = LabelledFacets {
            positions,
            triangles,
            labels,
            surfaces,
            names: ["base", "top", "side"].map(str::to_owned).to_vec(),
            colours: vec![None; 3],
            layers: vec![Vec::new(); 3],
            step: 1.0,
            certain: false,
        };
        (facets, vec![false, true, false])
    }

    fn off_circle(brep: &Brep) -> f64 {
        let ts: Vec<f64> = (0..=50).map(|k| f64::from(k) / 50.0).collect();
        let places = brep.edges.iter().flat_map(|edge| edge.curve.grid(std::array::from_ref(&ts)));
        let off = |p: Vec3| (libm::hypot(p.x, p.y) - 1.0).abs().max((p.z - 1.0).abs());
        places.map(off).fold(0.0, f64::max)
    }

    #[test]
    fn a_plane_sheet_ends_at_a_round_surface_within_the_accuracy() {
        let (facets, shown) = disc();
        let field = |k: u32, p: Vec3| match k {
            0 => (p.z, Vec3::of(0.0, 0.0, 1.0)),
            1 => (p.z - 1.0, Vec3::of(0.0, 0.0, 1.0)),
            _ => (p.x * p.x + p.y * p.y - 1.0, Vec3::of(2.0 * p.x, 2.0 * p.y, 0.0)),
        };
        let mut brep = Brep::default();
        brep.add_sheet(facets, shown, &field, 1e-6, 2.0).unwrap();
        assert_eq!(brep.faces.len(), 1);
        assert!(off_circle(&brep) <= 1e-6, "{}", off_circle(&brep));
    }

    #[test]
    fn a_plane_sheet_ends_on_the_circle_in_which_it_meets_a_cylinder() {
        let (facets, shown) = disc();
        let mut brep = Brep::default();
        let places = brep.add_facets_on(facets, shown, 1e-6, 2.0).unwrap();
        assert!(places.iter().all(|p| (p.z - 1.0).abs() < 1e-12));
        assert_eq!((brep.faces.len(), brep.edges.len()), (1, 1));
        assert!(brep.edges[0].ellipse.is_some() && off_circle(&brep) < 1e-12);
        assert!(brep.faces[0].exact && brep.faces[0].loops[0].len() == 1);
    }
}
