//! Poses of recordings that rosbags wrote: testdata/golden/formats/rosbag/poses.py.

use std::io::Cursor;

use super::*;
use crate::Opened;
use crate::entry::LocalPose;
use crate::format::Format;
use crate::poses::{PoseLog, PoseReader, PoseSource};
use crate::skipped::Skipped;

const POSES: [&str; 2] = ["rosbag/poses.bag", "mcap/poses.mcap"];
const TOPICS: [&str; 4] = ["/amcl", "/odom", "/slam", "/vicon"];

fn wanted(topic: &str) -> Wanted {
    Wanted::LocalPoses(Some(topic.to_owned()))
}

fn found(entries: &[Entry]) -> Vec<(u64, LocalPose)> {
    let pose = |entry: &Entry| match entry.what {
        What::LocalPose(pose) => Some((entry.at, pose)),
        _ => None,
    };
    entries.iter().filter_map(pose).collect()
}

fn expected(topic: &str) -> Vec<Value> {
    let text = std::fs::read_to_string(golden("rosbag/poses.json")).unwrap();
    let all: Value = serde_json::from_str(&text).unwrap();
    all[topic].as_array().unwrap().clone()
}

#[test]
fn poses_are_those_of_the_recording() {
    for name in POSES {
        for topic in TOPICS {
            let entries = read(name, &wanted(topic)).unwrap();
            let found = found(&entries);
            let expected = expected(topic);
            assert_eq!(found.len(), expected.len(), "{name} {topic}");
            for ((at, pose), expected) in found.iter().zip(&expected) {
                assert_eq!(*at, expected["at"].as_u64().unwrap(), "{name} {topic}");
                let time = expected["time"].as_f64().unwrap();
                assert!((pose.time - time).abs() < TIME, "{name} {topic}: {time}");
                let position = Vector3::from_row_slice(&numbers(&expected["position"]));
                assert_eq!(pose.position, Some(position), "{name} {topic}");
                let attitude = pose.attitude.map(|q| [q.i, q.j, q.k, q.w]);
                let turned =
                    (!expected["attitude"].is_null()).then(|| numbers(&expected["attitude"]));
                assert_eq!(
                    attitude.is_some(),
                    turned.is_some(),
                    "{name} {topic} {time}"
                );
                for (found, expected) in attitude.iter().flatten().zip(turned.iter().flatten()) {
                    // The root of the sum of squares is 1 but for its roundings.
                    assert!((found - expected).abs() < 4e-16, "{name} {topic}");
                }
                let of = |key: &str| {
                    let covariance = &expected[key];
                    (!covariance.is_null()).then(|| Matrix3::from_row_slice(&numbers(covariance)))
                };
                assert_eq!(
                    pose.position_covariance,
                    of("position_covariance"),
                    "{name} {topic}"
                );
                assert_eq!(
                    pose.attitude_covariance,
                    of("attitude_covariance"),
                    "{name} {topic}"
                );
            }
        }
    }
}

#[test]
fn what_is_no_pose_is_counted() {
    for name in POSES {
        let skipped = |topic: &str| {
            let entries = read(name, &wanted(topic)).unwrap();
            let skips = skips(&entries).into_iter();
            skips
                .map(|(kind, at, detail)| (kind, at, detail.to_owned()))
                .collect::<Vec<_>>()
        };
        let [slam, vicon] = ["/slam", "/vicon"].map(skipped);
        assert_eq!(slam.len(), 2, "{slam:?}");
        assert_eq!((slam[0].0, slam[0].1), (SkipKind::OutOfRange, 8));
        assert!(slam[0].2.ends_with("of norm 0.500"), "{slam:?}");
        assert_eq!((slam[1].0, slam[1].1), (SkipKind::NotFinite, 28));
        assert_eq!(
            vicon,
            [(
                SkipKind::OutOfRange,
                16,
                "a pose of wand, not of box".to_owned()
            )]
        );
        assert!(skipped("/amcl").is_empty() && skipped("/odom").is_empty());
    }
}

fn read_by(name: &str, topic: &str) -> (Vec<LocalPose>, Skipped) {
    let format = if name.ends_with(".bag") {
        Format::RosBag
    } else {
        Format::Mcap
    };
    let source = PoseSource::from(PoseLog {
        stream: Some(topic.to_owned()),
        time_offset: 100.0,
        ..PoseLog::new(format)
    });
    let mut reader = PoseReader::open(&golden(name), &source).unwrap();
    let poses = reader.by_ref().map(Result::unwrap).collect();
    (poses, reader.skipped().clone())
}

#[test]
fn the_reader_leaves_out_a_marker_that_was_lost_and_keeps_a_place_alone() {
    for name in POSES {
        let (poses, skipped) = read_by(name, "/vicon");
        // Six, but for that of another body and the lost one.
        assert_eq!((poses.len(), skipped.total()), (4, 2), "{skipped}");
        let time = expected("/vicon")[0]["time"].as_f64().unwrap() + 100.0;
        assert!((poses[0].time - time).abs() < TIME);
        let (poses, skipped) = read_by(name, "/slam");
        assert_eq!(poses.len(), 4);
        assert!(poses[1].attitude.is_none() && poses[1].position.is_some());
        // Its quaternion, and those of the two rows that cannot be used.
        assert_eq!(
            (skipped.count(SkipKind::OutOfRange), skipped.total()),
            (2, 3)
        );
    }
}

