//! From a static record of one axis to a noise model: screening, tests, Allan variance, ARMA,
//! candidates scored by the drift they leave, a recommendation.
//!
//! `docs/theory.md`, sections 1 and 6: the order of the source paper's part 1, and beyond it the choice by the
//! prediction error of the integrated signal on the half of the record that was not fitted.

mod axis;
mod candidates;
mod remarks;
mod residuals;

pub use axis::{Axis, Candidate, Origin};
pub use residuals::Residuals;

use crate::{
    allan::{self, DeviationKind, Grid},
    correlation::{self, Partial},
    drift_score::{self, HORIZONS_S, Scored},
    normality,
    screening::{self, Detrended, MotionRule, OutlierRule, RecordError, Trend},
    spectrum,
    stationarity::{self, Deterministic, KpssLags, Lags},
    whiteness,
};
use serde::{Deserialize, Serialize};
use undrift_nav::earth::STANDARD_GRAVITY;

/// Lags of the autocorrelations reported.
pub const LAGS: usize = 100;
/// Longest record that a search over orders sees; of a longer one its start, for time. The chosen
/// orders are then fitted to the whole half.
pub const SEARCH_SAMPLES: usize = 50_000;
/// Longest record that orders above (1,1) are fitted to: their short memory needs no more.
pub const HIGH_ORDER_SAMPLES: usize = 200_000;
/// Shortest record that is identified \[samples\].
pub const SHORTEST: usize = 1000;
/// Largest p and q of the grid of orders in [`Axis::box_jenkins`].
pub const GRID_ORDER: usize = 3;
/// Lags of the augmented Dickey-Fuller test; the most that its rules choose from.
const ADF_LAGS: usize = 20;
/// Equal samples in a row that a sensor at work does not give.
const HANGING: usize = 1000;
/// Quantisation steps above this share of the standard deviation are tried as a term: rounding of
/// the integrated signal would then be more than 1 % of the variance of a sample, step²/6.
const COARSE: f64 = 0.25;
/// A spectral line stands out of its neighbourhood's median by this factor.
const LINE_FACTOR: f64 = 10.0;

/// What was taken out beside the mean, by least squares over the whole record.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum Detrend {
    /// Nothing.
    #[default]
    Constant,
    /// A straight line.
    Linear {
        /// Its slope \[unit/h\].
        slope_per_hour: f64,
        /// Share of the variance that it explains.
        explained: f64,
    },
    /// A multiple of the temperature.
    Temperature {
        /// The multiple \[unit/K\].
        slope_per_kelvin: f64,
        /// Share of the variance that it explains.
        explained: f64,
    },
}

/// What is identified, and how much is tried.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options<'a> {
    /// Sample rate \[Hz\].
    pub rate_hz: f64,
    /// Largest n of ARMA(2n, 2n−1) in the Pandit-Wu table.
    pub n_max: usize,
    /// What is taken out first.
    pub trend: Trend,
    /// Temperature \[°C or K\], one a sample; without it [`Trend::Temperature`] takes the mean out alone.
    pub temperature: Option<&'a [f64]>,
}

impl Options<'_> {
    /// At a sample rate \[Hz\]: n up to 2, the mean taken out.
    pub fn at(rate_hz: f64) -> Self {
        Self {
            rate_hz,
            n_max: 2,
            trend: Trend::Constant,
            temperature: None,
        }
    }
}

/// Why a record has no model.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum IdentifyError {
    /// The record cannot be used.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// The temperature cannot be used.
    #[error("the temperature cannot be used: {0}")]
    Temperature(RecordError),
    /// No horizon fits into the half that is scored.
    #[error("{seconds:.1} s are too short to see a drift: record at least {needed:.0} s")]
    TooBrief {
        /// Length of the record \[s\].
        seconds: f64,
        /// Length needed \[s\].
        needed: f64,
    },
    /// No candidate could be fitted.
    #[error("no model could be fitted to the record")]
    NoCandidate,
    /// The sample rate is not one.
    #[error("the sample rate must be above 0 Hz")]
    Rate,
}

