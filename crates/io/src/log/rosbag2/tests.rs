//! Damaged bags, and files that are not bags; what whole ones hold is tested with the other recordings of ROS.

use std::path::{Path, PathBuf};

use super::*;
use crate::entry::{Entry, What};
use crate::format::Format;
use crate::skipped::SkipKind;
use crate::{Memory, Opened};

fn golden(name: &str) -> PathBuf {
    let root = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../testdata/golden/formats/rosbag2"
    );
    Path::new(root).join(name)
}

fn bytes(name: &str) -> Vec<u8> {
    std::fs::read(golden(name)).unwrap()
}

/// The entries of a database in memory.
fn read(bytes: &[u8]) -> Result<Vec<Entry>, ReadError> {
    let parts = vec![BagFile::Held("bag.db3".into(), bytes.to_vec())];
    let wanted = Wanted::Imu(Some("/imu/data".to_owned()));
    entries(parts, &BytesRead::default(), &wanted)?.collect()
}

fn samples(entries: &[Entry]) -> Vec<[f64; 4]> {
    let sample = |entry: &Entry| match &entry.what {
        What::Imu(reading) => Some([
            reading.time,
            reading.gyro.x,
            reading.accel.y,
            reading.accel.z,
        ]),
        _ => None,
    };
    entries.iter().filter_map(sample).collect()
}

fn skips(entries: &[Entry], of: SkipKind) -> usize {
    let is = |entry: &&Entry| matches!(&entry.what, What::Skipped(kind, _) if *kind == of);
    entries.iter().filter(is).count()
}

/// Pages that are left are read, and that others are missing is counted.
#[test]
fn databases_cut_anywhere_are_read_as_far_as_they_go() {
    for (name, step) in [("small-pages.db3", 256), ("plain.db3", 1024)] {
        let bytes = bytes(name);
        let whole = samples(&read(&bytes).unwrap());
        assert_eq!(whole.len(), 11, "{name}");
        let mut counts = Vec::new();
        for n in (0..=bytes.len()).step_by(step) {
            let Ok(cut) = read(&bytes[..n]) else {
                continue;
            };
            let found = samples(&cut);
            assert!(
                found.iter().all(|sample| whole.contains(sample)),
                "{name} {n}"
            );
            if found.len() < whole.len() {
                assert_eq!(skips(&cut, SkipKind::EndsEarly), 1, "{name} cut at {n}");
            }
            counts.push(found.len());
        }
        // The more there is of the file, the more of it is read; several steps on the way.
        assert!(counts.is_sorted(), "{name}: {counts:?}");
        assert!(
            *counts.last().unwrap() == 11 && *counts.first().unwrap() < 11,
            "{name}"
        );
        counts.dedup();
        assert!(counts.len() > 1, "{name}: {counts:?}");
    }
}

/// A database has no checksums: wrong numbers are possible, panics and endless reading are not.
#[test]
fn flipped_bits_and_bytes() {
    let whole = bytes("small-pages.db3");
    let mut given = 0;
    for n in 0..whole.len() {
        let mut damaged = whole.clone();
        if n % 3 == 0 {
            damaged[n] ^= 1 << (n / 3 % 8);
        } else {
            damaged[n] = [0x00, 0xff][n % 2];
        }
        given += samples(&read(&damaged).unwrap_or_default()).len();
    }
    // Most damage costs at most one message.
    assert!(given > 10 * whole.len(), "{given}");
}

/// Where the tree of a table begins is in the schema; the first page of a table of some pages is inner.
fn inner_page(bytes: &[u8]) -> usize {
    let page = |start: &usize| bytes[*start] == 0x05;
    (512..bytes.len()).step_by(512).find(page).unwrap()
}

#[test]
fn links_in_a_circle_end() {
    let mut bytes = bytes("small-pages.db3");
    let start = inner_page(&bytes);
    let number = (start / 512 + 1) as u32;
    // All children of the inner page are itself.
    let cells = usize::from(u16::from_be_bytes([bytes[start + 3], bytes[start + 4]]));
    for cell in 0..cells {
        let at = start + 12 + 2 * cell;
        let at = start + usize::from(u16::from_be_bytes([bytes[at], bytes[at + 1]]));
        bytes[at..at + 4].copy_from_slice(&number.to_be_bytes());
    }
    let entries = read(&bytes).unwrap();
    assert_eq!(skips(&entries, SkipKind::Damaged), cells);
}

