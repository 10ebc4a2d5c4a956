//! What a measure depends on, one question at a time: which unit, which sensor or label, is it the temperature, which
//! logs? Each log is one number, the mean logarithm of its values; differences are tested by Student's t and reported as
//! factors. Causes that go together are not separated: that takes a model of all of them, in Python
//! `undrift.fleet.effects`.

mod student;

use std::collections::{BTreeMap, BTreeSet};
use student::{Estimate, Line, Moments, Point, Spread, holm, mean, slope, welch, within_units};
use undrift_results::{Effect, FleetEffects, Level, by_name};

/// One log's values of a measure.
#[derive(Clone, Debug, Default)]
pub struct Sample<'a> {
    /// Place of the part, and the value; what is not positive is ignored.
    pub values: Vec<(usize, f64)>,
    pub unit: Option<&'a str>,
    /// Levels of the factors, such as the type.
    pub levels: Vec<Option<&'a str>>,
    pub temperature_c: Option<f64>,
}

/// Probability of finding anything where there is nothing: of units, types and temperature together, …
pub const SIGNIFICANCE: f64 = 0.01;
/// … and of all logs, which are many more.
pub const OF_LOGS: f64 = 0.01;
/// Levels of a factor that are compared.
pub const MOST_LEVELS: usize = 50;
/// Units that show how much units differ, beside the one that is tested.
const OTHER_UNITS: f64 = 3.0;
/// Units that may hide each other from the test.
const MOST_HIDDEN: usize = 12;
/// Rounds of setting logs aside.
const ROUNDS: usize = 12;

/// What a measure depends on.
#[derive(Default)]
pub struct Effects {
    pub tested: FleetEffects,
    /// By part: the geometric mean over units.
    pub levels: Vec<Option<Level>>,
    /// By unit.
    pub units: BTreeMap<String, Effect>,
    /// By factor and level, relative to the other levels.
    pub factors: Vec<BTreeMap<String, Effect>>,
    /// Logs that do not belong: their place among the samples, and by which factor they differ from the rest of their
    /// unit.
    pub logs: Vec<(usize, Effect)>,
}

/// Compares the logs; `None` where there are fewer than two.
pub fn effects(samples: &[Sample<'_>], parts: usize) -> Option<Effects> {
    let (logs, levels) = logs_of(samples, parts);
    if logs.len() < 2 {
        return None;
    }
    let (aside, outliers) = outlying(&logs);
    let kept = logs.iter().filter(|log| !aside.contains(&log.place));
    let units = compared_units(&Vec::from_iter(kept.copied()));
    let count = samples.first().map_or(0, |sample| sample.levels.len());
    let factors = Vec::from_iter((0..count).map(|factor| compared_levels(&logs, factor)));
    let temperature = slope_with_temperature(&logs);

    // All that is compared is one family.
    let levels_of = factors.iter().flatten().map(|(_, ratio)| ratio);
    let tests = units.iter().map(|(_, test, _)| test).chain(levels_of);
    let p = tests.chain(&temperature).map(Estimate::probability);
    let mut p = holm(&Vec::from_iter(p)).into_iter();
    let mut ratio = |ratio: &Estimate| ratio.effect(p.next().unwrap_or(1.0));
    let units = by_name(units.iter().map(|(name, _, of)| (*name, ratio(of))));
    let factors = factors.iter().map(|levels| {
        let levels = levels.iter();
        by_name(levels.map(|(name, of)| (*name, ratio(of))))
    });
    let factors = Vec::from_iter(factors);
    Some(Effects {
        tested: FleetEffects {
            logs: logs.len() as u64,
            units: units.len() as u64,
            significance: SIGNIFICANCE.into(),
            significance_of_logs: OF_LOGS.into(),
            temperature: temperature.zip(p.next()).map(slope),
        },
        levels,
        units,
        factors,
        logs: outliers,
    })
}

/// A log as one number.
#[derive(Clone, Copy)]
struct Log<'a> {
    place: usize,
    sample: &'a Sample<'a>,
    /// Number of its unit; logs without a unit are units of their own.
    unit: usize,
    value: f64,
}

