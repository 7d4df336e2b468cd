//! Measures of the cells of a surface grid.

use crate::SurfaceGrid;
use moldloft_budget::{Budget, Spent};
use moldloft_num::{Real, Vec3};

/// Quality metric of cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QualityMetric {
    /// Scaled Jacobian: the least, over the corners, of the sine of the angle between the two
    /// sides; negative where the corner is turned over against the cells around. Best 1.
    ScaledJacobian,
    /// Equiangular skewness, 0 (best) to 1 and beyond for re-entrant corners: the largest of
    /// (a - 90) / 90 and (90 - a) / 90 over the angles a in degrees; triangles with 60 for 90.
    Skew,
    /// The longer over the shorter of the lines that join the middles of opposite sides.
    Aspect,
    /// The longest over the shortest side.
    EdgeRatio,
    /// The larger ratio of the cell's length along i to that of its neighbours along i.
    GrowthI,
    /// The same along j.
    GrowthJ,
    /// Distance of the corners from the plane midway between the diagonals, over the root of the
    /// area.
    Warp,
    /// The largest angle, in radians, by which a grid line turns at a corner of the cell.
    Turn,
    /// The area, of the two halves on either side of a diagonal, averaged over both diagonals.
    Area,
}

impl QualityMetric {
    /// All, in the order of the reference.
    pub const ALL: [QualityMetric; 9] = [
        QualityMetric::ScaledJacobian,
        QualityMetric::Skew,
        QualityMetric::Aspect,
        QualityMetric::EdgeRatio,
        QualityMetric::GrowthI,
        QualityMetric::GrowthJ,
        QualityMetric::Warp,
        QualityMetric::Turn,
        QualityMetric::Area,
    ];

    /// The name in the language.
    pub fn word(self) -> &'static str {
        match self {
            QualityMetric::ScaledJacobian => "sj",
            QualityMetric::Skew => "skew",
            QualityMetric::Aspect => "aspect",
            QualityMetric::EdgeRatio => "edge_ratio",
            QualityMetric::GrowthI => "growth_i",
            QualityMetric::GrowthJ => "growth_j",
            QualityMetric::Warp => "warp",
            QualityMetric::Turn => "turn",
            QualityMetric::Area => "area",
        }
    }
}

/// The metric of each cell, (i, j) at `i * (n - 1) + j`; empty for a grid of fewer than two lines.
///
/// Sides without length (at poles) do not count: the cell is a triangle then. A cell without area
/// has scaled Jacobian 0 and skew 1, aspect and edge ratio infinite unless it is a point.
pub fn quality<T: Real>(grid: &SurfaceGrid<T>, metric: QualityMetric) -> Vec<T> {
    measured(grid, metric, &|| Ok(())).expect("nothing ends it")
}

/// As [`quality`]; ends early when `budget` is spent.
///
/// # Errors
/// The exceeded limit.
pub fn quality_until<T: Real>(
    grid: &SurfaceGrid<T>,
    metric: QualityMetric,
    budget: &Budget,
) -> Result<Vec<T>, Spent> {
    measured(grid, metric, &|| budget.poll())
}

/// The metric of each cell, as long as the work is not stopped.
fn measured<T: Real>(
    grid: &SurfaceGrid<T>,
    metric: QualityMetric,
    go_on: &dyn Fn() -> Result<(), Spent>,
) -> Result<Vec<T>, Spent> {
    if grid.m < 2 || grid.n < 2 {
        return Ok(Vec::new());
    }
    let cells = GridCells { grid, m: grid.m - 1, n: grid.n - 1 };
    let each = |f: &dyn Fn(usize, usize) -> T| {
        let mut all = Vec::with_capacity(cells.m * cells.n);
        for i in 0..cells.m {
            go_on()?;
            all.extend((0..cells.n).map(|j| f(i, j)));
        }
        Ok(all)
    };
    match metric {
        QualityMetric::ScaledJacobian => {
            let normals = cells.reference_normals(go_on)?;
            each(&|i, j| cells.scaled_jacobian(i, j, normals[i * cells.n + j]))
        }
        QualityMetric::Skew => each(&|i, j| cells.skew(i, j)),
        QualityMetric::Aspect => each(&|i, j| {
            let [a, b] = cells.middles(i, j);
            ratio(a, b)
        }),
        QualityMetric::EdgeRatio => each(&|i, j| {
            let sides = cells.sides(i, j).map(|d| length(d)).into_iter();
            let known: Vec<T> = sides.filter(|s| s.re() > 0.0).collect();
            match known.iter().copied().reduce(T::max).zip(known.iter().copied().reduce(T::min)) {
                Some((most, least)) => most / least,
                None => T::one(),
            }
        }),
        QualityMetric::GrowthI | QualityMetric::GrowthJ => {
            let axis = usize::from(metric == QualityMetric::GrowthJ);
            let last = if axis == 0 { cells.m } else { cells.n };
            each(&|i, j| {
                let k = [i, j][axis];
                let beside = [k.checked_sub(1), (k + 1 < last).then_some(k + 1)];
                let here = cells.middles(i, j)[axis];
                beside.into_iter().flatten().fold(T::one(), |most, k| {
                    let (i, j) = if axis == 0 { (k, j) } else { (i, k) };
                    most.max(ratio(here, cells.middles(i, j)[axis]))
                })
            })
        }
        QualityMetric::Warp => each(&|i, j| cells.warp(i, j)),
        QualityMetric::Turn => each(&|i, j| cells.turn(i, j)),
        QualityMetric::Area => each(&|i, j| cells.area(i, j)),
    }
}

