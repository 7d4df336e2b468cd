//! Labelled triangles into faces: each face on the surface of its label, its edges where that surface meets the next.
//!
//! `triangles with surfaces -> connected faces -> seams -> chains of sides -> edges -> loops`
//!
//! The triangles determine connectivity and which part of a curve is an edge; their coordinates are
//! not in the result.

use crate::analytic::arc;
use crate::contacts::parted;
use crate::crossing::crossing;
use crate::extruded::cubic_span;
use crate::seams::{FacetNet, ordered};
use crate::{Brep, BrepEdge, BrepFace, Coedge, ExactCurve, SurfaceAxes, SurfaceShape, meet};
use moldloft_num::Vec3;
use moldloft_spline::nurbs::Nurbs;
use rustc_hash::{FxHashMap, FxHashSet};
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// Relative distance within which a point is on a surface.
const NEAR: f64 = 1e-9;

/// Typical length along a border, relative to its sides: curves may be in finer pieces than surfaces.
const SIDES_OF_A_STEP: f64 = 3.0;

/// Maximum displacement of a corner, in cells, at small angles between faces.
const REACH: f64 = 4.0;

/// Vertices that are farther from a surface, in cells, are not on it.
const STRAYED: f64 = 0.02;

/// Surfaces touch, as far as triangles go, where the sine of the angle of their normals is less.
const TOUCHING: f64 = 0.5;

/// Triangles of a closed body, and the surface that each is on.
#[derive(Clone, Debug)]
pub struct LabelledFacets {
    /// Positions.
    pub positions: Vec<Vec3>,
    /// Triangles, counter-clockwise from outside.
    pub triangles: Vec<[u32; 3]>,
    /// The surface of each triangle.
    pub labels: Vec<u32>,
    /// The surfaces, if formats have their type.
    pub surfaces: Vec<Option<SurfaceShape>>,
    /// Their names.
    pub names: Vec<String>,
    /// Their colours.
    pub colours: Vec<Option<[u8; 3]>>,
    /// Their layers.
    pub layers: Vec<Vec<String>>,
    /// Typical length of a triangle side. Deviations of triangles from an edge must be smaller for the edge to be found.
    pub step: f64,
    /// True if every triangle is on the surface that it is labelled with; else few may be on the next one.
    pub certain: bool,
}

/// Reason why triangles do not represent a body of faces.
#[derive(Clone, Debug, PartialEq)]
pub struct FacetFault {
    /// Kind of fault.
    pub kind: FacetFaultKind,
    /// The names of the surfaces concerned.
    pub surfaces: Vec<String>,
    /// Position.
    pub place: Vec3,
}

/// Fault of triangles that do not represent a body of faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FacetFaultKind {
    /// The triangles do not close, or more than two share a side.
    NotClosed,
    /// No seam around the face avoids the vertices.
    Seam,
    /// No common curve of the surfaces is found within the accuracy near the triangles.
    Edge,
    /// The surfaces round a vertex have no common point near it.
    Vertex,
    /// A surface of a type that formats do not have.
    Surface,
    /// No patches come within the accuracy of the surface, or they fold.
    Patch,
    /// Too many patches are needed for the accuracy.
    Many,
}

/// Sides of triangles between the same two faces, from corner to corner.
struct BorderChain {
    vertices: Vec<u32>,
    surfaces: [u32; 2],
    exact: Option<ExactCurve>,
}

impl BorderChain {
    fn closed(&self) -> bool {
        self.vertices.first() == self.vertices.last()
    }
}

impl Brep {
    /// Adds the faces of a body; returns a point on its face for each triangle.
    ///
    /// # Errors
    /// Triangles that do not show its faces; finer ones may.
    pub fn add_facets(
        &mut self,
        facets: LabelledFacets,
        accuracy: f64,
        size: f64,
    ) -> Result<Vec<Vec3>, FacetFault> {
        let shown = vec![true; facets.surfaces.len()];
        self.add_facets_on(facets, shown, accuracy, size)
    }

    /// Adds the faces of a body that are on the surfaces marked by `shown`; returns a point on its
    /// face for each of their triangles. The other surfaces only bound these faces.
    ///
    /// # Errors
    /// As [`Self::add_facets`].
    pub fn add_facets_on(
        &mut self,
        facets: LabelledFacets,
        shown: Vec<bool>,
        accuracy: f64,
        size: f64,
    ) -> Result<Vec<Vec3>, FacetFault> {
        let mut work = LabelledBody::new(facets, shown, accuracy, size)?;
        if !work.certain {
            work.join_islands();
        }
        work.pin()?;
        let places = work.places();
        work.cut()?;
        work.find_chains();
        work.choose_curves();
        work.place_corners()?;
        work.into_brep(self)?;
        Ok(places)
    }
}

