//! From a static record of one axis to a noise model: screening, tests, Allan variance, ARMA,
//! candidates scored by the drift they leave, a recommendation.
//!
//! `docs/theory.md`, sections 1 and 6: the order of the source paper's part 1, and beyond it the choice by the
//! prediction error of the integrated signal on the half of the record that was not fitted.

mod candidates;

use crate::{
    allan::{self, Curve, GaussMarkovFit, Grid, Interval, Kind, Terms},
    arma::ArmaFit,
    correlation::{self, Partial},
    drift_score::{self, HORIZONS_S, HorizonScore, Scored},
    model_file::AxisModel,
    normality::{self, Normality},
    pandit_wu::PanditWu,
    screening::{self, Motion, MotionRule, Outlier, OutlierRule, RecordError},
    spectrum::{self, Density, Line},
    stationarity::{self, Adf, Deterministic, Kpss, KpssLags, Lags, PhillipsPerron, Verdict},
    whiteness::{self, Portmanteau},
};
use undrift_nav::earth::STANDARD_GRAVITY;

/// Lags of the autocorrelations reported.
pub const LAGS: usize = 100;
/// Longest record that a search over orders sees; of a longer one its start, for time. The chosen
/// orders are then fitted to the whole half.
pub const SEARCH_SAMPLES: usize = 50_000;
/// Longest record that orders above (1,1) are fitted to: their short memory needs no more.
pub const HIGH_ORDER_SAMPLES: usize = 200_000;
/// Shortest record that is identified [samples].
pub const SHORTEST: usize = 1000;
/// Lags of the augmented Dickey-Fuller test.
const ADF_LAGS: usize = 20;
/// A spectral line stands out of its neighbourhood's median by this factor.
const LINE_FACTOR: f64 = 10.0;

/// What is identified, and how much is tried.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Sample rate [Hz].
    pub rate_hz: f64,
    /// Largest n of ARMA(2n, 2n−1) in the Pandit-Wu table.
    pub n_max: usize,
}

/// One candidate model.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// Name, such as "ARMA(1,1)" or "white + random walk".
    pub name: String,
    /// The model of the axis in the terms of the model file.
    pub model: AxisModel,
    /// States of its shaping filter, the turn-on constant's included.
    pub states: usize,
    /// Parameters fitted.
    pub parameters: usize,
    /// The ARMA fit it comes from, for ARMA and AR models.
    pub fit: Option<ArmaFit>,
    /// Ljung-Box p of its residuals at 20 lags, for ARMA and AR models.
    pub ljung_box_p: Option<f64>,
    /// RMS prediction error of the integrated signal at each horizon.
    pub score: Vec<HorizonScore>,
}

/// Everything found of one axis. SI units.
#[derive(Clone, Debug)]
pub struct Axis {
    /// Samples of the record.
    pub samples: usize,
    /// Mean removed [unit].
    pub mean: f64,
    /// Samples replaced for being outliers.
    pub outliers: Vec<Outlier>,
    /// Whether the sensor moved.
    pub motion: Option<Motion>,
    /// Augmented Dickey-Fuller, constant, 20 lags.
    pub adf: Adf,
    /// KPSS about a level.
    pub kpss: Kpss,
    /// Phillips-Perron, constant.
    pub phillips_perron: PhillipsPerron,
    /// The three weighed.
    pub stationarity: Verdict,
    /// Moments, Jarque-Bera, Kolmogorov-Smirnov, Lilliefors, quantisation step.
    pub normality: Normality,
    /// Autocorrelation at lags 0…[`LAGS`].
    pub acf: Vec<f64>,
    /// Partial autocorrelation at lags 0…[`LAGS`].
    pub pacf: Vec<f64>,
    /// Ljung-Box of the record at 20 lags.
    pub whiteness: Portmanteau,
    /// Welch power spectral density.
    pub psd: Density,
    /// Lines that stand out of it.
    pub lines: Vec<Line>,
    /// Overlapping Allan deviation at octaves.
    pub allan: Curve,
    /// Its 68 % intervals.
    pub allan_intervals: Vec<Interval>,
    /// Terms fitted to it.
    pub allan_terms: Terms,
    /// White noise and Gauss-Markov process fitted to it.
    pub allan_gauss_markov: Option<GaussMarkovFit>,
    /// The paper's procedure on at most [`SEARCH_SAMPLES`] samples, the search at reduced effort.
    pub pandit_wu: Option<PanditWu>,
    /// Candidates with their scores, in the order tried.
    pub candidates: Vec<Candidate>,
    /// Index of the recommended candidate.
    pub chosen: usize,
    /// Why, in one sentence.
    pub reason: String,
    /// Everything that should be said with it.
    pub warnings: Vec<String>,
}

