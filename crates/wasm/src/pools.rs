//! Small blocks by size: a model's move takes and gives back thousands of them, and a list of free blocks for each
//! size answers in a few instructions. Greater blocks are the system's.
//!
//! Blocks are returned to their list and never to the system, so small ones keep their maximum
//! memory.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::UnsafeCell;
use std::ptr::null_mut;

/// Sizes are rounded up to multiples of this, which is also the alignment.
const STEP: usize = 16;
/// The greatest small block.
const SMALL: usize = 1024;
/// Bytes taken from the system at a time.
const CHUNK: usize = 64 << 10;

struct Lists {
    /// The first free block of each size; each begins with the address of the next.
    free: [*mut u8; SMALL / STEP],
    /// Rest of the last chunk.
    rest: *mut u8,
    left: usize,
}

/// The allocator.
pub struct Pools(UnsafeCell<Lists>);

// SAFETY: the engine has one thread; a page's worker with shared memory is another target.
unsafe impl Sync for Pools {}

/// The list of a block; `None` for a large one.
fn list_of(layout: Layout) -> Option<usize> {
    let small = layout.size() <= SMALL && layout.align() <= STEP;
    small.then(|| layout.size().saturating_sub(1) / STEP)
}

impl Pools {
    /// With nothing in its lists.
    pub const fn new() -> Self {
        Self(UnsafeCell::new(Lists { free: [null_mut(); SMALL / STEP], rest: null_mut(), left: 0 }))
    }
}

impl Lists {
    unsafe fn take(&mut self, list: usize) -> *mut u8 {
        let block = self.free[list];
        if block.is_null() {
            // SAFETY: as below.
            return unsafe { self.carve(list) };
        }
        // SAFETY: a free block begins with the address of the next.
        self.free[list] = unsafe { block.cast::<*mut u8>().read() };
        block
    }

    unsafe fn give(&mut self, list: usize, block: *mut u8) {
        // SAFETY: the block is nobody's, at least of 16 bytes and aligned to them.
        unsafe { block.cast::<*mut u8>().write(self.free[list]) };
        self.free[list] = block;
    }

    #[cold]
    unsafe fn carve(&mut self, list: usize) -> *mut u8 {
        let size = (list + 1) * STEP;
        if self.left < size {
            if self.left > 0 {
                // SAFETY: the rest is a multiple of 16 bytes, less than a small block's size.
                unsafe { self.give(self.left / STEP - 1, self.rest) };
                self.left = 0;
            }
            // SAFETY: neither size nor alignment is zero.
            let chunk = unsafe { System.alloc(Layout::from_size_align_unchecked(CHUNK, STEP)) };
            if chunk.is_null() {
                return chunk;
            }
            (self.rest, self.left) = (chunk, CHUNK);
        }
        let block = self.rest;
        // SAFETY: within the chunk.
        self.rest = unsafe { block.add(size) };
        self.left -= size;
        block
    }
}

// SAFETY: a block of a list has its size and alignment and one owner; others are the system's.
unsafe impl GlobalAlloc for Pools {
    #[inline]
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        match list_of(layout) {
            // SAFETY: no other thread, and nothing in between.
            Some(list) => unsafe { (*self.0.get()).take(list) },
            // SAFETY: the caller keeps the contract.
            None => unsafe { System.alloc(layout) },
        }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        if list_of(layout).is_none() {
            // SAFETY: the caller keeps the contract.
            return unsafe { System.alloc_zeroed(layout) };
        }
        // SAFETY: as above; the block has at least that size.
        unsafe {
            let block = self.alloc(layout);
            if !block.is_null() {
                block.write_bytes(0, layout.size());
            }
            block
        }
    }

    #[inline]
    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        match list_of(layout) {
            // SAFETY: it is of this list, and nobody's from now on.
            Some(list) => unsafe { (*self.0.get()).give(list, block) },
            // SAFETY: the caller keeps the contract.
            None => unsafe { System.dealloc(block, layout) },
        }
    }

    unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: the caller keeps the contract: the size is not zero and fits.
        let new = unsafe { Layout::from_size_align_unchecked(size, layout.align()) };
        match (list_of(layout), list_of(new)) {
            (Some(a), Some(b)) if a == b => block,
            // SAFETY: both are the system's.
            (None, None) => unsafe { System.realloc(block, layout, size) },
            // SAFETY: as many bytes as both have.
            _ => unsafe {
                let other = self.alloc(new);
                if !other.is_null() {
                    other.copy_from_nonoverlapping(block, layout.size().min(size));
                    self.dealloc(block, layout);
                }
                other
            },
        }
    }
}
