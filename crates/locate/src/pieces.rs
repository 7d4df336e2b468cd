//! Curves and surfaces as cubic pieces in Bernstein form, with bounds.
//!
//! Every piece is in the box around its control points, widened by its `slack`. Between the joints
//! of a shape, a piece that is a polynomial of degree three or less in each parameter is
//! represented exactly (slack of rounding): this holds for all B-splines up to the cubic, and
//! searches on it then miss nothing. Other shapes are interpolated and split until they are
//! accurate; their slack is twice the largest error at points between the nodes, which is a
//! measurement and no proof.

use moldloft_num::{Box3, Curve, Order, Surface, Vec3};

/// Accuracy at which pieces are not split further, relative to the size …
const CLOSE: f64 = 1e-5;

/// … but no more often than this,
const DEEPEST: u32 = 6;

/// and no more than this many times altogether.
const MOST_PIECES: usize = 1 << 13;

/// A cubic piece of a curve.
#[derive(Clone, Copy, Debug)]
pub struct CurvePiece {
    /// The range of its parameters on the curve.
    pub t: [f64; 2],
    /// Bernstein control points.
    pub net: [Vec3; 4],
    /// Bound on the distance of the curve from the piece.
    pub slack: f64,
    /// The range of the measured piece that it covers, for the slack.
    pub share: f64,
    /// For each end, true if the curve may end or change its direction there: an end or a corner.
    pub open: [bool; 2],
}

/// A bicubic piece of a surface.
#[derive(Clone, Copy, Debug)]
pub struct BezierPatch {
    /// The ranges of its parameters on the surface: start and end in u, start and end in v.
    pub uv: [[f64; 2]; 2],
    /// Bernstein control points, [i * 4 + j] with i along u.
    pub net: [Vec3; 16],
    /// Bound on the distance of the surface from the piece.
    pub slack: f64,
    /// The ranges, along u and v, of the measured piece that it covers, for the slack.
    pub share: [f64; 2],
    /// For each side (low and high in u, then in v), true if the surface may end or change its
    /// direction there: an edge or a crease.
    pub open: [[bool; 2]; 2],
}

/// Bernstein coefficients of the cubic through values at 0, 1/3, 2/3, 1.
#[inline]
pub fn through(f: [Vec3; 4]) -> [Vec3; 4] {
    let b1 = (f[1] * 18.0 - f[0] * 5.0 - f[2] * 9.0 + f[3] * 2.0) * (1.0 / 6.0);
    let b2 = (f[0] * 2.0 - f[1] * 9.0 + f[2] * 18.0 - f[3] * 5.0) * (1.0 / 6.0);
    [f[0], b1, b2, f[3]]
}

/// The cubic at `t` in [0, 1], by de Casteljau's scheme.
#[inline]
pub fn cubic(b: &[Vec3], t: f64) -> Vec3 {
    let s = 1.0 - t;
    let (a, m, z) = (b[0] * s + b[1] * t, b[1] * s + b[2] * t, b[2] * s + b[3] * t);
    (a * s + m * t) * s + (m * s + z * t) * t
}

/// Both halves of a cubic.
#[inline]
pub fn halves(b: [Vec3; 4]) -> [[Vec3; 4]; 2] {
    let mid = |p: Vec3, q: Vec3| (p + q) * 0.5;
    let (a, m, z) = (mid(b[0], b[1]), mid(b[1], b[2]), mid(b[2], b[3]));
    let (l, r) = (mid(a, m), mid(m, z));
    let c = mid(l, r);
    [[b[0], a, l, c], [c, r, z, b[3]]]
}

impl CurvePiece {
    /// The box around it, slack included.
    pub fn bounds(&self) -> Box3 {
        widened(Box3::around(self.net), self.slack)
    }

    /// Both halves.
    pub fn halves(&self) -> [Self; 2] {
        let [a, b] = halves(self.net);
        let m = 0.5 * (self.t[0] + self.t[1]);
        let share = 0.5 * self.share;
        let [first, last] = self.open;
        [
            Self { t: [self.t[0], m], net: a, share, open: [first, false], ..*self },
            Self { t: [m, self.t[1]], net: b, share, open: [false, last], ..*self },
        ]
    }

    /// Distance of the inner control points from the thirds of the chord: a bound on the distance
    /// from a line with constant speed, and on the turn of the tangent.
    pub fn bend(&self) -> f64 {
        let [a, b, c, d] = self.net;
        let third = (d - a) * (1.0 / 3.0);
        (b - a - third).norm().max((c - d + third).norm())
    }
}

impl BezierPatch {
    /// The box around it, slack included.
    pub fn bounds(&self) -> Box3 {
        widened(Box3::around(self.net), self.slack)
    }

