use super::*;
use crate::Opened;
use crate::skipped::SkipKind;
use crate::source::BytesRead;
use crate::table::Column;
use std::io::Cursor;
use std::path::Path;
use undrift_nav::Matrix3;

fn format() -> ImuFormat {
    let column = |n| Column::Number(n);
    ImuFormat::new(
        Some(column(1)),
        [column(2), column(3), column(4)],
        [column(5), column(6), column(7)],
    )
}

fn reader(text: &str, format: &ImuFormat) -> ImuReader {
    let source = Box::new(Cursor::new(text.as_bytes().to_vec()));
    ImuReader::new(
        Opened::stream(Path::new("imu.csv"), source).unwrap(),
        format,
    )
    .unwrap()
}

fn all(text: &str, format: &ImuFormat) -> Vec<ImuSample> {
    reader(text, format).map(Result::unwrap).collect()
}

/// A few roundings of numbers of order one.
const ROUNDING: f64 = 1e-14;

#[test]
fn rates_become_increments_over_the_real_interval() {
    let text = "0,1,2,3,4,5,6\n0.5,1,2,3,4,5,6\n1.5,1,2,3,4,5,6\n";
    let samples = all(text, &format());
    let intervals: Vec<f64> = samples.iter().map(|s| s.dt).collect();
    assert_eq!(intervals, [0.5, 0.5, 1.0]);
    assert_eq!(samples[1].dtheta, Vector3::new(0.5, 1.0, 1.5));
    assert_eq!(samples[2].dvel, Vector3::new(4.0, 5.0, 6.0));
    let rated = ImuFormat {
        rate_hz: Some(4.0),
        ..format()
    };
    assert_eq!(all(text, &rated)[0].dt, 0.25);
}

#[test]
fn scale_rotation_and_offset() {
    // Sensor x is body y, sensor y is body x, sensor z is up.
    let mounted = ImuFormat {
        time_scale: 1e-3,
        time_offset: 100.0,
        gyro_scale: Vector3::repeat(2.0),
        accel_scale: Vector3::repeat(10.0),
        rotation: Matrix3::new(0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0),
        gyro_offset: Vector3::new(0.5, 0.0, 0.0),
        accel_offset: Vector3::new(0.0, 0.0, 1.0),
        ..format()
    };
    let text = "0,1,2,3,4,5,6\n500,1,2,3,4,5,6\n";
    let rates = all(text, &mounted)[1];
    assert_eq!(rates.time, 100.5);
    assert!((rates.dtheta - Vector3::new(3.5, 2.0, -6.0) * 0.5).norm() < ROUNDING);
    assert!((rates.dvel - Vector3::new(50.0, 40.0, -61.0) * 0.5).norm() < ROUNDING);
    let increments = ImuFormat {
        increments: true,
        ..mounted
    };
    let increment = all(text, &increments)[1];
    assert!((increment.dtheta - Vector3::new(3.75, 2.0, -6.0)).norm() < ROUNDING);
    assert!((increment.dvel - Vector3::new(50.0, 40.0, -60.5)).norm() < ROUNDING);
}

#[test]
fn without_a_time_column_a_bad_row_still_takes_its_time() {
    let column = |n| Column::Number(n);
    let rated = ImuFormat {
        rate_hz: Some(10.0),
        ..ImuFormat::new(
            None,
            [column(1), column(2), column(3)],
            [column(4), column(5), column(6)],
        )
    };
    let samples = all("1,1,1,1,1,1\n1,1,bad,1,1,1\n1,1,1,1,1,1\n", &rated);
    assert_eq!(samples.len(), 2);
    assert_eq!((samples[0].time, samples[0].dt), (0.0, 0.1));
    assert_eq!((samples[1].time, samples[1].dt), (0.2, 0.2));
}

#[test]
fn one_sample_without_a_rate_is_an_error_and_only_once() {
    let mut reader = reader("0,1,2,3,4,5,6\n", &format());
    assert!(
        reader
            .next()
            .unwrap()
            .unwrap_err()
            .to_string()
            .contains("only one row of data")
    );
    assert!(reader.next().is_none());
}

