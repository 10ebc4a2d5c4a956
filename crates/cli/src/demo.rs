//! `undrift demo`: the paper's experiment on a simulated drive.

use crate::report;
use anyhow::{Context, Result};
use clap::Args;
use std::path::PathBuf;
use undrift::{demo, figure};

/// Simulate a 10-minute drive, cut its GNSS 15 times, and compare the noise models.
///
/// Example: undrift demo --seed 7 --out out
#[derive(Args)]
pub struct Arguments {
    /// Seed of the drive, the sensors and the receiver
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Write outages.json and demo.svg into this folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let demo = demo::run(arguments.seed)?;
    let (count, length, ..) = demo::OUTAGES;
    report::say(format!(
        "Simulated car drive of {:.0} min, {} at {:.0} Hz, RTK-like GNSS at 5 Hz, seed {};\n\
         GNSS cut {count} times for {length:.0} s. Errors inside the outages:\n",
        demo::DURATION / 60.0,
        demo::PRESET,
        demo::RATE_HZ,
        arguments.seed
    ))?;
    let (runs, failed) = report::split(&demo.runs);
    report::say(report::table(&runs))?;
    report::say(format!(
        "The models are made from the simulation's own parameters: a Gauss-Markov process plus white\n\
         noise is exactly an ARMA(1,1), so arma and gauss-markov differ only by how each starts from the\n\
         mean over the rest. \"{}\" is white on samples whose turn-on constants were\n\
         removed beforehand.",
        demo::WHITE_CALIBRATED
    ))?;
    report::print_failed(&failed);
    report::print_warnings(&runs);
    if let Some(folder) = &arguments.out {
        std::fs::create_dir_all(folder)
            .with_context(|| format!("cannot make {}", folder.display()))?;
        let json = report::json(&demo.outages, &runs, "truth");
        let file = folder.join("outages.json");
        report::write_whole(&file, &json)?;
        let curves: Vec<_> = runs.iter().map(|r| figure::drift_curve(r)).collect();
        let picture = folder.join("demo.svg");
        figure::experiment(&picture, &demo.simulation.truth, &demo.outages, &curves)
            .map_err(anyhow::Error::msg)?;
        report::say(format!(
            "\nWritten: {}, {}",
            file.display(),
            picture.display()
        ))?;
    }
    Ok(())
}
