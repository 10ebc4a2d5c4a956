//! Results for reading.

use crate::{error::error, model::write};
use pyo3::prelude::*;
use std::path::PathBuf;
use undrift_report::{ReportFormat, figures, of_results};

/// Makes a report of results: their names, of files or none, and their JSON. It goes into a file `output`, in the format
/// of its extension, its figures into a folder, where they are asked for.
#[pyfunction]
#[pyo3(name = "report")]
pub fn make(
    py: Python<'_>,
    results: Vec<(PathBuf, String)>,
    output: Option<PathBuf>,
    folder: Option<PathBuf>,
) -> PyResult<()> {
    py.detach(|| {
        let document = of_results(&results).map_err(error)?;
        if let Some(path) = output {
            let format = ReportFormat::from_path(&path).ok_or_else(|| {
                let path = path.display();
                error(format!(
                    "{path}: a report is .html, or its tables as .md, .tex or .csv"
                ))
            })?;
            write(&path, &format.render(&document))?;
        }
        if let Some(folder) = folder {
            figures::write(&document, &folder).map_err(error)?;
        }
        Ok(())
    })
}
