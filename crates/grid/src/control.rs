//! Control terms of elliptic grids, which keep the spacing of the edges or impose a given one.

use crate::lines::Control;
use crate::{GridSide, SurfaceGrid, Wall};
use moldloft_num::{Real, Vec3};

/// -r' . r'' / |r'|^2 at each point of a row, by central differences, within [`MOST`], which corners exceed; zero at
/// its ends and where it stays fixed.
fn along<T: Real>(points: &[Vec3<T>]) -> Vec<T> {
    let mut all = vec![T::zero(); points.len()];
    for (k, w) in points.windows(3).enumerate() {
        let (first, second) = ((w[2] - w[0]) * T::from(0.5), w[2] + w[0] - w[1] * T::from(2.0));
        let square = first.norm_sq();
        if square.re() > 0.0 {
            let limit = T::from(MOST);
            all[k + 1] = (-(first.dot(second) / square)).min(limit).max(-limit);
        }
    }
    all
}

/// The terms of Thomas and Middlecoff (1980): along each edge those with which its own points are a
/// solution, in between linear from edge to edge by index. An edge that is a point takes those of the
/// opposite one; of periodic edges, the last is that of the grid everywhere.
pub fn middlecoff<T: Real>(grid: &SurfaceGrid<T>, periodic: bool) -> Control<T> {
    let (m, n) = (grid.m, grid.n);
    let pair = |a: GridSide, b: GridSide| -> [Vec<T>; 2] {
        let (p, q) = (grid.edge(a), grid.edge(b));
        let still = |p: &[Vec3<T>]| p.iter().all(|x| x.re() == p[0].re());
        match (still(&p), still(&q)) {
            (true, false) => [along(&q), along(&q)],
            (false, true) => [along(&p), along(&p)],
            _ => [along(&p), along(&q)],
        }
    };
    // The rows of the grid are along j: "across" belongs to i.
    let [low, high] = pair(GridSide::FirstJ, GridSide::LastJ);
    let [first, last] = match periodic {
        true => [along(&grid.edge(GridSide::LastI)), along(&grid.edge(GridSide::LastI))],
        false => pair(GridSide::FirstI, GridSide::LastI),
    };
    let mix = |a: T, b: T, k: usize, n: usize| a + (b - a) * (k as f64 / (n - 1) as f64);
    Control {
        across: (0..m * n).map(|k| mix(low[k / n], high[k / n], k % n, n)).collect(),
        along: (0..m * n).map(|k| mix(first[k % n], last[k % n], k / n, m)).collect(),
    }
}

/// Distance from its wall, in cells, at which a term has decayed to 1/e.
const REACH: f64 = 1.0 / 0.3;

/// Terms, with those of the edges, may not grow beyond this: central differences lose their sense at 2.
const MOST: f64 = 1.9;

/// Fraction of an error, as an angle, that is added to a term in one sweep.
const SHARE: f64 = 0.2;

/// Deviations of a wall from its specification.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallReport {
    /// The edge.
    pub edge: GridSide,
    /// Smallest and largest first cell height, relative to the given one.
    pub cells: [f64; 2],
    /// Largest deviation from the given angle, in radians.
    pub angle: f64,
}

impl WallReport {
    /// The largest relative error of a cell, or error of an angle.
    pub fn error(&self) -> f64 {
        (self.cells[1] - 1.0).max(1.0 - self.cells[0]).max(self.angle)
    }
}

/// The terms of Hilgenstock (1988) at the walls, found iteratively: each sweep adds the errors of
/// first cells and angles.
///
/// Unlike those of Steger and Sorenson (1979), which solve for them, they give the cell itself, and two walls
/// converge.
pub struct WallTerms<T> {
    /// The terms along and away from each wall, at each of its points.
    terms: Vec<Vec<[T; 2]>>,
}

impl<T: Real> WallTerms<T> {
    pub fn new(grid: &SurfaceGrid<T>, walls: &[Wall<T>]) -> Self {
        let terms = walls.iter().map(|w| vec![[T::zero(); 2]; grid.edge(w.edge).len()]).collect();
        Self { terms }
    }

