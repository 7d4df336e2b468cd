//! Integrals over the skin below z = level and over the waterplane, each with an error estimate.
//! The flux of the field (0, 0, z - level) through the waterplane is zero, so the volume needs no
//! lid. Whole cells of low degree use a rule that is exact for their polynomials. On strips cut by
//! the water the outer parameter is w = a + (b - a) sin^2(pi s / 2), which removes the square roots
//! at both ends from the integrand; panels have
//! none, and of triangles the parts below the water are triangles, which every rule gives exactly. Every integral is computed by two rules; the finer one is the
//! result, and the difference, approximately the error of the coarser one, its error estimate.
//! Cells are halved, the worst first, until the sum of the estimates is small.

use crate::cell::PolynomialCell;
use crate::strip::{CoordinatePlane, Strip, StripLine, Wet, strips};
use moldloft_num::{Real, Vec3, gauss_rule};
use moldloft_parallel::prelude::*;
use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::sync::Arc;

/// Integrals, about (x0, y0, level).
#[derive(Clone, Copy, Debug)]
pub(crate) struct HydrostaticIntegrals<T> {
    /// Of x n_x, y n_y, z n_z.
    pub forms: [T; 3],
    /// First moments of the volume.
    pub moment: Vec3<T>,
    /// Area of the skin, and its first moments.
    pub wetted: T,
    pub area_moment: Vec3<T>,
    /// Of 1, x, y, xx, xy, yy over the waterplane.
    pub plane: [T; 6],
    /// Area of the waterplane from the waterline (Green's theorem).
    pub green: T,
    /// Integrals of n_x and n_y: zero without openings below the water.
    pub open: [T; 2],
}

/// Errors of volume, its first moments, area, and of the waterplane's area, first and second
/// moments.
pub(crate) type Errors = [f64; 6];

impl<T: Real> HydrostaticIntegrals<T> {
    pub fn zero() -> Self {
        let t = T::zero();
        Self {
            forms: [t; 3],
            moment: Vec3::zero(),
            wetted: t,
            area_moment: Vec3::zero(),
            plane: [t; 6],
            green: t,
            open: [t; 2],
        }
    }

    pub fn add(&mut self, o: &Self) {
        for k in 0..3 {
            self.forms[k] += o.forms[k];
        }
        self.moment += o.moment;
        self.wetted += o.wetted;
        self.area_moment += o.area_moment;
        for k in 0..6 {
            self.plane[k] += o.plane[k];
        }
        self.green += o.green;
        for k in 0..2 {
            self.open[k] += o.open[k];
        }
    }

    /// All of them, in a fixed order.
    pub fn numbers(&self) -> [T; 19] {
        let [f, m, a] = [self.forms, self.moment.to_array(), self.area_moment.to_array()];
        let (p, o) = (self.plane, self.open);
        [
            f[0],
            f[1],
            f[2],
            m[0],
            m[1],
            m[2],
            a[0],
            a[1],
            a[2],
            self.wetted,
            self.green,
            p[0],
            p[1],
            p[2],
            p[3],
            p[4],
            p[5],
            o[0],
            o[1],
        ]
    }

    /// The integrals with these numbers, in the order of `numbers`.
    pub fn of_numbers(n: [T; 19]) -> Self {
        Self {
            forms: [n[0], n[1], n[2]],
            moment: Vec3::new(n[3], n[4], n[5]),
            area_moment: Vec3::new(n[6], n[7], n[8]),
            wetted: n[9],
            green: n[10],
            plane: [n[11], n[12], n[13], n[14], n[15], n[16]],
            open: [n[17], n[18]],
        }
    }

    /// Adds a piece of skin with the vector area `n`.
    #[inline]
    fn take(&mut self, p: Vec3<T>, n: Vec3<T>) {
        let square = n.norm_sq();
        if square.re() > 0.0 {
            let area = square.sqrt();
            self.wetted += area;
            self.area_moment += p * area;
        }
        self.forms[0] += p.x * n.x;
        self.forms[1] += p.y * n.y;
        let column = p.z * n.z;
        self.forms[2] += column;
        self.moment += Vec3::new(p.x * column, p.y * column, p.z * column * 0.5);
        let down = -n.z;
        let (x, y) = (p.x * down, p.y * down);
        let parts = [down, x, y, p.x * x, p.x * y, p.y * y];
        for (sum, part) in self.plane.iter_mut().zip(parts) {
            *sum += part;
        }
        self.open[0] += n.x;
        self.open[1] += n.y;
    }

