//! `undrift navigate`: one drive into one solution.

use crate::{
    details,
    drives::{Kept, Source},
    output::{self, Files},
    print,
    progress::Bar,
    report::ResultOutput,
    terminal::{Invalid, say, stage, warn},
};
use anyhow::{Result, anyhow, bail};
use clap::Args;
use std::path::{Path, PathBuf};
use undrift::{
    drive::Drive,
    findings::Finding,
    io::write::{SolutionFile, SolutionFormat, SolutionOptions},
    navigate::{self, Clock, Hindsight, Wanted},
    noise::{BiasModel, ImuModel},
    results,
};
use undrift_report::{say as sentences, sentence_of, text};

/// Navigate a drive: IMU and GNSS into position, velocity and attitude.
///
/// The drive file specifies the files, their columns and units, and the mounting of the IMU
/// (docs/drive-file.md). A summary is printed; -o writes the solution.
#[derive(Args)]
#[command(after_help = "Examples:
  undrift navigate examples/rtk-drive.toml --data logs -o nav.csv -o nav.kml
  undrift navigate examples/drive30.toml --data target/drive30/seed1 --smooth --json -
  undrift navigate examples/uav-flight.toml --data logs --bias-model gauss-markov -v
  undrift navigate imu.csv gnss.pos --save-drive drive.toml -o nav.csv

tools/make-drive30 makes target/drive30/seed1.")]
pub struct Arguments {
    /// The drive file; or the logs of an IMU and a receiver, described as `undrift inspect` does; or a recording of `undrift live`
    #[arg(value_name = "DRIVE.toml|LOGS", required = true)]
    drive: Vec<PathBuf>,
    #[command(flatten)]
    common: Common,
    /// Noise model of the IMU: a model file or a preset (`undrift model --list`)
    #[arg(long, value_name = "IMU.toml")]
    model: Option<String>,
    /// Bias model: white, paper, gauss-markov, random-walk, ar or arma
    #[arg(long, value_name = "NAME", default_value = "arma")]
    bias_model: BiasModel,
    /// Write the solution, in the format of the extension: csv (every sample, with standard deviations
    /// and estimated sensor errors), nav (KF-GINS), nmea, kml, geojson, gpx, mcap, parquet, sbet, jsonl, mavlink, tum (of poses); repeatable
    #[arg(short, long, value_name = "nav.csv", help_heading = "Output")]
    output: Vec<PathBuf>,
    /// Format of the solution regardless of the extension: csv, kf-gins, nmea, kml, geojson, gpx, mcap, parquet, sbet, jsonl, mavlink or tum
    #[arg(long, value_name = "NAME", help_heading = "Output")]
    format: Option<SolutionFormat>,
    /// Minimum time between rows of the solution [s]; 0: every sample. Default: 0, but 0.1 for nmea,
    /// kml, geojson and gpx
    #[arg(long, value_name = "S", help_heading = "Output")]
    every: Option<f64>,
    /// Smooth: use the whole log for the estimate at every sample
    #[arg(long)]
    smooth: bool,
    /// Look ahead: study the errors of all fixes first, and find the mounting. Default: as while driving, from the log so far
    #[arg(long)]
    look_ahead: bool,
    /// Whose times the solution has: imu, as the samples are stamped, or gnss, as the fixes are. Default: imu, and where the two
    /// differ the standard deviations contain it
    #[arg(long, value_name = "NAME", help_heading = "Output")]
    clock: Option<Clock>,
    #[command(flatten)]
    result: ResultOutput,
}

/// Options of every verb on a drive.
#[derive(Args)]
pub struct Common {
    /// Folder of the log files. Default: that of the drive file
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
    #[command(flatten)]
    kept: Kept,
}

