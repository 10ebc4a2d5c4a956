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
fn what_is_wrong_is_said() {
    for (arguments, part) in [
        (&["adis16465", "--to", "kalibr"][..], "--rate HZ"),
        (
            &["adis16465", "--to", "kalibre"],
            "there are kalibr, kf-gins",
        ),
        (&["nothing.toml", "--to", "ros"], "one of the presets"),
        (&["adis16465", "--to", "ros", "--rate", "0"], "sample rate"),
    ] {
        let output = model(arguments);
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!output.status.success() && text.contains(part), "{text}");
    }
}
