//! Experiments on simulated drives, where the truth is known: the [`demo`] with the source paper's scenario, the average
//! over many draws of the noise ([`montecarlo`]), and a simulated drive as the files of a log.

pub mod demo;
pub mod montecarlo;
pub mod simulated_log;

pub use simulated_log::SimulatedLog;
