//! Bytes that the process has allocated, counted by an allocator around the system's.
//!
//! Each thread counts by itself and adds to the sum once it is [`FLUSH`] away from it, so that an allocation costs
//! what it did. The sum is exact to [`FLUSH`] for each thread. Where no program installs [`Counting`], it stays zero.
#![expect(
    unsafe_code,
    reason = "an allocator is unsafe code; this one hands everything to the system's"
)]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::atomic::{AtomicI64, Ordering};

/// Bytes that a thread counts by itself.
pub const FLUSH: i64 = 64 << 10;

static HELD: AtomicI64 = AtomicI64::new(0);

thread_local! {
    /// Bytes of this thread that are not in the sum yet; blocks may be freed by other threads.
    static OWN: Cell<i64> = const { Cell::new(0) };
}

fn count(bytes: i64) {
    // Without a place to count, at the end of a thread, nothing is counted.
    let _ = OWN.try_with(|own| {
        let sum = own.get() + bytes;
        if sum.abs() < FLUSH {
            own.set(sum);
        } else {
            HELD.fetch_add(sum, Ordering::Relaxed);
            own.set(0);
        }
    });
}

/// Adds to the sum what the thread has counted by itself: for the end of a thread, which would take it along.
pub fn settle() {
    let _ = OWN.try_with(|own| HELD.fetch_add(own.replace(0), Ordering::Relaxed));
}

/// Bytes that the process holds on its heap.
pub fn held() -> u64 {
    u64::try_from(HELD.load(Ordering::Relaxed)).unwrap_or(0)
}

/// The system's allocator, with its bytes counted.
#[derive(Clone, Copy, Debug, Default)]
pub struct Counting;

// SAFETY: every call is the system allocator's with the same arguments; counting neither allocates nor panics.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller keeps the contract of `GlobalAlloc`.
        let block = unsafe { System.alloc(layout) };
        if !block.is_null() {
            count(layout.size() as i64);
        }
        block
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as above.
        let block = unsafe { System.alloc_zeroed(layout) };
        if !block.is_null() {
            count(layout.size() as i64);
        }
        block
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { System.dealloc(block, layout) };
        count(-(layout.size() as i64));
    }

    unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: as above.
        let moved = unsafe { System.realloc(block, layout, size) };
        if !moved.is_null() {
            count(size as i64 - layout.size() as i64);
        }
        moved
    }
}
