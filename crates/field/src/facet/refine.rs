//! Refinement for curvature that the cells do not resolve: edges along which the normal turns far
//! are divided, and adjacent diagonals are flipped along the surface.
//!
//! This is svLis's rule (divide where the gradient is not narrow) applied to the finished
//! triangles, so that a sharp bend costs a few more of them instead of a finer grid. A new vertex
//! is on the same primitives as the divided edge. The surface between the ends of an edge is
//! estimated from the normals there: a chord e with the normals n and m at its ends is off the
//! middle of an arc by |e . (m - n)| / 8.

use super::assemble::Assembled;
use super::crossing::{bin_of, bins, crossings};
use super::grid::Grid;
use super::types::FacetBlock;
use super::vertex::{Solver, Surfaces};
use crate::expr::tape::ExprTape;
use crate::set::Leaf;
use moldloft_budget::{Budget, Spent};
use moldloft_num::union_find::UnionFind;
use moldloft_num::{Box3, Vec3};
use moldloft_parallel::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};
use smallvec::SmallVec;
use std::sync::Arc;

/// When an edge is divided.
#[derive(Clone, Copy, Debug)]
pub(super) struct RefinementRule {
    /// The least cosine between the normals at its ends.
    pub(super) turn: f64,
    /// Maximum distance of its middle from the surface.
    pub(super) accuracy: f64,
    /// Edges up to this long are left as they are.
    pub(super) shortest: f64,
    /// Vertices are on their surfaces to this.
    pub(super) goal: f64,
    /// A bend that is cut off by less than this is not.
    pub(super) slack: f64,
}

/// Number of passes; each divides the distance of the edges' midpoints by four.
const PASSES: usize = 6;
/// Number of repetitions, with vertices of intersecting triangles locked.
const TRIES: usize = 3;
/// A new vertex is at most this part of its edge away from it, or the part that a corner between the normals at
/// its ends is, …
const AWAY: f64 = 0.35;
/// … but no more than this.
const FARTHEST: f64 = 1.2;
/// The least cosine between a triangle and the mean of the surface's normals at its corners.
const FACING: f64 = 0.2;
/// Minimum height of a triangle after a flip, relative to its longest side.
const THIN: f64 = 0.05;
/// An edge between whose ends the normal still turns by more than this cosine says nothing of the surface there.
const SHARPEST: f64 = -0.2;
/// A diagonal is turned when the squares of distances fall below this part.
const GAIN: f64 = 0.9;

/// The set as it is near a point: the whole one costs as much as it has primitives.
pub(super) struct Tapes<'a> {
    grid: &'a Grid,
    at: FxHashMap<[u32; 3], &'a ExprTape<f64>>,
    whole: &'a ExprTape<f64>,
}

impl<'a> Tapes<'a> {
    pub(super) fn new(
        grid: &'a Grid,
        blocks: &'a [(Arc<ExprTape<f64>>, Arc<FacetBlock>)],
        whole: &'a ExprTape<f64>,
    ) -> Self {
        Self { grid, at: blocks.iter().map(|(tape, b)| (b.at, &**tape)).collect(), whole }
    }

    /// Tapes of the blocks with surface for which `which` holds.
    pub(super) fn those(
        &self,
        which: impl Fn(&ExprTape<f64>) -> bool,
    ) -> FxHashMap<[u32; 3], &'a ExprTape<f64>> {
        self.at.iter().filter(|(_, tape)| which(tape)).map(|(at, tape)| (*at, *tape)).collect()
    }

    pub(super) fn at(&self, p: Vec3) -> &ExprTape<f64> {
        self.at.get(&self.grid.block_of(p)).copied().unwrap_or(self.whole)
    }
}

type Corner = [u32; 3];
/// Unit normals, one for each of a vertex's surfaces.
pub(super) type Normals = SmallVec<[Vec3; 1]>;

/// Unit normals of its surfaces at each vertex; zero if undefined.
pub(super) fn normals(
    positions: &[Vec3],
    surfaces: &[SmallVec<[u32; 3]>],
    leaves: &[Leaf],
) -> Vec<Normals> {
    positions
        .par_iter()
        .zip(surfaces)
        .map_init(Solver::default, |solver, (p, on)| {
            on.iter().map(|&leaf| normal(solver, leaves, leaf, *p)).collect()
        })
        .collect()
}

