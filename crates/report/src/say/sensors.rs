//! Sentences: what the inertial sensors show.

use super::words::{at, many};
use crate::{
    numbers::short,
    parameters::{Wording, wording},
};
use undrift_events::{ChangeOf, DisturbedField, Mismatch, RejectedHeadings, SensorChange};
use undrift_results::findings::{Finding, TemperatureUse, WrappedAxis};

/// Values that the IMU repeats.
pub(super) fn still(finding: &Finding) -> String {
    match finding {
        Finding::Frozen {
            start,
            length,
            samples,
        } => format!(
            "all six IMU axes repeat the same values for {length:.2} s from {} s ({samples} samples): the log or the sensor is frozen",
            at(*start)
        ),
        Finding::Held {
            axis,
            value,
            start,
            length,
            samples,
            saturated,
        } => format!(
            "{} stays at {value} (as logged) for {length:.2} s from {} s ({samples} samples){}",
            name(*axis),
            at(*start),
            if *saturated {
                ", its largest or smallest value: the sensor is saturated or too coarse"
            } else {
                ": the sensor is frozen, disconnected or too coarse"
            }
        ),
        Finding::Constant {
            axis,
            value,
            samples,
            ..
        } => format!(
            "{} is constant ({value}) in all {samples} samples: check {}; if the column is right, the sensor is faulty or too coarse",
            name(*axis),
            if *axis < 3 { "imu.gyro" } else { "imu.accel" }
        ),
        other => unreachable!("not one of a value that repeats: {other:?}"),
    }
}

/// Samples corrected for temperature, those without one, and those at temperatures that the model's recording did not cover.
pub(super) fn copied([axis, copy]: [usize; 2]) -> String {
    format!(
        "{} and {} have the same value in every sample: the log has one column twice; check {}",
        name(axis),
        name(copy),
        if axis < 3 { "imu.gyro" } else { "imu.accel" }
    )
}

pub(super) fn wrapped(of: &WrappedAxis) -> String {
    let WrappedAxis {
        axis,
        limit,
        start,
        jumps,
    } = *of;
    format!(
        "{} jumps from one end of its range to the other ({} as logged) {}, first at {} s: its numbers have too few bits; log more, or a larger range",
        name(axis),
        short(limit),
        many(jumps, "time"),
        at(start)
    )
}

pub(super) fn changed(change: &SensorChange) -> String {
    let [from, to] = change.between;
    let what = match change.what {
        ChangeOf::TurnScale(ratio) => format!(
            "the vertical gyro measures {} times what it did before, of the same turns: its unit or range changed",
            short(ratio)
        ),
        ChangeOf::NoTurn => {
            "the gyros do not measure the turns of the GNSS course any more: an axis failed, or another column is in its place".into()
        }
        ChangeOf::Turned(angle) => format!(
            "the IMU is turned by {:.0} deg about the vertical against before: it was moved in its mount, or its axes were exchanged",
            angle.to_degrees()
        ),
        ChangeOf::ForceScale(axis, ratio) => format!(
            "the accelerometer along body {} measures {} times what it did before, of the same accelerations: its unit or range changed",
            ["forward", "right"].get(axis).unwrap_or(&""),
            short(ratio)
        ),
    };
    format!(
        "from {}-{} s on {what}; use the part before or after alone ([span])",
        at(from),
        at(to)
    )
}

pub(super) fn mismatch(of: &Mismatch) -> String {
    match *of {
        Mismatch::LateVelocities { delay, beyond } => format!(
            "the velocities of the fixes are {delay:.2} s late against the turns of the gyros{}: the receiver's own filter, differences of positions, or wrong stamps",
            beyond.map_or(String::new(), |moved| format!(
                ", and positions some {} m off",
                short(moved)
            ))
        ),
        Mismatch::LateAccelerometers(delay) => format!(
            "the accelerometers are {delay:.2} s later than the gyros: two clocks or topics, or a low-pass on one of them; shift one of the two, or estimate it with states.accel_delay"
        ),
        Mismatch::HeldPositions(step) => format!(
            "the receiver holds its position while it moves slowly, and then steps by up to {} m: switch off its static hold",
            short(step)
        ),
        Mismatch::Nods(angle) => format!(
            "the IMU nods by {:.1} deg (RMS) against the way it moves, which no vehicle on wheels does: a loose mount, of which the attitude is; fasten it",
            angle.to_degrees()
        ),
        Mismatch::MovesAside(angle) => format!(
            "the vehicle moves {:.0} deg off the IMU's forward axis: attitude and heading are the IMU's, not the vehicle's; set imu.mounting or imu.axes",
            angle.to_degrees()
        ),
    }
}

