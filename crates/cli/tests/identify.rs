//! The `identify` command on small records: what it writes, and what it says of records that are none.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use undrift::{
    nav::shaping::ShapingFilter,
    noise::{BiasModel, ImuModel, synthesis::NoiseGenerator},
};

fn folder(name: &str) -> PathBuf {
    let folder =
        std::env::temp_dir().join(format!("undrift-identify-{}-{name}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

fn identify(folder: &Path, record: &str, arguments: &[&str]) -> Output {
    std::fs::write(folder.join("record.csv"), record).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_undrift"))
        .current_dir(folder)
        .args(["identify", "record.csv"])
        .args(arguments)
        .output()
        .unwrap();
    assert!(
        !String::from_utf8_lossy(&output.stderr).contains("panicked"),
        "{output:?}"
    );
    output
}

/// A record of `samples` rows with white noise on every axis, z at −g.
fn record(header: &str, samples: usize) -> String {
    let white =
        |density, seed| NoiseGenerator::new(&ShapingFilter::white(density, 0.01).unwrap(), seed);
    let mut axes = [
        white(0.03, 1),
        white(0.03, 2),
        white(0.03, 3),
        white(1e-3, 4),
        white(1e-3, 5),
        white(1e-3, 6),
    ];
    let mut text = format!("{header}\n");
    for _ in 0..samples {
        let mut row: Vec<f64> = axes.iter_mut().map(NoiseGenerator::sample).collect();
        row[5] -= 1.0;
        let fields: Vec<String> = row.iter().map(|x| format!("{x:.6}")).collect();
        text += &fields.join(",");
        text.push('\n');
    }
    text
}

const HEADER: &str = "gx_dps,gy_dps,gz_dps,ax_g,ay_g,az_g";

#[test]
fn a_record_becomes_a_model_that_makes_filters() {
    let folder = folder("model");
    let arguments = [
        "--rate",
        "100",
        "--n-max",
        "1",
        "-o",
        "imu.toml",
        "--json",
        "found.json",
    ];
    let output = identify(&folder, &record(HEADER, 6000), &arguments);
    assert!(output.status.success(), "{output:?}");
    let model = ImuModel::load(&folder.join("imu.toml")).unwrap();
    assert_eq!(model.provenance.samples, Some(6000));
    assert_eq!(model.provenance.sha256.as_ref().map(String::len), Some(64));
    for (_, axis) in model.axes() {
        axis.shaping(BiasModel::Arma, 0.005).unwrap();
    }
    // 0.03 deg/s/√Hz; 6000 samples give it to 1 %, the fit over τ to some percent.
    let density = model.gyro[0].white_density().to_degrees();
    assert!((density / 0.03 - 1.0).abs() < 0.1, "{density}");
    let text = std::fs::read_to_string(folder.join("found.json")).unwrap();
    let found: serde_json::Value = serde_json::from_str(&text).unwrap();
    let axis = &found["axes"]["gyro_x"];
    for key in [
        "adf",
        "kpss",
        "phillips_perron",
        "jarque_bera",
        "ks",
        "lilliefors",
        "allan",
        "allan_terms",
        "pandit_wu",
        "candidates",
        "chosen",
    ] {
        assert!(!axis[key].is_null(), "{key}");
    }
    assert!(axis["candidates"][0]["drift_score"]["1"].is_number());
    assert_eq!(axis["samples"], 6000);
}

#[test]
fn one_axis_needs_a_base_for_the_model() {
    let folder = folder("one");
    let text = record(HEADER, 3000);
    let one = [
        "--rate",
        "100",
        "--columns",
        "gz_dps",
        "--n-max",
        "1",
        "-o",
        "imu.toml",
    ];
    let output = identify(&folder, &text, &one);
    assert!(!output.status.success());
    assert!(
        String::from_utf8_lossy(&output.stderr).contains("--base"),
        "{output:?}"
    );
    let output = identify(&folder, &text, &[&one[..], &["--base", "mpu6050"]].concat());
    assert!(output.status.success(), "{output:?}");
    let model = ImuModel::load(&folder.join("imu.toml")).unwrap();
    assert!(
        model.gyro[2].identification.contains_key("drift_scores")
            && model.gyro[0].identification.is_empty()
    );
}

#[test]
fn what_is_no_record_is_said() {
    let folder = folder("bad");
    let says = |text: &str, arguments: &[&str], expected: &str| {
        let output = identify(&folder, text, arguments);
        assert!(!output.status.success(), "{expected}: {output:?}");
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(error.contains(expected), "{expected}: {error}");
    };
    says(&record(HEADER, 2), &["--rate", "100"], "too short");
    let constant = format!("{HEADER}\n{}", "1,1,1,0,0,-1\n".repeat(2000));
    says(&constant, &["--rate", "100"], "constant");
    let nothing = format!("{HEADER}\n{}", "nan,nan,nan,nan,nan,nan\n".repeat(2000));
    says(&nothing, &[], "NaN");
    says(&record("a,b,c,d,e,f", 2000), &[], "--columns");
    says(&record("gx,gy,gz,ax,ay,az", 2000), &[], "--units");
    says(&record(HEADER, 2000), &["--units", "deg,g"], "angular rate");
    says(
        &record(HEADER, 2000),
        &["--columns", "gx_dps,gy_dps"],
        "2 columns",
    );
    says(
        &record(HEADER, 2000),
        &[
            "--columns",
            "nothing",
            "--axis",
            "gyro_x",
            "--units",
            "deg/s",
        ],
        "nothing",
    );
    says(&record(HEADER, 2000), &["--rate", "0"], "0 Hz");
    says(&record(HEADER, 2000), &[], "--rate");
    let stamped: String = record(HEADER, 2000)
        .lines()
        .enumerate()
        .map(|(k, line)| match k {
            0 => format!("t_s,{line}\n"),
            _ => format!("{:.3},{line}\n", k as f64 * 0.02),
        })
        .collect();
    says(&stamped, &["--rate", "100"], "time stamps say 50");
}
