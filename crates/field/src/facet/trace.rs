//! Edges of a set, followed from point to point: each on two surfaces, from corner to corner.
//!
//! The line of two surfaces is an edge of the set, convex or concave, by the solid in the four
//! sectors between the surfaces beside it. A change of these marks a corner, where another surface
//! passes.

use super::refine::Tapes;
use super::vertex::{Solver, Surfaces};
use crate::expr::tape::NO_LEAF;
use crate::set::Leaf;
use moldloft_num::{Box3, Vec3};
use smallvec::SmallVec;

/// Distance from the line at which sectors are tested, in cells, …
const ASIDE: f64 = 1e-5;
/// … where surfaces meet at an angle of more than this.
const TOUCH: f64 = 1e-2;
/// Distance from a corner at which its lines are tested, in cells.
const BEGIN: f64 = 1e-3;
/// Corners of the same surfaces nearer than this part of a cell are one.
const ONE: f64 = 1e-6;
/// The least cosine between the directions at the ends of a step.
const BENT: f64 = 0.96;
/// The most points of an edge, and edges of a region.
const MOST_POINTS: usize = 400;
const MOST_EDGES: usize = 300;

/// Solid sectors between two surfaces: where both are solid, or where one is.
#[derive(Clone, Copy, Debug, PartialEq)]
enum EdgeBend {
    Convex,
    Concave,
}

/// An edge at one of its ends.
#[derive(Clone, Copy, Debug)]
struct EdgeRay {
    /// Its surfaces, ascending.
    pair: [u32; 2],
    bend: EdgeBend,
    /// True when it leaves along the product of their normals.
    forward: bool,
    traced: bool,
}

/// An end of edges.
#[derive(Debug)]
pub(super) struct TraceNode {
    pub(super) point: Vec3,
    pub(super) surfaces: Surfaces,
    rays: SmallVec<[EdgeRay; 6]>,
}

/// An edge with the points between its ends.
#[derive(Debug)]
pub(super) struct TracedEdge {
    pub(super) ends: [usize; 2],
    pub(super) points: Vec<Vec3>,
    /// Surfaces on the left and on the right, seen from outside.
    pub(super) sides: [u32; 2],
}

pub(super) struct Tracer<'a> {
    pub(super) leaves: &'a [Leaf],
    pub(super) tapes: &'a Tapes<'a>,
    pub(super) goal: f64,
    /// Side of a cell.
    pub(super) cell: f64,
    /// Distance of points.
    pub(super) step: f64,
    /// Edges do not leave this.
    pub(super) within: Box3,
    pub(super) nodes: Vec<TraceNode>,
    pub(super) edges: Vec<TracedEdge>,
    pub(super) solver: Solver,
    registers: Vec<f64>,
}

impl<'a> Tracer<'a> {
    pub(super) fn new(
        leaves: &'a [Leaf],
        tapes: &'a Tapes<'a>,
        [goal, cell, step]: [f64; 3],
        within: Box3,
    ) -> Self {
        let (nodes, edges, registers) = (Vec::new(), Vec::new(), Vec::new());
        let solver = Solver::default();
        Self { leaves, tapes, goal, cell, step, within, nodes, edges, solver, registers }
    }

    pub(super) fn normal(&mut self, leaf: u32, p: Vec3) -> Option<Vec3> {
        let tape = self.leaves[leaf as usize].primitive.tape();
        let slope = self.solver.gradient(tape, p).slope;
        let size = slope.norm();
        (size > 0.0 && size.is_finite()).then(|| slope / size)
    }

    /// True if a point is on all the surfaces.
    pub(super) fn on(&mut self, p: Vec3, surfaces: &[u32]) -> bool {
        surfaces.iter().all(|&s| {
            let g = self.solver.gradient(self.leaves[s as usize].primitive.tape(), p);
            g.value.abs() <= 10.0 * self.goal * g.slope.norm()
        })
    }

    /// The value of the set.
    pub(super) fn value(&mut self, p: Vec3) -> f64 {
        self.tapes.at(p).eval::<f64>(&p, &mut self.registers)
    }

    fn put(&mut self, on: &[u32], start: Vec3, reach: f64) -> Option<Vec3> {
        let reach = Vec3::of(reach, reach, reach);
        let around = Box3 { low: start - reach, high: start + reach };
        let placed = self.solver.place(self.leaves, on, start, &around, self.goal);
        (placed.residual <= self.goal).then_some(placed.point)
    }

    /// The direction of the line of two surfaces.
    fn along(&mut self, p: Vec3, [a, b]: [u32; 2]) -> Option<Vec3> {
        let (n, m) = (self.normal(a, p)?, self.normal(b, p)?);
        let line = n.cross(m);
        let size = line.norm();
        (size > TOUCH).then(|| line / size)
    }

