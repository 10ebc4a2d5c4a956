use undrift_nav::Vector3;
use undrift_nav::sample::{FixQuality, Position};

use super::{entries, streams};
use crate::entry::{StreamKind, Wanted, What};
use crate::log::receiver::testing::{
    FIXES, all, cut_at_every_byte, fixes, flip_every_byte, golden, near, same, source_of, table,
    try_all, whatever_the_source,
};
use crate::skipped::SkipKind;

#[test]
fn blocks_of_one_time_are_one_fix() {
    let (fixes, skipped) = fixes(entries, &golden("sbf/fixes.sbf"));
    let mut expected = table("sbf/fixes.csv");
    let get = |row: &std::collections::HashMap<String, Option<f64>>, name: &str| row[name].unwrap();
    expected
        .retain(|row| get(row, "PVTGeodetic.Error") == 0.0 && get(row, "PVTGeodetic.Type") > 0.0);
    assert_eq!((fixes.len(), expected.len()), (36, 36));
    assert_eq!(skipped.count(SkipKind::NoFix), 4);
    // One that was damaged and ten stray beginnings.
    assert_eq!(skipped.count(SkipKind::Damaged), 11);
    for (fix, row) in fixes.iter().zip(&expected) {
        let get = |name: &str| get(row, name);
        let weeks = get("WNc") - 2374.0;
        assert!(near(fix.time, get("TOW") * 1e-3 + 604_800.0 * weeks));
        let covariance = |block: &str, [n, e, u]: [&str; 3]| {
            let of = |a: &str, b: &str| get(&format!("{block}.Cov_{a}{b}"));
            [of(n, n), of(e, e), of(u, u), of(n, e), -of(n, u), -of(e, u)]
        };
        let known = |c: [f64; 6]| c[0] > -2e10;
        let flat = |m: undrift_nav::Matrix3| {
            [
                m[(0, 0)],
                m[(1, 1)],
                m[(2, 2)],
                m[(0, 1)],
                m[(0, 2)],
                m[(1, 2)],
            ]
        };
        if get("PVTGeodetic.2D") == 1.0 {
            assert!(fix.position.is_none());
        } else {
            let Some((Position::Geodetic(place), Some(own))) = fix.position else {
                panic!("{fix:?}");
            };
            let of = |name: &str| get(&format!("PVTGeodetic.{name}"));
            assert!(near(place.lat, of("Latitude")) && near(place.lon, of("Longitude")));
            assert!(near(place.height, of("Height")));
            let full = covariance("PosCovGeodetic", ["lat", "lon", "hgt"]);
            if known(full) {
                assert_eq!(flat(own), full);
            } else {
                // Twice the root mean square, of a circle for the horizontal one.
                let (h, v) = (of("HAccuracy") / 2.0, of("VAccuracy") / 2.0);
                let expected = [h * h / 2.0, h * h / 2.0, v * v, 0.0, 0.0, 0.0];
                assert!(flat(own).iter().zip(expected).all(|(a, b)| near(*a, b)));
            }
        }
        let v = ["Vn", "Ve", "Vu"].map(|name| get(&format!("PVTGeodetic.{name}")));
        match fix.velocity {
            None => assert_eq!(v[0], -2e10),
            Some((velocity, own)) => {
                assert!(same(velocity, [v[0], v[1], -v[2]]));
                let full = covariance("VelCovGeodetic", ["Vn", "Ve", "Vu"]);
                assert_eq!(own.map(flat), known(full).then_some(full));
            }
        }
        let quality = match get("PVTGeodetic.Type") as u8 {
            1 => FixQuality::Single,
            4 => FixQuality::Fixed,
            5 => FixQuality::Float,
            _ => FixQuality::Differential,
        };
        assert_eq!(fix.quality, quality);
    }
}

#[test]
fn accuracies_are_those_of_the_block_where_there_is_no_covariance() {
    let (fixes, _) = fixes(entries, &golden("sbf/plain.sbf"));
    assert_eq!(fixes.len(), 10);
    for (k, fix) in fixes.iter().enumerate() {
        // Revision 0 has none.
        assert_eq!(fix.position.unwrap().1.is_some(), k % 2 == 1);
        assert!(fix.velocity.unwrap().1.is_none());
    }
}

