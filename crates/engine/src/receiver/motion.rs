//! How the solution accelerates from fix to fix, and what a receiver's tracking loops make of it.
//!
//! A loop of time constant τ follows a velocity with an error of τ a. The part of it that does not change is the delay of the velocities,
//! which is estimated; the rest varies with what the receiver tracks, and grows with the acceleration as well: in calm motion the stated
//! accuracy is right, in turns it is not, and a delay that is taken from turns alone is not as certain as it looks.

use crate::estimator::Estimator;
use undrift_nav::{Matrix3, Vector3};

/// Spans over which accelerations are averaged, least and most \[s\].
const SPAN: (f64, f64) = (0.1, 2.5);
/// Time by which the lag of a receiver's velocity varies, one standard deviation \[s\]: loops of 2 to 10 Hz have 15 to 80 ms (Kaplan & Hegarty
/// 2017, section 8.6).
const LAG: f64 = 0.05;

/// A delay that fixes may have beyond the one that is estimated \[s\].
const UNKNOWN: f64 = 0.1;

/// Motion of the solution from one fix to the next.
#[derive(Clone, Copy, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Motion {
    /// Time \[s\] and velocity [m/s] at the beginning of the present span.
    since: Option<(f64, Vector3)>,
    /// Mean acceleration over the last span [m/s²].
    acceleration: Vector3,
}

impl Motion {
    /// Looks at the solution before a fix.
    pub(super) fn follow(&mut self, filter: &dyn Estimator) {
        let (time, v_n) = (filter.nav().time, filter.nav().v_n);
        let (since, before) = *self.since.get_or_insert((time, v_n));
        let span = time - since;
        if span < SPAN.0 {
            return;
        }
        self.acceleration = match span < SPAN.1 {
            true => (v_n - before) / span,
            false => Vector3::zeros(),
        };
        self.since = Some((time, v_n));
    }

    /// Covariance of what a velocity lags by \[m²/s²\].
    pub(super) fn lag(&self) -> Matrix3 {
        let off = self.acceleration * LAG;
        off * off.transpose()
    }

    /// What the solution may drift by within a second, nearly three standard deviations [m/s]: by its velocity, and by a delay of the fixes
    /// that is not known.
    pub(super) fn drift(&self, filter: &dyn Estimator) -> f64 {
        let std = Vector3::from_column_slice(&filter.nav_std()[3..6]).norm();
        3.0 * std + UNKNOWN * self.acceleration.norm()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::driving_north;
    use undrift_nav::sample::ImuSample;

    #[test]
    fn a_velocity_lags_along_the_acceleration() {
        let mut filter = driving_north(10.0);
        let mut motion = Motion::default();
        motion.follow(&*filter);
        assert_eq!(motion.lag(), Matrix3::zeros());
        // Half a second of 2 m/s² to the east.
        for k in 1..=50 {
            let time = 0.01 * f64::from(k);
            let sample = ImuSample::from_rates(time, 0.01, [0.0; 3], [0.0, 2.0, -9.8]);
            filter.begin(&sample);
            filter.advance(None);
        }
        motion.follow(&*filter);
        let lag = motion.lag();
        assert!((lag[(1, 1)] - (2.0 * LAG).powi(2)).abs() < 4e-4, "{lag}");
        assert!(lag[(0, 0)] < 1e-6 && lag[(2, 2)] < 1e-4);
        let calm = 3.0 * Vector3::from_column_slice(&filter.nav_std()[3..6]).norm();
        assert!((motion.drift(&*filter) - calm - 0.2).abs() < 0.01);
        // Seen again at once, it is what it was.
        motion.follow(&*filter);
        assert_eq!(motion.lag(), lag);
    }
}