    /// Convexity of the line of two surfaces, if it is an edge.
    fn bend(&mut self, p: Vec3, [a, b]: [u32; 2]) -> Option<EdgeBend> {
        let (n, m) = (self.normal(a, p)?, self.normal(b, p)?);
        let c = n.dot(m);
        let det = n.cross(m).norm_sq();
        if det < TOUCH * TOUCH {
            return None;
        }
        let reach = ASIDE * self.cell / det;
        let (u, v) = ((n - m * c) * reach, (m - n * c) * reach);
        let mut solid = |q: Vec3| self.value(q) <= 0.0;
        match [solid(p - u - v), solid(p - u + v), solid(p + u - v), solid(p + u + v)] {
            [true, false, false, false] => Some(EdgeBend::Convex),
            [true, true, true, false] => Some(EdgeBend::Concave),
            _ => None,
        }
    }

    /// An end with one edge, on whose left the first of two surfaces shows; `None` if there is no such edge.
    pub(super) fn end(&mut self, point: Vec3, left: u32, right: u32) -> Option<usize> {
        let pair = [left.min(right), left.max(right)];
        let bend = self.bend(point, pair)?;
        let forward = (left == pair[0]) == (bend == EdgeBend::Convex);
        let ray = EdgeRay { pair, bend, forward, traced: false };
        let surfaces = Surfaces::from_slice(&pair);
        self.nodes.push(TraceNode { point, surfaces, rays: SmallVec::from_slice(&[ray]) });
        Some(self.nodes.len() - 1)
    }

    /// A point inside an edge, from which it is followed in both directions, unless it is on a
    /// known one.
    pub(super) fn amid(&mut self, point: Vec3, pair: [u32; 2]) {
        let known = |e: &TracedEdge| {
            let own = [e.sides[0].min(e.sides[1]), e.sides[0].max(e.sides[1])];
            let ends = e.ends.map(|k| self.nodes[k].point);
            let mut last = ends[0];
            own == pair
                && e.points.iter().chain([&ends[1]]).any(|&next| {
                    let near = from_side(point, last, next) < 0.2 * self.cell;
                    last = next;
                    near
                })
        };
        if self.edges.iter().any(known) {
            return;
        }
        let Some(bend) = self.bend(point, pair) else { return };
        let ray = |forward| EdgeRay { pair, bend, forward, traced: false };
        let rays = SmallVec::from_slice(&[ray(true), ray(false)]);
        self.nodes.push(TraceNode { point, surfaces: Surfaces::from_slice(&pair), rays });
    }

    /// Follows all edges; false when one is lost.
    pub(super) fn follow(&mut self) -> bool {
        let mut at = 0;
        while at < self.nodes.len() {
            match self.nodes[at].rays.iter().position(|r| !r.traced) {
                None => at += 1,
                Some(ray) => {
                    if self.edges.len() > MOST_EDGES || self.edge(at, ray).is_none() {
                        return false;
                    }
                }
            }
        }
        true
    }

    /// Follows one edge to its other end.
    fn edge(&mut self, from: usize, number: usize) -> Option<()> {
        let ray = self.nodes[from].rays[number];
        self.nodes[from].rays[number].traced = true;
        let EdgeRay { pair, bend, forward, .. } = ray;
        let sides = if (bend == EdgeBend::Convex) == forward { pair } else { [pair[1], pair[0]] };
        let mut points: Vec<Vec3> = Vec::new();
        let mut p = self.nodes[from].point;
        let to = loop {
            if points.len() > MOST_POINTS {
                return None;
            }
            let t = self.along(p, pair)?;
            let t = if forward { t } else { -t };
            if let Some(end) = self.arrives(p, t, &ray, (from, points.len())) {
                break end;
            }
            let q = self.next(p, t, &ray)?;
            let half = self.put(&pair, (p + q) * 0.5, 0.3 * p.distance(q))?;
            let stops = [half, q].into_iter().find(|x| self.bend(*x, pair) != Some(bend));
            if let Some(stop) = stops {
                let end = self.corner(p, stop, &ray)?;
                let back = |r: &EdgeRay| {
                    r.pair == pair && r.bend == bend && r.forward != forward && !r.traced
                };
                let back = self.nodes[end].rays.iter().position(back)?;
                self.nodes[end].rays[back].traced = true;
                break end;
            }
            let inside = (0..3).all(|k| self.within.low[k] <= q[k] && q[k] <= self.within.high[k]);
            if !inside {
                return None;
            }
            points.push(q);
            p = q;
        };
        self.edges.push(TracedEdge { ends: [from, to], points, sides });
        Some(())
    }