#[test]
fn samples_of_a_sensor() {
    let (found, skipped) = all(entries, &golden("sbf/sensors.sbf"), &Wanted::Imu(None));
    let expected = table("sbf/sensors.csv");
    assert_eq!(found.len(), expected.len());
    assert_eq!(skipped.count(SkipKind::MissingField), 1);
    for (entry, row) in found.iter().zip(&expected) {
        let What::Imu(reading) = entry.what else {
            panic!("{entry:?}");
        };
        let get = |name: &str| row[name].unwrap();
        assert!(near(reading.time, get("t_s")));
        assert!(same(reading.gyro, ["gx", "gy", "gz"].map(get)));
        assert!(same(reading.accel, ["ax", "ay", "az"].map(get)));
    }
}

#[test]
fn the_inertial_solution_is_a_reference() {
    let bytes = golden("sbf/sensors.sbf");
    let (found, skipped) = all(entries, &bytes, &Wanted::Poses(None));
    let expected = table("sbf/ins.csv");
    assert_eq!((found.len(), expected.len()), (27, 27));
    assert_eq!(skipped.count(SkipKind::NoFix), 3);
    for (entry, row) in found.iter().zip(&expected) {
        let What::Pose(pose) = entry.what else {
            panic!("{entry:?}");
        };
        let get = |name: &str| row[name].unwrap();
        assert!(near(pose.time, get("t_s")));
        assert!(near(pose.position.lat, get("lat")) && near(pose.position.lon, get("lon")));
        assert!(near(pose.position.height, get("height")));
        assert!(same(pose.v_n.unwrap(), [get("vn"), get("ve"), -get("vu")]));
        let rpy = ["roll_deg", "pitch_deg", "yaw_deg"].map(|name| get(name).to_radians());
        assert!(same(pose.rpy.unwrap(), rpy));
    }
    let wanted = Wanted::Fixes {
        position: Some("INSNavGeod".to_owned()),
        velocity: None,
        base: None,
        at_once: false,
    };
    let (found, _) = all(entries, &bytes, &wanted);
    for (entry, row) in found.iter().zip(&expected) {
        let What::Fix(fix) = entry.what else {
            panic!("{entry:?}");
        };
        let stated = row["std"] == Some(1.0);
        let diagonal = |covariance: Option<undrift_nav::Matrix3>| covariance.map(|m| m.diagonal());
        let position = Vector3::new(0.5, 0.25, 1.0).map(|s| s * s);
        let velocity = Vector3::new(0.03125, 0.0625, 0.125).map(|s| s * s);
        assert_eq!(
            diagonal(fix.position.unwrap().1),
            stated.then_some(position)
        );
        assert_eq!(
            diagonal(fix.velocity.unwrap().1),
            stated.then_some(velocity)
        );
    }
    // Without them, the message names what could serve; if that is asked for, it is taken.
    let fixes = golden("sbf/fixes.sbf");
    let (_, _, error) = try_all(entries, source_of(&fixes), &Wanted::Poses(None));
    assert!(error.unwrap().to_string().contains("\"PVTGeodetic\""));
    let (poses, _) = all(
        entries,
        &fixes,
        &Wanted::Poses(Some("PVTGeodetic".to_owned())),
    );
    assert_eq!(poses.len(), 34);
}

#[test]
fn streams_are_listed_and_the_format_is_known() {
    let bytes = golden("sbf/sensors.sbf");
    let listed = streams(source_of(&bytes)).unwrap();
    let listed: Vec<_> = listed
        .iter()
        .map(|s| (s.name.as_str(), s.kind, s.messages))
        .collect();
    let expected = [
        ("ExtSensorMeas", StreamKind::Imu, 306),
        ("INSNavGeod", StreamKind::Poses, 30),
    ];
    assert_eq!(listed, expected);
    for name in ["fixes", "plain", "sensors"] {
        let bytes = golden(&format!("sbf/{name}.sbf"));
        assert_eq!(crate::log::detect(&bytes), Some(crate::format::Format::Sbf));
    }
    assert!(!super::detect(b"$@$@$@\0\0\0\0\0\0\0\0\0$@"));
}

