//! Sensors that repeat a value: frozen, saturated, or never connected.

use undrift_nav::repeats::{FROZEN_TIMES, Repeat, Repeats, SATURATED_TIMES};

/// A value that a sensor axis held longer than its noise explains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Held {
    /// 0 to 2 for the gyros x, y, z of the sensor, 3 to 5 for the accelerometers.
    pub axis: usize,
    /// The value, as it is in the log.
    pub value: f64,
    /// Time of the first sample of it \[s\].
    pub start: f64,
    /// Time to the last sample of it \[s\].
    pub length: f64,
    /// How many samples had it, one after the other.
    pub samples: u64,
    /// Whether it is the largest or smallest value of the axis, and not the only one.
    pub saturated: bool,
    /// Whether the axis never had another value.
    pub constant: bool,
}

/// A frozen axis holds a value for so many samples, so long \[s\].
const FROZEN: (u64, f64) = (20, 1.0);
/// A saturated one for so many samples.
const SATURATED: u64 = 5;

impl Held {
    /// What an axis held, if it held a value.
    fn of(axis: usize, mut values: Repeats) -> Option<Self> {
        values.end();
        let varies = values.least.value < values.most.value;
        let extreme = |of: &Repeat| of.value == values.least.value || of.value == values.most.value;
        let is_beyond =
            |of: &Repeat, times: f64| of.samples as f64 >= times * values.usual_beside(of);
        let frozen = Some(values.longest).filter(|of| {
            let length = of.end - of.start;
            of.samples >= FROZEN.0 && length >= FROZEN.1 && is_beyond(of, FROZEN_TIMES)
        });
        let saturated = [values.least, values.most]
            .into_iter()
            .max_by_key(|of| of.samples)
            .filter(|of| varies && of.samples >= SATURATED && is_beyond(of, SATURATED_TIMES));
        frozen.or(saturated).map(|of| Held {
            axis,
            value: of.value,
            start: of.start,
            length: of.end - of.start,
            samples: of.samples,
            saturated: varies && extreme(&of),
            constant: !varies,
        })
    }
}

/// Watches the six axes of an inertial log.
#[derive(Clone, Copy, Default)]
pub struct HeldWatch([Repeats; 6]);

impl HeldWatch {
    /// Takes in the next sample at `time` \[s\], gyros before accelerometers, in any units.
    #[inline]
    pub fn add(&mut self, time: f64, values: [f64; 6]) {
        for (axis, value) in self.0.iter_mut().zip(values) {
            axis.push(time, value);
        }
    }

    /// The axes that held a value for long, each with its longest.
    pub fn held(&self) -> Vec<Held> {
        let axes = self.0.iter().enumerate();
        axes.filter_map(|(k, axis)| Held::of(k, *axis)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten seconds at 100 Hz of the same six functions of the sample's number.
    fn watch(value: impl Fn(u32) -> f64) -> Vec<Held> {
        let mut watch = HeldWatch::default();
        for k in 0..1000 {
            watch.add(0.01 * f64::from(k), [value(k); 6]);
        }
        watch.held()
    }

    /// A number between −1 and 1 that never repeats soon.
    fn noise(k: u32) -> f64 {
        (f64::from(k) * 78.233).sin()
    }

    #[test]
    fn what_varies_is_not_held() {
        assert_eq!(watch(noise), []);
        // Rounded so coarsely that values repeat, though never for long.
        assert_eq!(watch(|k| (2.0 * noise(k)).round()), []);
        // A sensor at rest that shows one of two values for a while each.
        assert_eq!(watch(|k| f64::from((k / 30) % 2)), []);
    }

    #[test]
    fn a_frozen_axis() {
        let held = watch(|k| {
            if (300..450).contains(&k) {
                0.25
            } else {
                noise(k)
            }
        });
        assert_eq!(held.len(), 6);
        assert_eq!(
            (held[1].axis, held[1].value, held[1].samples),
            (1, 0.25, 150)
        );
        assert!((held[1].start - 3.0).abs() < 1e-9 && (held[1].length - 1.49).abs() < 1e-9);
        assert!(held.iter().all(|held| !held.saturated && !held.constant));
        // Half a second is too short to tell.
        assert_eq!(
            watch(|k| if (300..350).contains(&k) {
                0.25
            } else {
                noise(k)
            }),
            []
        );
    }

    #[test]
    fn one_value_for_ever() {
        let held = watch(|_| 0.0);
        assert_eq!((held.len(), held[0].samples), (6, 1000));
        assert!(!held[0].saturated && held[0].constant);
    }

    #[test]
    fn a_saturated_axis() {
        let held = watch(|k| (3.0 * (f64::from(k) / 40.0).sin() + 0.1 * noise(k)).min(2.0));
        assert!(held.len() == 6 && held[0].saturated && held[0].value == 2.0);
        // The same, unclipped.
        assert_eq!(
            watch(|k| 3.0 * (f64::from(k) / 40.0).sin() + 0.1 * noise(k)),
            []
        );
    }
}
