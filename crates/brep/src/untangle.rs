//! Triangles that turned over, or became slivers, when their vertices were moved onto their surfaces.
//!
//! If two surfaces touch along a curve, as a blend and its faces do, cells do not resolve their
//! border: its vertices deviate by up to a cell, and there may be small pieces of a third surface.

use crate::patches::PatchedBody;
use crate::seams::FacetNet;
use moldloft_num::Vec3;
use rustc_hash::FxHashSet;

/// Triangles of a lower quality are corrected; that of an even one is 1, of one that is turned over less than 0.
const LEAST: f64 = 0.06;

/// Minimum gain of the least quality by a correction.
const GAIN: f64 = 1e-3;

/// Walks over all triangles.
const PASSES: usize = 8;

/// A piece of a surface of less than the square of `PIECE` in area is given to a surface beside it
/// that is within `NEAR`; both relative to a cell's side.
const PIECE: f64 = 0.3;
const NEAR: f64 = 0.02;

/// Surfaces touch where the sine of the angle of their normals is below `TOUCHING`; their border is
/// smoothed where the cosine of its turn is below `STRAIGHT`.
const TOUCHING: f64 = 0.2;
const STRAIGHT: f64 = 0.75;

/// Correction of a triangle.
#[derive(Clone, Copy)]
enum Repair {
    /// Flip of the side from the first vertex to the second.
    Flip(u32, u32),
    /// The first vertex becomes the second.
    Collapse(u32, u32),
    Move(u32, Vec3),
}

/// Triangles under repair.
struct Tangle {
    triangles: Vec<[u32; 3]>,
    labels: Vec<u32>,
    alive: Vec<bool>,
    /// The triangles round each vertex.
    around: Vec<Vec<u32>>,
    moved: FxHashSet<u32>,
}

