//! Marching off a surface.

use super::crossing::{BoundaryPart, first_crossing, lowered, triangles_cross};
use super::curve::{ACUTE, LEAST_SINE};
use super::front::{self, Front, MarchStep};
use super::line::{BlockTridiagonal, Matrix, inverse, mirrored, smoothed, times};
use super::outcome::{MarchFailure, Marched};
use super::report::{self, Worst};
use super::settings::{Hyperbolic, MarchBoundary};
use crate::{GridError, SurfaceGrid};
use moldloft_budget::Budget;
use moldloft_num::{Real, Vec3};
use moldloft_parallel::prelude::*;
use std::collections::HashMap;

/// The layers of a grid marched off a surface, along its normals s_i x s_j: the surface first.
///
/// Lines leave the surface on the bisecting normals with the first height, at corners and sharp
/// edges too. Each further layer solves r_i . r_k = 0, r_j . r_k = 0, r_k . (r_i x r_j) = V,
/// linearised about the layer below and factored along j and along i (Chan and Steger 1992), in
/// steps of at most half the shortest edge; where lines converge, second differences separate them.
/// Every cell is tested before it is accepted; a step that folds is repeated with less constraint,
/// then with more smoothing, and otherwise is an error.
///
/// # Errors
/// Heights that do not ascend from 0; surfaces without a normal; periodic edges that differ;
/// [`GridError::March`] with the layer, the position and the cause.
pub fn hyperbolic<T: Real>(
    surface: &SurfaceGrid<T>,
    options: &Hyperbolic<T>,
) -> Result<Marched<T>, GridError> {
    hyperbolic_until(surface, options, &Budget::default())
}

/// As [`hyperbolic`]; ends when `budget` is spent.
///
/// # Errors
/// Also [`GridError::Spent`].
pub fn hyperbolic_until<T: Real>(
    surface: &SurfaceGrid<T>,
    options: &Hyperbolic<T>,
    budget: &Budget,
) -> Result<Marched<T>, GridError> {
    surface.check_count(3)?;
    surface.check_finite()?;
    report::check_heights(&options.heights)?;
    let sides = options.sides;
    let closed = [0, 1].map(|axis| {
        sides[2 * axis] == MarchBoundary::Periodic || sides[2 * axis + 1] == MarchBoundary::Periodic
    });
    let (m, n) = (surface.m, surface.n);
    let size = [m - usize::from(closed[0]), n - usize::from(closed[1])];
    if size[0] < 3 || size[1] < 3 {
        return Err(GridError::TooFew { expected: 4, actual: [m, n] });
    }
    let mut seams = Vec::new();
    if closed[0] {
        let pair = |j: usize| (surface.at(0, j).re(), surface.at(m - 1, j).re(), [m, j + 1]);
        seams.extend((0..n).map(pair));
    }
    if closed[1] {
        let pair = |i: usize| (surface.at(i, 0).re(), surface.at(i, n - 1).re(), [i + 1, n]);
        seams.extend((0..m).map(pair));
    }
    let all: Vec<Vec3<T>> = surface.points().collect();
    report::check_seam(&seams, &all)?;
    let wall = (0..size[0] * size[1]).map(|k| surface.at(k / size[1], k % size[1])).collect();
    let front = SurfaceFront { wall, size, closed, sides };
    front.check_normals()?;
    let outcome = front::march(&front, options, budget)?;
    let angles = front.wall_angles(&outcome.layers);
    let (layers, report) = report::settled(&front, options, outcome, angles)?;
    let whole = |layer: Vec<Vec3<T>>| {
        SurfaceGrid::from_fn(m, n, |i, j| layer[i % size[0] * size[1] + j % size[1]])
    };
    Ok(Marched { layers: layers.into_iter().map(whole).collect(), report })
}

struct SurfaceFront<T> {
    /// The unique points, (i, j) at i size[1] + j.
    wall: Vec<Vec3<T>>,
    size: [usize; 2],
    closed: [bool; 2],
    sides: [MarchBoundary; 4],
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

impl<T: Real> SurfaceFront<T> {
    fn side(&self, axis: usize, end: usize) -> MarchBoundary {
        self.sides[2 * axis + end]
    }

    fn index(&self, axis: usize, along: usize, line: usize) -> usize {
        if axis == 0 { along * self.size[1] + line } else { line * self.size[1] + along }
    }

