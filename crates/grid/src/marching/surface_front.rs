//! The front of marched patches: one step of all nodes.

use super::crossing::{BoundaryPart, first_crossing, lowered, triangles_cross};
use super::curve::{ACUTE, LEAST_SINE};
use super::front::{EDGE_SHARE, Front, MarchStep};
use super::line::{
    BlockTridiagonal, FactoredLine, LineEnd, Matrix, apply, inverse, smoothed, times,
};
use super::outcome::{MarchFailure, MarchPlace};
use super::report::{self, Worst};
use super::settings::{MarchBoundary, reflected};
use super::topology::{FrontCell, FrontTopology, GridLine, LineNode, NodeKind, Reach, Spoke};
use crate::GridError;
use moldloft_budget::Budget;
use moldloft_num::{Real, Vec3};
use moldloft_parallel::prelude::*;
use std::collections::HashMap;

pub(super) struct SurfaceFront<T> {
    /// The points of the nodes.
    pub wall: Vec<Vec3<T>>,
    pub topology: FrontTopology,
    /// Several patches: places name the patch, and the equations are solved exactly, so that nodes do not depend
    /// on the order and directions of the patches. One patch takes the factored step.
    pub is_joined: bool,
}

#[derive(Clone, Copy)]
struct NodeDirection<T> {
    next: Vec3<T>,
    last: Vec3<T>,
    lengths: [T; 2],
    /// Difference of the unit vectors to both.
    turn: Vec3<T>,
    /// Sine and cosine of half the angle, on the grid's side.
    sine: T,
    cosine: T,
}

impl<T: Real> NodeDirection<T> {
    fn length(&self) -> T {
        (self.lengths[0] + self.lengths[1]) * 0.5
    }
}

#[derive(Clone, Copy)]
struct SurfaceNode<T> {
    ways: [NodeDirection<T>; 2],
    normal: Vec3<T>,
    pole: bool,
}

impl<T: Real> SurfaceNode<T> {
    fn sharp(&self) -> bool {
        self.ways.iter().any(|way| way.cosine.re() < -0.5)
    }
}

/// Lengths of zero, at poles, count as this.
const TINY: f64 = 1e-300;

/// The point at the end of an edge of a star at `here`.
fn spoke_end<T: Real>(spoke: &Spoke, r: &[Vec3<T>], here: Vec3<T>) -> Vec3<T> {
    match spoke.mirror {
        Some(plane) => reflected(r[spoke.node], plane, here[plane]),
        None => r[spoke.node],
    }
}

/// Weights of an edge of a star in the next and last virtual neighbours of a direction: half their difference is
/// the derivative there, their sum the half of all second differences, by the trigonometric sums over the edges.
fn spoke_weights(count: usize, cosine: f64) -> [f64; 2] {
    [1.0, -1.0].map(|sign| 2.0 / count as f64 * (0.5 + sign * cosine))
}

impl<T: Real> SurfaceFront<T> {
    /// The neighbours of a node in a direction.
    fn neighbours(&self, r: &[Vec3<T>], k: usize, axis: usize) -> [Vec3<T>; 2] {
        let here = r[k];
        match &self.topology.nodes[k] {
            NodeKind::Regular(ways) => {
                let ends = ways[axis];
                [0, 1].map(|end| match (ends[end], ends[1 - end]) {
                    (Reach::Node(at), _) => r[at],
                    (Reach::Beyond(condition), Reach::Node(inner)) => {
                        condition.beyond(here, r[inner])
                    }
                    (Reach::Beyond(_), Reach::Beyond(_)) => here,
                })
            }
            NodeKind::Star(spokes) => {
                let mut ends = [here; 2];
                for spoke in spokes {
                    let line = spoke_end(spoke, r, here) - here;
                    let weights = spoke_weights(spokes.len(), spoke.angle[axis]);
                    for (end, weight) in ends.iter_mut().zip(weights) {
                        *end += line * T::from(weight);
                    }
                }
                ends
            }
            NodeKind::Hub => [here; 2],
        }
    }

    /// The sum of the lengths of the edges to both neighbours.
    fn span(&self, r: &[Vec3<T>], k: usize, axis: usize) -> T {
        if let NodeKind::Star(spokes) = &self.topology.nodes[k] {
            let lengths = spokes.iter().map(|s| (spoke_end(s, r, r[k]) - r[k]).norm());
            return lengths.fold(T::zero(), |sum, l| sum + l) * (2.0 / spokes.len() as f64);
        }
        let [next, last] = self.neighbours(r, k, axis);
        (next - r[k]).norm() + (last - r[k]).norm()
    }

    /// For each line, if it turns round an edge: at the foot of a post the bisector leans away from it, so a
    /// weaker condition suffices than for a prescribed motion.
    fn lines_that_turn(&self, nodes: &[SurfaceNode<T>]) -> Vec<bool> {
        let turns = |at: &LineNode| !at.held && nodes[at.node].ways[at.axis].cosine.re() < -0.25;
        self.topology.lines.iter().map(|line| line.nodes.iter().any(turns)).collect()
    }

