//! Outliers by the median and the median absolute deviation of a moving window (Hampel, J. American
//! Statistical Association 69, 1974).

use super::record::{RecordError, check};
use super::tail;
use serde::{Deserialize, Serialize};
use undrift_base::order_statistics::{MAD_TO_SIGMA, upper_median};

/// Median deviations at which squares are capped.
const CAP: f64 = 5.0;

/// Limits from which a sample is an outlier.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutlierRule {
    /// Number of samples of the moving window.
    pub window: usize,
    /// Robust standard deviations from the window's median; more where the noise's own tail is heavier than normal.
    pub sigmas: f64,
    /// Step of quantised samples \[unit\], 0 where there is none: no deviation counts as smaller.
    pub step: f64,
}

impl Default for OutlierRule {
    /// 1000 samples, 8 standard deviations: beyond what 10⁷ normal samples reach, so that noise is
    /// never cut.
    fn default() -> Self {
        Self {
            window: 1000,
            sigmas: 8.0,
            step: 0.0,
        }
    }
}

/// An outlier of a record.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Outlier {
    /// Position of the sample, from 0.
    pub index: usize,
    /// Value of the sample \[unit\].
    pub value: f64,
    /// Distance from the local median, in robust standard deviations, with its sign.
    pub sigmas: f64,
}

/// Outliers, and the record without them.
///
/// `threshold` is that of the rule, or larger where the noise has heavy tails; identification reports it with
/// the outliers.
#[derive(Clone, Debug, PartialEq)]
pub struct Outliers {
    /// The outliers by position.
    pub outliers: Vec<Outlier>,
    /// The record with NaN, that is missing, in their places \[unit\].
    pub cleaned: Vec<f64>,
    /// Robust standard deviations beyond which a sample is an outlier.
    pub threshold: f64,
}

