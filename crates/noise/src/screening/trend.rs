//! Constant, linear and temperature trend.

use super::record::{Compensated, RecordError, check, mean, mean_and_squares};
use serde::{Deserialize, Serialize};

/// Trend that is removed from a record before identification: the mean, and perhaps a slope.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Trend {
    /// The mean alone.
    Constant,
    /// A straight line.
    Linear,
    /// The mean and, where the record has a temperature, what follows it ([`crate::temperature`]).
    #[default]
    Temperature,
}

impl Trend {
    /// Every kind, in the order of help texts.
    pub const ALL: [Self; 3] = [Self::Constant, Self::Linear, Self::Temperature];

    /// Its name in files and arguments.
    pub fn name(self) -> &'static str {
        match self {
            Self::Constant => "constant",
            Self::Linear => "linear",
            Self::Temperature => "temperature",
        }
    }

    /// The trend of this name; `None` of any other text.
    ///
    /// ```
    /// use undrift_noise::screening::Trend;
    /// assert!(Trend::ALL.iter().all(|trend| Trend::named(trend.name()) == Some(*trend)));
    /// assert_eq!((Trend::named("linear"), Trend::named("cubic")), (Some(Trend::Linear), None));
    /// ```
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|trend| trend.name() == name)
    }
}

/// A record less its trend.
#[derive(Clone, Debug, PartialEq)]
pub struct Detrended {
    /// The residuals \[unit\].
    pub residuals: Vec<f64>,
    /// Mean of the record \[unit\].
    pub mean: f64,
    /// Slope: [unit a sample] for the linear trend, [unit/K] for temperature, 0 for a constant.
    pub slope: f64,
    /// Share of the variance about the mean that the slope explains, 0 to 1.
    pub explained: f64,
}

/// Removes the mean. It is what a record at rest needs: anything more removes part of the slow noise that is to be identified.
///
/// # Errors
/// No sample, a sample that is not finite.
///
/// ```
/// let found = undrift_noise::screening::remove_constant(&[1.0, 2.0, 6.0])?;
/// assert_eq!((found.mean, found.residuals), (3.0, vec![-2.0, -1.0, 3.0]));
/// # Ok::<(), undrift_noise::screening::RecordError>(())
/// ```
pub fn remove_constant(x: &[f64]) -> Result<Detrended, RecordError> {
    check(x, 1)?;
    let mean = mean(x);
    Ok(Detrended {
        residuals: x.iter().map(|v| v - mean).collect(),
        mean,
        slope: 0.0,
        explained: 0.0,
    })
}

/// Removes the mean and a straight line, by least squares. Of a random walk a line always explains much: what is left of it
/// looks less like one than it is.
///
/// ```
/// let warming: Vec<f64> = (0..100).map(|k| 5.0 + 0.01 * f64::from(k)).collect();
/// let found = undrift_noise::screening::remove_linear(&warming)?;
/// assert!((found.slope - 0.01).abs() < 1e-12 && found.explained > 0.999);
/// assert!(found.residuals.iter().all(|left| left.abs() < 1e-12));
/// # Ok::<(), undrift_noise::screening::RecordError>(())
/// ```
///
/// # Errors
/// Fewer than 3 samples, a sample that is not finite.
pub fn remove_linear(x: &[f64]) -> Result<Detrended, RecordError> {
    check(x, 3)?;
    Ok(linear(x))
}

/// Does [`remove_linear`] on a record that has been checked.
pub(crate) fn linear(x: &[f64]) -> Detrended {
    let middle = 0.5 * (x.len() - 1) as f64;
    regress(x, |k| k as f64 - middle)
}

/// Removes the mean and a multiple of the temperature (`temperature_c` [°C or K], one a sample), by ordinary
/// least squares. A temperature that only drifts cannot be distinguished from a linear trend, and beside a random walk the slope is
/// wrong by many of its standard errors: [`crate::temperature`] allows for that.
///
/// # Errors
/// Fewer than 3 samples, a sample that is not finite, lengths that differ, [`RecordError::Constant`]
/// where the temperature does not change.
///
/// ```
/// use undrift_noise::screening::remove_temperature;
/// let temperature: Vec<f64> = (0..200).map(|k| 25.0 + 5.0 * (0.05 * f64::from(k)).sin()).collect();
/// let record: Vec<f64> = temperature.iter().map(|t| 0.1 + 2e-4 * t).collect();
/// let found = remove_temperature(&record, &temperature)?;
/// assert!((found.slope - 2e-4).abs() < 1e-12 && found.explained > 0.999); // [unit/K]
/// # Ok::<(), undrift_noise::screening::RecordError>(())
/// ```
pub fn remove_temperature(x: &[f64], temperature_c: &[f64]) -> Result<Detrended, RecordError> {
    check(x, 3)?;
    check(temperature_c, 3)?;
    if x.len() != temperature_c.len() {
        return Err(RecordError::Argument(
            "one temperature per sample is needed",
        ));
    }
    let (centre, squares) = mean_and_squares(temperature_c);
    if squares <= 16.0 * f64::EPSILON * centre * centre * x.len() as f64 {
        return Err(RecordError::Constant);
    }
    Ok(regress(x, |k| temperature_c[k] - centre))
}

/// Least squares on one regressor whose mean is 0.
fn regress(x: &[f64], regressor: impl Fn(usize) -> f64) -> Detrended {
    let (mean, squares) = mean_and_squares(x);
    let (mut products, mut norm) = (Compensated::default(), Compensated::default());
    for (k, value) in x.iter().enumerate() {
        let r = regressor(k);
        products.add(r * (value - mean));
        norm.add(r * r);
    }
    let slope = products.value() / norm.value();
    let residuals = x
        .iter()
        .enumerate()
        .map(|(k, value)| value - mean - slope * regressor(k))
        .collect();
    let explained = if squares > 0.0 {
        (slope * products.value() / squares).clamp(0.0, 1.0)
    } else {
        0.0
    };
    Detrended {
        residuals,
        mean,
        slope,
        explained,
    }
}