    fn nodes(&self, r: &[Vec3<T>]) -> Vec<SurfaceNode<T>> {
        let node = |k: usize| match &self.topology.nodes[k] {
            NodeKind::Regular(_) => self.regular_node(r, k),
            NodeKind::Star(spokes) => self.star_node(r, k, spokes),
            NodeKind::Hub => {
                let none = NodeDirection {
                    next: r[k],
                    last: r[k],
                    lengths: [T::from(TINY); 2],
                    turn: Vec3::zero(),
                    sine: T::one(),
                    cosine: T::zero(),
                };
                SurfaceNode { ways: [none; 2], normal: Vec3::zero(), pole: true }
            }
        };
        let mut nodes: Vec<SurfaceNode<T>> = (0..r.len()).into_par_iter().map(node).collect();
        let normals: Vec<Vec3<T>> = nodes.iter().map(|node| node.normal).collect();
        for (k, unit) in self.pole_directions(&normals) {
            nodes[k].normal = unit;
        }
        nodes
    }

    fn regular_node(&self, r: &[Vec3<T>], k: usize) -> SurfaceNode<T> {
        let tiny = T::from(TINY);
        let way = |axis: usize| {
            let [next, last] = self.neighbours(r, k, axis);
            let length = |d: Vec3<T>| {
                let square = d.norm_sq();
                if square.re() > 0.0 { square.sqrt() } else { tiny }
            };
            let (p, m) = (next - r[k], last - r[k]);
            let lengths = [length(p), length(m)];
            let turn = p / lengths[0] - m / lengths[1];
            (next, last, lengths, turn)
        };
        let raw = [way(0), way(1)];
        let normal = raw[0].3.cross(raw[1].3);
        let square = normal.norm_sq();
        let normal = match square.re() > 1e-24 {
            true => normal / square.sqrt(),
            false => Vec3::zero(),
        };
        let ways = raw.map(|(next, last, lengths, turn)| {
            let square = turn.norm_sq() * 0.25;
            let sine = match square.re() > LEAST_SINE * LEAST_SINE {
                true => square.sqrt(),
                false => T::from(LEAST_SINE),
            };
            let lean = |p: Vec3<T>, l: T| (p - r[k]).dot(normal) / l;
            let cosine = (lean(next, lengths[0]) + lean(last, lengths[1])) * 0.5;
            NodeDirection { next, last, lengths, turn, sine, cosine }
        });
        SurfaceNode { ways, normal, pole: self.topology.is_pole[k] }
    }

    /// A star's directions: the first with the mean lean of its two most convex edges, the second with that of the
    /// two most concave ones and the least sine between normal and cells.
    fn star_node(&self, r: &[Vec3<T>], k: usize, spokes: &[Spoke]) -> SurfaceNode<T> {
        let tiny = T::from(TINY);
        let count = spokes.len();
        let mut units = Vec::with_capacity(count);
        let mut mean = T::zero();
        let mut turns = [Vec3::zero(); 2];
        for spoke in spokes {
            let line = spoke_end(spoke, r, r[k]) - r[k];
            let square = line.norm_sq();
            let length = if square.re() > 0.0 { square.sqrt() } else { tiny };
            mean += length * (1.0 / count as f64);
            let unit = line / length;
            for (turn, part) in turns.iter_mut().zip(spoke.angle) {
                *turn += unit * T::from(4.0 / count as f64 * part);
            }
            units.push(unit);
        }
        let normal = turns[0].cross(turns[1]);
        let square = normal.norm_sq();
        let normal = match square.re() > 1e-24 {
            true => normal / square.sqrt(),
            false => Vec3::zero(),
        };
        let mut leans: Vec<T> = units.iter().map(|unit| unit.dot(normal)).collect();
        leans.sort_by(|a, b| a.re().total_cmp(&b.re()));
        let half = T::from(0.5);
        let cosines = [(leans[0] + leans[1]) * half, (leans[count - 1] + leans[count - 2]) * half];
        let mut sine = T::one();
        if cosines[1].re() > 0.0 {
            for m in 0..count {
                let face = units[m].cross(units[(m + 1) % count]);
                let square = face.norm_sq();
                if square.re() > 1e-24 {
                    sine = sine.min(face.dot(normal) / square.sqrt());
                }
            }
            sine = sine.max(T::from(LEAST_SINE));
        }
        let ways = [0, 1].map(|axis| {
            let [next, last] = self.neighbours(r, k, axis);
            let (lengths, turn, cosine) = ([mean; 2], turns[axis], cosines[axis]);
            let sine = if axis == 1 { sine } else { T::one() };
            NodeDirection { next, last, lengths, turn, sine, cosine }
        });
        SurfaceNode { ways, normal, pole: false }
    }

    pub fn check_normals(&self) -> Result<(), GridError> {
        let nodes = self.nodes(&self.wall);
        match nodes.iter().position(|node| !(node.normal.re().norm_sq() > 0.5)) {
            Some(k) => Err(GridError::NoNormal { at: self.place(k) }),
            None => Ok(()),
        }
    }

