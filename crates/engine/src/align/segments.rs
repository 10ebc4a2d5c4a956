//! Motion between fixes, preintegrated.
//!
//! What lies between two fixes is a [`Preintegrated`] motion: turn, change of velocity and of place with their
//! derivatives by the gyro bias, so that a search may try another bias without going through the samples again.
//! It is linear about the bias that it was made with.
//!
//! Preintegration: Lupton & Sukkarieh 2012; Forster, Carlone, Dellaert & Scaramuzza 2017. Gravity
//! and the Earth's rate are not in it: they depend on the attitude sought, and [`super::wahba`]
//! adds them.

use super::sightings::Sighting;
use crate::estimator::STAMP_ROUNDING;
use alloc::vec::Vec;
use undrift_nav::{Vector3, preintegration::Preintegrated, sample::ImuSample};

/// Speed of a vehicle that moves \[m/s\] …
const MOVES: f64 = 0.5;
/// … and of a slower one, in standard deviations of it.
const SURELY: f64 = 5.0;

/// Motion from the fix before to this one.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Segment {
    /// In body axes at the segment's start.
    pub(super) motion: Preintegrated,
    /// Angular rate at the end [rad/s].
    pub(super) omega_b: Vector3,
    /// The fix at the end.
    pub(super) fix: Sighting,
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

/// The segments between the fixes that are at least `spacing` \[s\] apart, the last one in any case; the first one has no
/// length and holds the fix of the start. `gyro` is the gyro bias about which it is linear [rad/s].
///
/// Empty where no fix is within the samples. O(samples + fixes).
pub(super) fn segments<'a>(
    samples: impl Iterator<Item = &'a ImuSample>,
    fixes: impl Iterator<Item = &'a Sighting>,
    spacing: f64,
    gyro: &Vector3,
) -> Vec<Segment> {
    let mut fixes = fixes.peekable();
    let mut segments: Vec<Segment> = Vec::new();
    let mut open = Segment::default();
    for sample in samples {
        let mut done = sample.time - sample.dt;
        while let Some(fix) = fixes.next_if(|fix| fix.time <= sample.time + STAMP_ROUNDING) {
            let time = fix.time.min(sample.time);
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
                segments.push(Segment { fix: *fix, ..open });
                open = Segment::default();
            }
        }
        if !segments.is_empty() && sample.time > done {
            open.add(sample, sample.time - done, gyro);
        }
    }
    segments
}

/// Time that the vehicle moved in a window \[s\].
pub(super) fn moving(segments: &[Segment]) -> f64 {
    let moves = |s: &&Segment| s.fix.v_n.xy().norm() > MOVES.min(SURELY * s.fix.speed_std);
    let moving = segments.iter().filter(moves);
    moving.map(|s| s.motion.dt).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    /// Samples of 0.1 s from 0 to 5 s that turn by 0.2 rad/s and push by 3 m/s², and fixes with a velocity of their time.
    fn log(fixes: &[f64]) -> (Vec<ImuSample>, Vec<Sighting>) {
        let sample = |k: u32| ImuSample {
            time: 0.1 * f64::from(k + 1),
            dt: 0.1,
            dtheta: Vector3::new(0.0, 0.0, 0.02),
            dvel: Vector3::new(0.3, 0.0, 0.0),
        };
        let fix = |time: &f64| Sighting {
            time: *time,
            v_n: Vector3::new(*time, 0.0, 0.0),
            variance: Vector3::repeat(0.04),
            ..Sighting::default()
        };
        (
            (0..50).map(sample).collect(),
            fixes.iter().map(fix).collect(),
        )
    }

    #[test]
    fn fixes_closer_than_the_spacing_are_passed_over_but_for_the_last() {
        let (samples, fixes) = log(&[0.55, 0.8, 1.3, 1.7, 2.6, 2.9]);
        let gyro = Vector3::new(0.0, 0.0, 0.05);
        let found = segments(samples.iter(), fixes.iter(), 1.0, &gyro);
        let seen: Vec<(f64, f64)> = found.iter().map(|s| (s.motion.dt, s.fix.v_n.x)).collect();
        let expected = [(0.0, 0.55), (1.15, 1.7), (1.2, 2.9)];
        assert_eq!(seen.len(), 3, "{seen:?}");
        for ((dt, at), (length, time)) in seen.into_iter().zip(expected) {
            assert!((dt - length).abs() < 1e-9 && at == time, "{dt} {at}");
        }
        for segment in &found {
            assert!((segment.omega_b.z - 0.15).abs() < 1e-12);
            assert!((segment.fix.variance - Vector3::repeat(0.04)).norm() < 1e-15);
        }
        // None are passed over without a spacing.
        let (samples, fixes) = log(&[0.5, 1.0, 2.0]);
        let found = segments(samples.iter(), fixes.iter(), 0.0, &gyro);
        let lengths: Vec<f64> = found
            .iter()
            .map(|s| (100.0 * s.motion.dt).round())
            .collect();
        assert_eq!(lengths, [0.0, 50.0, 100.0]);
    }
}
