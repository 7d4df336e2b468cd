//! Long work without Python's lock, and Ctrl-C.

use pyo3::prelude::*;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc;
use std::time::Duration;

/// How often signals are looked at while work is under way.
const SIGNALS_EVERY: Duration = Duration::from_millis(50);

/// How long a cancelled run may take to notice.
const PATIENCE: Duration = Duration::from_secs(1);

/// Stack of the working thread: that of the main thread on Linux.
const STACK: usize = 8 << 20;

/// Runs `work` on a thread of its own, without Python's lock, and looks out for Ctrl-C.
///
/// After Ctrl-C `cancel` is set and the exception raised. Work that does not look at it goes on
/// unseen until it ends, and calls that need what it holds wait for it.
pub fn interruptible<R: Send + 'static>(
    py: Python<'_>,
    cancel: &AtomicBool,
    work: impl FnOnce() -> R + Send + 'static,
) -> PyResult<R> {
    let (sender, receiver) = mpsc::channel();
    let run = move || {
        // After an interrupt nobody receives; that is no fault.
        let _ = sender.send(catch_unwind(AssertUnwindSafe(work)));
    };
    std::thread::Builder::new().stack_size(STACK).spawn(run)?;
    let receiver = Mutex::new(receiver);
    let receive = |wait: Duration| {
        py.detach(|| receiver.lock().expect("only this thread locks it").recv_timeout(wait))
    };
    loop {
        match receive(SIGNALS_EVERY) {
            Ok(Ok(result)) => return Ok(result),
            Ok(Err(panic)) => resume_unwind(panic),
            Err(_) => {
                if let Err(interrupt) = py.check_signals() {
                    cancel.store(true, Ordering::Relaxed);
                    let _ = receive(PATIENCE);
                    cancel.store(false, Ordering::Relaxed);
                    return Err(interrupt);
                }
            }
        }
    }
}
