use undrift_nav::Vector3;
use undrift_nav::earth::Geodetic;
use undrift_nav::sample::{FixQuality, Position};

use super::{detect, entries, streams};
use crate::entry::{StreamKind, Wanted, What};
use crate::log::receiver::testing::{
    FIXES, all, cut_at_every_byte, fixes, flip_every_byte, golden, imu, near, poses, refused, same,
    source_of, table, try_all, whatever_the_source,
};
use crate::skipped::SkipKind;

#[test]
fn messages_of_one_time_are_one_fix() {
    let mut expected = table("novatel/fixes.csv");
    expected.retain(|row| row["used"] == Some(1.0));
    for name in ["novatel/fixes.bin", "novatel/fixes.asc"] {
        let (mut fixes, skipped) = fixes(entries, &golden(name));
        // PSRPOS is taken until there is something better: never here, BESTPOS comes first.
        fixes.retain(|fix| fix.position.is_some());
        assert_eq!(fixes.len(), expected.len(), "{name}");
        assert!(skipped.count(SkipKind::NoFix) >= 8);
        let damaged = u64::from(name.ends_with("bin"));
        assert!(skipped.count(SkipKind::Damaged) >= damaged, "{name}");
        for (fix, row) in fixes.iter().zip(&expected) {
            let get = |name: &str| row[name].unwrap();
            // Past the end of the week.
            assert!(near(fix.time, get("t_s")));
            let Some((Position::Geodetic(place), Some(covariance))) = fix.position else {
                panic!("{fix:?}");
            };
            assert!(near(place.lat.to_degrees(), get("lat_deg")));
            assert!(near(place.lon.to_degrees(), get("lon_deg")));
            assert!(near(place.height, get("height_m")));
            let std = ["std_lat", "std_lon", "std_height"].map(|name| get(name).powi(2));
            assert!(same(covariance.diagonal(), std));
            let (velocity, unknown) = fix.velocity.unwrap();
            let (speed, course) = (get("speed"), get("course_deg").to_radians());
            let expected = [speed * course.cos(), speed * course.sin(), -get("up")];
            assert!(same(velocity, expected) && unknown.is_none());
            let quality = match get("kind") as u8 {
                16 => FixQuality::Single,
                17 => FixQuality::Differential,
                34 => FixQuality::Float,
                _ => FixQuality::Fixed,
            };
            assert_eq!(fix.quality, quality);
        }
    }
}

#[test]
fn a_worse_stream_can_be_asked_for() {
    let wanted = Wanted::Fixes {
        position: Some("PSRPOS".to_owned()),
        velocity: None,
        base: None,
        at_once: false,
    };
    let (found, _) = all(entries, &golden("novatel/fixes.bin"), &wanted);
    let with_position = found.iter().filter(|entry| match entry.what {
        What::Fix(fix) => fix.position.is_some(),
        _ => false,
    });
    assert_eq!(with_position.count(), 52);
    let unknown = Wanted::Poses(Some("INSATT".to_owned()));
    assert!(refused(entries, b"", &unknown).contains("available: BESTGNSSPOS"));
}

#[test]
fn late_velocities_belong_to_the_time_before() {
    let (fixes, _) = fixes(entries, &golden("novatel/late.asc"));
    assert_eq!(fixes.len(), 40);
    assert!(fixes.windows(2).all(|pair| pair[0].time < pair[1].time));
    for (k, fix) in fixes.iter().enumerate() {
        // The first position is at 100 000 s, its velocity 0.25 s before that.
        assert!(near(fix.time, 99_999.75 + 0.25 * k as f64));
        assert_eq!(fix.velocity.is_some(), k % 2 == 0);
        assert_eq!(fix.position.is_some(), k % 2 == 1);
    }
}

