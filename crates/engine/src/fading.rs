//! A covariance that grows while the innovations are larger than it predicts.

use crate::median::upper_median;
use undrift_nav::{
    Vector3,
    filter::{Outcome, Update},
};

/// Innovations of which the median tells their size: outliers alone are not the solution's fault.
const WINDOW: usize = 16;
/// Median of χ²(3)/3.
const MEDIAN: f64 = 0.789;

/// Size of the last sixteen innovations squared, by their median, over the usual one, from which the covariance grows;
/// all sizes here are NIS per degree of freedom.
const FROM: f64 = 4.0;
/// Largest factor on the covariance by one update.
const MOST: f64 = 1.5;
/// One innovation counts up to this many times the usual NIS.
const CLIP: f64 = 10.0;
/// Autocorrelation of innovations from which they may be correlated measurements.
const CORRELATED: f64 = 0.3;
/// By what part the usual NIS follows each.
const GAIN: f64 = 0.005;
/// Updates after which the usual NIS is known.
const LEAST: u32 = 40;
/// Least usual NIS: standard deviations stated twice too large.
const LEAST_USUAL: f64 = 0.25;
/// Standard deviation of the heading beyond which nothing is gained \[rad\].
pub(super) const MOST_HEADING: f64 = 0.5;

/// The size of the innovations of one kind of measurement, now and as a rule.
#[derive(Clone, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Fading {
    recent: [f64; WINDOW],
    count: u32,
    usual: f64,
    /// Whitened innovation of the last update, and means of its products with the one before and with itself.
    last: Vector3,
    products: f64,
    squares: f64,
}

impl Fading {
    pub(super) fn new() -> Self {
        Self {
            usual: 1.0,
            ..Self::default()
        }
    }

    /// By what the covariance is multiplied after an update; `known` where the noise of the measurement itself is
    /// known to be as stated: white innovations that are always larger are then the solution's fault. Correlated ones
    /// may be the measurement's.
    pub(super) fn factor(&mut self, update: &Update, known: bool) -> f64 {
        if update.outcome == Outcome::Rejected {
            return 1.0;
        }
        let nis = update.nis / update.dof as f64;
        let usual = self.usual.max(LEAST_USUAL);
        let white = self.products < CORRELATED * self.squares;
        let usual = if known && white {
            usual.min(1.0)
        } else {
            usual
        };
        let nis = nis.min(CLIP * usual);
        self.recent[self.count as usize % WINDOW] = nis;
        self.count += 1;
        let gain = GAIN.max(1.0 / f64::from(self.count));
        self.usual += gain * (nis.min(FROM * usual) - self.usual);
        let now = Vector3::from(update.whitened).map(|w| w.clamp(-CLIP, CLIP));
        self.products += gain * (now.dot(&self.last) - self.products);
        self.squares += gain * (now.norm_squared() - self.squares);
        self.last = now;
        let size = upper_median(&mut self.recent.clone()) / MEDIAN;
        if self.count < LEAST || size < FROM * usual {
            return 1.0;
        }
        (size / (FROM * usual)).min(MOST)
    }
}

#[cfg(test)]
mod tests;
