//! Against recordings that other software wrote: testdata/golden/formats/rosbag, .../mcap and .../rosbag2.

mod apart;
mod poses;

use std::io::BufReader;
use std::path::PathBuf;

use serde_json::Value;
use undrift_nav::sample::{FixQuality, Position};
use undrift_nav::{Matrix3, Vector3};

use crate::ReadError;
use crate::entry::{Entries, Entry, Fix, ImuReading, Stream, StreamKind, Wanted, What};
use crate::log::rosbag2::{self, BagFile};
use crate::log::{bag, mcap};
use crate::skipped::SkipKind;
use crate::source::{self, BytesRead, Source};

/// All that hold the same recording.
const SAME: [&str; 14] = [
    "rosbag/none.bag",
    "rosbag/bz2.bag",
    "rosbag/lz4.bag",
    "mcap/rosbag2.mcap",
    "mcap/zstd.mcap",
    "mcap/lz4.mcap",
    "mcap/ros1.mcap",
    "mcap/big-endian.mcap",
    "rosbag2/plain.db3",
    "rosbag2/messages.db3",
    "rosbag2/file.db3.zstd",
    "rosbag2/small-pages.db3",
    "rosbag2/split",
    "rosbag2/split-mcap",
];

fn golden(name: &str) -> PathBuf {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../../testdata/golden/formats");
    PathBuf::from(root).join(name)
}

fn entries(name: &str, source: Source, wanted: &Wanted) -> Result<Entries, ReadError> {
    if name.ends_with(".bag") {
        bag::entries(source, wanted)
    } else {
        mcap::entries(source, wanted)
    }
}

/// The parts of a bag of ROS 2.
fn parts(name: &str) -> Option<Vec<BagFile>> {
    let path = golden(name);
    name.starts_with("rosbag2/").then(|| match path.is_dir() {
        true => rosbag2::parts_of_folder(&path).unwrap(),
        false => vec![BagFile::File(path)],
    })
}

fn read(name: &str, wanted: &Wanted) -> Result<Vec<Entry>, ReadError> {
    if let Some(parts) = parts(name) {
        return rosbag2::entries(parts, &BytesRead::default(), wanted)?.collect();
    }
    entries(name, source::open(&golden(name))?, wanted)?.collect()
}

fn streams(name: &str) -> Vec<Stream> {
    if let Some(parts) = parts(name) {
        return rosbag2::streams(parts).unwrap();
    }
    let path = golden(name);
    let source = source::open(&path).unwrap();
    if name.ends_with(".bag") {
        bag::streams(source).unwrap()
    } else {
        mcap::streams(source).unwrap()
    }
}

fn fixes(position: Option<&str>, velocity: Option<&str>) -> Wanted {
    Wanted::Fixes {
        position: position.map(str::to_owned),
        velocity: velocity.map(str::to_owned),
        base: None,
        at_once: false,
    }
}

fn readings(entries: &[Entry]) -> Vec<(u64, ImuReading)> {
    let reading = |entry: &Entry| match entry.what {
        What::Imu(reading) => Some((entry.at, reading)),
        _ => None,
    };
    entries.iter().filter_map(reading).collect()
}

fn found_fixes(entries: &[Entry]) -> Vec<(u64, Fix)> {
    let fix = |entry: &Entry| match entry.what {
        What::Fix(fix) => Some((entry.at, fix)),
        _ => None,
    };
    entries.iter().filter_map(fix).collect()
}

fn skips(entries: &[Entry]) -> Vec<(SkipKind, u64, &str)> {
    let mut skips = Vec::new();
    for entry in entries {
        if let What::Skipped(kind, detail) = &entry.what {
            skips.push((*kind, entry.at, detail.as_str()));
        }
    }
    skips
}

