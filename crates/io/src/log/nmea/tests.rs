use undrift_nav::Matrix3;
use undrift_nav::earth::Geodetic;
use undrift_nav::sample::{FixQuality, Position};

use super::{detect, entries, streams};
use crate::entry::{Fix, Wanted, What};
use crate::log::receiver::testing::{
    all, cut_at_every_byte, fixes, flip_every_byte, golden, source_of, table, try_all,
    whatever_the_source,
};
use crate::skipped::SkipKind;

/// Minutes of the golden sentences have seven decimals, of which the parser of the golden values
/// keeps as many of degrees: half of 1e-7° \[rad\].
const ANGLE: f64 = 0.9e-9;
/// Some roundings of times of 6e5 s.
const TIME: f64 = 1e-9;

fn place(fix: &Fix) -> (Geodetic, Option<Matrix3>) {
    match fix.position.unwrap() {
        (Position::Geodetic(place), covariance) => (place, covariance),
        other => panic!("{other:?}"),
    }
}

#[test]
fn the_sentences_of_an_epoch_are_one_fix() {
    let (fixes, skipped) = fixes(entries, &golden("nmea/drive.nmea"));
    let mut expected = table("nmea/fixes.csv");
    let text = String::from_utf8(golden("nmea/fixes.csv")).unwrap();
    let void: Vec<bool> = text
        .lines()
        .skip(1)
        .map(|line| line.contains(",V,"))
        .collect();
    let mut void = void.iter();
    expected.retain(|row| {
        let quality = row["quality"].unwrap();
        !void.next().unwrap() && (1.0..=5.0).contains(&quality)
    });
    assert_eq!(fixes.len(), expected.len());
    assert_eq!(skipped.count(SkipKind::NoFix), 150 - expected.len() as u64);
    for (fix, row) in fixes.iter().zip(&expected) {
        let get = |name: &str| row[name].unwrap();
        assert!(
            (fix.time - get("t_s")).abs() < TIME,
            "{} {}",
            fix.time,
            get("t_s")
        );
        let (place, covariance) = place(fix);
        assert!((place.lat - get("lat").to_radians()).abs() < ANGLE);
        assert!((place.lon - get("lon").to_radians()).abs() < ANGLE);
        // One sum.
        assert!((place.height - get("alt") - get("sep")).abs() < 1e-10);
        // 12.345 kn at 87.65°, by the definition of the knot; a rounding of each factor.
        let (velocity, unknown) = fix.velocity.unwrap();
        let speed = 12.345 * 1852.0 / 3600.0;
        assert!((velocity.norm() - speed).abs() < 1e-14 && velocity.z == 0.0);
        assert!((velocity.y.atan2(velocity.x) - 87.65f64.to_radians()).abs() < 1e-15);
        assert!(unknown.is_none());
        let quality = match get("quality") as u8 {
            2 => FixQuality::Differential,
            4 => FixQuality::Fixed,
            5 => FixQuality::Float,
            _ => FixQuality::Single,
        };
        assert_eq!(fix.quality, quality);
        let Some(down) = row["stdAlt"] else {
            assert!(covariance.is_none());
            continue;
        };
        let covariance = covariance.unwrap();
        assert!((covariance[(2, 2)] - down * down).abs() < 1e-15);
        if let (Some(north), Some(east)) = (row["stdLat"], row["stdLong"]) {
            assert!((covariance[(0, 0)] - north * north).abs() < 1e-15);
            assert!((covariance[(1, 1)] - east * east).abs() < 1e-15);
            continue;
        }
        // The axes of the ellipse are eigenvectors, and their squares the eigenvalues.
        let direction = get("orient").to_radians();
        let along = undrift_nav::Vector3::new(direction.cos(), direction.sin(), 0.0);
        let across = undrift_nav::Vector3::new(-direction.sin(), direction.cos(), 0.0);
        for (axis, size) in [(along, get("stdMajor")), (across, get("stdMinor"))] {
            assert!((covariance * axis - axis * size * size).amax() < 1e-15);
        }
    }
    // A damaged GGA in every tenth epoch, and one cut short in another.
    assert_eq!(skipped.count(SkipKind::Damaged), 30);
    assert_eq!(skipped.total(), 30 + skipped.count(SkipKind::NoFix));
}

#[test]
fn without_a_date_the_day_is_counted_across_midnight() {
    let (fixes, skipped) = fixes(entries, &golden("nmea/undated.nmea"));
    let times: Vec<f64> = fixes.iter().map(|fix| fix.time).collect();
    let expected: Vec<f64> = (0..10).map(|k| 86_395.0 + f64::from(k)).collect();
    assert_eq!(times, expected);
    // No separation at first: said once, and the heights stay above sea level though there is one
    // later.
    assert_eq!(skipped.count(SkipKind::MissingField), 1);
    assert!((place(&fixes[9]).0.height - 161.124).abs() < 1e-10);
}

