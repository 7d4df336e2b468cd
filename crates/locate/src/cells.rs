//! A surface as small, nearly flat cells, with bounds of their curvature, for repeated searches on
//! the same surface.
//!
//! `pieces -> cells -> tree of boxes`
//!
//! The piece of a cell has the polynomial; the cell has a parallelogram, the second derivatives at
//! its centre, and bounds of the remainder. A first test uses the parallelogram only, which is
//! therefore stored separately.

use crate::pieces::BezierPatch;
use crate::tree::{Boxes, SurfaceTree};
use moldloft_num::{Box3, Order, SurfJet, Surface, Vec3};
use pulp::WithSimd;

/// Curvature relative to their length up to which pieces are halved, for nearest points, for many
/// intersections, and for one …
const BEND: f64 = 0.06;
const FINE_BEND: f64 = 0.05;
const COARSE_BEND: f64 = 0.12;

/// … but into no more cells than this, each and altogether.
pub(crate) const MOST_HALVINGS: u32 = 6;
const MOST_CELLS: usize = 1 << 17;

#[derive(Clone, Copy, Debug)]
pub(crate) struct PolynomialPiece {
    /// Its parameters on the surface.
    pub uv: [[f64; 2]; 2],
    /// Coefficient of s^i t^j at [i * 4 + j], with s and t in [-1, 1].
    pub powers: [Vec3; 16],
    /// Bound of the surface's distance from it.
    pub slack: f64,
}

/// The parallelogram c + a s + b t, |s| and |t| <= 1, and a bound of the surface's distance from
/// it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Flat {
    pub c: Vec3,
    pub a: Vec3,
    pub b: Vec3,
    /// a . a, a . b, b . b.
    pub products: [f64; 3],
    /// One over their determinant, a . a and b . b.
    pub inverses: [f64; 3],
    /// Bound of the distance from the point of equal s and t, slack included.
    pub bend: f64,
}

/// Data of a cell besides its parallelogram.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bent {
    /// Second derivatives by s and t at the middle.
    pub second: [Vec3; 3],
    /// Bounds of the third derivatives sss, sst, stt, ttt of half the square of the distance from
    /// a point: `fixed` + `far` times the greatest distance.
    pub fixed: [f64; 4],
    pub far: [f64; 4],
    /// Maximum distance of the cell's points from its centre.
    pub reach: f64,
    /// Middle and half sides in the piece's own parameters.
    pub middle: [f64; 2],
    pub half: [f64; 2],
    /// The piece.
    pub piece: u32,
    /// See [`BezierPatch::open`].
    pub open: [[bool; 2]; 2],
}

/// Two boxes of a tree, side by side, and their contents.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fork {
    pub bounds: [Box3; 2],
    /// Index of the fork below, or of a cell with [`LEAF`] added.
    pub below: [u32; 2],
}

/// Four boxes of a tree, side by side, and their contents; missing ones are empty boxes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Quad {
    /// By axis.
    low: [[f64; 4]; 3],
    high: [[f64; 4]; 3],
    /// Index of the quad below, or of a cell with [`LEAF`] added.
    pub below: [u32; 4],
}

impl Quad {
    const EMPTY: Quad =
        Quad { low: [[f64::INFINITY; 4]; 3], high: [[f64::NEG_INFINITY; 4]; 3], below: [LEAF; 4] };

    /// Squares of the distances of a point.
    #[inline]
    pub fn distances_sq(&self, p: Vec3) -> [f64; 4] {
        let mut sum = [0.0; 4];
        for axis in 0..3 {
            for k in 0..4 {
                let x = p[axis];
                let d = (self.low[axis][k] - x).max(x - self.high[axis][k]).max(0.0);
                sum[k] += d * d;
            }
        }
        sum
    }
}

