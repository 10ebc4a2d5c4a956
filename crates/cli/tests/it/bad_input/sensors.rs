//! An IMU that is wrong: units, axes, frozen, saturated and silent sensors.

use super::drives::{good, is_sound};
use super::log::{Log, says};

const GYRO: [usize; 3] = [1, 2, 3];
const ACCEL: [usize; 3] = [4, 5, 6];

/// The town drive with some columns of the IMU multiplied.
fn times(columns: &[usize], factor: f64) -> Log {
    let mut log = good();
    for row in &mut log.imu {
        for &column in columns {
            row.put(column, &[row.number(column) * factor]);
        }
    }
    log
}

/// The town drive with the values of each row of the IMU changed: gyro x, y, z, accelerometer x, y, z.
fn changed(change: impl Fn(f64, [f64; 6]) -> [f64; 6]) -> Log {
    let mut log = good();
    for row in &mut log.imu {
        let values = std::array::from_fn(|k| row.number(k + 1));
        let changed = change(row.time, values);
        row.put(1, &changed);
    }
    log
}

#[test]
fn gyro_in_degrees_called_radians() {
    let case = times(&GYRO, 180.0 / std::f64::consts::PI).write("gyro_deg");
    says(
        &case.refusal(),
        &[
            "could not be aligned",
            "the GNSS course turns at 0.017",
            "imu.gyro_unit (the numbers look like deg/s)",
        ],
    );
}

#[test]
fn gyro_in_radians_called_degrees() {
    let mut log = good();
    log.set("\"rad/s\"", "\"deg/s\"");
    let case = log.write("gyro_rad");
    case.doubted(&[
        "the GNSS course turns at 57",
        "imu.gyro_unit (the numbers look like rad/s)",
    ]);
}

#[test]
fn gyro_in_millidegrees_called_radians() {
    let message = times(&GYRO, 180e3 / std::f64::consts::PI)
        .write("gyro_mdps")
        .refusal();
    says(
        &message,
        &[
            "could not be aligned",
            "check axes, units",
            "check imu.gyro_unit",
        ],
    );
}

#[test]
fn accelerometer_in_g_called_metres() {
    let parts = [
        "the accelerometers measure 0.1",
        "imu.accel_unit (the numbers look like g)",
    ];
    let warnings = times(&ACCEL, 1.0 / 9.80665)
        .write("accel_g")
        .distrusted(3, &parts);
    // With a wrong unit the innovations say nothing of the receiver.
    assert!(
        !warnings.iter().any(|w| w.contains("std_factor")),
        "{warnings:?}"
    );
}

#[test]
fn accelerometer_in_metres_called_g() {
    let mut log = good();
    log.set("\"m/s^2\"", "\"g\"");
    log.write("accel_mps2").doubted(&[
        "the accelerometers measure 9.",
        "imu.accel_unit (the numbers look like m/s^2)",
    ]);
}

#[test]
fn accelerometer_in_mg_called_metres() {
    times(&ACCEL, 1000.0 / 9.80665).write("accel_mg").doubted(&[
        "the accelerometers measure 10",
        "imu.accel_unit (the numbers look like mg",
    ]);
}

#[test]
fn gyros_and_accelerometers_swapped() {
    let case = changed(|_, [a, b, c, d, e, f]| [d, e, f, a, b, c]).write("groups");
    says(
        &case.refusal(),
        &[
            "could not be aligned",
            "the gyros measure gravity, and the accelerometers do not: exchange the columns of imu.gyro and imu.accel",
        ],
    );
}

#[test]
fn columns_of_the_accelerometers_swapped() {
    changed(|_, [a, b, c, d, e, f]| [a, b, c, e, d, f])
        .write("accel_xy")
        .doubted(&[
            "the accelerometer's forward and right axes seem exchanged",
            "order and signs of imu.accel",
        ]);
}

#[test]
fn columns_of_the_gyros_swapped() {
    changed(|_, [a, b, c, d, e, f]| [c, b, a, d, e, f])
        .write("gyro_xz")
        .doubted(&["show in the gyro about body forward", "order of imu.gyro"]);
    changed(|_, [a, b, c, d, e, f]| [a, c, b, d, e, f])
        .write("gyro_yz")
        .doubted(&["show in the gyro about body right", "order of imu.gyro"]);
}

#[test]
fn left_handed_axes() {
    times(&[2, 5], -1.0).write("left_handed").doubted(&[
        "the accelerometer's right axis seems to have the wrong sign",
        "order and signs of imu.accel",
    ]);
}

#[test]
fn mounted_backwards() {
    times(&[1, 2, 4, 5], -1.0)
        .write("backwards")
        .doubted(&["the IMU faces backwards (yaw 180°)", "imu.axes"]);
}

#[test]
fn mounted_a_quarter_turn_to_the_right() {
    changed(|_, [a, b, c, d, e, f]| [b, -a, c, e, -d, f])
        .write("quarter")
        .doubted(&["the IMU faces to the right (yaw 90°)", "imu.axes"]);
}

#[test]
fn mounted_upside_down() {
    let (outcome, _) = times(&[2, 3, 5, 6], -1.0).write("upside").solution();
    says(
        &outcome.stderr,
        &[
            "the IMU seems to be upside down",
            "check the signs in imu.axes",
        ],
    );
    // The solution is that of the axes as given, and sound but for that.
    assert!(outcome.rms("horizontal_m") < 0.5 && outcome.rms("roll_deg") > 179.0);
}

