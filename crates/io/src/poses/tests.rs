mod layout;

use std::io::Cursor;
use std::path::Path;

use undrift_nav::{Matrix3, Vector3, attitude};

use super::*;
use crate::Opened;
use crate::table::Column;

fn named<const N: usize>(names: [&str; N]) -> [Column; N] {
    names.map(|name| Column::Name(name.to_owned()))
}

fn time(name: &str) -> Column {
    Column::Name(name.to_owned())
}

fn try_all(text: &str, source: &PoseSource) -> Result<(Vec<LocalPose>, Skipped), ReadError> {
    let stream = Cursor::new(text.as_bytes().to_vec());
    let opened = Opened::stream(Path::new("poses.csv"), stream)?;
    let mut reader = PoseReader::new(opened, source)?;
    let poses = reader.by_ref().collect::<Result<_, _>>()?;
    Ok((poses, reader.skipped().clone()))
}

fn all(text: &str, format: PoseFormat) -> (Vec<LocalPose>, Skipped) {
    try_all(text, &format.into()).unwrap()
}

fn quaternion(names: [&str; 4], w_first: bool) -> AttitudeColumns {
    AttitudeColumns::Quaternion {
        columns: named(names),
        w_first,
    }
}

/// Turned by 90° about z: what is forward of the marker is along y of the frame.
const QUARTER: f64 = std::f64::consts::FRAC_1_SQRT_2;

#[test]
fn quaternions_angles_and_matrices_are_one_attitude() {
    let place = || Some(named(["x", "y", "z"]));
    let text = format!(
        "t,x,y,z,qx,qy,qz,qw,roll,pitch,yaw,a,b,c,d,e,f,g,h,i\n\
         1,1,2,3,0,0,{QUARTER},{QUARTER},0,0,90,0,-1,0,1,0,0,0,0,1\n"
    );
    let euler = AttitudeColumns::Euler {
        columns: named(["roll", "pitch", "yaw"]),
        scale: 1f64.to_radians(),
    };
    let matrix = AttitudeColumns::Matrix(named(["a", "b", "c", "d", "e", "f", "g", "h", "i"]));
    for columns in [
        quaternion(["qx", "qy", "qz", "qw"], false),
        quaternion(["qw", "qx", "qy", "qz"], true),
        euler,
        matrix,
    ] {
        let format = PoseFormat::new(time("t"), place(), Some(columns.clone()));
        let (poses, skipped) = all(&text, format);
        assert!(skipped.is_empty(), "{skipped}");
        assert_eq!(poses[0].position, Some(Vector3::new(1.0, 2.0, 3.0)));
        let forward = poses[0].attitude.unwrap() * Vector3::x();
        // Some roundings of numbers up to 1.
        assert!(
            (forward - Vector3::y()).amax() < 1e-15,
            "{columns:?} {forward}"
        );
        assert_eq!(poses[0].position_covariance, None);
    }
    // About all three axes, by an angle each.
    let rpy = Vector3::new(0.3, -0.5, 1.1);
    let turn = attitude::from_rpy(&rpy).to_rotation_matrix();
    let numbers = turn
        .matrix()
        .transpose()
        .iter()
        .map(f64::to_string)
        .collect::<Vec<_>>();
    let text = format!("t,a,b,c,d,e,f,g,h,i\n1,{}\n", numbers.join(","));
    let matrix = AttitudeColumns::Matrix(named(["a", "b", "c", "d", "e", "f", "g", "h", "i"]));
    let (poses, _) = all(&text, PoseFormat::new(time("t"), None, Some(matrix)));
    let found = attitude::to_rpy(&poses[0].attitude.unwrap());
    assert!((found - rpy).amax() < 1e-15, "{found}");
}

