//! Sentences: what the fixes show.

use super::sensors::too_optimistic;
use super::words::{at, many};
use crate::numbers::{error, short};
use undrift_events::{Contradiction, FixMend, Lean, Part};
use undrift_results::findings;

pub(super) fn bad_covariance(fixes: u64) -> String {
    format!(
        "rejected {} whose covariance is not positive definite",
        many(fixes, "fix")
    )
}

pub(super) fn wrong_velocity(mend: Option<FixMend>) -> String {
    mend.map_or(
        "GNSS positions and velocities disagree: check gnss.position, gnss.velocity and their units",
        fix_mend,
    )
    .into()
}

pub(super) fn velocity_scale([ratio, std]: [f64; 2]) -> String {
    format!(
        "the velocities of the fixes are {ratio:.3} ± {std:.3} times the changes of position: another unit or another quantity; gnss.use = \"position\" ignores them"
    )
}

pub(super) fn two_receivers(distance: f64) -> String {
    format!(
        "the positions alternate between two places {} m apart: two receivers or antennas in one log; keep the fixes of one",
        short(distance)
    )
}

pub(super) fn more_rejected(spans: u64, accepted: u64) -> String {
    format!(
        "rejected fixes in {spans} more spans, then accepted them in {accepted}; --json lists all"
    )
}

pub(super) fn wrong_sign(axis: usize) -> String {
    format!(
        "the velocity {} appears to have the wrong sign (its innovations are -2 times its value): check gnss.velocity and gnss.velocity_axes",
        ["north", "east", "down"].get(axis).unwrap_or(&"")
    )
}

pub(super) fn repeated(fixes: u64, interval: f64) -> String {
    format!(
        "skipped {}: the receiver measures every {} s",
        match fixes {
            1 => "1 fix that repeats the previous one".into(),
            n => format!("{n} fixes that repeat the previous one"),
        },
        short(interval)
    )
}

pub(super) fn rounded(step: f64) -> String {
    format!(
        "positions are rounded to steps of {} m; their covariance was increased accordingly",
        short(step)
    )
}

pub(super) fn jitter(std: f64) -> String {
    format!(
        "time stamps of the fixes jitter by {:.0} ms; the along-track covariance of the positions was increased accordingly",
        std * 1e3
    )
}

pub(super) fn correlated(share: f64, time: f64) -> String {
    format!(
        "position errors are correlated over {time:.0} s ({:.0} % of their variance); the correlated part is estimated",
        100.0 * share
    )
}

pub(super) fn noisy(factor: f64) -> String {
    format!(
        "positions scatter {factor:.1} times as much as stated; their standard deviations were scaled accordingly"
    )
}

pub(super) fn noisy_heights(factor: f64) -> String {
    format!(
        "heights scatter or wander {factor:.1} times as much as stated; their standard deviation was scaled accordingly"
    )
}

pub(super) fn modest_velocity(factor: f64) -> String {
    format!(
        "velocities match the changes of position to {factor:.2} of their stated standard deviations, which were scaled accordingly; the lasting part of their error is estimated"
    )
}

pub(super) fn velocity_bias([north, east, down]: [f64; 3]) -> String {
    format!(
        "velocities differ from the changes of position by a constant {north:.2}, {east:.2}, {down:.2} m/s north, east, down: one of them is wrong; gnss.use = \"position\" ignores the velocities"
    )
}

/// A part of a fix and its unit.
fn part(part: Part) -> (&'static str, &'static str) {
    match part {
        Part::Position => ("position", "m"),
        Part::Velocity => ("velocity", "m/s"),
    }
}

pub(super) fn no_vertical_velocity(start: f64) -> String {
    format!(
        "the vertical velocity of the fixes is always 0, in motion too: it is taken as not measured from {} s on; \"20 m/s\" as the third number of gnss.velocity_std says so from the first fix on",
        at(start)
    )
}

pub(super) fn side_slip(start: f64, speed: f64) -> String {
    format!(
        "from {} s on the vehicle moves across its forward axis by up to {} m/s (RMS of a minute): it does not move as wheels do, or the mounting is wrong; the constraint holds as much less, and without [vehicle] profile = \"car\" not at all",
        at(start),
        short(speed)
    )
}