    /// Both halves along axis 0 (u) or 1 (v).
    pub fn halves(&self, axis: usize) -> [Self; 2] {
        let mut out = [*self, *self];
        for k in 0..4 {
            let at = |i: usize| if axis == 0 { i * 4 + k } else { k * 4 + i };
            let [a, b] = halves([0, 1, 2, 3].map(|i| self.net[at(i)]));
            for i in 0..4 {
                out[0].net[at(i)] = a[i];
                out[1].net[at(i)] = b[i];
            }
        }
        let m = 0.5 * (self.uv[axis][0] + self.uv[axis][1]);
        out[0].uv[axis][1] = m;
        out[1].uv[axis][0] = m;
        out[0].open[axis][1] = false;
        out[1].open[axis][0] = false;
        out.iter_mut().for_each(|half| half.share[axis] *= 0.5);
        out
    }

    /// The centre of its parameters.
    pub fn middle(&self) -> [f64; 2] {
        self.uv.map(|[a, b]| 0.5 * (a + b))
    }

    /// Approximate lengths of its sides along u and v: the longest legs of the control net.
    pub fn lengths(&self) -> [f64; 2] {
        let n = &self.net;
        let leg = |a: usize, b: usize| n[a].distance(n[b]);
        [leg(0, 12).max(leg(3, 15)), leg(0, 3).max(leg(12, 15))]
    }

    /// Distance of its control points from those of the parallelogram of three of its corners: a
    /// bound on the distance from an affine map.
    pub fn bend(&self) -> f64 {
        let n = &self.net;
        let centre = (n[0] + n[3] + n[12] + n[15]) * 0.25;
        let a = (n[12] + n[15] - n[0] - n[3]) * 0.25;
        let b = (n[3] + n[15] - n[0] - n[12]) * 0.25;
        let mut most: f64 = 0.0;
        for i in 0..4 {
            for j in 0..4 {
                let at = |k: usize| (2 * k) as f64 / 3.0 - 1.0;
                let flat = centre + a * at(i) + b * at(j);
                most = most.max(n[i * 4 + j].distance(flat));
            }
        }
        most
    }
}

/// Number of minima of the distance from a point to a piece, as proved by bounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Feet {
    /// The minimum is on a border with a neighbouring piece, which contains it too.
    Elsewhere,
    /// There is at most one minimum.
    One,
    /// Not known.
    Unknown,
}

impl CurvePiece {
    /// Bounds the number of minima of the distance from `p`, by its derivatives and their change
    /// along the piece.
    pub fn feet(&self, p: Vec3) -> Feet {
        let b = &self.net;
        let first = [0, 1, 2].map(|k| (b[k + 1] - b[k]) * 3.0);
        let second = [0, 1].map(|k| (first[k + 1] - first[k]) * 2.0);
        let (x, r) = ball(b);
        let (d, v1) = ball(&first);
        let (dd, v2) = ball(&second);
        // An error between nodes of size s has slopes of some 10 s and curvatures of 40 s.
        let (s, w) = (self.slack, self.share);
        let (r, v1, v2) = (r + s, v1 + 10.0 * s * w, v2 + 40.0 * s * w * w);
        let away = x - p;
        let far = away.norm();
        let slope = d.dot(away);
        if slope.abs() > d.norm() * r + v1 * (far + r) {
            let end = self.open[usize::from(slope < 0.0)];
            return if end { Feet::One } else { Feet::Elsewhere };
        }
        let curvature = d.norm_sq() + dd.dot(away);
        let change = 2.0 * d.norm() * v1 + v1 * v1 + far * v2 + r * (dd.norm() + v2);
        if curvature > change { Feet::One } else { Feet::Unknown }
    }
}

/// A centre of a set of points, and their maximum distance from it.
pub(crate) fn ball(all: &[Vec3]) -> (Vec3, f64) {
    let c = Box3::around(all.iter().copied()).centre();
    (c, all.iter().map(|q| (*q - c).norm_sq()).fold(0.0, f64::max).sqrt())
}

