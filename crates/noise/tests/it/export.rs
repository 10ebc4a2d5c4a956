//! Models in other programs' formats, against closed forms; `testdata/golden/formats/written/check.py`
//! reads the same texts with PyYAML.

mod formats;
mod simulated;
mod terms;

use std::path::PathBuf;
use undrift_noise::{ImuModel, ModelFormat};

/// Round numbers in the units of the formats, other ones on one axis.
const MODEL: &str = r#"
format = "undrift-imu"
version = 1
name = "Test: \"IMU\" # 1"
source = """two
lines"""
[gyro]
white_noise = "0.3 deg/sqrt(h)"
bias_instability = "9 deg/h"
correlation_time = "200 s"
[gyro_z]
white_noise = "0.6 deg/sqrt(h)"
turn_on = "12 deg/h"
[accel]
white_noise = "0.06 m/s/sqrt(h)"
random_walk = "1e-4 m/s^2/sqrt(s)"
"#;

fn model() -> ImuModel {
    ImuModel::from_toml(MODEL, "test").unwrap()
}

/// The numbers after a key or name, up to the end of the line or the comment.
fn numbers(text: &str, key: &str) -> Vec<f64> {
    let line = text
        .lines()
        .map(str::trim_start)
        .find(|line| !line.starts_with(['#', '%']) && line.contains(key))
        .unwrap_or_else(|| panic!("no {key} in\n{text}"));
    let (_, after) = line.split_once(key).unwrap();
    let after = after.split(['#', '%']).next().unwrap();
    after
        .split(|c: char| c.is_whitespace() || "[](),:'".contains(c))
        .filter_map(|word| word.parse().ok())
        .collect()
}

/// Nine digits are written.
fn close(ours: &[f64], expected: &[f64]) {
    assert_eq!(ours.len(), expected.len(), "{ours:?} {expected:?}");
    for (a, b) in ours.iter().zip(expected) {
        assert!((a - b).abs() <= 6e-9 * b.abs(), "{ours:?} {expected:?}");
    }
}

const DEG: f64 = std::f64::consts::PI / 180.0;

/// Root mean square of the gyros' white noise, 0.3, 0.3, 0.6 deg/√h [rad/√s].
fn gyro_white() -> f64 {
    0.3 * DEG / 60.0 * 2f64.sqrt()
}

#[test]
fn undrift_reads_back() {
    let text = model().export(ModelFormat::Undrift, None).unwrap();
    let back = ImuModel::from_toml(&text, "back").unwrap();
    assert_eq!(back.gyro[0], model().gyro[0]);
    // deg/h goes out as deg/s, in six digits.
    let (ours, theirs) = (back.gyro[2].turn_on, model().gyro[2].turn_on);
    assert!((ours - theirs).abs() < 5.1e-6 * theirs);
}

#[test]
fn what_is_missing_is_named() {
    let error = |text: &str, format, rate| {
        let head = "format = \"undrift-imu\"\nversion = 1\n";
        let model = ImuModel::from_toml(&format!("{head}{text}"), "some.toml").unwrap();
        model.export(format, rate).unwrap_err().to_string()
    };
    let white =
        "[gyro]\nwhite_noise = \"1 deg/sqrt(h)\"\n[accel]\nwhite_noise = \"1 m/s/sqrt(h)\"\n";
    let one = "[gyro_x]\nwhite_noise = \"1 deg/sqrt(h)\"\n";
    let lacking = error(white, ModelFormat::Kalibr, Some(100.0));
    assert!(
        lacking.starts_with("gyro_x: the kalibr model needs"),
        "{lacking}"
    );
    assert!(error(one, ModelFormat::KfGins, None).contains("gyro_y"));
    assert!(error(white, ModelFormat::Ros, None).contains("--rate HZ"));
    for rate in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(error(white, ModelFormat::Ros, Some(rate)).contains("invalid sample rate"));
    }
    // Anti-persistent noise has no bias that moves.
    let error = terms::with_arma("[]", "[0.5]")
        .export(ModelFormat::Kalibr, None)
        .unwrap_err();
    assert!(error.to_string().contains("gyro_x"));
    for format in ModelFormat::ALL {
        assert_eq!(format.name().parse(), Ok(format));
    }
    assert!("kalibre".parse::<ModelFormat>().is_err());
}

fn golden(format: ModelFormat) -> PathBuf {
    let name = match format {
        ModelFormat::Kalibr => "imu.kalibr.yaml",
        ModelFormat::KfGins => "imu.kf-gins.yaml",
        ModelFormat::Ros => "imu.ros.yaml",
        ModelFormat::Px4 => "imu.px4.params",
        ModelFormat::Matlab => "imu.m",
        ModelFormat::Vins => "imu.vins.yaml",
        ModelFormat::OpenVins => "imu.openvins.yaml",
        ModelFormat::Basalt => "imu.basalt.json",
        ModelFormat::Gtsam => "imu.gtsam.py",
        ModelFormat::ArduPilot => "imu.ardupilot.param",
        ModelFormat::Gazebo => "imu.gazebo.sdf",
        ModelFormat::Undrift => "imu.toml",
    };
    let folder = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../testdata/golden/formats/written"
    );
    PathBuf::from(folder).join(name)
}

/// The texts that `check.py` has read. `UNDRIFT_BLESS=1` writes them; then run `check.py`.
#[test]
fn equal_to_what_was_checked() {
    for format in ModelFormat::ALL {
        let text = model().export(format, Some(100.0)).unwrap();
        if std::env::var_os("UNDRIFT_BLESS").is_some() {
            std::fs::write(golden(format), &text).unwrap();
        }
        let checked = std::fs::read_to_string(golden(format)).unwrap();
        assert_eq!(text, checked, "{}", format.name());
    }
}