struct LabelledBody {
    net: FacetNet,
    /// For each surface, whether its faces are wanted.
    shown: Vec<bool>,
    /// The surfaces, and behind them the planes of seams.
    surfaces: Vec<SurfaceShape>,
    names: Vec<String>,
    colours: Vec<Option<[u8; 3]>>,
    layers: Vec<Vec<String>>,
    axes: BTreeMap<u32, SurfaceAxes>,
    chains: Vec<BorderChain>,
    corners: BTreeMap<u32, Vec3>,
    /// Distance of the points found.
    gap: f64,
    accuracy: f64,
    size: f64,
    step: f64,
    certain: bool,
}

impl LabelledBody {
    fn new(
        facets: LabelledFacets,
        shown: Vec<bool>,
        accuracy: f64,
        size: f64,
    ) -> Result<Self, FacetFault> {
        let LabelledFacets { positions, triangles, mut labels, surfaces, names, .. } = facets;
        let place = positions.first().copied().unwrap_or_default();
        let Some(surfaces) = surfaces.into_iter().collect::<Option<Vec<SurfaceShape>>>() else {
            let kind = FacetFaultKind::Surface;
            return Err(FacetFault { kind, surfaces: Vec::new(), place });
        };
        let near = NEAR * size;
        let first: Vec<u32> = (0..surfaces.len())
            .map(|k| {
                let same = |&j: &usize| {
                    shown[j] == shown[k] && surfaces[j].is_same(&surfaces[k], near, size)
                };
                (0..k).find(same).unwrap_or(k) as u32
            })
            .collect();
        labels.iter_mut().for_each(|l| *l = first[*l as usize]);
        let open =
            |place| FacetFault { kind: FacetFaultKind::NotClosed, surfaces: Vec::new(), place };
        // Where a body touches itself, its parts have edges of their own.
        let apart = facets.certain.then(|| parted(&positions, &triangles)).flatten();
        let (positions, triangles) = apart.unwrap_or((positions, triangles));
        let net = FacetNet::new(positions, triangles, labels).map_err(open)?;
        Ok(Self {
            net,
            shown,
            surfaces,
            names,
            colours: facets.colours,
            layers: facets.layers,
            axes: BTreeMap::new(),
            chains: Vec::new(),
            corners: BTreeMap::new(),
            gap: 0.0,
            accuracy,
            size,
            step: facets.step,
            certain: facets.certain,
        })
    }

    fn fault(&self, kind: FacetFaultKind, surfaces: &[u32], place: Vec3) -> FacetFault {
        let mut names: Vec<String> = Vec::new();
        for &s in surfaces {
            if let Some(name) = self.names.get(s as usize)
                && !names.contains(name)
            {
                names.push(name.clone());
            }
        }
        FacetFault { kind, surfaces: names, place }
    }

    /// True if a face beside a side of triangles is wanted.
    fn is_shown_beside(&self, a: u32, b: u32) -> bool {
        [(a, b), (b, a)].iter().any(|side| {
            let label = self.net.labels[self.net.across[side] as usize];
            self.shown[label as usize]
        })
    }

    /// The typical length of sides round some borders: a small hole in a large disc has short ones.
    fn step_along(&self, sides: impl Iterator<Item = (u32, u32)>) -> f64 {
        if !self.certain {
            return self.step;
        }
        let place = |v: u32| self.net.positions[v as usize];
        let longest = sides.map(|(a, b)| place(a).distance(place(b))).fold(0.0, f64::max);
        (SIDES_OF_A_STEP * longest).min(self.step)
    }

    fn chain_step(&self, chain: &BorderChain) -> f64 {
        self.step_along(chain.vertices.windows(2).map(|w| (w[0], w[1])))
    }

    /// Distance from a contact of surfaces within which they are less than a cell apart.
    fn cusp(&self) -> f64 {
        (self.step * self.size).sqrt()
    }

    /// The middles of the triangles, moved onto their surfaces. Omitted are those beside a border
    /// along which surfaces touch, because they may be on either surface, and those beside the
    /// border of an image: the move onto an image is not the shortest and may cross the border.
    fn places(&self) -> Vec<Vec3> {
        let mut touching: FxHashSet<u32> = FxHashSet::default();
        let mut border: FxHashSet<u32> = FxHashSet::default();
        for ((a, b), surfaces) in self.borders() {
            border.extend([a, b]);
            let [m, n] = surfaces.map(|s| &self.surfaces[s as usize]);
            let sine = |v: u32| {
                let p = self.net.positions[v as usize];
                m.normal(p).cross(n.normal(p)).norm()
            };
            touching.extend([a, b].into_iter().filter(|&v| sine(v) < TOUCHING));
        }
        let middle = |k: usize| {
            let [a, b, c] = self.net.corners(k);
            let p = (a + b + c) / 3.0;
            self.surfaces[self.net.labels[k] as usize].onto(p)
        };
        let clear = |k: &usize| {
            let corners = &self.net.triangles[*k];
            let image =
                matches!(self.surfaces[self.net.labels[*k] as usize], SurfaceShape::Image(_));
            self.shown[self.net.labels[*k] as usize]
                && corners.iter().all(|v| !touching.contains(v))
                && !(image && corners.iter().any(|v| border.contains(v)))
        };
        (0..self.net.triangles.len()).filter(clear).map(middle).collect()
    }