    fn has_pole(&self, axis: usize) -> bool {
        (0..2).any(|end| self.side(axis, end) == MarchBoundary::Pole)
    }

    fn is_pole(&self, k: usize) -> bool {
        let at = [k / self.size[1], k % self.size[1]];
        (0..2).any(|axis| {
            at[axis] == 0 && self.side(axis, 0) == MarchBoundary::Pole
                || at[axis] + 1 == self.size[axis] && self.side(axis, 1) == MarchBoundary::Pole
        })
    }

    fn neighbours(&self, r: &[Vec3<T>], k: usize, axis: usize) -> [Vec3<T>; 2] {
        let at = [k / self.size[1], k % self.size[1]];
        let (along, line, count) = (at[axis], at[1 - axis], self.size[axis]);
        let point = |along: usize| r[self.index(axis, along, line)];
        let beyond = |end: usize, inner: Vec3<T>| {
            let here = r[k];
            let mut ghost = (here * T::from(2.0) - inner).to_array();
            if let MarchBoundary::Symmetry(plane) = self.side(axis, end) {
                let inner = inner.to_array();
                for c in 0..3 {
                    if c != plane {
                        ghost[c] = inner[c];
                    }
                }
            }
            ghost.into()
        };
        let next = match along + 1 < count {
            true => point(along + 1),
            false if self.closed[axis] => point(0),
            false => beyond(1, point(along - 1)),
        };
        let last = match along > 0 {
            true => point(along - 1),
            false if self.closed[axis] => point(count - 1),
            false => beyond(0, point(1)),
        };
        [next, last]
    }

    /// For each axis, which of its lines turn round an edge: at the foot of a post the bisector
    /// leans away from it, so a weaker condition suffices than for a prescribed motion.
    fn lines_that_turn(&self, nodes: &[SurfaceNode<T>]) -> [Vec<bool>; 2] {
        [0, 1].map(|axis| {
            let turns = |line: usize| {
                (0..self.size[axis]).any(|along| {
                    nodes[self.index(axis, along, line)].ways[axis].cosine.re() < -0.25
                })
            };
            (0..self.size[1 - axis]).map(turns).collect()
        })
    }

    fn nodes(&self, r: &[Vec3<T>]) -> Vec<SurfaceNode<T>> {
        let tiny = T::from(TINY);
        let node = |k: usize| {
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
            SurfaceNode { ways, normal, pole: self.is_pole(k) }
        };
        let mut nodes: Vec<SurfaceNode<T>> = (0..r.len()).into_par_iter().map(node).collect();
        let normals: Vec<Vec3<T>> = nodes.iter().map(|node| node.normal).collect();
        for (k, unit) in self.pole_directions(&normals) {
            nodes[k].normal = unit;
        }
        nodes
    }

    fn check_normals(&self) -> Result<(), GridError> {
        let nodes = self.nodes(&self.wall);
        match nodes.iter().position(|node| !(node.normal.re().norm_sq() > 0.5)) {
            Some(k) => {
                let [i, j] = self.place(k);
                Err(GridError::NoNormal { at: [i, j] })
            }
            None => Ok(()),
        }
    }

    /// The nodes of poles with the unit mean of the vectors of the ring around them; components
    /// normal to a plane of symmetry are dropped, so that half bodies keep their poles in it.
    fn pole_directions(&self, vectors: &[Vec3<T>]) -> Vec<(usize, Vec3<T>)> {
        let mut found = Vec::new();
        for axis in 0..2 {
            let (count, lines) = (self.size[axis], self.size[1 - axis]);
            for (end, k, beside) in [(0, 0, 1), (1, count - 1, count - 2)] {
                if self.side(axis, end) != MarchBoundary::Pole {
                    continue;
                }
                let ring = (0..lines).map(|l| vectors[self.index(axis, beside, l)]);
                let mut mean = ring.fold(Vec3::zero(), |sum, v| sum + v).to_array();
                for end in 0..2 {
                    if let MarchBoundary::Symmetry(plane) = self.side(1 - axis, end) {
                        mean[plane] = T::zero();
                    }
                }
                let unit = Vec3::from(mean).normalized().unwrap_or_else(Vec3::zero);
                found.extend((0..lines).map(|l| (self.index(axis, k, l), unit)));
            }
        }
        found
    }

