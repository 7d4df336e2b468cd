//! Cells of a stroke: samples gathered over equal lengths, and the noise of the stroke.

use super::division::StrokeMoments;
use super::{cross, distance, dot, to};
use std::ops::Range;

/// Length of a cell in units of the stroke's size, and in standard deviations of single samples.
const CELL: f64 = 0.01;
const CELL_NOISE: f64 = 3.0;

/// Most cells: the work of the division grows with their square.
const MOST_CELLS: f64 = 240.0;

/// Length along which a hand is off to one side, in units of the stroke's size.
const TOGETHER: f64 = 0.027;

/// Least noise of a hand, in units of the stroke's size.
const STEADY: f64 = 1.5e-3;

/// Largest cut at the start of a closed stroke, and at its end where it does not retrace the start.
const MOST_CUT: f64 = 0.12;

/// Largest part of a closed stroke that retraces its start.
const MOST_RETRACED: f64 = 0.3;

/// Samples gathered over equal lengths of a stroke.
pub(super) struct StrokeCells {
    /// Mean position of each cell.
    pub at: Vec<[f64; 2]>,
    /// Mean moments of each cell.
    pub moments: Vec<StrokeMoments>,
    /// Positions of the samples of each cell.
    pub samples: Vec<Vec<[f64; 2]>>,
    /// Standard deviation across the stroke.
    pub noise: f64,
}

impl StrokeCells {
    /// Gathers points; `jitter` is the standard deviation of a single one.
    pub fn of(points: &[[f64; 2]], jitter: f64) -> StrokeCells {
        let step = (CELL_NOISE * jitter).max(CELL);
        let length = step * gathered(points, step).len() as f64;
        let samples = gathered(points, step.max(length / MOST_CELLS));
        let mut cells =
            StrokeCells { at: vec![], moments: vec![], samples, noise: STEADY.max(0.5 * jitter) };
        for own in &cells.samples {
            let sum = own
                .iter()
                .fold(StrokeMoments::default(), |m, p| m.with(*p, 1.0 / own.len() as f64));
            cells.at.push([sum.x, sum.y]);
            cells.moments.push(sum);
        }

        cells
    }

    /// The cells of a range.
    pub fn part(self, range: Range<usize>) -> StrokeCells {
        StrokeCells {
            at: self.at[range.clone()].to_vec(),
            moments: self.moments[range.clone()].to_vec(),
            samples: self.samples[range].to_vec(),
            noise: self.noise,
        }
    }

    /// The cells from one of them on, round a closed stroke.
    pub fn rotated(mut self, first: usize) -> StrokeCells {
        self.at.rotate_left(first);
        self.moments.rotate_left(first);
        self.samples.rotate_left(first);
        self
    }

    /// Number of neighbours that are off together: a hand is off along some length.
    fn together(&self) -> f64 {
        let length: f64 = self.at.windows(2).map(|w| distance(w[0], w[1])).sum();
        let spacing = length / (self.len() - 1).max(1) as f64;
        1.0 / libm::tanh(0.5 * spacing / TOGETHER)
    }

    /// Half the inverse of the variance of a cell across the stroke, of a noise.
    pub fn precision_of(&self, noise: f64) -> f64 {
        0.5 / (noise * noise * self.together())
    }

    /// The same for the noise of the stroke.
    pub fn precision(&self) -> f64 {
        self.precision_of(self.noise)
    }

    /// Number of cells that are off independently.
    pub fn independent(&self) -> f64 {
        self.len() as f64 / self.together()
    }

    /// Number of cells.
    pub fn len(&self) -> usize {
        self.at.len()
    }
}

/// Points gathered until one is `step` away from the first of its cell.
fn gathered(points: &[[f64; 2]], step: f64) -> Vec<Vec<[f64; 2]>> {
    let mut cells: Vec<Vec<[f64; 2]>> = Vec::new();
    for &p in points {
        match cells.last_mut() {
            Some(own) if distance(own[0], p) < step => own.push(p),
            _ => cells.push(vec![p]),
        }
    }
    cells
}

/// Standard deviation of a coordinate of a single sample, by the median of the third differences.
pub(super) fn noise_of_samples(points: &[[f64; 2]]) -> f64 {
    let mut square: Vec<f64> = (points.windows(4))
        .map(|w| {
            let third = |k: usize| w[3][k] - 3.0 * w[2][k] + 3.0 * w[1][k] - w[0][k];
            third(0) * third(0) + third(1) * third(1)
        })
        .collect();
    if square.is_empty() {
        return 0.0;
    }
    let middle = square.len() / 2;
    let (_, median, _) = square.select_nth_unstable_by(middle, f64::total_cmp);
    // The squares of both coordinates have the median 2 ln 2, third differences 20 times the variance.
    (*median / (2.0 * std::f64::consts::LN_2 * 20.0)).sqrt()
}

/// The part of a stroke that is closed, without ends that overshoot or retrace it; `None` for an
/// open stroke.
pub(super) fn closed_part(cells: &StrokeCells, tolerance: f64) -> Option<Range<usize>> {
    let n = cells.len();
    let mut along = vec![0.0; n];
    for k in 1..n {
        along[k] = along[k - 1] + distance(cells.at[k - 1], cells.at[k]);
    }
    let length = along[n - 1];
    let mut best: Option<(f64, Range<usize>)> = None;
    for first in (0..n).take_while(|&k| along[k] <= MOST_CUT) {
        for last in (first + 3..n).rev() {
            let cut = length - along[last];
            if cut > MOST_RETRACED * length || along[last] - along[first] < 4.0 * tolerance {
                break;
            }
            let apart = distance(cells.at[first], cells.at[last]);
            let price = apart + 0.3 * (along[first] + cut);
            if apart > tolerance || best.as_ref().is_some_and(|b| b.0 <= price) {
                continue;
            }
            let retraced = |k: usize| {
                let head = (first..last).take_while(|&m| along[m] - along[first] <= 2.0 * cut);
                head.clone()
                    .zip(head.skip(1))
                    .any(|(a, b)| off_segment(cells.at[k], cells.at[a], cells.at[b]) <= tolerance)
            };
            if cut <= MOST_CUT || (last..n).all(retraced) {
                best = Some((price, first..last + 1));
            }
        }
    }
    best.map(|b| b.1)
}

/// Distance of a point from a segment.
fn off_segment(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let (way, off) = (to(a, b), to(a, p));
    let square = dot(way, way);
    if square == 0.0 {
        return distance(p, a);
    }
    let part = (dot(way, off) / square).clamp(0.0, 1.0);
    let foot = [a[0] + part * way[0], a[1] + part * way[1]];
    let straight = cross(way, off).abs() / square.sqrt();
    if part > 0.0 && part < 1.0 { straight } else { distance(p, foot) }
}
