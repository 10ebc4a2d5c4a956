//! Sentences: what GNSS outages show.

use super::{NO_MODEL, words::at};
use undrift_results::findings::{LeftOut, WhyLeftOut};

pub(super) const NO_OUTAGE: &str = "no outage is left to measure in";

pub(super) fn rejected_reference(fixes: u64, of: u64) -> String {
    format!(
        "{fixes} of {of} withheld positions are rejected by the run without outages, so they are no reference"
    )
}

pub(super) fn left_out(left: &LeftOut) -> String {
    let LeftOut {
        why,
        outages,
        of,
        first,
    } = *left;
    let (is, begins) = match outages {
        1 => ("was", "begins"),
        _ => ("were", "begin"),
    };
    let why = match why {
        WhyLeftOut::NotStarted => {
            format!("{begins} before the solution does; start the outages later")
        }
        WhyLeftOut::InGap => format!("{begins} in a gap of the fixes"),
        WhyLeftOut::NoReference => "no reference at the end".into(),
        WhyLeftOut::NoSamples => "inertial samples are missing".into(),
    };
    let first = match outages {
        1 => format!("at {} s", at(first)),
        _ => format!("the first at {} s", at(first)),
    };
    let none = if left.is_all() {
        format!("{NO_OUTAGE}: ")
    } else {
        String::new()
    };
    format!("{none}{outages} of {of} outages {is} excluded ({first}): {why}")
}

pub(super) fn not_run(models: &[String], all: bool, why: Option<&str>) -> String {
    let why = why.map_or(String::new(), |why| format!(": {why}"));
    match all {
        true => format!("{NO_MODEL}{why}"),
        false => format!("could not be run: {}{why}", models.join(", ")),
    }
}