#[test]
fn values_that_would_overflow_are_left_out() {
    let text =
        "0,1,2,3,4,5,6\n1,1,2,3,4,5,6\n2,1e308,2,3,4,5,6\n4,1,2,3,4,5,-1e200\n5,1,2,3,4,5,6\n";
    let mut reader = reader(text, &format());
    let intervals: Vec<f64> = reader.by_ref().map(|sample| sample.unwrap().dt).collect();
    // The next one reaches back to the last that was given.
    assert_eq!(intervals, [1.0, 1.0, 4.0]);
    assert_eq!(reader.skipped().count(SkipKind::OutOfRange), 2);
}

#[test]
fn increments_of_next_to_no_time_are_not_scaled_to_a_gap() {
    let increments = ImuFormat {
        increments: true,
        ..format()
    };
    let text = "0,1,2,3,4,5,6\n1e-310,1,2,3,4,5,6\n1,1,2,3,4,5,6\n";
    let mut reader = reader(text, &increments);
    assert_eq!(reader.by_ref().map(Result::unwrap).count(), 2);
    assert_eq!(reader.skipped().count(SkipKind::OutOfRange), 1);
}

#[test]
fn formats_that_make_no_times() {
    for bad in [
        ImuFormat {
            rate_hz: None,
            ..ImuFormat::new(
                None,
                [1, 2, 3].map(Column::Number),
                [4, 5, 6].map(Column::Number),
            )
        },
        ImuFormat {
            rate_hz: Some(0.0),
            ..format()
        },
        // Its interval is infinite.
        ImuFormat {
            rate_hz: Some(1e-310),
            ..format()
        },
        ImuFormat {
            time_scale: f64::NAN,
            ..format()
        },
    ] {
        let source = Box::new(Cursor::new(b"1,1,1,1,1,1,1\n".to_vec()));
        let opened = Opened::stream(Path::new("x"), source).unwrap();
        assert!(ImuReader::new(opened, &bad).is_err());
    }
}

#[test]
fn duplicates_are_skipped_and_a_reset_clock_is_an_error() {
    let row = |t: f64| format!("{t},0,0,0,0,0,0\n");
    let mut text: String = (0..50).map(|k| row(k as f64 * 0.01)).collect();
    text += &row(0.49);
    text += &row(0.2);
    text += &row(0.5);
    let mut good = reader(&text, &format());
    assert_eq!(good.by_ref().filter(Result::is_ok).count(), 51);
    assert_eq!(good.skipped().count(SkipKind::DuplicateTime), 1);
    assert_eq!(good.skipped().count(SkipKind::TimeBackwards), 1);

    text.extend((0..200).map(|k| row(k as f64 * 1e-3)));
    let last = reader(&text, &format()).last().unwrap();
    let error = last.unwrap_err();
    assert_eq!(error.line, Some(54));
    assert!(error.to_string().contains("jumps back"), "{error}");
}

#[test]
fn span_keeps_the_interval_of_its_first_sample_and_names_what_there_is() {
    let text: String = (0..10).map(|k| format!("{k},0,0,0,0,0,0\n")).collect();
    let part = |span| ImuFormat {
        span: Some(span),
        ..format()
    };
    let samples = all(&text, &part((3.0, 5.0)));
    let times: Vec<f64> = samples.iter().map(|s| s.time).collect();
    assert_eq!(times, [3.0, 4.0, 5.0]);
    assert_eq!(samples[0].dt, 1.0);
    let mut outside = reader(&text, &part((30.0, 50.0)));
    let error = outside.next().unwrap().unwrap_err().to_string();
    assert!(
        error.contains("ends at 9 s, before [span] begins at 30 s"),
        "{error}"
    );
}

#[test]
fn gaps_keep_their_length() {
    let mut text: String = (0..200).map(|k| format!("{k},0,0,0,0,0,0\n")).collect();
    text += "207,0,0,0,0,0,0\n";
    let mut reader = reader(&text, &format());
    assert_eq!(reader.by_ref().last().unwrap().unwrap().dt, 8.0);
    let gap = Gap {
        start: 199.0,
        length: 8.0,
        line: 201,
    };
    assert_eq!(reader.gaps().count, 1);
    assert_eq!(reader.gaps().longest, Some(gap));
}

/// Increments at 100 Hz of 2 rad/s and 3 m/s² for `rows` rows, without those at `missing`.
fn increments(rows: std::ops::Range<u32>, missing: &[u32]) -> String {
    rows.filter(|k| !missing.contains(k))
        .map(|k| format!("{},0.02,0,0,0,0.03,0\n", f64::from(k) / 100.0))
        .collect()
}

