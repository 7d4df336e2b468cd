//! Conversion of reports of searches to those of values, and to errors.

use moldloft_locate::{LocateReport, LocateStatus};
use moldloft_registry::{CallError, SearchReport, SearchStatus};

/// The report as the value carries it. `advice` says how to choose another solution.
pub fn found(report: &LocateReport, advice: &'static str) -> SearchReport {
    let status = match report.status {
        LocateStatus::Fallback => SearchStatus::Fallback,
        LocateStatus::EdgeClamped => SearchStatus::EdgeClamped,
        LocateStatus::Tangent => SearchStatus::Tangent,
        LocateStatus::Multiple { count, chosen, next } => {
            SearchStatus::Multiple { count, chosen, next }
        }
        LocateStatus::Ok
        | LocateStatus::NoSolution
        | LocateStatus::Unfinished
        | LocateStatus::Diverged => SearchStatus::Ok,
    };
    SearchReport {
        status,
        residual: report.residual,
        iterations: report.iterations,
        start: report.start.to_vec(),
        last: report.last.to_vec(),
        alternatives: report.alternatives.iter().map(|a| (a.parameters.to_vec(), a.xyz)).collect(),
        advice,
    }
}

/// The fault that two things do not meet, or that a search ended before it knew; the names say which.
pub fn no_intersection(report: &LocateReport, one: &str, other: &str) -> CallError {
    if report.status == LocateStatus::Unfinished {
        return CallError::new(
            "search-unfinished",
            format!(
                "the search for the intersection of the {one} and the {other} reached its limit"
            ),
        )
        .expected(format!("a {one} and another shape that do not run along each other"))
        .found(format!("a smallest gap of {:.6e}, and parts not searched", report.residual))
        .help("start from a bead or a magnet near the intended point");
    }
    let at: Vec<String> = report.last.iter().map(|x| format!("{x:.6}")).collect();
    let fault = CallError::new("no-intersection", format!("the {one} does not meet the {other}"))
        .expected(format!("a {one} that crosses the {other} within its parameter range"));
    let fault = if report.residual.is_finite() {
        fault.found(format!("a gap of {:.6e} at ({})", report.residual, at.join(", ")))
    } else {
        fault.found("nothing near")
    };
    fault.help(format!("move or lengthen the {one}, or the {other}"))
}

/// The fault of a derivative at a contact: it is infinite.
pub fn tangent() -> CallError {
    CallError::new("tangent-contact", "the shapes touch, so the point has no finite derivative")
        .expected("shapes that cross at an angle")
        .found("shapes that are tangent to each other")
        .help("move one of them until they cross, or take the nearest point instead (Prox…)")
}

/// The fault of an iteration that came to nothing.
pub fn diverged(report: &LocateReport) -> CallError {
    CallError::new("no-convergence", "the search for the nearest point did not converge")
        .found(format!("a residual of {:.3e}", report.residual))
        .help("give a start near the intended point")
}
