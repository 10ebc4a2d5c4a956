//! What the outages did to the models.

use crate::{
    findings::Finding,
    reference::{Coverage, Errors},
    replay::{ReplayError, Summary},
};

/// Errors of one model in one outage.
#[derive(Clone, Debug)]
pub struct OutageErrors {
    /// Start in the log's time base \[s\].
    pub start_s: f64,
    /// Largest magnitude inside the outage, in the units of [`Errors`].
    pub max: Errors,
    /// Error at its end.
    pub end: Errors,
    /// Predicted standard deviations at its end.
    pub sigma: Errors,
    /// Normalised error squared at its end per degree of freedom, of [`crate::reference::GROUPS`].
    pub nees: [f64; 3],
    /// How many of its errors the predicted standard deviations cover.
    pub covered: Coverage,
    /// Horizontal error against time since the outage began: pairs of \[s\] and \[m\], at most about ten a second.
    pub drift: Vec<(f64, f64)>,
    /// The solution at the same instants: time \[s\], latitude and longitude \[rad\].
    pub way: Vec<[f64; 3]>,
}

/// Errors of one model over all outages.
#[derive(Clone, Debug)]
pub struct ModelErrors {
    /// Largest magnitude over all samples inside the outages.
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
    /// Outages that are in none of these: they began before the solution.
    pub left_out: usize,
    /// Outage by outage.
    pub per_outage: Vec<OutageErrors>,
    /// Set when the numbers cannot be trusted, and why.
    pub finding: Option<Finding>,
}

/// The errors of one bias model in the outages, and its replay.
#[derive(Debug)]
pub struct ModelRun {
    /// Name of the bias model.
    pub name: String,
    /// The outcome.
    pub errors: ModelErrors,
    /// Counts and innovations of the replay.
    pub summary: Summary,
}

/// A model's name, and its run or the error that ended it.
pub type ModelOutcome = (String, Result<ModelRun, ReplayError>);
