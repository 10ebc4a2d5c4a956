//! Samples that a logger writes again until the sensor has a new one.

use super::{Record, own_values};
use undrift_noise::screening::timing;
pub use undrift_results::recording::Repeated;

/// Share of the samples that are the ones before, at least.
const REPEATED: f64 = 0.3;
/// Samples apart that are equal by chance alone, and their share of those that are equal to the one before.
const APART: usize = 7;
const CHANCE: f64 = 0.5;

impl Record {
    /// The record without samples that a logger repeated until there was a new one, which are no noise of the sensor; and how
    /// many rows it had to each that is left. Where one sensor alone repeats, its axes miss samples.
    pub(crate) fn without_repeats(mut self) -> (Self, f64) {
        let sensors = ["gyro", "accel"].map(|sensor| {
            let axes = self.axes.iter().enumerate();
            let axes = axes.filter(|(_, name)| name.starts_with(sensor));
            let axes: Vec<usize> = axes.map(|(axis, _)| axis).collect();
            let found = self.repeated(&axes);
            (sensor == "gyro", axes, found)
        });
        let there = || sensors.iter().filter(|(_, axes, _)| !axes.is_empty());
        let all = || there().map(|(_, _, found)| found.as_ref());
        for (gyro, _, found) in there() {
            let times = found.as_ref().map(|(_, times)| *times);
            let gyro = *gyro;
            self.repeated
                .extend(times.map(|times| Repeated { gyro, times }));
        }
        let mut together = all().flatten();
        let first = together.next().cloned();
        let alike = all().all(|found| found == first.as_ref());
        match first {
            Some((repeats, times)) if alike => {
                let kept = |values: &mut Vec<f64>| {
                    let mut repeats = repeats.iter();
                    values.retain(|_| !repeats.next().copied().unwrap_or(false));
                };
                self.samples.iter_mut().for_each(kept);
                self.temperature.iter_mut().for_each(kept);
                if !self.stamps.is_empty() {
                    kept(&mut self.stamps);
                    self.timing = timing(&self.stamps).ok();
                }
                (self, times)
            }
            _ => {
                for (_, axes, found) in sensors {
                    let Some((repeats, _)) = found else { continue };
                    for axis in axes {
                        let values = self.samples[axis].iter_mut().zip(&repeats);
                        let repeated = values.filter(|(_, repeats)| **repeats);
                        repeated.for_each(|(value, _)| *value = f64::NAN);
                    }
                }
                (self, 1.0)
            }
        }
    }

    /// Which samples of the axes of a sensor are all those before again, and how many there are to each new one; `None` where
    /// they are so by chance, as of a sensor at rest with coarse steps.
    fn repeated(&self, axes: &[usize]) -> Option<(Vec<bool>, f64)> {
        let same = |apart: usize| {
            let equal = move |k: usize| {
                k >= apart
                    && axes
                        .iter()
                        .all(|axis| self.samples[*axis][k] == self.samples[*axis][k - apart])
            };
            (0..self.length()).map(equal)
        };
        let share = |apart| same(apart).filter(|same| *same).count() as f64 / self.length() as f64;
        let before = share(1);
        if axes.is_empty() || before < REPEATED || share(APART) > CHANCE * before {
            return None;
        }
        let repeats: Vec<bool> = same(1).collect();
        // New ones come as evenly as a sensor of its own rate has them.
        let new = repeats
            .iter()
            .map(|repeats| if *repeats { f64::NAN } else { 0.0 });
        let (new, ..) = own_values(&new.collect::<Vec<_>>())?;
        let times = repeats.len() as f64 / new.len() as f64;
        Some((repeats, times))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Samples at 100 Hz of gyros that have `gyro` new ones in a hundred, and accelerometers.
    fn record(gyro: usize, accel: usize) -> Record {
        let noise = |k: usize, axis: usize| {
            let drawn = ((k * 6 + axis) as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15);
            (drawn >> 40) as f64
        };
        let held = |k: usize, axis: usize| {
            let new = if axis < 3 { gyro } else { accel };
            noise(k * new / 100, axis)
        };
        let rows = (0..6000).map(|k| std::array::from_fn(|axis| held(k, axis)));
        Record::from_samples(&rows.collect::<Vec<_>>())
    }

    #[test]
    fn what_a_logger_repeats_is_no_sample() {
        let (whole, times) = record(100, 100).without_repeats();
        assert_eq!((whole.length(), times), (6000, 1.0));
        assert_eq!(whole.repeated, []);
        // A sensor of 40 Hz logged at 100.
        let (thinned, times) = record(40, 40).without_repeats();
        assert_eq!((thinned.length(), times), (2400, 2.5));
        assert_eq!(thinned.repeated.len(), 2);
        // The gyros alone: two of three samples are missing.
        let (gyros, times) = record(33, 100).without_repeats();
        assert_eq!((gyros.length(), times), (6000, 1.0));
        let missing = |axis: usize| gyros.samples[axis].iter().filter(|x| x.is_nan()).count();
        assert_eq!((missing(0), missing(5)), (6000 - 1980, 0));
        let [Repeated { gyro, times }] = gyros.repeated[..] else {
            panic!("{:?}", gyros.repeated);
        };
        assert!(gyro && (times - 3.0).abs() < 0.2);
        // Coarse steps repeat by chance, and not as evenly.
        let mut coarse = record(100, 100);
        let sixteen = 16.0f64.exp2();
        for axis in &mut coarse.samples {
            axis.iter_mut()
                .for_each(|x| *x = (*x / (200.0 * sixteen)).round());
        }
        let before = coarse.clone();
        assert_eq!(coarse.without_repeats().0.samples, before.samples);
    }
}
