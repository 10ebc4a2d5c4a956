//! Numbers between Python and Rust.

use numpy::{IntoPyArray, PyArray2, PyArrayMethods, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::Path;
use undrift::{
    io::{table::Columns, write::solution::SolutionRow},
    nav::{Matrix3, Vector3, earth::Geodetic},
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

/// Numbers of every item as arrays by name.
pub struct Arrays<'a, 'py, T> {
    items: &'a [T],
    dict: Bound<'py, PyDict>,
}

impl<'a, 'py, T> Arrays<'a, 'py, T> {
    /// Of items, none yet.
    pub fn new(py: Python<'py>, items: &'a [T]) -> Self {
        Self {
            items,
            dict: PyDict::new(py),
        }
    }

    /// With one number of every item.
    pub fn one(self, name: &str, of: impl Fn(&T) -> f64) -> PyResult<Self> {
        let numbers: Vec<f64> = self.items.iter().map(of).collect();
        let array = numbers.into_pyarray(self.dict.py());
        self.dict.set_item(name, array)?;
        Ok(self)
    }

    /// With three numbers of every item side by side.
    pub fn three(self, name: &str, of: impl Fn(&T) -> [f64; 3]) -> PyResult<Self> {
        let numbers = self.items.iter().flat_map(of).collect();
        self.dict
            .set_item(name, table(self.dict.py(), numbers, 3)?)?;
        Ok(self)
    }

    /// With the nine numbers of a matrix of every item, row by row.
    pub fn nine(self, name: &str, of: impl Fn(&T) -> Matrix3) -> PyResult<Self> {
        let numbers = self.items.iter().flat_map(|item| rows(of(item)).concat());
        let numbers = table(self.dict.py(), numbers.collect(), 9)?;
        self.dict.set_item(name, numbers)?;
        Ok(self)
    }

    /// With latitude, longitude [rad] and height [m] of every item.
    pub fn place(self, of: impl Fn(&T) -> [f64; 3]) -> PyResult<Self> {
        let placed = self.one("lat", |item| of(item)[0])?;
        let placed = placed.one("lon", |item| of(item)[1])?;
        placed.one("height", |item| of(item)[2])
    }

    /// The arrays.
    pub fn dict(self) -> Bound<'py, PyDict> {
        self.dict
    }
}

/// Latitude, longitude and height.
pub fn coordinates(place: &Geodetic) -> [f64; 3] {
    [place.lat, place.lon, place.height]
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

/// The rows of a covariance.
pub fn rows(matrix: Matrix3) -> [[f64; 3]; 3] {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| matrix[(i, j)]))
}

/// A solution as arrays by the names of `undrift.Solution`.
pub fn solution<'py>(py: Python<'py>, rows: &[SolutionRow]) -> PyResult<Bound<'py, PyDict>> {
    let std = |of: &[f64], from: usize| [0, 1, 2].map(|i| of[from + i]);
    let arrays = Arrays::new(py, rows)
        .one("time", |row| row.time)?
        .place(|row| coordinates(&row.position))?
        .three("velocity", |row| array(&row.v_n))?
        .three("rpy", |row| array(&row.rpy))?
        .three("position_std", |row| std(&row.nav_std, 0))?
        .three("velocity_std", |row| std(&row.nav_std, 3))?
        .three("attitude_std", |row| std(&row.nav_std, 6))?
        .three("gyro_error", |row| array(&row.gyro_error))?
        .three("accel_error", |row| array(&row.accel_error))?
        .three("gyro_error_std", |row| std(&row.error_std, 0))?
        .three("accel_error_std", |row| std(&row.error_std, 3))?;
    Ok(arrays.dict())
}
