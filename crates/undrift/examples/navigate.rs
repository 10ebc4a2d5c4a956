//! A drive from its files to a solution: `cargo run --release -p undrift --example navigate -- DRIVE.toml`.
//!
//! The drive file says which columns of which files are what (docs/drive-file.md), the noise model how the
//! IMU errs. Without arguments a drive is simulated and its files are written first.

use std::error::Error;
use std::path::{Path, PathBuf};
use undrift::io::write::{SolutionFile, SolutionFormat, SolutionOptions};
use undrift::nav::Vector3;
use undrift::replay::Aid;
use undrift::simulate::{GnssNoise, SimulatedLog};
use undrift::{BiasModel, Drive, ImuModel, Trajectory, navigate, navigate_drive};

/// A car for two minutes: an ADIS16465 at 100 Hz and a receiver on the roof.
fn simulated(folder: &Path) -> Result<PathBuf, Box<dyn Error>> {
    let (rate_hz, seed) = (100.0, 1);
    let model = ImuModel::preset("adis16465").ok_or("no such preset")?;
    let sensors = model.shaping(BiasModel::GaussMarkov, 1.0 / rate_hz)?;
    let gnss = GnssNoise {
        position_std: [0.5, 0.5, 1.0],
        velocity_std: [0.05, 0.05, 0.1],
        rate_hz: 5.0,
        lever_arm: Vector3::new(0.3, 0.0, -1.2),
        ..GnssNoise::default()
    };
    SimulatedLog {
        trajectory: &Trajectory::car(120.0, seed),
        rate_hz,
        filters: &sensors,
        gnss: &gnss,
        seed,
        model: "adis16465",
        temperature_c: None,
    }
    .write(folder)?;
    Ok(folder.join("drive.toml"))
}

fn main() -> Result<(), Box<dyn Error>> {
    let file = match std::env::args().nth(1) {
        Some(file) => PathBuf::from(file),
        None => simulated(&std::env::temp_dir().join("undrift-example"))?,
    };
    // Units, axes and lever arm are judged here: an error says file, line, key and the mend.
    let drive = Drive::load(&file, None)?;

    // Every model is a shaping filter per axis; `Arma` runs whatever the model file describes.
    let solution = file.with_file_name("nav.csv");
    let options = SolutionOptions {
        epoch: drive.epoch,
        ..SolutionOptions::default()
    };
    let csv = SolutionFile::create(&solution, SolutionFormat::Csv, &options)?;
    let wanted = navigate::Wanted {
        files: vec![csv],
        ..Default::default()
    };
    let report = navigate_drive(&drive, BiasModel::Arma, wanted)?;

    let summary = &report.summary;
    println!(
        "{} samples, {} fixes: {}",
        summary.samples,
        summary.fixes,
        solution.display()
    );
    // Innovations as large as predicted have a normalised square of 1 per degree of freedom.
    if let Some(nis) = summary.innovations[Aid::Position].per_dof() {
        println!("position: NIS {nis:.2} per degree of freedom");
    }
    if let Some((errors, samples)) = &report.rmse {
        let horizontal = errors.numbers()["horizontal_m"].0;
        println!("RMS error over {samples} samples with a truth: {horizontal:.3} m");
    }
    // What cannot be right (units, axes, signs, clocks) is a value, not a sentence in a log.
    for finding in report.findings() {
        println!("finding: {finding:?}");
    }
    Ok(())
}