fn normal(solver: &mut Solver, leaves: &[Leaf], leaf: u32, p: Vec3) -> Vec3 {
    let slope = solver.gradient(leaves[leaf as usize].primitive.tape(), p).slope;
    let size = slope.norm();
    if size > 0.0 && size.is_finite() { slope / size } else { Vec3::zero() }
}

fn key(a: u32, b: u32) -> (u32, u32) {
    (a.min(b), a.max(b))
}

struct Refiner<'a> {
    rule: RefinementRule,
    leaves: &'a [Leaf],
    tapes: &'a Tapes<'a>,
    positions: Vec<Vec3>,
    surfaces: Vec<Surfaces>,
    normals: Vec<Normals>,
    triangles: Vec<(u32, Corner)>,
    /// The triangles beside the edges near bends.
    edges: FxHashMap<(u32, u32), SmallVec<[u32; 2]>>,
    /// Vertices beside which nothing is changed.
    locked: Vec<bool>,
    /// The connected part that a vertex is in; parts are independent of each other. [`NO_PART`] for
    /// unchanged vertices.
    parts: Vec<u32>,
    changed: Vec<u32>,
    solver: Solver,
}

impl Refiner<'_> {
    fn at(&self, v: u32) -> Vec3 {
        self.positions[v as usize]
    }

    fn normal(&self, v: u32, leaf: u32) -> Option<Vec3> {
        let k = self.surfaces[v as usize].iter().position(|&s| s == leaf)?;
        let n = self.normals[v as usize][k];
        (n != Vec3::zero()).then_some(n)
    }

    /// Distance of the middle of an edge from the surface, if it has to be divided.
    fn wanting(&self, leaf: u32, a: u32, b: u32) -> Option<f64> {
        let (n, m) = (self.normal(a, leaf)?, self.normal(b, leaf)?);
        let chord = self.at(b) - self.at(a);
        let away = chord.dot(m - n).abs() / 8.0;
        let long = chord.norm_sq() > self.rule.shortest * self.rule.shortest;
        let bent = n.dot(m) < self.rule.turn && away > 1e-3 * chord.norm();
        (long && (bent || away > self.rule.accuracy)).then_some(away)
    }

    /// The square of the distance of a triangle's centre from the surface: that of three points of a
    /// parabola from their mean.
    fn distance_sq(&self, leaf: u32, t: Corner) -> Option<f64> {
        let mut sum = 0.0;
        for k in 0..3 {
            let (a, b) = (t[k], t[(k + 1) % 3]);
            sum += (self.at(b) - self.at(a)).dot(self.normal(b, leaf)? - self.normal(a, leaf)?);
        }
        Some((sum / 18.0).powi(2))
    }

    /// The cosine between a triangle and the mean of the surface's normals at its corners.
    fn facing([a, b, c]: [Vec3; 3], normals: [Option<Vec3>; 3]) -> f64 {
        let n = (b - a).cross(c - a);
        let mut mean = Vec3::zero();
        normals.into_iter().flatten().for_each(|m| mean += m);
        let size = n.norm() * mean.norm();
        if size == 0.0 { -1.0 } else { n.dot(mean) / size }
    }

    /// Depth of a corner between the normals at the ends of an edge, relative to its length, and a
    /// margin: tan(phi / 2) / 2 for a turn by phi.
    fn depth(&self, leaf: u32, a: u32, b: u32) -> f64 {
        let (Some(n), Some(m)) = (self.normal(a, leaf), self.normal(b, leaf)) else { return 0.0 };
        let cos = n.dot(m);
        let half = ((1.0 - cos) / (1.0 + cos).max(1e-9)).max(0.0).sqrt();
        (0.05 + 0.5 * half).min(FARTHEST)
    }

    fn facing_of(&self, leaf: u32, t: Corner) -> f64 {
        Self::facing(t.map(|v| self.at(v)), t.map(|v| self.normal(v, leaf)))
    }

    /// The middle of a triangle, when that of a quadratic one through the middles of its sides is not on the surface; that of a side
    /// about which the surface turns too far.
    fn cut_off(&mut self, t: u32) -> Option<Vec3> {
        let (leaf, corners) = self.triangles[t as usize];
        let side = |k: usize| (corners[k], corners[(k + 1) % 3]);
        let bent = |(a, b): (u32, u32)| match (self.normal(a, leaf), self.normal(b, leaf)) {
            (Some(n), Some(m)) => n.dot(m) < self.rule.turn,
            _ => false,
        };
        if !(0..3).any(|k| bent(side(k))) {
            return None;
        }
        let sharpest = |(a, b): (u32, u32)| match (self.normal(a, leaf), self.normal(b, leaf)) {
            (Some(n), Some(m)) => n.dot(m) < SHARPEST,
            _ => false,
        };
        if let Some((a, b)) = (0..3).map(side).find(|&ab| sharpest(ab)) {
            return Some((self.at(a) + self.at(b)) * 0.5);
        }
        let mut patch = Vec3::zero();
        for k in 0..3 {
            let (a, b) = side(k);
            let (p, q) = (self.at(a), self.at(b));
            let other = |s: &u32| *s != leaf && self.surfaces[b as usize].contains(s);
            let mut on: Surfaces =
                self.surfaces[a as usize].iter().copied().filter(other).take(1).collect();
            on.push(leaf);
            on.sort_unstable();
            let (chord, away) = ((p + q) * 0.5, AWAY * p.distance(q));
            let reach = Vec3::of(away, away, away);
            let around = Box3 { low: chord - reach, high: chord + reach };
            let placed = self.solver.place(self.leaves, &on, chord, &around, self.rule.goal);
            let middle = if placed.residual <= self.rule.goal { placed.point } else { chord };
            patch += middle * (4.0 / 9.0) - p * (1.0 / 9.0);
        }
        let g = self.solver.gradient(self.leaves[leaf as usize].primitive.tape(), patch);
        let near = g.value.abs() <= self.rule.slack * g.slope.norm();
        (!near).then_some(patch)
    }

    fn collect_edges(&mut self, near: &[u32]) {
        for &t in near {
            let corners = self.triangles[t as usize].1;
            for k in 0..3 {
                let beside = self.edges.entry(key(corners[k], corners[(k + 1) % 3])).or_default();
                beside.push(t);
            }
        }
    }

    /// The edge's triangles, first the one with the direction from `a` to `b`, with their tips.
    fn beside(&self, (a, b): (u32, u32)) -> Option<[(u32, u32); 2]> {
        let pair = self.edges.get(&(a, b))?;
        let [s, t] = pair[..] else { return None };
        let tip = |t: u32| {
            let corners = self.triangles[t as usize].1;
            let k = corners.iter().position(|&v| v == a)?;
            let forward = corners[(k + 1) % 3] == b;
            Some((forward, corners.into_iter().find(|&v| v != a && v != b)?))
        };
        let ((f, c), (g, d)) = (tip(s)?, tip(t)?);
        match (f, g) {
            (true, false) => Some([(s, c), (t, d)]),
            (false, true) => Some([(t, d), (s, c)]),
            _ => None,
        }
    }

    fn moved(&mut self, edge: (u32, u32), from: u32, to: u32) {
        if let Some(slot) =
            self.edges.get_mut(&edge).and_then(|p| p.iter_mut().find(|t| **t == from))
        {
            *slot = to;
        }
    }

    /// Divides an edge, unless the new vertex would not do.
    fn divide(&mut self, (a, b): (u32, u32)) -> bool {
        let Some([(s, c), (t, d)]) = self.beside((a, b)) else { return false };
        if [a, b, c, d].iter().any(|&v| self.locked[v as usize]) {
            return false;
        }
        let pair = [s, t].map(|x| self.triangles[x as usize].0);
        let mut on = Surfaces::from_slice(&pair);
        on.sort_unstable();
        on.dedup();
        let (p, q) = (self.at(a), self.at(b));
        let (middle, length) = ((p + q) * 0.5, p.distance(q));
        let away =
            length * pair.map(|leaf| self.depth(leaf, a, b)).into_iter().fold(AWAY, f64::max);
        let reach = Vec3::of(away, away, away);
        let around = Box3 { low: middle - reach, high: middle + reach };
        let placed = self.solver.place(self.leaves, &on, middle, &around, self.rule.goal);
        if placed.residual > self.rule.goal || placed.point.distance(middle) > away {
            return false;
        }
        let point = placed.point;
        // Another primitive may cut off the point.
        let slope = self.solver.gradient(self.leaves[on[0] as usize].primitive.tape(), point).slope;
        if self.solver.value(self.tapes.at(point), point).abs()
            > 10.0 * self.rule.goal * slope.norm()
        {
            return false;
        }
        let found: Normals =
            on.iter().map(|&leaf| normal(&mut self.solver, self.leaves, leaf, point)).collect();
        for (tip, leaf, forward) in [(c, pair[0], true), (d, pair[1], false)] {
            let Some(k) = on.iter().position(|&x| x == leaf) else { return false };
            let old = self.facing_of(leaf, if forward { [a, b, tip] } else { [b, a, tip] });
            let least = FACING.min(old);
            let (x, y) = if forward { (a, b) } else { (b, a) };
            for [u, v] in [[Some(x), None], [None, Some(y)]] {
                let at = |w: Option<u32>| w.map_or(point, |w| self.at(w));
                let of = |w: Option<u32>| match w {
                    Some(w) => self.normal(w, leaf),
                    None => Some(found[k]),
                };
                let points = [at(u), at(v), self.at(tip)];
                if Self::facing(points, [of(u), of(v), self.normal(tip, leaf)]) < least {
                    return false;
                }
            }
        }
        let m = self.positions.len() as u32;
        self.positions.push(point);
        self.surfaces.push(on);
        self.normals.push(found);
        self.locked.push(false);
        self.parts.push(self.parts[a as usize]);
        let (s2, t2) = (self.triangles.len() as u32, self.triangles.len() as u32 + 1);
        self.triangles[s as usize].1 = [a, m, c];
        self.triangles[t as usize].1 = [m, a, d];
        self.triangles.push((pair[0], [m, b, c]));
        self.triangles.push((pair[1], [b, m, d]));
        self.edges.remove(&key(a, b));
        self.moved(key(b, c), s, s2);
        self.moved(key(b, d), t, t2);
        self.edges.insert(key(a, m), SmallVec::from_slice(&[s, t]));
        self.edges.insert(key(m, b), SmallVec::from_slice(&[s2, t2]));
        self.edges.insert(key(m, c), SmallVec::from_slice(&[s, s2]));
        self.edges.insert(key(m, d), SmallVec::from_slice(&[t, t2]));
        self.changed.extend([s, t, s2, t2]);
        true
    }

    /// Turns the diagonal of the two triangles beside an edge when that brings them nearer to the surface.
    fn turn(&mut self, (a, b): (u32, u32)) -> bool {
        let Some([(s, c), (t, d)]) = self.beside((a, b)) else { return false };
        let leaf = self.triangles[s as usize].0;
        let locked = [a, b, c, d].iter().any(|&v| self.locked[v as usize]);
        if locked || self.triangles[t as usize].0 != leaf || self.edges.contains_key(&key(c, d)) {
            return false;
        }
        let (old, new) = ([[a, b, c], [b, a, d]], [[a, d, c], [d, b, c]]);
        let sum = |pair: [Corner; 2]| {
            Some(self.distance_sq(leaf, pair[0])? + self.distance_sq(leaf, pair[1])?)
        };
        let (Some(before), Some(after)) = (sum(old), sum(new)) else { return false };
        if after >= GAIN * before {
            return false;
        }
        let facing = |pair: [Corner; 2]| {
            pair.map(|t| self.facing_of(leaf, t)).into_iter().fold(1.0, f64::min)
        };
        let fits = |t: Corner| {
            let [p, q, r] = t.map(|v| self.at(v));
            let sides = [(q - p).norm_sq(), (r - q).norm_sq(), (p - r).norm_sq()];
            let longest = sides.into_iter().fold(0.0, f64::max);
            (q - p).cross(r - p).norm() >= THIN * longest
        };
        if facing(new) < FACING.max(facing(old) - 0.1) || !new.into_iter().all(fits) {
            return false;
        }
        self.triangles[s as usize].1 = new[0];
        self.triangles[t as usize].1 = new[1];
        self.edges.remove(&key(a, b));
        self.moved(key(a, d), t, s);
        self.moved(key(b, c), s, t);
        self.edges.insert(key(c, d), SmallVec::from_slice(&[s, t]));
        self.changed.extend([s, t]);
        true
    }

    /// The edges of these triangles that have to be divided, the worst first.
    fn wanted(&self, triangles: &[u32]) -> Vec<(u32, u32)> {
        let mut found: Vec<(f64, (u32, u32))> = Vec::new();
        for &t in triangles {
            let (leaf, corners) = self.triangles[t as usize];
            for k in 0..3 {
                let edge = key(corners[k], corners[(k + 1) % 3]);
                found.extend(self.wanting(leaf, edge.0, edge.1).map(|away| (away, edge)));
            }
        }
        found.sort_by(|x, y| y.0.total_cmp(&x.0).then(x.1.cmp(&y.1)));
        let mut seen = FxHashSet::default();
        found.into_iter().map(|f| f.1).filter(|e| seen.insert(*e)).collect()
    }

    /// All passes over these triangles.
    fn run(&mut self, near: &[u32], budget: &Budget) -> Result<(), Spent> {
        let mut front = near.to_vec();
        for _ in 0..PASSES {
            let start = self.changed.len();
            for edge in self.wanted(&front) {
                self.divide(edge);
            }
            // A flip depends only on its two triangles: unchanged pairs need no second test.
            let mut from = start;
            for _ in 0..4 {
                // A triangle is named as often as it was changed.
                let mut changed = self.changed[from..].to_vec();
                changed.sort_unstable();
                changed.dedup();
                // Memory of edges and of the new triangles.
                budget.poll()?;
                budget.grow((24 * changed.len() + 16 * self.triangles.len()) as u64)?;
                from = self.changed.len();
                let mut edges: Vec<(u32, u32)> = changed
                    .iter()
                    .flat_map(|&t| {
                        let c = self.triangles[t as usize].1;
                        [key(c[0], c[1]), key(c[1], c[2]), key(c[2], c[0])]
                    })
                    .collect();
                edges.sort_unstable();
                edges.dedup();
                if edges.into_iter().filter(|&e| self.turn(e)).count() == 0 {
                    break;
                }
            }
            front = self.changed[start..].to_vec();
            front.sort_unstable();
            front.dedup();
            if front.is_empty() {
                break;
            }
        }
        Ok(())
    }
}

