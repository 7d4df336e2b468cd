//! Use of the budget by a run, and the messages when it is exceeded.

use moldloft_budget::Spent;
use moldloft_diag::Diagnostic;

/// Number of compiled steps that take the time of one interpreted step.
pub(crate) const STEPS_OF_CODE: u64 = 16;

/// Counts of a run, compared with its limits.
#[derive(Debug, Default)]
pub(crate) struct Usage {
    /// Statements and calls, and the elements of values.
    pub steps: u64,
    /// The steps executed by compiled code, which count less.
    pub quick: u64,
    /// Nesting depth of statements, expressions and calls.
    pub depth: u32,
    /// Bytes that were printed.
    pub printed: usize,
    /// Errors that were reported.
    pub errors: usize,
}

impl Usage {
    /// The steps as the limit counts them: by the time that they take, the same on every machine.
    #[inline]
    pub fn cost(&self) -> u64 {
        self.steps - self.quick + self.quick / STEPS_OF_CODE
    }
}

/// Why a run ended before it was done.
pub(crate) fn spent(spent: Spent) -> Diagnostic {
    match spent {
        Spent::Cancelled => Diagnostic::error("cancelled", "the run was cancelled"),
        other => Diagnostic::error(other.id(), other.to_string()).help(other.help()),
    }
}
