//! Cells cut by a plane z = level: strips on which the cut is a function of the outer parameter.
//! On a strip the outer parameter w is between `from` and `to`, and the wet part of each line of
//! constant w is the whole line, or the part before or after the single root of z - level.
//! Bernstein coefficients prove wet, dry and the uniqueness of the root for the polynomial of the
//! cell.

use crate::bernstein::{bracketed, place_and_tangent, sign_changes, value_and_slope};
use crate::cell::PolynomialCell;
use moldloft_num::{Real, Vec3};
use std::sync::Arc;

/// The immersed part of the lines of a strip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Wet {
    All,
    /// Up to the root.
    Before,
    /// From the root on.
    After,
}

/// A strip of a cell.
#[derive(Clone, Debug)]
pub(crate) struct Strip<T> {
    pub cell: Arc<PolynomialCell<T>>,
    /// The parameter along its lines: 0 = u, 1 = v.
    pub inner: usize,
    /// Range of the other parameter.
    pub from: T,
    pub to: T,
    pub wet: Wet,
}

/// The coordinate that a plane fixes, and its value.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CoordinatePlane<T> {
    pub axis: usize,
    pub level: T,
    /// Negligible distance.
    pub epsilon: f64,
}

/// Distance from a plane that does not matter, relative to the size of the body.
pub(crate) const NEGLIGIBLE: f64 = 1e-13;

impl<T> CoordinatePlane<T> {
    /// The plane that cuts a body of that size.
    pub fn new(axis: usize, level: T, size: f64) -> Self {
        Self { axis, level, epsilon: NEGLIGIBLE * size }
    }
}

/// Maximum depth of halving for cells whose height is monotonic in neither parameter.
const DEEPEST: u32 = 11;

/// Minimum slope along the inner parameter, relative to its maximum, in cells halved less often.
const STEEP: f64 = 1e-2;
const STEEP_TO: u32 = 6;

/// The strips of a cell below the plane, and the area of undecided pieces.
pub(crate) fn strips<T: Real>(
    cell: &Arc<PolynomialCell<T>>,
    cut: CoordinatePlane<T>,
    out: &mut Vec<Strip<T>>,
) -> f64 {
    let mut undecided = 0.0;
    let mut stack = vec![(cell.clone(), 0u32)];
    while let Some((cell, depth)) = stack.pop() {
        let heights = heights(&cell, cut);
        let all = |f: &dyn Fn(f64) -> bool| heights.iter().all(|&z| f(z));
        if all(&|z| z >= -cut.epsilon) {
            continue;
        }
        if all(&|z| z <= cut.epsilon) {
            let edges = edges_in_plane(&cell, &heights, cut.epsilon);
            if let [(first, _), (second, _), ..] = edges[..]
                && depth < DEEPEST
            {
                // Each half has one of the two opposite edges.
                let along = if first == second { first } else { (depth % 2) as usize };
                let halves = cell.split(along).map(|half| (Arc::new(half), depth + 1));
                stack.extend(halves);
                continue;
            }
            let (inner, wet) = edges.first().copied().unwrap_or((0, Wet::All));
            out.push(Strip { cell, inner, from: T::zero(), to: T::one(), wet });
            continue;
        }
        if let Some(corners) = cell.triangle() {
            cut_triangle(&cell, corners, cut, out);
            continue;
        }
        let least = if depth < STEEP_TO { STEEP } else { 0.0 };
        if let Some(inner) = ordered(&heights, cell.degree(), least) {
            cut_cell(&cell, inner, &heights, cut, out);
            continue;
        }
        if depth >= DEEPEST {
            let [a, b] = cell.lengths();
            undecided += a * b;
            let mean = heights.iter().sum::<f64>() / heights.len() as f64;
            if mean < 0.0 {
                out.push(Strip { cell, inner: 0, from: T::zero(), to: T::one(), wet: Wet::All });
            }
            continue;
        }
        for half in cell.split(1) {
            for quarter in half.split(0) {
                stack.push((Arc::new(quarter), depth + 1));
            }
        }
    }
    undecided
}