    /// Gives faces that are smaller than cells and in the surface of the next one to that: where surfaces touch, few
    /// triangles are on the wrong one of both.
    fn join_islands(&mut self) {
        const PASSES: usize = 3;
        for _ in 0..PASSES {
            let mut members: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
            for (k, g) in self.net.groups.iter().enumerate() {
                members.entry(*g).or_default().push(k);
            }
            let mut joined = false;
            for (group, own) in &members {
                let places: Vec<Vec3> = own.iter().flat_map(|&k| self.net.corners(k)).collect();
                let [low, high] = extent(places.iter().copied());
                if Vec3::from(high).distance(low.into()) > 3.0 * self.step {
                    continue;
                }
                let mut others: Vec<u32> = Vec::new();
                for &k in own {
                    for i in 0..3 {
                        let other = self.net.beyond(k, i);
                        if self.net.groups[other] != *group {
                            others.push(self.net.labels[other]);
                        }
                    }
                }
                others.sort_unstable();
                others.dedup();
                let off = |label: &u32| {
                    let surface = &self.surfaces[*label as usize];
                    let far = |p: &Vec3| surface.distance(*p).unwrap_or(f64::INFINITY).abs();
                    places.iter().map(far).fold(0.0, f64::max)
                };
                let best = others.iter().map(|l| (off(l), *l)).min_by(|a, b| a.0.total_cmp(&b.0));
                if let Some((off, label)) = best
                    && off <= 1e-2 * self.step
                {
                    own.iter().for_each(|&k| self.net.labels[k] = label);
                    joined = true;
                }
            }
            if !joined {
                return;
            }
            self.net.groups = self.net.connected();
        }
    }

    /// Makes one vertex of those round the apex of a cone, or a point where two surfaces touch and their edges cross.
    fn pin(&mut self) -> Result<(), FacetFault> {
        let mut points: Vec<Vec3> = Vec::new();
        let mut reaches: Vec<f64> = Vec::new();
        let known =
            |points: &[Vec3], p: Vec3, reach: f64| points.iter().any(|q| q.distance(p) <= reach);
        let borders = self.borders();
        let mut shown: Vec<u32> = self.net.labels.clone();
        shown.sort_unstable();
        shown.dedup();
        for label in shown {
            let Some(apex) = self.surfaces[label as usize].apex() else { continue };
            let own = borders.iter().filter(|(_, both)| both.contains(&label));
            let reach = self.step_along(own.map(|(side, _)| *side));
            if self.net.positions.iter().any(|p| p.distance(apex) <= 0.5 * reach)
                && !known(&points, apex, reach)
            {
                points.push(apex);
                reaches.push(reach);
            }
        }
        self.find_chains();
        for chain in std::mem::take(&mut self.chains) {
            let beside =
                borders.iter().filter(|(_, own)| own.iter().any(|l| chain.surfaces.contains(l)));
            let reach = self.step_along(beside.map(|(side, _)| *side));
            let both = chain.surfaces.map(|s| &self.surfaces[s as usize]);
            let sine = |v: &u32| {
                let p = self.net.positions[*v as usize];
                both[0].normal(p).cross(both[1].normal(p)).norm()
            };
            let sines: Vec<f64> = chain.vertices.iter().map(sine).collect();
            // Along all of it they touch in a curve.
            if sines.iter().fold(0.0, |m: f64, s| m.max(*s)) < 0.1 {
                continue;
            }
            for (k, &v) in chain.vertices.iter().enumerate() {
                let low = k.saturating_sub(1);
                let high = (k + 1).min(sines.len() - 1);
                if sines[k] > 0.3 || sines[k] > sines[low] || sines[k] > sines[high] {
                    continue;
                }
                let start = self.net.positions[v as usize];
                if let Some(p) = crate::crossing::touch(both, start, NEAR * self.size)
                    && p.distance(start) <= 2.0 * reach
                    && !known(&points, p, reach)
                {
                    points.push(p);
                    reaches.push(reach);
                }
            }
        }
        self.corners.clear();
        for (p, reach) in points.into_iter().zip(reaches) {
            // The remaining triangles around it may fold; slightly different sizes avoid that.
            let net = [1.0, 0.7, 1.4, 0.5, 2.0]
                .into_iter()
                .find_map(|share| self.net.pinned(p, share * reach));
            self.net = net.ok_or_else(|| self.fault(FacetFaultKind::NotClosed, &[], p))?;
        }
        Ok(())
    }

