//! `undrift tune`: the noise of the sensor in its vehicle, from drives.

use crate::{
    details,
    drives::{Kept, Source},
    output::{Files, shown},
    progress::Bar,
    report::ResultOutput,
    style,
    terminal::{self, Invalid, detail, note, say, stage},
};
use anyhow::{Context, Result, anyhow, bail};
use clap::Args;
use std::path::{Path, PathBuf};
use undrift::{
    drive::Drive,
    noise::ImuModel,
    results,
    tune::{self, Options, Stage},
};
use undrift_report::{say as sentences, text, usable};

/// Identify the noise of a sensor in its vehicle from drives, and tune the filter with it.
///
/// Noise in a vehicle is several times that of a static recording or a data sheet, and differs by axis. It is
/// estimated from the errors at the end of spans of 1 to 30 s whose fixes are withheld. The gain is measured on
/// held-out outages (docs/tune.md).
#[derive(Args)]
#[command(after_help = "Examples:
  undrift tune drive.toml -o tuned.toml
  undrift tune imu.csv gnss.pos -o tuned.toml
  undrift tune monday.toml tuesday.toml --model imu.toml --hold-out 0.3 --model-out vehicle.toml
  undrift tune examples/rtk-drive-car.toml --data logs --json tune.json --report tune.html")]
pub struct Arguments {
    /// Drive files of one sensor in one vehicle; or the logs of one drive, described as `undrift inspect` does
    #[arg(value_name = "DRIVE.toml|LOGS", required = true)]
    drives: Vec<PathBuf>,
    /// Folder of the log files, one for all drives or one for each in order. Default: that of the drive file
    #[arg(long, value_name = "DIR")]
    data: Vec<PathBuf>,
    /// The sensor at rest: a model file or a preset. Default: the first drive's model, else a guess from its quietest
    /// seconds
    #[arg(long, value_name = "IMU.toml")]
    model: Option<String>,
    /// Hold out this share at the end of each drive, 0 to 0.9. Default: the drift is measured on the second half
    /// after a fit of the first, and the noise is fitted to the whole
    #[arg(long, value_name = "SHARE")]
    hold_out: Option<f64>,
    /// Write the tuned drive file for navigate and outages; with several drives the first, or all of them into a
    /// folder
    #[arg(short, long, value_name = "tuned.toml|DIR", help_heading = "Output")]
    output: Option<PathBuf>,
    /// Write the model of the sensor in its vehicle
    #[arg(long, value_name = "IMU.toml", help_heading = "Output")]
    model_out: Option<PathBuf>,
    #[command(flatten)]
    kept: Kept,
    #[command(flatten)]
    result: ResultOutput,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    if let Some(problem) = sentences::hold_out("--hold-out", arguments.hold_out) {
        bail!(Invalid(problem));
    }
    let (folders, drives) = (arguments.data.len(), arguments.drives.len());
    if folders > 1 && folders != drives {
        bail!(Invalid(format!(
            "--data occurs {folders} times for {drives} drives: set it once, or once for each drive"
        )));
    }
    let sources = Source::of_each(
        &arguments.drives,
        &arguments.data,
        &arguments.kept,
        arguments.model.as_deref(),
    )?;
    sources.iter().for_each(details::drive);
    let model = arguments.model.as_deref();
    let start = model
        .map(|name| ImuModel::resolve(name, Path::new("")))
        .transpose()?;
    let tuned = tuned_files(arguments, &sources)?;
    let written = tuned.iter().map(|(_, to)| to.as_path());
    let written = written.chain(arguments.model_out.as_deref());
    let written = written.chain(arguments.kept.file());
    let inputs = arguments.drives.iter().map(PathBuf::as_path);
    let inputs = inputs.chain(sources.iter().flat_map(|source| source.drive.logs()));
    let files = Files::claim(
        inputs.chain(model.map(Path::new)),
        arguments.result.files().chain(written),
    )?;
    sources
        .iter()
        .try_for_each(|source| source.save(&files, &arguments.kept))?;
    let drives: Vec<Drive> = sources.iter().map(|source| source.drive.clone()).collect();
    let options = Options {
        start,
        hold_out: arguments.hold_out,
    };
    let (found, logs) = stage("tuning", || {
        let bar = Bar::new("evaluated", 0, "iterations");
        let progress = |at: Stage| {
            bar.add(1);
            detail(1, || match at {
                Stage::Reading => "reading the logs".to_owned(),
                Stage::Fitting(value) => format!("fitting: objective {value:.2}"),
                Stage::Judging => "measuring the drift on the held-out part".to_owned(),
            });
            true
        };
        tune::tune(&drives, &options, &progress)
            .map_err(|error| anyhow!(sentences::unsolved(error.findings(), error)))
    })?;
    for logs in &logs {
        if let Some(mounting) = &logs.mounting {
            note(sentences::estimated(&sentences::mounting(mounting)));
        }
    }
    let paths = sources.iter().map(|source| source.file.as_path());
    let mut result = found.result(paths.zip(&drives));
    result.tuned = arguments.output.as_deref().map(shown);
    if !usable::tune(&result) {
        terminal::doubt();
    }
    let json = results::text(&result);
    if !arguments.result.write(&files, &json)? {
        say(text::tune(&result, style::heading))?;
    }
    let names: Vec<String> = sources
        .iter()
        .map(|source| results::name(&source.file))
        .collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let model = found.model(&names);
    if let Some(path) = &arguments.model_out {
        files.write(path, &found.steady_model(&names).to_toml())?;
    }
    for (from, to) in tuned {
        let file = &from.file;
        // With --data the logs stay there.
        let moved = arguments.data.is_empty() && folder(file).ok() != folder(&to).ok();
        let logs = moved.then(|| folder(file)).transpose()?;
        let text = match usable::tuned_is_worse(&result) {
            true => tune::file::unchanged(&from.text()?, logs.as_deref()),
            false => tune::file::tuned(&from.text()?, &found, &model, logs.as_deref()),
        };
        let text = text.with_context(|| format!("cannot change {}", file.display()))?;
        files.write(&to, &text)?;
    }
    Ok(())
}

fn folder(file: &Path) -> std::io::Result<PathBuf> {
    let folder = file.parent().filter(|folder| *folder != Path::new(""));
    folder.unwrap_or(Path::new(".")).canonicalize()
}

/// Drive files and where their tuned versions are written.
fn tuned_files<'a>(
    arguments: &Arguments,
    sources: &'a [Source],
) -> Result<Vec<(&'a Source, PathBuf)>> {
    let Some(output) = &arguments.output else {
        return Ok(Vec::new());
    };
    if !output.is_dir() {
        let first = sources.iter().take(1);
        return Ok(first.map(|source| (source, output.clone())).collect());
    }
    let mut files: Vec<(&Source, PathBuf)> = Vec::new();
    for source in sources {
        let to = output.join(source.file.file_name().unwrap_or_default());
        if let Some((other, _)) = files.iter().find(|(_, file)| *file == to) {
            bail!(
                "-o {}: {} and {} have the same file name; give one -o file, or rename one of them",
                output.display(),
                other.file.display(),
                source.file.display()
            );
        }
        files.push((source, to));
    }
    Ok(files)
}
