//! How the bias of an axis goes with the sensor's temperature: a slope and, where a test says so, a quadratic, estimated
//! together with the noise.
//!
//! Least squares take the noise for white. Where its slow part is a random walk, both a walk and the temperature wander
//! over hours, and the slope that they find is wrong by many of their standard errors (Granger & Newbold 1974). Here the
//! slope is that of generalised least squares: the record and the temperature in block averages, under the exact covariance of
//! white noise with a random walk, a Gauss-Markov process or flicker noise, whose parameters are fitted with the slope by
//! restricted likelihood. Of the models that the likelihood does not tell apart the one with the largest standard error counts. What
//! is not [`SIGNIFICANT`] is not determined, and nothing is taken out.
//!
//! ```
//! use undrift_nav::shaping::ShapingFilter;
//! use undrift_noise::{synthesis::NoiseGenerator, temperature::Regressors};
//! // Half an hour at 10 Hz of a gyro that warms from 25 to 40 °C and reads 2e-5 rad/s more for every kelvin.
//! let celsius: Vec<f64> = (0..18_000).map(|k| 40.0 - 15.0 * (-f64::from(k) / 6000.0).exp()).collect();
//! let noise = NoiseGenerator::new(&ShapingFilter::white(1e-4, 0.1)?, 1);
//! let record: Vec<f64> = celsius.iter().zip(noise).map(|(t, noise)| 2e-5 * t + noise).collect();
//! let found = Regressors::new(&record, &celsius, 0.1)?.estimate()?;
//! assert!(found.determined && (found.effect.slope - 2e-5).abs() < 4.0 * found.effect.slope_sigma);
//! assert_eq!(found.effect.bias(found.effect.reference_c), 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod regression;

use crate::composite::{TermSet, average_in_blocks};
use nalgebra::DVector;
use regression::{Averages, Likelihood, Regression, combined};
use undrift_nav::shaping::ShapingFilter;

/// Blocks that the regression is of, at most: no temperature changes faster than a thousandth of a record matters.
const BLOCKS: usize = 1000;
/// Least change of the temperature over the record \[K\], of block averages, for an effect to be estimated.
pub const LEAST_CHANGE_K: f64 = 0.5;
/// Standard errors that a coefficient must be away from 0. At 3 two records in a hundred whose bias is a random walk would have
/// an effect that is not there, since the walk is estimated too and two coefficients are tested; an effect between 3 and 3.5 is uncertain by a third.
pub const SIGNIFICANT: f64 = 3.5;
/// Fall of AIC that a coefficient must make besides, the noise fitted with and without it: a walk may explain what it does.
const FALL: f64 = SIGNIFICANT * SIGNIFICANT;
/// Standard errors from an estimate to an end of its 95 % interval.
pub const NORMAL_95: f64 = 1.96;
/// Models whose AIC is within this of the least are not distinguished.
const ALIKE: f64 = 6.0;

/// Zero of the Celsius scale \[K\].
pub const ZERO_CELSIUS: f64 = 273.15;

/// A temperature with its unit [°C], such as "25 degC" or "298 K". `None` without a unit, and below absolute zero.
///
/// ```
/// use undrift_noise::temperature::celsius;
/// assert_eq!(celsius("25 degC"), Some(25.0));
/// assert_eq!(celsius("298.15 K"), Some(25.0));
/// assert_eq!(celsius("25"), None);
/// ```
pub fn celsius(text: &str) -> Option<f64> {
    let text = text.trim().replace('\u{2212}', "-");
    let (number, offset) = ["degC", "°C", "celsius", "C"]
        .into_iter()
        .find_map(|unit| Some((text.strip_suffix(unit)?, 0.0)))
        .or_else(|| Some((text.strip_suffix('K')?, -ZERO_CELSIUS)))?;
    let value: f64 = number.trim().parse().ok()?;
    let celsius = value + offset;
    (celsius.is_finite() && celsius >= -ZERO_CELSIUS).then_some(celsius)
}

/// The noise beside which the slope is estimated.
const SETS: [(&str, TermSet); 3] = {
    let white = TermSet {
        white: true,
        quantisation: false,
        random_walk: false,
        flicker: false,
        gauss_markov: 0,
    };
    [
        (
            "white + random walk",
            TermSet {
                random_walk: true,
                ..white
            },
        ),
        (
            "white + Gauss-Markov",
            TermSet {
                gauss_markov: 1,
                ..white
            },
        ),
        (
            "white + flicker",
            TermSet {
                flicker: true,
                ..white
            },
        ),
    ]
};

