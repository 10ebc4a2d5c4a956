//! `undrift inspect`: from files to a drive file that runs.

mod strangers;

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Output},
};

fn undrift(arguments: &[&str], here: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_undrift"))
        .args(arguments)
        .current_dir(here)
        .output()
        .unwrap()
}

fn folder(name: &str) -> PathBuf {
    let dir = std::env::temp_dir().join(format!("undrift-inspect-{name}-{}", std::process::id()));
    let _ = fs::remove_dir_all(&dir);
    fs::create_dir_all(&dir).unwrap();
    dir
}

fn text(output: &Output) -> String {
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    String::from_utf8(output.stdout.clone()).unwrap()
}

/// A car that is at rest for 20 s and then drives north, 2 m/s² for 10 s: an inertial log of six columns and
/// fixes, in a layout given by a function of time, specific force forward, and distance.
fn drive(dir: &Path, imu_head: &str, imu_row: impl Fn(f64, f64) -> String) {
    let mut imu = imu_head.to_owned();
    let mut gnss = "time,latitude,longitude,altitude\n".to_owned();
    for k in 0..6000 {
        let t = f64::from(k) * 0.01;
        let force = if (20.0..30.0).contains(&t) { 2.0 } else { 0.0 };
        imu += &imu_row(t, force);
        let driven = (t - 20.0).clamp(0.0, 10.0);
        let distance = driven * driven + 20.0 * (t - 30.0).max(0.0);
        if k % 20 == 0 {
            gnss += &format!("{t:.2},{:.9},11.5,500\n", 48.1 + distance / 111_195.0);
        }
    }
    fs::write(dir.join("imu.csv"), imu).unwrap();
    fs::write(dir.join("gnss.csv"), gnss).unwrap();
}

/// Inspects both files, checks what the drive file says, and navigates with it.
fn inspect_and_navigate(name: &str, head: &str, row: impl Fn(f64, f64) -> String, says: &[&str]) {
    let dir = folder(name);
    drive(&dir, head, row);
    let found = undrift(
        &["inspect", "imu.csv", "gnss.csv", "-o", "drive.toml"],
        &dir,
    );
    let report = text(&found);
    assert!(report.contains("[imu] 6000 records at 100 Hz"), "{report}");
    assert!(report.contains("[gnss] 300 records at 5 Hz"), "{report}");
    let file = fs::read_to_string(dir.join("drive.toml")).unwrap();
    for expected in says {
        assert!(file.contains(expected), "{expected} is not in\n{file}");
    }
    let run = undrift(&["navigate", "drive.toml", "-o", "nav.csv"], &dir);
    assert!(text(&run).contains("navigated"), "{}", text(&run));
    assert!(dir.join("nav.csv").is_file());
    fs::remove_dir_all(&dir).unwrap();
}

/// An error that alternates, so that it has no mean: as scattered as a MEMS gyro.
fn noise(t: f64, size: f64) -> f64 {
    if (t * 100.0).round() as i64 % 2 == 0 {
        size
    } else {
        -size
    }
}

#[test]
fn named_columns_in_degrees_and_g() {
    inspect_and_navigate(
        "named",
        "time,gyro_x,gyro_y,gyro_z,acc_x,acc_y,acc_z\n",
        |t, force| {
            let n = noise(t, 0.05);
            format!("{t:.2},{n},{n},{n},{},0.001,-1.0\n", force / 9.80665)
        },
        &[
            "gyro_unit = \"deg/s\" # guessed",
            "accel_unit = \"g\" # guessed",
            // The side force of 1 mg is a tilt.
            "mounting = \"-0.1, -0.1, 0.0 deg\"",
            "position_std = \"3, 3, 6 m\" # guessed",
        ],
    );
}

#[test]
fn numbers_without_names_in_milliseconds() {
    inspect_and_navigate(
        "numbers",
        "",
        |t, force| {
            let n = noise(t, 0.0005);
            format!("{:.0} {force} 0.01 9.8 {n} {n} {n}\n", 1000.0 * t)
        },
        &[
            "time_unit = \"ms\"",
            "accel = [2, 3, 4]",
            "gyro = [5, 6, 7]",
            "gyro_unit = \"rad/s\" # guessed",
            "mounting = \"-179.9, -0.1, 0.0 deg\"",
        ],
    );
}

