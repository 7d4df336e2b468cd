//! The likeliest positions of parts whose depth the picture leaves open.
//!
//! A part that only oblique lines connect, such as an apex or a ridge, is where these lines have the
//! most equal lengths. A part without any connection, such as the inner edges of a hole, is where at
//! least two of its planes coincide with planes of the rest.

use crate::drawing::planes::Planes;
use crate::{Align, CoordinateAxis, Drawing};
use moldloft_num::{Real, Vec3};

/// Motions of a plane below this do not count.
const STILL: f64 = 1e-7;

/// Gap of planes that coincide, in standard deviations of the drawn points.
const COINCIDENT_DEVIATIONS: f64 = 4.5;

/// Least deviation of drawn points, relative to the size of the drawing.
const STEADY_HAND: f64 = 2e-3;

/// Least spread of the slopes of oblique lines' lengths, relative to the size, at which equal
/// lengths determine a depth.
const LEAST_SPREAD: f64 = 0.05;

/// Plane positions and their motions along the open depths.
pub(super) struct OpenDepths<'a> {
    pub drawing: &'a Drawing,
    pub planes: &'a Planes,
    /// By axis and plane.
    pub coordinates: [Vec<f64>; 3],
    /// By depth, axis and plane.
    pub motions: Vec<[Vec<f64>; 3]>,
}

/// A plane of a part and one of the rest.
#[derive(Clone, Copy)]
struct PlanePair {
    axis: CoordinateAxis,
    planes: [usize; 2],
    motion: f64,
    gap: f64,
}

impl PlanePair {
    /// The depth at which both coincide.
    fn depth(&self) -> f64 {
        -self.gap / self.motion
    }
}

/// The pairs, sorted by their depths, that can coincide with the first one at one depth; each plane
/// in one pair at most.
fn together(pairs: &[PlanePair], tolerance: f64) -> Vec<PlanePair> {
    let Some(first) = pairs.first() else { return Vec::new() };
    let reach = first.depth() + 2.0 * tolerance / first.motion.abs();
    let mut chosen: Vec<PlanePair> = Vec::new();
    for pair in pairs.iter().take_while(|pair| pair.depth() <= reach) {
        let shared = |c: &PlanePair| {
            c.axis == pair.axis && (0..2).any(|side| c.planes[side] == pair.planes[side])
        };
        if !chosen.iter().any(shared) {
            chosen.push(*pair);
        }
    }
    chosen
}

