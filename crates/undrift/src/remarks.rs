//! What should be said of a log and of how it was navigated, in sentences.

use crate::{
    align::{
        Alignment, AlignmentFailure, AttitudeSource, HeadingSource, MotionFailure, RestFailure,
    },
    replay::{FixMend, Implausible, Innovations, NotAligned, Part, RestartCause, Summary},
};
use undrift_io::{held::Held, imu::GapSummary, skipped::Skipped};

/// What was unusual about the log.
pub fn of_health(summary: &Summary) -> Vec<String> {
    let mut remarks = Vec::new();
    if summary.bridged > 0 {
        remarks.push(format!(
            "short gaps between samples, bridged: {}",
            summary.bridged
        ));
    }
    if let Some((count, first, longest)) = summary.long_gaps {
        remarks.push(format!(
            "long gaps between samples: {count}, the first at {first:.3} s, the longest {longest:.3} s; the covariance was grown over each of up to a minute"
        ));
    }
    let (from, length) = summary.longest_without_gnss;
    if length > WITHOUT_GNSS {
        remarks.push(format!(
            "longest span without a usable fix: {length:.1} s from {from:.3} s"
        ));
    }
    if summary.bad_fixes > 0 {
        remarks.push(format!(
            "fixes whose covariance is none: {}",
            summary.bad_fixes
        ));
    }
    remarks
}

/// Axes of the IMU that held a value.
pub fn of_held(held: &[Held]) -> Vec<String> {
    let of = |held: &Held| {
        let Held {
            value,
            start,
            length,
            samples,
            ..
        } = held;
        let sensor = if held.axis < 3 {
            "gyro"
        } else {
            "accelerometer"
        };
        let axis = ["x", "y", "z"][held.axis % 3];
        let why = if held.saturated {
            "its largest or smallest: the sensor is saturated, or too coarse"
        } else {
            "and nothing else: the sensor is frozen, not connected or too coarse"
        };
        format!(
            "{sensor} {axis} read {value} for {length:.2} s from {start:.3} s, {samples} samples on end, {why}"
        )
    };
    // A frozen log is one remark.
    match held {
        [first, _, _, _, _, _]
            if held
                .iter()
                .all(|of| of.start == first.start && !of.saturated) =>
        {
            vec![format!(
                "all six axes of the IMU repeat their values for {:.2} s from {:.3} s, {} samples on end: the log or the sensor is frozen",
                first.length, first.start, first.samples
            )]
        }
        _ => held.iter().map(of).collect(),
    }
}

/// Spans without a usable fix longer than this are told [s].
pub const WITHOUT_GNSS: f64 = 5.0;

