//! What six columns of numbers show of their sensors without any model: axes that repeat a value, that are copies of one another,
//! and that come back from the other end of their range.

use crate::held::{Held, HeldWatch};

/// What the axes of an inertial log show so far, 0 to 2 the gyros x, y, z of the sensor, 3 to 5 its accelerometers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AxisFaults {
    /// The axes that held a value for long, each with its longest.
    pub held: Vec<Held>,
    /// Pairs of axes of one kind that had the same value in every sample.
    pub copied: Vec<[usize; 2]>,
    /// Axes whose numbers are too small for what they measure.
    pub wrapped: Vec<Wrapped>,
}

/// An axis that jumps from one end of its range to the other: its counts have too few bits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wrapped {
    /// 0 to 2 for the gyros x, y, z of the sensor, 3 to 5 for the accelerometers.
    pub axis: usize,
    /// The largest size of a value, as it is in the log.
    pub limit: f64,
    /// Time of the first jump \[s\].
    pub start: f64,
    /// How many jumps.
    pub jumps: u64,
}

/// Pairs of axes of one kind.
const PAIRS: [[usize; 2]; 6] = [[0, 1], [0, 2], [1, 2], [3, 4], [3, 5], [4, 5]];
/// Samples that it takes to call two axes copies.
const LEAST_SAMPLES: u64 = 100;
/// Jumps that it takes to call an axis wrapped.
const LEAST_JUMPS: u64 = 3;
/// Share of the largest size that both sides of a jump have.
const NEAR: f64 = 0.85;
/// What the largest size may grow by without beginning again.
const GROWS: f64 = 1.05;
/// Share of a jump that is the most that the axis changes by from sample to sample, on average.
const SMOOTH: f64 = 0.1;
/// Samples from one whose change is added up to the next.
const EVERY: u64 = 16;

/// Jumps of an axis.
#[derive(Clone, Copy, Default)]
struct Jumps {
    last: f64,
    /// Largest size so far, and that since which jumps are counted.
    most: f64,
    since: f64,
    start: f64,
    jumps: u64,
    /// Sum of the sizes of every sixteenth change, and how many.
    changes: f64,
    count: u64,
}

impl Jumps {
    #[inline]
    fn push(&mut self, time: f64, value: f64) {
        let last = core::mem::replace(&mut self.last, value);
        self.most = self.most.max(value.abs());
        if (value - last).abs() > 2.0 * NEAR * self.most {
            self.jump(time, last, value);
        }
    }

    /// A change by most of the range, or at its very beginning.
    #[cold]
    fn jump(&mut self, time: f64, last: f64, value: f64) {
        if self.most > GROWS * self.since {
            (self.since, self.jumps) = (self.most, 0);
        }
        let near = NEAR * self.most;
        if last.abs().min(value.abs()) > near {
            if self.jumps == 0 {
                self.start = time;
            }
            self.jumps += 1;
        }
    }

    fn wrapped(&self, axis: usize) -> Option<Wrapped> {
        // A jump is a change that counts for itself.
        let usual = SMOOTH * 2.0 * self.most * self.count as f64;
        (self.jumps >= LEAST_JUMPS && self.changes < usual).then_some(Wrapped {
            axis,
            limit: self.most,
            start: self.start,
            jumps: self.jumps,
        })
    }
}

/// Watches the six axes of an inertial log.
#[derive(Clone, Copy, Default)]
pub struct AxisWatch {
    held: HeldWatch,
    jumps: [Jumps; 6],
    samples: u64,
    /// A bit for each of [`PAIRS`] that differed.
    differ: u8,
}

