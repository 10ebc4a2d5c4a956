//! The `model` command.

use std::process::{Command, Output};

fn model(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_undrift"))
        .arg("model")
        .args(arguments)
        .output()
        .unwrap()
}

#[test]
fn a_preset_goes_to_standard_output_or_a_file() {
    let output = model(&["adis16465", "--to", "kalibr", "--rate", "200"]);
    assert!(output.status.success(), "{output:?}");
    let text = String::from_utf8(output.stdout).unwrap();
    // 0.15 deg/√h.
    assert!(
        text.contains("gyroscope_noise_density: 4.36332313e-5"),
        "{text}"
    );
    assert!(text.ends_with("update_rate: 200.0\n"));
    let path = std::env::temp_dir().join(format!("undrift-model-{}.yaml", std::process::id()));
    let file = path.to_str().unwrap();
    let output = model(&["adis16465", "--to", "kalibr", "--rate", "200", "-o", file]);
    assert!(output.status.success() && output.stdout.is_empty());
    assert_eq!(std::fs::read_to_string(&path).unwrap(), text);
    std::fs::remove_file(path).unwrap();
}

#[test]
fn the_presets_are_listed_in_80_columns() {
    let output = model(&["--list"]);
    assert!(output.status.success(), "{output:?}");
    let text = String::from_utf8(output.stdout).unwrap();
    for line in text.lines() {
        assert!(line.chars().count() <= 80, "{line}");
    }
    let (table, _) = text.split_once("\n\n").unwrap();
    let rows: Vec<_> = table
        .lines()
        .map(|line| line.split_whitespace().collect::<Vec<_>>())
        .collect();
    let names: Vec<_> = rows.iter().skip(2).map(|row| row[0]).collect();
    assert_eq!(names, undrift::ImuModel::preset_names());
    // 0.15 deg/√h, 2 deg/h, 0.4 deg/s; 0.012 m/s/√h is 0.012/60/9.80665 = 20.39 µg/√Hz; 3.6 µg, 1.4 mg.
    let row = "adis16465 Analog Devices ADIS16465-1 0.15 2 0.4 20.4 0.0036 1.4";
    assert!(rows.iter().any(|cells| cells.join(" ") == row), "{table}");
    // The largest of the axes: 80 mg is that of z.
    assert!(
        rows.iter()
            .any(|cells| cells[0] == "mpu6050" && cells.last() == Some(&"80")),
        "{table}"
    );
}

#[test]
fn the_presets_come_as_json_too() {
    let output = model(&["--list", "--json", "-"]);
    assert!(output.status.success(), "{output:?}");
    let all: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(
        all.as_object().unwrap().len(),
        undrift::ImuModel::preset_names().len()
    );
    let one = model(&["icm20602", "--json", "-"]);
    let one: serde_json::Value = serde_json::from_slice(&one.stdout).unwrap();
    assert_eq!(all["icm20602"], one);
}

#[test]
fn what_is_wrong_is_said() {
    for (arguments, part) in [
        (&["adis16465", "--to", "kalibr"][..], "--rate HZ"),
        (
            &["adis16465", "--to", "kalibre"],
            "available: kalibr, kf-gins",
        ),
        (
            &["nothing.toml", "--to", "ros"],
            "a file or a preset; `undrift model --list`",
        ),
        (&["ADIS-16465", "--to", "ros"], "did you mean adis16465?"),
        (&["--list", "adis16465"], "cannot be used with"),
        (&["--list", "--to", "ros"], "cannot be used with"),
        (&[], "IMU.toml"),
        (&["adis16465", "--to", "ros", "--rate", "0"], "sample rate"),
    ] {
        let output = model(arguments);
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!output.status.success() && text.contains(part), "{text}");
    }
}
