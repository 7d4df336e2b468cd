//! Nearest points of one surface for many points: everything that does not depend on the point is
//! computed beforehand.

use crate::nearest::nearest_in_surface;
use crate::pieces::{Patch, distance_sq};
use crate::tree::{Boxes, SurfaceTree};
use moldloft_num::{Box3, Surface, Vec3};

/// A part of a piece, in powers of its own parameters s and t in [-1, 1].
#[derive(Clone, Debug)]
struct Cell {
    uv: [[f64; 2]; 2],
    /// Coefficient of s^a t^b at [a * 4 + b].
    powers: [Vec3; 16],
    /// How far the cell may be from the parallelogram c + a s + b t.
    bend: f64,
    /// Products of its sides, for the nearest point of the parallelogram.
    aa: f64,
    ab: f64,
    bb: f64,
    /// Bounds of first, second and third derivatives.
    bounds: [f64; 3],
}

/// A surface prepared for many nearest-point questions.
///
/// On surfaces that are cubic pieces exactly (B-splines up to degree three) the answer is the
/// nearest point of all: cells are left out only when a bound of their distance exceeds the best,
/// and a foot in a cell counts as its only one only when the second derivatives of the distance are
/// certainly positive there. On other surfaces each answer comes from the general search.
#[derive(Clone, Debug)]
pub struct NearestSurface {
    tree: SurfaceTree,
    cells: Vec<Cell>,
    boxes: Boxes,
}

impl Cell {
    fn new(patch: &Patch) -> Self {
        let line = |b: [Vec3; 4]| -> [Vec3; 4] {
            // Bernstein on [0, 1] to powers of s = 2 x - 1.
            let [a, b, c, d] = b;
            [
                (a + b * 3.0 + c * 3.0 + d) * 0.125,
                (d + c - b - a) * 0.375 + Vec3::zero(),
                (a - b - c + d) * 0.375,
                (d - c * 3.0 + b * 3.0 - a) * 0.125,
            ]
        };
        let mut powers = [Vec3::zero(); 16];
        for i in 0..4 {
            let row = line([0, 1, 2, 3].map(|j| patch.net[i * 4 + j]));
            powers[i * 4..i * 4 + 4].copy_from_slice(&row);
        }
        for j in 0..4 {
            let column = line([0, 1, 2, 3].map(|i| powers[i * 4 + j]));
            for i in 0..4 {
                powers[i * 4 + j] = column[i];
            }
        }
        let size = |a: usize, b: usize| powers[a * 4 + b].norm();
        let mut bend = 0.0;
        let mut bounds = [[0.0; 3]; 3];
        let falling = |n: usize, k: usize| (0..k).map(|i| n as f64 - i as f64).product::<f64>();
        for a in 0..4 {
            for b in 0..4 {
                if a + b > 1 {
                    bend += size(a, b);
                }
                for (order, row) in bounds.iter_mut().enumerate() {
                    for k in 0..=order + 1 {
                        let l = order + 1 - k;
                        let factor = falling(a, k).max(0.0) * falling(b, l).max(0.0);
                        let slot = k.min(2);
                        row[slot] += factor * size(a, b);
                    }
                }
            }
        }
        let most = |row: [f64; 3]| row.into_iter().fold(0.0, f64::max);
        let (a, b) = (powers[4], powers[1]);
        Cell {
            uv: patch.uv,
            powers,
            bend: bend + patch.slack,
            aa: a.norm_sq(),
            ab: a.dot(b),
            bb: b.norm_sq(),
            bounds: bounds.map(most),
        }
    }

    /// Position, first and second derivatives at (s, t).
    #[inline]
    fn jet(&self, s: f64, t: f64) -> [Vec3; 6] {
        let mut out = [Vec3::zero(); 6];
        for i in (0..4).rev() {
            let c = &self.powers[i * 4..i * 4 + 4];
            let f = ((c[3] * t + c[2]) * t + c[1]) * t + c[0];
            let d = (c[3] * (3.0 * t) + c[2] * 2.0) * t + c[1];
            let dd = c[3] * (6.0 * t) + c[2] * 2.0;
            // p, s, t, ss, st, tt by Horner's rule with derivatives.
            out[3] = out[3] * s + out[1] * 2.0;
            out[1] = out[1] * s + out[0];
            out[0] = out[0] * s + f;
            out[4] = out[4] * s + out[2];
            out[2] = out[2] * s + d;
            out[5] = out[5] * s + dd;
        }
        out
    }
}