impl PatchedBody<'_> {
    /// Gives small pieces of surfaces between others to these.
    pub fn absorb_pieces(&mut self) {
        let mut members: Vec<Vec<usize>> = Vec::new();
        for (k, g) in self.net.groups.iter().enumerate() {
            if members.len() <= *g as usize {
                members.resize(*g as usize + 1, Vec::new());
            }
            members[*g as usize].push(k);
        }
        let step = self.facets.step;
        let mut labels = self.net.labels.clone();
        for own in members.iter().filter(|own| !own.is_empty()) {
            let cross = |&k: &usize| {
                let [a, b, c] = self.net.corners(k);
                0.5 * (b - a).cross(c - a).norm()
            };
            let area: f64 = own.iter().map(cross).sum();
            if area > PIECE * PIECE * step * step {
                continue;
            }
            let mut beside: Vec<u32> = Vec::new();
            for &k in own {
                let t = self.net.triangles[k];
                for i in 0..3 {
                    let label = self.net.labels[self.net.across[&(t[(i + 1) % 3], t[i])] as usize];
                    if label != self.net.labels[k] && !beside.contains(&label) {
                        beside.push(label);
                    }
                }
            }
            let away = |label: u32| {
                let places = own.iter().flat_map(|&k| {
                    let [a, b, c] = self.net.corners(k);
                    [a, b, c, (a + b + c) / 3.0]
                });
                places
                    .map(|p| {
                        let (f, slope) = (self.field)(label, p);
                        if f == 0.0 { 0.0 } else { f.abs() / slope.norm() }
                    })
                    .fold(0.0, f64::max)
            };
            let nearest = beside
                .into_iter()
                .map(|label| (away(label), label))
                .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            if let Some((off, label)) = nearest
                && off <= NEAR * step
            {
                own.iter().for_each(|&k| labels[k] = label);
            }
        }
        if labels != self.net.labels {
            self.net.labels = labels;
            self.net.groups = self.net.connected();
        }
    }

    /// Corrects triangles that are turned over or slivers, all or those round some vertices; gives the vertices that were
    /// moved, or nothing where all is well.
    pub fn untangle(&mut self, round: Option<&FxHashSet<u32>>) -> Option<FxHashSet<u32>> {
        let mut tangle = Tangle {
            triangles: self.net.triangles.clone(),
            labels: self.net.labels.clone(),
            alive: vec![true; self.net.triangles.len()],
            around: vec![Vec::new(); self.net.positions.len()],
            moved: FxHashSet::default(),
        };
        for (k, t) in tangle.triangles.iter().enumerate() {
            for &v in t {
                tangle.around[v as usize].push(k as u32);
            }
        }
        if self.signs.is_empty() {
            self.signs = self.outward();
        }
        let near = |t: &[u32; 3]| round.is_none_or(|own| t.iter().any(|v| own.contains(v)));
        let mut walked: Vec<usize> =
            (0..tangle.triangles.len()).filter(|k| near(&tangle.triangles[*k])).collect();
        let mut changed = false;
        for _ in 0..PASSES {
            let mut corrected = false;
            for &k in &walked {
                if tangle.alive[k]
                    && self.is_shown_surface(tangle.labels[k])
                    && self.quality(tangle.triangles[k], tangle.labels[k]) < LEAST
                    && let Some(repair) = self.best_repair(&tangle, k)
                {
                    self.apply(&mut tangle, repair);
                    corrected = true;
                }
            }
            // Their surroundings may have become worse.
            let mut vertices: Vec<u32> = walked.iter().flat_map(|&k| tangle.triangles[k]).collect();
            vertices.sort_unstable();
            vertices.dedup();
            for &v in &vertices {
                if let Some(repair) = self.straighten(&tangle, v) {
                    self.apply(&mut tangle, repair);
                    corrected = true;
                }
            }
            changed |= corrected;
            if !corrected {
                break;
            }
            if round.is_some() {
                walked = vertices
                    .iter()
                    .flat_map(|v| &tangle.around[*v as usize])
                    .map(|k| *k as usize)
                    .collect();
                walked.sort_unstable();
                walked.dedup();
            }
        }
        if !changed {
            return None;
        }
        let kept = |k: &usize| tangle.alive[*k];
        let count = tangle.triangles.len();
        let triangles = (0..count).filter(kept).map(|k| tangle.triangles[k]).collect();
        let labels = (0..count).filter(kept).map(|k| tangle.labels[k]).collect();
        if let Ok(net) = FacetNet::new(self.net.positions.clone(), triangles, labels) {
            self.net = net;
        }
        Some(tangle.moved)
    }

    /// For each surface 1 where its gradient points outwards, else -1.
    fn outward(&self) -> Vec<f64> {
        let mut signs = vec![0.0; self.facets.surfaces.len()];
        for k in 0..self.net.triangles.len() {
            let [a, b, c] = self.net.corners(k);
            let label = self.net.labels[k];
            let slope = (self.field)(label, (a + b + c) / 3.0).1.normalized().unwrap_or_default();
            signs[label as usize] += (b - a).cross(c - a).dot(slope);
        }
        signs.iter().map(|s| if *s < 0.0 { -1.0 } else { 1.0 }).collect()
    }

    /// Quality of a triangle: its shape, and its orientation to the surface.
    fn quality(&self, t: [u32; 3], label: u32) -> f64 {
        self.quality_at(t.map(|v| self.net.positions[v as usize]), label)
    }

    fn quality_at(&self, [a, b, c]: [Vec3; 3], label: u32) -> f64 {
        let slope = (self.field)(label, (a + b + c) / 3.0).1.normalized().unwrap_or_default();
        let sides = a.distance(b).powi(2) + b.distance(c).powi(2) + c.distance(a).powi(2);
        let area = (b - a).cross(c - a).dot(slope) * self.signs[label as usize];
        if sides > 0.0 { 2.0 * 3f64.sqrt() * area / sides } else { 0.0 }
    }

    /// The correction with the best result around it, if better than the present state.
    fn best_repair(&self, tangle: &Tangle, k: usize) -> Option<Repair> {
        let t = tangle.triangles[k];
        let mut best: Option<(f64, Repair)> = None;
        let mut offer = |found: Option<(f64, f64)>, repair: Repair| {
            if let Some((before, after)) = found
                && after > before + GAIN
                && best.as_ref().is_none_or(|(gain, _)| after - before > *gain)
            {
                best = Some((after - before, repair));
            }
        };
        for i in 0..3 {
            let (a, b) = (t[i], t[(i + 1) % 3]);
            offer(self.flipped(tangle, a, b), Repair::Flip(a, b));
            offer(self.collapsed(tangle, a, b), Repair::Collapse(a, b));
            offer(self.collapsed(tangle, b, a), Repair::Collapse(b, a));
            if let Some(place) = self.smoothed(tangle, a) {
                let [before, after] = [self.net.positions[a as usize], place].map(|at| {
                    let own = tangle.around[a as usize].iter().map(|&n| {
                        let t = tangle.triangles[n as usize];
                        let corners =
                            t.map(|v| if v == a { at } else { self.net.positions[v as usize] });
                        self.quality_at(corners, tangle.labels[n as usize])
                    });
                    own.fold(1.0, f64::min)
                });
                offer(Some((before, after)), Repair::Move(a, place));
            }
        }
        best.map(|(_, repair)| repair)
    }

    /// The least quality of two triangles before and after their diagonal is the other one.
    fn flipped(&self, tangle: &Tangle, a: u32, b: u32) -> Option<(f64, f64)> {
        let (k, l) = (tangle.left(a, b)?, tangle.left(b, a)?);
        let label = tangle.labels[k];
        let (c, d) = (tangle.third(k, a, b)?, tangle.third(l, a, b)?);
        if tangle.labels[l] != label || c == d || tangle.left(c, d).or(tangle.left(d, c)).is_some()
        {
            return None;
        }
        let q = |t: [u32; 3]| self.quality(t, label);
        let before = q(tangle.triangles[k]).min(q(tangle.triangles[l]));
        Some((before, q([c, a, d]).min(q([d, b, c]))))
    }

    /// The least quality of the triangles round a vertex before and after it becomes another.
    fn collapsed(&self, tangle: &Tangle, from: u32, to: u32) -> Option<(f64, f64)> {
        if !tangle.may_collapse(from, to) {
            return None;
        }
        let (mut before, mut after) = (1f64, 1f64);
        for &n in &tangle.around[from as usize] {
            let (t, label) = (tangle.triangles[n as usize], tangle.labels[n as usize]);
            before = before.min(self.quality(t, label));
            if !t.contains(&to) {
                let t = t.map(|v| if v == from { to } else { v });
                after = after.min(self.quality(t, label));
            }
        }
        Some((before, after))
    }

    /// Correction of a sharp turn in a border of two touching surfaces: its vertex is on another
    /// common line there.
    fn straighten(&self, tangle: &Tangle, v: u32) -> Option<Repair> {
        let labels = tangle.labels_of(v);
        let at = |v: u32| self.net.positions[v as usize];
        let &[one, other] = &labels[..] else { return None };
        if !self.is_shown_surface(one) && !self.is_shown_surface(other) {
            return None;
        }
        let slope = |label: u32| (self.field)(label, at(v)).1.normalized().unwrap_or_default();
        if slope(one).cross(slope(other)).norm() > TOUCHING {
            return None;
        }
        let &[before, after] = &tangle.border_neighbours(v)[..] else { return None };
        let turn = |p: Vec3| {
            let [a, b] = [p - at(before), at(after) - p];
            a.dot(b) / (a.norm() * b.norm())
        };
        let now = turn(at(v));
        // Also one of no length.
        if now >= STRAIGHT {
            return None;
        }
        let own = |at_v: Vec3| {
            let round = tangle.around[v as usize].iter().map(|&n| {
                let t = tangle.triangles[n as usize];
                let corners = t.map(|w| if w == v { at_v } else { at(w) });
                self.quality_at(corners, tangle.labels[n as usize])
            });
            round.fold(1.0, f64::min)
        };
        if let Some(place) = self.smoothed(tangle, v)
            && turn(place) > now.max(STRAIGHT)
            && own(place) >= own(at(v)).min(LEAST)
        {
            return Some(Repair::Move(v, place));
        }
        let nearest = [before, after]
            .into_iter()
            .min_by(|a, b| at(v).distance(at(*a)).total_cmp(&at(v).distance(at(*b))))?;
        let (low, high) = self.collapsed(tangle, v, nearest)?;
        (high >= low.min(LEAST)).then_some(Repair::Collapse(v, nearest))
    }

    /// A point between the neighbours of a vertex, on its surfaces.
    fn smoothed(&self, tangle: &Tangle, v: u32) -> Option<Vec3> {
        let labels = tangle.labels_of(v);
        let neighbours = match labels.len() {
            1 => tangle.neighbours(v),
            2 => {
                let along = tangle.border_neighbours(v);
                if along.len() != 2 {
                    return None;
                }
                along
            }
            _ => return None,
        };
        let sum = neighbours.iter().map(|&w| self.net.positions[w as usize]);
        let middle = sum.fold(Vec3::zero(), |s, p| s + p) / neighbours.len() as f64;
        self.foot(&labels, middle, self.facets.step)
    }

    fn apply(&mut self, tangle: &mut Tangle, repair: Repair) {
        match repair {
            Repair::Move(v, place) => {
                self.net.positions[v as usize] = place;
                tangle.moved.insert(v);
            }
            Repair::Flip(a, b) => tangle.flip(a, b),
            Repair::Collapse(from, to) => tangle.collapse(from, to),
        }
    }
}