impl BezierPatch {
    /// See [`CurvePiece::feet`].
    pub fn feet(&self, p: Vec3) -> Feet {
        let n = &self.net;
        let mut du = [Vec3::zero(); 12];
        let mut dv = [Vec3::zero(); 12];
        for j in 0..4 {
            for i in 0..3 {
                du[i * 4 + j] = (n[(i + 1) * 4 + j] - n[i * 4 + j]) * 3.0;
                dv[j * 3 + i] = (n[j * 4 + i + 1] - n[j * 4 + i]) * 3.0;
            }
        }
        let mut duu = [Vec3::zero(); 8];
        let mut dvv = [Vec3::zero(); 8];
        let mut duv = [Vec3::zero(); 9];
        for i in 0..2 {
            for j in 0..4 {
                duu[i * 4 + j] = (du[(i + 1) * 4 + j] - du[i * 4 + j]) * 2.0;
                dvv[j * 2 + i] = (dv[j * 3 + i + 1] - dv[j * 3 + i]) * 2.0;
            }
        }
        for i in 0..3 {
            for j in 0..3 {
                duv[i * 3 + j] = (du[i * 4 + j + 1] - du[i * 4 + j]) * 3.0;
            }
        }
        let with = |all: &[Vec3], slack: f64| {
            let (c, r) = ball(all);
            (c, r + slack)
        };
        let (s, [w, z]) = (self.slack, self.share);
        let (x, r) = with(n, s);
        let (a, b) = (with(&du, 10.0 * s * w), with(&dv, 10.0 * s * z));
        let uu = with(&duu, 40.0 * s * w * w);
        let uv = with(&duv, 40.0 * s * w * z);
        let vv = with(&dvv, 40.0 * s * z * z);
        let away = x - p;
        let far = away.norm();
        // If the distance decreases towards one side all over the piece, the minimum is on that
        // side.
        let mut to_edge = [false; 2];
        for (k, (d, reach)) in [a, b].into_iter().enumerate() {
            let slope = d.dot(away);
            if slope.abs() > d.norm() * r + reach * (far + r) {
                if !self.open[k][usize::from(slope < 0.0)] {
                    return Feet::Elsewhere;
                }
                to_edge[k] = true;
            }
        }
        let entry = |d: (Vec3, f64), e: (Vec3, f64), dd: (Vec3, f64)| {
            let value = d.0.dot(e.0) + dd.0.dot(away);
            let change = d.0.norm() * e.1
                + e.0.norm() * d.1
                + d.1 * e.1
                + far * dd.1
                + r * (dd.0.norm() + dd.1);
            (value, change)
        };
        let (h11, c11) = entry(a, a, uu);
        let (h22, c22) = entry(b, b, vv);
        let (l11, l22) = (h11 - c11, h22 - c22);
        let one = match to_edge {
            [true, true] => true,
            [true, false] => l22 > 0.0,
            [false, true] => l11 > 0.0,
            [false, false] => {
                let (h12, c12) = entry(a, b, uv);
                let m12 = h12.abs() + c12;
                l11 > 0.0 && l22 > 0.0 && l11 * l22 > m12 * m12
            }
        };
        if one { Feet::One } else { Feet::Unknown }
    }
}

/// The box with its sides moved outward.
pub fn widened(b: Box3, by: f64) -> Box3 {
    let d = Vec3::of(by, by, by);
    Box3 { low: b.low - d, high: b.high + d }
}

/// True when the boxes have a point in common.
#[inline]
pub fn meet(a: &Box3, b: &Box3) -> bool {
    a.low.x <= b.high.x
        && b.low.x <= a.high.x
        && a.low.y <= b.high.y
        && b.low.y <= a.high.y
        && a.low.z <= b.high.z
        && b.low.z <= a.high.z
}

/// Square of the distance from `p` to the box.
#[inline]
pub fn distance_sq(b: &Box3, p: Vec3) -> f64 {
    let out = |low: f64, high: f64, x: f64| (low - x).max(x - high).max(0.0);
    let d = Vec3::of(
        out(b.low.x, b.high.x, p.x),
        out(b.low.y, b.high.y, p.y),
        out(b.low.z, b.high.z, p.z),
    );
    d.norm_sq()
}

/// The reference length of accuracies: the diagonal of the box, plus a fraction of its distance
/// from the origin, because every coordinate contains that rounding.
pub fn size_of(b: &Box3) -> f64 {
    let far = b.low.norm().max(b.high.norm());
    let size = b.diagonal() + 1e-3 * far;
    if size > 0.0 { size } else { 1.0 }
}

/// 0, the breaks strictly inside, 1.
fn with_ends(breaks: Vec<f64>) -> Vec<f64> {
    let mut all = vec![0.0];
    all.extend(breaks.into_iter().filter(|t| *t > 1e-12 && *t < 1.0 - 1e-12));
    all.push(1.0);
    all.dedup();
    all
}

/// Sample parameters of a piece: the nodes of its cubic, and points between them.
const NODES: [f64; 4] = [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0];
const BETWEEN: [f64; 3] = [1.0 / 6.0, 0.5, 5.0 / 6.0];

