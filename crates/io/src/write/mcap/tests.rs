use std::f64::consts::FRAC_PI_2;
use std::io::Cursor;
use std::path::PathBuf;

use undrift_nav::earth::Geodetic;
use undrift_nav::sample::{FixQuality, Position};
use undrift_nav::{Matrix3, Quaternion, Vector3, attitude};

use super::messages::ecef_from_ned;
use super::*;
use crate::Opened;
use crate::epoch::ClockSource;
use crate::format::Format;
use crate::log::{StreamKind, Wanted, What};
use crate::mcap_records::MAGIC;
use crate::write::PendingFile;

fn row(time: f64) -> SolutionRow {
    SolutionRow {
        time,
        position: Geodetic::from_degrees(48.0 + 1e-4 * time, 11.5, 560.25),
        v_n: Vector3::new(3.0, 4.0, 0.5),
        rpy: Vector3::new(0.1, -0.2, 2.5),
        nav_std: [1.0, 2.0, 3.0, 0.1, 0.2, 0.3, 0.01, 0.02, 0.03],
        gyro_error: Vector3::zeros(),
        accel_error: Vector3::zeros(),
        error_std: [0.0; 6],
    }
}

fn temporary(name: &str) -> PathBuf {
    std::env::temp_dir().join(format!("undrift-io-{}-{name}.mcap", std::process::id()))
}

/// Several chunks of messages.
const ROWS: u32 = 2500;

#[test]
fn what_is_written_is_read_again() {
    let path = temporary("round");
    // 8 July 2025, with a fraction of a second.
    let epoch = Epoch::of_unix(1_752_003_240.25, 0.0, ClockSource::Gnss);
    let mut writer = McapWriter::new(PendingFile::create(&path).unwrap(), epoch).unwrap();
    for k in 0..ROWS {
        writer.write(&row(0.01 * f64::from(k))).unwrap();
    }
    assert!(!path.exists());
    writer.into_inner().unwrap().finish().unwrap();

    let wanted = Wanted::Fixes {
        position: None,
        velocity: None,
        base: None,
        at_once: false,
    };
    let mut log = Opened::open(&path)
        .unwrap()
        .log(Format::Mcap, &wanted)
        .unwrap();
    for k in 0..ROWS {
        let What::Fix(fix) = log.next().unwrap().unwrap().what else {
            panic!("no fix")
        };
        let written = row(0.01 * f64::from(k));
        // 243 258.25 s of the week by `date`; stamps are of a nanosecond.
        let time = 243_258.25 + written.time;
        assert!((fix.time - time).abs() < 1e-9, "{} {time}", fix.time);
        let (Position::Geodetic(place), Some(covariance)) = fix.position.unwrap() else {
            panic!("no position")
        };
        // To degrees and back: two roundings, 6e-9 m.
        assert!(place.offset_to(&written.position).norm() < 2e-8);
        let squares = Vector3::new(1.0, 4.0, 9.0);
        assert_eq!(covariance, Matrix3::from_diagonal(&squares));
        assert_eq!(fix.quality, FixQuality::Single);
    }
    assert!(log.next().unwrap().is_none());
    assert!(log.skipped().is_empty());

    let topics: Vec<_> = Opened::open(&path)
        .unwrap()
        .streams(Format::Mcap)
        .unwrap()
        .into_iter()
        .map(|stream| (stream.name, stream.kind, stream.messages))
        .collect();
    let topic = |name: &str, kind| (name.to_owned(), kind, u64::from(ROWS));
    assert_eq!(
        topics,
        [
            topic("/undrift/fix", StreamKind::Fixes),
            topic("/undrift/imu", StreamKind::Imu),
            topic("/undrift/odom", StreamKind::LocalPoses),
        ]
    );
    // The attitude alone is no inertial sample.
    let mut log = Opened::open(&path)
        .unwrap()
        .log(Format::Mcap, &Wanted::Imu(None))
        .unwrap();
    assert!(log.next().unwrap().is_none());
    assert_eq!(log.skipped().total(), u64::from(ROWS));
    std::fs::remove_file(&path).unwrap();
}

