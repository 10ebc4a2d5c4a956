//! From a static record of one axis to a noise model: screening, tests, Allan variance, ARMA,
//! candidates scored by the drift they leave, a recommendation.
//!
//! `docs/theory.md`, sections 1 and 6: the order of the source paper's part 1, and beyond it the choice by the
//! prediction error of the integrated signal on the half of the record that was not fitted, and by likelihood among
//! those that the drift does not tell apart.
//!
//! [`identify()`] is of one record, [`identify_pool`] of several of one sensor or type, [`allan_deviation`] of the Allan deviation
//! alone, after the same screening. What was removed, and every candidate with its score, is in the [`Axis`] that comes out.
//!
//! ```
//! use undrift_noise::{composite::CompositeTerms, identify::{Options, identify}, synthesis::NoiseGenerator};
//! // A quarter of an hour at 10 Hz: white noise of 1e-3 rad/√s over a random walk of 1e-4 rad/s/√s.
//! let truth = CompositeTerms { white: 1e-3, random_walk: 1e-4, ..CompositeTerms::default() };
//! let record: Vec<f64> = NoiseGenerator::new(&truth.to_shaping(0.1)?, 1).take(9000).collect();
//! let axis = identify(&record, false, &Options::at(10.0))?;
//! let white = axis.allan_terms.white.value;
//! assert!((white / 1e-3 - 1.0).abs() < 0.1);
//! let best = &axis.candidates[axis.chosen];
//! assert!(!best.compared && best.states > 0, "{} has no state for the walk", best.name);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod axis;
mod candidates;
mod pool;
mod remarks;
mod residuals;
mod screened;

pub use axis::{Axis, Candidate, NotFitted, Origin};
pub use pool::{Between, Difference, Pool, PoolError, Ratio, Sampled, Share, identify_pool};
pub use remarks::{FitRemark, RecordRemark};
pub use residuals::Residuals;
pub use screened::Detrend;

use crate::{
    allan::{self, DeviationKind, Grid},
    arma::ArmaFit,
    correlation::{self, Partial},
    drift_score::{self, HORIZONS_S, Reason, Scored},
    normality::{self, Normality},
    screening::{DeadBand, RecordError, Trend, bridge::inflation},
    spectrum,
    stationarity::{self, Adf, Deterministic, Kpss, KpssLags, Lags, PhillipsPerron},
    temperature::{self, Regressors},
    whiteness,
};
use std::sync::OnceLock;
use undrift_base::number::rounded;
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
/// Quantisation steps above this share of the standard deviation are tried as a term: rounding of
/// the integrated signal would then be more than 1 % of the variance of a sample, step²/6.
const COARSE: f64 = 0.25;

/// What is identified, and how much is tried.
///
/// With [`Options::at`] and a struct update: `Options { trend: Trend::Linear, ..Options::at(100.0) }`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options<'a> {
    /// Sample rate \[Hz\].
    pub rate_hz: f64,
    /// Largest n of ARMA(2n, 2n−1) that the Pandit-Wu search may choose.
    pub n_max: usize,
    /// What is taken out first.
    pub trend: Trend,
    /// Temperature [°C], one a sample, NaN where it is missing; without it [`Trend::Temperature`] takes the mean out alone.
    pub temperature: Option<&'a [f64]>,
}

impl Options<'_> {
    /// At a sample rate \[Hz\]: n up to 2, the mean taken out, no temperature.
    pub fn at(rate_hz: f64) -> Self {
        Self {
            rate_hz,
            n_max: 2,
            trend: Trend::default(),
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
    /// No horizon fits into the half that is scored.
    #[error("{seconds:.1} s are too short to measure drift: record at least {needed:.0} s")]
    TooBrief {
        /// Length of the record \[s\].
        seconds: f64,
        /// Length needed \[s\].
        needed: f64,
    },
    /// Rounding leaves nothing of the noise.
    #[error(
        "only {off} of {samples} samples differ from the most common value: rounding to steps of {step:.3e} hides the noise, up to {hidden:.2e} before rounding; record at a finer range or without the sensor's low-pass filter"
    )]
    Coarse {
        /// Step of the samples \[unit\].
        step: f64,
        /// Samples off the most common value.
        off: usize,
        /// Samples.
        samples: usize,
        /// Largest standard deviation before rounding \[unit\].
        hidden: f64,
    },
    /// A dead band hides the noise at rest.
    #[error(
        "dead band: {:.0} % of the samples are exactly {}, and none of the others within {:.2e} of it, which hides the noise at rest; switch it off in the sensor or its driver", 100.0 * .0.share, rounded(.0.value, 4), .0.width
    )]
    DeadBand(DeadBand),
    /// No candidate could be fitted.
    #[error("no model could be fitted to the recording")]
    NoCandidate,
    /// The sample rate is not a positive number.
    #[error("the sample rate must be above 0 Hz")]
    Rate,
}

