//! `undrift navigate`: one drive into one solution.

use crate::report;
use anyhow::Result;
use clap::Args;
use std::path::PathBuf;
use undrift::{
    drive::Drive,
    navigate::{self, Report},
    noise::{BiasModel, ImuModel},
    reference::COMPONENTS,
    replay::Innovations,
};

/// Navigate a drive: IMU and GNSS into position, velocity and attitude.
///
/// Example: undrift navigate examples/rtk-drive.toml --data logs -o nav.csv
#[derive(Args)]
pub struct Arguments {
    /// The drive file
    #[arg(value_name = "DRIVE.toml")]
    drive: PathBuf,
    #[command(flatten)]
    common: Common,
    /// Bias model: white, paper, gauss-markov, random-walk, ar or arma
    #[arg(long, value_name = "NAME", default_value = "arma")]
    bias_model: BiasModel,
    /// Write the solution at every sample, with standard deviations and estimated sensor errors
    #[arg(short, long, value_name = "nav.csv")]
    output: Option<PathBuf>,
    /// Smooth: at every sample the best estimate given the whole log
    #[arg(long)]
    smooth: bool,
}

/// What every verb on a drive takes.
#[derive(Args)]
pub struct Common {
    /// Folder of the drive's log files, if not the drive file's own
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
    /// Noise model of the IMU: a model file or a preset (adis16405, adis16465, adis16488, icm20602, mpu6050)
    #[arg(long, value_name = "IMU.toml")]
    model: Option<String>,
}

/// The drive with the model that the command line asks for.
pub fn load(drive: &std::path::Path, common: &Common) -> Result<Drive> {
    let mut loaded = Drive::load(drive, common.data.as_deref())?;
    if let Some(name) = &common.model {
        loaded.model = Some(ImuModel::resolve(name, std::path::Path::new(""))?);
    }
    Ok(loaded)
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let drive = load(&arguments.drive, &arguments.common)?;
    let report = navigate::navigate(
        &drive,
        arguments.bias_model,
        arguments.output.as_deref(),
        arguments.smooth,
    )?;
    print_report(&report, arguments.bias_model)?;
    if let Some(path) = &arguments.output {
        report::say(format!("solution: {}", path.display()))?;
    }
    if let Some(time) = report.summary.diverged {
        anyhow::bail!("the solution diverged at {time:.3} s; what was written ends there");
    }
    Ok(())
}

fn print_report(report: &Report, kind: BiasModel) -> Result<()> {
    let s = &report.summary;
    let started = s.started.unwrap_or(f64::NAN);
    if let Some(mounting) = &report.mounting {
        report::say(format!("mounting estimated: {mounting}"))?;
    }
    report::say(format!("bias model {kind}; {}", s.alignment))?;
    report::say(format!(
        "navigated {} samples from {started:.3} s to {:.3} s; {} samples and {} fixes before that",
        s.samples, s.ended, s.align_samples, s.fixes_before
    ))?;
    report::say(format!(
        "{} fixes used; NIS per degree of freedom (1 when the model is right): position {}, velocity {}",
        s.fixes,
        nis(&s.position),
        nis(&s.velocity)
    ))?;
    for (name, sums) in [
        ("non-holonomic constraint", &s.non_holonomic),
        ("zero velocity", &s.zero_velocity),
        ("odometer", &s.odometer),
        ("barometer", &s.barometer),
    ] {
        if sums.updates > 0 {
            report::say(format!(
                "{name}: {} updates, NIS per degree of freedom {}",
                sums.updates,
                nis(sums)
            ))?;
        }
    }
    for (kind, value, std) in &s.parameters {
        report::say(format!("{kind:?} {value:.4?} ± {std:.4?}"))?;
    }
    if let Some((errors, n)) = &report.rmse {
        let parts: Vec<String> = COMPONENTS
            .iter()
            .zip(errors.0)
            .filter(|(_, e)| e.is_finite())
            .map(|(name, e)| format!("{name} {e:.4}"))
            .collect();
        report::say(format!(
            "RMS error against the truth at {n} samples: {}",
            parts.join(", ")
        ))?;
    }
    if let (None, Some((from, to))) = (&report.rmse, report.truth_read) {
        let why = if to < started || from > s.ended {
            "the truth does not overlap the solution"
        } else {
            "the truth has no two samples within 2 s of each other beside the solution"
        };
        eprintln!(
            "{why}, so there is no error: it was read from {from:.3} s to {to:.3} s, the solution runs from {started:.3} s to {:.3} s; compare the time columns, truth.time_offset moves one",
            s.ended
        );
    }
    report::print_health(s);
    for (name, skipped, gaps) in &report.scalars {
        let sums = if *name == "odometer" {
            &s.odometer
        } else {
            &s.barometer
        };
        report::print_scalar(name, skipped, gaps, sums);
    }
    for (file, skipped) in [
        ("IMU", &report.imu_skipped),
        ("GNSS", &report.gnss_skipped),
        ("truth", &report.truth_skipped),
    ] {
        if !skipped.is_empty() {
            eprintln!("{file} log: {skipped}");
        }
    }
    Ok(())
}

fn nis(sums: &Innovations) -> String {
    sums.per_dof().map_or("none".into(), |r| format!("{r:.2}"))
}
