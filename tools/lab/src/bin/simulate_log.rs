//! Writes a simulated car drive as a log: imu.csv, gnss.csv, truth.csv and drive.toml.
//!
//! `cargo run --release -p undrift-lab --bin simulate_log -- DIR [SECONDS [RATE_HZ [SEED]]]`, by
//! default eight hours at 100 Hz. The sensor is the preset adis16405 with all its terms.

use std::path::Path;
use undrift::{
    noise::{BiasModel, ImuModel},
    simulate::{GnssNoise, SimulatedLog, Trajectory},
};

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let mut arguments = std::env::args().skip(1);
    let folder = arguments.next().ok_or("give a folder to write to")?;
    let mut number = |default: f64| -> Result<f64, Failure> {
        Ok(arguments.next().map_or(Ok(default), |text| text.parse())?)
    };
    let (duration, rate_hz, seed) = (number(28_800.0)?, number(100.0)?, number(1.0)? as u64);
    let model = ImuModel::preset("adis16405").ok_or("no such preset")?;
    let log = SimulatedLog {
        trajectory: &Trajectory::car(duration, seed),
        rate_hz,
        filters: &model.shaping(BiasModel::GaussMarkov, 1.0 / rate_hz)?,
        gnss: &GnssNoise::default(),
        seed,
        model: "adis16405",
        temperature_c: None,
    };
    log.write(Path::new(&folder))?;
    println!("{folder}");
    Ok(())
}
