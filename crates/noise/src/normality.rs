//! Is a record normally distributed? Jarque-Bera, Kolmogorov-Smirnov and Lilliefors, with the effect
//! sizes that matter at a million samples and the quantisation step that makes every test reject.
//!
//! ```
//! let x: Vec<f64> = (0..300).map(|k| f64::from(k * 7919 % 101)).collect();
//! let report = undrift_noise::normality::normality(&x)?;
//! assert!(report.kurtosis_excess < -1.0);
//! assert_eq!(report.quantisation.unwrap().step, 1.0);
//! # Ok::<(), undrift_noise::screening::RecordError>(())
//! ```

mod distance;
pub mod kolmogorov;
pub mod quantisation;

pub use kolmogorov::{lilliefors_critical_5, lilliefors_p, plain_critical_5, plain_p};
pub use quantisation::{Quantisation, quantisation_of_sorted};

use crate::screening::record::{RecordError, check_varying, sum_of};
use serde::{Deserialize, Serialize};

/// 5 % critical value of chi-squared with 2 degrees of freedom, −2 ln 0.05.
pub const JARQUE_BERA_CRITICAL_5: f64 = 5.991_464_547_107_98;

/// A test that rejects normality where its statistic is above its critical value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Test {
    /// Value of the statistic [–].
    pub statistic: f64,
    /// Critical value at 5 %.
    pub critical_5: f64,
    /// Probability of a larger statistic if the samples were normal and independent. Of a million samples it is small for departures that
    /// no filter notices, and of correlated samples it is too small: read the effect sizes beside it.
    pub p_value: f64,
}

/// Moments of a record, three tests of normality, and the step of its quantisation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Normality {
    /// Number of samples.
    pub samples: usize,
    /// Mean \[unit\].
    pub mean: f64,
    /// Standard deviation, divisor n − 1 \[unit\].
    pub deviation: f64,
    /// Skewness m₃/m₂^{3/2}, moments with divisor n; 0 for a normal distribution.
    pub skewness: f64,
    /// Excess kurtosis m₄/m₂² − 3; 0 for a normal distribution.
    pub kurtosis_excess: f64,
    /// Jarque & Bera (Economics Letters 6, 1980): n/6 (skewness² + kurtosis²/4), chi-squared with 2 degrees
    /// of freedom when the record is normal.
    pub jarque_bera: Test,
    /// Kolmogorov-Smirnov distance to the normal distribution of the record's own mean and deviation, as if
    /// that were known beforehand, which is how the source paper compares: too lenient.
    pub ks: Test,
    /// The same distance by Lilliefors' test, which allows for the mean and deviation being fitted (Dallal & Wilkinson, Stephens; as R's
    /// nortest).
    pub lilliefors: Test,
    /// The grid the samples lie on, where there is one.
    pub quantisation: Option<Quantisation>,
}

/// Skewness, excess kurtosis, and the test of Jarque & Bera that is made of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JarqueBera {
    /// Jarque & Bera (Economics Letters 6, 1980): n/6 (skewness² + kurtosis²/4).
    pub statistic: f64,
    /// Probability of a larger statistic of a normal record, by chi-squared with 2 degrees of freedom.
    pub p_value: f64,
    /// Skewness m₃/m₂^{3/2}, moments with divisor n; 0 for a normal distribution.
    pub skewness: f64,
    /// Excess kurtosis m₄/m₂² − 3; 0 for a normal distribution.
    pub kurtosis_excess: f64,
}

/// Jarque-Bera test alone; O(N) time, no memory. At a million samples it rejects a skewness of 0.006 or an excess
/// kurtosis of 0.012, which no filter notices: look at these numbers before the p.
///
/// # Errors
/// Fewer than 5 samples, a sample that is not finite, a constant record.
///
/// ```
/// use undrift_nav::shaping::ShapingFilter;
/// use undrift_noise::{normality::jarque_bera, synthesis::NoiseGenerator};
/// let normal: Vec<f64> = NoiseGenerator::new(&ShapingFilter::white(1e-3, 0.01)?, 1).take(5000).collect();
/// assert!(jarque_bera(&normal)?.p_value > 0.05);
/// let heavy: Vec<f64> = normal.iter().map(|x| x * x.abs()).collect();
/// let test = jarque_bera(&heavy)?;
/// assert!(test.kurtosis_excess > 3.0 && test.p_value < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn jarque_bera(x: &[f64]) -> Result<JarqueBera, RecordError> {
    let (mean, squares) = check_varying(x, 5)?;
    Ok(jarque_bera_about(x, mean, squares))
}

