//! Solve sets: parameters determined by conditions.
//!
//! `param float x = 2 in [0, 5]; ... SolveSet s({x}, {hull.volume - 100});`
//! The unknowns are parameters, and a condition is any number of the program that depends on them;
//! all dependents use the solution, so there is no cycle. The document runs the program with the
//! unknowns at their written values, evaluates the conditions, and takes damped Newton steps with
//! the Jacobian of a run with dual numbers until the conditions vanish. A run with derivatives
//! seeds the unknowns with dx/dp = -(G_x)^-1 G_p (implicit function theorem), so that everything
//! downstream differentiates exactly.
//! The solution depends only on the text and the given values of parameters: each run starts from
//! these. There are as many conditions as unknowns: derivatives of a least-squares solution would
//! need second derivatives. Several sets are solved in order; a condition may depend on the
//! unknowns of its own set and of earlier ones.

use crate::document::Document;
use indexmap::IndexMap;
use moldloft_diag::{Diagnostic, Span};
use moldloft_lang::SolveStatus;
use moldloft_num::{Dual4, solve_pivoting_fully};
use std::collections::HashSet;

/// The report on a solve set.
#[derive(Clone, Debug, PartialEq)]
pub struct SolveReport {
    /// The name of the set.
    pub name: String,
    /// The unknowns.
    pub unknowns: Vec<String>,
    /// Initial values.
    pub starts: Vec<f64>,
    /// Final values.
    pub values: Vec<f64>,
    /// The conditions at the final values.
    pub residuals: Vec<f64>,
    /// Number of Newton steps.
    pub iterations: usize,
    /// Status of the solution.
    pub status: SolveStatus,
    /// Jacobian of the conditions at the final values, by rows.
    pub(crate) jacobian: Vec<Vec<f64>>,
    /// The declaration.
    span: Span,
}

/// Step, relative to the unknowns, that ends the iteration: the error after it is its square.
const SMALL_STEP: f64 = 1e-10;

/// Sufficient step where rounding prevents further progress.
const ROUNDED_STEP: f64 = 1e-7;

/// Maximum number of halvings of a step.
const HALVINGS: usize = 24;

impl Document {
    /// The reports on the solve sets of the last run, in order.
    pub fn solved(&self) -> &[SolveReport] {
        &self.solved
    }

    /// Solves all sets of the last run, and runs the model with the solution.
    pub(crate) fn solve(&mut self) {
        let count = self.plain.env.solves.len();
        let unknowns = self.plain.env.solves.iter().flat_map(|s| &s.unknowns);
        self.solved_objects = unknowns.filter_map(|u| u.object.clone()).collect();
        let mut values: IndexMap<String, f64> = IndexMap::new();
        let mut reports: Vec<SolveReport> = Vec::new();
        for at in 0..count {
            // A failed set leaves its unknowns unchanged.
            let report = self.solve_one(at, &mut values);
            reports.push(report);
        }
        self.trial(&values, true);
        let mut found: Vec<Diagnostic> =
            reports.iter().filter_map(SolveReport::diagnostic).collect();
        found.extend(self.out_of_order(&reports, &values));
        for report in &mut reports {
            if let Some(solve) = self.plain.env.solves.iter().find(|s| *s.name == *report.name) {
                report.values = solve.unknowns.iter().map(|u| u.value).collect();
                report.residuals = solve.conditions.clone();
            }
        }
        self.run_diagnostics.extend(found);
        self.plain.env.solved =
            reports.iter().map(|r| (r.name.clone(), (r.iterations, r.status))).collect();
        self.solved = reports;
    }

    /// Runs the model with these values of unknowns.
    fn trial(&mut self, values: &IndexMap<String, f64>, report: bool) {
        let mut evaluation = std::mem::take(&mut self.plain);
        let seed = |name: &str, x: f64| values.get(name).copied().unwrap_or(x);
        self.applied = self.evaluate(&mut evaluation, &seed, &HashSet::new(), report);
        self.plain = evaluation;
    }

    /// The conditions of set `at` in the last run; `None` if the run did not evaluate them.
    fn conditions(&self, at: usize, unknowns: usize) -> Option<Vec<f64>> {
        let solve = self.plain.env.solves.get(at)?;
        let finite = solve.conditions.iter().all(|c| c.is_finite());
        (finite && solve.conditions.len() == unknowns).then(|| solve.conditions.clone())
    }

