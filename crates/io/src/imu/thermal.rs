//! The bias that follows the sensor's temperature, and how much of a log it is known for.

use undrift_nav::{Matrix3, Vector3};

/// How long a temperature is used for samples that have none \[s\]: a housing changes by tenths of a kelvin in it.
pub const HOLD_S: f64 = 60.0;
/// Temperatures [°C] that no working sensor leaves: what is beyond is no temperature, or raw counts.
const PLAUSIBLE_C: std::ops::RangeInclusive<f64> = -100.0..=200.0;

/// Bias of an axis over temperature, `slope·(T − reference) + quadratic·(T − reference)²`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ThermalAxis {
    /// [°C]
    pub reference_c: f64,
    /// Temperatures that it was estimated between [°C].
    pub range_c: [f64; 2],
    /// [rad/s/K] or [m/s²/K]
    pub slope: f64,
    /// [rad/s/K²] or [m/s²/K²]
    pub quadratic: f64,
    /// Along the body's axes, not the sensor's.
    pub body: bool,
}

/// Bias over temperature of gyros x, y, z and accelerometers x, y, z.
pub type Thermal = [Option<ThermalAxis>; 6];

/// Samples by what was known of their temperature.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ThermalSummary {
    /// Samples that were corrected.
    pub corrected: u64,
    /// Samples without a temperature, for more than [`HOLD_S`] since the last that had one: as they were.
    pub without: u64,
    /// Time of the first of those \[s\].
    pub without_from: Option<f64>,
    /// Samples at temperatures that some axis was not estimated at.
    pub beyond: u64,
    /// Lowest and highest temperature of the samples [°C].
    pub seen_c: Option<[f64; 2]>,
}

/// Gyro and accelerometer.
type Bias = (Vector3, Vector3);

/// Follows the temperature through a log.
#[derive(Clone, Debug)]
pub(super) struct ThermalWatch {
    axes: Thermal,
    rotation: Matrix3,
    /// Temperatures that all axes were estimated at [°C].
    range_c: [f64; 2],
    /// The last temperature, its time and the bias at it.
    last: Option<(f64, f64, Bias)>,
    pub(super) summary: ThermalSummary,
}

impl ThermalWatch {
    pub(super) fn new(axes: &Thermal, rotation: Matrix3) -> Self {
        let known = || axes.iter().flatten();
        Self {
            axes: *axes,
            rotation,
            range_c: [
                known().fold(f64::NEG_INFINITY, |low, axis| low.max(axis.range_c[0])),
                known().fold(f64::INFINITY, |high, axis| high.min(axis.range_c[1])),
            ],
            last: None,
            summary: ThermalSummary::default(),
        }
    }

    /// Bias [rad/s], [m/s²] in body axes of a sample at a time \[s\] and a temperature [°C], NaN where it has none.
    #[inline]
    pub(super) fn bias(&mut self, time: f64, temperature_c: f64) -> Bias {
        let summary = &mut self.summary;
        if PLAUSIBLE_C.contains(&temperature_c) {
            let bias = match self.last {
                Some((last, _, bias)) if last == temperature_c => bias,
                _ => bias(&self.axes, &self.rotation, temperature_c),
            };
            self.last = Some((temperature_c, time, bias));
            let [low, high] = summary.seen_c.unwrap_or([temperature_c; 2]);
            summary.seen_c = Some([low.min(temperature_c), high.max(temperature_c)]);
        }
        match self.last {
            Some((at, since, bias)) if time - since <= HOLD_S => {
                summary.corrected += 1;
                let [low, high] = self.range_c;
                summary.beyond += u64::from(!(low..=high).contains(&at));
                bias
            }
            _ => {
                summary.without += 1;
                summary.without_from.get_or_insert(time);
                (Vector3::zeros(), Vector3::zeros())
            }
        }
    }
}

fn bias(axes: &Thermal, rotation: &Matrix3, temperature_c: f64) -> Bias {
    let along = |first: usize| {
        let of = |body: bool| {
            Vector3::from_fn(|i, _| match axes[first + i] {
                Some(axis) if axis.body == body => {
                    let above = temperature_c - axis.reference_c;
                    above * (axis.slope + axis.quadratic * above)
                }
                _ => 0.0,
            })
        };
        rotation * of(false) + of(true)
    };
    (along(0), along(3))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_temperature_holds_for_a_minute_and_axes_are_the_sensors_or_the_bodys() {
        let axis = ThermalAxis {
            reference_c: 20.0,
            range_c: [10.0, 30.0],
            slope: 2.0,
            quadratic: 0.5,
            body: false,
        };
        let mut axes = Thermal::default();
        axes[0] = Some(axis);
        axes[5] = Some(ThermalAxis {
            slope: 1.0,
            quadratic: 0.0,
            body: true,
            ..axis
        });
        // Body x is the sensor's y, body y its −x.
        let rotation = Matrix3::new(0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0);
        let mut watch = ThermalWatch::new(&axes, rotation);
        let none = (Vector3::zeros(), Vector3::zeros());
        assert_eq!(watch.bias(0.0, f64::NAN), none);
        // 2·4 + 0.5·16 = 16.
        let warm = (Vector3::new(0.0, -16.0, 0.0), Vector3::new(0.0, 0.0, 4.0));
        assert_eq!(watch.bias(1.0, 24.0), warm);
        assert_eq!(watch.bias(2.0, f64::NAN), warm);
        assert_eq!(watch.bias(61.0, 5000.0), warm);
        assert_eq!(watch.bias(61.5, f64::NAN), none);
        let hot = watch.bias(62.0, 40.0);
        assert_eq!(hot.1.z, 20.0);
        let seen = ThermalSummary {
            corrected: 4,
            without: 2,
            without_from: Some(0.0),
            beyond: 1,
            seen_c: Some([24.0, 40.0]),
        };
        assert_eq!(watch.summary, seen);
    }
}
