//! `MANIFEST.toml`: which logs, and what is to be done with them. All keys are in `docs/fleet.md`.

use super::{Job, Plan, RecordSettings, Task};
use crate::{
    drive::{ConfigError, DriveError, Section, parse, read_switch, read_text},
    identify::Trend,
};
use std::path::Path;
use undrift_io::table::Column;
use undrift_nav::units::Quantity;
use undrift_noise::BiasModel;

/// What is to be done with logs, and what is known of them; a log's own word goes before that of all.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// Cut the GNSS of drives; else navigate them.
    pub outages: bool,
    /// Bias models for drives.
    pub bias_models: Vec<BiasModel>,
    /// Where GNSS is cut.
    pub plan: Plan,
    /// Whether solutions are smoothed.
    pub smooth: bool,
    /// How records are read.
    pub record: RecordSettings,
    /// Noise model of the IMU instead of the drive file's.
    pub model: Option<String>,
    /// Folder of a drive's logs.
    pub data: Option<String>,
    /// Serial number; `{stem}`, `{folder}` and `{parent}` in it are the log's.
    pub unit: Option<String>,
    /// Temperature [°C].
    pub temperature_c: Option<f64>,
}

impl Default for Choice {
    fn default() -> Self {
        Self {
            outages: true,
            bias_models: BiasModel::ALL.to_vec(),
            plan: Plan::default(),
            smooth: false,
            record: RecordSettings {
                n_max: 2,
                ..RecordSettings::default()
            },
            model: None,
            data: None,
            unit: None,
            temperature_c: None,
        }
    }
}

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
            task: match (self.records, choice.outages) {
                (true, _) => Task::Identify(choice.record.clone()),
                (_, true) => Task::Outages {
                    bias_models: choice.bias_models.clone(),
                    plan: choice.plan.clone(),
                    smooth: choice.smooth,
                },
                (_, false) => Task::Navigate {
                    bias_models: choice.bias_models.clone(),
                    smooth: choice.smooth,
                },
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
                        "give drive, the name of a drive file, or record, that of a static record; * stands for any",
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
        matching: impl Fn(&str, &str) -> Result<Vec<String>, String>,
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
            let mut names = matching(folder, &log.pattern).map_err(wrong)?;
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
    /// A pattern that is none.
    pub fn matching(folder: &str, pattern: &str) -> Result<Vec<String>, String> {
        // The folder's name is no pattern.
        let whole = match folder {
            "" => pattern.to_owned(),
            folder => format!("{}/{pattern}", glob::Pattern::escape(folder)),
        };
        let found = glob::glob(&whole).map_err(|error| format!("\"{pattern}\": {error}"))?;
        let name = |path: std::path::PathBuf| {
            let name = path.strip_prefix(folder).unwrap_or(&path);
            name.to_string_lossy().replace('\\', "/")
        };
        Ok(found.flatten().filter(|p| p.is_file()).map(name).collect())
    }
}

/// The jobs of drive files by their names or patterns, without a manifest.
///
/// # Errors
/// A sentence for the user when one stands for nothing.
pub fn drives(patterns: &[String], choice: &Choice) -> Result<Vec<Job>, String> {
    let mut jobs = Vec::new();
    for pattern in patterns {
        let log = Pattern {
            pattern: pattern.clone(),
            records: false,
            line: None,
            choice: choice.clone(),
        };
        let names = if log.is_pattern() && !Path::new(pattern).is_file() {
            Manifest::matching("", pattern)?
        } else {
            vec![pattern.clone()]
        };
        if names.is_empty() {
            return Err(format!("\"{pattern}\" matches no file"));
        }
        jobs.extend(names.iter().map(|name| log.job("", name)));
    }
    Ok(jobs)
}

fn read_choice(section: &Section, before: Choice, unit: &str) -> Result<Choice, ConfigError> {
    let mut choice = before;
    let tasks = [("outages", true), ("navigate", false)];
    if let Some(outages) = section.word("task", &tasks)? {
        choice.outages = outages;
    }
    let models = BiasModel::ALL.map(|model| (model.name(), model));
    if let Some(models) = section.words("bias_models", &models)? {
        choice.bias_models = models;
    }
    if let Some(smooth) = read_switch(section, "smooth")? {
        choice.smooth = smooth;
    }
    for (key, slot, what) in [
        ("model", &mut choice.model, "a preset or a model file"),
        ("data", &mut choice.data, "a folder"),
        ("unit", &mut choice.unit, unit),
    ] {
        match section.text(key)? {
            Some("") => return Err(section.error(key, format!("is empty; give {what}"))),
            Some(text) => *slot = Some(text.to_owned()),
            None => {}
        }
    }
    if let Some(text) = section.text("temperature")? {
        let celsius = celsius(text).ok_or_else(|| {
            section.error("temperature", "must be such as \"25 degC\" or \"298 K\"")
        });
        choice.temperature_c = Some(celsius?);
    }
    read_plan(&section.section("outages")?, &mut choice.plan)?;
    read_record(&section.section("identify")?, &mut choice.record)?;
    Ok(choice)
}

