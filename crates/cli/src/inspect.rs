//! `undrift inspect`: what a file is, and a starter drive file for it.

use crate::{
    output::{Files, JsonOutput},
    terminal,
};
use anyhow::{Result, bail};
use clap::Args;
use std::path::PathBuf;
use undrift::inspect;
use undrift_report::inspect as report;

/// Describe log files and write a starter drive file.
///
/// Shown are format, streams, rate, gaps, units, and how they are known.
#[derive(Args)]
#[command(after_help = "Examples:
  undrift inspect imu.csv gnss.pos -o drive.toml
  undrift inspect flight.ulg --json -")]
pub struct Arguments {
    /// Logs of an IMU, of a receiver, or of both
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,
    /// Write a drive file that reads them
    #[arg(short, long, value_name = "DRIVE.toml", help_heading = "Output")]
    output: Option<PathBuf>,
    #[command(flatten)]
    json: JsonOutput,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let outputs = arguments
        .json
        .file()
        .into_iter()
        .chain(arguments.output.as_deref());
    let files = Files::claim(arguments.files.iter().map(PathBuf::as_path), outputs)?;
    let mut inspections = Vec::new();
    for file in &arguments.files {
        match inspect::inspect(file) {
            Ok(mut inspection) => {
                report::fill(&mut inspection);
                inspections.push(inspection);
            }
            Err(error) => terminal::error(&error.into()),
        }
    }
    if inspections.is_empty() {
        bail!("no file could be read");
    }
    let json = serde_json::to_string_pretty(&inspections)?;
    let shown = arguments.json.write(&files, &json)?;
    if !shown {
        for inspection in &inspections {
            terminal::say(report::text(inspection))?;
        }
    }
    if let Some(file) = &arguments.output {
        let home = file.parent().unwrap_or(std::path::Path::new(""));
        files.write(file, &report::drive_file(&inspections, home))?;
        terminal::say_beside(shown, format!("drive file: {}", file.display()))?;
    }
    if inspections.len() < arguments.files.len() {
        bail!("not every file could be read");
    }
    Ok(())
}
