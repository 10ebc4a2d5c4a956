//! What a measure depends on: which unit, which type, is it the temperature? Each effect is a factor on the measure,
//! estimated together with the others by a [mixed model](super::mixed) of its logarithm.

use super::mixed::{Contrast, Fit, Grouping, Nested, Shift, quantile_95};
use std::collections::{BTreeMap, BTreeSet};
use undrift_results::{
    Effect, FleetEffects, Level, Number, Scatter, Slope, by_name, series::to_digits,
};

/// One log's values of a measure.
#[derive(Clone, Debug, Default)]
pub struct Sample<'a> {
    /// Place of the part, and the value; what is not positive is left out.
    pub values: Vec<(usize, f64)>,
    pub unit: Option<&'a str>,
    /// Levels of the factors, such as the type.
    pub levels: Vec<Option<&'a str>>,
    pub temperature_c: Option<f64>,
}

/// Probability of finding anything where there is nothing: of units, types and temperature together, so that 19 of
/// 20 fleets are left alone in 98 % of cases, …
pub const SIGNIFICANCE: f64 = 0.01;
/// … and of all logs, which are many more.
pub const OF_LOGS: f64 = 0.01;
/// Temperature at which levels are given [°C].
pub const REFERENCE_C: f64 = 25.0;
/// Levels of a factor that are compared.
pub const MOST_LEVELS: usize = 50;
/// Units that are set aside before there is reason to, in case several hide each other.
const AHEAD: usize = 2;
/// … among as many as this; more units cannot hide each other.
const FEW: usize = 300;
/// Rounds of setting aside.
const ROUNDS: usize = 12;

/// What a measure depends on.
#[derive(Default)]
pub struct Effects {
    pub model: FleetEffects,
    /// By part: the level at [`REFERENCE_C`].
    pub levels: Vec<Option<Level>>,
    /// By unit.
    pub units: BTreeMap<String, Effect>,
    /// By factor and level, relative to the mean of the other levels.
    pub factors: Vec<BTreeMap<String, Effect>>,
    /// Logs that do not belong: their place among the samples, and by which factor they differ from what the
    /// others and the rest of their unit predict.
    pub logs: Vec<(usize, Effect)>,
}

/// Columns of the fixed effects.
struct Design<'a> {
    parts: usize,
    /// Names of the levels of each factor, and the column of the first but one.
    factors: Vec<(Vec<&'a str>, usize)>,
    temperature: usize,
    columns: usize,
}

/// A level of a factor that a log does not state.
const UNKNOWN: &str = "";