    fn keep_planes(&self, from: &[Vec3<T>], to: &mut [Vec3<T>]) {
        for axis in 0..2 {
            for (end, along) in [(0, 0), (1, self.size[axis] - 1)] {
                let (MarchBoundary::Symmetry(plane) | MarchBoundary::Constant(plane)) =
                    self.side(axis, end)
                else {
                    continue;
                };
                for line in 0..self.size[1 - axis] {
                    let k = self.index(axis, along, line);
                    let mut p = to[k].to_array();
                    p[plane] = from[k][plane];
                    to[k] = p.into();
                }
            }
        }
    }

    /// Distances of the first layer from the wall, and the angles of its lines to the normals.
    fn wall_angles(&self, layers: &[Vec<Vec3<T>>]) -> Vec<(f64, f64)> {
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

    /// Values smoothed along an axis, in parallel lines.
    fn smoothed(&self, axis: usize, reach: &[T], values: &mut [T]) {
        let (count, lines) = (self.size[axis], self.size[1 - axis]);
        let solved: Vec<Vec<T>> = (0..lines)
            .into_par_iter()
            .map(|line| {
                let pick = |v: &[T]| -> Vec<T> {
                    (0..count).map(|k| v[self.index(axis, k, line)]).collect()
                };
                smoothed(&pick(reach), &pick(values), self.closed[axis])
            })
            .collect();
        for (line, solved) in solved.into_iter().enumerate() {
            for (along, x) in solved.into_iter().enumerate() {
                values[self.index(axis, along, line)] = x;
            }
        }
    }
}

/// The least sine of a node's concave half angles: its distance from the wall over its travel.
fn concave_sine<T: Real>(node: &SurfaceNode<T>) -> T {
    node.ways.iter().fold(T::one(), |least, way| {
        if way.cosine.re() > 1e-3 && !node.pole { least.min(way.sine) } else { least }
    })
}

/// The equations of a node: steps alone, or with their coupling along i and j.
struct Equation<T> {
    right: Vec3<T>,
    /// C^-1 A and C^-1 B with the implicit dissipation; `None` if the step is prescribed.
    coupling: Option<[(Matrix<T>, T); 2]>,
}

impl<T: Real> Front<T> for SurfaceFront<T> {
    fn wall(&self) -> &[Vec3<T>] {
        &self.wall
    }

