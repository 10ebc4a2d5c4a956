//! Sums of readings of a vector: their mean and their scatter.

use undrift_nav::Vector3;

/// Sums of readings \[unit\].
#[derive(Clone, Copy, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Readings {
    pub(crate) count: u32,
    sum: Vector3,
    squares: f64,
    /// Sum of the stated variances.
    white: f64,
}

impl Readings {
    pub(crate) fn add(&mut self, reading: &Vector3, std: f64) {
        self.count += 1;
        self.sum += reading;
        self.squares += reading.norm_squared();
        self.white += std * std;
    }

    pub(crate) fn number(&self) -> f64 {
        f64::from(self.count)
    }

    /// Their mean; NaN without readings.
    pub(crate) fn mean(&self) -> Vector3 {
        self.sum / self.number()
    }

    /// Sum of the squares about the mean.
    pub(crate) fn scatter(&self) -> f64 {
        let n = self.number();
        (self.squares - n * self.mean().norm_squared()).max(0.0)
    }

    /// Variance of the mean's white noise: that which is stated, or the `scattered` variance of each where that is larger.
    pub(crate) fn white_of_mean(&self, scattered: f64) -> f64 {
        let n = self.number();
        (self.white / n).max(scattered) / n
    }
}
