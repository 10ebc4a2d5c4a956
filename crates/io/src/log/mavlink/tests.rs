use undrift_nav::earth::STANDARD_GRAVITY;
use undrift_nav::sample::{FixQuality, Position};

use super::{detect, entries, streams};
use crate::entry::{StreamKind, Wanted, What};
use crate::log::receiver::testing::{
    FIXES, all, cut_at_every_byte, fixes, flip_every_byte, golden, imu, near, refused, same,
    source_of, table, wanted_fixes, wanted_imu, whatever_the_source,
};
use crate::skipped::SkipKind;

#[test]
fn samples_are_those_that_pymavlink_packed() {
    let bytes = golden("mavlink/stream.mavlink");
    let samples = imu(entries, &bytes, None);
    let expected = table("mavlink/samples.csv");
    assert_eq!((samples.len(), expected.len()), (100, 100));
    for (sample, row) in samples.iter().zip(&expected) {
        let get = |name: &str| row[name].unwrap();
        assert!(near(sample.time, get("time")));
        assert!(same(sample.gyro, ["gx", "gy", "gz"].map(get)));
        assert!(same(sample.accel, ["ax", "ay", "az"].map(get)));
        let temperature = Some(sample.temperature_c).filter(|t| t.is_finite());
        assert_eq!(temperature, row["temperature"]);
    }
    let (_, skipped) = all(entries, &bytes, &wanted_imu(None));
    assert_eq!(
        skipped.count(SkipKind::Damaged),
        0,
        "other bytes are passed over"
    );
}

#[test]
fn fixes_are_those_that_pymavlink_packed() {
    let (fixes, skipped) = fixes(entries, &golden("mavlink/stream.mavlink"));
    let mut expected = table("mavlink/fixes.csv");
    expected.retain(|row| row["fix_type"] != Some(1.0));
    assert_eq!((fixes.len(), expected.len()), (8, 8));
    assert_eq!(skipped.count(SkipKind::NoFix), 2);
    for (fix, row) in fixes.iter().zip(&expected) {
        let get = |name: &str| row[name].unwrap();
        assert!(near(fix.time, get("time")));
        let quality = match get("fix_type") as u8 {
            2 | 3 => FixQuality::Single,
            4 => FixQuality::Differential,
            _ => FixQuality::Fixed,
        };
        assert_eq!(fix.quality, quality);
        assert_eq!(fix.position.is_some(), get("fix_type") > 2.0);
        if let Some((Position::Geodetic(place), covariance)) = &fix.position {
            assert!(near(place.lat, get("lat_deg").to_radians()));
            assert!(near(place.lon, get("lon_deg").to_radians()));
            assert!(near(place.height, get("height")));
            let stated = covariance.map(|r| [r[(0, 0)], r[(1, 1)], r[(2, 2)]]);
            let expected = row["h_acc"].map(|h| {
                let v = get("v_acc");
                [h * h / 2.0, h * h / 2.0, v * v]
            });
            assert!(match (stated, expected) {
                (Some(stated), Some(expected)) =>
                    stated.iter().zip(expected).all(|(a, b)| near(*a, b)),
                (None, None) => true,
                _ => false,
            });
        }
        assert_eq!(fix.velocity.is_some(), row["vel"].is_some());
        if let Some((v_n, covariance)) = fix.velocity {
            let (speed, course) = (get("vel"), get("cog_deg").to_radians());
            assert!((v_n.x - speed * course.cos()).abs() < 1e-12);
            assert!((v_n.y - speed * course.sin()).abs() < 1e-12);
            assert_eq!((v_n.z, covariance.is_some()), (0.0, row["h_acc"].is_some()));
        }
    }
}

#[test]
fn a_tlog_has_both_versions_and_times_in_between() {
    let bytes = golden("mavlink/drive.tlog");
    let counts = table("mavlink/counts.csv");
    let scaled = imu(entries, &bytes, Some("SCALED_IMU2"));
    let raw = imu(entries, &bytes, Some("RAW_IMU"));
    assert_eq!((scaled.len(), raw.len(), counts.len()), (40, 40, 40));
    for ((scaled, raw), row) in scaled.iter().zip(&raw).zip(&counts) {
        let get = |name: &str| row[name].unwrap();
        // The stamps of 32 bits begin again after 300 ms.
        assert!((scaled.time - (2f64.powi(32) - 300.0 + 20.0 * get("k")) * 1e-3).abs() < 1e-6);
        // By Unix time: 1760000000 is 9 October 2025, second 377618 of the GPS week.
        assert!((raw.time - (377_618.0 + 0.02 * get("k"))).abs() < 1e-6);
        for sample in [scaled, raw] {
            assert!(same(
                sample.gyro,
                ["gx", "gy", "gz"].map(|name| 1e-3 * get(name))
            ));
            let unit = 1e-3 * STANDARD_GRAVITY;
            assert!(same(
                sample.accel,
                ["ax", "ay", "az"].map(|name| unit * get(name))
            ));
        }
    }
    let problem = refused(entries, &bytes, &wanted_imu(None));
    assert!(problem.contains("RAW_IMU and SCALED_IMU2"), "{problem}");
    let problem = refused(entries, &bytes, &wanted_imu(Some("IMU")));
    assert!(problem.contains("available: HIGHRES_IMU"), "{problem}");
    let (found, _) = all(entries, &bytes, &wanted_fixes(Some("GPS2_RAW")));
    let with_place = found.iter().filter(|entry| match &entry.what {
        What::Fix(fix) => fix.position.is_some(),
        _ => false,
    });
    assert_eq!(with_place.count(), 24);
}

#[test]
fn streams_have_their_names() {
    let found = streams(source_of(&golden("mavlink/stream.mavlink"))).unwrap();
    let kinds: Vec<_> = found
        .iter()
        .map(|stream| (stream.name.as_str(), stream.kind, stream.messages))
        .collect();
    assert_eq!(
        kinds,
        [
            ("SYSTEM_TIME", StreamKind::Other, 1),
            ("GPS_RAW_INT", StreamKind::Fixes, 10),
            ("HIGHRES_IMU", StreamKind::Imu, 110),
        ]
    );
}

#[test]
fn the_date_is_that_of_the_autopilot() {
    let bytes = golden("mavlink/stream.mavlink");
    let mut found = entries(source_of(&bytes), &Wanted::Imu(None)).unwrap();
    assert_eq!(found.by_ref().map(Result::unwrap).count(), 100);
    let epoch = found.epoch().unwrap();
    // 1760000000.25 s at 4.25 s since the start.
    assert!((epoch.unix(4.25) - 1_760_000_000.25).abs() < 1e-6);
}

#[test]
fn damage_costs_only_itself() {
    assert!(detect(&golden("mavlink/drive.tlog")) && !detect(b"\xfe\x01\x02\x03\x04\x05\x06\x07"));
    let bytes = golden("mavlink/drive.tlog");
    let part = bytes.get(..1500).unwrap();
    let open: crate::log::receiver::testing::Open = |source, wanted| {
        entries(
            source,
            &match wanted {
                Wanted::Imu(_) => Wanted::Imu(Some("RAW_IMU".into())),
                other => other.clone(),
            },
        )
    };
    cut_at_every_byte(open, part);
    flip_every_byte(open, part, 1);
    whatever_the_source(open, &bytes);
    assert!(!all(entries, &bytes, &FIXES).0.is_empty());
}
