//! A record that is not static: it moves, or its sensor repeats one value.
//!
//! Two tests: means of neighbouring windows against the noise inside them ([`motion`]), and runs of equal
//! samples ([`constant_runs`]). A slow bias changes a mean over a second by less than the noise does, and
//! passes; a hand that touches the table does not.

use super::record::{RecordError, check, mean_and_squares};
use serde::{Deserialize, Serialize};
use undrift_base::order_statistics::upper_median;

/// Limits from which a record counts as moving. The default suits records of sensors on a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionRule {
    /// Number of samples of a window; about a second.
    pub window: usize,
    /// A window moves where the square of the change of its mean is this many times what the white
    /// noise inside the windows allows.
    pub factor: f64,
    /// The record moves where more than this share of its windows does.
    pub share: f64,
    /// Step of quantised samples \[unit\], 0 where there is none: a mean that goes from one level to the next does not move.
    pub step: f64,
}

impl Default for MotionRule {
    /// 100 samples, 50 times, 1 % of the windows: flicker noise and vibration stay far below, a
    /// single knock is reported but is no motion.
    fn default() -> Self {
        Self {
            window: 100,
            factor: 50.0,
            share: 0.01,
            step: 0.0,
        }
    }
}

/// Finding of the comparison of window means: whether a record is static.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Motion {
    /// Half the mean square change between the means of neighbouring windows over what the white noise in
    /// the windows allows, by their samples or the means of their quarters: about 1 for white noise, behind a low-pass filter too; a
    /// drift hardly adds to it.
    pub ratio: f64,
    /// First samples of the windows whose mean changed too much from the window before.
    pub moving_windows: Vec<usize>,
    /// Number of windows compared.
    pub windows: usize,
    /// Whether the record moves: more windows than the rule allows.
    pub moving: bool,
}

/// Compares the changes between the means of neighbouring windows with the variance inside the windows, O(N).
///
/// ```
/// use undrift_nav::shaping::ShapingFilter;
/// use undrift_noise::{screening::{MotionRule, motion}, synthesis::NoiseGenerator};
/// let mut record: Vec<f64> = NoiseGenerator::new(&ShapingFilter::white(1e-3, 0.01)?, 1).take(10_000).collect();
/// assert!(!motion(&record, MotionRule::default())?.moving);
/// for (k, sample) in record[4000..6000].iter_mut().enumerate() {
///     *sample += 0.2 * (0.01 * k as f64).sin(); // The sensor is turned to and fro.
/// }
/// assert!(motion(&record, MotionRule::default())?.moving);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// A sample that is not finite, fewer than three windows, a window below 2 or a factor that
/// is not positive.
pub fn motion(x: &[f64], rule: MotionRule) -> Result<Motion, RecordError> {
    motion_where(x, rule, |_| true)
}

/// The same of the windows that are known, by the positions of their samples.
///
/// # Errors
/// As above, of fewer than three known windows too.
pub(crate) fn motion_where(
    x: &[f64],
    rule: MotionRule,
    known: impl Fn(std::ops::Range<usize>) -> bool,
) -> Result<Motion, RecordError> {
    if rule.window < 2 || rule.factor.is_nan() || rule.factor <= 0.0 {
        return Err(RecordError::Argument(
            "the motion rule needs 2 samples a window and a positive factor",
        ));
    }
    check(x, rule.window.saturating_mul(3))?;
    let width = rule.window as f64;
    let windows = x.chunks_exact(rule.window).enumerate();
    let windows = windows.filter(|(k, _)| known(k * rule.window..(k + 1) * rule.window));
    let (places, windows): (Vec<usize>, Vec<&[f64]>) = windows.unzip();
    if windows.len() < 3 {
        return Err(RecordError::Argument("too few windows have samples"));
    }
    let summary: Vec<(f64, f64)> = windows.iter().map(|w| mean_and_squares(w)).collect();
    let mut variances: Vec<f64> = summary.iter().map(|s| s.1 / (width - 1.0)).collect();
    let inside = upper_median(&mut variances);
    let mut of_quarters: Vec<f64> = windows.iter().filter_map(|w| by_quarters(w)).collect();
    let of_quarters = match of_quarters.is_empty() {
        true => 0.0,
        false => upper_median(&mut of_quarters) / QUARTERS_MEDIAN,
    };
    let changes: Vec<f64> = summary
        .windows(2)
        .map(|w| 0.5 * (w[1].0 - w[0].0).powi(2))
        .collect();
    let total = changes.iter().sum::<f64>() / changes.len() as f64;
    let white = (inside / width).max(of_quarters);
    let allowed = white.max(rule.step * rule.step / rule.factor);
    let ratio = if total == 0.0 { 0.0 } else { total / allowed };
    let moving_windows: Vec<usize> = changes
        .iter()
        .enumerate()
        .filter(|(_, change)| **change > rule.factor * allowed)
        .filter_map(|(k, _)| Some(places.get(k + 1)? * rule.window))
        .collect();
    let moving = moving_windows.len() as f64 > rule.share * changes.len() as f64;
    Ok(Motion {
        ratio,
        windows: changes.len(),
        moving_windows,
        moving,
    })
}

/// Median of χ² with 2 degrees of freedom over its mean.
const QUARTERS_MEDIAN: f64 = std::f64::consts::LN_2;

/// Variance of the mean of a window by the scatter of the means of its quarters about a straight line: of noise behind a low-pass filter
/// neighbouring samples tell too little; those means are as good as independent, and show the level of its spectrum near zero.
fn by_quarters(window: &[f64]) -> Option<f64> {
    let quarter = window.len() / 4;
    if quarter < 2 {
        return None;
    }
    let means = window.chunks_exact(quarter).take(4);
    let means: Vec<f64> = means.map(|part| mean_and_squares(part).0).collect();
    // At −1.5, −0.5, 0.5 and 1.5, whose squares are 5.
    let [a, b, c, d] = means[..] else { return None };
    let slope = (1.5 * (d - a) + 0.5 * (c - b)) / 5.0;
    let rest = mean_and_squares(&means).1 - 5.0 * slope * slope;
    Some(rest.max(0.0) / 2.0 / 4.0)
}

/// A stretch of equal samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Hanging {
    /// Position of the first sample, from 0.
    pub index: usize,
    /// Number of samples.
    pub samples: usize,
}

/// Stretches of at least `least` equal samples. A sensor that hangs gives one; a constant record is one
/// from end to end. Quantised samples repeat by chance, so `least` should be large (1000 samples).
///
/// ```
/// use undrift_noise::screening::constant_runs;
/// let mut x: Vec<f64> = (0..5000).map(|k| f64::from(k * 7919 % 101)).collect();
/// x[2000..4000].fill(7.0);
/// let runs = constant_runs(&x, 1000);
/// assert_eq!((runs[0].index, runs[0].samples), (2000, 2000));
/// ```
pub fn constant_runs(x: &[f64], least: usize) -> Vec<Hanging> {
    let mut runs = Vec::new();
    let mut start = 0;
    for k in 1..=x.len() {
        if k == x.len() || x[k] != x[start] {
            let (index, samples) = (start, k - start);
            if samples >= least.max(2) {
                runs.push(Hanging { index, samples });
            }
            start = k;
        }
    }
    runs
}