pub(super) fn temperature(of: &TemperatureUse) -> String {
    let TemperatureUse {
        corrected,
        without,
        without_from,
        beyond,
        seen_c,
    } = *of;
    let Some([low, high]) = seen_c else {
        return "the model's temperature correction is not used: the inertial log has no temperature".into();
    };
    let mut text = format!("corrected for temperature ({low:.1} to {high:.1} °C)");
    if let Some(from) = without_from {
        let total = corrected + without;
        let share = 100.0 * without as f64 / total as f64;
        text += &format!(
            ", but not {share:.2} % of the samples, from {} s on, which have no temperature within a minute",
            at(from)
        );
    }
    if beyond > 0 {
        let share = 100.0 * beyond as f64 / corrected as f64;
        text += &format!(
            "; {share:.0} % of it is extrapolated beyond the temperatures of the model's recording: record a wider range"
        );
    }
    text
}

pub(super) fn wrong_gravity(ratio: f64, exchanged: bool) -> String {
    if exchanged {
        return "the gyros measure gravity, and the accelerometers do not: exchange the columns of imu.gyro and imu.accel, and their units".into();
    }
    format!(
        "the accelerometers measure {} times gravity on average: check {}",
        // A sensor without noise.
        if ratio < 1e-6 {
            "0".into()
        } else {
            short(ratio)
        },
        match ratio {
            0.09..0.115 => "imu.accel_unit (the numbers look like g)",
            8.5..11.5 => "imu.accel_unit (the numbers look like m/s^2)",
            90.0..115.0 => "imu.accel_unit (the numbers look like mg or cm/s^2)",
            2.9..3.7 => "imu.accel_unit (the numbers look like ft/s^2)",
            9e4..1.15e5 => "imu.accel_unit (the numbers look like ug)",
            1e-6..0.09 => {
                "imu.accel (gravity seems to be removed, as from a \"linear acceleration\": log the accelerometers with gravity)"
            }
            _ => "imu.accel, imu.accel_unit and imu.data",
        }
    )
}

pub(super) fn not_down(down: [f64; 3]) -> String {
    let (place, size) = (0..3)
        .map(|k| (k, down[k]))
        .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
        .unwrap_or((2, 1.0));
    let towards = match (place, size > 0.0) {
        (0, true) => "forward",
        (0, false) => "backward",
        (1, true) => "right",
        (1, false) => "left",
        (_, true) => "down",
        (_, false) => {
            return "the IMU seems to be upside down (gravity points up in the body axes): check the signs in imu.axes, or set imu.mounting = \"auto\"".into();
        }
    };
    let tilt = down[2].clamp(-1.0, 1.0).acos().to_degrees();
    format!(
        "the IMU seems to be tilted by {tilt:.0}° (gravity points {towards} in the body axes): check imu.axes and the order of imu.accel, or set imu.mounting = \"auto\""
    )
}

pub(super) fn wrong_turn_rate(ratio: f64) -> String {
    format!(
        "the GNSS course turns at {} times the rate of the gyros: check {}",
        short(ratio),
        match ratio {
            -1.7..-0.6 =>
                "the sign of the specific force (reversed: imu.accel_unit = \"-m/s^2\" or \"-g\") and of the gyros (one axis reversed: imu.gyro_unit = \"deg/s, deg/s, -deg/s\"), and imu.axes; `undrift inspect` on the logs tries them",
            0.01..0.03 => "imu.gyro_unit (the numbers look like deg/s)",
            34.0..97.0 => "imu.gyro_unit (the numbers look like rad/s)",
            0.0006..0.0017 => {
                "imu.gyro_unit (the numbers are a thousand times too large: thousandths are \"mdps\" or \"mrad/s\")"
            }
            0.04..0.08 => "imu.gyro_unit (the numbers look like mrad/s)",
            1.2e-5..2.5e-5 => "imu.gyro_unit (the numbers look like mdps)",
            _ => "imu.gyro_unit and imu.axes",
        }
    )
}

