//! The compiled half of the Python package `undrift`: functions on arrays and files that release the
//! interpreter's lock. The classes that people see are in `python/undrift`.

use pyo3::prelude::*;

mod arrays;
mod drive;
mod error;
mod filter;
mod identify;
mod model;
mod navigate;
mod report;
mod simulate;

#[pymodule]
fn _undrift(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add(
        "UndriftError",
        module.py().get_type::<error::UndriftError>(),
    )?;
    module.add_class::<drive::Drive>()?;
    module.add_class::<filter::Filter>()?;
    module.add_class::<identify::Identified>()?;
    module.add_class::<model::NoiseModel>()?;
    module.add_function(wrap_pyfunction!(drive::told_by_names, module)?)?;
    module.add_function(wrap_pyfunction!(identify::identify, module)?)?;
    module.add_function(wrap_pyfunction!(navigate::navigate, module)?)?;
    module.add_function(wrap_pyfunction!(navigate::outages, module)?)?;
    module.add_function(wrap_pyfunction!(report::make, module)?)?;
    module.add_function(wrap_pyfunction!(simulate::simulate, module)?)?;
    module.add_function(wrap_pyfunction!(simulate::write_csv, module)?)?;
    Ok(())
}