#[test]
fn absurd_lengths_take_no_memory() {
    let mut bytes = bytes("plain.db3");
    // The last message's row: its length is made 2⁵⁶ or so. The rows of a leaf are written from its end.
    let leaf = |start: &usize| bytes[*start] == 0x0d && bytes[*start + 4] > 5;
    let start = (4096..bytes.len()).step_by(4096).rfind(leaf).unwrap();
    let at = start + 8;
    let at = start + usize::from(u16::from_be_bytes([bytes[at], bytes[at + 1]]));
    bytes[at..at + 8].fill(0xff);
    let entries = read(&bytes).unwrap();
    assert!(skips(&entries, SkipKind::Damaged) >= 1);
}

#[test]
fn what_is_no_bag_or_has_no_messages() {
    let error = |path: &Path| match Opened::open(path).and_then(|log| log.streams(Format::RosBag2))
    {
        Ok(streams) => panic!("{streams:?}"),
        Err(error) => error.to_string(),
    };
    let none = error(&golden("no-messages.db3"));
    assert!(
        none.ends_with("no-messages.db3: a ROS 2 bag without messages"),
        "{none}"
    );
    for path in ["unwritten", "unwritten/running.db3"] {
        let unwritten = error(&golden(path));
        assert!(
            unwritten.contains("without messages; the recorder was stopped"),
            "{unwritten}"
        );
        assert!(unwritten.contains("running.db3-wal"), "{unwritten}");
    }
    let folder = error(&golden("../ulog"));
    assert!(
        folder.contains("is a folder, not a log, and has no ROS 2 bag"),
        "{folder}"
    );
    let text = error(&golden("make.py"));
    assert!(text.contains("neither SQLite nor MCAP"), "{text}");

    // The tables are there, their pages are not.
    let short = read(&bytes("plain.db3")[..30_000]).unwrap_err();
    assert!(short.mend.contains("page 10 of the database"), "{short}");

    let mut other = bytes("no-messages.db3");
    while let Some(at) = memchr::memmem::find(&other, b"messages") {
        other[at] = b'x';
    }
    let other = read(&other).unwrap_err().to_string();
    assert!(
        other.contains("without the tables topics and messages"),
        "{other}"
    );
    assert!(
        other.contains("the file has: ") && other.contains("topics"),
        "{other}"
    );
}

#[test]
fn a_part_that_is_missing_is_counted() {
    let folder = std::env::temp_dir().join(format!("undrift-io-{}-split", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    for name in ["metadata.yaml", "bag_b.db3", "bag_a.db3"] {
        std::fs::copy(golden("split").join(name), folder.join(name)).unwrap();
    }
    let opened = Opened::open(&folder).unwrap();
    assert_eq!(opened.format(), Format::RosBag2);
    let mut log = opened.log(Format::RosBag2, &Wanted::Imu(None)).unwrap();
    let mut samples = 0;
    while log.next().unwrap().is_some() {
        samples += 1;
    }
    let skipped = log.skipped().to_string();
    let table = Opened::open(&folder).unwrap().preview(1).unwrap_err();
    std::fs::remove_dir_all(&folder).unwrap();
    // The sample without a rate is in the part that is missing.
    assert_eq!(samples, 11);
    assert!(skipped.contains("bag_c.db3: no such file"), "{skipped}");
    assert!(table.problem.contains("not a table"), "{table}");
}

#[test]
fn pipes_and_compressed_databases_are_held() {
    let read = |name: &str| {
        let memory = Memory::Bytes(bytes(name).into());
        let opened = Opened::memory("pipe".as_ref(), memory, &BytesRead::default()).unwrap();
        assert_eq!(opened.format(), Format::RosBag2);
        opened.streams(Format::RosBag2).unwrap()
    };
    assert_eq!(read("plain.db3"), read("file.db3.zstd"));
    assert_eq!(read("plain.db3").len(), 6);
}

/// The whole file counts as read at its end.
#[test]
fn what_is_read_is_counted() {
    let read = BytesRead::default();
    let opened = Opened::counted(&golden("split"), &read).unwrap();
    let mut log = opened.log(Format::RosBag2, &Wanted::Imu(None)).unwrap();
    while log.next().unwrap().is_some() {}
    let parts = ["split/bag_a.db3", "split/bag_b.db3", "split/bag_c.db3"];
    let all: usize = parts.iter().map(|name| bytes(name).len()).sum();
    let counted = read.bytes().load(std::sync::atomic::Ordering::Relaxed);
    assert_eq!(counted, all as u64);
}
