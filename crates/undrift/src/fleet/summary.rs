//! All outcomes in one: how far logs drift by bias model, unit, sensor and temperature, and which stand out.

use super::{
    FleetOutcome, Row,
    statistics::{
        OUTLIER_DEVIATIONS, OUTLIER_LEAST, OUTLIER_SHARE, outlier_limit, rank_correlation,
    },
};
use crate::{
    results::{
        Bin, Fleet, FleetGroup, FleetLog, FleetMeasure, FleetOutlier, FleetPart, Number, Numbers,
        OutlierRule, SCHEMA, Temperature, Trouble, VERSION, Warned,
    },
    series::to_digits,
};
use std::collections::BTreeMap;
use undrift_nav::earth::STANDARD_GRAVITY;
use undrift_noise::order_statistics::median;

/// What is compared between logs: a number for each bias model or axis.
struct Measure {
    name: &'static str,
    /// What it is, in words.
    what: &'static str,
    unit: &'static str,
    /// Of which task, and of which of its parts.
    task: &'static str,
    parts: &'static str,
    /// From the rows of one part, in `unit`.
    of: fn(&FleetOutcome, &[&Row]) -> Option<f64>,
}

/// A number of the only row.
fn only(outcome: &FleetOutcome, rows: &[&Row], column: &str, factor: f64) -> Option<f64> {
    let value = outcome.value(rows.first()?, column)?;
    (value > 0.0).then_some(value * factor)
}