fn along([a, b]: [f64; 2], s: f64) -> f64 {
    if s == 1.0 { b } else { a + (b - a) * s }
}

/// The pieces of a curve, in the order of t.
pub fn curve_pieces(curve: &dyn Curve<f64>) -> Vec<CurvePiece> {
    let ends = with_ends(curve.joints());
    let mut todo: Vec<([f64; 2], u32)> = ends.windows(2).rev().map(|w| ([w[0], w[1]], 0)).collect();
    let at_break = |t: f64| ends.contains(&t);
    let mut done = Vec::new();
    let mut bounds = Box3::EMPTY;
    while let Some((t, depth)) = todo.pop() {
        let mut ts = [0.0; 7];
        for (k, s) in NODES.iter().chain(&BETWEEN).enumerate() {
            ts[k] = along(t, *s);
        }
        let mut x = [Vec3::zero(); 7];
        curve.grid(&ts, &mut x);
        bounds = x.into_iter().fold(bounds, Box3::including);
        let net = through([x[0], x[1], x[2], x[3]]);
        let error = BETWEEN.iter().zip(&x[4..]).map(|(s, p)| cubic(&net, *s).distance(*p));
        let error = error.fold(0.0, f64::max);
        // A short curve may hide a bend between the samples of one piece.
        let enough =
            error <= CLOSE * bounds.diagonal() && (error < 1e-13 * bounds.diagonal() || depth > 1);
        if enough || depth >= DEEPEST + 4 || done.len() + todo.len() >= MOST_PIECES {
            let open = t.map(at_break);
            done.push(CurvePiece { t, net, slack: 2.0 * error, share: 1.0, open });
        } else {
            let m = 0.5 * (t[0] + t[1]);
            todo.push(([m, t[1]], depth + 1));
            todo.push(([t[0], m], depth + 1));
        }
    }
    let size = size_of(&bounds);
    for k in 1..done.len() {
        let (a, b) = (done[k - 1], done[k]);
        let slopes = [
            (a.net[3] - a.net[2]) * (3.0 / (a.t[1] - a.t[0])),
            (b.net[1] - b.net[0]) * (3.0 / (b.t[1] - b.t[0])),
        ];
        if a.slack.max(b.slack) <= SMOOTH * size && alike(slopes) {
            done[k - 1].open[1] = false;
            done[k].open[0] = false;
        }
    }
    for piece in &mut done {
        piece.slack += 1e-15 * size;
    }
    done
}

/// Slack of pieces, relative to the size, below which they determine whether the tangents on both
/// sides of a border are equal.
const SMOOTH: f64 = 1e-9;

/// True when two tangents are the same, to rounding.
fn alike([a, b]: [Vec3; 2]) -> bool {
    a.distance(b) <= 1e-7 * a.norm().max(b.norm())
}

/// The pieces of a surface: the cells of the grid of breaks, in order.
pub fn patches(surface: &dyn Surface<f64>) -> Vec<BezierPatch> {
    let [us, vs] = surface.joints().map(with_ends);
    // All cells at once: surfaces have fast grids.
    let fine = |ends: &[f64]| -> Vec<f64> {
        let spans = ends.windows(2);
        spans.flat_map(|w| [0, 4, 1, 5, 2, 6, 3].map(|k| place([w[0], w[1]], k))).collect()
    };
    let (all_u, all_v) = (fine(&us), fine(&vs));
    let mut x = vec![Vec3::zero(); all_u.len() * all_v.len()];
    surface.grid(&all_u, &all_v, &mut x, None);
    let bounds = Box3::around(x.iter().copied());
    let size = bounds.diagonal();
    let mut cells = Vec::with_capacity((us.len() - 1) * (vs.len() - 1));
    let columns = all_v.len();
    let mut budget = MOST_PIECES.max(2 * (us.len() - 1) * (vs.len() - 1));
    for (i, wu) in us.windows(2).enumerate() {
        for (j, wv) in vs.windows(2).enumerate() {
            let uv = [[wu[0], wu[1]], [wv[0], wv[1]]];
            let mut samples = [Vec3::zero(); 49];
            for a in 0..7 {
                let row = (i * 7 + a) * columns + j * 7;
                samples[a * 7..a * 7 + 7].copy_from_slice(&x[row..row + 7]);
            }
            cells.push(fit(uv, &samples));
        }
    }
    mark_smooth(&mut cells, vs.len() - 1, size);
    let mut done = Vec::with_capacity(cells.len());
    for (patch, errors) in cells {
        split(surface, patch, errors, size, 0, &mut budget, &mut done);
    }
    let rounding = 1e-15 * size_of(&bounds);
    for patch in &mut done {
        patch.slack += rounding;
    }
    done
}