fn read_plan(section: &Section, plan: &mut Plan) -> Result<(), ConfigError> {
    let time = |key, most: bool| match section.quantity(key, Quantity::Time)? {
        Some(time) if time < 0.0 || (most && time == 0.0) => {
            Err(section.error(key, "must be longer than that"))
        }
        time => Ok(time),
    };
    if let Some(length) = time("length", true)? {
        plan.length_s = length;
    }
    if let Some(start) = time("start", false)? {
        plan.start_s = start;
    }
    let (every, count) = (time("every", true)?, section.whole("count")?);
    if count == Some(0) {
        return Err(section.error("count", "must be 1 or more"));
    }
    if every.is_some() || count.is_some() {
        plan.every_s = every;
        plan.count = count.map(|n| usize::try_from(n).unwrap_or(usize::MAX));
    }
    section.only_known()
}

fn read_record(section: &Section, record: &mut RecordSettings) -> Result<(), ConfigError> {
    if let Some(rate) = section.quantity("rate", Quantity::Frequency)? {
        if rate <= 0.0 {
            return Err(section.error("rate", "must be above 0 Hz"));
        }
        record.rate_hz = Some(rate);
    }
    match (section.columns("gyro")?, section.columns("accel")?) {
        (Some(gyro), Some(accel)) => {
            let name = |column: Column| match column {
                Column::Name(name) => name,
                Column::Number(number) => number.to_string(),
            };
            record.columns = gyro.into_iter().chain(accel).map(name).collect();
        }
        (None, None) => {}
        _ => return Err(section.error("gyro", "give gyro and accel, or neither")),
    }
    match (section.text("gyro_unit")?, section.text("accel_unit")?) {
        (Some(gyro), Some(accel)) => record.units = Some((gyro.into(), accel.into())),
        (None, None) => {}
        _ => return Err(section.error("gyro_unit", "give gyro_unit and accel_unit, or neither")),
    }
    if let Some(topic) = section.text("topic")? {
        record.topic = Some(topic.to_owned());
    }
    let trends = [
        ("constant", Trend::Constant),
        ("linear", Trend::Linear),
        ("temperature", Trend::Temperature),
    ];
    if let Some(trend) = section.word("detrend", &trends)? {
        record.detrend = trend;
    }
    if let Some(n) = section.whole("n_max")? {
        record.n_max = usize::try_from(n).unwrap_or(usize::MAX);
    }
    section.only_known()
}

/// Zero of the Celsius scale [K].
pub(super) const ZERO_CELSIUS: f64 = 273.15;

