//! Unit-root tests and their verdict.

use crate::array::{Record, samples};
use crate::error::error;
use pyo3::prelude::*;
use undrift::noise::screening::RecordError;
use undrift::noise::stationarity::{self, Conclusion, Deterministic, KpssLags, Lags};
use undrift_report::say;

/// A number of lags, or the name of the rule that chooses it.
#[derive(FromPyObject)]
pub enum Rule {
    Fixed(usize),
    Named(String),
}

#[derive(IntoPyObject)]
pub struct Critical {
    #[pyo3(item("1%"))]
    one: f64,
    #[pyo3(item("5%"))]
    five: f64,
    #[pyo3(item("10%"))]
    ten: f64,
}

impl From<stationarity::Critical> for Critical {
    fn from(critical: stationarity::Critical) -> Self {
        Self {
            one: critical.one,
            five: critical.five,
            ten: critical.ten,
        }
    }
}

#[derive(IntoPyObject)]
pub struct Adf {
    statistic: f64,
    p_value: f64,
    lags: usize,
    observations: usize,
    critical: Critical,
    criterion: Option<f64>,
}

impl From<stationarity::Adf> for Adf {
    fn from(test: stationarity::Adf) -> Self {
        Self {
            statistic: test.statistic,
            p_value: test.p_value,
            lags: test.lags,
            observations: test.observations,
            critical: test.critical.into(),
            criterion: test.criterion,
        }
    }
}

#[derive(IntoPyObject)]
pub struct Kpss {
    statistic: f64,
    p_value: f64,
    p_is_bound: bool,
    lags: usize,
    critical: Critical,
}

impl From<stationarity::Kpss> for Kpss {
    fn from(test: stationarity::Kpss) -> Self {
        Self {
            statistic: test.statistic,
            p_value: test.p_value,
            p_is_bound: test.p_is_bound,
            lags: test.lags,
            critical: test.critical.into(),
        }
    }
}

#[derive(IntoPyObject)]
pub struct PhillipsPerron {
    statistic: f64,
    p_value: f64,
    rho_statistic: f64,
    lags: usize,
    observations: usize,
    critical: Critical,
}

impl From<stationarity::PhillipsPerron> for PhillipsPerron {
    fn from(test: stationarity::PhillipsPerron) -> Self {
        Self {
            statistic: test.z_tau,
            p_value: test.p_value,
            rho_statistic: test.z_rho,
            lags: test.lags,
            observations: test.observations,
            critical: test.critical.into(),
        }
    }
}

#[derive(IntoPyObject)]
pub struct Verdict {
    conclusion: &'static str,
    sentence: String,
    adf: Adf,
    kpss: Kpss,
    phillips_perron: PhillipsPerron,
}

fn deterministic(regression: &str) -> PyResult<Deterministic> {
    match regression {
        "n" => Ok(Deterministic::None),
        "c" => Ok(Deterministic::Constant),
        "ct" => Ok(Deterministic::Trend),
        _ => Err(error(format!(
            "unknown regression {regression:?}; available: n (none), c (constant), ct (constant and trend)"
        ))),
    }
}

#[pyfunction]
pub fn adf(
    py: Python<'_>,
    x: Record<'_>,
    regression: &str,
    lags: Rule,
    max_lags: Option<usize>,
) -> PyResult<Adf> {
    let x = samples(&x)?;
    let regression = deterministic(regression)?;
    let lags = match lags {
        Rule::Fixed(count) => Lags::Fixed(count),
        Rule::Named(name) => match name.as_str() {
            "aic" => Lags::Aic(max_lags),
            "bic" => Lags::Bic(max_lags),
            "t-stat" => Lags::LastSignificant(max_lags),
            _ => {
                return Err(error(format!(
                    "unknown lag rule {name:?}; available: aic, bic, t-stat or a number"
                )));
            }
        },
    };
    py.detach(|| stationarity::adf(x, regression, lags))
        .map(Adf::from)
        .map_err(error)
}

#[pyfunction]
pub fn kpss(py: Python<'_>, x: Record<'_>, regression: &str, lags: Rule) -> PyResult<Kpss> {
    let x = samples(&x)?;
    let regression = deterministic(regression)?;
    let lags = match lags {
        Rule::Fixed(count) => KpssLags::Fixed(count),
        Rule::Named(name) => match name.as_str() {
            "auto" => KpssLags::Auto,
            "legacy" => KpssLags::Legacy,
            "long" => KpssLags::Long,
            "short" => KpssLags::Short,
            _ => {
                return Err(error(format!(
                    "unknown lag rule {name:?}; available: auto, legacy, long, short or a number"
                )));
            }
        },
    };
    py.detach(|| stationarity::kpss(x, regression, lags))
        .map(Kpss::from)
        .map_err(error)
}

#[pyfunction]
pub fn phillips_perron(
    py: Python<'_>,
    x: Record<'_>,
    regression: &str,
    lags: Option<usize>,
) -> PyResult<PhillipsPerron> {
    let x = samples(&x)?;
    let regression = deterministic(regression)?;
    py.detach(|| stationarity::phillips_perron(x, regression, lags))
        .map(PhillipsPerron::from)
        .map_err(error)
}

#[pyfunction]
pub fn verdict(
    py: Python<'_>,
    x: Record<'_>,
    lags: usize,
    ma_root: Option<f64>,
) -> PyResult<Verdict> {
    let x = samples(&x)?;
    let constant = Deterministic::Constant;
    let (adf, kpss, phillips_perron) = py
        .detach(|| {
            Ok::<_, RecordError>((
                stationarity::adf(x, constant, Lags::Fixed(lags))?,
                stationarity::kpss(x, constant, KpssLags::Legacy)?,
                stationarity::phillips_perron(x, constant, None)?,
            ))
        })
        .map_err(error)?;
    let verdict = stationarity::verdict(&adf, &kpss, &phillips_perron, ma_root);
    Ok(Verdict {
        conclusion: match verdict.conclusion {
            Conclusion::Stationary => "stationary",
            Conclusion::UnitRoot => "unit root",
            Conclusion::Conflict => "conflict",
            Conclusion::Undecided => "undecided",
            Conclusion::NothingSlowSeen => "no slow part detected",
            Conclusion::SlowPartSeen => "slow part detected",
        },
        sentence: say::stationarity(&verdict),
        adf: adf.into(),
        kpss: kpss.into(),
        phillips_perron: phillips_perron.into(),
    })
}
