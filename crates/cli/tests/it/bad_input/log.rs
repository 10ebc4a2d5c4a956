//! A small drive as files, to be damaged, and the real command on it.

use std::path::PathBuf;
use std::process::Command;
use std::sync::OnceLock;
use undrift::nav::Vector3;
use undrift::nav::sample::Position;
use undrift::noise::{BiasModel, ImuModel};
use undrift::simulate::{GnssNoise, Simulation, Trajectory, simulate};

pub const RATE_HZ: f64 = 50.0;
/// Length of the drive [s]; it is at rest until 20 s and cruises at 15 m/s from about 30 s on.
pub const DURATION: f64 = 80.0;

const DRIVE: &str = r#"model = "adis16465"
[imu]
file = "imu.csv"
time = "t"
gyro = ["gx", "gy", "gz"]
gyro_unit = "rad/s"
accel = ["fx", "fy", "fz"]
accel_unit = "m/s^2"
[gnss]
file = "gnss.csv"
time = "t"
position = ["lat", "lon", "height"]
position_std_columns = ["sn", "se", "sd"]
velocity = ["vn", "ve", "vd"]
velocity_std = "0.05 m/s"
[truth]
file = "truth.csv"
time = "t"
position = ["lat", "lon", "height"]
velocity = ["vn", "ve", "vd"]
attitude = ["roll", "pitch", "yaw"]
"#;

/// A row of a log: its time [s] and the fields as text, the time first.
#[derive(Clone)]
pub struct Row {
    pub time: f64,
    pub fields: Vec<String>,
}

impl Row {
    fn new(time: f64, values: &[f64]) -> Self {
        let fields = std::iter::once(format!("{time:.4}"))
            .chain(values.iter().map(|value| format!("{value:.12e}")))
            .collect();
        Self { time, fields }
    }

    /// The row at another time.
    pub fn at(&self, time: f64) -> Self {
        let mut row = self.clone();
        row.time = time;
        row.fields[0] = format!("{time:.4}");
        row
    }

    /// The number in a column; the time is column 0.
    pub fn number(&self, column: usize) -> f64 {
        self.fields[column].parse().unwrap()
    }

    /// Puts numbers into columns after the time.
    pub fn put(&mut self, column: usize, values: &[f64]) {
        for (field, value) in self.fields[column..].iter_mut().zip(values) {
            *field = format!("{value:.12e}");
        }
    }
}

/// The files of a drive, before they are written.
#[derive(Clone)]
pub struct Log {
    pub drive: String,
    pub imu: Vec<Row>,
    pub gnss: Vec<Row>,
    pub truth: Vec<Row>,
}

fn simulation() -> &'static Simulation {
    static ONCE: OnceLock<Simulation> = OnceLock::new();
    ONCE.get_or_init(|| {
        let mut car = Trajectory::rest(DURATION);
        car.course = 0.6;
        car.speed.ramp_to(20.0, 1.5, 1.0, 15.0);
        simulated(&car)
    })
}

/// A drive with the sensors and the receiver of all drives here.
pub fn simulated(car: &Trajectory) -> Simulation {
    let model = ImuModel::preset("adis16465").unwrap();
    let sensors = model
        .shaping(BiasModel::GaussMarkov, 1.0 / RATE_HZ)
        .unwrap();
    let gnss = GnssNoise {
        position_std: [0.5, 0.5, 1.0],
        velocity_std: [0.05; 3],
        rate_hz: 2.0,
        ..GnssNoise::default()
    };
    simulate(car, RATE_HZ, Some(&sensors), &gnss, 5).unwrap()
}

impl Log {
    /// Without a fault.
    pub fn good() -> Self {
        Self::of(simulation())
    }

