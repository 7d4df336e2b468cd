//! Long work without Python's lock, Ctrl-C, and calls into Python from such work.

use moldloft::budget::{Budget, settle};
use pyo3::prelude::*;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, OnceLock, mpsc};
use std::thread::ThreadId;
use std::time::{Duration, Instant};

/// Interval of checks for signals during work.
const SIGNALS_EVERY: Duration = Duration::from_millis(30);

/// Maximum time for a cancelled run to end before it is abandoned: together with the above less
/// than a tenth of a second.
const STOP_TIMEOUT: Duration = Duration::from_millis(50);

/// Stack of the working thread: that of the main thread on Linux.
const STACK: usize = 8 << 20;

/// Runs `work` on a thread of its own, without Python's lock, and looks out for Ctrl-C.
///
/// After Ctrl-C `budget` is cancelled, and stays so, and the exception is raised. Work that does
/// not check the budget continues in the background until it ends, and calls that need its data
/// wait for it.
pub fn interruptible<R: Send + 'static>(
    py: Python<'_>,
    budget: &Budget,
    work: impl FnOnce() -> R + Send + 'static,
) -> PyResult<R> {
    let slot = Arc::new(Mutex::new(None));
    let result = slot.clone();
    let run = move || {
        let made = work();
        *slot.lock().expect("nothing panics while it is locked") = Some(made);
    };
    let _timed = budget.timed();
    unseen(py, budget, Box::new(run))?;
    let made = result.lock().expect("nothing panics while it is locked").take();
    Ok(made.expect("the work has ended without panic"))
}

/// [`interruptible`] without the type of its result, so that it is compiled once.
fn unseen(
    py: Python<'_>,
    budget: &Budget,
    work: Box<dyn FnOnce() + Send + 'static>,
) -> PyResult<()> {
    let (sender, receiver) = mpsc::channel();
    let run = move || {
        // After an interrupt nobody receives; that is not a fault.
        let _ = sender.send(catch_unwind(AssertUnwindSafe(work)));
        settle();
    };
    std::thread::Builder::new().stack_size(STACK).spawn(run)?;
    let receiver = Mutex::new(receiver);
    let receive = |wait: Duration| {
        py.detach(|| {
            let received = receiver.lock().expect("only this thread locks it").recv_timeout(wait);
            stay_out();
            received
        })
    };
    loop {
        match receive(SIGNALS_EVERY) {
            // A late signal is handled here, and not during the conversion of the result to arrays.
            Ok(Ok(())) => return py.check_signals(),
            Ok(Err(panic)) => resume_unwind(panic),
            Err(_) => {
                if let Err(interrupt) = py.check_signals() {
                    budget.cancel();
                    let _ = receive(STOP_TIMEOUT);
                    return Err(interrupt);
                }
            }
        }
    }
}

/// [`interruptible`] for work without a budget: after Ctrl-C it continues in the background until
/// it ends.
pub fn unlocked<R: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce() -> R + Send + 'static,
) -> PyResult<R> {
    interruptible(py, &Budget::default(), work)
}

/// [`unlocked`], but in this thread where the work is small: another thread costs more than that.
pub fn unlocked_if<R: Send + 'static>(
    py: Python<'_>,
    large: bool,
    work: impl FnOnce() -> R + Send + 'static,
) -> PyResult<R> {
    if large { unlocked(py, work) } else { Ok(py.detach(work)) }
}

/// [`interruptible`] for a budget that later work shares: it is resumed after an interrupt.
pub fn interruptible_shared<R: Send + 'static>(
    py: Python<'_>,
    budget: &Budget,
    work: impl FnOnce() -> R + Send + 'static,
) -> PyResult<R> {
    let outcome = interruptible(py, budget, work);
    budget.resume();
    outcome
}

/// Number of threads of this package that run Python code.
static VISITORS: AtomicUsize = AtomicUsize::new(0);

/// The interpreter is about to end: nobody enters any more.
static CLOSED: AtomicBool = AtomicBool::new(false);

/// Maximum wait of the interpreter's end for running calls.
const LEAVING: Duration = Duration::from_secs(10);

/// One visit to Python; the count falls even if the visit panics.
struct Visit;

impl Drop for Visit {
    fn drop(&mut self) {
        VISITORS.fetch_sub(1, Ordering::SeqCst);
    }
}

/// Calls Python from work that may go on unseen; `None` once the interpreter is ending.
///
/// A thread that requests Python's lock while the interpreter ends is killed by it, and with it, as
/// Rust cannot unwind through that, the process. So the end waits for threads inside and admits no
/// others.
pub fn visit_python<R>(call: impl FnOnce(Python<'_>) -> R) -> Option<R> {
    VISITORS.fetch_add(1, Ordering::SeqCst);
    let _visit = Visit;
    if CLOSED.load(Ordering::SeqCst) {
        return None;
    }
    Some(Python::attach(call))
}

/// Keeps a daemon thread from going back to an interpreter that is ending; the process ends it.
fn stay_out() {
    while CLOSED.load(Ordering::SeqCst) && CLOSER.get() != Some(&std::thread::current().id()) {
        std::thread::park();
    }
}

/// The thread that ends the interpreter; its calls continue as usual.
static CLOSER: OnceLock<ThreadId> = OnceLock::new();

/// Runs at the interpreter's end (`atexit`): closes the door and waits for those inside.
#[pyfunction]
fn close(py: Python<'_>) {
    let _ = CLOSER.set(std::thread::current().id());
    CLOSED.store(true, Ordering::SeqCst);
    py.detach(|| {
        let begin = Instant::now();
        while VISITORS.load(Ordering::SeqCst) > 0 && begin.elapsed() < LEAVING {
            std::thread::sleep(Duration::from_millis(1));
        }
    });
}

/// Has the interpreter call [`close`] when it ends.
pub fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let close = wrap_pyfunction!(close, module)?;
    module.py().import("atexit")?.call_method1("register", (close,))?;
    Ok(())
}
