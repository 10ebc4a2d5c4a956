//! `undrift sample`: simulated logs to try the other verbs on.

use crate::{
    output::{self, Files},
    terminal::say,
};
use anyhow::{Context, Result};
use clap::Args;
use std::path::PathBuf;
use undrift::{
    Vector3,
    nav::attitude::from_rpy,
    noise::{BiasModel, ImuModel},
    simulate::{GnssNoise, PoseNoise, SimulatedLog, Trajectory},
};

/// The preset whose terms the samples have.
const SENSOR: &str = "icm20602";
/// Rate of the samples \[Hz\].
const RATE: f64 = 50.0;
/// Length of the static recording and of the drive \[s\].
const STATIC: f64 = 1200.0;
const DRIVE: f64 = 1200.0;
/// Length of the motion in a room \[s\], the turns in it \[rad\], and the white noise against that at rest.
const ROOM: f64 = 180.0;
const SWING: f64 = 0.6;
const IN_HAND: f64 = 4.0;

/// Write small simulated logs, to try the other verbs on.
///
/// static.csv is a static recording of an ICM-20602, drive a car's drive with the same sensor and a GNSS receiver:
/// imu.csv, gnss.csv, truth.csv and drive.toml; and room the same sensor in a hand, four times as noisy, with the poses of a
/// marker: imu.csv and poses.txt. The same seed gives the same files.
#[derive(Args)]
#[command(after_help = "Examples:
  undrift sample logs
  undrift identify logs/static.csv -o imu.toml
  undrift outages logs/drive/drive.toml --count 5
  undrift tune logs/room/imu.csv logs/room/poses.txt")]
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
    let [record, drive, room] =
        ["static.csv", "drive", "room"].map(|name| arguments.folder.join(name));
    output::make_folder(&drive)?;
    output::make_folder(&room)?;
    let outputs = SimulatedLog::FILES.map(|name| drive.join(name));
    let of_room = SimulatedLog::ROOM.map(|name| room.join(name));
    let outputs = outputs.iter().chain(&of_room).chain([&record]);
    Files::claim([], outputs.map(PathBuf::as_path))?;
    let driven = SimulatedLog {
        trajectory: &Trajectory::car(DRIVE, seed),
        seed: seed.wrapping_add(1),
        ..at_rest
    };
    let written = at_rest.write_record(&record);
    let written = written.and_then(|()| driven.write(&drive));
    let mut louder = model.clone();
    for axis in louder.gyro.iter_mut().chain(&mut louder.accel) {
        axis.white = axis.white.map(|white| IN_HAND * white);
    }
    let in_hand = SimulatedLog {
        trajectory: &Trajectory::handheld(ROOM, SWING, seed),
        rate_hz: 2.0 * RATE,
        filters: &louder.shaping(BiasModel::GaussMarkov, 0.5 / RATE)?,
        seed: seed.wrapping_add(2),
        ..at_rest
    };
    let marker = PoseNoise {
        marker: from_rpy(&Vector3::new(0.2, -0.1, 1.5)),
        lever_arm: Vector3::new(0.05, 0.02, -0.1),
        clock: 0.02,
        ..PoseNoise::default()
    };
    let written = written.and_then(|()| in_hand.write_room(&room, &marker, 2));
    written.with_context(|| format!("cannot write into {}", arguments.folder.display()))?;
    say(format!(
        "static recording: {}\ndrive: {}\nroom: {}",
        record.display(),
        drive.join("drive.toml").display(),
        room.join("poses.txt").display()
    ))
}
