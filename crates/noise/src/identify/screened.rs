//! What is done to a record before anything is identified of it: its trend, its outliers, whether it rests.
//!
//! In this order: a dead band and coarse rounding, which hide the noise, end identification; the effect of
//! temperature or a line is removed, then the mean; outliers become missing; what is missing is bridged by
//! straight lines for the statistics that cannot do without it, while likelihoods see the gaps. Motion,
//! saturation and frozen stretches are reported, not repaired.

use super::{IdentifyError, Options, SHORTEST};
use crate::normality::{self, Quantisation};
use crate::screening::rounding::{self, FEWEST_OFF, LEAST_SHOWN};
use crate::screening::{
    self, Hanging, Motion, MotionRule, Outlier, OutlierRule, Saturation, Trend, bridge::bridge,
};
use crate::spectrum::{self, Line};
use crate::temperature::{self, Estimate, Regressors, Temperature, TemperatureError};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// Equal samples in a row that a sensor at work does not give.
const HANGING: usize = 1000;

/// Part of a record that was removed beside its mean and the effect of temperature.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum Detrend {
    /// Nothing.
    #[default]
    Constant,
    /// A straight line, by least squares over the whole record.
    Linear {
        /// Slope of the line \[unit/h\].
        slope_per_hour: f64,
        /// Share of the variance that the line explains [–].
        explained: f64,
    },
}

/// A record less its trend and its outliers, and what was seen on the way.
pub(super) struct Screened {
    /// Level that was removed \[unit\].
    pub(super) mean: f64,
    /// Straight line that was removed, if one was.
    pub(super) removed: Detrend,
    /// The effect of temperature, or why it is unknown; taken out where it is determined.
    pub(super) temperature: Option<Result<Estimate, TemperatureError>>,
    /// NaN where an outlier was.
    pub(super) cleaned: Vec<f64>,
    /// The cleaned record with straight lines over what is missing.
    pub(super) bridged: Vec<f64>,
    pub(super) outliers: Vec<Outlier>,
    /// Samples that were missing.
    pub(super) missing: usize,
    /// Stretches in which the sensor was moved; `None` where the record is too short to tell.
    pub(super) motion: Option<Motion>,
    /// Samples at the end of the range.
    pub(super) saturation: Vec<Saturation>,
    /// Runs of equal samples that a working sensor does not give.
    pub(super) hanging: Vec<Hanging>,
    /// Robust standard deviations beyond which a sample was an outlier.
    pub(super) threshold: f64,
    /// The grid of the samples, and their standard deviation before rounding where the steps are coarse and it shows.
    pub(super) quantisation: Option<Quantisation>,
    pub(super) before_rounding: Option<f64>,
    /// Where it does not, the share of the noise at another mean that this one shows.
    pub(super) noise_shown: Option<f64>,
    /// The steps are larger than the noise: the error that they leave is no noise of its own.
    pub(super) coarse: bool,
}

impl Screened {
    /// Takes lines and narrow resonances out.
    ///
    /// After it the record has notches at resonances; what was removed is returned.
    pub(super) fn remove_lines(&mut self, rate_hz: f64) -> Vec<Line> {
        let lines = spectrum::remove_lines(&mut self.cleaned, rate_hz);
        if !lines.is_empty() {
            self.bridged = bridge(&self.cleaned, 0.0);
        }
        lines
    }
}