    /// The sides between faces, each once: vertices in order and the surfaces of both faces, or of the face and its
    /// cut.
    fn borders(&self) -> BTreeMap<(u32, u32), [u32; 2]> {
        let mut borders = BTreeMap::new();
        for (k, t) in self.net.triangles.iter().enumerate() {
            for i in 0..3 {
                let (a, b) = (t[i], t[(i + 1) % 3]);
                if a > b {
                    continue;
                }
                let other = self.net.beyond(k, i);
                let seam = match self.net.seams.is_empty() {
                    true => None,
                    false => self.net.seams.get(&(a, b)),
                };
                if let Some(&seam) = seam {
                    borders.insert((a, b), [self.net.labels[k], seam]);
                } else if self.net.groups[k] != self.net.groups[other] {
                    borders.insert((a, b), [self.net.labels[k], self.net.labels[other]]);
                }
            }
        }
        borders
    }

    fn corners_of(borders: &BTreeMap<(u32, u32), [u32; 2]>) -> FxHashSet<u32> {
        let mut degree: FxHashMap<u32, usize> = FxHashMap::default();
        for (a, b) in borders.keys() {
            *degree.entry(*a).or_insert(0) += 1;
            *degree.entry(*b).or_insert(0) += 1;
        }
        degree.into_iter().filter(|(_, n)| *n != 2).map(|(v, _)| v).collect()
    }

    /// Cuts the faces that close around their axes.
    fn cut(&mut self) -> Result<(), FacetFault> {
        let borders = self.borders();
        let corners = Self::corners_of(&borders);
        let count = self.net.groups.iter().max().map_or(0, |g| g + 1);
        let mut beside: Vec<Vec<Vec3>> = vec![Vec::new(); count as usize];
        for (a, b) in borders.keys() {
            let sides = [(*a, *b), (*b, *a)].map(|s| self.net.across[&s] as usize);
            for [k, o] in [[0, 1], [1, 0]].map(|w| w.map(|i| sides[i])) {
                let z = match &self.surfaces[self.net.labels[o] as usize] {
                    SurfaceShape::Plane { normal, .. } => Some(*normal),
                    SurfaceShape::Sphere { axes, .. } => {
                        let own = self.surfaces[self.net.labels[k] as usize].axes();
                        own.and_then(|c| (axes.origin - c.origin).normalized())
                    }
                    SurfaceShape::Image(image) => {
                        image.of().axes().and_then(|a| image.linear(a.z).normalized())
                    }
                    other => other.axes().map(|a| a.z),
                };
                let known = &mut beside[self.net.groups[k] as usize];
                known.extend(z.filter(|z| known.iter().all(|u| u.dot(*z).abs() < 1.0 - 1e-9)));
            }
        }
        let mut sides: Vec<Vec<(u32, u32)>> = vec![Vec::new(); count as usize];
        for &(a, b) in borders.keys() {
            for side in [(a, b), (b, a)] {
                sides[self.net.groups[self.net.across[&side] as usize] as usize].push(side);
            }
        }
        let steps: Vec<f64> =
            sides.into_iter().map(|own| self.step_along(own.into_iter())).collect();
        for group in 0..count {
            let Some(k) = self.net.groups.iter().position(|g| *g == group) else { continue };
            let label = self.net.labels[k];
            let surface = self.surfaces[label as usize].clone();
            let is_image = matches!(surface, SurfaceShape::Image(_));
            if !self.shown[label as usize] || surface.axes().is_none() && !is_image {
                continue;
            }
            let place = self.net.corners(k)[0];
            let scale = (self.size, steps[group as usize]);
            let beside = &beside[group as usize];
            let made = match &surface {
                SurfaceShape::Image(image) => self.net.prepared_image(
                    group,
                    image,
                    beside,
                    &mut self.surfaces,
                    &corners,
                    scale,
                ),
                _ => {
                    self.net.prepared(group, &surface, beside, &mut self.surfaces, &corners, scale)
                }
            };
            match made {
                Some(axes) => self.axes.insert(group, axes),
                None => return Err(self.fault(FacetFaultKind::Seam, &[label], place)),
            };
        }
        // A cut may have made two faces of one.
        self.net.settle();
        let before = std::mem::take(&mut self.net.groups);
        self.net.groups = self.net.connected();
        let axes = std::mem::take(&mut self.axes);
        for (old, new) in before.iter().zip(&self.net.groups) {
            if let Some(a) = axes.get(old) {
                self.axes.insert(*new, *a);
            }
        }
        Ok(())
    }