/// Each log's mean over its parts of ln y less the part's mean over logs, unit by unit; and the levels of the parts.
fn logs_of<'a>(samples: &'a [Sample<'a>], parts: usize) -> (Vec<Log<'a>>, Vec<Option<Level>>) {
    let mut sorted = Vec::from_iter(samples.iter().enumerate());
    sorted.sort_by_key(|(_, sample)| sample.unit);
    let mut logs: Vec<Log<'a>> = Vec::new();
    for (place, sample) in sorted {
        let last = logs.last().map(|log| (log.unit, log.sample.unit));
        let unit = last.map_or(0, |(unit, name)| {
            unit + usize::from(name.is_none() || name != sample.unit)
        });
        let value = f64::NAN;
        logs.push(Log {
            place,
            sample,
            unit,
            value,
        });
    }
    let logarithms = |log: &Log<'a>| {
        let values = log.sample.values.iter();
        let positive =
            values.filter(|(part, value)| *part < parts && value.is_finite() && *value > 0.0);
        positive.map(|(part, value)| (*part, value.ln()))
    };
    let mut by_part = vec![Vec::new(); parts];
    for log in &logs {
        for (part, value) in logarithms(log) {
            by_part[part].push(Log { value, ..*log });
        }
    }
    let means = Vec::from_iter(by_part.iter().map(|logs| Moments::from_logs(logs).mean));
    logs.retain_mut(|log| {
        let all = Moments::new(logarithms(log).map(|(part, value)| value - means[part]));
        log.value = all.mean;
        all.n > 0.0
    });
    let level = |logs: &Vec<Log<'a>>| {
        let units = Vec::from_iter(by_unit(logs).map(Moments::from_logs));
        let level = match units[..] {
            [of_logs] => of_logs,
            _ => Moments::new(units.iter().map(|unit| unit.mean)),
        };
        let error = (level.variance()? / level.n).sqrt();
        let level = Estimate {
            value: level.mean,
            error,
            freedom: level.n - 1.0,
        };
        let [value, low, high] = level.interval(f64::exp);
        Some(Level { value, low, high })
    };
    let levels = by_part.iter().map(level).collect();
    (logs, levels)
}

/// The logs of each unit.
fn by_unit<'a, 'b>(logs: &'b [Log<'a>]) -> impl Iterator<Item = &'b [Log<'a>]> {
    logs.chunk_by(|a, b| a.unit == b.unit)
}

