//! Stopping a long computation from outside: Ctrl-C in an interpreter that has called it.
//!
//! A caller that runs computations on threads of its own lets each thread [`heed`] a flag. Long loops call [`check`],
//! which unwinds with [`Stopped`] once the flag is set; on threads that heed none it does nothing.

use std::{
    cell::RefCell,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
};

thread_local! {
    static FLAG: RefCell<Option<Arc<AtomicBool>>> = const { RefCell::new(None) };
}

/// What a stopped computation unwinds with.
#[derive(Clone, Copy, Debug)]
pub struct Stopped;

/// From now on the computations of this thread stop once `flag` is set.
pub fn heed(flag: Arc<AtomicBool>) {
    FLAG.set(Some(flag));
}

/// Unwinds with [`Stopped`] if this thread heeds a flag that is set.
#[inline]
pub fn check() {
    let asked = FLAG.with_borrow(|flag| {
        let flag = flag.as_ref();
        flag.is_some_and(|flag| flag.load(Ordering::Relaxed))
    });
    if asked {
        // No message of a panic: nothing is wrong.
        std::panic::resume_unwind(Box::new(Stopped));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thread_stops_by_its_own_flag_only() {
        let flag = Arc::new(AtomicBool::new(false));
        let of_thread = Arc::clone(&flag);
        let stopped = std::thread::spawn(move || {
            heed(Arc::clone(&of_thread));
            check();
            of_thread.store(true, Ordering::Relaxed);
            check();
        })
        .join();
        assert!(stopped.unwrap_err().is::<Stopped>());
        check();
    }
}
