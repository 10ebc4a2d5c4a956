//! `undrift montecarlo`: does the filter know its own errors?

use crate::{
    output::Files,
    progress::Bar,
    report::{ResultOutput, svg_only, write_picture},
    style,
    terminal::{self, detail, say, stage},
};
use anyhow::Result;
use clap::Args;
use std::{fmt::Write as _, path::PathBuf};
use undrift::{
    montecarlo::{self, Spec},
    noise::BiasModel,
    results::{self, MonteCarlo, MonteCarloModel, Verdict},
};
use undrift_report::figures;

/// Simulate a drive many times and compare the filter's errors with its own covariance (NEES, NIS).
///
/// The motion is the same in every run; the noise is drawn anew. A filter that knows its own errors has
/// an average NEES inside its bounds (docs/montecarlo.md).
#[derive(Args)]
#[command(after_help = "Examples:
  undrift montecarlo examples/montecarlo-car.toml --runs 100 --json montecarlo.json
  undrift montecarlo examples/montecarlo-car.toml --runs 20 --bias-models arma --figure nees.svg")]
pub struct Arguments {
    /// What to simulate and what to tell the filter
    #[arg(value_name = "SPEC.toml")]
    spec: PathBuf,
    /// Number of runs
    #[arg(long, value_name = "N", default_value_t = 100)]
    runs: usize,
    /// Seed of all runs' noise; the drive's own seed is in the SPEC
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Bias models to run, instead of the SPEC's
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    bias_models: Vec<BiasModel>,
    /// Draw the average NEES over time with its bounds
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
    detail(2, || format!("{spec:#?}"));
    let result = stage("simulation and navigation", || {
        let bar = Bar::new("simulated", arguments.runs as u64, "runs");
        montecarlo::run(&spec, arguments.runs, arguments.seed, || bar.add(1))
    })?;
    if result.models.iter().any(|model| model.diverged > 0) {
        terminal::doubt();
    }
    let json = results::text(&result);
    if !arguments.result.write(&files, &json)? {
        say(text(&result))?;
    }
    if let Some(path) = &arguments.figure {
        write_picture(&files, path, &json, figures::consistency)?;
    }
    Ok(())
}

/// The result for a reader.
fn text(result: &MonteCarlo) -> String {
    let mut text = format!(
        "{} runs of a simulated drive of {:.0} s, IMU at {} Hz, errors drawn as {}, seed {}.\n\
         After the first {:.0} s of navigation, an epoch every {} s:\n\n",
        result.runs,
        result.drive.duration_s.0,
        result.drive.rate_hz.0,
        result.drive.drawn_as,
        result.seed,
        result.settle_s.0,
        result.drive.every_s.0,
    );
    let heading = format!(
        "{:14} {:12} {:>3} {:>17} {:>19} {:>7} {:>7}  verdict",
        "model", "NEES of", "dof", "mean / dof", "inside 95 % bounds", "above", "below"
    );
    let _ = writeln!(text, "{}", style::heading(&heading));
    for model in &result.models {
        for group in &model.nees {
            let _ = writeln!(
                text,
                "{:14} {:12} {:>3} {:>9} ± {:<5} {:>9.1} ± {:<4.1} % {:>5.1} % {:>5.1} %  {}",
                model.name,
                group.name,
                group.freedom,
                short(group.mean_per_freedom.0),
                short(group.mean_standard_error.0),
                100.0 * group.share_inside.0,
                100.0 * group.share_standard_error.0,
                100.0 * group.share_above.0,
                100.0 * group.share_below.0,
                verdict(group.verdict)
            );
        }
    }
    let heading = format!(
        "{:14} {:9} {:>7} {:>10} {:>17} {:>11} {:>13}  verdict",
        "model", "NIS of", "updates", "mean / dof", "95 % bounds", "above 95 %", "lag 1 … 10"
    );
    let _ = writeln!(text, "\n{}", style::heading(&heading));
    for model in &result.models {
        for kind in &model.nis {
            let largest = kind
                .autocorrelation
                .iter()
                .flatten()
                .fold(0.0f64, |m, r| m.max(r.0.abs()));
            let _ = writeln!(
                text,
                "{:14} {:9} {:>7} {:>10} {:>8.4} … {:<6.4} {:>9.1} % {:>5.3} / {:<5.3}  {}",
                model.name,
                kind.name,
                kind.updates,
                short(kind.nis_per_freedom.0),
                kind.bounds.0.0,
                kind.bounds.1.0,
                100.0 * kind.share_above_95.0,
                largest,
                kind.autocorrelation_bound.0,
                verdict(kind.verdict)
            );
        }
    }
    let heading = format!(
        "{:14} {:15} within 1σ (68.3 %), 2σ (95.4 %), 3σ (99.7 %)",
        "model", "component"
    );
    let _ = writeln!(text, "\n{}", style::heading(&heading));
    for model in &result.models {
        for (component, shares) in &model.coverage {
            let share = |i: usize| 100.0 * shares.get(i).copied().unwrap_or_default().0;
            let _ = writeln!(
                text,
                "{:14} {component:15} {:>8.1} {:>6.1} {:>6.1}",
                model.name,
                share(0),
                share(1),
                share(2)
            );
        }
    }
    text.push('\n');
    for model in &result.models {
        let _ = writeln!(text, "{}", sentence(model, result.runs));
    }
    text.pop();
    text
}

fn verdict(verdict: Option<Verdict>) -> String {
    verdict.map_or(String::new(), |verdict| verdict.to_string())
}

/// What it comes to, in words.
fn sentence(model: &MonteCarloModel, runs: u64) -> String {
    let parts: Vec<String> = Verdict::ALL
        .into_iter()
        .filter_map(|verdict| {
            let names: Vec<&str> = model
                .nees
                .iter()
                .filter(|group| group.verdict == Some(verdict))
                .map(|group| group.name.as_str())
                .collect();
            (!names.is_empty()).then(|| format!("{verdict} in {}", names.join(", ")))
        })
        .collect();
    let mut sentence = format!("{}: {}", model.name, parts.join("; "));
    if model.diverged > 0 {
        let _ = write!(sentence, "; {} of {runs} runs diverged", model.diverged);
    }
    sentence + "."
}

/// Three significant digits.
fn short(value: f64) -> String {
    match value.abs() {
        v if !v.is_finite() => "–".into(),
        v if v < 9.9995 => format!("{value:.3}"),
        v if v < 99.95 => format!("{value:.1}"),
        v if v < 1e4 => format!("{value:.0}"),
        _ => format!("{value:.1e}"),
    }
}
