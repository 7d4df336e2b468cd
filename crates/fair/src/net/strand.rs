//! One curve of a network, and its measure over its own points.

use crate::{EndContinuity, Measure, Space};
use moldloft_num::Real;

/// One curve of a network.
#[derive(Clone, Debug, PartialEq)]
pub struct NetworkCurve {
    /// Its spline.
    pub space: Space,
    /// Its control points: places in the network's list.
    pub points: Vec<usize>,
    /// Weights of a rational curve.
    pub weights: Option<Vec<f64>>,
    /// Its own places that are intended breaks.
    pub marks: Vec<usize>,
    /// Straight runs among its points, from place to place: nothing is smoothed across their ends but
    /// the tangent.
    pub runs: Vec<[usize; 2]>,
    /// Continuity kept at its ends when it is faired alone.
    pub ends: [EndContinuity; 2],
    /// Parameters of its points in [0, 1], for points that the curve passes through: measures are
    /// then those of divided differences. Without them the points are control points of its
    /// spline.
    pub at: Option<Vec<f64>>,
}

impl NetworkCurve {
    /// The rows of a measure over its own points, at parameters that may carry derivatives.
    pub(super) fn divided<T: Real>(&self, measure: Measure, at: &[T]) -> Vec<Vec<(usize, T)>> {
        let (closed, degree) = (self.space.is_closed(), self.space.degree());
        let mut rows = measure.divided(at, closed, degree);
        let ends = |c: &usize| self.marks.contains(c) || self.runs.iter().flatten().any(|e| e == c);
        let within = |c: usize, run: &[usize; 2]| run[0] <= c && c <= run[1];
        rows.retain(|row| {
            let inner = &row[1..row.len() - 1];
            let straight = self.runs.iter().any(|run| row.iter().all(|&(c, _)| within(c, run)));
            !straight && !inner.iter().any(|(c, _)| ends(c))
        });
        let n = at.len();
        let order = measure.order(degree);
        for &run in &self.runs {
            for (end, back) in [(run[1], false), (run[0], true)] {
                // The end counts twice, the second time as the tangent of the run.
                let step = |k: usize| if back { end.checked_sub(k) } else { Some(end + k) };
                let place = |k: usize| match step(k) {
                    Some(i) if i < n => Some((i, T::zero())),
                    Some(i) => closed.then(|| (i - n, T::one())),
                    None => closed.then(|| (end + n - k, -T::one())),
                };
                let nodes: Option<Vec<(usize, T)>> = (0..order).map(place).collect();
                let Some(nodes) = nodes.filter(|_| !self.marks.contains(&end)) else { continue };
                if order < 2 || nodes[1..order - 1].iter().any(|(c, _)| ends(c)) {
                    continue;
                }
                let nodes: Vec<(usize, T)> =
                    nodes.into_iter().map(|(c, round)| (c, at[c] + round)).collect();
                rows.push(beside_run(&nodes, run.map(|c| (c, at[c]))));
            }
        }
        rows
    }
}

/// The weighted divided difference, as [`Measure::divided`] has it, of nodes of which the first counts
/// twice: its slope is that of a run.
fn beside_run<T: Real>(nodes: &[(usize, T)], run: [(usize, T); 2]) -> Vec<(usize, T)> {
    let (end, others) = (nodes[0], &nodes[1..]);
    let order = nodes.len();
    let factorial: f64 = (1..=order).map(|i| i as f64).product();
    let span = others[others.len() - 1].1 - end.1;
    let size = if span.re() < 0.0 { -span } else { span };
    let weight = (size / order as f64).sqrt() * factorial;
    let all = others.iter().fold(T::one(), |s, o| s * (end.1 - o.1));
    let slope = weight / all;
    let sum = others.iter().fold(T::zero(), |s, o| s + T::one() / (end.1 - o.1));
    let mut row = vec![(end.0, -slope * sum)];
    for (k, o) in others.iter().enumerate() {
        let apart = o.1 - end.1;
        let beside = others.iter().enumerate().filter(|(l, _)| *l != k);
        let product = beside.fold(apart * apart, |s, (_, l)| s * (o.1 - l.1));
        row.push((o.0, weight / product));
    }
    let length = run[1].1 - run[0].1;
    for (sign, (c, _)) in [(-T::one(), run[0]), (T::one(), run[1])] {
        match row.iter_mut().find(|e| e.0 == c) {
            Some(entry) => entry.1 += slope * sign / length,
            None => row.push((c, slope * sign / length)),
        }
    }
    row
}
