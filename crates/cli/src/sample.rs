//! `undrift sample`: simulated logs to try the other verbs on.

use crate::{
    output::{self, Files},
    terminal::say,
};
use anyhow::{Context, Result};
use clap::Args;
use std::path::PathBuf;
use undrift::{
    noise::{BiasModel, ImuModel},
    simulate::{GnssNoise, SimulatedLog, Trajectory},
};

/// The preset whose terms the samples have.
const SENSOR: &str = "icm20602";
/// Rate of the samples \[Hz\].
const RATE: f64 = 50.0;
/// Length of the static recording and of the drive \[s\].
const STATIC: f64 = 1200.0;
const DRIVE: f64 = 1200.0;

/// Write small simulated logs, to try the other verbs on.
///
/// static.csv is a static recording of an ICM-20602, and drive a car's drive with the same sensor and a GNSS receiver:
/// imu.csv, gnss.csv, truth.csv and drive.toml. The same seed gives the same files.
#[derive(Args)]
#[command(after_help = "Examples:
  undrift sample logs
  undrift identify logs/static.csv -o imu.toml
  undrift outages logs/drive/drive.toml --count 5")]
pub struct Arguments {
    /// The folder to write into
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Seed of all noise and of the route
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let model = ImuModel::preset(SENSOR).context("no such preset")?;
    let (seed, rest) = (arguments.seed, Trajectory::rest(STATIC));
    let at_rest = SimulatedLog {
        trajectory: &rest,
        rate_hz: RATE,
        filters: &model.shaping(BiasModel::GaussMarkov, 1.0 / RATE)?,
        gnss: &GnssNoise::default(),
        seed,
        model: SENSOR,
        temperature_c: None,
    };
    let (record, drive) = (
        arguments.folder.join("static.csv"),
        arguments.folder.join("drive"),
    );
    output::make_folder(&drive)?;
    let outputs = SimulatedLog::FILES.map(|name| drive.join(name));
    Files::claim([], outputs.iter().chain([&record]).map(PathBuf::as_path))?;
    let driven = SimulatedLog {
        trajectory: &Trajectory::car(DRIVE, seed),
        seed: seed.wrapping_add(1),
        ..at_rest
    };
    let written = at_rest.write_record(&record);
    let written = written.and_then(|()| driven.write(&drive));
    written.with_context(|| format!("cannot write into {}", arguments.folder.display()))?;
    say(format!(
        "static recording: {}\ndrive: {}",
        record.display(),
        drive.join("drive.toml").display()
    ))
}
