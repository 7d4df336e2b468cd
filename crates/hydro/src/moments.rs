//! Moments of whole cells in the axes of the body: below the water at every attitude they give the
//! integrals by the rotation alone, so that only the cells at the waterline are integrated anew.

use crate::attitude::Attitude;
use crate::bernstein::{Row, basis};
use crate::cell::PolynomialCell;
use crate::integrals::{HydrostaticIntegrals, points};
use moldloft_num::{Box3, Real, Vec3, gauss_rule};
use moldloft_parallel::prelude::*;
use std::sync::{Arc, OnceLock};

/// Integrals of n, p n, p p n, |n| and p |n| over a skin with the vector area n.
#[derive(Clone, Copy, Debug)]
struct SkinMoments<T> {
    normal: Vec3<T>,
    /// Row i is of the coordinate i.
    first: [Vec3<T>; 3],
    /// In the order of [`PAIRS`].
    second: [Vec3<T>; 6],
    area: T,
    area_first: Vec3<T>,
}

/// Pairs of coordinates, and the index of each.
const PAIRS: [[usize; 2]; 6] = [[0, 0], [0, 1], [0, 2], [1, 1], [1, 2], [2, 2]];
const PAIR: [[usize; 3]; 3] = [[0, 1, 2], [1, 3, 4], [2, 4, 5]];

impl<T: Real> SkinMoments<T> {
    fn zero() -> Self {
        let zero = Vec3::zero();
        let (first, second) = ([zero; 3], [zero; 6]);
        Self { normal: zero, first, second, area: T::zero(), area_first: zero }
    }

    fn add(&mut self, o: &Self) {
        self.normal += o.normal;
        for k in 0..3 {
            self.first[k] += o.first[k];
        }
        for k in 0..6 {
            self.second[k] += o.second[k];
        }
        self.area += o.area;
        self.area_first += o.area_first;
    }

    fn take(&mut self, p: Vec3<T>, n: Vec3<T>) {
        let square = n.norm_sq();
        if square.re() > 0.0 {
            let area = square.sqrt();
            self.area += area;
            self.area_first += p * area;
        }
        self.normal += n;
        let p = p.to_array();
        for k in 0..3 {
            self.first[k] += n * p[k];
        }
        for (sum, [i, j]) in self.second.iter_mut().zip(PAIRS) {
            *sum += n * (p[i] * p[j]);
        }
    }

    /// The integrals about an origin, with the earth `axes` in those of the body; `offset` is the
    /// origin of the moments relative to that of the integrals.
    fn turned(&self, axes: [Vec3<T>; 3], offset: Vec3<T>) -> HydrostaticIntegrals<T> {
        let [_, _, up] = axes;
        let column = self.normal.dot(up);
        let first = Vec3::from(self.first.map(|m| m.dot(up)));
        let second = self.second.map(|m| m.dot(up));
        let s = offset.to_array();
        let one = axes.map(|a| a.dot(first));
        // The integral of (a.q + s_a) n_z, and of (a.q + s_a) (b.q + s_b) n_z.
        let linear = |a: usize| one[a] + column * s[a];
        let square = |a: usize, b: usize| {
            let row = |i: usize| {
                let [x, y, z] = PAIR[i].map(|k| second[k]);
                axes[b].dot(Vec3::new(x, y, z))
            };
            let both = axes[a].dot(Vec3::new(row(0), row(1), row(2)));
            both + one[a] * s[b] + one[b] * s[a] + column * (s[a] * s[b])
        };
        // The integral of (a.q + s_a) n_a.
        let own = |a: usize| {
            let along = Vec3::from(self.first.map(|m| m.dot(axes[a])));
            axes[a].dot(along) + axes[a].dot(self.normal) * s[a]
        };
        let plane = [column, linear(0), linear(1), square(0, 0), square(0, 1), square(1, 1)];
        HydrostaticIntegrals {
            forms: [own(0), own(1), linear(2)],
            moment: Vec3::new(square(0, 2), square(1, 2), square(2, 2) * 0.5),
            wetted: self.area,
            area_moment: Vec3::from(axes.map(|a| a.dot(self.area_first))) + offset * self.area,
            plane: plane.map(|x| -x),
            green: T::zero(),
            open: [0, 1].map(|a| axes[a].dot(self.normal)),
        }
    }
}

/// The moments of a cell, and an estimate of the error of its area; of the others there is none.
#[derive(Clone, Debug)]
struct CellMoments<T> {
    sums: SkinMoments<T>,
    area_error: f64,
}

/// The weights of a rule of quadrature, and the Bernstein polynomials at its points.
type Rule<T> = Vec<(f64, (Row<T>, Row<T>))>;

fn rule<T: Real>(degree: usize, count: usize) -> Rule<T> {
    gauss_rule(count).iter().map(|&(at, w)| (w, basis(degree, T::from(at)))).collect()
}