/// A temperature with its unit [°C].
fn celsius(text: &str) -> Option<f64> {
    let text = text.trim().replace('\u{2212}', "-");
    let (number, offset) = ["degC", "°C", "celsius", "C"]
        .into_iter()
        .find_map(|unit| Some((text.strip_suffix(unit)?, 0.0)))
        .or_else(|| Some((text.strip_suffix('K')?, -ZERO_CELSIUS)))?;
    let value: f64 = number.trim().parse().ok()?;
    let celsius = value + offset;
    (celsius.is_finite() && celsius >= -ZERO_CELSIUS).then_some(celsius)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn jobs(text: &str) -> Result<Vec<Job>, ConfigError> {
        let manifest = Manifest::from_toml(text, "fleet.toml", |_| {})?;
        let found = ["b/drive.toml", "a/drive.toml"].map(str::to_owned);
        manifest.jobs("logs", |_, pattern| match pattern {
            "none*" => Ok(Vec::new()),
            _ => Ok(found.to_vec()),
        })
    }

    #[test]
    fn a_log_has_the_last_word() {
        let jobs = jobs(
            r#"
            model = "adis16405"
            unit = "{folder}"
            bias_models = ["white", "arma"]
            temperature = "298.15 K"
            [outages]
            length = "20 s"
            count = 3
            [[log]]
            drive = "*/drive.toml"
            [[log]]
            drive = "c/drive.toml"
            task = "navigate"
            unit = "SN 7"
            temperature = "-40 degC"
            bias_models = ["ar"]
            [[log]]
            record = "static/SN7.csv.gz"
            unit = "{stem}/{folder}"
            identify = { rate = "100 Hz", gyro_unit = "deg/s", accel_unit = "g", gyro = [2, 3, 4], accel = ["x", "y", "z"] }
            "#,
        )
        .unwrap();
        assert_eq!(
            jobs.iter().map(|j| j.log.as_str()).collect::<Vec<_>>(),
            [
                "a/drive.toml",
                "b/drive.toml",
                "c/drive.toml",
                "static/SN7.csv.gz"
            ]
        );
        let [a, _, c, record] = jobs.as_slice() else {
            panic!()
        };
        assert_eq!(
            (a.unit.as_deref(), a.temperature_c),
            (Some("a"), Some(25.0))
        );
        let Task::Outages {
            bias_models, plan, ..
        } = &a.task
        else {
            panic!("{a:?}")
        };
        assert_eq!(bias_models, &[BiasModel::White, BiasModel::Arma]);
        assert_eq!(
            plan.schedule(),
            Some(crate::outages::Schedule::Count {
                start: 60.0,
                count: 3
            })
        );
        assert_eq!(plan.length_s, 20.0);
        assert_eq!(
            (c.unit.as_deref(), c.temperature_c),
            (Some("SN 7"), Some(-40.0))
        );
        assert!(
            matches!(&c.task, Task::Navigate { bias_models, .. } if bias_models == &[BiasModel::Ar])
        );
        assert_eq!(record.unit.as_deref(), Some("SN7/static"));
        let Task::Identify(settings) = &record.task else {
            panic!("{record:?}")
        };
        assert_eq!(settings.columns, ["2", "3", "4", "x", "y", "z"]);
        // A job is its JSON.
        for job in &jobs {
            let text = serde_json::to_string(job).unwrap();
            assert_eq!(&serde_json::from_str::<Job>(&text).unwrap(), job);
        }
    }

    #[test]
    fn mistakes_are_told_with_their_line() {
        for (text, wanted) in [
            ("", "fleet.toml, log: missing"),
            ("[[log]]\n", "fleet.toml line 1, log.drive: give drive"),
            (
                "[[log]]\ndrive='a'\nrecord='b'\n",
                "fleet.toml line 2, log.drive: give drive",
            ),
            (
                "[[log]]\ndrive='a'\ncolour=1\n",
                "fleet.toml line 3, log.colour: unknown key; known here: bias_models, data, drive",
            ),
            (
                "uint='a'\n[[log]]\ndrive='a'\n",
                "fleet.toml line 1, uint: unknown key",
            ),
            (
                "[[log]]\n\ndrive='none*'\n",
                "fleet.toml line 3, log.drive: \"none*\" matches no file",
            ),
            (
                "temperature='warm'\n[[log]]\ndrive='a'\n",
                "fleet.toml line 1, temperature: must be such as",
            ),
            (
                "temperature=25\n[[log]]\ndrive='a'\n",
                "fleet.toml line 1, temperature: must be a string",
            ),
            (
                "log = 3",
                "fleet.toml line 1, log: must be tables: write [[log]]",
            ),
            (
                "log = [3]",
                "fleet.toml line 1, log: must be tables: write [[log]]",
            ),
            (
                "[outages]\nlength=10\n[[log]]\ndrive='a'\n",
                "fleet.toml line 2, outages.length: the number needs a unit",
            ),
            (
                "[outages]\nevery='0 s'\n[[log]]\ndrive='a'\n",
                "fleet.toml line 2, outages.every: must be longer",
            ),
            (
                "[[log]]\ndrive='a'\noutages={count=0}\n",
                "fleet.toml line 3, outages.count: must be 1 or more",
            ),
            (
                "bias_models=[]\n[[log]]\ndrive='a'\n",
                "must be a list of words",
            ),
            (
                "[[log]]\ndrive=''\n",
                "log.drive: the name of the file is empty",
            ),
        ] {
            let error = jobs(text).unwrap_err().to_string();
            assert!(error.contains(wanted), "{text}: {error}");
        }
    }

    #[test]
    fn temperatures() {
        assert_eq!(celsius("25 degC"), Some(25.0));
        assert_eq!(celsius("−5°C"), Some(-5.0));
        assert_eq!(celsius("273.15 K"), Some(0.0));
        assert_eq!(celsius("-1 K"), None);
        assert_eq!(celsius("nan degC"), None);
        assert_eq!(celsius("25"), None);
    }
}