impl OpenDepths<'_> {
    /// Moves each part to its likeliest depth. Returns for each depth the alignments that hold
    /// there.
    pub fn settle(&mut self) -> Vec<Vec<Align>> {
        if self.motions.is_empty() {
            return Vec::new();
        }
        let size = self.size();
        let tolerance = COINCIDENT_DEVIATIONS * f64::max(self.deviation(), STEADY_HAND * size);
        (0..self.motions.len())
            .map(|depth| {
                if let Some(t) = self.equal_lengths(depth, size) {
                    self.shift(depth, t);
                    return Vec::new();
                }
                let Some((t, pairs)) = self.coincidence(depth, tolerance) else {
                    return Vec::new();
                };
                self.shift(depth, t);
                pairs.iter().filter_map(|pair| self.alignment(pair)).collect()
            })
            .collect()
    }

    fn shift(&mut self, depth: usize, t: f64) {
        for (positions, motions) in self.coordinates.iter_mut().zip(&self.motions[depth]) {
            positions.iter_mut().zip(motions).for_each(|(x, m)| *x += t * m);
        }
    }

    fn size(&self) -> f64 {
        let spread = |c: &Vec<f64>| {
            let low = c.iter().copied().fold(f64::INFINITY, f64::min);
            c.iter().copied().fold(f64::NEG_INFINITY, f64::max) - low
        };
        self.coordinates.iter().filter(|c| !c.is_empty()).map(spread).fold(0.0, f64::max)
    }

    /// A vector of the point at `index` from values of its three planes.
    fn of_point(&self, values: &[Vec<f64>; 3], index: usize) -> Vec3 {
        let at = |a: CoordinateAxis| values[a.index()][self.planes.classes(a)[index] as usize];
        Vec3::new(at(CoordinateAxis::X), at(CoordinateAxis::Y), at(CoordinateAxis::Z))
    }

    /// The standard deviation of a drawn coordinate from the projection of the estimate.
    fn deviation(&self) -> f64 {
        let misses: Vec<[f64; 2]> = (self.planes.ids().iter().enumerate())
            .map(|(k, id)| {
                let drawn = self.drawing.points[id];
                let [u, v] = self.drawing.projection.project(self.of_point(&self.coordinates, k));
                [drawn.u - u, drawn.v - v]
            })
            .collect();
        let n = misses.len() as f64;
        let mean = [0, 1].map(|s| misses.iter().map(|m| m[s]).sum::<f64>() / n);
        let square = |m: &[f64; 2]| (m[0] - mean[0]).powi(2) + (m[1] - mean[1]).powi(2);
        let known = self.planes.counts().iter().sum::<usize>() as f64 - 1.0;
        let freedom = (2.0 * n - known + self.motions.len() as f64).max(1.0);
        Real::sqrt(misses.iter().map(square).sum::<f64>() / freedom)
    }

    /// The depth at which the lines between moving and still points have the least variance of
    /// squared lengths, if these lines determine one.
    fn equal_lengths(&self, depth: usize, size: f64) -> Option<f64> {
        let index = |p| self.planes.ids().binary_search(&p).ok();
        let (mut lengths, mut slopes) = (Vec::new(), Vec::new());
        let mut common: Option<f64> = None;
        for line in self.drawing.lines.values() {
            let (p, q) = (index(line.p)?, index(line.q)?);
            let between =
                |values: &[Vec<f64>; 3]| self.of_point(values, q) - self.of_point(values, p);
            let motion = between(&self.motions[depth]);
            let speed = motion.norm_sq();
            if speed <= STILL * STILL {
                continue;
            }
            // With one speed the squares of the depth cancel.
            if (speed - *common.get_or_insert(speed)).abs() > 1e-6 * speed {
                return None;
            }
            let stroke = between(&self.coordinates);
            lengths.push(stroke.norm_sq());
            slopes.push(2.0 * stroke.dot(motion));
        }
        let n = lengths.len() as f64;
        let speed = Real::sqrt(common?);
        let mean = |values: &[f64]| values.iter().sum::<f64>() / n;
        let (length, slope) = (mean(&lengths), mean(&slopes));
        let variance = slopes.iter().map(|s| (s - slope).powi(2)).sum::<f64>();
        let both =
            slopes.iter().zip(&lengths).map(|(s, l)| (s - slope) * (l - length)).sum::<f64>();
        let spread = Real::sqrt(variance / n);
        (spread > LEAST_SPREAD * speed * size).then(|| -both / variance)
    }

    /// The depth at which planes of the part coincide with planes of the rest, two or more, with
    /// these pairs. A part inside of the rest is likelier than one outside, two pairs along one axis
    /// are likelier than along two, and more pairs than fewer.
    fn coincidence(&self, depth: usize, tolerance: f64) -> Option<(f64, Vec<PlanePair>)> {
        let mut pairs = self.pairs(depth);
        pairs.sort_by(|a, b| a.depth().total_cmp(&b.depth()));
        let mut best: Option<((bool, bool, usize), f64, f64, Vec<PlanePair>)> = None;
        for first in 0..pairs.len() {
            let chosen = together(&pairs[first..], tolerance);
            let sum = |f: &dyn Fn(&PlanePair) -> f64| chosen.iter().map(f).sum::<f64>();
            let t = -sum(&|p| p.motion * p.gap) / sum(&|p| p.motion * p.motion);
            let apart = |p: &PlanePair| (p.gap + t * p.motion).abs() > tolerance;
            if chosen.len() < 2 || chosen.iter().any(apart) {
                continue;
            }
            let along = |axis| chosen.iter().filter(|p| p.axis == axis).count();
            let through = CoordinateAxis::ALL.into_iter().any(|axis| along(axis) >= 2);
            let rank = (self.is_inside(depth, t, tolerance), through, chosen.len());
            let miss = sum(&|p| (p.gap + t * p.motion).powi(2));
            let better = best
                .as_ref()
                .is_none_or(|(other, least, ..)| rank > *other || rank == *other && miss < *least);
            if better {
                best = Some((rank, miss, t, chosen));
            }
        }
        best.map(|(_, _, t, chosen)| (t, chosen))
    }

    /// True if the part is within the bounds of what does not move with it.
    fn is_inside(&self, depth: usize, t: f64, tolerance: f64) -> bool {
        CoordinateAxis::ALL.into_iter().all(|axis| {
            let k = axis.index();
            let moved = self.coordinates[k].iter().zip(&self.motions[depth][k]);
            let (part, rest): (Vec<_>, Vec<_>) = moved.partition(|(_, m)| m.abs() > STILL);
            let low = rest.iter().map(|(x, _)| **x).fold(f64::INFINITY, f64::min) - tolerance;
            let high = rest.iter().map(|(x, _)| **x).fold(f64::NEG_INFINITY, f64::max) + tolerance;
            part.iter().map(|(x, m)| *x + t * *m).all(|x| low <= x && x <= high)
        })
    }

    /// Planes that the depth moves, each with every plane of its axis that no open depth from this
    /// one on moves.
    fn pairs(&self, depth: usize) -> Vec<PlanePair> {
        let mut pairs = Vec::new();
        for axis in CoordinateAxis::ALL {
            let k = axis.index();
            let moved = |d: usize, plane: usize| self.motions[d][k][plane].abs() > STILL;
            for own in (0..self.coordinates[k].len()).filter(|&p| moved(depth, p)) {
                for other in 0..self.coordinates[k].len() {
                    if (depth..self.motions.len()).any(|d| moved(d, other)) {
                        continue;
                    }
                    let gap = self.coordinates[k][own] - self.coordinates[k][other];
                    let motion = self.motions[depth][k][own];
                    pairs.push(PlanePair { axis, planes: [own, other], motion, gap });
                }
            }
        }
        pairs
    }

    fn alignment(&self, pair: &PlanePair) -> Option<Align> {
        let [q, p] =
            pair.planes.map(|plane| self.planes.members(pair.axis, plane).first().copied());
        Some(Align { axis: pair.axis, p: p?, q: q? })
    }
}