    fn find_chains(&mut self) {
        let borders = self.borders();
        let mut corners = Self::corners_of(&borders);
        corners.extend(self.net.fixed.keys());
        let mut next: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for (a, b) in borders.keys() {
            next.entry(*a).or_default().push(*b);
            next.entry(*b).or_default().push(*a);
        }
        corners.retain(|v| next.contains_key(v));
        let mut used: FxHashSet<(u32, u32)> = FxHashSet::default();
        let mut starts: Vec<u32> = corners.iter().copied().collect();
        starts.sort_unstable();
        // Rings without corners begin anywhere.
        starts.extend(next.keys().filter(|v| !corners.contains(v)));
        for start in starts {
            for &first in &next[&start] {
                if used.contains(&ordered(start, first)) {
                    continue;
                }
                let mut vertices = vec![start, first];
                used.insert(ordered(start, first));
                let (mut before, mut here) = (start, first);
                while here != start && !corners.contains(&here) {
                    let Some(&to) = next[&here].iter().find(|&&v| v != before) else { break };
                    used.insert(ordered(here, to));
                    vertices.push(to);
                    (before, here) = (here, to);
                }
                if self.is_shown_beside(start, first) {
                    let surfaces = borders[&ordered(start, first)];
                    self.chains.push(BorderChain { vertices, surfaces, exact: None });
                }
            }
        }
        for chain in &self.chains {
            for v in [chain.vertices[0], chain.vertices[chain.vertices.len() - 1]] {
                self.corners.insert(v, self.net.positions[v as usize]);
            }
        }
    }

    /// Chooses lines, circles and ellipses for the chains that follow one.
    fn choose_curves(&mut self) {
        let near = NEAR * self.size;
        let cusp = self.cusp();
        let mut known: FxHashMap<[u32; 2], Vec<ExactCurve>> = FxHashMap::default();
        let steps: Vec<f64> = self.chains.iter().map(|chain| self.chain_step(chain)).collect();
        for (chain, step) in self.chains.iter_mut().zip(steps) {
            let [a, b] = chain.surfaces;
            let curves = known.entry([a, b]).or_insert_with(|| {
                meet(&self.surfaces[a as usize], &self.surfaces[b as usize], near, self.size)
            });
            // Vertices beyond corners, and those of cuts through cells that pass over a thin end, are on one surface at most.
            let strayed = |p: &Vec3| {
                [a, b].into_iter().any(|k| {
                    let off = self.surfaces[k as usize].distance(*p);
                    off.is_some_and(|d| d.abs() > STRAYED * step)
                })
            };
            let all = chain.vertices.iter().map(|&v| self.net.positions[v as usize]);
            let (off, on): (Vec<Vec3>, Vec<Vec3>) = all.partition(strayed);
            let places = if on.is_empty() { off } else { on };
            let far = |curve: &ExactCurve| {
                places.iter().map(|p| curve.near(*p).distance(*p)).fold(0.0, f64::max)
            };
            let best = curves.iter().map(|c| (far(c), *c)).min_by(|a, b| a.0.total_cmp(&b.0));
            let touching = chain.vertices.iter().all(|&v| {
                let p = self.net.positions[v as usize];
                let [m, n] = [a, b].map(|s| self.surfaces[s as usize].normal(p));
                m.cross(n).norm() < TOUCHING
            });
            // Triangles end far from where surfaces touch.
            let reach = if touching { cusp } else { step };
            chain.exact = best.filter(|(far, _)| *far <= reach).map(|(_, c)| c);
        }
    }

