//! Drives: files, or columns in memory.

use crate::{
    columns::{self, Arrays, Named, array, coordinates, matrix_std},
    error::{Failure, error},
    model::NoiseModel,
    work,
};
use pyo3::{prelude::*, types::PyDict};
use std::path::{Path, PathBuf};
use undrift::{
    columns::poses as poses_of_columns,
    drive, inspect,
    io::{
        Memory,
        poses::{AttitudeColumns, PoseFormat, QuaternionOrder},
        table::{Column, Preview},
    },
    nav::{
        Matrix3,
        earth::Geodetic,
        sample::{GnssFix, ImuSample, Position},
        units::{Quantity, unit_factor},
    },
    navigate,
    noise::interrupt,
    results,
};
use undrift_report::say;

/// A drive, ready to be read; `undrift.Drive` wraps it.
#[pyclass(frozen, module = "undrift._undrift")]
pub struct Drive {
    pub drive: drive::Drive,
    /// The drive file, or what messages call it.
    pub file: PathBuf,
}

#[pymethods]
impl Drive {
    /// Reads a drive file; the names of logs are relative to `data` or else to its own folder.
    #[staticmethod]
    #[pyo3(signature = (path, data=None))]
    fn load(py: Python<'_>, path: PathBuf, data: Option<PathBuf>) -> PyResult<Self> {
        let drive = py.detach(|| drive::Drive::load(&path, data.as_deref()));
        let drive = drive.map_err(error)?;
        Ok(Self { drive, file: path })
    }

    /// Reads the text of a drive file, called `file`; `memory` has the columns of the logs that are no files.
    #[staticmethod]
    fn from_toml(text: &str, file: PathBuf, memory: Vec<(PathBuf, Named<'_>)>) -> PyResult<Self> {
        let mut logs = drive::Logs::default();
        for (path, named) in memory {
            let columns = columns::columns(&path, named)?;
            logs.memory.insert(path, Memory::Columns(columns));
        }
        let name = file.to_string_lossy();
        let drive = drive::Drive::with_logs(text, &name, Path::new(""), logs).map_err(error)?;
        Ok(Self { drive, file })
    }

    /// The same drive with another noise model.
    fn with_model(&self, model: &NoiseModel) -> Self {
        Self {
            drive: drive::Drive {
                model: Some(model.0.clone()),
                ..self.drive.clone()
            },
            file: self.file.clone(),
        }
    }

    /// The noise model that the drive names.
    #[getter]
    fn model(&self) -> Option<NoiseModel> {
        self.drive.model.clone().map(NoiseModel)
    }

    /// The drive file, or what messages call it.
    #[getter]
    fn file(&self) -> PathBuf {
        self.file.clone()
    }

    /// Whether it has poses in the place of fixes.
    #[getter]
    fn by_poses(&self) -> bool {
        self.drive.poses.is_some()
    }

    /// The inertial samples in body axes, by the names of `undrift.ImuLog`.
    fn imu<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let samples = work::run(py, || {
            let (drive, _) = navigate::resolve_mounting(&self.drive)
                .map_err(|error| say::unsolved(error.findings(), error))?;
            let samples = drive.open_imu()?;
            let samples: Result<Vec<ImuSample>, _> =
                samples.inspect(|_| interrupt::check()).collect();
            Ok::<_, Failure>(samples?)
        })?;
        let samples = samples.map_err(error)?;
        let imu = Arrays::new(py, &samples)
            .one("time", |sample| sample.time)?
            .three("gyro", |sample| array(&(sample.dtheta / sample.dt)))?
            .three("accel", |sample| array(&(sample.dvel / sample.dt)))?;
        Ok(imu.dict())
    }

    /// The fixes by the names of `undrift.GnssLog`, with their covariances as matrices row by row.
    fn gnss<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let fixes = work::run(py, || {
            let fixes = self.drive.open_gnss()?.map(|fix| {
                let fix = self.drive.quality.apply(&fix?);
                Ok::<_, Failure>(fix)
            });
            fixes.collect::<Result<Vec<GnssFix>, _>>()
        })?;
        let fixes = fixes.map_err(error)?;
        let nan = [f64::NAN; 3];
        let unknown = Matrix3::repeat(f64::NAN);
        let position = |fix: &GnssFix| fix.position.map_or(unknown, |(_, r)| r);
        let velocity = |fix: &GnssFix| fix.velocity.map_or(unknown, |(_, r)| r);
        let place = |fix: &GnssFix| {
            fix.position
                .map_or(nan, |(at, _)| coordinates(&antenna(at)))
        };
        let arrays = Arrays::new(py, &fixes)
            .one("time", |fix| fix.time)?
            .place(place)?
            .three("position_std", |fix| matrix_std(&position(fix)))?
            .three("velocity", |fix| {
                fix.velocity.map_or(nan, |(v, _)| array(&v))
            })?
            .three("velocity_std", |fix| matrix_std(&velocity(fix)))?
            .nine("position_cov", position)?
            .nine("velocity_cov", velocity)?;
        Ok(arrays.dict())
    }

    /// What the drive consists of, as JSON.
    fn json(&self) -> String {
        results::text(&self.drive.result(&self.file))
    }
}

