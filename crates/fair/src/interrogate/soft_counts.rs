//! Counts of inflections and monotone pieces that are continuous in the curve: each ripple counts
//! by its persistence.

use crate::interrogate::shape::{SAME, STRAIGHT, Sample, UNCOUNTED, curvatures};

/// Persistences at which a ripple starts to count and counts fully. Ripples of a curve count earlier
/// than those of its limits, so that a curve within the soft limits is within the exact ones.
pub(crate) const EARLY: [f64; 2] = [0.8, 1.0];
pub(crate) const LATE: [f64; 2] = [1.0, 1.25];

/// Curvature of the other sign, relative to the largest of its part, that counts as an inflection.
const LOW: f64 = 1e-5;

/// Inflections and monotone pieces of the curvature, a ripple near the floor below which it is not
/// counted as a part of one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SoftCounts {
    pub inflections: f64,
    pub pieces: f64,
}

impl SoftCounts {
    /// The counts of the samples of [`crate::shape::pieces`], of each part between corners: a ripple of `from`
    /// floors counts nothing, one of `to` floors and more whole.
    pub fn of(samples: &[Sample], corners: &[f64], [from, to]: [f64; 2]) -> Self {
        let values = curvatures(samples);
        let counted = |share: f64| ((share - from) / (to - from)).clamp(0.0, 1.0);
        let sum =
            |all: Vec<(f64, f64)>| all.iter().map(|(share, by)| by * counted(*share)).sum::<f64>();
        let largest = |values: &[f64]| values.iter().fold(0.0_f64, |m, k| m.max(k.abs()));
        let far = |s: &Sample| (s.point - samples[0].point).norm();
        let straight = STRAIGHT / samples.iter().map(far).fold(f64::MIN_POSITIVE, f64::max);
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        let range = values.iter().copied().fold(f64::NEG_INFINITY, f64::max) - low;
        // Of a circle nothing counts.
        let circle = SAME * largest(&values).max(straight);
        let floor = UNCOUNTED * range / (range / circle - 1.0).clamp(0.0, 1.0);
        let begins =
            |k: &usize| samples[*k].t <= samples[k - 1].t && corners.contains(&samples[*k].t);
        let inner = (1..samples.len()).filter(begins);
        let bounds: Vec<usize> = [0].into_iter().chain(inner).chain([samples.len()]).collect();
        let mut out = Self { inflections: 0.0, pieces: 0.0 };
        for w in bounds.windows(2) {
            let part = &values[w[0]..w[1]];
            out.inflections += sum(lobes(part, straight.max(LOW * largest(part))));
            out.pieces += 1.0 + sum(swings(part, floor));
        }
        out
    }
}

/// Swings of a list of numbers relative to a floor, each with its number of monotone pieces: two
/// inside, one at an end. Swings are removed in increasing order (the rainflow count of Matsuishi
/// and Endo 1968), so that a swing is the difference of its extrema after all smaller ones are
/// removed. The last is not in the list.
fn swings(values: &[f64], floor: f64) -> Vec<(f64, f64)> {
    let range = |a: f64, b: f64| (a - b).abs();
    let mut out = Vec::new();
    let mut stack: Vec<f64> = Vec::new();
    for extreme in extremes(values) {
        stack.push(extreme);
        while let &[.., a, b, c, d] = stack.as_slice() {
            if range(b, c) > range(a, b) || range(b, c) > range(c, d) {
                break;
            }
            out.push((range(b, c) / floor, 2.0));
            let last = stack.len();
            stack.drain(last - 3..last - 1);
        }
    }
    // The remaining swings grow, then shrink: the smallest is at one of the ends.
    let mut left = stack.as_slice();
    while let &[first, second, .., before, last] = left {
        let at_start = range(first, second) < range(before, last);
        let gone = if at_start { range(first, second) } else { range(before, last) };
        out.push((gone / floor, 1.0));
        left = if at_start { &left[1..] } else { &left[..left.len() - 1] };
    }
    if let &[first, second, last] = left {
        out.push((range(first, second).min(range(second, last)) / floor, 1.0));
    }
    out
}

/// The numbers where a list turns, and its ends.
fn extremes(values: &[f64]) -> Vec<f64> {
    let mut out: Vec<f64> = Vec::new();
    for &v in values {
        match out.as_mut_slice() {
            [.., last] if *last == v => {}
            [.., before, last] if (*last > *before) == (v > *last) => *last = v,
            _ => out.push(v),
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
        let mut all = swings(&[0.0, 10.0, 7.0, 9.0, 1.0, 5.0], 1.0);
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        assert_eq!(all, [(2.0, 2.0), (4.0, 1.0), (9.0, 1.0)]);
        assert!(swings(&[0.0, 1.0, 2.0], 1.0).is_empty());
    }

    #[test]
    fn a_lobe_counts_by_its_height() {
        let mut all = lobes(&[1.0, 3.0, -0.5, 2.0, -4.0], 1.0);
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        assert_eq!(all, [(0.5, 2.0), (3.0, 1.0)]);
    }
}
