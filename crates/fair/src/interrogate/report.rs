//! Data of one fairing, as printed by the command line.

use crate::{
    Certificate, Data, DataFit, DataOptions, Deviation, FairError, Finding, Job, KnotJumps,
    KnotRemoval, KnotRemovalOptions, Limit, Measure, Optimum, OptimumOptions, RowNorm, Stopped,
    ball_gap, deviation, fair_data, knot_removal, multilevel, optimum, shape, sweeps,
};
use moldloft_num::Vec3;
use std::fmt;

/// Algorithm of a fairing.
#[derive(Clone, Debug, PartialEq)]
pub enum Mode {
    /// The optimum within the tolerance.
    Optimum(OptimumOptions),
    /// KnotRemoval steps.
    KnotRemoval(KnotRemovalOptions),
    /// Number of sweeps over all points; see [`sweeps`].
    Sweeps(Measure, usize),
    /// Number of multilevel cycles; see [`multilevel`](crate::multilevel).
    Multilevel(Measure, usize),
}

/// Counts and sums over a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurveStatistics {
    /// The selected measure.
    pub measure: f64,
    /// Sum of squared jumps.
    pub jumps: f64,
    /// The largest jump.
    pub largest_jump: f64,
    /// Monotone pieces of the curvature, reversals below a thousandth of its range ignored.
    pub pieces: usize,
    /// Sign changes of the curvature.
    pub inflections: usize,
    /// The largest curvature.
    pub largest_curvature: f64,
}

/// Result of a fairing with its figures. The caller measures the time.
#[derive(Clone, Debug, PartialEq)]
pub struct FairingReport {
    /// The faired control points.
    pub points: Vec<Vec3<f64>>,
    /// The measure's name.
    pub measure: &'static str,
    /// The original curve.
    pub before: CurveStatistics,
    /// The faired curve.
    pub after: CurveStatistics,
    /// Distance from the original.
    pub deviation: Deviation,
    /// The measure and the optimality gap.
    pub certificate: Certificate,
    /// Newton steps, or local steps.
    pub steps: usize,
    /// Why local steps ended; `None` for the optimum.
    pub stopped: Option<Stopped>,
    /// Limits that are reached; for the optimum.
    pub active: Option<usize>,
    /// Corners and wrong points that the original's jumps reveal and that are not marked.
    pub findings: Vec<Finding>,
    /// The jump at each knot, before and after, for jump plots.
    pub jumps: [Vec<f64>; 2],
    /// Things the user should know, besides the findings.
    pub notes: Vec<String>,
}

/// Samples on each span for curvature counts.
const SAMPLES: usize = 16;

/// The statistics of a curve.
///
/// # Errors
/// [`FairError::Degree`].
pub fn numbers(
    job: &Job,
    measure: Measure,
    points: &[Vec3<f64>],
) -> Result<CurveStatistics, FairError> {
    let samples = shape::samples(&job.space, points, job.weights.as_deref(), SAMPLES);
    let curvatures = shape::curvatures(&samples);
    let rows = job.own_rows(&KnotJumps::of(&job.space).rows);
    let relative = job.relative(points);
    let jumps = (0..rows.len()).map(|k| rows.apply(k, &relative).norm());
    Ok(CurveStatistics {
        measure: job.value(measure, points)?,
        jumps: rows.sum_sq(&relative),
        largest_jump: jumps.fold(0.0, f64::max),
        pieces: shape::monotone_pieces(&samples, 1e-3),
        inflections: shape::inflections(&samples),
        largest_curvature: curvatures.iter().fold(0.0, |m: f64, k| m.max(k.abs())),
    })
}

