//! Whether the IMU nods in its mount: a rigid vehicle on wheels keeps its pitch against the way it moves to a degree, and a loose IMU does not.
//!
//! Ten times a second above 3 m/s the velocity is looked at in body axes: how much its angles in pitch and in yaw scatter within 2 s. What turns
//! the IMU alone turns the velocity in it; bumps, dive and squat turn it by 0.2 to 0.9 deg. Craft in the air scatter in both angles alike, and
//! what pitches in waves goes up and down with them: they are not meant.

use crate::estimator::Estimator;
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::{ComplexField, RealField};
use undrift_nav::Vector3;

/// From one direction to the next \[s\], and from one block to the next.
const STEP: f64 = 0.095;
const BLOCK: f64 = 2.0;
/// Speed from which there is a direction [m/s].
const SPEED: f64 = 3.0;
/// Directions that a block needs, and blocks of a judgement.
const LEAST: f64 = 15.0;
const BLOCKS: u32 = 15;
/// Standard deviation of the pitch that no vehicle has against its way \[rad\], and how much more it is than that of the yaw, and than that of
/// the way itself.
const NODS: f64 = 0.026;
const MORE: f64 = 3.0;
/// Standard deviation of a heading that is known \[rad\], and of a vertical velocity that is, as a share of the speed.
const KNOWN: f64 = 0.1;
const LEVEL: f64 = 0.01;

/// What is known so far.
#[derive(Clone, Copy, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Rocking {
    /// Time of the last direction \[s\], and when the present block began.
    last: f64,
    began: f64,
    /// Directions of the block, sums of pitch and yaw in body axes and of the way's slope \[rad\], and of their squares \[rad²\].
    count: f64,
    sums: [[f64; 2]; 3],
    /// Blocks since the last judgement, and their variances \[rad²\].
    blocks: u32,
    variances: [f64; 3],
    /// Standard deviation of the pitch that was last judged to be the mount's, and the largest \[rad\].
    now: f64,
    most: f64,
}

impl Rocking {
    /// Looks at the solution at the end of a sample; every two seconds by how much the IMU nods \[rad\], 0 where it does not: as half a minute of
    /// motion has shown.
    pub(super) fn sample(&mut self, filter: &dyn Estimator) -> Option<f64> {
        let nav = filter.nav();
        if nav.time - self.last < STEP {
            return None;
        }
        self.last = nav.time;
        let is_whole = nav.time - self.began >= BLOCK;
        if is_whole {
            self.end_block(nav.time);
        }
        let (speed, std) = (nav.v_n.norm(), filter.nav_std());
        if speed > SPEED && std[8] < KNOWN && std[5] < LEVEL * speed {
            let v = nav.q_nb.inverse() * nav.v_n;
            let fall = |v: &Vector3| v.z.atan2(v.x.hypot(v.y));
            let angles = [fall(&v), v.y.atan2(v.x), fall(&nav.v_n)];
            for (sums, angle) in self.sums.iter_mut().zip(angles) {
                sums[0] += angle;
                sums[1] += angle * angle;
            }
            self.count += 1.0;
        }
        is_whole.then_some(self.now)
    }

    /// Ends a block at `time` \[s\], and a judgement with enough of them.
    fn end_block(&mut self, time: f64) {
        let count = core::mem::take(&mut self.count);
        let sums = core::mem::take(&mut self.sums);
        self.began = time;
        if count < LEAST {
            return;
        }
        for (variance, [sum, squares]) in self.variances.iter_mut().zip(sums) {
            *variance += (squares - sum * sum / count).max(0.0) / count;
        }
        self.blocks += 1;
        if self.blocks < BLOCKS {
            return;
        }
        self.blocks = 0;
        let [pitch, yaw, way] =
            core::mem::take(&mut self.variances).map(|sum| (sum / f64::from(BLOCKS)).sqrt());
        self.now = if pitch > NODS && pitch > MORE * yaw.max(way) {
            pitch
        } else {
            0.0
        };
        self.most = self.most.max(self.now);
    }

    /// By how much the IMU nodded at most, one standard deviation \[rad\]; `None` where it did not.
    pub(super) fn most(&self) -> Option<f64> {
        (self.most > 0.0).then_some(self.most)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimator::build;
    use undrift_nav::{
        attitude::from_rpy, earth::Geodetic, filter::InitialStd, mechanisation::NavState,
        parameters::Parameters, shaping::ShapingFilter,
    };

    /// By how much it nods \[deg\] that moves at 8 m/s while pitch, yaw and the slope of its way swing by so much \[deg\].
    fn nods([pitch, yaw, slope]: [f64; 3]) -> Option<f64> {
        let nav = |time: f64| {
            let swing = (4.0 * time).sin().to_radians();
            let fall = 8.0 * slope * swing;
            NavState {
                time,
                position: Geodetic::from_degrees(47.0, 8.0, 400.0),
                v_n: Vector3::new(8.0, 0.0, -fall),
                q_nb: from_rpy(&(Vector3::new(0.0, pitch, yaw) * swing)),
            }
        };
        let std = InitialStd {
            position: Vector3::repeat(1.0),
            velocity: Vector3::repeat(0.02),
            attitude: Vector3::repeat(0.01),
        };
        let sensors = [ShapingFilter::white(1e-3, 0.1).unwrap(); 6];
        let mut filter = build(nav(0.0), &std, &sensors, Parameters::none()).unwrap();
        let mut rocking = Rocking::default();
        for step in 1..400 {
            filter.set_nav(nav(0.1 * f64::from(step)));
            rocking.sample(&*filter);
        }
        rocking.most().map(f64::to_degrees)
    }

    #[test]
    fn what_turns_with_its_way_does_not_nod() {
        let loose = nods([4.0, 0.0, 0.0]).unwrap();
        assert!(
            (loose / 4.0 * core::f64::consts::SQRT_2 - 1.0).abs() < 0.1,
            "{loose}"
        );
        assert_eq!(nods([1.5, 0.0, 0.0]), None);
        // A craft in the air swings in yaw, too, and one in waves goes up and down.
        assert_eq!(nods([4.0, 3.0, 0.0]), None);
        assert_eq!(nods([4.0, 0.0, -3.0]), None);
    }
}
