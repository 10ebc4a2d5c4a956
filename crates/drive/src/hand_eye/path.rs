//! The turn of the gyros from the first sample on.

use undrift_nav::{Quaternion, Vector3, attitude::from_rotation_vector, sample::ImuSample};

/// Attitude of the body against that before the first sample, at the end of each.
pub(super) struct Path<'a> {
    samples: &'a [ImuSample],
    /// At the end of each sample.
    turned: Vec<Quaternion>,
    /// Taken from the gyros [rad/s].
    bias: Vector3,
}

impl<'a> Path<'a> {
    /// Of gyros that read `bias` [rad/s] at rest.
    pub(super) fn new(samples: &'a [ImuSample], bias: Vector3) -> Self {
        let mut now = Quaternion::identity();
        let turned = samples.iter().map(|sample| {
            now *= from_rotation_vector(&(sample.dtheta - bias * sample.dt));
            now.renormalize_fast();
            now
        });
        let turned = turned.collect();
        Self {
            samples,
            turned,
            bias,
        }
    }

    /// Index of the sample that ends at or after `time` \[s\].
    pub(super) fn sample_at(&self, time: f64) -> usize {
        self.samples.partition_point(|sample| sample.time < time)
    }

    /// The attitude at `time` \[s\]; `None` outside of the samples and in their gaps.
    pub(super) fn at(&self, time: f64) -> Option<Quaternion> {
        let at = self.sample_at(time);
        let sample = self.samples.get(at)?;
        let left = sample.time - time;
        if left > 1.5 * sample.dt {
            return None;
        }
        let rate = sample.dtheta / sample.dt - self.bias;
        Some(self.turned[at] * from_rotation_vector(&(-rate * left)))
    }

    /// The turn from one time to another \[s\], in the body's axes.
    pub(super) fn turn(&self, from: f64, to: f64) -> Option<Vector3> {
        Some((self.at(from)?.inverse() * self.at(to)?).scaled_axis())
    }
}
