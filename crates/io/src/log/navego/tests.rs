use std::io::{BufReader, Cursor, Write};
use std::path::{Path, PathBuf};

use serde_json::Value;
use undrift_nav::sample::Position;

use super::*;
use crate::log::receiver::testing::{wanted_fixes as fixes, wanted_imu as imu};
use crate::source;

fn golden(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../testdata/golden/formats/navego")
        .join(name)
}

/// What was written, row by row.
fn expected(variable: &str) -> Vec<Vec<f64>> {
    let text = std::fs::read_to_string(golden("expected.json")).unwrap();
    let value: Value = serde_json::from_str(&text).unwrap();
    let row = |row: &Value| {
        let numbers = row.as_array().unwrap().iter();
        numbers.map(|x| x.as_f64().unwrap()).collect()
    };
    value[variable]
        .as_array()
        .unwrap()
        .iter()
        .map(row)
        .collect()
}

fn all_of(file: &str, wanted: &Wanted) -> Result<Vec<Entry>, ReadError> {
    let path = golden(file);
    entries(source::open(&path)?, wanted)?.collect()
}

fn from_bytes(bytes: &[u8], wanted: &Wanted) -> Result<Vec<Entry>, ReadError> {
    let source = Box::new(BufReader::new(Cursor::new(bytes.to_vec())));
    entries(source, wanted)?.collect()
}

/// The numbers of an entry in the order of the golden rows; none of one that was skipped.
fn numbers(entry: &Entry) -> Option<Vec<f64>> {
    let place = |p: &undrift_nav::earth::Geodetic| [p.lat, p.lon, p.height];
    match &entry.what {
        What::Imu(s) => Some([&[s.time], s.gyro.as_slice(), s.accel.as_slice()].concat()),
        What::Fix(fix) => {
            let Some((Position::Geodetic(p), _)) = &fix.position else {
                panic!("no place");
            };
            let velocity = fix.velocity.unwrap().0;
            Some([&[fix.time], &place(p)[..], velocity.as_slice()].concat())
        }
        What::Pose(pose) => {
            let (v, rpy) = (pose.v_n.unwrap(), pose.rpy.unwrap());
            let p = place(&pose.position);
            Some([&[pose.time], &p[..], v.as_slice(), rpy.as_slice()].concat())
        }
        What::LocalPose(_) | What::Heading(_) | What::Field(_) | What::Skipped(..) => None,
    }
}

/// Equal but for the last bit, in which the reader of JSON may err.
#[track_caller]
fn same(ours: &[f64], theirs: &[f64]) {
    let near = |(a, b): (&f64, &f64)| (a - b).abs() <= f64::EPSILON * b.abs();
    assert_eq!(ours.len(), theirs.len());
    let equal = ours.iter().zip(theirs).all(near);
    assert!(equal, "{ours:?} {theirs:?}");
}

#[track_caller]
fn all_same(ours: &[Vec<f64>], theirs: &[Vec<f64>]) {
    assert_eq!(ours.len(), theirs.len());
    for (ours, theirs) in ours.iter().zip(theirs) {
        same(ours, theirs);
    }
}

#[test]
fn what_was_written_is_read() {
    for file in ["plain.mat", "compressed.mat"] {
        for (wanted, name) in [
            (imu(None), "imu"),
            (fixes(None), "gnss"),
            (Wanted::Poses(Some("ref".into())), "ref"),
        ] {
            let entries = all_of(file, &wanted).unwrap();
            let found: Vec<_> = entries.iter().map(|e| numbers(e).unwrap()).collect();
            all_same(&found, &expected(name));
            assert_eq!(entries[1].at, 2);
        }
    }
    let entries = all_of("big.mat", &imu(None)).unwrap();
    let found: Vec<_> = entries.iter().map(|e| numbers(e).unwrap()).collect();
    all_same(&found, &expected("imu"));
}

