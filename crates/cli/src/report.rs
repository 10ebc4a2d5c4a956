//! `undrift report`: results that were written as JSON, for reading.

use crate::{
    output::{self, JsonOutput},
    print,
};
use anyhow::{Context, Result};
use clap::Args;
use serde::Serialize;
use std::path::{Path, PathBuf};
use undrift_report::figures::Formats;

/// Make a report of one result, or compare several.
///
/// Results are what --json of the other verbs writes. Results of one kind are compared: tables side
/// by side, curves over one another; those of different kinds follow each other.
#[derive(Args)]
#[command(after_help = "Examples:
  undrift report demo.json -o demo.html
  undrift report arma.json white.json -o compared.html --figures figures

undrift demo --json demo.json makes the first one.")]
pub struct Arguments {
    /// Results
    #[arg(value_name = "RESULT.json", required = true)]
    results: Vec<PathBuf>,
    /// Write the report, one HTML file that needs nothing else
    #[arg(
        short,
        long,
        value_name = "FILE.html",
        required_unless_present = "figures"
    )]
    output: Option<PathBuf>,
    /// Write its figures into this folder, each as SVG and PNG
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,
    #[command(flatten)]
    json: JsonOutput,
}

/// Writes the report of one result.
pub fn write_page(path: &Path, result: &str) -> Result<()> {
    write(&[(PathBuf::new(), result.to_owned())], Some(path), None)
}

/// Where a verb puts the report of its result.
#[derive(Args)]
pub struct Reporting {
    /// Write a report with tables and figures, one HTML file that needs nothing else
    #[arg(long, value_name = "FILE.html", help_heading = "Output")]
    report: Option<PathBuf>,
    /// Write the report's figures into this folder, each as SVG and PNG
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    figures: Option<PathBuf>,
}

impl Reporting {
    /// As [`output::ready`].
    pub fn ready(&self) -> Result<()> {
        output::ready(self.report.as_deref())
    }

    /// That the report is none of the files that this run reads.
    ///
    /// # Errors
    /// As [`output::spares_input`].
    pub fn spares_input(&self) -> Result<()> {
        self.report.as_deref().map_or(Ok(()), output::spares_input)
    }

    /// Whether there is to be one.
    pub fn is_wanted(&self) -> bool {
        self.report.is_some() || self.figures.is_some()
    }

    /// Makes it of a result's JSON.
    pub fn write(&self, result: &str) -> Result<()> {
        if !self.is_wanted() {
            return Ok(());
        }
        write(
            &[(PathBuf::new(), result.to_owned())],
            self.report.as_deref(),
            self.figures.as_deref(),
        )
    }
}

/// What was made of what.
#[derive(Serialize)]
struct Told<'a> {
    figures: Option<&'a Path>,
    report: Option<&'a Path>,
    results: &'a [PathBuf],
}

pub fn run(arguments: &Arguments) -> Result<()> {
    arguments.json.ready()?;
    let results = arguments
        .results
        .iter()
        .map(|path| {
            output::reads(path);
            let text = std::fs::read_to_string(path)
                .with_context(|| format!("cannot read {}", path.display()))?;
            Ok((path.clone(), text))
        })
        .collect::<Result<Vec<_>>>()?;
    write(
        &results,
        arguments.output.as_deref(),
        arguments.figures.as_deref(),
    )?;
    let told = Told {
        figures: arguments.figures.as_deref(),
        report: arguments.output.as_deref(),
        results: &arguments.results,
    };
    arguments
        .json
        .write(&serde_json::to_string_pretty(&told)?)
        .map(drop)
}

fn write(
    results: &[(PathBuf, String)],
    output: Option<&Path>,
    figures: Option<&Path>,
) -> Result<()> {
    let document = undrift_report::of_results(results)?;
    if let Some(path) = output {
        print::write_whole(path, &undrift_report::html::render(&document))?;
    }
    if let Some(folder) = figures {
        undrift_report::figures::write(&document, folder, Formats::default())
            .map_err(anyhow::Error::msg)?;
    }
    Ok(())
}
