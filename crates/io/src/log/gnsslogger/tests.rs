use undrift_nav::sample::Position;
use undrift_nav::{Matrix3, Vector3};

use super::{detect, entries, streams};
use crate::entry::{StreamKind, Wanted};
use crate::log::phone::RADIUS;
use crate::log::receiver::testing::{
    FIXES, all, cut_at_every_byte, fixes, golden, imu, refused, source_of, table, try_all,
    whatever_the_source,
};
use crate::skipped::SkipKind;

/// The telephone's clock since boot, 1e5 s in nanoseconds, and GPS times of 6e5 s: some roundings.
const TIME: f64 = 1e-9;

#[test]
fn fixes_of_the_satellites() {
    let (fixes, skipped) = fixes(entries, &golden("gnsslogger/phone.txt"));
    let expected = table("gnsslogger/fixes.csv");
    assert_eq!((fixes.len(), expected.len()), (15, 15));
    assert!(skipped.is_empty(), "{skipped}");
    for (fix, row) in fixes.iter().zip(&expected) {
        let get = |name: &str| row[name].unwrap();
        assert!((fix.time - get("t_s")).abs() < TIME, "{fix:?}");
        let Some((Position::Geodetic(place), Some(covariance))) = fix.position else {
            panic!("{fix:?}");
        };
        assert_eq!(place.lat, get("lat").to_radians());
        assert_eq!(place.lon, get("lon").to_radians());
        assert_eq!(place.height, get("height"));
        let each = get("accuracy") / (-2.0 * 0.32f64.ln()).sqrt();
        let std = Vector3::new(each, each, get("vertical"));
        let off = covariance - Matrix3::from_diagonal(&std.component_mul(&std));
        assert!(off.amax() < 1e-9, "{off}");
        let (velocity, Some(covariance)) = fix.velocity.unwrap() else {
            panic!("{fix:?}");
        };
        let (speed, bearing) = (get("speed"), get("bearing").to_radians());
        let along = Vector3::new(bearing.cos(), bearing.sin(), 0.0);
        let across = Vector3::new(-bearing.sin(), bearing.cos(), 0.0);
        assert!((velocity - along * speed).amax() < 1e-12);
        let variance = |axis: Vector3| axis.dot(&(covariance * axis));
        assert!((variance(along) - 0.25).abs() < 1e-12);
        let turned = (speed * get("bearing_std").to_radians()).max(0.5);
        assert!((variance(across) - turned * turned).abs() < 1e-12);
        assert!((variance(Vector3::z()) - 400.0).abs() < 1e-9);
    }
    assert!((RADIUS - (-2.0 * 0.32f64.ln()).sqrt()).abs() < 1e-11);
}

#[test]
fn another_provider_can_be_asked_for() {
    let bytes = golden("gnsslogger/phone.txt");
    let wanted = |name: &str| Wanted::Fixes {
        position: Some(name.to_owned()),
        velocity: None,
        base: None,
        at_once: false,
    };
    assert_eq!(all(entries, &bytes, &wanted("FLP")).0.len(), 15);
    let text = String::from_utf8(bytes).unwrap();
    let fused: String = text
        .split_inclusive('\n')
        .filter(|line| !line.starts_with("Fix,GPS"))
        .collect();
    let error = refused(entries, fused.as_bytes(), &FIXES);
    assert!(error.contains("topic = \"FLP\""), "{error}");
    assert!(refused(entries, b"", &wanted("SBAS")).contains("GPS, FLP, NLP"));
}

#[test]
fn old_versions_have_fewer_columns() {
    let (fixes, _) = fixes(entries, &golden("gnsslogger/old.txt"));
    assert_eq!(fixes.len(), 10);
    for (k, fix) in fixes.iter().enumerate() {
        // 23:59:30 UTC of a Saturday is 12 s before the GPS week's end.
        assert!((fix.time - 604_788.0 - k as f64).abs() < TIME);
        assert!(fix.position.unwrap().1.is_none() && fix.velocity.is_none());
    }
}

#[test]
fn two_sensors_are_one_stream() {
    let readings = imu(entries, &golden("gnsslogger/phone.txt"), None);
    let expected = table("gnsslogger/samples.csv");
    assert_eq!(readings.len(), expected.len());
    for (reading, row) in readings.iter().zip(&expected) {
        let get = |name: &str| row[name].unwrap();
        assert!((reading.time - get("t_s")).abs() < TIME);
        let gyro = Vector3::from(["gx", "gy", "gz"].map(get));
        assert_eq!(reading.gyro, gyro);
        // The force changes by 0.5 m/s² a second: 1e-9 s of times are 5e-10 m/s².
        let accel = Vector3::from(["ax", "ay", "az"].map(get));
        assert!((reading.accel - accel).amax() < 1e-9, "{reading:?}");
    }
}

