//! The same again: results are the same to the bit, from run to run and on any number of threads.

use super::log::{Case, Log};
use std::fmt::Write as _;
use std::process::Command;
use undrift::{
    nav::shaping::ShapingFilter,
    noise::{BiasModel, ImuModel, synthesis::NoiseGenerator},
};

/// A record of a sensor at rest, 50 Hz: coloured noise on every axis, gyros in rad/s, z at −g.
pub fn static_record(samples: usize) -> String {
    let model = ImuModel::preset("adis16405").unwrap();
    let filters: [ShapingFilter; 6] = model.shaping(BiasModel::GaussMarkov, 0.02).unwrap();
    let mut axes: Vec<NoiseGenerator> = (0u64..)
        .zip(&filters)
        .map(|(seed, filter)| NoiseGenerator::new(filter, seed))
        .collect();
    let mut text = String::from("gx_radps,gy_radps,gz_radps,ax_mps2,ay_mps2,az_mps2\n");
    for _ in 0..samples {
        for (axis, noise) in axes.iter_mut().enumerate() {
            let gravity = if axis == 5 { -9.81 } else { 0.0 };
            let end = if axis == 5 { '\n' } else { ',' };
            let _ = write!(text, "{:.9}{end}", noise.sample() + gravity);
        }
    }
    text
}

/// Runs the command on each number of threads; all files must be the same, byte by byte.
fn same(case: &Case, arguments: &[&str], files: &[&str]) {
    let mut first: Option<Vec<Vec<u8>>> = None;
    // Twice on one, then on two, and on more than there are models or axes to share.
    for threads in ["1", "1", "2", "7"] {
        let output = Command::new(env!("CARGO_BIN_EXE_undrift"))
            .args(arguments)
            .current_dir(case.path(""))
            .env("RAYON_NUM_THREADS", threads)
            .output()
            .unwrap();
        assert!(output.status.success(), "{output:?}");
        let mut found = vec![output.stdout];
        for name in files {
            found.push(std::fs::read(case.path(name)).unwrap());
            std::fs::remove_file(case.path(name)).unwrap();
        }
        let first = first.get_or_insert_with(|| found.clone());
        for (k, (now, before)) in found.iter().zip(first).enumerate() {
            assert!(
                now == before,
                "{arguments:?} on {threads} threads: {} differs",
                k.checked_sub(1).map_or("standard output", |k| files[k])
            );
        }
    }
}

#[test]
fn navigate() {
    let case = Log::good().write("same_navigate");
    let arguments = [
        "navigate",
        "drive.toml",
        "-o",
        "nav.csv",
        "--json",
        "nav.json",
        "--report",
        "nav.html",
    ];
    same(&case, &arguments, &["nav.csv", "nav.json", "nav.html"]);
    let arguments = ["navigate", "drive.toml", "--smooth", "-o", "nav.csv"];
    same(&case, &arguments, &["nav.csv"]);
}

#[test]
fn outages() {
    let case = Log::good().write("same_outages");
    let arguments = [
        "outages",
        "drive.toml",
        "--length",
        "5",
        "--at",
        "40,60",
        "--json",
        "cut.json",
    ];
    same(&case, &arguments, &["cut.json"]);
}

#[test]
fn identify() {
    let case = Log::good().write("same_identify");
    case.put("record.csv", static_record(1000).as_bytes());
    let arguments = [
        "identify",
        "record.csv",
        "--rate",
        "50",
        "-o",
        "imu.toml",
        "--json",
        "found.json",
    ];
    same(&case, &arguments, &["imu.toml", "found.json"]);
}

#[test]
fn montecarlo() {
    let case = Log::good().write("same_montecarlo");
    let spec = "model = \"adis16465\"\n[filter]\nbias_models = [\"arma\", \"white\"]\n\
        [drive]\nkind = \"car\"\nduration = \"120 s\"\nrate = \"50 Hz\"\n[epochs]\nsettle = \"30 s\"\n";
    case.put("spec.toml", spec.as_bytes());
    let arguments = [
        "montecarlo",
        "spec.toml",
        "--runs",
        "5",
        "--json",
        "runs.json",
    ];
    same(&case, &arguments, &["runs.json"]);
}
