//! Gyroscopes and accelerometers that are topics of their own, in a small bag of ROS 1.

use std::io::Cursor;

use crate::entry::{Wanted, What};
use crate::log::bag;

fn record(header: &[(&str, &[u8])], data: &[u8]) -> Vec<u8> {
    let mut fields = Vec::new();
    for (name, value) in header {
        fields.extend((name.len() as u32 + 1 + value.len() as u32).to_le_bytes());
        fields.extend(name.bytes().chain([b'=']).chain(value.iter().copied()));
    }
    let sized = |bytes: &[u8]| [&(bytes.len() as u32).to_le_bytes(), bytes].concat();
    [sized(&fields), sized(data)].concat()
}

/// Seconds and nanoseconds of a time in milliseconds.
fn stamp(milli: u32) -> Vec<u8> {
    let (seconds, nanos) = (1_700_000_000 + milli / 1000, milli % 1000 * 1_000_000);
    [seconds.to_le_bytes(), nanos.to_le_bytes()].concat()
}

/// A message of sensor_msgs/Imu.
fn message(milli: u32, gyro: [f64; 3], accel: [f64; 3]) -> Vec<u8> {
    let doubles = |values: &[f64]| -> Vec<u8> {
        values
            .iter()
            .flat_map(|value| value.to_le_bytes())
            .collect()
    };
    let frame = [&3u32.to_le_bytes()[..], b"imu"].concat();
    let parts = [&[0.0; 13][..], &gyro, &[0.0; 9], &accel, &[0.0; 9]];
    let body: Vec<u8> = parts.iter().flat_map(|part| doubles(part)).collect();
    [vec![0; 4], stamp(milli), frame, body].concat()
}

/// A bag with gyroscopes at 100 Hz and accelerometers at 25 Hz, whose z has the time in seconds.
fn recording() -> Vec<u8> {
    let topics = ["/camera/accel", "/camera/gyro"];
    let mut records = Vec::new();
    for (number, topic) in (0u32..).zip(topics) {
        let head = [
            ("op", &[7u8][..]),
            ("conn", &number.to_le_bytes()),
            ("topic", topic.as_bytes()),
        ];
        let about = record(
            &[("topic", topic.as_bytes()), ("type", b"sensor_msgs/Imu")],
            &[],
        );
        // The data of a connection is a header without data behind it.
        let about = &about[4..about.len() - 4];
        records.extend(record(&head, about));
    }
    for milli in (0..4000).filter(|milli| milli % 10 == 0 || milli % 40 == 3) {
        let number = u32::from(milli % 10 == 0);
        let seconds = f64::from(milli) * 1e-3;
        let data = match number {
            1 => message(milli, [0.1, 0.2, seconds], [0.0; 3]),
            _ => message(milli, [0.0; 3], [1.0, 2.0, seconds]),
        };
        let head = [
            ("op", &[2u8][..]),
            ("conn", &number.to_le_bytes()),
            ("time", &stamp(milli)),
        ];
        records.extend(record(&head, &data));
    }
    let size = (records.len() as u32).to_le_bytes();
    let chunk = record(
        &[
            ("op", &[5u8][..]),
            ("compression", b"none"),
            ("size", &size),
        ],
        &records,
    );
    let head = record(
        &[
            ("op", &[3u8][..]),
            ("index_pos", &[0; 8]),
            ("conn_count", &2u32.to_le_bytes()),
            ("chunk_count", &1u32.to_le_bytes()),
        ],
        &[b' '; 64],
    );
    [b"#ROSBAG V2.0\n".to_vec(), head, chunk].concat()
}

#[test]
fn topics_that_are_named_together_are_joined() {
    let read = |topic: &str| {
        let wanted = Wanted::Imu(Some(topic.to_owned()));
        let entries = bag::entries(Box::new(Cursor::new(recording())), &wanted).unwrap();
        let readings = entries.filter_map(|entry| match entry.map(|entry| entry.what) {
            Ok(What::Imu(reading)) => Some(Ok(reading)),
            Ok(_) => None,
            Err(error) => Some(Err(error.to_string())),
        });
        readings.collect::<Result<Vec<_>, _>>()
    };
    let joined = read("/camera/gyro + /camera/accel").unwrap();
    // Those between the first force, at 3 ms, and the last, at 3.963 s.
    assert_eq!(joined.len(), 396);
    for reading in joined {
        let [_, _, seconds] = reading.gyro.into();
        let force = [1.0, 2.0, seconds];
        let off = (reading.accel - undrift_nav::Vector3::from(force)).amax();
        assert!(
            off < 1e-9 && (reading.gyro.x, reading.gyro.y) == (0.1, 0.2),
            "{reading:?}"
        );
    }
    let alone = read("/camera/gyro").unwrap();
    assert!(alone.len() == 400 && alone.iter().all(|of| of.accel.amax() == 0.0));
    let error = read("/camera/gyro + /camera/force").unwrap_err();
    assert!(
        error.contains("/camera/force") && error.contains("imu.topic"),
        "{error}"
    );
    let error = read("/camera/accel + /camera/other").unwrap_err();
    assert!(
        error.contains("the file has: /camera/accel, /camera/gyro"),
        "{error}"
    );
}