    /// The files of a simulated drive.
    pub fn of(of: &Simulation) -> Self {
        let vector = |v: Vector3| [v.x, v.y, v.z];
        let place =
            |p: &undrift::nav::earth::Geodetic| [p.lat.to_degrees(), p.lon.to_degrees(), p.height];
        let imu = of.imu.iter().map(|s| {
            let (rate, force) = (vector(s.dtheta / s.dt), vector(s.dvel / s.dt));
            Row::new(s.time, &[rate, force].concat())
        });
        let gnss = of.gnss.iter().map(|fix| {
            let (Some((Position::Geodetic(p), _)), Some((v, _))) = (fix.position, fix.velocity)
            else {
                panic!("the simulated fix has both parts");
            };
            Row::new(fix.time, &[place(&p), vector(v), [0.5, 0.5, 1.0]].concat())
        });
        let truth = of.truth.iter().map(|s| {
            let (v, rpy) = (s.v_n.unwrap(), s.rpy.unwrap().map(f64::to_degrees));
            Row::new(
                s.time,
                &[place(&s.position), vector(v), vector(rpy)].concat(),
            )
        });
        Self {
            drive: DRIVE.to_owned(),
            imu: imu.collect(),
            gnss: gnss.collect(),
            truth: truth.collect(),
        }
    }

    /// Replaces a piece of the drive file that must be there.
    pub fn set(&mut self, from: &str, to: &str) -> &mut Self {
        assert!(self.drive.contains(from), "no {from:?} in the drive file");
        self.drive = self.drive.replacen(from, to, 1);
        self
    }

    /// Index of the inertial row at `time` [s].
    pub fn imu_at(&self, time: f64) -> usize {
        self.imu
            .iter()
            .position(|row| row.time > time - 1e-6)
            .unwrap()
    }

    /// Writes the files into a folder of the test's own.
    pub fn write(&self, name: &str) -> Case {
        let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
        // Left by an earlier run, if it is there.
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(&folder).unwrap();
        let case = Case { folder };
        case.put("drive.toml", self.drive.as_bytes());
        case.put(
            "imu.csv",
            table("t,gx,gy,gz,fx,fy,fz", &self.imu).as_bytes(),
        );
        let header = "t,lat,lon,height,vn,ve,vd,sn,se,sd";
        case.put("gnss.csv", table(header, &self.gnss).as_bytes());
        let header = "t,lat,lon,height,vn,ve,vd,roll,pitch,yaw";
        case.put("truth.csv", table(header, &self.truth).as_bytes());
        case
    }
}

/// The text of a file; row k (from 0) is on line k + 2.
pub fn table(header: &str, rows: &[Row]) -> String {
    let mut text = format!("{header}\n");
    for row in rows {
        text += &row.fields.join(",");
        text.push('\n');
    }
    text
}

/// A folder with a drive; removed when dropped, kept when a test fails.
pub struct Case {
    folder: PathBuf,
}

impl Drop for Case {
    fn drop(&mut self) {
        if !std::thread::panicking() {
            let _ = std::fs::remove_dir_all(&self.folder);
        }
    }
}

impl Case {
    /// Writes a file of the case.
    pub fn put(&self, name: &str, bytes: &[u8]) {
        std::fs::write(self.folder.join(name), bytes).unwrap();
    }

    /// Text of a file of the case, if it is there.
    pub fn read(&self, name: &str) -> Option<String> {
        std::fs::read_to_string(self.folder.join(name)).ok()
    }

    /// Path of a file of the case.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// Runs the command; it must end by itself, with success or failure and never by a panic.
    pub fn run(&self, arguments: &[&str]) -> Outcome {
        let output = Command::new(env!("CARGO_BIN_EXE_undrift"))
            .args(arguments)
            .current_dir(&self.folder)
            .output()
            .unwrap();
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        let outcome = Outcome {
            code: output.status.code(),
            stdout: text(&output.stdout),
            stderr: text(&output.stderr),
        };
        assert!(!outcome.stderr.contains("panicked"), "{}", outcome.stderr);
        assert!(
            matches!(outcome.code, Some(0..=3)),
            "{:?} {}",
            outcome.code,
            outcome.stderr
        );
        outcome
    }

    /// `undrift navigate` with a solution, which must be all numbers if there is one.
    pub fn navigate(&self) -> (Outcome, Option<Nav>) {
        let outcome = self.run(&["navigate", "drive.toml", "-o", "nav.csv"]);
        let nav = self.nav();
        assert!(nav.is_some() || !outcome.succeeded(), "no solution");
        (outcome, nav)
    }