/// The same tree with four children each.
fn quads(forks: &[Fork]) -> Vec<Quad> {
    let mut out = Vec::with_capacity(forks.len() / 2 + 1);
    // Forks to be turned into quads, with the entry that waits for their number.
    let mut todo: Vec<(u32, Option<(usize, usize)>)> = Vec::new();
    if !forks.is_empty() {
        todo.push((0, None));
    }
    while let Some((at, parent)) = todo.pop() {
        if let Some((quad, k)) = parent {
            let number: u32 = out.len() as u32;
            let above: &mut Quad = &mut out[quad];
            above.below[k] = number;
        }
        let mut quad = Quad::EMPTY;
        let mut count = 0;
        let number = out.len();
        let mut add = |bounds: &Box3, below: u32| {
            for axis in 0..3 {
                quad.low[axis][count] = bounds.low[axis];
                quad.high[axis][count] = bounds.high[axis];
            }
            quad.below[count] = below;
            if below & LEAF == 0 {
                todo.push((below, Some((number, count))));
            }
            count += 1;
        };
        let fork = &forks[at as usize];
        for (bounds, &below) in fork.bounds.iter().zip(&fork.below) {
            if below & LEAF != 0 {
                add(bounds, below);
            } else {
                let inner = &forks[below as usize];
                (0..2).for_each(|k| add(&inner.bounds[k], inner.below[k]));
            }
        }
        out.push(quad);
    }
    out
}

/// Marks the index of a cell.
pub(crate) const LEAF: u32 = 1 << 31;

/// A surface cut up beforehand.
#[derive(Clone, Debug)]
pub(crate) struct Cells {
    pub tree: SurfaceTree,
    pub pieces: Vec<PolynomialPiece>,
    /// The cells, in the order of the leaves of the tree.
    pub flats: Vec<Flat>,
    pub bents: Vec<Bent>,
    /// The tree, root first; empty for a single cell.
    pub forks: Vec<Fork>,
    /// The tree for nearest points, with four children each.
    pub quads: Vec<Quad>,
    /// Halvings of the pieces, for intersections: the pieces first, in their order.
    pub twigs: Vec<Twig>,
}

/// A piece or a part of one, between pieces and cells.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Twig {
    pub patch: BezierPatch,
    pub piece: u32,
    /// The first of its halves, which follow each other; 0 for a cell.
    pub below: u32,
    /// The cell that it is, if it is one.
    pub cell: u32,
    /// Range in the piece's own parameters.
    place: [[f64; 2]; 2],
}

/// Bernstein coefficients on [0, 1] to powers of s = 2 x - 1.
fn powers([a, b, c, d]: [Vec3; 4]) -> [Vec3; 4] {
    [
        (a + b * 3.0 + c * 3.0 + d) * 0.125,
        (d + c - b - a) * 0.375,
        (a - b - c + d) * 0.375,
        (d - c * 3.0 + b * 3.0 - a) * 0.125,
    ]
}

pub(crate) fn patch_powers(patch: &BezierPatch) -> [Vec3; 16] {
    let mut out = [Vec3::zero(); 16];
    for i in 0..4 {
        out[i * 4..i * 4 + 4].copy_from_slice(&powers([0, 1, 2, 3].map(|j| patch.net[i * 4 + j])));
    }
    for j in 0..4 {
        let column = powers([0, 1, 2, 3].map(|i| out[i * 4 + j]));
        for i in 0..4 {
            out[i * 4 + j] = column[i];
        }
    }
    out
}

/// The derivative of a bicubic in powers by s (axis 0) or t (axis 1).
pub(crate) fn derivative(f: &[Vec3; 16], axis: usize) -> [Vec3; 16] {
    let mut out = [Vec3::zero(); 16];
    for i in 0..4 {
        for j in 0..4 {
            let (k, from) = if axis == 0 { (i, i + 1) } else { (j, j + 1) };
            if k < 3 {
                let at = if axis == 0 { from * 4 + j } else { i * 4 + from };
                out[i * 4 + j] = f[at] * from as f64;
            }
        }
    }
    out
}

/// A bound of the length of a bicubic on the square.
fn most(f: &[Vec3; 16]) -> f64 {
    f.iter().map(|c| c.norm()).sum()
}

