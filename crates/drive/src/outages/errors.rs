//! Errors of the models in the outages.

use crate::{
    findings::Finding,
    reference::{Coverage, Errors},
    replay::{ReplayError, Summary},
};

/// Errors of one model in one outage.
#[derive(Clone, Debug)]
pub struct OutageErrors {
    /// Start of the outage in the log's time base \[s\].
    pub start_s: f64,
    /// Largest magnitude of each component inside the outage [m, m/s, deg].
    pub max: Errors,
    /// Error at the outage's end.
    pub end: Errors,
    /// Predicted standard deviations at the outage's end.
    pub sigma: Errors,
    /// Normalised error squared at the outage's end per degree of freedom, of [`crate::reference::GROUPS`]: about 1 on the average of many
    /// outages where the covariance is right.
    pub nees: [f64; 3],
    /// Shares of its errors inside one, two and three predicted standard deviations.
    pub covered: Coverage,
    /// Horizontal error against time since the outage began: pairs of \[s\] and \[m\], at most about ten a second.
    pub drift: Vec<(f64, f64)>,
    /// The solution at the same instants: time \[s\], latitude and longitude \[rad\].
    pub way: Vec<[f64; 3]>,
}

/// Errors of one model over all outages: the numbers of the source paper's Table 4 and more.
#[derive(Clone, Debug)]
pub struct ModelErrors {
    /// Largest magnitude of each component over all samples inside the outages: the paper's figure.
    pub max: Errors,
    /// RMS over the outages of the largest error of each.
    pub rms: Errors,
    /// Median over the outages of the largest error of each.
    pub median: Errors,
    /// RMS over the outages of the error at the end.
    pub end_rms: Errors,
    /// Mean over the outages of the normalised error squared at the end per degree of freedom, of
    /// [`crate::reference::GROUPS`].
    pub nees: [f64; 3],
    /// How many errors inside the outages the predicted standard deviations cover.
    pub coverage: Coverage,
    /// Number of outages that are in none of these: they began before the solution.
    pub left_out: usize,
    /// Errors outage by outage, in order of time.
    pub per_outage: Vec<OutageErrors>,
    /// Reason why the numbers cannot be trusted, where there is one.
    pub finding: Option<Finding>,
}

/// The errors of one bias model in the outages, and its replay.
#[derive(Debug)]
pub struct ModelRun {
    /// Name of the bias model.
    pub name: String,
    /// Its errors in the outages.
    pub errors: ModelErrors,
    /// Counts and innovations of the replay.
    pub summary: Summary,
}

/// A model's name, and its run or the error that ended it.
pub type ModelOutcome = (String, Result<ModelRun, ReplayError>);
