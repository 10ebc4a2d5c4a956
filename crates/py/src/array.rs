//! Arrays on their way in and out.

use crate::error::error;
use numpy::{Element, IntoPyArray, PyArray1, PyReadonlyArray1, PyReadonlyArrayDyn};
use pyo3::prelude::*;
use std::convert::Infallible;

/// A record of `float64`, read where it lies.
pub type Record<'py> = PyReadonlyArray1<'py, f64>;

/// The samples of a record.
///
/// # Errors
/// Samples that do not lie one after the other.
pub fn samples<'a>(record: &'a Record<'_>) -> PyResult<&'a [f64]> {
    record
        .as_slice()
        .map_err(|_| error("the array is not contiguous"))
}

/// A vector that becomes a numpy array, without a copy.
pub struct Array<T>(pub Vec<T>);

impl<T> FromIterator<T> for Array<T> {
    fn from_iter<I: IntoIterator<Item = T>>(items: I) -> Self {
        Self(items.into_iter().collect())
    }
}

impl<'py, T: Element> IntoPyObject<'py> for Array<T> {
    type Target = PyArray1<T>;
    type Output = Bound<'py, PyArray1<T>>;
    type Error = Infallible;

    fn into_pyobject(self, py: Python<'py>) -> Result<Self::Output, Infallible> {
        Ok(self.0.into_pyarray(py))
    }
}

/// Of an array of any shape, row by row, or of a list.
impl<'py> FromPyObject<'_, 'py> for Array<f64> {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        match object.extract::<PyReadonlyArrayDyn<'py, f64>>() {
            Ok(array) => Ok(array.as_array().iter().copied().collect()),
            Err(_) => object.extract().map(Self),
        }
    }
}
