//! Vertical velocities that nobody measured: converters and receivers that have none write zeros, with the accuracy of the others.
//!
//! Five fixes in motion whose vertical velocity is 0 to the last digit are enough; one that is not 0 clears the
//! receiver for good. The vertical variance then becomes (20 m/s)², without correlation, so that the horizontal
//! velocity is used as it is.

use undrift_nav::sample::GnssFix;

use crate::summary::Summary;

/// Horizontal speed above which the vertical velocity of a receiver that measures it is not 0 to the last digit \[m/s\].
const MOVES: f64 = 1.0;
/// So many fixes in motion without one are enough.
const ENOUGH: u32 = 5;
/// Standard deviation that leaves a vertical velocity open \[m/s\].
const OPEN: f64 = 20.0;

/// Whether the receiver measures a vertical velocity.
#[derive(Clone, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct VerticalVelocity {
    measured: bool,
    /// Fixes in motion with a vertical velocity of 0, none before them with another.
    zeros: u32,
}

impl VerticalVelocity {
    /// The fix with a vertical velocity that is left open where it seems not to be measured; `counts` is whether the fix is a new
    /// one.
    ///
    /// Horizontal speed above 1 m/s makes motion. The first fix that was left open is noted with
    /// its time in `summary`.
    pub(super) fn judge(
        &mut self,
        mut fix: GnssFix,
        counts: bool,
        summary: &mut Summary,
    ) -> GnssFix {
        let Some((v_n, r)) = &mut fix.velocity else {
            return fix;
        };
        if self.measured || v_n.z != 0.0 {
            self.measured = true;
            return fix;
        }
        self.zeros += u32::from(counts && v_n.xy().norm() > MOVES);
        if self.zeros >= ENOUGH && r[(2, 2)] < OPEN * OPEN {
            r.fixed_view_mut::<1, 2>(2, 0).fill(0.0);
            r.fixed_view_mut::<2, 1>(0, 2).fill(0.0);
            r[(2, 2)] = OPEN * OPEN;
            summary.no_vertical_velocity.get_or_insert(fix.time);
        }
        fix
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use undrift_nav::{Matrix3, Vector3, sample::FixQuality};

    fn fix(time: f64, v_n: Vector3) -> GnssFix {
        let r = Matrix3::new(0.04, 0.01, 0.02, 0.01, 0.04, 0.02, 0.02, 0.02, 0.09);
        GnssFix {
            attitude: None,
            mean_velocity: None,
            time,
            position: None,
            velocity: Some((v_n, r)),
            quality: FixQuality::Unknown,
        }
    }

    fn std(watch: &mut VerticalVelocity, time: f64, v_n: [f64; 3], summary: &mut Summary) -> f64 {
        let (_, r) = watch
            .judge(fix(time, v_n.into()), true, summary)
            .velocity
            .unwrap();
        assert_eq!(r, r.transpose());
        assert_eq!(r[(0, 0)], 0.04);
        r[(2, 2)].sqrt()
    }

    #[test]
    fn zeros_in_motion_are_no_vertical_velocity() {
        let (mut watch, mut summary) = (VerticalVelocity::default(), Summary::default());
        // At rest receivers hold their velocities.
        for k in 0..50 {
            assert!((std(&mut watch, f64::from(k), [0.0; 3], &mut summary) - 0.3).abs() < 1e-12);
        }
        for k in 0..4 {
            let driving = [3.0, 1.0, 0.0];
            let found = std(&mut watch, 50.0 + f64::from(k), driving, &mut summary);
            assert!((found - 0.3).abs() < 1e-12 && summary.no_vertical_velocity.is_none());
        }
        for k in 0..9 {
            let driving = [3.0, 1.0, -0.0];
            assert_eq!(
                std(&mut watch, 54.0 + f64::from(k), driving, &mut summary),
                20.0
            );
            assert_eq!(summary.no_vertical_velocity, Some(54.0));
        }
        // A single other one, and it is measured.
        for z in [0.01, 0.0, 0.0] {
            assert!((std(&mut watch, 70.0, [3.0, 1.0, z], &mut summary) - 0.3).abs() < 1e-12);
        }
    }

    /// What is stated as open stays as it is, and there is nothing to say.
    #[test]
    fn what_is_open_already_is_left_alone() {
        let (mut watch, mut summary) = (VerticalVelocity::default(), Summary::default());
        for k in 0..20 {
            let mut open = fix(f64::from(k), Vector3::new(9.0, 0.0, 0.0));
            open.velocity.as_mut().unwrap().1[(2, 2)] = 900.0;
            assert_eq!(watch.judge(open, true, &mut summary), open);
        }
        assert_eq!(summary.no_vertical_velocity, None);
    }
}
