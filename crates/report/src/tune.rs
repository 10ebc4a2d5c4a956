//! The report of a tuning: what the drives say of the noise, and what it buys.

mod verdict;

use super::{
    Block, Figure, Panel, PlotAxis, Section, Series, Table,
    numbers::{percent, short, span},
    parts::{Run, capital, prefixed, text},
    plain::{self, Mark},
    say::words::worded,
};
use undrift_results::{Tune, TunedDrift, TunedParameter};
pub use verdict::{is_usable, is_worse, usability, verdict};

/// Shares of a normal distribution inside one, two and three standard deviations.
const NORMAL: [f64; 3] = [0.6827, 0.9545, 0.9973];

/// The sections.
pub fn sections(runs: &[Run<'_, Tune>]) -> Vec<Section> {
    let each = |run: &Run<'_, Tune>| {
        let (name, tune) = (run.0.as_str(), run.1);
        let first = [
            Some(Block::Verdict(
                usability(tune),
                prefixed(name, &(capital(&verdict(tune)) + ".")),
            )),
            text([what_was_done(tune)]),
            drift(tune).block(),
            nees(tune).and_then(Table::block),
            calibration(tune),
        ];
        let second = [parameters(tune).block(), text([undetermined(tune)])];
        [
            Section::new(
                &prefixed(name, "Drift before and after"),
                first.into_iter().flatten(),
            ),
            Section::new(
                &prefixed(name, "Noise in the vehicle"),
                second.into_iter().flatten(),
            ),
        ]
    };
    runs.iter().flat_map(each).flatten().collect()
}

/// The same for a terminal.
pub fn plain(tune: &Tune, mark: Mark) -> String {
    let blocks = [
        text([verdict(tune)]),
        text([what_was_done(tune)]),
        drift(tune).captioned(""),
        nees(tune).and_then(|table| table.captioned("")),
        parameters(tune).captioned(""),
        text([undetermined(tune)]),
    ];
    let posed = tune.drives.iter().any(|drive| drive.posed);
    worded(plain::plain(blocks, mark), posed)
}

fn what_was_done(tune: &Tune) -> String {
    let guess = if tune.guessed {
        ", with the noise at rest guessed from the quietest seconds of the first drive"
    } else {
        ""
    };
    let drives = match tune.drives.len() {
        1 => "1 drive".to_owned(),
        n => format!("{n} drives"),
    };
    let unseen = match (tune.held_out, tune.unseen.0) {
        (_, 0.0) => "nothing was held out".to_owned(),
        (true, share) => format!("the last {} of each held out", percent(share.into())),
        (false, share) => format!(
            "the drift is that of a fit without the last {} of each",
            percent(share.into())
        ),
    };
    let ended = if tune.converged {
        "converged"
    } else {
        "stopped before it converged"
    };
    let rejected = match tune.rejected {
        0 => String::new(),
        n => format!(
            " {n} of the {} positions there are rejected before and after, so they are no reference.",
            tune.withheld
        ),
    };
    format!(
        "Start: {}{guess}. {drives}, {} windows without fixes, {} evaluations, {ended}; {unseen}.{rejected}{}{}",
        tune.start,
        tune.windows,
        tune.evaluations,
        axes(tune),
        vibration(tune)
    )
}

/// Whether errors of the sensors' axes are estimated beside the noise.
fn axes(tune: &Tune) -> String {
    let Some(tried) = &tune.axes else {
        return String::new();
    };
    let with = match tried.scale_factor {
        Some(_) => " and scale factors",
        None => "",
    };
    match tried.kept {
        true => format!(
            " Misaligned axes{with} are estimated beside the noise ([states]): without them these errors are taken for noise."
        ),
        false => format!(
            " Misaligned axes{with} were tried beside the noise and rejected: the poses are no likelier with them."
        ),
    }
}

/// Whether the noise follows the vibration.
fn vibration(tune: &Tune) -> String {
    let Some(tried) = &tune.vibration else {
        return String::new();
    };
    format!(
        " White noise that follows the vibration was {}: the held-out fixes are {} likely with it; {} times the drift of constant white noise at {} (95 % interval {} to {}).",
        if tried.kept { "kept" } else { "rejected" },
        if tried.kept { "more" } else { "less" },
        short(tried.ratio.0),
        span(tried.length_s.0),
        short(tried.ratio_low.0),
        short(tried.ratio_high.0)
    )
}

fn drift(tune: &Tune) -> Table {
    let within = |drift: &[undrift_results::Number; 3]| {
        drift.map(percent).join(" / ").replace(" %", "") + " %"
    };
    Table::from_rows(
        "drift",
        "RMS of the largest horizontal error of an outage, with the noise of the model and drive files and with the noise found; their ratio with its 95 % interval; and the share of final position errors within 1, 2 and 3σ (68, 95 and 99.7 % expected).",
        &tune.drift,
        &[
            ("outage", &|d: &&TunedDrift| span(d.length_s.0).into()),
            ("number", &|d| d.outages.into()),
            ("before [m]", &|d| short(d.before_m.0).into()),
            ("after [m]", &|d| short(d.after_m.0).into()),
            ("ratio", &|d| {
                let (low, high) = (short(d.ratio_low.0), short(d.ratio_high.0));
                format!("{} ({low} to {high})", short(d.ratio.0)).into()
            }),
            ("inside before", &|d| within(&d.before_within).into()),
            ("inside after", &|d| within(&d.after_within).into()),
        ],
    )
}

