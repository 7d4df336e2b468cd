//! Chord lengths of points that noise has put in the wrong order.
//!
//! Where points are nearer to each other than their noise, steps go back along the curve. A chord
//! counts them as steps forward, which a straight line cannot follow. There positions along the
//! local direction are the parameters, with the least change that makes them rise: the mean of the
//! largest before and the least after (the isotonic regression of the least largest change).

use moldloft_num::Vec3;

/// The distance, in sums of the tolerances of a step's two points, within which others decide its
/// direction.
const REACH: f64 = 8.0;

/// Ratio of a step's part along the local direction to its length below which it is aside.
const SIDEWAYS: f64 = 0.7;

/// Fraction of the length within reach that is aside from which on positions are used entirely.
const ASIDE: f64 = 0.002;

/// Ratio to the tolerances at which a step back, and the distance of points from a line, cease to
/// be noise: 1 to this.
const BEYOND: f64 = 1.5;

/// A step's least length, in chords.
const LEAST: f64 = 0.05;

/// Positions along a noisy curve.
pub(super) struct NoisyOrder {
    /// Its rising positions, from 0.
    pub at: Vec<f64>,
    /// Sum of the squared moves along the curve that made them rise, over the tolerances.
    pub moved: f64,
}

/// Positions of open points with steps back or aside within their tolerances; `None` if there are
/// none.
pub(super) fn in_noisy_order(points: &[Vec3<f64>], radii: &[f64]) -> Option<NoisyOrder> {
    let steps = points.len().checked_sub(1)?;
    let chords: Vec<Vec3<f64>> = points.windows(2).map(|w| w[1] - w[0]).collect();
    let lengths: Vec<f64> = chords.iter().map(|c| c.norm()).collect();
    let room = |k: usize| Some(radii[k] + radii[k + 1]).filter(|r| r.is_finite());
    // Nearby steps with their weights.
    let near: Vec<Vec<(usize, f64)>> = (0..steps).map(|k| nearby(points, room(k), k)).collect();
    let ways: Vec<Option<Vec3<f64>>> = (0..steps).map(|k| way(&chords, &near[k])).collect();
    let along: Vec<f64> =
        (0..steps).map(|k| ways[k].map_or(lengths[k], |way| chords[k].dot(way))).collect();
    // Steps back that are no noise, and those of a curve that turns within reach, are chords.
    let noise: Vec<f64> = (0..steps)
        .map(|k| match (ways[k], room(k)) {
            (Some(way), Some(room)) if room > 0.0 => {
                let wide = 2.0 * across(points, way, &near[k]) / room;
                fading(-along[k] / room) * fading(wide)
            }
            _ => 0.0,
        })
        .collect();
    let aside: Vec<f64> =
        (0..steps).map(|k| (SIDEWAYS * lengths[k] - along[k]).max(0.0) * noise[k]).collect();
    if aside.iter().all(|&b| b == 0.0) {
        return None;
    }
    let signed: Vec<f64> = (0..steps)
        .map(|k| {
            let sum = |of: &dyn Fn(usize) -> f64| -> f64 {
                near[k].iter().map(|&(j, w)| w * of(j)).sum()
            };
            let share = sum(&|j| aside[j]) / (ASIDE * sum(&|j| lengths[j]));
            let share = share.min(1.0) * noise[k];
            if share == 0.0 { lengths[k] } else { lengths[k] + (along[k] - lengths[k]) * share }
        })
        .collect();
    let mut own: Vec<f64> = vec![0.0];
    for &step in &signed {
        own.push(own[own.len() - 1] + step);
    }
    let mut high = own.clone();
    for k in 1..own.len() {
        high[k] = high[k - 1].max(own[k]);
    }
    let mut low = own.clone();
    for k in (0..steps).rev() {
        low[k] = low[k + 1].min(own[k]);
    }
    let placed = |k: usize| (low[k] + high[k]) * 0.5;
    let square = |k: usize| {
        let by = (placed(k) - own[k]) / radii[k];
        if by.is_finite() { by * by } else { 0.0 }
    };
    let moved = (0..own.len()).map(square).sum();
    let mut at = vec![0.0];
    for k in 0..steps {
        let step = (placed(k + 1) - placed(k)).max(lengths[k] * LEAST);
        at.push(at[k] + step);
    }
    Some(NoisyOrder { at, moved })
}

/// 1 for ratios up to 1, 0 from [`BEYOND`] on.
fn fading(ratio: f64) -> f64 {
    ((BEYOND - ratio) / (BEYOND - 1.0)).clamp(0.0, 1.0)
}

/// The direction of steps, by their weights.
fn way(chords: &[Vec3<f64>], near: &[(usize, f64)]) -> Option<Vec3<f64>> {
    near.iter().fold(Vec3::zero(), |s, &(j, w)| s + chords[j] * w).normalized()
}

/// The root mean square of the distances of steps' middles from a line, by their weights.
fn across(points: &[Vec3<f64>], way: Vec3<f64>, near: &[(usize, f64)]) -> f64 {
    let middle = |j: usize| (points[j] + points[j + 1]) * 0.5;
    let all: f64 = near.iter().map(|n| n.1).sum();
    let mean = near.iter().fold(Vec3::zero(), |s, &(j, w)| s + middle(j) * (w / all));
    let square = |v: Vec3<f64>| (v - way * way.dot(v)).norm_sq();
    let sum: f64 = near.iter().map(|&(j, w)| w / all * square(middle(j) - mean)).sum();
    sum.sqrt()
}

/// The steps from each to each of which all are near step `k`, with weights from 1 for its own to
/// 0.
fn nearby(points: &[Vec3<f64>], room: Option<f64>, k: usize) -> Vec<(usize, f64)> {
    let mut out = vec![(k, 1.0)];
    let Some(room) = room.filter(|&r| r > 0.0) else { return out };
    let middle = (points[k] + points[k + 1]) * 0.5;
    let square = (REACH * room) * (REACH * room);
    let weight = |p: Vec3<f64>| (1.0 - (p - middle).norm_sq() / square).max(0.0);
    let mut least = weight(points[k + 1]);
    for j in k + 1..points.len() - 1 {
        least = least.min(weight(points[j + 1]));
        if least == 0.0 {
            break;
        }
        out.push((j, least));
    }
    let mut least = weight(points[k]);
    for j in (0..k).rev() {
        least = least.min(weight(points[j]));
        if least == 0.0 {
            break;
        }
        out.push((j, least));
    }
    out
}
