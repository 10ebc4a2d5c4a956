//! A navigated drive as text.

use crate::{
    date,
    numbers::{error, get, short},
    parameters::wording,
    parts::COMPONENTS,
    say,
};
use undrift_results::{Aid, Innovations, Navigate, Number, Numbers};

/// How a drive was navigated, line by line.
pub fn navigate(result: &Navigate) -> String {
    let s = &result.summary;
    let mut lines = vec![
        say::verdict(&result.findings),
        say::hindsight(result.look_ahead, result.smooth).into(),
    ];
    let mounting = result.mounting.as_ref();
    lines.extend(mounting.map(|mounting| say::estimated(mounting)));
    lines.push(format!("bias model {}; {}", result.bias_model, s.alignment));
    lines.push(format!(
        "navigated {} samples from {:.3} s to {:.3} s, after {} samples and {} fixes for alignment",
        s.samples, s.started.0, s.ended.0, s.align_samples, s.fixes_before
    ));
    let start = date::of_drive(&result.drive, s.started.0);
    lines.extend(start.map(|start| format!("start: {start}")));
    lines.push(format!("{} fixes used", s.fixes));
    if let Some((first, again)) = s.fix_errors.split_first() {
        let from = first.from.0;
        lines.push(match again.len() {
            0 => format!("their errors, as they show them: estimated from {from:.3} s on"),
            n => format!("their errors, as they show them: estimated from {from:.3} s on, re-estimated {n} times since"),
        });
    }
    for (aid, sums) in s.innovations.iter() {
        let (name, n) = (aid.name(), sums.updates);
        match aid {
            Aid::Position | Aid::Velocity if n + sums.rejected > 0 => {
                lines.push(format!("{name}: {}", innovations(sums)));
            }
            Aid::Position | Aid::Velocity => {}
            _ if n == 0 => {}
            _ => {
                let constraint = match aid {
                    Aid::NonHolonomic => " constraint",
                    _ => "",
                };
                let nis = nis(sums);
                lines.push(format!(
                    "{name}{constraint}: {n} updates, NIS per degree of freedom {nis}"
                ));
            }
        }
    }
    if let Some(louder) = &s.louder {
        let times = |axes: &[Number]| Vec::from_iter(axes.iter().map(|n| short(n.0))).join(", ");
        let (gyro, accel) = louder.split_at(3);
        lines.push(format!(
            "white noise above the band of motion: gyro x, y, z {}, accelerometer {} times the model's; the filter uses it",
            times(gyro),
            times(accel)
        ));
    }
    for (kind, parameter) in &s.parameters {
        let wording = wording(kind);
        let pairs = parameter.value.iter().zip(&parameter.std);
        let pairs = pairs.map(|(value, std)| {
            let [value, std] = [value, std].map(|number| wording.factor * number.0);
            format!("{} ± {}", short(value), error(std))
        });
        lines.push(format!(
            "{}: {} {}",
            wording.named(),
            Vec::from_iter(pairs).join(", "),
            wording.unit
        ));
    }
    if let (Some(errors), Some(n)) = (&result.rms_error, result.compared_samples) {
        let errors = known(errors, COMPONENTS.map(|(name, _)| name), 4);
        lines.push(format!(
            "RMS error against the truth at {n} samples: {errors}"
        ));
    }
    let groups = [
        "position",
        "velocity",
        "attitude",
        "gyro_bias",
        "accel_bias",
    ];
    let nees = known(&result.nees_per_dof, groups, 2).replace('_', " ");
    if !nees.is_empty() {
        lines.push(format!(
            "NEES per degree of freedom against the truth, once a second (1 if the covariance is correct): {nees}"
        ));
    }
    say::words::worded(lines.join("\n"), result.drive.posed)
}

/// The numbers that there are, by name.
fn known<const N: usize>(numbers: &Numbers, names: [&str; N], digits: usize) -> String {
    let known = names.into_iter().map(|name| (name, get(numbers, name)));
    let known = known.filter(|(_, value)| value.is_finite());
    let known = known.map(|(name, value)| format!("{name} {value:.digits$}"));
    Vec::from_iter(known).join(", ")
}

/// NIS, counts and autocorrelation in a line.
fn innovations(sums: &Innovations) -> String {
    let mut text = format!(
        "NIS per degree of freedom {} (1 if the model is correct)",
        nis(sums)
    );
    if let Some((correlation, bound)) = sums.autocorrelation() {
        text += &format!(", autocorrelation {correlation:.2} (±{bound:.2})");
    }
    text + &format!(
        "; {} rejected, {} down-weighted",
        sums.rejected, sums.weakened
    )
}

fn nis(sums: &Innovations) -> String {
    sums.per_dof().map_or("none".into(), |r| format!("{r:.2}"))
}
