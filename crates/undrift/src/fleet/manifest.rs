//! `MANIFEST.toml`: which logs, and what is to be done with them. All keys are in `docs/fleet.md`.

mod choice;

pub use choice::{Choice, Verb};

use super::{Job, Task};
use crate::drive::{ConfigError, DriveError, Section, parse, read_text};
use choice::read_choice;
use std::path::Path;

/// Logs by name, or by a pattern with `*`, `?` and `[…]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Pattern {
    /// The name or pattern, relative to the manifest's folder.
    pub pattern: String,
    /// Whether it stands for static records, else for drive files.
    pub records: bool,
    /// Line of the manifest.
    line: Option<usize>,
    choice: Choice,
}

impl Pattern {
    /// Whether there is something to match.
    pub fn is_pattern(&self) -> bool {
        self.pattern.contains(['*', '?', '['])
    }

    /// The job for one log.
    fn job(&self, folder: &str, log: &str) -> Job {
        let choice = &self.choice;
        Job {
            folder: folder.to_owned(),
            log: log.to_owned(),
            data: choice.data.as_ref().map(|data| filled(data, log)),
            unit: choice.unit.as_ref().map(|unit| filled(unit, log)),
            temperature_c: choice.temperature_c,
            model: choice.model.clone(),
            task: match choice.verb {
                _ if self.records => Task::Identify(choice.record.clone()),
                Verb::Outages => Task::Outages {
                    bias_models: choice.bias_models.clone(),
                    plan: choice.plan.clone(),
                    smooth: choice.smooth,
                },
                Verb::Navigate => Task::Navigate {
                    bias_models: choice.bias_models.clone(),
                    smooth: choice.smooth,
                },
                Verb::Tune => Task::Tune,
            },
        }
    }
}

/// A text with the parts of a log's name in place of `{stem}`, `{folder}` and `{parent}`.
fn filled(text: &str, log: &str) -> String {
    let mut parts = log.rsplit('/');
    let file = parts.next().unwrap_or_default();
    let stem = file.split('.').next().unwrap_or(file);
    let folder = parts.next().unwrap_or_default();
    let parent = parts.next().unwrap_or_default();
    text.replace("{stem}", stem)
        .replace("{folder}", folder)
        .replace("{parent}", parent)
}

/// A manifest, before its patterns are looked up.
#[derive(Clone, Debug, PartialEq)]
pub struct Manifest {
    /// What messages call it.
    pub file: String,
    /// Its logs.
    pub logs: Vec<Pattern>,
}

impl Manifest {
    /// Reads a manifest.
    ///
    /// # Errors
    /// A file that cannot be read or says something it cannot.
    pub fn load(path: &Path) -> Result<Self, DriveError> {
        let (text, file) = read_text(path)?;
        Ok(Self::from_toml(&text, &file, |_| {})?)
    }

    /// Reads the text of a manifest; `file` is what messages call it. `change` has the last word on what
    /// the manifest says of all and of each log.
    ///
    /// # Errors
    /// As [`Manifest::load`].
    pub fn from_toml(
        text: &str,
        file: &str,
        change: impl Fn(&mut Choice),
    ) -> Result<Self, ConfigError> {
        let table = parse(text, file)?;
        let top = Section::top(table.get_ref(), text, file);
        let choice = read_choice(&top, Choice::default(), "{folder} or {stem}")?;
        let mut logs = Vec::new();
        for log in top.sections("log")? {
            let mut choice = read_choice(&log, choice.clone(), "the log's name")?;
            change(&mut choice);
            let (key, records) = match (log.text("drive")?, log.text("record")?) {
                (Some(_), None) => ("drive", false),
                (None, Some(_)) => ("record", true),
                _ => {
                    return Err(log.error(
                        "drive",
                        "set drive (a drive file) or record (a static recording); * is a wildcard",
                    ));
                }
            };
            let pattern = log.file(key)?.to_owned();
            log.only_known()?;
            let line = log.get(key).map(|(_, line)| line);
            logs.push(Pattern {
                pattern,
                records,
                line,
                choice,
            });
        }
        top.only_known()?;
        if logs.is_empty() {
            return Err(top.error(
                "log",
                "missing: a [[log]] table for each log or pattern of logs, with drive or record",
            ));
        }
        let file = file.to_owned();
        Ok(Self { file, logs })
    }

