//! What a run may use, in one place: memory, steps, objects, time; and whether it was cancelled.
//!
//! Work that grows asks its [`Budget`]: [`Budget::grow`] before it allocates what a user's number asks for,
//! [`Budget::poll`] in loops that may take long. What comes back is [`Spent`], with a message that says what was used
//! up and how to allow more.
//!
//! Invariant: a budget never changes a result; work ends as if there were none, or with [`Spent`].

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
    /// Bytes on the heap of the process; none without a counting allocator.
    pub memory: u64,
    /// Statements and calls of a program, and the elements of its values; what loops and routines on numbers do in code
    /// counts a sixteenth, as it takes so much less time.
    pub steps: u64,
    /// Objects of a model.
    pub objects: u64,
    /// Seconds of one request: a run, a mesh, a measure. Without a limit, work on a set still has [`SET_SECONDS`].
    pub seconds: f64,
}

impl Limits {
    /// What a program may use unless its host says otherwise: 4 GiB, 20 million steps, 250 000 objects, any time.
    /// Hosts take [`usual_memory`] instead of 4 GiB.
    pub const USUAL: Self =
        Self { memory: 4 << 30, steps: 20_000_000, objects: 250_000, seconds: f64::INFINITY };
}

static MEMORY: AtomicU64 = AtomicU64::new(Limits::USUAL.memory);
static STEPS: AtomicU64 = AtomicU64::new(Limits::USUAL.steps);
static OBJECTS: AtomicU64 = AtomicU64::new(Limits::USUAL.objects);
static SECONDS: AtomicU64 = AtomicU64::new(Limits::USUAL.seconds.to_bits());

/// The limits of the process: those of every run that begins.
pub fn limits() -> Limits {
    Limits {
        memory: MEMORY.load(Ordering::Relaxed),
        steps: STEPS.load(Ordering::Relaxed),
        objects: OBJECTS.load(Ordering::Relaxed),
        seconds: f64::from_bits(SECONDS.load(Ordering::Relaxed)),
    }
}

/// Sets the limits of the process; no more memory than the system's limit of address space leaves, so that work ends
/// before the system refuses.
pub fn set_limits(limits: Limits) {
    MEMORY.store(limits.memory.min(machine::room(held())), Ordering::Relaxed);
    STEPS.store(limits.steps, Ordering::Relaxed);
    OBJECTS.store(limits.objects, Ordering::Relaxed);
    SECONDS.store(limits.seconds.to_bits(), Ordering::Relaxed);
}

/// Why work ended before it was done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Spent {
    /// The caller asked to stop.
    Cancelled,
    /// There is not enough memory.
    Memory {
        /// Bytes held, and those that were asked for.
        needed: u64,
        /// Bytes that are allowed.
        allowed: u64,
    },
    /// The system refuses memory that the budget allows.
    Refused,
    /// The time is over.
    Time {
        /// Seconds that were allowed.
        allowed: f64,
    },
}

impl Spent {
    /// A stable id, as diagnostics have it.
    pub fn id(self) -> &'static str {
        match self {
            Self::Cancelled => "cancelled",
            Self::Memory { .. } | Self::Refused => "out-of-memory",
            Self::Time { .. } => "out-of-time",
        }
    }

    /// True for the id of a fault that says nothing of the model: the same work may succeed another time.
    pub fn is_id(id: &str) -> bool {
        matches!(id, "cancelled" | "out-of-memory" | "out-of-time")
    }

    /// What can be done about it.
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

/// What is left to a run. Shared by the threads that work for it and by who may cancel it.
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
    /// When the time is over, in nanoseconds after [`elapsed`]'s beginning; 0 for never.
    deadline: AtomicU64,
    /// The time of a part of the work, and the budget of the whole; none for the whole.
    portion: Option<Portion>,
}

/// Time since the moment from which deadlines count.
fn elapsed() -> Duration {
    static ORIGIN: OnceLock<Instant> = OnceLock::new();
    ORIGIN.get_or_init(Instant::now).elapsed()
}

/// Time that is counted; it ends with this.
#[derive(Debug)]
pub struct Timed<'a>(&'a Budget);

impl Drop for Timed<'_> {
    fn drop(&mut self) {
        self.0.deadline.store(0, Ordering::Relaxed);
        memory::leave();
    }
}

impl Budget {
    /// Has the work end at its next look.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    /// Lets work begin again after it was cancelled.
    pub fn resume(&self) {
        self.cancelled.store(false, Ordering::Relaxed);
    }

    /// True after [`Budget::cancel`].
    pub fn is_cancelled(&self) -> bool {
        let above = || self.portion.as_ref().is_some_and(|portion| portion.whole.is_cancelled());
        self.cancelled.load(Ordering::Relaxed) || above()
    }

    /// A budget for the work on one set: a part of this one and, where no time is stated, of [`SET_SECONDS`].
    #[must_use]
    pub fn for_set(self: &Arc<Self>) -> Arc<Self> {
        // A page in a browser has no clock here; its host ends the engine.
        match limits().seconds.is_finite() || cfg!(target_family = "wasm") {
            true => self.clone(),
            false => Arc::new(Self {
                portion: Some(Portion::new(self.clone(), SET_SECONDS)),
                ..Self::default()
            }),
        }
    }

    /// A request begins, until the answer is dropped: its time is counted, where time is limited, and memory is kept back
    /// for its end when the system refuses more.
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

    /// Whether work may go on.
    ///
    /// # Errors
    /// [`Spent`] once it was cancelled, or memory or time are used up.
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

    /// True when work must end; for loops that cannot return an error by themselves.
    pub fn is_spent(&self) -> bool {
        self.poll().is_err()
    }

    /// Whether so many bytes more may be held.
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