impl<'a> Design<'a> {
    fn of(samples: &[Sample<'a>], parts: usize) -> Self {
        let temperature = parts;
        // After it a column of logs whose temperature is not known.
        let mut columns = parts + 2;
        let factors = samples.first().map_or(0, |sample| sample.levels.len());
        let factor = |k: usize| {
            let level = |sample: &Sample<'a>| sample.levels.get(k).copied().flatten();
            let names = samples
                .iter()
                .map(|sample| level(sample).unwrap_or(UNKNOWN));
            let mut names: Vec<&str> = names.collect::<BTreeSet<_>>().into_iter().collect();
            // The last column is the one that the others may make up, such as where the logs without a temperature
            // lack the level too.
            names.sort_by_key(|name| *name == UNKNOWN);
            if names.len() > MOST_LEVELS {
                names.clear();
            }
            let first = columns;
            columns += names.len().saturating_sub(1);
            (names, first)
        };
        Self {
            parts,
            factors: (0..factors).map(factor).collect(),
            temperature,
            columns,
        }
    }

    /// The column of a level; the first has none.
    fn column(&self, factor: usize, level: &str) -> Option<usize> {
        let (names, first) = self.factors.get(factor)?;
        let place = names.iter().position(|name| *name == level)?;
        Some(first + place.checked_sub(1)?)
    }

    fn rows(&self, sample: &Sample<'_>) -> Vec<(Vec<f64>, f64)> {
        let mut of_log = vec![0.0; self.columns];
        let mut set = |column: usize, value: f64| {
            if let Some(slot) = of_log.get_mut(column) {
                *slot = value;
            }
        };
        match sample.temperature_c.filter(|t| t.is_finite()) {
            Some(temperature) => set(self.temperature, temperature - REFERENCE_C),
            None => set(self.temperature + 1, 1.0),
        }
        for (factor, level) in sample.levels.iter().enumerate() {
            if let Some(column) = self.column(factor, level.unwrap_or(UNKNOWN)) {
                set(column, 1.0);
            }
        }
        let row = |(part, value): &(usize, f64)| {
            let mut row = of_log.clone();
            *row.get_mut(*part)? = 1.0;
            (value.is_finite() && *value > 0.0).then(|| (row, value.ln()))
        };
        sample.values.iter().filter_map(row).collect()
    }

    /// The contrast of a level with the mean of the other stated ones.
    fn against_others(&self, factor: usize, level: &str) -> Vec<(usize, f64)> {
        let names = self.factors.get(factor).map_or(&[][..], |(names, _)| names);
        let others = names.iter().filter(|n| **n != UNKNOWN && **n != level);
        let others: Vec<&str> = others.copied().collect();
        let share = -1.0 / others.len() as f64;
        let others = others.into_iter().map(|name| (name, share));
        let all = others.chain([(level, 1.0)]);
        all.filter_map(|(name, weight)| Some((self.column(factor, name)?, weight)))
            .collect()
    }

    /// The level of a part: at the reference temperature, the mean of the stated types.
    fn level(&self, part: usize) -> Vec<(usize, f64)> {
        let mut weights = vec![(part, 1.0)];
        for (factor, (names, _)) in self.factors.iter().enumerate() {
            let stated = || names.iter().filter(|name| **name != UNKNOWN);
            let share = 1.0 / stated().count().max(1) as f64;
            let columns = stated().filter_map(|name| self.column(factor, name));
            weights.extend(columns.map(|column| (column, share)));
        }
        weights
    }
}

/// The samples with values as rows, unit by unit; the names of the units, and the places of the logs among the samples.
fn nested<'a>(
    samples: &[Sample<'a>],
    design: &Design<'a>,
) -> (Nested, Vec<Option<&'a str>>, Vec<usize>) {
    let mut nested = Nested::new(design.columns);
    // Logs without a unit are units of their own.
    let mut by_unit: BTreeMap<(Option<&str>, usize), Vec<usize>> = BTreeMap::new();
    for (place, sample) in samples.iter().enumerate() {
        let own = if sample.unit.is_some() { 0 } else { place + 1 };
        by_unit.entry((sample.unit, own)).or_default().push(place);
    }
    let (mut names, mut places) = (Vec::new(), Vec::new());
    for ((name, _), logs) in by_unit {
        let with_rows = logs.into_iter().map(|log| (log, samples.get(log)));
        let with_rows = with_rows.filter_map(|(log, sample)| Some((log, design.rows(sample?))));
        let with_rows = with_rows.filter(|(_, rows)| !rows.is_empty());
        let (logs, rows): (Vec<usize>, Vec<_>) = with_rows.unzip();
        if !logs.is_empty() {
            nested.add(&rows);
            names.push(name);
            places.extend(logs);
        }
    }
    (nested, names, places)
}

/// Fits the model; `None` where there are too few logs.
pub fn effects(samples: &[Sample<'_>], parts: usize) -> Option<Effects> {
    let design = Design::of(samples, parts);
    let (mut nested, names, places) = nested(samples, &design);
    let mut fit = nested.fit(None)?;
    let named: Vec<bool> = names.iter().map(Option::is_some).collect();
    // Where each unit has one log, it is the logs that are compared, under the names of their units.
    let has_units = nested.has(Grouping::Unit);
    let logs_are_units = !has_units && named.contains(&true);
    let logs = if logs_are_units {
        Vec::new()
    } else {
        outlying_logs(&mut nested, &mut fit, &places)
    };
    let level = if has_units {
        Grouping::Unit
    } else {
        Grouping::Log
    };
    let tested = if has_units || logs_are_units {
        named
    } else {
        vec![false; nested.count(level)]
    };
    let shifts = if tested.contains(&true) {
        let ahead = if tested.len() <= FEW { AHEAD } else { 0 };
        set_aside(&mut nested, &mut fit, level, &tested, SIGNIFICANCE, ahead)
    } else {
        Vec::new()
    };
    let factors = (0..design.factors.len()).map(|factor| compared(&design, &nested, &fit, factor));
    let factors: Vec<Vec<(&str, Contrast)>> = factors.collect();
    let temperature = fit.contrast(&nested, &[(design.temperature, 1.0)]);

    // One family of questions: units, each factor, temperature.
    let mut questions = vec![holm(&probabilities(&shifts, &tested))];
    questions.extend(factors.iter().map(|levels| of_factor(levels)));
    questions.push(vec![temperature.map(|slope| slope.probability())]);
    let mut questions = of_one_family(questions).into_iter();
    let mut answers = || questions.next().unwrap_or_default();

    let units = of_units(&nested, &fit, &names, &shifts, &answers());
    let factors = factors.into_iter().map(|levels| {
        let effect = |((name, contrast), p): ((&str, Contrast), Option<f64>)| {
            (name.to_owned(), of_contrast(&contrast, p.unwrap_or(1.0)))
        };
        by_name(levels.into_iter().zip(answers()).map(effect))
    });
    let factors = Vec::from_iter(factors);
    let p = answers().first().copied().flatten().unwrap_or(1.0);
    let level = |part: usize| {
        let log = fit.contrast(&nested, &design.level(part))?;
        let [value, low, high] = interval(log.estimate, log.half_width(), f64::exp);
        Some(Level { value, low, high })
    };
    let scatter = |ratio: f64| to_digits((fit.variance * ratio).sqrt()).into();
    Some(Effects {
        levels: (0..design.parts).map(level).collect(),
        model: FleetEffects {
            logs: places.len() as u64,
            units: units.len() as u64,
            significance: SIGNIFICANCE.into(),
            significance_of_logs: OF_LOGS.into(),
            reference_c: REFERENCE_C.into(),
            scatter: Scatter {
                unit: scatter(fit.ratios[1]),
                log: scatter(fit.ratios[0]),
                rest: scatter(1.0),
            },
            temperature: temperature.map(|slope| of_temperature(&slope, p)),
        },
        units,
        factors,
        logs,
    })
}

/// Logs that do not belong, which are set aside.
fn outlying_logs(nested: &mut Nested, fit: &mut Fit, places: &[usize]) -> Vec<(usize, Effect)> {
    let all = vec![true; places.len()];
    let shifts = set_aside(nested, fit, Grouping::Log, &all, OF_LOGS, 0);
    let probabilities = holm(&probabilities(&shifts, &all));
    let logs = shifts.iter().zip(places).zip(probabilities).enumerate();
    let aside = logs.filter(|(log, _)| nested.is_aside(Grouping::Log, *log));
    aside
        .filter_map(|(_, ((shift, place), p))| {
            Some((*place, around(shift.as_ref()?, p.unwrap_or(1.0), true)))
        })
        .collect()
}

/// The units that have names, with their adjusted probabilities: by their predictions, or by the shifts of logs that
/// stand for them.
fn of_units(
    nested: &Nested,
    fit: &Fit,
    names: &[Option<&str>],
    shifts: &[Option<Shift>],
    p: &[Option<f64>],
) -> BTreeMap<String, Effect> {
    let predicted = if nested.has(Grouping::Unit) {
        nested.predictions(fit)
    } else {
        Vec::new()
    };
    let freedom = nested.between_freedom(fit).max(1.0);
    let unit = |(place, (name, p)): (usize, (&Option<&str>, &Option<f64>))| {
        let (name, p) = ((*name)?, (*p)?);
        let found = p < SIGNIFICANCE;
        let effect = match predicted.get(place) {
            Some((mean, square)) => {
                let half = quantile_95(freedom) * square.sqrt();
                factor(*mean, half, freedom, p, found)
            }
            None => around(shifts.get(place)?.as_ref()?, p, found),
        };
        Some((name.to_owned(), effect))
    };
    let units = names.iter().zip(p).enumerate();
    by_name(units.filter_map(unit))
}

/// Probabilities of the levels of a factor, adjusted among themselves.
fn of_factor(levels: &[(&str, Contrast)]) -> Vec<Option<f64>> {
    let p = levels.iter().map(|(_, contrast)| contrast.probability());
    let p = Vec::from_iter(p.map(Some));
    // Of two levels one is the other's inverse.
    if p.len() == 2 { p } else { holm(&p) }
}

fn of_temperature(slope: &Contrast, p: f64) -> Slope {
    let percent = |log: f64| 100.0 * log.exp_m1();
    let [percent_per_k, low, high] = interval(slope.estimate, slope.half_width(), percent);
    Slope {
        percent_per_k,
        low,
        high,
        freedom: to_digits(slope.freedom).into(),
        p: to_digits(p).into(),
        found: p < SIGNIFICANCE,
    }
}

/// The stated levels of a factor against the others, where there are several that the logs tell apart.
fn compared<'a>(
    design: &Design<'a>,
    nested: &Nested,
    fit: &Fit,
    factor: usize,
) -> Vec<(&'a str, Contrast)> {
    let Some((names, _)) = design.factors.get(factor) else {
        return Vec::new();
    };
    let stated: Vec<&str> = names.iter().copied().filter(|n| *n != UNKNOWN).collect();
    if stated.len() < 2 {
        return Vec::new();
    }
    let one = |name: &&'a str| {
        let contrast = fit.contrast(nested, &design.against_others(factor, name))?;
        Some((*name, contrast))
    };
    stated.iter().filter_map(one).collect()
}