    /// The derivatives of the conditions of set `at` with respect to parameters, by rows.
    fn conditions_by(
        &mut self,
        at: usize,
        names: &[String],
        values: &IndexMap<String, f64>,
    ) -> Option<Vec<Vec<f64>>> {
        let mut rows: Vec<Vec<f64>> = Vec::new();
        let mut evaluation = self.dual.take().unwrap_or_default();
        let mut complete = true;
        for pass in names.chunks(4) {
            let seed = |name: &str, mut x: Dual4| {
                if let Some(value) = values.get(name) {
                    x = Dual4::from(*value);
                }
                match pass.iter().position(|p| p == name) {
                    Some(k) => Dual4::seeded(x.re, k),
                    None => x,
                }
            };
            self.evaluate(&mut evaluation, &seed, &HashSet::new(), false);
            let Some(solve) = evaluation.env.solves.get(at) else {
                complete = false;
                break;
            };
            rows.resize(solve.conditions.len(), Vec::new());
            for (row, c) in rows.iter_mut().zip(&solve.conditions) {
                row.extend(&c.eps[..pass.len()]);
            }
        }
        self.dual = Some(evaluation);
        let finite = rows.iter().flatten().all(|x| x.is_finite());
        (complete && finite).then_some(rows)
    }

    fn solve_one(&mut self, at: usize, values: &mut IndexMap<String, f64>) -> SolveReport {
        let solve = &self.plain.env.solves[at];
        let unknowns = solve.unknowns.clone();
        let names: Vec<String> = unknowns.iter().map(|u| u.name.clone()).collect();
        let starts: Vec<f64> = unknowns.iter().map(|u| u.value).collect();
        let steps = solve.steps;
        let mut report = SolveReport {
            name: solve.name.to_string(),
            unknowns: names.clone(),
            starts: starts.clone(),
            values: starts.clone(),
            residuals: solve.conditions.clone(),
            iterations: 0,
            status: SolveStatus::TooManySteps,
            jacobian: Vec::new(),
            span: solve.span,
        };
        let n = names.len();
        let mut x = starts.clone();
        let mut weights: Option<Vec<f64>> = None;
        let with = |x: &[f64], values: &IndexMap<String, f64>| {
            let mut all = values.clone();
            all.extend(names.iter().cloned().zip(x.iter().copied()));
            all
        };
        self.trial(&with(&x, values), false);
        let Some(mut r) = self.conditions(at, n) else {
            report.status = SolveStatus::NoModel;
            return report;
        };
        let size = |x: &[f64], j: usize| match x[j].abs().max(starts[j].abs()) {
            0.0 => 1.0,
            size => size,
        };
        let mut small = false;
        loop {
            let Some(jacobian) = self.conditions_by(at, &names, &with(&x, values)) else {
                report.status = SolveStatus::NoModel;
                break;
            };
            report.jacobian = jacobian;
            if small || r.iter().all(|r| *r == 0.0) {
                report.status = SolveStatus::Solved;
                break;
            }
            if report.iterations == steps {
                break;
            }
            let scaled: Vec<Vec<f64>> = report
                .jacobian
                .iter()
                .map(|row| row.iter().enumerate().map(|(j, d)| d * size(&x, j)).collect())
                .collect();
            // Conditions may have different units: each is scaled by the effect of the unknowns.
            let weights = weights.get_or_insert_with(|| {
                let largest = |row: &Vec<f64>| row.iter().fold(0.0f64, |m, d| m.max(d.abs()));
                scaled.iter().map(|row| 1.0 / largest(row).max(f64::MIN_POSITIVE.sqrt())).collect()
            });
            let Some(step) = solve_pivoting_fully(&scaled, &r) else {
                report.status = SolveStatus::Singular;
                break;
            };
            let step: Vec<f64> = (0..n).map(|j| -step[j] * size(&x, j)).collect();
            let merit = |r: &[f64]| {
                r.iter().zip(weights.iter()).map(|(r, w)| (r * w) * (r * w)).sum::<f64>()
            };
            let relative = |from: &[f64], to: &[f64]| {
                (0..n).fold(0.0f64, |m, j| m.max((to[j] - from[j]).abs() / size(from, j)))
            };
            let now = merit(&r);
            let mut share = 1.0;
            let mut accepted = None;
            let mut bounded = false;
            for _ in 0..HALVINGS {
                let next: Vec<f64> = (0..n)
                    .map(|j| match unknowns[j].range {
                        Some((low, high)) => (x[j] + share * step[j]).clamp(low, high),
                        None => x[j] + share * step[j],
                    })
                    .collect();
                bounded = (0..n).any(|j| next[j] != x[j] + share * step[j]);
                if next == x {
                    break;
                }
                self.trial(&with(&next, values), false);
                if let Some(found) = self.conditions(at, n)
                    && merit(&found) < now * (1.0 - 1e-4 * share)
                {
                    accepted = Some((next, found));
                    break;
                }
                share *= 0.5;
            }
            let whole: Vec<f64> = (0..n).map(|j| x[j] + step[j]).collect();
            match accepted {
                Some((next, found)) => {
                    report.iterations += 1;
                    small = share == 1.0 && !bounded && relative(&x, &next) <= SMALL_STEP;
                    (x, r) = (next, found);
                }
                None if relative(&x, &whole) <= ROUNDED_STEP => small = true,
                None => {
                    report.status =
                        if bounded { SolveStatus::OutOfRange } else { SolveStatus::Stuck };
                    break;
                }
            }
        }
        report.values = x.clone();
        report.residuals = r;
        if report.status == SolveStatus::Solved {
            *values = with(&x, values);
        }
        report
    }

