//! Drives: files, or columns in memory.

use crate::{
    columns::{self, Named},
    error::error,
    model::NoiseModel,
};
use pyo3::prelude::*;
use std::path::{Path, PathBuf};
use undrift::{drive, inspect, io::Memory, results};

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

    /// What the drive consists of, as JSON.
    fn json(&self) -> String {
        results::text(&results::Drive::of(&self.file, &self.drive))
    }
}

/// What the names of columns tell of a table of the drive file, `imu`, `gnss` or `truth`: keys and
/// values as TOML writes them.
#[pyfunction]
pub fn told_by_names(names: Vec<String>) -> Vec<(&'static str, Vec<(&'static str, String)>)> {
    inspect::by_names(&names)
        .into_iter()
        .map(|part| {
            let lines = part.lines.into_iter();
            (
                part.table,
                lines.map(|line| (line.key, line.value)).collect(),
            )
        })
        .collect()
}