/// A bound of |f . g| on the square: the sum of the coefficients of the product.
fn most_product(f: &[Vec3; 16], g: &[Vec3; 16]) -> f64 {
    let mut sums = [0.0; 49];
    for (k, a) in f.iter().enumerate() {
        if *a == Vec3::zero() {
            continue;
        }
        for (l, b) in g.iter().enumerate() {
            sums[(k / 4 + l / 4) * 7 + k % 4 + l % 4] += a.dot(*b);
        }
    }
    sums.iter().map(|x| x.abs()).sum()
}

impl Flat {
    /// The parallelogram about `c` with half sides `a` and `b`.
    pub fn of(c: Vec3, a: Vec3, b: Vec3, bend: f64) -> Self {
        let [aa, ab, bb] = [a.norm_sq(), a.dot(b), b.norm_sq()];
        let inverses = [1.0 / (aa * bb - ab * ab), 1.0 / aa, 1.0 / bb];
        Flat { c, a, b, products: [aa, ab, bb], inverses, bend }
    }

    /// The one in the middle of a patch with these powers.
    pub fn new(patch: &BezierPatch, x: &[Vec3; 16]) -> Self {
        let (a, b) = (x[4], x[1]);
        let high: f64 = (0..16).filter(|k| k / 4 + k % 4 > 1).map(|k| x[k].norm()).sum();
        Self::of(x[0], a, b, high + patch.slack)
    }
}

impl Bent {
    pub fn new(
        cell: &BezierPatch,
        x: &[Vec3; 16],
        piece: u32,
        place: [[f64; 2]; 2],
        full: bool,
    ) -> Self {
        let (s, t) = (derivative(x, 0), derivative(x, 1));
        let (ss, st, tt) = (derivative(&s, 0), derivative(&s, 1), derivative(&t, 1));
        let third =
            [derivative(&ss, 0), derivative(&ss, 1), derivative(&st, 1), derivative(&tt, 1)];
        // The third derivatives of |X - p|^2 / 2 without their parts X''' . (X - p).
        let fixed = if full {
            [
                3.0 * most_product(&ss, &s),
                2.0 * most_product(&st, &s) + most_product(&ss, &t),
                2.0 * most_product(&st, &t) + most_product(&tt, &s),
                3.0 * most_product(&tt, &t),
            ]
        } else {
            [f64::INFINITY; 4]
        };
        let reach = (1..16).map(|k| x[k].norm()).sum();
        let [[a, b], [c, d]] = place;
        Bent {
            second: [ss[0], st[0], tt[0]],
            fixed,
            far: third.each_ref().map(most),
            reach,
            middle: [0.5 * (a + b), 0.5 * (c + d)],
            half: [0.5 * (b - a), 0.5 * (d - c)],
            piece,
            open: cell.open,
        }
    }
}

/// Position, first and second derivatives of a bicubic in powers: p, s, t, ss, st, tt.
#[inline]
fn second(powers: &[Vec3; 16], s: f64, t: f64) -> [Vec3; 6] {
    let mut out = [Vec3::zero(); 6];
    for i in (0..4).rev() {
        let c = &powers[i * 4..i * 4 + 4];
        let f = ((c[3] * t + c[2]) * t + c[1]) * t + c[0];
        let d = (c[3] * (3.0 * t) + c[2] * 2.0) * t + c[1];
        let dd = c[3] * (6.0 * t) + c[2] * 2.0;
        // Horner's rule with derivatives.
        out[3] = out[3] * s + out[1] * 2.0;
        out[1] = out[1] * s + out[0];
        out[0] = out[0] * s + f;
        out[4] = out[4] * s + out[2];
        out[2] = out[2] * s + d;
        out[5] = out[5] * s + dd;
    }
    out
}

impl PolynomialPiece {
    /// Position, first and second derivatives at (s, t): p, s, t, ss, st, tt.
    #[inline]
    pub fn jet(&self, s: f64, t: f64) -> [Vec3; 6] {
        second(&self.powers, s, t)
    }

    /// The surface's parameters at (s, t).
    #[inline]
    pub fn place(&self, s: f64, t: f64) -> [f64; 2] {
        // Exact at both ends, so that an edge is 0 or 1 to the bit.
        let along = |[a, b]: [f64; 2], x: f64| {
            if x >= 1.0 {
                b
            } else if x <= -1.0 {
                a
            } else {
                0.5 * (a + b) + 0.5 * (b - a) * x
            }
        };
        [along(self.uv[0], s), along(self.uv[1], t)]
    }
}