/// Screens a record; NaN marks a missing sample.
///
/// # Errors
/// A record that is constant or shorter than identification needs; a dead band
/// ([`IdentifyError::DeadBand`]); steps so coarse that the noise does not show
/// ([`IdentifyError::Coarse`]). Trends that cannot be removed.
pub(super) fn screened(record: &[f64], options: &Options<'_>) -> Result<Screened, IdentifyError> {
    let missing = |k: &usize| record[*k].is_nan();
    let left_out: Vec<usize> = (0..record.len()).filter(missing).collect();
    let (present, whole) = match left_out.is_empty() {
        true => (Cow::Borrowed(record), Cow::Borrowed(record)),
        false => {
            let present = record.iter().copied().filter(|x| !x.is_nan());
            let present = Vec::from_iter(present);
            let mean = present.iter().sum::<f64>() / present.len().max(1) as f64;
            (Cow::from(present), Cow::from(bridge(record, mean)))
        }
    };
    // What is constant has no trend: an error of its own.
    screening::record::check_varying(&present, SHORTEST)?;
    let (present, record) = (&*present, &*whole);
    if let Some(band) = screening::dead_band(present) {
        return Err(IdentifyError::DeadBand(band));
    }
    let quantisation = normality::quantisation(present);
    // By differences of neighbours, that a slow error over many steps does not matter.
    let squares: f64 = present.windows(2).map(|w| (w[1] - w[0]).powi(2)).sum();
    let variance = 0.5 * squares / present.len() as f64;
    let coarse = quantisation.filter(|grid| grid.step * grid.step > variance);
    let mut hanging = HANGING;
    let before_rounding = coarse.and_then(|grid| rounding::before_rounding(present, grid.step));
    let mut noise_shown = None;
    if let Some(grid) = coarse {
        let (samples, off) = (present.len(), rounding::off_the_mode(present));
        let share = rounding::share_shown(grid.step, off, samples, variance);
        // Where the noise before rounding is known, so is the mean's place.
        noise_shown = Some(share).filter(|share| before_rounding.is_none() && *share < 1.0);
        if off < FEWEST_OFF || noise_shown.is_some_and(|share| share < LEAST_SHOWN) {
            return Err(IdentifyError::Coarse {
                step: grid.step,
                off,
                samples,
                hidden: rounding::largest_hidden(grid.step, off, samples),
            });
        }
        // While the mean is amid a step, a sensor at work gives long stretches too.
        hanging = hanging.max(samples / 4);
    }
    let rule = OutlierRule {
        step: quantisation.map_or(0.0, |grid| grid.step),
        ..OutlierRule::default()
    };
    let (mut removed, mut temperature) = (Detrend::Constant, None);
    let plain = match (options.trend, options.temperature) {
        (Trend::Linear, _) => {
            let plain = screening::remove_linear(record)?;
            removed = Detrend::Linear {
                slope_per_hour: plain.slope * (options.rate_hz * 3600.0),
                explained: plain.explained,
            };
            plain
        }
        (Trend::Temperature, Some(of_samples)) => {
            let held = temperature::held(of_samples);
            let found = held.and_then(|held| {
                let found = estimated(record, &held, rule, 1.0 / options.rate_hz)?;
                let rest = found.determined.then(|| less(record, &held, &found.effect));
                Ok((rest, found))
            });
            let rest = found.as_ref().ok().and_then(|(rest, _)| rest.as_deref());
            let plain = screening::remove_constant(rest.unwrap_or(record))?;
            temperature = Some(found.map(|(_, found)| found));
            plain
        }
        _ => screening::remove_constant(record)?,
    };
    let mut found = screening::outliers(&plain.residuals, rule)?;
    found
        .outliers
        .retain(|one| left_out.binary_search(&one.index).is_err());
    left_out.iter().for_each(|k| found.cleaned[*k] = f64::NAN);
    let bridged = bridge(&found.cleaned, 0.0);
    // The mean of a window that is missing is that of its neighbours, with the scatter of fewer samples.
    let mostly_there = |samples: std::ops::Range<usize>| {
        let missing = found.cleaned.get(samples.clone()).unwrap_or_default();
        2 * missing.iter().filter(|x| x.is_nan()).count() <= samples.len()
    };
    let rule = MotionRule {
        window: (options.rate_hz.round() as usize).max(2),
        step: quantisation.map_or(0.0, |grid| grid.step),
        ..MotionRule::default()
    };
    let motion = screening::motion::motion_where(&bridged, rule, mostly_there).ok();
    Ok(Screened {
        mean: plain.mean,
        removed,
        temperature,
        cleaned: found.cleaned,
        motion,
        bridged,
        outliers: found.outliers,
        missing: left_out.len(),
        saturation: screening::saturation(present),
        hanging: screening::constant_runs(record, hanging),
        threshold: found.threshold,
        quantisation,
        coarse: coarse.is_some(),
        before_rounding,
        noise_shown,
    })
}

/// The effect of temperature on what is left without outliers. These are known beside plain least squares, which are
/// no estimate of the effect but leave less than it.
///
/// # Errors
/// As [`Regressors::new`] and [`Regressors::estimate`].
fn estimated(
    record: &[f64],
    temperature_c: &[f64],
    rule: OutlierRule,
    interval: f64,
) -> Result<Estimate, TemperatureError> {
    let regressors = Regressors::new(record, temperature_c, interval)?;
    let first = regressors.plain().ok_or(TemperatureError::NoFit)?;
    let rest = less(record, temperature_c, &first);
    let outliers = screening::remove_constant(&rest)
        .and_then(|rest| screening::outliers(&rest.residuals, rule));
    let outliers = outliers.map_err(|_| TemperatureError::NoFit)?.outliers;
    if outliers.is_empty() {
        return regressors.estimate();
    }
    let mut cleaned = record.to_vec();
    for outlier in outliers {
        cleaned[outlier.index] = f64::NAN;
    }
    Regressors::new(&cleaned, temperature_c, interval)?.estimate()
}