    /// Differences between two results for the same integrals.
    fn differences(&self, o: &Self) -> Errors {
        let off = |a: T, b: T| (a.re() - b.re()).abs();
        let vector = |a: Vec3<T>, b: Vec3<T>| off(a.x, b.x).max(off(a.y, b.y)).max(off(a.z, b.z));
        let plane = |k: usize| off(self.plane[k], o.plane[k]);
        [
            (0..3).map(|k| off(self.forms[k], o.forms[k])).fold(0.0, f64::max),
            vector(self.moment, o.moment),
            off(self.wetted, o.wetted),
            plane(0),
            plane(1).max(plane(2)),
            plane(3).max(plane(4)).max(plane(5)),
        ]
    }
}

/// The integrals over all cells, and the strips at the waterline.
pub(crate) struct Immersed<T> {
    pub sums: HydrostaticIntegrals<T>,
    /// Error estimates of the quadrature.
    pub errors: Errors,
    /// The strips cut by the water.
    pub waterline: Vec<Strip<T>>,
    /// The cells that they are of.
    pub leaves: Vec<HalvedCell<T>>,
}

/// A cell, or what halvings leave of it.
#[derive(Clone, Debug)]
pub(crate) struct HalvedCell<T> {
    pub cell: Arc<PolynomialCell<T>>,
    /// The index of the cell halved.
    pub root: usize,
    /// The halvings: the parameter along, and which half.
    pub path: Vec<[u8; 2]>,
}

#[cfg(test)]
thread_local! {
    static HALVED: std::cell::Cell<usize> = const { std::cell::Cell::new(0) };
}

/// The result of `work`, and the number of cells it halves.
#[cfg(test)]
pub(crate) fn counted<R>(work: impl FnOnce() -> R) -> (R, usize) {
    let before = HALVED.with(std::cell::Cell::get);
    let made = work();
    (made, HALVED.with(std::cell::Cell::get) - before)
}

/// Maximum number of halvings.
const MOST_HALVED: usize = 20_000;

/// Minimum number of cells for parallel work.
const WORTH_A_THREAD: usize = 2048;

/// Contribution of a cell to the integrals.
struct CellIntegrals<T> {
    leaf: HalvedCell<T>,
    sums: HydrostaticIntegrals<T>,
    errors: Errors,
    waterline: Vec<Strip<T>>,
}

/// A part that may be halved, ordered by error and then by index.
struct RefinementCandidate(f64, usize);

impl PartialEq for RefinementCandidate {
    fn eq(&self, o: &Self) -> bool {
        self.cmp(o) == Ordering::Equal
    }
}
impl Eq for RefinementCandidate {}
impl PartialOrd for RefinementCandidate {
    fn partial_cmp(&self, o: &Self) -> Option<Ordering> {
        Some(self.cmp(o))
    }
}
impl Ord for RefinementCandidate {
    fn cmp(&self, o: &Self) -> Ordering {
        self.0.total_cmp(&o.0).then(o.1.cmp(&self.1))
    }
}

/// The integrals that must reach the accuracy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Wanted {
    All,
    /// Volume and its first moments, for an equilibrium.
    Displacement,
    /// All integrals of a skin that may be open: openings affect the accuracy of the volume, which
    /// may be zero for a flat skin or a vertical wall.
    Skin,
}

