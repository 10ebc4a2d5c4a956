//! `identify` of what is no static recording, or not in the units stated.

use std::{
    path::{Path, PathBuf},
    process::{Command, Output},
};
use undrift::{
    nav::shaping::ShapingFilter,
    noise::{ImuModel, synthesis::NoiseGenerator},
};

fn folder(name: &str) -> PathBuf {
    let folder =
        std::env::temp_dir().join(format!("undrift-recordings-{}-{name}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

fn identify(folder: &Path, arguments: &[&str]) -> (Output, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_undrift"))
        .current_dir(folder)
        .arg("identify")
        .args(arguments)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!said.contains("panicked"), "{said}");
    (output, said)
}

/// A minute at 100 Hz in deg/s and g, white noise by seeds 1 to 6, each number made of `of` axis, time and number.
fn write(folder: &Path, header: &str, of: impl Fn(usize, f64, f64) -> f64) {
    let white =
        |density, seed| NoiseGenerator::new(&ShapingFilter::white(density, 0.01).unwrap(), seed);
    let mut axes: Vec<_> = (0..6)
        .map(|k| white(if k < 3 { 0.01 } else { 1e-3 }, k + 1))
        .collect();
    let mut text = format!("{header}\n");
    for k in 0..6000 {
        let time = f64::from(k) / 100.0;
        let row = axes.iter_mut().enumerate().map(|(axis, noise)| {
            let still = noise.sample()
                + if axis == 5 {
                    -1.0
                } else {
                    0.2 * f64::from(axis < 3)
                };
            format!("{:.6}", of(axis, time, still))
        });
        text += &format!("{time:.2},{}\n", row.collect::<Vec<_>>().join(","));
    }
    std::fs::write(folder.join("record.csv"), text).unwrap();
}

const HEADER: &str = "t_s,gx_dps,gy_dps,gz_dps,ax_g,ay_g,az_g";

fn refused(folder: &Path, arguments: &[&str], expected: &[&str]) {
    let arguments = [&["record.csv", "-o", "none.toml"], arguments].concat();
    let (output, said) = identify(folder, &arguments);
    assert_eq!(output.status.code(), Some(1), "{said}");
    for part in expected.iter().chain(&["record.csv: ", "--force"]) {
        assert!(said.contains(part), "{part}: {said}");
    }
    assert!(!folder.join("none.toml").exists());
}

#[test]
fn a_log_that_moves() {
    let folder = folder("moves");
    // Turns and brakes from 25 s on, the larger part.
    write(&folder, HEADER, |axis, t, still| match axis {
        2 if t > 25.0 => still + 15.0 * (t / 2.0).sin(),
        3 if t > 25.0 => still + 0.2 * (t / 3.0).cos(),
        _ => still,
    });
    // A window of a second less at the end of the rest.
    refused(&folder, &[], &["the IMU moves in", "--span 0,24"]);
    // What it says is an option.
    let (output, said) = identify(
        &folder,
        &["record.csv", "--span", "0,24", "-o", "rest.toml"],
    );
    assert!(
        output.status.success() && said.contains("turn-on"),
        "{said}"
    );
    let model = ImuModel::load(&folder.join("rest.toml")).unwrap();
    assert_eq!(model.provenance.samples, Some(2400));
    assert!(model.provenance.record.unwrap().contains("0 to 24 s"));
    // Forced, the model says so, and nobody takes it for a good one.
    let forced = ["record.csv", "--force", "--strict", "-o", "imu.toml"];
    let (output, said) = identify(&folder, &forced);
    assert_eq!(output.status.code(), Some(3), "{said}");
    let source = ImuModel::load(&folder.join("imu.toml")).unwrap().source;
    assert!(
        source.contains("--force although the IMU moves"),
        "{source}"
    );
}

#[test]
fn a_specific_force_that_is_not_gravity() {
    let folder = folder("gravity");
    write(&folder, HEADER, |_, _, still| still);
    refused(
        &folder,
        &["--units", "deg/s,m/s^2"],
        &["not 9.81", "--units \"deg/s,g\""],
    );
    write(&folder, HEADER, |axis, _, still| {
        if axis > 2 {
            (still * 16384.0).round()
        } else {
            still
        }
    });
    refused(&folder, &[], &["--units \"deg/s,LSB/16384 g\""]);
    let mended = ["record.csv", "--units", "deg/s,LSB/16384 g"];
    assert!(identify(&folder, &mended).0.status.success());
    write(
        &folder,
        HEADER,
        |axis, _, still| {
            if axis == 5 { still + 1.0 } else { still }
        },
    );
    refused(&folder, &[], &["gravity was removed"]);
    // The gyros alone have none.
    let gyro = ["record.csv", "--columns", "gz_dps"];
    assert!(identify(&folder, &gyro).0.status.success());
}

#[test]
fn raw_counts_called_degrees_a_second() {
    let folder = folder("counts");
    write(&folder, HEADER, |axis, _, still| {
        if axis < 3 {
            (still * 131.0).round()
        } else {
            still
        }
    });
    refused(&folder, &[], &["raw counts", "--units \"LSB/131 deg/s,g\""]);
    let mended = ["record.csv", "--units", "mpu6050/250dps,g"];
    assert!(identify(&folder, &mended).0.status.success());
    write(&folder, HEADER, |axis, _, still| {
        if axis == 1 { still + 57.0 } else { still }
    });
    refused(
        &folder,
        &[],
        &["gyro_y reads 57.2 deg/s", "unit of the gyros"],
    );
}

#[test]
fn a_drive_file_or_a_guess_says_what_the_columns_are() {
    let folder = folder("drive");
    // Without names: time, accelerometers [m/s²], gyros [rad/s].
    write(&folder, "t,fx,fy,fz,wx,wy,wz", |_, _, still| still);
    let text = std::fs::read_to_string(folder.join("record.csv")).unwrap();
    let turned = text.lines().skip(1).map(|line| {
        let n: Vec<f64> = line.split(',').map(|n| n.parse().unwrap()).collect();
        let (g, deg) = (9.80665, 1f64.to_radians());
        format!(
            "{:.2},{},{},{},{},{},{}\n",
            n[0],
            n[4] * g,
            n[5] * g,
            n[6] * g,
            n[1] * deg,
            n[2] * deg,
            n[3] * deg
        )
    });
    std::fs::write(folder.join("record.csv"), turned.collect::<String>()).unwrap();
    let drive = "[imu]\nfile = \"record.csv\"\ntime = 1\ngyro = [5, 6, 7]\ngyro_unit = \"rad/s\"\naccel = [2, 3, 4]\naccel_unit = \"m/s^2\"\n";
    std::fs::write(folder.join("drive.toml"), drive).unwrap();
    let (output, said) = identify(&folder, &["drive.toml", "-o", "drive-imu.toml"]);
    assert!(output.status.success(), "{said}");
    let (output, guessed) = identify(&folder, &["record.csv", "-o", "imu.toml"]);
    assert!(output.status.success(), "{guessed}");
    assert!(
        guessed
            .contains("guessed from the values: --columns \"5,6,7,2,3,4\" --units \"rad/s,m/s^2\""),
        "{guessed}"
    );
    let white = |name: &str| {
        let model = ImuModel::load(&folder.join(name)).unwrap();
        model.axes().map(|(_, axis)| axis.white_density())
    };
    for (drive, guess) in white("drive-imu.toml").into_iter().zip(white("imu.toml")) {
        // Rounded to six digits; the rate by the same stamps.
        assert!((drive / guess - 1.0).abs() < 1e-4, "{drive} {guess}");
    }
    let (_, said) = identify(&folder, &["drive.toml", "--units", "deg/s,g"]);
    assert!(said.contains("--units is for a log"), "{said}");
}
