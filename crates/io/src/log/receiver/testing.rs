//! What the tests of these readers share.

use std::collections::HashMap;
use std::io::{BufReader, Cursor, Read, Write};
use std::path::Path;

use undrift_nav::Vector3;
use undrift_nav::sample::TruthSample;

use crate::ReadError;
use crate::entry::{Entries, Entry, Fix, Heading, ImuReading, Wanted, What};
use crate::number;
use crate::skipped::Skipped;
use crate::source::{self, Source};

/// A reader's function.
pub(in crate::log) type Open = fn(Source, &Wanted) -> Result<Entries, ReadError>;

/// The inertial samples of the stream of this name.
pub(in crate::log) fn wanted_imu(name: Option<&str>) -> Wanted {
    Wanted::Imu(name.map(str::to_owned))
}

/// The fixes of the stream of this name.
pub(in crate::log) fn wanted_fixes(name: Option<&str>) -> Wanted {
    Wanted::Fixes {
        position: name.map(str::to_owned),
        velocity: None,
        base: None,
        at_once: false,
    }
}

/// Some roundings of numbers of degrees, radians and metres.
pub(in crate::log) const ROUNDING: f64 = 1e-12;

pub(in crate::log) const FIXES: Wanted = Wanted::Fixes {
    position: None,
    velocity: None,
    base: None,
    at_once: false,
};

pub(in crate::log) fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= ROUNDING * b.abs().max(1.0)
}

pub(in crate::log) fn same(a: Vector3, b: [f64; 3]) -> bool {
    a.iter().zip(b).all(|(a, b)| near(*a, b))
}

fn golden_path(name: &str) -> std::path::PathBuf {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../../testdata/golden/formats");
    Path::new(root).join(name)
}

/// A file of testdata/golden/formats.
pub(in crate::log) fn golden(name: &str) -> Vec<u8> {
    std::fs::read(golden_path(name)).unwrap()
}

/// A table of golden values by their columns; an empty field is `None`, True and False are 1 and 0.
pub(in crate::log) fn table(name: &str) -> Vec<HashMap<String, Option<f64>>> {
    let text = String::from_utf8(golden(name)).unwrap();
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let row = |line: &str| {
        let values = line.split(',').map(|field| number::parse(field.as_bytes()));
        header
            .iter()
            .map(|name| (*name).to_owned())
            .zip(values)
            .collect()
    };
    lines.map(row).collect()
}

/// Gives the bytes in pieces of the size, so that messages straddle the reads.
struct Pieces(Cursor<Vec<u8>>, usize);

impl Read for Pieces {
    fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
        let n = into.len().min(self.1);
        self.0.read(&mut into[..n])
    }
}

pub(in crate::log) fn source_of(bytes: &[u8]) -> Source {
    Box::new(Cursor::new(bytes.to_vec()))
}

/// All that a reader makes of some bytes, and what it skipped; the first error.
pub(in crate::log) fn try_all(
    open: Open,
    source: Source,
    wanted: &Wanted,
) -> (Vec<Entry>, Skipped, Option<ReadError>) {
    let (mut entries, mut skipped) = (Vec::new(), Skipped::default());
    let opened = match open(source, wanted) {
        Ok(opened) => opened,
        Err(error) => return (entries, skipped, Some(error)),
    };
    for entry in opened {
        match entry {
            Ok(Entry {
                at,
                what: What::Skipped(kind, detail),
            }) => skipped.add(kind, at, detail),
            Ok(entry) => entries.push(entry),
            Err(error) => return (entries, skipped, Some(error)),
        }
    }
    (entries, skipped, None)
}

pub(in crate::log) fn all(open: Open, bytes: &[u8], wanted: &Wanted) -> (Vec<Entry>, Skipped) {
    let (entries, skipped, error) = try_all(open, source_of(bytes), wanted);
    assert!(error.is_none(), "{}", error.unwrap());
    (entries, skipped)
}

