//! The engine on simulated and public drives, and which crate may use which.

mod alignment;
mod architecture;
mod arrivals;
mod assertions;
mod carrier;
mod circles;
mod epochs;
mod faults;
mod fix_study;
mod in_memory;
mod mechanisation;
mod montecarlo;
mod prose;
#[path = "../../../../tools/public_data.rs"]
mod public;
mod public_drives;
mod pull_away;
mod references;
mod rest;
mod shaping_forms;
#[path = "../../../observables/tests/it/sky.rs"]
mod sky;
mod smoothed_errors;
mod smoothing;
mod streams;
mod temperature;
mod tune;
mod vehicle_drives;