/// The integrals below `level`, each to about the relative `accuracy`; `origin` is (x0, y0), `size`
/// the size of the body, `known` those over its other cells below the water.
pub(crate) fn immersed<T: Real>(
    cells: &[Arc<PolynomialCell<T>>],
    known: &HydrostaticIntegrals<T>,
    level: T,
    origin: [T; 2],
    size: f64,
    accuracy: f64,
    wanted: Wanted,
) -> Immersed<T> {
    let cut = CoordinatePlane::new(2, level, size);
    let origin = Vec3::new(origin[0], origin[1], level);
    let one = |leaf: HalvedCell<T>| part(leaf, cut, origin);
    let whole = |(root, cell): (usize, &Arc<PolynomialCell<T>>)| {
        Some(one(HalvedCell { cell: cell.clone(), root, path: Vec::new() }))
    };
    let mut parts: Vec<Option<CellIntegrals<T>>> = if cells.len() < WORTH_A_THREAD {
        cells.iter().enumerate().map(whole).collect()
    } else {
        cells.par_iter().enumerate().map(whole).collect()
    };
    let mut errors = [0.0; 6];
    let mut scale = [0.0f64; 6];
    {
        let mut sums = *known;
        for part in parts.iter().flatten() {
            sums.add(&part.sums);
            for k in 0..6 {
                errors[k] += part.errors[k];
            }
        }
        let mut volume = sums.forms[2].re().abs().max(1e-12 * size.powi(3));
        if wanted == Wanted::Skin {
            let ends = [sums.open[0], sums.open[1], sums.plane[0]].map(|x| x.re().abs());
            let walls = [sums.forms[0], sums.forms[1]].map(|x| x.re().abs());
            volume = ends.into_iter().fold(volume, |v, x| v.max(x * size));
            volume = walls.into_iter().fold(volume, f64::max);
        }
        let area = sums.wetted.re().abs().max(1e-9 * size * size);
        let plane = sums.plane[0].re().abs().max(1e-3 * area);
        scale.copy_from_slice(&[
            volume,
            volume * size,
            area,
            plane,
            plane * size,
            plane * size * size,
        ]);
    }
    let count = if wanted == Wanted::Displacement { 2 } else { 6 };
    let worst = |e: &Errors| (0..count).map(|k| e[k] / scale[k]).fold(0.0, f64::max);
    let mut heap: BinaryHeap<RefinementCandidate> = parts
        .iter()
        .enumerate()
        .filter_map(|(k, p)| Some(RefinementCandidate(worst(&p.as_ref()?.errors), k)))
        .collect();
    let mut halved = 0;
    while halved < MOST_HALVED && worst(&errors) > accuracy {
        let Some(RefinementCandidate(share, k)) = heap.pop() else { break };
        if share <= 1e-3 * accuracy / (parts.len() as f64) {
            break;
        }
        let Some(old) = parts[k].take() else { continue };
        let [along_u, along_v] = old.leaf.cell.lengths();
        if along_u.max(along_v) <= 1e-12 * size {
            parts[k] = Some(old);
            continue;
        }
        for e in 0..6 {
            errors[e] -= old.errors[e];
        }
        let along = u8::from(along_v > along_u);
        for (k, half) in (0u8..).zip(old.leaf.cell.split(usize::from(along))) {
            let mut path = old.leaf.path.clone();
            path.push([along, k]);
            let new = one(HalvedCell { cell: Arc::new(half), root: old.leaf.root, path });
            for e in 0..6 {
                errors[e] += new.errors[e];
            }
            heap.push(RefinementCandidate(worst(&new.errors), parts.len()));
            parts.push(Some(new));
        }
        halved += 1;
    }
    #[cfg(test)]
    HALVED.with(|count| count.set(count.get() + halved));
    // Sum again: repeated subtraction accumulates rounding.
    let mut all =
        Immersed { sums: *known, errors: [0.0; 6], waterline: Vec::new(), leaves: Vec::new() };
    for part in parts.into_iter().flatten() {
        all.sums.add(&part.sums);
        for k in 0..6 {
            all.errors[k] += part.errors[k];
        }
        all.waterline.extend(part.waterline);
        all.leaves.push(part.leaf);
    }
    all
}

/// Quadrature points on cut strips: along w, and across.
const OUTER: [usize; 2] = [14, 10];

/// On those of panels, where the cut is a smooth function of w up to both ends.
const OUTER_BILINEAR: [usize; 2] = [6, 4];

fn part<T: Real>(
    leaf: HalvedCell<T>,
    cut: CoordinatePlane<T>,
    origin: Vec3<T>,
) -> CellIntegrals<T> {
    let cell = &leaf.cell;
    let mut found = Vec::new();
    let undecided = strips(cell, cut, &mut found);
    let (mut sums, mut errors) = (HydrostaticIntegrals::zero(), [0.0; 6]);
    if undecided > 0.0 {
        let reach = cell.lengths().iter().sum::<f64>();
        for (k, e) in errors.iter_mut().enumerate() {
            *e += match k {
                0 | 1 => 0.0,
                2 | 3 => undecided,
                4 => undecided * reach,
                _ => undecided * reach * reach,
            };
        }
    }
    for strip in &found {
        let fine = integrated(strip, cut, origin, 0);
        sums.add(&fine);
        if strip.cell.triangle().is_some() {
            continue;
        }
        let coarse = integrated(strip, cut, origin, 1);
        let mut off = fine.differences(&coarse);
        if strip.wet == Wet::All && is_exact(strip) {
            // Only the integrand of the area is not a polynomial.
            off = [0.0, 0.0, off[2], 0.0, 0.0, 0.0];
        }
        for k in 0..6 {
            errors[k] += off[k];
        }
    }
    found.retain(Strip::is_cut);
    CellIntegrals { leaf, sums, errors, waterline: found }
}