    /// Moves the ends of chains onto all surfaces and curves that meet there.
    fn place_corners(&mut self) -> Result<(), FacetFault> {
        let near = NEAR * self.size;
        let mut round: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        for (k, chain) in self.chains.iter().enumerate() {
            round.entry(chain.vertices[0]).or_default().push(k);
            if !chain.closed() {
                round.entry(chain.vertices[chain.vertices.len() - 1]).or_default().push(k);
            }
        }
        for (v, chains) in round {
            let start = self.net.positions[v as usize];
            if let Some(&fixed) = self.net.fixed.get(&v) {
                self.corners.insert(v, fixed);
                continue;
            }
            // A cut may have divided the sides beside it.
            let own = chains.iter().map(|&k| self.chain_step(&self.chains[k]));
            let step = own.fold(0.0, f64::max);
            let mut labels: Vec<u32> =
                chains.iter().flat_map(|&k| self.chains[k].surfaces).collect();
            labels.sort_unstable();
            labels.dedup();
            let mut shapes: Vec<SurfaceShape> =
                labels.iter().map(|&l| self.surfaces[l as usize].clone()).collect();
            let tip = shapes.iter().filter_map(SurfaceShape::apex).find(|apex| {
                let on = |s: &SurfaceShape| s.distance(*apex).is_some_and(|d| d.abs() <= near);
                apex.distance(start) <= 0.1 * step && shapes.iter().all(on)
            });
            if let Some(apex) = tip {
                self.corners.insert(v, apex);
                continue;
            }
            for &k in &chains {
                let chain = &self.chains[k];
                if let Some(curve) = &chain.exact {
                    let normal = self.surfaces[chain.surfaces[0] as usize].normal(start);
                    shapes.extend(curve.planes(normal));
                }
            }
            // Where surfaces touch, a point on all of them is not found by their normals.
            let on = |l: &u32| {
                self.surfaces[*l as usize].distance(start).is_some_and(|d| d.abs() <= near)
            };
            if self.certain && labels.iter().all(on) {
                self.corners.insert(v, start);
                continue;
            }
            let ring = [chains.len() == 1 && self.chains[chains[0]].closed()];
            let found = if ring[0] {
                // The beginning of a ring is any point of it.
                let chain = &self.chains[chains[0]];
                match &chain.exact {
                    Some(curve) => Some(curve.near(start)),
                    None => {
                        let both = chain.surfaces.map(|s| &self.surfaces[s as usize]);
                        crate::crossing::on_both(both, start)
                    }
                }
            } else {
                common_point(&shapes, start, near)
            };
            let touching = labels.iter().any(|&a| {
                let m = self.surfaces[a as usize].normal(start);
                labels
                    .iter()
                    .filter(|&&b| b > a)
                    .any(|&b| m.cross(self.surfaces[b as usize].normal(start)).norm() < TOUCHING)
            });
            let reach = if touching { self.cusp() } else { 0.0 }.max(REACH * step);
            let found = found.filter(|p| p.distance(start) <= reach);
            let Some(p) = found else {
                return Err(self.fault(FacetFaultKind::Vertex, &labels, start));
            };
            let off =
                shapes.iter().filter_map(|s| s.distance(p)).fold(0.0f64, |m, d| m.max(d.abs()));
            if off > self.accuracy {
                return Err(self.fault(FacetFaultKind::Vertex, &labels, start));
            }
            self.gap = self.gap.max(off);
            self.corners.insert(v, p);
        }
        Ok(())
    }

    /// The curve of a chain between the points of its ends.
    fn curve(&self, chain: &BorderChain) -> Option<(Nurbs<1>, Option<ExactCurve>)> {
        let n = chain.vertices.len();
        let [p, q] = [chain.vertices[0], chain.vertices[n - 1]].map(|v| self.corners[&v]);
        let inner = chain.vertices[1..n - 1].iter().map(|&v| self.net.positions[v as usize]);
        match chain.exact {
            Some(ExactCurve::Line { .. }) => Some((BrepEdge::segment(p, q), None)),
            Some(ExactCurve::Cubic(points)) => Some((cubic_span(&points, [p, q], inner)?, None)),
            Some(ellipse @ ExactCurve::Ellipse { .. }) => {
                let made = span(ellipse, [p, q], inner, chain.closed());
                made.map(|(curve, own)| (curve, Some(own)))
            }
            None => {
                let step = self.chain_step(chain);
                let both = chain.surfaces.map(|s| &self.surfaces[s as usize]);
                // Near a corner of small angles some vertices are beyond the corner and on one
                // surface only; the guide must not go there and back.
                let strayed = |r: &Vec3| {
                    let far =
                        |s: &SurfaceShape| s.distance(*r).is_some_and(|d| d.abs() > STRAYED * step);
                    both.into_iter().any(far)
                };
                let places: Vec<Vec3> = inner.collect();
                let first = places.iter().position(|r| !strayed(r)).unwrap_or(0);
                let last = places.iter().rposition(|r| !strayed(r)).map_or(places.len(), |k| k + 1);
                let mut guide = vec![p];
                let least = 0.3 * step;
                for &r in &places[first..last] {
                    if r.distance(guide[guide.len() - 1]) >= least && r.distance(q) >= least {
                        guide.push(r);
                    }
                }
                guide.push(q);
                Some((crossing(both, &guide, self.accuracy, REACH * step)?, None))
            }
        }
    }

