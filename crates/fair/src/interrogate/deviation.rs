//! Deviation of a faired curve from its original.

use crate::{Job, shape};
use moldloft_num::Vec3;

/// Distances between a faired curve and its original at equal parameters, which bound the Hausdorff
/// distance of the two curves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// The largest move of a control point.
    pub control: f64,
    /// Certified bound on the distance of the curve from its original: the largest Bézier point of
    /// the displacement, since the displacement is a convex combination of these.
    pub certified: f64,
    /// The largest distance found by sampling.
    pub sampled: f64,
    /// The length of the original curve.
    pub length: f64,
}

impl Deviation {
    /// The certified distance in percent of the arc length.
    pub fn percent(&self) -> f64 {
        if self.length > 0.0 { 100.0 * self.certified / self.length } else { 0.0 }
    }
}

/// Samples on each span.
const SAMPLES: usize = 10;

/// The deviation of the curve of `points` from the original of the job.
pub fn deviation(job: &Job, points: &[Vec3<f64>]) -> Deviation {
    let weights = job.weights.as_deref();
    let moved: Vec<_> = points.iter().zip(&job.points).map(|(p, q)| *p - *q).collect();
    let space = &job.space;
    // The distance of displacement curves; the same rational basis carries both curves.
    let samples = shape::samples(space, &moved, weights, SAMPLES);
    let far = |m: f64, v: Vec3<f64>| m.max(v.norm());
    Deviation {
        control: moved.iter().copied().fold(0.0, far),
        certified: certified(job, &moved),
        sampled: samples.iter().map(|s| s.point).fold(0.0, far),
        length: shape::arc_length(space, &job.points, weights),
    }
}

/// The certified bound alone, rounded up, in O(n) and without further memory.
pub fn certified(job: &Job, moved: &[Vec3<f64>]) -> f64 {
    let mut largest = 0.0f64;
    job.space.each_bezier(job.weights.as_deref(), |entries| {
        let sum = entries.iter().fold(Vec3::zero(), |s, &(c, x)| s + moved[c] * x);
        largest = largest.max(sum.norm_sq());
    });
    largest.sqrt() * (1.0 + 16.0 * f64::EPSILON)
}
