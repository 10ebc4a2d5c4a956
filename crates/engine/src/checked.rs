//! A sample between the checks of the sensor and the filter.

use undrift_nav::{Matrix3, sample::ImuSample};

/// A sample as the filter is to have it.
#[derive(Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Checked {
    pub(crate) sample: ImuSample,
    /// Covariances of the turn \[rad²\] and of the change of velocity \[m²/s²\] in it that are in doubt, body axes.
    pub(crate) doubt: Option<[Matrix3; 2]>,
}
