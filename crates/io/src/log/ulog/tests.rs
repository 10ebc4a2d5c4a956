use std::io::{BufReader, Cursor, Write};
use std::path::{Path, PathBuf};

use serde_json::Value;
use undrift_nav::sample::{FixQuality, Position};

use super::*;
use crate::entry::{Entry, What};
use crate::log::receiver::testing::{wanted_fixes as fixes, wanted_imu as imu};
use crate::skipped::SkipKind;
use crate::source;

fn golden(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../testdata/golden/formats/ulog")
        .join(name)
}

/// What pyulog reads in the file.
fn expected(log: &str) -> Value {
    let text = std::fs::read_to_string(golden("expected.json")).unwrap();
    serde_json::from_str::<Value>(&text).unwrap()[log].clone()
}

fn rows(value: &Value) -> Vec<Vec<f64>> {
    let row = |row: &Value| {
        let numbers = row.as_array().unwrap().iter();
        numbers.map(|x| x.as_f64().unwrap()).collect()
    };
    value.as_array().unwrap().iter().map(row).collect()
}

fn all_of(log: &str, wanted: &Wanted) -> Result<Vec<Entry>, ReadError> {
    let path = golden(&format!("{log}.ulg"));
    entries(source::open(&path)?, &|| source::open(&path), wanted)?.collect()
}

fn from_bytes(bytes: &[u8], wanted: &Wanted) -> Result<Vec<Entry>, ReadError> {
    let source = Box::new(BufReader::new(Cursor::new(bytes.to_vec())));
    let again = || source::open(&golden("flight.ulg"));
    entries(source, &again, wanted)?.collect()
}

/// A few roundings of double numbers between pyulog's way and ours.
fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-14 * b.abs().max(1.0)
}

#[track_caller]
fn same(ours: &[f64], theirs: &[f64]) {
    assert_eq!(ours.len(), theirs.len());
    let equal = ours.iter().zip(theirs).all(|(a, b)| near(*a, *b));
    assert!(equal, "{ours:?} {theirs:?}");
}

fn skips(entries: &[Entry]) -> Vec<(SkipKind, &str)> {
    entries
        .iter()
        .filter_map(|entry| match &entry.what {
            What::Skipped(kind, detail) => Some((*kind, detail.as_str())),
            _ => None,
        })
        .collect()
}

#[test]
fn streams_and_their_numbers_are_those_of_pyulog() {
    for log in ["flight", "old"] {
        let path = golden(&format!("{log}.ulg"));
        let streams = streams(source::open(&path).unwrap()).unwrap();
        let counted = &expected(log)["streams"];
        for stream in streams.iter().filter(|stream| stream.name != "nested.0") {
            assert_eq!(counted[&stream.name], stream.messages, "{}", stream.name);
        }
        assert!(streams.len() >= counted.as_object().unwrap().len());
    }
}

#[test]
fn samples_are_those_of_pyulog() {
    let read = [
        ("flight", None, "vehicle_imu.0", 0),
        ("flight", Some("vehicle_imu"), "vehicle_imu.0", 0),
        ("flight", Some("sensor_combined.0"), "sensor_combined.0", 1),
        ("old", None, "sensor_combined.0", 0),
    ];
    for (log, asked, name, skipped) in read {
        let entries = all_of(log, &imu(asked)).unwrap();
        let found = entries.iter().filter_map(|entry| match &entry.what {
            What::Imu(s) => Some([&[s.time], s.gyro.as_slice(), s.accel.as_slice()].concat()),
            _ => None,
        });
        let found: Vec<Vec<f64>> = found.collect();
        let theirs = rows(&expected(log)["imu"][name]);
        assert_eq!(found.len(), theirs.len(), "{log} {name}");
        for (ours, theirs) in found.iter().zip(&theirs) {
            same(ours, theirs);
        }
        assert_eq!(skips(&entries).len(), skipped, "{log} {name}");
    }
}

