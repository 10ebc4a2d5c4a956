//! The solution in the formats of others, read back by this crate's own readers.

use std::path::PathBuf;

use undrift_io::Opened;
use undrift_io::epoch::{ClockSource, Epoch};
use undrift_io::format::Format;
use undrift_io::gnss::{FixOptions, GnssLog, GnssReader};
use undrift_io::truth::{TruthLog, TruthReader};
use undrift_io::write::solution::SolutionRow;
use undrift_io::write::{SolutionFile, SolutionFormat, SolutionOptions};
use undrift_nav::Vector3;
use undrift_nav::earth::Geodetic;
use undrift_nav::sample::{GnssFix, Position};

/// GPS week of the track, which runs over its end.
const WEEK: u32 = 2374;

fn row(k: u32) -> SolutionRow {
    let x = f64::from(k);
    SolutionRow {
        v_n: Vector3::new(2.0, -3.5, 0.0),
        rpy: Vector3::new(0.01, -0.02, -1.0),
        nav_std: [0.5, 0.75, 1.25, 0.1, 0.1, 0.1, 0.01, 0.01, 0.02],
        gyro_error: Vector3::zeros(),
        accel_error: Vector3::zeros(),
        error_std: [0.0; 6],
        ..SolutionRow::at(
            604_794.0 + 0.2 * x,
            Geodetic::from_degrees(-33.86 + 1e-6 * x, 151.2 - 2e-6 * x, 25.0 + 0.01 * x),
        )
    }
}

/// Writes the track and reads its fixes.
fn round_trip(format: SolutionFormat, log: Format) -> Vec<GnssFix> {
    let path: PathBuf = std::env::temp_dir().join(format!(
        "undrift-io-round-trip-{}-{}",
        std::process::id(),
        format.name()
    ));
    let options = SolutionOptions {
        epoch: Some(Epoch::of_week(WEEK, ClockSource::Gnss)),
        name: "track".into(),
        every: None,
        frame: None,
    };
    let mut file = SolutionFile::create(&path, format, &options).unwrap();
    for k in 0..60 {
        file.write(&row(k), false).unwrap();
    }
    file.finish().unwrap();
    assert_eq!(Opened::open(&path).unwrap().format(), log);
    let options = GnssLog {
        fixes: FixOptions {
            position_std: (log == Format::Gpx).then_some([1.0; 3]),
            ..FixOptions::default()
        },
        ..GnssLog::new(log)
    };
    let mut wrong = options.clone();
    wrong.fixes.velocity_std_factor = 0.0;
    let refused = GnssReader::open(&path, &wrong.into()).err().unwrap();
    assert!(refused.to_string().contains("(key gnss.velocity_std)"));
    let fixes = GnssReader::open(&path, &options.into()).unwrap();
    let fixes: Vec<GnssFix> = fixes.map(Result::unwrap).collect();
    std::fs::remove_file(&path).unwrap();
    assert_eq!(fixes.len(), 60);
    fixes
}

/// Compares times, places to `angle` [rad] and `height` [m], and standard deviations to `std` [m].
fn compare(fixes: &[GnssFix], angle: f64, height: f64, std: Option<f64>) {
    for (k, fix) in (0..).zip(fixes) {
        let wrote = row(k);
        // Formats with dates have milliseconds.
        assert!(
            (fix.time - wrote.time).abs() < 6e-4,
            "{} {}",
            fix.time,
            wrote.time
        );
        let Some((Position::Geodetic(place), covariance)) = fix.position else {
            panic!("no position");
        };
        assert!((place.lat - wrote.position.lat).abs() < angle, "{place:?}");
        assert!((place.lon - wrote.position.lon).abs() < angle, "{place:?}");
        assert!(
            (place.height - wrote.position.height).abs() < height,
            "{place:?}"
        );
        for axis in (0..3).filter(|_| std.is_some()) {
            let read = covariance[(axis, axis)].sqrt();
            assert!((read - wrote.nav_std[axis]).abs() < std.unwrap(), "{read}");
        }
    }
}

#[test]
fn nmea() {
    // Minutes and metres as the sentences have them: a unit of the last decimal of each.
    let minute = 1f64.to_radians() / 60.0;
    let fixes = round_trip(SolutionFormat::Nmea, Format::Nmea);
    compare(&fixes, 1e-7 * minute, 1e-3, Some(1e-3));
}

#[test]
fn gpx() {
    let fixes = round_trip(SolutionFormat::Gpx, Format::Gpx);
    compare(&fixes, 1e-9f64.to_radians(), 1e-3, None);
}

#[test]
fn mcap() {
    let fixes = round_trip(SolutionFormat::Mcap, Format::Mcap);
    // Doubles in degrees: some roundings.
    compare(&fixes, 1e-14, 1e-9, Some(1e-9));
}

#[test]
fn sbet() {
    let options = SolutionOptions {
        epoch: Some(Epoch::of_week(WEEK, ClockSource::Gnss)),
        ..SolutionOptions::default()
    };
    let out = std::io::Cursor::new(Vec::new());
    let mut file = SolutionFile::new(out, SolutionFormat::Sbet, &options).unwrap();
    for k in 0..60 {
        file.write(&row(k), false).unwrap();
    }
    let bytes = file.into_inner().unwrap().into_inner();
    // 17 doubles a record; the third velocity of the first is down.
    assert_eq!(bytes.len(), 60 * 136);
    let number = |k: usize| f64::from_le_bytes(bytes[8 * k..8 * k + 8].try_into().unwrap());
    assert_eq!([number(4), number(5), number(6)], [2.0, -3.5, 0.0]);
    assert_eq!(number(9), std::f64::consts::TAU - 1.0);
    assert!((10..17).all(|k| number(k) == 0.0));
    let opened = Opened::stream("track.sbet".as_ref(), std::io::Cursor::new(bytes)).unwrap();
    assert_eq!(opened.format(), Format::Sbet);
    let log = TruthLog {
        format: Format::Sbet,
        stream: None,
        time_offset: 0.0,
        span: None,
    };
    let samples = TruthReader::new(opened, &log.into()).unwrap();
    let samples: Vec<_> = samples.map(Result::unwrap).collect();
    assert_eq!(samples.len(), 60);
    for (sample, k) in samples.iter().zip(0..) {
        let row = row(k);
        assert_eq!((sample.time, sample.position), (row.time, row.position));
        // One turn more and less.
        assert!((sample.rpy.unwrap() - row.rpy).amax() < 1e-15);
    }
}

#[test]
fn a_table_is_no_log() {
    let path = std::env::temp_dir().join(format!("undrift-io-table-{}.csv", std::process::id()));
    std::fs::write(&path, "t,x\n0,1\n").unwrap();
    let message = GnssReader::open(&path, &GnssLog::new(Format::Csv).into())
        .err()
        .unwrap()
        .to_string();
    assert!(message.contains("specify its columns"), "{message}");
    let message = Opened::open(&path)
        .unwrap()
        .streams(Format::Csv)
        .unwrap_err();
    std::fs::remove_file(&path).unwrap();
    assert!(
        message.to_string().contains("specify its columns"),
        "{message}"
    );
}

#[test]
fn a_file_that_is_not_finished_is_none() {
    let path =
        std::env::temp_dir().join(format!("undrift-io-unfinished-{}.mcap", std::process::id()));
    let mut file =
        SolutionFile::create(&path, SolutionFormat::Mcap, &SolutionOptions::default()).unwrap();
    file.write(&row(0), false).unwrap();
    drop(file);
    assert!(!path.exists());
}
