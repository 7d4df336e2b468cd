//! Heap size of the process, counted by an allocator that wraps the system's.
//! Each thread has a counter and adds it to the sum when it exceeds [`FLUSH`], which keeps the cost
//! of an allocation negligible. The sum is accurate to [`FLUSH`] per thread, and stays zero unless
//! the program installs [`Counting`].
//! When the system refuses an allocation, a reserve is released. It serves this allocation and
//! those until the next check of the budget, which ends the work with an error; without it Rust
//! aborts the process. Allocations above [`RESERVE`] / 2 are refused at once, for callers that
//! handle refusal.
#![expect(
    unsafe_code,
    reason = "an allocator is unsafe code; this one hands everything to the system's"
)]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::ptr::null_mut;
use std::sync::atomic::{AtomicBool, AtomicI64, AtomicPtr, AtomicUsize, Ordering};

/// Bytes that a thread counts before it adds them to the sum.
pub const FLUSH: i64 = 64 << 10;

static HELD: AtomicI64 = AtomicI64::new(0);

thread_local! {
    /// Bytes of this thread not yet in the sum; may be negative, since other threads may free
    /// blocks.
    static OWN: Cell<i64> = const { Cell::new(0) };
}

fn count(bytes: i64) {
    // At the end of a thread the counter no longer exists, and nothing is counted.
    let _ = OWN.try_with(|own| {
        let sum = own.get() + bytes;
        if sum.abs() < FLUSH {
            own.set(sum);
        } else {
            HELD.fetch_add(sum, Ordering::Relaxed);
            INSTALLED.store(true, Ordering::Relaxed);
            own.set(0);
        }
    });
}

/// Memory that the system's allocator takes for a block: its size, a header and rounding, as glibc
/// has them; for blocks of a few words that is a fifth and more.
fn taken(size: usize) -> i64 {
    ((size as i64 + 8 + 15) & !15).max(32)
}

/// Adds the counter of this thread to the sum; to be called at the end of a thread.
pub fn settle() {
    let _ = OWN.try_with(|own| HELD.fetch_add(own.replace(0), Ordering::Relaxed));
}

/// Heap size of the process in bytes.
pub fn held() -> u64 {
    u64::try_from(HELD.load(Ordering::Relaxed)).unwrap_or(0)
}

/// Memory outside the heap, such as a stack, that is counted until this is dropped.
#[derive(Debug)]
pub struct BesideHeap(i64);

/// Counts memory outside the heap.
pub fn beside(bytes: u32) -> BesideHeap {
    HELD.fetch_add(i64::from(bytes), Ordering::Relaxed);
    BesideHeap(i64::from(bytes))
}

impl Drop for BesideHeap {
    fn drop(&mut self) {
        HELD.fetch_sub(self.0, Ordering::Relaxed);
    }
}

/// Size of the reserve for running work when the system refuses an allocation, in bytes. It is
/// never written, so it uses address space but no memory.
pub const RESERVE: usize = 64 << 20;

const RESERVED: Layout = match Layout::from_size_align(RESERVE, 16) {
    Ok(layout) => layout,
    Err(_) => panic!("a power of two"),
};

/// The reserve; null before [`reserve`] and after its release.
static KEPT_BACK: AtomicPtr<u8> = AtomicPtr::new(null_mut());

/// Value of [`KEPT_BACK`] while a thread releases the reserve; not the address of a block.
const GIVING_UP: *mut u8 = std::ptr::without_provenance_mut(1);

/// True after the release of the reserve: work must end.
static REFUSED: AtomicBool = AtomicBool::new(false);

/// Number of running requests; while there is one, a released reserve is not allocated again.
static UNDER_WAY: AtomicUsize = AtomicUsize::new(0);

/// True from a refusal by the system until a request can allocate the reserve again.
#[inline]
pub(crate) fn refused() -> bool {
    REFUSED.load(Ordering::Relaxed) && still_refused()
}

/// Work outside requests restores the reserve when it checks.
#[cold]
fn still_refused() -> bool {
    if UNDER_WAY.load(Ordering::Relaxed) == 0 {
        reserve();
    }
    REFUSED.load(Ordering::Relaxed)
}

