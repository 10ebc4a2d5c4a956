use serde_json::Value;

use std::path::{Path, PathBuf};

use super::*;
use crate::Opened;
use crate::skipped::SkipKind;
use crate::table::{Column, Table, is_parquet};

fn golden(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../testdata/golden/formats/parquet")
        .join(name)
}

/// What pyarrow reads in types.parquet; null and NaN are `None`.
fn expected(column: &str) -> Vec<Option<f64>> {
    let text = std::fs::read_to_string(golden("expected.json")).unwrap();
    let value: Value = serde_json::from_str(&text).unwrap();
    let values = value[column].as_array().unwrap().iter();
    values.map(Value::as_f64).collect()
}

fn options(names: &[&str], keep_not_finite: bool) -> TableOptions {
    let column = |name: &&str| (format!("key.{name}"), Column::Name((*name).into()));
    TableOptions {
        columns: names.iter().map(column).collect(),
        keep_not_finite,
        ..TableOptions::default()
    }
}

fn rows(path: &Path, options: &TableOptions) -> Result<(Vec<Vec<f64>>, Table), ReadError> {
    let mut table = Opened::open(path)?.table(options)?;
    let mut row = vec![0.0; options.columns.len()];
    let mut rows = Vec::new();
    while table.next_row(&mut row)?.is_some() {
        rows.push(row.clone());
    }
    Ok((rows, table))
}

fn column_names(path: &Path) -> Result<Vec<String>, ReadError> {
    Ok(Opened::open(path)?.preview(0)?.names)
}

fn temporary(name: &str, bytes: &[u8]) -> PathBuf {
    let path = std::env::temp_dir().join(format!("undrift-io-{}-{name}", std::process::id()));
    std::fs::write(&path, bytes).unwrap();
    path
}

/// Equal but for the last bit, in which the reader of JSON and a decimal's factor may err.
fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= 2.0 * f64::EPSILON * b.abs()
}

#[test]
fn numbers_are_those_of_pyarrow() {
    let names = [
        "time", "single", "small", "integer", "unsigned", "large", "flag", "stamp", "price",
        "holes", "nan", "imu.gyro",
    ];
    let path = golden("types.parquet");
    let (rows, table) = rows(&path, &options(&names, true)).unwrap();
    assert_eq!((rows.len(), table.rows_seen()), (50, 50));
    assert!(table.skipped().is_empty());
    for (i, name) in names.iter().enumerate() {
        for (row, theirs) in rows.iter().zip(expected(name)) {
            match theirs {
                Some(value) => assert!(near(row[i], value), "{name}: {} {value}", row[i]),
                None => assert!(row[i].is_nan(), "{name}"),
            }
        }
    }
    let all = column_names(&path).unwrap();
    assert_eq!((all.len(), all[0].as_str()), (15, "time"));
    assert!(all.contains(&"imu.none".to_owned()));
}

#[test]
fn every_compression_and_encoding_is_read() {
    let wanted = options(&["integer", "holes", "time"], true);
    let (plain, _) = rows(&golden("types.parquet"), &wanted).unwrap();
    for name in ["none", "snappy", "gzip", "zstd", "lz4", "pages2"] {
        let (rows, _) = rows(&golden(&format!("{name}.parquet")), &wanted).unwrap();
        // NaN is not equal to itself: compared by its bits.
        let bits = |rows: &[Vec<f64>]| -> Vec<u64> {
            rows.iter().flatten().map(|value| value.to_bits()).collect()
        };
        assert_eq!(bits(&rows), bits(&plain), "{name}");
    }
}

#[test]
fn null_is_an_empty_field_and_rows_are_numbered() {
    let wanted = options(&["time", "holes", "nan"], false);
    let mut table = Opened::open(&golden("types.parquet"))
        .unwrap()
        .table(&wanted)
        .unwrap();
    let (mut row, mut numbers) = ([0.0; 3], Vec::new());
    while let Some(number) = table.next_row(&mut row).unwrap() {
        assert!(near(row[0], 100.0 + 0.25 * (number - 1) as f64));
        numbers.push(number);
    }
    let left: Vec<u64> = (1..=50).filter(|n| n % 7 != 4 && *n != 12).collect();
    assert_eq!(numbers, left);
    assert_eq!(table.skipped().count(SkipKind::MissingField), 7);
    assert_eq!(table.skipped().count(SkipKind::NotFinite), 1);
    let text = table.skipped().to_string();
    assert!(
        text.contains("first at line 4: column 10 is empty"),
        "{text}"
    );
    assert!(table.next_row(&mut [0.0]).is_err());
}

