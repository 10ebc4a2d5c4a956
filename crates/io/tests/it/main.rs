//! Readers and writers on golden, damaged and public files.

mod carrier;
mod dates;
mod hostile;
mod properties;
#[path = "../../../../tools/public_data.rs"]
mod public;
mod public_data;
mod rinex;
mod round_trip;
mod written;
