//! An allocator that counts what a test and its threads ask for.
#![allow(dead_code, reason = "one test binary uses it")]
#![allow(unsafe_code, reason = "a global allocator")]

use std::alloc::{GlobalAlloc, Layout, System as Heap};
use std::cell::Cell;
use std::sync::atomic::{AtomicBool, AtomicIsize, AtomicUsize, Ordering};

/// Counts what the test and the threads that it starts ask for, whatever the harness does in its own thread meanwhile.
pub(crate) struct Counting;

/// Whether the test has begun, so that threads from now on are its own.
pub(crate) static BEGUN: AtomicBool = AtomicBool::new(false);

thread_local! {
    /// Whether this thread is one of the test, once it has asked for memory.
    pub(crate) static IS_OURS: Cell<Option<bool>> = const { Cell::new(None) };
}

fn is_ours() -> bool {
    let known = |place: &Cell<Option<bool>>| {
        let is_ours = place.get().unwrap_or_else(|| BEGUN.load(Ordering::SeqCst));
        place.set(Some(is_ours));
        is_ours
    };
    IS_OURS.try_with(known).unwrap_or(true)
}

fn count(asked: usize, bytes: isize) {
    if is_ours() {
        ASKED.fetch_add(asked, Ordering::Relaxed);
        took(bytes);
    }
}

pub(crate) static ASKED: AtomicUsize = AtomicUsize::new(0);

/// Bytes that are in use.
pub(crate) static KEPT: AtomicIsize = AtomicIsize::new(0);

/// Most bytes that were in use.
pub(crate) static MOST: AtomicIsize = AtomicIsize::new(0);

/// More bytes are in use.
fn took(bytes: isize) {
    let now = KEPT.fetch_add(bytes, Ordering::Relaxed) + bytes;
    MOST.fetch_max(now, Ordering::Relaxed);
}

// SAFETY: every call goes to the allocator of the system with unchanged arguments.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(1, layout.size().cast_signed());
        // SAFETY: as asked of this function.
        unsafe { Heap.alloc(layout) }
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        count(0, -layout.size().cast_signed());
        // SAFETY: as asked of this function; the memory came from `Heap`.
        unsafe { Heap.dealloc(memory, layout) }
    }

    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count(1, size.cast_signed() - layout.size().cast_signed());
        // SAFETY: as asked of this function; the memory came from `Heap`.
        unsafe { Heap.realloc(memory, layout, size) }
    }
}
