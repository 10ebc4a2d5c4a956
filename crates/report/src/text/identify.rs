//! An identified record as text, and the source paper's Tables 2 and 3.

mod terms;

use crate::{
    Block,
    identify::{
        adequacy_line, bounds, drift_table, identified, lines, of_others, pool, temperatures,
        units, verdict,
    },
    parts::text,
    plain::{self, Mark, plain_table},
};
use std::fmt::Write as _;
use undrift_results::{Axis, Detrend, Identify};

/// Whether the record serves and the terms of each axis' model; `details` puts the tests and candidates of each
/// axis before.
pub fn identify(result: &Identify, details: bool, mark: Mark) -> String {
    let alarm = result.pool.as_ref().and_then(pool::not_one);
    let verdict = alarm.into_iter().chain([verdict(result)]);
    let temperatures = temperatures(identified("", result));
    let lines = lines(identified("", result));
    let blocks = [
        text([wrapped(verdict)]),
        text(details.then(|| every_axis(result, mark))),
        text(terms::table(result, mark)),
        temperatures.captioned("Bias over temperature, 95 % intervals:"),
        lines.captioned("Lines and narrow resonances, not in the terms above:"),
    ];
    plain::plain(blocks.into_iter().chain(several(result, details)), mark)
}

/// What several records show beyond their model; `details` puts the records of each axis first.
fn several(result: &Identify, details: bool) -> [Option<Block>; 3] {
    let Some(pool) = &result.pool else {
        return Default::default();
    };
    let records = pool::records("", pool);
    let count = pool.records.len();
    [
        records
            .captioned("Each recording against the others:")
            .filter(|_| details),
        pool::turn_on("", pool).captioned(&format!("Turn-on constants of {count} switch-ons:")),
        text([wrapped(pool::of_constants(pool))]),
    ]
}

/// Characters of a line.
const WIDTH: usize = 80;

/// Texts below one another, each in lines, the later ones indented.
fn wrapped(texts: impl IntoIterator<Item = String>) -> String {
    let wrap = |text: String| {
        let (mut out, mut length) = (String::new(), 0);
        for word in text.split(' ') {
            let more = word.chars().count() + 1;
            if length > 0 && length + more > WIDTH {
                out.truncate(out.trim_end().len());
                out += "\n  ";
                length = 2;
            }
            out += word;
            out.push(' ');
            length += more;
        }
        out.trim_end().to_owned()
    };
    Vec::from_iter(texts.into_iter().map(wrap)).join("\n")
}

/// What was found of each axis, with its candidates by their drift.
fn every_axis(result: &Identify, mark: Mark) -> String {
    let known = result.in_order().filter(|(_, axis)| axis.error.is_none());
    let texts = known.map(|(name, axis)| {
        let head = format!("{} samples at {} Hz", axis.samples, result.rate_hz.0);
        format!("{}: {head}\n{}", mark(name), of_axis(name, axis, mark))
    });
    Vec::from_iter(texts).join("\n")
}

fn of_axis(name: &str, axis: &Axis, mark: Mark) -> String {
    let unit = units(name);
    let removed = match axis.detrend {
        Detrend::Constant => None,
        Detrend::Linear {
            slope_per_hour,
            explained,
        } => Some((slope_per_hour, explained)),
    };
    let mut lines = Vec::new();
    lines.extend(removed.map(|(slope, explained)| {
        let (slope, explained) = (slope * unit.scale, 100.0 * explained);
        let sample = unit.sample;
        format!(
            "Removed: a slope of {slope:.3e} {sample} an hour, {explained:.2} % of the variance"
        )
    }));
    lines.push(axis.stationarity.clone());
    lines.push(format!(
        "Allan: white noise {:.4} {}; skewness {:.3}, excess kurtosis {:.3}",
        axis.allan_terms.white.value * unit.white.1,
        unit.white.0,
        axis.skewness.0,
        axis.kurtosis_excess.0
    ));
    lines.extend(adequacy_line(axis));
    lines.extend(axis.box_jenkins.as_ref().map(|grid| {
        format!(
            "Box-Jenkins, p, q ≤ {}, first {} samples: ARMA{} by AICc, {} by BIC",
            grid.p_max, grid.samples, grid.by_aicc, grid.by_bic
        )
    }));
    let candidates = plain_table(&drift_table(name, axis), mark);
    lines.extend(candidates.lines().map(str::to_owned));
    lines.extend(of_others(axis));
    lines.extend(axis.chosen.reason.clone());
    let bounds = bounds(name, axis);
    lines.extend(bounds.iter().map(|bound| {
        let (parameter, unit) = (&bound.parameter, bound.unit);
        format!(
            "{parameter}: {} {unit} with a probability of 95 %",
            bound.interval()
        )
    }));
    lines.extend(
        axis.warnings
            .iter()
            .map(|warning| format!("Note: {warning}.")),
    );
    lines.iter().map(|line| format!("  {line}\n")).collect()
}

/// Figure 3: autocorrelation and partial autocorrelation of an axis.
pub fn correlation_csv(identified: &Identify, name: &str) -> String {
    let mut text = String::from("lag,acf,pacf,bound\n");
    if let Some(axis) = identified.axes.get(name) {
        let bound = axis.series.correlation_bound.0;
        for (lag, (acf, pacf)) in axis.acf.iter().zip(&axis.pacf).enumerate() {
            let _ = writeln!(text, "{lag},{:.6},{:.6},{bound:.6}", acf.0, pacf.0);
        }
    }
    text
}