#[test]
fn kf_gins_increments() {
    inspect_and_navigate(
        "kf-gins",
        "",
        |t, force| {
            let n = noise(t, 1e-5);
            format!(
                "{t:.3}  {n:.9}  {n:.9}  {n:.9}  {:.9}  0.000001  -0.0980665\n",
                0.01 * force
            )
        },
        &["file = \"imu.csv\" # KF-GINS text"],
    );
}

/// The row of a log with names in degrees and g.
fn row(t: f64, force: f64) -> String {
    let n = noise(t, 0.05);
    format!("{t:.2},{n},{n},{n},{},0.001,-1.0\n", force / 9.80665)
}

const NAMED: &str = "time,gyro_x,gyro_y,gyro_z,acc_x,acc_y,acc_z\n";

#[test]
fn logs_stand_for_a_drive_file() {
    let dir = folder("logs");
    drive(&dir, NAMED, row);
    let logs = ["imu.csv", "gnss.csv"];
    let run = |verb: &str, more: &[&str]| undrift(&[&[verb], &logs[..], more].concat(), &dir);
    let kept = run("navigate", &["--save-drive", "kept.toml"]);
    let said = String::from_utf8_lossy(&kept.stderr).into_owned();
    for guess in [
        "drive of imu.csv and gnss.csv",
        "imu.gyro_unit = \"deg/s\": guessed",
    ] {
        assert!(said.contains(guess), "{said}");
    }
    let by_file = undrift(&["navigate", "kept.toml"], &dir);
    assert_eq!(
        text(&kept).replace("kept.toml", ""),
        text(&by_file).replace("kept.toml", "")
    );
    text(&undrift(
        &["inspect", "imu.csv", "gnss.csv", "-o", "drive.toml"],
        &dir,
    ));
    let [made, kept] = ["drive.toml", "kept.toml"].map(|file| fs::read(dir.join(file)).unwrap());
    assert_eq!(made, kept);
    // The model that is given is kept, too, as a preset or as a file seen from the drive file.
    fs::create_dir_all(dir.join("sub")).unwrap();
    let preset = undrift(
        &["model", "adis16465", "--to", "undrift", "-o", "mine.toml"],
        &dir,
    );
    assert!(preset.status.success());
    for (model, line) in [
        ("adis16465", "\nmodel = \"adis16465\"\n"),
        ("mine.toml", "mine.toml\"\n"),
    ] {
        text(&run(
            "navigate",
            &["--model", model, "--save-drive", "sub/given.toml"],
        ));
        let given = fs::read_to_string(dir.join("sub/given.toml")).unwrap();
        assert!(
            given.contains(line) && !given.contains("guessed: nothing"),
            "{given}"
        );
        text(&undrift(&["navigate", "sub/given.toml"], &dir));
    }
    let cut = text(&run("outages", &["--length", "2"]));
    assert!(cut.contains("outages of 2 s"), "{cut}");
    for (arguments, code, says) in [
        (&["navigate", "imu.csv"][..], 1, "no positions in imu.csv"),
        (
            &["navigate", "kept.toml", "gnss.csv"],
            2,
            "specify kept.toml alone",
        ),
        (
            &["navigate", "imu.csv", "gnss.csv", "--data", "."],
            2,
            "--data needs a drive file",
        ),
        (
            &["navigate", "kept.toml", "--save-drive", "x.toml"],
            2,
            "needs logs",
        ),
        (&["tune", "imu.csv", "imu.csv"], 1, "no positions"),
    ] {
        let output = undrift(arguments, &dir);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(code), "{said}");
        assert!(said.contains(says), "{said}");
    }
    fs::remove_dir_all(&dir).unwrap();
}

