//! The navigator while the vehicle drives: bytes of sources in, a solution out.
//!
//! ```text
//! sources (serial, TCP, …) ─► arrivals ─► session ─► rows and notices ─► outputs, page
//! recording, replay ────────┘   └─► recording
//! ```
//!
//! An [`Arrival`] is what came from a source and when. A [`Session`] makes of each arrival samples and measurements, by the readers
//! of logs, and pushes them into [`undrift_engine::Navigator`]. What it gives depends on the arrivals alone, on their order,
//! bytes and times, and on nothing else: neither on threads nor on the machine's clock. So a recording of the arrivals, fed
//! to a session of the same drive file, gives the same solution to the last bit.

pub mod foxglove;
pub mod output;
pub mod page;
pub mod plan;
pub mod replay;
pub mod session;
pub mod source;
pub mod state;
pub mod view;

mod clocks;
mod keys;
mod stream;

pub use session::{Notice, Session, SessionError, Sink};
pub use source::{Source, SourceError, Sources};
pub use undrift_io::recording::Arrived as Arrival;

/// Nanoseconds of a second.
const NANOS: f64 = 1e9;

/// A time of arrival in seconds.
fn seconds(at: u64) -> f64 {
    at as f64 / NANOS
}
