use std::io::Cursor;

use undrift_nav::Matrix3;
use undrift_nav::sample::{FixQuality, GnssFix};

use super::*;
use crate::Opened;
use crate::format::Format;
use crate::gnss::{FixOptions, GnssLog, GnssReader};
use crate::skipped::Skipped;

fn reader(text: &str, options: &GnssLog) -> Result<GnssReader, ReadError> {
    let stream = Cursor::new(text.as_bytes().to_vec());
    let opened = Opened::stream("gnss.pos".as_ref(), stream)?;
    GnssReader::new(opened, &options.clone().into())
}

fn rows(text: &str, options: &GnssLog) -> (Vec<GnssFix>, Skipped) {
    let mut reader = reader(text, options).unwrap();
    let fixes = reader.by_ref().map(Result::unwrap).collect();
    (fixes, reader.skipped().clone())
}

fn options() -> GnssLog {
    GnssLog::new(Format::Rtklib)
}

const HEADER: &str = "% program : RTKLIB\n%  GPST latitude(deg) longitude(deg) height(m) Q ns \
    sdn(m) sde(m) sdu(m) sdne(m) sdeu(m) sdun(m) age(s) ratio vn(m/s) ve(m/s) vu(m/s) \
    sdvn sdve sdvu sdvne sdveu sdvun\n";

/// Roundings of products of order one.
const ROUNDING: f64 = 1e-15;

#[test]
fn covariances_come_out_north_east_down() {
    let text = format!(
        "{HEADER}2025/07/08 00:00:01 40 -105 1600 1.0000 21 2 3 4 1 -1 0.5 0 0 1 2 3 1 1 1 0 0 0\n"
    );
    let (fixes, skipped) = rows(&text, &options());
    assert!(skipped.is_empty(), "{skipped}");
    let fix = fixes[0];
    assert_eq!((fix.time, fix.quality), (172_801.0, FixQuality::Fixed));
    let (position, covariance) = fix.position.unwrap();
    let place = Geodetic::from_degrees(40.0, -105.0, 1600.0);
    assert_eq!(position, Position::Geodetic(place));
    // cov(n,e) = 1, cov(e,u) = −1, cov(u,n) = 0.25; down is minus up.
    let expected = Matrix3::new(4.0, 1.0, -0.25, 1.0, 9.0, 1.0, -0.25, 1.0, 16.0);
    assert!((covariance - expected).norm() < ROUNDING, "{covariance}");
    let (velocity, _) = fix.velocity.unwrap();
    assert_eq!(velocity, Vector3::new(1.0, 2.0, -3.0));

    let doubled = GnssLog {
        fixes: FixOptions {
            position_std_factor: 2.0,
            velocity_std: Some([0.1, 0.2, 0.3]),
            time_offset: -1.0,
            ..FixOptions::default()
        },
        ..options()
    };
    let fix = rows(&text, &doubled).0[0];
    assert_eq!(fix.time, 172_800.0);
    assert!((fix.position.unwrap().1 - expected * 4.0).norm() < 4.0 * ROUNDING);
    assert!((fix.velocity.unwrap().1[(2, 2)] - 0.09).abs() < ROUNDING);
}

#[test]
fn impossible_cross_terms_are_dropped_and_bad_deviations_are_counted() {
    let text = format!(
        "{HEADER}2374 1 40 -105 1600 5 9 1 1 1 2 0 0 0 0 1 2 3 0 0 0 0 0 0\n\
         2374 2 40 -105 1600 2 9 0 1 1 0 0 0 0 0 1 2 3 1 1 1 0 0 0\n\
         2374 3 0 0 0 0 0 1 1 1 0 0 0 0 0 1 2 3 1 1 1 0 0 0\n\
         2374 4 95 0 0 0 0 1 1 1 0 0 0 0 0 1 2 3 1 1 1 0 0 0\n\
         2374 5 40 x\n2374 6 40\nrubbish\n"
    );
    let (fixes, skipped) = rows(&text, &options());
    assert_eq!(fixes.len(), 2);
    assert_eq!(fixes[0].position.unwrap().1, Matrix3::identity());
    assert_eq!(fixes[0].quality, FixQuality::Single);
    assert!(fixes[0].velocity.is_none() && fixes[1].velocity.is_some());
    assert!(fixes[1].position.is_none());
    assert_eq!(skipped.count(SkipKind::Uncertainty), 2);
    assert_eq!(skipped.count(SkipKind::OutOfRange), 2);
    assert_eq!(skipped.count(SkipKind::Text), 2);
    assert_eq!(skipped.count(SkipKind::MissingField), 1);
}

