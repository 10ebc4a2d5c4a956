//! Tests of stationarity, normality and whiteness; correlations and spectra.

use crate::array::{Array, Record, samples};
use crate::error::error;
use numpy::PyReadonlyArray1;
use pyo3::prelude::*;
use undrift::noise::correlation::{self, Partial};
use undrift::noise::normality;
use undrift::noise::screening::{self, Trend};
use undrift::noise::spectrum::{self, Density};
use undrift::noise::whiteness;

#[derive(IntoPyObject)]
pub struct JarqueBera {
    statistic: f64,
    p_value: f64,
    skewness: f64,
    kurtosis_excess: f64,
}

#[pyfunction]
pub fn jarque_bera(py: Python<'_>, x: Record<'_>) -> PyResult<JarqueBera> {
    let x = samples(&x)?;
    let test = py.detach(|| normality::jarque_bera(x)).map_err(error)?;
    Ok(JarqueBera {
        statistic: test.statistic,
        p_value: test.p_value,
        skewness: test.skewness,
        kurtosis_excess: test.kurtosis_excess,
    })
}

#[derive(IntoPyObject)]
pub struct Normality {
    samples: usize,
    mean: f64,
    deviation: f64,
    skewness: f64,
    kurtosis_excess: f64,
    jarque_bera: f64,
    jarque_bera_p: f64,
    distance: f64,
    plain_critical_5: f64,
    plain_p: f64,
    lilliefors_critical_5: f64,
    lilliefors_p: f64,
    quantisation_step: Option<f64>,
    levels: Option<usize>,
}

#[pyfunction]
pub fn normality_tests(py: Python<'_>, x: Record<'_>) -> PyResult<Normality> {
    let x = samples(&x)?;
    let test = py.detach(|| normality::normality(x)).map_err(error)?;
    Ok(Normality {
        samples: test.samples,
        mean: test.mean,
        deviation: test.deviation,
        skewness: test.skewness,
        kurtosis_excess: test.kurtosis_excess,
        jarque_bera: test.jarque_bera.statistic,
        jarque_bera_p: test.jarque_bera.p_value,
        distance: test.ks.statistic,
        plain_critical_5: test.ks.critical_5,
        plain_p: test.ks.p_value,
        lilliefors_critical_5: test.lilliefors.critical_5,
        lilliefors_p: test.lilliefors.p_value,
        quantisation_step: test.quantisation.map(|q| q.step),
        levels: test.quantisation.map(|q| q.levels),
    })
}

#[derive(IntoPyObject)]
pub struct Portmanteau {
    lags: Array<i64>,
    freedom: Array<i64>,
    statistic: Array<f64>,
    p_value: Array<f64>,
    box_pierce: Array<f64>,
    box_pierce_p: Array<f64>,
}

#[pyfunction]
pub fn portmanteau(
    py: Python<'_>,
    x: Record<'_>,
    lags: Vec<usize>,
    fitted: usize,
) -> PyResult<Portmanteau> {
    let x = samples(&x)?;
    let tests = py
        .detach(|| whiteness::portmanteau(x, &lags, fitted))
        .map_err(error)?;
    Ok(Portmanteau {
        lags: tests.iter().map(|t| t.lags as i64).collect(),
        freedom: tests.iter().map(|t| t.freedom as i64).collect(),
        statistic: tests.iter().map(|t| t.ljung_box).collect(),
        p_value: tests.iter().map(|t| t.ljung_box_p).collect(),
        box_pierce: tests.iter().map(|t| t.box_pierce).collect(),
        box_pierce_p: tests.iter().map(|t| t.box_pierce_p).collect(),
    })
}

#[derive(IntoPyObject)]
pub struct Correlations {
    samples: usize,
    lag: Array<i64>,
    value: Array<f64>,
    bound: Array<f64>,
}

/// Values at lags 0, 1, …, with the bounds of lags 1, ….
fn correlations(samples: usize, value: Vec<f64>, bounds: Vec<f64>) -> Correlations {
    Correlations {
        samples,
        lag: (0..value.len() as i64).collect(),
        value: Array(value),
        bound: std::iter::once(f64::NAN).chain(bounds).collect(),
    }
}