/// Its messages, summary and indices are read by others in crates/py/tests/test_mcap.py.
#[test]
fn a_clock_without_a_date_is_reported() {
    let mut writer = McapWriter::new(Vec::new(), None).unwrap();
    writer.write(&row(0.0)).unwrap();
    let file = writer.into_inner().unwrap();
    assert!(String::from_utf8_lossy(&file).contains("own clock"));
}

/// The numbers of a message after its texts: they end it.
fn last_numbers<const N: usize>(bytes: &[u8]) -> [f64; N] {
    let mut numbers = [0.0; N];
    let tail = &bytes[bytes.len() - 8 * N..];
    for (number, bytes) in numbers.iter_mut().zip(tail.chunks_exact(8)) {
        *number = f64::from_le_bytes(bytes.try_into().unwrap());
    }
    numbers
}

fn odometry(row: &SolutionRow, origin: &Geodetic) -> [f64; 85] {
    let mut messages = Messages::new(None);
    let first = SolutionRow {
        position: *origin,
        ..*row
    };
    messages.pose(&first);
    let stamp = messages.stamp(row).unwrap();
    last_numbers(messages.odometry(row, stamp))
}

fn quaternion(numbers: &[f64]) -> Quaternion {
    let &[x, y, z, w] = numbers else { panic!() };
    // By two half-turns, since there is no other way to one from its parts here.
    let angle = 2.0 * f64::hypot(f64::hypot(x, y), z).atan2(w);
    let axis = Vector3::new(x, y, z);
    Quaternion::from_scaled_axis(axis * (angle / axis.norm().max(1e-300)))
}

/// Some roundings of numbers of up to ten.
const ROUNDING: f64 = 1e-13;

#[test]
fn poses_are_those_of_rep_103() {
    let mut level = row(0.0);
    let here = level.position;
    // Facing east, nose up by 0.2 rad, moving forward: along x of the map and up.
    level.rpy = Vector3::new(0.0, 0.2, FRAC_PI_2);
    let (up, east) = (0.2f64.sin(), 0.2f64.cos());
    level.v_n = 5.0 * Vector3::new(0.0, east, -up);
    let odometry = odometry(&level, &here);
    assert_eq!(odometry[..3], [0.0; 3]);
    let q = quaternion(&odometry[3..7]);
    let axes = [
        (Vector3::x(), Vector3::new(east, 0.0, up)),
        (Vector3::y(), Vector3::new(0.0, 1.0, 0.0)),
        (Vector3::z(), Vector3::new(-up, 0.0, east)),
    ];
    for (body, map) in axes {
        assert!((q * body - map).amax() < ROUNDING, "{body}");
    }
    let velocity = Vector3::from_row_slice(&odometry[43..46]);
    assert!((velocity - Vector3::new(5.0, 0.0, 0.0)).amax() < ROUNDING);
    // Standard deviations of 1 m north, 2 m east, 3 m down.
    for (at, variance) in [(7, 4.0), (14, 1.0), (21, 9.0)] {
        assert!((odometry[at] - variance).abs() < ROUNDING, "{at}");
    }
    // Pitch is about left, which is north here; level, yaw would be about up alone.
    assert!((odometry[7 + 4 * 7] - 0.02f64.powi(2)).abs() < ROUNDING);
    // Forward is east and up, left is north.
    let (ve, vn, vd) = (0.04, 0.01, 0.09);
    assert!((odometry[49] - (east * east * ve + up * up * vd)).abs() < ROUNDING);
    assert!((odometry[56] - vn).abs() < ROUNDING);
}

