use undrift_nav::earth::Geodetic;
use undrift_nav::sample::{FixQuality, Position};
use undrift_nav::{Matrix3, Vector3};

use super::{detect, entries, streams};
use crate::entry::{Fix, ImuReading, StreamKind, Wanted, What};
use crate::log::receiver::testing::{
    ROUNDING, all, cut_at_every_byte, fixes, flip_every_byte, golden, near, source_of, table,
    try_all, whatever_the_source,
};
use crate::skipped::SkipKind;

fn place(fix: &Fix) -> (Geodetic, Option<Matrix3>) {
    match fix.position.unwrap() {
        (Position::Geodetic(place), covariance) => (place, covariance),
        other => panic!("{other:?}"),
    }
}

fn symmetric(upper: [f64; 6]) -> Matrix3 {
    let [nn, ne, nd, ee, ed, dd] = upper;
    Matrix3::new(nn, ne, nd, ne, ee, ed, nd, ed, dd)
}

fn imu(bytes: &[u8], name: Option<&str>) -> (Vec<ImuReading>, u64) {
    let (entries, skipped) = all(entries, bytes, &Wanted::Imu(name.map(str::to_owned)));
    let reading = |what: What| match what {
        What::Imu(reading) => reading,
        other => panic!("{other:?}"),
    };
    let readings = entries
        .into_iter()
        .map(|entry| reading(entry.what))
        .collect();
    (readings, skipped.count(SkipKind::MissingField))
}

#[test]
fn the_messages_of_an_epoch_are_one_fix() {
    let (fixes, skipped) = fixes(entries, &golden("ubx/drive.ubx"));
    let mut expected = table("ubx/fixes.csv");
    assert_eq!(expected.len(), 82);
    expected
        .retain(|row| row["NAV-PVT.fixType"] == Some(3.0) && row["NAV-PVT.gnssFixOk"] == Some(1.0));
    assert_eq!(fixes.len(), expected.len());
    assert_eq!(skipped.count(SkipKind::NoFix), 82 - expected.len() as u64);
    for (fix, row) in fixes.iter().zip(&expected) {
        let get = |name: &str| row[name].unwrap();
        // Past the week's end, and the fraction of the second that NAV-PVT knows better.
        let whole = get("iTOW") / 1e3 + if get("iTOW") < 3e8 { 604_800.0 } else { 0.0 };
        let time = whole - 0.000_123_456;
        assert!((fix.time - time).abs() < 2e-9, "{} {time}", fix.time);

        let high_precision = row["NAV-HPPOSLLH.invalidLlh"] == Some(0.0);
        let from = if high_precision {
            "NAV-HPPOSLLH"
        } else {
            "NAV-PVT"
        };
        let of = |field: &str| get(&format!("{from}.{field}"));
        let (place, covariance) = place(fix);
        assert!(near(place.lat.to_degrees(), of("lat")) && near(place.lon.to_degrees(), of("lon")));
        assert!(near(place.height, of("height") * 1e-3));

        let cov = |what: &str| {
            let pairs = ["NN", "NE", "ND", "EE", "ED", "DD"];
            symmetric(pairs.map(|pair| get(&format!("NAV-COV.{what}Cov{pair}"))))
        };
        let covariance = covariance.unwrap();
        if row["NAV-COV.posCovValid"] == Some(1.0) {
            assert_eq!(covariance, cov("pos"));
        } else {
            let (horizontal, vertical) = (of("hAcc") * 1e-3, of("vAcc") * 1e-3);
            let each = horizontal * horizontal / 2.0;
            let expected = Matrix3::from_diagonal(&Vector3::new(each, each, vertical * vertical));
            assert!((covariance - expected).amax() < ROUNDING);
        }

        let (velocity, covariance) = fix.velocity.unwrap();
        let expected = ["velN", "velE", "velD"].map(|name| get(&format!("NAV-PVT.{name}")) * 1e-3);
        assert!((velocity - Vector3::from(expected)).amax() < ROUNDING);
        if row["NAV-COV.posCovValid"].is_some() {
            assert_eq!(covariance.unwrap(), cov("vel"));
        } else {
            let each = get("NAV-PVT.sAcc") * 1e-3;
            let down = each * of("vAcc") / (of("hAcc") / 2f64.sqrt());
            let expected = Vector3::new(each, each, down).map(|std| std * std);
            let expected = Matrix3::from_diagonal(&expected);
            assert!((covariance.unwrap() - expected).amax() < ROUNDING);
        }

        let quality = match (get("NAV-PVT.carrSoln") as u8, get("NAV-PVT.diffSoln") as u8) {
            (2, _) => FixQuality::Fixed,
            (1, _) => FixQuality::Float,
            (_, 1) => FixQuality::Differential,
            _ => FixQuality::Single,
        };
        assert_eq!(fix.quality, quality);
    }
    // The 12 messages that were cut short, and what begins like one before the first.
    assert_eq!(skipped.count(SkipKind::Damaged), 13);
}

