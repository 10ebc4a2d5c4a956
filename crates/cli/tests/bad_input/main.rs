//! The command on damaged logs and wrong settings: what it says, how it ends, what it leaves behind.

mod configuration;
mod drives;
mod log;
mod logs;
mod montecarlo;
mod reports;
mod scalars;
mod schedule;
mod solutions;
