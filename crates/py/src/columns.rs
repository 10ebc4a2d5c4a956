//! Numbers between Python and Rust.

use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::Path;
use undrift::{
    io::{table::Columns, write::solution::SolutionRow},
    nav::{Matrix3, Vector3},
};

use crate::error::error;

/// Columns with their names, as Python hands them over.
pub type Named<'py> = Vec<(String, PyReadonlyArray1<'py, f64>)>;

/// The columns in memory that Rust keeps: the one copy of a table. `path` is what messages call it.
pub fn columns(path: &Path, named: Named<'_>) -> PyResult<Columns> {
    let columns = named
        .into_iter()
        .map(|(name, values)| (name, values.as_array().to_vec()))
        .collect();
    Columns::new(path, columns).map_err(error)
}

/// An array of rows and columns from its numbers row by row.
pub fn table<'py>(
    py: Python<'py>,
    numbers: Vec<f64>,
    width: usize,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let rows = numbers.len() / width.max(1);
    numbers.into_pyarray(py).reshape([rows, width])
}

/// Three numbers of every item side by side.
pub fn three<'py, T>(
    py: Python<'py>,
    items: &[T],
    of: impl Fn(&T) -> [f64; 3],
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    table(py, items.iter().flat_map(of).collect(), 3)
}

/// One number of every item.
pub fn one<'py, T>(
    py: Python<'py>,
    items: &[T],
    of: impl Fn(&T) -> f64,
) -> Bound<'py, PyArray1<f64>> {
    items.iter().map(of).collect::<Vec<f64>>().into_pyarray(py)
}

/// The numbers of a vector.
pub fn array(v: &Vector3) -> [f64; 3] {
    [v.x, v.y, v.z]
}

/// The standard deviations of a covariance.
pub fn matrix_std(covariance: &Matrix3) -> [f64; 3] {
    [0, 1, 2].map(|i| covariance[(i, i)].sqrt())
}

/// A covariance from its rows.
pub fn matrix(rows: [[f64; 3]; 3]) -> Matrix3 {
    Matrix3::from_fn(|i, j| rows[i][j])
}

/// A solution as arrays by the names of `undrift.Solution`.
pub fn solution<'py>(py: Python<'py>, rows: &[SolutionRow]) -> PyResult<Bound<'py, PyDict>> {
    let std = |from: usize| move |row: &SolutionRow| [0, 1, 2].map(|i| row.nav_std[from + i]);
    let error_std =
        |from: usize| move |row: &SolutionRow| [0, 1, 2].map(|i| row.error_std[from + i]);
    let dict = PyDict::new(py);
    dict.set_item("time", one(py, rows, |row| row.time))?;
    dict.set_item("lat", one(py, rows, |row| row.position.lat))?;
    dict.set_item("lon", one(py, rows, |row| row.position.lon))?;
    dict.set_item("height", one(py, rows, |row| row.position.height))?;
    dict.set_item("velocity", three(py, rows, |row| array(&row.v_n))?)?;
    dict.set_item("rpy", three(py, rows, |row| array(&row.rpy))?)?;
    dict.set_item("position_std", three(py, rows, std(0))?)?;
    dict.set_item("velocity_std", three(py, rows, std(3))?)?;
    dict.set_item("attitude_std", three(py, rows, std(6))?)?;
    dict.set_item("gyro_error", three(py, rows, |row| array(&row.gyro_error))?)?;
    dict.set_item(
        "accel_error",
        three(py, rows, |row| array(&row.accel_error))?,
    )?;
    dict.set_item("gyro_error_std", three(py, rows, error_std(0))?)?;
    dict.set_item("accel_error_std", three(py, rows, error_std(3))?)?;
    Ok(dict)
}
