//! `undrift report`: results that were written as JSON, for reading.

use crate::output::{Files, JsonOutput, make_folder};
use anyhow::{Context, Result};
use clap::Args;
use std::path::{Path, PathBuf};
use undrift::results::{self, ReportFiles};
use undrift_report::{Document, ReportFormat, figures};

/// Make a report of one result, or compare several.
///
/// Results are the JSON files of the other verbs (--json). Results of one kind are compared: tables side
/// by side, curves in one figure. Results of different kinds follow each other.
#[derive(Args)]
#[command(after_help = "Examples:
  undrift report demo.json -o demo.html
  undrift report arma.json white.json -o compared.html --figures figures

undrift demo --json demo.json makes the first one.")]
pub struct Arguments {
    /// Result files
    #[arg(value_name = "RESULT.json", required = true)]
    results: Vec<PathBuf>,
    /// Write the report as one self-contained HTML file; its tables alone as .md, .tex or .csv
    #[arg(
        short,
        long,
        value_name = "FILE.html",
        value_parser = report_file,
        required_unless_present = "figures"
    )]
    output: Option<PathBuf>,
    /// Write its figures into this folder as SVG; the report page can save PNG
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,
    #[command(flatten)]
    json: JsonOutput,
}

/// The report of one result.
fn document_of(json: &str) -> Result<Document> {
    let result = (PathBuf::new(), json.to_owned());
    Ok(undrift_report::of_results(&[result])?)
}

/// Writes what `draw` makes of one result's report, a picture or the page.
pub fn write_drawn(
    files: &Files,
    path: &Path,
    json: &str,
    draw: fn(&Document) -> String,
) -> Result<()> {
    files.write(path, &draw(&document_of(json)?))
}

/// Figures are written as SVG: another name is refused before the work begins.
#[cfg(not(target_family = "wasm"))]
pub fn svg_only(path: Option<&Path>) -> Result<()> {
    let Some(path) = path else { return Ok(()) };
    let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    match ending.as_deref() {
        Some(ending @ ("png" | "jpg" | "jpeg" | "pdf" | "eps")) => {
            anyhow::bail!(crate::terminal::Invalid(format!(
                "cannot write {}: figures are written as SVG, not {}; name it {}, or use --report FILE.html \
             and save the figure as PNG from the page",
                path.display(),
                ending.to_uppercase(),
                path.with_extension("svg").display()
            )))
        }
        _ => Ok(()),
    }
}

/// The name of a report, whose extension says what it is written as.
fn report_file(name: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(name);
    match ReportFormat::from_path(&path) {
        Some(_) => Ok(path),
        None => Err(format!(
            "a report is HTML, or its tables as .md, .tex or .csv: name it {}; a browser prints it as PDF",
            path.with_extension("html").display()
        )),
    }
}

/// Where a verb puts its result beside the terminal: as JSON, as a report, as figures.
#[derive(Args)]
pub struct ResultOutput {
    #[command(flatten)]
    json: JsonOutput,
    /// Write a report with tables and figures as one self-contained HTML file; its tables alone as .md, .tex or .csv
    #[arg(long, value_name = "FILE.html", help_heading = "Output", value_parser = report_file)]
    report: Option<PathBuf>,
    /// Write the report's figures into this folder as SVG; the report page can save PNG
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    figures: Option<PathBuf>,
}

impl ResultOutput {
    /// Whether it goes anywhere.
    pub fn is_wanted(&self) -> bool {
        self.json.is_wanted() || self.report.is_some() || self.figures.is_some()
    }

    /// The files, to be claimed.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        self.json.file().into_iter().chain(self.report.as_deref())
    }

    /// Writes what is wanted; whether the JSON went to standard output.
    pub fn write(&self, files: &Files, json: &str) -> Result<bool> {
        let shown = self.json.write(files, json)?;
        let (report, figures) = (self.report.as_deref(), self.figures.as_deref());
        if report.is_some() || figures.is_some() {
            write(files, &document_of(json)?, report, figures)?;
        }
        Ok(shown)
    }
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let (report, figures) = (arguments.output.as_deref(), arguments.figures.as_deref());
    let inputs = arguments.results.iter().map(PathBuf::as_path);
    let outputs = report.into_iter().chain(arguments.json.file());
    let files = Files::claim(inputs.clone(), outputs)?;
    let read = |path: &PathBuf| {
        let text = std::fs::read_to_string(path);
        let text = text.with_context(|| format!("cannot read {}", path.display()));
        Ok((path.clone(), text?))
    };
    let texts = arguments.results.iter().map(read);
    let document = undrift_report::of_results(&texts.collect::<Result<Vec<_>>>()?)?;
    write(&files, &document, report, figures)?;
    let name = |path: &Path| path.display().to_string();
    let made = ReportFiles {
        figures: figures.map(name),
        report: report.map(name),
        results: inputs.map(name).collect(),
    };
    let json = results::text(&made);
    arguments.json.write(&files, &json).map(drop)
}

fn write(
    files: &Files,
    document: &Document,
    report: Option<&Path>,
    figures: Option<&Path>,
) -> Result<()> {
    if let Some(path) = report {
        let format = ReportFormat::from_path(path).unwrap_or(ReportFormat::Html);
        files.write(path, &format.render(document))?;
    }
    if let Some(folder) = figures {
        make_folder(folder)?;
        for (name, svg) in figures::svgs(document) {
            files.write(&folder.join(name), &svg)?;
        }
    }
    Ok(())
}