impl Cells {
    /// Cuts a surface up for nearest points.
    pub fn new(surface: &dyn Surface<f64>) -> Self {
        Self::cut(surface, BEND, true)
    }

    /// Cuts a surface up for many intersections, without the bounds that only nearest points need.
    pub fn fine(surface: &dyn Surface<f64>) -> Self {
        Self::cut(surface, FINE_BEND, false)
    }

    /// Cuts a surface up for one intersection, into larger cells.
    pub fn coarse(surface: &dyn Surface<f64>) -> Self {
        Self::cut(surface, COARSE_BEND, false)
    }

    fn cut(surface: &dyn Surface<f64>, bend: f64, full: bool) -> Self {
        let tree = SurfaceTree::new(surface);
        let mut pieces = Vec::with_capacity(tree.patches.len());
        let mut twigs: Vec<Twig> = Vec::with_capacity(8 * tree.patches.len());
        for (k, patch) in tree.patches.iter().enumerate() {
            pieces.push(PolynomialPiece {
                uv: patch.uv,
                powers: patch_powers(patch),
                slack: patch.slack,
            });
            let place = [[-1.0, 1.0]; 2];
            twigs.push(Twig { patch: *patch, piece: k as u32, below: 0, cell: 0, place });
        }
        let mut cells: Vec<usize> = Vec::new();
        for k in 0..tree.patches.len() {
            let mut stack = vec![(k, 0)];
            while let Some((at, halvings)) = stack.pop() {
                let twig = twigs[at];
                let [lu, lv] = twig.patch.lengths();
                let longest = lu.max(lv);
                let enough = twig.patch.bend() <= bend * lu.min(lv).max(0.25 * longest);
                if enough || halvings >= MOST_HALVINGS || cells.len() + stack.len() >= MOST_CELLS {
                    cells.push(at);
                    continue;
                }
                let axis = usize::from(lv > lu);
                let [a, b] = twig.place[axis];
                let m = 0.5 * (a + b);
                twigs[at].below = twigs.len() as u32;
                for (half, span) in twig.patch.halves(axis).into_iter().zip([[a, m], [m, b]]) {
                    let mut place = twig.place;
                    place[axis] = span;
                    stack.push((twigs.len(), halvings + 1));
                    twigs.push(Twig { patch: half, place, ..twig });
                }
            }
        }
        let bounds: Vec<Box3> = cells.iter().map(|&at| twigs[at].patch.bounds()).collect();
        let boxes = Boxes::new(&bounds, 1);
        let mut flats = Vec::with_capacity(cells.len());
        let mut bents = Vec::with_capacity(cells.len());
        for (number, &k) in boxes.order.iter().enumerate() {
            let twig = &mut twigs[cells[k as usize]];
            twig.cell = number as u32;
            let x = patch_powers(&twig.patch);
            flats.push(Flat::new(&twig.patch, &x));
            bents.push(Bent::new(&twig.patch, &x, twig.piece, twig.place, full));
        }
        let forks = forks(&boxes);
        let quads = if full { quads(&forks) } else { Vec::new() };
        let twigs = if full { Vec::new() } else { twigs };
        Self { tree, pieces, flats, bents, forks, quads, twigs }
    }
}

/// The pieces as one surface, where they are the surface itself, to rounding.
#[derive(Clone, Debug)]
pub(crate) struct Polynomials {
    /// Starts of pieces along u and v, and the end of the last one.
    ends: [Vec<f64>; 2],
    /// Two over their widths.
    scales: [Vec<f64>; 2],
    /// Coefficients of s^i t^j at [i * 4 + j], each with a fourth number that is 0.
    powers: Vec<[[f64; 4]; 16]>,
    lanes: Lanes,
}

/// Registers of four numbers, where the processor has them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lanes {
    #[cfg(target_arch = "x86_64")]
    four: Option<pulp::x86::V3>,
}