#[test]
fn fixes_are_those_of_pyulog() {
    for (log, asked, name) in [
        ("flight", None, "sensor_gps.0"),
        (
            "flight",
            Some("vehicle_gps_position"),
            "vehicle_gps_position.0",
        ),
        ("old", None, "vehicle_gps_position.0"),
    ] {
        let entries = all_of(log, &fixes(asked)).unwrap();
        let found = entries.iter().filter_map(|entry| match &entry.what {
            What::Fix(fix) => Some(fix),
            _ => None,
        });
        let found: Vec<_> = found.collect();
        let theirs = rows(&expected(log)["fixes"][name]);
        assert_eq!(found.len(), theirs.len(), "{log} {name}");
        for (fix, row) in found.iter().zip(&theirs) {
            let Some((Position::Geodetic(place), covariance)) = fix.position else {
                panic!("no place");
            };
            same(&[fix.time, place.lat, place.lon, place.height], &row[..4]);
            let (eph, epv, speed_std) = (row[7], row[8], row[9]);
            match covariance {
                Some(c) => same(c.diagonal().as_slice(), &[eph * eph, eph * eph, epv * epv]),
                None => assert_eq!(eph, 0.0),
            }
            match fix.velocity {
                Some((velocity, covariance)) => {
                    same(velocity.as_slice(), &row[4..7]);
                    let std = covariance.unwrap().diagonal().map(f64::sqrt);
                    same(std.as_slice(), &[speed_std; 3]);
                }
                None => assert_eq!(row[11], 0.0),
            }
            let quality = match row[10] {
                3.0 => FixQuality::Single,
                5.0 => FixQuality::Float,
                _ => FixQuality::Fixed,
            };
            assert_eq!(fix.quality, quality);
        }
    }
    // The first fix of the receiver is two-dimensional.
    let entries = all_of("flight", &fixes(Some("sensor_gps"))).unwrap();
    assert_eq!(skips(&entries), [(SkipKind::OutOfRange, "fix type 2")]);
}

#[test]
fn positions_have_the_velocity_of_their_time() {
    for (log, velocities) in [("flight", 3), ("old", 4)] {
        let entries = all_of(log, &Wanted::Poses(None)).unwrap();
        let theirs = rows(&expected(log)["poses"]["vehicle_global_position.0"]);
        let mut with_velocity = 0;
        for (entry, row) in entries.iter().zip(&theirs) {
            let What::Pose(pose) = &entry.what else {
                panic!("{entry:?}");
            };
            let place = pose.position;
            same(&[pose.time, place.lat, place.lon, place.height], row);
            with_velocity += usize::from(pose.v_n.is_some());
        }
        assert_eq!((entries.len(), with_velocity), (theirs.len(), velocities));
    }
}

#[test]
fn what_is_not_there_is_said_with_what_there_is() {
    let refused = |wanted: &Wanted| all_of("flight", wanted).unwrap_err().to_string();
    let thinned = refused(&imu(Some("vehicle_imu.7")));
    assert!(thinned.contains("no message of vehicle_imu.7"), "{thinned}");
    assert!(thinned.contains("(key imu.topic)") && thinned.contains("vehicle_imu.1"));
    let other = refused(&imu(Some("sensor_gps")));
    assert!(
        other.contains("sensor_gps.0 is fixes of one receiver"),
        "{other}"
    );
    let apart = Wanted::Fixes {
        position: Some("sensor_gps".into()),
        velocity: Some("vehicle_gps_position".into()),
        base: None,
        at_once: false,
    };
    assert!(refused(&apart).contains("gnss.velocity_topic"));
    let flags = [&[0; 8][..], &[2], &[0; 31]].concat();
    let head = [&b"ULog\x01\x12\x35\x01"[..], &[0; 8], b"\x28\x00B", &flags].concat();
    let message = from_bytes(&head, &imu(Some("vehicle_imu"))).unwrap_err();
    assert!(message.to_string().contains("unknown kind"), "{message}");
}

#[test]
fn a_thinned_stream_is_refused() {
    let bytes = std::fs::read(golden("flight.ulg")).unwrap();
    // Every second message of increments is dropped by renaming its type.
    let (mut at, mut count, mut thin) = (16, 0, bytes[..16].to_vec());
    while at < bytes.len() {
        let length = usize::from(u16::from_le_bytes([bytes[at], bytes[at + 1]]));
        let message = &bytes[at..at + 3 + length];
        let increments = message[2..5] == *b"D\x01\x00";
        count += usize::from(increments);
        if !increments || count % 2 == 0 {
            thin.extend_from_slice(message);
        }
        at += message.len();
    }
    let error = from_bytes(&thin, &imu(Some("vehicle_imu"))).unwrap_err();
    assert!(error.to_string().contains("thinned"), "{error}");
    assert!(from_bytes(&thin, &imu(Some("sensor_combined"))).is_ok());
}

