//! Members of faired objects.

use crate::{Certificate, DataFit, GridFit, NetworkFit, Optimum};

/// Figures of a faired object, the values of its members.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct FairFigures {
    /// Largest distance of a point from the result at the point's parameter.
    pub deviation: f64,
    /// Measure of the result, and its optimality gap.
    pub value: f64,
    pub gap: f64,
    /// Number of tolerances reached.
    pub active: usize,
    /// Mean squared residual over tolerance, relative to 1/3; and the same for the fairest result.
    pub used: f64,
    pub fairest_used: f64,
    /// Number of points that do not fit their neighbours.
    pub findings: usize,
    /// Number of single steps, sweeps or cycles.
    pub steps: Option<usize>,
}

impl FairFigures {
    /// Figures of a curve near data with tolerances `radii`.
    pub fn of_curve(made: &DataFit, radii: &[f64], findings: usize) -> Self {
        let own = Self::of_residuals(&made.residuals, radii, findings);
        Self { active: made.active, ..own }.of_goal(&made.certificate, made.used, made.fairest_used)
    }

    /// Figures of a surface near data.
    pub fn of_surface(made: &GridFit, radii: &[f64], findings: usize) -> Self {
        let own = Self::of_residuals(&made.residuals, radii, findings);
        Self { active: made.active, ..own }.of_goal(&made.certificate, made.used, made.fairest_used)
    }

    /// Figures of a curve in a network: its own residuals, the measure of the whole network.
    pub fn of_network(
        made: &NetworkFit,
        residuals: &[f64],
        radii: &[f64],
        findings: usize,
    ) -> Self {
        let own = Self::of_residuals(residuals, radii, findings);
        own.of_goal(&made.certificate, made.used, made.fairest_used)
    }

    /// Figures of a moved control net, from the moves and the optimum, if one was solved for.
    pub fn of_net(moved: impl Iterator<Item = f64>, best: Option<&Optimum>) -> Self {
        Self::of_moves(moved, best.map(|b| (&b.certificate, Some(b.active), None)))
    }

    /// Figures of moved control points or points, from the moves and, if solved, the certificate,
    /// the number of active tolerances of an optimum and the number of steps.
    pub fn of_moves(
        moved: impl Iterator<Item = f64>,
        made: Option<(&Certificate, Option<usize>, Option<usize>)>,
    ) -> Self {
        let deviation = moved.fold(0.0, f64::max);
        let unknown = Self { deviation, value: f64::NAN, gap: f64::NAN, ..Self::default() };
        made.map_or(unknown, |(certificate, active, steps)| Self {
            value: certificate.value,
            gap: certificate.gap,
            active: active.unwrap_or(0),
            steps,
            ..unknown
        })
    }

    /// Members of moved control points and points; unavailable ones are left out.
    pub fn members_of_moves(&self) -> Vec<(&'static str, f64)> {
        let all = self.members().into_iter();
        let known = ["deviation", "value", "gap", "active"];
        let optimum = !self.value.is_nan() && self.steps.is_none();
        all.filter(|(name, x)| known.contains(name) && !x.is_nan())
            .filter(|(name, _)| *name != "active" || optimum)
            .chain(self.steps.map(|steps| ("steps", steps as f64)))
            .collect()
    }

    fn of_goal(self, certificate: &Certificate, used: f64, fairest_used: f64) -> Self {
        Self { value: certificate.value, gap: certificate.gap, used, fairest_used, ..self }
    }

    fn of_residuals(residuals: &[f64], radii: &[f64], findings: usize) -> Self {
        // A released point has a very large radius, which it does not reach.
        let least = radii.iter().copied().filter(|r| *r > 0.0).fold(f64::INFINITY, f64::min);
        let limited = residuals.iter().zip(radii).filter(|(_, a)| **a > 0.0 && **a < 1e3 * least);
        let reached = limited.filter(|(r, a)| **r > **a * (1.0 - 1e-4)).count();
        Self {
            deviation: residuals.iter().copied().fold(0.0, f64::max),
            active: reached,
            findings,
            ..Self::default()
        }
    }

    pub fn members(&self) -> [(&'static str, f64); 7] {
        [
            ("deviation", self.deviation),
            ("value", self.value),
            ("gap", self.gap),
            ("active", self.active as f64),
            ("used", self.used),
            ("fairest_used", self.fairest_used),
            ("findings", self.findings as f64),
        ]
    }
}
