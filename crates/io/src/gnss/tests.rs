use std::io::Cursor;

use undrift_nav::earth::Geodetic;
use undrift_nav::sample::{FixQuality, Position};

use super::*;
use crate::Opened;
use crate::table::Column;
use crate::utm::UtmZone;
use std::path::Path;
use undrift_nav::Vector3;

fn group(from: usize) -> [Column; 3] {
    [0, 1, 2].map(|k| Column::Number(from + k))
}

/// Time, latitude and longitude \[deg\], height, velocity with up, stds of position and velocity, quality.
fn format() -> GnssFormat {
    GnssFormat {
        time: Column::Number(1),
        date: None,
        time_scale: 1.0,
        place: Some(PositionColumns::Geodetic {
            columns: group(2),
            angle_scale: 1f64.to_radians(),
            degrees_minutes: false,
            height_scale: 1.0,
            height: None,
        }),
        position_std: Some(group(8)),
        velocity: Some(group(5)),
        velocity_axes: VelocityAxes::Up,
        velocity_scale: 1.0,
        velocity_std: None,
        quality: Some(Column::Number(11)),
        delimiter: None,
        fixes: FixOptions {
            position_std_factor: 2.0,
            velocity_std: Some([0.1, 0.2, 0.5]),
            velocity_std_factor: 10.0,
            ..FixOptions::default()
        },
    }
}

fn reader(text: &str, format: &GnssFormat) -> Result<GnssReader, ReadError> {
    let path = Path::new("gnss.csv");
    let source = Box::new(Cursor::new(text.as_bytes().to_vec()));
    GnssReader::new(Opened::stream(path, source)?, &format.clone().into())
}

fn all(text: &str, format: &GnssFormat) -> (Vec<GnssFix>, Skipped) {
    let mut reader = reader(text, format).unwrap();
    let fixes = reader.by_ref().map(Result::unwrap).collect();
    (fixes, reader.skipped().clone())
}

#[test]
fn units_signs_and_factors() {
    let (fixes, skipped) = all("7,45,-90,100,1,2,3,1,2,3,1\n", &format());
    assert!(skipped.is_empty());
    let fix = fixes[0];
    let (position, covariance) = fix.position.unwrap();
    let place = Geodetic::from_degrees(45.0, -90.0, 100.0);
    assert_eq!(position, Position::Geodetic(place));
    assert_eq!(covariance.diagonal(), Vector3::new(4.0, 16.0, 36.0));
    let (velocity, covariance) = fix.velocity.unwrap();
    assert_eq!(velocity, Vector3::new(1.0, 2.0, -3.0));
    assert_eq!(covariance.diagonal(), Vector3::new(1.0, 4.0, 25.0));
    assert_eq!((fix.time, fix.quality), (7.0, FixQuality::Fixed));
}

#[test]
fn unusable_parts_leave_the_other_part() {
    let text = "1,45,-90,100,1,2,3,0,2,3,1\n\
                2,45,-90,100,nan,2,3,1,2,3,2\n\
                3,,,,1,2,3,1,2,3,9\n\
                4,0,0,0,1,2,3,1,2,3,9\n\
                5,90.1,0,0,1,2,3,1,2,3,9\n\
                6,45,-90,100,1,2,3,nan,2,3,5\n\
                6,45,-90,100,1,2,3,1,2,3,5\n\
                5,45,-90,100,1,2,3,1,2,3,5\n\
                nan,45,-90,100,1,2,3,1,2,3,5\n\
                8,45,-90,100,,,,,,,\n\
                9,45,-90,100,1,2,3,1,2,3,4\n";
    let (fixes, skipped) = all(text, &format());
    let parts: Vec<_> = fixes
        .iter()
        .map(|fix| (fix.time, fix.position.is_some(), fix.velocity.is_some()))
        .collect();
    let expected = [
        (1.0, false, true),
        (2.0, true, false),
        (3.0, false, true),
        (6.0, false, true),
        (9.0, true, true),
    ];
    assert_eq!(parts, expected);
    assert_eq!(fixes[2].quality, FixQuality::Unknown);
    assert_eq!(fixes[4].quality, FixQuality::Differential);
    assert_eq!(skipped.count(SkipKind::Uncertainty), 3);
    assert_eq!(skipped.count(SkipKind::OutOfRange), 2);
    assert_eq!(skipped.count(SkipKind::NotFinite), 4);
    assert_eq!(skipped.count(SkipKind::DuplicateTime), 1);
    assert_eq!(skipped.count(SkipKind::TimeBackwards), 1);
}

#[test]
fn baselines_and_spans() {
    let base = Geodetic::from_degrees(45.0, 7.0, 300.0);
    let baseline = GnssFormat {
        place: Some(PositionColumns::Baseline {
            ned: group(2),
            base,
        }),
        velocity: None,
        quality: None,
        fixes: FixOptions {
            position_std: Some([1.0; 3]),
            time_offset: 10.0,
            span: Some((12.0, 13.0)),
            ..FixOptions::default()
        },
        ..format()
    };
    let text = "t n e d\n1 0 0 0\n2 1 2 3\n3 1 2 3\n4 1 2 3\n";
    let (fixes, _) = all(text, &baseline);
    assert_eq!(fixes.len(), 2);
    let ned = Vector3::new(1.0, 2.0, 3.0);
    assert_eq!(
        fixes[0].position.unwrap().0,
        Position::Baseline { base, ned }
    );
    assert_eq!(fixes[0].time, 12.0);
}