pub(in crate::log) fn fixes(open: Open, bytes: &[u8]) -> (Vec<Fix>, Skipped) {
    let (entries, skipped) = all(open, bytes, &FIXES);
    (entries.iter().map(fix).collect(), skipped)
}

fn fix(entry: &Entry) -> Fix {
    match entry.what {
        What::Fix(fix) => fix,
        _ => panic!("no fix: {entry:?}"),
    }
}

/// The inertial samples of a stream.
pub(in crate::log) fn imu(open: Open, bytes: &[u8], name: Option<&str>) -> Vec<ImuReading> {
    let (entries, _) = all(open, bytes, &wanted_imu(name));
    let reading = |entry: Entry| match entry.what {
        What::Imu(reading) => reading,
        other => panic!("{other:?}"),
    };
    entries.into_iter().map(reading).collect()
}

/// The reference solutions of a stream.
pub(in crate::log) fn poses(open: Open, bytes: &[u8], name: Option<&str>) -> Vec<TruthSample> {
    let (entries, _) = all(open, bytes, &Wanted::Poses(name.map(str::to_owned)));
    let pose = |entry: Entry| match entry.what {
        What::Pose(pose) => pose,
        other => panic!("{other:?}"),
    };
    entries.into_iter().map(pose).collect()
}

/// The headings of a stream.
pub(in crate::log) fn headings(
    open: Open,
    bytes: &[u8],
    name: Option<&str>,
) -> (Vec<Heading>, Skipped) {
    let (entries, skipped) = all(open, bytes, &Wanted::Headings(name.map(str::to_owned)));
    let heading = |entry: Entry| match entry.what {
        What::Heading(heading) => heading,
        other => panic!("{other:?}"),
    };
    (entries.into_iter().map(heading).collect(), skipped)
}

/// The error that ends the entries.
pub(in crate::log) fn refused(open: Open, bytes: &[u8], wanted: &Wanted) -> String {
    let (_, _, error) = try_all(open, source_of(bytes), wanted);
    error.unwrap().to_string()
}

/// Whatever is cut off, what is before it stays as it is: all but the last fix, which lacks
/// messages.
pub(in crate::log) fn cut_at_every_byte(open: Open, bytes: &[u8]) {
    let (whole, _) = fixes(open, bytes);
    assert!(whole.len() > 3);
    for length in 0..bytes.len() {
        let (entries, _, _) = try_all(open, source_of(&bytes[..length]), &FIXES);
        let cut: Vec<Fix> = entries.iter().map(fix).collect();
        assert!(cut.len() <= whole.len(), "{length}");
        let sure = cut.len().saturating_sub(1);
        assert_eq!(cut[..sure], whole[..sure], "{length}");
    }
}

/// One wrong bit costs no more than the fixes that it falls in; the others stay as they are.
pub(in crate::log) fn flip_every_byte(open: Open, bytes: &[u8], lost: usize) {
    let (whole, _) = fixes(open, bytes);
    let mut flipped = bytes.to_vec();
    for k in 0..bytes.len() {
        flipped[k] ^= 1 << (k % 8);
        let (entries, _, _) = try_all(open, source_of(&flipped), &FIXES);
        let same = entries.iter().filter(|entry| whole.contains(&fix(entry)));
        assert!(same.count() + lost >= whole.len(), "byte {k}");
        assert!(entries.len() <= whole.len() + 1, "byte {k}");
        flipped[k] = bytes[k];
    }
}

