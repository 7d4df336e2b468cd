//! Limits of a run: memory, steps, objects and time; and its cancellation.
//! Work of user-controlled size checks its [`Budget`]: [`Budget::grow`] before an allocation,
//! [`Budget::poll`] in long loops. The error is [`Spent`], whose message names the exhausted limit
//! and how to raise it.
//! Invariant: a budget never changes a result; work completes as without a budget, or fails with
//! [`Spent`].

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod confine;
mod frames;
mod machine;
mod memory;
mod portion;

pub use confine::confine;
pub use frames::{LONGEST_FRAME, read_frame, write_frame};
pub use machine::usual_memory;
pub use memory::{BesideHeap, Counting, FLUSH, RESERVE, beside, held, settle};
pub use portion::SET_SECONDS;

use portion::Portion;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

/// The limits of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Bytes on the heap of the process; has no effect without a counting allocator.
    pub memory: u64,
    /// Statements and calls of a program, and elements of its values; a step of compiled numeric
    /// code counts one sixteenth, in proportion to its time.
    pub steps: u64,
    /// Number of objects of a model.
    pub objects: u64,
    /// Seconds per request: a run, a mesh, a measure. Without a limit, work on a set is still
    /// limited to [`SET_SECONDS`].
    pub seconds: f64,
}

impl Limits {
    /// Default limits: 4 GiB, 20 million steps, 250 000 objects, unlimited time. Hosts use
    /// [`usual_memory`] instead of 4 GiB.
    pub const USUAL: Self =
        Self { memory: 4 << 30, steps: 20_000_000, objects: 250_000, seconds: f64::INFINITY };
}

static MEMORY: AtomicU64 = AtomicU64::new(Limits::USUAL.memory);
static STEPS: AtomicU64 = AtomicU64::new(Limits::USUAL.steps);
static OBJECTS: AtomicU64 = AtomicU64::new(Limits::USUAL.objects);
static SECONDS: AtomicU64 = AtomicU64::new(Limits::USUAL.seconds.to_bits());

/// The limits of the process, which apply to every new run.
pub fn limits() -> Limits {
    Limits {
        memory: MEMORY.load(Ordering::Relaxed),
        steps: STEPS.load(Ordering::Relaxed),
        objects: OBJECTS.load(Ordering::Relaxed),
        seconds: f64::from_bits(SECONDS.load(Ordering::Relaxed)),
    }
}

/// Sets the limits of the process. Memory is reduced to the address space that the system allows,
/// so that work ends before an allocation fails.
pub fn set_limits(limits: Limits) {
    MEMORY.store(limits.memory.min(machine::room(held())), Ordering::Relaxed);
    STEPS.store(limits.steps, Ordering::Relaxed);
    OBJECTS.store(limits.objects, Ordering::Relaxed);
    SECONDS.store(limits.seconds.to_bits(), Ordering::Relaxed);
}

/// Reason why work ended before its completion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Spent {
    /// Cancelled by the caller.
    Cancelled,
    /// The memory limit is reached.
    Memory {
        /// Bytes in use plus the requested ones.
        needed: u64,
        /// Limit in bytes.
        allowed: u64,
    },
    /// The system refused an allocation that the budget allows.
    Refused,
    /// The time limit is reached.
    Time {
        /// Limit in seconds.
        allowed: f64,
    },
}

impl Spent {
    /// Its stable id in diagnostics.
    pub fn id(self) -> &'static str {
        match self {
            Self::Cancelled => "cancelled",
            Self::Memory { .. } | Self::Refused => "out-of-memory",
            Self::Time { .. } => "out-of-time",
        }
    }

    /// True for the id of such a reason: the model is not at fault, and the same work may succeed
    /// later.
    pub fn is_id(id: &str) -> bool {
        matches!(id, "cancelled" | "out-of-memory" | "out-of-time")
    }

    /// The remedy.
    pub fn help(self) -> &'static str {
        match self {
            Self::Cancelled => "",
            Self::Memory { .. } => {
                "make it coarser, or allow more: `--limit memory=8G`, `moldloft.limits(memory=...)`"
            }
            Self::Refused => "make it coarser, or end other programs",
            Self::Time { .. } => {
                "make it coarser, or allow more: `--limit seconds=600`, `moldloft.limits(seconds=...)`"
            }
        }
    }
}