/// Root mean square of a column over the rows, if every row has it.
fn rms(outcome: &FleetOutcome, rows: &[&Row], column: &str) -> Option<f64> {
    let square = |row: &&Row| outcome.value(row, column).map(|v| v * v);
    let squares: Vec<f64> = rows.iter().map(square).collect::<Option<_>>()?;
    (!squares.is_empty()).then(|| (squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
}

/// Seconds to hours under the root, and radians to degrees.
const ROOT_HOUR: f64 = 60.0;
const DEGREE: f64 = 180.0 / std::f64::consts::PI;

const MEASURES: [Measure; 14] = [
    Measure {
        name: "drift",
        what: "largest horizontal error in an outage, root mean square over the outages of a log",
        unit: "m",
        task: "outages",
        parts: "",
        of: |o, rows| rms(o, rows, "max_horizontal_m"),
    },
    Measure {
        name: "error",
        what: "horizontal error against the truth, root mean square",
        unit: "m",
        task: "navigate",
        parts: "",
        of: |o, rows| only(o, rows, "rms_horizontal_m", 1.0),
    },
    Measure {
        name: "nis_position",
        what: "normalised innovation squared of the position per degree of freedom, 1 if the model is correct",
        unit: "",
        task: "navigate",
        parts: "",
        of: |o, rows| only(o, rows, "nis_position", 1.0),
    },
    Measure {
        name: "nis_velocity",
        what: "normalised innovation squared of the velocity per degree of freedom, 1 if the model is correct",
        unit: "",
        task: "navigate",
        parts: "",
        of: |o, rows| only(o, rows, "nis_velocity", 1.0),
    },
    Measure {
        name: "vehicle_gyro_white_noise",
        what: "white noise of the gyros in the vehicle (angle random walk), if the drive determines it",
        unit: "deg/√h",
        task: "tune",
        parts: "gyro",
        of: |o, rows| only(o, rows, "white_noise", DEGREE * ROOT_HOUR),
    },
    Measure {
        name: "vehicle_accel_white_noise",
        what: "white noise of the accelerometers in the vehicle (velocity random walk), if the drive determines it",
        unit: "m/s/√h",
        task: "tune",
        parts: "accel",
        of: |o, rows| only(o, rows, "white_noise", ROOT_HOUR),
    },
    Measure {
        name: "vehicle_gyro_random_walk",
        what: "random walk of the gyros' biases in the vehicle, if the drive determines it",
        unit: "deg/h/√h",
        task: "tune",
        parts: "gyro",
        of: |o, rows| only(o, rows, "random_walk", DEGREE * ROOT_HOUR.powi(3)),
    },
    Measure {
        name: "white_noise_ratio",
        what: "white noise in the vehicle relative to that at rest, if the drive determines it",
        unit: "",
        task: "tune",
        parts: "",
        of: |o, rows| only(o, rows, "white_noise_ratio", 1.0),
    },
    Measure {
        name: "tuned_drift",
        what: "largest horizontal error in a held-out outage, with the noise found, root mean square",
        unit: "m",
        task: "tune",
        parts: "",
        of: |o, rows| only(o, rows, "drift_after_m", 1.0),
    },
    Measure {
        name: "gyro_white_noise",
        what: "white noise of the gyros (angle random walk)",
        unit: "deg/√h",
        task: "identify",
        parts: "gyro",
        of: |o, rows| only(o, rows, "white_noise", DEGREE * ROOT_HOUR),
    },
    Measure {
        name: "gyro_bias_instability",
        what: "bias instability of the gyros, if the recording shows it",
        unit: "deg/h",
        task: "identify",
        parts: "gyro",
        of: |o, rows| only(o, rows, "bias_instability", DEGREE * ROOT_HOUR * ROOT_HOUR),
    },
    Measure {
        name: "gyro_drift",
        what: "angle that the recommended model of a gyro leaves after 10 s, root mean square",
        unit: "deg",
        task: "identify",
        parts: "gyro",
        of: |o, rows| only(o, rows, "drift_10s", DEGREE),
    },
    Measure {
        name: "accel_white_noise",
        what: "white noise of the accelerometers (velocity random walk)",
        unit: "m/s/√h",
        task: "identify",
        parts: "accel",
        of: |o, rows| only(o, rows, "white_noise", ROOT_HOUR),
    },
    Measure {
        name: "accel_bias_instability",
        what: "bias instability of the accelerometers, if the recording shows it",
        unit: "mg",
        task: "identify",
        parts: "accel",
        of: |o, rows| only(o, rows, "bias_instability", 1e3 / STANDARD_GRAVITY),
    },
];

/// One log's numbers.
struct Log {
    name: String,
    unit: Option<String>,
    sensor: Option<String>,
    temperature_c: Option<f64>,
    /// By measure and part.
    values: BTreeMap<(usize, String), f64>,
}

/// What is kept of the outcomes, a few numbers of each.
#[derive(Default)]
pub struct Summary {
    logs: Vec<Log>,
    tasks: BTreeMap<String, u64>,
    /// Bias models and axes in the order in which they came.
    parts: Vec<String>,
    failed: Vec<Trouble>,
    untrusted: Vec<Trouble>,
    warned: Vec<Warned>,
}

impl Summary {
    /// Adds an outcome.
    pub fn add(&mut self, outcome: &FleetOutcome) {
        let (log, unit) = (&outcome.log, &outcome.unit);
        *self.tasks.entry(outcome.task.clone()).or_default() += 1;
        let trouble = |part: Option<&str>, why: &str| Trouble {
            log: log.clone(),
            unit: unit.clone(),
            part: part.map(str::to_owned),
            why: why.to_owned(),
        };
        if let Some(why) = &outcome.failed {
            self.failed.push(trouble(None, why));
            return;
        }
        let failed = outcome.failed_parts.iter();
        self.untrusted
            .extend(failed.map(|(part, why)| trouble(Some(part), why)));
        if !outcome.warnings.is_empty() {
            self.warned.push(Warned {
                log: log.clone(),
                unit: unit.clone(),
                warnings: outcome.warnings.clone(),
            });
        }
        let mut values = BTreeMap::new();
        let mut rows: Vec<(&str, Vec<&Row>)> = Vec::new();
        for row in &outcome.rows {
            match rows.iter_mut().find(|(part, _)| *part == row.part) {
                Some((_, rows)) => rows.push(row),
                None => rows.push((&row.part, vec![row])),
            }
        }
        for (part, rows) in rows {
            if !self.parts.iter().any(|known| known == part) {
                self.parts.push(part.to_owned());
            }
            let note = rows.iter().find_map(|row| row.note.as_ref());
            if let (Some(why), false) = (note, outcome.task == "identify") {
                self.untrusted.push(trouble(Some(part), why));
            }
            for (place, measure) in MEASURES.iter().enumerate() {
                let fits = measure.task == outcome.task && part.starts_with(measure.parts);
                let value = fits.then(|| (measure.of)(outcome, &rows)).flatten();
                if let Some(value) = value.filter(|v| v.is_finite()) {
                    values.insert((place, part.to_owned()), value);
                }
            }
        }
        self.logs.push(Log {
            name: log.clone(),
            unit: unit.clone(),
            sensor: outcome.sensor.clone(),
            temperature_c: outcome.temperature_c,
            values,
        });
    }

    /// Everything, the result of the verb.
    pub fn result(self) -> Fleet {
        let measures = 0..MEASURES.len();
        Fleet {
            undrift: VERSION.into(),
            schema: SCHEMA,
            measures: measures.filter_map(|place| self.measure(place)).collect(),
            logs: self.logs.iter().map(log).collect(),
            tasks: self.tasks,
            failed: self.failed,
            untrusted: self.untrusted,
            warned: self.warned,
            outlier_rule: OutlierRule {
                deviations: OUTLIER_DEVIATIONS.into(),
                share: OUTLIER_SHARE.into(),
                least: OUTLIER_LEAST as u64,
            },
        }
    }

    /// The logs that have a part of a measure, with its value.
    fn of<'a>(&'a self, place: usize, part: &'a str) -> impl Iterator<Item = (&'a Log, f64)> + 'a {
        let key = (place, part.to_owned());
        let value = move |log: &'a Log| Some((log, *log.values.get(&key)?));
        self.logs.iter().filter_map(value)
    }

    fn measure(&self, place: usize) -> Option<FleetMeasure> {
        let measure = MEASURES.get(place)?;
        let parts: Vec<&str> = self
            .parts
            .iter()
            .map(String::as_str)
            .filter(|part| self.of(place, part).next().is_some())
            .collect();
        if parts.is_empty() {
            return None;
        }
        Some(FleetMeasure {
            name: measure.name.into(),
            what: measure.what.into(),
            unit: measure.unit.into(),
            parts: parts.iter().map(|part| self.part(place, part)).collect(),
            best: self.best(place, &parts),
            by_unit: self.groups(place, &parts, |log| log.unit.as_deref()),
            by_sensor: self.groups(place, &parts, |log| log.sensor.as_deref()),
        })
    }

    /// A bias model or axis over all logs.
    fn part(&self, place: usize, part: &str) -> FleetPart {
        let values: Vec<f64> = self.of(place, part).map(|(_, value)| value).collect();
        let middle = median(&values);
        let limit = outlier_limit(&values);
        let beyond = |value: f64| limit.is_some_and(|limit| value > limit);
        let mut outliers: Vec<(&Log, f64)> = self
            .of(place, part)
            .filter(|(_, value)| beyond(*value))
            .collect();
        outliers.sort_by(|a, b| b.1.total_cmp(&a.1));
        let outlier = |(log, value): (&Log, f64)| FleetOutlier {
            log: log.name.clone(),
            unit: log.unit.clone(),
            temperature_c: log.temperature_c.into(),
            value: to_digits(value).into(),
            times_median: to_digits(value / middle).into(),
        };
        let known = self.of(place, part);
        let pairs: Vec<(f64, f64)> = known
            .filter_map(|(log, value)| Some((log.temperature_c?, value)))
            .collect();
        let correlation = rank_correlation(&pairs);
        FleetPart {
            part: part.to_owned(),
            logs: values.len() as u64,
            median: to_digits(middle).into(),
            limit: limit.map(to_digits).into(),
            outliers: outliers.into_iter().map(outlier).collect(),
            temperature: Temperature {
                correlation: correlation.map(|c| to_digits(c.0)).into(),
                bound: correlation.map(|c| to_digits(c.1)).into(),
                bins: bins(&pairs),
            },
        }
    }

    /// On how many of the logs that have all parts each one is the least.
    fn best(&self, place: usize, parts: &[&str]) -> BTreeMap<String, u64> {
        let mut best = vec![0; parts.len()];
        for log in &self.logs {
            let value = |part: &&str| log.values.get(&(place, (*part).to_owned())).copied();
            let values: Option<Vec<f64>> = parts.iter().map(value).collect();
            let least = values.and_then(|values| {
                let places = values.iter().enumerate();
                places.min_by(|a, b| a.1.total_cmp(b.1)).map(|(at, _)| at)
            });
            if let Some(count) = least.and_then(|at| best.get_mut(at)) {
                *count += 1;
            }
        }
        let counts = parts.iter().zip(best);
        counts.map(|(part, n)| ((*part).to_owned(), n)).collect()
    }

    /// The medians of the logs of each group, the largest of the last part first.
    fn groups(
        &self,
        place: usize,
        parts: &[&str],
        group: impl Fn(&Log) -> Option<&str>,
    ) -> Vec<FleetGroup> {
        let mut groups: BTreeMap<&str, Vec<&Log>> = BTreeMap::new();
        for log in &self.logs {
            let any = parts
                .iter()
                .any(|part| log.values.contains_key(&(place, (*part).to_owned())));
            if let (Some(name), true) = (group(log), any) {
                groups.entry(name).or_default().push(log);
            }
        }
        let medians: Vec<Vec<f64>> = parts
            .iter()
            .map(|part| {
                let key = (place, (*part).to_owned());
                let of = |logs: &Vec<&Log>| {
                    let values = logs.iter().filter_map(|log| log.values.get(&key).copied());
                    median(&values.collect::<Vec<_>>())
                };
                groups.values().map(of).collect()
            })
            .collect();
        let limits: Vec<Option<f64>> = medians.iter().map(|m| outlier_limit(m)).collect();
        groups
            .iter()
            .enumerate()
            .map(|(at, (name, logs))| {
                let of = |k: usize| medians.get(k).and_then(|m| m.get(at)).copied();
                let mut median = Numbers::new();
                let mut outlying = Vec::new();
                for (k, part) in parts.iter().enumerate() {
                    let Some(value) = of(k).filter(|v| v.is_finite()) else {
                        continue;
                    };
                    median.insert((*part).to_owned(), to_digits(value).into());
                    if limits
                        .get(k)
                        .is_some_and(|l| l.is_some_and(|limit| value > limit))
                    {
                        outlying.push((*part).to_owned());
                    }
                }
                FleetGroup {
                    name: (*name).to_owned(),
                    logs: logs.len() as u64,
                    median,
                    outlying,
                }
            })
            .collect()
    }
}

