//! The outage table in the form of the source paper's Table 4, as text.

use crate::{outages::ModelErrors, reference::Errors};
use std::fmt::Write as _;

const HEADINGS: [&str; 9] = [
    "N m", "E m", "D m", "vN m/s", "vE m/s", "vD m/s", "roll °", "pitch °", "yaw °",
];
/// Places of [`HEADINGS`] among the components of [`Errors`].
const PLACES: [usize; 9] = [0, 1, 2, 4, 5, 6, 7, 8, 9];

/// One line per model for each of: maximum, RMS and median over the outages of the largest error.
pub fn outage_table(models: &[(String, &ModelErrors)]) -> String {
    let width = models
        .iter()
        .map(|(n, _)| n.chars().count())
        .max()
        .unwrap_or(0)
        .max(12);
    let mut text = String::new();
    type Pick = fn(&ModelErrors) -> &Errors;
    let blocks: [(&str, Pick); 3] = [
        ("maximum", |m| &m.max),
        ("RMS", |m| &m.rms),
        ("median", |m| &m.median),
    ];
    for (title, pick) in blocks {
        let _ = write!(text, "{title:width$}");
        for heading in HEADINGS {
            let _ = write!(text, " {heading:>8}");
        }
        text.push('\n');
        for (name, errors) in models {
            let _ = write!(text, "{name:width$}");
            for place in PLACES {
                let _ = write!(text, " {:>8}", cell(pick(errors).0[place]));
            }
            text.push('\n');
        }
        text.push('\n');
    }
    text.pop();
    text
}

/// Three significant digits, or a dash for what is not known.
fn cell(value: f64) -> String {
    match value.abs() {
        v if !v.is_finite() => "–".into(),
        v if v < 0.001 => format!("{value:.1e}"),
        v if v < 0.995 => format!("{value:.3}"),
        v if v < 9.95 => format!("{value:.2}"),
        v if v < 99.5 => format!("{value:.1}"),
        v if v < 1e6 => format!("{value:.0}"),
        _ => format!("{value:.1e}"),
    }
}
