//! `undrift fleet`: many logs, on all cores.

use crate::{
    output::{self, Files},
    progress::Bar,
    report::{ResultOutput, write_drawn},
    style,
    terminal::{self, Invalid, detail, note, say, stage, warn},
};
use anyhow::{Result, bail};
use clap::{Args, ValueEnum};
use std::{
    io::IsTerminal,
    path::{Path, PathBuf},
    sync::{
        Mutex,
        atomic::{AtomicUsize, Ordering::Relaxed},
    },
    time::Instant,
};
use undrift::{
    fleet::{self, Choice, Job, Lookup, Manifest, Options, Verb},
    noise::BiasModel,
    results::{self, Fleet},
};
use undrift_report::{html, sentence, text};

/// What to do with the drives.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Task {
    /// Cut their GNSS, as `undrift outages` does
    Outages,
    /// Navigate them, as `undrift navigate` does
    Navigate,
    /// Identify the noise in each one's vehicle, as `undrift tune` does
    Tune,
}

/// Process many logs on all cores into one table and one report; up-to-date results are skipped.
///
/// The logs come from a manifest (docs/fleet.md), or are drive files by name or pattern. Each result is
/// kept in its own file in the folder. A log that fails does not stop the others, and an interrupted run
/// can be resumed.
#[derive(Args)]
#[command(after_help = "Examples:
  undrift fleet fleet.toml -o out
  undrift fleet \"logs/*/drive.toml\" -o out --unit {folder} --bias-models white,arma
  undrift fleet fleet.toml -o out --shard 3/16
  undrift fleet fleet.toml -o out --gather --report fleet.html")]
pub struct Arguments {
    /// A manifest, or drive files by name or pattern
    #[arg(value_name = "MANIFEST.toml|GLOB", required = true)]
    logs: Vec<String>,
    /// Write results.parquet, fleet.json, fleet.html and each log's result into this folder
    #[arg(short, long, value_name = "DIR", help_heading = "Output")]
    output: PathBuf,
    /// Process only shard I of N, for N processes or machines that share the folder
    #[arg(long, value_name = "I/N", value_parser = shard, conflicts_with_all = ["gather", "json", "report", "figures"])]
    shard: Option<(usize, usize)>,
    /// Only make the table and report from the results of finished shards
    #[arg(long)]
    gather: bool,
    /// Process failed logs again
    #[arg(long, conflicts_with = "gather")]
    retry_failed: bool,
    /// Threads, each with one log at a time; 0: one per core
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u16).range(..=4096))]
    threads: u16,
    /// What to do with the drives. Default: the manifest's task, else outages
    #[arg(long, value_name = "VERB", value_enum)]
    task: Option<Task>,
    /// Serial number of the IMU; {stem}, {folder} and {parent} stand for parts of the log's name
    #[arg(long, value_name = "TEXT")]
    unit: Option<String>,
    /// Folder of the log files. Default: that of each drive file; {stem}, {folder}, {parent} as above
    #[arg(long, value_name = "DIR")]
    data: Option<String>,
    /// Noise model of the IMU: a model file or a preset
    #[arg(long, value_name = "IMU.toml")]
    model: Option<String>,
    /// Bias models to compare
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    bias_models: Option<Vec<BiasModel>>,
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
    refuse_urls(arguments)?;
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
        let lines = Lines::new(jobs.len());
        fleet::run(&jobs, folder, options, &sentence, |outcome| {
            bar.add(1);
            lines.add();
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
    if done.damaged > 0 {
        warn(format!(
            "{} damaged results in {} were replaced",
            done.damaged,
            output::shown(&folder.join("jobs"))
        ));
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
                "{failed} logs of the shard failed; --gather lists them"
            ));
        }
        return say(format!("shard {which} of {of}: {line}"));
    }
    let result = stage("gathering", || fleet::gather(&done.fingerprints, folder))?;
    let json = results::text(&result);
    write_drawn(&files, &folder.join("fleet.html"), &json, html::render)?;
    if !arguments.result.write(&files, &json)? {
        say(line)?;
        say(text::fleet(&result, style::heading))?;
        say(format!(
            "results.parquet, fleet.json and fleet.html are in {}",
            output::shown(folder)
        ))?;
    }
    warn_of_troubles(&result);
    if result.failed.len() == done.fingerprints.len() {
        bail!("no log could be processed");
    }
    Ok(())
}

/// Object storage is read through Python.
fn refuse_urls(arguments: &Arguments) -> Result<()> {
    let output = arguments.output.to_string_lossy();
    let names = arguments.logs.iter().map(String::as_str);
    let mut names = names.chain([&*output]).chain(arguments.data.as_deref());
    if let Some(name) = names.find(|name| name.contains("://")) {
        bail!(Invalid(format!(
            "{name}: the command reads and writes files of this machine; for URLs use undrift.fleet.run or \
             undrift.fleet.process_to of the Python package (docs/fleet.md), which give the same results"
        )));
    }
    Ok(())
}

/// Progress where there is no terminal for a bar: a line every ten seconds, the first after one.
struct Lines {
    start: Instant,
    all: usize,
    done: AtomicUsize,
    /// Seconds to the next line.
    next: Mutex<f64>,
}

impl Lines {
    fn new(all: usize) -> Self {
        Self {
            start: Instant::now(),
            all,
            done: AtomicUsize::new(0),
            next: Mutex::new(1.0),
        }
    }

    fn add(&self) {
        let done = self.done.fetch_add(1, Relaxed) + 1;
        if std::io::stderr().is_terminal() {
            return;
        }
        let elapsed = self.start.elapsed().as_secs_f64();
        let Ok(mut next) = self.next.lock() else {
            return;
        };
        if elapsed >= *next && done < self.all {
            *next = elapsed + 10.0;
            let left = (self.all - done) as f64 * elapsed / done as f64;
            note(format!(
                "{done} of {} logs in {elapsed:.0} s, {left:.0} s left",
                self.all
            ));
        }
    }
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
        let look = |folder: &str, lookup: &Lookup| match lookup {
            Lookup::Text(name) if name.ends_with(".parquet") => Err(
                "save the table as CSV; undrift.fleet of the Python package reads Parquet".into(),
            ),
            _ => Manifest::look(folder, lookup),
        };
        return Ok(manifest.jobs(&folder.to_string_lossy(), look)?);
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
    choice.verb = match arguments.task {
        Some(Task::Outages) => Verb::Outages,
        Some(Task::Navigate) => Verb::Navigate,
        Some(Task::Tune) => Verb::Tune,
        None => choice.verb,
    };
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
}

/// Entries shown of a longer list.
const SHOWN: usize = 10;

fn warn_of_troubles(result: &Fleet) {
    if result.failed.len() + result.untrusted.len() > 0 {
        terminal::doubt();
    }
    for troubles in [&result.failed, &result.untrusted] {
        // Bias models or axes of one log that fail alike are listed together.
        let alike = troubles.chunk_by(|a, b| a.log == b.log && a.why == b.why);
        for alike in alike.clone().take(SHOWN) {
            let parts = alike.iter().filter_map(|trouble| trouble.part.as_deref());
            let of = [alike[0].log.as_str()].into_iter().chain(parts);
            warn(format!(
                "{}: {}",
                Vec::from_iter(of).join(", "),
                alike[0].why
            ));
        }
        let more = alike.skip(SHOWN).count();
        if more > 0 {
            warn(format!("and {more} more; fleet.html lists them"));
        }
    }
}