/// The nearest point to `q` of the parallelogram a s + b t over |s|, |t| <= h, and the square of
/// its distance.
#[inline]
fn nearest_flat(q: Vec3, a: Vec3, b: Vec3, [aa, ab, bb]: [f64; 3], h: f64) -> ([f64; 2], f64) {
    let (qa, qb) = (q.dot(a), q.dot(b));
    let det = aa * bb - ab * ab;
    let clamp = |x: f64| if x.is_finite() { x.clamp(-h, h) } else { 0.0 };
    let (s, t) = ((qa * bb - qb * ab) / det, (qb * aa - qa * ab) / det);
    let off = |s: f64, t: f64| (q - a * s - b * t).norm_sq();
    if det > 0.0 && s.abs() <= h && t.abs() <= h {
        return ([s, t], off(s, t));
    }
    // The least lies on a side that the free one is beyond.
    let s1 = clamp(s);
    let t1 = clamp((qb - ab * s1) / bb);
    let t2 = clamp(t);
    let s2 = clamp((qa - ab * t2) / aa);
    let (d1, d2) = (off(s1, t1), off(s2, t2));
    if d1 <= d2 { ([s1, t1], d1) } else { ([s2, t2], d2) }
}

/// A patch in four.
fn quarters(patch: &Patch) -> [Patch; 4] {
    let [[a, b], [c, d]] = patch.halves(0).map(|half| half.halves(1));
    [a, b, c, d]
}

/// The best foot so far.
#[derive(Clone, Copy)]
struct Best {
    distance: f64,
    uv: [f64; 2],
}

impl NearestSurface {
    /// Prepares a surface.
    pub fn new(surface: &dyn Surface<f64>) -> Self {
        let tree = SurfaceTree::new(surface);
        let mut cells = Vec::new();
        let mut bounds = Vec::new();
        if tree.exact {
            for patch in &tree.patches {
                for cell in quarters(patch).iter().flat_map(quarters) {
                    bounds.push(cell.bounds());
                    cells.push(Cell::new(&cell));
                }
            }
        }
        let boxes = Boxes::new(&bounds, 1);
        Self { tree, cells, boxes }
    }

    /// The parameters of the nearest point of the surface, and its distance.
    pub fn nearest(&self, surface: &dyn Surface<f64>, p: Vec3) -> ([f64; 2], f64) {
        if self.cells.is_empty() {
            let found = nearest_in_surface(surface, &self.tree, p, None);
            let [u, v] = found.at;
            let x = surface.jet(u, v, moldloft_num::Order::Zero).p;
            return (found.at, x.distance(p));
        }
        let mut best = Best { distance: f64::INFINITY, uv: [0.5; 2] };
        // Depth first, the nearer child first; depths are the logarithm of the number of cells.
        let mut stack = [(0.0, 0u32); 64];
        let mut top = 1;
        let nodes = &self.boxes.nodes;
        stack[0] = (distance_sq(&nodes[0].bounds, p), 0);
        while top > 0 {
            top -= 1;
            let (low, at) = stack[top];
            if low >= best.distance * best.distance {
                continue;
            }
            let node = &nodes[at as usize];
            if node.count > 0 {
                let cell = &self.cells[self.boxes.order[node.first as usize] as usize];
                self.search(cell, p, &mut best);
                continue;
            }
            let children = [at + 1, node.first];
            let d = children.map(|k| distance_sq(&nodes[k as usize].bounds, p));
            let near = usize::from(d[1] < d[0]);
            for k in [1 - near, near] {
                if d[k] < best.distance * best.distance {
                    stack[top] = (d[k], children[k]);
                    top += 1;
                }
            }
        }
        (best.uv, best.distance)
    }

    fn search(&self, cell: &Cell, p: Vec3, best: &mut Best) {
        let (a, b) = (cell.powers[4], cell.powers[1]);
        let products = [cell.aa, cell.ab, cell.bb];
        let (st, flat) = nearest_flat(p - cell.powers[0], a, b, products, 1.0);
        if flat.sqrt() - cell.bend >= best.distance {
            return;
        }
        if flat.sqrt() < best.distance {
            self.descend(cell, p, st, [-1.0, -1.0], [1.0, 1.0], best);
        }
        self.divide(cell, p, [0.0, 0.0], 1.0, best, 0);
    }

