//! Readers and writers on golden, damaged and public files.

mod dates;
mod hostile;
mod properties;
mod public_data;
mod round_trip;
mod written;
