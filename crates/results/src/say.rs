//! What has a sentence. The values are here and in the crates below; their text is made in one place, `undrift_report::sentence`.

use crate::{demo::Demo, findings::Finding};
use undrift_events::{Alignment, Mounting};
use undrift_noise::{
    compared::Unfit,
    drift_score::Reason,
    identify::{FitRemark, RecordRemark},
    stationarity::Verdict,
};

/// Something found that has a sentence.
#[derive(Clone, Copy, Debug)]
pub enum Statement<'a> {
    /// Of logs and solutions.
    Finding(&'a Finding),
    /// How the first attitude was found.
    Alignment(&'a Alignment),
    /// How the IMU sits in the vehicle.
    Mounting {
        /// The estimate.
        mounting: &'a Mounting,
        /// Since when the solution is in the vehicle's axes \[s\], where it was found on the way.
        since: Option<f64>,
    },
    /// Of a static recording.
    Record(&'a RecordRemark),
    /// Of a model fitted to it.
    Fit(&'a FitRemark),
    /// Why a method has no model of it.
    NotFitted(&'a Unfit),
    /// Why a model is recommended.
    Recommended(&'a Reason),
    /// Whether the recording is stationary.
    Stationarity(&'a Verdict),
    /// How much less the recommended model of the demo drifts.
    Demo(&'a Demo),
}

/// What makes sentences: a result has them when it is returned.
pub type Say<'a> = &'a (dyn Fn(Statement<'_>) -> String + Sync);