    /// The nodes of poles with the unit mean of the vectors of the ring around them; components
    /// normal to a plane of symmetry are dropped, so that half bodies keep their poles in it.
    fn pole_directions(&self, vectors: &[Vec3<T>]) -> Vec<(usize, Vec3<T>)> {
        let mut found = Vec::new();
        for pole in &self.topology.poles {
            let ring = pole.ring.iter().map(|k| vectors[*k]);
            let mut mean = ring.fold(Vec3::zero(), |sum, v| sum + v).to_array();
            for plane in &pole.planes {
                mean[*plane] = T::zero();
            }
            let unit = Vec3::from(mean).normalized().unwrap_or_else(Vec3::zero);
            found.extend(pole.members.iter().map(|k| (*k, unit)));
        }
        found
    }

    fn keep_planes(&self, from: &[Vec3<T>], to: &mut [Vec3<T>]) {
        for (k, kept) in &self.topology.kept {
            let mut p = to[*k].to_array();
            for (c, _) in kept.iter().enumerate().filter(|(_, kept)| **kept) {
                p[c] = from[*k][c];
            }
            to[*k] = p.into();
        }
    }

    /// Distances of the first layer from the wall, and the angles of its lines to the normals.
    pub fn wall_angles(&self, layers: &[Vec<Vec3<T>>]) -> Vec<(f64, f64)> {
        let Some(first) = layers.get(1) else { return Vec::new() };
        let nodes = self.nodes(&self.wall);
        let each = nodes.iter().zip(self.wall.iter().zip(first)).map(|(node, (a, b))| {
            let line = (*b - *a).re();
            let normal = node.normal.re();
            let angle = libm::atan2(line.cross(normal).norm(), line.dot(normal));
            (line.norm() * concave_sine(node).re(), angle)
        });
        each.collect()
    }
}

/// The least sine of a node's concave half angles: its distance from the wall over its travel.
fn concave_sine<T: Real>(node: &SurfaceNode<T>) -> T {
    node.ways.iter().fold(T::one(), |least, way| {
        if way.cosine.re() > 1e-3 && !node.pole { least.min(way.sine) } else { least }
    })
}

/// The largest step, relative to an edge between lines that do not converge.
const LONG_SHARE: f64 = 5.0;

/// Angle, in radians, between neighbouring lines from which on they are separated in full on a front of several
/// patches. Lines that do not converge are left: at kinks between patches second differences are not
/// small, and would gather the lines at nodes of three edges.
const FULL_LEAN: f64 = 0.2;

/// The equations of a node: steps alone, or with their coupling along i and j.
struct Equation<T> {
    right: Vec3<T>,
    /// The part of the step that separates lines.
    pull: Vec3<T>,
    /// The direction of the line.
    ahead: Vec3<T>,
    /// C^-1 A and C^-1 B with the implicit dissipation; `None` if the step is prescribed.
    coupling: Option<[(Matrix<T>, T); 2]>,
}

impl<T: Real> Front<T> for SurfaceFront<T> {
    fn wall(&self) -> &[Vec3<T>] {
        &self.wall
    }

    fn place(&self, k: usize) -> MarchPlace {
        let (patch, at) = self.topology.places[k];
        MarchPlace { surface: self.is_joined.then_some(patch + 1), at }
    }

    fn cell_place(&self, cell: usize) -> (MarchPlace, usize) {
        let FrontCell { corners, patch, at } = self.topology.cells[cell];
        (MarchPlace { surface: self.is_joined.then_some(patch + 1), at }, corners[0])
    }

    fn first_layer(&self, height: T) -> Result<Option<Vec<Vec3<T>>>, MarchFailure> {
        let nodes = self.nodes(&self.wall);
        let mut layer = Vec::with_capacity(nodes.len());
        let mut fits = true;
        for (k, node) in nodes.iter().enumerate() {
            for way in &node.ways {
                if node.pole || !(way.cosine.re() > 1e-3) {
                    continue;
                }
                let spacing = way.lengths[0].re().min(way.lengths[1].re());
                fits &= report::fits_corner([way.sine.re(), way.cosine.re()], spacing, height.re())
                    .map_err(|cause| MarchFailure {
                        layer: 2,
                        at: self.place(k),
                        wall: self.wall[k].re(),
                        cause,
                    })?;
            }
            layer.push(self.wall[k] + node.normal * (height / concave_sine(node)));
        }
        if !fits {
            return Ok(None);
        }
        self.keep_planes(&self.wall, &mut layer);
        Ok(Some(layer))
    }

    fn step_limit(&self, r: &[Vec3<T>], tight: bool) -> (f64, usize) {
        let edges = self.topology.limits.iter();
        if tight {
            let (edge, node) = edges.fold((f64::INFINITY, 0), |best, &[k, l]| {
                let edge = r[k].re().distance(r[l].re());
                if edge < best.0 { (edge, k) } else { best }
            });
            return (EDGE_SHARE * edge, node);
        }
        let nodes = self.nodes(r);
        let ahead: Vec<Vec3> =
            nodes.iter().map(|node| (node.normal / concave_sine(node)).re()).collect();
        edges.fold((f64::INFINITY, 0), |best, &[k, l]| {
            let line = r[l].re() - r[k].re();
            let edge = line.norm();
            // By how much a step shortens the edge.
            let closing = (ahead[k] - ahead[l]).dot(line) / edge;
            let limit = edge * (EDGE_SHARE / closing.max(EDGE_SHARE / LONG_SHARE));
            if limit < best.0 { (limit, k) } else { best }
        })
    }