#[test]
fn far_from_the_origin_the_axes_are_still_those_of_the_map() {
    let origin = Geodetic::from_degrees(48.0, 11.5, 560.0);
    let mut far = row(0.0);
    far.position = Geodetic::from_degrees(48.5, 12.5, 500.0);
    let odometry = odometry(&far, &origin);
    let turn = ecef_from_ned(&far.position).to_rotation_matrix();
    // Products of a few sines and cosines.
    let difference = turn.inverse().into_inner() - far.position.ned_from_ecef();
    assert!(difference.amax() < 1e-15);
    // By way of matrices and Earth-fixed axes.
    let ned_map = origin.ned_from_ecef() * far.position.ned_from_ecef().transpose();
    let q_nb = attitude::from_rpy(&far.rpy);
    let forward = ned_map * (q_nb * Vector3::x());
    let enu = |v: &Vector3| Vector3::new(v.y, v.x, -v.z);
    let found = quaternion(&odometry[3..7]) * Vector3::x();
    assert!((found - enu(&forward)).amax() < ROUNDING);
    // 92 km away: 1e-11 m is a rounding of the Earth's radius squared over it.
    let place = Vector3::from_row_slice(&odometry[..3]);
    let ned = origin.ned_to(&far.position);
    assert!((place - enu(&ned)).amax() < 1e-9);
}

#[test]
fn unknown_deviations_and_what_is_refused() {
    let mut unknown = row(0.0);
    unknown.nav_std = [f64::NAN; 9];
    let numbers = odometry(&unknown, &unknown.position.clone());
    assert!(numbers.iter().all(|number| number.is_finite()));
    assert_eq!(numbers[7..43], [0.0; 36]);
    let mut messages = Messages::new(None);
    let stamp = messages.stamp(&unknown).unwrap();
    assert_eq!(messages.fix(&unknown, stamp).last(), Some(&0));

    let mut writer = McapWriter::new(Vec::new(), None).unwrap();
    let mut bad = row(0.0);
    bad.v_n.x = f64::NAN;
    for bad in [bad, row(f64::NAN), row(1e10)] {
        assert!(writer.write(&bad).is_err());
    }
    writer.write(&row(-1.5)).unwrap();
    writer.into_inner().unwrap();
}

#[test]
fn stamps_keep_nanoseconds() {
    let dated = |unix| Epoch::of_unix(unix, 0.0, ClockSource::Gnss);
    let stamp = |epoch, time| {
        let stamp = Messages::new(epoch).stamp(&row(time));
        stamp.map(|stamp| (stamp.seconds, stamp.nanoseconds))
    };
    assert_eq!(
        stamp(dated(1_752_003_240.0), 0.004).unwrap(),
        (1_752_003_240, 4_000_000)
    );
    assert_eq!(
        stamp(dated(1_752_003_240.75), 0.5).unwrap(),
        (1_752_003_241, 250_000_000)
    );
    assert_eq!(stamp(None, 0.999_999_999_9).unwrap(), (1, 0));
    assert_eq!(stamp(None, -0.25).unwrap(), (-1, 750_000_000));
}

/// A disk that is full after some bytes.
struct Full(Cursor<Vec<u8>>);