#[test]
fn what_cannot_be_read_is_said_with_its_key() {
    let path = golden("types.parquet");
    let refused = |path: &Path, name: &str| {
        let error = rows(path, &options(&[name], false)).err().unwrap();
        error.to_string()
    };
    let message = refused(&path, "gyro");
    assert!(message.contains("no column \"gyro\" (key key.gyro); the file has: time, single"));
    let message = refused(&path, "text");
    assert!(message.contains("column \"text\" holds text or bytes (key key.text)"));
    assert!(refused(&path, "list.list.element").contains("holds lists"));
    let message = refused(&path, "imu.none");
    assert!(message.contains("no row with a number"), "{message}");
    let by_number = TableOptions {
        columns: vec![("time".into(), Column::Number(16))],
        ..TableOptions::default()
    };
    let message = rows(&path, &by_number).err().unwrap().to_string();
    assert!(message.contains("no column 16, there are 15"), "{message}");

    let bytes = std::fs::read(&path).unwrap();
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    std::io::Write::write_all(&mut encoder, &bytes).unwrap();
    for (name, bytes, problem) in [
        (
            "gz",
            encoder.finish().unwrap(),
            "is compressed as a whole; decompress it",
        ),
        ("empty", Vec::new(), "is empty"),
        ("text", b"time,gyro".to_vec(), "no data, only a header"),
        (
            "cut",
            bytes[..bytes.len() - 1].to_vec(),
            "not a readable Parquet file",
        ),
    ] {
        let path = temporary(name, &bytes);
        let message = refused(&path, "time");
        assert!(message.contains(problem), "{message}");
        std::fs::remove_file(&path).unwrap();
    }
    assert!(refused(Path::new("nowhere.parquet"), "time").contains("no such file"));
    assert!(is_parquet(&bytes) && !is_parquet(b"PAR"));
}

#[test]
fn files_that_break_off_or_are_damaged_do_no_harm() {
    let wanted = options(&["time", "integer", "holes"], false);
    for name in [
        "none.parquet",
        "snappy.parquet",
        "zstd.parquet",
        "lz4.parquet",
        "pages2.parquet",
        "gzip.parquet",
        "types.parquet",
    ] {
        let bytes = std::fs::read(golden(name)).unwrap();
        let read = |bytes: &[u8]| {
            let path = temporary("damaged", bytes);
            if let Ok((rows, table)) = rows(&path, &wanted) {
                assert!(rows.iter().flatten().all(|value| value.is_finite()));
                assert!(rows.len() as u64 <= table.rows_seen());
            }
            std::fs::remove_file(&path).unwrap();
        };
        for length in (0..bytes.len()).step_by(37) {
            read(&bytes[..length]);
        }
        let mut state = 1u64;
        for _ in 0..1500 {
            let mut damaged = bytes.clone();
            for _ in 0..2 {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1);
                let at = (state >> 33) as usize % damaged.len();
                damaged[at] ^= 1 << ((state >> 20) & 7);
            }
            read(&damaged);
        }
    }
}

/// The crate alone takes minutes for it: a header with a list of 2³¹ booleans, of no byte each.
#[test]
fn a_list_without_end_in_a_header_ends_the_table() {
    let path =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus-seeds/parquet/endless-list");
    let started = std::time::Instant::now();
    for name in column_names(&path).unwrap() {
        let options = options(&[&name], true);
        if let Ok((_, table)) = rows(&path, &options) {
            assert!(!table.skipped().is_empty(), "{name}");
        }
    }
    assert!(started.elapsed().as_secs() < 5, "{:?}", started.elapsed());
}