/// Finds the outliers of a record. Each half window is compared with the median and the deviation of
/// the window around it: O(N). The median deviation of quantised samples jumps by whole steps: it is
/// not let below half of its median over all windows (below the mean absolute deviation of the record,
/// where that is 0), nor below the root mean square of the window with squares capped at five of it, nor below the
/// step. Of heavy-tailed noise nothing is an outlier that Student's t with the tail of the bulk can have made.
///
/// # Errors
/// Fewer than 5 samples, a sample that is not finite, a window below 5 or a threshold that
/// is not positive.
///
/// ```
/// use undrift_nav::shaping::ShapingFilter;
/// use undrift_noise::{screening::{OutlierRule, outliers}, synthesis::NoiseGenerator};
/// let mut record: Vec<f64> = NoiseGenerator::new(&ShapingFilter::white(1e-3, 0.01)?, 1).take(5000).collect();
/// // A bias that drifts by ten deviations is no outlier: the median of the window goes with it.
/// record.iter_mut().enumerate().for_each(|(k, x)| *x += 2e-5 * k as f64);
/// assert!(outliers(&record, OutlierRule::default())?.outliers.is_empty());
/// record[700] += 0.2; // Twenty deviations of 0.01.
/// let found = outliers(&record, OutlierRule::default())?;
/// assert_eq!(found.outliers.iter().map(|one| one.index).collect::<Vec<_>>(), [700]);
/// assert!((found.outliers[0].sigmas / 20.0 - 1.0).abs() < 0.25);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn outliers(x: &[f64], rule: OutlierRule) -> Result<Outliers, RecordError> {
    check(x, 5)?;
    if rule.window < 5 || rule.sigmas.is_nan() || rule.sigmas <= 0.0 {
        return Err(RecordError::Argument(
            "the outlier rule needs 5 samples and a positive threshold",
        ));
    }
    let window = rule.window.min(x.len());
    let step = (window / 2).max(1);
    let around = |k: usize| {
        let first = (k * step)
            .saturating_sub((window - step) / 2)
            .min(x.len() - window);
        first..first + window
    };
    let mut windows = Vec::with_capacity(x.len() / step + 1);
    let mut work = Vec::with_capacity(window);
    for k in 0..x.len().div_ceil(step) {
        work.clear();
        work.extend_from_slice(&x[around(k)]);
        let centre = upper_median(&mut work);
        work.iter_mut().for_each(|v| *v = (*v - centre).abs());
        windows.push((centre, MAD_TO_SIGMA * upper_median(&mut work)));
    }
    let mut deviations: Vec<f64> = windows.iter().map(|w| w.1).collect();
    let mut floor = 0.5 * upper_median(&mut deviations);
    if floor == 0.0 {
        let absolute = x
            .iter()
            .enumerate()
            .map(|(k, v)| (v - windows[k / step].0).abs())
            .sum::<f64>();
        floor = absolute / x.len() as f64 * (std::f64::consts::PI / 2.0).sqrt();
    }
    for (k, (centre, deviation)) in windows.iter_mut().enumerate() {
        *deviation = deviation.max(floor);
        let most = CAP * *deviation;
        let squares: f64 = x[around(k)]
            .iter()
            .map(|v| (v - *centre).clamp(-most, most).powi(2))
            .sum();
        *deviation = deviation
            .max((squares / window as f64).sqrt())
            .max(rule.step);
    }
    let sigmas = |index: usize| {
        let (centre, deviation) = windows[index / step];
        (x[index] - centre) / deviation
    };
    // Of samples on a coarse grid the quantiles are those of the grid.
    let coarse = rule.step > 0.0 && windows.iter().any(|w| w.1 < 2.0 * rule.step);
    let threshold = if coarse {
        rule.sigmas
    } else {
        let distances = (0..x.len()).map(|index| sigmas(index).abs());
        tail::bound(distances.filter(|d| !d.is_nan()).collect(), rule.sigmas)
    };
    let (mut found, mut cleaned) = (Vec::new(), x.to_vec());
    for (index, &value) in x.iter().enumerate() {
        let sigmas = sigmas(index);
        // 0/0 of a constant record is no outlier.
        if sigmas.abs() > threshold {
            found.push(Outlier {
                index,
                value,
                sigmas,
            });
            cleaned[index] = f64::NAN;
        }
    }
    Ok(Outliers {
        outliers: found,
        cleaned,
        threshold,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rule(window: usize, sigmas: f64, step: f64) -> OutlierRule {
        OutlierRule {
            window,
            sigmas,
            step,
        }
    }

    /// One window over all: median, median deviation and what is beyond, by hand.
    #[test]
    fn a_sample_is_measured_in_deviations_from_the_median() {
        // About 11: deviations 0, 1, 1, 2, 2, 3, 3, 4 and 39, whose median is 2.
        let x = [10.0, 9.0, 11.0, 8.0, 12.0, 7.0, 13.0, 14.0, 50.0];
        let deviation = 2.0 * MAD_TO_SIGMA;
        // Squares are capped at five of these: 44 and (10 · 1.4826)² over nine samples.
        let squares = (44.0 + (5.0 * deviation).powi(2)) / 9.0;
        let sigma = f64::max(deviation, squares.sqrt());
        assert!(sigma > deviation);
        let limit = 39.0 / sigma;
        // With a step of 4 the samples are on a coarse grid, of whose tail nothing is known.
        let found = outliers(&x, rule(9, limit - 1e-6, 4.0)).unwrap();
        let [one] = found.outliers[..] else {
            panic!("{found:?}")
        };
        assert_eq!((one.index, one.value), (8, 50.0));
        assert!((one.sigmas - limit).abs() < 1e-9, "{}", one.sigmas);
        assert_eq!(found.threshold, limit - 1e-6);
        assert!(found.cleaned[8].is_nan() && found.cleaned[..8] == x[..8]);
        assert!(
            outliers(&x, rule(9, limit + 1e-6, 4.0))
                .unwrap()
                .outliers
                .is_empty()
        );
        // A window longer than the record is the record; below, the sign is negative.
        let below = x.map(|v| 20.0 - v);
        let found = outliers(&below, rule(1000, limit - 1e-6, 4.0)).unwrap();
        assert!((found.outliers[0].sigmas + limit).abs() < 1e-9);
    }

    #[test]
    fn no_deviation_is_smaller_than_a_step_or_than_half_of_the_usual_one() {
        let x = [10.0, 9.0, 11.0, 8.0, 12.0, 7.0, 13.0, 14.0, 50.0];
        // A step of 8 in place of 5.4 of the noise.
        let found = outliers(&x, rule(9, 4.8, 8.0)).unwrap();
        assert!((found.outliers[0].sigmas - 39.0 / 8.0).abs() < 1e-12);
        assert!(outliers(&x, rule(9, 4.9, 8.0)).unwrap().outliers.is_empty());
        // Windows of ten about every five samples; the last quarter hardly moves, and half of the usual deviation counts there.
        let mut x: Vec<f64> = (0..400).map(|k| f64::from(k * 37 % 11)).collect();
        for (k, v) in x[300..].iter_mut().enumerate() {
            *v = 0.001 * (k % 3) as f64;
        }
        x[350] = 3000.0;
        let found = outliers(&x, rule(10, 8.0, 0.0)).unwrap();
        let one = found.outliers.iter().find(|one| one.index == 350).unwrap();
        // Of whole numbers 0 to 10 the median deviation is 3; half of it, and 3000 is capped at five of that in ten squares.
        let floor = 1.5 * MAD_TO_SIGMA;
        let sigma = (25.0 * floor * floor / 10.0).sqrt();
        assert!(
            (one.sigmas / (3000.0 / sigma) - 1.0).abs() < 0.01,
            "{one:?}"
        );
    }

    #[test]
    fn where_most_samples_are_equal_the_mean_absolute_deviation_counts() {
        // One in ten is 1: the mean deviation is 0.1, of a normal distribution √(π/2) of that.
        let mut x: Vec<f64> = (0..1000)
            .map(|k| f64::from(u8::from(k % 10 == 0)))
            .collect();
        x[505] = 9.0;
        let found = outliers(&x, rule(100, 8.0, 0.0)).unwrap();
        let [one] = found.outliers[..] else {
            panic!("{found:?}")
        };
        let floor = 0.109 * (std::f64::consts::PI / 2.0).sqrt();
        // Ten ones and 9, capped at five of these, in a hundred squares.
        let capped = (5.0 * floor).min(9.0).powi(2);
        let ones = (5.0 * floor).min(1.0).powi(2);
        let sigma = f64::max(floor, ((10.0 * ones + capped) / 100.0).sqrt());
        assert!((one.sigmas / (9.0 / sigma) - 1.0).abs() < 1e-9, "{one:?}");
    }

    #[test]
    fn each_half_window_is_held_against_the_window_around_it() {
        // The level rises by a million at sample 60; of windows of 20 about ten samples each none has more of the other side.
        let level = |k: i32| if k < 60 { 0.0 } else { 1e6 };
        let x: Vec<f64> = (0..120)
            .map(|k| level(k) + f64::from(k * 37 % 11))
            .collect();
        let found = outliers(&x, rule(20, 30.0, 0.0)).unwrap();
        assert!(found.outliers.is_empty(), "{:?}", found.outliers);
        let one = rule(5, 8.0, 0.0);
        assert!(outliers(&x[..5], one).is_ok() && outliers(&x[..4], one).is_err());
        assert!(
            outliers(&x, rule(4, 8.0, 0.0)).is_err() && outliers(&x, rule(5, 0.0, 0.0)).is_err()
        );
    }
}
