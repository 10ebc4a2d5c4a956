//! Arbitrary bytes: the readers end, with rows or an error, and never panic.

use std::io::Cursor;
use std::path::PathBuf;

use undrift_io::Opened;
use undrift_io::format::Format;
use undrift_io::gnss::{GnssLog, GnssReader};
use undrift_io::imu::{ImuFormat, ImuReader};
use undrift_io::poses::{PoseReader, detect};
use undrift_io::table::{Angles, Column, Stamp, TableOptions};
use undrift_nav::earth::Geodetic;

const CASES: usize = 3000;
const POS_HEADERS: [&str; 3] = [
    "%  GPST latitude(deg) longitude(deg) height(m) Q ns sdn(m) sde(m) sdu(m) sdne(m) sdeu(m) sdun(m) vn ve vu sdvn sdve sdvu\n",
    "%  UTC latitude(d'\") longitude(d'\") height(m) Q sdn sde sdu\n",
    "%  JST e-baseline(m) n-baseline(m) u-baseline(m) Q ns sde sdn sdu\n",
];
/// Pieces that formats are made of, so that the cases get past the first check.
const PIECES: [&[u8]; 30] = [
    b",",
    b";",
    b"\t",
    b" ",
    b"\n",
    b"\r\n",
    b"\"",
    b"#",
    b"%",
    b"t,gx\n",
    b"nan",
    b"inf",
    b"-",
    b"1e",
    b"1e999",
    b"-0",
    b"1.5",
    b"0",
    b"99999999999999999999",
    b"2025/07/08",
    b"23:59:60",
    b"2374",
    b"604800",
    b"40.5",
    b"-105",
    b"\xef\xbb\xbf",
    b"\xff\xfe",
    b"\0",
    b"\x1f\x8b\x08\0",
    b"GPST",
];

struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % n as u64) as usize
    }

    fn bytes(&mut self) -> Vec<u8> {
        let mut bytes = Vec::new();
        for _ in 0..self.below(200) {
            if self.below(4) == 0 {
                bytes.push(self.below(256) as u8);
            } else {
                bytes.extend_from_slice(PIECES[self.below(PIECES.len())]);
            }
        }
        bytes
    }
}

fn temporary(name: &str) -> PathBuf {
    std::env::temp_dir().join(format!("undrift-io-hostile-{}-{name}", std::process::id()))
}

#[test]
fn tables_of_arbitrary_bytes() {
    let mut random = Random(11);
    let mut rows = 0u64;
    for case in 0..CASES {
        let mut bytes = if case % 4 > 0 {
            b"t,gx\n1.5,2\n".to_vec()
        } else {
            Vec::new()
        };
        bytes.extend(random.bytes());
        let size = bytes.len() as u64;
        let columns = [
            vec![Column::Number(1)],
            vec![Column::Number(2), Column::Number(1), Column::Number(2)],
            vec![Column::Name("gx".into()), Column::Number(1)],
        ];
        let wanted = &columns[case % 3];
        let options = TableOptions {
            columns: wanted
                .iter()
                .map(|c| ("key".to_owned(), c.clone()))
                .collect(),
            delimiter: [None, Some(b','), Some(b' '), Some(b'"')][case % 4],
            header_lines: u64::from(case % 7 == 0),
            keep_not_finite: case % 2 == 0,
            of_one_sensor: case % 4 < 2,
            optional: (case % 3 == 0).then_some(case % 2),
            angles: (case % 10 == 0).then_some(Angles {
                place: case % 3,
                minutes: case % 20 == 0,
            }),
            stamp: (case % 5 == 0).then(|| Stamp {
                column: "time".into(),
                place: 0,
                scale: 1.0,
                date: (case % 2 == 0).then(|| ("key".to_owned(), Column::Number(2))),
            }),
        };
        let source = Box::new(Cursor::new(bytes));
        let opened = Opened::stream("x".as_ref(), source);
        let Ok(mut table) = opened.and_then(|opened| opened.table(&options)) else {
            continue;
        };
        let mut row = vec![0.0; wanted.len()];
        while let Ok(Some(line)) = table.next_row(&mut row) {
            assert!(line <= size + 1);
            assert!(options.keep_not_finite || row.iter().all(|value| value.is_finite()));
            rows += 1;
        }
        assert!(table.rows_seen() <= size + 1);
    }
    // The cases reach the parser: otherwise this test would guard nothing.
    assert!(rows > 500, "{rows}");
}