    fn has_long_steps(&self) -> bool {
        self.is_joined
    }

    fn mean_edge(&self, r: &[Vec3<T>]) -> f64 {
        let edges = &self.topology.edges;
        let lengths = edges.iter().map(|&[k, l]| r[k].re().distance(r[l].re()));
        lengths.sum::<f64>() / edges.len() as f64
    }

    fn step(&self, step: MarchStep<'_, T>, budget: &Budget) -> Vec<Vec3<T>> {
        let MarchStep { r, before, d, s, last, smoothed: state, cap, dissipation, first } = step;
        let nodes = self.nodes(r);
        let heights = self.heights(&nodes, [r, before], [d, s], state, cap);
        let of = StepOf { r, before, s, shift: report::shift(s, last), dissipation, first };
        let turns = self.lines_that_turn(&nodes);
        let equation = |k: usize| self.equation(k, &nodes, heights[k], &of, &turns);
        let mut equations: Vec<Equation<T>> = (0..r.len()).into_par_iter().map(equation).collect();
        if self.is_joined {
            self.keep_heights(&mut equations);
        }
        let mut moved: Vec<Vec3<T>> = equations.iter().map(|e| e.right).collect();
        self.lead_poles(d, &mut moved);
        let right = if self.is_joined { moved.clone() } else { Vec::new() };
        let lines = self.factored(&equations, budget);
        self.sweep(&equations, &lines, &mut moved);
        if self.is_joined {
            self.refine(&equations, &lines, &right, d, &mut moved, budget);
        }
        self.lead_poles(d, &mut moved);
        let mut next: Vec<Vec3<T>> = r.iter().zip(&moved).map(|(p, d)| *p + *d).collect();
        self.keep_planes(r, &mut next);
        next
    }

    fn crossing(&self, layers: &[Vec<Vec3<T>>]) -> Option<[usize; 2]> {
        let last = layers.len() - 1;
        let lowered = lowered(layers);
        let at = |[layer, k]: [usize; 2]| match layer == last {
            true => lowered[k],
            false => layers[layer][k].re(),
        };
        let unique = self.distinct_nodes();
        // Triangles of quadrilaterals, without those of no area at poles.
        let triangles = |quad: [[usize; 2]; 4]| {
            let (corners, foot) = (quad.map(at), quad.map(|[_, k]| unique[k]));
            let both = [[0, 1, 2], [0, 2, 3]].map(|of| of.map(|k: usize| corners[k]));
            both.into_iter()
                .filter(|[a, b, c]| a != b && b != c && c != a)
                .map(move |corners| BoundaryPart { corners, foot })
        };
        let layer = |layer: usize| {
            let quad = move |cell: &FrontCell| cell.corners.map(|k| [layer, k]);
            self.topology.cells.iter().map(quad)
        };
        let side = |&[k, l]: &[usize; 2]| {
            (0..last).map(move |layer| [[layer, k], [layer, l], [layer + 1, l], [layer + 1, k]])
        };
        let mut parts: Vec<BoundaryPart> = layer(last).flat_map(triangles).collect();
        let front = parts.len();
        parts.extend(layer(0).flat_map(triangles));
        parts.extend(self.topology.borders.iter().flat_map(side).flat_map(triangles));
        let found = first_crossing(&parts, front, triangles_cross);
        found.map(|pair| pair.map(|part| parts[part].foot[0]))
    }

    fn worst_cell(&self, below: &[Vec3<T>], above: &[Vec3<T>]) -> Worst {
        /// Cells for each thread to begin with.
        const CHUNK: usize = 64;
        let cells = &self.topology.cells;
        let chunk = |chunk: usize| {
            let mut worst = Worst::none();
            let end = cells.len().min((chunk + 1) * CHUNK);
            for (k, cell) in (chunk * CHUNK..end).zip(&cells[chunk * CHUNK..end]) {
                let [a, b, c, d] = cell.corners.map(|k| [below[k].re(), above[k].re()]);
                worst.take(k, report::hexahedron([[a, d], [b, c]]));
            }
            worst
        };
        let count = cells.len().div_ceil(CHUNK);
        let chunks: Vec<Worst> = (0..count).into_par_iter().map(chunk).collect();
        chunks.into_iter().fold(Worst::none(), Worst::worse)
    }
}

/// Parameters of a step that its equations need.
struct StepOf<'a, T> {
    r: &'a [Vec3<T>],
    before: &'a [Vec3<T>],
    s: T,
    shift: T,
    dissipation: f64,
    first: bool,
}

