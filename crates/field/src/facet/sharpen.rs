//! Edges that a vertex cuts off, put back into the triangles round it.
//!
//! Around a vertex that is not on all the surfaces of its triangles, those of a missing surface are
//! a sector of the ring. They are detached from the vertex: the edge of the body is then between
//! the first and the last vertex of the sector, if both are on the adjacent surfaces, or over a new
//! vertex on the edge or in the corner of these surfaces. This is done only if the number of
//! intersecting and folded triangles does not increase.

use super::assemble::{Assembled, NO_VERTEX};
use super::grid::Grid;
use super::refine::Tapes;
use super::unfold::{Change, Corners, FoldedRegion, RINGS};
use super::vertex::Surfaces;
use crate::set::Leaf;
use moldloft_num::{Box3, Vec3};
use smallvec::SmallVec;

/// Maximum number of passes over all vertices.
const ROUNDS: usize = 4;
/// Maximum distance of a new vertex, in cells.
const AWAY: f64 = 1.5;
/// Maximum distance of the edge from the middle of the side that represents it, relative to the
/// length.
const BEND: f64 = 0.35;
/// An edge or corner nearer than this part of a cell is not cut off.
const NEAR: f64 = 0.01;

/// Triangles about a vertex that are on one surface.
struct Sector {
    leaf: u32,
    /// Their numbers, …
    triangles: Vec<usize>,
    /// … and the vertices round them.
    rim: Vec<u32>,
}

struct Sharpener<'a, 'm> {
    folds: FoldedRegion<'m>,
    tapes: &'a Tapes<'a>,
    grid: &'a Grid,
}

/// Puts edges back where they are cut off, and strikes out the cells in which that is done.
pub(super) fn sharpen(made: &mut Assembled, grid: &Grid, leaves: &[Leaf], tapes: &Tapes) {
    let seeds: Vec<u32> = made.blunt.iter().map(|b| b.0).filter(|&v| v != NO_VERTEX).collect();
    if seeds.is_empty() {
        return;
    }
    let mut work =
        Sharpener { folds: FoldedRegion::about(made, leaves, &seeds, RINGS), tapes, grid };
    let mut open = seeds;
    open.sort_unstable();
    open.dedup();
    let mut sharp: Vec<u32> = Vec::new();
    for _ in 0..ROUNDS {
        let before = open.len();
        let mut changed = false;
        open.retain(|&v| {
            while work.vertex(v) {
                changed = true;
            }
            let done = work.wanting(v).is_none();
            if done {
                sharp.push(v);
            }
            !done
        });
        if !changed && open.len() == before {
            break;
        }
    }
    work.folds.done(grid);
    sharp.sort_unstable();
    made.blunt.retain(|b| sharp.binary_search(&b.0).is_err());
}

impl Sharpener<'_, '_> {
    /// Sectors around a vertex in the order of its ring; `None` without a ring.
    fn sectors(&self, v: u32) -> Option<Vec<Sector>> {
        let folds = &self.folds;
        let all = folds.round.get(&v)?;
        let first = *all.first()?;
        // From the second corner of each triangle to its third, with the vertex first.
        let turned = |t: usize| {
            let c = folds.made.triangles[t].1;
            let k = c.iter().position(|&x| x == v)?;
            Some([c[(k + 1) % 3], c[(k + 2) % 3]])
        };
        let mut ring = vec![first];
        let mut rim = vec![turned(first)?[0]];
        loop {
            let end = turned(*ring.last()?)?[1];
            if end == rim[0] {
                break;
            }
            rim.push(end);
            let next = folds.beside(v, end)?.0;
            if ring.contains(&next) || ring.len() > all.len() {
                return None;
            }
            ring.push(next);
        }
        if ring.len() != all.len() {
            return None;
        }
        let n = ring.len();
        let leaf = |k: usize| folds.made.triangles[ring[k % n]].0;
        let Some(start) = (0..n).find(|&k| leaf(k) != leaf(k + n - 1)) else {
            return Some(Vec::new());
        };
        let mut sectors: Vec<Sector> = Vec::new();
        for k in start..start + n {
            let (t, p, q) = (ring[k % n], rim[k % n], rim[(k + 1) % n]);
            match sectors.last_mut().filter(|s| s.leaf == leaf(k)) {
                Some(sector) => {
                    sector.triangles.push(t);
                    sector.rim.push(q);
                }
                None => sectors.push(Sector { leaf: leaf(k), triangles: vec![t], rim: vec![p, q] }),
            }
        }
        Some(sectors)
    }

    /// A surface that a vertex's triangles show and that it is not on.
    fn wanting(&mut self, v: u32) -> Option<u32> {
        let all = self.folds.round.get(&v)?.clone();
        let slack = NEAR * self.grid.step;
        let p = self.folds.at(v);
        for t in all {
            let leaf = self.folds.made.triangles[t].0;
            if !self.folds.on(v, leaf) {
                let tape = self.folds.leaves[leaf as usize].primitive.tape();
                let g = self.folds.solver.gradient(tape, p);
                let near = g.value.abs() <= slack * g.slope.norm();
                if !near {
                    return Some(leaf);
                }
            }
        }
        None
    }

