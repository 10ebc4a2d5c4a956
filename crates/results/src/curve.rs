//! What results share for plots.

use super::Number;
use serde::{Deserialize, Serialize};

/// Values over time.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Curve {
    /// Times \[s\].
    pub time_s: Vec<Number>,
    /// Values, in the unit of the curve's name.
    pub value: Vec<Number>,
}

/// A ground track.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Track {
    /// Times \[s\].
    pub time_s: Vec<Number>,
    /// Latitudes \[deg\].
    pub lat_deg: Vec<Number>,
    /// Longitudes \[deg\].
    pub lon_deg: Vec<Number>,
    /// Heights above the ellipsoid \[m\].
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub height_m: Vec<Number>,
}