fn log(log: &Log) -> FleetLog {
    let mut values: BTreeMap<String, Numbers> = BTreeMap::new();
    for ((place, part), value) in &log.values {
        let Some(measure) = MEASURES.get(*place) else {
            continue;
        };
        let parts = values.entry(measure.name.to_owned()).or_default();
        parts.insert(part.clone(), Number(to_digits(*value)));
    }
    FleetLog {
        log: log.name.clone(),
        unit: log.unit.clone(),
        sensor: log.sensor.clone(),
        temperature_c: log.temperature_c.map(to_digits).into(),
        values,
    }
}

/// Width of a bin of temperatures \[K\].
const BIN: f64 = 10.0;

/// Medians of the values in bins of temperature [°C].
fn bins(pairs: &[(f64, f64)]) -> Vec<Bin> {
    let mut bins: BTreeMap<i64, Vec<f64>> = BTreeMap::new();
    for (temperature, value) in pairs {
        let bin = (temperature / BIN).floor() as i64;
        bins.entry(bin).or_default().push(*value);
    }
    bins.into_iter()
        .map(|(bin, values)| {
            let from = bin as f64 * BIN;
            Bin {
                from_c: from.into(),
                to_c: (from + BIN).into(),
                logs: values.len() as u64,
                median: to_digits(median(&values)).into(),
            }
        })
        .collect()
}
