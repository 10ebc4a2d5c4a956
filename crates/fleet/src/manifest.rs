//! `MANIFEST.toml`: which logs, and what is to be done with them. All keys are in `docs/fleet.md`.

mod choice;
mod rows;
mod table;

pub use choice::{Choice, Verb};

use super::{Job, Task};
use choice::read_choice;
use std::path::Path;
use undrift_drive::drive::{ConfigError, Section, file_name, parse};

/// Logs by name, or by a pattern with `*`, `?` and `[…]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Pattern {
    /// The name or pattern, relative to the manifest's folder.
    pub pattern: String,
    /// Whether it names static recordings, else drive files.
    pub records: bool,
    /// A table with a row for each log; a drive file is then a template for all rows.
    pub table: Option<String>,
    /// Line of the manifest.
    line: Option<usize>,
    choice: Choice,
}

/// Whether there is something to match.
fn is_pattern(name: &str) -> bool {
    name.contains(['*', '?', '['])
}

/// What a manifest needs to know of the place where it lies.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Lookup {
    /// The files that match a pattern.
    Files(String),
    /// The folders that match a pattern.
    Folders(String),
    /// The text of a file.
    Text(String),
}

impl Pattern {
    /// The key of the manifest that errors are at.
    fn key(&self) -> &'static str {
        match self {
            Self { table: Some(_), .. } => "table",
            Self { records: true, .. } => "record",
            _ if matches!(self.lookup(), Some(Lookup::Folders(_))) => "data",
            _ => "drive",
        }
    }

    /// What has to be looked up for it, if anything has to be.
    fn lookup(&self) -> Option<Lookup> {
        let data = self.choice.data.as_ref();
        if let Some(table) = &self.table {
            Some(Lookup::Text(table.clone()))
        } else if is_pattern(&self.pattern) {
            Some(Lookup::Files(self.pattern.clone()))
        } else {
            let data = data.filter(|data| is_pattern(data));
            data.cloned().map(Lookup::Folders)
        }
    }

    /// The job for a drive file or record. Of a drive file for several folders of logs, the log is called
    /// as if the drive file lay in the folder of its logs.
    fn job(&self, folder: &str, file: &str) -> Job {
        let choice = &self.choice;
        let data = choice.data.as_ref().map(|data| filled(data, file));
        let own = file.rsplit('/').next().unwrap_or(file);
        let beside = data
            .as_ref()
            .filter(|_| !self.records && !is_pattern(&self.pattern));
        let beside = beside.map(|data| format!("{}/{own}", data.trim_end_matches('/')));
        let log = choice.name.clone().or(beside);
        let log = log.unwrap_or_else(|| file.to_owned());
        Job {
            folder: folder.to_owned(),
            drive: (log != file).then(|| file.to_owned()),
            data,
            unit: choice.unit.as_ref().map(|unit| filled(unit, &log)),
            sensor: choice.sensor.clone(),
            labels: choice.labels.clone(),
            log,
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
    /// Reads the text of a manifest; `file` is what messages call it. `change` has the last word on what
    /// the manifest says of all and of each log.
    ///
    /// # Errors
    /// A text that says something it cannot.
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
            choice.name = log.text("name")?.map(str::to_owned);
            change(&mut choice);
            let table = match log.get("table") {
                Some(_) => Some(file_name(&log, "table")?.to_owned()),
                None => None,
            };
            let key = match (log.text("drive")?, log.text("record")?) {
                (Some(_), None) => Some("drive"),
                (None, Some(_)) => Some("record"),
                (None, None) if table.is_some() => None,
                _ => {
                    return Err(log.error(
                        "drive",
                        "set drive (a drive file) or record (a static recording); * is a wildcard",
                    ));
                }
            };
            let pattern = key.map_or(Ok(""), |key| file_name(&log, key))?.to_owned();
            log.only_known()?;
            let line = log.line_of(key.unwrap_or("table"));
            if let Some(key) = key.filter(|_| table.is_some() && is_pattern(&pattern)) {
                return Err(log.error(key, "beside a table, one file is needed for all its rows"));
            }
            let pattern = Pattern {
                pattern,
                records: key == Some("record"),
                table,
                line,
                choice,
            };
            if pattern.choice.name.is_some() && pattern.lookup().is_some() {
                return Err(log.error("name", "several logs cannot have one name"));
            }
            logs.push(pattern);
        }
        top.only_known()?;
        if logs.is_empty() {
            return Err(top.missing(
                "log",
                "a [[log]] table for each log or pattern of logs, with drive or record",
            ));
        }
        let file = file.to_owned();
        Ok(Self { file, logs })
    }

    /// What [`Manifest::jobs`] looks up.
    pub fn lookups(&self) -> Vec<Lookup> {
        self.logs.iter().filter_map(Pattern::lookup).collect()
    }

    /// The jobs; `folder` is the manifest's, `look` looks something up there: the names that match, relative to the
    /// folder, or the text; or why that cannot be.
    ///
    /// # Errors
    /// A pattern that stands for nothing; a table that cannot be read.
    pub fn jobs(
        &self,
        folder: &str,
        look: impl Fn(&str, &Lookup) -> Result<Vec<String>, String>,
    ) -> Result<Vec<Job>, ConfigError> {
        let mut jobs = Vec::new();
        for log in &self.logs {
            let wrong = |message: String| ConfigError {
                file: self.file.clone(),
                line: log.line,
                key: format!("log.{}", log.key()),
                message,
            };
            let Some(lookup) = log.lookup() else {
                jobs.push(log.job(folder, &log.pattern));
                continue;
            };
            let (Lookup::Files(name) | Lookup::Folders(name) | Lookup::Text(name)) = &lookup;
            let mut found =
                look(folder, &lookup).map_err(|why| wrong(format!("\"{name}\": {why}")))?;
            if let Lookup::Text(table) = &lookup {
                let text = found.pop().unwrap_or_default();
                jobs.extend(table::jobs(log, folder, table, &text)?);
                continue;
            }
            let folders = matches!(lookup, Lookup::Folders(_));
            if found.is_empty() {
                return Err(wrong(format!(
                    "\"{name}\" matches no {}; names are relative to the manifest's folder",
                    if folders { "folder" } else { "file" }
                )));
            }
            found.sort_unstable();
            for found in found {
                if folders {
                    let mut log = log.clone();
                    let file = std::mem::take(&mut log.pattern);
                    log.choice.data = Some(found);
                    jobs.push(log.job(folder, &file));
                } else {
                    jobs.push(log.job(folder, &found));
                }
            }
        }
        Ok(jobs)
    }

    /// Looks something up on this machine; for [`Manifest::jobs`].
    ///
    /// # Errors
    /// A malformed pattern; a file that cannot be read.
    pub fn look(folder: &str, lookup: &Lookup) -> Result<Vec<String>, String> {
        let found = match lookup {
            Lookup::Files(pattern) => Self::matching(folder, pattern, Path::is_file),
            Lookup::Folders(pattern) => Self::matching(folder, pattern, Path::is_dir),
            Lookup::Text(name) => {
                let text = std::fs::read_to_string(Path::new(folder).join(name));
                return text
                    .map(|text| vec![text])
                    .map_err(|error| error.to_string());
            }
        };
        found.map_err(|error| error.to_string())
    }

    /// What a pattern stands for on this machine.
    fn matching(
        folder: &str,
        pattern: &str,
        wanted: impl Fn(&Path) -> bool,
    ) -> Result<Vec<String>, glob::PatternError> {
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
        Ok(found.flatten().filter(|p| wanted(p)).map(name).collect())
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
        /// What was meant, where that is known.
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
            table: None,
            line: None,
            choice: choice.clone(),
        };
        let names = if is_pattern(pattern) && !Path::new(pattern).is_file() {
            let matching = Manifest::matching("", pattern, Path::is_file);
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
