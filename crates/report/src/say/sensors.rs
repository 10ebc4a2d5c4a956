//! Sentences: what the inertial sensors show.

use super::words::{at, many};
use crate::numbers::short;

pub(super) fn frozen(start: f64, length: f64, samples: u64) -> String {
    format!(
        "all six axes of the IMU repeat their values for {length:.2} s from {} s ({samples} samples): the log or the sensor is frozen",
        at(start)
    )
}

/// An axis (0 to 2 gyros, 3 to 5 accelerometers) that holds its value from a start for a length \[s\].
pub(super) fn held(
    axis: usize,
    value: f64,
    [start, length]: [f64; 2],
    samples: u64,
    saturated: bool,
) -> String {
    format!(
        "{} reads {value} for {length:.2} s from {} s ({samples} samples), {}",
        name(axis),
        at(start),
        if saturated {
            "its largest or smallest value: the sensor is saturated or too coarse"
        } else {
            "and nothing else: the sensor is frozen, not connected or too coarse"
        }
    )
}

pub(super) fn wrong_gravity(ratio: f64) -> String {
    format!(
        "the accelerometers measure {} times gravity on average: check {}",
        // A sensor without noise.
        if ratio < 1e-6 {
            "0".into()
        } else {
            short(ratio)
        },
        match ratio {
            0.09..0.115 => "imu.accel_unit, the numbers look like g",
            8.5..11.5 => "imu.accel_unit, the numbers look like m/s^2",
            90.0..115.0 => "imu.accel_unit, the numbers look like mg or cm/s^2",
            _ => "imu.accel, imu.accel_unit and imu.data",
        }
    )
}

pub(super) fn not_down(down: [f64; 3]) -> String {
    format!(
        "gravity points along {:.2}, {:.2}, {:.2} of the body axes, which should be forward, right, down: check imu.axes and the order and signs of imu.accel; the attitude is that of the axes as given",
        down[0], down[1], down[2]
    )
}

pub(super) fn wrong_turn_rate(ratio: f64) -> String {
    format!(
        "the GNSS course turns {} times as fast as the gyros measure: check {}",
        short(ratio),
        match ratio {
            -1.7..-0.6 => "the signs of imu.gyro and imu.axes",
            0.01..0.03 => "imu.gyro_unit, the numbers look like deg/s",
            34.0..97.0 => "imu.gyro_unit, the numbers look like rad/s",
            0.0006..0.0017 => "imu.gyro_unit, the numbers are a thousand times too large",
            _ => "imu.gyro_unit and imu.axes",
        }
    )
}

pub(super) fn wrong_turn_axis(axis: usize) -> String {
    format!(
        "the turns of the GNSS course show in the gyro about body {}, not in the vertical one: check the order of imu.gyro, and imu.axes",
        ["forward", "right", "down"].get(axis).unwrap_or(&"")
    )
}

pub(super) const NO_TURNS: &str = "the gyros do not measure the turns of the GNSS course: check imu.gyro, and the times of both logs (gnss.time_offset)";

pub(super) fn late(delay: f64) -> String {
    format!(
        "the gyros measure the turns of the GNSS course {:.2} s {} than its stamps: set gnss.time_offset = \"{delay:.2} s\" more than it is{}",
        delay.abs(),
        if delay < 0.0 { "earlier" } else { "later" },
        if (delay.abs() - LEAP_SECONDS).abs() < 0.5 {
            "; GPS time and UTC are mixed"
        } else {
            ""
        }
    )
}

pub(super) fn spikes(axis: usize, samples: u64, start: f64) -> String {
    format!(
        "replaced {} of {} that cannot be right, the first at {} s",
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
        "the course contradicts the heading by up to {:.1} deg, {}-{} s{more}: the bias or the scale of the vertical gyro changed, or the IMU was turned; the heading's standard deviation covers it",
        angle.to_degrees().abs(),
        at(start),
        at(end)
    )
}

pub(super) fn optimistic_model(factor: f64) -> String {
    format!(
        "the innovations are {factor:.1} times as large as predicted although the fixes agree with each other: the noise model of the IMU is too small for this vehicle (`undrift tune` finds the right one), or the lever arm or the axes are wrong"
    )
}

pub(super) fn optimistic_drift(model: &str, inside: f64) -> String {
    format!(
        "only {:.0} % of the position errors in the outages lie inside three predicted standard deviations, by model {model}, which covers most: the noise is too small for this vehicle (`undrift tune` finds the right one), or the lever arm, the axes or the mounting are wrong",
        100.0 * inside
    )
}

pub(super) fn far_parameter(parameter: &str, value: f64, sigmas: f64) -> String {
    format!(
        "the estimated {parameter} of {} is {sigmas:.0} standard deviations from what was known of it: check what it stands for",
        short(value)
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
        let mend = axes.map_or("turn imu.axes by that".into(), |axes| {
            format!("set imu.axes = \"{axes}\"")
        });
        return format!(
            "GNSS shows that the IMU faces {faces} (yaw {yaw}°): {mend} or imu.mounting = \"auto\""
        );
    }
    let axis = |number| match number {
        1 => "forward",
        -1 => "backward",
        2 => "right",
        _ => "left",
    };
    let speeds_up = forward.filter(|number| *number != 1).map(|number| {
        format!(
            "it accelerates along body {} instead of forward",
            axis(number)
        )
    });
    let turns = right.filter(|number| *number != 2).map(|number| {
        format!(
            "it is pushed along body {} instead of right in turns to the right",
            axis(number)
        )
    });
    let seen: Vec<String> = speeds_up.into_iter().chain(turns).collect();
    format!(
        "GNSS shows that the IMU's axes are not the vehicle's: {}; check imu.axes and the order and signs of imu.accel and imu.gyro",
        seen.join(", and ")
    )
}