/// Divides the edges that need it, unless triangles would then intersect. Returns positions of
/// bends that remain cut off.
///
/// # Errors
/// [`Spent`].
pub(super) fn refine(
    made: &mut Assembled,
    leaves: &[Leaf],
    tapes: &Tapes,
    rule: RefinementRule,
    budget: &Budget,
) -> Result<Vec<Vec3>, Spent> {
    let mut cut_off = Vec::new();
    let normals = normals(&made.positions, &made.surfaces, leaves);
    let mut work = Refiner {
        rule,
        leaves,
        tapes,
        positions: std::mem::take(&mut made.positions),
        surfaces: std::mem::take(&mut made.surfaces),
        normals,
        triangles: std::mem::take(&mut made.triangles),
        edges: FxHashMap::default(),
        locked: Vec::new(),
        parts: Vec::new(),
        changed: Vec::new(),
        solver: Solver::default(),
    };
    // The triangles at bends, and two rings about them.
    let bent =
        |t: &(u32, Corner)| (0..3).any(|k| work.wanting(t.0, t.1[k], t.1[(k + 1) % 3]).is_some());
    let mut chosen: Vec<bool> = work.triangles.par_iter().map(bent).collect();
    if chosen.contains(&true) {
        let mut touched = vec![false; work.positions.len()];
        for _ in 0..2 {
            for ((_, t), _) in work.triangles.iter().zip(&chosen).filter(|c| *c.1) {
                t.iter().for_each(|&v| touched[v as usize] = true);
            }
            for ((_, t), chosen) in work.triangles.iter().zip(&mut chosen) {
                *chosen |= t.iter().any(|&v| touched[v as usize]);
            }
        }
        // The edges about a vertex are known when all its triangles are among them.
        let mut rim = vec![false; work.positions.len()];
        for ((_, t), _) in work.triangles.iter().zip(&chosen).filter(|c| !c.1) {
            t.iter().for_each(|&v| rim[v as usize] = true);
        }
        let near: Vec<u32> = (0..chosen.len() as u32).filter(|&t| chosen[t as usize]).collect();
        attempt(&mut work, &near, rim, budget)?;
        let new = chosen.len() as u32..work.triangles.len() as u32;
        for t in near.into_iter().chain(new) {
            cut_off.extend(work.cut_off(t));
        }
    }
    made.positions = work.positions;
    made.surfaces = work.surfaces;
    made.triangles = work.triangles;
    Ok(cut_off)
}