    /// The jobs; `folder` is the manifest's, `matching` finds what a pattern stands for there: names
    /// relative to the folder.
    ///
    /// # Errors
    /// A pattern that stands for nothing.
    pub fn jobs(
        &self,
        folder: &str,
        matching: impl Fn(&str, &str) -> Result<Vec<String>, glob::PatternError>,
    ) -> Result<Vec<Job>, ConfigError> {
        let mut jobs = Vec::new();
        for log in &self.logs {
            let wrong = |message: String| ConfigError {
                file: self.file.clone(),
                line: log.line,
                key: format!("log.{}", if log.records { "record" } else { "drive" }),
                message,
            };
            if !log.is_pattern() {
                jobs.push(log.job(folder, &log.pattern));
                continue;
            }
            let mut names = matching(folder, &log.pattern)
                .map_err(|error| wrong(format!("\"{}\": {error}", log.pattern)))?;
            if names.is_empty() {
                return Err(wrong(format!(
                    "\"{}\" matches no file; names are relative to the manifest's folder",
                    log.pattern
                )));
            }
            names.sort_unstable();
            jobs.extend(names.iter().map(|name| log.job(folder, name)));
        }
        Ok(jobs)
    }

    /// What a pattern stands for on this machine; for [`Manifest::jobs`].
    ///
    /// # Errors
    /// A malformed pattern.
    pub fn matching(folder: &str, pattern: &str) -> Result<Vec<String>, glob::PatternError> {
        // The folder's name is no pattern.
        let whole = match folder {
            "" => pattern.to_owned(),
            folder => format!("{}/{pattern}", glob::Pattern::escape(folder)),
        };
        let found = glob::glob(&whole)?;
        let name = |path: std::path::PathBuf| {
            let name = path.strip_prefix(folder).unwrap_or(&path);
            name.to_string_lossy().replace('\\', "/")
        };
        Ok(found.flatten().filter(|p| p.is_file()).map(name).collect())
    }
}

/// Why a pattern of drive files gives no job.
#[derive(Debug, thiserror::Error)]
pub enum PatternError {
    /// It cannot be read.
    #[error("\"{0}\": {1}")]
    Malformed(String, glob::PatternError),
    /// It matches no file.
    #[error("\"{pattern}\" matches no file{hint}")]
    NoMatch {
        /// As it was given.
        pattern: String,
        /// What was meant, where that can be told.
        hint: &'static str,
    },
}

/// The jobs of drive files by their names or patterns, without a manifest.
///
/// # Errors
/// When one is malformed or matches no file.
pub fn drives(patterns: &[String], choice: &Choice) -> Result<Vec<Job>, PatternError> {
    let mut jobs = Vec::new();
    for pattern in patterns {
        let log = Pattern {
            pattern: pattern.clone(),
            records: false,
            line: None,
            choice: choice.clone(),
        };
        let names = if log.is_pattern() && !Path::new(pattern).is_file() {
            let matching = Manifest::matching("", pattern);
            matching.map_err(|error| PatternError::Malformed(pattern.clone(), error))?
        } else {
            vec![pattern.clone()]
        };
        if names.is_empty() {
            let hint = match pattern.ends_with(".tml") {
                true => "; did you mean \"*.toml\"?",
                false => "; give drive files or patterns such as \"drives/*.toml\"",
            };
            let pattern = pattern.clone();
            return Err(PatternError::NoMatch { pattern, hint });
        }
        jobs.extend(names.iter().map(|name| log.job("", name)));
    }
    Ok(jobs)
}

#[cfg(test)]
mod tests;