    /// Makes sure that no nearer foot is in the square of half side `h` about `c`.
    fn divide(&self, cell: &Cell, p: Vec3, c: [f64; 2], h: f64, best: &mut Best, depth: u32) {
        let [x, s, t, ss, st, tt] = cell.jet(c[0], c[1]);
        let products = [s.norm_sq(), s.dot(t), t.norm_sq()];
        let [_, second, third] = cell.bounds;
        let (local, flat) = nearest_flat(p - x, s, t, products, h);
        let bend = 2.0 * second * h * h;
        if flat.sqrt() - bend >= best.distance * (1.0 - 1e-14) {
            return;
        }
        // The second derivatives of half the square of the distance, and how much they change.
        let r = x - p;
        let (m11, m12, m22) =
            (products[0] + ss.dot(r), products[1] + st.dot(r), products[2] + tt.dot(r));
        let far = r.norm() + cell.bounds[0] * 2.0 * h;
        // Where the distance falls towards one side all over the square, its least is there: in the
        // neighbour, unless that is an edge of the surface.
        let slopes = [s.dot(r), t.dot(r)];
        let wobble = 2.0 * h * (cell.bounds[0] * cell.bounds[0] + far * second);
        let mut to_edge = [false; 2];
        for k in 0..2 {
            if slopes[k].abs() > wobble {
                let edge = if slopes[k] > 0.0 {
                    c[k] - h <= -1.0 && cell.uv[k][0] <= 0.0
                } else {
                    c[k] + h >= 1.0 && cell.uv[k][1] >= 1.0
                };
                if !edge {
                    return;
                }
                to_edge[k] = true;
            }
        }
        let change = 4.0 * h * (3.0 * second * cell.bounds[0] + far * third);
        let (mean, half) = (0.5 * (m11 + m22), 0.5 * (m11 - m22));
        let least = mean - (half * half + m12 * m12).sqrt();
        let start = [c[0] + local[0], c[1] + local[1]];
        let one = match to_edge {
            [true, true] => true,
            [true, false] => m22 > change,
            [false, true] => m11 > change,
            _ => least > change,
        };
        if one || depth >= 16 {
            let low = [c[0] - h, c[1] - h];
            let high = [c[0] + h, c[1] + h];
            self.descend(cell, p, start, low, high, best);
            return;
        }
        let q = 0.5 * h;
        for (a, b) in [(-q, -q), (-q, q), (q, -q), (q, q)] {
            self.divide(cell, p, [c[0] + a, c[1] + b], q, best, depth + 1);
        }
    }

    /// Newton's method for the foot in a box of the cell.
    fn descend(
        &self,
        cell: &Cell,
        p: Vec3,
        start: [f64; 2],
        low: [f64; 2],
        high: [f64; 2],
        best: &mut Best,
    ) {
        let clamp = |q: [f64; 2]| [q[0].clamp(low[0], high[0]), q[1].clamp(low[1], high[1])];
        let mut q = clamp(start);
        for _ in 0..24 {
            let [x, s, t, ss, st, tt] = cell.jet(q[0], q[1]);
            let r = x - p;
            let distance = r.norm();
            if distance < best.distance {
                let [us, vs] = cell.uv;
                let along = |[a, b]: [f64; 2], x: f64| 0.5 * (a + b) + 0.5 * (b - a) * x;
                *best = Best { distance, uv: [along(us, q[0]), along(vs, q[1])] };
            }
            let g = [s.dot(r), t.dot(r)];
            let held =
                [0, 1].map(|k| q[k] <= low[k] && g[k] > 0.0 || q[k] >= high[k] && g[k] < 0.0);
            let (a, b, c) = (s.norm_sq(), s.dot(t), t.norm_sq());
            let (mut m11, mut m12, mut m22) = (a + ss.dot(r), b + st.dot(r), c + tt.dot(r));
            if m11 <= 1e-3 * a || m22 <= 1e-3 * c || m11 * m22 - m12 * m12 <= 1e-6 * a * c {
                (m11, m12, m22) = (a, b, c);
            }
            let step = match held {
                [true, true] => break,
                [true, false] => [0.0, g[1] / m22],
                [false, true] => [g[0] / m11, 0.0],
                _ => {
                    let det = m11 * m22 - m12 * m12;
                    [(g[0] * m22 - m12 * g[1]) / det, (m11 * g[1] - g[0] * m12) / det]
                }
            };
            if !(step[0].is_finite() && step[1].is_finite()) {
                break;
            }
            let next = clamp([q[0] - step[0], q[1] - step[1]]);
            let moved = (next[0] - q[0]).abs().max((next[1] - q[1]).abs());
            q = next;
            if moved < 1e-13 {
                break;
            }
        }
    }

    /// The box around the surface.
    pub fn bounds(&self) -> Box3 {
        self.tree.bounds
    }
}
