//! Many logs: each becomes a [`Job`], a plain description of what is to be done; [`process()`] makes an
//! [`FleetOutcome`] of it; [`run()`] does so on all cores, keeps every outcome in a file of its own and leaves out
//! what is up to date; [`gather()`] makes one table and one summary of them all.
//!
//! A job has no state beside it, and its outcome depends on nothing but the job and the contents of the
//! files that it names: no clock, no machine, no order. So whoever runs the jobs, wherever and however
//! often, gets the same outcomes to the bit. `docs/fleet.md` has the manifest and the columns.

mod fingerprint;
mod gather;
mod labels;
mod manifest;
mod outcome;
mod process;
mod ratios;
mod run;
mod summary;
#[cfg(feature = "parquet")]
mod table;

pub use fingerprint::{fingerprint, inputs};
pub use gather::{Gathering, gather};
pub use manifest::{Choice, Lookup, Manifest, Pattern, PatternError, Verb, drives};
pub use outcome::{FleetOutcome, OutcomeRow};
pub use process::process;
pub use run::{Done, FleetError, Options, job_path, process_on, run, shard};

use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};
use undrift_drive::{
    identify::{Settings, Trend},
    outages::Schedule,
    record::RecordFormat,
};
use undrift_io::table::Column;
use undrift_noise::BiasModel;

pub use undrift_results::Say;

/// One log and what is to be done with it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Job {
    /// Folder that names are relative to; empty for the current one. It is no part of the outcome.
    pub folder: String,
    /// What the outcome calls the log: the name of the drive file or record, if `drive` is absent.
    pub log: String,
    /// The drive file, where several folders of logs share one. It is no part of the outcome.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drive: Option<String>,
    /// Folder of the drive's logs, if not the drive file's own. It is no part of the outcome.
    pub data: Option<String>,
    /// Serial number of the IMU.
    pub unit: Option<String>,
    /// Type of the IMU, instead of the name of its noise model.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sensor: Option<String>,
    /// Whatever else is known of the log: vehicle, driver, campaign.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub labels: BTreeMap<String, String>,
    /// Temperature [°C], if it was stated.
    pub temperature_c: Option<f64>,
    /// Noise model of the IMU, a preset or a file, instead of the drive file's.
    pub model: Option<String>,
    /// What is to be done.
    pub task: Task,
}

/// What is to be done with a log.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Task {
    /// Navigate a drive under each bias model.
    Navigate {
        /// The bias models.
        #[serde(with = "names")]
        bias_models: Vec<BiasModel>,
        /// Whether the solution is the smoothed one.
        smooth: bool,
    },
    /// Cut a drive's GNSS under each bias model.
    Outages {
        /// The bias models.
        #[serde(with = "names")]
        bias_models: Vec<BiasModel>,
        /// Where.
        plan: OutagePlan,
        /// Whether the errors are those of the smoothed solution.
        smooth: bool,
    },
    /// Identify the noise of a sensor in its vehicle.
    Tune,
    /// Identify the noise of a static record.
    Identify(RecordSettings),
}

impl Task {
    /// The verb.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Navigate { .. } => "navigate",
            Self::Outages { .. } => "outages",
            Self::Tune => "tune",
            Self::Identify(_) => "identify",
        }
    }
}

/// From outage to outage where nothing is said \[s\].
const EVERY: f64 = 30.0;

/// Outages, the same in every drive.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OutagePlan {
    /// Length of an outage \[s\].
    pub length_s: f64,
    /// From the first fix to the start of the first outage \[s\].
    pub start_s: f64,
    /// From start to start \[s\]; without it they are evenly spread.
    pub every_s: Option<f64>,
    /// How many; without it as many as fit.
    pub count: Option<usize>,
    /// Starts in the log's time base \[s\], instead of the above.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at_s: Option<Vec<f64>>,
}

impl Default for OutagePlan {
    /// 10 s every 30 s from 60 s on.
    fn default() -> Self {
        Self {
            length_s: 10.0,
            start_s: 60.0,
            every_s: Some(EVERY),
            count: None,
            at_s: None,
        }
    }
}

impl OutagePlan {
    /// The schedule for one drive; there is one.
    pub fn schedule(&self) -> Option<Schedule> {
        let usual = self.count.is_none().then_some(EVERY);
        let every = self.every_s.or(usual);
        Schedule::asked(self.at_s.clone(), every, self.count, Some(self.start_s))
    }
}

/// How a static record is read, and what is taken out of it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecordSettings {
    /// Sample rate \[Hz\]; from the time stamps if absent.
    pub rate_hz: Option<f64>,
    /// Six columns by name or number; by the header if empty.
    pub columns: Vec<String>,
    /// Units of gyros and accelerometers; by the header if absent.
    pub units: Option<(String, String)>,
    /// Stream of a log that has several.
    pub topic: Option<String>,
    /// What is taken out beside the mean.
    pub detrend: Trend,
    /// Largest n of ARMA(2n, 2n−1) that the Pandit-Wu search may choose.
    pub n_max: usize,
}

impl RecordSettings {
    fn format(&self) -> RecordFormat {
        let column = |name: &String| {
            let number = name.parse().ok().filter(|n| *n > 0);
            number.map_or_else(|| Column::Name(name.clone()), Column::Number)
        };
        RecordFormat {
            time: None,
            columns: self.columns.iter().map(column).collect(),
            axis: None,
            units: self.units.clone(),
            temperature: false,
            topic: self.topic.clone(),
        }
    }

    fn identification(&self) -> Settings {
        Settings {
            rate_hz: self.rate_hz,
            span: None,
            n_max: self.n_max,
            trend: self.detrend,
        }
    }
}

impl Job {
    /// The drive file or record.
    pub fn path(&self) -> PathBuf {
        Path::new(&self.folder).join(self.file())
    }

    /// The drive file or record by its name in the folder.
    fn file(&self) -> &str {
        self.drive.as_deref().unwrap_or(&self.log)
    }

    /// Where a drive's logs lie, and a model file that its drive file names.
    fn folders(&self) -> (PathBuf, PathBuf) {
        let home = self.path().parent().map(Path::to_path_buf);
        let home = home.unwrap_or_default();
        let data = self.data.as_ref();
        let data = data.map_or_else(|| home.clone(), |data| Path::new(&self.folder).join(data));
        (home, data)
    }
}

/// Bias models by their names.
mod names {
    use super::*;

    pub fn serialize<S: Serializer>(models: &[BiasModel], to: S) -> Result<S::Ok, S::Error> {
        to.collect_seq(models.iter().map(|model| model.name()))
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<BiasModel>, D::Error> {
        let names = Vec::<String>::deserialize(from)?;
        let model = |name: String| name.parse().map_err(serde::de::Error::custom);
        names.into_iter().map(model).collect()
    }
}
