//! Networks faired curve after curve, or point after point.

use crate::optimum::certificate::gap;
use crate::{
    Certificate, FairError, Job, KnotRemovalOptions, Measure, Network, knot_removal_from,
    replay_from_with,
};
use moldloft_num::{Real, Vec3};

impl Network {
    fn check_seams(&self) -> Result<(), FairError> {
        if self.seams.is_empty() && self.held.is_empty() {
            Ok(())
        } else {
            Err(FairError::SeamsByPasses)
        }
    }

    /// Curve `k` at the original points, where what stays fixed for any curve does so for this one.
    fn pass_job(&self, k: usize, frozen: &[bool]) -> Job {
        let mut job = self.job(k, &self.points);
        for (radius, &i) in job.limit.radii.iter_mut().zip(&self.strands[k].points) {
            if frozen[i] {
                *radius = 0.0;
            }
        }
        job
    }

    /// Fairs curve after curve by local steps, `passes` times: the faithful algorithm. The limit is
    /// measured from the original across passes. The direction faired first becomes rougher again,
    /// so passes do not converge to the joint optimum.
    ///
    /// `steps` is the number of steps per control point of each curve.
    ///
    /// # Errors
    /// As [`crate::knot_removal`].
    pub fn passes(&self, passes: usize, steps: usize) -> Result<Vec<Vec3<f64>>, FairError> {
        self.check()?;
        self.check_seams()?;
        let frozen = self.frozen();
        let mut points = self.points.clone();
        for _ in 0..passes {
            for k in 0..self.strands.len() {
                let job = self.pass_job(k, &frozen);
                let from = self.strands[k].points.iter().map(|&i| points[i]).collect();
                let options = KnotRemovalOptions::faithful(steps * job.points.len());
                let faired = knot_removal_from(&job, from, &options)?.points;
                for (&i, p) in self.strands[k].points.iter().zip(faired) {
                    points[i] = p;
                }
            }
        }
        Ok(points)
    }

    /// As `passes`, for points that carry derivatives, whose real parts are those of the network:
    /// knots are chosen by the real parts.
    ///
    /// # Errors
    /// As [`Network::passes`].
    pub fn passes_with<T: Real>(
        &self,
        passes: usize,
        steps: usize,
        points: &[Vec3<T>],
        tolerances: &[T],
    ) -> Result<Vec<Vec3<T>>, FairError> {
        self.check()?;
        self.check_seams()?;
        let frozen = self.frozen();
        let mut now = points.to_vec();
        for _ in 0..passes {
            for (k, strand) in self.strands.iter().enumerate() {
                let job = self.pass_job(k, &frozen);
                let pick = |of: &[Vec3<T>]| -> Vec<Vec3<T>> {
                    strand.points.iter().map(|&i| of[i]).collect()
                };
                let (from, original) = (pick(&now), pick(points));
                let radii: Vec<T> = strand.points.iter().map(|&i| tolerances[i]).collect();
                let plain = from.iter().map(|p| p.re()).collect();
                let mut options = KnotRemovalOptions::faithful(steps * job.points.len());
                options.log = true;
                let made = knot_removal_from(&job, plain, &options)?;
                let faired = replay_from_with(&job, &options, &made.log, &from, &original, &radii)?;
                for (&i, p) in strand.points.iter().zip(faired) {
                    now[i] = p;
                }
            }
        }
        Ok(now)
    }

    /// Joint sweeps over single points, each moved to its constrained minimiser: for nets too large
    /// for the direct solver. No sweep increases the measure; reports the distance from the
    /// optimum.
    ///
    /// # Errors
    /// As [`crate::sweeps`].
    pub fn sweeps(
        &self,
        measure: Measure,
        count: usize,
    ) -> Result<(Vec<Vec3<f64>>, Certificate), FairError> {
        self.check()?;
        self.check_seams()?;
        let n = self.points.len();
        let rows = self.rows(measure)?;
        let gram = rows.gram(n);
        let frozen = self.frozen();
        let origin = self.origin();
        let mut relative = self.relative(&self.points);
        let mut points = self.points.clone();
        for _ in 0..count {
            for j in (0..n).filter(|&j| !frozen[j]) {
                let (columns, factors) = gram.row(j);
                let Some(at) = columns.iter().position(|&c| c as usize == j) else { continue };
                if factors[at] > 0.0 {
                    let wanted = points[j] - gram.apply(j, &relative) * (1.0 / factors[at]);
                    points[j] = self.limit.nearest(j, self.points[j], points[j], wanted);
                    relative[j] = points[j] - origin;
                }
            }
        }
        let norm = measure.norm();
        let certificate = gap(&self.points, &self.limit, &frozen, &rows, norm, &points, &relative);
        Ok((points, certificate))
    }
}
