//! Receivers and autopilots that carry samples and fixes on one line, live: through a socket the solution is that of `navigate`.

use super::{
    autopilots::mavlink,
    drives::{Shared, inspect, scratch},
    log::{Fix, Log, Sample},
    receivers::{novatel, sbf, ubx},
};
use crate::live::{interrupt, last_line, wait_for};
use std::{
    fs,
    io::Write,
    net::TcpListener,
    path::{Path, PathBuf},
    process::{Command, Stdio},
    thread,
    time::Duration,
};

/// Length of the drive [s], and how long it is sent [s].
const LENGTH: f64 = 140.0;
const SENT: f64 = 3.0;
/// Bytes that are sent at once: no message ends with them.
const PIECE: usize = 611;

/// The bytes of a drive whose last samples come after a fix that is later than all of them, so that none is missing at the end.
fn bytes(write: fn(&Log, &Path) -> Vec<PathBuf>, folder: &Path) -> (PathBuf, Vec<u8>) {
    let Log { samples, fixes } = Shared::find("simulated").unwrap().log();
    let samples: Vec<Sample> = samples.into_iter().filter(|s| s.time < LENGTH).collect();
    let fixes: Vec<Fix> = fixes
        .into_iter()
        .filter(|f| f.time < LENGTH + 1.0)
        .collect();
    let mut first = samples;
    let last = first.split_off(first.len() - 4);
    let mut parts = Vec::new();
    let (first, last) = (
        Log {
            samples: first,
            fixes,
        },
        Log {
            samples: last,
            fixes: Vec::new(),
        },
    );
    let mut file = PathBuf::new();
    for log in [first, last] {
        file = write(&log, folder).remove(0);
        parts.extend(fs::read(&file).unwrap());
    }
    fs::write(&file, &parts).unwrap();
    (file, parts)
}

fn live_is_navigate(name: &str, write: fn(&Log, &Path) -> Vec<PathBuf>) {
    let work = scratch(&format!("live-{name}"));
    let (file, bytes) = bytes(write, &work);
    inspect(&[file], true, &work.join("drive.toml"));
    let undrift = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_undrift"));
        command
            .args(arguments)
            .args(["--model", "icm20602"])
            .current_dir(&work);
        command
    };
    let navigate = ["navigate", "drive.toml", "-o", "nav.csv", "-q"];
    assert!(undrift(&navigate).status().unwrap().success(), "{name}");
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let source = format!("tcp://{}", listener.local_addr().unwrap());
    let server = thread::spawn(move || {
        let (mut stream, _) = listener.accept().unwrap();
        let pause = Duration::from_secs_f64(SENT * PIECE as f64 / bytes.len() as f64);
        for piece in bytes.chunks(PIECE) {
            stream.write_all(piece).unwrap();
            thread::sleep(pause);
        }
        stream
    });
    let live = [
        "live",
        "drive.toml",
        "--imu",
        &source,
        "--gnss",
        &source,
        "-o",
        "live.csv",
    ];
    let run = undrift(&live).stderr(Stdio::piped()).spawn().unwrap();
    let stream = server.join().unwrap();
    // The row of the last sample but one.
    let nav = fs::read_to_string(work.join("nav.csv")).unwrap();
    let expected = nav.lines().rev().nth(1).unwrap();
    let time = expected.split(',').next().unwrap();
    wait_for(name, || last_line(&work.join("live.csv")).starts_with(time));
    interrupt(run);
    drop(stream);
    let numbers = |line: &str| -> Vec<f64> {
        line.split(',')
            .map(|value| value.parse().unwrap())
            .collect()
    };
    let live = numbers(&last_line(&work.join("live.csv")));
    let expected = numbers(expected);
    assert_eq!(live.len(), expected.len(), "{name}");
    // To the printed digits.
    let apart = live
        .iter()
        .zip(&expected)
        .map(|(a, b)| (a - b).abs() / b.abs().max(1.0));
    assert!(
        apart.fold(0.0, f64::max) < 1e-9,
        "{name}: {live:?} {expected:?}"
    );
    fs::remove_dir_all(&work).unwrap();
}

#[test]
fn sbf_on_one_line() {
    live_is_navigate("sbf", sbf);
}

#[test]
fn novatel_on_one_line() {
    live_is_navigate("novatel", novatel);
}

#[test]
fn ubx_on_one_line() {
    live_is_navigate("ubx", ubx);
}

#[test]
fn mavlink_on_one_line() {
    live_is_navigate("mavlink", mavlink);
}