pub(super) fn wrong_turn_axis(axis: usize) -> String {
    format!(
        "turns of the GNSS course show in the gyro about body {}, not in the vertical one: check imu.axes and the order of imu.gyro",
        ["forward", "right", "down"].get(axis).unwrap_or(&"")
    )
}

pub(super) const NO_TURNS: &str = "the gyros do not measure the turns of the GNSS course: check imu.gyro and the times of both logs (gnss.time_offset)";

pub(super) fn late(delay: f64) -> String {
    format!(
        "GNSS is stamped {:.2} s too {} for the turns that the gyros measure: add {delay:.2} s to gnss.time_offset{}",
        delay.abs(),
        if delay < 0.0 { "late" } else { "early" },
        if (delay.abs() - LEAP_SECONDS).abs() < 0.5 {
            " (GPS time and UTC are mixed)"
        } else {
            ""
        }
    )
}

pub(super) fn moving_average_sign(axes: &[String]) -> String {
    format!(
        "the ARMA of {} has ar near 1 and a negative ma: check the sign of ma, which is subtracted here and added by statsmodels, R and MATLAB (a slow bias under white noise has ma just below ar)",
        axes.join(", ")
    )
}

pub(super) fn guessed_rate(rate: f64) -> String {
    format!(
        "the IMU log has no times, and {} Hz is a guess: set imu.rate, or log a time with each sample",
        short(rate)
    )
}

pub(super) fn slow_samples(rate: f64, factor: Option<f64>) -> String {
    let large = factor.map_or(String::new(), |factor| {
        format!("innovations are {factor:.1} times as large as predicted: ")
    });
    format!(
        "{large}{} samples a second miss what the vehicle does between them; log the IMU at 50 Hz or more",
        short(rate)
    )
}

pub(super) fn late_samples([delay, std]: [f64; 2], most: f64) -> String {
    let (late, behind, why) = match delay < 0.0 {
        true => ("early", "ahead of", "samples far apart"),
        false => (
            "late",
            "behind",
            "a low-pass filter in the sensor, samples far apart, or its clock",
        ),
    };
    format!(
        "the IMU's samples are {:.0} +- {:.0} ms {late} against the fixes ({why}): the solution has the times of the IMU and is up to {} m {behind} the receiver's, which its standard deviations contain; --clock gnss gives it the times of the receiver, --clock imu says that those of the IMU are right",
        1e3 * delay.abs(),
        1e3 * std,
        short(most)
    )
}

pub(super) fn spikes(axis: usize, samples: u64, start: f64) -> String {
    format!(
        "replaced {} of {} as implausible, the first at {} s",
        many(samples, "sample"),
        name(axis),
        at(start)
    )
}

/// A heading that the course contradicts over a span \[s\] by an angle \[rad\].
pub(super) fn heading_off([start, end]: [f64; 2], angle: f64, more: u64) -> String {
    let more = match more {
        0 => String::new(),
        n => format!(", and in {}", many(n, "more span")),
    };
    format!(
        "the heading disagrees with the GNSS course by up to {:.1} deg, {}-{} s{more}: the bias or the scale of the vertical gyro changed, or the IMU was moved; the heading's standard deviation accounts for it",
        angle.to_degrees().abs(),
        at(start),
        at(end)
    )
}

/// Headings by two antennas that were rejected, and in how many more spans.
pub(super) fn rejected_headings(longest: &RejectedHeadings, more: u64) -> String {
    let (start, end) = (at(longest.start), at(longest.end));
    let angle = longest.angle.to_degrees();
    let headings = longest.headings;
    let more = match more {
        0 => String::new(),
        n => format!(", and others in {}", many(n, "more span")),
    };
    match longest.accepted_in_the_end {
        false => format!(
            "rejected {headings} antenna headings, {start}-{end} s (off by {angle:.0} deg{more}): a wrong number of carrier wavelengths, or reflections"
        ),
        true => format!(
            "{headings} antenna headings in a row, {start}-{end} s, were off by {angle:.0} deg{more}, then accepted: correct heading.baseline, or the receiver was wrong for a minute"
        ),
    }
}

/// A span in which the magnetic field was disturbed.
pub(super) fn disturbed_field(field: &DisturbedField) -> String {
    let (start, end) = (at(field.start), at(field.end));
    format!(
        "the magnetic field was not the Earth's, {start}-{end} s (off by up to {:.0} uT): not used; iron or currents near the magnetometer",
        field.strongest * 1e6
    )
}