#[test]
fn inertial_logs_of_arbitrary_bytes() {
    let mut random = Random(5);
    let n = Column::Number;
    for case in 0..CASES {
        let format = ImuFormat {
            rate_hz: (case % 2 == 0).then_some(100.0),
            ..ImuFormat::new(
                (case % 3 > 0).then_some(n(1)),
                [n(1), n(1), n(2)],
                [n(2), n(1), n(1)],
            )
        };
        let source = Box::new(Cursor::new(random.bytes()));
        let opened = Opened::stream("x".as_ref(), source);
        if let Ok(reader) = opened.and_then(|opened| ImuReader::new(opened, &format)) {
            let mut last = f64::NEG_INFINITY;
            for sample in reader.flatten() {
                assert!(sample.time > last && sample.dt > 0.0);
                last = sample.time;
            }
        }
    }
}

#[test]
fn solution_files_of_arbitrary_bytes() {
    let mut random = Random(3);
    let path = temporary("gnss.pos");
    let options = GnssLog {
        base: Some(Geodetic::default()),
        ..GnssLog::new(Format::Rtklib)
    };
    let mut fixes = 0u64;
    for case in 0..CASES {
        let mut bytes = POS_HEADERS[case % 3].as_bytes().to_vec();
        if case % 10 == 0 {
            bytes.clear();
        }
        for _ in 0..random.below(6) {
            bytes.extend_from_slice(format!("2374 {}", random.below(700_000)).as_bytes());
            for _ in 0..random.below(20) {
                bytes.extend_from_slice(format!(" {}", random.below(100)).as_bytes());
            }
            bytes.push(b'\n');
        }
        bytes.extend(random.bytes());
        std::fs::write(&path, &bytes).unwrap();
        // What begins as a compressed stream need not be one.
        let Ok(opened) = Opened::open(&path) else {
            continue;
        };
        let _ = opened.format();
        if let Ok(reader) = GnssReader::new(opened, &options.clone().into()) {
            for fix in reader.flatten() {
                fixes += 1;
                if let Some((_, covariance)) = fix.position {
                    assert!(covariance.cholesky().is_some(), "{covariance}");
                }
            }
        }
    }
    std::fs::remove_file(&path).unwrap();
    assert!(fixes > 500, "{fixes}");
}

/// The seeds of the fuzzer, some of their bytes replaced by pieces of formats or cut away.
#[test]
fn damaged_files_of_poses() {
    let mut random = Random(11);
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fuzz/corpus-seeds/poses");
    let mut read = 0;
    for name in ["tum.txt", "kitti.txt", "euroc.csv", "motive.csv"] {
        let whole = std::fs::read(PathBuf::from(folder).join(name)).unwrap();
        for _ in 0..CASES / 4 {
            let mut bytes = whole.clone();
            for _ in 0..1 + random.below(3) {
                let from = random.below(bytes.len());
                let to = bytes.len().min(from + random.below(4));
                bytes.splice(from..to, PIECES[random.below(PIECES.len())].iter().copied());
            }
            let open = || Opened::stream(name.as_ref(), Cursor::new(bytes.clone()));
            let Ok(Some(source)) = open().and_then(|mut opened| detect(&mut opened, None)) else {
                continue;
            };
            let mut last = f64::NEG_INFINITY;
            for pose in PoseReader::new(open().unwrap(), &source)
                .into_iter()
                .flatten()
                .flatten()
            {
                assert!(pose.time > last, "{pose:?}");
                last = pose.time;
                assert!(
                    pose.position.is_none_or(|p| p.norm().is_finite()),
                    "{pose:?}"
                );
                // Some roundings of a root of a sum of squares.
                let unit = pose.attitude.is_none_or(|q| (q.norm() - 1.0).abs() < 1e-12);
                assert!(unit, "{pose:?}");
                read += 1;
            }
        }
    }
    assert!(read > 800, "{read}");
}

#[test]
fn damaged_gzip() {
    let mut random = Random(9);
    let path = temporary("damaged.csv.gz");
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    for k in 0..2000 {
        use std::io::Write;
        writeln!(encoder, "{k},{}", k * 31 % 97).unwrap();
    }
    let whole = encoder.finish().unwrap();
    let options = TableOptions {
        columns: vec![("key".into(), Column::Number(1))],
        ..TableOptions::default()
    };
    let mut broken_off = 0;
    for _ in 0..300 {
        let mut bytes = whole.clone();
        let at = random.below(bytes.len());
        bytes[at] ^= 1 << random.below(8);
        std::fs::write(&path, &bytes).unwrap();
        let Ok(opened) = Opened::open(&path) else {
            continue;
        };
        let Ok(mut table) = opened.table(&options) else {
            continue;
        };
        let mut row = [0.0];
        while let Ok(Some(_)) = table.next_row(&mut row) {}
        broken_off += u32::from(!table.skipped().is_empty());
    }
    std::fs::remove_file(&path).unwrap();
    assert!(broken_off > 100, "{broken_off}");
}
