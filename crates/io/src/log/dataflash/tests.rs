//! Against logs that a script wrote after ArduPilot's definitions and what pymavlink reads in them:
//! testdata/golden/formats/dataflash.

use std::io::Cursor;
use std::path::{Path, PathBuf};

use serde_json::Value;
use undrift_nav::Vector3;
use undrift_nav::sample::{FixQuality, Position};

use super::*;
use crate::entry::{Entry, Fix, ImuReading, What};
use crate::log::receiver::testing::{wanted_fixes as fixes, wanted_imu as imu};
use crate::skipped::SkipKind;

fn golden(name: &str) -> PathBuf {
    let root = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../testdata/golden/formats/dataflash"
    );
    Path::new(root).join(name)
}

fn bytes(name: &str) -> Vec<u8> {
    std::fs::read(golden(name)).unwrap()
}

fn source(bytes: &[u8]) -> Source {
    Box::new(Cursor::new(bytes.to_vec()))
}

fn of_bytes(bytes: &[u8], wanted: &Wanted) -> Result<Vec<Entry>, ReadError> {
    let again = || Ok(source(bytes));
    entries(source(bytes), &again, wanted)?.collect()
}

fn readings(entries: &[Entry]) -> Vec<ImuReading> {
    let reading = |entry: &Entry| match entry.what {
        What::Imu(reading) => Some(reading),
        _ => None,
    };
    entries.iter().filter_map(reading).collect()
}

fn found_fixes(entries: &[Entry]) -> Vec<Fix> {
    let fix = |entry: &Entry| match entry.what {
        What::Fix(fix) => Some(fix),
        _ => None,
    };
    entries.iter().filter_map(fix).collect()
}

fn skips(entries: &[Entry]) -> Vec<(SkipKind, &str)> {
    let mut skips = Vec::new();
    for entry in entries {
        if let What::Skipped(kind, detail) = &entry.what {
            skips.push((*kind, detail.as_str()));
        }
    }
    skips
}

fn expected() -> Value {
    serde_json::from_slice(&bytes("expected.json")).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    let list = value.as_array().unwrap();
    list.iter().map(|number| number.as_f64().unwrap()).collect()
}

/// GPS seconds of the week at which the autopilot's clock began, and how fast it is: make.py.
const BOOT: f64 = 345_600.0;
const FAST: f64 = 20e-6;
/// The shortest delay of a fix in the file.
const LATENCY: f64 = 0.110;

/// In six seconds the drift of 20 ppm, which so short a log does not tell, is 0.1 ms; delays are whole ms.
const TIME: f64 = 3e-4;
/// Single precision as text, and differences of the order of sums, are exact to more than this.
const ROUNDING: f64 = 1e-12;

#[test]
fn samples_are_those_that_pymavlink_reads() {
    let expected = expected();
    for (name, of) in [
        ("flight.BIN", "flight"),
        ("flight.log", "flight"),
        ("old.BIN", "old"),
    ] {
        for (stream, rows) in expected[of]["imu"].as_object().unwrap() {
            let entries = of_bytes(&bytes(name), &imu(Some(stream))).unwrap();
            let found = readings(&entries);
            let rows = rows.as_array().unwrap();
            assert_eq!(found.len(), rows.len(), "{name} {stream}");
            for (reading, row) in found.iter().zip(rows) {
                let [own, gx, gy, gz, ax, ay, az] = numbers(row)[..] else {
                    panic!("{row}");
                };
                let fast = if of == "flight" { FAST } else { 0.0 };
                let time = BOOT + own / (1.0 + fast) - LATENCY;
                assert!(
                    (reading.time - time).abs() < TIME,
                    "{name} {stream} {} {time}",
                    reading.time
                );
                for (found, expected) in reading
                    .gyro
                    .iter()
                    .chain(&reading.accel)
                    .zip([gx, gy, gz, ax, ay, az])
                {
                    assert!(
                        (found - expected).abs() < ROUNDING,
                        "{name} {stream} at {own}"
                    );
                }
            }
        }
    }
}

#[test]
fn fixes_are_those_that_pymavlink_reads() {
    let expected = expected();
    for (name, of) in [
        ("flight.BIN", "flight"),
        ("flight.log", "flight"),
        ("old.BIN", "old"),
    ] {
        for (stream, rows) in expected[of]["fixes"].as_object().unwrap() {
            let entries = of_bytes(&bytes(name), &fixes(Some(stream))).unwrap();
            let found = found_fixes(&entries);
            let rows = rows.as_array().unwrap().iter();
            let rows: Vec<_> = rows
                .filter(|row| row["status"].as_u64().unwrap() >= 3)
                .collect();
            assert_eq!(found.len(), rows.len(), "{name} {stream}");
            for (fix, row) in found.iter().zip(rows) {
                compare(fix, row);
            }
        }
        let none = of_bytes(&bytes(name), &fixes(Some("GPS0"))).unwrap();
        let none = skips(&none);
        let first: &[_] = if of == "old" {
            &[]
        } else {
            &[(SkipKind::NoFix, "status 1")]
        };
        assert_eq!(none, first, "{name}");
    }
}

