//! The compiled half of the Python package `undrift`: functions on arrays and files that release the
//! interpreter's lock. The classes that people see are in `python/undrift`.

use pyo3::prelude::*;

mod allan;
mod arma;
mod array;
mod columns;
mod drive;
mod error;
mod filter;
mod fleet;
mod identify;
mod model;
mod navigate;
mod orders;
mod report;
mod simulate;
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
    orders::register(module)?;
    model::register(module)?;
    identify::register(module)?;
    simulate::register(module)?;
    drive::register(module)?;
    navigate::register(module)?;
    report::register(module)?;
    filter::register(module)?;
    fleet::register(module)
}
