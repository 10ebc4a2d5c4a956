//! Outliers by the median and the median absolute deviation of a moving window (Hampel, J. American
//! Statistical Association 69, 1974).

use super::record::{RecordError, check};
use super::tail;
use crate::order_statistics::{MAD_TO_SIGMA, upper_median};
use serde::{Deserialize, Serialize};

/// Median deviations at which squares are capped.
const CAP: f64 = 5.0;

/// When a sample is an outlier.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutlierRule {
    /// Samples of the moving window.
    pub window: usize,
    /// Robust standard deviations from the window's median; more where the noise's own tail is heavier than normal.
    pub sigmas: f64,
    /// Step of quantised samples [unit], 0 where there is none: no deviation counts as smaller.
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

/// One outlier.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Outlier {
    /// Its position, from 0.
    pub index: usize,
    /// Its value [unit].
    pub value: f64,
    /// Its distance from the local median, in robust standard deviations (signed).
    pub sigmas: f64,
}

/// Outliers, and the record without them.
#[derive(Clone, Debug, PartialEq)]
pub struct Outliers {
    /// The outliers by position.
    pub outliers: Vec<Outlier>,
    /// The record with NaN, that is missing, in their places [unit].
    pub cleaned: Vec<f64>,
    /// Robust standard deviations beyond which a sample is an outlier.
    pub threshold: f64,
}

/// Finds the outliers of a record. Each half window is held against the median and the deviation of
/// the window around it: O(N). The median deviation of quantised samples jumps by whole steps: it is
/// not let below half of its median over all windows (below the mean absolute deviation of the record,
/// where that is 0), nor below the root mean square of the window with squares capped at five of it, nor below the
/// step. Of heavy-tailed noise nothing is an outlier that Student's t with the tail of the bulk can have made.
///
/// # Errors
/// Fewer than 5 samples, a sample that is not finite, a window below 5 or a threshold that
/// is not positive.
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
