//! Results read back from their JSON: what a report needs of them. What is missing stays empty; a
//! number that is null is NaN.

mod fleet;
mod identify;

pub use fleet::{
    Fleet, Group as FleetGroup, Log as FleetLog, Measure as FleetMeasure, Part as FleetPart,
    Trouble,
};
pub use identify::{Axis, Identify, OrderRow, Test};

use serde::{Deserialize, Deserializer, de::DeserializeOwned};
use std::{collections::BTreeMap, path::Path};
use undrift::io::ReadError;
use undrift::results::Kind;

/// Numbers by name.
pub type Numbers = BTreeMap<String, Number>;

/// A number; NaN where the JSON has null.
#[derive(Clone, Copy, Debug)]
pub struct Number(pub f64);

impl Default for Number {
    fn default() -> Self {
        Self(f64::NAN)
    }
}

impl<'de> Deserialize<'de> for Number {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Ok(Option::deserialize(deserializer)?.map_or_else(Self::default, Self))
    }
}

/// A result of any kind.
pub enum Read {
    /// Of `identify`.
    Identify(Identify),
    /// Of `navigate`.
    Navigate(Box<Navigate>),
    /// Of `outages`.
    Outages(Outages),
    /// Of `montecarlo`.
    MonteCarlo(MonteCarlo),
    /// Of `demo`.
    Demo(Demo),
    /// Of `fleet`.
    Fleet(Fleet),
}

/// What every result begins with.
#[derive(Deserialize)]
struct Head {
    /// Version of the program.
    undrift: String,
    kind: String,
}

/// Reads a result; also the version that wrote it. `path` is for messages.
pub fn read(path: &Path, text: &str) -> Result<(String, Read), ReadError> {
    let head: Head = part(path, text)?;
    let kind = Kind::ALL.into_iter().find(|k| k.name() == head.kind);
    let result = match kind {
        Some(Kind::Identify) => Read::Identify(part(path, text)?),
        Some(Kind::Navigate) => Read::Navigate(part(path, text)?),
        Some(Kind::Outages) => Read::Outages(part(path, text)?),
        Some(Kind::MonteCarlo) => Read::MonteCarlo(part(path, text)?),
        Some(Kind::Demo) => Read::Demo(part(path, text)?),
        Some(Kind::Fleet) => Read::Fleet(part(path, text)?),
        None => {
            let kinds = Kind::ALL.map(Kind::name).join(", ");
            return Err(not_a_result(
                path,
                &format!("\"{}\" is none of the kinds {kinds}", head.kind),
            )
            .key("kind"));
        }
    };
    Ok((head.undrift, result))
}

fn not_a_result(path: &Path, why: &str) -> ReadError {
    ReadError::new(path, format!("not a result of undrift: {why}"))
}

fn part<T: DeserializeOwned>(path: &Path, text: &str) -> Result<T, ReadError> {
    serde_json::from_str(text).map_err(|error| {
        let full = error.to_string();
        // The place is told by the error's own line.
        let why = full.split(" at line ").next().unwrap_or(&full);
        let failed = not_a_result(path, why).at(error.line() as u64);
        match key_before(text, error.line(), error.column()) {
            Some(key) if error.is_data() && !why.starts_with("missing field") => failed.key(key),
            _ => failed,
        }
    })
}

/// The last key of an object before a place in a text, lines and columns from 1.
fn key_before(text: &str, line: usize, column: usize) -> Option<&str> {
    let line = text.lines().nth(line.checked_sub(1)?)?;
    let before = line.get(..column.min(line.len()))?;
    let (before, _) = before.rsplit_once("\":")?;
    let (_, key) = before.rsplit_once('"')?;
    Some(key)
}

/// Values over time [s].
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Curve {
    pub time_s: Vec<Number>,
    pub value: Vec<Number>,
}

/// A way on the ground.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Track {
    pub time_s: Vec<Number>,
    pub lat_deg: Vec<Number>,
    pub lon_deg: Vec<Number>,
    pub height_m: Vec<Number>,
}

/// What was navigated.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Drive {
    pub simulated: Option<String>,
    pub file: Option<String>,
    pub imu: Option<String>,
    pub gnss: Option<String>,
    pub truth: Option<String>,
    pub rate_hz: Number,
    pub model: Option<String>,
    pub gnss_use: Option<String>,
}

