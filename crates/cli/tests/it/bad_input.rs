//! The command on damaged logs and wrong settings: what it says, how it ends, what it leaves behind.

mod configuration;
mod dates;
pub mod drives;
mod files;
mod fixes;
mod headings;
mod hidden;
mod killed;
pub mod log;
mod logs;
mod long;
mod models;
mod montecarlo;
mod places;
mod recordings;
mod reliability;
mod repeated;
mod reports;
mod scalars;
mod schedule;
mod sensors;
mod sizes;
mod solutions;
mod stamps;
