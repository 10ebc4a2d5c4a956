//! The command on damaged logs and wrong settings: what it says, how it ends, what it leaves behind.

mod configuration;
mod killed;
mod log;
mod logs;
mod long;
mod montecarlo;
mod repeated;
mod reports;
mod scalars;
mod schedule;
mod solutions;