    fn place(&self, k: usize) -> [usize; 2] {
        [k / self.size[1] + 1, k % self.size[1] + 1]
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

    fn shortest_edge(&self, r: &[Vec3<T>]) -> (f64, usize) {
        let mut best = (f64::INFINITY, 0);
        for axis in 0..2 {
            // Edges round a pole are short by right.
            if self.has_pole(1 - axis) && !self.has_pole(axis) {
                continue;
            }
            let count = self.size[axis] - usize::from(!self.closed[axis]);
            for line in 0..self.size[1 - axis] {
                for along in 0..count {
                    let k = self.index(axis, along, line);
                    let l = self.index(axis, (along + 1) % self.size[axis], line);
                    if self.is_pole(k) && self.is_pole(l) {
                        continue;
                    }
                    let edge = r[k].re().distance(r[l].re());
                    if edge < best.0 {
                        best = (edge, k);
                    }
                }
            }
        }
        best
    }

    fn mean_edge(&self, r: &[Vec3<T>]) -> f64 {
        let (mut sum, mut edges) = (0.0, 0);
        for axis in 0..2 {
            let count = self.size[axis] - usize::from(!self.closed[axis]);
            for line in 0..self.size[1 - axis] {
                for along in 0..count {
                    let k = self.index(axis, along, line);
                    let l = self.index(axis, (along + 1) % self.size[axis], line);
                    sum += r[k].re().distance(r[l].re());
                    edges += 1;
                }
            }
        }
        sum / f64::from(edges)
    }

    fn step(&self, step: MarchStep<'_, T>, budget: &Budget) -> Vec<Vec3<T>> {
        let MarchStep { r, before, d, s, last, smoothed: state, cap, dissipation, first } = step;
        let nodes = self.nodes(r);
        let count = r.len();
        let heights = self.heights(&nodes, [r, before], [d, s], state, cap);
        let shift = report::shift(s, last);
        let turns = self.lines_that_turn(&nodes);
        let equation = |k: usize| -> Equation<T> {
            let node = &nodes[k];
            let h = heights[k];
            if node.pole || node.sharp() {
                return Equation { right: node.normal * h, coupling: None };
            }
            let [u, v] = node.ways;
            let central = (u.next - u.last).cross(v.next - v.last);
            let square = central.norm_sq();
            if !(square.re() > 0.0) {
                return Equation { right: node.normal * h, coupling: None };
            }
            let e = central * (shift / square.sqrt()) + node.normal * (T::one() - shift);
            let e = e / e.norm();
            let mut pull = Vec3::zero();
            let epsilons = [0, 1].map(|axis| {
                let way = &node.ways[axis];
                let [next, back] = self.neighbours(before, k, axis);
                let then = (next - before[k]).norm() + (back - before[k]).norm();
                let now = way.lengths[0] + way.lengths[1];
                let length = way.length() * way.sine;
                let mut epsilon = if first {
                    T::zero()
                } else {
                    let concave = if way.cosine.re() > 0.0 {
                        T::one() / (way.sine * way.sine)
                    } else {
                        T::one()
                    };
                    let converge = report::convergence(then / now, shift);
                    shift * converge * concave * (h / length) * dissipation
                };
                // Along a corner that also turns round a sharp edge lines converge from the wall on.
                if way.cosine.re() > ACUTE
                    && !turns[1 - axis][[k % self.size[1], k / self.size[1]][1 - axis]]
                {
                    let ripe = s * way.cosine / way.sine / (way.length() * 0.3);
                    epsilon *= ripe.min(T::one());
                }
                pull += (way.next + way.last - r[k] * T::from(2.0)) * epsilon;
                epsilon
            });
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
            Equation { right: rk + pull, coupling: Some([(a, ei * 2.0), (b, ej * 2.0)]) }
        };
        let equations: Vec<Equation<T>> = (0..count).into_par_iter().map(equation).collect();
        let mut moved: Vec<Vec3<T>> = equations.iter().map(|e| e.right).collect();
        self.lead_poles(d, &mut moved);
        for axis in [1, 0] {
            moved = self.solved(axis, &equations, moved, budget);
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
        let mut parts: Vec<BoundaryPart> =
            self.layer_quads(last).into_iter().flat_map(triangles).collect();
        let front = parts.len();
        parts.extend(self.layer_quads(0).into_iter().flat_map(triangles));
        parts.extend(self.side_quads(last).into_iter().flat_map(triangles));
        let found = first_crossing(&parts, front, triangles_cross);
        found.map(|pair| pair.map(|part| parts[part].foot[0]))
    }

    fn worst_cell(&self, below: &[Vec3<T>], above: &[Vec3<T>]) -> Worst {
        let cells = [0, 1].map(|axis| self.size[axis] - usize::from(!self.closed[axis]));
        let row = |i: usize| {
            let mut worst = Worst::none();
            for j in 0..cells[1] {
                let at = |a: usize, b: usize| {
                    let (i, j) = ((i + a) % self.size[0], (j + b) % self.size[1]);
                    let k = i * self.size[1] + j;
                    [below[k].re(), above[k].re()]
                };
                let corners = [[at(0, 0), at(0, 1)], [at(1, 0), at(1, 1)]];
                worst.take(i * self.size[1] + j, report::hexahedron(corners));
            }
            worst
        };
        let rows: Vec<Worst> = (0..cells[0]).into_par_iter().map(row).collect();
        rows.into_iter().fold(Worst::none(), Worst::worse)
    }
}

impl<T: Real> SurfaceFront<T> {
    /// For each node the first one at the same place of the wall, as at poles and along wakes.
    fn distinct_nodes(&self) -> Vec<usize> {
        let mut first = HashMap::new();
        let key = |p: &Vec3<T>| p.re().to_array().map(|x| (x + 0.0).to_bits());
        let each = self.wall.iter().enumerate();
        each.map(|(k, p)| *first.entry(key(p)).or_insert(k)).collect()
    }

    /// The cells of a layer: layer and node of their corners.
    fn layer_quads(&self, layer: usize) -> Vec<[[usize; 2]; 4]> {
        let [m, n] = self.size;
        let cells = [0, 1].map(|axis| self.size[axis] - usize::from(!self.closed[axis]));
        let node = |i: usize, j: usize| [layer, i % m * n + j % n];
        let row = |i: usize| {
            (0..cells[1])
                .map(move |j| [node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)])
        };
        (0..cells[0]).flat_map(row).collect()
    }

    /// The cells of the sides that are not closed, between the wall and a layer.
    fn side_quads(&self, last: usize) -> Vec<[[usize; 2]; 4]> {
        let mut quads = Vec::new();
        for axis in [0, 1].into_iter().filter(|&axis| !self.closed[axis]) {
            let other = 1 - axis;
            let count = self.size[other];
            for line in [0, self.size[axis] - 1] {
                let node = |layer: usize, k: usize| [layer, self.index(other, k % count, line)];
                for k in 0..count - usize::from(!self.closed[other]) {
                    let strip = (0..last)
                        .map(|l| [node(l, k), node(l, k + 1), node(l + 1, k + 1), node(l + 1, k)]);
                    quads.extend(strip);
                }
            }
        }
        quads
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
        let mut volumes = plain.clone();
        for axis in 0..2 {
            // A line that ends in a pole has no volume there.
            if self.has_pole(axis) {
                continue;
            }
            let reach: Vec<T> = nodes
                .iter()
                .map(|node| match node.pole {
                    true => T::zero(),
                    false => s * d * 2.0 / (node.ways[axis].length() * node.ways[axis].length()),
                })
                .collect();
            self.smoothed(axis, &reach, &mut volumes);
        }
        let heights = (0..r.len()).map(|k| {
            if nodes[k].pole {
                return d;
            }
            let mut share = volumes[k] / plain[k];
            if let Some(cap) = cap {
                let converges = (0..2).any(|axis| {
                    let [next, last] = self.neighbours(before, k, axis);
                    let then = (next - before[k]).norm() + (last - before[k]).norm();
                    let lengths = nodes[k].ways[axis].lengths;
                    then.re() > (lengths[0] + lengths[1]).re() * 1.0001
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

    /// Gives the nodes of a pole one step, along the mean of the ring beside it.
    fn lead_poles(&self, d: T, moved: &mut [Vec3<T>]) {
        for (k, unit) in self.pole_directions(moved) {
            moved[k] = unit * d;
        }
    }

    /// The factor of one axis solved on all its lines.
    fn solved(
        &self,
        axis: usize,
        equations: &[Equation<T>],
        right: Vec<Vec3<T>>,
        budget: &Budget,
    ) -> Vec<Vec3<T>> {
        let (count, lines) = (self.size[axis], self.size[1 - axis]);
        let solve = |line: usize| -> Vec<Vec3<T>> {
            if budget.is_spent() {
                return vec![Vec3::zero(); count];
            }
            let mut system = BlockTridiagonal::unit(count);
            for k in 0..count {
                let at = self.index(axis, k, line);
                system.right[k] = right[at];
                let Some(coupling) = &equations[at].coupling else { continue };
                let (term, implicit) = &coupling[axis];
                let half = term.map(|row| row.map(|x| x * 0.5));
                let (mut low, mut high) = (half.map(|row| row.map(|x| -x)), half);
                for a in 0..3 {
                    low[a][a] -= *implicit;
                    high[a][a] -= *implicit;
                    system.middle[k][a][a] += *implicit * 2.0;
                }
                let first = k == 0 && !self.closed[axis];
                let last = k + 1 == count && !self.closed[axis];
                if first {
                    self.close_end(axis, 0, &mut system.middle[k], &low, &mut high);
                } else {
                    system.low[k] = low;
                }
                if last {
                    let mut inner = system.low[k];
                    self.close_end(axis, 1, &mut system.middle[k], &high, &mut inner);
                    system.low[k] = inner;
                } else {
                    system.high[k] = high;
                }
            }
            system.solved(self.closed[axis])
        };
        let solved: Vec<Vec<Vec3<T>>> = (0..lines).into_par_iter().map(solve).collect();
        let mut moved = right;
        for (line, solved) in solved.into_iter().enumerate() {
            for (k, step) in solved.into_iter().enumerate() {
                moved[self.index(axis, k, line)] = step;
            }
        }
        moved
    }

    /// The unknown beyond an end: the same step as the end's own, or its mirror image.
    fn close_end(
        &self,
        axis: usize,
        end: usize,
        middle: &mut Matrix<T>,
        outer: &Matrix<T>,
        inner: &mut Matrix<T>,
    ) {
        let (target, term) = match self.side(axis, end) {
            MarchBoundary::Symmetry(plane) => (inner, mirrored(outer, plane)),
            _ => (middle, *outer),
        };
        for a in 0..3 {
            for b in 0..3 {
                target[a][b] += term[a][b];
            }
        }
    }
}