impl Write for Full {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let room = 1000 - self.0.position() as usize;
        match bytes.len().min(room) {
            0 => Err(io::Error::other("full")),
            fits => self.0.write(&bytes[..fits]),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_full_disk_is_an_error_and_no_panic() {
    let mut writer = McapWriter::new(Full(Cursor::default()), None).unwrap();
    let written: io::Result<()> =
        (0..20_000).try_for_each(|k| writer.write(&row(f64::from(k) * 0.01)));
    assert!(written.is_err());
    drop(writer);
    // At the end, whatever is being written then.
    for rows in [0, 1, 20, 200] {
        let mut writer = McapWriter::new(Full(Cursor::default()), None).unwrap();
        let written: io::Result<()> = (0..rows).try_for_each(|_| writer.write(&row(0.0)));
        assert!(written.is_err() || writer.into_inner().is_err());
    }
    let path = temporary("dropped");
    let mut writer = McapWriter::new(PendingFile::create(&path).unwrap(), None).unwrap();
    writer.write(&row(0.0)).unwrap();
    drop(writer);
    assert!(!path.exists());
}

/// Fields at multiples of their size from the fifth byte on: OMG DDSI-RTPS 2.5, section 10, and the definitions of
/// diagnostic_msgs.
#[test]
fn diagnostics_are_laid_out_as_ros_does() {
    let mut messages = Messages::new(None);
    let stamp = messages.stamp(&row(1.5)).unwrap();
    let status = Status {
        level: Level::Warn,
        name: "a",
        message: "bc",
        values: vec![("x", 0.5)],
    };
    let bytes = messages.diagnostics(&[status], stamp).to_vec();
    let mut expected = vec![0, 1, 0, 0];
    // Stamp, frame "", one status.
    expected.extend([1, 0, 0, 0]);
    expected.extend(500_000_000u32.to_le_bytes());
    expected.extend([1, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0]);
    // Level, name, message, hardware.
    expected.extend([1, 0, 0, 0, 2, 0, 0, 0, b'a', 0, 0, 0]);
    expected.extend([3, 0, 0, 0, b'b', b'c', 0, 0, 1, 0, 0, 0, 0, 0, 0, 0]);
    // One value.
    expected.extend([1, 0, 0, 0, 2, 0, 0, 0, b'x', 0, 0, 0, 4, 0, 0, 0]);
    expected.extend(*b"0.5\0");
    assert_eq!(bytes, expected);
}

#[test]
fn a_stream_has_each_message_as_soon_as_it_is_there() {
    let mut messages = Messages::new(None);
    let mut stream = Stream::default();
    let mut bytes = Stream::head();
    let (number, declared) = stream.topic("/fix", "sensor_msgs/msg/NavSatFix");
    bytes.extend(declared);
    let begun = bytes.clone();
    for k in 1..=3 {
        let row = row(f64::from(k));
        let stamp = messages.stamp(&row).unwrap();
        let content = messages.fix(&row, stamp).to_vec();
        bytes.extend(Stream::message(number, stamp.nanoseconds(), &content));
    }
    let wanted = Wanted::Fixes {
        position: Some("/fix".into()),
        velocity: None,
        base: None,
        at_once: false,
    };
    let opened = Opened::live("ros2:/fix".as_ref(), &begun, Cursor::new(bytes)).unwrap();
    let mut log = opened.log(Format::Mcap, &wanted).unwrap();
    for k in 1..=3 {
        let What::Fix(fix) = log.next().unwrap().unwrap().what else {
            panic!("no fix")
        };
        // 1 January 1970 was a Thursday, of the GPS week 1 s of UTC before is 345 600 s.
        assert_eq!(fix.time.fract(), 0.0, "{k}");
        assert!(fix.position.is_some() && fix.velocity.is_none());
    }
}

/// Wherever it breaks off, what a reader gets again is what was declared and the message that has begun.
#[test]
fn a_reader_may_begin_in_the_middle_of_a_stream() {
    let mut stream = Stream::default();
    let (number, imu) = stream.topic("/imu", "sensor_msgs/msg/Imu");
    let first = Stream::message(number, 7, b"first");
    let (_, fix) = stream.topic("/fix", "sensor_msgs/msg/NavSatFix");
    let second = Stream::message(number, 8, b"second, longer");
    let bytes = [&Stream::head()[..], &imu, &first, &fix, &second].concat();
    let before = bytes.len() - second.len();
    for end in 0..=bytes.len() {
        let mut declared = Declarations::default();
        for piece in bytes[..end].chunks(5) {
            declared.add(piece);
        }
        let again = declared.again();
        if end == bytes.len() {
            assert_eq!(again, [&MAGIC[..], &imu, &fix].concat());
        } else if end >= before {
            let begun = &second[..end - before];
            assert_eq!(again, [&MAGIC[..], &imu, &fix, begun].concat(), "{end}");
        } else {
            assert!(again.len() <= end);
        }
    }
}
