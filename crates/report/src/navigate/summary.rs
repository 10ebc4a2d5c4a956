//! What was done and how it went, in words and counts.

use crate::{
    Cell, Section, Table, date,
    numbers::{bounded, count, error, get, short, span},
    parameters::{Wording, wording},
    parts::{Run, named, of_which, prefixed, text, verdict_of, warnings},
};
use undrift_results::{Aid, Navigate, Nis, Number, Numbers, Parameter};

/// NIS per degree of freedom that is reported as correct.
const PLAUSIBLE: std::ops::RangeInclusive<f64> = 0.6..=1.6;

/// Whether the solution is of use, how good it is, and what is to be known of it.
pub(super) fn verdict(runs: &[Run<'_, Navigate>]) -> Option<Section> {
    let verdicts = runs
        .iter()
        .map(|(name, run)| Some(verdict_of(name, &run.findings)));
    let conclusions = runs
        .iter()
        .map(|(name, run)| text([prefixed(name, &conclusion(run))]));
    let warned = runs.iter().flat_map(|(name, run)| {
        let warnings = run.warnings.iter();
        warnings.map(|warning| of_which(name, warning))
    });
    let warned: Vec<String> = warned.collect();
    let blocks = verdicts.chain(conclusions).chain([warnings(&warned)]);
    Section::new("Result", blocks.flatten())
}

/// How large the errors are, or else the innovations.
fn conclusion(run: &Navigate) -> String {
    let horizontal = |errors: &Numbers| get(errors, "horizontal_m");
    match run.rms_error.as_ref().map(horizontal) {
        Some(error) if error.is_finite() => {
            format!(
                "RMS horizontal error against the truth: {} m.",
                short(error)
            )
        }
        _ => [("position", &run.position), ("velocity", &run.velocity)]
            .map(|(part, nis)| innovations(part, nis))
            .into_iter()
            .filter(|sentence| !sentence.is_empty())
            .collect::<Vec<_>>()
            .join(" "),
    }
}

/// What was done and how it went, in words and counts.
pub(super) fn summary(runs: &[Run<'_, Navigate>]) -> Option<Section> {
    let done = runs
        .iter()
        .map(|(name, run)| text(what_was_done(name, run)));
    let blocks = done.chain([updates(runs).block(), parameters(runs).block()]);
    let fixes: u64 = runs.iter().map(|(_, run)| run.summary.fixes).sum();
    let section = Section::new("What was done", blocks.flatten())?;
    Some(section.noted(format!("{} fixes used", count(fixes))))
}

fn what_was_done(name: &str, run: &Navigate) -> Vec<String> {
    let (drive, s) = (&run.drive, &run.summary);
    let mut done = Vec::new();
    if let (Some(imu), Some(gnss)) = (&drive.imu, &drive.gnss) {
        let model = match drive.model.as_deref() {
            None | Some("") => "a noise model".into(),
            Some(model) => format!("the noise model \"{model}\""),
        };
        let smoothed = match (run.smooth, run.look_ahead) {
            (true, _) => ", and smoothed: every estimate also uses the later fixes",
            (false, true) => "; the errors of all fixes were studied first",
            (false, false) => "; every estimate uses only what came before it, as while driving",
        };
        let what = format!(
            "{imu} at {} Hz was navigated with the {} of {gnss}, using {model} as {}{smoothed}.",
            short(drive.rate_hz.0),
            drive.gnss_use.as_deref().unwrap_or("fixes"),
            run.bias_model,
        );
        done.push(prefixed(name, &what));
    }
    let (from, to) = (s.started.0, s.ended.0);
    if from.is_finite() && to.is_finite() {
        done.push(format!(
            "The solution has {} samples from {from:.3} s to {to:.3} s ({}) and used {} fixes.",
            count(s.samples),
            span(to - from),
            count(s.fixes)
        ));
    }
    if let Some(start) = date::of_drive(drive, from) {
        done.push(format!("Date at the start: {start}."));
    }
    if !s.alignment.is_empty() {
        done.push(format!("Start: {}.", s.alignment));
    }
    let mounting = run.mounting.as_ref();
    done.extend(mounting.map(|m| format!("Estimated mounting: {m}.")));
    let parts = [("position", &run.position), ("velocity", &run.velocity)];
    done.extend(parts.map(|(part, nis)| innovations(part, nis)));
    done
}

/// What the innovations of a part of the fixes say.
fn innovations(part: &str, nis: &Nis) -> String {
    let value = nis.nis_per_dof.0;
    let (correlation, bound) = (nis.autocorrelation.0, nis.autocorrelation_bound.0);
    let size = if !value.is_finite() {
        return String::new();
    } else if PLAUSIBLE.contains(&value) {
        "as large as predicted".into()
    } else if value > 1.0 {
        format!(
            "{} times as large as predicted: the filter or the stated accuracy is optimistic",
            short(value.sqrt())
        )
    } else {
        format!(
            "{} times smaller than predicted: the stated accuracy is pessimistic",
            short(value.sqrt().recip())
        )
    };
    let colour = match correlation {
        c if !c.is_finite() => "",
        c if c.abs() <= bound => ", and white",
        c if c.abs() > 0.5 => {
            "; they are strongly correlated from fix to fix, so errors of the fixes or the model last longer than the filter assumes"
        }
        c if c.abs() > 0.2 => "; they are correlated from fix to fix",
        _ => "; they are slightly correlated from fix to fix",
    };
    format!("The innovations of the {part} are {size}{colour}.")
}

fn updates(runs: &[Run<'_, Navigate>]) -> Table {
    let rows = runs.iter().flat_map(|(name, run)| {
        let kinds = run.summary.innovations.iter();
        let kinds = kinds.filter(|(_, counts)| counts.updates + counts.rejected > 0);
        kinds.map(|(kind, counts)| {
            let nis = match kind {
                Aid::Position => run.position,
                Aid::Velocity => run.velocity,
                _ => Nis::default(),
            };
            (prefixed(name, kind.name()), counts, nis)
        })
    });
    Table::from_rows(
        "updates",
        "Measurements used. NIS / dof: normalised innovation squared per degree of freedom, 1 if the model is correct. Autocorrelation: that of successive innovations, with its 95 % bound for white ones. Rejected: far from the prediction. Down-weighted: doubtful, used with less weight.",
        rows,
        &[
            ("measurement", &|(name, ..)| name.into()),
            ("updates", &|(_, counts, _)| counts.updates.into()),
            ("NIS / dof", &|(_, counts, _)| {
                Number::from(counts.per_dof()).into()
            }),
            ("autocorrelation", &|(.., nis)| {
                bounded(nis.autocorrelation, nis.autocorrelation_bound).into()
            }),
            ("rejected", &|(_, counts, _)| counts.rejected.into()),
            ("down-weighted", &|(_, counts, _)| counts.weakened.into()),
        ],
    )
}

/// Constants that were estimated.
fn parameters(runs: &[Run<'_, Navigate>]) -> Table {
    let parameters = runs.iter().flat_map(|(name, run)| {
        let parameters = run.summary.parameters.iter();
        parameters.map(move |(kind, parameter)| (name, wording(kind), parameter))
    });
    let list = |numbers: &[Number], factor: f64, text: fn(f64) -> String| -> Cell {
        let texts: Vec<String> = numbers.iter().map(|n| text(factor * n.0)).collect();
        texts.join(", ").into()
    };
    type Row<'a> = (&'a String, Wording<'a>, &'a Parameter);
    Table::from_rows(
        "parameters",
        "Constants estimated in addition to the sensor errors, with their final standard deviations.",
        parameters,
        &[
            ("constant", &|(name, wording, _): &Row<'_>| {
                named(name, &wording.named()).into()
            }),
            ("unit", &|(_, wording, _)| wording.unit.into()),
            ("estimate", &|(_, wording, of)| {
                list(&of.value, wording.factor, short)
            }),
            ("standard deviation", &|(_, wording, of)| {
                list(&of.std, wording.factor, error)
            }),
        ],
    )
}
