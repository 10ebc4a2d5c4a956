use std::path::{Path, PathBuf};

use undrift_nav::Vector3;
use undrift_nav::sample::Position;

use crate::Opened;
use crate::entry::StreamKind;
use crate::format::Format;
use crate::gnss::{GnssLog, GnssReader};
use crate::imu::{ImuFormat, ImuReader};

/// 8 July 2025 19:34:00 UTC in its GPS week \[s\]; the script gives it in Unix time.
const START: f64 = 243_258.0;

fn golden() -> PathBuf {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../../testdata/golden/formats");
    Path::new(root).join("sensor-logger/drive")
}

/// A folder with these files of the golden one.
fn folder(name: &str, files: &[&str]) -> PathBuf {
    let path = std::env::temp_dir().join(format!("undrift-io-{}-{name}", std::process::id()));
    std::fs::create_dir_all(&path).unwrap();
    for file in files {
        std::fs::copy(golden().join(file), path.join(file)).unwrap();
    }
    path
}

#[test]
fn a_folder_is_one_log() {
    assert_eq!(
        Opened::open(&golden()).unwrap().format(),
        Format::SensorLogger
    );
    let streams = Opened::open(&golden())
        .unwrap()
        .streams(Format::SensorLogger)
        .unwrap();
    let listed: Vec<_> = streams
        .iter()
        .map(|s| (s.name.as_str(), s.kind, s.messages))
        .collect();
    let expected = [
        ("Gyroscope", StreamKind::Imu, 300),
        ("TotalAcceleration", StreamKind::Other, 280),
        ("Location", StreamKind::Fixes, 3),
    ];
    assert_eq!(listed, expected);
    let imu = ImuFormat::log(Format::SensorLogger, None);
    let mut reader = ImuReader::open(&golden(), &imu).unwrap();
    let samples: Vec<_> = reader.by_ref().map(Result::unwrap).collect();
    // The first rate has no force before it; the last force is at 3 ms + 279 · 10.526316 ms = 2.939842 s.
    assert_eq!(samples.len(), 293);
    for (sample, k) in samples.iter().zip(1..) {
        let s = 0.01 * f64::from(k);
        assert!((sample.time - START - s).abs() < 1e-9);
        let gyro = Vector3::new(0.001 * f64::from(k), -0.125, 0.25);
        assert!((sample.dtheta / sample.dt - gyro).amax() < 1e-9);
        let force = Vector3::new(0.25 * s, 0.125 * s, 9.75 - 0.03125 * s);
        assert!(
            (sample.dvel / sample.dt - force).amax() < 1e-7,
            "{sample:?}"
        );
    }
    let fixes = GnssReader::open(&golden(), &GnssLog::new(Format::SensorLogger).into()).unwrap();
    let fixes: Vec<_> = fixes.map(Result::unwrap).collect();
    assert_eq!(fixes.len(), 3);
    let Some((Position::Geodetic(place), _)) = fixes[1].position else {
        panic!("{fixes:?}");
    };
    assert_eq!((fixes[1].time, place.height), (START + 1.0, 30.5));
    assert!((fixes[1].velocity.unwrap().0 - Vector3::new(0.0, 12.5, 0.0)).amax() < 1e-12);
    // Where the speed is not known it is −1.
    assert!(fixes[2].velocity.is_none());
}

#[test]
fn forces_without_gravity_and_folders_of_something_else_are_refused() {
    let imu = ImuFormat::log(Format::SensorLogger, None);
    let refused = |path: &Path| {
        let error = ImuReader::open(path, &imu).and_then(|mut reader| reader.next().unwrap());
        error.err().unwrap().to_string()
    };
    let linear = folder("linear", &["Gyroscope.csv", "Accelerometer.csv"]);
    assert!(
        refused(&linear).contains("without gravity"),
        "{}",
        refused(&linear)
    );
    let gyro = folder("gyro", &["Gyroscope.csv"]);
    assert!(refused(&gyro).contains("no accelerometers"));
    let nothing = folder("nothing", &[]);
    assert!(refused(&nothing).contains("is a folder"));
    // A file that breaks off, and one of arbitrary bytes.
    let damaged = folder("damaged", &["Gyroscope.csv", "TotalAcceleration.csv"]);
    let whole = std::fs::read(golden().join("Gyroscope.csv")).unwrap();
    for k in (0..whole.len()).step_by(501) {
        let mut bytes = whole[..k].to_vec();
        bytes.extend([0xff, b'\n', b',', 0, b'"']);
        std::fs::write(damaged.join("Gyroscope.csv"), bytes).unwrap();
        let count = ImuReader::open(&damaged, &imu).map(|reader| reader.flatten().count());
        assert!(count.is_ok_and(|count| count <= 300));
    }
    for path in [linear, gyro, nothing, damaged] {
        std::fs::remove_dir_all(path).unwrap();
    }
}

