//! Writes a fleet of simulated car drives and its manifest: `DIR/UNIT/NUMBER/drive.toml` and so on, and
//! `DIR/fleet.toml`.
//!
//! `cargo run --release -p undrift-lab --bin simulate_fleet -- DIR [DRIVES [SECONDS [RATE_HZ]]]`, by
//! default 200 drives of 300 s at 100 Hz, ten of each unit. The sensors are adis16405, whose errors
//! grow by 1 % a kelvin from 25 °C on; those of unit SN0007 are four times as large, and drive 100 has
//! lost its GNSS log.

use rayon::prelude::*;
use std::path::Path;
use undrift::{
    noise::{BiasModel, ImuModel},
    simulate::{GnssNoise, SimulatedLog, Trajectory},
};

type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Drives of one unit.
const OF_A_UNIT: usize = 10;

fn main() -> Result<(), Failure> {
    let mut arguments = std::env::args().skip(1);
    let folder = arguments.next().ok_or("give a folder to write to")?;
    let folder = Path::new(&folder);
    let mut number = |default: f64| -> Result<f64, Failure> {
        Ok(arguments.next().map_or(Ok(default), |text| text.parse())?)
    };
    let (drives, duration, rate_hz) = (number(200.0)? as usize, number(300.0)?, number(100.0)?);
    (0..drives)
        .into_par_iter()
        .try_for_each(|drive| write(folder, drive, duration, rate_hz))?;
    std::fs::write(
        folder.join("fleet.toml"),
        r#"unit = "{parent}"
bias_models = ["white", "gauss-markov", "arma"]

[outages]
length = "10 s"
every = "30 s"
start = "90 s"

[[log]]
drive = "*/*/drive.toml"
"#,
    )?;
    println!("{}", folder.join("fleet.toml").display());
    Ok(())
}

fn write(folder: &Path, drive: usize, duration: f64, rate_hz: f64) -> Result<(), Failure> {
    let unit = drive / OF_A_UNIT + 1;
    // Spread over −10 to 60 °C, another order in each unit.
    let temperature = ((drive * 37) % 71) as f64 - 10.0;
    let worse = if unit == 7 { 4.0 } else { 1.0 };
    let factor = worse * (0.01 * (temperature - 25.0)).exp();
    let mut model = ImuModel::preset("adis16405").ok_or("no such preset")?;
    for axis in model.gyro.iter_mut().chain(&mut model.accel) {
        axis.white = axis.white.map(|white| white * factor);
        for process in &mut axis.instability {
            process.sigma *= factor;
        }
    }
    let seed = drive as u64 + 1;
    let folder = folder.join(format!("SN{unit:04}/{drive:03}"));
    let log = SimulatedLog {
        trajectory: &Trajectory::car(duration, seed),
        rate_hz,
        filters: &model.shaping(BiasModel::GaussMarkov, 1.0 / rate_hz)?,
        gnss: &GnssNoise::default(),
        seed,
        model: "adis16405",
        temperature_c: Some(temperature),
    };
    log.write(&folder)?;
    if drive == 99 {
        std::fs::remove_file(folder.join("gnss.csv"))?;
    }
    Ok(())
}