/// What of the units, axes, signs or times cannot be right, and what to look at.
pub fn of_implausible(finding: &Implausible) -> String {
    match *finding {
        Implausible::Gravity(ratio) => format!(
            "the accelerometers show {} times gravity on the average: check {}",
            digits(ratio),
            match ratio {
                0.09..0.115 => "imu.accel_unit, the numbers are those of g",
                8.5..11.5 => "imu.accel_unit, the numbers are those of m/s^2",
                90.0..115.0 => "imu.accel_unit, the numbers are those of mg or cm/s^2",
                _ => "imu.accel, imu.accel_unit and imu.data",
            }
        ),
        Implausible::Down(down) => format!(
            "gravity lies along {:.2}, {:.2}, {:.2} of the body axes, which are to be forward, right, down: check imu.axes and the order and signs of imu.accel; the attitude is that of the axes as given",
            down[0], down[1], down[2]
        ),
        Implausible::TurnScale(scale) => format!(
            "the course turns by {} times what the gyros say: check {}",
            digits(scale),
            match scale {
                -1.7..-0.6 => "the signs of imu.gyro and imu.axes",
                0.01..0.03 => "imu.gyro_unit, the numbers are those of deg/s",
                34.0..97.0 => "imu.gyro_unit, the numbers are those of rad/s",
                0.0006..0.0017 => "imu.gyro_unit, the numbers are a thousand times too large",
                _ => "imu.gyro_unit and imu.axes",
            }
        ),
        Implausible::TurnAxis(axis) => format!(
            "the course turns as the gyro about body {} says, which is not the vertical axis: check the order of imu.gyro, and imu.axes",
            ["forward", "right", "down"].get(axis).unwrap_or(&"")
        ),
        Implausible::NoTurn => {
            "the gyros do not see the turns of the GNSS course: check imu.gyro, and the times of both logs (gnss.time_offset)".into()
        }
        Implausible::Late(late) => format!(
            "the gyros see the turns of the GNSS course {:.2} s {} than its stamps say: set gnss.time_offset = \"{late:.2} s\" more than it is{}",
            late.abs(),
            if late < 0.0 { "earlier" } else { "later" },
            if (late.abs() - LEAP_SECONDS).abs() < 0.5 {
                "; that is GPS time and UTC mixed"
            } else {
                ""
            }
        ),
        Implausible::Push { forward, right } => format!(
            "by the fixes the vehicle accelerates along body {}, to be forward, and is pushed along body {} in turns to the right, to be right: check imu.axes and the order and signs of imu.accel and imu.gyro",
            axis(forward),
            axis(right)
        ),
        Implausible::Velocity(mend) => format!(
            "positions do not move as the velocities say: {}; check gnss.position, gnss.velocity and their units",
            match mend {
                None => "one of the two is wrong",
                Some(FixMend::VelocityEastNorth) => "the velocity is east, north, not north, east",
                Some(FixMend::PositionSwapped) => "latitude and longitude are swapped",
                Some(FixMend::EastReversed) =>
                    "the velocity east (or the longitude) has the wrong sign",
                Some(FixMend::NorthReversed) =>
                    "the velocity north (or the latitude) has the wrong sign",
                Some(FixMend::VelocityReversed) => "the velocity has the wrong signs",
                Some(FixMend::KilometresPerHour) => "the velocity is in km/h",
                Some(FixMend::Knots) => "the velocity is in knots",
                Some(FixMend::FeetPerSecond) => "the velocity is in ft/s",
                Some(FixMend::CentimetresPerSecond) => "the velocity is in cm/s",
                Some(FixMend::MillimetresPerSecond) => "the velocity is in mm/s",
                Some(FixMend::PositionInRadians) => "latitude and longitude are in rad, not deg",
            }
        ),
    }
}

/// How the first attitude was found.
pub fn of_alignment(alignment: &Alignment) -> String {
    let how = match alignment.source {
        AttitudeSource::Given => return "attitude as given".into(),
        AttitudeSource::Rest { duration, heading } => {
            let heading = match heading {
                HeadingSource::Given => "heading as given",
                HeadingSource::Course => "heading from the course",
            };
            format!("level at rest, {heading}; {duration:.1} s of rest")
        }
        AttitudeSource::Motion {
            duration,
            bias_at_rest,
        } => {
            let after = if bias_at_rest {
                ", gyro bias at rest"
            } else {
                ""
            };
            format!("attitude from {duration:.0} s of motion{after}")
        }
    };
    let [level, heading, bias] = [
        alignment.level_std,
        alignment.heading_std,
        alignment.gyro_bias_std,
    ]
    .map(f64::to_degrees);
    format!("{how}; level ±{level:.2} deg, heading ±{heading:.1} deg, gyro bias ±{bias:.3} deg/s")
}

/// Why a log could not be aligned, and how to mend it.
pub fn of_not_aligned(why: &NotAligned) -> String {
    let mut text = format!("the log could not be aligned: {}", of_failure(&why.failure));
    if let Some([imu, end, gnss]) = why.times {
        text += &format!(
            "; the samples run from {imu:.3} s to {end:.3} s, the fixes from {gnss:.3} s on"
        );
    }
    for finding in &why.implausible {
        text += &format!("; {}", of_implausible(finding));
    }
    let logs: Vec<_> = why.skipped.iter().map(|(log, s)| (*log, s)).collect();
    for skipped in of_skipped(&logs) {
        text += &format!("; {}", skipped.replace('\n', "; "));
    }
    text
}