/// The cells, (i, j) from 0, that are turned over against those around them, in order.
///
/// In a plane grid all cells are compared with the sign of the whole; in a curved one with the mean
/// normal of the cells around, so of a large fold its border is reported.
pub fn folded_cells<T: Real>(grid: &SurfaceGrid<T>) -> Vec<[usize; 2]> {
    folded(grid, &|| Ok(())).expect("nothing ends it")
}

/// As [`folded_cells`]; ends early when `budget` is spent.
///
/// # Errors
/// The exceeded limit.
pub fn folded_cells_until<T: Real>(
    grid: &SurfaceGrid<T>,
    budget: &Budget,
) -> Result<Vec<[usize; 2]>, Spent> {
    folded(grid, &|| budget.poll())
}

fn folded<T: Real>(
    grid: &SurfaceGrid<T>,
    go_on: &dyn Fn() -> Result<(), Spent>,
) -> Result<Vec<[usize; 2]>, Spent> {
    let plain = grid.re();
    let n = grid.n.saturating_sub(1).max(1);
    let jacobians = measured(&plain, QualityMetric::ScaledJacobian, go_on)?;
    let folded = jacobians.iter().enumerate().filter(|(_, x)| **x < 0.0);
    Ok(folded.map(|(k, _)| [k / n, k % n]).collect())
}

struct GridCells<'a, T> {
    grid: &'a SurfaceGrid<T>,
    m: usize,
    n: usize,
}

/// The root, or zero with derivative zero.
fn root<T: Real>(square: T) -> T {
    if square.re() > 0.0 { square.sqrt() } else { T::zero() }
}

fn length<T: Real>(d: Vec3<T>) -> T {
    root(d.norm_sq())
}

/// The larger over the smaller; 1 when both vanish.
fn ratio<T: Real>(a: T, b: T) -> T {
    let (most, least) = if a.re() < b.re() { (b, a) } else { (a, b) };
    if most.re() == 0.0 { T::one() } else { most / least }
}

