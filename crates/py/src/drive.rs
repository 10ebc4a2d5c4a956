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
    drive, inspect,
    io::Memory,
    nav::{
        Matrix3,
        earth::Geodetic,
        sample::{GnssFix, ImuSample, Position},
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

/// What the names of columns tell of a table of the drive file, `imu`, `gnss` or `truth`: keys and
/// values as TOML writes them.
#[pyfunction]
pub fn parts_by_names(names: Vec<String>) -> Vec<(&'static str, Vec<(&'static str, String)>)> {
    inspect::by_names(&names)
        .into_iter()
        .map(|part| {
            let lines = part.lines.into_iter();
            (
                part.table,
                lines
                    .map(|line| (line.key, line.value.to_string()))
                    .collect(),
            )
        })
        .collect()
}
