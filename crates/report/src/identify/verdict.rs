//! Whether a static recording serves.

use super::{spoken, used};
use crate::numbers::{short, span};
use undrift_results::{Axis, AxisDoubt, Identify, usability::Usability};

/// Whether the record serves without reservation: its verdict is `usable`, and recordings are of one sensor.
pub fn is_usable(result: &Identify) -> bool {
    result.verdict() == Usability::Usable
}

/// Reason why the noise of an axis is not known.
const COARSE: &str = "the values' steps exceed the noise, and N may be several times too large: log more digits, or set a smaller range";

/// Whether the record serves, and why not: the first line of what is printed of it.
pub fn verdict(result: &Identify) -> String {
    let axes: Vec<(&str, &Axis)> = result.in_order().collect();
    let known = axes.iter().filter(|(_, axis)| axis.error.is_none());
    let known: Vec<_> = known.collect();
    let mut of_axes: Vec<String> = Vec::new();
    let mut coarse: Vec<String> = Vec::new();
    for (name, axis) in &axes {
        match axis.doubt() {
            Some(AxisDoubt::Coarse) => coarse.push(spoken(name)),
            _ => of_axes.extend(doubt(name, axis)),
        }
    }
    if !coarse.is_empty() {
        let names = coarse.join(", ");
        of_axes.push(format!("{names}: {COARSE}"));
    }
    let guess = result.guessed_units.as_ref();
    of_axes.extend(guess.map(|units| {
        format!("the range of the raw counts is a guess, and N may be several times too small or large: state --units (taken: \"{units}\")")
    }));
    of_axes.extend(used::doubts(result));
    let doubts = of_axes.join("; ");
    let Some((_, first)) = known.first() else {
        return format!("Not usable: {doubts}.");
    };
    let rate = result.rate_hz.0;
    let of = match known.len() {
        n if n < axes.len() => format!("{n} of {} axes", axes.len()),
        1 => "1 axis".to_owned(),
        n => format!("{n} axes"),
    };
    let recordings = match &result.pool {
        Some(pool) => format!(" in {} recordings", pool.records.len()),
        None => String::new(),
    };
    let record = format!(
        "{of}, {}{recordings} at {} Hz",
        span(first.samples as f64 / rate),
        short(rate)
    );
    let horizon = first.chosen.drift_score.keys();
    let longest = horizon
        .filter_map(|key| key.parse::<f64>().ok())
        .fold(0.0, f64::max);
    let brief = match longest {
        _ if is_allan(result) => " Allan deviations alone: no models.".to_owned(),
        60.0.. => String::new(),
        s => format!(" It is too short to judge drifts beyond {s} s."),
    };
    let used = used::spans(result);
    match doubts.as_str() {
        "" => format!("Usable: {record}.{brief}{used}"),
        doubts => format!("Usable with care: {doubts} ({record}).{brief}{used}"),
    }
}

/// Why an axis is not to be trusted.
fn doubt(name: &str, axis: &Axis) -> Option<String> {
    let name = spoken(name);
    let why = match &axis.doubt()? {
        AxisDoubt::Constant => {
            return Some(format!(
                "{name} is constant and was excluded; check its column or the sensor"
            ));
        }
        AxisDoubt::Failed(why) => why.clone(),
        AxisDoubt::Moving => "the recording is not static".into(),
        AxisDoubt::Saturated => "the axis is saturated".into(),
        AxisDoubt::Frozen => "the sensor is frozen".into(),
        AxisDoubt::Rounded => "rounding hides most of the noise".into(),
        AxisDoubt::Coarse => COARSE.into(),
    };
    Some(format!("{name}: {why}"))
}

/// Whether the result is of the Allan deviations alone.
pub(crate) fn is_allan(result: &Identify) -> bool {
    result.axes.values().all(|axis| axis.candidates.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;
    use undrift_noise::screening::{RecordError, rounding::MOSTLY_SHOWN};
    use undrift_results::Number;

    #[test]
    fn an_axis_is_doubted_for_the_first_reason_that_holds() {
        assert_eq!(doubt("gyro_x", &Axis::default()), None);
        let coarse = Axis {
            noise_shown: Some(Number(MOSTLY_SHOWN)),
            ..Axis::default()
        };
        let said = doubt("gyro_x", &coarse).unwrap();
        assert!(
            said.starts_with("gyro x: the values' steps exceed the noise"),
            "{said}"
        );
        let hidden = Axis {
            noise_shown: Some(Number(0.99 * MOSTLY_SHOWN)),
            ..Axis::default()
        };
        let why = |axis: &Axis| doubt("gyro_x", axis).unwrap_or_default();
        assert!(why(&hidden).ends_with(": rounding hides most of the noise"));
        let moving = Axis {
            moving: Some(true),
            ..hidden.clone()
        };
        assert!(why(&moving).ends_with(": the recording is not static"));
        let still = Axis {
            moving: Some(false),
            ..Axis::default()
        };
        assert_eq!(doubt("gyro_x", &still), None);
        let failed = Axis {
            error: Some("too short".into()),
            ..moving
        };
        assert!(why(&failed).ends_with(": too short"));
        let constant = Axis {
            error: Some(RecordError::Constant.to_string()),
            ..failed
        };
        assert!(why(&constant).contains("is constant and was excluded"));
    }
}
