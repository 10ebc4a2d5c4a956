//! The drives, public and one simulated, their drive files written by hand, and the command on them.

use super::log::{Log, mounting, rotation, text};
use crate::public;
use serde_json::Value;
use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
    sync::OnceLock,
};
use undrift::{
    Drive,
    nav::{Matrix3, Vector3, attitude::from_rpy},
    navigate::resolve_mounting,
    noise::{BiasModel, ImuModel},
    simulate::{GnssNoise, SimulatedLog, Trajectory},
};

/// Estimate against the drive file written by hand \[deg\].
pub const WITHIN_DEG: f64 = 3.0;

/// A car with one sensor in one place in all of its drives: z up, y forward, and turned by what the motion of trials
/// 02, 03 and 07 agrees on to a degree.
const WID: &str = r#"
vehicle.profile = "car"
model = "mpu6050"
[imu]
file = "imu.csv.gz"
time = "t_s"
gyro = ["gx_dps", "gy_dps", "gz_dps"]
gyro_unit = "deg/s"
accel = ["ax_mps2", "ay_mps2", "az_mps2"]
accel_unit = "m/s^2"
mounting = "176.4, -2.5, 95.9 deg"
[gnss]
file = "gnss.csv.gz"
time = "t_s"
position = ["lat_deg", "lon_deg", "height_m"]
position_std = "3, 3, 6 m"
"#;

/// An autopilot's log as tables without names. Speeds and courses are no columns of a drive file.
const APM: &str = r#"
model = "mpu6050"
[imu]
file = "IMU.txt.gz"
time = 1
time_unit = "ms"
gyro = [3, 4, 5]
gyro_unit = "rad/s"
accel = [6, 7, 8]
accel_unit = "m/s^2"
mounting = "0, 0, 0 deg"
[gnss]
file = "GPS.txt.gz"
time = 1
time_unit = "ms"
position = [7, 8, 9]
position_std = "3, 3, 6 m"
"#;

/// A drive.
pub struct Shared {
    pub name: &'static str,
    /// Where its files are.
    pub data: PathBuf,
    /// Its drive file written by hand, without a reference: outages are measured against the fixes withheld.
    pub by_hand: String,
    pub car: bool,
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

impl Shared {
    /// `simulated`, or a public drive if it is there.
    pub fn find(name: &'static str) -> Option<Self> {
        if name == "simulated" {
            return Some(Self::simulated());
        }
        let data = public::find(name)?;
        let example = |file: &str| text(&root().join("examples").join(file));
        let by_hand = match name.split('/').next() {
            Some("rtk-drive") => example("rtk-drive-car.toml"),
            Some("uav-flight") => example("uav-flight.toml"),
            Some("wid-car") => WID.to_owned(),
            Some("apm-quad") => APM.to_owned(),
            _ => example("ublox-drives-car.toml"),
        };
        let mut by_hand: toml::Table = by_hand.parse().unwrap();
        by_hand.remove("truth");
        Some(Self {
            name,
            data,
            car: by_hand.contains_key("vehicle"),
            by_hand: by_hand.to_string(),
        })
    }

    /// Five minutes of a simulated car in town with a receiver of a few metres.
    fn simulated() -> Self {
        static WRITTEN: OnceLock<PathBuf> = OnceLock::new();
        let data = WRITTEN.get_or_init(|| {
            let data = Path::new(env!("CARGO_TARGET_TMPDIR")).join("raw-logs-drive");
            let model = ImuModel::preset("icm20602").unwrap();
            let car = SimulatedLog {
                trajectory: &Trajectory::car(300.0, 1),
                rate_hz: 50.0,
                filters: &model.shaping(BiasModel::GaussMarkov, 0.02).unwrap(),
                gnss: &GnssNoise {
                    position_std: [2.0, 2.0, 4.0],
                    velocity_std: [0.1; 3],
                    rate_hz: 2.0,
                    ..GnssNoise::default()
                },
                seed: 1,
                model: "icm20602",
                temperature_c: None,
            };
            car.write(&data).unwrap();
            data
        });
        let mut by_hand: toml::Table = text(&data.join("drive.toml")).parse().unwrap();
        by_hand.remove("truth");
        by_hand.insert("vehicle".into(), toml::toml! { profile = "car" }.into());
        Self {
            name: "simulated",
            data: data.clone(),
            by_hand: by_hand.to_string(),
            car: true,
        }
    }

    pub fn log(&self) -> Log {
        Log::read(&self.by_hand, &self.data)
    }

    /// The mounting by hand, or what its drive file estimates.
    pub fn mounting(&self) -> Matrix3 {
        mounting(&self.by_hand).unwrap_or_else(|| {
            let drive = Drive::from_toml(&self.by_hand, "by hand", &self.data, &self.data);
            match resolve_mounting(&drive.unwrap()).unwrap() {
                (_, Some(found)) => found.matrix(),
                // The sensor's axes are the vehicle's.
                (_, None) => Matrix3::identity(),
            }
        })
    }

    /// Its files as they are: samples, fixes.
    pub fn files(&self) -> [PathBuf; 2] {
        let table: toml::Table = self.by_hand.parse().unwrap();
        ["imu", "gnss"].map(|section| self.data.join(table[section]["file"].as_str().unwrap()))
    }

