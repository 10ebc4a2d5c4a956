//! Results as plain text: the tables of a terminal, and CSV.

mod identify;
mod outages;

pub use identify::{correlation_csv, normality, pandit_wu, recommended};
pub use outages::outage_table;