#[test]
fn counts_become_rates() {
    for (name, expected) in [("raw.bin", "raw.csv"), ("epson.asc", "epson.csv")] {
        let readings = imu(entries, &golden(&format!("novatel/{name}")), None);
        let expected = table(&format!("novatel/{expected}"));
        assert_eq!(readings.len(), expected.len(), "{name}");
        for (reading, row) in readings.iter().zip(&expected) {
            let get = |name: &str| row[name].unwrap();
            assert!(near(reading.time, get("t_s")));
            // An interval of 8 ms is the difference of stamps of 6e5 s, each rounded by 6e-11 s.
            let close = |a: f64, b: f64| (a - b).abs() <= 2e-8 * b.abs();
            let gyro = ["gx", "gy", "gz"].map(get);
            let accel = ["ax", "ay", "az"].map(get);
            let all_close = |v: Vector3, w: [f64; 3]| v.iter().zip(w).all(|(v, w)| close(*v, w));
            assert!(all_close(reading.gyro, gyro), "{reading:?} {gyro:?}");
            assert!(all_close(reading.accel, accel), "{reading:?} {accel:?}");
        }
    }
}

#[test]
fn a_receivers_own_messages_are_read() {
    // Examples of NovAtel's documentation.
    let text = b"%RAWIMUSXA,2209,491674.014;04,41,2209,491674.013699,ea59fe00,329308016,-2706935,4508389,196192,417138,-1000837*038422a7\r\n";
    let readings = imu(entries, text, None);
    assert_eq!(readings[0].time, 491_674.013_699);
    // It is at rest, about upright.
    assert!((readings[0].accel.norm() - 9.8).abs() < 0.1, "{readings:?}");
    assert!(readings[0].gyro.norm() < 0.01);
    let text = b"#BESTPOSA,USB1,0,58.5,FINESTEERING,2209,502061.000,02000020,cdba,16809;SOL_COMPUTED,PPP,51.15043706870,-114.03067882331,1097.3462,-17.0001,WGS84,0.0154,0.0139,0.0288,\"TSTR\",11.000,0.000,43,39,39,38,00,00,7f,37*52483ac5\r\n";
    let (fixes, _) = fixes(entries, text);
    assert_eq!(fixes[0].time, 502_061.0);
    let place = Geodetic::from_degrees(51.150_437_068_7, -114.030_678_823_31, 1097.3462 - 17.0001);
    assert_eq!(fixes[0].position.unwrap().0, Position::Geodetic(place));
    assert_eq!(fixes[0].quality, FixQuality::Differential);
}

#[test]
fn without_the_type_of_the_imu_counts_are_refused() {
    let text = golden("novatel/epson.asc");
    let raw = text
        .split_inclusive(|&byte| byte == b'\n')
        .filter(|line| line.starts_with(b"%RAWIMUSA"))
        .collect::<Vec<_>>()
        .concat();
    let error = refused(entries, &raw, &Wanted::Imu(None));
    assert!(error.contains("RAWIMUSX or INSCONFIG"), "{error}");
    assert_eq!(imu(entries, &raw, Some("RAWIMUS:EPSON_G320")).len(), 40);
    let error = refused(
        entries,
        &raw,
        &Wanted::Imu(Some("RAWIMUS:MPU6050".to_owned())),
    );
    assert!(error.contains("EPSON_G320"), "{error}");
    // A type without public scale factors.
    let example = "RAWIMUSXA,2209,491674.014;04,99,2209,491674.013699,00000000,1,2,3,4,5,6";
    let sum = example.bytes().fold(0u32, |sum, byte| {
        (0..8).fold(sum ^ u32::from(byte), |sum, _| {
            (sum >> 1) ^ (0xedb8_8320 * (sum & 1))
        })
    });
    let text = format!("%{example}*{sum:08x}\n");
    let error = refused(entries, text.as_bytes(), &Wanted::Imu(None));
    assert!(error.contains("IMU of type 99"), "{error}");
}

