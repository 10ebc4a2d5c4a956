//! What an inspection finds of log files; who shows it makes the sentences.

mod known;
mod parts;

pub use known::{Content, Known, Note, about_gravity};
pub use parts::{CounterRestarts, Inspection, Line, Measured, Motion, Part, Start, quoted};
