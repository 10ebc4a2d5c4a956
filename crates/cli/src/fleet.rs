//! `undrift fleet`: many logs, on all cores.

use crate::{
    output::{self, Files},
    progress::Bar,
    report::{ResultOutput, write_page},
    style,
    terminal::{self, detail, say, stage, warn},
};
use anyhow::{Result, bail};
use clap::{Args, ValueEnum};
use std::{
    fmt::Write as _,
    path::{Path, PathBuf},
    sync::atomic::{AtomicUsize, Ordering::Relaxed},
};
use undrift::{
    fleet::{self, Choice, Job, Manifest, Options},
    noise::BiasModel,
    results::{self, Fleet},
};
use undrift_report::{say as sentences, short};

/// What is done with drives.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Task {
    /// Cut their GNSS, as `undrift outages` does
    Outages,
    /// Navigate them, as `undrift navigate` does
    Navigate,
}

/// Process many logs: all cores, what is up to date left out, one table and one report.
///
/// The logs are those of a manifest (docs/fleet.md), or drive files by name or pattern. Each one's
/// result is kept in a file of its own in the folder; one that fails stops none of the others, and a
/// run that was ended goes on where it was.
#[derive(Args)]
#[command(after_help = "Examples:
  undrift fleet fleet.toml -o out
  undrift fleet \"logs/*/drive.toml\" -o out --unit {folder} --length 10 --every 30 --bias-models white,arma
  undrift fleet fleet.toml -o out --shard 3/16
  undrift fleet fleet.toml -o out --gather --report fleet.html")]
pub struct Arguments {
    /// A manifest, or drive files by name or pattern
    #[arg(value_name = "MANIFEST.toml|GLOB", required = true)]
    logs: Vec<String>,
    /// Write results.parquet, fleet.json, fleet.html and each log's result into this folder
    #[arg(short, long, value_name = "DIR", help_heading = "Output")]
    output: PathBuf,
    /// Process one of N shards of the logs only, for N processes or machines that share the folder
    #[arg(long, value_name = "I/N", value_parser = shard, conflicts_with_all = ["gather", "json", "report", "figures"])]
    shard: Option<(usize, usize)>,
    /// Process nothing, but make table and report of results that shards have left
    #[arg(long)]
    gather: bool,
    /// Process again what failed
    #[arg(long, conflicts_with = "gather")]
    retry_failed: bool,
    /// Threads, and logs at a time; 0 for as many as there are cores
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u16).range(..=4096))]
    threads: u16,
    /// What is done with drives; the manifest's word or outages if absent
    #[arg(long, value_name = "VERB", value_enum)]
    task: Option<Task>,
    /// Serial number of the IMU; {stem}, {folder} and {parent} in it are parts of the log's name
    #[arg(long, value_name = "TEXT")]
    unit: Option<String>,
    /// Folder of the drives' log files, if not the drive files' own; {stem}, {folder}, {parent} as above
    #[arg(long, value_name = "DIR")]
    data: Option<String>,
    /// Noise model of the IMU: a model file or a preset
    #[arg(long, value_name = "IMU.toml")]
    model: Option<String>,
    /// Bias models to compare
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    bias_models: Option<Vec<BiasModel>>,
    /// Length of an outage [s]
    #[arg(long, value_name = "S", help_heading = "Outages")]
    length: Option<f64>,
    /// Number of outages in each drive; evenly spread unless --every is given
    #[arg(long, value_name = "N", help_heading = "Outages")]
    count: Option<usize>,
    /// From the start of one outage to the start of the next [s]
    #[arg(long, value_name = "S", help_heading = "Outages")]
    every: Option<f64>,
    /// Start of the first outage [s], counted from the first fix
    #[arg(long, value_name = "S", help_heading = "Outages")]
    start: Option<f64>,
    #[command(flatten)]
    result: ResultOutput,
}

/// Which one of how many.
fn shard(text: &str) -> Result<(usize, usize), String> {
    let numbers = text.split_once('/');
    let parsed = numbers.and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
    match parsed {
        Some((i, n)) if 1 <= i && i <= n => Ok((i, n)),
        _ => Err("write I/N, from 1/N to N/N".into()),
    }
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let inputs = arguments.logs.iter().map(Path::new);
    let files = Files::claim(inputs, arguments.result.files())?;
    let folder = &arguments.output;
    output::make_folder(folder)?;
    let mut jobs = jobs(arguments)?;
    let all = jobs.len();
    if let Some((which, of)) = arguments.shard {
        jobs = fleet::shard(jobs, which, of);
    }
    let options = Options {
        threads: usize::from(arguments.threads),
        retry_failed: arguments.retry_failed,
        look_only: arguments.gather,
    };
    let failed = AtomicUsize::new(0);
    let done = stage("processing", || {
        let bar = Bar::new("processed", jobs.len() as u64, "logs");
        fleet::run(&jobs, folder, options, sentences::outcome, |outcome| {
            bar.add(1);
            let Some(outcome) = outcome else { return };
            if let Some(why) = &outcome.failed {
                failed.fetch_add(1, Relaxed);
                detail(1, || format!("{} failed: {why}", outcome.log));
            } else {
                detail(1, || format!("{} done", outcome.log));
            }
        })
    })?;
    if let Some(first) = done.first_missing {
        bail!(fleet::FleetError::Missing {
            missing: done.missing,
            all,
            first,
        });
    }
    let line = format!(
        "{} logs processed, {} up to date",
        done.processed, done.skipped
    );
    if let Some((which, of)) = arguments.shard {
        let failed = failed.into_inner();
        if failed > 0 {
            terminal::doubt();
            warn(format!(
                "{failed} logs of the shard failed; --gather tells which"
            ));
        }
        return say(format!("shard {which} of {of}: {line}"));
    }
    let result = stage("gathering", || fleet::gather(&done.fingerprints, folder))?;
    let json = results::text(&result);
    write_page(&files, &folder.join("fleet.html"), &json)?;
    if !arguments.result.write(&files, &json)? {
        say(line)?;
        say(summary(&result))?;
        say(format!(
            "results.parquet, fleet.json and fleet.html: {}",
            folder.display()
        ))?;
    }
    tell_troubles(&result);
    if result.failed.len() == done.fingerprints.len() {
        bail!("no log could be processed");
    }
    Ok(())
}

