//! `undrift inspect`: what a file is, and a starter drive file for it.

use crate::{
    output::{self, Files, JsonOutput},
    terminal,
};
use anyhow::{Result, bail};
use clap::Args;
use std::path::PathBuf;
use undrift::{inspect, results, vehicle::Profile};
use undrift_report::inspect as report;

/// Describe log files and write a starter drive file.
///
/// Shows format, streams, rate, gaps and units, and how each is known.
#[derive(Args)]
#[command(after_help = "Examples:
  undrift inspect imu.csv gnss.pos -o drive.toml
  undrift inspect imu.csv gnss.pos --vehicle car -o drive.toml
  undrift inspect flight.ulg --json -")]
pub struct Arguments {
    /// Logs of an IMU, a receiver, or both
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,
    /// Write a drive file that reads them
    #[arg(short, long, value_name = "DRIVE.toml", help_heading = "Output")]
    output: Option<PathBuf>,
    /// Vehicle profile to write into the drive file
    #[arg(long, value_name = "PROFILE", requires = "output", value_parser = profile)]
    vehicle: Option<Profile>,
    #[command(flatten)]
    json: JsonOutput,
}

/// A vehicle's profile by its name.
fn profile(name: &str) -> Result<Profile, String> {
    let known = Profile::ALL.into_iter().find(|known| known.name() == name);
    known.ok_or_else(|| {
        format!(
            "write one of {}",
            Profile::ALL.map(Profile::name).join(", ")
        )
    })
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let json = arguments.json.file().into_iter();
    let outputs = json.chain(arguments.output.as_deref());
    let files = Files::claim(arguments.files.iter().map(PathBuf::as_path), outputs)?;
    let mut inspections = Vec::new();
    for file in &arguments.files {
        match inspect::inspect(file) {
            Ok(inspection) => inspections.push(inspection),
            Err(error) => terminal::error(&error.into()),
        }
    }
    if inspections.is_empty() {
        bail!("no file could be read");
    }
    let motion = terminal::stage("aligning", || inspect::motion(&mut inspections));
    inspections.iter_mut().for_each(report::fill);
    let json = results::text(&inspections);
    let shown = arguments.json.write(&files, &json)?;
    if !shown {
        for inspection in &inspections {
            terminal::say(report::text(inspection))?;
        }
    }
    if let Some(file) = &arguments.output {
        let home = file.parent().unwrap_or(std::path::Path::new(""));
        let text = report::drive_file(&inspections, home, arguments.vehicle, motion);
        files.write(file, &text)?;
        terminal::say(format!("drive file: {}", output::shown(file)))?;
        if has_both(&inspections) {
            terminal::say(report::next(&inspections, file))?;
        }
    }
    if inspections.len() < arguments.files.len() {
        bail!("not every file could be read");
    }
    Ok(())
}

/// Whether there is what a drive needs: an IMU and fixes.
fn has_both(inspections: &[inspect::Inspection]) -> bool {
    let has = |table| {
        let mut parts = inspections.iter().flat_map(|file| &file.parts);
        parts.any(|part| part.table == table && part.problem.is_none())
    };
    has("imu") && has("gnss")
}