impl<T: Real> CellMoments<T> {
    /// About `middle`.
    fn new(cell: &PolynomialCell<T>, middle: Vec3) -> Self {
        // The degree of p p n along a parameter is 4 d - 1.
        let fine = cell.degree().map(|d| points(d).max(2 * d));
        let sums = integrated(cell, middle, fine);
        let coarse = [0, 1].map(|k| fine[k] - if cell.degree()[k] <= 1 { 1 } else { 2 });
        let area_error = (sums.area.re() - integrated(cell, middle, coarse).area.re()).abs();
        Self { sums, area_error }
    }
}

fn integrated<T: Real>(
    cell: &PolynomialCell<T>,
    middle: Vec3,
    [count_u, count_v]: [usize; 2],
) -> SkinMoments<T> {
    let [_, dv] = cell.degree();
    let middle = Vec3::lifted(middle);
    let sign = if cell.reversed { -1.0 } else { 1.0 };
    let nodes: Rule<T> = rule(dv, count_v);
    let mut sums = SkinMoments::zero();
    let (mut at, mut by) = (Vec::new(), Vec::new());
    for &(u, weight) in gauss_rule(count_u) {
        cell.line(1, T::from(u), &mut at, &mut by);
        for (across, (values, slopes)) in &nodes {
            let (mut p, mut along_u, mut along_v) = (Vec3::zero(), Vec3::zero(), Vec3::zero());
            for (k, (&c, &d)) in at.iter().zip(&by).enumerate() {
                p += c * values[k];
                along_v += c * slopes[k];
                along_u += d * values[k];
            }
            let n = along_u.cross(along_v).map(|x| x * (sign * weight * across));
            sums.take(p - middle, n);
        }
    }
    sums
}

/// The cells of a body with their moments, each made when it is first below the water.
#[derive(Clone, Debug)]
pub(crate) struct BodyMoments<T> {
    middle: Vec3,
    cells: Vec<BoxedCell<T>>,
}

#[derive(Clone, Debug)]
struct BoxedCell<T> {
    cell: Arc<PolynomialCell<T>>,
    /// Of the box of its control points.
    centre: Vec3,
    half: Vec3,
    moments: OnceLock<CellMoments<T>>,
}

impl<T: Real> BoxedCell<T> {
    fn new(cell: &Arc<PolynomialCell<T>>) -> Self {
        let reach = Box3::around(cell.net().iter().map(|p| p.re()));
        let centre = reach.centre();
        Self { cell: cell.clone(), centre, half: reach.high - centre, moments: OnceLock::new() }
    }

    fn moments(&self, middle: Vec3) -> &CellMoments<T> {
        self.moments.get_or_init(|| CellMoments::new(&self.cell, middle))
    }
}

/// The part of a body below the water.
pub(crate) struct Below<T> {
    /// The integrals over whole cells below the water.
    pub sums: HydrostaticIntegrals<T>,
    /// An estimate of the error of their area.
    pub area_error: f64,
    /// The other cells that are not above the water.
    pub across: Vec<usize>,
}

/// Minimum number of cells for parallel work.
const WORTH_A_THREAD: usize = 256;

impl<T: Real> BodyMoments<T> {
    pub fn new(cells: &[Arc<PolynomialCell<T>>], middle: Vec3) -> Self {
        Self { middle, cells: cells.iter().map(BoxedCell::new).collect() }
    }

    /// The part below the water at an attitude, by more than `near`, with the integrals about (x0,
    /// y0) in earth axes. Cells whose areas are not to the relative accuracy `area` together are
    /// left to be halved.
    pub fn below(
        &self,
        attitude: Attitude<T>,
        origin: [T; 2],
        near: f64,
        area: Option<f64>,
    ) -> Below<T> {
        let axes = attitude.axes();
        let (up, level) = (axes[2].re(), attitude.level.re());
        let (mut wet, mut across) = (Vec::new(), Vec::new());
        for (k, cell) in self.cells.iter().enumerate() {
            let height = cell.centre.dot(up) - level;
            let reach = (0..3).map(|k| (cell.half[k] * up[k]).abs()).sum::<f64>() + near;
            if height + reach < 0.0 {
                wet.push(k);
            } else if height - reach <= 0.0 {
                across.push(k);
            }
        }
        let moments = |k: usize| self.cells[k].moments(self.middle);
        if wet.len() >= WORTH_A_THREAD {
            wet.par_iter().for_each(|&k| _ = moments(k));
        }
        if let Some(accuracy) = area {
            let all: f64 = wet.iter().map(|&k| moments(k).sums.area.re()).sum();
            let allowed = accuracy * all / wet.len() as f64;
            let (coarse, fine) = wet.iter().partition(|&&k| moments(k).area_error > allowed);
            (wet, across) = (fine, [across, coarse].concat());
            across.sort_unstable();
        }
        let (mut sums, mut area_error) = (SkinMoments::zero(), 0.0);
        for k in wet {
            sums.add(&moments(k).sums);
            area_error += moments(k).area_error;
        }
        let origin = Vec3::new(origin[0], origin[1], attitude.level);
        let offset = attitude.earth_from(Vec3::lifted(self.middle)) - origin;
        Below { sums: sums.turned(axes, offset), area_error, across }
    }
}