    /// Drift with the drive file written by hand, whose noise model goes into a file of its own; that file.
    pub fn drift_by_hand(&self, work: &Path) -> (Vec<Option<f64>>, PathBuf) {
        let (drive, model) = (work.join("by-hand.toml"), work.join("model.toml"));
        fs::write(&drive, &self.by_hand).unwrap();
        let table: toml::Table = self.by_hand.parse().unwrap();
        let densities = match &table["model"] {
            toml::Value::String(preset) => format!("preset = {preset:?}"),
            table => toml::to_string(table).unwrap(),
        };
        let header = "format = \"undrift-imu\"\nversion = 1\n";
        fs::write(&model, format!("{header}{densities}")).unwrap();
        let data = ["--data", self.data.to_str().unwrap()];
        (drift(&drive, &model, &data), model)
    }
}

pub fn undrift(arguments: &[&str]) -> Value {
    let done = Command::new(env!("CARGO_BIN_EXE_undrift"))
        .args(arguments)
        .output()
        .unwrap();
    let errors = String::from_utf8_lossy(&done.stderr);
    serde_json::from_slice(&done.stdout).unwrap_or_else(|e| panic!("{arguments:?}: {e}\n{errors}"))
}

/// What the command prints where it refuses, or warns of under `--strict`.
pub fn doubt(arguments: &[&str]) -> String {
    let done = Command::new(env!("CARGO_BIN_EXE_undrift"))
        .args(arguments)
        .arg("--strict")
        .output()
        .unwrap();
    assert!(matches!(done.status.code(), Some(1 | 3)), "{arguments:?}");
    String::from_utf8(done.stderr).unwrap()
}

/// How `inspect` knows how the IMU sits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum How {
    /// By navigating in sensor axes.
    Motion,
    /// By forces, speeds and turns.
    Forces,
    /// By gravity alone: the heading of the axes is assumed.
    Gravity,
}

/// What `inspect` found.
pub struct Found {
    pub how: How,
    /// Takes the sensor's axes to the vehicle's.
    pub mounting: Matrix3,
    pub notes: String,
}

/// Inspects files and writes the drive file.
pub fn inspect(files: &[PathBuf], car: bool, drive: &Path) -> Found {
    let files = files.iter().map(|file| file.to_str().unwrap());
    let mut arguments: Vec<&str> = ["inspect"].into_iter().chain(files).collect();
    arguments.extend(["-o", drive.to_str().unwrap(), "--json", "-"]);
    if car {
        arguments.extend(["--vehicle", "car"]);
    }
    let found = undrift(&arguments);
    let all = found.as_array().unwrap().iter();
    let parts = all
        .clone()
        .flat_map(|file| file["parts"].as_array().unwrap());
    let imu = parts.clone().find(|part| part["table"] == "imu");
    let imu = imu.unwrap_or_else(|| panic!("no IMU: {found:#}"));
    let lines = imu["lines"].as_array().unwrap();
    let line = lines
        .iter()
        .find(|line| line["key"] == "mounting" || line["key"] == "axes");
    let line = line.unwrap_or_else(|| panic!("no axes: {found:#}"));
    let rpy = &line["known"]["motion"]["rpy_deg"];
    let (how, mounting) = if rpy.is_array() {
        let rpy = [0, 1, 2].map(|k| rpy[k].as_f64().unwrap().to_radians());
        let mounting = from_rpy(&Vector3::from(rpy)).to_rotation_matrix();
        (How::Motion, mounting.into_inner())
    } else {
        let value: toml::Table = format!("of = {}", line["value"].as_str().unwrap())
            .parse()
            .unwrap();
        let mounting = rotation(value["of"].as_str().unwrap());
        let how = match &line["known"]["forces"] {
            Value::Null => How::Gravity,
            _ => How::Forces,
        };
        (how, mounting.unwrap_or_else(Matrix3::zeros))
    };
    let notes = all.flat_map(|file| file["notes"].as_array().unwrap());
    Found {
        how,
        mounting,
        notes: notes
            .map(|note| note.as_str().unwrap())
            .collect::<Vec<_>>()
            .join("\n"),
    }
}

pub fn angle_deg(a: &Matrix3, b: &Matrix3) -> f64 {
    let cosine = ((a.transpose() * b).trace() - 1.0) / 2.0;
    cosine.clamp(-1.0, 1.0).acos().to_degrees()
}

/// Largest horizontal error of each outage \[m\].
pub fn drift(drive: &Path, model: &Path, extra: &[&str]) -> Vec<Option<f64>> {
    let [drive, model] = [drive, model].map(|path| path.to_str().unwrap());
    let run = ["outages", drive, "--model", model, "--json", "-"];
    let cuts = ["--length", "10", "--every", "20", "--bias-models", "arma"];
    // One start is a matter of luck: three, a third of the interval apart.
    let of_start = |start: &&str| {
        let result = undrift(&[&run[..], &cuts, &["--start", start], extra].concat());
        let each = result["models"]["arma"]["per_outage"].as_array().unwrap();
        each.iter()
            .map(|outage| outage["max"]["horizontal_m"].as_f64())
            .collect::<Vec<_>>()
    };
    ["40", "47", "54"].iter().flat_map(of_start).collect()
}

/// Root mean squares of two drifts over the outages that both measured, and how many these are.
pub fn compared(a: &[Option<f64>], b: &[Option<f64>]) -> (f64, f64, usize) {
    let pairs: Vec<(f64, f64)> = a
        .iter()
        .zip(b)
        .filter_map(|(a, b)| Some(((*a)?, (*b)?)))
        .collect();
    let mean = |of: fn(&(f64, f64)) -> f64| {
        (pairs.iter().map(|pair| of(pair).powi(2)).sum::<f64>() / pairs.len() as f64).sqrt()
    };
    (mean(|pair| pair.0), mean(|pair| pair.1), pairs.len())
}

pub fn scratch(name: &str) -> PathBuf {
    let name = name.replace('/', "-");
    let folder = std::env::temp_dir().join(format!("undrift-raw-{name}-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    folder
}
