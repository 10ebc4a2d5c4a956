//! Results as plain text: the tables of a terminal, and CSV.

mod identify;
mod navigate;

pub use crate::{
    fleet::plain as fleet,
    montecarlo::plain as montecarlo,
    outages::plain as outages,
    plain::{Mark, unmarked},
    tune::plain as tune,
};
pub(crate) use identify::bounds;
pub use identify::{correlation_csv, identification, identify};
pub use navigate::navigate;