/// A record less the effect of its temperature.
///
/// Temperatures in °C, one a sample.
fn less(record: &[f64], temperature_c: &[f64], effect: &Temperature) -> Vec<f64> {
    let samples = record.iter().zip(temperature_c);
    samples.map(|(x, t)| x - effect.bias(*t)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// White noise of unit variance, seed 3, about 5.
    fn white(samples: usize) -> Vec<f64> {
        let mut record = vec![0.0; samples];
        let white = undrift_nav::shaping::ShapingFilter::white(1.0, 1.0).unwrap();
        crate::synthesis::NoiseGenerator::new(&white, 3).fill(&mut record);
        record.iter().map(|x| x + 5.0).collect()
    }

    fn screen(record: &[f64], trend: Trend) -> Screened {
        let options = Options {
            trend,
            ..Options::at(49.6)
        };
        screened(record, &options).unwrap()
    }

    #[test]
    fn what_is_missing_is_bridged_and_no_outlier() {
        let mut record = white(4000);
        record[1000] = 60.0;
        record[2000..2010].fill(f64::NAN);
        // An outlier beside a gap: the line across is off, too.
        record[2010] = -50.0;
        let found = screen(&record, Trend::Constant);
        let places: Vec<usize> = found.outliers.iter().map(|one| one.index).collect();
        assert_eq!((places, found.missing), (vec![1000, 2010], 10));
        for (k, value) in found.cleaned.iter().enumerate() {
            let is_out = k == 1000 || (2000..=2010).contains(&k);
            assert_eq!(value.is_nan(), is_out, "{k}");
            assert!(is_out || (value - (record[k] - found.mean)).abs() < 1e-12);
        }
        let between = 0.5 * (found.cleaned[999] + found.cleaned[1001]);
        assert!((found.bridged[1000] - between).abs() < 1e-12);
        assert!((found.mean - 5.0).abs() < 0.1, "{}", found.mean);
        // Windows of a second, 50 samples.
        assert_eq!(found.motion.unwrap().windows, 79);
        assert!(
            found.removed == Detrend::Constant && found.quantisation.is_none() && !found.coarse
        );
    }

    #[test]
    fn long_losses_are_no_motion() {
        // Every tenth second two to three are missing, of 50 samples each.
        let mut record = white(40_000);
        for start in (500..39_000).step_by(500) {
            record[start..start + 100 + start % 51].fill(f64::NAN);
        }
        let found = screen(&record, Trend::Constant);
        let motion = found.motion.unwrap();
        assert!(
            !motion.moving && motion.moving_windows.is_empty(),
            "{motion:?}"
        );
        // And motion is still where it is.
        for sample in &mut record[20_300..20_450] {
            *sample += 5.0;
        }
        let moved = screen(&record, Trend::Constant).motion.unwrap();
        let near = |place: &usize| (20_200..=20_500).contains(place);
        assert!(moved.moving_windows.iter().any(near), "{moved:?}");
    }

    #[test]
    fn a_slope_is_given_by_the_hour_with_its_share_of_the_variance() {
        let record: Vec<f64> = white(4000)
            .iter()
            .zip(0..)
            .map(|(x, k)| x + 1e-3 * f64::from(k))
            .collect();
        let found = screen(&record, Trend::Linear);
        let Detrend::Linear {
            slope_per_hour,
            explained,
        } = found.removed
        else {
            panic!("{:?}", found.removed)
        };
        // A standard error of √(12/4000³) a sample, 1.4 %.
        assert!(
            (slope_per_hour / (1e-3 * 49.6 * 3600.0) - 1.0).abs() < 0.06,
            "{slope_per_hour}"
        );
        // A ramp of 4 has a variance of 16/12.
        let share = (16.0 / 12.0) / (1.0 + 16.0 / 12.0);
        assert!((explained - share).abs() < 0.05, "{explained}");
        let rest = found.cleaned.iter().sum::<f64>() / 4000.0;
        assert!(rest.abs() < 1e-9);
    }

    /// Mostly 0, every so many samples 1.
    fn coarse(samples: usize, each: usize, most: usize) -> Vec<f64> {
        let mut record = vec![0.0; samples];
        let places = (7..samples).step_by(each).take(most);
        places.for_each(|k| record[k] = 1.0);
        record
    }

    #[test]
    fn noise_below_the_steps_needs_thirty_samples_off_the_mode() {
        let found = screen(&coarse(4000, 25, 1000), Trend::Constant);
        assert!(found.coarse && found.before_rounding.is_none());
        // 160 of 4000 are off, 0.04 of steps² by differences: of what a σ of ½ over the quantile of 0.0204 may be.
        let quantile = 2.045_4;
        let shown = (0.04 / (0.5 / quantile / std::f64::consts::PI.sqrt())).sqrt();
        assert!(
            (found.noise_shown.unwrap() / shown - 1.0).abs() < 0.01,
            "{:?}",
            found.noise_shown
        );
        let off = |most: usize| screened(&coarse(4000, 25, most), &Options::at(50.0)).map(|_| ());
        assert!(matches!(
            off(29),
            Err(IdentifyError::Coarse {
                off: 29,
                samples: 4000,
                step: 1.0,
                ..
            })
        ));
        assert!(off(30).is_ok());
        // Of twice as long a record thirty show less than a fifth of what may be.
        let long = screened(&coarse(8000, 25, 30), &Options::at(50.0));
        assert!(matches!(long, Err(IdentifyError::Coarse { off: 30, .. })));
    }

    #[test]
    fn amid_a_step_a_quarter_of_equal_samples_is_no_fault() {
        let with = |zeros: usize| {
            let mut record = coarse(8000, 25, 1000);
            record[1000..1000 + zeros].fill(0.0);
            screen(&record, Trend::Constant).hanging
        };
        assert!(with(1500).is_empty());
        assert_eq!(with(2100).len(), 1);
        // Of noise that shows a thousand are.
        let mut record = white(8000);
        record[1000..2000].fill(5.0);
        let [one] = screen(&record, Trend::Constant).hanging[..] else {
            panic!()
        };
        assert_eq!((one.index, one.samples), (1000, 1000));
        record[1999] = 4.0;
        assert!(screen(&record, Trend::Constant).hanging.is_empty());
    }

    #[test]
    fn a_record_less_the_effect_of_its_temperature() {
        let effect = Temperature {
            reference_c: 20.0,
            slope: 2.0,
            quadratic: 0.5,
            ..Temperature::default()
        };
        assert_eq!(less(&[10.0, 20.0], &[21.0, 18.0], &effect), [7.5, 22.0]);
        // An outlier does not move it.
        let temperature: Vec<f64> = (0..4000)
            .map(|k| 20.0 + (f64::from(k) / 300.0).sin())
            .collect();
        let mut record: Vec<f64> = white(4000)
            .iter()
            .zip(&temperature)
            .map(|(x, t)| x + 2.0 * t)
            .collect();
        let clean = estimated(&record, &temperature, OutlierRule::default(), 0.02).unwrap();
        assert!(
            (clean.effect.slope - 2.0).abs() < 0.1 && clean.determined,
            "{clean:?}"
        );
        record[1200] += 1e4;
        let dirty = estimated(&record, &temperature, OutlierRule::default(), 0.02).unwrap();
        assert!(
            (dirty.effect.slope - clean.effect.slope).abs() < 0.01,
            "{dirty:?}"
        );
        assert!((dirty.explained - clean.explained).abs() < 0.01);
    }

    #[test]
    fn noise_known_before_rounding_has_no_share_that_is_hidden() {
        let coarse = |samples: usize, sigma: f64, mean: f64| {
            let noise = white(samples);
            let rounded = noise.iter().map(|x| (sigma * (x - 5.0) + mean).round());
            screen(&rounded.collect::<Vec<_>>(), Trend::Constant)
        };
        // Amid a step both its edges show: their shares give the deviation, to 2 % of three windows of 2000.
        let amid = coarse(8000, 0.4, 5.0);
        assert!(amid.coarse && amid.noise_shown.is_none());
        let sigma = amid.before_rounding.unwrap();
        assert!((sigma / 0.4 - 1.0).abs() < 0.04, "{sigma}");
        // At a third of a step but one edge shows, and less noise than the mean at the edge would.
        let aside = coarse(8000, 0.12, 5.3);
        assert!(aside.coarse && aside.before_rounding.is_none());
        let share = aside.noise_shown.unwrap();
        assert!(share > LEAST_SHOWN && share < 1.0, "{share}");
    }

    #[test]
    fn the_effect_of_temperature_is_estimated_at_the_rate_of_the_record() {
        // Slow noise that may be flicker, which has times of its own: an error of the rate shows.
        let temperature: Vec<f64> = (0..6000)
            .map(|k| 20.0 + (f64::from(k) / 700.0).sin() + 1e-4 * f64::from(k))
            .collect();
        let noise = white(12_000);
        let mut slow = 0.0;
        let record: Vec<f64> = (0..6000)
            .map(|k| {
                slow = 0.99 * slow + 0.05 * (noise[6000 + k] - 5.0);
                noise[k] + slow + temperature[k]
            })
            .collect();
        let options = Options {
            trend: Trend::Temperature,
            temperature: Some(&temperature),
            ..Options::at(49.6)
        };
        let found = screened(&record, &options).unwrap();
        let found = found.temperature.unwrap().unwrap().effect;
        let at = |interval| {
            let rule = OutlierRule::default();
            let estimate = estimated(&record, &temperature, rule, interval);
            estimate.unwrap().effect
        };
        assert_eq!(found, at(1.0 / 49.6));
        assert!((at(49.6).slope_sigma / found.slope_sigma - 1.0).abs() > 0.2);
    }
}
