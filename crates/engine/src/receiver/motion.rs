//! How the solution accelerates from fix to fix, and what it may drift by meanwhile.

use crate::estimator::Estimator;
use undrift_nav::Vector3;

/// Spans over which accelerations are averaged, least and most \[s\].
const SPAN: (f64, f64) = (0.1, 2.5);

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
    fn what_is_unknown_of_a_delay_drifts_with_the_acceleration() {
        let mut filter = driving_north(10.0);
        let mut motion = Motion::default();
        motion.follow(&*filter);
        let drift = |motion: &Motion, filter: &dyn Estimator| {
            let std = Vector3::from_column_slice(&filter.nav_std()[3..6]).norm();
            motion.drift(filter) - 3.0 * std
        };
        assert_eq!(drift(&motion, &*filter), 0.0);
        // Half a second of 2 m/s² to the east.
        for k in 1..=50 {
            let time = 0.01 * f64::from(k);
            let sample = ImuSample::from_rates(time, 0.01, [0.0; 3], [0.0, 2.0, -9.8]);
            filter.begin(&sample);
            filter.advance(None);
        }
        motion.follow(&*filter);
        assert!((drift(&motion, &*filter) - 0.2).abs() < 0.01);
        // Seen again at once, it is what it was.
        motion.follow(&*filter);
        assert!((drift(&motion, &*filter) - 0.2).abs() < 0.01);
    }
}