/// Why a record has no model.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum IdentifyError {
    /// The record cannot be used.
    #[error(transparent)]
    Record(#[from] RecordError),
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

/// Identifies one axis: `record` in SI units, evenly sampled. `accelerometer` tells what the mean means.
///
/// # Errors
/// A record that is too short (fewer than 1000 samples), constant or not finite.
pub fn identify(
    record: &[f64],
    accelerometer: bool,
    options: &Options,
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
    let plain = screening::remove_constant(record)?;
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
    if motion.as_ref().is_some_and(|m| m.moving) {
        warnings.push("the record is not static: its mean moves from second to second".into());
    }
    if let Some(first) = found.outliers.first() {
        warnings.push(format!(
            "{} samples lie more than 8 robust standard deviations off and were left out, the first at {:.2} s",
            found.outliers.len(),
            first.index as f64 / rate
        ));
    }

    let adf = stationarity::adf(&bridged, Deterministic::Constant, Lags::Fixed(ADF_LAGS))?;
    let kpss = stationarity::kpss(&bridged, Deterministic::Constant, KpssLags::Legacy)?;
    let phillips_perron = stationarity::phillips_perron(&bridged, Deterministic::Constant, None)?;
    let normality = normality::normality(&bridged)?;
    let acf = correlation::autocorrelation(&bridged, LAGS)?;
    let pacf = correlation::partial_autocorrelation(&bridged, LAGS, Partial::YuleWalker)?;
    let whiteness = whiteness::portmanteau(&bridged, &[20], 0)?[0];
    let segment = (record.len() / 8).clamp(256, 8192);
    let psd = spectrum::welch(&bridged, rate, segment)?;
    let lines = spectrum::lines(&psd, LINE_FACTOR);
    let curve = allan::deviations(&bridged, rate, Kind::Overlapping, Grid::Octave)?;
    let allan_intervals = allan::intervals(&bridged, &curve, 0.683)?;
    let allan_terms = allan::fit_terms(&curve)?;
    let allan_gauss_markov = allan::fit_gauss_markov(&curve).ok();

    let half_length = record.len() / 2;
    let seconds = half_length as f64 / rate;
    let half = candidates::Half {
        record: &found.cleaned,
        first: half_length,
        rate_hz: rate,
        turn_on: turn_on_of(plain.mean, accelerometer),
        horizons: HORIZONS_S
            .into_iter()
            .filter(|h| seconds > 4.0 * h)
            .collect(),
    };
    let (pandit_wu, candidates) = candidates::candidates(&half, options, &allan_terms);
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
    if let Some(fit) = &chosen.fit {
        if fit.near_cancelling {
            warnings.push("an autoregressive and a moving-average root of the chosen model nearly cancel: they are not distinguishable in this record".into());
        }
        if fit.flat_likelihood {
            warnings.push("the likelihood of the chosen model is flat in some direction: its coefficients are not well determined, what they predict is".into());
        }
    }
    let ma_root = candidates
        .iter()
        .filter_map(|c| c.fit.as_ref())
        .find(|fit| fit.order() == (1, 1))
        .and_then(|fit| fit.ma.first().copied());
    Ok(Axis {
        samples: record.len(),
        mean: plain.mean,
        stationarity: stationarity::verdict(&adf, &kpss, &phillips_perron, ma_root),
        outliers: found.outliers,
        motion,
        adf,
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

impl Axis {
    /// The recommended candidate.
    pub fn recommended(&self) -> &Candidate {
        &self.candidates[self.chosen]
    }

    /// The model to store: the recommended one, with the runner-up and the scores beside it.
    pub fn model(&self) -> AxisModel {
        let chosen = self.recommended();
        let mut model = chosen.model.clone();
        let mut note = toml::Table::new();
        note.insert("model".into(), chosen.name.clone().into());
        note.insert("reason".into(), self.reason.clone().into());
        let runner_up = (0..self.candidates.len())
            .filter(|i| *i != self.chosen)
            .min_by(|a, b| {
                self.candidates[*a]
                    .last_rms()
                    .total_cmp(&self.candidates[*b].last_rms())
            });
        if let Some(index) = runner_up {
            note.insert(
                "runner_up".into(),
                self.candidates[index].name.clone().into(),
            );
        }
        let mut scores = toml::Table::new();
        for candidate in &self.candidates {
            let row: Vec<toml::Value> = candidate.score.iter().map(|s| s.rms.into()).collect();
            scores.insert(candidate.name.clone(), row.into());
        }
        let horizons: Vec<toml::Value> = chosen.score.iter().map(|s| s.horizon_s.into()).collect();
        note.insert("horizons_s".into(), horizons.into());
        note.insert("drift_scores".into(), scores.into());
        model.identification = note;
        model
    }
}

impl Candidate {
    /// Score at the longest horizon [unit·s]; infinite without one.
    fn last_rms(&self) -> f64 {
        self.score.last().map_or(f64::INFINITY, |s| s.rms)
    }
}
