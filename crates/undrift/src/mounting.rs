//! How the IMU sits in the vehicle, from a solution of its own axes.
//!
//! A wheeled vehicle moves along its own forward axis, so the direction of `v^b = C_n^b v^n` on straight
//! driving is that axis in sensor axes; and on average over a drive it is level, so the mean of
//! "down" in sensor axes, less its part along forward, is the vehicle's down. The third axis is
//! their cross product. Side slip and the lever between rear axle and IMU show in turns, which are
//! left out; hills turn both axes together and drop out.
//!
//! `b` is the sensor's own axes here and `v` the vehicle's forward, right, down; `q_vb` takes the one
//! to the other and is what `imu.mounting` states as roll, pitch, yaw (`docs/drive-file.md`).

use crate::{
    estimator::Estimator,
    replay::{Measurements, Observer, ReplayError, Samples, Settings, replay},
};
use undrift_nav::{Matrix3, Quaternion, Vector3, attitude::to_rpy};

/// Speed above which the direction of motion counts [m/s].
const MIN_SPEED: f64 = 5.0;
/// Turn rate up to which driving is straight [rad/s].
const STRAIGHT: f64 = 0.05;
/// Heading this uncertain \[rad\] or more says nothing of the forward axis.
const HEADING_STD: f64 = 0.05;
/// Driving that makes one value: errors of the attitude, bends and bumps live for about that long \[s\].
const BLOCK: f64 = 5.0;
/// Values needed.
const MIN_BLOCKS: u32 = 6;
/// What averages do not remove, one standard deviation \[rad\]: crown of the road and an uneven load
/// in roll; squat at speed in pitch; side slip of one-sided bends in yaw.
const FLOOR: [f64; 3] = [0.012, 0.004, 0.003];
/// The part of the log that [`estimate`] looks at, from its first sample \[s\].
pub const LONGEST_PASS: f64 = 900.0;

/// How the IMU sits in the vehicle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mounting {
    /// Takes sensor axes `b` to vehicle axes `v`, forward, right, down.
    pub q_vb: Quaternion,
    /// Standard deviations of the error angles about the vehicle's forward, right and down \[rad\].
    pub std: Vector3,
    /// Straight driving that it rests on \[s\].
    pub duration: f64,
}

impl Mounting {
    /// Roll, pitch, yaw of the sensor in the vehicle \[rad\], as `imu.mounting` takes them.
    pub fn rpy(&self) -> Vector3 {
        to_rpy(&self.q_vb)
    }

    /// Rotation matrix C_b^v, sensor to vehicle.
    pub fn matrix(&self) -> Matrix3 {
        self.q_vb.to_rotation_matrix().into_inner()
    }
}

/// Why there is no estimate.
#[derive(Debug, thiserror::Error)]
pub enum MountingError {
    /// Not enough straight driving.
    #[error(
        "the mounting could not be estimated: {found:.0} s of straight driving above {MIN_SPEED} m/s with a known heading, \
         {:.0} s are needed; give imu.mounting or imu.axes",
        f64::from(MIN_BLOCKS) * BLOCK
    )]
    TooLittle {
        /// What there was \[s\].
        found: f64,
    },
    /// The vehicle does not move along one of the sensor's directions.
    #[error(
        "the mounting could not be estimated: the direction of motion wanders by {:.0} deg in sensor axes, \
         so this is no wheeled vehicle, or its IMU is not fixed to it", wander.to_degrees()
    )]
    Wanders {
        /// Standard deviation of its direction \[rad\].
        wander: f64,
    },
    /// The log could not be navigated in sensor axes.
    #[error(transparent)]
    Replay(#[from] ReplayError),
}

/// Direction of motion beyond this standard deviation is no axis \[rad\].
const WANDER: f64 = 0.2;

/// Gathers the directions of motion and of down. Streamed: only sums are kept.
#[derive(Clone, Debug, Default)]
pub struct MountingEstimator {
    /// Of the present block: its length \[s\], the sums of the directions, of the attitude's variance.
    span: f64,
    forward: Vector3,
    down: Vector3,
    variance: f64,
    /// Of the blocks: their number, the sums of their mean directions and of products of those.
    blocks: u32,
    forward_sum: Vector3,
    forward_square: Matrix3,
    down_sum: Vector3,
    down_square: Matrix3,
    variance_sum: f64,
    /// Time moving with the sum of the directions less time against it \[s\].
    ahead: f64,
}