impl std::fmt::Display for Spent {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let gib = |bytes: u64| bytes as f64 / f64::from(1 << 30);
        match *self {
            Self::Cancelled => write!(f, "cancelled"),
            Self::Memory { needed, allowed } => {
                write!(
                    f,
                    "this needs {:.2} GiB of memory, {:.2} are allowed",
                    gib(needed),
                    gib(allowed)
                )
            }
            Self::Refused => write!(f, "the system has no more memory for this"),
            Self::Time { allowed } => {
                write!(f, "this takes longer than the {allowed} s that are allowed")
            }
        }
    }
}

impl std::error::Error for Spent {}

/// The remaining budget of a run, shared by its threads and by the owner, who may cancel it.
///
/// # Example
/// ```
/// use moldloft_budget::{Budget, Spent};
///
/// let budget = Budget::default();
/// assert_eq!(budget.poll(), Ok(()));
/// assert!(matches!(budget.grow(1 << 60), Err(Spent::Memory { .. })));
/// budget.cancel();
/// assert_eq!(budget.poll(), Err(Spent::Cancelled));
/// ```
#[derive(Debug, Default)]
pub struct Budget {
    cancelled: AtomicBool,
    /// Deadline in nanoseconds on the clock of [`elapsed`]; 0 without one.
    deadline: AtomicU64,
    /// Time of a part of the work and budget of the whole; `None` in the budget of the whole.
    portion: Option<Portion>,
}

/// Time since the origin of deadlines.
fn elapsed() -> Duration {
    static ORIGIN: OnceLock<Instant> = OnceLock::new();
    ORIGIN.get_or_init(Instant::now).elapsed()
}

/// Guard of a timed request, which ends when this is dropped.
#[derive(Debug)]
pub struct Timed<'a>(&'a Budget);

impl Drop for Timed<'_> {
    fn drop(&mut self) {
        self.0.deadline.store(0, Ordering::Relaxed);
        memory::leave();
    }
}

impl Budget {
    /// Ends the work at the next check.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    /// Allows new work after a cancellation.
    pub fn resume(&self) {
        self.cancelled.store(false, Ordering::Relaxed);
    }

    /// True after [`Budget::cancel`].
    pub fn is_cancelled(&self) -> bool {
        let above = || self.portion.as_ref().is_some_and(|portion| portion.whole.is_cancelled());
        self.cancelled.load(Ordering::Relaxed) || above()
    }

    /// A budget for the work on one set: part of this one, and without a time limit at most
    /// [`SET_SECONDS`].
    #[must_use]
    pub fn for_set(self: &Arc<Self>) -> Arc<Self> {
        // There is no clock in a browser; the page ends the engine.
        match limits().seconds.is_finite() || cfg!(target_family = "wasm") {
            true => self.clone(),
            false => Arc::new(Self {
                portion: Some(Portion::new(self.clone(), SET_SECONDS)),
                ..Self::default()
            }),
        }
    }

    /// Begins a request, which ends when the guard is dropped. Starts its time limit, if there is
    /// one, and holds a memory reserve for an orderly end when the system refuses more.
    pub fn timed(&self) -> Timed<'_> {
        memory::enter();
        let seconds = limits().seconds;
        if let Ok(allowed) = Duration::try_from_secs_f64(seconds) {
            let end = elapsed() + allowed;
            let end = u64::try_from(end.as_nanos()).unwrap_or(0);
            self.deadline.store(end.max(1), Ordering::Relaxed);
        }
        Timed(self)
    }

    /// Checks that work may continue.
    ///
    /// # Errors
    /// [`Spent`] if it is cancelled, or memory or time are exhausted.
    #[inline]
    pub fn poll(&self) -> Result<(), Spent> {
        if self.cancelled.load(Ordering::Relaxed) {
            return Err(Spent::Cancelled);
        }
        if let Some(portion) = &self.portion {
            return portion.poll();
        }
        self.grow(0)?;
        let deadline = self.deadline.load(Ordering::Relaxed);
        if deadline > 0 && elapsed().as_nanos() > u128::from(deadline) {
            return Err(Spent::Time { allowed: limits().seconds });
        }
        Ok(())
    }

    /// True when work must end; for loops that cannot return an error.
    pub fn is_spent(&self) -> bool {
        self.poll().is_err()
    }

    /// Checks that `bytes` more may be allocated.
    ///
    /// # Errors
    /// [`Spent::Memory`].
    #[inline]
    pub fn grow(&self, bytes: u64) -> Result<(), Spent> {
        if memory::refused() {
            return Err(Spent::Refused);
        }
        let (needed, allowed) = (held().saturating_add(bytes), MEMORY.load(Ordering::Relaxed));
        if needed > allowed { Err(Spent::Memory { needed, allowed }) } else { Ok(()) }
    }
}