#[test]
fn increments_after_a_gap_are_scaled_to_the_mean_rate() {
    let unrated = ImuFormat {
        increments: true,
        gyro_offset: Vector3::new(0.0, 0.0, 0.5),
        ..format()
    };
    let rated = ImuFormat {
        rate_hz: Some(100.0),
        ..unrated.clone()
    };
    // The third row, one after the median runs, and a whole second.
    let mut missing = vec![2, 150];
    missing.extend(200..299);
    let text = increments(0..400, &missing);
    for format in [&unrated, &rated] {
        let samples = all(&text, format);
        assert_eq!(samples.len(), 400 - missing.len());
        let longest = samples.iter().map(|s| s.dt).fold(0.0, f64::max);
        assert!((longest - 1.0).abs() < 1e-9);
        for s in &samples {
            let (rate, force) = (s.dtheta / s.dt, s.dvel / s.dt);
            let expected = Vector3::new(2.0, 0.0, -0.5);
            // Differences of stamps, and the median with them, are off by rounding: 1e-15 of 0.01.
            assert!((rate - expected).norm() < 1e-11, "{} {rate}", s.time);
            let expected = Vector3::new(0.0, 3.0, 0.0);
            assert!((force - expected).norm() < 1e-11, "{} {force}", s.time);
        }
    }
    // Rates need no such thing, whatever the rate.
    let rates = ImuFormat {
        increments: false,
        ..rated
    };
    let late = all(&text, &rates).into_iter().find(|s| s.dt > 0.5).unwrap();
    assert!((late.dvel.y / late.dt - 0.03).abs() < 1e-12);
}

#[test]
fn increments_at_another_rate_are_refused() {
    let stated = ImuFormat {
        increments: true,
        rate_hz: Some(200.0),
        ..format()
    };
    let error = reader(&increments(0..400, &[]), &stated)
        .find_map(Result::err)
        .unwrap();
    // The first row has no interval of its own.
    assert_eq!(error.line, Some(101));
    let text = error.to_string();
    assert!(
        text.contains("imu.rate") && text.contains("200.00 Hz"),
        "{text}"
    );

    let unrated = ImuFormat {
        rate_hz: None,
        ..stated
    };
    let slower: Vec<u32> = (300..1000).filter(|k| k % 3 != 0).collect();
    let error = reader(&increments(0..1000, &slower), &unrated)
        .find_map(Result::err)
        .unwrap();
    assert!(error.to_string().contains("split the file"), "{error}");
    // A log that loses every other row for a while is no other rate.
    let losses: Vec<u32> = (300..490).filter(|k| k % 2 != 0).collect();
    let text = increments(0..1000, &losses);
    assert_eq!(all(&text, &unrated).len(), 1000 - losses.len());
}

fn of_memory(samples: &[ImuSample], format: &ImuFormat) -> ImuReader {
    let memory = Memory::Samples(samples.into());
    let opened = Opened::memory(Path::new("<imu>"), memory, &BytesRead::default()).unwrap();
    ImuReader::new(opened, format).unwrap()
}

#[test]
fn samples_in_memory_come_back_as_they_are() {
    // Stamps that are no multiples of anything, a gap, and an axis that is held.
    let text: String = (0..100)
        .filter(|k| !(40..60).contains(k))
        .map(|k| {
            let t = f64::from(k) * 0.0101 + 1e5 / 3.0;
            format!(
                "{t},{},2,3,-4,{},6\n",
                f64::from(k) * 0.1,
                0.3 / f64::from(k + 1)
            )
        })
        .collect();
    let mut read = reader(&text, &format());
    let samples: Vec<ImuSample> = read.by_ref().map(Result::unwrap).collect();
    let mut again = of_memory(&samples, &ImuFormat::samples());
    assert_eq!(
        again.by_ref().map(Result::unwrap).collect::<Vec<_>>(),
        samples
    );
    assert_eq!(again.gaps().count, read.gaps().count);
    assert_eq!(again.gaps().nominal_interval, read.gaps().nominal_interval);
    assert_eq!(again.skipped(), &Skipped::of_samples());
}