/// A navigated drive.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Navigate {
    pub drive: Drive,
    pub bias_model: String,
    pub smooth: bool,
    pub mounting: Option<String>,
    pub position: Nis,
    pub velocity: Nis,
    pub rms_error: Option<Numbers>,
    pub nees_per_dof: Numbers,
    pub compared_samples: Option<u64>,
    pub summary: Summary,
    pub warnings: Vec<String>,
    pub series: Option<NavigateSeries>,
}

/// Innovations of one kind of measurement.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Nis {
    pub nis_per_dof: Number,
    pub autocorrelation: Number,
    pub autocorrelation_bound: Number,
}

/// What a replay was like.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Summary {
    pub samples: u64,
    pub started: Number,
    pub ended: Number,
    pub alignment: String,
    pub fixes: u64,
    pub position: Counts,
    pub velocity: Counts,
    pub non_holonomic: Counts,
    pub zero_velocity: Counts,
    pub odometer: Counts,
    pub barometer: Counts,
    pub parameters: BTreeMap<String, Parameter>,
}

/// Counts of updates.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Counts {
    pub updates: u64,
    pub nis_sum: Number,
    pub dof_sum: u64,
    pub weakened: u64,
    pub rejected: u64,
}

/// An estimated parameter.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Parameter {
    pub value: Vec<Number>,
    pub std: Vec<Number>,
}

/// A run over time.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct NavigateSeries {
    pub track: Track,
    pub motion: BTreeMap<String, Curve>,
    pub std: BTreeMap<String, Curve>,
    pub sensor_error: BTreeMap<String, Curve>,
    pub sensor_error_std: BTreeMap<String, Curve>,
    pub error: BTreeMap<String, Curve>,
    pub innovations: BTreeMap<String, BTreeMap<String, Curve>>,
    pub without_gnss_s: Vec<(Number, Number)>,
}

/// An experiment with outages.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Outages {
    pub drive: Drive,
    pub outages: Vec<Cut>,
    pub order: Vec<String>,
    pub models: BTreeMap<String, ModelErrors>,
    pub failed: BTreeMap<String, String>,
    pub reference: String,
    pub smooth: bool,
    pub warnings: Vec<String>,
    pub series: OutageSeries,
}

/// One outage.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Cut {
    pub start_s: Number,
    pub length_s: Number,
}

/// What the outages did to one model.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct ModelErrors {
    pub max: Numbers,
    pub rms: Numbers,
    pub median: Numbers,
    pub end_rms: Numbers,
    pub per_outage: Vec<OutageErrors>,
    pub warning: Option<String>,
}

/// What one outage did.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct OutageErrors {
    pub start_s: Number,
    pub max: Numbers,
    pub end: Numbers,
}

/// For the plots of an experiment.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct OutageSeries {
    pub track: Track,
    pub drift: BTreeMap<String, Drift>,
}

/// Drift since the cut.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Drift {
    pub since_cut_s: Vec<Number>,
    pub horizontal_rms_m: Vec<Number>,
}

/// The demo.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Demo {
    pub seed: u64,
    pub identification: Option<Identify>,
    pub outages: Outages,
    pub note: String,
}

/// A Monte Carlo.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct MonteCarlo {
    pub runs: u64,
    pub seed: u64,
    pub settle_s: Number,
    pub drive: MonteCarloDrive,
    pub time_s: Vec<Number>,
    pub models: Vec<MonteCarloModel>,
}

/// What was simulated.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct MonteCarloDrive {
    pub duration_s: Number,
    pub rate_hz: Number,
    pub drawn_as: String,
    pub model: String,
    pub filter_model: String,
}

/// One bias model of a Monte Carlo.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct MonteCarloModel {
    pub name: String,
    pub diverged: u64,
    pub started_s: Number,
    pub nees: Vec<Group>,
    pub coverage: BTreeMap<String, Vec<Number>>,
    pub nis: Vec<NisKind>,
}

/// NEES of a group of states.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Group {
    pub name: String,
    pub freedom: u64,
    pub mean_per_freedom: Number,
    pub mean_standard_error: Number,
    pub share_inside: Number,
    pub share_above: Number,
    pub share_below: Number,
    pub share_standard_error: Number,
    pub verdict: String,
    pub average: Vec<Number>,
    pub lower: Vec<Number>,
    pub upper: Vec<Number>,
}

/// NIS of a kind of measurement.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct NisKind {
    pub name: String,
    pub updates: u64,
    pub nis_per_freedom: Number,
    pub bounds: (Number, Number),
    pub share_above_95: Number,
    pub autocorrelation: Vec<Vec<Number>>,
    pub autocorrelation_bound: Number,
    pub verdict: String,
}