impl AxisWatch {
    /// Takes in the next sample at `time` \[s\], gyros before accelerometers, in any units.
    #[inline]
    pub fn add(&mut self, time: f64, values: [f64; 6]) {
        self.held.add(time, values);
        if self.samples.is_multiple_of(EVERY) {
            for (axis, value) in self.jumps.iter_mut().zip(values) {
                let change = (value - axis.last).abs();
                if change < NEAR * axis.most {
                    axis.changes += change;
                    axis.count += 1;
                }
            }
        }
        for (axis, value) in self.jumps.iter_mut().zip(values) {
            axis.push(time, value);
        }
        self.samples += 1;
        if self.differ != (1 << PAIRS.len()) - 1 {
            for (k, [a, b]) in PAIRS.into_iter().enumerate() {
                self.differ |= u8::from(values[a] != values[b]) << k;
            }
        }
    }

    /// What the samples show so far.
    pub fn faults(&self) -> AxisFaults {
        let held = self.held.held();
        let constant = |axis| held.iter().any(|of| of.axis == axis && of.constant);
        let pairs = PAIRS.into_iter().enumerate();
        let copied = pairs
            .filter(|(k, [axis, _])| self.differ & (1 << k) == 0 && !constant(*axis))
            .map(|(_, pair)| pair)
            .filter(|_| self.samples >= LEAST_SAMPLES)
            .collect();
        let axes = self.jumps.iter().enumerate();
        let wrapped = axes.filter_map(|(axis, of)| of.wrapped(axis)).collect();
        AxisFaults {
            held,
            copied,
            wrapped,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Twenty seconds at 100 Hz of six functions of the axis and the sample's number.
    fn faults(value: impl Fn(usize, f64) -> f64) -> AxisFaults {
        let mut watch = AxisWatch::default();
        for k in 0..2000 {
            let of = |axis| value(axis, f64::from(k));
            watch.add(0.01 * f64::from(k), [0, 1, 2, 3, 4, 5].map(of));
        }
        watch.faults()
    }

    /// A number between −1 and 1 that never repeats soon, another of each axis.
    fn noise(axis: usize, k: f64) -> f64 {
        (k * (78.233 + axis as f64)).sin()
    }

    #[test]
    fn an_axis_that_is_a_copy_of_another_of_its_kind() {
        let sound = faults(noise);
        assert_eq!(sound, AxisFaults::default());
        let copied = faults(|axis, k| noise(if axis == 4 { 3 } else { axis }, k));
        assert_eq!(copied.copied, [[3, 4]]);
        // A gyro with the values of an accelerometer is another kind of fault, and two dead axes are dead.
        let other = faults(|axis, k| noise(if axis == 0 { 3 } else { axis }, k));
        assert_eq!(other.copied, [] as [[usize; 2]; 0]);
        let dead = faults(|axis, k| if axis < 2 { 0.0 } else { noise(axis, k) });
        assert_eq!(dead.copied, [] as [[usize; 2]; 0]);
        // Equal for all but one sample.
        let once = |axis: usize, k: f64| noise(if axis == 4 && k != 900.0 { 3 } else { axis }, k);
        assert_eq!(faults(once).copied, [] as [[usize; 2]; 0]);
    }

    #[test]
    fn an_axis_of_too_few_bits_comes_back_from_the_other_end() {
        let turning = |axis: usize, k: f64| 40.0 * (0.02 * k + axis as f64).sin() + noise(axis, k);
        let wrap = |value: f64, limit: f64| (value + limit).rem_euclid(2.0 * limit) - limit;
        assert_eq!(faults(turning).wrapped, []);
        let found = faults(|axis, k| match axis {
            2 => wrap(turning(2, k), 32.768),
            _ => turning(axis, k),
        });
        let [one] = found.wrapped[..] else {
            panic!("{found:?}")
        };
        assert!(one.axis == 2 && one.jumps > 10, "{one:?}");
        assert!(
            (one.limit / 32.768 - 1.0).abs() < 0.05 && one.start < 4.0,
            "{one:?}"
        );
        // Clipped is not wrapped; nor is vibration that is as large as the range, at half the rate of the samples.
        assert_eq!(
            faults(|axis, k| turning(axis, k).clamp(-30.0, 30.0)).wrapped,
            []
        );
        let shaking = |_, k: f64| if k % 2.0 == 0.0 { 5.0 } else { -5.0 };
        assert_eq!(faults(shaking).wrapped, []);
    }
}