fn of_failure(failure: &AlignmentFailure) -> String {
    let (rest, motion) = match failure {
        AlignmentFailure::NoPosition => {
            return "no fix within the inertial log has a usable position".into();
        }
        AlignmentFailure::NoOverlap => {
            return "no usable GNSS position fell within the inertial log; compare the two time columns".into();
        }
        AlignmentFailure::NoVelocity => {
            return "the fixes carry no velocity and no two are close enough to make one; set initial.velocity".into();
        }
        AlignmentFailure::NoAttitude(rest, motion) => (rest, motion),
    };
    let (rest, mend) = match rest {
        RestFailure::NoRest => (
            "there was no rest to level on".to_string(),
            "initial.attitude",
        ),
        RestFailure::NoFastFix { min_speed } => (
            format!(
                "no fix after a rest was faster than {min_speed:.1} m/s, so the course gives no heading"
            ),
            "initial.heading or initial.attitude",
        ),
        RestFailure::TooSlow { min_speed, fastest } => (
            format!(
                "the speed never reached {min_speed:.1} m/s (fastest {fastest:.1} m/s), so the course gives no heading"
            ),
            "initial.min_speed, initial.heading or initial.attitude",
        ),
        RestFailure::NoHeading => (
            "there was rest, but no heading".to_string(),
            "initial.heading or initial.attitude",
        ),
    };
    let motion = match motion {
        MotionFailure::NoVelocity => "the fixes carry no velocity, which an alignment in motion needs".into(),
        MotionFailure::TooFew => "there were never enough fixes with a velocity on end for an alignment in motion".into(),
        MotionFailure::TooSteady { change, within } => format!(
            "the velocity changed by {change:.1} m/s at most within {within:.0} s, which says too little of the heading: \
             an alignment in motion needs speeding up, braking or turning"
        ),
        MotionFailure::Ambiguous => "the velocity changes fit more than one attitude: an alignment in motion needs more speeding up, \
             braking or turning".into(),
        MotionFailure::Uncertain(std) => format!(
            "the velocity changes give the attitude to {:.1} deg only: an alignment in motion needs more \
             speeding up, braking or turning, or the noise model is too modest",
            std.to_degrees()
        ),
        MotionFailure::Settling(std) => format!(
            "the log ended while the attitude was known to {:.1} deg",
            std.to_degrees()
        ),
        MotionFailure::Misfit(nis) => format!(
            "samples and fixes do not fit together (squared residuals {nis:.0} times what they should be): compare axes, units, time columns and standard deviations"
        ),
    };
    format!("{rest}, and {motion}; set {mend}")
}

/// Why a solution was aligned again.
fn of_cause(cause: RestartCause) -> &'static str {
    match cause {
        RestartCause::Impossible => "position, velocity or covariance left the possible range",
        RestartCause::NoSamples => "no inertial samples came for more than a minute",
        RestartCause::LargeInnovations => {
            "the innovations were far beyond their predicted size for half a minute"
        }
        RestartCause::GaveWayOften => "it gave way to fixes again and again",
    }
}

/// Name of a body axis in the horizontal plane.
fn axis(number: Option<i8>) -> &'static str {
    match number {
        Some(1) => "forward",
        Some(-1) => "backward",
        Some(2) => "right",
        Some(-2) => "left",
        _ => "(not seen)",
    }
}

/// GPS time less UTC since 2017 [s].
const LEAP_SECONDS: f64 = 18.0;

/// Three digits of a factor.
fn digits(value: f64) -> String {
    if value.abs() < 1e-6 {
        return "0".into();
    }
    let decimals = (2 - value.abs().max(1e-9).log10().floor() as i32).clamp(0, 9) as usize;
    format!("{value:.decimals$}")
}

/// Where the solution and the fixes disagreed: the receiver's fault or the model's.
pub fn of_disagreement(summary: &Summary) -> Vec<String> {
    let mut remarks: Vec<String> = summary.implausible.iter().map(of_implausible).collect();
    for restart in &summary.restarts {
        let then = match restart.resumed {
            Some(time) => format!("aligned anew at {time:.3} s"),
            None => "no new alignment was found".into(),
        };
        remarks.push(format!(
            "restart at {:.3} s: {}; {then}",
            restart.time,
            of_cause(restart.why)
        ));
    }
    remarks.extend(of_contradictions(summary));
    for lean in &summary.leans {
        let (part, unit) = of(lean.part);
        let [north, east, down] = lean.mean;
        remarks.push(format!(
            "from {:.1} s to {:.1} s the {part} differs from the solution to one side, by up to {:.2}, {:.2}, {:.2} {unit} north, east, down on the average: a slow drift of the fixes (multipath, spoofing), or of the sensors",
            lean.start, lean.end, -north, -east, -down
        ));
    }
    for axis in summary.wrong_signs() {
        remarks.push(format!(
            "the velocity {} seems to have the wrong sign: its innovations are minus twice its value; check gnss.velocity and gnss.velocity_axes",
            ["north", "east", "down"][axis]
        ));
    }
    if let Some(time) = summary.suspect {
        remarks.push(format!(
            "the innovations from {time:.1} s on are far beyond their predicted size: the solution diverges from the fixes, or the noise model or the stated GNSS accuracy is wrong"
        ));
    }
    remarks
}