#[test]
fn units_offsets_weeks_and_uncertainties() {
    let text = "week,ms,x,y,z,yaw,sx,sa\n\
                2000,604799000,1000,2000,-500,90,10,1\n\
                2001,500,1000,2000,-500,90,20,2\n\
                2001,1500,1000,2000,-500,90,0,2\n";
    let format = PoseFormat {
        time_scale: 1e-3,
        time_offset: 0.25,
        week: Some(time("week")),
        position_scale: 1e-3,
        position_std: Some(named(["sx", "sx", "sx"])),
        attitude_std: Some(named(["sa", "sa", "sa"])),
        attitude_std_scale: 0.1,
        ..PoseFormat::new(
            time("ms"),
            Some(named(["x", "y", "z"])),
            Some(AttitudeColumns::Euler {
                columns: named(["yaw", "yaw", "yaw"]),
                scale: 0.01,
            }),
        )
    };
    let (poses, skipped) = all(text, format);
    assert_eq!((poses.len(), skipped.count(SkipKind::Uncertainty)), (2, 1));
    assert_eq!([poses[0].time, poses[1].time], [604_799.25, 604_800.75]);
    assert_eq!(poses[0].position, Some(Vector3::new(1.0, 2.0, -0.5)));
    let rpy = attitude::to_rpy(&poses[0].attitude.unwrap());
    assert!((rpy - Vector3::repeat(0.9)).amax() < 1e-15, "{rpy}");
    let variances = |covariance: Option<Matrix3>| covariance.unwrap().diagonal();
    let off = variances(poses[1].position_covariance) - Vector3::repeat(0.02 * 0.02);
    assert!(off.amax() < 1e-18);
    let off = variances(poses[1].attitude_covariance) - Vector3::repeat(0.2 * 0.2);
    assert!(off.amax() < 1e-16);
}

#[test]
fn what_is_no_pose_is_skipped_and_counted() {
    let columns = quaternion(["qw", "qx", "qy", "qz"], true);
    let format = PoseFormat::new(time("t"), Some(named(["x", "y", "z"])), Some(columns));
    let text = "t,x,y,z,qw,qx,qy,qz\n\
                1,1,1,1,1,0,0,0\n\
                2,nan,nan,nan,nan,nan,nan,nan\n\
                3,,,,,,,\n\
                4,1,1,1,0.979,0,0,0\n\
                5,1,1,1,1.021,0,0,0\n\
                6,1,1,1,0,0.985,0,0\n\
                7,0,0,0,0,0,0,0\n\
                8,1,0,0,0,0,0,0\n\
                9,0,0,0,1,0,0,0\n\
                9,0,0,0,1,0,0,0\n\
                inf,0,0,0,1,0,0,0\n";
    let (poses, skipped) = all(text, format.clone());
    let times: Vec<f64> = poses.iter().map(|pose| pose.time).collect();
    assert_eq!(times, [1.0, 6.0, 8.0, 9.0]);
    let kinds: Vec<(SkipKind, u64, u64)> = skipped
        .iter()
        .map(|(kind, entry)| (kind, entry.count, entry.first_line))
        .collect();
    let expected = [
        (SkipKind::MissingField, 1, 4),
        (SkipKind::NotFinite, 2, 3),
        (SkipKind::DuplicateTime, 1, 11),
        // Two lengths, a marker that was lost, a position alone.
        (SkipKind::OutOfRange, 4, 5),
    ];
    assert_eq!(kinds, expected);
    let detail = &skipped.entry(SkipKind::OutOfRange).unwrap().first_detail;
    assert_eq!(detail, "quaternion w 0.979, x 0, y 0, z 0 of norm 0.979");
    let unit = poses[1].attitude.unwrap();
    assert_eq!((unit.w, unit.i), (0.0, 1.0));
    assert_eq!(
        (poses[2].position, poses[2].attitude),
        (Some(Vector3::x()), None)
    );
    // Without a quaternion, the origin is a place as any other.
    let place_alone = PoseFormat {
        attitude: None,
        ..format
    };
    let (poses, skipped) = all(text, place_alone);
    assert_eq!((poses.len(), skipped.count(SkipKind::OutOfRange)), (7, 0));
    let matrix = |text: &str| {
        let columns = named(["a", "b", "c", "d", "e", "f", "g", "h", "i"]);
        let format = PoseFormat::new(time("t"), None, Some(AttitudeColumns::Matrix(columns)));
        let text = format!("t,a,b,c,d,e,f,g,h,i\n1,{text}\n2,1,0,0,0,1,0,0,0,1\n");
        let (poses, skipped) = all(&text, format);
        assert_eq!(poses.len() as u64 + skipped.count(SkipKind::OutOfRange), 2);
        skipped
            .entry(SkipKind::OutOfRange)
            .map(|entry| entry.first_detail.clone())
    };
    assert_eq!(
        matrix("1,0,0,0,1,0,0,0,-1").unwrap(),
        "a left-handed matrix"
    );
    assert!(
        matrix("1,0,0,0,1,0,0,0,1.03")
            .unwrap()
            .contains("off by 0.061")
    );
    assert_eq!(matrix("1,0.01,0,0,1,0,0,0,1.01"), None);
}

