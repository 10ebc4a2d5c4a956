//! Sentences of findings: one place for terminal, report and Python.
//!
//! A sentence begins with a small letter and has no full stop, so that it can stand after a name.

mod fill;
mod start;

pub use fill::{WHITE_CALIBRATED, all, cut, demo, navigated, outcome};
pub use start::{alignment, mounting, unsolved};

use crate::parts::{error, short};
use undrift::{
    findings::{Finding, Log, NoError},
    replay::{Contradiction, FixMend, Lean, Part, RestartCause},
};

/// The sentence of a finding.
pub fn say(finding: &Finding) -> String {
    use Finding::{
        BadCovariance, Bridged, Diverged, Frozen, Gaps, Held, LargeInnovations, Late, LongGaps,
        MoreRejected, NoReference, NoTurns, NotCompared, NotDown, OneSided, Outliers, Rejected,
        Restart, Skipped, StartedLate, Uneven, Unused, WithoutGnss, WrongAccuracy, WrongAxes,
        WrongGravity, WrongSign, WrongTurnAxis, WrongTurnRate, WrongVelocity,
    };
    match finding {
        Diverged { time } => format!("the solution diverged at {} s and ends there", at(*time)),
        NotCompared {
            why,
            truth,
            started,
            ended,
        } => {
            let why = match why {
                NoError::NoOverlap => "the truth does not overlap the solution",
                NoError::TooSparse => {
                    "the truth has no two samples within 2 s of each other during the solution"
                }
            };
            let started = started.map_or("nowhere".into(), at);
            format!(
                "no error against the truth: {why}; the truth runs from {} to {} s, the solution from {started} to {} s; compare the time columns, truth.time_offset moves one",
                at(truth[0]),
                at(truth[1]),
                at(*ended)
            )
        }
        Bridged { gaps } => format!("bridged {} between samples", many(*gaps, "short gap")),
        LongGaps {
            gaps,
            first,
            longest,
        } => format!(
            "{} between samples, the first at {} s, the longest {longest:.3} s; the covariance grew over each of up to a minute",
            many(*gaps, "long gap"),
            at(*first)
        ),
        WithoutGnss { start, length } => format!(
            "longest span without a usable fix: {length:.1} s from {} s",
            at(*start)
        ),
        BadCovariance { fixes } => format!(
            "rejected {} whose covariance is not positive definite",
            many(*fixes, "fix")
        ),
        Frozen {
            start,
            length,
            samples,
        } => format!(
            "all six axes of the IMU repeat their values for {length:.2} s from {} s ({samples} samples): the log or the sensor is frozen",
            at(*start)
        ),
        Held {
            axis,
            value,
            start,
            length,
            samples,
            saturated,
        } => format!(
            "{} {} reads {value} for {length:.2} s from {} s ({samples} samples), {}",
            if *axis < 3 { "gyro" } else { "accelerometer" },
            ["x", "y", "z"][axis % 3],
            at(*start),
            if *saturated {
                "its largest or smallest value: the sensor is saturated or too coarse"
            } else {
                "and nothing else: the sensor is frozen, not connected or too coarse"
            }
        ),
        WrongGravity { ratio } => format!(
            "the accelerometers measure {} times gravity on average: check {}",
            // A sensor without noise.
            if *ratio < 1e-6 { "0".into() } else { short(*ratio) },
            match ratio {
                0.09..0.115 => "imu.accel_unit, the numbers look like g",
                8.5..11.5 => "imu.accel_unit, the numbers look like m/s^2",
                90.0..115.0 => "imu.accel_unit, the numbers look like mg or cm/s^2",
                _ => "imu.accel, imu.accel_unit and imu.data",
            }
        ),
        NotDown { down } => format!(
            "gravity points along {:.2}, {:.2}, {:.2} of the body axes, which should be forward, right, down: check imu.axes and the order and signs of imu.accel; the attitude is that of the axes as given",
            down[0], down[1], down[2]
        ),
        WrongTurnRate { ratio } => format!(
            "the GNSS course turns {} times as fast as the gyros measure: check {}",
            short(*ratio),
            match ratio {
                -1.7..-0.6 => "the signs of imu.gyro and imu.axes",
                0.01..0.03 => "imu.gyro_unit, the numbers look like deg/s",
                34.0..97.0 => "imu.gyro_unit, the numbers look like rad/s",
                0.0006..0.0017 => "imu.gyro_unit, the numbers are a thousand times too large",
                _ => "imu.gyro_unit and imu.axes",
            }
        ),
        WrongTurnAxis { axis } => format!(
            "the turns of the GNSS course show in the gyro about body {}, not in the vertical one: check the order of imu.gyro, and imu.axes",
            ["forward", "right", "down"].get(*axis).unwrap_or(&"")
        ),
        NoTurns => "the gyros do not measure the turns of the GNSS course: check imu.gyro, and the times of both logs (gnss.time_offset)".into(),
        Late { delay } => format!(
            "the gyros measure the turns of the GNSS course {:.2} s {} than its stamps: set gnss.time_offset = \"{delay:.2} s\" more than it is{}",
            delay.abs(),
            if *delay < 0.0 { "earlier" } else { "later" },
            if (delay.abs() - LEAP_SECONDS).abs() < 0.5 {
                "; GPS time and UTC are mixed"
            } else {
                ""
            }
        ),
        WrongAxes {
            forward,
            right,
            axes,
        } => wrong_axes(*forward, *right, axes.as_deref()),
        WrongVelocity { mend } => format!(
            "positions do not move as the velocities say: {}; check gnss.position, gnss.velocity and their units",
            mend.map_or("one of the two is wrong", fix_mend)
        ),
        Restart { time, why, resumed } => format!(
            "gave up the solution at {} s: {}; {}",
            at(*time),
            cause(*why),
            match resumed {
                Some(time) => format!("re-initialised at {} s", at(*time)),
                None => "it could not be re-initialised".into(),
            }
        ),
        Rejected(fixes) => rejected(fixes),
        MoreRejected { spans, accepted } => format!(
            "and {spans} more such spans, after {accepted} of which the fixes were accepted; --json lists them"
        ),
        OneSided(lean) => one_sided(lean),
        WrongSign { axis } => format!(
            "the velocity {} seems to have the wrong sign: its innovations are minus twice its value; check gnss.velocity and gnss.velocity_axes",
            ["north", "east", "down"].get(*axis).unwrap_or(&"")
        ),
        LargeInnovations { start } => format!(
            "the innovations from {start:.1} s on are far beyond their predicted size: the solution diverges from the fixes, or the noise model or the stated GNSS accuracy is wrong"
        ),
        WrongAccuracy {
            part,
            factor,
            adapted,
            correlated,
        } => accuracy(*part, *factor, *adapted, *correlated),
        Skipped { log, kinds, .. } => format!("{} log: {}", name(*log), kinds.replace('\n', "; ")),
        Gaps {
            log,
            gaps,
            start,
            length,
        } => format!(
            "{} log: {}, the longest {length:.3} s from {} s",
            name(*log),
            many(*gaps, "gap"),
            at(*start)
        ),
        Unused { log } => format!(
            "{0} log: nothing of it was used; compare its times with the IMU's, {0}.time_offset moves them",
            name(*log)
        ),
        Outliers {
            log,
            rejected,
            weakened,
        } => format!(
            "{}: rejected {}, used {weakened} with less weight, all far from the prediction",
            name(*log),
            many(*rejected, "measurement")
        ),
        StartedLate { time } => format!(
            "navigation began at {time:.1} s, after the start of the first outage; begin the outages later"
        ),
        NoReference { outages } => {
            format!("{} without a reference inside", many(*outages as u64, "outage"))
        }
        Uneven {
            gaps,
            jitter_rms,
            interval,
        } => format!(
            "the time stamps are not evenly spaced: {}, jitter {:.2} ms RMS of {:.2} ms; the recording is used as if they were",
            many(*gaps as u64, "gap"),
            jitter_rms * 1e3,
            interval * 1e3
        ),
    }
}