impl<T: Real> SurfaceFront<T> {
    /// The equations of node `k`, whose step has the height `h`.
    fn equation(
        &self,
        k: usize,
        nodes: &[SurfaceNode<T>],
        h: T,
        of: &StepOf<'_, T>,
        turns: &[bool],
    ) -> Equation<T> {
        let StepOf { r, before, s, shift, dissipation, first } = *of;
        let (node, here) = (&nodes[k], r[k]);
        let prescribed = Equation {
            right: node.normal * h,
            pull: Vec3::zero(),
            ahead: Vec3::zero(),
            coupling: None,
        };
        if node.pole || node.sharp() {
            return prescribed;
        }
        let [u, v] = node.ways;
        let central = (u.next - u.last).cross(v.next - v.last);
        let square = central.norm_sq();
        if !(square.re() > 0.0) {
            return prescribed;
        }
        let e = central * (shift / square.sqrt()) + node.normal * (T::one() - shift);
        let e = e / e.norm();
        let mut epsilons = [0, 1].map(|axis| {
            let way = &node.ways[axis];
            let then = self.span(before, k, axis);
            let now = way.lengths[0] + way.lengths[1];
            let length = way.length() * way.sine;
            let mut epsilon = if first {
                T::zero()
            } else {
                let concave =
                    if way.cosine.re() > 0.0 { T::one() / (way.sine * way.sine) } else { T::one() };
                let converge = report::convergence(then / now, shift);
                shift * converge * concave * (h / length) * dissipation
            };
            // Along a corner that also turns round a sharp edge lines converge from the wall on.
            let across = self.topology.lines_of[k][1 - axis];
            if way.cosine.re() > ACUTE && !across.is_some_and(|line| turns[line]) {
                let ripe = s * way.cosine / way.sine / (way.length() * 0.3);
                epsilon *= ripe.min(T::one());
            }
            epsilon
        });
        if matches!(self.topology.nodes[k], NodeKind::Star(_)) {
            epsilons = [(epsilons[0] + epsilons[1]) * 0.5; 2];
        }
        let mut pull = Vec3::zero();
        for (axis, (way, epsilon)) in node.ways.iter().zip(epsilons).enumerate() {
            let mut share = epsilon;
            if self.is_joined {
                let lean = self.lean(nodes, r, k, axis);
                share *= (lean * (1.0 / FULL_LEAN)).max(T::zero()).min(T::one());
            }
            pull += (way.next + way.last - here * T::from(2.0)) * share;
        }
        let back = pull.dot(e);
        if back.re() < 0.0 {
            pull -= e * back;
        }
        // Rows: r_i . dr = 0, r_j . dr = 0, (r_i x r_j) . dr = V; A and B multiply the derivatives of dr by i
        // and by j. The tangents have the mean lengths of their edges and are at right angles to e.
        let tangent = |way: &NodeDirection<T>| {
            let t = way.turn * (way.length() * 0.5);
            t - e * t.dot(e)
        };
        let (ri, rj) = (tangent(&u), tangent(&v));
        let rk = e * h;
        let solve = inverse(&[ri.to_array(), rj.to_array(), ri.cross(rj).to_array()]);
        let zero = [T::zero(); 3];
        let a = times(&solve, &[rk.to_array(), zero, rj.cross(rk).to_array()]);
        let b = times(&solve, &[zero, rk.to_array(), rk.cross(ri).to_array()]);
        let [ei, ej] = epsilons;
        Equation {
            right: rk + pull,
            coupling: Some([(a, ei * 2.0), (b, ej * 2.0)]),
            pull,
            ahead: e,
        }
    }

    /// By how much the lines beside a node lean towards its own: the mean closing per height. It is taken
    /// from normals, not from edges, which pulls shorten at kinks.
    fn lean(&self, nodes: &[SurfaceNode<T>], r: &[Vec3<T>], k: usize, axis: usize) -> T {
        let (here, normal) = (r[k], nodes[k].normal);
        let toward = |point: Vec3<T>, other: Vec3<T>| {
            let line = point - here;
            let square = line.norm_sq();
            match square.re() > 0.0 {
                true => (normal - other).dot(line) / square.sqrt(),
                false => T::zero(),
            }
        };
        match &self.topology.nodes[k] {
            NodeKind::Regular(ways) => {
                let ends = ways[axis];
                let sides = [0, 1].map(|end| match (ends[end], ends[1 - end]) {
                    (Reach::Node(at), _) => toward(r[at], nodes[at].normal),
                    (Reach::Beyond(condition), Reach::Node(inner)) => {
                        let MarchBoundary::Symmetry(plane) = condition else { return T::zero() };
                        let image = reflected(nodes[inner].normal, plane, T::zero());
                        toward(condition.beyond(here, r[inner]), image)
                    }
                    (Reach::Beyond(_), Reach::Beyond(_)) => T::zero(),
                });
                (sides[0] + sides[1]) * 0.5
            }
            NodeKind::Star(spokes) => {
                let sum = spokes.iter().fold(T::zero(), |sum, spoke| {
                    let other = nodes[spoke.node].normal;
                    let other = match spoke.mirror {
                        Some(plane) => reflected(other, plane, T::zero()),
                        None => other,
                    };
                    sum + toward(spoke_end(spoke, r, here), other)
                });
                sum * (1.0 / spokes.len() as f64)
            }
            NodeKind::Hub => T::zero(),
        }
    }