impl MountingEstimator {
    /// Adds `dt` \[s\] of motion: attitude, velocity [m/s], angular rate ω_nb^b [rad/s], and the standard
    /// deviations of the misalignment about north, east, down \[rad\].
    pub fn add(
        &mut self,
        dt: f64,
        q_nb: &Quaternion,
        v_n: &Vector3,
        omega_nb_b: &Vector3,
        attitude_std: &Vector3,
    ) {
        let speed = v_n.norm();
        let usable =
            speed > MIN_SPEED && omega_nb_b.norm() < STRAIGHT && attitude_std.z < HEADING_STD;
        if !usable {
            return;
        }
        let direction = q_nb.inverse() * v_n / speed;
        // Reversing counts as the same axis the other way round; most of the driving is forward.
        let sign = if direction.dot(&(self.forward_sum + self.forward)) < 0.0 {
            -1.0
        } else {
            1.0
        };
        self.ahead += sign * dt;
        self.span += dt;
        self.forward += direction * (sign * dt);
        self.down += q_nb.inverse() * Vector3::z() * dt;
        self.variance += attitude_std.z * attitude_std.z * dt;
        if self.span < BLOCK {
            return;
        }
        let (forward, down) = (self.forward / self.span, self.down / self.span);
        self.blocks += 1;
        self.forward_sum += forward;
        self.forward_square += forward * forward.transpose();
        self.down_sum += down;
        self.down_square += down * down.transpose();
        self.variance_sum += self.variance / self.span;
        (self.span, self.variance) = (0.0, 0.0);
        (self.forward, self.down) = (Vector3::zeros(), Vector3::zeros());
    }

    /// Straight driving so far \[s\].
    pub fn duration(&self) -> f64 {
        f64::from(self.blocks) * BLOCK
    }

    /// What is known now.
    ///
    /// # Errors
    /// With too little driving, or where it has no one direction.
    pub fn estimate(&self) -> Result<Mounting, MountingError> {
        let too_little = MountingError::TooLittle {
            found: self.duration(),
        };
        if self.blocks < MIN_BLOCKS {
            return Err(too_little);
        }
        let n = f64::from(self.blocks);
        let (Some(axis), Some(right)) = (
            self.forward_sum.try_normalize(1e-9),
            self.down_sum.cross(&self.forward_sum).try_normalize(1e-9),
        ) else {
            return Err(MountingError::Wanders { wander: WANDER });
        };
        let sign = if self.ahead < 0.0 { -1.0 } else { 1.0 };
        let (forward, right) = (axis * sign, right * sign);
        let down = forward.cross(&right);
        let c_vb = Matrix3::from_rows(&[forward.transpose(), right.transpose(), down.transpose()]);

        // Scatter of the blocks' means along each axis.
        let variance = |sum: &Vector3, square: &Matrix3, along: &Vector3| {
            let mean = sum.dot(along) / n;
            (along.dot(&(square * along)) / n - mean * mean).max(0.0) * n / (n - 1.0)
        };
        let pitch = variance(&self.forward_sum, &self.forward_square, &down);
        let yaw = variance(&self.forward_sum, &self.forward_square, &right);
        let roll = variance(&self.down_sum, &self.down_square, &right);
        let wander = (pitch + yaw).sqrt();
        if wander > WANDER {
            return Err(MountingError::Wanders { wander });
        }
        // The filter's heading error outlives a block; it is taken to be another one after a minute.
        let minutes = (self.duration() / 60.0).max(1.0);
        let heading = self.variance_sum / n / minutes;
        let std = Vector3::new(roll / n, pitch / n, yaw / n + heading);
        Ok(Mounting {
            q_vb: Quaternion::from_matrix(&c_vb),
            std: std.zip_map(&Vector3::from(FLOOR), |variance, floor| {
                (variance + floor * floor).sqrt()
            }),
            duration: self.duration(),
        })
    }
}