/// Points in bins as wide as the search radius.
struct PointsByPlace {
    reach: f64,
    bins: FxHashMap<[i64; 3], Vec<Vec3>>,
}

impl PointsByPlace {
    fn new(points: impl Iterator<Item = Vec3>, reach: f64) -> Self {
        let mut bins: FxHashMap<[i64; 3], Vec<Vec3>> = FxHashMap::default();
        for p in points {
            bins.entry(bin_of(p, reach)).or_default().push(p);
        }
        Self { reach, bins }
    }

    fn any_within_reach(&self, p: Vec3) -> bool {
        let reach = Vec3::of(self.reach, self.reach, self.reach);
        bins(&Box3 { low: p - reach, high: p + reach }, self.reach).any(|bin| {
            let here = self.bins.get(&bin).into_iter().flatten();
            here.into_iter().any(|m| m.distance(p) <= self.reach)
        })
    }
}

/// The part of a vertex beside which nothing is changed.
const NO_PART: u32 = u32::MAX;

/// The parts in which vertices are that triangles join, but for those that are kept.
fn parts(triangles: impl Iterator<Item = Corner>, kept: &[bool]) -> Vec<u32> {
    let mut joined = UnionFind::new(kept.len());
    for t in triangles {
        let mut free = t.into_iter().filter(|&v| !kept[v as usize]);
        let Some(first) = free.next() else { continue };
        free.for_each(|v| joined.join(first, v));
    }
    let part = |(v, kept): (usize, &bool)| if *kept { NO_PART } else { joined.find(v as u32) };
    kept.iter().enumerate().map(part).collect()
}