    /// Takes out of the volumes the change of area by pulls, which otherwise changes the heights: pulled lines
    /// that gather would move ahead.
    fn keep_heights(&self, equations: &mut [Equation<T>]) {
        let pulls: Vec<Vec3<T>> = equations.iter().map(|e| e.pull).collect();
        for (k, equation) in equations.iter_mut().enumerate() {
            let Some(coupling) = &equation.coupling else { continue };
            let mut change = Vec3::zero();
            for (axis, (term, _)) in coupling.iter().enumerate() {
                let [next, last] = self.neighbour_steps(&pulls, k, axis);
                change += apply(term, (next - last) * T::from(0.5));
            }
            let ahead = equation.ahead;
            equation.right += ahead * change.dot(ahead);
        }
    }

    /// For each node the first one at the same place of the wall, as at poles and along wakes.
    fn distinct_nodes(&self) -> Vec<usize> {
        let mut first = HashMap::new();
        let key = |p: &Vec3<T>| p.re().to_array().map(|x| (x + 0.0).to_bits());
        let each = self.wall.iter().enumerate();
        each.map(|(k, p)| *first.entry(key(p)).or_insert(k)).collect()
    }

    /// The heights of a step: as volumes of the layer to come, smoothed over a length of the height reached.
    fn heights(
        &self,
        nodes: &[SurfaceNode<T>],
        [r, before]: [&[Vec3<T>]; 2],
        [d, s]: [T; 2],
        state: &mut [T],
        cap: Option<f64>,
    ) -> Vec<T> {
        let q: Vec<Vec3<T>> = (0..r.len()).map(|k| r[k] + nodes[k].normal * d).collect();
        let area = |k: usize| nodes[k].ways[0].length() * nodes[k].ways[1].length();
        let plain: Vec<T> = (0..r.len())
            .into_par_iter()
            .map(|k| {
                let node = &nodes[k];
                if node.pole {
                    return T::zero();
                }
                let mut volume = d * area(k);
                if let NodeKind::Star(_) = &self.topology.nodes[k]
                    && !node.sharp()
                {
                    // The area itself: its directions are arbitrary.
                    let [u, v] = node.ways;
                    let [[a, b], [p, q]] = [0, 1].map(|axis| self.neighbours(&q, k, axis));
                    let below = (u.next - u.last).cross(v.next - v.last);
                    let square = below.norm_sq();
                    if square.re() > 0.0 {
                        let above = (a - b).cross(p - q);
                        volume *= (above.dot(below) / square).max(T::one()).min(T::from(4.0));
                    }
                    return volume;
                }
                for (axis, way) in node.ways.iter().enumerate() {
                    if node.sharp() {
                        break;
                    }
                    let [next, last] = self.neighbours(&q, k, axis);
                    let (a, b) = (way.next - way.last, next - last);
                    let square = a.norm_sq();
                    if square.re() > 0.0 {
                        volume *= (a.dot(b) / square).max(T::one()).min(T::from(2.0));
                    }
                }
                volume
            })
            .collect();
        let volumes = self.smoothed_volumes(nodes, [d, s], &plain);
        let heights = (0..r.len()).map(|k| {
            if nodes[k].pole {
                return d;
            }
            let mut share = volumes[k] / plain[k];
            if let Some(cap) = cap {
                let converges = (0..2).any(|axis| {
                    let lengths = nodes[k].ways[axis].lengths;
                    self.span(before, k, axis).re() > (lengths[0] + lengths[1]).re() * 1.0001
                });
                if !converges {
                    share = share.max(state[k] * (1.0 / cap)).min(state[k] * cap);
                }
                state[k] = share;
            }
            share * plain[k] / area(k)
        });
        heights.collect()
    }

    /// Volumes smoothed along all lines: of one patch first along i, then along j; of several the mean of both,
    /// repeated (additive operator splitting), which does not depend on the order of the lines.
    fn smoothed_volumes(&self, nodes: &[SurfaceNode<T>], [d, s]: [T; 2], plain: &[T]) -> Vec<T> {
        /// Repetitions: of the roughness across a line 1/16 is left.
        const PASSES: usize = 4;
        let reach = |at: &LineNode| {
            let node = &nodes[at.node];
            if node.pole {
                return T::zero();
            }
            let length = node.ways[at.axis].length();
            s * d * 2.0 / (length * length)
        };
        let mut volumes = plain.to_vec();
        if !self.is_joined {
            for sweep in &self.topology.sweeps {
                for (_, node, x) in self.smoothed_along(sweep, reach, &volumes) {
                    volumes[node] = x;
                }
            }
            return volumes;
        }
        let topology = &self.topology;
        let lines: Vec<usize> =
            (0..topology.lines.len()).filter(|line| !topology.ends_in_pole[*line]).collect();
        let is_star = |node: usize| matches!(topology.nodes[node], NodeKind::Star(_));
        let share = |at: &LineNode| {
            let of = topology.lines_of[at.node];
            let count = match is_star(at.node) {
                true => 4,
                false => of.iter().flatten().filter(|line| !topology.ends_in_pole[**line]).count(),
            };
            reach(at) * (count as f64 / PASSES as f64)
        };
        for _ in 0..PASSES {
            let mut sums = vec![(T::zero(), 0usize); volumes.len()];
            for (held, node, x) in self.smoothed_along(&lines, share, &volumes) {
                if !held || is_star(node) {
                    sums[node] = (sums[node].0 + x, sums[node].1 + 1);
                }
            }
            for (volume, (sum, count)) in volumes.iter_mut().zip(sums) {
                if count > 0 {
                    *volume = sum * (1.0 / count as f64);
                }
            }
        }
        volumes
    }

