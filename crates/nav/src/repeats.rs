//! Values that a sensor axis repeats: how long they usually last, and which lasted longer than noise explains.
//!
//! A frozen axis repeats a value for [`FROZEN_TIMES`] times as many samples as it usually does; a saturated one its largest or
//! smallest value, for fewer. Rounded values of a quiet sensor repeat too, so it is the ratio to the usual that counts. What is
//! done with it is the callers': a reader names the axis in words, a navigator replaces the samples while they come.
//!
//! ```
//! use undrift_nav::repeats::{FROZEN_TIMES, Repeats};
//! let mut axis = Repeats::default();
//! for k in 0..1000 {
//!     let value = if (300..450).contains(&k) { 0.25 } else { f64::from(k) };
//!     axis.push(0.01 * f64::from(k), value);
//! }
//! assert!((axis.longest.value, axis.longest.samples) == (0.25, 150));
//! assert!(axis.longest.samples as f64 > FROZEN_TIMES * axis.usual_beside(&axis.longest));
//! ```

/// A frozen axis holds a value for this many times the usual number of samples.
pub const FROZEN_TIMES: f64 = 20.0;
/// A saturated one does so with its largest or smallest value.
pub const SATURATED_TIMES: f64 = 5.0;

/// Samples of one value on end.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Repeat {
    /// The value, in the axis's unit.
    pub value: f64,
    /// Time of its first sample \[s\].
    pub start: f64,
    /// Time of its last sample \[s\].
    pub end: f64,
    /// How many samples have it; 0 before the first.
    pub samples: u64,
}

/// The values of an axis so far, each with how long it lasted. A number that is not finite is one like any other.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Repeats {
    /// The value that has not come to an end.
    pub present: Repeat,
    /// Values that came to an end, and their samples.
    pub ended: u64,
    samples: u64,
    /// Of those that ended the longest, and the longest at the smallest and at the largest value.
    pub longest: Repeat,
    /// The longest at the smallest value.
    pub least: Repeat,
    /// The longest at the largest value.
    pub most: Repeat,
}

impl Repeats {
    /// Takes in the next sample at `time` \[s\].
    #[inline]
    pub fn push(&mut self, time: f64, value: f64) {
        if value == self.present.value && self.present.samples > 0 {
            self.prolong(time);
        } else {
            self.renew(time, value);
        }
    }

    /// The sample at `time` \[s\] repeats the value, as its caller knows: a rounding may be between them.
    #[inline]
    pub fn prolong(&mut self, time: f64) {
        self.present.samples += 1;
        self.present.end = time;
    }

    /// The sample at `time` \[s\] has another value.
    #[inline]
    pub fn renew(&mut self, time: f64, value: f64) {
        self.end();
        self.present = Repeat {
            value,
            start: time,
            end: time,
            samples: 1,
        };
    }

    /// The present value has come to an end.
    #[inline]
    pub fn end(&mut self) {
        let Repeat { value, samples, .. } = self.present;
        if samples == 0 {
            return;
        }
        self.ended += 1;
        self.samples += samples;
        if samples > self.longest.samples {
            self.longest = self.present;
        }
        let longer = |of: &Repeat| value == of.value && samples > of.samples;
        if self.ended == 1 || value < self.least.value || longer(&self.least) {
            self.least = self.present;
        }
        if self.ended == 1 || value > self.most.value || longer(&self.most) {
            self.most = self.present;
        }
        self.present.samples = 0;
    }

    /// Samples that a value usually lasts, of those that ended.
    #[inline]
    pub fn usual(&self) -> f64 {
        self.samples as f64 / self.ended as f64
    }

    /// The same of all others than `one`, which has ended too.
    pub fn usual_beside(&self, one: &Repeat) -> f64 {
        (self.samples - one.samples) as f64 / self.ended.saturating_sub(1).max(1) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_counted_by_how_long_they_last() {
        let mut axis = Repeats::default();
        for (k, value) in [1.0, 1.0, 3.0, 2.0, 2.0, 2.0, 1.0].into_iter().enumerate() {
            axis.push(k as f64, value);
        }
        assert_eq!((axis.ended, axis.usual()), (3, 2.0));
        axis.end();
        // Twice at its end is once.
        axis.end();
        assert_eq!((axis.ended, axis.usual()), (4, 7.0 / 4.0));
        let repeat = |value, start, end, samples| Repeat {
            value,
            start,
            end,
            samples,
        };
        assert_eq!(axis.longest, repeat(2.0, 3.0, 5.0, 3));
        assert_eq!(axis.least, repeat(1.0, 0.0, 1.0, 2));
        assert_eq!(axis.most, repeat(3.0, 2.0, 2.0, 1));
        assert_eq!(axis.usual_beside(&axis.longest), 4.0 / 3.0);
    }
}
