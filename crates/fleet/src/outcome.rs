//! What came of one log.

use super::Job;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use undrift_base::hash::hexadecimal;
use undrift_drive::{drive::ConfigError, findings::Finding, reference::COMPONENTS};
use undrift_results::{
    self as results, Axis, Cut, Navigate, Number, OutageErrors, known_finding, known_findings,
};

/// What came of one log: numbers in rows, or why there are none. The same to the bit wherever it was
/// worked out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FleetOutcome {
    /// The log, as the job calls it.
    pub log: String,
    /// Serial number of the IMU.
    pub unit: Option<String>,
    /// Type of the IMU: stated, else the name of its noise model.
    pub sensor: Option<String>,
    /// What else is known of the log.
    #[serde(default)]
    pub labels: BTreeMap<String, String>,
    /// Temperature [°C]: stated, else the mean of the log's own column.
    pub temperature_c: Option<f64>,
    /// What was done: "navigate", "outages", "tune" or "identify".
    pub task: String,
    /// Why nothing came of it.
    pub failed: Option<String>,
    /// Bias models or axes that nothing came of, and why.
    pub failed_parts: BTreeMap<String, String>,
    /// What was found out about the log.
    #[serde(default, deserialize_with = "known_findings")]
    pub findings: Vec<Finding>,
    /// The same in sentences, and those of identified axes.
    pub warnings: Vec<String>,
    /// Names of the numbers of each row.
    pub columns: Vec<String>,
    /// The rows.
    pub rows: Vec<OutcomeRow>,
}

/// Numbers of a bias model or an axis.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OutcomeRow {
    /// The bias model or axis.
    pub part: String,
    /// Which outage, from 1.
    pub outage: Option<u32>,
    /// The model that was recommended, or the sentence of `finding`.
    pub note: Option<String>,
    /// Why the numbers cannot be trusted, if so.
    #[serde(default, deserialize_with = "known_finding")]
    pub finding: Option<Finding>,
    /// A number for each of [`FleetOutcome::columns`]; `None` where there is none.
    pub values: Vec<Option<f64>>,
}

impl FleetOutcome {
    /// Of a job, before anything came of it.
    pub(super) fn new(job: &Job) -> Self {
        Self {
            log: job.log.clone(),
            unit: job.unit.clone(),
            sensor: job.sensor.clone(),
            labels: job.labels.clone(),
            temperature_c: job.temperature_c,
            task: job.task.name().into(),
            failed: None,
            failed_parts: BTreeMap::new(),
            findings: Vec::new(),
            warnings: Vec::new(),
            columns: columns(job.task.name()),
            rows: Vec::new(),
        }
    }

    /// As text: JSON with a line for each row, and the SHA-256 of it without its last line but one.
    pub fn to_json(&self) -> String {
        let text = results::text(self);
        let sum = hexadecimal(Sha256::new_with_prefix(&text));
        let open = text.strip_suffix(END).unwrap_or(&text);
        format!("{open}{SUM}{sum}\"{END}\n")
    }

    /// Reads [`FleetOutcome::to_json`]; `file` is for messages.
    ///
    /// # Errors
    /// If the text is not what [`FleetOutcome::to_json`] writes, with the line.
    pub fn from_json(text: &str, file: &str) -> Result<Self, ConfigError> {
        let wrong = |line, why: &str| ConfigError {
            file: file.to_owned(),
            line,
            key: String::new(),
            message: format!("not the result of a log: {why}; remove the file and run again"),
        };
        let text = sound(text).ok_or_else(|| {
            wrong(
                None,
                "it is cut short or damaged, its checksum does not fit",
            )
        })?;
        serde_json::from_str(&text).map_err(|error| wrong(Some(error.line()), &error.to_string()))
    }

    /// A row's number by its column.
    pub fn value(&self, row: &OutcomeRow, column: &str) -> Option<f64> {
        let place = self.columns.iter().position(|name| name == column)?;
        *row.values.get(place)?
    }
}

/// How the text of an outcome ends, and what stands before its checksum.
const END: &str = "\n}";
const SUM: &str = ",\n  \"sha256\": \"";

/// The text of an outcome without its checksum, if that fits.
fn sound(text: &str) -> Option<String> {
    let (open, end) = text.rsplit_once(SUM)?;
    let sum = end.strip_suffix('\n')?.strip_suffix(END)?;
    let text = format!("{open}{END}");
    let found = hexadecimal(Sha256::new_with_prefix(&text));
    (sum.strip_suffix('"')? == found).then_some(text)
}

/// A number of a task's rows: its column, and where the task's result has it.
pub(super) type Field<R> = (&'static str, fn(&R) -> Number);

/// Of an outage, before the errors in it.
pub(super) const OUTAGES: [Field<(Cut, OutageErrors)>; 2] = [
    ("start_s", |(_, errors)| errors.start_s),
    ("length_s", |(cut, _)| cut.length_s),
];

/// Of a navigated drive, before the errors against the truth.
pub(super) const NAVIGATE: [Field<Navigate>; 4] = [
    ("started_s", |of| of.summary.started),
    ("ended_s", |of| of.summary.ended),
    ("nis_position", |of| of.position.nis_per_dof),
    ("nis_velocity", |of| of.velocity.nis_per_dof),
];

/// Of an axis or a length of outages in the vehicle.
pub(super) const TUNE: [&str; 6] = [
    "length_s",
    "white_noise",
    "random_walk",
    "white_noise_ratio",
    "drift_before_m",
    "drift_after_m",
];

/// Of an identified axis.
pub(super) const IDENTIFY: [Field<Axis>; 8] = [
    ("samples", |of| Number(of.samples as f64)),
    ("mean", |of| of.mean),
    ("white_noise", |of| Number(of.allan_terms.white.value)),
    ("bias_instability", |of| {
        Number(of.allan_terms.bias_instability.value)
    }),
    ("random_walk", |of| Number(of.allan_terms.random_walk.value)),
    ("drift_1s", |of| drift(of, "1")),
    ("drift_10s", |of| drift(of, "10")),
    ("drift_60s", |of| drift(of, "60")),
];

/// Drift of the recommended model over a horizon [s].
fn drift(axis: &Axis, horizon: &str) -> Number {
    let scores = &axis.chosen.drift_score;
    scores.get(horizon).copied().unwrap_or_default()
}

/// Names of the numbers of a task's rows.
pub(super) fn columns(task: &str) -> Vec<String> {
    fn of<R>(fields: &[Field<R>], errors: &[&str]) -> Vec<String> {
        let fields = fields.iter().map(|(name, _)| (*name).to_owned());
        let columns = |kind| COMPONENTS.map(|name| format!("{kind}_{name}"));
        fields.chain(errors.iter().flat_map(columns)).collect()
    }
    match task {
        "outages" => of(&OUTAGES, &["max", "end"]),
        "navigate" => of(&NAVIGATE, &["rms"]),
        "tune" => TUNE.map(str::to_owned).to_vec(),
        _ => of(&IDENTIFY, &[]),
    }
}