    /// Detaches one sector from a vertex; false if none can be.
    fn vertex(&mut self, v: u32) -> bool {
        if self.wanting(v).is_none() {
            return false;
        }
        let Some(sectors) = self.sectors(v) else { return false };
        let n = sectors.len();
        for k in 0..n {
            let sector = &sectors[k];
            if self.folds.on(v, sector.leaf) {
                continue;
            }
            let beside = [sectors[(k + n - 1) % n].leaf, sectors[(k + 1) % n].leaf];
            let ends = [sector.rim[0], sector.rim[sector.rim.len() - 1]];
            let fits = |k: usize| {
                self.folds.on(v, beside[k])
                    && self.folds.on(ends[k], beside[k])
                    && self.folds.on(ends[k], sector.leaf)
            };
            if !(fits(0) && fits(1)) || ends[0] == ends[1] {
                continue;
            }
            if beside[0] == beside[1] && self.along(v, sector, beside[0]) {
                return true;
            }
            if self.over(v, sector, beside) {
                return true;
            }
        }
        false
    }

    fn point_on(&mut self, on: &Surfaces, start: Vec3, away: f64) -> Option<Vec3> {
        let reach = Vec3::of(away, away, away);
        let around = Box3 { low: start - reach, high: start + reach };
        let goal = self.grid.goal;
        let placed = self.folds.solver.place(self.folds.leaves, on, start, &around, goal);
        if placed.residual > goal {
            return None;
        }
        // Another primitive may cut off the point.
        let point = placed.point;
        let tape = self.folds.leaves[on[0] as usize].primitive.tape();
        let slope = self.folds.solver.gradient(tape, point).slope.norm();
        let value = self.folds.solver.value(self.tapes.at(point), point);
        (value.abs() <= 10.0 * goal * slope).then_some(point)
    }

    /// The edge connects the first vertex of the sector with its last.
    fn along(&mut self, v: u32, sector: &Sector, beside: u32) -> bool {
        let (p, q) = (sector.rim[0], sector.rim[sector.rim.len() - 1]);
        let [a, b] = [p, q].map(|x| self.folds.at(x));
        let length = a.distance(b);
        let mut on = Surfaces::from_slice(&[beside, sector.leaf]);
        on.sort_unstable();
        let Some(middle) = self.point_on(&on, (a + b) * 0.5, BEND * length) else { return false };
        if middle.distance((a + b) * 0.5) > BEND * length {
            return false;
        }
        // The two may be joined elsewhere.
        let inner = sector.rim.len() - 2;
        if inner > 0 && self.folds.beside(p, q).or(self.folds.beside(q, p)).is_some() {
            return false;
        }
        let mut best: Option<(isize, Change)> = None;
        for apex in 0..sector.rim.len() {
            let mut made: SmallVec<[(usize, u32, Corners); 8]> = SmallVec::new();
            made.push((sector.triangles[0], beside, [v, p, q]));
            let hub = sector.rim[apex];
            let n = sector.rim.len();
            let mut slots = sector.triangles[1..].iter();
            for k in 0..n {
                let (x, y) = (sector.rim[k], sector.rim[(k + 1) % n]);
                if x != hub && y != hub && inner > 0 {
                    let Some(&slot) = slots.next() else { return false };
                    made.push((slot, sector.leaf, [hub, x, y]));
                }
            }
            let change = Change { made, gone: SmallVec::new() };
            self.better(change, &mut best);
        }
        self.take(best)
    }

    /// The edge has a new vertex.
    fn over(&mut self, v: u32, sector: &Sector, beside: [u32; 2]) -> bool {
        let mut on = Surfaces::from_slice(&[beside[0], beside[1], sector.leaf]);
        on.sort_unstable();
        on.dedup();
        let rim: Vec<Vec3> = sector.rim.iter().map(|&x| self.folds.at(x)).collect();
        let (a, b) = (rim[0], rim[rim.len() - 1]);
        let mut mean = Vec3::zero();
        rim.iter().for_each(|p| mean += *p);
        let starts = [self.folds.at(v), (a + b) * 0.5, mean / rim.len() as f64];
        let away = AWAY * self.grid.step;
        let mut points: Vec<Vec3> = Vec::new();
        for start in starts {
            let Some(point) = self.point_on(&on, start, away) else { continue };
            let new = |q: &Vec3| q.distance(point) > NEAR * self.grid.step;
            if points.iter().all(new) && rim.iter().all(new) {
                points.push(point);
            }
        }
        let m = self.folds.made.positions.len() as u32;
        let count = self.folds.made.triangles.len();
        for point in points {
            self.folds.made.positions.push(point);
            self.folds.made.surfaces.push(on.clone());
            self.folds.round.insert(m, Vec::new());
            let mut made: SmallVec<[(usize, u32, Corners); 8]> = SmallVec::new();
            for (k, &t) in sector.triangles.iter().enumerate() {
                made.push((t, sector.leaf, [m, sector.rim[k], sector.rim[k + 1]]));
            }
            let (p, q) = (sector.rim[0], sector.rim[sector.rim.len() - 1]);
            made.push((count, beside[0], [v, p, m]));
            made.push((count + 1, beside[1], [v, m, q]));
            let mut best = None;
            self.better(Change { made, gone: SmallVec::new() }, &mut best);
            if self.take(best) {
                return true;
            }
            self.folds.made.positions.pop();
            self.folds.made.surfaces.pop();
            self.folds.round.remove(&m);
            self.folds.forget(m);
        }
        false
    }

    fn better(&mut self, change: Change, best: &mut Option<(isize, Change)>) {
        let flat = |m: &(usize, u32, Corners)| self.folds.height(m.2) < 1e-4;
        if change.made.iter().any(flat) {
            return;
        }
        if let Some(gain) = self.folds.gain(&change, best.as_ref().map_or(-1, |b| b.0)) {
            *best = Some((gain, change));
        }
    }

    fn take(&mut self, best: Option<(isize, Change)>) -> bool {
        let Some((_, change)) = best else { return false };
        self.folds.apply(&change);
        true
    }
}
