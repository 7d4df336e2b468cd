//! A curve strictly inside the tolerances of data that has far fewer control points than these.
//!
//! The curve in the middle of tolerances `level` times as large, the least of -sum log((level a)^2 - |x(t) - p|^2),
//! by damped Newton steps, while the level falls towards the largest residual (Nesterov and Nemirovskii 1994).

use crate::curve::least_squares::NarrowOrder;
use crate::optimum::band::Band;
use crate::{FairError, SparseRows};
use moldloft_num::Vec3;

/// Newton steps at most, and the decrement from which on a curve is in the middle.
const STEPS: usize = 120;
const CENTRED: f64 = 0.25;

/// Relative distance between level and largest residual at convergence.
const CLOSE: f64 = 1e-6;

/// Residuals above this fraction of the level are infeasible.
const OUTER: f64 = 0.95;

/// Fraction of the distance to the largest residual that remains after a step of the level.
const LEFT: f64 = 0.1;

/// Of very many data those that are farthest in each block of neighbours are searched, and others as they are
/// passed: more than `MANY`, and blocks for each control point.
const MANY: usize = 2_000;
const BLOCKS: usize = 8;

/// The square of Newton's decrement from which on the middle of a level bounds the least level from below.
const PROVES: f64 = 1e-4;

/// The curve in the middle of the tolerances `radii` of points on the rows of a spline, begun at `start`; else the
/// points that keep it out.
///
/// # Errors
/// [`FairError::TooLarge`].
pub(crate) fn centre(
    rows: &SparseRows,
    points: &[Vec3<f64>],
    radii: &[f64],
    start: &[Vec3<f64>],
    order: &NarrowOrder,
    free: &[bool],
) -> Result<Result<Vec<Vec3<f64>>, Vec<bool>>, FairError> {
    let n = points.len();
    let mut band = Band::zero(3 * start.len(), 3 * (order.span + 1) - 1)?;
    let mut control = start.to_vec();
    let mut search = CentreSearch { rows, points, radii, order, free, own: (0..n).collect() };
    let blocks = BLOCKS * start.len();
    if n > MANY.max(4 * blocks) {
        search.own = Vec::new();
        let mut inside = true;
        while inside && search.extend(&control, blocks) {
            inside = search.inside(&mut band, &mut control);
        }
        if !inside {
            return Ok(Err(search.outer(&control)));
        }
        search.own = (0..n).collect();
    }
    let inside = search.inside(&mut band, &mut control);
    Ok(if inside { Ok(control) } else { Err(search.outer(&control)) })
}

struct CentreSearch<'a> {
    rows: &'a SparseRows,
    points: &'a [Vec3<f64>],
    radii: &'a [f64],
    order: &'a NarrowOrder,
    free: &'a [bool],
    /// The data that are searched.
    own: Vec<usize>,
}

