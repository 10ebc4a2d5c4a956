//! The memory of navigators: what the caller's allocator gives, and no other.

use crate::status::{Status, call};
use core::{
    alloc::{GlobalAlloc, Layout},
    ffi::c_void,
    ptr::null_mut,
    sync::atomic::{AtomicPtr, AtomicUsize, Ordering},
};

/// Where the memory of navigators comes from.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Allocator {
    /// Passed to both functions.
    pub context: *mut c_void,
    /// Allocates `size` bytes with the alignment `align`, a power of two of at most 16. Null where memory is exhausted: the program aborts.
    pub allocate: Option<
        unsafe extern "C" fn(context: *mut c_void, size: usize, align: usize) -> *mut c_void,
    >,
    /// Frees what `allocate` returned for this size.
    pub release:
        Option<unsafe extern "C" fn(context: *mut c_void, memory: *mut c_void, size: usize)>,
}

/// The caller's; null until it is set.
static ALLOCATOR: AtomicPtr<Allocator> = AtomicPtr::new(null_mut());
/// Navigators that there are.
static NAVIGATORS: AtomicUsize = AtomicUsize::new(0);

/// Counts navigators by `change`: 1, or −1 as a wrapping number.
pub(crate) fn count(change: usize) {
    NAVIGATORS.fetch_add(change, Ordering::AcqRel);
}

/// Whether there is an allocator.
pub(crate) fn is_set() -> bool {
    !ALLOCATOR.load(Ordering::Acquire).is_null()
}

/// The caller's allocator, if it is set.
fn callers() -> Option<Allocator> {
    // SAFETY: null, or it points to an allocator as long as there are navigators.
    unsafe { ALLOCATOR.load(Ordering::Acquire).as_ref() }.copied()
}

/// Sets where the memory of navigators comes from, before the first of them: all of it is asked for there, none elsewhere.
/// `allocator` stays where it is as long as there are navigators. UNDRIFT_STATUS_IN_USE while there are some.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn undrift_set_allocator(allocator: *const Allocator) -> Status {
    call(|| {
        if allocator.is_null() {
            return Err(Status::NullPointer);
        }
        if !allocator.is_aligned() {
            return Err(Status::Misaligned);
        }
        // SAFETY: aligned and not null, so it points to an allocator.
        let Allocator {
            allocate, release, ..
        } = unsafe { allocator.read() };
        if allocate.is_none() || release.is_none() {
            return Err(Status::NullPointer);
        }
        if NAVIGATORS.load(Ordering::Acquire) != 0 {
            return Err(Status::InUse);
        }
        ALLOCATOR.store(allocator.cast_mut(), Ordering::Release);
        Ok(())
    })
}

/// The caller's allocator as that of Rust.
pub(crate) struct Callers;

// In the tests of this crate the memory is that of the system.
#[cfg(not(test))]
#[global_allocator]
static GLOBAL: Callers = Callers;

// SAFETY: what is given out comes from the caller's allocator, which gives what it is asked for or null.
unsafe impl GlobalAlloc for Callers {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let Some(Allocator {
            context,
            allocate: Some(allocate),
            ..
        }) = callers()
        else {
            return null_mut();
        };
        // SAFETY: the caller's own function, with its context.
        unsafe { allocate(context, layout.size(), layout.align()) }.cast()
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        if let Some(Allocator {
            context,
            release: Some(release),
            ..
        }) = callers()
        {
            // SAFETY: memory that it returned for this size.
            unsafe { release(context, memory.cast(), layout.size()) };
        }
    }
}