fn expected() -> Value {
    let text = std::fs::read_to_string(golden("rosbag/expected.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    let list = value.as_array().unwrap();
    list.iter().map(|number| number.as_f64().unwrap()).collect()
}

/// The time is the sum of whole seconds, which are exact, and of nanoseconds; one rounding of a
/// number of 6e5 is 6e-11, here and there.
const TIME: f64 = 2e-10;

#[test]
fn samples_are_those_of_the_recording() {
    for name in SAME {
        let entries = read(name, &Wanted::Imu(None)).unwrap();
        let found = readings(&entries);
        let expected = expected();
        let expected = expected["imu"].as_array().unwrap();
        assert_eq!(found.len(), expected.len(), "{name}");
        for ((at, reading), expected) in found.iter().zip(expected) {
            assert_eq!(*at, expected["at"].as_u64().unwrap(), "{name}");
            let time = expected["time"].as_f64().unwrap();
            assert!((reading.time - time).abs() < TIME, "{name}: {time}");
            assert_eq!(reading.gyro.as_slice(), numbers(&expected["gyro"]));
            assert_eq!(reading.accel.as_slice(), numbers(&expected["accel"]));
        }
        let skipped = skips(&entries);
        let no_rate = [(SkipKind::MissingField, 21, "no angular rate")];
        assert_eq!(skipped, no_rate, "{name}");
    }
}

#[test]
fn fixes_are_those_of_the_recording() {
    for name in SAME {
        // The velocities have the frame of the positions: they are found without a name.
        let entries = read(name, &fixes(None, None)).unwrap();
        let found = found_fixes(&entries);
        let expected = expected();
        let expected = expected["fixes"].as_array().unwrap();
        assert_eq!(found.len(), expected.len(), "{name}");
        for ((at, fix), expected) in found.iter().zip(expected) {
            compare(name, fix, expected);
            assert_eq!(*at, expected["at"].as_u64().unwrap(), "{name}");
        }
        let skipped = skips(&entries);
        assert_eq!(skipped.len(), 1, "{name}");
        assert_eq!(skipped[0].0, SkipKind::OutOfRange, "{name}");
    }
}

fn compare(name: &str, fix: &Fix, expected: &Value) {
    let time = expected["time"].as_f64().unwrap();
    assert!((fix.time - time).abs() < TIME, "{name}: {time}");
    let quality = match expected["quality"].as_str().unwrap() {
        "Single" => FixQuality::Single,
        "Differential" => FixQuality::Differential,
        _ => FixQuality::Unknown,
    };
    assert_eq!(fix.quality, quality, "{name} at {time}");
    let position = fix.position.map(|(position, covariance)| {
        let Position::Geodetic(place) = position else {
            panic!("a baseline")
        };
        let degrees = Vector3::new(place.lat.to_degrees(), place.lon.to_degrees(), place.height);
        (degrees, covariance)
    });
    // Degrees to radians and back are two roundings: 48° is exact to 7e-15.
    close(name, position, expected, "position", 2e-14);
    // The velocity's numbers are only reordered.
    close(name, fix.velocity, expected, "velocity", 0.0);
}

fn close(
    name: &str,
    found: Option<(Vector3, Option<Matrix3>)>,
    expected: &Value,
    key: &str,
    tolerance: f64,
) {
    assert_eq!(found.is_some(), !expected[key].is_null(), "{name} {key}");
    let Some((vector, covariance)) = found else {
        return;
    };
    let difference = vector - Vector3::from_row_slice(&numbers(&expected[key]));
    assert!(difference.amax() <= tolerance, "{name} {key} {difference}");
    let expected = &expected[format!("{key}_covariance")];
    assert_eq!(covariance.is_some(), !expected.is_null(), "{name} {key}");
    if let Some(covariance) = covariance {
        // Equal: the means of equal numbers.
        assert_eq!(covariance, Matrix3::from_row_slice(&numbers(expected)));
    }
}

#[test]
fn named_velocities_and_what_is_missing() {
    for name in SAME {
        let wheel = read(name, &fixes(None, Some("/wheel"))).unwrap();
        let found = found_fixes(&wheel);
        assert_eq!(found.len(), 6, "{name}");
        let (velocity, covariance) = found[0].1.velocity.unwrap();
        assert_eq!(velocity, Vector3::new(0.0, 3.0, 0.0));
        assert_eq!(covariance, None);

        let error = |wanted| read(name, &wanted).unwrap_err();
        let missing = error(Wanted::Imu(Some("/imu".to_owned())));
        assert_eq!(missing.key, Some(crate::Key::Topic("imu")));
        assert!(missing.to_string().contains("/imu/data"), "{missing}");
        let wrong = error(fixes(Some("/odom"), None));
        assert_eq!(wrong.key, Some(crate::Key::Topic("gnss")));
        assert!(wrong.to_string().contains("/gps/fix"), "{wrong}");
        let missing = error(fixes(None, Some("/velocity")));
        assert_eq!(missing.key, Some(crate::Key::VelocityTopic));
        assert!(missing.mend.contains("/gps/vel, /wheel"), "{missing}");
        assert!(error(Wanted::Poses(None)).mend.contains("Odometry"));
    }
}

#[test]
fn several_topics_have_to_be_named() {
    for name in ["rosbag/two-imus.bag", "mcap/two-imus.mcap"] {
        let error = read(name, &Wanted::Imu(None)).unwrap_err();
        assert_eq!(error.key, Some(crate::Key::Topic("imu")));
        assert!(error.problem.starts_with("more than one"), "{error}");
        assert_eq!(error.mend, "the file has: /imu/a, /imu/b");
        for (topic, count) in [("/imu/a", 6), ("/imu/b", 2)] {
            let entries = read(name, &Wanted::Imu(Some(topic.to_owned()))).unwrap();
            assert_eq!(readings(&entries).len(), count, "{name} {topic}");
        }
        let error = read(name, &fixes(None, None)).unwrap_err();
        assert!(error.to_string().contains("/imu/a (sensor_msgs/Imu)"));
    }
}

#[test]
fn streams_are_listed() {
    for name in SAME {
        let streams = streams(name);
        let short: Vec<_> = streams
            .iter()
            .map(|s| (s.name.as_str(), s.kind, s.messages))
            .collect();
        assert_eq!(
            short,
            [
                ("/chatter", StreamKind::Other, 6),
                ("/gps/fix", StreamKind::Fixes, 6),
                ("/gps/vel", StreamKind::Velocity, 5),
                ("/imu/data", StreamKind::Imu, 12),
                ("/odom", StreamKind::LocalPoses, 6),
                ("/wheel", StreamKind::Velocity, 6),
            ],
            "{name}"
        );
        let about = |k: usize| streams[k].about.as_str();
        assert_eq!(about(0), "std_msgs/String");
        assert_eq!(about(1), "sensor_msgs/NavSatFix, frame gps");
        assert!(about(3).starts_with("sensor_msgs/Imu, frame imu_link; "));
        assert_eq!(
            about(4),
            "nav_msgs/Odometry, frame odom to base_link; poses in a local frame"
        );
    }
}

fn of_bytes(name: &str, bytes: &[u8], wanted: &Wanted) -> Result<Vec<Entry>, ReadError> {
    let source = Box::new(BufReader::new(std::io::Cursor::new(bytes.to_vec())));
    entries(name, source, wanted)?.collect()
}

/// A recording that was killed: what came before is read, and that it broke off is reported once.
#[test]
fn files_cut_anywhere_are_read_up_to_there() {
    // All bytes of two, and some of the larger or slower ones.
    for (name, step) in [
        ("rosbag/lz4.bag", 1),
        ("rosbag/bz2.bag", 17),
        ("rosbag/none.bag", 17),
        ("mcap/zstd.mcap", 1),
        ("mcap/lz4.mcap", 17),
        ("mcap/big-endian.mcap", 17),
    ] {
        let bytes = std::fs::read(golden(name)).unwrap();
        let wanted = Wanted::Imu(None);
        let whole = readings(&read(name, &wanted).unwrap());
        let mut most = 0;
        for n in (0..bytes.len()).step_by(step) {
            let source = Box::new(std::io::Cursor::new(bytes[..n].to_vec()));
            let Ok(cut) = entries(name, source, &wanted) else {
                assert!(n < 13, "{name} cut at {n}");
                continue;
            };
            let cut: Vec<_> = cut.collect();
            // Without a sample the end is an error, which names no topic.
            let missing = cut.iter().filter(|entry| entry.is_err()).count();
            let cut: Vec<Entry> = cut.into_iter().filter_map(Result::ok).collect();
            let found = readings(&cut);
            assert_eq!(missing, usize::from(found.is_empty()), "{name} cut at {n}");
            // As text: a temperature that is not there is NaN.
            let [found_text, wanted] =
                [&found[..], &whole[..found.len()]].map(|r| format!("{r:?}"));
            assert_eq!(found_text, wanted, "{name} cut at {n}");
            let ends = skips(&cut);
            let ends = ends.iter().filter(|skip| skip.0 == SkipKind::EndsEarly);
            assert_eq!(ends.count(), 1, "{name} cut at {n}");
            assert!(found.len() >= most, "{name} cut at {n}");
            most = found.len();
        }
        assert_eq!(most, whole.len(), "{name}");
    }
}

/// A recorder that was killed leaves no index and says so in the header.
#[test]
fn a_bag_that_was_not_closed() {
    let mut bytes = std::fs::read(golden("rosbag/none.bag")).unwrap();
    let name = b"index_pos=";
    let at = memchr::memmem::find(&bytes, name).unwrap() + name.len();
    let index = u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap());
    bytes.truncate(usize::try_from(index).unwrap());
    bytes[at..at + 8].fill(0);
    let entries = of_bytes("rosbag/none.bag", &bytes, &Wanted::Imu(None)).unwrap();
    assert_eq!(readings(&entries).len(), 11);
    let last = skips(&entries).pop().unwrap();
    assert_eq!((last.0, last.1), (SkipKind::EndsEarly, 41));
}

/// Where chunks have checksums, nothing wrong is ever given; elsewhere there is no panic.
#[test]
fn flipped_bits() {
    for name in [
        "mcap/zstd.mcap",
        "rosbag/lz4.bag",
        "mcap/ros1.mcap",
        "mcap/big-endian.mcap",
    ] {
        let mut bytes = std::fs::read(golden(name)).unwrap();
        let imu = Wanted::Imu(Some("/imu/data".to_owned()));
        let whole = readings(&read(name, &imu).unwrap());
        for n in (0..bytes.len()).step_by(3) {
            let bit = 1 << (n % 8);
            bytes[n] ^= bit;
            let _ = of_bytes(name, &bytes, &fixes(None, None));
            let found = of_bytes(name, &bytes, &imu).unwrap_or_default();
            bytes[n] ^= bit;
            for (_, reading) in readings(&found) {
                assert!(reading.time.is_finite(), "{name} at {n}");
                let same = |(_, other): &(u64, ImuReading)| {
                    (other.gyro, other.accel) == (reading.gyro, reading.accel)
                };
                let checked = name != "mcap/big-endian.mcap" && name != "rosbag/lz4.bag";
                assert!(!checked || whole.iter().any(same), "{name} at {n}");
            }
        }
    }
}

#[test]
fn absurd_lengths_and_unknown_compressions() {
    // A chunk of MCAP that says to be of 2^60 bytes, of a known and an unknown method.
    let chunk = |method: &str, size: u64| {
        let mut body = vec![0; 16];
        body.extend(size.to_le_bytes());
        body.extend([0; 4]);
        body.extend((method.len() as u32).to_le_bytes());
        body.extend(method.as_bytes());
        body.extend(3u64.to_le_bytes());
        body.extend([1, 2, 3]);
        let mut bytes = crate::mcap_records::MAGIC.to_vec();
        bytes.push(6);
        bytes.extend((body.len() as u64).to_le_bytes());
        bytes.extend(body);
        bytes
    };
    let name = "mcap/none.mcap";
    let read = |bytes: &[u8]| {
        let source = Box::new(std::io::Cursor::new(bytes.to_vec()));
        let entries = entries(name, source, &Wanted::Imu(None)).unwrap();
        entries.collect::<Vec<_>>()
    };
    let huge = read(&chunk("zstd", 1 << 60));
    let [Ok(damaged), Ok(early), Err(_)] = &huge[..] else {
        panic!("{huge:?}")
    };
    assert_eq!(skips(std::slice::from_ref(damaged))[0].0, SkipKind::Damaged);
    assert_eq!(skips(std::slice::from_ref(early))[0].0, SkipKind::EndsEarly);
    let unknown = read(&chunk("xz", 10));
    let [Err(error)] = &unknown[..] else {
        panic!("{unknown:?}")
    };
    assert!(error.problem.contains("\"xz\""), "{error}");

    // A record of MCAP, and a header of a bag, of absurd length.
    let mut bytes = crate::mcap_records::MAGIC.to_vec();
    bytes.push(5);
    bytes.extend(u64::MAX.to_le_bytes());
    assert_eq!(read(&bytes).len(), 2);
    let bag = [b"#ROSBAG V2.0\n".as_slice(), &[0xff; 40]].concat();
    let source = Box::new(std::io::Cursor::new(bag));
    let entries = entries("rosbag/none.bag", source, &Wanted::Imu(None)).unwrap();
    assert_eq!(entries.count(), 2);
}

#[test]
fn formats_are_known_by_their_start() {
    for name in SAME.into_iter().filter(|name| !golden(name).is_dir()) {
        let bytes = std::fs::read(golden(name)).unwrap();
        assert_eq!(rosbag2::detect(&bytes), name.ends_with(".db3"));
        assert_eq!(bag::detect(&bytes), name.ends_with(".bag"));
        assert_eq!(mcap::detect(&bytes), name.ends_with(".mcap"));
    }
    let old = Box::new(std::io::Cursor::new(b"#ROSBAG V1.2\nxxxxxxx".to_vec()));
    let error = bag::streams(old).unwrap_err();
    assert!(error.problem.contains("version"), "{error}");
    let none = Box::new(std::io::Cursor::new(b"text".to_vec()));
    assert!(mcap::streams(none).is_err());
}