    /// Values smoothed along lines, in parallel. Lines that end in a pole have no volume there and are left out.
    fn smoothed_along(
        &self,
        lines: &[usize],
        reach: impl Fn(&LineNode) -> T + Sync,
        values: &[T],
    ) -> Vec<(bool, usize, T)> {
        let solve = |k: usize| -> Vec<(bool, usize, T)> {
            if self.topology.ends_in_pole[lines[k]] {
                return Vec::new();
            }
            let line = &self.topology.lines[lines[k]];
            let reaches: Vec<T> = line.nodes.iter().map(&reach).collect();
            let found: Vec<T> = line.nodes.iter().map(|at| values[at.node]).collect();
            let ends = (!line.closed).then(|| self.line_ends(line));
            let solved = smoothed(&reaches, &found, ends);
            line.nodes.iter().zip(solved).map(|(at, x)| (at.held, at.node, x)).collect()
        };
        let solved: Vec<Vec<(bool, usize, T)>> =
            (0..lines.len()).into_par_iter().map(solve).collect();
        solved.into_iter().flatten().collect()
    }

    /// The ends of a line as volumes see them: those of one patch are open.
    fn line_ends(&self, line: &GridLine) -> [LineEnd; 2] {
        let last = line.nodes.len() - 1;
        [(0, false), (last, true)].map(|(k, ahead)| {
            let at = &line.nodes[k];
            let condition = self.condition_beyond(at, at.forward == ahead);
            match condition {
                MarchBoundary::Symmetry(_) if self.is_joined && !at.held => LineEnd::Mirrored,
                _ => LineEnd::Open,
            }
        })
    }

    /// Gives the nodes of a pole one step, along the mean of the ring beside it.
    fn lead_poles(&self, d: T, moved: &mut [Vec3<T>]) {
        for (k, unit) in self.pole_directions(moved) {
            moved[k] = unit * d;
        }
    }

    /// The factors of all lines; none when the budget is spent.
    fn factored(&self, equations: &[Equation<T>], budget: &Budget) -> Vec<FactoredLine<T>> {
        let lines = &self.topology.lines;
        let factor = |k: usize| {
            let line = &lines[k];
            match budget.is_spent() {
                true => BlockTridiagonal::unit(line.nodes.len()).factored(false),
                false => self.line_equations(line, equations).factored(line.closed),
            }
        };
        (0..lines.len()).into_par_iter().map(factor).collect()
    }

    /// The factored solution: the factors of all lines that do not cross, one after the other, then the stars.
    fn sweep(&self, equations: &[Equation<T>], lines: &[FactoredLine<T>], moved: &mut [Vec3<T>]) {
        for sweep in self.topology.sweeps.iter().rev() {
            let from = &*moved;
            let solve = |k: usize| -> Vec<Vec3<T>> {
                let nodes = &self.topology.lines[sweep[k]].nodes;
                lines[sweep[k]].solved(nodes.iter().map(|at| from[at.node]).collect())
            };
            let solved: Vec<Vec<Vec3<T>>> = (0..sweep.len()).into_par_iter().map(solve).collect();
            for (line, solved) in sweep.iter().zip(solved) {
                for (at, step) in self.topology.lines[*line].nodes.iter().zip(solved) {
                    if !at.held {
                        moved[at.node] = step;
                    }
                }
            }
        }
        for (k, node) in self.topology.nodes.iter().enumerate() {
            let NodeKind::Star(_) = node else { continue };
            let Some(coupling) = &equations[k].coupling else { continue };
            // The row without the star's own step, which its neighbours' weights leave on the diagonal.
            let here = moved[k];
            let whole = self.applied(k, equations, moved);
            let diagonal = T::one() + (coupling[0].1 + coupling[1].1) * 2.0;
            moved[k] = (here - whole) / diagonal + here;
        }
    }

    /// The equations along one line.
    fn line_equations(&self, line: &GridLine, equations: &[Equation<T>]) -> BlockTridiagonal<T> {
        let count = line.nodes.len();
        let mut system = BlockTridiagonal::unit(count);
        for (k, at) in line.nodes.iter().enumerate() {
            let Some(coupling) = &equations[at.node].coupling else { continue };
            if at.held {
                continue;
            }
            let (term, implicit) = &coupling[at.axis];
            let half = term.map(|row| row.map(|x| x * 0.5));
            let (mut low, mut high) = (half.map(|row| row.map(|x| -x)), half);
            for a in 0..3 {
                low[a][a] -= *implicit;
                high[a][a] -= *implicit;
                system.middle[k][a][a] += *implicit * 2.0;
            }
            if !at.forward {
                std::mem::swap(&mut low, &mut high);
            }
            let first = k == 0 && !line.closed;
            let last = k + 1 == count && !line.closed;
            if first {
                let condition = self.condition_beyond(at, !at.forward);
                condition.close(&mut system.middle[k], &low, &mut high);
            } else {
                system.low[k] = low;
            }
            if last {
                let mut inner = system.low[k];
                let condition = self.condition_beyond(at, at.forward);
                condition.close(&mut system.middle[k], &high, &mut inner);
                system.low[k] = inner;
            } else {
                system.high[k] = high;
            }
        }
        system
    }