#[test]
fn options_that_cannot_be_meant_are_refused() {
    let text = "t,x,y,z\n1,1,1,1\n";
    let format = || PoseFormat::new(time("t"), Some(named(["x", "y", "z"])), None);
    let neither = PoseFormat {
        position: None,
        ..format()
    };
    let no_scale = PoseFormat {
        position_scale: 0.0,
        ..format()
    };
    let missing = PoseFormat::new(time("t"), Some(named(["x", "y", "w"])), None);
    for (source, message) in [
        (
            neither.into(),
            "poses.csv: neither position nor attitude requested (key poses)",
        ),
        (
            no_scale.into(),
            "poses.csv: invalid scale: 0 (key poses.position)",
        ),
        (
            missing.into(),
            "poses.csv line 1: no column \"w\" (key poses.position); the file has: t, x, y, z",
        ),
        (
            PoseSource::from(PoseLog::new(Format::Nmea)),
            "poses.csv: NMEA 0183 has no poses in a local frame (key poses.file)",
        ),
    ] {
        assert_eq!(try_all(text, &source).unwrap_err().to_string(), message);
    }
}

#[test]
fn poses_in_memory_with_their_offset() {
    let pose = |time: f64, position, attitude| LocalPose {
        time,
        position,
        attitude,
        position_covariance: Some(Matrix3::identity()),
        attitude_covariance: None,
    };
    let turned = attitude::from_rpy(&Vector3::new(0.1, 0.2, 0.3));
    let held = [
        pose(1.0, Some(Vector3::zeros()), None),
        pose(2.0, None, Some(turned)),
        pose(3.0, None, None),
        pose(4.0, Some(Vector3::repeat(f64::NAN)), None),
        pose(5.0, Some(Vector3::x()), Some(turned)),
        pose(6.0, Some(Vector3::x()), Some(turned)),
    ];
    let opened = Opened::memory(
        Path::new("poses"),
        Memory::Poses(held.into()),
        &crate::source::BytesRead::default(),
    );
    let mut source = PoseSource::Poses {
        time_offset: 0.0,
        span: Some((0.0, 15.5)),
    };
    *source.time_offset() = 10.0;
    let mut reader = PoseReader::new(opened.unwrap(), &source).unwrap();
    let poses: Vec<LocalPose> = reader.by_ref().map(Result::unwrap).collect();
    let times: Vec<f64> = poses.iter().map(|pose| pose.time).collect();
    assert_eq!(times, [11.0, 12.0, 15.0]);
    assert_eq!(
        poses[2],
        LocalPose {
            time: 15.0,
            ..held[4]
        }
    );
    let skipped = reader.skipped();
    let counts = [SkipKind::OutOfRange, SkipKind::NotFinite].map(|kind| skipped.count(kind));
    assert_eq!(counts, [1, 1]);
}