/// The test of a record of known mean and sum of squared deviations from it.
fn jarque_bera_about(x: &[f64], mean: f64, squares: f64) -> JarqueBera {
    let count = x.len() as f64;
    let scale = (squares / count).sqrt();
    // Standardised before the powers, which could overflow.
    let skewness = sum_of(x, |v| ((v - mean) / scale).powi(3)) / count;
    let kurtosis_excess = sum_of(x, |v| ((v - mean) / scale).powi(4)) / count - 3.0;
    let statistic = count / 6.0 * (skewness * skewness + 0.25 * kurtosis_excess * kurtosis_excess);
    JarqueBera {
        statistic,
        p_value: (-0.5 * statistic).exp(),
        skewness,
        kurtosis_excess,
    }
}

/// Moments, tests and quantisation step of a record; O(N log N) time, one sorted copy for the step.
///
/// # Errors
/// Fewer than 5 samples, a sample that is not finite, a constant record.
///
/// A gyro at rest whose samples are rounded to steps of a tenth of their deviation is rejected by every test at
/// 10⁶ samples, and no filter notices. So look at skewness and excess kurtosis first, then whether
/// [`Normality::quantisation`] explains the rest.
///
/// ```
/// use undrift_nav::shaping::ShapingFilter;
/// use undrift_noise::{normality::normality, synthesis::NoiseGenerator};
/// let noise = NoiseGenerator::new(&ShapingFilter::white(0.1, 0.01)?, 1); // σ = N/√T = 1.
/// let rounded: Vec<f64> = noise.take(20_000).map(f64::round).collect();
/// let report = normality(&rounded)?;
/// assert_eq!(report.quantisation.map(|grid| grid.step), Some(1.0));
/// assert!(report.lilliefors.p_value < 0.001, "rejected for its steps");
/// assert!(report.skewness.abs() < 0.06 && report.kurtosis_excess.abs() < 0.15, "and near normal in shape");
/// // Rounding adds the variance of a uniform error, step²/12.
/// assert!((report.deviation.powi(2) - (1.0 + 1.0 / 12.0)).abs() < 0.04);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn normality(x: &[f64]) -> Result<Normality, RecordError> {
    check_varying(x, 5)?;
    normality_on(x, quantisation(x))
}

/// Does [`normality`] of a record whose grid is known.
pub(crate) fn normality_on(
    x: &[f64],
    quantisation: Option<Quantisation>,
) -> Result<Normality, RecordError> {
    let (mean, squares) = check_varying(x, 5)?;
    let test = jarque_bera_about(x, mean, squares);
    let deviation = (squares / (x.len() as f64 - 1.0)).sqrt();
    let distance = distance::distance(x, mean, deviation);
    Ok(Normality {
        samples: x.len(),
        mean,
        deviation,
        skewness: test.skewness,
        kurtosis_excess: test.kurtosis_excess,
        jarque_bera: Test {
            statistic: test.statistic,
            critical_5: JARQUE_BERA_CRITICAL_5,
            p_value: test.p_value,
        },
        ks: Test {
            statistic: distance,
            critical_5: plain_critical_5(x.len()),
            p_value: plain_p(distance, x.len()),
        },
        lilliefors: Test {
            statistic: distance,
            critical_5: lilliefors_critical_5(x.len()),
            p_value: lilliefors_p(distance, x.len()),
        },
        quantisation,
    })
}

/// The grid that the samples lie on, if they do; `None` too of a record that is constant, shorter than 2 samples or not
/// finite.
///
/// ```
/// let counts: Vec<f64> = (0..300).map(|k| 0.25 * f64::from(k * 7919 % 11)).collect();
/// let grid = undrift_noise::normality::quantisation(&counts).expect("11 levels");
/// assert_eq!((grid.step, grid.levels), (0.25, 11));
/// ```
pub fn quantisation(x: &[f64]) -> Option<Quantisation> {
    let (_, squares) = check_varying(x, 2).ok()?;
    let mut sorted = x.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    quantisation_of_sorted(&sorted, (squares / (x.len() as f64 - 1.0)).sqrt())
}