impl<T: Real> GridCells<'_, T> {
    /// The corners, counter-clockwise as seen from the side of r_i x r_j.
    fn corners(&self, i: usize, j: usize) -> [Vec3<T>; 4] {
        let s = self.grid;
        [s.at(i, j), s.at(i + 1, j), s.at(i + 1, j + 1), s.at(i, j + 1)]
    }

    fn sides(&self, i: usize, j: usize) -> [Vec3<T>; 4] {
        let [a, b, c, d] = self.corners(i, j);
        [b - a, c - b, d - c, a - d]
    }

    /// Lengths along i and along j, between the middles of sides.
    fn middles(&self, i: usize, j: usize) -> [T; 2] {
        let [a, b, c, d] = self.corners(i, j);
        [length(b + c - a - d) * 0.5, length(c + d - a - b) * 0.5]
    }

    /// Twice the area vector.
    fn normal(&self, i: usize, j: usize) -> Vec3<T> {
        let [a, b, c, d] = self.corners(i, j);
        (c - a).cross(d - b)
    }

    fn area(&self, i: usize, j: usize) -> T {
        let [a, b, c, d] = self.corners(i, j);
        let triangle = |p: Vec3<T>, q: Vec3<T>, r: Vec3<T>| length((q - p).cross(r - p));
        (triangle(a, b, c) + triangle(a, c, d) + triangle(a, b, d) + triangle(b, c, d)) * 0.25
    }

    /// The direction that a cell's normal is compared with.
    fn reference_normals(
        &self,
        go_on: &dyn Fn() -> Result<(), Spent>,
    ) -> Result<Vec<Vec3<f64>>, Spent> {
        let mut all: Vec<Vec3> = Vec::with_capacity(self.m * self.n);
        for i in 0..self.m {
            go_on()?;
            all.extend((0..self.n).map(|j| self.normal(i, j).re()));
        }
        let total = all.iter().fold(Vec3::zero(), |sum, v| sum + *v);
        let swept = all.iter().map(|v| v.norm()).sum::<f64>();
        // Plane: no normal leaves the line of the total.
        let across = |v: &Vec3| v.cross(total).norm() > 1e-9 * v.norm() * total.norm();
        if total.norm() > 1e-6 * swept && !all.iter().any(across) {
            return Ok(vec![total / total.norm(); all.len()]);
        }
        let around = |k: usize| {
            let (i, j) = (k / self.n, k % self.n);
            let mut sum = Vec3::zero();
            for a in i.saturating_sub(1)..(i + 2).min(self.m) {
                for b in j.saturating_sub(1)..(j + 2).min(self.n) {
                    sum += all[a * self.n + b];
                }
            }
            sum.normalized().unwrap_or_default()
        };
        let mut around_all = Vec::with_capacity(all.len());
        for i in 0..self.m {
            go_on()?;
            around_all.extend((i * self.n..(i + 1) * self.n).map(around));
        }
        Ok(around_all)
    }

    fn scaled_jacobian(&self, i: usize, j: usize, reference: Vec3) -> T {
        let sides = self.sides(i, j);
        let reference = Vec3::lifted(reference);
        let mut least: Option<T> = None;
        for k in 0..4 {
            let (next, last) = (sides[k], -sides[(k + 3) % 4]);
            let scale = length(next) * length(last);
            if scale.re() == 0.0 {
                continue;
            }
            let cross = next.cross(last);
            let size = length(cross);
            // The sine of the angle, with the sign of the side that the corner faces.
            let sine = if cross.dot(reference).re() < 0.0 { -size } else { size } / scale;
            least = Some(least.map_or(sine, |least| least.min(sine)));
        }
        least.unwrap_or_default()
    }

    fn skew(&self, i: usize, j: usize) -> T {
        let sides: Vec<Vec3<T>> =
            self.sides(i, j).into_iter().filter(|d| d.norm_sq().re() > 0.0).collect();
        let n = sides.len();
        if n < 3 {
            return T::one();
        }
        let best = std::f64::consts::PI * (1.0 - 2.0 / n as f64);
        (0..n).fold(T::zero(), |worst, k| {
            let (next, last) = (sides[k], -sides[(k + n - 1) % n]);
            let angle = length(next.cross(last)).atan2(next.dot(last));
            let sharp = (-angle + best) / best;
            let blunt = (angle - best) / (std::f64::consts::PI - best);
            worst.max(sharp).max(blunt)
        })
    }

    fn warp(&self, i: usize, j: usize) -> T {
        let [a, b, ..] = self.corners(i, j);
        let normal = self.normal(i, j);
        let area = self.area(i, j);
        let size = length(normal);
        if size.re() == 0.0 || area.re() == 0.0 {
            return T::zero();
        }
        ((b - a).dot(normal) / size * 0.5).abs() / root(area)
    }

    fn turn(&self, i: usize, j: usize) -> T {
        let s = self.grid;
        let mut most = T::zero();
        for (i, j) in [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)] {
            let lines = [
                (i > 0 && i + 1 < s.m).then(|| [s.at(i - 1, j), s.at(i, j), s.at(i + 1, j)]),
                (j > 0 && j + 1 < s.n).then(|| [s.at(i, j - 1), s.at(i, j), s.at(i, j + 1)]),
            ];
            for [a, b, c] in lines.into_iter().flatten() {
                let (before, after) = (b - a, c - b);
                let sine = length(before.cross(after));
                if before.norm_sq().re() > 0.0 && after.norm_sq().re() > 0.0 {
                    most = most.max(sine.atan2(before.dot(after)));
                }
            }
        }
        most
    }
}