/// The drive with the first of the models that the command line asks for, all of these, and the files of the run.
pub fn load<'a>(
    sources: &[PathBuf],
    common: &'a Common,
    models: &[String],
    outputs: impl IntoIterator<Item = &'a Path>,
) -> Result<(Source, Vec<ImuModel>, Files)> {
    let mut source = Source::open(
        sources,
        common.data.as_deref(),
        &common.kept,
        models.first().map(String::as_str),
    )?;
    let read = models
        .iter()
        .map(|name| ImuModel::resolve(name, Path::new("")));
    let read = read.collect::<Result<Vec<_>, _>>()?;
    if let Some(first) = read.first() {
        source.drive.model = Some(first.clone());
    }
    let models = models.iter().map(Path::new);
    let named = sources.iter().map(PathBuf::as_path);
    let inputs = named.chain(source.drive.logs()).chain(models);
    let files = Files::claim(inputs, outputs.into_iter().chain(common.kept.file()))?;
    source.save(&files, &common.kept)?;
    details::drive(&source);
    Ok((source, read, files))
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let solutions = arguments.output.iter().map(PathBuf::as_path);
    let written = arguments.result.files().chain(solutions);
    #[cfg(not(target_family = "wasm"))]
    if let [path] = arguments.drive.as_slice()
        && let Some(recorded) = crate::live::Recorded::open(path)?
    {
        return again(arguments, path, recorded);
    }
    let (Source { file, drive, .. }, _, files) = load(
        &arguments.drive,
        &arguments.common,
        arguments.model.as_slice(),
        written,
    )?;
    let recording = arguments.result.is_wanted();
    let report = stage("navigation", || {
        let _bar = Bar::watching(
            drive.imu_read.bytes(),
            &results::name(&drive.imu.0),
            details::size(&drive.imu.0),
            "bytes",
        );
        let wanted = Wanted {
            files: outputs(arguments, &file, &drive)?,
            hindsight: Hindsight::asked(arguments.look_ahead, arguments.smooth),
            clock: arguments.clock.unwrap_or_default(),
            recording,
            ..navigate::Wanted::default()
        };
        navigate::navigate(&drive, arguments.bias_model, wanted)
            .map_err(|error| anyhow!(sentences::unsolved(error.findings(), error)))
    })?;
    let about = drive.result(&file);
    let result = report.result(
        arguments.bias_model,
        about,
        &sentence_of(drive.poses.is_some()),
    );
    print::judge(&result.findings);
    let shown = recording && arguments.result.write(&files, &results::text(&result))?;
    if !shown {
        say(text::navigate(&result))?;
        // How it ends comes last.
        let findings = result.findings.iter().zip(&result.warnings);
        let found = findings.filter(|(of, _)| !matches!(of, Finding::Diverged { .. }));
        found.for_each(|(_, sentence)| warn(sentence));
        for path in &arguments.output {
            say(format!("solution: {}", output::shown(path)))?;
        }
    }
    match result.summary.diverged {
        Some(time) => bail!(sentences::ended(time, &result.findings)),
        None => Ok(()),
    }
}

/// The solution of a recorded live run again, to the last bit: what would change it is refused.
#[cfg(not(target_family = "wasm"))]
fn again(arguments: &Arguments, path: &Path, recorded: crate::live::Recorded) -> Result<()> {
    let others = [
        (arguments.smooth, "--smooth"),
        (arguments.look_ahead, "--look-ahead"),
        (arguments.model.is_some(), "--model"),
        (arguments.clock.is_some(), "--clock"),
        (arguments.common.data.is_some(), "--data"),
        (arguments.common.kept.file().is_some(), "--save-drive"),
        (
            arguments.result.is_wanted(),
            "--json, --report and --figures",
        ),
    ];
    if let Some((_, option)) = others.into_iter().find(|(is_asked, _)| *is_asked) {
        bail!(Invalid(format!(
            "{}: a recording of undrift live gives its run again, which {option} cannot change; for that navigate the logs",
            path.display()
        )));
    }
    let solutions = arguments.output.iter().map(PathBuf::as_path);
    Files::claim([path], solutions)?;
    let line = recorded.navigate(&mut |drive| outputs(arguments, path, drive))?;
    say(line)?;
    for path in &arguments.output {
        say(format!("solution: {}", output::shown(path)))?;
    }
    Ok(())
}

/// The files that were asked for.
fn outputs(arguments: &Arguments, file: &Path, drive: &Drive) -> Result<Vec<SolutionFile>> {
    if arguments.format.is_some() && arguments.output.len() > 1 {
        let mistake = "--format needs a single -o; several are written by their extensions";
        bail!(Invalid(mistake.into()));
    }
    let options = SolutionOptions {
        epoch: drive.epoch,
        name: stem(file),
        every: arguments.every,
        frame: drive.pose_frame(),
    };
    let unknown = |path: &PathBuf| {
        let is_standard = path == Path::new("-");
        arguments.format.is_none() && !is_standard && SolutionFormat::from_path(path).is_none()
    };
    let files = SolutionFile::create_all(&arguments.output, arguments.format, &options);
    files.map_err(|problem| match arguments.output.iter().any(unknown) {
        true => Invalid(problem).into(),
        false => anyhow!(problem),
    })
}

/// The name of a file without folder and extension.
pub fn stem(path: &Path) -> String {
    path.file_stem()
        .map(|name| name.to_string_lossy().into_owned())
        .unwrap_or_default()
}
