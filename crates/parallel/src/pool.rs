//! The pool of this process: Rayon's own in the first one that works in parallel, a new one in each of its descendants.

use rayon::{ThreadPool, ThreadPoolBuilder};
use std::cell::Cell;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU32, Ordering};

/// Processes that worked in parallel, each a descendant of the one before by `fork` without `exec`.
static GENERATIONS: [Generation; MAX_GENERATIONS] = [const { Generation::new() }; MAX_GENERATIONS];

/// Number of pools beyond which work waits for a pool of its own to start.
const MAX_GENERATIONS: usize = 64;

/// A process and its pool. No process ever waits for a generation of another: a `fork` in the middle of the making of a
/// pool leaves the child a lock that nobody opens.
struct Generation {
    /// The process; 0 before the first.
    process: AtomicU32,
    /// Its pool. The first process has Rayon's own, so that tests may install another.
    pool: OnceLock<ThreadPool>,
}

impl Generation {
    const fn new() -> Self {
        Self { process: AtomicU32::new(0), pool: OnceLock::new() }
    }

    /// True when the generation is that of `process`, or was free and is so now.
    fn is_of(&self, process: u32) -> bool {
        let mut owner = self.process.load(Ordering::Relaxed);
        if owner == 0 {
            let taken =
                self.process.compare_exchange(0, process, Ordering::Relaxed, Ordering::Relaxed);
            owner = taken.err().unwrap_or(process);
        }
        owner == process
    }
}

thread_local! {
    /// True on a thread that does all the work of its loops.
    static ALONE: Cell<bool> = const { Cell::new(false) };
}

/// True on a thread of [`on_one_thread`]: its work must stay on it.
pub fn is_alone() -> bool {
    ALONE.get()
}

/// Does work with all its parallel loops on one thread, a new one: data kept by thread are found again.
/// `None` when the system refuses a thread.
pub fn on_one_thread<R: Send>(stack_bytes: usize, work: impl FnOnce() -> R + Send) -> Option<R> {
    let builder = ThreadPoolBuilder::new().num_threads(1).stack_size(stack_bytes);
    let alone = builder.build().ok()?;
    Some(alone.install(|| {
        ALONE.set(true);
        work()
    }))
}

/// Does work with its parallel loops on threads of this process.
pub(crate) fn in_pool<R: Send>(work: impl FnOnce() -> R + Send) -> R {
    if ALONE.get() {
        return work();
    }
    in_pool_of(&GENERATIONS, std::process::id(), work)
}

fn in_pool_of<R: Send>(
    generations: &[Generation],
    process: u32,
    work: impl FnOnce() -> R + Send,
) -> R {
    match generations.iter().position(|generation| generation.is_of(process)) {
        Some(0) => work(),
        Some(k) => generations[k].pool.get_or_init(new_pool).install(work),
        None => new_pool().install(work),
    }
}

fn new_pool() -> ThreadPool {
    ThreadPoolBuilder::new().build().expect("threads can be started")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn thread() -> Option<usize> {
        rayon::current_thread_index()
    }

    #[test]
    fn each_process_has_a_pool_and_the_last_ones_work_without() {
        let generations = [const { Generation::new() }; 2];
        // The first works where it is, on whatever pool is installed there.
        assert_eq!(in_pool_of(&generations, 7, thread), None);
        let installed = ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        assert_eq!(installed.install(|| in_pool_of(&generations, 7, thread)), Some(0));
        // Its child and that one's child have others; the child's stays.
        assert!(in_pool_of(&generations, 8, thread).is_some());
        let pool = generations[1].pool.get().map(std::ptr::from_ref);
        assert!(in_pool_of(&generations, 8, thread).is_some());
        assert_eq!(pool, generations[1].pool.get().map(std::ptr::from_ref));
        assert!(in_pool_of(&generations, 9, thread).is_some());
    }

    #[test]
    fn loops_within_loops_end() {
        let generations = [const { Generation::new() }; 2];
        in_pool_of(&generations, 1, || ());
        let inner = || in_pool_of(&generations, 2, thread);
        assert!(in_pool_of(&generations, 2, inner).is_some());
    }

    #[test]
    fn one_thread_does_all_the_work_of_its_loops() {
        use crate::many::*;
        let threads = on_one_thread(1 << 20, || {
            let inner = || (0..8u32).into_par_iter().map(|_| std::thread::current().id());
            let outer = (0..8u32).into_par_iter().flat_map_iter(|_| inner().collect::<Vec<_>>());
            outer.collect::<Vec<_>>()
        });
        let threads = threads.expect("a thread");
        assert_eq!(threads.len(), 64);
        assert!(threads.iter().all(|id| *id == threads[0] && *id != std::thread::current().id()));
    }
}
