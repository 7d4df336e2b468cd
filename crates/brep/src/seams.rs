//! Triangles of labelled faces, and the seams along which faces that go round an axis are cut.
//!
//! A face needs no cut where an angle about its axis is free of it; else its triangles are divided along a half-plane
//! through the axis, which becomes an edge with the face on both sides. A pole inside a face becomes a vertex.

use crate::{Coedge, SurfaceAxes, SurfaceImage, SurfaceShape};
use moldloft_num::Vec3;
use rustc_hash::{FxHashMap, FxHashSet};
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

/// Sectors of the circle that are searched for one free of vertices.
const PARTS: usize = 240;

/// Minimum number of consecutive sectors without the face that form a gap.
const LEAST_GAP: usize = 4;

/// Triangles with the surfaces and faces that they belong to.
pub struct FacetNet {
    pub positions: Vec<Vec3>,
    pub triangles: Vec<[u32; 3]>,
    /// The surface of each triangle.
    pub labels: Vec<u32>,
    /// The face of each triangle, before cuts.
    pub groups: Vec<u32>,
    /// The triangle on the left of each directed side.
    pub across: FxHashMap<(u32, u32), u32>,
    /// The triangle across each side of each triangle; empty once one was divided.
    neighbours: Vec<[u32; 3]>,
    /// The plane of each cut side, by its vertices in order.
    pub seams: BTreeMap<(u32, u32), u32>,
    /// Vertices with known positions.
    pub fixed: BTreeMap<u32, Vec3>,
}

pub fn ordered(a: u32, b: u32) -> (u32, u32) {
    (a.min(b), a.max(b))
}

impl FacetNet {
    /// The net of labelled triangles.
    ///
    /// # Errors
    /// The middle of a side that has more than two triangles, or only one.
    pub fn new(
        positions: Vec<Vec3>,
        triangles: Vec<[u32; 3]>,
        labels: Vec<u32>,
    ) -> Result<Self, Vec3> {
        let middle = |a: u32, b: u32| (positions[a as usize] + positions[b as usize]) / 2.0;
        let mut across =
            FxHashMap::with_capacity_and_hasher(3 * triangles.len(), Default::default());
        for (k, t) in triangles.iter().enumerate() {
            for i in 0..3 {
                let (a, b) = (t[i], t[(i + 1) % 3]);
                if across.insert((a, b), k as u32).is_some() {
                    return Err(middle(a, b));
                }
            }
        }
        let neighbours = neighbours(&triangles, &across).map_err(|(a, b)| middle(a, b))?;
        let mut net = Self {
            neighbours,
            positions,
            groups: vec![u32::MAX; triangles.len()],
            triangles,
            labels,
            across,
            seams: BTreeMap::new(),
            fixed: BTreeMap::new(),
        };
        net.groups = net.connected();
        Ok(net)
    }

    /// The net of labelled triangles with the vertices within reach of a point merged into one.
    pub fn pinned(&self, place: Vec3, reach: f64) -> Option<Self> {
        let inside: Vec<bool> = self.positions.iter().map(|p| p.distance(place) <= reach).collect();
        let Some(one) = inside.iter().position(|i| *i) else {
            let whole = (self.positions.clone(), self.triangles.clone(), self.labels.clone());
            return Self::new(whole.0, whole.1, whole.2).ok();
        };
        let moved = |v: u32| if inside[v as usize] { one as u32 } else { v };
        let (mut triangles, mut labels) = (Vec::new(), Vec::new());
        for (t, label) in self.triangles.iter().zip(&self.labels) {
            let t = t.map(moved);
            if t[0] != t[1] && t[1] != t[2] && t[2] != t[0] {
                triangles.push(t);
                labels.push(*label);
            }
        }
        let mut positions = self.positions.clone();
        positions[one] = place;
        let mut net = Self::new(positions, triangles, labels).ok()?;
        net.fixed = self.fixed.clone();
        net.fixed.insert(one as u32, place);
        Some(net)
    }

    /// The triangle across a side of a triangle.
    pub fn beyond(&self, triangle: usize, side: usize) -> usize {
        match self.neighbours.get(triangle) {
            Some(own) => own[side] as usize,
            None => {
                let t = self.triangles[triangle];
                self.across[&(t[(side + 1) % 3], t[side])] as usize
            }
        }
    }

