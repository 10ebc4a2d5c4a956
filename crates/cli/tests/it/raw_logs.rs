//! Raw logs of public drives in `../shared/data`, with the axes of the IMU turned in every way: nothing but `inspect` and
//! `outages`. Skipped, and said so, where the data is missing.

use flate2::read::GzDecoder;
use serde_json::Value;
use std::{
    fmt::Write as _,
    fs,
    io::Read,
    path::{Path, PathBuf},
    process::Command,
};
use undrift::nav::{
    Matrix3, Vector3,
    attitude::{from_rpy, to_rpy},
};

/// Estimate against the drive file set by hand or against the estimate of another turn \[deg\].
const WITHIN_DEG: f64 = 3.0;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn folder(name: &str) -> Option<PathBuf> {
    let folder = root().join("../shared/data").join(name);
    if !folder.is_dir() {
        println!("skipped: {} is missing", folder.display());
        return None;
    }
    Some(folder)
}

/// The 24 turns that take axes to axes.
fn turns() -> Vec<Matrix3> {
    let mut turns = Vec::new();
    for order in [
        [0, 1, 2],
        [0, 2, 1],
        [1, 0, 2],
        [1, 2, 0],
        [2, 0, 1],
        [2, 1, 0],
    ] {
        for signs in 0..8 {
            let mut turn = Matrix3::zeros();
            for (row, column) in order.into_iter().enumerate() {
                turn[(row, column)] = if signs >> row & 1 == 0 { 1.0 } else { -1.0 };
            }
            if turn.determinant() > 0.0 {
                turns.push(turn);
            }
        }
    }
    turns
}

/// A log of a table: header and rows.
struct Raw {
    header: String,
    rows: Vec<Vec<f64>>,
}

impl Raw {
    fn read(file: &Path) -> Self {
        let mut text = String::new();
        let file = fs::File::open(file).unwrap();
        GzDecoder::new(file).read_to_string(&mut text).unwrap();
        let (header, rows) = text.split_once('\n').unwrap();
        let row = |line: &str| {
            line.split(',')
                .map(|field| field.parse().unwrap())
                .collect()
        };
        Self {
            header: header.to_owned(),
            rows: rows.lines().map(row).collect(),
        }
    }

    /// The same of a sensor that is turned: triads in columns 1 to 3 and 4 to 6.
    fn turned(&self, turn: &Matrix3) -> String {
        let mut text = format!("{}\n", self.header);
        for row in &self.rows {
            let [first, second] =
                [1, 4].map(|at| turn * Vector3::new(row[at], row[at + 1], row[at + 2]));
            let _ = write!(text, "{}", row[0]);
            for value in first.iter().chain(&second) {
                let _ = write!(text, ",{value}");
            }
            text.push('\n');
        }
        text
    }
}

fn undrift(arguments: &[&str]) -> Value {
    let done = Command::new(env!("CARGO_BIN_EXE_undrift"))
        .args(arguments)
        .output()
        .unwrap();
    let errors = String::from_utf8_lossy(&done.stderr);
    serde_json::from_slice(&done.stdout).unwrap_or_else(|e| panic!("{arguments:?}: {e}\n{errors}"))
}

/// Takes the sensor's axes to the vehicle's, as `inspect` estimates it; it writes the drive file.
fn inspected(imu: &Path, gnss: &Path, drive: &Path) -> Matrix3 {
    let [imu, gnss, drive] = [imu, gnss, drive].map(|path| path.to_str().unwrap());
    let arguments = [
        "inspect",
        imu,
        gnss,
        "--vehicle",
        "car",
        "-o",
        drive,
        "--json",
        "-",
    ];
    let found = undrift(&arguments);
    let lines = found[0]["parts"][0]["lines"].as_array().unwrap();
    let mounting = lines.iter().find(|line| line["key"] == "mounting");
    let rpy = &mounting.unwrap_or_else(|| panic!("{lines:?}"))["known"]["motion"]["rpy_deg"];
    let rpy = [0, 1, 2].map(|k| rpy[k].as_f64().unwrap().to_radians());
    from_rpy(&Vector3::from(rpy))
        .to_rotation_matrix()
        .into_inner()
}

fn angle_deg(a: &Matrix3, b: &Matrix3) -> f64 {
    let cosine = ((a.transpose() * b).trace() - 1.0) / 2.0;
    cosine.clamp(-1.0, 1.0).acos().to_degrees()
}