/// A bias that changes with temperature by `slope·(T − reference) + quadratic·(T − reference)²`. "unit" is rad/s or m/s².
///
/// ```
/// use undrift_noise::temperature::Temperature;
/// let gyro = Temperature {
///     reference_c: 25.0,
///     range_c: [10.0, 45.0],
///     slope: 2e-5, // [rad/s/K]
///     slope_sigma: 1e-6,
///     quadratic: 0.0,
///     quadratic_sigma: 0.0,
///     body_axes: false,
/// };
/// assert!((gyro.bias(35.0) - 2e-4).abs() < 1e-18); // To be subtracted from the samples [rad/s].
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Temperature {
    /// Temperature at which the effect is 0 [°C]: the mean of the record.
    pub reference_c: f64,
    /// Lowest and highest temperature of the record that it was estimated from [°C]; beyond, it is extrapolated.
    pub range_c: [f64; 2],
    /// Change of the bias with temperature at the reference [unit/K].
    pub slope: f64,
    /// Standard error of the slope [unit/K].
    pub slope_sigma: f64,
    /// Quadratic part [unit/K²]; 0 of a straight line.
    pub quadratic: f64,
    /// Standard error of the quadratic part [unit/K²]; 0 of a straight line.
    pub quadratic_sigma: f64,
    /// Whether it is along the body axes of a drive file; else along the sensor's own, whose columns the record has.
    pub body_axes: bool,
}

impl Temperature {
    /// The bias at `temperature_c` [°C] less that at the reference \[unit\].
    #[inline]
    pub fn bias(&self, temperature_c: f64) -> f64 {
        let above = temperature_c - self.reference_c;
        above * (self.slope + self.quadratic * above)
    }
}

/// Effect of temperature in a record, and whether it is beyond doubt.
///
/// An effect that is not determined is an upper bound at best: the random walk of the bias may have done what
/// looks like it.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// Slope and, where the likelihood wants it, quadratic.
    pub effect: Temperature,
    /// Whether the slope or the quadratic is [`SIGNIFICANT`].
    pub determined: bool,
    /// Model of the noise under which it was estimated, the most cautious of the likely ones.
    pub noise: &'static str,
    /// Share of the variance of the block averages that the effect explains [–].
    pub explained: f64,
}

impl Estimate {
    /// The effect, to be put into a model; `None` unless it is determined.
    pub fn in_model(&self) -> Option<Temperature> {
        self.determined.then_some(self.effect)
    }
}

/// Why the effect of temperature cannot be estimated.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum TemperatureError {
    /// The temperature's length is not that of the record.
    #[error("one temperature per sample is needed")]
    Length,
    /// More than a tenth of the temperature is missing.
    #[error("more than a tenth of the temperatures is missing")]
    Missing,
    /// The temperature hardly changes, less than [`LEAST_CHANGE_K`].
    #[error("it changes by {change_k:.2} K, at least {LEAST_CHANGE_K} K are needed")]
    Steady {
        /// The change over the record \[K\].
        change_k: f64,
    },
    /// The regression failed.
    #[error("no model of the noise could be fitted with it")]
    NoFit,
}

/// `temperature_c` [°C] with the last finite value held over what is missing, and the first finite one before it: for sensors that give a
/// temperature now and then.
///
/// ```
/// use undrift_noise::temperature::held;
/// let mut temperature = vec![25.0; 20];
/// (temperature[0], temperature[10]) = (f64::NAN, f64::NAN);
/// assert_eq!(held(&temperature)?, vec![25.0; 20]);
/// assert!(held(&[f64::NAN, 25.0]).is_err());
/// # Ok::<(), undrift_noise::temperature::TemperatureError>(())
/// ```
///
/// # Errors
/// [`TemperatureError::Missing`].
pub fn held(temperature_c: &[f64]) -> Result<Vec<f64>, TemperatureError> {
    let first = temperature_c.iter().copied().find(|t| t.is_finite());
    let missing = temperature_c.iter().filter(|t| !t.is_finite()).count();
    let mut last = first.filter(|_| 10 * missing <= temperature_c.len());
    let last = last.as_mut().ok_or(TemperatureError::Missing)?;
    let held = temperature_c.iter().map(|&t| {
        if t.is_finite() {
            *last = t;
        }
        *last
    });
    Ok(held.collect())
}

/// A record and its temperature in averages over at most 1000 blocks: [`Regressors::new`], then [`Regressors::estimate`].
pub struct Regressors {
    averages: Averages,
    reference_c: f64,
    range_c: [f64; 2],
    /// Standard deviation of the temperature's averages \[K\], the unit of the regressors.
    scale: f64,
}