impl Lanes {
    pub fn new() -> Self {
        Self {
            #[cfg(target_arch = "x86_64")]
            four: pulp::x86::V3::try_new(),
        }
    }

    #[inline]
    pub fn run<F: pulp::WithSimd>(self, work: F) -> F::Output {
        #[cfg(target_arch = "x86_64")]
        if let Some(four) = self.four {
            return pulp::Simd::vectorize(four, work);
        }
        pulp::Simd::vectorize(pulp::Scalar::new(), work)
    }
}

impl Cells {
    /// The pieces as a surface, if they are a grid of exact ones.
    pub fn polynomials(&self) -> Option<Polynomials> {
        let pieces = &self.pieces;
        let columns = pieces.iter().take_while(|p| p.uv[0] == pieces[0].uv[0]).count();
        let rows = pieces.len() / columns;
        let grid = rows * columns == pieces.len()
            && pieces.iter().enumerate().all(|(k, p)| {
                p.uv == [pieces[k / columns * columns].uv[0], pieces[k % columns].uv[1]]
            });
        if !(grid && self.tree.exact) {
            return None;
        }
        let us = (0..rows).map(|k| pieces[k * columns].uv[0]);
        let vs = (0..columns).map(|k| pieces[k].uv[1]);
        let spans: [Vec<[f64; 2]>; 2] = [us.collect(), vs.collect()];
        let ends = spans.each_ref().map(|all| all.iter().map(|s| s[0]).chain([1.0]).collect());
        let scales = spans.each_ref().map(|all| all.iter().map(|[a, b]| 2.0 / (b - a)).collect());
        let powers = pieces.iter().map(|p| p.powers.map(|c| [c.x, c.y, c.z, 0.0])).collect();
        Some(Polynomials { ends, scales, powers, lanes: Lanes::new() })
    }
}

/// The number of the span that `x` is in; the first or last one outside.
#[inline]
fn span(ends: &[f64], x: f64) -> usize {
    let last = ends.len() - 2;
    // Right at once where spans are even.
    let mut k = ((x * (last + 1) as f64) as usize).min(last);
    while k > 0 && x < ends[k] {
        k -= 1;
    }
    while k < last && x >= ends[k + 1] {
        k += 1;
    }
    k
}

/// Position and first derivatives of a piece by Horner's rule, on as many numbers at a time as the
/// processor can. There are no fused operations, so that the bits do not depend on that.
struct First<'a> {
    powers: &'a [[f64; 4]; 16],
    s: f64,
    t: f64,
}

impl pulp::WithSimd for First<'_> {
    type Output = [[f64; 4]; 3];

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, simd: S) -> [[f64; 4]; 3] {
        // No closures where registers are wide: those that are not inlined lose them.
        let (s, t, triple) =
            (simd.splat_f64s(self.s), simd.splat_f64s(self.t), simd.splat_f64s(3.0 * self.t));
        let (two, zero) = (simd.splat_f64s(2.0), simd.splat_f64s(0.0));
        let mut out = [[0.0; 4]; 3];
        for part in 0..4 / S::F64_LANES {
            let (mut p, mut by_s, mut by_t) = (zero, zero, zero);
            for i in [3, 2, 1, 0] {
                let a = S::as_simd_f64s(&self.powers[i * 4]).0[part];
                let b = S::as_simd_f64s(&self.powers[i * 4 + 1]).0[part];
                let c = S::as_simd_f64s(&self.powers[i * 4 + 2]).0[part];
                let d = S::as_simd_f64s(&self.powers[i * 4 + 3]).0[part];
                let f = simd.add_f64s(simd.mul_f64s(d, t), c);
                let f = simd.add_f64s(simd.mul_f64s(f, t), b);
                let f = simd.add_f64s(simd.mul_f64s(f, t), a);
                let g = simd.add_f64s(simd.mul_f64s(d, triple), simd.mul_f64s(c, two));
                let g = simd.add_f64s(simd.mul_f64s(g, t), b);
                by_s = simd.add_f64s(simd.mul_f64s(by_s, s), p);
                p = simd.add_f64s(simd.mul_f64s(p, s), f);
                by_t = simd.add_f64s(simd.mul_f64s(by_t, s), g);
            }
            S::as_mut_simd_f64s(&mut out[0]).0[part] = p;
            S::as_mut_simd_f64s(&mut out[1]).0[part] = by_s;
            S::as_mut_simd_f64s(&mut out[2]).0[part] = by_t;
        }
        out
    }
}

