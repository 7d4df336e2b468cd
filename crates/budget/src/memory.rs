//! Bytes that the process has allocated, counted by an allocator around the system's.
//!
//! Each thread counts by itself and adds to the sum once it is [`FLUSH`] away from it, so that an allocation costs
//! what it did. The sum is exact to [`FLUSH`] for each thread. Where no program installs [`Counting`], it stays zero.
//!
//! When the system refuses, a reserve is given up: what was asked for, and what is allocated until the work looks at its
//! budget, is taken from that, and the look ends the work by name. Without it Rust ends the process. What is greater than
//! [`RESERVE`] / 2 is refused at once, for whoever asks so that it may be.
#![expect(
    unsafe_code,
    reason = "an allocator is unsafe code; this one hands everything to the system's"
)]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::ptr::null_mut;
use std::sync::atomic::{AtomicBool, AtomicI64, AtomicPtr, AtomicUsize, Ordering};

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
            INSTALLED.store(true, Ordering::Relaxed);
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

/// Bytes beside the heap, such as a stack, that count as held until this is dropped.
#[derive(Debug)]
pub struct BesideHeap(i64);

/// Counts bytes that are taken beside the heap.
pub fn beside(bytes: u32) -> BesideHeap {
    HELD.fetch_add(i64::from(bytes), Ordering::Relaxed);
    BesideHeap(i64::from(bytes))
}

impl Drop for BesideHeap {
    fn drop(&mut self) {
        HELD.fetch_sub(self.0, Ordering::Relaxed);
    }
}

/// Bytes that are kept back for the work under way when the system refuses. Nothing is written there: it is address
/// space, no memory.
pub const RESERVE: usize = 64 << 20;

const RESERVED: Layout = match Layout::from_size_align(RESERVE, 16) {
    Ok(layout) => layout,
    Err(_) => panic!("a power of two"),
};

/// The reserve; none before [`reserve`] and after it was given up.
static KEPT_BACK: AtomicPtr<u8> = AtomicPtr::new(null_mut());

/// In [`KEPT_BACK`] while a thread gives the reserve up; no block begins there.
const GIVING_UP: *mut u8 = std::ptr::without_provenance_mut(1);

/// The reserve was given up: work must end.
static REFUSED: AtomicBool = AtomicBool::new(false);

/// Requests under way: while there is one, a reserve that was given up is not taken anew.
static UNDER_WAY: AtomicUsize = AtomicUsize::new(0);

/// True from when the system refused memory until a request finds it there again.
#[inline]
pub(crate) fn refused() -> bool {
    REFUSED.load(Ordering::Relaxed) && still_refused()
}

/// Work outside of requests sees to the reserve when it asks.
#[cold]
fn still_refused() -> bool {
    if UNDER_WAY.load(Ordering::Relaxed) == 0 {
        reserve();
    }
    REFUSED.load(Ordering::Relaxed)
}

/// A request begins; the first of those at one time sees to the reserve.
pub(crate) fn enter() {
    if UNDER_WAY.fetch_add(1, Ordering::Relaxed) == 0 {
        reserve();
    }
}

/// A request ends.
pub(crate) fn leave() {
    UNDER_WAY.fetch_sub(1, Ordering::Relaxed);
}

/// Takes the reserve, where there is none, through the program's allocator; without one that counts it would be no use.
fn reserve() {
    // In a page address space is memory, and the page's own engine is the process that may end.
    if cfg!(target_family = "wasm") || !KEPT_BACK.load(Ordering::Acquire).is_null() {
        return;
    }
    if INSTALLED.load(Ordering::Relaxed) {
        // SAFETY: the size is not zero; the block is freed with the same layout.
        let block = unsafe { std::alloc::alloc(RESERVED) };
        if block.is_null() {
            return;
        }
        // It is nobody's memory yet.
        count(-(RESERVE as i64));
        if KEPT_BACK
            .compare_exchange(null_mut(), block, Ordering::AcqRel, Ordering::Acquire)
            .is_err()
        {
            count(RESERVE as i64);
            // SAFETY: it was allocated above.
            unsafe { std::alloc::dealloc(block, RESERVED) };
        }
    }
    REFUSED.store(false, Ordering::Relaxed);
}

/// Whether the program's allocator is one of ours: set with the first bytes that are added to the sum.
static INSTALLED: AtomicBool = AtomicBool::new(false);

/// An allocator with its bytes counted: the system's, or in tests one that refuses.
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
    /// Another one.
    pub const fn over(inner: A) -> Self {
        Self(inner)
    }

    /// What to do about a block that was refused: asked for once more when the reserve is given up.
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
            // Another thread gives it up: until it has, the system would refuse again.
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

    /// A block of that size, which is so much more than before.
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

// SAFETY: every call is the inner allocator's with the same arguments; counting neither allocates nor panics.
unsafe impl<A: GlobalAlloc> GlobalAlloc for Counting<A> {
    #[inline]
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller keeps the contract of `GlobalAlloc`.
        self.counted(layout.size(), layout.size() as i64, || unsafe { self.0.alloc(layout) })
    }

    #[inline]
    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as above.
        self.counted(layout.size(), layout.size() as i64, || unsafe { self.0.alloc_zeroed(layout) })
    }

    #[inline]
    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { self.0.dealloc(block, layout) };
        count(-(layout.size() as i64));
    }

    #[inline]
    unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: as above; a block that cannot be moved stays as it is.
        let more = size as i64 - layout.size() as i64;
        self.counted(size, more, || unsafe { self.0.realloc(block, layout, size) })
    }
}