pub(super) fn rejected(fixes: &Contradiction) -> String {
    let (part, unit) = match (fixes.height, part(fixes.part)) {
        (true, (_, unit)) => ("height", unit),
        (false, named) => named,
    };
    let size = |value: f64| match value {
        v if !(9.95..9999.5).contains(&v) => error(v),
        v => format!("{v:.0}"),
    };
    let what = match (fixes.fixes, fixes.part) {
        (1, _) => format!("1 {part}"),
        (n, _) if fixes.height => format!("{n} heights"),
        (n, Part::Position) => format!("{n} positions"),
        (n, Part::Velocity) => format!("{n} velocities"),
    };
    let (first, last, largest) = (fixes.first, fixes.last, fixes.largest);
    if findings::is_jump(fixes) && !fixes.height {
        return format!(
            "the positions of the fixes jump by {} m at {} s while nothing else does (RTK on a wrong integer, another base or receiver, multipath?): positions before and after do not fit together",
            size(first),
            at(fixes.start)
        );
    }
    if fixes.height && fixes.accepted_in_the_end {
        return format!(
            "the height of the fixes jumps by {largest:.1} m at {} s while nothing else does (above sea level against above the ellipsoid?): heights before and after do not fit together",
            at(fixes.start)
        );
    }
    let (when, how) = if fixes.fixes == 1 {
        (at(fixes.start), format!("error {} {unit}", size(largest)))
    } else {
        let changed = if last < first { "fell" } else { "grew" };
        let mut how = format!(
            "error {changed} from {} to {} {unit}, at {} {}",
            size(first),
            size(last),
            short(fixes.growth.abs()),
            match fixes.part {
                Part::Position => "m/s",
                Part::Velocity => "m/s²",
            }
        );
        if largest > 1.05 * first.max(last) {
            how += &format!(", at most {} {unit}", size(largest));
        }
        (format!("{}-{}", at(fixes.start), at(fixes.end)), how)
    };
    let why = if fixes.frozen {
        ": the receiver repeated its fix while the solution moved"
    } else {
        ""
    };
    let then = if fixes.accepted_in_the_end {
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
        "from {:.1} to {:.1} s the GNSS {part} differs from the solution to one side, on average by up to {:.2}, {:.2}, {:.2} {unit} north, east, down: the fixes drift slowly (multipath, spoofing), or the sensors do",
        lean.start, lean.end, -north, -east, -down
    )
}

pub(super) fn correlated_innovations(of: Part, correlation: f64, tuned: bool) -> String {
    let (part, _) = part(of);
    format!(
        "{part} innovations are correlated from fix to fix (autocorrelation {correlation:.2}), so attitude and sensor errors are larger than predicted: {}",
        too_optimistic(tuned, "the lever arm, the axes or the times are wrong")
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
        "stated {part} standard deviations are about {times:.1} times too {direction} for the innovations"
    );
    if adapted {
        return text + "; they were adapted";
    }
    text += &format!(": multiply gnss.{part}_std_factor by {factor:.2}, or set gnss.adapt = true");
    if correlated && factor > 1.0 {
        text += "; but the innovations are correlated from fix to fix, so the noise model, the mounting, the lever arm or the times may be wrong instead";
    }
    text
}

fn fix_mend(mend: FixMend) -> &'static str {
    match mend {
        FixMend::VelocityEastNorth => {
            "the GNSS velocity is east, north, not north, east: list the north column first in gnss.velocity"
        }
        FixMend::PositionSwapped => {
            "latitude and longitude are exchanged: list the latitude first in gnss.position"
        }
        FixMend::EastReversed => {
            "the GNSS velocity east (or the longitude) has the wrong sign: check gnss.velocity and gnss.position"
        }
        FixMend::NorthReversed => {
            "the GNSS velocity north (or the latitude) has the wrong sign: check gnss.velocity and gnss.position"
        }
        FixMend::VelocityReversed => {
            "the GNSS velocity has the wrong signs: check gnss.velocity, which is north, east, down"
        }
        FixMend::KilometresPerHour => {
            "the GNSS velocity is in km/h, not m/s: convert the columns of gnss.velocity to m/s"
        }
        FixMend::Knots => {
            "the GNSS velocity is in knots, not m/s: convert the columns of gnss.velocity to m/s"
        }
        FixMend::FeetPerSecond => {
            "the GNSS velocity is in ft/s, not m/s: convert the columns of gnss.velocity to m/s"
        }
        FixMend::CentimetresPerSecond => {
            "the GNSS velocity is in cm/s, not m/s: convert the columns of gnss.velocity to m/s"
        }
        FixMend::MillimetresPerSecond => {
            "the GNSS velocity is in mm/s, not m/s: convert the columns of gnss.velocity to m/s"
        }
        FixMend::PositionInRadians => {
            "latitude and longitude are in rad, not deg: set gnss.position_unit = \"rad\""
        }
    }
}