impl Refiner<'_> {
    /// The part of the surface that a triangle is in.
    fn part(&self, corners: Corner) -> Option<u32> {
        corners.into_iter().map(|v| self.parts[v as usize]).find(|&p| p != NO_PART)
    }

    /// Restores parts to the given triangles and number of vertices.
    fn revert(&mut self, parts: &FxHashSet<u32>, old: &[(u32, Corner)], count: usize) {
        let gone = |v: usize| v >= count && parts.contains(&self.parts[v]);
        let gone: Vec<bool> = (0..self.positions.len()).map(gone).collect();
        let mut number: Vec<u32> = Vec::with_capacity(gone.len());
        let mut kept = 0;
        for gone in &gone {
            number.push(kept);
            kept += u32::from(!gone);
        }
        let mut triangles = Vec::with_capacity(self.triangles.len());
        for (k, &(leaf, corners)) in self.triangles.iter().enumerate() {
            if !self.part(corners).is_some_and(|part| parts.contains(&part)) {
                triangles.push((leaf, corners.map(|v| number[v as usize])));
            } else if let Some(&before) = old.get(k) {
                triangles.push(before);
            }
        }
        self.triangles = triangles;
        fn keep<T>(all: &mut Vec<T>, gone: &[bool]) {
            let mut gone = gone.iter();
            all.retain(|_| gone.next() == Some(&false));
        }
        keep(&mut self.positions, &gone);
        keep(&mut self.surfaces, &gone);
        keep(&mut self.normals, &gone);
        keep(&mut self.parts, &gone);
    }
}