    /// `undrift navigate` that must succeed.
    pub fn solution(&self) -> (Outcome, Nav) {
        let (outcome, nav) = self.navigate();
        assert!(outcome.succeeded(), "{}", outcome.stderr);
        (outcome, nav.unwrap())
    }

    /// `undrift navigate` that must fail without leaving a solution; the message.
    pub fn refusal(&self) -> String {
        let (outcome, nav) = self.navigate();
        assert_eq!(outcome.code, Some(1), "{}", outcome.stderr);
        assert!(nav.is_none(), "a solution was left behind");
        outcome.stderr
    }

    /// `undrift navigate` whose result says that it cannot be trusted, with a warning that has all
    /// these parts in its JSON.
    #[track_caller]
    pub fn doubted(&self, parts: &[&str]) -> Vec<String> {
        self.distrusted(3, parts)
    }

    /// The same with this exit code: 1 where the solution diverges for good before the log ends.
    #[track_caller]
    pub fn distrusted(&self, code: i32, parts: &[&str]) -> Vec<String> {
        let outcome = self.run(&[
            "navigate",
            "drive.toml",
            "--strict",
            "-o",
            "nav.csv",
            "--json",
            "r.json",
        ]);
        assert_eq!(outcome.code, Some(code), "{}", outcome.stderr);
        assert!(self.nav().is_some(), "no solution");
        let result = std::fs::read_to_string(self.folder.join("r.json")).unwrap();
        let result: serde_json::Value = serde_json::from_str(&result).unwrap();
        let warnings: Vec<String> = serde_json::from_value(result["warnings"].clone()).unwrap();
        let said = |warning: &String| parts.iter().all(|part| warning.contains(part));
        assert!(warnings.iter().any(said), "{parts:?} in {warnings:#?}");
        warnings
    }

    /// `undrift outages` with the arma model.
    pub fn outages(&self, arguments: &[&str]) -> Outcome {
        let first = ["outages", "drive.toml", "--bias-models", "arma"];
        self.run(&[&first, arguments].concat())
    }

    fn nav(&self) -> Option<Nav> {
        let text = std::fs::read_to_string(self.folder.join("nav.csv")).ok()?;
        let mut lines = text.lines();
        let names: Vec<String> = lines.next()?.split(',').map(str::to_owned).collect();
        let rows: Vec<Vec<f64>> = lines
            .map(|line| {
                let values: Vec<f64> = line.split(',').map(|f| f.parse().unwrap()).collect();
                assert!(values.iter().all(|v| v.is_finite()), "in nav.csv: {line}");
                assert_eq!(values.len(), names.len());
                values
            })
            .collect();
        assert!(rows.windows(2).all(|w| w[0][0] < w[1][0]), "nav.csv: times");
        Some(Nav { names, rows })
    }
}

/// What the command said.
pub struct Outcome {
    pub code: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

impl Outcome {
    pub fn succeeded(&self) -> bool {
        self.code == Some(0)
    }

    /// RMS error of a component against the truth, as printed.
    pub fn rms(&self, component: &str) -> f64 {
        let line = self.stdout.lines().find(|l| l.starts_with("RMS error"));
        let line = line.unwrap_or_else(|| panic!("no RMS error in {}", self.stdout));
        let (_, after) = line.split_once(&format!("{component} ")).unwrap();
        after.split(',').next().unwrap().trim().parse().unwrap()
    }
}

/// A solution file.
pub struct Nav {
    names: Vec<String>,
    rows: Vec<Vec<f64>>,
}

impl Nav {
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// A column at the first row at or after `time` [s].
    pub fn at(&self, time: f64, column: &str) -> f64 {
        let column = self.names.iter().position(|name| name == column).unwrap();
        let row = self.rows.iter().find(|row| row[0] > time - 1e-6).unwrap();
        row[column]
    }
}

/// Asserts that a message has all the parts.
#[track_caller]
pub fn says(message: &str, parts: &[&str]) {
    for part in parts {
        assert!(message.contains(part), "no {part:?} in:\n{message}");
    }
}
