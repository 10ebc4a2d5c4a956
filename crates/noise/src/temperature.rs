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
/// Least change of the temperature over the record \[K\], of block averages.
pub const LEAST_CHANGE_K: f64 = 0.5;
/// Standard errors that a coefficient must be away from 0. At 3 two records in a hundred whose bias is a random walk would have
/// an effect that is not there, since the walk is estimated too and two coefficients are tested; an effect between 3 and 3.5 is uncertain by a third.
pub const SIGNIFICANT: f64 = 3.5;
/// Fall of AIC that a coefficient must make besides, the noise fitted with and without it: a walk may explain what it does.
const FALL: f64 = SIGNIFICANT * SIGNIFICANT;
/// Standard errors of the ends of a 95 % interval.
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
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Temperature {
    /// Temperature at which the effect is 0 [°C].
    pub reference_c: f64,
    /// Temperatures that it was estimated between [°C].
    pub range_c: [f64; 2],
    /// [unit/K]
    pub slope: f64,
    /// Its standard error [unit/K].
    pub slope_sigma: f64,
    /// [unit/K²]; 0 where there is none.
    pub quadratic: f64,
    /// Its standard error [unit/K²]; 0 where there is none.
    pub quadratic_sigma: f64,
    /// Along the body axes of a drive file; otherwise along the sensor's own, whose columns the record has.
    pub body_axes: bool,
}

impl Temperature {
    /// The bias at a temperature [°C] less that at the reference \[unit\].
    #[inline]
    pub fn bias(&self, temperature_c: f64) -> f64 {
        let above = temperature_c - self.reference_c;
        above * (self.slope + self.quadratic * above)
    }
}

/// What a record says of the effect of temperature.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// Slope and, where the likelihood wants it, quadratic.
    pub effect: Temperature,
    /// Whether the slope or the quadratic is [`SIGNIFICANT`].
    pub determined: bool,
    /// The noise that the standard errors are of.
    pub noise: &'static str,
    /// Share of the variance of the block averages that the effect explains.
    pub explained: f64,
}

impl Estimate {
    /// The effect for a model, if it is determined.
    pub fn in_model(&self) -> Option<Temperature> {
        self.determined.then_some(self.effect)
    }
}

/// Why there is no estimate.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum TemperatureError {
    /// Its length is not that of the record.
    #[error("one temperature per sample is needed")]
    Length,
    /// More than a tenth of it is missing.
    #[error("more than a tenth of the temperatures is missing")]
    Missing,
    /// It hardly changes.
    #[error("it changes by {change_k:.2} K, at least {LEAST_CHANGE_K} K are needed")]
    Steady {
        /// The change over the record \[K\].
        change_k: f64,
    },
    /// The regression failed.
    #[error("no model of the noise could be fitted with it")]
    NoFit,
}

/// The temperature with the last finite value held over what is missing, the first before the first; an error where
/// that is more than a tenth.
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
    /// Of `record` \[unit\], NaN where a sample is missing, with a finite temperature [°C] for every sample, taken every
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

    /// Slope and quadratic by plain least squares: a first look, for what is robust against their errors.
    pub fn plain(&self) -> Option<Temperature> {
        Some(self.effect(&self.averages.plain(2)?))
    }

    /// The estimate. The quadratic is kept where the AIC falls by more than [`SIGNIFICANT`]² for it; the effect is determined
    /// where it makes the AIC fall by as much and its last coefficient is more than [`SIGNIFICANT`] standard errors from 0.
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

    /// Of the models that the likelihood does not tell apart the one under which the last coefficient is least certain.
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
mod tests {
    use super::*;

    #[test]
    fn a_temperature_is_read_with_its_unit() {
        for (text, expected) in [
            ("25 degC", Some(25.0)),
            ("25degC", Some(25.0)),
            (" 25 °C ", Some(25.0)),
            ("25 celsius", Some(25.0)),
            ("-5 C", Some(-5.0)),
            ("\u{2212}5C", Some(-5.0)),
            ("300.15 K", Some(27.0)),
            ("0 K", Some(-273.15)),
            ("-273.15 C", Some(-273.15)),
            ("-273.16 C", None),
            ("-0.01 K", None),
            ("inf C", None),
            ("warm C", None),
            ("25", None),
            ("25 F", None),
        ] {
            let found = celsius(text);
            assert_eq!(found.is_some(), expected.is_some(), "{text}");
            let miss = found.zip(expected).map_or(0.0, |(a, b)| a - b);
            assert!(miss.abs() < 1e-12, "{text}: {found:?}");
        }
    }

    #[test]
    fn a_missing_temperature_is_the_last_and_a_tenth_may_be_missing() {
        let nan = f64::NAN;
        let of = [nan, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0];
        assert_eq!(
            held(&of),
            Ok(vec![1.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0])
        );
        assert_eq!(held(&of[..9]), Err(TemperatureError::Missing));
        let mut two = [of, of].concat();
        two[0] = 7.0;
        two[19] = f64::INFINITY;
        let found = held(&two).unwrap();
        assert_eq!(
            (found[0], found[9], found[10], found[19]),
            (7.0, 9.0, 9.0, 8.0)
        );
    }

    /// Temperatures about 20 °C, of which the squares of one and two steps are orthogonal.
    fn steps() -> Vec<f64> {
        (0..900).map(|k| 20.0 + f64::from(k % 3) - 1.0).collect()
    }

