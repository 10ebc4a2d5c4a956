//! Allan and wavelet variance.

use crate::array::{Array, Record, samples};
use crate::{error::error, work};
use numpy::PyReadonlyArray1;
use pyo3::prelude::*;
use undrift::noise::allan::{
    self, Curve, DeviationKind, GaussMarkovFit, Grid, Interval, Point, Term, Terms,
};
use undrift::noise::screening::RecordError;
use undrift::noise::wavelet;

/// Averaging times: the name of a grid, or times [s].
#[derive(FromPyObject)]
pub enum Taus<'py> {
    Grid(String),
    Times(Record<'py>),
}

#[derive(IntoPyObject)]
pub struct Deviations {
    samples: usize,
    m: Array<i64>,
    tau: Array<f64>,
    deviation: Array<f64>,
    n: Array<i64>,
    noise_type: Option<Array<i64>>,
    edf: Option<Array<f64>>,
    lower: Option<Array<f64>>,
    upper: Option<Array<f64>>,
}

fn kind_of(name: &str) -> PyResult<DeviationKind> {
    match name {
        "overlapping" => Ok(DeviationKind::Overlapping),
        "modified" => Ok(DeviationKind::Modified),
        "hadamard" => Ok(DeviationKind::Hadamard),
        "total" => Ok(DeviationKind::Total),
        _ => Err(error(format!(
            "unknown deviation {name:?}; available: overlapping, modified, hadamard, total"
        ))),
    }
}

#[pyfunction]
pub fn allan_deviation(
    py: Python<'_>,
    x: Record<'_>,
    rate: f64,
    kind: &str,
    taus: Taus<'_>,
    confidence: Option<f64>,
) -> PyResult<Deviations> {
    let rates = samples(&x)?;
    let kind = kind_of(kind)?;
    let largest = kind.largest_m(rates.len());
    let factors = match taus {
        Taus::Times(times) => allan::factors_of(samples(&times)?, rate).map_err(error)?,
        Taus::Grid(name) => match name.as_str() {
            "octave" => Grid::Octave,
            "decade" => Grid::Decade,
            "all" => Grid::All,
            _ => {
                return Err(error(format!(
                    "unknown grid of averaging times {name:?}; available: octave, decade, all"
                )));
            }
        }
        .factors(largest),
    };
    let (curve, intervals) = work::run(py, || {
        let curve = allan::deviations_at(rates, rate, kind, &factors)?;
        let intervals = confidence
            .map(|level| allan::intervals(rates, &curve, level))
            .transpose()?;
        Ok::<_, RecordError>((curve, intervals))
    })?
    .map_err(error)?;
    let intervals = intervals.as_deref();
    let bound = |of: fn(&Interval) -> f64| intervals.map(|i| i.iter().map(of).collect());
    Ok(Deviations {
        samples: curve.samples,
        m: curve.points.iter().map(|p| p.m as i64).collect(),
        tau: curve.points.iter().map(|p| p.tau_s).collect(),
        deviation: curve.points.iter().map(|p| p.deviation).collect(),
        n: curve.points.iter().map(|p| p.terms as i64).collect(),
        noise_type: intervals.map(|i| i.iter().map(|i| i64::from(i.alpha)).collect()),
        edf: bound(|i| i.edf),
        lower: bound(|i| i.lower),
        upper: bound(|i| i.upper),
    })
}

/// A curve as the package holds it.
#[derive(FromPyObject)]
pub struct PyCurve<'py> {
    kind: String,
    rate: f64,
    samples: usize,
    m: PyReadonlyArray1<'py, i64>,
    tau: Record<'py>,
    deviation: Record<'py>,
    n: PyReadonlyArray1<'py, i64>,
}

impl PyCurve<'_> {
    fn curve(&self) -> PyResult<Curve> {
        let (m, tau, deviation, n) = (
            self.m.as_array(),
            self.tau.as_array(),
            self.deviation.as_array(),
            self.n.as_array(),
        );
        let points = m.iter().zip(tau).zip(deviation).zip(n);
        let points = points.map(|(((&m, &tau_s), &deviation), &terms)| {
            Some(Point {
                m: usize::try_from(m).ok()?,
                tau_s,
                deviation,
                terms: usize::try_from(terms).ok()?,
            })
        });
        Ok(Curve {
            kind: kind_of(&self.kind)?,
            rate_hz: self.rate,
            samples: self.samples,
            points: points
                .collect::<Option<_>>()
                .ok_or_else(|| error("a number of samples is negative"))?,
        })
    }
}

