//! `undrift inspect`: what a file is, and a starter drive file for it.

use crate::{
    output::{Files, JsonOutput},
    terminal,
};
use anyhow::{Result, bail};
use clap::Args;
use std::{fmt::Write as _, path::PathBuf};
use undrift::inspect::{self, Inspection, Part};
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
            terminal::say(text(inspection).trim_end())?;
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

fn text(inspection: &Inspection) -> String {
    let mut text = format!(
        "{}: {}\n",
        inspection.file.display(),
        inspection.description
    );
    for (name, messages, about) in &inspection.streams {
        let _ = writeln!(text, "  {name}: {messages} messages, {about}");
    }
    for part in &inspection.parts {
        write_part(&mut text, part);
    }
    for note in &inspection.notes {
        let _ = writeln!(text, "  note: {note}");
    }
    text
}

fn write_part(text: &mut String, part: &Part) {
    let _ = write!(text, "  [{}]", part.table);
    if let Some(m) = &part.measured {
        let _ = write!(
            text,
            " {} records at {} Hz, {:.3} s to {:.3} s",
            m.records,
            short(m.rate_hz),
            m.first_s,
            m.last_s
        );
        match m.longest_gap_s {
            Some((start, length)) => {
                let _ = write!(
                    text,
                    "; gaps: {}, the longest {length:.3} s from {start:.3} s",
                    m.gaps
                );
            }
            None => text.push_str("; no gaps"),
        }
    }
    text.push('\n');
    let width = part.lines.iter().map(|line| line.key.len()).max();
    for line in &part.lines {
        let _ = write!(
            text,
            "    {:width$} = {}",
            line.key,
            line.value,
            width = width.unwrap_or(0)
        );
        if !line.why.is_empty() {
            let _ = write!(text, "   # {}", line.why);
        }
        text.push('\n');
    }
    if let Some(m) = &part.measured {
        for remark in m
            .remarks
            .iter()
            .map(String::as_str)
            .chain(m.skipped.lines())
        {
            let _ = writeln!(text, "    {remark}");
        }
    }
    if let Some(problem) = &part.problem {
        let _ = writeln!(text, "    cannot be read: {problem}");
    }
}

/// A rate to its fourth decimal, without the zeros at its end.
fn short(rate_hz: f64) -> f64 {
    (rate_hz * 1e4).round() / 1e4
}