impl CentreSearch<'_> {
    fn off(&self, control: &[Vec3<f64>], k: usize) -> Vec3<f64> {
        (self.rows.apply(k, control) - self.points[k]) * (1.0 / self.radii[k])
    }

    /// True for the data that keep the curve out.
    fn outer(&self, control: &[Vec3<f64>]) -> Vec<bool> {
        let all: Vec<f64> = (0..self.points.len()).map(|k| self.off(control, k).norm()).collect();
        let largest = all.iter().copied().fold(0.0, f64::max);
        all.iter().map(|&r| r > OUTER * largest).collect()
    }

    /// Adds the data of each block that are farthest outside of their tolerances, one on either side; at first
    /// whether outside or not. False if none are.
    fn extend(&mut self, control: &[Vec3<f64>], blocks: usize) -> bool {
        let n = self.points.len();
        let least = if self.own.is_empty() { 0.0 } else { 1.0 };
        let before = self.own.len();
        for b in 0..blocks {
            let off = |k: usize| self.off(control, k);
            let farthest = |side: Option<Vec3<f64>>| {
                let other = |v: Vec3<f64>| side.is_none_or(|s| s.dot(v) < 0.0);
                let own = (b * n / blocks..(b + 1) * n / blocks).map(|k| (k, off(k)));
                let all = own.filter(|(_, v)| v.norm_sq() >= least && other(*v));
                all.max_by(|a, b| a.1.norm_sq().total_cmp(&b.1.norm_sq()))
            };
            if let Some((first, side)) = farthest(None) {
                let second = farthest(Some(side)).map(|f| f.0);
                self.own.extend([Some(first), second].into_iter().flatten());
            }
        }
        self.own.len() > before
    }

    /// The largest residual over its tolerance, of the data that are searched.
    fn largest(&self, control: &[Vec3<f64>]) -> f64 {
        self.own.iter().map(|&k| self.off(control, k).norm_sq()).fold(0.0, f64::max).sqrt()
    }

    /// The square of a level that no curve is below, in the middle of `level`: there the squares of the residuals
    /// weighed by 1 / (level^2 - r^2) are the least.
    fn least(&self, control: &[Vec3<f64>], level: f64) -> f64 {
        let square = level * level;
        let weight = |&k: &usize| 1.0 / (square - self.off(control, k).norm_sq());
        square - self.own.len() as f64 / self.own.iter().map(weight).sum::<f64>()
    }

    /// Moves the curve to the middle of the tolerances; false if it is outside of them.
    fn inside(&self, band: &mut Band, control: &mut [Vec3<f64>]) -> bool {
        let mut largest = self.largest(control);
        let mut level = if largest < 1.0 { 1.0 } else { 1.1 * largest };
        for _ in 0..STEPS {
            let decrement = self.step(band, control, level);
            largest = self.largest(control);
            if level > 1.0 && largest < 1.0 - 1e-12 {
                level = 1.0;
            } else if decrement < CENTRED {
                if level == 1.0 {
                    return true;
                }
                if decrement < PROVES && self.least(control, level) > 1.0
                    || level - largest <= CLOSE * level
                {
                    break;
                }
                level = f64::max(1.0, largest + LEFT * (level - largest));
            }
        }
        level == 1.0 && largest < 1.0
    }

    /// The sum of logarithms; infinite outside.
    fn potential(&self, control: &[Vec3<f64>], level: f64) -> f64 {
        let mut sum = 0.0;
        for &k in &self.own {
            let room = level * level - self.off(control, k).norm_sq();
            if room <= 0.0 {
                return f64::INFINITY;
            }
            sum -= libm::log(room);
        }
        sum
    }

    /// One damped Newton step; the square of Newton's decrement.
    fn step(&self, band: &mut Band, control: &mut [Vec3<f64>], level: f64) -> f64 {
        let place = &self.order.place;
        let n = control.len();
        band.clear();
        let mut slope = vec![0.0; 3 * n];
        for &k in &self.own {
            let r = self.off(control, k).to_array();
            let room = level * level - (r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
            let unit = 1.0 / self.radii[k];
            let (a, b) = (2.0 / room, 4.0 / (room * room));
            let entry = |i: usize, j: usize| b * r[i] * r[j] + if i == j { a } else { 0.0 };
            let block: [[f64; 3]; 3] =
                std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j) * unit * unit));
            let (columns, factors) = self.rows.row(k);
            for (i, (&ci, &x)) in columns.iter().zip(factors).enumerate() {
                let ci = ci as usize;
                if !self.free[ci] {
                    continue;
                }
                for (axis, r) in r.iter().enumerate() {
                    slope[3 * place[ci] + axis] += a * r * x * unit;
                }
                for (&cj, &y) in columns[..=i].iter().zip(factors) {
                    let cj = cj as usize;
                    if self.free[cj] {
                        let (i, j) = (place[ci], place[cj]);
                        band.add_block(i.max(j), i.min(j), x * y, &block);
                    }
                }
            }
        }
        for c in (0..n).filter(|&c| !self.free[c]) {
            let unit = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
            band.add_block(place[c], place[c], 1.0, &unit);
        }
        band.factor();
        let mut way: Vec<f64> = slope.iter().map(|g| -g).collect();
        band.solve(&mut way);
        let decrement: f64 = -slope.iter().zip(&way).map(|(g, d)| g * d).sum::<f64>();
        if !(decrement.is_finite() && decrement > 0.0) {
            return 0.0;
        }
        let here = self.potential(control, level);
        let mut by = if decrement > 1.0 { 1.0f64.min(4.0 / (1.0 + decrement.sqrt())) } else { 1.0 };
        for _ in 0..40 {
            let mut next = control.to_vec();
            for (c, p) in next.iter_mut().enumerate().filter(|(c, _)| self.free[*c]) {
                let at = 3 * place[c];
                *p += Vec3::of(way[at], way[at + 1], way[at + 2]) * by;
            }
            if self.potential(&next, level) <= here - 0.1 * by * decrement {
                control.copy_from_slice(&next);
                return decrement;
            }
            by *= 0.5;
        }
        // The rest is rounding.
        0.0
    }
}
