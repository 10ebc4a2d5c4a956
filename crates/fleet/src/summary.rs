//! All outcomes in one: how far logs drift by bias model, unit, sensor, label and temperature, and which stand
//! out.

mod measures;

use super::{
    FleetOutcome, OutcomeRow,
    labels::{self, Labels},
    ratios::{self, Effects, Sample},
};
use measures::MEASURES;
use std::collections::BTreeMap;
use undrift_base::order_statistics::median;
use undrift_drive::findings::{self, Severity};
use undrift_results::{
    Bin, Effect, Fleet, FleetGroup, FleetLabel, FleetLog, FleetMeasure, FleetOutlier, FleetPart,
    LeftOut, Level, Number, Numbers, SCHEMA, Trouble, VERSION, Warned, by_name, series::to_digits,
};

/// One log's numbers.
struct OneLog {
    name: String,
    unit: Option<String>,
    sensor: Option<String>,
    labels: Labels,
    temperature_c: Option<f64>,
    /// By measure and part.
    values: BTreeMap<(usize, String), f64>,
    /// Parts whose values cannot be trusted.
    untrusted: Vec<String>,
}

impl OneLog {
    fn label(&self, name: &str) -> Option<&str> {
        self.labels.get(name).map(String::as_str)
    }
}

/// Logs of a measure, their labels and why one is left out, and the effects on it.
type Known<'a> = (
    Vec<&'a OneLog>,
    Vec<(&'a str, Option<LeftOut>)>,
    Option<Effects>,
);

/// What is kept of the outcomes, a few numbers of each.
#[derive(Default)]
pub struct Tally {
    logs: Vec<OneLog>,
    tasks: BTreeMap<String, u64>,
    /// Bias models and axes in the order in which they came.
    parts: Vec<String>,
    failed: Vec<Trouble>,
    untrusted: Vec<Trouble>,
    warned: Vec<Warned>,
}