/// Root mean square of the largest horizontal errors \[m\].
fn drift(drive: &Path, extra: &[&str]) -> f64 {
    let cuts = [
        "--length",
        "10",
        "--every",
        "30",
        "--start",
        "60",
        "--bias-models",
        "arma",
    ];
    let drive = ["outages", drive.to_str().unwrap(), "--json", "-"];
    let result = undrift(&[&drive[..], &cuts, extra].concat());
    let each = result["models"]["arma"]["per_outage"].as_array().unwrap();
    let squares = each
        .iter()
        .filter_map(|outage| outage["max"]["horizontal_m"].as_f64());
    let squares: Vec<f64> = squares.map(|drift| drift * drift).collect();
    assert!(squares.len() > 10, "{} outages", squares.len());
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

/// The mounting in a drive file set by hand.
fn by_hand(example: &Path) -> Matrix3 {
    let text: toml::Table = fs::read_to_string(example).unwrap().parse().unwrap();
    let mounting = text["imu"]["mounting"].as_str().unwrap();
    let angles = mounting.trim_end_matches(" deg").split(", ");
    let angles: Vec<f64> = angles.map(|angle| angle.parse::<f64>().unwrap()).collect();
    let rpy = Vector3::from_row_slice(&angles).map(f64::to_radians);
    from_rpy(&rpy).to_rotation_matrix().into_inner()
}

fn scratch(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("undrift-raw-{name}-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    folder
}

#[test]
#[ignore = "slow: 24 logs"]
fn every_turn_of_the_sensor_in_a_car() {
    let Some(data) = folder("rtk-drive") else {
        return;
    };
    let work = scratch("rtk");
    let raw = Raw::read(&data.join("imu.csv.gz"));
    let example = root().join("examples/rtk-drive-car.toml");
    let truth = by_hand(&example);
    let model = work.join("imu.toml");
    let text: toml::Table = fs::read_to_string(&example).unwrap().parse().unwrap();
    let densities = toml::to_string(&text["model"]).unwrap();
    let header = "format = \"undrift-imu\"\nversion = 1\n";
    fs::write(&model, format!("{header}{densities}")).unwrap();
    let model = ["--model", model.to_str().unwrap()];
    let own = [&model[..], &["--data", data.to_str().unwrap()]].concat();
    let wanted = drift(&example, &own);
    for (k, turn) in turns().iter().enumerate() {
        let (imu, drive) = (
            work.join(format!("imu{k}.csv")),
            work.join(format!("{k}.toml")),
        );
        fs::write(&imu, raw.turned(turn)).unwrap();
        let found = inspected(&imu, &data.join("gnss.pos"), &drive);
        let off = angle_deg(&found, &(truth * turn.transpose()));
        let rpy = to_rpy(&undrift::nav::Quaternion::from_matrix(&found)).map(f64::to_degrees);
        assert!(off < WITHIN_DEG, "turn {k}: {off:.2} deg off, {rpy:.1}");
        if k % 8 == 0 {
            let got = drift(&drive, &model);
            println!("turn {k}: {off:.2} deg off; {got:.2} m, by hand {wanted:.2} m");
            assert!(got < 1.1 * wanted, "turn {k}: {got} m, by hand {wanted} m");
        }
    }
    fs::remove_dir_all(&work).unwrap();
}

#[test]
#[ignore = "slow: 18 logs"]
fn turns_of_the_sensor_agree_on_other_drives() {
    for name in [
        "ublox-drives/mixed-road-long-drive-nominal-001",
        "ublox-drives-more/urban-medium-turn-loop-nominal-001",
        "ublox-drives-more/urban-low-speed-low-signal-001",
    ] {
        let Some(data) = folder(name) else { return };
        let work = scratch(name.split('/').next_back().unwrap());
        let raw = Raw::read(&data.join("imu.csv.gz"));
        let gnss = data.join("gnss.csv.gz");
        let drive = work.join("drive.toml");
        let original = inspected(&data.join("imu.csv.gz"), &gnss, &drive);
        for (k, turn) in turns().iter().enumerate().step_by(4) {
            let imu = work.join("imu.csv");
            fs::write(&imu, raw.turned(turn)).unwrap();
            let found = inspected(&imu, &gnss, &drive);
            let off = angle_deg(&found, &(original * turn.transpose()));
            assert!(off < WITHIN_DEG, "{name}, turn {k}: {off:.2} deg off");
        }
        fs::remove_dir_all(&work).unwrap();
    }
}