    fn into_brep(self, brep: &mut Brep) -> Result<(), FacetFault> {
        // Corners at one point, joined by a chain without length, are one.
        let mut one: BTreeMap<u32, u32> = BTreeMap::new();
        fn root(one: &BTreeMap<u32, u32>, mut v: u32) -> u32 {
            while let Some(&w) = one.get(&v) {
                v = w;
            }
            v
        }
        let near = 10.0 * NEAR * self.size;
        let mut vanished = vec![false; self.chains.len()];
        for (k, chain) in self.chains.iter().enumerate() {
            let ends = [chain.vertices[0], chain.vertices[chain.vertices.len() - 1]];
            let [p, q] = ends.map(|v| self.corners[&v]);
            let places = chain.vertices.iter().map(|&v| self.net.positions[v as usize]);
            let long = places.map(|r| r.distance(p)).fold(0.0, f64::max);
            if !chain.closed() && p.distance(q) <= near && long <= 2.0 * self.chain_step(chain) {
                vanished[k] = true;
                let [a, b] = ends.map(|v| root(&one, v));
                if a != b {
                    one.insert(a.max(b), a.min(b));
                }
            }
        }
        let mut vertices: BTreeMap<u32, usize> = BTreeMap::new();
        let mut edges = vec![usize::MAX; self.chains.len()];
        let mut first: FxHashMap<(u32, u32), (usize, bool)> = FxHashMap::default();
        let mut border: FxHashSet<(u32, u32)> = FxHashSet::default();
        let mut gap = self.gap.max(1e-15 * self.size);
        for (k, chain) in self.chains.iter().enumerate() {
            let n = chain.vertices.len();
            border.extend(chain.vertices.windows(2).flat_map(|w| [(w[0], w[1]), (w[1], w[0])]));
            first.insert((chain.vertices[0], chain.vertices[1]), (k, true));
            first.insert((chain.vertices[n - 1], chain.vertices[n - 2]), (k, false));
            if vanished[k] {
                continue;
            }
            let made = self.curve(chain);
            let Some((curve, ellipse)) = made else {
                let place = self.net.positions[chain.vertices[n / 2] as usize];
                return Err(self.fault(FacetFaultKind::Edge, &chain.surfaces, place));
            };
            let off = self.off(chain, &curve);
            if off > self.accuracy {
                let place = self.net.positions[chain.vertices[n / 2] as usize];
                return Err(self.fault(FacetFaultKind::Edge, &chain.surfaces, place));
            }
            gap = gap.max(off);
            let ends = [chain.vertices[0], chain.vertices[n - 1]].map(|v| {
                *vertices.entry(root(&one, v)).or_insert_with(|| {
                    brep.vertices.push(self.corners[&root(&one, v)]);
                    brep.vertices.len() - 1
                })
            });
            edges[k] = brep.edges.len();
            brep.edges.push(BrepEdge { ends, curve, ellipse });
        }
        brep.gap = brep.gap.max(gap);
        // No side of an open shell is the outer one.
        let whole = self.shown.iter().all(|s| *s);
        let cavities = self.net.cavities();
        let mut by_group: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        for (k, g) in self.net.groups.iter().enumerate() {
            by_group.entry(*g).or_default().push(k);
        }
        for (group, members) in by_group {
            if !self.shown[self.net.labels[members[0]] as usize] {
                continue;
            }
            let mut loops = self.net.loops(&members, &border, &first, &edges);
            let size = |cycle: &Vec<Coedge>| {
                let points = cycle.iter().flat_map(|side| &brep.edges[side.edge].curve.points);
                let [low, high] = extent(points.copied());
                Vec3::from(high).distance(low.into())
            };
            loops.sort_by(|a, b| size(b).total_cmp(&size(a)));
            if loops.is_empty() {
                continue;
            }
            let cavity = whole && cavities[members[0]];
            brep.faces.push(self.face(group, &members, loops, cavity));
        }
        Ok(())
    }

    /// Distance of a curve from its surfaces: for exact curves by samples, since they are either
    /// right or wrong.
    fn off(&self, chain: &BorderChain, curve: &Nurbs<1>) -> f64 {
        if chain.exact.is_none() {
            return curve.error;
        }
        let ts: Vec<f64> = (0..=24).map(|k| k as f64 / 24.0).collect();
        let places = curve.grid(&[ts]);
        let far = |p: &Vec3| {
            let both = chain.surfaces.map(|s| self.surfaces[s as usize].distance(*p));
            both.into_iter().flatten().fold(0.0f64, |m, d| m.max(d.abs()))
        };
        places.iter().map(far).fold(0.0, f64::max)
    }

    fn face(
        &self,
        group: u32,
        members: &[usize],
        loops: Vec<Vec<Coedge>>,
        cavity: bool,
    ) -> BrepFace {
        let label = self.net.labels[members[0]] as usize;
        let (surface, reversed) =
            faced(&self.surfaces[label], self.axes.get(&group), &self.net, members);
        let extent = extent(members.iter().flat_map(|&k| self.net.corners(k)));
        BrepFace {
            name: self.names[label].clone(),
            colour: self.colours[label],
            layers: self.layers[label].clone(),
            surface,
            reversed,
            loops,
            error: 0.0,
            exact: true,
            extent: Some((extent, cavity)),
        }
    }
}

/// The part of an ellipse between two points, via others; and that ellipse, traversed by increasing
/// angle.
pub fn span(
    ellipse: ExactCurve,
    [p, q]: [Vec3; 2],
    inner: impl Iterator<Item = Vec3>,
    closed: bool,
) -> Option<(Nurbs<1>, ExactCurve)> {
    let ExactCurve::Ellipse { centre, x, y } = ellipse else { return None };
    let start = ellipse.angle(p);
    let wrapped = |d: f64| d - TAU * libm::round(d / TAU);
    let mut at = start;
    for p in inner.chain([q]) {
        at += wrapped(ellipse.angle(p) - at);
    }
    let mut sweep = at - start;
    if closed {
        sweep = if sweep < 0.0 { -TAU } else { TAU };
    }
    let (y, start) = if sweep < 0.0 { (-y, -start) } else { (y, start) };
    let own = ExactCurve::Ellipse { centre, x, y };
    let mut curve = arc(centre, x, y, start, sweep.abs());
    // Ends are vertices, bit for bit.
    let last = curve.points.len() - 1;
    (curve.points[0], curve.points[last]) = (p, q);
    (sweep != 0.0).then_some((curve, own))
}

