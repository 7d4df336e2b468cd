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
    let search = CentreSearch { rows, points, radii, order, free };
    let mut control = start.to_vec();
    let mut largest = search.largest(&control);
    let mut level = f64::max(1.0, 1.1 * largest);
    let mut band = Band::zero(3 * control.len(), 3 * (order.span + 1) - 1)?;
    for _ in 0..STEPS {
        let decrement = search.step(&mut band, &mut control, level);
        largest = search.largest(&control);
        if level > 1.0 && largest < 1.0 - 1e-12 {
            level = 1.0;
        } else if decrement < CENTRED {
            if level == 1.0 {
                return Ok(Ok(control));
            }
            if level - largest <= CLOSE * level {
                break;
            }
            level = f64::max(1.0, largest + LEFT * (level - largest));
        }
    }
    if level == 1.0 && largest < 1.0 {
        return Ok(Ok(control));
    }
    let beyond =
        |k: usize| (rows.apply(k, &control) - points[k]).norm() > OUTER * largest * radii[k];
    Ok(Err((0..points.len()).map(beyond).collect()))
}

struct CentreSearch<'a> {
    rows: &'a SparseRows,
    points: &'a [Vec3<f64>],
    radii: &'a [f64],
    order: &'a NarrowOrder,
    free: &'a [bool],
}

impl CentreSearch<'_> {
    fn off(&self, control: &[Vec3<f64>], k: usize) -> Vec3<f64> {
        (self.rows.apply(k, control) - self.points[k]) * (1.0 / self.radii[k])
    }

    /// The largest residual over its tolerance.
    fn largest(&self, control: &[Vec3<f64>]) -> f64 {
        (0..self.points.len()).map(|k| self.off(control, k).norm_sq()).fold(0.0, f64::max).sqrt()
    }

    /// The sum of logarithms; infinite outside.
    fn potential(&self, control: &[Vec3<f64>], level: f64) -> f64 {
        let mut sum = 0.0;
        for k in 0..self.points.len() {
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
        for k in 0..self.points.len() {
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