#[test]
fn standard_deviations_are_one_for_all_or_one_each() {
    let entries = all_of("plain.mat", &fixes(None)).unwrap();
    for entry in &entries {
        let What::Fix(fix) = &entry.what else {
            panic!("{entry:?}");
        };
        let position = fix.position.unwrap().1.unwrap().diagonal();
        assert_eq!(position.as_slice(), [25.0, 25.0, 100.0]);
        let velocity = fix.velocity.unwrap().1.unwrap().diagonal();
        assert_eq!(velocity.as_slice(), [0.05 * 0.05; 3]);
    }
    let entries = all_of("columns.mat", &fixes(Some("gnss1"))).unwrap();
    let found: Vec<_> = entries
        .iter()
        .filter_map(|e| Some((numbers(e)?, e)))
        .collect();
    let theirs = expected("gnss1");
    assert_eq!(found.len(), theirs.len());
    for ((ours, entry), row) in found.iter().zip(&theirs) {
        same(ours, &row[..7]);
        let What::Fix(fix) = &entry.what else {
            panic!("{entry:?}");
        };
        assert!(fix.velocity.unwrap().1.is_none());
        match fix.position.unwrap().1 {
            Some(c) => same(c.diagonal().map(f64::sqrt).as_slice(), &row[7..]),
            None => assert_eq!(row[7], 0.0),
        }
    }
    let skipped = entries.iter().filter(|e| numbers(e).is_none());
    assert_eq!(skipped.map(|e| e.at).collect::<Vec<_>>(), [3]);
}

#[test]
fn vectors_may_be_columns_and_attitudes_matrices() {
    let entries = all_of("columns.mat", &imu(None)).unwrap();
    let found: Vec<_> = entries.iter().filter_map(numbers).collect();
    all_same(&found, &expected("my_imu"));
    assert!(matches!(
        entries[4].what,
        What::Skipped(SkipKind::NotFinite, _)
    ));
    let entries = all_of("columns.mat", &Wanted::Poses(None)).unwrap();
    let theirs = expected("ref");
    assert_eq!(entries.len(), theirs.len());
    for (entry, row) in entries.iter().zip(&theirs) {
        let What::Pose(pose) = &entry.what else {
            panic!("{entry:?}");
        };
        assert!(pose.v_n.is_none());
        let rpy = pose.rpy.unwrap();
        for i in 0..3 {
            // Roundings of sines and cosines, over the cosine of a pitch of 1.5 rad at most.
            assert!((rpy[i] - row[7 + i]).abs() < 1e-13, "{rpy:?} {row:?}");
        }
    }
}

#[test]
fn variables_are_listed_by_what_they_hold() {
    let path = golden("compressed.mat");
    let streams = streams(source::open(&path).unwrap()).unwrap();
    let kinds: Vec<_> = streams
        .iter()
        .map(|s| (s.name.as_str(), s.kind, s.messages))
        .collect();
    assert_eq!(
        kinds,
        [
            ("imu", StreamKind::Imu, 40),
            ("gnss", StreamKind::Fixes, 8),
            ("ref", StreamKind::Poses, 40),
            ("note", StreamKind::Other, 0),
            ("cells", StreamKind::Other, 0),
            ("velocity", StreamKind::Velocity, 8),
            ("table", StreamKind::Other, 0),
            ("several", StreamKind::Other, 0),
        ]
    );
    assert_eq!(streams[6].about, "double 3×3");
    let about = &streams[1].about;
    assert!(about.starts_with("struct 1×1 with t, lat"), "{about}");
    assert!(about.ends_with("larm 0.1, 0.2, -0.3 m"), "{about}");
}

#[test]
fn what_is_not_there_is_said_with_what_there_is() {
    let refused = |file: &str, wanted: &Wanted| all_of(file, wanted).unwrap_err().to_string();
    let message = refused("plain.mat", &imu(Some("ustrain")));
    assert!(message.contains("no variable ustrain (key imu.topic); the file has: imu, gnss"));
    let message = refused("columns.mat", &fixes(None));
    assert!(message.contains("gnss1 and gnss2 are both"), "{message}");
    let message = refused("plain.mat", &imu(Some("gnss")));
    assert!(
        message.contains("gnss is no structure with t, fb, wb"),
        "{message}"
    );
    let message = refused("big.mat", &fixes(None));
    assert!(message.contains("no structure with t, lat, lon, h (key gnss.topic)"));
    let apart = Wanted::Fixes {
        position: Some("gnss".into()),
        velocity: Some("velocity".into()),
        base: None,
        at_once: false,
    };
    assert!(refused("plain.mat", &apart).contains("gnss.velocity_topic"));
    let mut other = std::fs::read(golden("plain.mat")).unwrap();
    let at = other.windows(6).position(|w| w == b"wb\0\0\0\0").unwrap();
    other[at..at + 2].copy_from_slice(b"xx");
    let message = from_bytes(&other, &imu(Some("imu")))
        .unwrap_err()
        .to_string();
    assert!(message.contains("imu is no structure"), "{message}");
}

