//! The compiled half of the Python package `undrift`: functions on arrays and files that release the
//! interpreter's lock. The classes that people see are in `python/undrift`.

use pyo3::prelude::*;

mod allan;
mod arma;
mod array;
mod error;
mod fleet;
mod stationarity;
mod statistics;

#[pymodule]
fn _undrift(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add(
        "UndriftError",
        module.py().get_type::<error::UndriftError>(),
    )?;
    allan::register(module)?;
    stationarity::register(module)?;
    statistics::register(module)?;
    arma::register(module)?;
    fleet::register(module)
}
