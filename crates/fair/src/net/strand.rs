//! One curve of a network, and its measure over its own points.

use crate::{EndContinuity, Measure, Space};
use moldloft_num::Real;

/// One curve of a network.
#[derive(Clone, Debug, PartialEq)]
pub struct NetworkCurve {
    /// Its spline.
    pub space: Space,
    /// Its control points, by index in the network's list.
    pub points: Vec<usize>,
    /// Weights of a rational curve.
    pub weights: Option<Vec<f64>>,
    /// Its control points that are intended breaks, by index on the curve.
    pub marks: Vec<usize>,
    /// Straight runs, by the indices of their first and last point on the curve: only the tangent
    /// is continuous across their ends.
    pub runs: Vec<[usize; 2]>,
    /// Continuity at its ends when it is faired alone.
    pub ends: [EndContinuity; 2],
    /// Parameters of its points in [0, 1], for a curve through its points: measures are then those
    /// of divided differences. Without parameters the points are control points of its spline.
    pub at: Option<Vec<f64>>,
}

impl NetworkCurve {
    /// The rows of a measure over its own points, at parameters that may carry derivatives; nothing is smoothed
    /// along `arcs`, nor across their ends but the tangent.
    pub(super) fn divided<T: Real>(
        &self,
        measure: Measure,
        at: &[T],
        arcs: &[[usize; 2]],
    ) -> Vec<Vec<(usize, T)>> {
        let (closed, degree) = (self.space.is_closed(), self.space.degree());
        let mut rows = measure.divided(at, closed, degree);
        let shapes = || self.runs.iter().chain(arcs);
        let ends = |c: &usize| self.marks.contains(c) || shapes().flatten().any(|e| e == c);
        let within = |c: usize, run: &[usize; 2]| run[0] <= c && c <= run[1];
        let shaped =
            |row: &[(usize, T)]| shapes().any(|run| row.iter().all(|&(c, _)| within(c, run)));
        rows.retain(|row| {
            let inner = &row[1..row.len() - 1];
            !shaped(row) && !inner.iter().any(|(c, _)| ends(c))
        });
        let n = at.len();
        let order = measure.order(degree);
        for (&run, round) in
            self.runs.iter().map(|r| (r, false)).chain(arcs.iter().map(|r| (r, true)))
        {
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
                if order < 2 || nodes[1..order - 1].iter().any(|(c, _)| ends(c)) || shaped(&nodes) {
                    continue;
                }
                let nodes: Vec<(usize, T)> =
                    nodes.into_iter().map(|(c, round)| (c, at[c] + round)).collect();
                let slope = if round {
                    let last = if back { run[0] + 3 } else { run[1] - 3 };
                    let near = last.min(end)..=last.max(end);
                    slope_at(at, near, end)
                } else {
                    let length = at[run[1]] - at[run[0]];
                    vec![(run[0], -T::one() / length), (run[1], T::one() / length)]
                };
                rows.push(beside_run(&nodes, &slope));
            }
        }
        rows
    }
}

/// The slope at one of some points of the polynomial through them.
fn slope_at<T: Real>(
    at: &[T],
    points: std::ops::RangeInclusive<usize>,
    place: usize,
) -> Vec<(usize, T)> {
    let others = |k: usize| points.clone().filter(move |&l| l != k);
    let weight = |k: usize| {
        if k == place {
            return others(k).fold(T::zero(), |s, l| s + T::one() / (at[k] - at[l]));
        }
        let above =
            others(k).filter(|&l| l != place).fold(T::one(), |s, l| s * (at[place] - at[l]));
        above / others(k).fold(T::one(), |s, l| s * (at[k] - at[l]))
    };
    points.clone().map(|k| (k, weight(k))).collect()
}

/// The weighted divided difference, as [`Measure::divided`] has it, of nodes of which the first counts
/// twice: its slope is that of a run or an arc, a sum over points.
fn beside_run<T: Real>(nodes: &[(usize, T)], own: &[(usize, T)]) -> Vec<(usize, T)> {
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
    for &(c, weight) in own {
        match row.iter_mut().find(|e| e.0 == c) {
            Some(entry) => entry.1 += slope * weight,
            None => row.push((c, slope * weight)),
        }
    }
    row
}