#[test]
fn lines_of_a_serial_monitor() {
    let clock = |t: f64| format!("12:{:02}:{:06.3}", (t / 60.0) as u32, t % 60.0);
    let dir = folder("serial");
    drive(&dir, "12:00:00.000 -> gx,gy,gz,ax,ay,az\n", |t, force| {
        let row = row(t, force);
        let (_, values) = row.split_once(',').unwrap();
        format!("{} -> {values}", clock(t))
    });
    let report = text(&undrift(&["inspect", "imu.csv"], &dir));
    for line in [
        "6000 records at 100 Hz",
        "\"received\"",
        "[\"gx\", \"gy\", \"gz\"]",
    ] {
        assert!(report.contains(line), "{report}");
    }
    drive(&dir, "", |t, force| {
        let row = row(t, force);
        let names = ["t", "gx", "gy", "gz", "ax", "ay", "az"];
        let labelled = names.iter().zip(row.trim_end().split(','));
        labelled
            .map(|(name, value)| format!("{name}: {value} "))
            .collect::<String>()
            + "\n"
    });
    let run = undrift(&["navigate", "imu.csv", "gnss.csv"], &dir);
    assert!(text(&run).contains("navigated"));
    fs::remove_dir_all(&dir).unwrap();
}

#[test]
fn receivers_that_count_and_speeds_with_a_course() {
    let dir = folder("counts");
    drive(&dir, NAMED, row);
    let fixes = fs::read_to_string(dir.join("gnss.csv")).unwrap();
    let rewritten = |header: &str, row: &dyn Fn(f64, f64, f64) -> String| {
        let mut rows = header.to_owned();
        let mut last = 48.1;
        for line in fixes.lines().skip(1) {
            let numbers: Vec<f64> = line
                .split(',')
                .map(|field| field.parse().unwrap())
                .collect();
            let speed = (numbers[1] - last) * 111_195.0 / 0.2;
            last = numbers[1];
            rows += &row(numbers[0], numbers[1], speed);
        }
        fs::write(dir.join("gnss.csv"), rows).unwrap();
        let run = undrift(
            &[
                "navigate",
                "imu.csv",
                "gnss.csv",
                "--save-drive",
                "kept.toml",
            ],
            &dir,
        );
        assert!(text(&run).contains("navigated"));
        fs::read_to_string(dir.join("kept.toml")).unwrap()
    };
    let counts = rewritten(
        "time,lat,lon,hMSL,hAcc,vAcc,gSpeed,headMot\n",
        &|t, lat, speed| {
            format!(
                "{t:.2},{:.0},115000000,500000,1500,2500,{:.0},0\n",
                1e7 * lat,
                1e3 * speed
            )
        },
    );
    let metric = rewritten("time,lat,lon,alt,speed,course\n", &|t, lat, speed| {
        format!("{t:.2},{lat:.9},11.5,500,{:.3},0\n", 3.6 * speed)
    });
    for (file, lines) in [
        (
            &counts,
            &[
                "position_unit = \"LSB/1e7 deg\"",
                "height_unit = \"mm\"",
                "position_std_columns = [\"hAcc\", \"hAcc\", \"vAcc\"]",
                "position_std_factor = 0.001",
                "course = \"headMot\"",
                "velocity_unit = \"mm/s\"",
            ][..],
        ),
        (&metric, &["speed = \"speed\"", "velocity_unit = \"km/h\""]),
    ] {
        for line in lines {
            assert!(file.contains(line), "{line}: {file}");
        }
    }
    fs::remove_dir_all(&dir).unwrap();
}

#[test]
fn hostile_names_stay_text() {
    let dir = folder("hostile");
    let mut rows =
        "time,gyro_x,gyro_y,gyro_z,acc_x,acc_y,acc_z,\"\"\"]\nevil = 1\n\"\n".replace('\n', " ");
    rows.push('\n');
    for k in 0..200 {
        rows += &format!("{},0.05,-0.05,0.05,0,0,-1,0\n", f64::from(k) * 0.01);
    }
    fs::write(dir.join("a\"b.csv"), rows).unwrap();
    let found = undrift(&["inspect", "a\"b.csv", "-o", "drive.toml"], &dir);
    // Written, but it lacks fixes.
    assert_eq!(found.status.code(), Some(1));
    let says = String::from_utf8_lossy(&found.stderr).into_owned();
    assert!(says.contains("drive.toml lacks [gnss]"), "{says}");
    let file = fs::read_to_string(dir.join("drive.toml")).unwrap();
    toml::from_str::<toml::Table>(&file).unwrap();
    fs::remove_dir_all(&dir).unwrap();
}