#[test]
fn streams_by_name_count_what_pyubx2_counts() {
    for file in ["drive.ubx", "old.ubx"] {
        let found = streams(source_of(&golden(&format!("ubx/{file}")))).unwrap();
        let text = String::from_utf8(golden("ubx/messages.csv")).unwrap();
        let expected: Vec<(String, u64)> = text
            .lines()
            .filter_map(|line| line.strip_prefix(&format!("{file},")))
            .map(|line| line.split_once(',').unwrap())
            .map(|(name, count)| (name.to_owned(), count.parse().unwrap()))
            .collect();
        assert_eq!(found.len(), expected.len());
        for (name, count) in expected {
            let stream = found.iter().find(|stream| stream.name == name).unwrap();
            assert_eq!(stream.messages, count, "{name}");
        }
    }
    let found = streams(source_of(&golden("ubx/drive.ubx"))).unwrap();
    let kind = |name: &str| {
        found
            .iter()
            .find(|stream| stream.name == name)
            .unwrap()
            .kind
    };
    assert_eq!(
        (kind("NAV-PVT"), kind("ESF-RAW")),
        (StreamKind::Fixes, StreamKind::Imu)
    );
}

/// The line through the ties reproduces the counter's rate, which the tags round to 39 µs; half of
/// that and the same from the ties.
const TAG: f64 = 4e-5;

#[test]
fn samples_get_gps_times_though_their_counter_is_slow_and_wraps() {
    for name in [None, Some("ESF-RAW")] {
        let (readings, dropped) = imu(&golden("ubx/drive.ubx"), name);
        let expected = table("ubx/samples.csv");
        assert_eq!((readings.len(), dropped), (expected.len(), 0));
        for (reading, row) in readings.iter().zip(&expected) {
            // The ties are NAV-PVT's times, 123 µs before the whole quarters of a second.
            let time = row["t_s"].unwrap() - 0.000_123_456;
            assert!((reading.time - time).abs() < TAG, "{} {time}", reading.time);
            check(reading, row);
        }
    }
}

fn check(reading: &ImuReading, row: &std::collections::HashMap<String, Option<f64>>) {
    let three = |names: [&str; 3]| Vector3::from(names.map(|name| row[name].unwrap()));
    let gyro = three(["gx_radps", "gy_radps", "gz_radps"]);
    let accel = three(["ax_mps2", "ay_mps2", "az_mps2"]);
    assert!((reading.gyro - gyro).amax() < ROUNDING);
    assert_eq!(reading.accel, accel);
}

#[test]
fn calibrated_tags_are_exact_by_the_status() {
    let (readings, dropped) = imu(&golden("ubx/sensors.ubx"), Some("ESF-MEAS"));
    let expected = table("ubx/sensors.csv");
    assert_eq!((readings.len(), dropped), (expected.len(), 0));
    for (reading, row) in readings.iter().zip(&expected) {
        let time = row["t_s"].unwrap() - 0.000_123_456;
        // A straight line through points of it: roundings of numbers of 6e5.
        assert!(
            (reading.time - time).abs() < 1e-8,
            "{} {time}",
            reading.time
        );
        check(reading, row);
    }
}

#[test]
fn the_first_word_of_esf_raw_and_the_status_tie_exactly() {
    let (readings, dropped) = imu(&golden("ubx/raw.ubx"), None);
    assert_eq!((readings.len(), dropped), (1300, 0));
    for row in table("ubx/raw.csv") {
        let reading = &readings[row["sample"].unwrap() as usize];
        let time = row["t_s"].unwrap() - 0.000_123_456;
        // The 40 ms to the epoch are counted at the nominal rate, 1.5 % off: 0.6 ms; and the tag.
        let off = reading.time - time;
        assert!((off - 0.6e-3).abs() < TAG, "{off}");
        check(reading, &row);
    }
}

#[test]
fn without_a_fix_the_time_is_the_counters() {
    // The samples alone: frames of class 0x10.
    let bytes = golden("ubx/sensors.ubx");
    let only: Vec<u8> = messages(&bytes)
        .into_iter()
        .filter(|frame| frame[2] == 0x10)
        .flatten()
        .collect();
    let (readings, _) = imu(&only, None);
    assert_eq!(readings.len(), 240);
    // Milliseconds since startup.
    assert!(near(readings[0].time, 3999.9995) && near(readings[239].time, 4023.8995));
}

/// The whole messages of a clean file.
fn messages(mut bytes: &[u8]) -> Vec<Vec<u8>> {
    let mut out = Vec::new();
    while bytes.len() > 8 {
        let length = 8 + usize::from(u16::from_le_bytes([bytes[4], bytes[5]]));
        out.push(bytes[..length].to_vec());
        bytes = &bytes[length..];
    }
    out
}

