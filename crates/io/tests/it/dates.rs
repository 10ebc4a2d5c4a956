//! The date from every reader that knows one into every writer with dates, and back.

use std::io::Cursor;
use std::path::{Path, PathBuf};

use undrift_io::Opened;
use undrift_io::epoch::{ClockSource, Epoch};
use undrift_io::format::Format;
use undrift_io::gnss::{FixOptions, GnssLog, GnssReader};
use undrift_io::imu::{ImuFormat, ImuReader};
use undrift_io::layouts;
use undrift_io::table::Column;
use undrift_io::truth::{TruthFormat, TruthLog, TruthReader};
use undrift_io::write::solution::SolutionRow;
use undrift_io::write::{SolutionFile, SolutionFormat, SolutionOptions};
use undrift_nav::Vector3;
use undrift_nav::sample::Position;

fn golden(name: &str) -> PathBuf {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../testdata/golden/formats");
    Path::new(folder).join(name)
}

fn fixes(path: &Path) -> GnssReader {
    let opened = Opened::open(path).unwrap();
    let options = GnssLog {
        fixes: FixOptions {
            position_std: Some([1.0; 3]),
            velocity_std: Some([1.0; 3]),
            ..FixOptions::default()
        },
        ..GnssLog::new(opened.format())
    };
    GnssReader::new(opened, &options.into()).unwrap()
}

fn samples(path: &Path, stream: Option<&str>) -> ImuReader {
    let opened = Opened::open(path).unwrap();
    let format = ImuFormat::log(opened.format(), stream.map(str::to_owned));
    ImuReader::new(opened, &format).unwrap()
}

/// Logs with fixes, and UTC of the first as the scripts beside the files have it.
const FIXES: [(&str, &str, ClockSource); 11] = [
    (
        "nmea/drive.nmea",
        "2025-07-12T23:59:36.000Z",
        ClockSource::Gnss,
    ),
    (
        "gpx/track.gpx",
        "2025-07-12T23:59:12.000Z",
        ClockSource::Utc,
    ),
    (
        "ubx/drive.ubx",
        "2025-07-12T23:59:32.000Z",
        ClockSource::Gnss,
    ),
    ("ubx/old.ubx", "2014-07-06T00:16:24.000Z", ClockSource::Gnss),
    (
        "sbf/fixes.sbf",
        "2025-07-12T23:59:38.000Z",
        ClockSource::Gnss,
    ),
    (
        "novatel/fixes.bin",
        "2025-07-12T23:59:36.000Z",
        ClockSource::Gnss,
    ),
    (
        "dataflash/flight.BIN",
        "2025-07-10T00:00:12.200Z",
        ClockSource::Gnss,
    ),
    (
        "ulog/old.ulg",
        "2017-07-14T02:40:05.016Z",
        ClockSource::Gnss,
    ),
    (
        "mcap/rosbag2.mcap",
        "2025-07-12T23:59:41.500Z",
        ClockSource::Host,
    ),
    (
        "rosbag/none.bag",
        "2025-07-12T23:59:41.500Z",
        ClockSource::Host,
    ),
    (
        "sensor-logger/drive",
        "2025-07-08T19:34:00.000Z",
        ClockSource::Host,
    ),
];

#[test]
fn fixes_keep_their_date_through_the_files_written_of_them() {
    for (name, utc, clock) in FIXES {
        let mut reader = fixes(&golden(name));
        let read: Vec<_> = reader.by_ref().map_while(Result::ok).collect();
        let epoch = reader.epoch().unwrap_or_else(|| panic!("{name}: no date"));
        assert_eq!(epoch.clock, clock, "{name}");
        assert_eq!(epoch.iso(read[0].time), utc, "{name}");
        let rows: Vec<SolutionRow> = read
            .iter()
            .filter_map(|fix| match fix.position {
                Some((Position::Geodetic(place), _)) => Some(SolutionRow {
                    v_n: Vector3::new(1.0, 0.0, 0.0),
                    rpy: Vector3::zeros(),
                    nav_std: [1.0; 9],
                    ..SolutionRow::at(fix.time, place)
                }),
                _ => None,
            })
            .collect();
        for format in [
            SolutionFormat::Gpx,
            SolutionFormat::Nmea,
            SolutionFormat::Mcap,
        ] {
            let stem = name.replace(['/', '.'], "-");
            let file = format!(
                "undrift-io-dates-{}-{stem}.{}",
                std::process::id(),
                format.name()
            );
            let path = std::env::temp_dir().join(file);
            let options = SolutionOptions {
                epoch: Some(epoch),
                every: Some(0.0),
                ..SolutionOptions::default()
            };
            let mut file = SolutionFile::create(&path, format, &options).unwrap();
            rows.iter().for_each(|row| file.write(row, false).unwrap());
            file.finish().unwrap();
            let mut again = fixes(&path);
            let back: Vec<_> = again.by_ref().map(Result::unwrap).collect();
            std::fs::remove_file(&path).unwrap();
            let there = again.epoch().unwrap();
            assert_eq!(back.len(), rows.len(), "{name} as {}", format.name());
            for (fix, row) in back.iter().zip(&rows) {
                // GPX and NMEA have milliseconds.
                let off = there.unix(fix.time) - epoch.unix(row.time);
                assert!(off.abs() < 6e-4, "{name} as {}: {off} s", format.name());
            }
        }
    }
}