/// How far the errors at the ends of outages of poses are off, against what the solution states; `None` of other drives.
fn nees(tune: &Tune) -> Option<Table> {
    let rows = tune
        .drift
        .iter()
        .flat_map(|drift| drift.nees.iter().map(move |nees| (drift, nees)));
    let rows = Vec::from_iter(rows);
    let shown = |[mean, low, high]: &[undrift_results::Number; 3]| {
        format!("{} ({} to {})", short(mean.0), short(low.0), short(high.0))
    };
    (!rows.is_empty()).then(|| {
        Table::from_rows(
            "nees",
            "NEES at the ends of the outages per degree of freedom, the pose's own error counted, with its 95 % interval: 1 where standard deviations are right, above where they are too small.",
            &rows,
            &[
                ("NEES", &|(drift, _)| span(drift.length_s.0).into()),
                ("of", &|(_, nees)| (&nees.of).into()),
                ("before", &|(_, nees)| shown(&nees.before).into()),
                ("after", &|(_, nees)| shown(&nees.after).into()),
            ],
        )
    })
}

/// A value in the unit that data sheets use.
fn shown(parameter: &TunedParameter) -> (f64, &str) {
    const G: f64 = undrift_nav::earth::STANDARD_GRAVITY;
    match parameter.unit.as_str() {
        "rad/s/√Hz" => (1f64.to_degrees() * 1e3, "mdps/√Hz"),
        "m/s²/√Hz" => (1e6 / G, "µg/√Hz"),
        "rad/s/√s" => (1f64.to_degrees() * 1e3, "mdps/√s"),
        "m/s²/√s" => (1e6 / G, "µg/√s"),
        unit => (1.0, unit),
    }
}

fn parameters(tune: &Tune) -> Table {
    let value = |p: &TunedParameter, value: f64| short(value * shown(p).0);
    Table::from_rows(
        "parameters",
        "Noise at rest or as specified, the 95 % interval expected in a vehicle, and the estimate from the drives, how many times that at rest it is, and its 95 % interval.",
        &tune.parameters,
        &[
            ("parameter", &|p: &&TunedParameter| (&p.name).into()),
            ("unit", &|p| shown(p).1.into()),
            ("at rest", &|p| value(p, p.start.0).into()),
            ("expected", &|p| {
                format!(
                    "{} to {}",
                    value(p, p.prior_low.0),
                    value(p, p.prior_high.0)
                )
                .into()
            }),
            ("found", &|p| value(p, p.value.0).into()),
            ("times rest", &|p| short(p.value.0 / p.start.0).into()),
            ("interval", &|p| {
                format!("{} to {}", value(p, p.low.0), value(p, p.high.0)).into()
            }),
        ],
    )
}

/// Share of the way to the end of the prior's interval from which on a value is far from what was expected.
const FAR: f64 = 0.5;

/// What the drives do not determine: near what was expected before, or by chance away from it.
fn undetermined(tune: &Tune) -> String {
    let is_far = |p: &&TunedParameter| {
        let off = (p.value.0 / p.prior.0).ln();
        let bound = if off > 0.0 { p.prior_high } else { p.prior_low };
        off.abs() > FAR * (bound.0 / p.prior.0).ln().abs()
    };
    let open = tune.parameters.iter().filter(|p| !p.determined);
    let (far, near): (Vec<&TunedParameter>, Vec<_>) = open.partition(is_far);
    let mut said = Vec::new();
    if !near.is_empty() {
        let names: Vec<&str> = near.iter().map(|p| p.name.as_str()).collect();
        said.push(format!(
            "Not determined by these drives, so close to what was expected: {}.",
            names.join(", ")
        ));
    }
    if !far.is_empty() {
        let value = |p: &TunedParameter, value: f64| short(value * shown(p).0);
        let named = far.iter().map(|p| {
            format!(
                "{} ({}, expected {} to {})",
                p.name,
                value(p, p.value.0),
                value(p, p.prior_low.0),
                value(p, p.prior_high.0)
            )
        });
        said.push(format!(
            "Not determined, and towards an end of what was expected, or beyond it: {}.",
            Vec::from_iter(named).join(", ")
        ));
    }
    said.join(" ")
}

/// Shares inside so many standard deviations against those of a normal distribution.
fn calibration(tune: &Tune) -> Option<Block> {
    let points = |shares: [f64; 3]| NORMAL.into_iter().zip(shares).collect::<Vec<_>>();
    let panel = |drift: &TunedDrift| {
        let mut panel = Panel::new(
            &span(drift.length_s.0),
            PlotAxis::new("share of a normal distribution"),
            PlotAxis::new("share of the errors").within(0.0..1.05),
        );
        panel.series = vec![
            Series::dashed("a correct σ", 0, points(NORMAL)),
            Series::line("before", 1, points(drift.before_within.map(|n| n.0))),
            Series::thick("after", 2, points(drift.after_within.map(|n| n.0))),
        ];
        panel
    };
    Figure::block(
        "calibration",
        "Share of final position errors of outages within 1, 2 and 3σ against that of a normal distribution; below the dashed line σ is too small.",
        3,
        tune.drift.iter().map(panel),
    )
}

#[cfg(test)]
mod tests;