    /// Updates adjacency after a division of triangles.
    pub fn settle(&mut self) {
        if self.neighbours.is_empty() {
            self.neighbours = neighbours(&self.triangles, &self.across).unwrap_or_default();
        }
    }

    /// The number of the face of each triangle: connected triangles of one surface form one face,
    /// seams excepted.
    pub fn connected(&self) -> Vec<u32> {
        let mut groups = vec![u32::MAX; self.triangles.len()];
        let mut count = 0;
        for start in 0..self.triangles.len() {
            if groups[start] != u32::MAX {
                continue;
            }
            groups[start] = count;
            let mut queue = vec![start];
            while let Some(k) = queue.pop() {
                let t = self.triangles[k];
                for i in 0..3 {
                    let (a, b) = (t[i], t[(i + 1) % 3]);
                    let other = self.beyond(k, i);
                    let one = self.labels[other] == self.labels[k];
                    let cut = !self.seams.is_empty() && self.seams.contains_key(&ordered(a, b));
                    if one && !cut && groups[other] == u32::MAX {
                        groups[other] = count;
                        queue.push(other);
                    }
                }
            }
            count += 1;
        }
        groups
    }

    /// The triangles of a face.
    pub fn members(&self, group: u32) -> Vec<usize> {
        (0..self.triangles.len()).filter(|&k| self.groups[k] == group).collect()
    }

