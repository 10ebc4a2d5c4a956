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