/// Fairs a curve and reports.
///
/// # Errors
/// [`FairError`] as for [`optimum`] and [`knot_removal`](crate::knot_removal).
///
/// # Example
/// ```
/// use moldloft_fair::{Job, Measure, Mode, OptimumOptions, report};
/// use moldloft_num::Vec3;
/// let wavy = |i: i32| Vec3::of(f64::from(i), if i % 3 == 0 { 0.01 } else { 0.0 }, 0.0);
/// let job = Job::of_points(3, (0..20).map(wavy).collect(), false, 0.02).unwrap();
/// let report = report(&job, &Mode::Optimum(OptimumOptions::of(Measure::Second))).unwrap();
/// assert!(report.deviation.certified <= 0.02 && report.after.jumps < 1e-3 * report.before.jumps);
/// assert!(report.to_string().contains("certified"));
/// ```
pub fn report(job: &Job, mode: &Mode) -> Result<FairingReport, FairError> {
    let (points, measure, certificate, steps, stopped, active) = match mode {
        Mode::Optimum(options) => {
            let Optimum { points, certificate, iterations, active } = optimum(job, options)?;
            (points, options.measure, certificate, iterations, None, Some(active))
        }
        Mode::KnotRemoval(options) => {
            let KnotRemoval { points, steps, stopped, .. } = knot_removal(job, options)?;
            let rows = job.measure_rows(options.measure)?;
            let gap = ball_gap(job, &rows, RowNorm::Square, &points);
            (points, options.measure, gap, steps, Some(stopped), None)
        }
        Mode::Sweeps(measure, count) | Mode::Multilevel(measure, count) => {
            if measure.norm() != RowNorm::Square {
                return Err(FairError::Squares);
            }
            let points = match mode {
                Mode::Sweeps(..) => sweeps(job, *measure, *count)?,
                _ => multilevel(job, *measure, *count, u32::BITS)?,
            };
            let gap = ball_gap(job, &job.measure_rows(*measure)?, RowNorm::Square, &points);
            (points, *measure, gap, *count, Some(Stopped::Steps), None)
        }
    };
    let (before, after) = (numbers(job, measure, &job.points)?, numbers(job, measure, &points)?);
    let rows = job.own_rows(&KnotJumps::of(&job.space).rows);
    let jumps = [&job.points, &points].map(|p| {
        let relative = job.relative(p);
        (0..rows.len()).map(|k| rows.apply(k, &relative).norm()).collect()
    });
    let mut report = FairingReport {
        deviation: deviation(job, &points),
        points,
        measure: measure.name(),
        before,
        after,
        certificate,
        steps,
        stopped,
        active,
        findings: unmarked(job),
        jumps,
        notes: Vec::new(),
    };
    report.notes = notes(job, &report);
    Ok(report)
}

/// Fairs data and reports. Jumps, counts and the deviation compare the faired curve with the one
/// through the data; findings are left to the caller ([`crate::data_findings`]).
///
/// # Errors
/// As [`fair_data`].
pub fn data_report(
    data: &Data,
    options: &DataOptions,
) -> Result<(DataFit, FairingReport), FairError> {
    let made = fair_data(data, options)?;
    let reported = report_of(data, options.measure, &made)?;
    Ok((made, reported))
}

/// The report of a faired curve near data.
pub(crate) fn report_of(
    data: &Data,
    measure: Measure,
    made: &DataFit,
) -> Result<FairingReport, FairError> {
    let n = made.points.len();
    let job = Job {
        space: data.layout.space.clone(),
        points: made.original.clone(),
        weights: None,
        limit: Limit { motion: data.limit.motion, radii: vec![f64::INFINITY; n] },
        marks: Vec::new(),
        ends: data.ends,
    };
    let numbers = |points: &[Vec3<f64>]| numbers(&job, measure, points);
    let (before, after) = (numbers(&job.points)?, numbers(&made.points)?);
    let rows = KnotJumps::of(&job.space).rows;
    let jumps = [&job.points, &made.points]
        .map(|p| (0..rows.len()).map(|k| rows.apply(k, p).norm()).collect());
    let mut notes = Vec::new();
    if data.limit.radii.iter().any(|r| r.is_infinite()) {
        notes.push(
            "no tolerance: the fairest curve is a single polynomial, far from the data".to_string(),
        );
    }
    let first = data.points.first().copied().unwrap_or_default();
    let size = data.points.iter().map(|p| (*p - first).norm()).fold(0.0, f64::max);
    // The one in the middle: released points have another.
    let mut given: Vec<f64> =
        data.limit.radii.iter().copied().filter(|r| r.is_finite() && *r > 0.0).collect();
    given.sort_by(f64::total_cmp);
    let tolerance = given.get(given.len() / 2).copied().unwrap_or(0.0);
    if tolerance > 0.05 * size {
        notes.push(format!(
            "the tolerance, {tolerance:.3e}, is {:.0} % of the extent of the data: check its unit",
            100.0 * tolerance / size
        ));
    }
    let held = data.limit.radii.iter().filter(|r| r.is_finite() && **r > 0.0).count();
    if held > 3 && made.active >= held {
        notes.push(
            "the tolerance is reached at every datum: it is smaller than the noise".to_string(),
        );
    }
    let report = FairingReport {
        deviation: deviation(&job, &made.points),
        points: made.points.clone(),
        measure: measure.name(),
        before,
        after,
        certificate: made.certificate,
        steps: made.iterations,
        stopped: None,
        active: Some(made.active),
        findings: Vec::new(),
        jumps,
        notes,
    };
    Ok(report)
}

