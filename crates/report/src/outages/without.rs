//! What each constraint and sensor beside GNSS saves: the last model with and without it.

use super::{HORIZONTAL, wins};
use crate::{
    Cell, Table,
    numbers::{get, short},
    parts::{capital, prefixed},
};
use undrift_events::Aid;
use undrift_results::{ModelErrors, Outages, is_clear_lead};

const CAPTION: &str = "Each constraint and sensor beside GNSS removed: RMS over the outages of the largest error of each; \"ratio\" is the horizontal drift with it over that without it, \"less with it\" counts outages.";

/// The last model with all that the drive has, and without one kind of measurement at a time.
struct Compared<'a> {
    model: &'a str,
    with: &'a ModelErrors,
    without: Vec<(Aid, &'a ModelErrors)>,
}

/// What there is to compare, if it was run.
fn compared(run: &Outages) -> Option<Compared<'_>> {
    let model = run.order.last()?;
    let of_aid = |aid: Aid| Some((aid, run.without.get(&aid.key())?));
    let without = Vec::from_iter(Aid::ALL.into_iter().filter_map(of_aid));
    (!without.is_empty()).then_some(Compared {
        model,
        with: run.models.get(model)?,
        without,
    })
}

fn ratio(with: &ModelErrors, without: &ModelErrors) -> f64 {
    get(&with.rms, HORIZONTAL) / get(&without.rms, HORIZONTAL)
}

/// The table of a run.
pub(super) fn table(name: &str, run: &Outages) -> Option<Table> {
    let Compared {
        model,
        with,
        without,
    } = compared(run)?;
    let named = |aid: &Aid| prefixed(name, &format!("without {}", aid.name())).into();
    let names = std::iter::once(prefixed(name, model).into());
    let rows = Vec::from_iter(names.chain(without.iter().map(|(aid, _)| named(aid))));
    let own: &dyn Fn(&&Cell) -> Cell = &|name| (*name).clone();
    let mut table = Table::from_rows("without", CAPTION, &rows, &[("model", own)]);
    let errors = || std::iter::once(with).chain(without.iter().map(|(_, errors)| *errors));
    for (key, head) in [
        (HORIZONTAL, "horizontal [m]"),
        ("down_m", "D [m]"),
        ("yaw_deg", "yaw [°]"),
    ] {
        let values = Vec::from_iter(errors().map(|of| get(&of.rms, key)));
        if values.iter().any(|value| value.is_finite()) {
            table.add(head.into(), values.iter().map(|v| short(*v).into()));
        }
    }
    let gap = || std::iter::once(Cell::number(f64::NAN, 0));
    let ratios = without
        .iter()
        .map(|(_, of)| Cell::number(ratio(with, of), 2));
    table.add("ratio".into(), gap().chain(ratios));
    let counts = without.iter().map(|(_, of)| {
        let (wins, of) = wins(with, of);
        format!("{wins} of {of}").into()
    });
    table.add("less with it".into(), gap().chain(counts));
    Some(table)
}

/// A sentence for each that makes a difference beyond chance.
pub(super) fn sentences(name: &str, run: &Outages) -> Vec<String> {
    let Some(Compared { with, without, .. }) = compared(run) else {
        return Vec::new();
    };
    let sentence = |(aid, errors): &(Aid, &ModelErrors)| {
        let (wins, of) = wins(with, errors);
        let clear = is_clear_lead(wins, of) || is_clear_lead(of - wins, of);
        clear.then(|| {
            format!(
                "{}: {} times the horizontal drift without it, less in {wins} of {of} outages.",
                capital(&prefixed(name, aid.name())),
                short(ratio(with, errors)),
            )
        })
    };
    without.iter().filter_map(sentence).collect()
}