/// Clears the marks of the sides across which the tangents of neighbouring patches agree. The
/// patches are those of a grid with `columns` along v.
fn mark_smooth(cells: &mut [(BezierPatch, [f64; 2])], columns: usize, size: f64) {
    for k in 0..cells.len() {
        for axis in 0..2 {
            let next = if axis == 0 { k + columns } else { k + 1 };
            if next >= cells.len() || axis == 1 && next % columns == 0 {
                continue;
            }
            let (a, b) = (&cells[k].0, &cells[next].0);
            let width = |p: &BezierPatch| p.uv[axis][1] - p.uv[axis][0];
            let same = |i: usize| {
                let at = |row: usize| if axis == 0 { row * 4 + i } else { i * 4 + row };
                let before = (a.net[at(3)] - a.net[at(2)]) * (3.0 / width(a));
                let after = (b.net[at(1)] - b.net[at(0)]) * (3.0 / width(b));
                alike([before, after])
            };
            if a.slack.max(b.slack) <= SMOOTH * size && (0..4).all(same) {
                cells[k].0.open[axis][1] = false;
                cells[next].0.open[axis][0] = false;
            }
        }
    }
}

/// The k-th sample parameter of a span: the nodes first.
fn place(span: [f64; 2], k: usize) -> f64 {
    along(span, if k < 4 { NODES[k] } else { BETWEEN[k - 4] })
}

/// The bicubic through the nodes among 7 x 7 samples in ascending order, with slack; and the
/// largest error between nodes that is due to the u and to the v direction.
fn fit(uv: [[f64; 2]; 2], samples: &[Vec3; 49]) -> (BezierPatch, [f64; 2]) {
    let at = |a: usize, b: usize| samples[a * 7 + b];
    let mut net = [Vec3::zero(); 16];
    for i in 0..4 {
        let row = through([at(2 * i, 0), at(2 * i, 2), at(2 * i, 4), at(2 * i, 6)]);
        net[i * 4..i * 4 + 4].copy_from_slice(&row);
    }
    for j in 0..4 {
        let column = through([net[j], net[4 + j], net[8 + j], net[12 + j]]);
        for i in 0..4 {
            net[i * 4 + j] = column[i];
        }
    }
    let mut errors: [f64; 2] = [0.0; 2];
    let mut most: f64 = 0.0;
    let s = |k: usize| k as f64 / 6.0;
    for a in 0..7 {
        let line =
            [0, 1, 2, 3].map(|j| cubic(&[net[j], net[4 + j], net[8 + j], net[12 + j]], s(a)));
        for b in 0..7 {
            if a % 2 == 0 && b % 2 == 0 {
                continue;
            }
            let error = cubic(&line, s(b)).distance(at(a, b));
            most = most.max(error);
            // On the lines of nodes of one direction only the other one errs.
            if b % 2 == 0 {
                errors[0] = errors[0].max(error);
            } else if a % 2 == 0 {
                errors[1] = errors[1].max(error);
            }
        }
    }
    (BezierPatch { uv, net, slack: 2.0 * most, share: [1.0; 2], open: [[true; 2]; 2] }, errors)
}

fn split(
    surface: &dyn Surface<f64>,
    patch: BezierPatch,
    errors: [f64; 2],
    size: f64,
    depth: u32,
    budget: &mut usize,
    done: &mut Vec<BezierPatch>,
) {
    let error = 0.5 * patch.slack;
    let enough = error <= CLOSE * size && (error < 1e-13 * size || depth > 2);
    if enough || depth >= 2 * DEEPEST || *budget == 0 {
        done.push(patch);
        return;
    }
    *budget -= 1;
    let axis = usize::from(errors[1] > errors[0]);
    let [a, b] = patch.uv[axis];
    let m = 0.5 * (a + b);
    for (k, half) in [[a, m], [m, b]].into_iter().enumerate() {
        let mut uv = patch.uv;
        uv[axis] = half;
        let mut open = patch.open;
        open[axis][1 - k] = false;
        let places = |span: [f64; 2]| [0, 4, 1, 5, 2, 6, 3].map(|k| place(span, k));
        let mut samples = [Vec3::zero(); 49];
        surface.grid(&places(uv[0]), &places(uv[1]), &mut samples, None);
        let (patch, errors) = fit(uv, &samples);
        split(surface, BezierPatch { open, ..patch }, errors, size, depth + 1, budget, done);
    }
}

/// Position and derivatives of the curve at the real parameter.
pub fn curve_point(curve: &dyn Curve<f64>, t: f64) -> Vec3 {
    curve.jet(t, Order::Zero)[0]
}
