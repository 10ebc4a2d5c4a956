//! What a navigator says of a solution beside its states, as values: [events](Event), [start](Alignment) and [`Mounting`], sums of
//! [`Innovations`], agreement with the fixes by [windows](Windows), errors that the [fixes](FixErrors) have shown, and the names
//! by which [measurements](Aid) and [logs](Log) go. The engine makes them; results hold them and a report words them, and need no
//! engine for that.
//!
//! SI units and radians, north-east-down, forward-right-down (docs/conventions.md). `no_std`.
#![no_std]

extern crate alloc;
#[cfg(test)]
extern crate std;

mod aid;
mod events;
pub mod fix_errors;
mod fixes;
mod innovations;
mod start;
mod windows;

pub use aid::{Aid, Log, ScalarLog};
pub use events::{
    ChangeOf, Contradiction, CovarianceHealth, DisturbedField, Doubt, Event, FixMend, HeadingOff,
    Implausible, Lean, Mismatch, Part, RejectedHeadings, Restart, RestartCause, SampleFault,
    SensorChange,
};
pub use fix_errors::FixErrors;
pub use fixes::{GnssUse, Outage, STAMP_ROUNDING};
pub use innovations::Innovations;
pub use start::{Alignment, AttitudeSource, HeadingSource, Mounting};
pub use windows::{Agreement, Disagreement, Window, WindowPart, Windows};