#[test]
fn degrees_minutes_seconds_and_commas() {
    let text = "%  GPST,latitude(d'\"),longitude(d'\"),height(m),Q,ns,sdn(m),sde(m),sdu(m)\n\
        2025/07/08 00:00:01.000, 40 ,30,36.0,-0,15,0,100,1,9,1,1,1\n";
    let (fixes, skipped) = rows(text, &options());
    assert!(skipped.is_empty(), "{skipped}");
    let expected = Geodetic::from_degrees(40.51, -0.25, 100.0);
    let Position::Geodetic(place) = fixes[0].position.unwrap().0 else {
        panic!("no geodetic position");
    };
    // 1e-15 rad is 6 nm.
    assert!(
        (place.lat - expected.lat).abs() < ROUNDING && (place.lon - expected.lon).abs() < ROUNDING
    );
}

#[test]
fn ecef_is_turned_to_north_east_down() {
    let place = Geodetic::from_degrees(30.0, 40.0, 100.0);
    let (at, v_n) = (place.to_ecef(), Vector3::new(1.0, 2.0, 3.0));
    let v = place.ned_from_ecef().transpose() * v_n;
    let text = format!(
        "%  GPST x-ecef(m) y-ecef(m) z-ecef(m) Q ns sdx(m) sdy(m) sdz(m) sdxy(m) sdyz(m) sdzx(m) \
         age(s) ratio vx(m/s) vy(m/s) vz(m/s) sdvx sdvy sdvz sdvxy sdvyz sdvzx\n\
         2374 1 {} {} {} 6 9 2 2 2 0 0 0 0 0 {} {} {} 1 1 1 0 0 0\n",
        at.x, at.y, at.z, v.x, v.y, v.z
    );
    let (fixes, _) = rows(&text, &options());
    let fix = fixes[0];
    let (Position::Geodetic(found), covariance) = fix.position.unwrap() else {
        panic!("no geodetic position");
    };
    // A nanometre in coordinates of 6e6 m.
    assert!(place.offset_to(&found).norm() < 1e-8);
    assert!((covariance - Matrix3::identity() * 4.0).norm() < 10.0 * ROUNDING);
    assert!((fix.velocity.unwrap().0 - v_n).norm() < 10.0 * ROUNDING);
    assert_eq!(fix.quality, FixQuality::Differential);
}

#[test]
fn baselines_need_their_base() {
    let text = "%  GPST e-baseline(m) n-baseline(m) u-baseline(m) Q ns sde(m) sdn(m) sdu(m) \
        sden(m) sdnu(m) sdue(m)\n2374 1 10 20 30 1 9 1 2 3 0 -1 0\n";
    let error = reader(text, &options()).err();
    assert!(error.unwrap().to_string().contains("(key gnss.base)"));
    let base = Geodetic::from_degrees(40.0, -105.0, 1600.0);
    let options = GnssLog {
        base: Some(base),
        ..options()
    };
    let (position, covariance) = rows(text, &options).0[0].position.unwrap();
    let ned = Vector3::new(20.0, 10.0, -30.0);
    assert_eq!(position, Position::Baseline { base, ned });
    let expected = Matrix3::new(4.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 9.0);
    assert!((covariance - expected).norm() < ROUNDING, "{covariance}");
}

#[test]
fn a_file_without_header_is_refused() {
    for text in [
        "\n",
        "2374 1 40 -105 100 1 9\n",
        "% program\n2374 1 40 -105 100\n",
    ] {
        let error = reader(text, &options()).err();
        assert!(error.unwrap().to_string().contains("header"), "{text}");
    }
}

#[test]
fn rows_without_a_header_are_a_solution() {
    let row = |k: u32| {
        format!(
            "2024/02/07 12:00:{k:02}.000   50.123456789  4.123456789   120.1234   {}  12   0.0100   0.0200   0.0300   0.0010   0.0010   0.0010   0.50    5.0\n",
            if k == 0 { 2 } else { 1 }
        )
    };
    let text: String = (0..5).map(row).collect();
    assert!(detect(text.as_bytes()) && lacks_header(text.as_bytes()));
    assert!(detect(HEADER.as_bytes()) && !lacks_header(HEADER.as_bytes()));
    let (fixes, skipped) = rows(&text, &options());
    assert!(skipped.is_empty(), "{skipped}");
    assert_eq!((fixes.len(), fixes[0].time), (5, 302_400.0));
    assert_eq!(fixes[0].quality, FixQuality::Float);
    let (_, covariance) = fixes[4].position.unwrap();
    // The squares of the standard deviations, and of the root of the covariance north-east.
    let expected = [1e-4, 4e-4, 9e-4, 1e-6];
    let found = [(0, 0), (1, 1), (2, 2), (0, 1)].map(|place| covariance[place]);
    assert!(
        found
            .iter()
            .zip(expected)
            .all(|(a, b)| (a - b).abs() < ROUNDING),
        "{covariance}"
    );
}