#[test]
fn what_is_no_log_is_said() {
    let dir = folder("none");
    fs::write(dir.join("letter.txt"), "Dear Sir,\nno numbers here.\n").unwrap();
    fs::write(dir.join("empty"), "").unwrap();
    let report = text(&undrift(&["inspect", "letter.txt"], &dir));
    assert!(report.contains("nothing usable"), "{report}");
    for missing in ["empty", "not-there.csv"] {
        let output = undrift(&["inspect", missing], &dir);
        assert!(!output.status.success());
        assert!(String::from_utf8_lossy(&output.stderr).contains(missing));
    }
    fs::remove_dir_all(&dir).unwrap();
}

/// A golden file, what it is called, and what can be read of it.
const SAMPLES: [(&str, &str, &[&str]); 13] = [
    ("rosbag/bz2.bag", "a ROS 1 bag", &["imu", "gnss"]),
    ("mcap/zstd.mcap", "MCAP", &["imu", "gnss"]),
    ("rosbag2/plain.db3", "a ROS 2 bag", &["imu", "gnss"]),
    (
        "dataflash/flight.BIN",
        "ArduPilot DataFlash",
        &["imu", "gnss"],
    ),
    (
        "dataflash/flight.log",
        "ArduPilot DataFlash",
        &["imu", "gnss"],
    ),
    ("ulog/old.ulg", "PX4 ULog", &["imu", "gnss", "truth"]),
    (
        "navego/compressed.mat",
        "a NaveGo MATLAB file",
        &["imu", "gnss", "truth"],
    ),
    ("nmea/drive.nmea", "NMEA 0183", &["gnss"]),
    ("ubx/drive.ubx", "u-blox UBX", &["imu", "gnss"]),
    ("gpx/track.gpx", "GPX", &["gnss"]),
    ("parquet/imu.parquet", "Parquet", &["imu"]),
    ("written/track.nav", "KF-GINS text", &["truth"]),
    ("euroc/imu.csv", "EuRoC CSV", &["imu"]),
];

/// A folder is inspected as one log, and what is written for it can be navigated from.
#[test]
fn folders_of_bags_are_one_log() {
    let dir = folder("bags");
    let golden =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../testdata/golden/formats/rosbag2");
    let golden = golden.to_str().unwrap();
    for bag in ["split", "split-mcap"] {
        let path = format!("{golden}/{bag}");
        let report = text(&undrift(&["inspect", &path, "-o", "drive.toml"], &dir));
        assert!(
            report.starts_with(&format!("{path}: a ROS 2 bag\n")),
            "{report}"
        );
        // Of all three files.
        assert!(report.contains("[imu] 11 records"), "{report}");
        let drive = fs::read_to_string(dir.join("drive.toml")).unwrap();
        // The folder's own path, without the way there.
        let named = format!("formats/rosbag2/{bag}\" # a ROS 2 bag");
        assert_eq!(drive.matches(&named).count(), 2, "{drive}");
        fs::remove_file(dir.join("drive.toml")).unwrap();
    }
    fs::remove_dir_all(&dir).unwrap();
}

fn gzipped(bytes: &[u8]) -> Vec<u8> {
    use std::io::Write;
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

#[test]
fn every_format_is_known_by_its_content() {
    let dir = folder("formats");
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../testdata/golden/formats");
    for (file, called, parts) in SAMPLES {
        let bytes = fs::read(golden.join(file)).unwrap();
        // No name helps, and compression does not matter but to Parquet, which is read from its end.
        fs::write(dir.join("unnamed"), &bytes).unwrap();
        fs::write(dir.join("compressed"), gzipped(&bytes)).unwrap();
        for name in ["unnamed", "compressed"] {
            if name == "compressed" && called == "Parquet" {
                continue;
            }
            let report = text(&undrift(&["inspect", name], &dir));
            assert!(
                report.starts_with(&format!("{name}: {called}\n")),
                "{file}: {report}"
            );
            for part in parts {
                assert!(report.contains(&format!("[{part}] ")), "{file}: {report}");
            }
            assert!(!report.contains("cannot be read"), "{file}: {report}");
        }
    }
    fs::remove_dir_all(&dir).unwrap();
}
