//! Motion between fixes, preintegrated.

use crate::estimator::STAMP_ROUNDING;
use alloc::vec::Vec;
use undrift_nav::{
    Vector3,
    preintegration::Preintegrated,
    sample::{GnssFix, ImuSample},
};

/// Motion from the fix before to this one.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Segment {
    pub(super) motion: Preintegrated,
    /// Angular rate at the end [rad/s].
    pub(super) omega_b: Vector3,
    /// Velocity of the antenna at the end [m/s] and its variances.
    pub(super) v_n: Vector3,
    pub(super) variance: Vector3,
}

impl Segment {
    /// Adds `dt` \[s\] of a sample, whose gyros read too much by `gyro`.
    fn add(&mut self, sample: &ImuSample, dt: f64, gyro: &Vector3) {
        let part = dt / sample.dt;
        let dtheta = sample.dtheta * part - gyro * dt;
        self.motion.add(&dtheta, &(sample.dvel * part), dt);
        self.omega_b = sample.dtheta / sample.dt - gyro;
    }
}

/// The segments between the fixes that have a velocity and are at least `spacing` \[s\] apart, the last one in any case; the
/// first one has no length and holds the velocity of the start. `gyro` is the gyro bias about which it is
/// linear [rad/s].
pub(super) fn segments<'a>(
    samples: impl Iterator<Item = &'a ImuSample>,
    fixes: impl Iterator<Item = &'a GnssFix>,
    spacing: f64,
    gyro: &Vector3,
) -> Vec<Segment> {
    let mut fixes = fixes
        .filter_map(|fix| {
            fix.velocity
                .map(|(v, covariance)| (fix.time, v, covariance.diagonal()))
        })
        .peekable();
    let mut segments: Vec<Segment> = Vec::new();
    let mut open = Segment::default();
    for sample in samples {
        let mut done = sample.time - sample.dt;
        while let Some((time, v_n, variance)) =
            fixes.next_if(|(time, ..)| *time <= sample.time + STAMP_ROUNDING)
        {
            let time = time.min(sample.time);
            if segments.is_empty() {
                done = time;
                open.omega_b = sample.dtheta / sample.dt - gyro;
            } else if time > done {
                open.add(sample, time - done, gyro);
                done = time;
            }
            // The window ends with the last fix, however near the one before it is.
            let last = fixes.peek().is_none();
            if segments.is_empty() || open.motion.dt >= spacing || last && open.motion.dt > 0.0 {
                segments.push(Segment {
                    v_n,
                    variance,
                    ..open
                });
                open = Segment::default();
            }
        }
        if !segments.is_empty() && sample.time > done {
            open.add(sample, sample.time - done, gyro);
        }
    }
    segments
}