#[test]
fn samples_and_references_have_the_date_too() {
    for (name, stream, utc) in [
        ("ubx/sensors.ubx", None, "2025-07-12T23:59:30.765Z"),
        ("sbf/sensors.sbf", None, "2025-07-12T23:59:38.000Z"),
        ("novatel/epson.asc", None, "2025-07-07T03:46:22.016Z"),
        ("dataflash/flight.BIN", None, "2025-07-10T00:00:11.891Z"),
        ("ulog/old.ulg", None, "2017-07-14T02:40:05.000Z"),
        (
            "gnsslogger/phone.txt",
            Some("UncalGyro"),
            "2025-07-12T23:59:30.010Z",
        ),
        ("sensor-logger/drive", None, "2025-07-08T19:34:00.010Z"),
        ("mcap/ros1.mcap", None, "2025-07-12T23:59:41.500Z"),
        ("rosbag2/plain.db3", None, "2025-07-12T23:59:41.500Z"),
    ] {
        let mut reader = samples(&golden(name), stream);
        let first = reader.next().unwrap().unwrap();
        let epoch = reader.epoch().unwrap_or_else(|| panic!("{name}: no date"));
        assert_eq!(epoch.iso(first.time), utc, "{name}");
    }
    // As printed by date -u -d @1403636579.759.
    let mut euroc = ImuReader::open(&golden("euroc/imu.csv"), &layouts::euroc_imu()).unwrap();
    let first = euroc.next().unwrap().unwrap();
    let utc = euroc.epoch().unwrap().iso(first.time);
    assert_eq!(utc, "2014-06-24T19:02:59.759Z");
    for name in ["week.txt", "date.txt", "commas.csv"] {
        let log = TruthLog {
            format: Format::Explorer,
            stream: None,
            time_offset: 0.0,
            span: None,
        };
        let path = golden("explorer").join(name);
        let mut reader = TruthReader::open(&path, &log.into()).unwrap();
        let first = reader.next().unwrap().unwrap();
        let utc = reader.epoch().map(|epoch| epoch.iso(first.time));
        assert_eq!(utc.as_deref(), Some("2025-07-09T23:59:12.000Z"), "{name}");
    }
}

#[test]
fn logs_without_a_date_claim_none() {
    for name in ["nmea/undated.nmea", "navego/plain.mat", "ulog/flight.ulg"] {
        let mut reader = fixes(&golden(name));
        reader.next().unwrap().unwrap();
        assert_eq!(reader.epoch(), None, "{name}");
    }
}

#[test]
fn tables_have_dates_unix_times_and_gps_weeks() {
    // 8 July 2025 19:34:00.5 UTC, by `date -u +%s` 1752003240.5: second 243258.5 of GPS week 2374.
    for (stamp, date, scale, clock) in [
        ("2025-07-08T19:34:00.5Z", "", 1.0, ClockSource::Utc),
        ("2025-07-08 21:34:00.5+02:00", "", 1.0, ClockSource::Utc),
        ("2025-07-08 19:34:00.5", "", 1.0, ClockSource::NoZone),
        ("19:34:00.5", "2025-07-08", 1.0, ClockSource::NoZone),
        ("243258.5", "2374", 1.0, ClockSource::Gnss),
        ("1752003240.5", "", 1.0, ClockSource::Utc),
        ("1752003240500000000", "", 1e-9, ClockSource::Utc),
    ] {
        let text = format!("t,lat,lon,h,d\n{stamp},1,2,3,{date}\n");
        let place = [2, 3, 4].map(Column::Number);
        let format = TruthFormat {
            time_scale: scale,
            date: (!date.is_empty()).then_some(Column::Number(5)),
            ..TruthFormat::degrees(Column::Number(1), place)
        };
        let opened = Opened::stream(Path::new("t.csv"), Cursor::new(text.into_bytes())).unwrap();
        let mut reader = TruthReader::new(opened, &format.into()).unwrap();
        let first = reader.next().unwrap().unwrap();
        let epoch = reader.epoch().unwrap_or_else(|| panic!("{stamp}: no date"));
        assert_eq!(epoch.clock, clock, "{stamp}");
        // Nanoseconds of today are exact to 0.3 µs as doubles.
        let off = epoch.after(Epoch::of_week(2374, clock)) + first.time - 243_258.5;
        assert!(off.abs() < 1e-6, "{stamp}: {off}");
    }
}
