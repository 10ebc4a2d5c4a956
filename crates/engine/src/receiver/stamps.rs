//! How much the delay of fixes changes, by the stamps themselves.
//!
//! A receiver measures at even times. Stamps that are made when a fix arrives come unevenly, and by as much as they do the delay
//! of one fix is another than that of the next. What is white of it is the study's to find ([`crate::fixes`]); what adds up from fix to fix is
//! a random walk of the time offset: with D(n) the mean square of what n intervals on end are longer than usual, q² = (D(8) − D(1)) / 7 Δ.
//! Even stamps say nothing: a clock may be even and wrong.

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

/// The last stamps of fixes, in a ring: what is cloned with a snapshot allocates nothing.
#[derive(Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Stamps {
    #[cfg_attr(feature = "checkpoint", serde(with = "crate::kept::array"))]
    ring: [f64; WINDOW],
    /// Place of the next one, and how many there are.
    next: usize,
    count: usize,
}

impl Default for Stamps {
    fn default() -> Self {
        Self {
            ring: [0.0; WINDOW],
            next: 0,
            count: 0,
        }
    }
}

impl Stamps {
    /// Takes in a stamp \[s\]; by how much the delay has changed since the one before, one standard deviation \[s\].
    pub(super) fn next(&mut self, time: f64) -> f64 {
        let interval = self.interval();
        let newest = self.count.checked_sub(1);
        let since = newest.map_or(0.0, |newest| time - self.at(newest));
        if since <= 0.0 || interval.is_some_and(|usual| since > GAP * usual) {
            self.count = 0;
        }
        let full = self.count == WINDOW;
        self.ring[self.next] = time;
        self.next = (self.next + 1) % WINDOW;
        self.count = WINDOW.min(self.count + 1);
        if !full {
            return 0.0;
        }
        match self.interval() {
            Some(usual) => {
                let walk = (self.longer(MANY, usual) - self.longer(1, usual)) / (MANY - 1) as f64;
                (walk / usual).clamp(0.0, MOST * MOST).sqrt() * since.max(0.0).sqrt()
            }
            None => 0.0,
        }
    }

    /// The stamp at this place, of the oldest first \[s\].
    fn at(&self, place: usize) -> f64 {
        self.ring[(self.next + WINDOW - self.count + place) % WINDOW]
    }

    /// Mean interval \[s\].
    fn interval(&self) -> Option<f64> {
        let last = self.count.checked_sub(1).filter(|last| *last > 0)?;
        Some((self.at(last) - self.at(0)) / last as f64)
    }

    /// Mean square of what `n` intervals on end are longer than usual \[s²\].
    fn longer(&self, n: usize, usual: f64) -> f64 {
        let spans = (n..self.count).map(|k| self.at(k) - self.at(k - n));
        let sum: f64 = spans.map(|span| (span - n as f64 * usual).powi(2)).sum();
        sum / (self.count - n) as f64
    }
}

#[cfg(test)]
mod tests;