impl Tally {
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
        // A log as a whole, by its findings: who fills in the warnings begins with their sentences.
        if let (severity, Some(cause)) = findings::verdict(&outcome.findings)
            && severity > Severity::Note
        {
            let place = outcome.findings.iter().position(|of| of == cause);
            let why = place.and_then(|place| outcome.warnings.get(place));
            self.untrusted
                .push(trouble(None, why.map_or("", String::as_str)));
        }
        if !outcome.warnings.is_empty() {
            self.warned.push(Warned {
                log: log.clone(),
                unit: unit.clone(),
                warnings: outcome.warnings.clone(),
            });
        }
        let mut values = BTreeMap::new();
        let mut untrusted = Vec::new();
        let mut rows: Vec<(&str, Vec<&OutcomeRow>)> = Vec::new();
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
                untrusted.push(part.to_owned());
            }
            for (place, measure) in MEASURES.iter().enumerate() {
                let (task, parts) = measure.of;
                let fits = task == outcome.task && part.starts_with(parts);
                let value = fits.then(|| measure.value(outcome, &rows)).flatten();
                if let Some(value) = value.filter(|v| v.is_finite()) {
                    values.insert((place, part.to_owned()), value);
                }
            }
        }
        self.logs.push(OneLog {
            name: log.clone(),
            unit: unit.clone(),
            sensor: outcome.sensor.clone(),
            labels: outcome.labels.clone(),
            temperature_c: outcome.temperature_c,
            values,
            untrusted,
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
        }
    }

    /// The logs that have a part of a measure, with its value.
    fn logs_with<'a>(
        &'a self,
        place: usize,
        part: &'a str,
    ) -> impl Iterator<Item = (&'a OneLog, f64)> + 'a {
        let key = (place, part.to_owned());
        let value = move |log: &'a OneLog| Some((log, *log.values.get(&key)?));
        self.logs.iter().filter_map(value)
    }

    fn measure(&self, place: usize) -> Option<FleetMeasure> {
        let measure = MEASURES.get(place)?;
        let parts: Vec<&str> = self
            .parts
            .iter()
            .map(String::as_str)
            .filter(|part| self.logs_with(place, part).next().is_some())
            .collect();
        if parts.is_empty() {
            return None;
        }
        let (logs, labels, effects) = self.effects(place, &parts);
        let tested = effects.as_ref().map(|effects| effects.tested);
        let effects = effects.unwrap_or_default();
        let outlier = |(at, effect): (usize, Effect)| {
            let log = logs.get(at)?;
            Some(FleetOutlier {
                log: log.name.clone(),
                unit: log.unit.clone(),
                report: log.label("report").map(str::to_owned),
                temperature_c: log.temperature_c.into(),
                effect,
            })
        };
        let mut outliers: Vec<_> = effects.logs.into_iter().filter_map(outlier).collect();
        outliers.sort_by(|a, b| a.effect.p.0.total_cmp(&b.effect.p.0));
        let mut factors = effects.factors.into_iter();
        let sensors = factors.next().unwrap_or_default();
        let by_label = labels.into_iter().map(|(label, left_out)| {
            let factor = left_out.is_none().then(|| factors.next()).flatten();
            self.label(place, &parts, label, left_out, factor)
        });
        let by_label = by_label.collect();
        let level = |at: usize| effects.levels.get(at).copied().flatten();
        let of_parts = parts.iter().enumerate();
        Some(FleetMeasure {
            name: measure.name.into(),
            what: measure.what.into(),
            unit: measure.unit.into(),
            task: measure.of.0.into(),
            parts: of_parts
                .map(|(at, part)| self.part(place, part, level(at)))
                .collect(),
            best: self.best(place, &parts),
            effects: tested,
            outliers,
            by_unit: self.groups(place, &parts, &effects.units, |log| log.unit.as_deref()),
            by_sensor: self.groups(place, &parts, &sensors, |log| log.sensor.as_deref()),
            by_label,
        })
    }

    /// A label with the effects of its values.
    fn label(
        &self,
        place: usize,
        parts: &[&str],
        label: &str,
        left_out: Option<LeftOut>,
        effects: Option<BTreeMap<String, Effect>>,
    ) -> FleetLabel {
        let groups = |effects| self.groups(place, parts, &effects, |log| log.label(label));
        FleetLabel {
            label: label.to_owned(),
            by_value: effects.map_or_else(Vec::new, groups),
            left_out,
        }
    }

    /// The logs that have the measure, their labels, and what it depends on; of a solution that diverged it does not.
    fn effects(&self, place: usize, parts: &[&str]) -> Known<'_> {
        let sample = |log: &OneLog| {
            let value = |(at, part): (usize, &&str)| {
                let part = (*part).to_owned();
                let trusted = !log.untrusted.contains(&part);
                let value = *log.values.get(&(place, part))?;
                trusted.then_some((at, value))
            };
            parts
                .iter()
                .enumerate()
                .filter_map(value)
                .collect::<Vec<_>>()
        };
        let logs = self.logs.iter().map(|log| (log, sample(log)));
        let (logs, values): (Vec<&OneLog>, Vec<_>) = logs.filter(|(_, v)| !v.is_empty()).unzip();
        let known: Vec<_> = logs
            .iter()
            .map(|log| (log.unit.as_deref(), &log.labels))
            .collect();
        let labels: Vec<_> = labels::chosen(&known).collect();
        let factors = labels.iter().filter(|(_, left_out)| left_out.is_none());
        let samples: Vec<Sample<'_>> = logs
            .iter()
            .zip(values)
            .map(|(log, values)| Sample {
                values,
                unit: log.unit.as_deref(),
                levels: [log.sensor.as_deref()]
                    .into_iter()
                    .chain(factors.clone().map(|(label, _)| log.label(label)))
                    .collect(),
                temperature_c: log.temperature_c,
            })
            .collect();
        let effects = ratios::effects(&samples, parts.len());
        (logs, labels, effects)
    }

    /// A bias model or axis over all logs.
    fn part(&self, place: usize, part: &str, level: Option<Level>) -> FleetPart {
        let values: Vec<f64> = self
            .logs_with(place, part)
            .map(|(_, value)| value)
            .collect();
        let known = self.logs_with(place, part);
        let pairs: Vec<(f64, f64)> = known
            .filter_map(|(log, value)| Some((log.temperature_c?, value)))
            .collect();
        FleetPart {
            part: part.to_owned(),
            logs: values.len() as u64,
            median: to_digits(median(&values)).into(),
            level,
            temperature: bins(&pairs),
        }
    }

    /// On how many of the logs that have all parts each one is the least.
    fn best(&self, place: usize, parts: &[&str]) -> BTreeMap<String, u64> {
        let mut best = vec![0_u64; parts.len()];
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
        by_name(counts.map(|(part, n)| (*part, n)))
    }

    /// The medians of the logs of each group, and what it differs by.
    fn groups(
        &self,
        place: usize,
        parts: &[&str],
        effects: &BTreeMap<String, Effect>,
        group: impl Fn(&OneLog) -> Option<&str>,
    ) -> Vec<FleetGroup> {
        let keys: Vec<(usize, String)> = parts.iter().map(|p| (place, (*p).to_owned())).collect();
        let mut groups: BTreeMap<&str, Vec<&OneLog>> = BTreeMap::new();
        for log in &self.logs {
            let any = keys.iter().any(|key| log.values.contains_key(key));
            if let (Some(name), true) = (group(log), any) {
                groups.entry(name).or_default().push(log);
            }
        }
        let of_group = |(name, logs): (&str, Vec<&OneLog>)| {
            let of_part = |key: &(usize, String)| {
                let values = logs.iter().filter_map(|log| log.values.get(key).copied());
                let middle = median(&values.collect::<Vec<_>>());
                let known = middle.is_finite();
                known.then(|| (key.1.clone(), to_digits(middle)))
            };
            FleetGroup {
                name: name.to_owned(),
                logs: logs.len() as u64,
                median: by_name(keys.iter().filter_map(of_part)),
                effect: effects.get(name).copied(),
            }
        };
        groups.into_iter().map(of_group).collect()
    }
}

fn log(log: &OneLog) -> FleetLog {
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

#[cfg(test)]
mod tests;
