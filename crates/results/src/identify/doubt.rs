//! Whether a static recording can be used, and why not.

use super::{Axis, Identify, Used};
use crate::usability::Usability;
use undrift_noise::screening::{RecordError, rounding::MOSTLY_SHOWN};

/// Why an axis is not to be trusted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum AxisDoubt {
    /// It has one value from end to end.
    Constant,
    /// It has no model, for this reason.
    Failed(String),
    /// The sensor moved.
    Moving,
    /// It reads the end of its range.
    Saturated,
    /// The sensor repeats a value.
    Frozen,
    /// Steps of the samples hide most of the noise.
    Rounded,
    /// They are larger than the noise, and nothing but them shows how large it is.
    Coarse,
}

impl Axis {
    /// Why it is not to be trusted, the first reason that holds.
    pub fn doubt(&self) -> Option<AxisDoubt> {
        Some(match &self.error {
            Some(error) if *error == RecordError::Constant.to_string() => AxisDoubt::Constant,
            Some(error) => AxisDoubt::Failed(error.clone()),
            None if self.moving == Some(true) => AxisDoubt::Moving,
            None if !self.saturation.is_empty() => AxisDoubt::Saturated,
            None if !self.hanging.is_empty() => AxisDoubt::Frozen,
            None if self.noise_shown.is_some_and(|share| share.0 < MOSTLY_SHOWN) => {
                AxisDoubt::Rounded
            }
            None if self.noise_shown.is_some() => AxisDoubt::Coarse,
            None => return None,
        })
    }
}

impl Identify {
    /// The axes that are not to be trusted, in the order of a sensor.
    pub fn doubts(&self) -> Vec<(&str, AxisDoubt)> {
        self.in_order()
            .filter_map(|(name, axis)| Some((name, axis.doubt()?)))
            .collect()
    }

    /// Not usable without any axis; with care where one is doubted, where the range of raw counts is a guess, where more of a recording was excluded than its
    /// handling at the start or end, or where recordings are not of one sensor.
    pub fn verdict(&self) -> Usability {
        let of_one_sensor = self.pool.as_ref().is_none_or(|pool| pool.homogeneous);
        if self.axes.values().all(|axis| axis.error.is_some()) {
            Usability::NotUsable
        } else if of_one_sensor
            && self.doubts().is_empty()
            && self.guessed_units.is_none()
            && !self.used.iter().any(Used::is_doubtful)
        {
            Usability::Usable
        } else {
            Usability::WithCare
        }
    }
}
