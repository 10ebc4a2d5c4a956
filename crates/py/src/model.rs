//! Noise models.

use crate::{columns, error::error, work};
use numpy::{PyArray2, ToPyArray};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use std::path::{Path, PathBuf};
use undrift::{
    io::write::write_whole,
    nav::shaping::ShapingFilter,
    noise::{AxisModel, BiasModel, ImuModel, ModelFormat, model_file},
    simulate::SensorErrors,
};

/// The noise model of an IMU; `undrift.NoiseModel` wraps it.
#[pyclass(frozen, module = "undrift._undrift")]
pub struct NoiseModel(pub ImuModel);

/// A bias model by its name.
pub fn bias_model(name: &str) -> PyResult<BiasModel> {
    name.parse::<BiasModel>().map_err(error)
}

/// An axis with its terms, where they are known.
pub type NamedTerms<'py> = (&'static str, Option<Bound<'py, PyDict>>);

#[pymethods]
impl NoiseModel {
    /// A preset, or a model file.
    #[staticmethod]
    fn load(name_or_path: PathBuf) -> PyResult<Self> {
        let name = name_or_path.to_string_lossy();
        ImuModel::resolve(&name, Path::new(""))
            .map(Self)
            .map_err(error)
    }

    /// From a model file's text; `file` is what messages call it.
    #[staticmethod]
    fn from_toml(text: &str, file: &str) -> PyResult<Self> {
        ImuModel::from_toml(text, file).map(Self).map_err(error)
    }

    /// Names of the presets.
    #[staticmethod]
    fn presets() -> Vec<&'static str> {
        ImuModel::preset_names().to_vec()
    }

    #[getter]
    fn name(&self) -> &str {
        &self.0.name
    }

    #[getter]
    fn source(&self) -> &str {
        &self.0.source
    }

    /// Text of the model file.
    fn to_toml(&self) -> String {
        self.0.to_toml()
    }

    /// Writes the model file.
    fn save(&self, path: PathBuf) -> PyResult<()> {
        write(&path, &self.0.to_toml())
    }

    /// The model as other programs read it.
    #[pyo3(signature = (format, rate=None))]
    fn export(&self, format: &str, rate: Option<f64>) -> PyResult<String> {
        let format: ModelFormat = format.parse().map_err(error)?;
        self.0.export(format, rate).map_err(error)
    }

    /// The six axes in order: name, and what is known of it, `None` where nothing is.
    fn axes<'py>(&self, py: Python<'py>) -> PyResult<Vec<NamedTerms<'py>>> {
        let axes = self.0.axes().into_iter();
        axes.map(|(name, axis)| Ok((name, axis.is_known().then(|| terms(py, axis)).transpose()?)))
            .collect()
    }

    /// The shaping filters of the six axes at a rate [Hz].
    fn shaping<'py>(
        &self,
        py: Python<'py>,
        bias_model: &str,
        rate: f64,
    ) -> PyResult<Bound<'py, PyList>> {
        let filters = self.filters(bias_model, rate)?;
        let dicts = filters
            .iter()
            .map(|filter| matrices(py, filter))
            .collect::<PyResult<Vec<_>>>()?;
        PyList::new(py, dicts)
    }

    /// `count` samples of the errors of the six axes at a rate [Hz], side by side.
    fn simulate<'py>(
        &self,
        py: Python<'py>,
        count: usize,
        rate: f64,
        bias_model: &str,
        seed: u64,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let filters = self.filters(bias_model, rate)?;
        if count as u64 > undrift::simulate::MAX_SAMPLES {
            return Err(error(undrift::simulate::SimulationError::TooLong));
        }
        let drawn = work::run(py, || {
            let mut errors = SensorErrors::new(&filters, rate, seed)?;
            let draw = (0..count).flat_map(|_| {
                undrift::noise::interrupt::check();
                errors.draw()
            });
            Ok::<_, undrift::simulate::SimulationError>(draw.collect())
        })?;
        columns::table(py, drawn.map_err(error)?, 6)
    }
}

impl NoiseModel {
    /// The shaping filters of a bias model at a rate [Hz].
    pub fn filters(&self, bias: &str, rate: f64) -> PyResult<[ShapingFilter; 6]> {
        if !(rate > 0.0 && rate.is_finite()) {
            return Err(error(undrift::noise::ModelError::BadRate(rate)));
        }
        self.0.shaping(bias_model(bias)?, 1.0 / rate).map_err(error)
    }
}

/// What is known of an axis, by the names of `undrift.AxisNoise`.
fn terms<'py>(py: Python<'py>, axis: &AxisModel) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    let AxisModel {
        turn_on,
        white,
        quantisation,
        instability,
        random_walk,
        arma,
        paper_sigma,
        lines: _,
        temperature,
        identification: _,
    } = axis;
    let sigmas: Vec<f64> = instability.iter().map(|of| of.sigma).collect();
    let taus: Vec<f64> = instability.iter().map(|of| of.tau_s).collect();
    dict.set_item("white_noise", white)?;
    dict.set_item("bias_instability", sigmas)?;
    dict.set_item("correlation_time", taus)?;
    dict.set_item("random_walk", random_walk)?;
    dict.set_item("quantisation", quantisation)?;
    dict.set_item("turn_on", turn_on)?;
    dict.set_item("paper_sigma", paper_sigma)?;
    let arma = arma.as_ref().map(
        |model_file::Arma {
             ar,
             ma,
             sigma,
             rate_hz,
         }| { (ar.clone(), ma.clone(), *sigma, *rate_hz) },
    );
    dict.set_item("arma", arma)?;
    let temperature = temperature.as_ref().map(|of| {
        let range = (of.range_c[0], of.range_c[1]);
        let slope = (of.slope, of.slope_sigma);
        (
            of.reference_c,
            range,
            slope,
            (of.quadratic, of.quadratic_sigma),
        )
    });
    dict.set_item("temperature", temperature)?;
    Ok(dict)
}

/// The matrices of a shaping filter, by the names of `undrift.Shaping`.
fn matrices<'py>(py: Python<'py>, filter: &ShapingFilter) -> PyResult<Bound<'py, PyDict>> {
    let n = filter.order;
    let square = |m: &[[f64; 6]; 6]| -> PyResult<_> {
        let rows: Vec<f64> = m[..n].iter().flat_map(|row| row[..n].to_vec()).collect();
        numpy::PyArrayMethods::reshape(&numpy::IntoPyArray::into_pyarray(rows, py), [n, n])
    };
    let dict = PyDict::new(py);
    dict.set_item("f", square(&filter.f)?)?;
    dict.set_item("h", filter.h[..n].to_pyarray(py))?;
    dict.set_item("q", square(&filter.q)?)?;
    dict.set_item("s", filter.s[..n].to_pyarray(py))?;
    dict.set_item("r", filter.r)?;
    dict.set_item("p0", square(&filter.p0)?)?;
    dict.set_item("interval", filter.interval)?;
    Ok(dict)
}

/// Writes a text that appears whole or not at all.
pub fn write(path: &Path, text: &str) -> PyResult<()> {
    write_whole(path, text).map_err(|e| error(format!("cannot write {}: {e}", path.display())))
}
