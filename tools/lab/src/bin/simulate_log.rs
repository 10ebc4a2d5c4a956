//! Writes a simulated car drive as a log: imu.csv, gnss.csv, truth.csv and drive.toml.
//!
//! `cargo run --release -p undrift-lab --bin simulate_log -- DIR [SECONDS [RATE_HZ [SEED [MODEL [MOTION]]]]]`,
//! by default eight hours at 100 Hz. The sensor has all terms of a model, a file or a preset, by default adis16405; the
//! motion is that of a `car`, or `rest`.

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
    let name = arguments.next().unwrap_or_else(|| "adis16405".to_owned());
    let model = ImuModel::resolve(&name, Path::new(""))?;
    let trajectory = match arguments.next().as_deref() {
        None | Some("car") => Trajectory::car(duration, seed),
        Some("rest") => Trajectory::rest(duration),
        Some(other) => return Err(format!("no motion {other}").into()),
    };
    let log = SimulatedLog {
        trajectory: &trajectory,
        rate_hz,
        filters: &model.shaping(BiasModel::GaussMarkov, 1.0 / rate_hz)?,
        gnss: &GnssNoise::default(),
        seed,
        model: &name,
        temperature_c: None,
    };
    log.write(Path::new(&folder))?;
    println!("{folder}");
    Ok(())
}