/// The topics of poses have to be named where there are several; they say of what frames they are.
#[test]
fn topics_of_poses() {
    for name in POSES {
        let error = read(name, &Wanted::LocalPoses(None)).unwrap_err();
        assert_eq!(error.key, Some(crate::Key::Topic("poses")));
        assert_eq!(error.mend, "the file has: /amcl, /odom, /slam, /vicon");
        let error = read(name, &wanted("/imu/data")).unwrap_err().to_string();
        assert!(
            error.contains("Odometry") && error.contains("/imu/data"),
            "{error}"
        );
        let streams = streams(name);
        let poses = streams
            .iter()
            .filter(|stream| stream.kind == StreamKind::LocalPoses);
        let about: Vec<&str> = poses.map(|stream| stream.about.as_str()).collect();
        let expected = [
            "geometry_msgs/PoseWithCovarianceStamped, frame map; poses in a local frame",
            "nav_msgs/Odometry, frame odom to base_link; poses in a local frame",
            "geometry_msgs/PoseStamped, frame map; poses in a local frame",
            "geometry_msgs/TransformStamped, frame world to box; poses in a local frame",
        ];
        assert_eq!(about, expected, "{name}");
    }
    // The only one.
    let entries = read("rosbag/none.bag", &Wanted::LocalPoses(None)).unwrap();
    assert_eq!(found(&entries).len(), 6);
}

/// The first message is of a clock a week behind.
#[test]
fn poses_of_another_computer_do_not_choose_the_week_of_the_samples() {
    for name in POSES {
        let entries = read(name, &Wanted::Imu(None)).unwrap();
        let first = readings(&entries)[0].1.time;
        assert!((first - (604_800.0 - 0.5)).abs() < TIME, "{name} {first}");
    }
}

#[test]
fn damaged_poses_are_no_panic() {
    for name in POSES {
        let mut bytes = std::fs::read(golden(name)).unwrap();
        for topic in TOPICS {
            let whole = found(&read(name, &wanted(topic)).unwrap()).len();
            let mut most = 0;
            for n in (0..bytes.len()).step_by(37) {
                let cut = Box::new(Cursor::new(bytes[..n].to_vec()));
                let Ok(cut) = entries(name, cut, &wanted(topic)) else {
                    continue;
                };
                let cut: Vec<Entry> = cut.filter_map(Result::ok).collect();
                most = most.max(found(&cut).len());
            }
            assert_eq!(most, whole, "{name} {topic}");
        }
        for n in (0..bytes.len()).step_by(5) {
            let bit = 1 << (n % 8);
            bytes[n] ^= bit;
            let opened = Opened::stream("x".as_ref(), Cursor::new(bytes.clone()));
            bytes[n] ^= bit;
            let format = match name.ends_with(".bag") {
                true => Format::RosBag,
                false => Format::Mcap,
            };
            let source = PoseSource::from(PoseLog {
                stream: Some("/odom".to_owned()),
                ..PoseLog::new(format)
            });
            let Ok(reader) = opened.and_then(|opened| PoseReader::new(opened, &source)) else {
                continue;
            };
            for pose in reader.flatten() {
                assert!(pose.is_finite(), "{name} at {n}: {pose:?}");
            }
        }
    }
}

/// By testdata/golden/formats/rosbag/transforms.py.
#[test]
fn pairs_of_frames_are_streams() {
    let pair = "/tf: odom -> base_link";
    for name in ["rosbag/transforms.bag", "mcap/transforms.mcap"] {
        let streams = Opened::open(&golden(name)).unwrap();
        let format = streams.format();
        let streams = streams.streams(format).unwrap();
        let poses = streams
            .iter()
            .filter(|stream| stream.kind == StreamKind::LocalPoses);
        let listed: Vec<_> = poses.map(|s| (s.name.as_str(), s.messages)).collect();
        let expected = [
            ("/tf: map -> odom", 6),
            (pair, 6),
            ("/tf_static: base_link -> imu_link", 1),
        ];
        assert_eq!(listed, expected, "{name}");
        let found = found(&read(name, &wanted(pair)).unwrap());
        assert_eq!(found.len(), 6, "{name}");
        for ((at, pose), k) in found.iter().zip(0..) {
            let k = f64::from(k);
            let place = Vector3::new(k + 0.5, -0.25 * k, 1.0);
            assert_eq!((*at, pose.position), (k as u64 + 2, Some(place)), "{name}");
            // Half a second before the end of a week.
            assert!((pose.time - (604_799.5 + 0.1 * k)).abs() < TIME, "{name}");
            let q = pose.attitude.unwrap();
            assert!((q.j - 0.6).abs() < 4e-16 && (q.w - 0.8).abs() < 4e-16);
        }
        let error = read(name, &Wanted::LocalPoses(None)).unwrap_err();
        assert!(error.to_string().contains(pair), "{error}");
    }
}

/// A recording whose positions are in mm and whose quaternions have w first.
#[test]
fn other_units_and_orders_can_be_stated() {
    let name = "rosbag/transforms.bag";
    let log = PoseLog {
        stream: Some("/tf: odom -> base_link".to_owned()),
        ..PoseLog::new(Format::RosBag)
    };
    let read = |log: PoseLog| {
        let mut reader = PoseReader::open(&golden(name), &log.into()).unwrap();
        reader.next().unwrap().unwrap()
    };
    let (plain, stated) = (
        read(log.clone()),
        read(PoseLog {
            position_scale: 1e-3,
            w_first: true,
            ..log
        }),
    );
    let place = plain.position.unwrap() * 1e-3;
    assert!((stated.position.unwrap() - place).norm() < 1e-15);
    let (q, other) = (plain.attitude.unwrap(), stated.attitude.unwrap());
    assert_eq!([other.w, other.i, other.j, other.k], [q.i, q.j, q.k, q.w]);
}
