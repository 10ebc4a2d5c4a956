//! Which part of a recording was used, and why not all of it.

use super::{spoken, units, units::with_unit};
use crate::numbers::span;
use undrift_results::{Identify, Omission, Omitted, Used};

/// Steps that are said one by one.
const FEW_STEPS: usize = 2;

/// Why the rest of a recording is to be looked at, of parts that were left out for more than handling at its ends.
pub(super) fn doubts(result: &Identify) -> Vec<String> {
    let doubtful = result.used.iter().filter(|used| used.is_doubtful());
    let doubts = doubtful.map(|used| {
        let steps = used.left_out.iter();
        let steps = Vec::from_iter(steps.filter(|part| part.why == Omission::Step));
        let size = |part: &&&Omitted| part.step.0.abs();
        let largest = steps.iter().max_by(|a, b| size(a).total_cmp(&size(b)));
        // Many steps are one doubt.
        let many = largest.filter(|_| steps.len() > FEW_STEPS);
        let of_steps = many.and_then(|largest| {
            let largest = doubt(used, largest)?;
            Some(format!("{} steps, the largest: {largest}", steps.len()))
        });
        let parts = used.left_out.iter();
        let parts = parts.filter(|part| many.is_none() || part.why != Omission::Step);
        let parts = parts.filter_map(|part| doubt(used, part));
        let parts = Vec::from_iter(of_steps.into_iter().chain(parts));
        of_several(result, used, parts.join("; "))
    });
    doubts.collect()
}

fn doubt(used: &Used, part: &Omitted) -> Option<String> {
    let (start, end) = (part.start_s.0, part.end_s.0);
    let name = part.axis.as_deref().unwrap_or_default();
    let size = with_unit(part.step.0.abs(), units(name).constant);
    let name = spoken(name);
    let over = span(part.time_s.0);
    Some(match part.why {
        Omission::Handled => return None,
        Omission::Bump => format!("a bump at {start:.0} to {end:.0} s"),
        Omission::Session => format!("another session at {start:.0} to {end:.0} s"),
        Omission::Step => {
            let at = if end <= used.start_s.0 { end } else { start };
            format!("{name} steps by {size} at {at:.0} s (re-zeroed, or the sensor was moved)")
        }
        Omission::WarmUp => format!(
            "{name} warms up: it drifts by {size} from {start:.0} to {end:.0} s (time constant {over})"
        ),
        Omission::WarmUpRest => format!(
            "{name} still warms up by {size} in what is used (time constant {over}; subtracted)"
        ),
        Omission::Cycle => {
            format!("{name} swings by ±{size} with a period of {over} (subtracted)")
        }
    })
}

/// The part of each recording that was used, as sentences; nothing of one that was used whole.
pub(super) fn spans(result: &Identify) -> String {
    let cut = result.used.iter().filter_map(|used| {
        let parts = used.left_out.iter();
        let parts = Vec::from_iter(parts.filter(|part| !part.why.is_subtracted()));
        (!parts.is_empty()).then_some((used, parts))
    });
    let sentences = cut.map(|(used, parts)| {
        let adjoin = |a: &&Omitted, b: &&Omitted| a.why == b.why && a.end_s == b.start_s;
        let parts = parts.chunk_by(adjoin).filter_map(|run| {
            let (part, last) = (run.first()?, run.last()?);
            let (start, end) = (part.start_s.0, last.end_s.0);
            let why = match part.why {
                Omission::Handled => "handled",
                Omission::Bump => "bump",
                Omission::Step => "beyond the step",
                Omission::Session => "another session",
                Omission::WarmUp => "warm-up",
                Omission::WarmUpRest | Omission::Cycle => return None,
            };
            Some(format!("{start:.0} to {end:.0} s ({why})"))
        });
        let left_out = Vec::from_iter(parts).join(", ");
        let (start, end) = (used.start_s.0, used.end_s.0);
        let text = format!("used {start:.0} to {end:.0} s, excluded {left_out}.");
        let text = of_several(result, used, text);
        match text.strip_prefix("used ") {
            Some(rest) => format!(" Used {rest}"),
            None => format!(" {text}"),
        }
    });
    sentences.collect()
}

