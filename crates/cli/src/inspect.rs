//! `undrift inspect`: what a file is, and a starter drive file for it.

use crate::{
    output::{self, Files, JsonOutput},
    terminal,
};
use anyhow::{Result, bail};
use clap::Args;
use std::path::{Path, PathBuf};
use undrift::{
    inspect::{self, Inspection, Motion, Part},
    results,
    vehicle::Profile,
};
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
    let inspections = read(&arguments.files)?;
    let unread = inspections.len() < arguments.files.len();
    let (inspections, motion) = described(inspections);
    let json = results::text(&Vec::from_iter(inspections.iter().map(report::shown)));
    let shown = arguments.json.write(&files, &json)?;
    if !shown {
        if let Some(first) = report::lead(&inspections) {
            terminal::say(first)?;
        }
        for inspection in &inspections {
            terminal::say(report::text(inspection))?;
        }
    }
    if let Some(file) = &arguments.output {
        let home = file.parent().unwrap_or(Path::new(""));
        let model = inspect::model(&inspections);
        let vehicle = arguments.vehicle;
        let text = inspect::drive_file(
            &model,
            &inspections,
            home,
            vehicle,
            motion,
            &report::comment,
        );
        files.write(file, &text)?;
        terminal::say(format!("drive file: {}", output::shown(file)))?;
        complete(&inspections, Some(file))?;
        terminal::say(report::next(&model, motion, file))?;
    }
    if unread {
        bail!("not every file could be read");
    }
    Ok(())
}

/// Describes files; unreadable ones are reported and skipped.
pub fn read(files: &[PathBuf]) -> Result<Vec<Inspection>> {
    let mut inspections = Vec::new();
    for file in files {
        match inspect::inspect(file) {
            Ok(inspection) => inspections.push(inspection),
            Err(error) => terminal::error(&error.into()),
        }
    }
    if inspections.is_empty() {
        bail!("no file could be read");
    }
    Ok(inspections)
}

/// What files are, and what the motion shows of them together.
pub fn described(mut inspections: Vec<Inspection>) -> (Vec<Inspection>, Motion) {
    let motion = terminal::stage("aligning", || inspect::motion(&mut inspections));
    // Of two files that were joined, the one that stands for both.
    let joined = inspections.iter().filter(|file| !file.parts.is_empty());
    let joined = Vec::from_iter(joined.map(|file| file.file.clone()));
    inspections.retain(|file| !file.parts.is_empty() || !joined.contains(&file.file));
    (inspections, motion)
}

/// Refuses logs that lack what a drive needs: an IMU and fixes. `drive` is the drive file made of them.
pub fn complete(inspections: &[Inspection], drive: Option<&Path>) -> Result<()> {
    let names: Vec<_> = inspections
        .iter()
        .map(|log| output::shown(&log.file))
        .collect();
    let unknown = |table| report::unknown_log(inspections, table);
    let fixes = inspect::fixes_table(inspections);
    let is_reference = |file: &&Inspection| file.parts.iter().any(|part| part.table == "truth");
    if let (None, Some(why)) = (drive, report::without_gravity(inspections)) {
        bail!("{why}");
    }
    let reference = inspections
        .iter()
        .find(is_reference)
        .map(|file| file.file.as_path());
    for (table, what) in [("imu", "inertial samples"), (fixes, "positions")] {
        let mut parts = inspections.iter().flat_map(|file| &file.parts);
        match parts.find(|part| part.table == table) {
            Some(Part {
                problem: Some(problem),
                ..
            }) => bail!("the {what} cannot be read: {problem}"),
            Some(_) => {}
            None if table != "imu" && reference.is_some() => bail!(
                "no {what} to use in {}: {} has an attitude beside its positions, so it is a reference ([truth]); write [gnss] by hand to use it as fixes",
                names.join(" and "),
                reference.map_or_else(Default::default, output::shown)
            ),
            None if unknown(table).is_some() => bail!(
                "no {what} in {}: {}",
                names.join(" and "),
                unknown(table).unwrap_or_default()
            ),
            None => bail!(
                "no {what} in {}{}: specify their log too, as in `undrift inspect {} LOG -o drive.toml`, or write [{table}] by hand",
                names.join(" and "),
                drive.map_or(String::new(), |drive| format!(
                    ", so {} lacks [{table}]",
                    output::shown(drive)
                )),
                names.join(" ")
            ),
        }
    }
    Ok(())
}