#[test]
fn what_is_no_such_file_is_refused_and_gzip_is_read() {
    let message = |bytes: &[u8]| from_bytes(bytes, &imu(None)).unwrap_err().to_string();
    assert!(message(b"").contains("is empty"));
    let hdf5 = [
        &b"MATLAB 7.3 MAT-file"[..],
        &[b' '; 493],
        b"\x89HDF\r\n\x1a\n",
    ]
    .concat();
    let text = message(&hdf5);
    assert!(text.contains("version 7.3; save it with -v7"), "{text}");
    assert!(message(&[b' '; 200]).contains("not a MATLAB file"));
    let bytes = std::fs::read(golden("compressed.mat")).unwrap();
    assert!(detect(&bytes) && detect(&hdf5) && !detect(b"MATLAB"));
    assert!(message(&bytes[..128]).contains("no structure with t, fb, wb"));
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(&bytes).unwrap();
    let path = std::env::temp_dir().join(format!("undrift-io-mat-{}.gz", std::process::id()));
    std::fs::write(&path, encoder.finish().unwrap()).unwrap();
    let source = source::open(&path).unwrap();
    assert_eq!(entries(source, &imu(None)).unwrap().count(), 40);
    std::fs::remove_file(&path).unwrap();
}

#[test]
fn a_compressed_variable_does_not_fill_the_memory() {
    let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
    let block = vec![0; 1 << 20];
    for _ in 0..513 {
        encoder.write_all(&block).unwrap();
    }
    let bomb = encoder.finish().unwrap();
    let header = &std::fs::read(golden("plain.mat")).unwrap()[..128];
    let tag = [15u32.to_le_bytes(), (bomb.len() as u32).to_le_bytes()].concat();
    let message = from_bytes(&[header, &tag, &bomb].concat(), &imu(None)).unwrap_err();
    assert!(
        message.to_string().contains("more than 512 MiB"),
        "{message}"
    );
    // A length that the file does not have is not believed.
    let tag = [14u32.to_le_bytes(), 0x1fff_fff0u32.to_le_bytes()].concat();
    let message = from_bytes(&[header, &tag].concat(), &imu(None)).unwrap_err();
    assert!(message.to_string().contains("in the middle"), "{message}");
}

fn read_all(bytes: &[u8]) {
    let open = || Box::new(BufReader::new(Cursor::new(bytes.to_vec())));
    let _ = streams(open());
    for wanted in [imu(None), fixes(None), Wanted::Poses(None)] {
        for entry in entries(open(), &wanted).into_iter().flatten() {
            match entry.unwrap().what {
                What::Imu(s) => assert!(s.time.is_finite() && !s.gyro.x.is_nan()),
                What::Fix(fix) => assert!(fix.time.is_finite()),
                What::Pose(pose) => assert!(pose.position.is_valid()),
                What::LocalPose(_) | What::Heading(_) | What::Field(_) | What::Skipped(..) => {}
            }
        }
    }
}

#[test]
fn files_that_break_off_or_are_damaged_do_no_harm() {
    for file in ["plain.mat", "compressed.mat", "columns.mat", "big.mat"] {
        let bytes = std::fs::read(golden(file)).unwrap();
        for length in (0..bytes.len()).step_by(17) {
            read_all(&bytes[..length]);
        }
        let mut state = 1u64;
        for _ in 0..1500 {
            let mut damaged = bytes.clone();
            for _ in 0..3 {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1);
                let at = (state >> 33) as usize % damaged.len();
                damaged[at] ^= 1 << ((state >> 20) & 7);
            }
            read_all(&damaged);
        }
    }
}
