//! `undrift outages`: cut the GNSS of a drive and compare bias models.

use crate::{
    drives::Source,
    navigate, print,
    progress::Bar,
    report::ResultOutput,
    style,
    terminal::{Invalid, note, say, stage, warn},
};
use anyhow::{Context, Result, anyhow, bail};
use clap::Args;
use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};
use undrift::{
    fleet::Choice,
    io::write::{SolutionFile, SolutionFormat, SolutionOptions, solution::SolutionRow},
    navigate::Hindsight,
    noise::{BiasModel, ImuModel},
    outages::{ComparedModel, Logs, Schedule, ScheduleError, USUAL_MODELS},
    replay::{Outage, STAMP_ROUNDING},
    results,
};
use undrift_report::{say as sentences, sentence_of, text};

/// Cut GNSS repeatedly on a drive and measure how far each bias model drifts.
///
/// Every bias model, or with several --model every noise model, navigates the drive with GNSS withheld during
/// the outages. Errors inside them, against the truth or else the withheld fixes, are reported as maximum, RMS
/// and median over the outages. By default also what each constraint and sensor beside GNSS saves: the last
/// model without it.
#[derive(Args)]
#[command(after_help = "Examples:
  undrift outages imu.csv gnss.pos --length 30
  undrift outages examples/rtk-drive.toml --data logs --length 10 --every 30 --start 40
  undrift outages examples/navego-adis16405.toml --data logs --every 24 --count 15
  undrift outages examples/drive30.toml --data target/drive30/seed1 --count 10 --bias-models white,arma
  undrift outages drive.toml --model rest.toml --model tuned.toml

tools/make-drive30 makes target/drive30/seed1.")]
pub struct Arguments {
    /// The drive file; or the logs of an IMU and a receiver, described as `undrift inspect` does
    #[arg(value_name = "DRIVE.toml|LOGS", required = true)]
    drive: Vec<PathBuf>,
    #[command(flatten)]
    common: navigate::Common,
    /// Noise model of the IMU: a model file or a preset (`undrift model --list`); repeated: models to compare
    #[arg(long, value_name = "IMU.toml")]
    model: Vec<String>,
    /// Bias models to compare, of white, paper, gauss-markov, random-walk, ar, arma; or all. Default:
    /// gauss-markov,random-walk,ar,arma; for several --model one, arma
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = bias_models)]
    bias_models: Option<Vec<Vec<BiasModel>>>,
    #[command(flatten)]
    plan: Cuts,
    /// Start times of the outages in the GNSS file's time [s], instead of --start, --count and --every
    #[arg(long, value_name = "T1,T2,…", allow_negative_numbers = true, value_delimiter = ',', conflicts_with_all = ["count", "every", "start"], help_heading = "Outages")]
    at: Option<Vec<f64>>,
    /// Smooth: measure the errors when the fixes after an outage are used too
    #[arg(long)]
    smooth: bool,
    /// Look ahead: study the errors of all fixes first, and find the mounting. Default: as while driving, from the log so far
    #[arg(long)]
    look_ahead: bool,
    /// Write the truth, or the fixes, with the outages marked: kml, geojson or gpx by extension
    #[arg(long, value_name = "track.kml")]
    track: Option<PathBuf>,
    #[command(flatten)]
    result: ResultOutput,
}

