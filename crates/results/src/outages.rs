//! What GNSS outages do.

use super::{
    Drive, Number, Numbers, Track,
    known::{known_finding, known_findings},
};
use crate::findings::{Finding, WhyLeftOut};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use undrift_events::Outage;

/// An experiment with outages.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, tag = "kind", rename = "outages")]
pub struct Outages {
    /// Version of the program.
    pub undrift: String,
    /// Version of this schema.
    pub schema: u32,
    /// What was navigated.
    pub drive: Drive,
    /// Where GNSS was cut.
    pub outages: Vec<Cut>,
    /// Outages that were asked for and are not among them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub left_out: Vec<LeftOutCut>,
    /// Positions withheld by the outages, where they are the reference.
    pub withheld: u64,
    /// Those of them that the run without outages rejects: they are no reference.
    pub rejected: u64,
    /// Names of the models that were run, in their order.
    pub order: Vec<String>,
    /// Where noise models were compared: the noise model of each name. Else the models are bias models of the drive's.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub noise_models: BTreeMap<String, NoiseModelRun>,
    /// What the outages did to each of them.
    pub models: BTreeMap<String, ModelErrors>,
    /// The last of `order` without one kind of measurement beside GNSS at a time, by the kind, where that was run.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub without: BTreeMap<String, ModelErrors>,
    /// The models that could not be run, and why.
    pub failed: BTreeMap<String, String>,
    /// "truth", or "gnss" where the withheld fixes are the reference.
    pub reference: String,
    /// Whether the errors are those of the smoothed solutions.
    pub smooth: bool,
    /// Whether the solutions know more of the log than what came before: else they are those of a run while driving.
    pub look_ahead: bool,
    /// Normalised innovations squared of each model per degree of freedom.
    pub nis_per_dof: BTreeMap<String, NisOfParts>,
    /// What was found out about the logs.
    #[serde(deserialize_with = "known_findings")]
    pub findings: Vec<Finding>,
    /// The same in sentences.
    pub warnings: Vec<String>,
    /// For plots.
    pub series: OutageSeries,
}

/// A noise model in an experiment with outages.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct NoiseModelRun {
    /// Name that its file has for it.
    pub model: String,
    /// The bias model that it was run as.
    pub bias_model: String,
}

/// One outage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Cut {
    /// Start \[s\].
    pub start_s: Number,
    /// Length \[s\].
    pub length_s: Number,
}

/// An outage that was left out.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LeftOutCut {
    /// Start \[s\].
    pub start_s: Number,
    /// Length \[s\].
    pub length_s: Number,
    /// Why.
    pub why: WhyLeftOut,
}

/// What the outages did to one model; errors by component with their units.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct ModelErrors {
    /// Largest magnitude over all samples inside the outages.
    pub max: Numbers,
    /// RMS over the outages of the largest error of each.
    pub rms: Numbers,
    /// Median over the outages of the largest error of each.
    pub median: Numbers,
    /// RMS over the outages of the error at the end.
    pub end_rms: Numbers,
    /// Mean over the outages of the normalised error squared at the end per degree of freedom, 1 when the
    /// covariance is right: of position, velocity and attitude.
    pub nees: Numbers,
    /// Shares of the errors inside one, two and three predicted standard deviations, of position, velocity and
    /// attitude.
    pub inside_sigma: BTreeMap<String, [Number; 3]>,
    /// Outages that began before the solution did; they count in none of these.
    pub left_out: u64,
    /// Outage by outage.
    pub per_outage: Vec<OutageErrors>,
    /// Why the numbers cannot be trusted, if so.
    #[serde(
        skip_serializing_if = "Option::is_none",
        deserialize_with = "known_finding"
    )]
    pub finding: Option<Finding>,
    /// The same as a sentence.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub warning: Option<String>,
}

/// What one outage did; errors by component with their units.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct OutageErrors {
    /// Start \[s\].
    pub start_s: Number,
    /// Largest magnitude inside the outage.
    pub max: Numbers,
    /// Error at its end.
    pub end: Numbers,
    /// Predicted standard deviations at its end.
    pub sigma: Numbers,
    /// Normalised error squared at its end per degree of freedom, of position, velocity and attitude.
    pub nees: Numbers,
}

/// NIS per degree of freedom, 1 if the model is correct.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct NisOfParts {
    /// Of positions.
    pub position: Number,
    /// Of velocities.
    pub velocity: Number,
}

/// For the plots of an experiment.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct OutageSeries {
    /// The truth, or else the fixes.
    pub track: Track,
    /// Drift of each model.
    pub drift: BTreeMap<String, Drift>,
    /// Where each model was inside the outages, one after the other, evenly thinned.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub ways: BTreeMap<String, Track>,
}

/// Drift since the cut.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Drift {
    /// Time since the cut \[s\].
    pub since_cut_s: Vec<Number>,
    /// Root mean square over the outages of the horizontal error \[m\].
    pub horizontal_rms_m: Vec<Number>,
}

impl From<&Outage> for Cut {
    fn from(of: &Outage) -> Self {
        Self {
            start_s: of.start.into(),
            length_s: (of.end - of.start).into(),
        }
    }
}

impl From<&(Outage, WhyLeftOut)> for LeftOutCut {
    fn from((of, why): &(Outage, WhyLeftOut)) -> Self {
        let Cut { start_s, length_s } = of.into();
        Self {
            start_s,
            length_s,
            why: *why,
        }
    }
}
