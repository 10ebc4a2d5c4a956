//! A covariance that grows while the innovations are larger than it predicts.

use crate::median::upper_median;
use crate::settings::FadingSettings;
use undrift_nav::{
    Vector3,
    filter::{Outcome, Update},
};

/// Innovations of which the median tells their size: outliers alone are not the solution's fault.
const WINDOW: usize = 16;
/// Median of χ²(3)/3.
const MEDIAN: f64 = 0.789;

/// The size of the innovations of one kind of measurement, now and as a rule.
#[derive(Clone, Default)]
pub(super) struct Fading {
    set: FadingSettings,
    recent: [f64; WINDOW],
    count: u32,
    usual: f64,
    /// Whitened innovation of the last update, and means of its products with the one before and with itself.
    last: Vector3,
    products: f64,
    squares: f64,
}

impl Fading {
    pub(super) fn new(set: FadingSettings) -> Self {
        Self {
            set,
            usual: 1.0,
            ..Self::default()
        }
    }

    /// By what the covariance is multiplied after an update; `known` where the noise of the measurement itself is
    /// known to be as stated: white innovations that are always larger are then the solution's fault. Correlated ones
    /// may be the measurement's.
    pub(super) fn factor(&mut self, update: &Update, known: bool) -> f64 {
        let set = &self.set;
        if update.outcome == Outcome::Rejected {
            return 1.0;
        }
        let nis = update.nis / update.dof as f64;
        let usual = self.usual.max(set.least_usual);
        let white = self.products < set.correlated * self.squares;
        let usual = if known && white {
            usual.min(1.0)
        } else {
            usual
        };
        let nis = nis.min(set.clip * usual);
        self.recent[self.count as usize % WINDOW] = nis;
        self.count += 1;
        let gain = set.gain.max(1.0 / f64::from(self.count));
        self.usual += gain * (nis.min(set.from * usual) - self.usual);
        let now = Vector3::from(update.whitened).map(|w| w.clamp(-set.clip, set.clip));
        self.products += gain * (now.dot(&self.last) - self.products);
        self.squares += gain * (now.norm_squared() - self.squares);
        self.last = now;
        let size = upper_median(&mut self.recent.clone()) / MEDIAN;
        if self.count < set.least || size < set.from * usual {
            return 1.0;
        }
        (size / (set.from * usual)).min(set.most)
    }
}

#[cfg(test)]
mod tests;
