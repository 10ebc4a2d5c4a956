//! Several records identified together: which differs, and the spread of the turn-on constants.

use super::spoken;
use crate::{
    Block, Cell, Table,
    numbers::{probability, short},
    parts::{Run, first_few, prefixed, text, warnings},
};
use std::f64::consts::PI;
use undrift_results::{Differing, Identify, Pool};

/// Records that a sentence lists.
const LISTED: usize = 3;

/// Unit of a constant, and its factor from SI.
fn constants(name: &str) -> (&'static str, f64) {
    match name.starts_with("gyro") {
        true => ("°/s", 180.0 / PI),
        false => ("mg", 1e3 / undrift_nav::earth::STANDARD_GRAVITY),
    }
}

/// "white noise 2.0 times, slow part 3.1 times".
fn how(found: &Differing) -> String {
    let factor = |what: &str, factor: Option<f64>| match factor {
        Some(factor) if factor < 0.0 => Some(format!("{what} only there")),
        factor => factor.map(|factor| format!("{what} {} times", short(factor))),
    };
    let parts = [
        factor("white noise", found.white.get()),
        factor("slow part", found.slow.get()),
        factor("outliers", found.outliers.get()),
    ];
    Vec::from_iter(parts.into_iter().flatten()).join(", ")
}

/// That the records are not of one sensor, and which differ how; `None` where they may be.
pub(crate) fn not_one(pool: &Pool) -> Option<String> {
    let mut records: Vec<(&str, Vec<String>)> = Vec::new();
    for (name, axis) in pool.in_order() {
        for found in &axis.differing {
            let against = match &found.other {
                Some(other) => format!(" of {other}"),
                None => String::new(),
            };
            let what = format!("{} {}{against}", spoken(name), how(found));
            match records
                .iter_mut()
                .find(|(record, _)| *record == found.record)
            {
                Some((_, list)) => list.push(what),
                None => records.push((&found.record, vec![what])),
            }
        }
    }
    let sentences = records
        .iter()
        .map(|(record, list)| format!("{record} ({})", list.join("; ")));
    let sentences: Vec<String> = sentences.collect();
    let against = match pool.records.len() {
        2 => "",
        _ => " from the others",
    };
    let verb = if records.len() == 1 {
        "differs"
    } else {
        "differ"
    };
    (!records.is_empty()).then(|| {
        format!(
            "Not one sensor: {} {verb}{against}.",
            first_few(&sentences, LISTED)
        )
    })
}

/// What is known of the constants that the table does not say.
pub(crate) fn of_constants(pool: &Pool) -> Vec<String> {
    let accels = pool.axes.keys().any(|name| name.starts_with("accel"));
    let of_accels = match pool.moved {
        Some(true) => Some(format!(
            "The accelerometers' turn-on σ is not determined: gravity shows that the sensor was laid down differently, by up to {}°.",
            short(pool.tilt.0 * 180.0 / PI)
        )),
        None if accels => Some(
            "The accelerometers' turn-on σ is not determined: without three of them, a bias cannot be distinguished from a tilt.".to_owned(),
        ),
        _ => None,
    };
    let of = |axis: &undrift_results::AxisPool| axis.turn_on.map(|turn_on| turn_on.records);
    let few = pool.axes.values().filter_map(of).min().filter(|n| *n < 4);
    let few = few.map(|n| {
        format!("{n} switch-ons bound the turn-on σ poorly: the model has the upper 95 % bound of all axes of a sensor together, or the data sheet's (--base) where that is larger.")
    });
    of_accels.into_iter().chain(few).collect()
}

/// The turn-on constants' spread, an axis a row.
pub(crate) fn turn_on(run: &str, pool: &Pool) -> Table {
    let known = pool
        .in_order()
        .filter_map(|(name, axis)| Some((name, axis.turn_on?)));
    Table::from_rows(
        &format!("turn-on{run}"),
        "Turn-on constants: standard deviation σ between switch-ons with its 95 % interval and degrees of freedom, the constant common to all, and the σ that the model has for a filter, which starts from zero.",
        known,
        &[
            ("axis", &|(name, _)| prefixed(run, &spoken(name)).into()),
            ("unit", &|(name, _)| constants(name).0.into()),
            ("σ", &|(name, t)| {
                short(t.sigma.0 * constants(name).1).into()
            }),
            ("from", &|(name, t)| {
                short(t.low.0 * constants(name).1).into()
            }),
            ("to", &|(name, t)| {
                short(t.high.0 * constants(name).1).into()
            }),
            ("freedom", &|(_, t)| t.degrees_of_freedom.into()),
            ("common", &|(name, t)| {
                short(t.common.0 * constants(name).1).into()
            }),
            ("model", &|(name, t)| {
                short(t.for_filter.0 * constants(name).1).into()
            }),
        ],
    )
}

/// Records by axes.
pub(crate) fn records(run: &str, pool: &Pool) -> Table {
    let shares = pool.in_order().flat_map(|(name, axis)| {
        let records = pool.records.iter().zip(&axis.records);
        records.map(move |(record, share)| (name, &record.record, share, axis))
    });
    let strong = |text: String, strong: bool| Cell {
        strong,
        ..text.into()
    };
    Table::from_rows(
        &format!("records{run}"),
        "Each recording against the others: white noise and slow part in multiples of theirs, the probability of such a difference by chance, and its constant.",
        shares,
        &[
            ("axis", &|(name, ..)| prefixed(run, &spoken(name)).into()),
            ("recording", &|(_, record, _, axis)| {
                let differs = axis.differing.iter().any(|found| found.record == **record);
                strong((*record).clone(), differs)
            }),
            ("white noise", &|(_, _, share, _)| {
                short(share.white.0).into()
            }),
            ("slow part", &|(_, _, share, _)| short(share.slow.0).into()),
            ("probability", &|(_, _, share, _)| {
                probability(share.p_value.0).into()
            }),
            ("constant", &|(name, _, share, _)| {
                let (unit, factor) = constants(name);
                format!("{} {unit}", short(share.constant.0 * factor)).into()
            }),
            ("outliers", &|(_, _, share, _)| share.outliers.into()),
        ],
    )
}

/// What the report has of it.
pub(super) fn blocks(name: &str, run: &Identify) -> Vec<Block> {
    let Some(pool) = &run.pool else {
        return Vec::new();
    };
    let names: Vec<String> = pool
        .records
        .iter()
        .map(|record| record.record.clone())
        .collect();
    let what = format!(
        "One model of {} recordings: {}. Tests, spectra and correlations are of the longest. The recordings are fitted together; the drift is scored on recordings left out of the fit. Two recordings of one process are taken for different ones with a probability of {} % in all.",
        names.len(),
        first_few(&names, 10),
        short(100.0 * pool.false_alarm.0)
    );
    let alarm = not_one(pool).map(|sentence| prefixed(name, &sentence));
    let blocks = [
        warnings(alarm.iter()),
        text([prefixed(name, &what)]),
        turn_on(name, pool).block(),
        text(of_constants(pool)),
        records(name, pool).block(),
    ];
    blocks.into_iter().flatten().collect()
}

/// For all runs.
pub(super) fn of_runs(runs: &[Run<'_, Identify>]) -> Vec<Block> {
    runs.iter()
        .flat_map(|(name, run)| blocks(name, run))
        .collect()
}