/// The constant seen, as the best single guess of what a turn-on may bring [unit]: for an
/// accelerometer that stands upright, what it reads beyond gravity.
fn turn_on_of(mean: f64, accelerometer: bool) -> f64 {
    if accelerometer && mean.abs() > 0.5 * STANDARD_GRAVITY {
        (mean.abs() - STANDARD_GRAVITY).abs()
    } else {
        mean.abs()
    }
}

/// The record less its trend, and what that was.
fn detrended(record: &[f64], options: &Options<'_>) -> Result<(Detrended, Detrend), IdentifyError> {
    // What is constant has no trend: an error of its own.
    screening::record::check_varying(record, SHORTEST)?;
    Ok(match (options.trend, options.temperature) {
        (Trend::Linear, _) => {
            let plain = screening::remove_linear(record)?;
            let removed = Detrend::Linear {
                slope_per_hour: plain.slope * (options.rate_hz * 3600.0),
                explained: plain.explained,
            };
            (plain, removed)
        }
        (Trend::Temperature, Some(temperature)) => {
            let plain = screening::remove_temperature(record, temperature);
            let plain = plain.map_err(IdentifyError::Temperature)?;
            let removed = Detrend::Temperature {
                slope_per_kelvin: plain.slope,
                explained: plain.explained,
            };
            (plain, removed)
        }
        _ => (screening::remove_constant(record)?, Detrend::Constant),
    })
}

/// Horizons that fit four times into half a record of so many samples \[s\].
fn horizons(samples: usize, rate_hz: f64) -> Result<Vec<f64>, IdentifyError> {
    let half = (samples / 2) as f64 / rate_hz;
    let (sample, shortest) = (1.0 / rate_hz, HORIZONS_S[0]);
    let fitting: Vec<f64> = HORIZONS_S
        .into_iter()
        .filter(|h| half > 4.0 * h && *h >= sample)
        .collect();
    if fitting.is_empty() {
        return Err(IdentifyError::TooBrief {
            seconds: samples as f64 / rate_hz,
            needed: 10.0 * shortest.max(sample),
        });
    }
    Ok(fitting)
}