#[test]
fn gravity_with_the_wrong_sign() {
    times(&ACCEL, -1.0)
        .write("gravity_sign")
        .doubted(&["the IMU seems to be upside down", "the signs in imu.axes"]);
    times(&[6], -1.0)
        .write("accel_z_sign")
        .doubted(&["the IMU seems to be upside down", "the signs in imu.axes"]);
}

#[test]
fn gyros_with_the_wrong_sign() {
    for (name, columns) in [("gyro_sign", &GYRO[..]), ("gyro_z_sign", &[3])] {
        times(columns, -1.0).write(name).doubted(&[
            "the GNSS course turns at -0.99",
            "of the gyros (one axis reversed: imu.gyro_unit",
        ]);
    }
}

#[test]
fn a_gyro_that_is_silent() {
    let warnings = times(&[3], 0.0)
        .write("gyro_z_silent")
        .doubted(&["gyro z is constant (0) in all 14000 samples: check imu.gyro"]);
    says(
        &warnings.join("\n"),
        &["the gyros do not measure the turns of the GNSS course"],
    );
}

#[test]
fn all_sensors_silent() {
    let (outcome, _) = times(&[1, 2, 3, 4, 5, 6], 0.0).write("silent").navigate();
    let verdict = outcome.stdout.lines().next().unwrap_or_default();
    assert!(
        !verdict.starts_with("usable:") && verdict.contains(": the accelerometers measure 0 times"),
        "{verdict}"
    );
    says(
        &outcome.stderr,
        &[
            "all six IMU axes repeat the same values",
            "measure 0 times gravity",
        ],
    );
}

#[test]
fn one_axis_of_nan() {
    let mut log = good();
    for row in &mut log.imu {
        row.fields[2] = "NaN".into();
    }
    let message = log.write("nan_axis").refusal();
    says(
        &message,
        &[
            "imu.csv: column \"gy\" (key imu.gyro) is NaN or infinite in all 14000 rows",
            "choose another column",
        ],
    );
}

#[test]
fn one_axis_of_nan_for_a_while() {
    let mut log = good();
    for row in log
        .imu
        .iter_mut()
        .filter(|row| (45.0..47.0).contains(&row.time))
    {
        row.fields[5] = "nan".into();
    }
    let (outcome, nav) = log.write("nan_while").solution();
    says(
        &outcome.stderr,
        &[
            "IMU log: 200 rows with NaN or infinity",
            "no samples for 2.0 s from 44.99 s",
        ],
    );
    // Two seconds unseen at 2 m/s².
    assert!(nav.at(47.0, "yaw_std_deg") > 5.0);
    assert!(outcome.rms("horizontal_m") < 1.0);
}

/// Repeats the values of the row at `from` until `to` [s] in some columns.
fn frozen(columns: &[usize], from: f64, to: f64) -> Log {
    let mut log = good();
    let first = log.imu_at(from);
    let row = log.imu[first].clone();
    for other in log.imu[first..].iter_mut().take_while(|row| row.time < to) {
        for &column in columns {
            other.fields[column].clone_from(&row.fields[column]);
        }
    }
    log
}

#[test]
fn a_frozen_gyro() {
    frozen(&[3], 60.0, 80.0).write("frozen_gyro").doubted(&[
        "gyro z stays at",
        "for 19.9",
        "s from 60",
        "(2000 samples)",
        "frozen",
    ]);
}

#[test]
fn a_frozen_accelerometer() {
    let (outcome, _) = frozen(&[4], 20.0, 24.0).write("frozen_accel").solution();
    says(
        &outcome.stderr,
        &["accelerometer x stays at", "for 3.99 s from 20 s", "frozen"],
    );
}

#[test]
fn a_frozen_imu() {
    frozen(&[1, 2, 3, 4, 5, 6], 60.0, 80.0)
        .write("frozen_imu")
        .doubted(&["all six IMU axes repeat the same values for 19.9", "frozen"]);
}

#[test]
fn a_saturated_gyro() {
    // Turns are at 0.3 rad/s.
    changed(|_, [a, b, c, d, e, f]| [a, b, c.clamp(-0.2, 0.2), d, e, f])
        .write("saturated")
        .doubted(&[
            "gyro z stays at 0.2 (as logged) for",
            "the sensor is saturated",
        ]);
}

#[test]
fn a_saturated_accelerometer() {
    // Turns push at 3.6 m/s².
    let log = changed(|_, [a, b, c, d, e, f]| [a, b, c, d, e.clamp(-2.0, 2.0), f]);
    let warnings = log
        .write("saturated_accel")
        .doubted(&["the sensor is saturated"]);
    says(
        &warnings.join("\n"),
        &["accelerometer y stays at ", "2 (as logged) for"],
    );
}

#[test]
fn coarse_rounding() {
    let round = |value: f64, step: f64| (value / step).round() * step;
    // A hundredth of g, and 0.06 deg/s: the steps of a sensor at its largest range.
    let log =
        changed(|_, v| std::array::from_fn(|k| round(v[k], if k < 3 { 0.001 } else { 0.01 })));
    let (outcome, _) = log.write("rounded").solution();
    is_sound(&outcome);
    // So coarse that slow axes read zero: said, and the solution is still as good as the fixes.
    let log = changed(|_, v| std::array::from_fn(|k| round(v[k], if k < 3 { 0.02 } else { 0.04 })));
    let (outcome, _) = log.write("rounded_to_zero").solution();
    says(
        &outcome.stderr,
        &[
            "gyro x is constant (0) in all 14000 samples",
            "faulty or too coarse",
        ],
    );
    is_sound(&outcome);
}
