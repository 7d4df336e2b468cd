//! Reports of the fairing of networks.

use crate::net::arcs::NetworkArc;
use crate::net::curves::CurveSwing;
use crate::optimum::certificate::gap;
use crate::{Bound, Certificate, Condition, FairError, Goal, Measure, Network};
use moldloft_num::Vec3;

/// Report of the fairing of a network.
#[derive(Clone, Debug, PartialEq)]
pub struct NetworkReport {
    /// The faired points.
    pub points: Vec<Vec3<f64>>,
    /// The measure over all curves, before and after.
    pub measure: [f64; 2],
    /// Sum of squared jumps over all curves, before and after.
    pub jumps: [f64; 2],
    /// Certified bound on the move of the surface (or of a control point of a network).
    pub certified: f64,
    /// The largest distance found by sampling.
    pub sampled: f64,
    /// The measure and the optimality gap within the limits.
    pub certificate: Certificate,
    /// For goals, three times the mean of the squared moves over tolerances; otherwise not a
    /// number.
    pub used: f64,
    /// Curves with more inflections than their points require within the tolerances, under the goal
    /// [`Goal::Near`]: conditions or crossing curves force them.
    pub bent: Vec<usize>,
    /// The requested circular arcs.
    pub arcs: Vec<NetworkArc>,
    /// Curves that exceed their bound on the distance from their originals: the tolerance
    /// everywhere, or 1.5 tolerances if the bound is that of the points.
    pub swings: Vec<CurveSwing>,
}

/// Method of fairing a network.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NetworkMode {
    /// All curves at once towards a goal, with a ball round each point.
    Toward(Goal),
    /// All curves at once: the fairest.
    Joint(Bound),
    /// All curves at once, by a number of sweeps over single points.
    Sweeps(usize),
    /// Curve after curve: a number of passes, and of steps per point.
    Passes(usize, usize),
}

impl Network {
    /// Fairs and reports.
    ///
    /// # Errors
    /// As [`Network::optimum`], [`Network::sweeps`] and [`Network::passes`].
    pub fn report(&self, measure: Measure, mode: NetworkMode) -> Result<NetworkReport, FairError> {
        self.report_with(measure, mode, Vec::new())
    }

    /// As `report`, under linear conditions, which only the joint optimum can satisfy.
    ///
    /// # Errors
    /// As [`Network::report`].
    pub fn report_with(
        &self,
        measure: Measure,
        mode: NetworkMode,
        conditions: Vec<Condition>,
    ) -> Result<NetworkReport, FairError> {
        let (mut used, mut bent) = (f64::NAN, Vec::new());
        let (points, certificate) = match mode {
            NetworkMode::Toward(goal) => {
                let (found, own) = self.reached(measure, goal, conditions, 1e-9)?;
                (used, bent) = (found.used, own);
                (found.optimum.points, found.optimum.certificate)
            }
            NetworkMode::Joint(bound) => {
                let best = self.optimum(measure, bound, conditions, 1e-9)?;
                (best.points, best.certificate)
            }
            NetworkMode::Sweeps(count) => self.sweeps(measure, count)?,
            NetworkMode::Passes(passes, steps) => {
                let points = self.passes(passes, steps)?;
                let rows = self.rows(measure)?;
                let relative = self.relative(&points);
                let frozen = vec![false; points.len()];
                let norm = measure.norm();
                let left = gap(&self.points, &self.limit, &frozen, &rows, norm, &points, &relative);
                (points, left)
            }
        };
        let all = 0..self.strands.len();
        let both = |m: Measure| -> Result<[f64; 2], FairError> {
            Ok([self.value(m, all.clone(), &self.points)?, self.value(m, all.clone(), &points)?])
        };
        Ok(NetworkReport {
            measure: both(measure)?,
            jumps: both(Measure::Jumps)?,
            certified: self.certified(&points),
            sampled: self.sampled(&points),
            certificate,
            used,
            bent,
            arcs: self.arcs_at(&points),
            swings: if self.net_parts().is_none() && self.patches.is_empty() {
                self.swings(&points)?
            } else {
                Vec::new()
            },
            points,
        })
    }
}