/// Findings that are not marked yet.
fn unmarked(job: &Job) -> Vec<Finding> {
    let mut found = crate::findings(job);
    found.retain(|f| !job.marks.contains(&f.index()));
    found
}

fn notes(job: &Job, report: &FairingReport) -> Vec<String> {
    let mut notes = Vec::new();
    if report.stopped == Some(Stopped::Stalled) {
        notes.push(
            "the literal rule stalled: the point of the largest jump is at its limit; rank by \
            achievable move, or use the optimum"
                .to_string(),
        );
    }
    if report.after.inflections > report.before.inflections {
        notes.push(format!(
            "{} inflections appeared",
            report.after.inflections - report.before.inflections
        ));
    }
    if job.limit.radii.iter().any(|r| r.is_infinite()) {
        notes.push(
            "no tolerance: the steps converge to a single polynomial, far from the data"
                .to_string(),
        );
    }
    // Noise in end points that stay fixed shows as a kink beside them.
    let jumps = &report.jumps[1];
    if let (Some(first), Some(last)) = (jumps.first(), jumps.last())
        && !job.space.is_closed()
        && jumps.len() > 4
    {
        let largest = jumps.iter().copied().fold(0.0, f64::max);
        let inner = jumps[1..jumps.len() - 1].iter().copied().fold(0.0, f64::max);
        if largest > 0.0 && largest == first.max(*last) && largest > 2.0 * inner {
            notes.push(
                "the largest remaining jump is beside a clamped end, whose points may be \
                 off; free the end or fit it"
                    .to_string(),
            );
        }
    }
    notes
}

impl fmt::Display for FairingReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (b, a, d) = (&self.before, &self.after, &self.deviation);
        writeln!(f, "                         before         after")?;
        writeln!(f, "{:<18} {:>12.6e}  {:>12.6e}", self.measure, b.measure, a.measure)?;
        writeln!(f, "{:<18} {:>12.6e}  {:>12.6e}", "squared jumps", b.jumps, a.jumps)?;
        let largest = (b.largest_jump, a.largest_jump);
        writeln!(f, "{:<18} {:>12.6e}  {:>12.6e}", "largest jump", largest.0, largest.1)?;
        writeln!(f, "{:<18} {:>12}  {:>12}", "monotone pieces", b.pieces, a.pieces)?;
        writeln!(f, "{:<18} {:>12}  {:>12}", "inflections", b.inflections, a.inflections)?;
        writeln!(
            f,
            "deviation          certified {:.6e} (sampled {:.6e}), {:.4} % of the length",
            d.certified,
            d.sampled,
            d.percent()
        )?;
        write!(f, "certificate        {:.9e}, ", self.certificate.value)?;
        let gap = self.certificate.relative();
        if d.certified == 0.0 && gap >= 1.0 {
            writeln!(f, "no optimum is claimed: the points are unchanged")?;
        } else if gap >= 1.0 {
            writeln!(f, "no optimum is claimed: the proved gap exceeds the measure")?;
        } else {
            writeln!(f, "relative optimality gap <= {gap:.2e} with these knots and parameters")?;
        }
        match (self.stopped, self.active) {
            (Some(why), _) => writeln!(f, "steps              {} ({})", self.steps, why.name())?,
            (None, Some(active)) => {
                writeln!(f, "iterations         {}, {active} limits reached", self.steps)?;
            }
            (None, None) => {}
        }
        self.findings.iter().try_for_each(|finding| writeln!(f, "note: {finding}"))?;
        self.notes.iter().try_for_each(|note| writeln!(f, "note: {note}"))
    }
}