#[test]
fn sensors_of_other_rates_or_alone_are_refused() {
    let mut slow = Vec::new();
    let packed = golden("gnsslogger/slow.txt.gz");
    std::io::Read::read_to_end(
        &mut flate2::read::GzDecoder::new(packed.as_slice()),
        &mut slow,
    )
    .unwrap();
    let error = refused(entries, &slow, &Wanted::Imu(None));
    assert!(
        error.contains("100.0 Hz") && error.contains("20.0 Hz"),
        "{error}"
    );
    let text = String::from_utf8(slow).unwrap();
    let gyro: String = text
        .split_inclusive('\n')
        .filter(|line| !line.starts_with("UncalAccel"))
        .collect();
    let error = refused(entries, gyro.as_bytes(), &Wanted::Imu(None));
    assert!(error.contains("no UncalAccel lines"), "{error}");
    let both = text
        .replace("\nUncalAccel", "\nAccel")
        .replacen("\nUncalGyro", "\nGyro", 3);
    let error = refused(entries, both.as_bytes(), &Wanted::Imu(None));
    assert!(error.contains("Gyro and UncalGyro"), "{error}");
}

#[test]
fn a_gap_of_the_accelerometers_is_not_bridged() {
    let text = String::from_utf8(golden("gnsslogger/phone.txt")).unwrap();
    let mut accels = 0;
    let with_gap: String = text
        .split_inclusive('\n')
        .filter(|line| {
            accels += u32::from(line.starts_with("UncalAccel"));
            !(line.starts_with("UncalAccel") && (600..690).contains(&accels))
        })
        .collect();
    let (found, skipped) = all(entries, with_gap.as_bytes(), &Wanted::Imu(None));
    let whole = imu(entries, text.as_bytes(), None);
    // 91 intervals of 90 Hz are 1.01 s: 101 rates of 100 Hz.
    let lost = whole.len() - found.len();
    assert!((100..=102).contains(&lost), "{lost}");
    // And the first, which has no force before it.
    assert_eq!(skipped.count(SkipKind::MissingField), lost as u64 + 1);
}

#[test]
fn streams_are_listed_and_the_format_is_known() {
    let bytes = golden("gnsslogger/phone.txt");
    let listed = streams(source_of(&bytes)).unwrap();
    let of = |kind: StreamKind| -> Vec<&str> {
        let those = listed.iter().filter(|stream| stream.kind == kind);
        those.map(|stream| stream.name.as_str()).collect()
    };
    assert_eq!(of(StreamKind::Fixes), ["GPS", "FLP"]);
    assert_eq!(of(StreamKind::Imu), ["UncalGyro"]);
    for name in ["phone.txt", "old.txt"] {
        let bytes = golden(&format!("gnsslogger/{name}"));
        assert_eq!(
            crate::log::detect(&bytes),
            Some(crate::format::Format::GnssLogger)
        );
    }
    for other in [&b"# a comment\n1,2,3\n"[..], b"Fixed,GPS,1\n", b""] {
        assert!(!detect(other));
    }
}

#[test]
fn damage_costs_only_itself() {
    let bytes = golden("gnsslogger/old.txt");
    cut_at_every_byte(entries, &bytes);
    // Behind the comment, in which a wrong bit renames a column.
    let start = bytes.iter().position(|byte| *byte == b'\n').unwrap() + 1;
    let (comment, lines) = bytes.split_at(start);
    for k in (0..lines.len()).step_by(3) {
        let mut flipped = lines.to_vec();
        flipped[k] ^= 1 << (k % 8);
        let (found, _, _) = try_all(entries, source_of(&[comment, &flipped].concat()), &FIXES);
        assert!(found.len() >= 8, "byte {k}");
    }
    let bytes = golden("gnsslogger/phone.txt");
    whatever_the_source(entries, &bytes);
    let bytes = &bytes[..60_000];
    for k in (0..bytes.len()).step_by(997) {
        let mut flipped = bytes.to_vec();
        flipped[k] ^= 1 << (k % 8);
        for wanted in [FIXES, Wanted::Imu(None)] {
            for entry in try_all(entries, source_of(&flipped), &wanted).0 {
                assert!(entry.what.is_finite());
            }
            try_all(entries, source_of(&bytes[..k]), &wanted);
        }
    }
}