fn shifts(nested: &Nested, fit: &Fit, level: Grouping) -> Vec<Option<Shift>> {
    match level {
        Grouping::Unit => nested.unit_shifts(fit),
        Grouping::Log => nested.log_shifts(fit),
    }
}

fn probabilities(shifts: &[Option<Shift>], tested: &[bool]) -> Vec<Option<f64>> {
    let pairs = shifts.iter().zip(tested);
    pairs
        .map(|(shift, tested)| shift.filter(|_| *tested).map(|shift| shift.probability))
        .collect()
}

/// Sets aside what does not belong to the others, so that it does not widen their spread, and fits again: first what
/// is significant at once, then up to `ahead` of the largest one by one, in case they hide each other (as the
/// generalised test of Rosner, Technometrics 25 (1983) 165). What is not significant in the end is taken back.
fn set_aside(
    nested: &mut Nested,
    fit: &mut Fit,
    level: Grouping,
    tested: &[bool],
    significance: f64,
    ahead: usize,
) -> Vec<Option<Shift>> {
    let all = tested.iter().filter(|tested| **tested).count();
    let mut chosen: Vec<usize> = Vec::new();
    let (mut sure, mut tried) = (0, 0);
    let mut known = shifts(nested, fit, level);
    for _ in 0..ROUNDS {
        let others = probabilities(&known, tested).into_iter().enumerate();
        let others = others.filter(|(place, _)| !chosen.contains(place));
        let mut others: Vec<(usize, f64)> = others.filter_map(|(k, p)| Some((k, p?))).collect();
        others.sort_by(|a, b| a.1.total_cmp(&b.1));
        let limit = significance / others.len().max(1) as f64;
        let significant = others.partition_point(|(_, p)| *p < limit);
        tried = if significant > 0 { 0 } else { tried + 1 };
        let room = (all / 4).saturating_sub(chosen.len());
        if tried > ahead || room == 0 {
            break;
        }
        let next = others.iter().take(significant.max(1).min(room));
        for (place, _) in next {
            nested.set_aside(level, *place, true);
            chosen.push(*place);
        }
        let Some(again) = nested.fit(Some(fit.ratios)) else {
            break;
        };
        *fit = again;
        known = shifts(nested, fit, level);
        if significant > 0 {
            sure = chosen.len();
        }
    }
    let limit = significance / all.max(1) as f64;
    let p = probabilities(&known, tested);
    let mut back = false;
    for (order, place) in chosen.iter().enumerate() {
        let stands = p.get(*place).copied().flatten().is_some_and(|p| p < limit);
        if order >= sure || !stands {
            nested.set_aside(level, *place, false);
            back = true;
        }
    }
    if back && let Some(again) = nested.fit(Some(fit.ratios)) {
        *fit = again;
        known = shifts(nested, fit, level);
    }
    known
}