/// The constant seen, as the best single guess of what a turn-on may bring \[unit\]: for an
/// accelerometer axis near the vertical, what it reads beyond gravity.
fn turn_on_of(mean: f64, accelerometer: bool) -> f64 {
    if accelerometer && mean.abs() > 0.5 * STANDARD_GRAVITY {
        (mean.abs() - STANDARD_GRAVITY).abs()
    } else {
        mean.abs()
    }
}

/// The standard deviation of the turn-on constants that records show \[unit\].
fn turn_on_of_all(records: &[Prepared], accelerometer: bool) -> f64 {
    let means = records.iter().map(|record| record.screened.mean);
    let squares = means.map(|mean| turn_on_of(mean, accelerometer).powi(2));
    (squares.sum::<f64>() / records.len() as f64).sqrt()
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

/// The tests of a record.
struct Tests {
    adf: Adf,
    /// By the name of the rule that chose its lags.
    adf_chosen: Vec<(&'static str, Adf)>,
    kpss: Kpss,
    phillips_perron: PhillipsPerron,
    normality: Normality,
}

fn tests(screened: &screened::Screened) -> Result<Tests, RecordError> {
    let x = &screened.bridged;
    let most = Some(ADF_LAGS);
    let rules = [
        Lags::Fixed(ADF_LAGS),
        Lags::Aic(most),
        Lags::Bic(most),
        Lags::LastSignificant(most),
    ];
    let [adf, aic, bic, last] = stationarity::adf_by_rules(x, Deterministic::Constant, rules)?;
    Ok(Tests {
        adf_chosen: vec![("aic", aic), ("bic", bic), ("last_significant", last)],
        adf,
        kpss: stationarity::kpss(x, Deterministic::Constant, KpssLags::Legacy)?,
        phillips_perron: stationarity::phillips_perron(x, Deterministic::Constant, None)?,
        // Bridged, or less a trend, the samples no longer lie on their grid.
        normality: normality::normality_on(x, screened.quantisation)?,
    })
}

/// Coverage of the intervals of Allan deviations.
const COVERAGE: f64 = 0.683;

/// A record with its screening, before anything is fitted.
struct Prepared {
    samples: usize,
    screened: screened::Screened,
    remarks: Vec<RecordRemark>,
    psd: spectrum::Density,
    lines: Vec<spectrum::Line>,
    allan: allan::Curve,
    /// The temperature where its effect is estimated, and whether a quadratic is in it.
    temperature: Option<(Regressors, bool)>,
}

/// Screens a record: what cannot be used is an error.
fn prepare(record: &[f64], options: &Options<'_>) -> Result<Prepared, IdentifyError> {
    let rate = options.rate_hz;
    if !(rate > 0.0 && rate.is_finite()) {
        return Err(IdentifyError::Rate);
    }
    if record.len() < SHORTEST {
        let (needed, got) = (SHORTEST, record.len());
        return Err(RecordError::TooShort { needed, got }.into());
    }
    horizons(record.len(), rate)?;
    let mut screened = screened::screened(record, options)?;
    let remarks = remarks::of_record(&screened, record.len(), rate);
    // The spectrum shows the lines; everything else is of the record without them.
    let segment = spectrum::default_segment(record.len());
    let psd = spectrum::welch(&screened.bridged, rate, segment)?;
    let lines = screened.remove_lines(rate);
    let allan = allan::deviations(
        &screened.bridged,
        rate,
        DeviationKind::Overlapping,
        Grid::Octave,
    )?;
    let effect = screened.temperature.as_ref().map(|found| found.as_ref());
    let effect = effect.and_then(Result::ok).map(|found| found.effect);
    let temperature = effect.zip(options.temperature).and_then(|(effect, of)| {
        let held = temperature::held(of).ok()?;
        let regressors = Regressors::new(&screened.cleaned, &held, 1.0 / rate).ok()?;
        Some((regressors, effect.quadratic != 0.0))
    });
    Ok(Prepared {
        samples: record.len(),
        temperature,
        screened,
        remarks,
        psd,
        lines,
        allan,
    })
}

/// Identifies one axis: `record` in SI units (rad/s or m/s²), evenly sampled, NaN where a sample is missing. `accelerometer` says
/// what the mean means: of a gyro it is the turn-on constant, of an accelerometer the part of it beyond gravity where the axis is
/// vertical.
///
/// # Errors
/// A record that is too short ([`SHORTEST`]), constant or infinite; one too brief for any horizon; noise hidden by rounding
/// ([`IdentifyError::Coarse`]) or by a dead band ([`IdentifyError::DeadBand`]); a sample rate that is not positive.
pub fn identify(
    record: &[f64],
    accelerometer: bool,
    options: &Options<'_>,
) -> Result<Axis, IdentifyError> {
    Ok(conclude(vec![prepare(record, options)?], accelerometer, options)?.0)
}

/// The Allan deviation of an axis.
#[derive(Clone, Debug)]
pub struct AllanDeviation {
    /// The curve, of the overlapping deviation at an octave's steps.
    pub curve: allan::Curve,
    /// 68 % interval of each point.
    pub intervals: Vec<allan::Interval>,
    /// The terms fitted to it.
    pub terms: allan::Terms,
}

/// The Allan deviation as [`identify`] finds it, without the tests and models, in a small part of its time.
///
/// # Errors
/// As [`identify`].
///
/// ```
/// use undrift_noise::{composite::CompositeTerms, identify::{Options, allan_deviation}, synthesis::NoiseGenerator};
/// let truth = CompositeTerms { white: 1e-3, ..CompositeTerms::default() };
/// let mut record: Vec<f64> = NoiseGenerator::new(&truth.to_shaping(0.1)?, 1).take(5000).collect();
/// (record[100], record[200]) = (f64::NAN, 1.0); // One sample missing, one an outlier.
/// let found = allan_deviation(&record, &Options::at(10.0))?;
/// assert!((found.terms.white.value / 1e-3 - 1.0).abs() < 0.05);
/// assert_eq!(found.intervals.len(), found.curve.points.len());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn allan_deviation(
    record: &[f64],
    options: &Options<'_>,
) -> Result<AllanDeviation, IdentifyError> {
    let Prepared {
        screened,
        allan: curve,
        ..
    } = prepare(record, options)?;
    Ok(AllanDeviation {
        intervals: allan::intervals(&screened.bridged, &curve, COVERAGE)?,
        terms: allan::fit_terms(&curve)?.with_less_white(inflation(&[&screened.cleaned])),
        curve,
    })
}

/// The axis that records of one sensor show together; tests, spectrum and correlations are those of the first, which
/// is the longest. Also the records as they were fitted.
fn conclude(
    mut records: Vec<Prepared>,
    accelerometer: bool,
    options: &Options<'_>,
) -> Result<(Axis, Vec<Vec<f64>>), IdentifyError> {
    let rate = options.rate_hz;
    let turn_on = turn_on_of_all(&records, accelerometer);
    let curves: Vec<allan::Curve> = records.iter().map(|record| record.allan.clone()).collect();
    let samples = records.iter().map(|record| record.samples).sum();
    let mut cleaned: Vec<Vec<f64>> = Vec::new();
    let mut temperatures = Vec::new();
    for record in &mut records {
        cleaned.push(std::mem::take(&mut record.screened.cleaned));
        temperatures.extend(record.temperature.take());
    }
    let mut all = records.into_iter();
    let first = all.next().ok_or(IdentifyError::NoCandidate)?;
    let Prepared {
        screened,
        remarks,
        psd,
        lines,
        ..
    } = first;
    let bridged = &screened.bridged;

    let tests = tests(&screened)?;
    let curve = allan::pooled(&curves).ok_or(IdentifyError::NoCandidate)?;
    let fitted: Vec<&[f64]> = cleaned.iter().map(Vec::as_slice).collect();
    let allan_terms = allan::fit_terms(&curve)?.with_less_white(inflation(&fitted));

    let coarse = screened
        .quantisation
        .is_some_and(|q| q.step_over_deviation > COARSE);
    let task = candidates::Task {
        records: fitted,
        rate_hz: rate,
        curve: &curve,
        allan: allan_terms,
        turn_on,
        quantised: coarse || allan_terms.quantisation.seen,
        n_max: options.n_max,
        temperatures,
        compared: OnceLock::new(),
    };
    let tried = candidates::candidates(&task);
    let candidates = tried.candidates;
    let (index, reason) = tried.chosen.ok_or(IdentifyError::NoCandidate)?;
    let chosen = &candidates[index];
    let intervals = match screened.coarse {
        true => Vec::new(),
        false => candidates::intervals(&task, chosen),
    };
    let mut fits = candidates.iter().filter_map(Candidate::arma);
    let one_one = fits.find(|fit| fit.order() == (1, 1));
    let ma_root = one_one.and_then(|fit| fit.ma.first().copied());
    let axis = Axis {
        samples,
        mean: screened.mean,
        removed: screened.removed,
        temperature: screened.temperature.and_then(Result::ok),
        stationarity: stationarity::verdict(
            &tests.adf,
            &tests.kpss,
            &tests.phillips_perron,
            ma_root,
        ),
        outliers: screened.outliers,
        motion: screened.motion,
        saturation: screened.saturation,
        hanging: screened.hanging,
        noise_shown: screened.noise_shown,
        adf: tests.adf,
        adf_chosen: tests.adf_chosen,
        kpss: tests.kpss,
        phillips_perron: tests.phillips_perron,
        normality: tests.normality,
        acf: correlation::autocorrelation(bridged, LAGS)?,
        pacf: correlation::partial_autocorrelation(bridged, LAGS, Partial::YuleWalker)?,
        whiteness: whiteness::portmanteau(bridged, &[20], 0)?[0],
        lines,
        psd,
        allan_intervals: allan::intervals(bridged, &curve, COVERAGE)?,
        allan_gauss_markov: allan::fit_gauss_markov(&curve).ok(),
        allan: task.curve.clone(),
        allan_terms,
        residuals: residuals::of_models(tried.pandit_wu.as_ref(), chosen.arma(), task.records[0]),
        pandit_wu: tried.pandit_wu,
        box_jenkins: tried.box_jenkins,
        scales: tried.scales,
        intervals,
        chosen: index,
        reason,
        candidates,
        not_fitted: tried.not_fitted,
        remarks,
    };
    Ok((axis, cleaned))
}

/// Position of the candidate that is recommended, and why; of methods of the literature none is, nor a model whose slow part is the
/// mean that was removed, nor an ARMA that is no likelier than a sum of terms: that is a model at every rate, and an ARMA(1,1) says
/// the same, which would be tried twice.
fn recommended(candidates: &[Candidate]) -> Option<(usize, Reason)> {
    let is_mean = |of: &Candidate| of.arma().is_some_and(ArmaFit::is_removed_mean);
    let own = candidates.iter().enumerate();
    let own = own.filter(|(_, candidate)| !candidate.compared && !is_mean(candidate));
    let sums = own.clone().filter(|(_, one)| one.model.arma.is_none());
    let least = sums.map(|(_, one)| one.aic).fold(f64::INFINITY, f64::min);
    let likelier = least - drift_score::EQUAL_AIC;
    let own = own.filter(|(_, one)| one.model.arma.is_none() || one.aic < likelier);
    let scored = own.clone().map(|(_, candidate)| Scored {
        name: candidate.name.clone(),
        states: candidate.states,
        parameters: candidate.parameters,
        aic: candidate.aic,
        horizons: candidate.score.clone(),
    });
    let found = drift_score::recommend(&Vec::from_iter(scored))?;
    let (index, _) = own.clone().nth(found.index)?;
    Some((index, found.reason))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn horizons_fit_four_times_into_half_of_the_record_and_hold_a_sample() {
        let of = |samples, rate| horizons(samples, rate).ok();
        assert_eq!(of(8, 1.0), None);
        assert_eq!(of(10, 1.0), Some(vec![1.0]));
        assert_eq!(of(80, 1.0), Some(vec![1.0]));
        assert_eq!(of(82, 1.0), Some(vec![1.0, 10.0]));
        assert_eq!(of(48_200, 100.0), Some(vec![1.0, 10.0, 60.0]));
        assert_eq!(of(260_000, 100.0), Some(vec![1.0, 10.0, 60.0, 300.0]));
        // At 0.5 Hz one second has no sample.
        assert_eq!(of(50, 0.5), Some(vec![10.0]));
        let brief = |samples, rate| match horizons(samples, rate) {
            Err(IdentifyError::TooBrief { seconds, needed }) => (seconds, needed),
            other => panic!("{other:?}"),
        };
        assert_eq!(brief(700, 100.0), (7.0, 10.0));
        assert_eq!(brief(10, 0.5), (20.0, 20.0));
    }

    #[test]
    fn a_turn_on_is_the_mean_beyond_gravity_where_the_axis_stands_upright() {
        let g = STANDARD_GRAVITY;
        assert_eq!(turn_on_of(-0.02, false), 0.02);
        assert_eq!(turn_on_of(12.0, false), 12.0);
        for sign in [1.0, -1.0] {
            assert!((turn_on_of(sign * (g + 0.1), true) - 0.1).abs() < 1e-12);
            assert!((turn_on_of(sign * (g - 0.1), true) - 0.1).abs() < 1e-12);
            assert_eq!(turn_on_of(sign * 0.49 * g, true), 0.49 * g);
            assert!((turn_on_of(sign * 0.51 * g, true) - 0.49 * g).abs() < 1e-12);
        }
    }
}