#[test]
fn a_late_date_holds_for_what_waited_for_it() {
    let (fixes, _) = fixes(entries, &golden("nmea/late.nmea"));
    // Saturday 23:59:55 UTC is 13 s after the end of the GPS week, so of the next one.
    let expected: Vec<f64> = (0..13).map(|k| 13.0 + f64::from(k)).collect();
    let times: Vec<f64> = fixes.iter().map(|fix| fix.time).collect();
    assert_eq!(times, expected);
}

fn with_checksum(body: &str) -> String {
    let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${body}*{sum:02X}\r\n")
}

#[test]
fn what_cannot_be_used_is_counted() {
    let gga = |fields: &str| with_checksum(&format!("GPGGA,{fields}"));
    for (fields, kind) in [
        (
            "x,4807.038,N,01131.000,E,1,8,0.9,545.4,M,46.9,M,,",
            SkipKind::Text,
        ),
        (
            "250000,4807.038,N,01131.000,E,1,8,0.9,545.4,M,46.9,M,,",
            SkipKind::Text,
        ),
        (
            "12é519,4807.038,N,01131.000,E,1,8,0.9,545.4,M,46.9,M,,",
            SkipKind::Text,
        ),
        (
            "123519,4867.038,N,01131.000,E,1,8,0.9,545.4,M,46.9,M,,",
            SkipKind::Text,
        ),
        (
            "123519,4807.038,X,01131.000,E,1,8,0.9,545.4,M,46.9,M,,",
            SkipKind::Text,
        ),
        (
            "123519,-4807.038,N,01131.000,E,1,8,0.9,545.4,M,46.9,M,,",
            SkipKind::Text,
        ),
        (
            "123519,4807.038,N,01131.000,E,1,8,0.9,nan,M,46.9,M,,",
            SkipKind::Text,
        ),
        (
            "123519,4807.038,N,01131.000,E,1,8,0.9,,M,46.9,M,,",
            SkipKind::MissingField,
        ),
        ("123519,4807.038,N", SkipKind::NoFix),
        (
            "123519,9107.038,N,01131.000,E,1,8,0.9,545.4,M,46.9,M,,",
            SkipKind::OutOfRange,
        ),
        (
            "123519,0000.000,N,00000.000,E,1,8,0.9,545.4,M,46.9,M,,",
            SkipKind::OutOfRange,
        ),
        (
            "123519,4807.038,N,01131.000,E,1,8,0.9,9e99,M,46.9,M,,",
            SkipKind::OutOfRange,
        ),
    ] {
        let (found, skipped) = fixes(entries, gga(fields).as_bytes());
        assert!(found.is_empty(), "{fields}");
        assert_eq!((skipped.count(kind), skipped.total()), (1, 1), "{fields}");
    }
    let good = gga("123519,4807.038,N,01131.000,E,1,8,0.9,545.4,M,46.9,M,,");
    let unusable = with_checksum("GPGST,123519,1,1,1,1,0,0.1,0.1");
    let (found, skipped) = fixes(entries, (good.clone() + &unusable).as_bytes());
    assert!(place(&found[0]).1.is_none());
    assert_eq!(skipped.count(SkipKind::Uncertainty), 1);
    // No checksum, and one behind garbage and a sentence without its end.
    let (found, skipped) = fixes(entries, good.replace('*', ",").as_bytes());
    assert!(found.is_empty() && skipped.count(SkipKind::Damaged) == 1);
    let (found, skipped) = fixes(entries, format!("\0$\u{7f}$GPRMC,12{good}").as_bytes());
    assert_eq!((found.len(), skipped.count(SkipKind::Damaged)), (1, 1));
    // Before the receiver knows the time, there is nothing to say.
    let (found, skipped) = fixes(entries, gga(",,,,,0,00,99.99,,,,,,").as_bytes());
    assert!(found.is_empty() && skipped.is_empty());
}

#[test]
fn dates_of_two_digits_and_impossible_ones() {
    let at = |date: &str| {
        let rmc = format!("GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,{date},003.1,W");
        let gga = "GPGGA,123519,4807.038,N,01131.000,E,1,8,0.9,545.4,M,46.9,M,,";
        let text = with_checksum(&rmc) + &with_checksum(gga);
        fixes(entries, text.as_bytes()).0[0].time
    };
    // 23 March 1994 was a Wednesday, when GPS was 9 s ahead; 12:35:19 are 45 319 s.
    assert_eq!(at("230394"), 3.0 * 86_400.0 + 45_319.0 + 9.0);
    for date in ["", "320125", "011325", "2301", "23019x"] {
        assert_eq!(at(date), 45_319.0, "{date}");
    }
}