#[pyfunction]
pub fn acf(py: Python<'_>, x: Record<'_>, lags: usize) -> PyResult<Correlations> {
    let x = samples(&x)?;
    let values = py
        .detach(|| correlation::autocorrelation(x, lags))
        .map_err(error)?;
    let bounds = correlation::bartlett_bounds(&values, x.len());
    Ok(correlations(x.len(), values, bounds))
}

#[pyfunction]
pub fn pacf(py: Python<'_>, x: Record<'_>, lags: usize, method: &str) -> PyResult<Correlations> {
    let x = samples(&x)?;
    let method = match method {
        "yule-walker" => Partial::YuleWalker,
        "yule-walker-adjusted" => Partial::YuleWalkerAdjusted,
        "burg" => Partial::Burg,
        _ => {
            return Err(error(format!(
                "unknown method {method:?}; available: yule-walker, yule-walker-adjusted, burg"
            )));
        }
    };
    let values = py
        .detach(|| correlation::partial_autocorrelation(x, lags, method))
        .map_err(error)?;
    let bounds = vec![correlation::white_bound(x.len()); lags];
    Ok(correlations(x.len(), values, bounds))
}

#[derive(IntoPyObject)]
pub struct Spectrum {
    frequency: Array<f64>,
    density: Array<f64>,
    segments: usize,
}

#[pyfunction]
pub fn psd(py: Python<'_>, x: Record<'_>, rate: f64, segment: Option<usize>) -> PyResult<Spectrum> {
    let x = samples(&x)?;
    let segment = segment.unwrap_or_else(|| spectrum::default_segment(x.len()));
    let density = py
        .detach(|| spectrum::welch(x, rate, segment))
        .map_err(error)?;
    Ok(Spectrum {
        frequency: Array(density.frequency_hz),
        density: Array(density.density),
        segments: density.segments,
    })
}

#[derive(IntoPyObject)]
pub struct Lines {
    frequency: Array<f64>,
    amplitude: Array<f64>,
    over_median: Array<f64>,
}

#[pyfunction]
pub fn spectral_lines(
    frequency: PyReadonlyArray1<'_, f64>,
    density: PyReadonlyArray1<'_, f64>,
    segments: usize,
    factor: f64,
) -> PyResult<Lines> {
    let density = Density {
        frequency_hz: frequency.as_array().to_vec(),
        density: density.as_array().to_vec(),
        segments,
    };
    if density.frequency_hz.len() != density.density.len() {
        return Err(error("one density is needed for each frequency"));
    }
    let lines = spectrum::peaks(&density, factor);
    Ok(Lines {
        frequency: lines.iter().map(|l| l.frequency_hz).collect(),
        amplitude: lines.iter().map(|l| l.amplitude).collect(),
        over_median: lines.iter().map(|l| l.over_median).collect(),
    })
}

#[derive(IntoPyObject)]
pub struct Detrended {
    residuals: Array<f64>,
    mean: f64,
    slope: f64,
    explained: f64,
}

#[pyfunction]
pub fn detrend(
    py: Python<'_>,
    x: Record<'_>,
    kind: &str,
    temperature: Option<Record<'_>>,
) -> PyResult<Detrended> {
    let x = samples(&x)?;
    let temperature = temperature.as_ref().map(samples).transpose()?;
    let trend = Trend::named(kind).ok_or_else(|| {
        error(format!(
            "unknown trend {kind:?}; available: constant, linear, temperature"
        ))
    })?;
    let plain = py.detach(|| match (trend, temperature) {
        (Trend::Constant, None) => screening::remove_constant(x).map_err(error),
        (Trend::Linear, None) => screening::remove_linear(x).map_err(error),
        (Trend::Temperature, Some(temperature)) => {
            screening::remove_temperature(x, temperature).map_err(error)
        }
        (Trend::Temperature, None) => {
            Err(error("the trend over temperature needs the temperature"))
        }
        (_, Some(_)) => Err(error(format!("a {kind} trend does not use a temperature"))),
    })?;
    Ok(Detrended {
        residuals: Array(plain.residuals),
        mean: plain.mean,
        slope: plain.slope,
        explained: plain.explained,
    })
}
