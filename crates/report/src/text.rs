//! Results as plain text: the tables of a terminal, and CSV.

mod identify;
mod navigate;

pub use crate::{
    demo::plain as demo,
    fleet::plain as fleet,
    montecarlo::plain as montecarlo,
    outages::plain as outages,
    paper::plain as paper,
    plain::{Mark, unmarked},
    tune::plain as tune,
};
pub use identify::{correlation_csv, identify};
pub use navigate::navigate;

#[cfg(test)]
mod tests;
