//! Drives in every format that can hold them. In the gate the simulated one is in all formats, with the outages of each, and
//! every other drive in a sixth of them by turns, so that each format has three drives or more; each week every drive is in
//! all of them.
//!
//! Left out:
//! * ROS 2's `.db3`: SQLite's pages take a writer of their own, and its messages are those of the MCAP.
//! * EuRoC, GPX, SBET, Inertial Explorer: they hold samples alone, positions alone at whole seconds, or references.
//! * The quadcopters in KF-GINS: stamps alone tell what increments cover, and theirs jitter by more than what counts as a gap.
//! * Trial06 of the car with position-only fixes: most of its positions are bad, which has to be reported.

use super::{
    autopilots::{dataflash, mavlink, ulog},
    drives::{
        Found, How, Shared, WITHIN_DEG, angle_deg, compared, drift, inspect, scratch, undrift,
    },
    log::{Log, text},
    matlab::navego,
    phones::{gnss_logger, sensor_logger},
    receivers::{novatel, sbf, ubx},
    robots::{bag, mcap},
    tables::{dates, degrees_and_g, kf_gins, nmea, parquet, rtklib, unix_ms},
};
use std::{
    fs,
    path::{Path, PathBuf},
};

/// A format: how it is written, and to what it holds numbers.
struct Format {
    name: &'static str,
    write: fn(&Log, &Path) -> Vec<PathBuf>,
    /// Times of samples against those of fixes \[s\].
    time: f64,
    /// Angular rate [rad/s] and specific force [m/s²].
    sensors: [f64; 2],
    /// \[m\]
    place: f64,
    /// Horizontal [m/s].
    velocity: f64,
    /// Most of the drift against that by hand: more where accuracies have to be guessed, and where the velocity has no
    /// vertical part and the accuracy is an HDOP or a radius (NMEA, telephones: a sixth more over 39 outages).
    drift: f64,
}

const EXACT: [f64; 2] = [1e-9, 1e-7];
const SINGLE: [f64; 2] = [1e-5, 1e-4];

#[rustfmt::skip]
const FORMATS: [Format; 18] = [
    Format { name: "CSV, deg/s and g", write: degrees_and_g, time: 1e-6, sensors: EXACT, place: 1e-3, velocity: 1e-6, drift: 1.1 },
    Format { name: "CSV, dates, semicolons", write: dates, time: 2e-4, sensors: EXACT, place: 1e-3, velocity: 1e-6, drift: 1.1 },
    Format { name: "CSV, Unix ms", write: unix_ms, time: 2e-3, sensors: EXACT, place: 1e-3, velocity: 1e-6, drift: 1.5 },
    Format { name: "Parquet", write: parquet, time: 1e-6, sensors: EXACT, place: 1e-3, velocity: 1e-6, drift: 1.1 },
    Format { name: "KF-GINS", write: kf_gins, time: 1e-6, sensors: SINGLE, place: 1e-3, velocity: 1e-6, drift: 1.1 },
    Format { name: "RTKLIB beside CSV", write: rtklib, time: 2e-4, sensors: EXACT, place: 1e-3, velocity: 1e-6, drift: 1.1 },
    Format { name: "NMEA beside CSV", write: nmea, time: 2e-3, sensors: EXACT, place: 2e-3, velocity: 0.01, drift: 1.25 },
    Format { name: "UBX", write: ubx, time: 0.02, sensors: [3e-6, 6e-4], place: 0.02, velocity: 2e-3, drift: 1.1 },
    Format { name: "NovAtel ASCII", write: novatel, time: 2e-3, sensors: SINGLE, place: 1e-3, velocity: 1e-6, drift: 1.1 },
    Format { name: "SBF", write: sbf, time: 2e-3, sensors: EXACT, place: 1e-3, velocity: 1e-5, drift: 1.1 },
    Format { name: "ROS 1 bag", write: bag, time: 1e-6, sensors: EXACT, place: 1e-3, velocity: 1e-6, drift: 1.1 },
    Format { name: "ROS 2 MCAP", write: mcap, time: 1e-6, sensors: EXACT, place: 1e-3, velocity: 1e-6, drift: 1.1 },
    Format { name: "ULog", write: ulog, time: 2e-6, sensors: SINGLE, place: 1e-3, velocity: 1e-5, drift: 1.1 },
    Format { name: "DataFlash", write: dataflash, time: 2e-3, sensors: SINGLE, place: 0.02, velocity: 1e-4, drift: 1.1 },
    Format { name: "MAVLink", write: mavlink, time: 2e-6, sensors: SINGLE, place: 0.02, velocity: 0.02, drift: 1.25 },
    Format { name: "GnssLogger", write: gnss_logger, time: 2e-3, sensors: EXACT, place: 1e-3, velocity: 1e-6, drift: 1.25 },
    Format { name: "Sensor Logger", write: sensor_logger, time: 1e-6, sensors: EXACT, place: 1e-3, velocity: 1e-6, drift: 1.25 },
    Format { name: "NaveGo", write: navego, time: 1e-6, sensors: EXACT, place: 1e-3, velocity: 1e-6, drift: 1.1 },
];