/// The size of the reads and compression make no difference; nothing is nothing.
pub(in crate::log) fn whatever_the_source(open: Open, bytes: &[u8]) {
    let (whole, _) = fixes(open, bytes);
    for piece in [1, 7, 1000] {
        let pieces = Pieces(Cursor::new(bytes.to_vec()), piece);
        let source = Box::new(BufReader::with_capacity(1, pieces));
        let (entries, _, error) = try_all(open, source, &FIXES);
        assert!(error.is_none());
        assert_eq!(entries.iter().map(fix).collect::<Vec<_>>(), whole);
    }
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(bytes).unwrap();
    let packed = encoder.finish().unwrap();
    let mut file = tempfile();
    file.1.write_all(&packed).unwrap();
    let (entries, _, error) = try_all(open, source::open(&file.0).unwrap(), &FIXES);
    assert!(error.is_none());
    assert_eq!(entries.iter().map(fix).collect::<Vec<_>>(), whole);
    // A member cut in its middle: what could be unpacked stays.
    std::fs::write(&file.0, &packed[..packed.len() / 2]).unwrap();
    let (entries, skipped, _) = try_all(open, source::open(&file.0).unwrap(), &FIXES);
    std::fs::remove_file(&file.0).unwrap();
    let cut: Vec<Fix> = entries.iter().map(fix).collect();
    assert_eq!(cut[..cut.len() - 1], whole[..cut.len() - 1]);
    assert_eq!(skipped.count(crate::skipped::SkipKind::EndsEarly), 1);
}

fn tempfile() -> (std::path::PathBuf, std::fs::File) {
    use std::sync::atomic::{AtomicU32, Ordering};
    static NUMBER: AtomicU32 = AtomicU32::new(0);
    let number = NUMBER.fetch_add(1, Ordering::Relaxed);
    let name = format!("undrift-io-{}-receiver-{number}.gz", std::process::id());
    let path = std::env::temp_dir().join(name);
    let file = std::fs::File::create(&path).unwrap();
    (path, file)
}

/// Pieces of all the formats put together at random: whatever comes, the readers end, and what they
/// give is finite.
#[test]
fn random_mixtures() {
    use crate::log::{gpx, nmea, novatel, sbf, ubx};
    let names = [
        "ubx/drive.ubx",
        "ubx/sensors.ubx",
        "nmea/drive.nmea",
        "gpx/track.gpx",
        "novatel/fixes.bin",
        "novatel/epson.asc",
        "sbf/fixes.sbf",
        "sbf/sensors.sbf",
    ];
    let parts = names.map(golden);
    let mut state = 1u64;
    let mut below = move |n: usize| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state % n as u64) as usize
    };
    let readers: [Open; 5] = [
        ubx::entries,
        nmea::entries,
        gpx::entries,
        novatel::entries,
        sbf::entries,
    ];
    for _ in 0..1000 {
        let mut bytes = b"<gpx>".to_vec();
        for _ in 0..8 {
            let part = &parts[below(parts.len())];
            let from = below(part.len());
            let to = from + below(600).min(part.len() - from);
            bytes.extend_from_slice(&part[from..to]);
            for _ in 0..below(3) {
                let at = below(bytes.len());
                bytes[at] = below(256) as u8;
            }
        }
        for wanted in [
            FIXES,
            Wanted::Imu(None),
            Wanted::Poses(None),
            Wanted::Headings(None),
        ] {
            for open in readers {
                for entry in try_all(open, source_of(&bytes), &wanted).0 {
                    let finite = match entry.what {
                        What::Imu(imu) => imu.time + imu.gyro.sum() + imu.accel.sum(),
                        What::Fix(fix) => fix.time + fix.velocity.map_or(0.0, |(v_n, _)| v_n.sum()),
                        What::Pose(pose) => pose.time + pose.position.to_ecef().sum(),
                        What::LocalPose(pose) => pose.time,
                        What::Heading(heading) => heading.time + heading.heading,
                        What::Field(reading) => reading.time + reading.field.sum(),
                        What::Skipped(..) => 0.0,
                    };
                    assert!(finite.is_finite());
                }
            }
        }
        ubx::detect(&bytes);
        nmea::detect(&bytes);
        gpx::detect(&bytes);
        novatel::detect(&bytes);
        sbf::detect(&bytes);
    }
}