fn compare(fix: &Fix, row: &Value) {
    let number = |key: &str| row[key].as_f64().unwrap();
    assert_eq!(fix.time, number("tow"));
    let Some((Position::Geodetic(place), covariance)) = fix.position else {
        panic!("no position");
    };
    let quality = match number("status") {
        3.0 => FixQuality::Single,
        4.0 => FixQuality::Differential,
        5.0 => FixQuality::Float,
        _ => FixQuality::Fixed,
    };
    assert_eq!(fix.quality, quality);
    assert!(
        (place.lat - number("lat")).abs() < ROUNDING
            && (place.lon - number("lon")).abs() < ROUNDING
    );
    assert!((place.height - number("height")).abs() < ROUNDING);
    assert_eq!(fix.velocity.is_some(), !row["velocity"].is_null());
    assert_eq!(covariance.is_some(), !row["std"].is_null());
    if let Some((velocity, _)) = fix.velocity {
        for (found, expected) in velocity.iter().zip(numbers(&row["velocity"])) {
            assert!((found - expected).abs() < ROUNDING, "{row}");
        }
    }
    if let Some(covariance) = covariance {
        let [h, v, s] = numbers(&row["std"])[..] else {
            panic!("{row}");
        };
        for (found, std) in covariance.diagonal().iter().zip([h, h, v]) {
            assert!((found.sqrt() - std).abs() < ROUNDING, "{row}");
        }
        let own = fix.velocity.and_then(|(_, covariance)| covariance);
        assert!(own.is_none_or(|own| (own[(1, 1)].sqrt() - s).abs() < ROUNDING));
    }
}

#[test]
fn streams_are_listed_and_raw_samples_are_preferred() {
    let listed = |name: &str| {
        let streams = streams(source(&bytes(name))).unwrap().into_iter();
        let short = |s: Stream| format!("{} {:?} {}", s.name, s.kind, s.messages);
        streams.map(short).collect::<Vec<_>>().join(", ")
    };
    let others = "ATT Other 15, FMT Other 10, FMTU Other 10, MSG Other 1";
    let flight =
        format!("IMU0 Imu 75, IMU1 Imu 75, RAW0 Imu 150, GPS0 Fixes 15, GPS1 Fixes 15, {others}");
    assert_eq!(listed("flight.BIN"), flight);
    assert_eq!(listed("flight.log"), flight);
    let old = "IMU0 Imu 20, IMU1 Imu 20, GPS0 Fixes 2, FMT Other 4";
    assert_eq!(listed("old.BIN"), old);

    let usual = |name: &str| readings(&of_bytes(&bytes(name), &imu(None)).unwrap()).len();
    // All gyro samples but the last two, after which comes no accelerometer sample.
    assert_eq!((usual("flight.BIN"), usual("old.BIN")), (298, 20));
    let error = of_bytes(&bytes("old.BIN"), &imu(Some("RAW0"))).unwrap_err();
    assert_eq!(error.key, Some(crate::Key::Topic("imu")));
    assert!(error.mend.contains("IMU0, IMU1, GPS0"), "{error}");
    let error = of_bytes(&bytes("old.BIN"), &fixes(Some("IMU0"))).unwrap_err();
    assert!(error.problem.contains("no stream IMU0"), "{error}");
    assert!(of_bytes(&bytes("old.BIN"), &Wanted::Poses(None)).is_err());
}

/// The head of the next message, or the end, closes a message: what is given is right where bytes are lost.
#[test]
fn lost_bytes_cost_the_messages_around_them() {
    let whole = bytes("flight.BIN");
    let wanted = imu(Some("IMU1"));
    let samples = readings(&of_bytes(&whole, &wanted).unwrap());
    let values = |reading: &ImuReading| (reading.gyro, reading.accel);
    let mut fewest = samples.len();
    for (from, n) in (3000..whole.len() - 500)
        .step_by(331)
        .zip([1, 7, 61, 397].into_iter().cycle())
    {
        let cut = [&whole[..from], &whole[from + n..]].concat();
        let entries = of_bytes(&cut, &wanted).unwrap();
        let found = readings(&entries);
        assert!(
            found
                .iter()
                .all(|f| samples.iter().any(|s| values(s) == values(f))),
            "{from}"
        );
        fewest = fewest.min(found.len());
        let damaged = skips(&entries);
        // Whole messages may be what is lost.
        assert!(damaged.len() <= 1, "{damaged:?}");
        assert!(
            damaged
                .iter()
                .all(|(kind, detail)| *kind == SkipKind::Damaged
                    && detail.contains("hold no message"))
        );
    }
    // 397 bytes are those of six messages, of which one in six is of the stream, and one is beside them.
    assert!(fewest >= samples.len() - 4, "{fewest}");
}

