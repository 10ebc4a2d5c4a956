//! How much the delay of fixes changes, by the stamps themselves.
//!
//! A receiver measures at even times. Stamps that are made when a fix arrives come unevenly, and by as much as they do the delay
//! of one fix is another than that of the next. What is white of it is the study's to find ([`crate::fixes`]); what adds up from fix to fix is
//! a random walk of the time offset: with D(n) the mean square of what n intervals on end are longer than usual, q² = (D(8) − D(1)) / 7 Δ.
//! Even stamps say nothing: a clock may be even and wrong.

use alloc::collections::VecDeque;
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;

/// Stamps that are looked at.
const WINDOW: usize = 64;
/// Intervals on end that are compared with single ones.
const MANY: usize = 8;
/// An interval of more than this many usual ones is a gap: stamps before it are forgotten.
const GAP: f64 = 1.5;
/// More than this [s/√s] is no delay that wanders.
const MOST: f64 = 0.05;

/// The last stamps of fixes.
#[derive(Clone, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Stamps {
    last: VecDeque<f64>,
}

impl Stamps {
    /// Takes in a stamp \[s\]; by how much the delay has changed since the one before, one standard deviation \[s\].
    pub(super) fn next(&mut self, time: f64) -> f64 {
        let interval = self.interval();
        let since = self.last.back().map_or(0.0, |last| time - last);
        if since <= 0.0 || interval.is_some_and(|usual| since > GAP * usual) {
            self.last.clear();
        }
        self.last.push_back(time);
        if self.last.len() <= WINDOW {
            return 0.0;
        }
        self.last.pop_front();
        match self.interval() {
            Some(usual) => {
                let walk = (self.longer(MANY, usual) - self.longer(1, usual)) / (MANY - 1) as f64;
                (walk / usual).clamp(0.0, MOST * MOST).sqrt() * since.max(0.0).sqrt()
            }
            None => 0.0,
        }
    }

    /// Mean interval \[s\].
    fn interval(&self) -> Option<f64> {
        let (first, last) = (self.last.front()?, self.last.back()?);
        (self.last.len() > 1).then(|| (last - first) / (self.last.len() - 1) as f64)
    }

    /// Mean square of what `n` intervals on end are longer than usual \[s²\].
    fn longer(&self, n: usize, usual: f64) -> f64 {
        let spans = self.last.iter().zip(self.last.iter().skip(n));
        let sum: f64 = spans.map(|(a, b)| (b - a - n as f64 * usual).powi(2)).sum();
        sum / (self.last.len() - n) as f64
    }
}

#[cfg(test)]
mod tests;
