//! The curves of a network: splines through its points, how far these are apart, and limits that
//! hold all along them.

use crate::net::shapes::control_map;
use crate::optimum::DataLimits;
use crate::{
    Deviation, FairError, InterpolationSpace, Job, Network, ParameterSpacing, Space, SparseRows,
    deviation, interpolate_with_corners,
};
use moldloft_num::Vec3;

/// A curve of a network before and after, on the same knots.
#[derive(Clone, Debug, PartialEq)]
pub struct CurvePair {
    /// The splines.
    pub space: Space,
    /// The control points through the points as they were given.
    pub before: Vec<Vec3<f64>>,
    /// Those through the faired points, at the same parameters.
    pub after: Vec<Vec3<f64>>,
}

impl CurvePair {
    /// The distance between the curves.
    ///
    /// # Errors
    /// As [`Job::new`].
    pub fn deviation(&self) -> Result<Deviation, FairError> {
        let job = Job::new(self.space.clone(), self.before.clone(), 0.0)?;
        Ok(deviation(&job, &self.after))
    }
}

impl Network {
    /// The splines through the points of curve `k`, where it has parameters.
    pub(super) fn layout(&self, k: usize) -> Option<Result<InterpolationSpace, FairError>> {
        let strand = &self.strands[k];
        let (degree, closed) = (strand.space.degree(), strand.space.is_closed());
        strand.at.as_ref().map(|at| {
            if strand.runs.is_empty() {
                return InterpolationSpace::new(degree, at, &strand.marks, closed);
            }
            InterpolationSpace::with_runs(at, &strand.marks, &strand.runs, closed)
        })
    }

    /// Curve `k` through its points as they were given, and through these.
    ///
    /// # Errors
    /// [`FairError`] when there is no such spline.
    pub fn curve_pair(&self, k: usize, points: &[Vec3<f64>]) -> Result<CurvePair, FairError> {
        let strand = &self.strands[k];
        let own = |all: &[Vec3<f64>]| -> Vec<Vec3<f64>> {
            strand.points.iter().map(|&i| all[i]).collect()
        };
        let (before, after) = (own(&self.points), own(points));
        if let Some(layout) = self.layout(k) {
            let layout = layout?;
            let through = |points: &[Vec3<f64>]| layout.through(&layout.data(points));
            let (before, after) = (through(&before)?, through(&after)?);
            return Ok(CurvePair { space: layout.space, before, after });
        }
        let (degree, closed) = (strand.space.degree(), strand.space.is_closed());
        let through = |points: &[Vec3<f64>]| {
            interpolate_with_corners(
                degree,
                points,
                ParameterSpacing::Uniform,
                closed,
                &strand.marks,
            )
        };
        let (before, after) = (through(&before)?, through(&after)?);
        Ok(CurvePair { space: before.fit.space, before: before.points, after: after.points })
    }

    /// Limits on the points and on the Bézier points of the curves' displacements: of each the
    /// smaller tolerance of the two points that move it most, of those that may move.
    pub(super) fn along_curves(&self) -> Result<DataLimits, FairError> {
        let count = self.points.len();
        let mut rows = SparseRows::identity(count);
        let mut radii = self.limit.radii.clone();
        for k in 0..self.strands.len() {
            let Some(layout) = self.layout(k) else { continue };
            let layout = layout?;
            let own = &self.strands[k].points;
            // The displacement is linear in the moves.
            let control = control_map(&layout, own.len())?;
            layout.space.each_bezier(None, |entries| {
                let mut sum = vec![0.0; own.len()];
                for &(c, x) in entries {
                    for &(place, f) in &control[c] {
                        sum[place] += x * f;
                    }
                }
                let mut near: Vec<usize> = (0..own.len()).collect();
                near.sort_by(|&a, &b| sum[b].abs().total_cmp(&sum[a].abs()));
                let radii_of = |places: &[usize]| {
                    let all = places.iter().map(|&place| self.limit.radii[own[place]]);
                    all.filter(|&r| r > 0.0).reduce(f64::min)
                };
                // Beside a point without limit the curve has none.
                let free =
                    near[..2].iter().any(|&place| self.limit.radii[own[place]].is_infinite());
                let radius = radii_of(&near[..2]).or_else(|| radii_of(&near)).filter(|_| !free);
                // A Bézier point of one point has the limit of that.
                let single = sum.iter().filter(|f| f.abs() > 1e-12).count() < 2;
                if let (Some(radius), false) = (radius, single) {
                    rows.push(own.iter().copied().zip(sum).filter(|(_, f)| *f != 0.0));
                    radii.push(radius);
                }
            });
        }
        let reach = self.limit.radii.clone();
        Ok(DataLimits { rows, radii, offsets: Vec::new(), reach })
    }
}