/// What was unusual about a log of one number, and how it was used.
pub fn of_scalar(
    name: &str,
    skipped: &Skipped,
    gaps: &GapSummary,
    used: &Innovations,
) -> Vec<String> {
    let mut remarks = Vec::new();
    if !skipped.is_empty() {
        remarks.push(format!("{name} log: {skipped}"));
    }
    if let (count, Some(longest)) = (gaps.count, gaps.longest) {
        remarks.push(format!(
            "{name} log: {count} gaps, the longest {:.3} s from {:.3} s",
            longest.length, longest.start
        ));
    }
    if used.updates == 0 {
        remarks.push(format!(
            "{name} log: nothing of it was used; compare its times with the IMU's, {name}.time_offset moves them"
        ));
    }
    if used.rejected + used.weakened > 0 {
        remarks.push(format!(
            "{name}: {} measurements left out and {} given less weight, far from what was predicted",
            used.rejected, used.weakened
        ));
    }
    remarks
}

/// What was left out of each log.
pub fn of_skipped(logs: &[(&str, &Skipped)]) -> Vec<String> {
    let any = logs.iter().filter(|(_, skipped)| !skipped.is_empty());
    any.map(|(log, skipped)| format!("{log} log: {skipped}"))
        .collect()
}

/// Autocorrelation of innovations above which it is not the accuracy of the fixes that is wrong.
const COLOURED: f64 = 0.5;

/// What a stated accuracy of a part of the fixes is, that is wrong by a factor.
pub fn of_accuracy(part: &str, factor: f64, summary: &Summary) -> String {
    let (times, direction) = if factor > 1.0 {
        (factor, "small")
    } else {
        (1.0 / factor, "large")
    };
    let mut text = format!(
        "the stated standard deviations of the {part} are about {times:.1} times too {direction} for the innovations"
    );
    let goes_on = [&summary.position, &summary.velocity]
        .iter()
        .any(|sums| sums.autocorrelation().is_some_and(|(c, _)| c > COLOURED));
    if summary.adapted.iter().any(Option::is_some) {
        text += "; they were adapted";
    } else {
        text += &format!(
            ": set gnss.{part}_std_factor to {factor:.2} times what it is, or gnss.adapt = true"
        );
        if goes_on && factor > 1.0 {
            text += "; but the innovations go on from fix to fix, so that the noise model, the mounting, the lever arm or the times may be wrong rather than the accuracy";
        }
    }
    text
}

/// Runs of fixes left out that are told one by one.
const TOLD: usize = 12;

fn of(part: Part) -> (&'static str, &'static str) {
    match part {
        Part::Position => ("position", "m"),
        Part::Velocity => ("velocity", "m/s"),
    }
}

/// Which fixes were left out.
fn of_contradictions(summary: &Summary) -> Vec<String> {
    let mut remarks = Vec::new();
    let all = &summary.contradictions;
    for c in all.iter().take(TOLD) {
        let (part, unit) = of(c.part);
        let size = if c.fixes == 1 {
            format!("{:.2} {unit} off", c.largest)
        } else {
            format!(
                "{:.2} {unit} off at first, {:.2} {unit} at last ({:+.2} {unit} a second), {:.2} {unit} at most",
                c.first, c.last, c.growth, c.largest
            )
        };
        let what = if c.frozen {
            "the receiver repeated itself while the solution moved"
        } else {
            "jump"
        };
        let end = if c.gave_way {
            "; the solution gave way to it"
        } else {
            ""
        };
        remarks.push(format!(
            "{part} left out, {what}: {:.3} s to {:.3} s, {} {}, {size}{end}",
            c.start,
            c.end,
            c.fixes,
            if c.fixes == 1 { "fix" } else { "fixes" }
        ));
    }
    let more = all.len() - all.len().min(TOLD);
    if more > 0 {
        let gave_way = all.iter().skip(TOLD).filter(|c| c.gave_way).count();
        remarks.push(format!(
            "and {} more such spans, in {gave_way} of which the solution gave way; --json has {}",
            more as u64 + summary.more_contradictions,
            if summary.more_contradictions > 0 {
                "the first 1000"
            } else {
                "all"
            }
        ));
    }
    remarks
}