impl Tangle {
    /// The triangle on the left of a directed side.
    fn left(&self, a: u32, b: u32) -> Option<usize> {
        let own = self.around[a as usize].iter().map(|k| *k as usize);
        own.into_iter().find(|&k| {
            let t = self.triangles[k];
            (0..3).any(|i| t[i] == a && t[(i + 1) % 3] == b)
        })
    }

    fn third(&self, k: usize, a: u32, b: u32) -> Option<u32> {
        self.triangles[k].into_iter().find(|v| *v != a && *v != b)
    }

    fn neighbours(&self, v: u32) -> Vec<u32> {
        let all = self.around[v as usize].iter().flat_map(|&k| self.triangles[k as usize]);
        let mut found: Vec<u32> = all.filter(|w| *w != v).collect();
        found.sort_unstable();
        found.dedup();
        found
    }

    fn labels_of(&self, v: u32) -> Vec<u32> {
        let mut found: Vec<u32> =
            self.around[v as usize].iter().map(|&k| self.labels[k as usize]).collect();
        found.sort_unstable();
        found.dedup();
        found
    }

    /// The neighbours to which a side leads that two surfaces share.
    fn border_neighbours(&self, v: u32) -> Vec<u32> {
        let borders = |w: &u32| {
            let sides = [self.left(v, *w), self.left(*w, v)];
            matches!(sides, [Some(k), Some(l)] if self.labels[k] != self.labels[l])
        };
        self.neighbours(v).into_iter().filter(borders).collect()
    }