    /// Conditions that depend on unknowns of later sets.
    fn out_of_order(
        &mut self,
        reports: &[SolveReport],
        values: &IndexMap<String, f64>,
    ) -> Vec<Diagnostic> {
        let mut found = Vec::new();
        for (at, report) in reports.iter().enumerate() {
            let later: Vec<String> =
                reports[at + 1..].iter().flat_map(|r| r.unknowns.clone()).collect();
            let rows = if later.is_empty() { None } else { self.conditions_by(at, &later, values) };
            let touched = later.iter().enumerate().find(|(j, _)| {
                rows.as_ref().is_some_and(|rows| rows.iter().any(|row| row[*j] != 0.0))
            });
            if let Some((_, name)) = touched {
                found.push(
                    Diagnostic::error(
                        "unsolved",
                        format!("`{}` depends on `{name}`, which is solved later", report.name),
                    )
                    .at(report.span)
                    .expected("conditions on its own unknowns and those of earlier sets")
                    .help("put both into one solve set, or change their order")
                    .object(&*report.name),
                );
            }
        }
        found
    }

    /// The derivatives of all unknowns in the directions that `seed` gives for parameters and
    /// literals.
    pub(crate) fn seeded_unknowns(
        &mut self,
        evaluation: &mut moldloft_lang::source::env::Evaluation<Dual4>,
        seed: &(dyn Fn(&str, Dual4) -> Dual4 + Sync),
        seeded_objects: &HashSet<String>,
    ) -> IndexMap<String, Dual4> {
        let reports = self.solved.clone();
        let solution = || reports.iter().flat_map(|r| r.unknowns.iter().zip(&r.values));
        let mut known: IndexMap<String, Dual4> =
            solution().map(|(name, x)| (name.clone(), Dual4::from(*x))).collect();
        for (at, report) in reports.iter().enumerate() {
            if report.status != SolveStatus::Solved {
                continue;
            }
            let with =
                |name: &str, x: Dual4| known.get(name).copied().unwrap_or_else(|| seed(name, x));
            self.evaluate(evaluation, &with, seeded_objects, false);
            let Some(solve) = evaluation.env.solves.get(at) else { continue };
            for k in 0..4 {
                let by: Vec<f64> = solve.conditions.iter().map(|c| c.eps[k]).collect();
                if by.iter().all(|d| *d == 0.0) {
                    continue;
                }
                let Some(change) = solve_pivoting_fully(&report.jacobian, &by) else { continue };
                for (name, change) in report.unknowns.iter().zip(change) {
                    if let Some(x) = known.get_mut(name) {
                        x.eps[k] = -change;
                    }
                }
            }
        }
        known
    }
}

impl SolveReport {
    fn diagnostic(&self) -> Option<Diagnostic> {
        let list = |xs: &[f64]| xs.iter().map(f64::to_string).collect::<Vec<_>>().join(", ");
        let names = self.unknowns.join(", ");
        let (message, help) = match self.status {
            SolveStatus::Solved => return None,
            SolveStatus::Singular => (
                "its conditions do not determine the unknowns".to_string(),
                match self.without_effect() {
                    Some(name) => format!("no condition depends on `{name}`"),
                    None => "two conditions may be equivalent, or insensitive at the start: \
                             begin elsewhere"
                        .to_string(),
                },
            ),
            SolveStatus::OutOfRange => (
                "no solution within the ranges".to_string(),
                "widen a range, or choose another start".to_string(),
            ),
            SolveStatus::Stuck => (
                "the search makes no progress towards a solution".to_string(),
                "there may be no solution; otherwise start nearer to it".to_string(),
            ),
            SolveStatus::TooManySteps => (
                format!("no solution was found in {} steps", self.iterations),
                "start nearer to it, or allow more `steps`".to_string(),
            ),
            SolveStatus::NoModel => (
                "its conditions have no values at the start".to_string(),
                "start with values for which the model can be built".to_string(),
            ),
        };
        Some(
            Diagnostic::error("unsolved", format!("`{}` is not solved: {message}", self.name))
                .at(self.span)
                .expected("conditions that become zero")
                .found(format!(
                    "the conditions {} at {names} = {} after {} steps from {}",
                    list(&self.residuals),
                    list(&self.values),
                    self.iterations,
                    list(&self.starts),
                ))
                .help(help)
                .object(&*self.name),
        )
    }

    /// An unknown without effect on any condition.
    fn without_effect(&self) -> Option<&str> {
        let still = |j: &usize| self.jacobian.iter().all(|row| row[*j] == 0.0);
        (0..self.unknowns.len()).find(still).map(|j| self.unknowns[j].as_str())
    }
}
