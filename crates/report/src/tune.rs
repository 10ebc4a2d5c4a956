//! The report of a tuning: what the drives say of the noise, and what it buys.

use super::{
    Block, Figure, Panel, PlotAxis, Section, Series, Table,
    numbers::{percent, short, span},
    parts::{Run, capital, prefixed, text},
    plain::{Mark, plain_table},
    say::usable,
};
use undrift::{
    findings::Severity,
    results::{Tune, TunedDrift, TunedParameter},
};

/// Shares of a normal distribution inside one, two and three standard deviations.
const NORMAL: [f64; 3] = [0.6827, 0.9545, 0.9973];

/// The sections.
pub fn sections(runs: &[Run<'_, Tune>]) -> Vec<Section> {
    let each = |run: &Run<'_, Tune>| {
        let (name, tune) = (run.0.as_str(), run.1);
        let first = [
            Some(Block::Verdict(prefixed(
                name,
                &(capital(&verdict(tune)) + "."),
            ))),
            text([what_was_done(tune)]),
            drift(tune).block(),
            calibration(tune),
        ];
        let second = [parameters(tune).block(), text([undetermined(tune)])];
        [
            Section::of(
                &prefixed(name, "Drift before and after"),
                first.into_iter().flatten(),
            ),
            Section::of(
                &prefixed(name, "Noise in the vehicle"),
                second.into_iter().flatten(),
            ),
        ]
    };
    runs.iter().flat_map(each).flatten().collect()
}

/// The same for a terminal.
pub fn plain(tune: &Tune, mark: Mark) -> String {
    let tables = [drift(tune), parameters(tune)].map(|table| plain_table(&table, mark));
    let undetermined = undetermined(tune);
    format!(
        "{}\n\n{}\n\n{}\n{}{}{}",
        verdict(tune),
        what_was_done(tune),
        tables[0],
        tables[1],
        if undetermined.is_empty() { "" } else { "\n" },
        undetermined
    )
    .trim_end()
    .to_owned()
}

/// Whether it is of use, in a sentence.
fn verdict(tune: &Tune) -> String {
    let (severity, why) = judgement(tune);
    format!("{}: {why}", usable(severity))
}

/// Whether the verdict is `usable`.
pub fn is_usable(tune: &Tune) -> bool {
    judgement(tune).0 == Severity::Note
}

fn judgement(tune: &Tune) -> (Severity, String) {
    use Severity::{Note, Unusable, Warning};
    if let [first, ..] = tune.unaligned.as_slice() {
        let why = format!(
            "{first} cannot be aligned with the noise found. Set `attitude` under [initial], or tune on a \
             longer drive with more turns and changes of speed"
        );
        return (Unusable, why);
    }
    if tune.stopped {
        let why = "stopped early and not tested; the noise is the best so far";
        return (Warning, why.into());
    }
    let judged = |length: f64| tune.drift.iter().find(|d| d.length_s.0 == length);
    let Some(drift) = judged(30.0).or_else(|| tune.drift.last()) else {
        let why = "not tested, because the drives are too short to hold out outages; tune on longer drives";
        return (Warning, why.into());
    };
    let (low, high) = (drift.ratio_low.0, drift.ratio_high.0);
    let is_honest = drift.after_within[1].0 >= 0.9;
    let (severity, found) = match () {
        () if low > 1.0 => (Unusable, "more drift than before"),
        () if !tune.converged => (Warning, "the fit has not converged"),
        () if high < 1.0 && is_honest => (Note, "less drift"),
        () if high < 1.0 => (Warning, "less drift, but the solution is optimistic"),
        () if is_honest => (Note, "no significant change of drift"),
        () => (
            Warning,
            "no significant change of drift, and the solution is optimistic",
        ),
    };
    let why = format!(
        "{found}. {} without GNSS: {} m; before: {} m (ratio {}, 95 % interval {} to {}), over {} held-out outages",
        span(drift.length_s.0),
        short(drift.after_m.0),
        short(drift.before_m.0),
        short(drift.ratio.0),
        short(low),
        short(high),
        drift.outages
    );
    (severity, why)
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
    format!(
        "Start: {}{guess}. {drives}, {} windows without fixes, {} evaluations, {ended}; {unseen}.{}",
        tune.start,
        tune.windows,
        tune.evaluations,
        vibration(tune)
    )
}

/// Whether the noise follows the vibration.
fn vibration(tune: &Tune) -> String {
    let Some(tried) = &tune.vibration else {
        return String::new();
    };
    format!(
        " White noise that follows the vibration was tried and {}: {} times the drift of constant white noise at {} (95 % interval {} to {}).",
        if tried.kept { "kept" } else { "rejected" },
        short(tried.ratio.0),
        span(tried.length_s.0),
        short(tried.ratio_low.0),
        short(tried.ratio_high.0)
    )
}

fn drift(tune: &Tune) -> Table {
    let within = |drift: &[undrift::results::Number; 3]| {
        drift.map(percent).join(" / ").replace(" %", "") + " %"
    };
    Table::of(
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

/// A value in the unit that data sheets use.
fn shown(parameter: &TunedParameter) -> (f64, &str) {
    const G: f64 = undrift::nav::earth::STANDARD_GRAVITY;
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
    Table::of(
        "parameters",
        "Noise at rest or as specified, the 95 % interval expected in a vehicle, and the estimate from the drives with its 95 % interval.",
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
            ("interval", &|p| {
                format!("{} to {}", value(p, p.low.0), value(p, p.high.0)).into()
            }),
        ],
    )
}

/// What the drives do not tell.
fn undetermined(tune: &Tune) -> String {
    let names: Vec<&str> = tune
        .parameters
        .iter()
        .filter(|p| !p.determined)
        .map(|p| p.name.as_str())
        .collect();
    match names.as_slice() {
        [] => String::new(),
        names => format!(
            "Not determined by these drives, so close to their priors: {}.",
            names.join(", ")
        ),
    }
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
    Figure::of(
        "calibration",
        "Share of final position errors of outages within 1, 2 and 3σ against that of a normal distribution; below the dashed line σ is too small.",
        3,
        tune.drift.iter().map(panel),
    )
}

#[cfg(test)]
mod tests;