#[test]
fn unusable_formats_and_files_are_named() {
    let nothing = GnssFormat {
        place: None,
        velocity: None,
        ..format()
    };
    assert!(reader("1\n", &nothing).is_err());
    let mut zero = format();
    zero.fixes.velocity_std = Some([0.1, 0.0, 0.1]);
    let error = reader("1\n", &zero).err().unwrap().to_string();
    assert!(error.contains("gnss.velocity_std"), "{error}");
    let unknown = GnssFormat {
        position_std: None,
        ..format()
    };
    let error = reader("1\n", &unknown).err().unwrap().to_string();
    assert!(error.contains("gnss.position_std"), "{error}");
    let mut none = reader("1,0,0,0,1,2,3,1,2,3,5\n", &format()).unwrap();
    let error = none.next().unwrap().unwrap_err().to_string();
    assert!(error.contains("never had a fix (line 1: 0, 0)"), "{error}");
    assert!(none.next().is_none());
}

/// On the equator at 90° east the Earth-fixed axes are west, up and north, so all is known without rounding
/// but that of the semi-major axis.
#[test]
fn speeds_with_a_course_and_heights_in_another_unit() {
    let polar = GnssFormat {
        velocity_axes: VelocityAxes::Course,
        velocity_scale: 1.0 / 3.6,
        ..format()
    };
    let (east, north) = (VelocityAxes::Course, Vector3::new(36.0, 90.0, 36.0));
    let turned = east.vector(north, polar.velocity_scale);
    assert!((turned - Vector3::new(0.0, 10.0, 0.0)).norm() < 1e-12);
    let climbing = Vector3::new(36.0, 90.0, 18.0);
    for (axes, down) in [
        (VelocityAxes::CourseDown, 5.0),
        (VelocityAxes::CourseUp, -5.0),
    ] {
        let turned = axes.to_ned(None).unwrap() * axes.vector(climbing, polar.velocity_scale);
        assert!(
            (turned - Vector3::new(0.0, 10.0, down)).norm() < 1e-12,
            "{axes:?}"
        );
    }
    let down = VelocityAxes::Down.vector(north, 0.5);
    assert_eq!(down, north * 0.5);
}

#[test]
fn earth_fixed_columns() {
    let earth_fixed = GnssFormat {
        place: Some(PositionColumns::Ecef(group(2))),
        velocity_axes: VelocityAxes::Ecef,
        velocity_scale: 1.0,
        velocity_std: Some(group(8)),
        fixes: FixOptions::default(),
        ..format()
    };
    let row = "7,0,6378237,0,1,2,3,0.5,0.25,2,1\n";
    let (fixes, skipped) = all(row, &earth_fixed);
    assert!(skipped.is_empty(), "{skipped}");
    let near = |a: f64, b: f64| (a - b).abs() < 1e-9;
    let (Position::Geodetic(place), covariance) = fixes[0].position.unwrap() else {
        panic!("{fixes:?}");
    };
    assert!(near(place.lat, 0.0) && near(place.lon, std::f64::consts::FRAC_PI_2));
    // 100 m above the semi-major axis of WGS-84, 6 378 137 m.
    assert!(near(place.height, 100.0));
    let squares = [4.0, 0.25, 0.0625];
    let (velocity, of_velocity) = fixes[0].velocity.unwrap();
    for covariance in [covariance, of_velocity] {
        assert!(
            covariance
                .diagonal()
                .iter()
                .zip(squares)
                .all(|(a, b)| near(*a, b))
        );
    }
    assert!((velocity - Vector3::new(3.0, -1.0, -2.0)).amax() < 1e-9);
    // Stated standard deviations are north, east, down.
    let stated = GnssFormat {
        fixes: FixOptions {
            position_std: Some([1.0, 2.0, 3.0]),
            velocity_std: Some([1.0, 2.0, 3.0]),
            ..FixOptions::default()
        },
        ..earth_fixed.clone()
    };
    let (fixes, _) = all(row, &stated);
    for covariance in [fixes[0].position.unwrap().1, fixes[0].velocity.unwrap().1] {
        assert!((covariance.diagonal() - Vector3::new(1.0, 4.0, 9.0)).amax() < 1e-9);
    }
    // The Earth's middle is no place, and a velocity without a place cannot be turned.
    assert!(
        reader("7,0,0,0,1,2,3,1,1,1,1\n", &earth_fixed)
            .unwrap()
            .next()
            .unwrap()
            .is_err()
    );
    let unplaced = GnssFormat {
        place: None,
        ..earth_fixed
    };
    let error = reader(row, &unplaced).err().unwrap().to_string();
    assert!(error.contains("gnss.velocity_axes"), "{error}");
}

/// Munich by PROJ, as in [`crate::utm`].
#[test]
fn eastings_and_northings() {
    let utm = GnssFormat {
        place: Some(PositionColumns::Utm {
            columns: group(2),
            zone: UtmZone::parse("32N").unwrap(),
            height_scale: 1.0,
            height: None,
        }),
        velocity: None,
        quality: None,
        fixes: FixOptions {
            position_std: Some([1.0; 3]),
            ..FixOptions::default()
        },
        ..format()
    };
    let text = "t e n h\n1 691611.2155 5334758.0528 520\n2 1e9 5334758 520\n3 nan 5334758 520\n";
    let (fixes, skipped) = all(text, &utm);
    assert_eq!((fixes.len(), skipped.total()), (1, 2), "{skipped}");
    let Some((Position::Geodetic(place), _)) = fixes[0].position else {
        panic!("{:?}", fixes[0]);
    };
    let expected = Geodetic::from_degrees(48.1372, 11.5756, 520.0);
    assert!((place.to_ecef() - expected.to_ecef()).norm() < 1e-4);
}