/// In how many parts the formats of most drives are.
const PARTS: usize = 6;

/// Formats of a drive.
enum Which {
    /// All of them, and the outages of each.
    All,
    /// The first with its outages, and those of this part.
    Part(usize),
}
use Which::{All, Part};

fn formats(name: &'static str, which: Which) {
    let Some(shared) = Shared::find(name) else {
        return;
    };
    let work = scratch(&format!("formats-{name}"));
    let (log, truth) = (shared.log(), shared.mounting());
    let (by_hand, model) = shared.drift_by_hand(&work);
    let mut failed = Vec::new();
    for (k, format) in FORMATS.iter().enumerate() {
        if name.starts_with("apm-quad") && format.name == "KF-GINS" {
            continue;
        }
        let outages = match which {
            All => true,
            Part(part) if k > 0 && k % PARTS != part => continue,
            Part(_) => k == 0,
        };
        let folder = work.join(k.to_string());
        fs::create_dir_all(&folder).unwrap();
        let drive = folder.join("drive.toml");
        let files = (format.write)(&log, &folder);
        let found = inspect(&files, shared.car, &drive);
        let off = angle_deg(&found.mounting, &truth);
        let mut row = format!("| {name} | {} | {:?} {off:.2} |", format.name, found.how);
        let read = std::panic::catch_unwind(|| Log::read(&text(&drive), &folder));
        match read {
            Err(_) => failed.push(format!("{}: not read", format.name)),
            Ok(read) => failed.extend(differences(&log, &read, format)),
        }
        failed.extend(verdict(&found, off).map(|why| format!("{}: {why}", format.name)));
        if outages {
            let (got, wanted, n) = compared(&drift(&drive, &model, &[]), &by_hand);
            row += &format!(" {got:.2} / {wanted:.2} m, {n} outages |");
            if n < 2 || got > format.drift * wanted {
                failed.push(format!(
                    "{}: drift {got:.2} m, by hand {wanted:.2} m",
                    format.name
                ));
            }
        }
        println!("{row}");
        fs::remove_dir_all(&folder).unwrap();
    }
    fs::remove_dir_all(&work).unwrap();
    assert!(failed.is_empty(), "{name}:\n{}", failed.join("\n"));
}

/// What is wrong with the mounting found.
fn verdict(found: &Found, off: f64) -> Option<String> {
    (off > WITHIN_DEG).then(|| format!("{off:.1} deg off by {:?}; {}", found.how, found.notes))
}