/// GPS time less UTC since 2017 \[s\].
const LEAP_SECONDS: f64 = 18.0;

/// A time of a log \[s\], to the millisecond where it has that.
fn at(time: f64) -> String {
    let text = format!("{time:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// So many things by the name of one.
fn many(n: u64, what: &str) -> String {
    let plural = if what.ends_with('x') { "es" } else { "s" };
    format!("{n} {what}{}", if n == 1 { "" } else { plural })
}

fn name(log: Log) -> &'static str {
    match log {
        Log::Imu => "IMU",
        Log::Gnss => "GNSS",
        Log::Truth => "truth",
        Log::Odometer => "odometer",
        Log::Barometer => "barometer",
        Log::Recording => "recording",
    }
}

/// A part of a fix and its unit.
fn part(part: Part) -> (&'static str, &'static str) {
    match part {
        Part::Position => ("position", "m"),
        Part::Velocity => ("velocity", "m/s"),
    }
}

fn rejected(fixes: &Contradiction) -> String {
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

fn one_sided(lean: &Lean) -> String {
    let (part, unit) = part(lean.part);
    let [north, east, down] = lean.mean;
    format!(
        "from {:.1} to {:.1} s the {part} differs from the solution to one side, on average by up to {:.2}, {:.2}, {:.2} {unit} north, east, down: a slow drift of the fixes (multipath, spoofing) or of the sensors",
        lean.start, lean.end, -north, -east, -down
    )
}

fn accuracy(of: Part, factor: f64, adapted: bool, correlated: bool) -> String {
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

/// Where the IMU's axes lie, by the body axes that accelerate and are pushed.
fn wrong_axes(forward: Option<i8>, right: Option<i8>, axes: Option<&str>) -> String {
    let yaw = match (forward, right) {
        (Some(-1), Some(-2) | None) => Some(("backwards", 180)),
        (Some(2), Some(-1) | None) => Some(("to the left", -90)),
        (Some(-2), Some(1) | None) => Some(("to the right", 90)),
        _ => None,
    };
    if let Some((faces, yaw)) = yaw {
        let mend = axes.map_or("turn imu.axes by that".into(), |axes| {
            format!("set imu.axes = \"{axes}\"")
        });
        return format!(
            "GNSS shows that the IMU faces {faces} (yaw {yaw}°): {mend} or imu.mounting = \"auto\""
        );
    }
    let axis = |number| match number {
        Some(1) => "forward",
        Some(-1) => "backward",
        Some(2) => "right",
        Some(-2) => "left",
        _ => "(not seen)",
    };
    format!(
        "GNSS shows that the IMU's axes are not the vehicle's: it accelerates along body {} instead of forward, and is pushed along body {} instead of right in turns to the right; check imu.axes and the order and signs of imu.accel and imu.gyro",
        axis(forward),
        axis(right)
    )
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

/// Why a solution was given up.
pub fn cause(cause: RestartCause) -> &'static str {
    match cause {
        RestartCause::Impossible => "position, velocity or covariance left the possible range",
        RestartCause::NoSamples => "no inertial samples for more than a minute",
        RestartCause::LargeInnovations => {
            "the innovations were far beyond their predicted size for half a minute"
        }
        RestartCause::GaveWayOften => "it rejected fixes and then accepted them again and again",
    }
}

#[cfg(test)]
mod tests;
