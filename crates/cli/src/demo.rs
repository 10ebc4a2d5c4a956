//! `undrift demo`: how much less a good noise model drifts, and the source paper's tables beside ours.

use crate::{
    output::{self, Files},
    progress::Bar,
    report::{ResultOutput, write_drawn},
    style, tables,
    terminal::{say, stage},
};
use anyhow::Result;
use clap::Args;
use std::path::{Path, PathBuf};
use undrift::{
    demo::{self, DRIVES, Demo, Experiment, Source, Stage},
    io::Opened,
    record::{self, Record, RecordFormat},
    results,
};
use undrift_report::{figures, sentence, text};

/// Static records in the folder of `--data`: the one identified, and the one played back on the drives.
const RECORDS: [&str; 2] = ["run2.csv.gz", "run1.csv.gz"];
/// Files in the folder of `--out`.
const FILES: [&str; 6] = [
    "demo.json",
    "figure1-record.csv",
    "figure3-correlation.csv",
    "figure4-trajectory.csv",
    "figure5-drift.csv",
    "demo.svg",
];

/// Identify a sensor, cut GNSS on simulated drives, and compare the noise models.
///
/// Simulates a static recording of 30 min and five drives of 15 min with a sensor whose noise is that of real
/// recordings, identifies the sensor, and runs its noise models and those of other methods through outages of 10, 30 and 60 s.
#[derive(Args)]
#[command(after_help = "Examples:
  undrift demo
  undrift demo --seed 7 --out out
  undrift demo --paper --report paper.html
  undrift demo --paper --data adis16405-static --report paper-real.html")]
pub struct Arguments {
    /// Seed of the sensor, the drives and the receiver
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Number of drives
    #[arg(long, value_name = "N", default_value_t = DRIVES as u64, value_parser = clap::value_parser!(u64).range(1..=100))]
    drives: u64,
    /// Show the tables and figures of Wang, Lyu & Wu (2016) beside ours
    #[arg(long)]
    paper: bool,
    /// Take the sensor's errors from real recordings: folder of run1.csv.gz and run2.csv.gz, six axes at rest at 100 Hz
    #[arg(long, value_name = "DIR", value_hint = clap::ValueHint::DirPath)]
    data: Option<PathBuf>,
    /// Write the result, its picture and the data of the figures into this folder
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    out: Option<PathBuf>,
    #[command(flatten)]
    result: ResultOutput,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    if let Some(folder) = &arguments.out {
        output::make_folder(folder)?;
    }
    let within = |folder: &Option<PathBuf>, names: &[&str]| {
        let files = folder
            .iter()
            .flat_map(|folder| names.iter().map(|name| folder.join(name)));
        Vec::from_iter(files)
    };
    let inputs = within(&arguments.data, &RECORDS);
    let outputs = within(&arguments.out, &FILES);
    let outputs = outputs.iter().map(PathBuf::as_path);
    let files = Files::claim(
        inputs.iter().map(PathBuf::as_path),
        outputs.chain(arguments.result.files()),
    )?;
    let bar = Bar::at_once("simulated", arguments.drives, "drives");
    let source = match &arguments.data {
        Some(folder) => recorded(folder)?,
        None => Source::Simulated,
    };
    let experiment = Experiment {
        seed: arguments.seed,
        drives: arguments.drives as usize,
        source,
        paper: arguments.paper,
    };
    let demo = stage("simulation, identification and navigation", || {
        demo::run(experiment, |stage, more, total| {
            match stage {
                Stage::Simulation => bar.stage("simulated", total, "drives"),
                Stage::Identification => bar.stage("identified", total, "axes"),
                Stage::Navigation => bar.stage("navigated", total, "samples"),
            }
            bar.add(more);
        })
    })?;
    drop(bar);
    let result = demo.result(&sentence);
    let json = results::text(&result);
    let shown = arguments.result.write(&files, &json)?;
    if !shown {
        let text = match arguments.paper {
            true => text::paper(&result, style::heading),
            false => text::demo(&result, style::heading),
        };
        say(text)?;
    }
    if let Some(folder) = &arguments.out {
        write(&files, folder, &demo, &result, &json)?;
        if !shown {
            say(format!(
                "\nWritten to {}: demo.json, demo.svg and the data of the figures",
                output::shown(folder)
            ))?;
        }
    }
    Ok(())
}

/// The records of a folder.
fn recorded(folder: &Path) -> Result<Source> {
    let read = |name: &str| -> Result<Box<Record>> {
        let opened = Opened::open(&folder.join(name))?;
        Ok(Box::new(record::read(opened, &RecordFormat::default())?))
    };
    let [identified, played] = RECORDS;
    Ok(Source::Recorded {
        identified: read(identified)?,
        played: read(played)?,
    })
}

/// Writes the result and the data of its figures.
fn write(
    files: &Files,
    folder: &Path,
    demo: &Demo,
    result: &results::Demo,
    json: &str,
) -> Result<()> {
    let texts = [
        json.to_owned(),
        tables::record_csv(&demo.record, demo::RATE_HZ),
        text::correlation_csv(&result.identification, "gyro_z"),
        tables::trajectory_csv(demo),
        tables::drift_csv(result),
    ];
    for (name, text) in FILES.iter().zip(texts) {
        files.write(&folder.join(name), &text)?;
    }
    let [.., picture] = FILES;
    write_drawn(files, &folder.join(picture), json, figures::experiment)
}
