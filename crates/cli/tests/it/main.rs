//! The command as a user runs it: what it says, how it ends, what it leaves behind.

mod bad_input;
mod documents;
mod exit_codes;
mod fleet;
mod identify;
mod inspect;
#[cfg(unix)]
mod live;
mod mistakes;
mod model;
mod poses;
#[path = "../../../../tools/public_data.rs"]
mod public;
mod raw_logs;
mod repository;
mod schema;
mod terminal;
