//! Sensor errors played back from a static record: real noise on an exact truth.

use undrift_nav::{Vector3, sample::ImuSample};

/// Adds a stretch of recorded errors, axis by axis, to ideal increments.
#[derive(Clone, Debug)]
pub struct RecordedErrors<'a> {
    axes: [&'a [f64]; 6],
    at: usize,
}

impl<'a> RecordedErrors<'a> {
    /// From the errors of gyro x, y, z [rad/s] and accelerometer x, y, z [m/s²] at the IMU's rate,
    /// beginning at sample `start`.
    pub fn new(axes: [&'a [f64]; 6], start: usize) -> Self {
        Self { axes, at: start }
    }

    /// The ideal sample with the next errors; `None` at the record's end.
    pub fn apply(&mut self, ideal: &ImuSample) -> Option<ImuSample> {
        let mut next = [0.0; 6];
        for (value, axis) in next.iter_mut().zip(self.axes) {
            *value = *axis.get(self.at)?;
        }
        self.at += 1;
        let [gx, gy, gz, ax, ay, az] = next;
        Some(ImuSample {
            dtheta: ideal.dtheta + Vector3::new(gx, gy, gz) * ideal.dt,
            dvel: ideal.dvel + Vector3::new(ax, ay, az) * ideal.dt,
            ..*ideal
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_follow_one_another_from_the_start_to_the_end_of_the_record() {
        let record: [Vec<f64>; 6] =
            std::array::from_fn(|axis| (0..4).map(|k| (10 * axis + k) as f64).collect());
        let ideal = ImuSample {
            time: 3.0,
            dt: 0.5,
            dtheta: Vector3::new(1.0, 2.0, 3.0),
            dvel: Vector3::new(4.0, 5.0, 6.0),
        };
        let mut errors = RecordedErrors::new(record.each_ref().map(Vec::as_slice), 1);
        // Rates and forces act for half a second.
        for at in [1.0, 2.0, 3.0] {
            let expected = ImuSample {
                dtheta: ideal.dtheta + Vector3::new(at, 10.0 + at, 20.0 + at) * 0.5,
                dvel: ideal.dvel + Vector3::new(30.0 + at, 40.0 + at, 50.0 + at) * 0.5,
                ..ideal
            };
            assert_eq!(errors.apply(&ideal), Some(expected));
        }
        assert_eq!(errors.apply(&ideal), None);
    }
}
