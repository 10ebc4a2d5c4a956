//! Which part of a recording was used.

use crate::Number;
use serde::{Deserialize, Serialize};

/// The part of a recording that was used, where that is not all of it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Used {
    /// Name of the recording.
    pub record: String,
    /// Where the part begins, after the first sample \[s\].
    pub start_s: Number,
    /// Where it ends \[s\].
    pub end_s: Number,
    /// Length of the recording \[s\].
    pub length_s: Number,
    /// What was left out, in order.
    pub left_out: Vec<Omitted>,
}

/// A part of a recording that was left out.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Omitted {
    /// Why.
    pub why: Omission,
    /// Where it begins, after the first sample of the recording \[s\].
    pub start_s: Number,
    /// Where it ends \[s\].
    pub end_s: Number,
    /// The axis that steps, warms up or has a cycle.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub axis: Option<String>,
    /// By how much it steps, drifts in this part, or swings to either side \[unit\].
    pub step: Number,
    /// Time constant of a warm-up, period of a cycle \[s\].
    pub time_s: Number,
}

/// Why a part of a recording is left out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Omission {
    /// The sensor was handled, at the start or end of the recording.
    #[default]
    Handled,
    /// It was knocked, for some seconds amid the recording.
    Bump,
    /// Beyond a step of an axis: it was re-zeroed, or tilted.
    Step,
    /// Another session, before or after a long gap or time stamps that restart.
    Session,
    /// An axis drifts as a sensor that warms up.
    WarmUp,
    /// What is left of a warm-up in the part that is used: subtracted from the samples.
    WarmUpRest,
    /// A slow cycle of an axis, as of a room's temperature: subtracted from the samples.
    Cycle,
}

impl Omission {
    /// Whether the samples are used, less what is said.
    pub fn is_subtracted(self) -> bool {
        matches!(self, Self::WarmUpRest | Self::Cycle)
    }
}

impl Used {
    /// Whether what is left out speaks against the rest: all but handling at the start or end.
    pub fn is_doubtful(&self) -> bool {
        self.left_out.iter().any(|one| one.why != Omission::Handled)
    }
}
