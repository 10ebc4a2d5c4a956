//! Gyroscopes and accelerometers on two topics of a recording: each from its own samples, not between them.

use super::{Record, of_samples};
use crate::{drive::Logs, inspect};
use std::path::Path;
use undrift_io::{
    ReadError,
    format::Format,
    imu::{ImuFormat, ImuReader, ImuSource},
    log::{AND, StreamKind},
    source::BytesRead,
};

/// The topics of gyroscopes and accelerometers that a format names together.
pub(super) fn apart(format: &ImuFormat) -> Option<[ImuFormat; 2]> {
    let ImuSource::Log(log, Some(topics)) = &format.source else {
        return None;
    };
    let (gyro, accel) = topics.split_once(AND)?;
    let of = |topic: &str| ImuFormat {
        source: ImuSource::Log(*log, Some(topic.to_owned())),
        ..format.clone()
    };
    Some([of(gyro), of(accel)])
}

/// The topic, or the two of them, that a log with several is read from: as `inspect` chooses.
pub(super) fn chosen(path: &Path, logs: &Logs, format: Format) -> Option<String> {
    let streams = logs.open(path, &BytesRead::default()).ok()?;
    let streams = streams.streams(format).ok()?.into_iter();
    let those = streams.filter(|of| of.kind == StreamKind::Imu && of.messages > 0);
    let names: Vec<String> = those.map(|stream| stream.name).collect();
    let line = inspect::choose_topic(path, logs, format, &names)?;
    Some(line.value.as_str()?.to_owned())
}

/// Reads both into one record: samples of the faster sensor, with those of the other at the sample that is next to them and NaN
/// between them.
///
/// # Errors
/// If the log cannot be read, or a topic is not in it.
pub(super) fn read(
    path: &Path,
    logs: &Logs,
    formats: &[ImuFormat; 2],
    record: Record,
) -> Result<Record, ReadError> {
    let alone = |format: &ImuFormat, of_gyro: bool| {
        let opened = logs.open(path, &BytesRead::default())?;
        let mut found = of_samples(ImuReader::new(opened, format)?, record.clone())?;
        let mut axes = found.axes.iter().zip(std::mem::take(&mut found.samples));
        let mine = |axis: &str| axis.starts_with("gyro") == of_gyro;
        found.samples = axes
            .by_ref()
            .filter_map(|(axis, samples)| mine(axis).then_some(samples))
            .collect();
        found.axes.retain(|axis| mine(axis));
        Ok::<_, ReadError>(found)
    };
    let [gyro, accel] = formats;
    let (gyro, accel) = (alone(gyro, true)?, alone(accel, false)?);
    let of_gyro = gyro.length() >= accel.length();
    let (mut fast, mut slow) = if of_gyro {
        (gyro, accel)
    } else {
        (accel, gyro)
    };
    for samples in &mut slow.samples {
        *samples = placed(&fast.stamps, &slow.stamps, samples);
    }
    match of_gyro {
        true => {
            fast.axes.append(&mut slow.axes);
            fast.samples.append(&mut slow.samples);
        }
        false => {
            fast.axes.splice(0..0, slow.axes);
            fast.samples.splice(0..0, slow.samples);
        }
    }
    fast.skipped.merge(&slow.skipped);
    Ok(fast)
}