/// Identifies one axis: `record` in SI units, evenly sampled. `accelerometer` tells what the mean means.
///
/// # Errors
/// A record that is too short (fewer than 1000 samples), constant or not finite; one too brief for
/// any horizon; a temperature that does not fit the record.
pub fn identify(
    record: &[f64],
    accelerometer: bool,
    options: &Options<'_>,
) -> Result<Axis, IdentifyError> {
    if !(options.rate_hz > 0.0 && options.rate_hz.is_finite()) {
        return Err(IdentifyError::Rate);
    }
    if record.len() < SHORTEST {
        return Err(RecordError::TooShort {
            needed: SHORTEST,
            got: record.len(),
        }
        .into());
    }
    let mut warnings = Vec::new();
    let horizons_s = horizons(record.len(), options.rate_hz)?;
    let (plain, removed) = detrended(record, options)?;
    let found = screening::outliers(&plain.residuals, OutlierRule::default())?;
    let bridged = bridge(&found.cleaned);
    let rate = options.rate_hz;
    let window = (rate.round() as usize).max(2);
    let motion = screening::motion(
        &bridged,
        MotionRule {
            window,
            ..MotionRule::default()
        },
    )
    .ok();
    let saturation = screening::saturation(record);
    let hanging = screening::constant_runs(record, HANGING);
    warnings.extend(remarks::of_record(
        motion.as_ref(),
        &saturation,
        &hanging,
        &found.outliers,
        record.len(),
        rate,
    ));

    let adf = stationarity::adf(&bridged, Deterministic::Constant, Lags::Fixed(ADF_LAGS))?;
    let by = |name, lags| {
        stationarity::adf(&bridged, Deterministic::Constant, lags).map(|test| (name, test))
    };
    let adf_chosen = vec![
        by("aic", Lags::Aic(Some(ADF_LAGS)))?,
        by("bic", Lags::Bic(Some(ADF_LAGS)))?,
        by("last_significant", Lags::LastSignificant(Some(ADF_LAGS)))?,
    ];
    let kpss = stationarity::kpss(&bridged, Deterministic::Constant, KpssLags::Legacy)?;
    let phillips_perron = stationarity::phillips_perron(&bridged, Deterministic::Constant, None)?;
    let mut normality = normality::normality(&bridged)?;
    // Bridged, or less a trend, the samples no longer lie on their grid.
    normality.quantisation = normality::quantisation(record);
    let acf = correlation::autocorrelation(&bridged, LAGS)?;
    let pacf = correlation::partial_autocorrelation(&bridged, LAGS, Partial::YuleWalker)?;
    let whiteness = whiteness::portmanteau(&bridged, &[20], 0)?[0];
    let segment = spectrum::default_segment(record.len());
    let psd = spectrum::welch(&bridged, rate, segment)?;
    let lines = spectrum::lines(&psd, LINE_FACTOR);
    let curve = allan::deviations(&bridged, rate, DeviationKind::Overlapping, Grid::Octave)?;
    let allan_intervals = allan::intervals(&bridged, &curve, 0.683)?;
    let allan_terms = allan::fit_terms(&curve)?;
    let allan_gauss_markov = allan::fit_gauss_markov(&curve).ok();

    let coarse = normality
        .quantisation
        .is_some_and(|q| q.step_over_deviation > COARSE);
    let half = candidates::Half {
        record: &found.cleaned,
        first: record.len() / 2,
        rate_hz: rate,
        turn_on: turn_on_of(plain.mean, accelerometer),
        horizons: horizons_s,
        quantised: coarse || allan_terms.quantisation.seen,
    };
    let candidates::Tried {
        pandit_wu,
        box_jenkins,
        scales,
        candidates,
    } = candidates::candidates(&half, options.n_max, &allan_terms);
    let scored: Vec<Scored> = candidates
        .iter()
        .map(|c| Scored {
            name: c.name.clone(),
            states: c.states,
            parameters: c.parameters,
            horizons: c.score.clone(),
        })
        .collect();
    let Some(recommended) = drift_score::recommend(&scored) else {
        return Err(IdentifyError::NoCandidate);
    };
    let chosen = &candidates[recommended.index];
    warnings.extend(
        chosen
            .warnings
            .iter()
            .map(|warning| format!("{}: {warning}", chosen.name)),
    );
    let ma_root = candidates
        .iter()
        .filter_map(Candidate::arma)
        .find(|fit| fit.order() == (1, 1))
        .and_then(|fit| fit.ma.first().copied());
    let by_f = pandit_wu.as_ref().and_then(|table| table.fit(table.by_f));
    let recommended_arma = chosen
        .arma()
        .filter(|fit| by_f.is_none_or(|by_f| by_f.order() != fit.order()));
    let residuals = by_f
        .into_iter()
        .chain(recommended_arma)
        .filter_map(|fit| residuals::residuals(fit, &found.cleaned[..record.len() / 2]))
        .collect();
    Ok(Axis {
        samples: record.len(),
        mean: plain.mean,
        removed,
        stationarity: stationarity::verdict(&adf, &kpss, &phillips_perron, ma_root),
        outliers: found.outliers,
        motion,
        saturation,
        hanging,
        adf,
        adf_chosen,
        kpss,
        phillips_perron,
        normality,
        acf,
        pacf,
        whiteness,
        psd,
        lines,
        allan: curve,
        allan_intervals,
        allan_terms,
        allan_gauss_markov,
        pandit_wu,
        box_jenkins,
        residuals,
        scales,
        chosen: recommended.index,
        reason: recommended.reason,
        candidates,
        warnings,
    })
}

/// Missing samples replaced by the straight line between their neighbours.
fn bridge(cleaned: &[f64]) -> Vec<f64> {
    let mut whole = cleaned.to_vec();
    let mut last: Option<usize> = None;
    let mut at = 0;
    while at < whole.len() {
        if whole[at].is_nan() {
            at += 1;
            continue;
        }
        if let Some(from) = last
            && at - from > 1
        {
            let (a, b) = (whole[from], whole[at]);
            for k in from + 1..at {
                whole[k] = a + (b - a) * (k - from) as f64 / (at - from) as f64;
            }
        }
        last = Some(at);
        at += 1;
    }
    // Missing at either end: the mean.
    for value in whole.iter_mut().filter(|v| v.is_nan()) {
        *value = 0.0;
    }
    whole
}
