//! The command as a user runs it: what it says, how it ends, what it leaves behind.

mod bad_input;
mod fleet;
mod identify;
mod inspect;
mod mistakes;
mod model;
mod raw_logs;
mod readme;
mod schema;
mod terminal;
