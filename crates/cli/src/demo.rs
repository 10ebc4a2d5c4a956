//! `undrift demo`: the paper's experiment on a simulated drive.

use crate::{report, tables};
use anyhow::{Context, Result};
use clap::Args;
use std::path::PathBuf;
use undrift::{
    demo::{self, Models},
    figure,
};

/// Simulate a static record and a 10-minute drive, identify the sensors from the record, cut the
/// drive's GNSS 15 times, and compare the noise models.
///
/// Example: undrift demo --seed 7 --out out
#[derive(Args)]
pub struct Arguments {
    /// Seed of the drive, the sensors and the receiver
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Take the models from the simulation's own parameters instead of identifying them
    #[arg(long)]
    true_models: bool,
    /// Write the tables' and figures' data and demo.svg into this folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let models = if arguments.true_models {
        Models::Truth
    } else {
        Models::Identified
    };
    let demo = demo::run(arguments.seed, models)?;
    let (count, length, ..) = demo::OUTAGES;
    if let Some((_, identified)) = &demo.identified {
        report::say(format!(
            "Simulated static record of {:.0} s, {} at {:.0} Hz, seed {}.\n\n{}",
            demo::STATIC_DURATION,
            demo::PRESET,
            demo::RATE_HZ,
            arguments.seed,
            tables::normality(identified)
        ))?;
        report::say(tables::pandit_wu(identified, "gyro_z"))?;
        report::say(tables::recommended(identified))?;
    }
    report::say(format!(
        "Simulated car drive of {:.0} min, {} at {:.0} Hz, RTK-like GNSS at 5 Hz, seed {};\n\
         GNSS cut {count} times for {length:.0} s. Errors inside the outages (Table 4):\n",
        demo::DURATION / 60.0,
        demo::PRESET,
        demo::RATE_HZ,
        arguments.seed
    ))?;
    let (runs, failed) = report::split(&demo.runs);
    report::say(report::table(&runs))?;
    report::say(format!(
        "\"{}\" is white on samples whose turn-on constants were removed beforehand.",
        demo::WHITE_CALIBRATED
    ))?;
    report::print_failed(&failed);
    report::print_warnings(&runs);
    if let Some(folder) = &arguments.out {
        std::fs::create_dir_all(folder)
            .with_context(|| format!("cannot make {}", folder.display()))?;
        let json = report::json(&demo.outages, &runs, "truth");
        report::write_whole(&folder.join("outages.json"), &json)?;
        if let Some((record, identified)) = &demo.identified {
            report::write_whole(
                &folder.join("identified.json"),
                &format!("{:#}", identified.json()),
            )?;
            report::write_whole(
                &folder.join("figure1-record.csv"),
                &tables::record_csv(record, demo::RATE_HZ),
            )?;
            report::write_whole(
                &folder.join("figure3-correlation.csv"),
                &tables::correlation_csv(identified, "gyro_z"),
            )?;
        }
        report::write_whole(
            &folder.join("figure4-trajectory.csv"),
            &tables::trajectory_csv(&demo),
        )?;
        report::write_whole(&folder.join("figure5-drift.csv"), &tables::drift_csv(&runs))?;
        let curves: Vec<_> = runs.iter().map(|r| figure::drift_curve(r)).collect();
        figure::experiment(
            &folder.join("demo.svg"),
            &demo.simulation.truth,
            &demo.outages,
            &curves,
        )
        .map_err(anyhow::Error::msg)?;
        report::say(format!(
            "\nWritten to {}: outages.json, demo.svg and the data of the figures",
            folder.display()
        ))?;
    }
    Ok(())
}