/// A text after the name of its recording, where there are several.
fn of_several(result: &Identify, used: &Used, text: String) -> String {
    match result.pool {
        Some(_) => format!("{}: {text}", used.record),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_span_used_is_said_and_a_step_is_a_doubt() {
        let handled = Omitted {
            start_s: 0.0.into(),
            end_s: 6.0.into(),
            ..Omitted::default()
        };
        let mut result = Identify {
            used: vec![Used {
                start_s: 6.0.into(),
                end_s: 1800.0.into(),
                length_s: 1800.0.into(),
                left_out: vec![handled],
                ..Used::default()
            }],
            ..Identify::default()
        };
        assert_eq!(doubts(&result), Vec::<String>::new());
        assert_eq!(
            spans(&result),
            " Used 6 to 1800 s, excluded 0 to 6 s (handled)."
        );
        result.used[0].left_out.push(Omitted {
            why: Omission::Step,
            start_s: 900.0.into(),
            end_s: 1800.0.into(),
            axis: Some("accel_x".into()),
            step: (-0.25 * 9.80665e-3).into(),
            ..Omitted::default()
        });
        assert_eq!(
            doubts(&result),
            ["accelerometer x steps by 0.250 mg at 900 s (re-zeroed, or the sensor was moved)"]
        );
        assert!(spans(&result).ends_with("900 to 1800 s (beyond the step)."));
    }

    #[test]
    fn many_steps_are_said_as_one() {
        let step = |start: f64, end: f64, size: f64| Omitted {
            why: Omission::Step,
            start_s: start.into(),
            end_s: end.into(),
            axis: Some("gyro_y".into()),
            step: (size * std::f64::consts::PI / 180.0).into(),
            ..Omitted::default()
        };
        let result = Identify {
            used: vec![Used {
                start_s: 600.0.into(),
                end_s: 1200.0.into(),
                length_s: 2400.0.into(),
                left_out: vec![
                    step(0.0, 600.0, 0.1),
                    step(1200.0, 1800.0, -0.3),
                    step(1800.0, 2400.0, 0.2),
                ],
                ..Used::default()
            }],
            ..Identify::default()
        };
        assert_eq!(
            doubts(&result),
            [
                "3 steps, the largest: gyro y steps by 0.300 °/s at 1200 s (re-zeroed, or the sensor was moved)"
            ]
        );
        assert_eq!(
            spans(&result),
            " Used 600 to 1200 s, excluded 0 to 600 s (beyond the step), 1200 to 2400 s (beyond the step)."
        );
    }

    #[test]
    fn a_warm_up_is_said_with_its_drift_and_what_is_subtracted_is_used() {
        let part = |why, start: f64, end: f64, size: f64| Omitted {
            why,
            start_s: start.into(),
            end_s: end.into(),
            axis: Some("gyro_z".into()),
            step: (size * std::f64::consts::PI / 180.0).into(),
            time_s: 900.0.into(),
        };
        let warm_up = part(Omission::WarmUp, 0.0, 1800.0, -0.04);
        let cycle = part(Omission::Cycle, 1800.0, 3600.0, 0.02);
        let rest = part(Omission::WarmUpRest, 1800.0, 3600.0, -0.005);
        let mut result = Identify {
            used: vec![Used {
                start_s: 1800.0.into(),
                end_s: 3600.0.into(),
                length_s: 3600.0.into(),
                left_out: vec![warm_up, rest, cycle.clone()],
                ..Used::default()
            }],
            ..Identify::default()
        };
        assert_eq!(
            doubts(&result),
            [
                "gyro z warms up: it drifts by 0.0400 °/s from 0 to 1800 s (time constant 15 min); gyro z still warms up by 0.00500 °/s in what is used (time constant 15 min; subtracted); gyro z swings by ±0.0200 °/s with a period of 15 min (subtracted)"
            ]
        );
        assert_eq!(
            spans(&result),
            " Used 1800 to 3600 s, excluded 0 to 1800 s (warm-up)."
        );
        result.used[0].left_out = vec![cycle];
        assert_eq!(spans(&result), "");
    }
}