#[test]
fn damage_is_passed_over_to_the_next_synchronisation() {
    let bytes = std::fs::read(golden("flight.ulg")).unwrap();
    let whole = from_bytes(&bytes, &imu(Some("vehicle_imu"))).unwrap();
    let sync = bytes.windows(3).position(|w| w == b"\x08\x00S").unwrap();
    let mut damaged = bytes.clone();
    // Noise before the first synchronisation message.
    damaged.splice(sync..sync, [0xff; 500]);
    let entries = from_bytes(&damaged, &imu(Some("vehicle_imu"))).unwrap();
    assert_eq!(entries.len(), whole.len() + 1);
    let skipped = skips(&entries);
    assert_eq!(skipped[0].0, SkipKind::Text);
    assert!(skipped[0].1.contains("hold no message"), "{}", skipped[0].1);
    // Without another one, the file ends there.
    let last = bytes.windows(3).rposition(|w| w == b"\x08\x00S").unwrap();
    let mut damaged = bytes.clone();
    damaged.splice(last + 11..last + 11, [0; 50]);
    let entries = from_bytes(&damaged, &imu(Some("vehicle_imu"))).unwrap();
    assert!(entries.len() < whole.len());
    assert_eq!(skips(&entries)[0].0, SkipKind::EndsEarly);
}

/// Reads everything in every way; nothing may panic, and no number may be not finite.
fn read_all(bytes: &[u8]) {
    let open = || Box::new(BufReader::new(Cursor::new(bytes.to_vec())));
    let again = || source::open(&golden("flight.ulg"));
    let _ = streams(open());
    let ways = [
        imu(Some("vehicle_imu")),
        imu(Some("sensor_combined")),
        fixes(Some("sensor_gps")),
        fixes(Some("vehicle_gps_position")),
        Wanted::Poses(Some("vehicle_global_position".into())),
    ];
    for wanted in &ways {
        let Ok(entries) = entries(open(), &again, wanted) else {
            continue;
        };
        for entry in entries.flatten() {
            match entry.what {
                What::Imu(s) => assert!((s.gyro + s.accel).norm().is_finite()),
                What::Fix(fix) => assert!(fix.time.is_finite()),
                What::Pose(pose) => assert!(pose.position.is_valid()),
                What::LocalPose(_) | What::Heading(_) | What::Field(_) | What::Skipped(..) => {}
            }
        }
    }
}

#[test]
fn files_that_break_off_or_are_damaged_do_no_harm() {
    for log in ["flight.ulg", "old.ulg"] {
        let bytes = std::fs::read(golden(log)).unwrap();
        for length in (0..bytes.len()).step_by(7) {
            read_all(&bytes[..length]);
        }
        let mut state = 1u64;
        for _ in 0..2000 {
            let mut damaged = bytes.clone();
            for _ in 0..3 {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1);
                let at = (state >> 33) as usize % damaged.len();
                damaged[at] ^= 1 << ((state >> 20) & 7);
            }
            read_all(&damaged);
        }
    }
}

#[test]
fn what_is_no_log_is_refused_and_gzip_is_read() {
    let name = imu(Some("vehicle_imu"));
    let message = |bytes: &[u8]| from_bytes(bytes, &name).unwrap_err().to_string();
    assert!(message(b"").contains("is empty"));
    assert!(message(b"ULog\x01\x12\x35").contains("not a ULog"));
    assert!(message(&[0; 100]).contains("not a ULog"));
    let bytes = std::fs::read(golden("flight.ulg")).unwrap();
    assert!(detect(&bytes) && !detect(b"ULog"));
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(&bytes).unwrap();
    let path = std::env::temp_dir().join(format!("undrift-io-ulog-{}.gz", std::process::id()));
    std::fs::write(&path, encoder.finish().unwrap()).unwrap();
    let entries = entries(
        source::open(&path).unwrap(),
        &|| source::open(&path),
        &imu(None),
    )
    .unwrap();
    assert_eq!(entries.filter_map(Result::ok).count(), 40);
    std::fs::remove_file(&path).unwrap();
}