#[test]
fn files_cut_anywhere_are_read_up_to_there() {
    for (name, step) in [("flight.BIN", 97), ("old.BIN", 3), ("flight.log", 997)] {
        let whole = bytes(name);
        let wanted = imu(Some("IMU0"));
        let samples = readings(&of_bytes(&whole, &wanted).unwrap());
        let mut most = 0;
        for n in (1..whole.len()).step_by(step) {
            let Ok(entries) = of_bytes(&whole[..n], &wanted) else {
                assert_eq!(most, 0, "{name} cut at {n}");
                continue;
            };
            let found = readings(&entries);
            assert!(
                found.len() >= most && found.len() <= samples.len(),
                "{name} cut at {n}"
            );
            let same = found.iter().zip(&samples).all(|(a, b)| a.gyro == b.gyro);
            // The last line of a text may be cut within a number.
            assert!(same || name == "flight.log", "{name} cut at {n}");
            most = found.len();
        }
        assert!(most + 1 >= samples.len(), "{name}: {most}");
    }
}

#[test]
fn flipped_bits() {
    for name in ["flight.BIN", "old.BIN", "flight.log"] {
        let mut bytes = bytes(name);
        let step = bytes.len() / 700 + 1;
        for n in (0..bytes.len()).step_by(step) {
            let bit = 1 << (n % 8);
            bytes[n] ^= bit;
            for wanted in [imu(None), fixes(None)] {
                for entry in of_bytes(&bytes, &wanted).unwrap_or_default() {
                    let finite = entry.what.is_finite() || matches!(entry.what, What::Skipped(..));
                    assert!(finite, "{name} at {n}: {entry:?}");
                }
            }
            bytes[n] ^= bit;
        }
    }
}

/// Without a fix that knows the time, times are the autopilot's.
#[test]
fn logs_without_fixes_keep_their_clock() {
    let text = String::from_utf8(bytes("flight.log")).unwrap();
    let lines = text.lines().filter(|line| !line.starts_with("GPS, "));
    let text = lines.collect::<Vec<_>>().join("\n");
    let found = readings(&of_bytes(text.as_bytes(), &imu(Some("IMU"))).unwrap());
    assert_eq!(found.len(), 75);
    assert_eq!(found[0].time, 30.0006);
}

#[test]
fn formats_are_known_by_their_start() {
    assert!(detect(&bytes("flight.BIN")) && detect(&bytes("old.BIN")));
    assert!(detect(&bytes("flight.log")));
    assert!(!detect(b"FMT") && !detect(&[0xa3, 0x95, 1]));
    assert!(streams(source(b"")).is_err());
}

/// What a compass measured [mG] becomes tesla, by instance; without a fix times are the autopilot's.
#[test]
fn magnetic_fields_are_those_of_the_compass_asked_for() {
    let text = "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n\
        FMT, 40, 35, MAG, QBhhhhhhhhhBI, TimeUS,I,MagX,MagY,MagZ,OfsX,OfsY,OfsZ,MOX,MOY,MOZ,Health,S\n\
        MAG, 1000000, 0, 210, -30, 450, 1, 2, 3, 0, 0, 0, 1, 1000\n\
        MAG, 1000000, 1, 999, 0, 0, 1, 2, 3, 0, 0, 0, 1, 1000\n\
        MAG, 1100000, 0, 211, -30, 450, 1, 2, 3, 0, 0, 0, 1, 1000\n";
    let fields = |name: Option<&str>| -> Vec<(f64, Vector3)> {
        let wanted = Wanted::Fields(name.map(str::to_owned));
        let entries = of_bytes(text.as_bytes(), &wanted).unwrap();
        let field = |entry: &Entry| match entry.what {
            What::Field(reading) => Some((reading.time, reading.field)),
            _ => None,
        };
        entries.iter().filter_map(field).collect()
    };
    let first = fields(None);
    assert_eq!(first.len(), 2);
    assert!((first[0].0 - 1.0).abs() < 1e-12 && (first[1].0 - 1.1).abs() < 1e-12);
    assert!((first[0].1 - Vector3::new(21e-6, -3e-6, 45e-6)).norm() < 1e-12);
    assert_eq!(fields(Some("MAG1")).len(), 1);
    let error = of_bytes(
        b"FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n",
        &Wanted::Fields(None),
    );
    assert!(error.unwrap_err().to_string().contains("no MAG"));
}
