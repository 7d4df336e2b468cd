//! Bounds on the optimality gap, computed from the result alone.

use crate::{Job, Limit, Motion, RowNorm, SparseRows};
use moldloft_num::Vec3;

/// Distance of a result from the optimum within its limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Certificate {
    /// The measure of the result.
    pub value: f64,
    /// No curve within the limits has a measure below `value - gap`.
    pub gap: f64,
}

impl Certificate {
    /// The gap relative to the value.
    pub fn relative(&self) -> f64 {
        if self.gap <= 0.0 { 0.0 } else { self.gap / self.value }
    }
}

/// The certificate of any control points within the limits of a job without other conditions.
///
/// A convex measure f lies above its tangent: f(y) >= f(d) + g (y - d), and the least of the right
/// side over all y within the limits is found point by point: |d - d0| <= r gives
/// gap = sum of g (d - d0) + r |g|. No solver is trusted. Infinite when a point is not limited and
/// the slope there is not zero.
pub fn ball_gap(job: &Job, rows: &SparseRows, norm: RowNorm, points: &[Vec3<f64>]) -> Certificate {
    let relative = job.relative(points);
    gap(&job.points, &job.limit, &job.frozen(), rows, norm, points, &relative)
}

/// The gap of any problem whose measure is given by rows.
pub(crate) fn gap(
    original: &[Vec3<f64>],
    limit: &Limit,
    frozen: &[bool],
    rows: &SparseRows,
    norm: RowNorm,
    points: &[Vec3<f64>],
    relative: &[Vec3<f64>],
) -> Certificate {
    let n = points.len();
    let mut slope = vec![Vec3::zero(); n];
    let part = |k: usize| {
        let row = rows.apply(k, relative);
        match norm {
            RowNorm::Square => row * 2.0,
            RowNorm::Length => row.normalized().unwrap_or_default(),
        }
    };
    rows.add_transposed(part, &mut slope);
    let gap = crate::sparse_rows::chunked_sum(n, |i| {
        if frozen[i] {
            return 0.0;
        }
        let (g, away, r) = (slope[i], points[i] - original[i], limit.radii[i]);
        let reach = match limit.motion {
            Motion::Ball => g.norm(),
            Motion::Box => g.x.abs() + g.y.abs() + g.z.abs(),
            Motion::Along(d) => g.dot(d).abs(),
            Motion::Across(d) => (g - d * g.dot(d)).norm(),
        };
        if reach == 0.0 { 0.0 } else { g.dot(away) + r * reach }
    });
    Certificate { value: crate::measure::value(rows, norm, relative), gap: gap.max(0.0) }
}
