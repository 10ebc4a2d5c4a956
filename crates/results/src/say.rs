//! What has a sentence, of those that crates above and below have to say: its text is made in one place, `undrift_report::say`.

use crate::findings::Finding;
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
}

/// What makes sentences.
pub type Say<'a> = &'a (dyn Fn(Statement<'_>) -> String + Sync);