/// The surface of a face of triangles, with axes of its own, and whether its normal points inwards there.
pub fn faced(
    surface: &SurfaceShape,
    axes: Option<&SurfaceAxes>,
    net: &FacetNet,
    members: &[usize],
) -> (SurfaceShape, bool) {
    let area = |k: usize| {
        let [a, b, c] = net.corners(k);
        (b - a).cross(c - a)
    };
    let largest = members.iter().max_by(|a, b| area(**a).norm().total_cmp(&area(**b).norm()));
    let largest = *largest.unwrap_or(&members[0]);
    let [a, b, c] = net.corners(largest);
    let (middle, out) = ((a + b + c) / 3.0, area(largest));
    let places = members.iter().flat_map(|&k| net.corners(k));
    let mut surface = match surface {
        SurfaceShape::Image(image) => {
            let local = image.local(middle);
            let of = placed(image.of(), axes, local, places.map(|p| image.local(p)));
            SurfaceShape::Image(Box::new(image.with(of)))
        }
        other => placed(other, axes, middle, places),
    };
    let reversed = surface.normal(middle).dot(out) < 0.0;
    if let (true, SurfaceShape::Plane { normal, .. }) = (reversed, &mut surface) {
        *normal = -*normal;
        return (surface, false);
    }
    (surface, reversed)
}

/// A surface with the axes of a face with a known point in the middle and known others; the origin
/// of a cone is moved to its widest point.
fn placed(
    surface: &SurfaceShape,
    axes: Option<&SurfaceAxes>,
    middle: Vec3,
    places: impl Iterator<Item = Vec3>,
) -> SurfaceShape {
    let mut made = axes.map_or_else(|| surface.clone(), |axes| surface.with_axes(*axes));
    if let (Some(apex), SurfaceShape::Cone { axes, radius, half_angle }) = (made.apex(), &mut made)
    {
        if (middle - apex).dot(axes.z) < 0.0 {
            axes.z = -axes.z;
        }
        // There its radius is not zero.
        let high = places.map(|p| (p - apex).dot(axes.z)).fold(0.0, f64::max);
        axes.origin = apex + axes.z * high;
        *radius = high * libm::tan(*half_angle);
    }
    made
}

/// The point near another that is on all surfaces: that of the three that cross best, if it is on the others, too.
fn common_point(shapes: &[SurfaceShape], start: Vec3, near: f64) -> Option<Vec3> {
    const STEPS: usize = 40;
    let n = shapes.len();
    let mut triples = Vec::new();
    let normals: Vec<Vec3> = shapes.iter().map(|s| s.normal(start)).collect();
    for i in 0..n {
        for j in i + 1..n {
            for k in j + 1..n {
                let det = normals[i].dot(normals[j].cross(normals[k])).abs();
                triples.push((det, [i, j, k]));
            }
        }
    }
    triples.sort_by(|a, b| b.0.total_cmp(&a.0));
    let off =
        |p: Vec3| shapes.iter().filter_map(|s| s.distance(p)).fold(0.0f64, |m, d| m.max(d.abs()));
    let mut best: Option<(f64, Vec3)> = None;
    for (det, triple) in triples.into_iter().take(4) {
        if det < 1e-3 {
            break;
        }
        let mut p = start;
        for _ in 0..STEPS {
            let m = triple.map(|k| shapes[k].normal(p));
            let d = triple.map(|k| shapes[k].distance(p).unwrap_or(0.0));
            let [a, b, c] = m;
            let det = a.dot(b.cross(c));
            if det.abs() < 1e-6 {
                break;
            }
            let step = (b.cross(c) * d[0] + c.cross(a) * d[1] + a.cross(b) * d[2]) / det;
            p -= step;
            if step.norm() <= 1e-15 * (1.0 + p.norm()) {
                break;
            }
        }
        let own = off(p);
        if best.is_none_or(|(least, _)| own < least) {
            best = Some((own, p));
        }
        if own <= near {
            break;
        }
    }
    best.map(|(_, p)| p)
}

/// The box round points.
pub fn extent(points: impl Iterator<Item = Vec3>) -> [[f64; 3]; 2] {
    points.fold([[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]], |[mut low, mut high], p| {
        for k in 0..3 {
            low[k] = low[k].min(p[k]);
            high[k] = high[k].max(p[k]);
        }
        [low, high]
    })
}