/// Logs that differ from the rest of their unit, or from all if no log has a unit: the places of those set aside, and
/// the effects of those significant in the end. They are set aside in rounds, the worst of each unit, by the deleted
/// residuals of the analysis of variance.
fn outlying(logs: &[Log<'_>]) -> (BTreeSet<usize>, Vec<(usize, Effect)>) {
    let mut units = if logs.iter().any(|log| log.sample.unit.is_some()) {
        by_unit(logs).map(<[Log<'_>]>::to_vec).collect()
    } else {
        vec![logs.to_vec()]
    };
    units.retain(|logs| logs.len() > 1);
    let mut aside: Vec<(usize, Log<'_>)> = Vec::new();
    for _ in 0..ROUNDS {
        let kept = Vec::from_iter(units.iter().map(|logs| Moments::from_logs(logs)));
        let spread = Spread::within(&kept);
        let count: usize = units.iter().map(Vec::len).sum();
        let before = aside.len();
        for (unit, of_unit) in kept.iter().enumerate() {
            // Of two logs of a unit it is the one farther from all logs.
            let middle = if of_unit.n > 2.0 { of_unit.mean } else { 0.0 };
            let size = |log: &Log<'_>| (log.value - middle).abs();
            let worst = units[unit].iter().enumerate();
            let worst = worst.max_by(|(_, a), (_, b)| size(a).total_cmp(&size(b)));
            if let Some((at, log)) = worst
                && spread.deleted(log.value, of_unit).probability() * (count as f64) < OF_LOGS
            {
                aside.push((unit, units[unit].swap_remove(at)));
            }
        }
        if aside.len() == before {
            break;
        }
    }
    let kept = Vec::from_iter(units.iter().map(|logs| Moments::from_logs(logs)));
    let spread = Spread::within(&kept);
    let tests = aside
        .iter()
        .map(|(unit, log)| spread.beside(log.value, &kept[*unit]));
    let tests = Vec::from_iter(tests);
    let of_kept = units
        .iter()
        .zip(&kept)
        .flat_map(|(logs, of_unit)| logs.iter().map(|log| spread.deleted(log.value, of_unit)));
    let p = tests.iter().copied().chain(of_kept);
    let p = holm(&Vec::from_iter(p.map(|test| test.probability())));
    let found = aside
        .iter()
        .zip(&tests)
        .zip(p)
        .filter(|(_, p)| *p < OF_LOGS);
    let found = found.map(|(((_, log), test), p)| (log.place, test.effect(p)));
    let found = Vec::from_iter(found);
    (aside.iter().map(|(_, log)| log.place).collect(), found)
}

/// A unit with its test and its ratio to the others.
type OfUnit<'a> = (&'a str, Estimate, Estimate);

/// Each unit against the others without it and without those that hide others, as many as the generalised test of
/// Rosner (Technometrics 25 (1983) 165) finds.
fn compared_units<'a>(logs: &[Log<'a>]) -> Vec<OfUnit<'a>> {
    let units =
        by_unit(logs).filter_map(|logs| Some((logs[0].sample.unit?, Moments::from_logs(logs))));
    let units: Vec<(&str, Moments)> = units.collect();
    let within = Spread::within(&Vec::from_iter(units.iter().map(|(_, unit)| *unit)));
    let mut aside = vec![false; units.len()];
    let test = |aside: &[bool]| {
        let kept = || units.iter().zip(aside).filter(|(_, aside)| !**aside);
        let means = Moments::new(kept().map(|((_, unit), _)| unit.mean));
        let shares = Moments::new(kept().map(|((_, unit), _)| 1.0 / unit.n));
        let one = |((name, unit), aside): (&(&'a str, Moments), &bool)| {
            let (means, shares) = if *aside {
                (means, shares)
            } else {
                (means.without(unit.mean), shares.without(1.0 / unit.n))
            };
            let (test, ratio) = against_other_units(unit, &means, shares.mean, &within)?;
            Some((*name, test, ratio))
        };
        Vec::from_iter(units.iter().zip(aside).map(one))
    };
    let (mut order, mut hidden) = (Vec::new(), 0);
    for step in 0..(units.len() / 4).min(MOST_HIDDEN) {
        let tests = test(&aside).into_iter().enumerate();
        let kept = tests.filter(|(at, _)| !aside[*at]);
        let p = kept.filter_map(|(at, test)| Some((at, test?.1.probability())));
        let Some((at, p)) = p.min_by(|a, b| a.1.total_cmp(&b.1)) else {
            break;
        };
        order.push(at);
        aside[at] = true;
        if p * ((units.len() - step) as f64) < SIGNIFICANCE {
            hidden = order.len();
        }
    }
    order[hidden..].iter().for_each(|at| aside[*at] = false);
    test(&aside).into_iter().flatten().collect()
}

/// A unit's mean against those of others, `share` being the mean of one over their numbers of logs: the test, by how much
/// the others differ from each other, and the ratio, by how well both are known.
fn against_other_units(
    unit: &Moments,
    others: &Moments,
    share: f64,
    within: &Spread,
) -> Option<(Estimate, Estimate)> {
    if others.n < OTHER_UNITS {
        return None;
    }
    let (between, freedom) = (others.variance()?, others.n - 1.0);
    let of_logs = within.variance();
    // The mean of fewer logs than the others' scatters more.
    let more = of_logs * (1.0 / unit.n - share).max(0.0);
    let difference = unit.mean - others.mean;
    let estimate = |own: f64, of_own: f64, logs: f64| {
        let terms = [
            (between * (own + 1.0 / others.n), of_own),
            (logs, within.freedom),
        ];
        Estimate::new(difference, terms)
    };
    let test = estimate(1.0, freedom, more);
    // Where each unit has one log, these differ as units do.
    let known = within.freedom > 0.0;
    let ratio = if known {
        estimate(0.0, freedom, of_logs / unit.n)
    } else {
        test
    };
    Some((test, ratio))
}

/// The levels of a factor against the other stated ones: from differences within units where the factor varies there,
/// else, by Welch's test, from the means of units.
fn compared_levels<'a>(logs: &[Log<'a>], factor: usize) -> Vec<(&'a str, Estimate)> {
    let level = |log: &Log<'a>| *log.sample.levels.get(factor)?;
    let stated = logs.iter().filter_map(|log| Some((level(log)?, log)));
    let stated: Vec<(&str, &Log<'_>)> = stated.collect();
    let names: BTreeSet<&str> = stated.iter().map(|(name, _)| *name).collect();
    if !(2..=MOST_LEVELS).contains(&names.len()) {
        return Vec::new();
    }
    let compared = |name: &'a str| {
        let point = |(level, log): &(&str, &Log<'_>)| Point {
            unit: log.unit,
            x: f64::from(u8::from(*level == name)),
            y: log.value,
        };
        let points = Vec::from_iter(stated.iter().map(point));
        let of_units = |x: f64| {
            let own = Vec::from_iter(points.iter().copied().filter(|point| point.x == x));
            let units = own.chunk_by(|a, b| a.unit == b.unit);
            Moments::new(units.map(|unit| mean(unit).y))
        };
        let estimate = within_units(&points).or_else(|| welch(&of_units(1.0), &of_units(0.0)))?;
        Some((name, estimate))
    };
    names.into_iter().filter_map(compared).collect()
}

/// The slope with temperature: within units where temperatures vary there, else between their means.
fn slope_with_temperature(logs: &[Log<'_>]) -> Option<Estimate> {
    let point = |log: &Log<'_>| {
        let x = log.sample.temperature_c.filter(|t| t.is_finite())?;
        Some(Point {
            unit: log.unit,
            x,
            y: log.value,
        })
    };
    let points = Vec::from_iter(logs.iter().filter_map(point));
    let units = points.chunk_by(|a, b| a.unit == b.unit);
    let means = Vec::from_iter(units.map(mean));
    within_units(&points).or_else(|| Line::fit([&means[..]]).slope())
}

#[cfg(test)]
mod tests;
