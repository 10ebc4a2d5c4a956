//! The demo: what was identified, and what the outages did.

use super::{Identify, Outages};
use serde::{Deserialize, Serialize};

/// The demo.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, tag = "kind", rename = "demo")]
pub struct Demo {
    /// Version of the program.
    pub undrift: String,
    /// Version of this schema.
    pub schema: u32,
    /// Seed of the drive, the sensors and the receiver.
    pub seed: u64,
    /// What was identified of the static record, unless the models are the simulation's own.
    pub identification: Option<Identify>,
    /// What the outages did.
    pub outages: Outages,
    /// What is to be known of the models.
    pub note: String,
}
