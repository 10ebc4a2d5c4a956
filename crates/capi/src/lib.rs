//! The error-state filter behind a C header, `include/undrift.h`: no allocation, no standard library. With feature `navigator` also
//! the navigator around it, in memory of the caller's allocator (module `navigator`).
//!
//! The caller gives the memory of a filter ([`filter::undrift_filter_init`]); all else passes by pointers
//! to plain structs, which are copied. Units, frames and signs are those of `docs/conventions.md`:
//! SI and radians, north-east-down, body axes forward-right-down.
//!
//! What C has to promise: a pointer is null or points to as much memory as its type or length says,
//! valid for the call; a filter is used by one thread at a time. All else is checked: null pointers,
//! numbers that are not finite, sizes and alignment give a [`status::Status`], and the filter is then as
//! it was unless the status says otherwise.
//!
//! The most states a filter holds is fixed when this crate is built, by `UNDRIFT_MAX_STATES` in the
//! environment, 33 by default.
#![no_std]

// On a host the standard library brings what a static library needs: a panic handler.
#[cfg(not(target_os = "none"))]
extern crate std;

#[cfg(feature = "navigator")]
extern crate alloc;

#[cfg(feature = "navigator")]
pub mod allocator;
mod capacity;
pub mod filter;
mod memory;
#[cfg(feature = "navigator")]
pub mod navigator;
pub mod read;
pub mod sensor;
pub mod status;
pub mod types;
pub mod update;

#[cfg(test)]
mod tests;

#[cfg(all(target_os = "none", feature = "panic-handler"))]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    loop {}
}
