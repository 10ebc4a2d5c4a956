//! Which part of a recording was used.

use crate::results::Number;
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
    /// Beyond a step, the axis that steps.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub axis: Option<String>,
    /// By how much \[unit\].
    pub step: Number,
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
}

impl Used {
    /// Whether what is left out speaks against the rest: all but handling at the start or end.
    pub fn is_doubtful(&self) -> bool {
        self.left_out.iter().any(|one| one.why != Omission::Handled)
    }
}
