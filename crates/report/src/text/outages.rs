//! The outage table in the form of the source paper's Table 4, as text.

use crate::parts::{get, short};
use std::{collections::BTreeMap, fmt::Write as _};
use undrift::results::{ModelErrors, Numbers};

/// Components of the errors with their headings.
const COLUMNS: [(&str, &str); 9] = [
    ("north_m", "N m"),
    ("east_m", "E m"),
    ("down_m", "D m"),
    ("vn_mps", "vN m/s"),
    ("ve_mps", "vE m/s"),
    ("vd_mps", "vD m/s"),
    ("roll_deg", "roll °"),
    ("pitch_deg", "pitch °"),
    ("yaw_deg", "yaw °"),
];

/// One line per model of these names for each of: maximum, RMS and median over the outages of the largest error.
pub fn outage_table(models: &BTreeMap<String, ModelErrors>, names: &[impl AsRef<str>]) -> String {
    let models = || {
        let names = names.iter().map(AsRef::as_ref);
        names.filter_map(|name| Some((name, models.get(name)?)))
    };
    let longest = models().map(|(name, _)| name.chars().count()).max();
    let width = longest.unwrap_or(0).max(12);
    let mut text = String::new();
    type Pick = fn(&ModelErrors) -> &Numbers;
    let blocks: [(&str, Pick); 3] = [
        ("maximum", |m| &m.max),
        ("RMS", |m| &m.rms),
        ("median", |m| &m.median),
    ];
    for (title, pick) in blocks {
        let _ = write!(text, "{title:width$}");
        for (_, heading) in COLUMNS {
            let _ = write!(text, " {heading:>8}");
        }
        text.push('\n');
        for (name, errors) in models() {
            let _ = write!(text, "{name:width$}");
            for (component, _) in COLUMNS {
                let _ = write!(text, " {:>8}", short(get(pick(errors), component)));
            }
            text.push('\n');
        }
        text.push('\n');
    }
    text.pop();
    text
}