/// All passes. If changed triangles intersect others, that part of the surface is repeated with
/// their surroundings locked, and restored if that does not help. Nothing changes beside `kept`
/// vertices.
fn attempt(
    work: &mut Refiner,
    near: &[u32],
    mut kept: Vec<bool>,
    budget: &Budget,
) -> Result<(), Spent> {
    let count = work.positions.len();
    let old: Vec<(u32, Corner)> = work.triangles.clone();
    work.parts = parts(near.iter().map(|&t| old[t as usize].1), &kept);
    let mut near = near.to_vec();
    for _ in 0..TRIES {
        work.edges.clear();
        work.changed.clear();
        work.locked.clone_from(&kept);
        work.locked.resize(work.positions.len(), false);
        work.collect_edges(&near);
        work.run(&near, budget)?;
        budget.poll()?;
        let mut flagged = vec![false; work.triangles.len()];
        work.changed.iter().for_each(|&t| flagged[t as usize] = true);
        let corner = |f: usize| work.triangles[f].1;
        let cut = crossings(&work.positions, work.triangles.len(), corner, Some(&flagged));
        if cut.is_empty() {
            break;
        }
        // Changed vertices there, and their neighbours, are locked in the next attempt.
        let cut: Vec<Corner> = cut.into_iter().flatten().map(corner).collect();
        // About two cells.
        let reach = 10.0 * work.rule.shortest;
        let marks = PointsByPlace::new(cut.iter().map(|c| work.at(c[0])), reach);
        for (p, lock) in work.positions.iter().zip(&mut kept) {
            *lock = *lock || marks.any_within_reach(*p);
        }
        let again: FxHashSet<u32> = cut.iter().filter_map(|c| work.part(*c)).collect();
        work.revert(&again, &old, count);
        near.retain(|&t| work.part(old[t as usize].1).is_some_and(|part| again.contains(&part)));
    }
    Ok(())
}