    fn may_collapse(&self, from: u32, to: u32) -> bool {
        let own = self.labels_of(from);
        let along = self.border_neighbours(from);
        let free = match own.len() {
            1 => along.is_empty(),
            2 => along.len() == 2 && along.contains(&to),
            _ => false,
        };
        let others = self.neighbours(to);
        let common = self.neighbours(from).iter().filter(|w| others.contains(w)).count();
        free && common == 2 && self.around[from as usize].len() > 3
    }

    fn flip(&mut self, a: u32, b: u32) {
        let (Some(k), Some(l)) = (self.left(a, b), self.left(b, a)) else { return };
        let (Some(c), Some(d)) = (self.third(k, a, b), self.third(l, a, b)) else { return };
        self.triangles[k] = [c, a, d];
        self.triangles[l] = [d, b, c];
        let (k, l) = (k as u32, l as u32);
        self.around[a as usize].retain(|n| *n != l);
        self.around[b as usize].retain(|n| *n != k);
        self.around[c as usize].push(l);
        self.around[d as usize].push(k);
    }

    fn collapse(&mut self, from: u32, to: u32) {
        for n in std::mem::take(&mut self.around[from as usize]) {
            let k = n as usize;
            if self.triangles[k].contains(&to) {
                self.alive[k] = false;
                for v in self.triangles[k] {
                    self.around[v as usize].retain(|m| *m != n);
                }
            } else {
                self.triangles[k] = self.triangles[k].map(|v| if v == from { to } else { v });
                self.around[to as usize].push(n);
            }
        }
    }
}
