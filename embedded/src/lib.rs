//! One minute of a simulated drive through the filter, on a microcontroller and on the machine that
//! built it: both run this library, and `tools/bare-metal` compares what they print.
#![cfg_attr(not(test), no_std)]

#[cfg(target_os = "none")]
pub mod metal;
pub mod minimal;
pub mod models;
pub mod record;
pub mod run;

/// The recorded minute; crates/undrift/examples/embedded_minute.rs made it.
pub static MINUTE: &[u8] = include_bytes!("../../testdata/golden/embedded/minute.bin");
