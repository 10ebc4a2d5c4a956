//! What a manifest says of all logs and of each: the keys beside `drive` and `record`.

use crate::{OutagePlan, RecordSettings};
use std::collections::BTreeMap;
use undrift_drive::{
    drive::{ConfigError, Section, columns},
    identify::Trend,
};
use undrift_io::table::Column;
use undrift_nav::units::{self, Quantity};
use undrift_noise::{BiasModel, temperature::celsius};

/// What is done with drives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verb {
    /// Their GNSS is cut.
    Outages,
    /// They are navigated.
    Navigate,
    /// Their noise is identified, drive by drive.
    Tune,
}

/// What is to be done with logs, and what is known of them; a log's own word goes before that of all.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// What is done with drives.
    pub verb: Verb,
    /// Bias models for drives.
    pub bias_models: Vec<BiasModel>,
    /// Where GNSS is cut.
    pub plan: OutagePlan,
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
    /// Type of the IMU, instead of the name of its noise model.
    pub sensor: Option<String>,
    /// What the log is called, if not by its files.
    pub name: Option<String>,
    /// What else is known, by name.
    pub labels: BTreeMap<String, String>,
    /// Temperature [°C].
    pub temperature_c: Option<f64>,
}

impl Default for Choice {
    fn default() -> Self {
        Self {
            verb: Verb::Outages,
            bias_models: BiasModel::ALL.to_vec(),
            plan: OutagePlan::default(),
            smooth: false,
            record: RecordSettings {
                n_max: 2,
                ..RecordSettings::default()
            },
            model: None,
            data: None,
            unit: None,
            sensor: None,
            name: None,
            labels: BTreeMap::new(),
            temperature_c: None,
        }
    }
}

pub(super) fn read_choice(
    section: &Section,
    before: Choice,
    unit: &str,
) -> Result<Choice, ConfigError> {
    let mut choice = before;
    let tasks = [
        ("outages", Verb::Outages),
        ("navigate", Verb::Navigate),
        ("tune", Verb::Tune),
    ];
    if let Some(verb) = section.word("task", &tasks)? {
        choice.verb = verb;
    }
    let models = BiasModel::ALL.map(|model| (model.name(), model));
    if let Some(models) = section.words("bias_models", &models)? {
        choice.bias_models = models;
    }
    if let Some(smooth) = section.switch("smooth")? {
        choice.smooth = smooth;
    }
    for (key, slot, what) in [
        ("model", &mut choice.model, "a preset or a model file"),
        ("data", &mut choice.data, "a folder"),
        ("unit", &mut choice.unit, unit),
        ("type", &mut choice.sensor, "the type of the IMU"),
    ] {
        match section.text(key)? {
            Some("") => return Err(section.error(key, format!("is empty; set {what}"))),
            Some(text) => *slot = Some(text.to_owned()),
            None => {}
        }
    }
    if let Some(text) = section.text("temperature")? {
        let celsius = celsius(text).ok_or_else(|| section.error("temperature", TEMPERATURE));
        choice.temperature_c = Some(celsius?);
    }
    let labels = section.section("labels")?;
    for label in labels.keys() {
        if let Some(text) = labels.text(label)? {
            choice.labels.insert(label.to_owned(), text.to_owned());
        }
    }
    read_plan(&section.section("outages")?, &mut choice.plan)?;
    read_record(&section.section("identify")?, &mut choice.record)?;
    Ok(choice)
}

/// What a temperature looks like.
pub(super) const TEMPERATURE: &str = "must be such as \"25 degC\" or \"298 K\"";

/// Times with a unit behind the last one, in ascending order \[s\]: `"120, 300 s"`.
pub(super) fn times(text: &str) -> Result<Vec<f64>, String> {
    let wrong = || format!("\"{text}\" must be ascending times such as \"120, 300 s\"");
    let unit = text.trim_start_matches(|c: char| c.is_ascii_digit() || " .,;+-eE".contains(c));
    let numbers = text.strip_suffix(unit).unwrap_or_default();
    let factor = units::unit_factor(unit.trim(), Quantity::Time).map_err(|_| wrong())?;
    let numbers = numbers.split([',', ';', ' ']).filter(|n| !n.is_empty());
    let times: Vec<f64> = numbers
        .map(|number| number.parse::<f64>().map(|number| number * factor))
        .collect::<Result<_, _>>()
        .map_err(|_| wrong())?;
    let ascends = times.iter().zip(times.iter().skip(1)).all(|(a, b)| a < b);
    if times.is_empty() || !ascends || !times.iter().all(|time| time.is_finite()) {
        return Err(wrong());
    }
    Ok(times)
}

fn read_plan(section: &Section, plan: &mut OutagePlan) -> Result<(), ConfigError> {
    let time = |key, most: bool| match section.quantity(key, Quantity::Time)? {
        Some(time) if time < 0.0 || (most && time == 0.0) => Err(section.error(
            key,
            if most {
                "must be longer than 0 s"
            } else {
                "must not be negative"
            },
        )),
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
    let at = section.text("at")?;
    if at.is_some() && (every.is_some() || count.is_some()) {
        return Err(section.error("at", "set either at, or every and count"));
    }
    if every.is_some() || count.is_some() {
        plan.every_s = every;
        plan.count = count.map(|n| usize::try_from(n).unwrap_or(usize::MAX));
        plan.at_s = None;
    }
    if let Some(text) = at {
        plan.at_s = Some(times(text).map_err(|why| section.error("at", why))?);
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
    match (columns(section, "gyro")?, columns(section, "accel")?) {
        (Some(gyro), Some(accel)) => {
            let name = |column: Column| match column {
                Column::Name(name) => name,
                Column::Number(number) => number.to_string(),
            };
            record.columns = gyro.into_iter().chain(accel).map(name).collect();
        }
        (None, None) => {}
        _ => return Err(section.error("gyro", "set both gyro and accel, or neither")),
    }
    match (section.text("gyro_unit")?, section.text("accel_unit")?) {
        (Some(gyro), Some(accel)) => record.units = Some((gyro.into(), accel.into())),
        (None, None) => {}
        _ => {
            return Err(section.error("gyro_unit", "set both gyro_unit and accel_unit, or neither"));
        }
    }
    if let Some(topic) = section.text("topic")? {
        record.topic = Some(topic.to_owned());
    }
    let trends = Trend::ALL.map(|trend| (trend.name(), trend));
    if let Some(trend) = section.word("detrend", &trends)? {
        record.detrend = trend;
    }
    if let Some(n) = section.whole("n_max")? {
        record.n_max = usize::try_from(n).unwrap_or(usize::MAX);
    }
    section.only_known()
}
