//! The system refuses memory to several threads at once, and giving the reserve up takes a while: each has its block.
#![expect(unsafe_code, reason = "an allocator that hands everything to the system's, or refuses")]

use moldloft_budget::{Budget, Counting, RESERVE};
use std::alloc::{GlobalAlloc, Layout, System};
use std::hint::black_box;
use std::ptr::null_mut;
use std::sync::Barrier;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Refuses everything while it is full; room comes when the reserve is freed, slowly.
struct FullUntilFreed;

static FULL: AtomicBool = AtomicBool::new(false);

// SAFETY: every call is the system allocator's with the same arguments, or refuses, as the contract allows.
unsafe impl GlobalAlloc for FullUntilFreed {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        if FULL.load(Ordering::SeqCst) {
            return null_mut();
        }
        // SAFETY: the caller keeps the contract of `GlobalAlloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { System.dealloc(block, layout) };
        if layout.size() == RESERVE {
            std::thread::sleep(Duration::from_millis(50));
            FULL.store(false, Ordering::SeqCst);
        }
    }
}

#[global_allocator]
static ALLOCATOR: Counting<FullUntilFreed> = Counting::over(FullUntilFreed);

#[test]
fn threads_that_are_refused_at_once_wait_for_the_reserve() {
    const THREADS: usize = 4;
    // The allocator counts in steps: enough that it is known to be there.
    drop(black_box(vec![0u8; 1 << 20]));
    let budget = Budget::default();
    for _ in 0..3 {
        // A request takes the reserve anew.
        let timed = budget.timed();
        let barrier = Barrier::new(THREADS + 1);
        std::thread::scope(|scope| {
            for _ in 0..THREADS {
                scope.spawn(|| {
                    barrier.wait();
                    barrier.wait();
                    black_box(Vec::<u8>::with_capacity(100));
                });
            }
            barrier.wait();
            FULL.store(true, Ordering::SeqCst);
            barrier.wait();
        });
        assert!(!FULL.load(Ordering::SeqCst), "the reserve was given up");
        assert!(budget.poll().is_err(), "the work ends");
        drop(timed);
    }
}