/// The antenna's place.
fn antenna(at: Position) -> Geodetic {
    match at {
        Position::Geodetic(place) => place,
        Position::Baseline { base, ned } => {
            // Towards it along the local radii; each step leaves the square of the last one's error over the radius.
            let nearer = |place: Geodetic, _| place.displaced(&(ned - base.ned_to(&place)));
            (0..5).fold(base, nearer)
        }
    }
}

/// Keys of a drive file's table and their values as TOML writes them.
type Keys = Vec<(&'static str, String)>;

/// What the names of columns show of a table of the drive file, `imu`, `gnss`, `poses` or `truth`.
#[pyfunction]
pub fn parts_by_names(names: Vec<String>) -> Vec<(&'static str, Keys)> {
    let table = Preview {
        names: names.clone(),
        ..Preview::default()
    };
    let poses = poses_of_columns(&table).and_then(|poses| keys_of(&poses));
    let parts = inspect::by_names(&names).into_iter();
    parts
        .filter(|part| part.table != POSES)
        .map(|part| {
            let lines = part.lines.into_iter();
            let keys = lines.map(|line| (line.key, line.value.to_string()));
            (part.table, keys.collect())
        })
        .chain(poses.map(|keys| (POSES, keys)))
        .collect()
}

/// The table of poses.
const POSES: &str = "poses";
/// Units that names of columns may state.
const TIMES: [&str; 4] = ["s", "ms", "us", "ns"];
const LENGTHS: [&str; 6] = ["m", "mm", "cm", "km", "ft", "in"];

/// The keys of `[poses]` that read such columns, without the order of a quaternion that no name states; `None` without a position, or in
/// units that are not those above.
fn keys_of(poses: &PoseFormat) -> Option<Keys> {
    let time_unit = unit_of(poses.time_scale, Quantity::Time, &TIMES)?;
    let length_unit = unit_of(poses.position_scale, Quantity::Length, &LENGTHS)?;
    let list = |key, columns: &[Column]| (key, format!("[{}]", toml_of(columns)));
    let one = |column| toml_of(std::slice::from_ref(column));
    let mut keys = vec![("time", one(&poses.time))];
    if poses.time_scale != 1.0 {
        keys.push(("time_unit", time_unit));
    }
    keys.extend(poses.date.as_ref().map(|date| ("date", one(date))));
    keys.push(list("position", poses.position.as_ref()?));
    if poses.position_scale != 1.0 {
        keys.push(("position_unit", length_unit));
    }
    let position_std = poses.position_std.as_ref();
    keys.extend(position_std.map(|std| list("position_std_columns", std)));
    match &poses.attitude {
        Some(AttitudeColumns::Quaternion {
            columns: four,
            w_first,
        }) => {
            keys.push(list("attitude", four));
            if poses.quaternion_order == QuaternionOrder::Stated {
                let order = if *w_first { "w,x,y,z" } else { "x,y,z,w" };
                keys.push(("attitude_order", text(order)));
            }
        }
        Some(AttitudeColumns::Euler {
            columns: three,
            scale,
        }) => {
            keys.push(list("euler", three));
            let unit = if *scale == 1.0 { "rad" } else { "deg" };
            keys.push(("euler_unit", text(unit)));
        }
        // No names of columns show these.
        Some(AttitudeColumns::Matrix(_) | AttitudeColumns::RotationVector { .. }) | None => {}
    }
    Some(keys)
}

/// The unit of a factor to SI.
fn unit_of(factor: f64, quantity: Quantity, units: &[&str]) -> Option<String> {
    let mut units = units.iter();
    let unit = units.find(|unit| unit_factor(unit, quantity) == Ok(factor));
    unit.map(|unit| text(unit))
}

/// A text as TOML writes it.
fn text(of: &str) -> String {
    serde_json::to_string(of).unwrap_or_default()
}

/// Columns as TOML writes them, between commas.
fn toml_of(columns: &[Column]) -> String {
    let each = columns.iter().map(|column| match column {
        Column::Number(number) => number.to_string(),
        Column::Name(name) => text(name),
    });
    Vec::from_iter(each).join(", ")
}