impl Regressors {
    /// Averages `record` \[unit\], NaN where a sample is missing, with a finite temperature [°C] for every sample, taken every
    /// `interval` \[s\].
    ///
    /// # Errors
    /// Lengths that differ, a temperature that changes less than [`LEAST_CHANGE_K`].
    pub fn new(
        record: &[f64],
        temperature_c: &[f64],
        interval: f64,
    ) -> Result<Self, TemperatureError> {
        if record.len() != temperature_c.len() {
            return Err(TemperatureError::Length);
        }
        let block = record.len().div_ceil(BLOCKS).max(1);
        let blocks = |values| average_in_blocks(values, block).map_err(|_| TemperatureError::NoFit);
        let (values, temperatures) = (blocks(record)?, blocks(temperature_c)?);
        let count = temperatures.len() as f64;
        let reference_c = temperatures.iter().sum::<f64>() / count;
        let squares: f64 = temperatures.iter().map(|t| (t - reference_c).powi(2)).sum();
        let scale = (squares / count).sqrt();
        let ends = temperatures.iter();
        let range_c = ends.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &t| {
            [low.min(t), high.max(t)]
        });
        let change_k = range_c[1] - range_c[0];
        if change_k.is_nan() || change_k < LEAST_CHANGE_K {
            return Err(TemperatureError::Steady { change_k });
        }
        let rows = values.iter().zip(&temperatures).map(|(value, t)| {
            let above = (t - reference_c) / scale;
            [*value, 1.0, above, above * above - 1.0]
        });
        Ok(Self {
            averages: Averages {
                rows: rows.collect(),
                block,
                interval,
            },
            reference_c,
            range_c,
            scale,
        })
    }

    /// Slope and quadratic by ordinary least squares: a first look, for what is robust against their errors. Its standard errors do not hold
    /// beside a random walk.
    pub fn plain(&self) -> Option<Temperature> {
        Some(self.effect(&self.averages.plain(2)?))
    }

    /// The estimate by generalised least squares. The quadratic is kept where the AIC falls by more than [`SIGNIFICANT`]² for it; the effect is
    /// determined where it makes the AIC fall by as much and its last coefficient is more than [`SIGNIFICANT`] standard errors from 0.
    ///
    /// # Errors
    /// [`TemperatureError::NoFit`], where no model of the noise can be fitted.
    pub fn estimate(&self) -> Result<Estimate, TemperatureError> {
        let none = self.likeliest(0)?;
        let slope = self.likeliest(1)?;
        let both = self.likeliest(2)?;
        let is_curved = slope - both > FALL;
        let regressors = if is_curved { 2 } else { 1 };
        let (noise, found) = self.most_cautious(regressors)?;
        let last =
            found.coefficients[regressors] / found.covariance[(regressors, regressors)].sqrt();
        let fall = none - if is_curved { both } else { slope };
        Ok(Estimate {
            effect: self.effect(&found),
            determined: fall > FALL && last.abs() > SIGNIFICANT,
            noise,
            explained: self.explained(&found.coefficients),
        })
    }

    /// What the restricted log-likelihood of a model of the noise, at the interval of the samples, changes by where the
    /// effect of temperature is integrated out under a flat prior: what it may explain then counts neither for
    /// the noise nor against it. The slope alone, or the quadratic with it. 0 for a model without a likelihood.
    pub(crate) fn restriction(&self, filter: &ShapingFilter, with_quadratic: bool) -> f64 {
        let regressors = 1 + usize::from(with_quadratic);
        self.averages
            .restriction(filter, regressors)
            .unwrap_or_default()
    }

    /// The least AIC of the models of the noise, with so many regressors.
    fn likeliest(&self, regressors: usize) -> Result<f64, TemperatureError> {
        let fits = SETS.into_iter();
        let fits = fits.filter_map(|(_, set)| self.averages.fit(set, regressors, Likelihood::Full));
        let least = fits.map(|fit| fit.aic).min_by(f64::total_cmp);
        least.ok_or(TemperatureError::NoFit)
    }

    /// The model, of those that the likelihood does not tell apart, under which the last coefficient is least certain.
    fn most_cautious(
        &self,
        regressors: usize,
    ) -> Result<(&'static str, Regression), TemperatureError> {
        let fit = |set| self.averages.fit(set, regressors, Likelihood::Restricted);
        let fits = SETS.map(|(name, set)| Some((name, fit(set)?)));
        let fits = || fits.iter().flatten();
        let least = fits().map(|(_, f)| f.aic).fold(f64::INFINITY, f64::min);
        let alike = fits().filter(|(_, f)| f.aic <= least + ALIKE);
        let variance = |of: &Regression| of.covariance[(regressors, regressors)];
        let widest = alike.max_by(|(_, a), (_, b)| variance(a).total_cmp(&variance(b)));
        widest.cloned().ok_or(TemperatureError::NoFit)
    }

    fn effect(&self, found: &Regression) -> Temperature {
        let (reference_c, scale) = (self.reference_c, self.scale);
        let coefficient = |at: usize| found.coefficients.get(at).copied().unwrap_or(0.0);
        let sigma = |at: usize| match at < found.coefficients.len() {
            true => found.covariance[(at, at)].sqrt(),
            false => 0.0,
        };
        Temperature {
            reference_c,
            range_c: self.range_c,
            slope: coefficient(1) / scale,
            slope_sigma: sigma(1) / scale,
            quadratic: coefficient(2) / (scale * scale),
            quadratic_sigma: sigma(2) / (scale * scale),
            body_axes: false,
        }
    }

    fn explained(&self, coefficients: &DVector<f64>) -> f64 {
        let present = || self.averages.rows.iter().filter(|row| !row[0].is_nan());
        let spread = |of: &dyn Fn(&regression::Row) -> f64| {
            let count = present().count() as f64;
            let mean = present().map(of).sum::<f64>() / count;
            present().map(|row| (of(row) - mean).powi(2)).sum::<f64>()
        };
        let left = spread(&|row| row[0] - combined(coefficients, row));
        (1.0 - left / spread(&|row| row[0])).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests;