/// The vectors by the surface's parameters.
#[inline]
fn scaled([x, s, t]: &[[f64; 4]; 3], [by_u, by_v]: [f64; 2]) -> [Vec3; 3] {
    [
        Vec3 { x: x[0], y: x[1], z: x[2] },
        Vec3 { x: s[0] * by_u, y: s[1] * by_u, z: s[2] * by_u },
        Vec3 { x: t[0] * by_v, y: t[1] * by_v, z: t[2] * by_v },
    ]
}

impl Polynomials {
    /// The number of the piece at (u, v), its scales, and its own parameters there.
    #[inline]
    fn locate(&self, u: f64, v: f64) -> (usize, [f64; 2], [f64; 2]) {
        let [us, vs] = &self.ends;
        let (i, j) = (span(us, u), span(vs, v));
        let by = [self.scales[0][i], self.scales[1][j]];
        let place = [(u - us[i]) * by[0] - 1.0, (v - vs[j]) * by[1] - 1.0];
        (i * (vs.len() - 1) + j, by, place)
    }
}

impl Polynomials {
    /// Position and first derivatives of two surfaces at (u, v) and (p, r).
    #[inline(always)]
    pub fn both<S: pulp::Simd>(
        simd: S,
        a: &Self,
        b: &Self,
        [u, v, p, r]: [f64; 4],
    ) -> [[Vec3; 3]; 2] {
        let (m, by_a, [s, t]) = a.locate(u, v);
        let x = First { powers: &a.powers[m], s, t }.with_simd(simd);
        let (n, by_b, [s, t]) = b.locate(p, r);
        let y = First { powers: &b.powers[n], s, t }.with_simd(simd);
        [scaled(&x, by_a), scaled(&y, by_b)]
    }
}

impl Surface<f64> for Polynomials {
    fn jet(&self, u: f64, v: f64, order: Order) -> SurfJet<f64> {
        let (number, [by_u, by_v], [s, t]) = self.locate(u, v);
        let powers = &self.powers[number];
        if order == Order::Second {
            let powers = powers.map(|x| Vec3 { x: x[0], y: x[1], z: x[2] });
            let [p, s, t, ss, st, tt] = second(&powers, s, t);
            let (uu, uv, vv) = (ss * (by_u * by_u), st * (by_u * by_v), tt * (by_v * by_v));
            return SurfJet { p, u: s * by_u, v: t * by_v, uu, uv, vv };
        }
        let first = self.lanes.run(First { powers, s, t });
        let [p, u, v] = scaled(&first, [by_u, by_v]);
        SurfJet { p, u, v, ..SurfJet::default() }
    }

    fn breaks(&self) -> [Vec<f64>; 2] {
        self.ends.each_ref().map(|ends| ends[1..ends.len() - 1].to_vec())
    }

    moldloft_num::surface_facts!(broken, open, not_rational);
    moldloft_num::surface_one_by_one!(f64: grid, line, scattered);
}

/// The tree with the boxes of both children side by side; its leaves have one item.
pub(crate) fn forks(boxes: &Boxes) -> Vec<Fork> {
    let nodes = &boxes.nodes;
    let mut number = vec![0u32; nodes.len()];
    let mut inner = 0;
    for (k, node) in nodes.iter().enumerate() {
        if node.count == 0 {
            number[k] = inner;
            inner += 1;
        } else {
            number[k] = node.first | LEAF;
        }
    }
    let children = |k: usize| [k + 1, nodes[k].first as usize];
    (0..nodes.len())
        .filter(|&k| nodes[k].count == 0)
        .map(|k| Fork {
            bounds: children(k).map(|c| nodes[c].bounds),
            below: children(k).map(|c| number[c]),
        })
        .collect()
}
