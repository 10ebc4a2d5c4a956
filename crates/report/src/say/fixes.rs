//! Sentences: what the fixes show.

use super::words::{at, many};
use crate::numbers::{error, short};
use undrift::replay::{Contradiction, FixMend, Lean, Part};

pub(super) fn bad_covariance(fixes: u64) -> String {
    format!(
        "rejected {} whose covariance is not positive definite",
        many(fixes, "fix")
    )
}

pub(super) fn wrong_velocity(mend: Option<FixMend>) -> String {
    format!(
        "positions do not move as the velocities say: {}; check gnss.position, gnss.velocity and their units",
        mend.map_or("one of the two is wrong", fix_mend)
    )
}

pub(super) fn more_rejected(spans: u64, accepted: u64) -> String {
    format!(
        "and {spans} more such spans, after {accepted} of which the fixes were accepted; --json lists them"
    )
}

pub(super) fn wrong_sign(axis: usize) -> String {
    format!(
        "the velocity {} seems to have the wrong sign: its innovations are minus twice its value; check gnss.velocity and gnss.velocity_axes",
        ["north", "east", "down"].get(axis).unwrap_or(&"")
    )
}

pub(super) fn repeated(fixes: u64, interval: f64) -> String {
    format!(
        "{} skipped: the receiver measures every {} s",
        match fixes {
            1 => "1 fix repeats the one before and was".into(),
            n => format!("{n} fixes repeat the one before and were"),
        },
        short(interval)
    )
}

pub(super) fn rounded(step: f64) -> String {
    format!(
        "positions come in steps of {} m; their covariance is that much larger",
        short(step)
    )
}

pub(super) fn jitter(std: f64) -> String {
    format!(
        "the stamps of the fixes jitter by {:.0} ms; the covariance of the positions along the track is that much larger",
        std * 1e3
    )
}

pub(super) fn correlated(share: f64, time: f64) -> String {
    format!(
        "the position's error is correlated over {time:.0} s ({:.0} % of its variance); it is estimated",
        100.0 * share
    )
}

pub(super) fn noisy(factor: f64) -> String {
    format!(
        "positions scatter {factor:.1} times as much as stated; their standard deviations were multiplied by that"
    )
}

pub(super) fn modest_velocity(factor: f64) -> String {
    format!(
        "velocities agree with the motion of the positions to {factor:.2} of their stated standard deviations, which were multiplied by that; a part of the error lasts and is estimated"
    )
}

pub(super) fn velocity_bias([north, east, down]: [f64; 3]) -> String {
    format!(
        "the velocity differs from the motion of the positions by {north:.2}, {east:.2}, {down:.2} m/s north, east, down all along: it or the positions are wrong; gnss.use = \"position\" does without it"
    )
}

/// A part of a fix and its unit.
fn part(part: Part) -> (&'static str, &'static str) {
    match part {
        Part::Position => ("position", "m"),
        Part::Velocity => ("velocity", "m/s"),
    }
}

pub(super) fn rejected(fixes: &Contradiction) -> String {
    let (part, unit) = part(fixes.part);
    let size = |value: f64| match value {
        v if !(9.95..9999.5).contains(&v) => error(v),
        v => format!("{v:.0}"),
    };
    let what = match (fixes.fixes, fixes.part) {
        (1, _) => format!("1 {part}"),
        (n, Part::Position) => format!("{n} positions"),
        (n, Part::Velocity) => format!("{n} velocities"),
    };
    let (first, last, largest) = (fixes.first, fixes.last, fixes.largest);
    let (when, how) = if fixes.fixes == 1 {
        (at(fixes.start), format!("error {} {unit}", size(largest)))
    } else {
        let changed = if last < first { "fell" } else { "grew" };
        let mut how = format!(
            "error {changed} from {} to {} {unit}, by {} {unit} a second",
            size(first),
            size(last),
            short(fixes.growth.abs())
        );
        if largest > 1.05 * first.max(last) {
            how += &format!(", {} {unit} at most", size(largest));
        }
        (format!("{}-{}", at(fixes.start), at(fixes.end)), how)
    };
    let why = if fixes.frozen {
        ": the receiver repeated itself while the solution moved"
    } else {
        ""
    };
    let then = if fixes.gave_way {
        "; then accepted them"
    } else {
        ""
    };
    format!("rejected {what}, {when} s ({how}){why}{then}")
}

pub(super) fn one_sided(lean: &Lean) -> String {
    let (part, unit) = part(lean.part);
    let [north, east, down] = lean.mean;
    format!(
        "from {:.1} to {:.1} s the {part} differs from the solution to one side, on average by up to {:.2}, {:.2}, {:.2} {unit} north, east, down: a slow drift of the fixes (multipath, spoofing) or of the sensors",
        lean.start, lean.end, -north, -east, -down
    )
}

pub(super) fn correlated_innovations(of: Part, correlation: f64) -> String {
    let (part, _) = part(of);
    format!(
        "the innovations of the {part} last from fix to fix (autocorrelation {correlation:.2}): attitude and sensor errors are larger than stated; the noise model of the IMU is too small for this vehicle (`undrift tune` finds the right one), or the lever arm, the axes or the times are wrong"
    )
}

pub(super) fn wrong_accuracy(of: Part, factor: f64, adapted: bool, correlated: bool) -> String {
    let (part, _) = part(of);
    let (times, direction) = if factor > 1.0 {
        (factor, "small")
    } else {
        (1.0 / factor, "large")
    };
    let mut text = format!(
        "the stated standard deviations of the {part} are about {times:.1} times too {direction} for the innovations"
    );
    if adapted {
        return text + "; they were adapted";
    }
    text += &format!(
        ": set gnss.{part}_std_factor to {factor:.2} times what it is, or gnss.adapt = true"
    );
    if correlated && factor > 1.0 {
        text += "; but the innovations are correlated from fix to fix, so the noise model, the mounting, the lever arm or the times may be wrong rather than the accuracy";
    }
    text
}

fn fix_mend(mend: FixMend) -> &'static str {
    match mend {
        FixMend::VelocityEastNorth => "the velocity is east, north, not north, east",
        FixMend::PositionSwapped => "latitude and longitude are swapped",
        FixMend::EastReversed => "the velocity east (or the longitude) has the wrong sign",
        FixMend::NorthReversed => "the velocity north (or the latitude) has the wrong sign",
        FixMend::VelocityReversed => "the velocity has the wrong signs",
        FixMend::KilometresPerHour => "the velocity is in km/h",
        FixMend::Knots => "the velocity is in knots",
        FixMend::FeetPerSecond => "the velocity is in ft/s",
        FixMend::CentimetresPerSecond => "the velocity is in cm/s",
        FixMend::MillimetresPerSecond => "the velocity is in mm/s",
        FixMend::PositionInRadians => "latitude and longitude are in rad, not deg",
    }
}