/// The jobs of the manifest or of the drive files.
fn jobs(arguments: &Arguments) -> Result<Vec<Job>> {
    let change = |choice: &mut Choice| override_by(choice, arguments);
    if let [file] = arguments.logs.as_slice()
        && let Ok(text) = std::fs::read_to_string(file)
        && is_manifest(&text)
    {
        let manifest = Manifest::from_toml(&text, file, change)?;
        let folder = Path::new(file).parent().unwrap_or(Path::new(""));
        return Ok(manifest.jobs(&folder.to_string_lossy(), Manifest::matching)?);
    }
    let mut choice = Choice::default();
    change(&mut choice);
    Ok(fleet::drives(&arguments.logs, &choice)?)
}

/// Whether a text is a manifest rather than a drive file; what is neither is refused as a manifest.
fn is_manifest(text: &str) -> bool {
    toml::from_str(text).is_ok_and(|table: toml::Table| !table.contains_key("imu"))
}

/// The command line has the last word.
fn override_by(choice: &mut Choice, arguments: &Arguments) {
    if let Some(task) = arguments.task {
        choice.outages = task == Task::Outages;
    }
    for (slot, stated) in [
        (&mut choice.unit, &arguments.unit),
        (&mut choice.data, &arguments.data),
        (&mut choice.model, &arguments.model),
    ] {
        if stated.is_some() {
            slot.clone_from(stated);
        }
    }
    if let Some(models) = &arguments.bias_models {
        choice.bias_models.clone_from(models);
    }
    let plan = &mut choice.plan;
    plan.length_s = arguments.length.unwrap_or(plan.length_s);
    plan.start_s = arguments.start.unwrap_or(plan.start_s);
    if arguments.every.is_some() || arguments.count.is_some() {
        (plan.every_s, plan.count) = (arguments.every, arguments.count);
    }
}

/// What is told one by one of a longer list.
const TOLD: usize = 10;

fn tell_troubles(result: &Fleet) {
    if result.failed.len() + result.untrusted.len() > 0 {
        terminal::doubt();
    }
    for troubles in [&result.failed, &result.untrusted] {
        let mut told: Vec<(&str, Vec<&str>, &str)> = Vec::new();
        for trouble in troubles {
            let part = trouble.part.as_deref().unwrap_or_default();
            match told.last_mut() {
                Some((log, parts, why)) if *log == trouble.log && *why == trouble.why => {
                    parts.push(part)
                }
                _ => told.push((&trouble.log, vec![part], &trouble.why)),
            }
        }
        let more = told.len().saturating_sub(TOLD);
        for (log, parts, why) in told.into_iter().take(TOLD) {
            match parts.join(", ").as_str() {
                "" => warn(format!("{log}: {why}")),
                parts => warn(format!("{log}, {parts}: {why}")),
            }
        }
        if more > 0 {
            warn(format!("and {more} more; fleet.html names them"));
        }
    }
}

/// The measures as tables, and who stands out.
fn summary(result: &Fleet) -> String {
    let mut blocks = Vec::new();
    for measure in &result.measures {
        let name = measure.name.replace('_', " ");
        let name = match measure.unit.as_str() {
            "" => name,
            unit => format!("{name} [{unit}]"),
        };
        // Writing into a String cannot fail.
        let mut table = format!("{}\n", measure.what);
        let heading = format!(
            "{name:28} {:>7} {:>10} {:>10} {:>9}",
            "logs", "median", "limit", "above"
        );
        let _ = writeln!(table, "{}", style::heading(&heading));
        let mut named: Vec<&str> = Vec::new();
        for part in &measure.parts {
            let _ = writeln!(
                table,
                "{:28} {:>7} {:>10} {:>10} {:>9}",
                part.part,
                part.logs,
                short(part.median.0),
                short(part.limit.0),
                part.outliers.len()
            );
            for outlier in &part.outliers {
                if !named.contains(&outlier.log.as_str()) {
                    named.push(&outlier.log);
                }
            }
        }
        if !named.is_empty() {
            let more = named.len().saturating_sub(TOLD);
            named.truncate(TOLD);
            let more = if more > 0 {
                format!(" and {more} more")
            } else {
                String::new()
            };
            let _ = writeln!(table, "standing out: {}{more}", named.join(", "));
        }
        blocks.push(table);
    }
    blocks.join("\n")
}