    pub fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.triangles[triangle].map(|v| self.positions[v as usize])
    }

    /// Puts a vertex on a side.
    pub fn split(&mut self, a: u32, b: u32, at: Vec3) -> u32 {
        self.neighbours.clear();
        let m = self.positions.len() as u32;
        self.positions.push(at);
        for (x, y) in [(a, b), (b, a)] {
            let Some(k) = self.across.remove(&(x, y)) else { continue };
            let t = self.triangles[k as usize];
            let Some(i) = (0..3).find(|&i| t[i] == x) else { continue };
            let c = t[(i + 2) % 3];
            self.triangles[k as usize] = [x, m, c];
            self.add([m, y, c], k);
            for side in [(x, m), (m, c), (c, x)] {
                self.across.insert(side, k);
            }
        }
        if let Some(seam) = self.seams.remove(&ordered(a, b)) {
            self.seams.insert(ordered(a, m), seam);
            self.seams.insert(ordered(m, b), seam);
        }
        m
    }

    /// A triangle beside another, of the same surface and face.
    fn add(&mut self, t: [u32; 3], like: u32) {
        self.neighbours.clear();
        let n = self.triangles.len() as u32;
        self.triangles.push(t);
        self.labels.push(self.labels[like as usize]);
        self.groups.push(self.groups[like as usize]);
        for i in 0..3 {
            self.across.insert((t[i], t[(i + 1) % 3]), n);
        }
    }

    /// The vertex of a face on a ray from a centre: a new one, unless there is one.
    fn pierced(&mut self, members: &[usize], from: Vec3, direction: Vec3) -> Option<u32> {
        for &k in members {
            let t = self.triangles[k];
            let [a, b, c] = self.corners(k).map(|p| p - from);
            let n = (b - a).cross(c - a);
            let along = n.dot(direction);
            let s = n.dot(a) / along;
            if along == 0.0 || s <= 0.0 {
                continue;
            }
            let p = direction * s;
            let shares =
                [(b, c), (c, a), (a, b)].map(|(u, v)| (u - p).cross(v - p).dot(n) / n.norm_sq());
            if shares.iter().any(|s| *s < -1e-12) {
                continue;
            }
            if let Some(i) = (0..3).find(|&i| shares[i] > 1.0 - 1e-9) {
                return Some(t[i]);
            }
            if let Some(i) = (0..3).find(|&i| shares[i] < 1e-9) {
                return Some(self.split(t[(i + 1) % 3], t[(i + 2) % 3], from + p));
            }
            let m = self.positions.len() as u32;
            self.positions.push(from + p);
            self.triangles[k] = [t[0], t[1], m];
            self.add([t[1], t[2], m], k as u32);
            self.add([t[2], t[0], m], k as u32);
            for side in [(t[0], t[1]), (t[1], m), (m, t[0])] {
                self.across.insert(side, k as u32);
            }
            return Some(m);
        }
        None
    }

    /// Divides a face where a function is zero and another positive; the new sides are seams of
    /// that plane. False if the zero set contains an existing vertex.
    fn cut(
        &mut self,
        group: u32,
        plane: u32,
        height: &dyn Fn(Vec3) -> f64,
        beyond: &dyn Fn(Vec3) -> bool,
        poles: &[u32],
        near: f64,
    ) -> bool {
        let mut flagged: FxHashSet<u32> = poles.iter().copied().collect();
        let mut crossed = Vec::new();
        let mut seen = FxHashSet::default();
        for k in self.members(group) {
            let t = self.triangles[k];
            for i in 0..3 {
                let (a, b) = (t[i], t[(i + 1) % 3]);
                if flagged.contains(&a) || flagged.contains(&b) || !seen.insert(ordered(a, b)) {
                    continue;
                }
                let [p, q] = [a, b].map(|v| self.positions[v as usize]);
                let [f, g] = [p, q].map(height);
                if f.abs() <= near && beyond(p) || g.abs() <= near && beyond(q) {
                    return false;
                }
                let at = p.lerp(q, f / (f - g));
                if (f > 0.0) != (g > 0.0) && beyond(at) {
                    crossed.push((ordered(a, b), at));
                }
            }
        }
        crossed.sort_by_key(|c| c.0);
        for ((a, b), at) in crossed {
            flagged.insert(self.split(a, b, at));
        }
        for k in self.members(group) {
            let t = self.triangles[k];
            for i in 0..3 {
                let (a, b) = (t[i], t[(i + 1) % 3]);
                let inside =
                    self.across.get(&(b, a)).is_some_and(|&o| self.groups[o as usize] == group);
                if flagged.contains(&a) && flagged.contains(&b) && inside {
                    self.seams.entry(ordered(a, b)).or_insert(plane);
                }
            }
        }
        true
    }

    /// Centre of the widest range of angles without the face; `None` if it has every angle.
    pub fn gap(&self, members: &[usize], angle: &dyn Fn(Vec3) -> Option<f64>) -> Option<f64> {
        let mut taken = [false; PARTS];
        for &k in members {
            let angles: Vec<f64> = self.corners(k).into_iter().filter_map(angle).collect();
            let Some(&first) = angles.first() else { continue };
            let away = |a: &f64| {
                let d = a - first;
                d - TAU * libm::round(d / TAU)
            };
            let low = angles.iter().map(away).fold(0.0, f64::min);
            let high = angles.iter().map(away).fold(0.0, f64::max);
            if high - low > 0.9 * PI {
                return None;
            }
            let part = |a: f64| libm::floor(a / TAU * PARTS as f64) as i64;
            for n in part(first + low)..=part(first + high) {
                taken[n.rem_euclid(PARTS as i64) as usize] = true;
            }
        }
        let start = taken.iter().position(|t| *t)?;
        let (mut best, mut run, mut end) = (0, 0, 0);
        for n in 1..=PARTS {
            let k = (start + n) % PARTS;
            run = if taken[k] { 0 } else { run + 1 };
            if run > best {
                (best, end) = (run, start + n);
            }
        }
        let middle = (end as f64 + 1.0 - best as f64 / 2.0) * TAU / PARTS as f64;
        (best >= LEAST_GAP).then_some(middle)
    }

    /// The direction of a half-plane about an axis that crosses few borders of the face, far from
    /// its corners.
    fn seam_angle(
        &self,
        members: &[usize],
        axes: &SurfaceAxes,
        group: u32,
        corners: &FxHashSet<u32>,
    ) -> f64 {
        const CHOICES: usize = 72;
        let mut borders = Vec::new();
        let mut away = Vec::new();
        for &k in members {
            let t = self.triangles[k];
            for i in 0..3 {
                let (a, b) = (t[i], t[(i + 1) % 3]);
                let own = self.groups[self.across[&(b, a)] as usize] == group;
                if !own {
                    let [p, q] = [a, b].map(|v| axes.angle(self.positions[v as usize]));
                    borders.push((p, q));
                    if corners.contains(&a) {
                        away.push(p);
                    }
                }
            }
        }
        let wrapped = |d: f64| d - TAU * libm::round(d / TAU);
        let figure = |u: f64| {
            let crossings = borders.iter().filter(|(p, q)| {
                let (p, q) = (wrapped(p - u), wrapped(q - u));
                (p > 0.0) != (q > 0.0) && (p - q).abs() < PI
            });
            let near = away.iter().map(|a| wrapped(a - u).abs()).fold(PI, f64::min);
            (crossings.count(), near)
        };
        // No simple angles: the cuts would pass through vertices.
        let all = (0..CHOICES).map(|k| 0.013_77 + TAU * k as f64 / CHOICES as f64);
        let best = all
            .map(|u| (figure(u), u))
            .min_by(|(f, u), (g, v)| f.0.cmp(&g.0).then(g.1.total_cmp(&f.1)).then(u.total_cmp(v)));
        best.map_or(0.0, |b| b.1)
    }

    /// Axes for a face on a surface of revolution, after the cuts that it needs; planes of cuts are added to the
    /// surfaces. None where no cut succeeds.
    pub fn prepared(
        &mut self,
        group: u32,
        surface: &SurfaceShape,
        beside: &[Vec3],
        planes: &mut Vec<SurfaceShape>,
        corners: &FxHashSet<u32>,
        (size, step): (f64, f64),
    ) -> Option<SurfaceAxes> {
        let members = self.members(group);
        let mut axes = *surface.axes()?;
        if let SurfaceShape::Sphere { radius, .. } = surface {
            axes = self.sphere_axes(&members, axes, *radius, beside);
        }
        let near = 1e-9 * size;
        let pole = surface.apex();
        let on_axis = |p: Vec3| {
            let [x, y, _] = axes.local(p);
            x.abs().max(y.abs()) <= near
        };
        let angle = |p: Vec3| (!on_axis(p)).then(|| axes.angle(p));
        if let Some(u) = self.gap(&members, &angle) {
            axes.x = axes.x * libm::cos(u) + axes.y() * libm::sin(u);
        } else {
            let mut poles = Vec::new();
            if matches!(surface, SurfaceShape::Sphere { .. }) {
                for z in [axes.z, -axes.z] {
                    let members = self.members(group);
                    let Some(v) = self.pierced(&members, axes.origin, z) else { continue };
                    let radius = (self.positions[v as usize] - axes.origin).norm();
                    let exact = axes.origin + z * surface_radius(surface).unwrap_or(radius);
                    self.positions[v as usize] = exact;
                    self.fixed.insert(v, exact);
                    poles.push(v);
                }
            }
            if let Some(apex) = pole {
                let all = members.iter().flat_map(|&k| self.triangles[k]);
                let far = |v: u32| self.positions[v as usize].distance(apex);
                let tip = all.min_by(|a, b| far(*a).total_cmp(&far(*b)));
                if let Some(v) = tip.filter(|&v| far(v) <= 0.1 * step) {
                    self.positions[v as usize] = apex;
                    self.fixed.insert(v, apex);
                    poles.push(v);
                }
            }
            let members = self.members(group);
            let mut u = self.seam_angle(&members, &axes, group, corners);
            let plane = planes.len() as u32;
            let mut done = false;
            for _ in 0..20 {
                let x = axes.x * libm::cos(u) + axes.y() * libm::sin(u);
                let normal = axes.z.cross(x);
                let height = |p: Vec3| (p - axes.origin).dot(normal);
                let beyond = |p: Vec3| (p - axes.origin).dot(x) > 0.0;
                done = self.cut(group, plane, &height, &beyond, &poles, near);
                if done {
                    axes.x = x;
                    planes.push(SurfaceShape::Plane { origin: axes.origin, normal, axis: x });
                    break;
                }
                u += 0.000_731;
            }
            if !done {
                return None;
            }
        }
        if let SurfaceShape::Torus { major, .. } = surface {
            let round = |p: Vec3| {
                let [x, y, z] = axes.local(p);
                Some(libm::atan2(z, (x * x + y * y).sqrt() - major))
            };
            let members = self.members(group);
            if self.gap(&members, &round).is_none() {
                let plane = planes.len() as u32;
                let height = |p: Vec3| (p - axes.origin).dot(axes.z);
                let beyond = |p: Vec3| {
                    let [x, y, _] = axes.local(p);
                    x * x + y * y > major * major
                };
                // The reader's parameters begin there: no other height will do.
                self.lift(group, &height, &beyond, axes.z, near);
                if !self.cut(group, plane, &height, &beyond, &[], 0.0) {
                    return None;
                }
                planes.push(SurfaceShape::Plane {
                    origin: axes.origin,
                    normal: axes.z,
                    axis: axes.x,
                });
            }
        }
        Some(axes)
    }

    /// The prepared patch of a face on the image of a surface of revolution, in the coordinates of the image.
    pub fn prepared_image(
        &mut self,
        group: u32,
        image: &SurfaceImage,
        beside: &[Vec3],
        planes: &mut Vec<SurfaceShape>,
        corners: &FxHashSet<u32>,
        (size, step): (f64, f64),
    ) -> Option<SurfaceAxes> {
        let local: Vec<Vec3> = self.positions.iter().map(|p| image.local(*p)).collect();
        let before = std::mem::replace(&mut self.positions, local.clone());
        let fixed = std::mem::take(&mut self.fixed);
        let known = planes.len();
        let beside: Vec<Vec3> = beside.iter().filter_map(|n| image.normal_back(*n)).collect();
        let scale = image.scale();
        let made = self.prepared(
            group,
            image.of(),
            &beside,
            planes,
            corners,
            (size / scale, step / scale),
        );
        // Back, to the last bit where nothing moved.
        let own = std::mem::replace(&mut self.fixed, fixed);
        self.fixed.extend(own.into_iter().map(|(v, p)| (v, image.world(p))));
        for (v, p) in self.positions.iter_mut().enumerate() {
            *p = match (local.get(v), before.get(v)) {
                (Some(l), Some(b)) if l == p => *b,
                _ => image.world(*p),
            };
        }
        for plane in &mut planes[known..] {
            if let SurfaceShape::Plane { origin, normal, axis } = plane {
                *origin = image.world(*origin);
                *normal = image.gradient(*normal).normalized()?;
                *axis = image.linear(*axis).normalized()?;
            }
        }
        made
    }

    /// Moves vertices inside a face off a plane, by less than counts: only which side they are on matters.
    fn lift(
        &mut self,
        group: u32,
        height: &dyn Fn(Vec3) -> f64,
        beyond: &dyn Fn(Vec3) -> bool,
        normal: Vec3,
        near: f64,
    ) {
        for k in self.members(group) {
            for v in self.triangles[k] {
                let p = self.positions[v as usize];
                if height(p).abs() <= near && beyond(p) {
                    self.positions[v as usize] = p + normal * (3.0 * near);
                }
            }
        }
    }

    /// Axes of a face of a sphere: with poles outside the face, if possible, along an adjacent
    /// surface's axis if that allows it.
    fn sphere_axes(
        &self,
        members: &[usize],
        axes: SurfaceAxes,
        radius: f64,
        beside: &[Vec3],
    ) -> SurfaceAxes {
        let mut vertices: Vec<u32> = members.iter().flat_map(|&k| self.triangles[k]).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let units: Vec<Vec3> =
            vertices.iter().map(|&v| (self.positions[v as usize] - axes.origin) / radius).collect();
        let longest = members
            .iter()
            .flat_map(|&k| {
                let [a, b, c] = self.corners(k);
                [a.distance(b), b.distance(c), c.distance(a)]
            })
            .fold(0.0, f64::max)
            / radius;
        let room = |z: Vec3| units.iter().map(|u| (*u - z).norm()).fold(2.0, f64::min);
        let figure = |z: Vec3| {
            let both = [room(z), room(-z)];
            let free = both.iter().filter(|r| **r > 1.2 * longest).count();
            (free, both[0].max(both[1]).min(if free == 2 { both[0].min(both[1]) } else { 2.0 }))
        };
        const CHOICES: usize = 150;
        let golden = PI * (3.0 - 5f64.sqrt());
        let spread = (0..CHOICES).map(|k| {
            let z = (k as f64 + 0.5) / CHOICES as f64;
            let r = (1.0 - z * z).sqrt();
            let a = golden * k as f64;
            Vec3::of(r * libm::cos(a), r * libm::sin(a), z)
        });
        if let [z] = beside {
            // Circles about one axis.
            let border = |p: &Vec3| (*p - *z).norm().min((*p + *z).norm());
            let edge: Vec<Vec3> = members
                .iter()
                .flat_map(|&k| {
                    let t = self.triangles[k];
                    (0..3).map(move |i| (t[i], t[(i + 1) % 3], k))
                })
                .filter(|&(a, b, k)| self.groups[self.across[&(b, a)] as usize] != self.groups[k])
                .map(|(a, ..)| (self.positions[a as usize] - axes.origin) / radius)
                .collect();
            if edge.iter().map(border).fold(2.0, f64::min) > 2.0 * longest {
                return SurfaceAxes::about(axes.origin, *z);
            }
        }
        let mut best = (figure(axes.z), axes.z);
        for (natural, z) in beside.iter().map(|z| (true, *z)).chain(spread.map(|z| (false, z))) {
            let own = figure(z);
            // Axes of adjacent surfaces are preferred to arbitrary directions with slightly wider
            // gaps.
            let bonus = if natural { 1.0 } else { 1.3 };
            if own.0 > best.0.0 || own.0 == best.0.0 && own.1 > bonus * best.0.1 {
                best = (own, z);
            }
        }
        SurfaceAxes::about(axes.origin, best.1)
    }

    /// The loops of a face: its border sides, each followed by the next one round its end within the face.
    pub fn loops(
        &self,
        members: &[usize],
        border: &FxHashSet<(u32, u32)>,
        first: &FxHashMap<(u32, u32), (usize, bool)>,
        edges: &[usize],
    ) -> Vec<Vec<Coedge>> {
        let mut seen: FxHashSet<(u32, u32)> = FxHashSet::default();
        let mut loops = Vec::new();
        for &k in members {
            let t = self.triangles[k];
            for i in 0..3 {
                let start = (t[i], t[(i + 1) % 3]);
                if !border.contains(&start) || seen.contains(&start) {
                    continue;
                }
                let mut cycle = Vec::new();
                let mut side = start;
                while seen.insert(side) {
                    if let Some(&(chain, forward)) = first.get(&side)
                        && edges[chain] != usize::MAX
                    {
                        cycle.push(Coedge {
                            edge: edges[chain],
                            forward,
                            trace: None,
                            alike: true,
                        });
                    }
                    // The next side of the triangle, and of those round the vertex, until one is a border.
                    let mut turn = side;
                    loop {
                        let t = self.triangles[self.across[&turn] as usize];
                        let i = (0..3).find(|&i| t[i] == turn.0).unwrap_or(0);
                        let out = (t[(i + 1) % 3], t[(i + 2) % 3]);
                        if border.contains(&out) {
                            side = out;
                            break;
                        }
                        turn = (out.1, out.0);
                    }
                }
                if !cycle.is_empty() {
                    loops.push(cycle);
                }
            }
        }
        loops
    }

    /// For each triangle whether it bounds a cavity.
    pub fn cavities(&self) -> Vec<bool> {
        let mut shell = vec![usize::MAX; self.triangles.len()];
        let mut volumes = Vec::new();
        for start in 0..shell.len() {
            if shell[start] != usize::MAX {
                continue;
            }
            let own = volumes.len();
            let origin = self.corners(start)[0];
            let mut volume = 0.0;
            shell[start] = own;
            let mut queue = vec![start];
            while let Some(k) = queue.pop() {
                let [a, b, c] = self.corners(k).map(|p| p - origin);
                volume += a.dot(b.cross(c));
                for i in 0..3 {
                    let other = self.beyond(k, i);
                    if shell[other] == usize::MAX {
                        shell[other] = own;
                        queue.push(other);
                    }
                }
            }
            volumes.push(volume);
        }
        shell.into_iter().map(|s| volumes[s] < 0.0).collect()
    }
}

/// The triangle across each side of each triangle; `None` if a side has only one.
fn neighbours(
    triangles: &[[u32; 3]],
    across: &FxHashMap<(u32, u32), u32>,
) -> Result<Vec<[u32; 3]>, (u32, u32)> {
    let beyond = |t: &[u32; 3]| {
        let mut own = [0; 3];
        for (i, other) in own.iter_mut().enumerate() {
            let side = (t[(i + 1) % 3], t[i]);
            *other = *across.get(&side).ok_or(side)?;
        }
        Ok(own)
    };
    triangles.iter().map(beyond).collect()
}

fn surface_radius(surface: &SurfaceShape) -> Option<f64> {
    match surface {
        SurfaceShape::Sphere { radius, .. } => Some(*radius),
        _ => None,
    }
}
