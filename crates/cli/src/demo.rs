//! `undrift demo`: the paper's experiment on a simulated drive.

use crate::{
    output::{self, Files},
    print,
    progress::Bar,
    report::{ResultOutput, write_drawn},
    style, tables,
    terminal::{say, stage},
};
use anyhow::Result;
use clap::Args;
use std::path::{Path, PathBuf};
use undrift::{
    demo::{self, Demo, Models, Stage},
    outages::ModelRun,
    results,
};
use undrift_report::{figures, text};

/// Simulate a drive, cut its GNSS 15 times, and compare the noise models.
///
/// Simulates a static recording and a 10-minute drive, identifies the sensors from the recording, and runs the
/// noise models through outages of 10 s: Tables 2, 3 and 4 of Wang, Lyu & Wu (2016).
#[derive(Args)]
#[command(after_help = "Examples:
  undrift demo
  undrift demo --seed 7 --out out
  undrift demo --true-models --json demo.json")]
pub struct Arguments {
    /// Seed of the drive, the sensors and the receiver
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Use the simulation's own noise models instead of identified ones
    #[arg(long)]
    true_models: bool,
    /// Write the data of tables and figures and demo.svg into this folder
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    out: Option<PathBuf>,
    #[command(flatten)]
    result: ResultOutput,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let files = Files::claim([], arguments.result.files())?;
    if let Some(folder) = &arguments.out {
        output::make_folder(folder)?;
    }
    let models = if arguments.true_models {
        Models::Truth
    } else {
        Models::Identified
    };
    let demo = stage("simulation, identification and navigation", || {
        let bar = Bar::new("simulated", 0, "samples");
        demo::run(arguments.seed, models, |stage, more, total| {
            match stage {
                Stage::Identification => bar.stage("identified", total, "axes"),
                Stage::Navigation => bar.stage("navigated", total, "samples"),
            }
            bar.add(more);
        })
    })?;
    let result = undrift_report::say::demo(&demo);
    let json = results::text(&result);
    let shown = arguments.result.write(&files, &json)?;
    if !shown {
        print_tables(arguments, &result)?;
    }
    print::print_troubles(&result.outages);
    if let Some(folder) = &arguments.out {
        write(&files, folder, &demo, &result)?;
        if !shown {
            say(format!(
                "\nWritten to {}: outages.json, demo.svg and the data of the figures",
                output::shown(folder)
            ))?;
        }
    }
    Ok(())
}

/// Prints the tables.
fn print_tables(arguments: &Arguments, result: &results::Demo) -> Result<()> {
    let (count, length, ..) = demo::OUTAGES;
    let (sensor, rate, seed) = (demo::PRESET, demo::RATE_HZ, arguments.seed);
    if let Some(identified) = &result.identification {
        say(format!(
            "Simulated static recording of {:.0} s, {sensor} at {rate:.0} Hz, seed {seed}.\n\n{}",
            demo::STATIC_DURATION,
            text::identification(identified, "gyro_z", style::heading)
        ))?;
    }
    say(format!(
        "Simulated car drive of {:.0} min, {sensor} at {rate:.0} Hz, RTK-like GNSS at 5 Hz, seed {seed};\n\
         GNSS cut {count} times for {length:.0} s. Errors inside the outages (Table 4):\n\n{}",
        demo::DURATION / 60.0,
        text::outages(&result.outages, style::heading)
    ))
}

/// Writes the data of tables and figures.
fn write(files: &Files, folder: &Path, demo: &Demo, result: &results::Demo) -> Result<()> {
    let put = |name: &str, text: &str| files.write(&folder.join(name), text);
    let outages = results::text(&result.outages);
    put("outages.json", &outages)?;
    if let (Some((record, _)), Some(identified)) = (&demo.identified, &result.identification) {
        let identified = results::Identify {
            record: demo::PRESET.into(),
            ..identified.clone()
        };
        put("identified.json", &results::text(&identified))?;
        put(
            "figure1-record.csv",
            &tables::record_csv(record, demo::RATE_HZ),
        )?;
        put(
            "figure3-correlation.csv",
            &text::correlation_csv(&identified, "gyro_z"),
        )?;
    }
    put("figure4-trajectory.csv", &tables::trajectory_csv(demo))?;
    let runs: Vec<&ModelRun> = demo
        .runs
        .iter()
        .filter_map(|(_, run)| run.as_ref().ok())
        .collect();
    put("figure5-drift.csv", &tables::drift_csv(&runs))?;
    write_drawn(
        files,
        &folder.join("demo.svg"),
        &outages,
        figures::experiment,
    )
}