/// Maximum number of quadrature points on whole lines.
const MOST: usize = 12;

/// Quadrature points on a whole line along a parameter: exact for second moments up to degree 6.
pub(crate) fn points(degree: usize) -> usize {
    match degree {
        0 | 1 => 3,
        d => (2 * d).clamp(5, MOST),
    }
}

/// True when [`points`] along a parameter are exact for second moments; then only areas have an
/// error in this direction.
fn exact_along(degree: usize) -> bool {
    2 * degree <= MOST
}

fn is_exact<T: Real>(strip: &Strip<T>) -> bool {
    strip.cell.degree().into_iter().all(exact_along)
}

/// Quadrature points of the finer (0) or the coarser (1) rule. If the rules along the other
/// parameter are not exact, both are exact along one of low degree, so that the difference is the
/// error of the other parameter.
fn points_beside(degree: usize, coarser: usize, other_exact: bool) -> usize {
    match (exact_along(degree), other_exact) {
        (true, false) => (2 * degree.max(1) + 1) - coarser,
        _ => points(degree) - if degree == 1 { 1 } else { 2 } * coarser,
    }
}

/// Quadrature points of a strip along its lines, and across them, of the finer (0) or coarser (1)
/// rule.
pub(crate) fn rule_points<T: Real>(strip: &Strip<T>, coarser: usize) -> [usize; 2] {
    let degree = strip.cell.degree();
    let [inner, beside] = [degree[strip.inner], degree[1 - strip.inner]];
    let outer_exact = !strip.is_cut() && exact_along(beside);
    let along = points_beside(inner, coarser, outer_exact);
    let across = match strip.is_cut() {
        true if strip.is_bilinear() && strip.cell.triangle().is_none() => OUTER_BILINEAR[coarser],
        true if !strip.is_bilinear() => OUTER[coarser],
        _ => points_beside(beside, coarser, exact_along(inner)),
    };
    [along, across]
}

/// The share of the length of a strip at a node of the rule across its lines, and its derivative.
pub(crate) fn outer_share<T: Real>(strip: &Strip<T>, s: f64) -> (f64, f64) {
    if strip.is_cut() && !strip.is_bilinear() {
        let half = std::f64::consts::FRAC_PI_2;
        let (sine, cosine) = (libm::sin(half * s), libm::cos(half * s));
        (sine * sine, 2.0 * half * sine * cosine)
    } else {
        (s, 1.0)
    }
}

/// The integrals over a strip by the finer (0) or the coarser (1) rule.
pub(crate) fn integrated<T: Real>(
    strip: &Strip<T>,
    cut: CoordinatePlane<T>,
    origin: Vec3<T>,
    coarser: usize,
) -> HydrostaticIntegrals<T> {
    let mut sums = HydrostaticIntegrals::zero();
    let [across, outer] = rule_points(strip, coarser);
    let length = strip.to - strip.from;
    let sign = strip.sign();
    let mut line = StripLine::default();
    for &(s, weight) in gauss_rule(outer) {
        let (share, slope) = outer_share(strip, s);
        let w = strip.from + length * share;
        let dw = length * (slope * weight);
        strip.line(w, &mut line);
        let (low, high) = if strip.is_cut() {
            let at = strip.cut_on(&line, cut);
            let (p, along) = (at.p - origin, at.along);
            // The waterline follows the edge of the skin, clockwise about the waterplane seen from
            // above.
            let turn = if strip.wet == Wet::Before { -sign } else { sign };
            sums.green += (p.x * along.y - p.y * along.x) * dw * (0.5 * turn);
            if strip.wet == Wet::Before { (T::zero(), at.t) } else { (at.t, T::one()) }
        } else {
            (T::zero(), T::one())
        };
        let reach = high - low;
        for &(s, weight) in gauss_rule(across) {
            let t = low + reach * s;
            let (basis, slopes) = crate::bernstein::basis(line.at.len() - 1, t);
            let (mut p, mut inner, mut outer) = (Vec3::zero(), Vec3::zero(), Vec3::zero());
            for k in 0..line.at.len() {
                p += line.at[k] * basis[k];
                inner += line.at[k] * slopes[k];
                outer += line.by[k] * basis[k];
            }
            let n = inner.cross(outer) * (reach * dw * (weight * sign));
            sums.take(p - origin, n);
        }
    }
    sums
}