/// Values at `times` \[s\] among `stamps` \[s\], both in order: each at the nearest one, NaN elsewhere.
fn placed(stamps: &[f64], times: &[f64], values: &[f64]) -> Vec<f64> {
    let mut all = vec![f64::NAN; stamps.len()];
    for (time, value) in times.iter().zip(values) {
        let next = stamps.partition_point(|stamp| stamp < time);
        let distance = |at: usize| stamps.get(at).map_or(f64::INFINITY, |s| (s - time).abs());
        let nearest = match next.checked_sub(1) {
            Some(before) if distance(before) < distance(next) => before,
            _ => next,
        };
        if let Some(place) = all.get_mut(nearest) {
            *place = *value;
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::RecordFormat;
    use undrift_io::Opened;

    /// Time \[ms\], gyros and forces.
    type Row = (u32, [f64; 3], [f64; 3]);

    /// A bag of ROS 1 without an index: topics of sensor_msgs/Imu with these rows of time \[ms\], gyros and forces.
    fn bag(topics: &[(&str, Vec<Row>)]) -> Vec<u8> {
        type Fields<'a> = &'a [(&'a str, Vec<u8>)];
        let header = |fields: Fields<'_>| -> Vec<u8> {
            let mut all = Vec::new();
            for (key, value) in fields {
                all.extend((key.len() as u32 + 1 + value.len() as u32).to_le_bytes());
                all.extend([key.as_bytes(), b"=", value].concat());
            }
            all
        };
        let record = |of: &[u8], data: &[u8]| -> Vec<u8> {
            let [length, size] = [of, data].map(|part| (part.len() as u32).to_le_bytes());
            [&length, of, &size, data].concat()
        };
        let mut bytes = b"#ROSBAG V2.0\n".to_vec();
        let zero = |size: usize| vec![0; size];
        let first = header(&[
            ("op", vec![3]),
            ("index_pos", zero(8)),
            ("conn_count", zero(4)),
            ("chunk_count", zero(4)),
        ]);
        bytes.extend(record(&first, &[b' '; 64]));
        let mut messages = Vec::new();
        for (number, (topic, rows)) in (0u32..).zip(topics) {
            let conn = number.to_le_bytes().to_vec();
            let named = header(&[
                ("op", vec![7]),
                ("conn", conn.clone()),
                ("topic", topic.as_bytes().to_vec()),
            ]);
            let about = header(&[
                ("topic", topic.as_bytes().to_vec()),
                ("type", b"sensor_msgs/Imu".to_vec()),
                ("md5sum", b"6a62c6daae103f4ff57a132d6f95cec2".to_vec()),
                ("message_definition", b"Header header\n".to_vec()),
            ]);
            bytes.extend(record(&named, &about));
            for (ms, gyro, force) in rows {
                let stamp = [1_700_000_000 + ms / 1000, ms % 1000 * 1_000_000];
                let stamp = stamp.map(u32::to_le_bytes).concat();
                let mut data = [&[0; 4][..], &stamp, &3u32.to_le_bytes(), b"imu"].concat();
                let numbers = [&[0.0; 13][..], gyro, &[0.0; 9], force, &[0.0; 9]].concat();
                data.extend(numbers.into_iter().flat_map(f64::to_le_bytes));
                let of = header(&[("op", vec![2]), ("conn", conn.clone()), ("time", stamp)]);
                messages.push((*ms, record(&of, &data)));
            }
        }
        messages.sort_by_key(|(ms, _)| *ms);
        bytes.extend(messages.into_iter().flat_map(|(_, message)| message));
        bytes
    }

    /// Gyros at 100 Hz on one topic, forces at 50 Hz between them on another, as a depth camera has them; and a topic without
    /// gravity before the one that has it.
    #[test]
    fn topics_are_chosen_and_joined_without_numbers_between_samples() {
        let read = |name: &str, content: &[u8], topic: Option<&str>| {
            let path = std::env::temp_dir().join(format!("undrift-{}-{name}", std::process::id()));
            std::fs::write(&path, content).unwrap();
            let format = RecordFormat {
                topic: topic.map(str::to_owned),
                ..RecordFormat::default()
            };
            let found = crate::record::read(Opened::open(&path).unwrap(), &format);
            std::fs::remove_file(&path).unwrap();
            found.unwrap()
        };
        let noise = |k: u32| f64::from(k * 7919 % 13) * 1e-3 - 6e-3;
        let gyros = (0..2000).map(|k| (10 * k, [noise(k), 0.01, -0.01], [0.0; 3]));
        let force = |k: u32| [0.0, 0.1 + noise(k), 9.81];
        let forces = (0..1000).map(|k| (20 * k + 3, [0.0; 3], force(k)));
        let apart = bag(&[
            ("/camera/accel", forces.collect()),
            ("/camera/gyro", gyros.collect()),
        ]);
        let both = "/camera/gyro + /camera/accel";
        for topic in [None, Some(both)] {
            let record = read("apart.bag", &apart, topic);
            assert_eq!((record.axes.len(), record.length()), (6, 2000));
            let (values, _, every) = crate::record::own_values(&record.samples[4]).unwrap();
            assert_eq!((values.len(), every), (1000, 2.0));
            let off = |(k, value): (u32, &f64)| (value.abs() - force(k)[1]).abs();
            assert!((0..).zip(&values).map(off).fold(0.0, f64::max) < 1e-9);
            assert_eq!(record.guessed.is_empty(), topic.is_some());
        }
        let rows = |gravity: f64| {
            let row = |k: u32| (10 * k, [noise(k), 0.01, -0.01], [0.0, noise(k), gravity]);
            (0..500).map(row).collect()
        };
        let two = bag(&[("/imu/data", rows(0.0)), ("/imu/data_raw", rows(9.81))]);
        let record = read("two.bag", &two, None);
        assert_eq!(record.guessed, [("--topic", "/imu/data_raw".to_owned())]);
        assert_eq!(record.length(), 500);
    }

    #[test]
    fn values_of_the_slower_sensor_are_at_the_nearest_samples() {
        let stamps: Vec<f64> = (0..10).map(f64::from).collect();
        let found = placed(
            &stamps,
            &[0.3, 2.6, 5.0, 8.9, 12.0],
            &[1.0, 2.0, 3.0, 4.0, 5.0],
        );
        let there: Vec<(usize, f64)> = found
            .into_iter()
            .enumerate()
            .filter(|(_, value)| value.is_finite())
            .collect();
        assert_eq!(there, [(0, 1.0), (3, 2.0), (5, 3.0), (9, 5.0)]);
    }
}