/// Begins a request; the first of concurrent requests allocates the reserve.
pub(crate) fn enter() {
    if UNDER_WAY.fetch_add(1, Ordering::Relaxed) == 0 {
        reserve();
    }
}

/// Ends a request.
pub(crate) fn leave() {
    UNDER_WAY.fetch_sub(1, Ordering::Relaxed);
}

/// Allocates the reserve, if there is none, through the program's allocator; useless without a
/// counting one.
fn reserve() {
    // In a browser address space is memory, and the engine of a page may end.
    if cfg!(target_family = "wasm") || !KEPT_BACK.load(Ordering::Acquire).is_null() {
        return;
    }
    if INSTALLED.load(Ordering::Relaxed) {
        // SAFETY: the size is not zero; the block is freed with the same layout.
        let block = unsafe { std::alloc::alloc(RESERVED) };
        if block.is_null() {
            return;
        }
        // The reserve does not count as used.
        count(-taken(RESERVE));
        if KEPT_BACK
            .compare_exchange(null_mut(), block, Ordering::AcqRel, Ordering::Acquire)
            .is_err()
        {
            count(taken(RESERVE));
            // SAFETY: it was allocated above.
            unsafe { std::alloc::dealloc(block, RESERVED) };
        }
    }
    REFUSED.store(false, Ordering::Relaxed);
}

/// True when the program uses a counting allocator: set by the first bytes added to the sum.
static INSTALLED: AtomicBool = AtomicBool::new(false);

/// A counting allocator around the system's allocator, or in tests around one that refuses.
#[derive(Clone, Copy, Debug)]
pub struct Counting<A = System>(A);

impl Counting {
    /// The system's.
    pub const fn new() -> Self {
        Self(System)
    }
}

impl Default for Counting {
    fn default() -> Self {
        Self::new()
    }
}

impl<A: GlobalAlloc> Counting<A> {
    /// Counts the bytes of another allocator.
    pub const fn over(inner: A) -> Self {
        Self(inner)
    }

    /// Handles a refused allocation: releases the reserve and tries again.
    #[cold]
    fn again(&self, size: usize, ask: impl Fn() -> *mut u8) -> *mut u8 {
        if size > RESERVE / 2 {
            return null_mut();
        }
        loop {
            let kept = KEPT_BACK.load(Ordering::Acquire);
            if kept.is_null() {
                break;
            }
            // Another thread is releasing it; the system refuses until that is done.
            if kept == GIVING_UP {
                std::thread::yield_now();
                continue;
            }
            let taken =
                KEPT_BACK.compare_exchange(kept, GIVING_UP, Ordering::AcqRel, Ordering::Acquire);
            if taken.is_ok() {
                REFUSED.store(true, Ordering::Relaxed);
                // SAFETY: it was allocated with this layout by this allocator, and taken out by this thread alone.
                unsafe { self.0.dealloc(kept, RESERVED) };
                KEPT_BACK.store(null_mut(), Ordering::Release);
                break;
            }
        }
        ask()
    }

    /// Makes and counts a block of `size` bytes, `more` than before.
    #[inline]
    fn counted(&self, size: usize, more: i64, ask: impl Fn() -> *mut u8) -> *mut u8 {
        let mut block = ask();
        if block.is_null() {
            block = self.again(size, ask);
        }
        if !block.is_null() {
            count(more);
        }
        block
    }
}

// SAFETY: every call is forwarded to the inner allocator with the same arguments; counting neither
// allocates nor panics.
unsafe impl<A: GlobalAlloc> GlobalAlloc for Counting<A> {
    #[inline]
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller keeps the contract of `GlobalAlloc`.
        self.counted(layout.size(), taken(layout.size()), || unsafe { self.0.alloc(layout) })
    }

    #[inline]
    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as above.
        self.counted(layout.size(), taken(layout.size()), || unsafe { self.0.alloc_zeroed(layout) })
    }

    #[inline]
    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { self.0.dealloc(block, layout) };
        count(-taken(layout.size()));
    }

    #[inline]
    unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: as above; a block that cannot be reallocated is unchanged.
        let more = taken(size) - taken(layout.size());
        self.counted(size, more, || unsafe { self.0.realloc(block, layout, size) })
    }
}