#[test]
fn the_inertial_systems_solutions_are_references() {
    let bytes = golden("novatel/reference.bin");
    for (name, expected) in [("INSPVAS", "reference.csv"), ("INSPVAX", "extended.csv")] {
        let poses = poses(entries, &bytes, Some(name));
        let expected = table(&format!("novatel/{expected}"));
        assert_eq!(poses.len(), expected.len(), "{name}");
        for (pose, row) in poses.iter().zip(&expected) {
            let get = |name: &str| row[name].unwrap();
            assert!(near(pose.time, get("t_s")));
            assert!(near(pose.position.lat.to_degrees(), get("lat_deg")));
            assert!(near(pose.position.lon.to_degrees(), get("lon_deg")));
            assert!(near(pose.position.height, get("height_m")));
            assert!(same(pose.v_n.unwrap(), [get("vn"), get("ve"), -get("vu")]));
            let rpy = ["roll_deg", "pitch_deg", "yaw_deg"].map(|name| get(name).to_radians());
            assert!(same(pose.rpy.unwrap(), rpy));
        }
    }
    let error = refused(entries, &bytes, &Wanted::Poses(None));
    assert!(error.contains("INSPVAS and INSPVAX"), "{error}");
    // As fixes, with the standard deviations of INSPVAX.
    let wanted = Wanted::Fixes {
        position: Some("INSPVAX".to_owned()),
        velocity: None,
        base: None,
        at_once: false,
    };
    let (found, _) = all(entries, &bytes, &wanted);
    assert_eq!(found.len(), 7);
    let What::Fix(fix) = &found[0].what else {
        panic!("{found:?}")
    };
    let covariance = fix.velocity.unwrap().1.unwrap();
    assert!(same(
        covariance.diagonal(),
        [0.03125, 0.0625, 0.125].map(|s: f64| s * s)
    ));
    // The antenna's positions, if those are asked for.
    let error = refused(entries, &golden("novatel/fixes.asc"), &Wanted::Poses(None));
    assert!(error.contains("topic = \"BESTPOS\""), "{error}");
    assert_eq!(
        poses(entries, &golden("novatel/fixes.asc"), Some("BESTPOS")).len(),
        56
    );
}

#[test]
fn streams_are_listed() {
    let streams = streams(source_of(&golden("novatel/reference.bin"))).unwrap();
    let listed: Vec<_> = streams
        .iter()
        .map(|s| (s.name.as_str(), s.kind, s.messages))
        .collect();
    let expected = [
        ("INSPVAS", StreamKind::Poses, 80),
        ("INSPVAX", StreamKind::Poses, 8),
    ];
    assert_eq!(listed, expected);
}

#[test]
fn known_by_content() {
    for name in ["fixes.bin", "fixes.asc", "raw.bin", "epson.asc"] {
        let bytes = golden(&format!("novatel/{name}"));
        assert_eq!(
            crate::log::detect(&bytes),
            Some(crate::format::Format::Novatel)
        );
    }
    for other in [&b"#comment\n%another\n"[..], b"\xaa\x44\x12\x1c", b""] {
        assert!(!detect(other));
    }
}

#[test]
fn damage_costs_only_itself() {
    for name in ["novatel/fixes.bin", "novatel/fixes.asc"] {
        let bytes = golden(name);
        cut_at_every_byte(entries, &bytes[..bytes.len().min(3000)]);
        flip_every_byte(entries, &bytes[..bytes.len().min(3000)], 1);
        whatever_the_source(entries, &bytes);
    }
    let bytes = golden("novatel/raw.bin");
    let whole = imu(entries, &bytes, None).len();
    for k in (0..bytes.len()).step_by(97) {
        let mut flipped = bytes.clone();
        flipped[k] ^= 1 << (k % 8);
        for wanted in [FIXES, Wanted::Imu(None), Wanted::Poses(None)] {
            let (found, _, _) = try_all(entries, source_of(&flipped), &wanted);
            assert!(found.len() <= whole);
        }
        assert!(imu(entries, &flipped, None).len() + 1 >= whole, "byte {k}");
    }
}