#[test]
fn accelerations_and_gravity_are_summed() {
    let path = folder("sum", &["Gyroscope.csv"]);
    let total = std::fs::read_to_string(golden().join("TotalAcceleration.csv")).unwrap();
    let mut lines = total.lines();
    let header = lines.next().unwrap();
    let [mut linear, mut gravity] = [0, 1].map(|_| format!("{header}\n"));
    let names: Vec<&str> = header.split(',').collect();
    let z = names.iter().position(|name| *name == "z").unwrap();
    for line in lines {
        let fields: Vec<&str> = line.split(',').collect();
        let row = |force: &dyn Fn(usize) -> String| {
            let of = |(k, field): (usize, &&str)| match names[k] {
                "x" | "y" | "z" => force(k),
                _ => (*field).to_owned(),
            };
            fields
                .iter()
                .enumerate()
                .map(of)
                .collect::<Vec<_>>()
                .join(",")
                + "\n"
        };
        linear += &row(&|k| {
            let value: f64 = fields[k].parse().unwrap();
            (value - if k == z { 9.75 } else { 0.0 }).to_string()
        });
        gravity += &row(&|k| if k == z { "9.75" } else { "0" }.to_owned());
    }
    std::fs::write(path.join("Accelerometer.csv"), linear).unwrap();
    let imu = ImuFormat::log(Format::SensorLogger, None);
    let alone = ImuReader::open(&path, &imu).unwrap().find_map(Result::err);
    assert!(alone.unwrap().to_string().contains("without gravity"));
    std::fs::write(path.join("Gravity.csv"), gravity).unwrap();
    let read = |path: &Path| -> Vec<_> {
        let reader = ImuReader::open(path, &imu).unwrap();
        reader.map(Result::unwrap).collect()
    };
    let (summed, whole) = (read(&path), read(&golden()));
    assert_eq!(summed.len(), whole.len());
    for (a, b) in summed.iter().zip(&whole) {
        assert!(
            a.time == b.time && (a.dvel - b.dvel).amax() < 1e-9,
            "{a:?} {b:?}"
        );
    }
    std::fs::remove_dir_all(path).unwrap();
}

/// The values of the folder as the app exports and sends them, in the order of their sensors.
#[test]
fn objects_of_json_are_the_same_log() {
    let mut exported = vec![serde_json::json!({"sensor": "Metadata", "platform": "android"})];
    let mut sent = Vec::new();
    for name in ["Location", "TotalAcceleration", "Gyroscope"] {
        let text = std::fs::read_to_string(golden().join(format!("{name}.csv"))).unwrap();
        let mut lines = text.lines().map(|line| line.split(','));
        let names: Vec<&str> = lines.next().unwrap().collect();
        for row in lines {
            let members = names.iter().map(|name| (*name).to_owned());
            let values = row.map(|text| text.to_owned().into());
            let mut object: serde_json::Map<_, serde_json::Value> = members.zip(values).collect();
            let time: i64 = object["time"].as_str().unwrap().parse().unwrap();
            sent.push(serde_json::json!({
                "name": name.to_lowercase(), "time": time, "values": object.clone()
            }));
            object.insert("sensor".to_owned(), name.into());
            exported.push(object.into());
        }
    }
    let imu = ImuFormat::log(Format::SensorLogger, None);
    let mut gnss = GnssLog::new(Format::SensorLogger);
    gnss.fixes.velocity_std = Some([1.0; 3]);
    let (samples, fixes) = {
        let samples = ImuReader::open(&golden(), &imu).unwrap();
        let fixes = GnssReader::open(&golden(), &gnss.clone().into()).unwrap();
        (
            samples.map(Result::unwrap).collect::<Vec<_>>(),
            fixes.map(Result::unwrap).collect::<Vec<_>>(),
        )
    };
    for objects in [exported, sent] {
        for text in [
            serde_json::to_string(&objects).unwrap(),
            serde_json::to_string_pretty(&objects).unwrap(),
        ] {
            let opened = || {
                let stream = std::io::Cursor::new(text.clone().into_bytes());
                Opened::stream(Path::new("phone.json"), stream).unwrap()
            };
            assert_eq!(opened().format(), Format::SensorLogger);
            let read = ImuReader::new(opened(), &imu).unwrap();
            assert!(read.map(Result::unwrap).eq(samples.iter().copied()));
            let read = GnssReader::new(opened(), &gnss.clone().into()).unwrap();
            assert!(read.map(Result::unwrap).eq(fixes.iter().copied()));
        }
    }
}

#[test]
fn magnetic_fields_have_a_file_of_their_own() {
    use crate::magnetic::{MagneticFormat, MagneticReader, MagneticSource};
    let path = folder(
        "field",
        &["Gyroscope.csv", "TotalAcceleration.csv", "Location.csv"],
    );
    let rows = "time,seconds_elapsed,z,y,x\n1700000000100000000,0.1,-40,3,20\n1700000000200000000,0.2,-40,3,21\n";
    std::fs::write(path.join("Magnetometer.csv"), rows).unwrap();
    let source = MagneticSource::Log(Format::SensorLogger, None);
    let mut reader = MagneticReader::open(&path, &MagneticFormat::new(source, 1e-6)).unwrap();
    let fields: Vec<_> = reader.by_ref().map(Result::unwrap).collect();
    assert_eq!(fields.len(), 2);
    assert!((fields[0].field - Vector3::new(20e-6, 3e-6, -40e-6)).norm() < 1e-12);
    // The samples are as without it.
    let imu = ImuFormat::log(Format::SensorLogger, None);
    let samples = ImuReader::open(&path, &imu).unwrap();
    assert_eq!(samples.map(Result::unwrap).count(), 293);
    std::fs::remove_dir_all(&path).unwrap();
}
