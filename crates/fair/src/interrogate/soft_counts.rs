//! Counts of inflections and monotone pieces that are continuous in the curve: each ripple counts
//! by its persistence.

use crate::interrogate::shape::{Sample, UNCOUNTED, curvature_floors, curvatures};

/// Inflections and monotone pieces of the curvature, a ripple near the floor below which it is not
/// counted as a part of one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SoftCounts {
    pub inflections: f64,
    pub pieces: f64,
}

impl SoftCounts {
    /// The counts of the samples of [`crate::shape::pieces`]: a ripple of `from` floors counts
    /// nothing, one of `to` floors and more whole.
    pub fn of(samples: &[Sample], [from, to]: [f64; 2]) -> Self {
        let Some(floors) = curvature_floors(samples, UNCOUNTED) else {
            return Self { inflections: 0.0, pieces: 1.0 };
        };
        let values = curvatures(samples);
        let counted = |share: f64| ((share - from) / (to - from)).clamp(0.0, 1.0);
        let sum =
            |all: Vec<(f64, f64)>| all.iter().map(|(share, by)| by * counted(*share)).sum::<f64>();
        let most = values.iter().fold(0.0_f64, |m, k| m.max(k.abs()));
        Self {
            inflections: sum(lobes(&values, UNCOUNTED * most)),
            pieces: 1.0 + sum(swings(&values, &floors)),
        }
    }
}

/// Swings of a list of numbers relative to floors, each with its number of monotone pieces: two
/// inside, one at an end. Swings are removed in increasing order (the rainflow count of Matsuishi
/// and Endo 1968), so that a swing is the difference of its extrema after all smaller ones are
/// removed. The last is not in the list.
fn swings(values: &[f64], floors: &[f64]) -> Vec<(f64, f64)> {
    let share = |a: &(f64, f64), b: &(f64, f64)| (a.0 - b.0).abs() / a.1.max(b.1);
    let range = |a: &(f64, f64), b: &(f64, f64)| (a.0 - b.0).abs();
    let mut out = Vec::new();
    let mut stack: Vec<(f64, f64)> = Vec::new();
    for extreme in extremes(values, floors) {
        stack.push(extreme);
        while let [.., a, b, c, d] = stack.as_slice() {
            if range(b, c) > range(a, b) || range(b, c) > range(c, d) {
                break;
            }
            out.push((share(b, c), 2.0));
            let last = stack.len();
            stack.drain(last - 3..last - 1);
        }
    }
    // The remaining swings grow, then shrink: the smallest is at one of the ends.
    let mut left = stack.as_slice();
    while let [first, second, .., before, last] = left {
        let at_start = range(first, second) < range(before, last);
        let gone = if at_start { share(first, second) } else { share(before, last) };
        out.push((gone, 1.0));
        left = if at_start { &left[1..] } else { &left[..left.len() - 1] };
    }
    if let [first, second, last] = left {
        out.push((share(first, second).min(share(second, last)), 1.0));
    }
    out
}

/// The numbers where a list turns, and its ends, each with its floor.
fn extremes(values: &[f64], floors: &[f64]) -> Vec<(f64, f64)> {
    let mut out: Vec<(f64, f64)> = Vec::new();
    for (&v, &floor) in values.iter().zip(floors) {
        match out.as_mut_slice() {
            [.., last] if last.0 == v => last.1 = last.1.max(floor),
            [.., before, last] if (last.0 > before.0) == (v > last.0) => *last = (v, floor),
            _ => out.push((v, floor)),
        }
    }
    out
}

/// Heights, relative to the floor, of the parts of one sign, each with its number of inflections:
/// two inside, one at an end. The lowest is removed first.
fn lobes(values: &[f64], floor: f64) -> Vec<(f64, f64)> {
    let mut heights: Vec<f64> = Vec::new();
    let mut positive = None;
    for &v in values.iter().filter(|v| **v != 0.0) {
        match heights.last_mut().filter(|_| positive == Some(v > 0.0)) {
            Some(height) => *height = height.max(v.abs()),
            None => heights.push(v.abs()),
        }
        positive = Some(v > 0.0);
    }
    let mut out = Vec::new();
    while heights.len() > 1 {
        let lowest = (0..heights.len()).min_by(|&a, &b| heights[a].total_cmp(&heights[b]));
        let k = lowest.unwrap_or(0);
        let share = heights[k] / floor.max(f64::MIN_POSITIVE);
        if k == 0 || k + 1 == heights.len() {
            heights.remove(k);
            out.push((share, 1.0));
        } else {
            heights[k - 1] = heights[k - 1].max(heights[k + 1]);
            heights.drain(k..=k + 1);
            out.push((share, 2.0));
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_swing_counts_by_what_its_extremes_differ() {
        let floors = [1.0; 6];
        let mut all = swings(&[0.0, 10.0, 7.0, 9.0, 1.0, 5.0], &floors);
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        assert_eq!(all, [(2.0, 2.0), (4.0, 1.0), (9.0, 1.0)]);
        assert!(swings(&[0.0, 1.0, 2.0], &floors[..3]).is_empty());
    }

    #[test]
    fn a_lobe_counts_by_its_height() {
        let mut all = lobes(&[1.0, 3.0, -0.5, 2.0, -4.0], 1.0);
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        assert_eq!(all, [(0.5, 2.0), (3.0, 1.0)]);
    }
}