/// The parts of a triangle below the plane, which cuts it: exact, with an edge along the cut.
fn cut_triangle<T: Real>(
    cell: &PolynomialCell<T>,
    corners: [Vec3<T>; 3],
    cut: CoordinatePlane<T>,
    out: &mut Vec<Strip<T>>,
) {
    let height = |p: Vec3<T>| p[cut.axis] - cut.level;
    let wet = corners.map(|p| height(p).re() < 0.0);
    let below = wet.iter().filter(|&&w| w).count() == 2;
    // The corner on one side of the plane, and the two on the other.
    let first = wet.iter().position(|&w| w != below).unwrap_or(0);
    let [p, q, r] = [0, 1, 2].map(|k| corners[(first + k) % 3]);
    let crossing = |other: Vec3<T>| {
        let (h, k) = (height(p), height(other));
        let mut at = (p + (other - p) * (h / (h - k))).to_array();
        at[cut.axis] = cut.level;
        Vec3::from(at)
    };
    let (on_q, on_r) = (crossing(q), crossing(r));
    let mut piece = |corners: [Vec3<T>; 3], wet: Wet| {
        let cell = Arc::new(cell.part_of_triangle(corners));
        out.push(Strip { cell, inner: 1, from: T::zero(), to: T::one(), wet });
    };
    if below {
        piece([on_r, on_q, q], Wet::After);
        piece([q, r, on_r], Wet::All);
    } else {
        piece([on_q, on_r, p], Wet::After);
    }
}

/// The edges of a wet cell in the plane, which are part of the waterline: the parameter across, and
/// the wet part of its lines. Degenerate edges do not count.
fn edges_in_plane<T: Real>(
    cell: &PolynomialCell<T>,
    heights: &[f64],
    epsilon: f64,
) -> Vec<(usize, Wet)> {
    let [du, dv] = cell.degree();
    let near = |k: usize| heights[k] >= -epsilon;
    if ![0, dv, du * (dv + 1), du * (dv + 1) + dv].into_iter().any(near) {
        return Vec::new();
    }
    let u = |i: usize| (0..=dv).map(|j| i * (dv + 1) + j).collect::<Vec<_>>();
    let v = |j: usize| (0..=du).map(|i| i * (dv + 1) + j).collect::<Vec<_>>();
    let sides = [
        (0, Wet::After, u(0)),
        (0, Wet::Before, u(du)),
        (1, Wet::After, v(0)),
        (1, Wet::Before, v(dv)),
    ];
    let place = |k: usize| cell.net()[k].re();
    let lies = |edge: &[usize]| {
        edge.iter().all(|&k| near(k))
            && edge.iter().any(|&k| place(k).distance(place(edge[0])) > epsilon)
    };
    sides
        .into_iter()
        .filter(|(_, _, edge)| lies(edge))
        .map(|(inner, wet, _)| (inner, wet))
        .collect()
}

fn heights<T: Real>(cell: &PolynomialCell<T>, cut: CoordinatePlane<T>) -> Vec<f64> {
    cell.net().iter().map(|p| p[cut.axis].re() - cut.level.re()).collect()
}

/// The parameter in which the height is monotonic; the steeper one if there are two.
fn ordered(heights: &[f64], [du, dv]: [usize; 2], least: f64) -> Option<usize> {
    let steps = |along: usize| {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        let stride = if along == 0 { dv + 1 } else { 1 };
        for i in 0..=du {
            for j in 0..=dv {
                if [i < du, j < dv][along] {
                    let k = i * (dv + 1) + j;
                    let step = heights[k + stride] - heights[k];
                    low = low.min(step);
                    high = high.max(step);
                }
            }
        }
        // Minimum over maximum slope; negative if the sign changes.
        let largest = low.abs().max(high.abs());
        if largest == 0.0 {
            return -1.0;
        }
        low.max(-high) / largest
    };
    let shares = [steps(0), steps(1)];
    let best = usize::from(shares[1] > shares[0]);
    (shares[best] >= least).then_some(best)
}

/// The strips of a cell with monotonic height along `inner`, between the roots on its two outer
/// edges.
fn cut_cell<T: Real>(
    cell: &Arc<PolynomialCell<T>>,
    inner: usize,
    heights: &[f64],
    cut: CoordinatePlane<T>,
    out: &mut Vec<Strip<T>>,
) {
    let [du, dv] = cell.degree();
    let edge = |end: usize| -> Vec<usize> {
        match (inner, end) {
            (0, 0) => (0..=dv).collect(),
            (0, _) => (0..=dv).map(|j| du * (dv + 1) + j).collect(),
            (_, 0) => (0..=du).map(|i| i * (dv + 1)).collect(),
            _ => (0..=du).map(|i| i * (dv + 1) + dv).collect(),
        }
    };
    let edges = [edge(0), edge(1)];
    let mut breaks: Vec<T> = Vec::new();
    for indices in &edges {
        let row: Vec<f64> = indices.iter().map(|&k| heights[k]).collect();
        for root in sign_changes(&row, cut.epsilon * 1e-3) {
            // One Newton step gives the derivatives.
            let exact: Vec<T> =
                indices.iter().map(|&k| cell.net()[k][cut.axis] - cut.level).collect();
            let (z, _) = value_and_slope(&exact, T::from(root));
            let (_, slope) = value_and_slope(&row, root);
            let move_by = -z / slope;
            let moved = if slope != 0.0 && move_by.is_finite() && move_by.re().abs() < 1e-6 {
                T::from(root) + move_by
            } else {
                T::from(root)
            };
            breaks.push(moved);
        }
    }
    breaks.push(T::zero());
    breaks.push(T::one());
    breaks.sort_by(|a, b| a.re().total_cmp(&b.re()));
    let rows = edges.each_ref().map(|e| e.iter().map(|&k| heights[k]).collect::<Vec<f64>>());
    for ends in breaks.windows(2) {
        let [from, to] = [ends[0], ends[1]];
        if to.re() - from.re() <= 1e-15 {
            continue;
        }
        let middle = 0.5 * (from.re() + to.re());
        let [low, high] = rows.each_ref().map(|row| value_and_slope(row, middle).0);
        let wet = match (low < 0.0, high < 0.0) {
            (true, true) => Wet::All,
            (true, false) => Wet::Before,
            (false, true) => Wet::After,
            (false, false) => continue,
        };
        out.push(Strip { cell: cell.clone(), inner, from, to, wet });
    }
}