/// Probabilities adjusted for their number (Holm, Scandinavian Journal of Statistics 6 (1979) 65).
fn holm(p: &[Option<f64>]) -> Vec<Option<f64>> {
    let known = p.iter().enumerate().filter_map(|(k, p)| Some((k, (*p)?)));
    let mut known: Vec<(usize, f64)> = known.collect();
    known.sort_by(|a, b| a.1.total_cmp(&b.1));
    let mut adjusted = vec![None; p.len()];
    let (mut most, count) = (0.0_f64, known.len());
    for (order, (place, p)) in known.into_iter().enumerate() {
        most = most.max(p * (count - order) as f64).min(1.0);
        if let Some(slot) = adjusted.get_mut(place) {
            *slot = Some(most);
        }
    }
    adjusted
}

/// The same over questions, of which each has some probabilities that are adjusted among themselves: the least of a
/// question is its own. A question is open once those with smaller ones are answered.
fn of_one_family(mut questions: Vec<Vec<Option<f64>>>) -> Vec<Vec<Option<f64>>> {
    let least = |p: &Vec<Option<f64>>| p.iter().flatten().copied().reduce(f64::min);
    let own = questions.iter().map(least).enumerate();
    let mut own: Vec<(usize, f64)> = own.filter_map(|(k, p)| Some((k, p?))).collect();
    own.sort_by(|a, b| a.1.total_cmp(&b.1));
    let (mut most, count) = (0.0_f64, own.len());
    for (order, (place, p)) in own.into_iter().enumerate() {
        let times = (count - order) as f64;
        most = most.max(times * p).min(1.0);
        for p in questions.get_mut(place).into_iter().flatten().flatten() {
            *p = (times * *p).max(most).min(1.0);
        }
    }
    questions
}

/// What a logarithm and the ends of its interval stand for.
fn interval(log: f64, half: f64, of: impl Fn(f64) -> f64) -> [Number; 3] {
    [log, log - half, log + half].map(|log| to_digits(of(log)).into())
}

fn factor(log: f64, half: f64, freedom: f64, p: f64, found: bool) -> Effect {
    let [times, low, high] = interval(log, half, f64::exp);
    Effect {
        times,
        low,
        high,
        freedom: to_digits(freedom).into(),
        p: to_digits(p).into(),
        found,
    }
}

fn around(shift: &Shift, p: f64, found: bool) -> Effect {
    let half = quantile_95(shift.freedom.max(1.0)) * shift.spread;
    factor(shift.estimate, half, shift.freedom, p, found)
}

fn of_contrast(contrast: &Contrast, p: f64) -> Effect {
    let found = p < SIGNIFICANCE;
    factor(
        contrast.estimate,
        contrast.half_width(),
        contrast.freedom,
        p,
        found,
    )
}

#[cfg(test)]
mod tests;