    #[test]
    fn an_effect_without_noise_is_found_as_it_is() {
        let temperature = steps();
        let of = |t: &f64| 7.0 + 0.3 * (t - 20.0) - 0.2 * (t - 20.0).powi(2);
        let record: Vec<f64> = temperature.iter().map(of).collect();
        let regressors = Regressors::new(&record, &temperature, 0.5).unwrap();
        let found = regressors.plain().unwrap();
        assert!((found.slope - 0.3).abs() < 1e-9 && (found.quadratic + 0.2).abs() < 1e-9);
        assert!((found.reference_c - 20.0).abs() < 1e-9);
        assert_eq!((found.range_c, found.body_axes), ([19.0, 21.0], false));
        // White noise of density 1 at 2 Hz: 2 over Σt² of 600, and for the squares over Σ(t² − 2/3)² of 200.
        assert!((found.slope_sigma - (2.0f64 / 600.0).sqrt()).abs() < 1e-9);
        assert!((found.quadratic_sigma - (2.0f64 / 200.0).sqrt()).abs() < 1e-9);
        for (t, bias) in [(20.0, 0.0), (22.0, -0.2), (19.0, -0.5)] {
            assert!((found.bias(t) - bias).abs() < 1e-9, "{t}");
        }
        let explained =
            |coefficients: &[f64]| regressors.explained(&DVector::from_row_slice(coefficients));
        // In units of the standard deviation √(2/3): the slope and the quadratic have 0.09 · 2/3 and 0.04 · 2/9 of variance.
        let (slope, quadratic) = (0.3 * (2.0f64 / 3.0).sqrt(), -0.2 * 2.0 / 3.0);
        let (a, b) = (0.06, 0.04 * 2.0 / 9.0);
        assert!((explained(&[7.0, slope, quadratic]) - 1.0).abs() < 1e-9);
        assert!((explained(&[0.0, slope]) - a / (a + b)).abs() < 1e-9);
        assert!(explained(&[3.0]) < 1e-12);
    }

    #[test]
    fn a_record_is_averaged_to_a_thousand_blocks_and_the_temperature_has_to_change() {
        let ramp = |n: usize, change: f64| -> Vec<f64> {
            (0..n)
                .map(|k| 20.0 + change * k as f64 / (n - 1) as f64)
                .collect()
        };
        let of = |n: usize, change: f64| Regressors::new(&vec![1.0; n], &ramp(n, change), 0.1);
        for (n, block) in [(900, 1), (1000, 1), (1001, 2), (3500, 4)] {
            let found = of(n, 10.0).unwrap().averages;
            assert_eq!((found.block, found.rows.len()), (block, n / block), "{n}");
            assert_eq!(found.interval, 0.1);
        }
        assert!(of(500, 0.5 + 1e-9).is_ok());
        let Err(TemperatureError::Steady { change_k }) = of(500, 0.49) else {
            panic!()
        };
        assert!((change_k - 0.49).abs() < 1e-9);
        // Averages of 0 and 1 over pairs: rows are the record, one, and the temperature's powers of unit variance.
        let rows = Regressors::new(&[4.0, 8.0], &[10.0, 14.0], 0.1).unwrap();
        assert_eq!(
            rows.averages.rows,
            [[4.0, 1.0, -1.0, 0.0], [8.0, 1.0, 1.0, 0.0]]
        );
        assert_eq!((rows.scale, rows.reference_c), (2.0, 12.0));
    }

    #[test]
    fn a_quadratic_is_integrated_out_where_it_is_in_the_effect() {
        let temperature = steps();
        let record: Vec<f64> = (0..900).map(|k| f64::from(k * 37 % 19)).collect();
        let regressors = Regressors::new(&record, &temperature, 0.5).unwrap();
        let white = ShapingFilter::white(3.0, 0.5).unwrap();
        for (with_quadratic, count) in [(false, 1), (true, 2)] {
            let found = regressors.restriction(&white, with_quadratic);
            assert_eq!(
                found,
                regressors.averages.restriction(&white, count).unwrap()
            );
        }
        assert!(regressors.restriction(&white, false) != regressors.restriction(&white, true));
    }

    #[test]
    fn an_effect_is_determined_by_its_standard_errors_and_the_fall_of_the_criterion() {
        let temperature: Vec<f64> = (0..900)
            .map(|k| 20.0 + (f64::from(k) / 40.0).sin())
            .collect();
        let of = |slope: f64, quadratic: f64| {
            let mut record = vec![0.0; 900];
            let white = ShapingFilter::white(0.3, 1.0).unwrap();
            crate::synthesis::NoiseGenerator::new(&white, 5).fill(&mut record);
            for (x, t) in record.iter_mut().zip(&temperature) {
                *x += slope * (t - 20.0) + quadratic * (t - 20.0).powi(2);
            }
            Regressors::new(&record, &temperature, 1.0)
                .unwrap()
                .estimate()
                .unwrap()
        };
        // Noise of 0.3, Σ(t − 20)² of 450: a slope is known to 0.014, a quadratic to 0.027.
        let none = of(0.0, 0.0);
        assert!(!none.determined && none.effect.quadratic == 0.0 && none.explained < 0.02);
        assert!((0.01..0.03).contains(&none.effect.slope_sigma), "{none:?}");
        assert_eq!(none.in_model(), None);
        let slope = of(0.3, 0.0);
        assert!(
            slope.determined && slope.effect.quadratic == 0.0,
            "{slope:?}"
        );
        assert!((slope.effect.slope - 0.3).abs() < 0.06);
        assert_eq!(slope.in_model(), Some(slope.effect));
        let both = of(0.3, 0.5);
        assert!(
            both.determined && (both.effect.quadratic - 0.5).abs() < 0.12,
            "{both:?}"
        );
        // A quadratic alone: the slope says nothing, the effect is determined all the same.
        let bent = of(0.0, 0.5);
        assert!(
            bent.determined && (bent.effect.quadratic - 0.5).abs() < 0.12,
            "{bent:?}"
        );
    }
}