/// When GNSS is cut.
#[derive(Args)]
struct Cuts {
    /// Length of an outage [s]. Default: 10
    #[arg(long, value_name = "S", help_heading = "Outages")]
    length: Option<f64>,
    /// Number of outages; evenly spread without --every. Default: as many as fit
    #[arg(long, value_name = "N", help_heading = "Outages")]
    count: Option<usize>,
    /// From the start of one outage to the start of the next [s]. Default: three times the length
    #[arg(long, value_name = "S", help_heading = "Outages")]
    every: Option<f64>,
    /// Start of the first outage [s], counted from the first fix. Default: 60, sooner in a log of less than 180 s
    #[arg(long, value_name = "S", help_heading = "Outages")]
    start: Option<f64>,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let Cuts {
        length,
        count,
        every,
        start,
    } = arguments.plan;
    let length = length.unwrap_or(Choice::default().plan.length_s);
    let kinds = kinds(arguments)?;
    if let Some(path) = &arguments.track {
        track_format(path)?;
    }
    let asked = Schedule::asked(arguments.at.clone(), every, count, start);
    let outputs = arguments.result.files().chain(arguments.track.as_deref());
    let (Source { file, drive, .. }, models, files) = navigate::load(
        &arguments.drive,
        &arguments.common,
        &arguments.model,
        outputs,
    )?;
    let compared = compared(&arguments.model, models, &kinds);
    // Of models by name the drift of these is asked for.
    let without = arguments.bias_models.is_none() && arguments.model.len() < 2;
    let hindsight = Hindsight::asked(arguments.look_ahead, arguments.smooth);
    let logs = Logs::load(&drive, hindsight)
        .map_err(|error| anyhow!(sentences::unsolved(error.findings(), error)))?;
    if let Some(mounting) = &logs.mounting {
        note(sentences::estimated(&sentences::mounting(mounting)));
    }
    let cuts = logs.plan_or_usual(asked, length, start);
    let cuts = cuts.map_err(refused)?;
    let experiment = stage("navigation", || {
        let bar = Bar::new(
            "navigated",
            logs.samples(compared.len(), without),
            "samples",
        );
        let done = |more| bar.add(more);
        logs.compare(&compared, &cuts, hindsight, without, &done)
            .map_err(anyhow::Error::from)
    })?;
    let mut runs = experiment
        .runs
        .iter()
        .filter_map(|(_, run)| run.as_ref().ok());
    if let Some(found) = runs.find_map(|run| sentences::found(&run.summary.mountings)) {
        note(sentences::estimated(&found));
    }
    let result = logs.result(&file, &experiment, &sentence_of(drive.poses.is_some()));
    print::judge(&result.findings);
    let json = results::text(&result);
    if !arguments.result.write(&files, &json)? {
        say(sentences::verdict_of(&result.findings, result.drive.posed))?;
        say(sentences::hindsight(result.look_ahead, result.smooth))?;
        say(text::outages(&result, style::heading))?;
    }
    // One reason for all of them is in the warning that they could not be run.
    let reasons = BTreeSet::from_iter(result.failed.values());
    if reasons.len() > 1 {
        let failed = result.failed.iter();
        failed.for_each(|(name, why)| warn(format!("{name}: {why}")));
    }
    result.warnings.iter().for_each(warn);
    if let Some(path) = &arguments.track {
        write_track(path, &logs, &experiment.cuts, &file)
            .with_context(|| format!("cannot write {}", path.display()))?;
    }
    if result.models.is_empty() {
        bail!(sentences::no_result(&result.findings));
    }
    Ok(())
}

/// The bias models to run: of several noise models the same one.
fn kinds(arguments: &Arguments) -> Result<Vec<BiasModel>, Invalid> {
    let asked = arguments.bias_models.as_ref().map(|names| names.concat());
    match (arguments.model.as_slice(), asked) {
        ([_, _, ..], Some(kinds)) if kinds.len() > 1 => Err(Invalid(format!(
            "{} --model are compared as one bias model, but --bias-models has {}: specify one of them, or one --model",
            arguments.model.len(),
            kinds.len()
        ))),
        ([_, _, ..], None) => Ok(vec![BiasModel::Arma]),
        (_, asked) => Ok(asked.unwrap_or(USUAL_MODELS.to_vec())),
    }
}

/// What is compared: bias models, or the noise models of these names.
fn compared(names: &[String], models: Vec<ImuModel>, kinds: &[BiasModel]) -> Vec<ComparedModel> {
    match kinds {
        [kind] if models.len() > 1 => {
            let names = names.iter().map(|name| navigate::stem(Path::new(name)));
            ComparedModel::each(names.zip(models), *kind)
        }
        kinds => kinds.iter().copied().map(Into::into).collect(),
    }
}

/// The bias models of a name.
fn bias_models(name: &str) -> Result<Vec<BiasModel>, String> {
    match name {
        "all" => Ok(BiasModel::ALL.to_vec()),
        name => {
            let model = name.parse::<BiasModel>();
            model
                .map(|model| vec![model])
                .map_err(|error| error.to_string())
        }
    }
}

/// What no log could be cut by is a mistake of the command line.
fn refused(error: ScheduleError) -> anyhow::Error {
    use ScheduleError::{Every, Length, Start, Zero};
    match error {
        Length(_) | Start(_) | Every(_) | Zero => Invalid(error.to_string()).into(),
        _ => error.into(),
    }
}

/// The format of the track, known before anything is run.
fn track_format(path: &Path) -> Result<SolutionFormat, Invalid> {
    SolutionFormat::from_path(path)
        .filter(|format| format.is_map())
        .ok_or_else(|| {
            let path = path.display();
            Invalid(format!("--track {path}: must be .kml, .geojson or .gpx"))
        })
}

fn write_track(path: &Path, logs: &Logs, cuts: &[Outage], drive: &Path) -> Result<()> {
    let options = SolutionOptions {
        epoch: logs.drive.epoch,
        name: navigate::stem(drive),
        ..SolutionOptions::default()
    };
    let mut file = SolutionFile::create(path, track_format(path)?, &options)?;
    for sample in logs.track() {
        let next = cuts.partition_point(|cut| cut.end + STAMP_ROUNDING < sample.time);
        let outage = cuts.get(next).is_some_and(|cut| cut.contains(sample.time));
        file.write(&SolutionRow::at(sample.time, sample.position), outage)?;
    }
    Ok(file.finish()?)
}