    fn next(&mut self, p: Vec3, t: Vec3, ray: &EdgeRay) -> Option<Vec3> {
        let mut step = self.step;
        for _ in 0..8 {
            if let Some(q) = self.put(&ray.pair, p + t * step, 0.5 * step)
                && let Some(u) = self.along(q, ray.pair)
            {
                let u = if ray.forward { u } else { -u };
                let chord = q - p;
                if chord.dot(t) > 0.5 * step && t.dot(u) > BENT {
                    return Some(q);
                }
            }
            step *= 0.5;
        }
        None
    }

    /// The end that an edge comes to next.
    fn arrives(
        &mut self,
        p: Vec3,
        t: Vec3,
        ray: &EdgeRay,
        (from, count): (usize, usize),
    ) -> Option<usize> {
        let mut best: Option<(f64, usize, usize)> = None;
        for (k, node) in self.nodes.iter().enumerate() {
            if k == from && count < 3 {
                continue;
            }
            let ahead = node.point - p;
            let far = ahead.norm();
            if far > 1.3 * self.step || ahead.dot(t) < 0.9 * far || far == 0.0 {
                continue;
            }
            let back = |r: &EdgeRay| {
                r.pair == ray.pair && r.bend == ray.bend && r.forward != ray.forward && !r.traced
            };
            if let Some(back) = node.rays.iter().position(back)
                && best.is_none_or(|b| far < b.0)
            {
                best = Some((far, k, back));
            }
        }
        let (far, node, back) = best?;
        for part in [0.25, 0.5, 0.75] {
            let middle = p + (self.nodes[node].point - p) * part;
            let q = self.put(&ray.pair, middle, 0.2 * far)?;
            if q.distance(middle) > 0.1 * far || self.bend(q, ray.pair) != Some(ray.bend) {
                return None;
            }
        }
        self.nodes[node].rays[back].traced = true;
        Some(node)
    }

    /// The corner between a point of an edge and one beyond its end.
    fn corner(&mut self, p: Vec3, stop: Vec3, ray: &EdgeRay) -> Option<usize> {
        let (mut low, mut high) = (p, stop);
        for _ in 0..40 {
            let far = low.distance(high);
            if far < ASIDE * self.cell {
                break;
            }
            let middle = self.put(&ray.pair, (low + high) * 0.5, 0.5 * far)?;
            match self.bend(middle, ray.pair) == Some(ray.bend) {
                true => low = middle,
                false => high = middle,
            }
        }
        let mut others: Vec<u32> = self.tapes.at(low).leaf.clone();
        others.extend(&self.tapes.at(high).leaf);
        others.sort_unstable();
        others.dedup();
        let mut best: Option<(f64, Vec3, Surfaces)> = None;
        for other in others.into_iter().filter(|l| *l != NO_LEAF && !ray.pair.contains(l)) {
            let mut on = Surfaces::from_slice(&[ray.pair[0], ray.pair[1], other]);
            on.sort_unstable();
            let Some(point) = self.put(&on, low, 0.1 * self.cell) else { continue };
            let far = point.distance(low);
            if best.as_ref().is_none_or(|b| far < b.0) {
                best = Some((far, point, on));
            }
        }
        let (_, point, on) = best?;
        let same = |n: &TraceNode| n.surfaces == on && n.point.distance(point) < ONE * self.cell;
        if let Some(known) = self.nodes.iter().position(same) {
            return Some(known);
        }
        let rays = self.rays(point, &on);
        self.nodes.push(TraceNode { point, surfaces: on, rays });
        Some(self.nodes.len() - 1)
    }

    /// The edges that leave a corner.
    fn rays(&mut self, point: Vec3, on: &Surfaces) -> SmallVec<[EdgeRay; 6]> {
        let mut rays = SmallVec::new();
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            let pair = [on[i], on[j]];
            let Some(t) = self.along(point, pair) else { continue };
            for forward in [true, false] {
                let away = if forward { t } else { -t } * (BEGIN * self.cell);
                let Some(q) = self.put(&pair, point + away, 0.5 * BEGIN * self.cell) else {
                    continue;
                };
                if let Some(bend) = self.bend(q, pair) {
                    rays.push(EdgeRay { pair, bend, forward, traced: false });
                }
            }
        }
        rays
    }
}

/// Distance of a point from a side.
pub(super) fn from_side(p: Vec3, a: Vec3, b: Vec3) -> f64 {
    let along = b - a;
    let size = along.norm_sq();
    let t = if size > 0.0 { ((p - a).dot(along) / size).clamp(0.0, 1.0) } else { 0.0 };
    p.distance(a + along * t)
}