#[test]
fn damage_costs_only_itself() {
    let bytes = golden("sbf/fixes.sbf");
    cut_at_every_byte(entries, &bytes[..3000]);
    // A bit of the block that ends an epoch costs none, one of PVTGeodetic one.
    flip_every_byte(entries, &bytes[..3000], 1);
    whatever_the_source(entries, &bytes);
    let bytes = golden("sbf/sensors.sbf");
    let count = |bytes: &[u8], wanted: &Wanted| try_all(entries, source_of(bytes), wanted).0.len();
    for k in (0..bytes.len()).step_by(131) {
        let mut flipped = bytes.clone();
        flipped[k] ^= 1 << (k % 8);
        for wanted in [FIXES, Wanted::Imu(None), Wanted::Poses(None)] {
            assert!(
                count(&flipped, &wanted) + 1 >= count(&bytes, &wanted),
                "byte {k}"
            );
        }
    }
}

/// A block of SBF: its number and what comes behind its head.
fn block(number: u16, body: &[u8]) -> Vec<u8> {
    let padded = body.len().next_multiple_of(4);
    let mut covered = number.to_le_bytes().to_vec();
    covered.extend((8 + padded as u16).to_le_bytes());
    covered.extend(body);
    covered.resize(4 + padded, 0);
    // CRC of CCITT from 0.
    let crc = covered.iter().fold(0u16, |crc, byte| {
        (0..8).fold(crc ^ u16::from(*byte) << 8, |crc, _| match crc & 0x8000 {
            0 => crc << 1,
            _ => crc << 1 ^ 0x1021,
        })
    });
    [b"$@".as_slice(), &crc.to_le_bytes(), &covered].concat()
}

#[test]
fn cartesian_blocks_are_fixes_where_there_are_no_geodetic_ones() {
    let place = undrift_nav::earth::Geodetic::from_degrees(50.85, 4.35, 120.0);
    let turn = place.ned_from_ecef();
    let v_n = Vector3::new(3.0, -4.0, 0.5);
    let floats = |values: &[f64]| -> Vec<u8> {
        values
            .iter()
            .flat_map(|value| (*value as f32).to_le_bytes())
            .collect()
    };
    let head = |k: u32| {
        let milli = 302_400_000 + 1000 * k;
        [&milli.to_le_bytes()[..], &2300u16.to_le_bytes(), &[4, 0]].concat()
    };
    // Twice as certain along the z axis of the Earth.
    let covariance = [4e-4, 4e-4, 1e-4, 4e-4, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let mut bytes = Vec::new();
    for k in 0..10 {
        let x = place.to_ecef();
        let doubles: Vec<u8> = x.iter().flat_map(|value| value.to_le_bytes()).collect();
        let v = turn.transpose() * v_n;
        let rest = floats(&[45.0, v.x, v.y, v.z, 0.0]);
        bytes.extend(block(4006, &[head(k), doubles, rest, vec![0; 40]].concat()));
        for number in [5905, 5907] {
            bytes.extend(block(number, &[head(k), floats(&covariance)].concat()));
        }
    }
    assert!(super::detect(&bytes));
    let (fixes, skipped) = fixes(entries, &bytes);
    assert!(skipped.is_empty(), "{skipped}");
    assert_eq!((fixes.len(), fixes[3].time), (10, 302_403.0));
    let Some((Position::Geodetic(found), Some(own))) = fixes[0].position else {
        panic!("{fixes:?}");
    };
    // 1e-9 rad is 6 mm.
    assert!((found.lat - place.lat).abs() < 1e-9 && (found.height - 120.0).abs() < 1e-6);
    let earth = undrift_nav::Matrix3::from_diagonal(&Vector3::new(4e-4, 4e-4, 1e-4));
    // Single precision.
    assert!(
        (own - turn * earth * turn.transpose()).norm() < 1e-10,
        "{own}"
    );
    let (velocity, covariance) = fixes[0].velocity.unwrap();
    assert!((velocity - v_n).norm() < 1e-6 && covariance == Some(own));
    let listed = streams(source_of(&bytes)).unwrap();
    let of = |name: &str| {
        listed
            .iter()
            .find(|stream| stream.name == name)
            .unwrap()
            .kind
    };
    assert_eq!(of("PVTCartesian"), StreamKind::Fixes);
}