#[test]
fn unusable_samples_in_memory_are_counted_and_a_gap_has_the_mean_rate() {
    let sample = |time: f64, dt: f64| ImuSample {
        time,
        dt,
        dtheta: Vector3::repeat(dt),
        dvel: Vector3::repeat(2.0 * dt),
    };
    let nan = ImuSample {
        dvel: Vector3::repeat(f64::NAN),
        ..sample(0.25, 0.1)
    };
    let given = [
        sample(0.1, 0.1),
        sample(0.2, 0.1),
        nan,
        sample(0.3, 0.0),
        sample(0.2, 0.1),
        // Half a second is missing, and the sensor goes on with 0.1 s a sample.
        sample(0.8, 0.1),
    ];
    let mut reader = of_memory(&given, &ImuFormat::samples());
    let samples: Vec<ImuSample> = reader.by_ref().map(Result::unwrap).collect();
    assert_eq!(samples[..2], given[..2]);
    assert_eq!(samples.len(), 3);
    let last = samples[2];
    assert!(
        (last.dt - 0.6).abs() < ROUNDING && (last.dvel - Vector3::repeat(1.2)).amax() < ROUNDING
    );
    let count = |kind| reader.skipped().count(kind);
    assert_eq!(count(SkipKind::NotFinite), 1);
    assert_eq!(count(SkipKind::OutOfRange), 1);
    assert_eq!(count(SkipKind::DuplicateTime), 1);
    // Columns are not asked of them, nor fixes.
    let memory = || {
        let memory = Memory::Samples(given[..1].into());
        Opened::memory(Path::new("<imu>"), memory, &BytesRead::default()).unwrap()
    };
    let refused = ImuReader::new(memory(), &format())
        .err()
        .unwrap()
        .to_string();
    assert!(
        refused.contains("<imu>") && refused.contains("records in memory"),
        "{refused}"
    );
    let fixes = crate::gnss::GnssSource::Fixes {
        time_offset: 0.0,
        span: None,
    };
    let refused = crate::gnss::GnssReader::new(memory(), &fixes)
        .err()
        .unwrap();
    assert!(
        refused.to_string().contains("records in memory"),
        "{refused}"
    );
}

#[test]
fn rows_of_one_sensor_alone_are_joined_where_that_is_asked_for() {
    // Gyros at 100 Hz; forces at 25 Hz in rows of the gyros, or 3 ms after them in rows of their own.
    let apart = ImuFormat {
        apart: true,
        ..format()
    };
    for own_rows in [false, true] {
        let mut text = String::new();
        for k in 0..400 {
            let t = 0.01 * f64::from(k);
            match (k % 4 == 0, own_rows) {
                (true, false) => text += &format!("{t},1,2,{t},4,5,{t}\n"),
                (true, true) => text += &format!("{t},1,2,{t},,,\n{0},,,,4,5,{0}\n", t + 0.003),
                _ => text += &format!("{t},1,2,{t},,,nan\n"),
            }
        }
        let mut reader = reader(&text, &apart);
        let samples: Vec<ImuSample> = reader.by_ref().map(Result::unwrap).collect();
        // From the first force to the last, at 3.96 s.
        assert_eq!(samples.len(), if own_rows { 396 } else { 397 });
        let before = reader.skipped().count(SkipKind::MissingField);
        assert_eq!(before, u64::from(own_rows), "{}", reader.skipped());
        for sample in &samples {
            let expected = Vector3::new(4.0, 5.0, sample.time);
            // Stamps of hundredths have a rounding of 1e-15 s, over intervals of 0.01 s.
            assert!(
                (sample.dvel / sample.dt - expected).amax() < 1e-9,
                "{sample:?}"
            );
            assert!((sample.dtheta.z / sample.dt - sample.time).abs() < 1e-9);
        }
        // Rows that lack a sensor are skipped elsewhere.
        if !own_rows {
            assert_eq!(all(&text, &format()).len(), 100);
        }
    }
    let rows =
        (0..2000).map(|k| format!("{k},1,2,3,{}\n", if k % 40 == 0 { "4,5,6" } else { ",," }));
    let error = reader(&rows.collect::<String>(), &apart).find_map(Result::err);
    assert!(
        error
            .unwrap()
            .to_string()
            .contains("record both at the same rate")
    );
}