    /// One step towards the terms with which the walls are as specified; returns the deviations.
    pub fn update(&mut self, grid: &SurfaceGrid<T>, walls: &[Wall<T>]) -> Vec<WallReport> {
        let each = walls.iter().zip(&mut self.terms).map(|(wall, terms)| {
            let view = EdgeView { grid, edge: wall.edge };
            let count = view.count();
            let mut report =
                WallReport { edge: wall.edge, cells: [f64::INFINITY, 0.0], angle: 0.0 };
            for k in 1..count - 1 {
                let Some((length, angle)) = view.cell(k) else { continue };
                let spacing = wall.spacing[k.min(wall.spacing.len() - 1)];
                let share = length.re() / spacing.re();
                report.cells = [report.cells[0].min(share), report.cells[1].max(share)];
                let off = angle - wall.angle;
                report.angle = report.angle.max(off.re().abs());
                let [p, q] = &mut terms[k];
                *p += (off * std::f64::consts::FRAC_2_PI).atan() * SHARE;
                *q += ((spacing - length) / spacing).atan() * SHARE;
            }
            // The terms of the ends are their neighbours'.
            if count > 2 {
                (terms[0], terms[count - 1]) = (terms[1], terms[count - 2]);
            }
            report
        });
        each.collect()
    }

    /// The terms in the whole grid, fading away from the walls.
    pub fn control(
        &self,
        grid: &SurfaceGrid<T>,
        walls: &[Wall<T>],
        base: &Control<T>,
    ) -> Control<T> {
        let mut control = base.clone();
        let n = grid.n;
        for (wall, terms) in walls.iter().zip(&self.terms) {
            let view = EdgeView { grid, edge: wall.edge };
            let fade: Vec<f64> =
                (0..view.depth()).map(|d| libm::exp(-(d as f64) / REACH)).collect();
            for (k, [p, q]) in terms.iter().enumerate() {
                for (d, fade) in fade.iter().enumerate() {
                    let [i, j] = view.index(k, d);
                    // Depth counts backwards from the far edges: the sense of q turns.
                    let q = if view.far() { -*q } else { *q };
                    let (by_tangent, by_depth) = (*p * *fade, q * *fade);
                    let at = i * n + j;
                    // Rows are along j.
                    if view.along_i() {
                        control.across[at] += by_tangent;
                        control.along[at] += by_depth;
                    } else {
                        control.along[at] += by_tangent;
                        control.across[at] += by_depth;
                    }
                }
            }
        }
        let limit = T::from(MOST);
        for term in control.along.iter_mut().chain(&mut control.across) {
            *term = term.min(limit).max(-limit);
        }
        control
    }
}

/// Deviations of a grid's walls from their specification.
pub fn wall_reports<T: Real>(grid: &SurfaceGrid<T>, walls: &[Wall<T>]) -> Vec<WallReport> {
    WallTerms::new(grid, walls).update(grid, walls)
}

/// The first cell off each point of an edge, and its angle to the edge; of points without one, zeros.
pub fn wall_cells<T: Real>(grid: &SurfaceGrid<T>, edge: GridSide) -> Vec<[T; 2]> {
    let view = EdgeView { grid, edge };
    (0..view.count())
        .map(|k| view.cell(k).map_or([T::zero(); 2], |(length, angle)| [length, angle]))
        .collect()
}

/// A grid seen from an edge: point k along it, d cells deep.
struct EdgeView<'a, T> {
    grid: &'a SurfaceGrid<T>,
    edge: GridSide,
}

impl<T: Real> EdgeView<'_, T> {
    /// True when the edge is along i.
    fn along_i(&self) -> bool {
        matches!(self.edge, GridSide::FirstJ | GridSide::LastJ)
    }

    fn far(&self) -> bool {
        matches!(self.edge, GridSide::LastI | GridSide::LastJ)
    }

    fn count(&self) -> usize {
        if self.along_i() { self.grid.m } else { self.grid.n }
    }

    fn depth(&self) -> usize {
        if self.along_i() { self.grid.n } else { self.grid.m }
    }

    fn index(&self, k: usize, d: usize) -> [usize; 2] {
        let d = if self.far() { self.depth() - 1 - d } else { d };
        if self.along_i() { [k, d] } else { [d, k] }
    }

    fn at(&self, k: usize, d: usize) -> Vec3<T> {
        let [i, j] = self.index(k, d);
        self.grid.at(i, j)
    }

    /// The length of the first cell off a point of the edge, and its angle to the edge.
    fn cell(&self, k: usize) -> Option<(T, T)> {
        let (tangent, inward) = (self.tangent(k), self.at(k, 1) - self.at(k, 0));
        let (across, square) = (tangent.cross(inward), inward.norm_sq());
        if !(across.norm_sq().re() > 0.0) {
            return None;
        }
        Some((square.sqrt(), across.norm().atan2(tangent.dot(inward))))
    }

    /// The derivative along the edge.
    fn tangent(&self, k: usize) -> Vec3<T> {
        let last = self.count() - 1;
        match k {
            0 => self.at(1, 0) - self.at(0, 0),
            k if k == last => self.at(last, 0) - self.at(last - 1, 0),
            k => (self.at(k + 1, 0) - self.at(k - 1, 0)) * T::from(0.5),
        }
    }
}
