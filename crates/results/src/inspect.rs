//! What an inspection finds of log files.

mod known;
mod parts;

pub use known::{Content, Known, Note, PoseFault, about_gravity};
pub use parts::{
    Comment, CounterRestarts, Flight, Inspection, Line, Measured, Model, Motion, Part, Start,
    Wheels, pose_notes, pose_piece,
};