    /// The condition at the end of a line, beyond its node's next or last neighbour.
    fn condition_beyond(&self, at: &LineNode, next: bool) -> MarchBoundary {
        match &self.topology.nodes[at.node] {
            NodeKind::Regular(ways) => match ways[at.axis][usize::from(!next)] {
                Reach::Beyond(condition) => condition,
                Reach::Node(_) => MarchBoundary::Free,
            },
            _ => MarchBoundary::Free,
        }
    }

    /// The left side of a node's equations for these steps.
    fn applied(&self, k: usize, equations: &[Equation<T>], moved: &[Vec3<T>]) -> Vec3<T> {
        let here = moved[k];
        let Some(coupling) = &equations[k].coupling else { return here };
        let mut sum = here;
        for axis in 0..2 {
            let [next, last] = self.neighbour_steps(moved, k, axis);
            let (term, implicit) = &coupling[axis];
            sum += apply(term, (next - last) * T::from(0.5));
            sum -= (next + last - here * T::from(2.0)) * *implicit;
        }
        sum
    }

    /// The steps of a node's neighbours in a direction.
    fn neighbour_steps(&self, moved: &[Vec3<T>], k: usize, axis: usize) -> [Vec3<T>; 2] {
        let here = moved[k];
        match &self.topology.nodes[k] {
            NodeKind::Regular(ways) => {
                let ends = ways[axis];
                [0, 1].map(|end| match (ends[end], ends[1 - end]) {
                    (Reach::Node(at), _) => moved[at],
                    (Reach::Beyond(condition), Reach::Node(inner)) => {
                        condition.beyond_step(here, moved[inner])
                    }
                    (Reach::Beyond(_), Reach::Beyond(_)) => here,
                })
            }
            NodeKind::Star(spokes) => {
                let mut ends = [here; 2];
                for spoke in spokes {
                    let step = match spoke.mirror {
                        Some(plane) => reflected(moved[spoke.node], plane, T::zero()),
                        None => moved[spoke.node],
                    };
                    let weights = spoke_weights(spokes.len(), spoke.angle[axis]);
                    for (end, weight) in ends.iter_mut().zip(weights) {
                        *end += (step - here) * T::from(weight);
                    }
                }
                ends
            }
            NodeKind::Hub => [here; 2],
        }
    }

    /// Solves the equations exactly, by conjugate residuals (GCR) on the factored solution. Coefficients are those
    /// of real parts, so derivatives are those of the steps.
    fn refine(
        &self,
        equations: &[Equation<T>],
        lines: &[FactoredLine<T>],
        right: &[Vec3<T>],
        d: T,
        moved: &mut [Vec3<T>],
        budget: &Budget,
    ) {
        /// Residual, relative to the height of the step.
        const RESIDUAL: f64 = 1e-10;
        /// Maximum number of iterations.
        const MOST: usize = 30;
        let left = |steps: &[Vec3<T>]| -> Vec<Vec3<T>> {
            let row = |k: usize| self.applied(k, equations, steps);
            (0..steps.len()).into_par_iter().map(row).collect()
        };
        let dot = |a: &[Vec3<T>], b: &[Vec3<T>]| -> f64 {
            a.iter().zip(b).map(|(a, b)| a.re().dot(b.re())).sum()
        };
        let add = |to: &mut [Vec3<T>], from: &[Vec3<T>], share: f64| {
            for (to, from) in to.iter_mut().zip(from) {
                *to += *from * T::from(share);
            }
        };
        let mut rest = left(moved);
        for (k, rest) in rest.iter_mut().enumerate() {
            *rest = match equations[k].coupling {
                Some(_) => right[k] - *rest,
                None => Vec3::zero(),
            };
        }
        let mut searched: Vec<[Vec<Vec3<T>>; 2]> = Vec::new();
        for _ in 0..MOST {
            let most = rest.iter().fold(0.0, |most, v| f64::max(most, v.re().norm()));
            if !(most > RESIDUAL * d.re()) || budget.is_spent() {
                return;
            }
            let mut step = rest.clone();
            self.sweep(equations, lines, &mut step);
            let mut change = left(&step);
            for [earlier, changed] in &searched {
                let share = -dot(&change, changed);
                add(&mut step, earlier, share);
                add(&mut change, changed, share);
            }
            let size = dot(&change, &change).sqrt();
            if !(size > 0.0 && size.is_finite()) {
                return;
            }
            for v in step.iter_mut().chain(&mut change) {
                *v = *v * T::from(1.0 / size);
            }
            let share = dot(&rest, &change);
            add(moved, &step, share);
            add(&mut rest, &change, -share);
            searched.push([step, change]);
        }
    }
}