#[derive(FromPyObject, IntoPyObject)]
pub struct PyTerm {
    value: f64,
    standard_error: f64,
    upper_95: f64,
    seen: bool,
}

impl From<Term> for PyTerm {
    fn from(term: Term) -> Self {
        Self {
            value: term.value,
            standard_error: term.standard_error,
            upper_95: term.upper_95,
            seen: term.seen,
        }
    }
}

#[derive(FromPyObject, IntoPyObject)]
pub struct PyTerms {
    quantisation: PyTerm,
    white: PyTerm,
    bias_instability: PyTerm,
    random_walk: PyTerm,
    ramp: PyTerm,
    shortest_tau: f64,
    white_variance: f64,
    reduced_chi2: f64,
}

impl From<Terms> for PyTerms {
    fn from(terms: Terms) -> Self {
        Self {
            quantisation: terms.quantisation.into(),
            white: terms.white.into(),
            bias_instability: terms.bias_instability.into(),
            random_walk: terms.random_walk.into(),
            ramp: terms.ramp.into(),
            shortest_tau: terms.from_s,
            white_variance: terms.white_variance,
            reduced_chi2: terms.reduced_chi2,
        }
    }
}

impl From<PyTerms> for Terms {
    /// With what a variance is made of.
    fn from(terms: PyTerms) -> Self {
        let term = |term: PyTerm| Term {
            value: term.value,
            ..Term::default()
        };
        Self {
            quantisation: term(terms.quantisation),
            white: term(terms.white),
            bias_instability: term(terms.bias_instability),
            random_walk: term(terms.random_walk),
            ramp: term(terms.ramp),
            ..Self::default()
        }
    }
}

#[pyfunction]
pub fn allan_terms(
    py: Python<'_>,
    curve: PyCurve<'_>,
    shortest_tau: Option<f64>,
) -> PyResult<PyTerms> {
    let curve = curve.curve()?;
    work::run(py, || match shortest_tau {
        None => allan::fit_terms(&curve),
        Some(shortest) => allan::fit_terms_from(&curve, shortest),
    })?
    .map(PyTerms::from)
    .map_err(error)
}

#[pyfunction]
pub fn allan_terms_variance(terms: PyTerms, tau: Record<'_>) -> Array<f64> {
    let terms = Terms::from(terms);
    let tau = tau.as_array();
    tau.iter().map(|&tau| terms.variance(tau)).collect()
}

#[derive(IntoPyObject)]
pub struct GaussMarkov {
    quantisation: f64,
    white: f64,
    sigma: f64,
    correlation_time: f64,
    reduced_chi2: f64,
    at_limit: bool,
}

#[pyfunction]
pub fn allan_gauss_markov(py: Python<'_>, curve: PyCurve<'_>) -> PyResult<GaussMarkov> {
    let curve = curve.curve()?;
    let fit: GaussMarkovFit = work::run(py, || allan::fit_gauss_markov(&curve))?.map_err(error)?;
    Ok(GaussMarkov {
        quantisation: fit.quantisation,
        white: fit.white,
        sigma: fit.sigma,
        correlation_time: fit.tau_c_s,
        reduced_chi2: fit.reduced_chi2,
        at_limit: fit.at_limit,
    })
}

#[derive(IntoPyObject)]
pub struct Wavelet {
    samples: usize,
    m: Array<i64>,
    scale: Array<f64>,
    variance: Array<f64>,
    edf: Array<f64>,
    n: Array<i64>,
}

#[pyfunction]
pub fn wavelet_variance(py: Python<'_>, x: Record<'_>, rate: f64) -> PyResult<Wavelet> {
    let record = samples(&x)?;
    let curve = py
        .detach(|| wavelet::wavelet_variance(record, 1.0 / rate))
        .map_err(error)?;
    Ok(Wavelet {
        samples: curve.samples,
        m: curve.points.iter().map(|p| p.m as i64).collect(),
        scale: curve.points.iter().map(|p| p.scale_s).collect(),
        variance: curve.points.iter().map(|p| p.variance).collect(),
        edf: curve.points.iter().map(|p| p.edf).collect(),
        n: curve.points.iter().map(|p| p.coefficients as i64).collect(),
    })
}