#[test]
fn two_streams_of_samples_have_to_be_named() {
    let both = [golden("ubx/sensors.ubx"), golden("ubx/drive.ubx")].concat();
    let (_, _, error) = try_all(entries, source_of(&both), &Wanted::Imu(None));
    assert!(error.unwrap().to_string().contains("ESF-RAW, ESF-MEAS"));
    let (_, _, error) = try_all(entries, source_of(&both), &Wanted::Imu(Some("IMU".into())));
    let message = error.unwrap().to_string();
    assert!(
        message.contains("\"IMU\"") && message.contains("ESF-MEAS"),
        "{message}"
    );
}

#[test]
fn receivers_before_nav_pvt_and_names_of_messages() {
    let bytes = golden("ubx/old.ubx");
    let (found, _) = fixes(entries, &bytes);
    let expected = table("ubx/old.csv");
    assert_eq!(found.len(), expected.len());
    for (fix, row) in found.iter().zip(&expected) {
        assert!(near(fix.time, row["iTOW"].unwrap() / 1e3));
        let (place, covariance) = place(fix);
        assert!(near(place.lat.to_degrees(), row["NAV-POSLLH.lat"].unwrap()));
        assert!(near(place.height, row["NAV-POSLLH.height"].unwrap() * 1e-3));
        assert!(near(covariance.unwrap()[(0, 0)], 2.5 * 2.5 / 2.0));
        let (velocity, covariance) = fix.velocity.unwrap();
        assert!(near(velocity.x, row["NAV-VELNED.velN"].unwrap() * 1e-2));
        assert!(near(covariance.unwrap()[(0, 0)], 0.45 * 0.45));
        // hAcc 2.5 m is 1.77 m for each axis, vAcc is 3.6 m.
        let down = 0.45 * 3.6 / (2.5 / 2f64.sqrt());
        assert!(near(covariance.unwrap()[(2, 2)], down * down));
        let differential = row["NAV-SOL.diffSoln"] == Some(1.0);
        assert_eq!(fix.quality == FixQuality::Differential, differential);
    }
    // NAV-PVT alone where it is named: the plain position, not the high-precision one.
    let wanted = Wanted::Fixes {
        position: Some("NAV-PVT".into()),
        velocity: Some("NAV-VELNED".into()),
        base: None,
        at_once: false,
    };
    let (entries, _) = all(entries, &golden("ubx/drive.ubx"), &wanted);
    let What::Fix(fix) = entries[0].what else {
        panic!()
    };
    let row = &table("ubx/fixes.csv")[0];
    assert!(near(
        place(&fix).0.lat.to_degrees(),
        row["NAV-PVT.lat"].unwrap()
    ));
    assert!(fix.velocity.is_none());
}

#[test]
fn reference_solutions_have_position_and_velocity() {
    let bytes = golden("ubx/drive.ubx");
    let (poses, _) = all(entries, &bytes, &Wanted::Poses(None));
    let (fixes, _) = fixes(entries, &bytes);
    assert_eq!(poses.len(), fixes.len());
    for (pose, fix) in poses.iter().zip(&fixes) {
        let What::Pose(pose) = pose.what else {
            panic!()
        };
        assert_eq!((pose.time, pose.position), (fix.time, place(fix).0));
        assert_eq!(
            (pose.v_n, pose.rpy),
            (fix.velocity.map(|(v_n, _)| v_n), None)
        );
    }
}

#[test]
fn damage_of_any_kind() {
    let bytes = golden("ubx/drive.ubx");
    cut_at_every_byte(entries, &bytes[..6000]);
    // A wrong bit costs a message, so that its epoch changes or is lost.
    flip_every_byte(entries, &bytes[..4000], 1);
    whatever_the_source(entries, &bytes);
    let (none, skipped) = fixes(entries, b"");
    assert!(none.is_empty() && skipped.is_empty());
    let (whole, _) = imu(&bytes, None);
    for length in 0..6000 {
        let wanted = Wanted::Imu(None);
        let (cut, _, error) = try_all(entries, source_of(&bytes[..length]), &wanted);
        assert!(error.is_none());
        for (entry, reading) in cut.iter().zip(&whole) {
            let What::Imu(cut) = entry.what else { panic!() };
            assert_eq!((cut.gyro, cut.accel), (reading.gyro, reading.accel));
        }
    }
}

#[test]
fn a_wrong_bit_among_the_samples() {
    let mut bytes = golden("ubx/sensors.ubx");
    for k in 0..4000 {
        bytes[k] ^= 1 << (k % 8);
        let (found, skipped, error) = try_all(entries, source_of(&bytes), &Wanted::Imu(None));
        assert!(error.is_none() && found.len() >= 239, "{k}");
        assert!(skipped.count(SkipKind::Damaged) <= 2, "{k}");
        bytes[k] ^= 1 << (k % 8);
    }
}

#[test]
fn known_by_its_messages() {
    assert!(detect(&golden("ubx/drive.ubx")));
    assert!(detect(&golden("ubx/drive.ubx")[..200]));
    assert!(!detect(&golden("nmea/undated.nmea")) && !detect(b"") && !detect(b"t,gx\n1,2\n"));
    assert!(!detect(&[0xb5, 0x62].repeat(32_768)));
}