/// What a log lost on its way through a format.
fn differences(log: &Log, read: &Log, format: &Format) -> Vec<String> {
    let mut found = Vec::new();
    let mut check = |what: &str, worst: f64, limit: f64| {
        if worst > limit {
            found.push(format!("{}: {what} off by {worst:.3e}", format.name));
        }
    };
    // A clock of its own, the same of samples and fixes.
    let shift = read.fixes[0].time - log.fixes[0].time;
    let (mut rates, mut forces, mut times, mut alike) = (0f64, 0f64, 0f64, 0);
    let mut at = 0;
    for sample in &read.samples {
        let time = sample.time - shift;
        let off = |k: usize| (log.samples[k].time - time).abs();
        while at + 1 < log.samples.len() && off(at + 1) <= off(at) {
            at += 1;
        }
        let unlike = |k: usize| {
            let of = &log.samples[k];
            (of.gyro - sample.gyro).norm() + (of.accel - sample.accel).norm() + 1e-6 * off(k)
        };
        // The nearest by value among the neighbours, where the clock is off by a sample.
        let (mut same, mut least) = (at, unlike(at));
        for k in at.saturating_sub(2)..(at + 3).min(log.samples.len()) {
            // One component alone excludes most of them.
            if (log.samples[k].gyro.x - sample.gyro.x).abs() < least && unlike(k) < least {
                (same, least) = (k, unlike(k));
            }
        }
        rates = rates.max((log.samples[same].gyro - sample.gyro).amax());
        forces = forces.max((log.samples[same].accel - sample.accel).amax());
        times = times.max(off(same));
        alike += 1;
    }
    check("rates", rates, format.sensors[0]);
    check("forces", forces, format.sensors[1]);
    check("times", times, format.time);
    let lost = log.samples.len() as f64 - f64::from(alike);
    check(
        "number of samples",
        lost.abs(),
        0.001 * log.samples.len() as f64 + 3.0,
    );
    let lost = log.fixes.len() as f64 - read.fixes.len() as f64;
    check("number of fixes", lost.abs(), 2.0);
    let (mut places, mut velocities) = (0f64, 0f64);
    for (fix, of) in read.fixes.iter().zip(&log.fixes) {
        let [north, east] = [0, 1].map(|k| (fix.place[k] - of.place[k]) * 111_320.0);
        places = places
            .max(north.abs())
            .max(east.abs())
            .max((fix.place[2] - of.place[2]).abs());
        let unlike = match (fix.velocity, of.velocity) {
            (Some(fix), Some(of)) => (fix.xy() - of.xy()).amax(),
            (None, None) => 0.0,
            _ => f64::INFINITY,
        };
        velocities = velocities.max(unlike);
    }
    check("places", places, format.place);
    check("velocities", velocities, format.velocity);
    found
}

/// Where neither navigation nor forces show the forward axis, that is reported, and so is that the results do not fit.
#[test]
fn bad_positions_show_no_forward_axis() {
    let Some(shared) = Shared::find("wid-car/trial06") else {
        return;
    };
    let work = scratch("bad-positions");
    let drive = work.join("drive.toml");
    let found = inspect(&shared.files(), shared.car, &drive);
    assert_eq!(found.how, How::Gravity);
    assert!(
        found.notes.contains("axes guessed from gravity alone"),
        "{}",
        found.notes
    );
    let outages = [
        "outages",
        drive.to_str().unwrap(),
        "--bias-models",
        "arma",
        "--count",
        "3",
        "--json",
        "-",
    ];
    let warnings = undrift(&outages)["warnings"].to_string();
    assert!(
        warnings.contains("the gyros do not measure the turns of the GNSS course"),
        "{warnings}"
    );
    fs::remove_dir_all(&work).unwrap();
}

macro_rules! drives {
    ($($test:ident: $name:literal, $which:expr;)*) => {
        $(
            #[test]
            #[ignore = "slow: many formats"]
            fn $test() {
                formats($name, $which);
            }
        )*
        /// Every drive in all formats.
        mod weekly {
            $(
                #[test]
                #[ignore = "slow: all formats"]
                fn $test() {
                    super::formats($name, super::All);
                }
            )*
        }
    };
}

drives! {
    simulated: "simulated", All;
    rtk_drive: "rtk-drive", Part(0);
    long_drive: "ublox-drives/mixed-road-long-drive-nominal-001", Part(1);
    parking_lot: "ublox-drives/parkinglot-maneuvers", Part(2);
    stop_and_go: "ublox-drives/urban-stop-go-tight-turns-nominal-001", Part(3);
    figure_of_eight: "ublox-drives-more/parking-lot-figure8-nominal-001", Part(4);
    long_loop: "ublox-drives-more/urban-long-turn-loop-nominal-001", Part(5);
    low_speed: "ublox-drives-more/urban-low-speed-low-signal-001", Part(0);
    medium_loop: "ublox-drives-more/urban-medium-turn-loop-nominal-001", Part(1);
    short_loop: "ublox-drives-more/urban-short-turn-loop-nominal-001", Part(2);
    car_02: "wid-car/trial02", Part(3);
    car_03: "wid-car/trial03", Part(4);
    car_04: "wid-car/trial04", Part(5);
    car_07: "wid-car/trial07", Part(0);
    car_09: "wid-car/trial09", Part(1);
    car_10: "wid-car/trial10", Part(2);
    aeroplane: "uav-flight", Part(3);
    quadcopter: "apm-quad/quad106", Part(4);
    quadcopter_with_a_glitch: "apm-quad/f450_glitch_log", Part(5);
}
