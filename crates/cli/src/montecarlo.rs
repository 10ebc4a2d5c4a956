//! `undrift montecarlo`: does the filter know its own errors?

use crate::{
    details,
    output::Files,
    progress::Bar,
    report::{ResultOutput, svg_only, write_drawn},
    style,
    terminal::{self, say, stage},
};
use anyhow::Result;
use clap::Args;
use std::path::PathBuf;
use undrift::{
    montecarlo::{self, Spec},
    noise::BiasModel,
    results,
};
use undrift_report::{figures, text};

/// Simulate a drive many times and compare the filter's errors with its own covariance (NEES, NIS).
///
/// The motion is the same in every run; the noise differs. A consistent filter has an average NEES
/// within its bounds (docs/lab/montecarlo-command.md).
#[derive(Args)]
#[command(after_help = "Examples:
  undrift montecarlo examples/montecarlo-car.toml --runs 100 --json montecarlo.json
  undrift montecarlo examples/montecarlo-car.toml --runs 20 --bias-models arma --figure nees.svg")]
pub struct Arguments {
    /// Simulation and filter settings
    #[arg(value_name = "SPEC.toml")]
    spec: PathBuf,
    /// Number of runs
    #[arg(long, value_name = "N", default_value_t = 100)]
    runs: usize,
    /// Seed of the noise of all runs; the SPEC has the seed of the drive
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Bias models to run instead of the SPEC's
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    bias_models: Vec<BiasModel>,
    /// Plot the average NEES over time with its bounds
    #[arg(long, value_name = "FILE.svg", help_heading = "Output")]
    figure: Option<PathBuf>,
    #[command(flatten)]
    result: ResultOutput,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    svg_only(arguments.figure.as_deref())?;
    let outputs = arguments.result.files().chain(arguments.figure.as_deref());
    let files = Files::claim([arguments.spec.as_path()], outputs)?;
    let mut spec = Spec::load(&arguments.spec)?;
    if !arguments.bias_models.is_empty() {
        spec.bias_models.clone_from(&arguments.bias_models);
    }
    details::text(&arguments.spec);
    let result = stage("simulation and navigation", || {
        let bar = Bar::new("simulated", arguments.runs as u64, "runs");
        montecarlo::run(&spec, arguments.runs, arguments.seed, || bar.add(1))
    })?;
    if result.models.iter().any(|model| model.diverged > 0) {
        terminal::doubt();
    }
    let json = results::text(&result);
    if !arguments.result.write(&files, &json)? {
        say(text::montecarlo(&result, style::heading))?;
    }
    if let Some(path) = &arguments.figure {
        write_drawn(&files, path, &json, figures::consistency)?;
    }
    Ok(())
}
