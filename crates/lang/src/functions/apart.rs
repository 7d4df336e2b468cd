//! Work that does not check the budget, such as encoders of files, on a thread of its own while the
//! run checks.
//!
//! When the budget is spent the run ends without the thread, whose result is dropped.

use crate::run::interpreter::Interpreter;
use crate::run::usage;
use moldloft_budget::{Budget, Spent};
use moldloft_diag::{Diagnostic, Span};
use moldloft_registry::Scalar;

/// Number of items that take less time than a check.
const FEW: usize = 20_000;

impl<T: Scalar> Interpreter<'_, '_, T> {
    /// Runs a computation on about `items` points, bytes or the like that can be stopped meanwhile.
    pub(super) fn apart<R: Send + 'static>(
        &self,
        items: usize,
        span: Span,
        work: impl FnOnce() -> R + Send + 'static,
    ) -> Result<R, Diagnostic> {
        match items < FEW {
            true => Ok(work()),
            false => {
                watched(self.inputs.budget, work).map_err(|spent| usage::spent(spent).at(span))
            }
        }
    }
}

#[cfg(not(target_arch = "wasm32"))]
fn watched<R: Send + 'static>(
    budget: &Budget,
    work: impl FnOnce() -> R + Send + 'static,
) -> Result<R, Spent> {
    use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
    use std::sync::mpsc::{RecvTimeoutError, channel};
    use std::time::Duration;

    let (give, take) = channel();
    let started = std::thread::Builder::new().spawn(move || {
        let done = catch_unwind(AssertUnwindSafe(work));
        moldloft_budget::settle();
        // Nobody waits any more when the run has ended.
        let _ = give.send(done);
    });
    if started.is_err() {
        return Err(Spent::Refused);
    }
    loop {
        match take.recv_timeout(Duration::from_millis(20)) {
            Ok(Ok(made)) => return Ok(made),
            Ok(Err(panic)) => resume_unwind(panic),
            Err(RecvTimeoutError::Timeout) => budget.poll()?,
            Err(RecvTimeoutError::Disconnected) => return Err(Spent::Refused),
        }
    }
}

/// A page in a browser has no threads; its host ends the engine.
#[cfg(target_arch = "wasm32")]
fn watched<R>(_: &Budget, work: impl FnOnce() -> R) -> Result<R, Spent> {
    Ok(work())
}
