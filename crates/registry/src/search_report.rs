//! Reports of searches that a value carries, and the resulting warnings. They depend on the model
//! only.

use moldloft_num::Vec3;
use std::fmt;

/// A warning about a value that exists.
#[derive(Clone, Debug, PartialEq)]
pub struct Remark {
    /// Id of the diagnostic.
    pub id: &'static str,
    /// Message.
    pub message: String,
    /// Remedy; may be empty.
    pub advice: &'static str,
}

/// Report of a construction by search or fit (a projection, an intersection, a fit), stored with
/// the point or curve; it depends only on the model.
#[derive(Clone, Debug, PartialEq)]
pub struct SearchReport {
    /// Result of the search.
    pub status: SearchStatus,
    /// Residual of the equations, in the unit of length.
    pub residual: f64,
    /// Steps of the iteration.
    pub iterations: u32,
    /// The parameters that the search began with.
    pub start: Vec<f64>,
    /// The parameters it ended with.
    pub last: Vec<f64>,
    /// Solutions not chosen: their parameters and positions.
    pub alternatives: Vec<(Vec<f64>, Vec3)>,
    /// Advice on how to get another solution or to avoid the warning.
    pub advice: &'static str,
}

/// Result of a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SearchStatus {
    /// Found from the given start, or the only solution.
    Ok,
    /// The iteration from the start failed; the nearest of all solutions was chosen.
    Fallback,
    /// At an end or an edge, because the unconstrained solution is beyond it.
    EdgeClamped,
    /// The shapes are tangent, so the solution is ill-conditioned.
    Tangent,
    /// A weighted sum whose weights do not add up to 1.
    Unbalanced {
        /// Sum of the weights.
        sum: f64,
    },
    /// One of several solutions, without a start to select one.
    Multiple {
        /// Number of solutions.
        count: usize,
        /// Number of the result among them, from 0.
        chosen: usize,
        /// Distance in space to the nearest of the others.
        next: f64,
    },
}

impl SearchStatus {
    /// Its word used in the language and in Python.
    pub fn word(self) -> &'static str {
        match self {
            SearchStatus::Ok => "ok",
            SearchStatus::Fallback => "fallback",
            SearchStatus::EdgeClamped => "edge-clamped",
            SearchStatus::Tangent => "tangent",
            SearchStatus::Unbalanced { .. } => "unbalanced",
            SearchStatus::Multiple { .. } => "multiple",
        }
    }
}

impl fmt::Display for SearchStatus {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.word())
    }
}

fn list(parameters: &[f64]) -> String {
    let all: Vec<String> = parameters.iter().map(|x| format!("{x:.6}")).collect();
    match all.as_slice() {
        [one] => one.clone(),
        many => format!("({})", many.join(", ")),
    }
}

impl SearchReport {
    /// The warning about it, if any.
    pub fn remark(&self) -> Option<Remark> {
        let (id, message) = self.message()?;
        Some(Remark { id, message, advice: self.advice })
    }

    fn message(&self) -> Option<(&'static str, String)> {
        let at = list(&self.last);
        Some(match self.status {
            SearchStatus::Ok => return None,
            SearchStatus::Fallback => (
                "start-failed",
                format!(
                    "no convergence from the start {}; the nearest solution, at {at}, was used",
                    list(&self.start)
                ),
            ),
            SearchStatus::EdgeClamped => {
                ("edge-clamped", format!("the solution is beyond the edge; it was clamped to {at}"))
            }
            SearchStatus::Tangent => (
                "tangent-contact",
                format!("the shapes touch at {at}; a small change may separate them"),
            ),
            SearchStatus::Unbalanced { sum } => {
                ("weight-sum", format!("the weights sum to {sum}: the point depends on the origin"))
            }
            SearchStatus::Multiple { count, chosen, next } => {
                let others: Vec<String> =
                    self.alternatives.iter().take(3).map(|(p, _)| list(p)).collect();
                let more = if self.alternatives.len() > 3 { ", …" } else { "" };
                let message = format!(
                    "there are {count} solutions; number {} at {at} was taken, others are at {}{more} \
                     (the next {next:.3e} away)",
                    chosen + 1,
                    others.join(", ")
                );
                ("several-solutions", message)
            }
        })
    }

    /// True when there is a warning.
    pub fn warns(&self) -> bool {
        self.status != SearchStatus::Ok
    }
}