/// Estimates the mounting from the first [`LONGEST_PASS`] of a log in sensor axes; `settings` must not
/// take the axes for a vehicle's ([`crate::align::Heading::Auto`]).
///
/// # Errors
/// Where the log cannot be navigated, or holds too little straight driving.
pub fn estimate(
    imu: &mut Samples,
    gnss: &mut Measurements,
    settings: &Settings,
) -> Result<Mounting, MountingError> {
    let mut watch = Watch {
        estimator: MountingEstimator::default(),
        last: None,
    };
    let mut end = None;
    let mut imu = imu.take_while(|sample| match sample {
        Ok(sample) => sample.time <= *end.get_or_insert(sample.time + LONGEST_PASS),
        Err(_) => true,
    });
    replay(&mut imu, gnss, settings, &mut watch)?;
    watch.estimator.estimate()
}

struct Watch {
    estimator: MountingEstimator,
    last: Option<f64>,
}

impl Observer for Watch {
    fn sample(&mut self, filter: &dyn Estimator) -> Result<(), ReplayError> {
        let nav = filter.nav();
        let std = filter.nav_std();
        if let Some(last) = self.last.replace(nav.time) {
            let attitude_std = Vector3::new(std[6], std[7], std[8]);
            let dt = (nav.time - last).min(1.0);
            self.estimator
                .add(dt, &nav.q_nb, &nav.v_n, &filter.omega_nb_b(), &attitude_std);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use undrift_nav::attitude::from_rpy;

    const STD: Vector3 = Vector3::new(0.003, 0.003, 0.01);

    /// Straight driving at 10 m/s in many directions, `backwards` of it [s] first in reverse.
    fn drive(q_vb: &Quaternion, seconds: u32, backwards: u32) -> MountingEstimator {
        let mut estimator = MountingEstimator::default();
        for second in 0..seconds {
            let q_nv = from_rpy(&Vector3::new(0.0, 0.05, f64::from(second)));
            let speed = if second < backwards { -10.0 } else { 10.0 };
            let v_n = q_nv * Vector3::x() * speed;
            estimator.add(1.0, &(q_nv * q_vb), &v_n, &Vector3::zeros(), &STD);
        }
        estimator
    }

    #[test]
    fn hills_and_reversing_do_not_matter() {
        let q_vb = from_rpy(&Vector3::new(2.0, -0.7, 1.2));
        for backwards in [0, 40] {
            let found = drive(&q_vb, 100, backwards).estimate().unwrap();
            assert!(found.q_vb.angle_to(&q_vb) < 1e-9, "{backwards}");
            assert!((found.rpy() - Vector3::new(2.0, -0.7, 1.2)).norm() < 1e-9);
            assert!(found.std.x >= FLOOR[0] && found.std.max() < 0.02);
        }
    }

    #[test]
    fn slow_turning_or_lost_says_nothing() {
        let mut estimator = MountingEstimator::default();
        let q = Quaternion::identity();
        let east = Vector3::y();
        for _ in 0..1000 {
            estimator.add(1.0, &q, &(east * 3.0), &Vector3::zeros(), &STD);
            estimator.add(1.0, &q, &(east * 10.0), &(Vector3::z() * 0.1), &STD);
            estimator.add(1.0, &q, &(east * 10.0), &Vector3::zeros(), &(STD * 10.0));
        }
        let error = estimator.estimate().unwrap_err();
        assert!(matches!(error, MountingError::TooLittle { found } if found == 0.0));
    }

    #[test]
    fn what_drifts_sideways_is_no_wheeled_vehicle() {
        let mut estimator = MountingEstimator::default();
        for second in 0..200 {
            let q_nb = from_rpy(&Vector3::new(0.0, 0.0, (f64::from(second) * 0.1).sin()));
            estimator.add(1.0, &q_nb, &(Vector3::x() * 10.0), &Vector3::zeros(), &STD);
        }
        let error = estimator.estimate().unwrap_err();
        assert!(matches!(error, MountingError::Wanders { .. }), "{error}");
    }
}