pub(super) fn optimistic_model(factor: f64, tuned: bool) -> String {
    format!(
        "innovations are {factor:.1} times as large as predicted although the fixes are consistent: {}",
        too_optimistic(tuned, "the lever arm or the axes are wrong")
    )
}

pub(super) fn optimistic_drift(
    model: &str,
    inside: f64,
    [outside, outages]: [u64; 2],
    tuned: bool,
) -> String {
    let of = match outages {
        0 => String::new(),
        of => format!(", in {outside} of {of} outages less than 90 %"),
    };
    format!(
        "only {:.0} % of the position errors in the outages lie within 3σ as predicted, even with model {model}{of}: {}",
        100.0 * inside,
        too_optimistic(tuned, "the lever arm, the axes or the mounting are wrong")
    )
}

/// What makes a solution optimistic: a noise model that was not tuned may be; else something of these.
pub(super) fn too_optimistic(tuned: bool, others: &str) -> String {
    match tuned {
        false => format!(
            "the IMU's noise model is too optimistic for this vehicle (run `undrift tune`), or {others}"
        ),
        true => format!("{others}, or the drive is unlike those that the noise was tuned on"),
    }
}

pub(super) fn far_parameter(parameter: &str, value: f64, sigmas: f64) -> String {
    let Wording {
        name, unit, factor, ..
    } = wording(parameter);
    let what = match parameter {
        "GyroScale" => {
            "check the units and signs of imu.gyro, imu.axes and imu.mounting, or run `undrift inspect` on the logs again"
        }
        _ => "check the setting that it corrects",
    };
    format!(
        "{name}: the estimate of {} {unit} is {sigmas:.0} prior standard deviations from zero; {what}",
        short(value * factor)
    )
}

fn name(axis: usize) -> String {
    let triad = if axis < 3 { "gyro" } else { "accelerometer" };
    format!("{triad} {}", ["x", "y", "z"][axis % 3])
}

/// GPS time less UTC since 2017 \[s\].
const LEAP_SECONDS: f64 = 18.0;

/// Where the IMU's axes lie, by the body axes that accelerate and are pushed.
pub(super) fn wrong_axes(forward: Option<i8>, right: Option<i8>, axes: Option<&str>) -> String {
    let yaw = match (forward, right) {
        (Some(-1), Some(-2) | None) => Some(("backwards", 180)),
        (Some(2), Some(-1) | None) => Some(("to the left", -90)),
        (Some(-2), Some(1) | None) => Some(("to the right", 90)),
        _ => None,
    };
    if let Some((faces, yaw)) = yaw {
        let mend = axes.map_or("rotate imu.axes by that angle, or set".into(), |axes| {
            format!("set imu.axes = \"{axes}\" or")
        });
        return format!(
            "GNSS shows that the IMU faces {faces} (yaw {yaw}°): {mend} imu.mounting = \"auto\""
        );
    }
    let axis = |number| match number {
        1 => "forward",
        -1 => "backward",
        2 => "to the right",
        _ => "to the left",
    };
    let speeds_up = forward
        .filter(|number| *number != 1)
        .map(|number| format!("GNSS accelerates forward, the IMU {}", axis(number)));
    let turns = right.filter(|number| *number != 2).map(|number| {
        format!(
            "in turns GNSS is pushed to the right, the IMU {}",
            axis(number)
        )
    });
    let seen = speeds_up.or(turns).unwrap_or_default();
    // What no rotation of the IMU does is in the columns of the accelerometers.
    let reversed = " (one axis reversed: imu.accel_unit = \"g, -g, g\"; `undrift inspect` on the logs tries them)";
    let (wrong, mend) = match (forward, right) {
        (Some(2 | -2), Some(1 | -1)) => ("forward and right axes seem exchanged", ""),
        (Some(1), Some(-2)) => ("right axis seems to have the wrong sign", reversed),
        (Some(-1), Some(2)) => ("forward axis seems to have the wrong sign", reversed),
        _ => {
            return format!(
                "the IMU's axes are not the vehicle's ({seen}): check imu.axes and the order and signs of imu.accel"
            );
        }
    };
    format!("the accelerometer's {wrong} ({seen}): check the order and signs of imu.accel{mend}")
}
