//! Long logs: memory does not grow with them, and the covariance stays one.

use super::log::{Case, Log, simulated};
use serde_json::Value;
use std::process::{Command, Stdio};
use std::time::Duration;
use undrift::simulate::Trajectory;

/// `undrift navigate` with all that it can write on a car drive of so many seconds.
fn navigated(name: &str, seconds: f64) -> (Case, Option<u64>) {
    let case = Log::of(&simulated(&Trajectory::car(seconds, 1))).write(name);
    let mut child = Command::new(env!("CARGO_BIN_EXE_undrift"))
        .args([
            "navigate",
            "drive.toml",
            "-o",
            "nav.csv",
            "--json",
            "nav.json",
        ])
        .current_dir(case.path(""))
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let mut peak = None;
    let status = loop {
        // Nothing of it is left once the process has ended: the last look counts.
        peak = peak_kib(child.id()).or(peak);
        if let Some(status) = child.try_wait().unwrap() {
            break status;
        }
        std::thread::sleep(Duration::from_millis(1));
    };
    assert!(status.success());
    (case, peak)
}

/// Largest resident memory of a process so far [KiB], where the system reports it.
fn peak_kib(process: u32) -> Option<u64> {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.split_whitespace().next()?.parse().ok()
}

#[test]
#[ignore = "slow: an hour of samples"]
fn an_hour_takes_the_memory_of_minutes() {
    let (_, few) = navigated("long_few", 400.0);
    let (case, many) = navigated("long_many", 3600.0);
    let text = case.read("nav.json").unwrap();
    let result: Value = serde_json::from_str(&text).unwrap();
    let covariance = &result["summary"]["covariance"];
    // Nine of navigation, twelve of the sensors, three scale factors, the lever arm, two time offsets, the rate of the
    // clock.
    assert_eq!(covariance["states"], 30);
    // It is written on both sides of its diagonal, not computed twice.
    assert_eq!(covariance["asymmetry"], 0.0);
    let least = covariance["least_eigenvalue"].as_f64().unwrap();
    assert!(least > 0.0, "{least}");

    let (Some(few), Some(many)) = (few, many) else {
        println!("skipped: the system does not tell of peak memory");
        return;
    };
    // Series for plots fill up to their bounds, and so does the text that they become: 3 to 4.5 MB in
    // the first hour, 1.5 MB in the three after it. The log itself would be 16 MB, the solution 50 MB.
    assert!(many < few + 8192, "{few} KiB, then {many} KiB");
    assert!(many < 64 * 1024, "{many} KiB");
}