/// A line of a strip: its control points, and their derivatives with respect to the outer
/// parameter.
#[derive(Debug, Default)]
pub(crate) struct StripLine<T> {
    pub at: Vec<Vec3<T>>,
    pub by: Vec<Vec3<T>>,
}

/// A point of the cut.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CutPoint<T> {
    /// The inner parameter.
    pub t: T,
    pub p: Vec3<T>,
    /// Derivative of the point with respect to the outer parameter.
    pub along: Vec3<T>,
}

impl<T: Real> Strip<T> {
    /// True when the plane cuts it.
    pub fn is_cut(&self) -> bool {
        self.wet != Wet::All
    }

    /// True for a strip of a panel.
    pub fn is_bilinear(&self) -> bool {
        self.cell.degree() == [1, 1]
    }

    /// True when its lines are those of this whole cell.
    pub fn is_all_of(&self, cell: &Arc<PolynomialCell<T>>) -> bool {
        (self.from.re(), self.to.re()) == (0.0, 1.0) && Arc::ptr_eq(&self.cell, cell)
    }

    /// The strip without derivatives.
    pub fn re(&self) -> Strip<f64> {
        let Self { cell, inner, from, to, wet } = self;
        Strip { cell: Arc::new(cell.re()), inner: *inner, from: from.re(), to: to.re(), wet: *wet }
    }

    /// 1 if the cross product of the inner and the outer derivative points outward, otherwise -1.
    pub fn sign(&self) -> f64 {
        if self.cell.reversed == (self.inner == 0) { -1.0 } else { 1.0 }
    }

    /// The line at `w`, and the inner parameter of the cut on it; 0 or 1 if the cut is beyond an
    /// end by rounding.
    pub fn line(&self, w: T, line: &mut StripLine<T>) {
        self.cell.line(self.inner, w, &mut line.at, &mut line.by);
    }

    /// The point of the cut on a line.
    pub fn cut_on(&self, line: &StripLine<T>, cut: CoordinatePlane<T>) -> CutPoint<T> {
        let row: Vec<f64> = line.at.iter().map(|p| p[cut.axis].re() - cut.level.re()).collect();
        let last = row[row.len() - 1];
        let (ends, rising) = ([row[0], last], self.wet == Wet::Before);
        let root = if (ends[0] >= 0.0) == rising {
            0.0
        } else if (ends[1] <= 0.0) == rising {
            1.0
        } else {
            bracketed(&row)
        };
        let (p, by_inner) = place_and_tangent(&line.at, T::from(root));
        let slope = by_inner[cut.axis];
        let off = (p[cut.axis] - cut.level) / slope;
        let t = if off.is_finite() && off.re().abs() < 1e-6 {
            T::from(root) - off
        } else {
            T::from(root)
        };
        let (mut p, by_inner) = place_and_tangent(&line.at, t);
        let (by_outer, _) = place_and_tangent(&line.by, t);
        let share = by_outer[cut.axis] / by_inner[cut.axis];
        let along = if share.is_finite() { by_outer - by_inner * share } else { by_outer };
        let mut c = p.to_array();
        c[cut.axis] = cut.level;
        p = c.into();
        CutPoint { t, p, along }
    }

    /// The point of the cut at the outer parameter `w`.
    pub fn cut_at(&self, w: T, cut: CoordinatePlane<T>, line: &mut StripLine<T>) -> CutPoint<T> {
        self.line(w, line);
        self.cut_on(line, cut)
    }
}