#[test]
fn streams_and_names() {
    let found = streams(source_of(&golden("nmea/drive.nmea"))).unwrap();
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].name, "NMEA");
    // 150 epochs of three, four of five with a GST.
    assert_eq!(found[0].about, "GGA 150, GST 120, RMC 150, VTG 150");
    assert_eq!(found[0].messages, 570);
    assert!(streams(source_of(b"t,x\n")).unwrap().is_empty());
    let refused = |wanted: Wanted| {
        try_all(entries, source_of(b""), &wanted)
            .2
            .unwrap()
            .to_string()
    };
    assert!(refused(Wanted::Imu(None)).contains("no inertial samples"));
    assert!(refused(Wanted::Poses(Some("/fix".into()))).contains("available: NMEA"));
    let velocity = Wanted::Fixes {
        position: None,
        velocity: Some("NMEA".into()),
        base: None,
        at_once: false,
    };
    assert!(refused(velocity).contains("no stream of velocities"));
    let (poses, _) = all(
        entries,
        &golden("nmea/drive.nmea"),
        &Wanted::Poses(Some("NMEA".into())),
    );
    let What::Pose(pose) = poses[0].what else {
        panic!()
    };
    assert!(pose.v_n.is_none() && pose.time == 604_794.0);
}

#[test]
fn damage_of_any_kind() {
    let bytes = golden("nmea/drive.nmea");
    cut_at_every_byte(entries, &bytes[..4000]);
    // A wrong bit can damage a sentence's end and the next one's beginning, of two epochs.
    flip_every_byte(entries, &bytes[..3000], 2);
    whatever_the_source(entries, &bytes);
    let (none, skipped) = fixes(entries, b"");
    assert!(none.is_empty() && skipped.is_empty());
}

#[test]
fn known_by_its_sentences() {
    let drive = golden("nmea/drive.nmea");
    assert!(detect(&drive) && detect(&drive[..200]) && detect(&golden("nmea/undated.nmea")));
    assert!(!detect(&drive[..100]) && !detect(b"") && !detect(b"t,gx\n1,2\n$x,y*00\n"));
    // Sentences between messages of UBX: these have more to say.
    let found = crate::log::detect(&golden("ubx/drive.ubx"));
    assert_eq!(found, Some(crate::format::Format::Ubx));
}

/// Positions of RMC where no sentence has a height, once that is certain.
#[test]
fn rmc_and_gns_alone() {
    let rmc = |second: u32| {
        with_checksum(&format!(
            "GPRMC,1235{second:02},A,4807.038,N,01131.000,W,022.4,084.4,230325,,,A"
        ))
    };
    let text: String = (10..20).map(rmc).collect();
    let (found, skipped) = fixes(entries, text.as_bytes());
    assert_eq!((found.len(), skipped.count(SkipKind::MissingField)), (7, 1));
    let at = place(&found[0]).0;
    assert!((at.lat.to_degrees() - (48.0 + 7.038 / 60.0)).abs() < 1e-12);
    assert!((at.lon.to_degrees() + (11.0 + 31.0 / 60.0)).abs() < 1e-12);
    assert_eq!(at.height, 0.0);
    assert!((found[0].velocity.unwrap().0.norm() - 22.4 * 1852.0 / 3600.0).abs() < 1e-12);
    // One position without a height between others is not used.
    let gns = |second: u32, mode: &str| {
        with_checksum(&format!(
            "GNGNS,1235{second:02}.00,4807.038,N,01131.000,E,{mode},12,0.8,545.4,46.9,,"
        ))
    };
    let text: String = (10..20)
        .map(|second| {
            rmc(second)
                + &if second == 15 {
                    String::new()
                } else {
                    gns(second, "AR")
                }
        })
        .collect();
    let (found, skipped) = fixes(entries, text.as_bytes());
    assert_eq!((found.len(), skipped.total()), (9, 0));
    assert!((place(&found[0]).0.height - 592.3).abs() < 1e-9);
    assert!(found.iter().all(|fix| fix.quality == FixQuality::Fixed));
    let (found, skipped) = fixes(entries, (gns(10, "NN") + &gns(11, "DN")).as_bytes());
    assert_eq!((found.len(), skipped.count(SkipKind::NoFix)), (1, 1));
    assert_eq!(found[0].quality, FixQuality::Differential);
}
