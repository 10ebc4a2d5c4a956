//! How the IMU sits in the vehicle, from a solution of its own axes.
//!
//! A wheeled vehicle moves along its own forward axis, so the direction of `v^b = C_n^b v^n` on straight
//! driving is that axis in sensor axes; and on average over a drive it is level, so the mean of
//! "down" in sensor axes, less its part along forward, is the vehicle's down. The third axis is
//! their cross product. Side slip and the lever between rear axle and IMU show in turns, which are
//! left out; hills turn both axes together and drop out.
//!
//! What never drives fast and straight for long has its turns taken too: there `v^b = s f + L ω × f` with the speed s,
//! the forward axis f and the lever L from the axle forward to the IMU, which is estimated with it.
//!
//! `b` is the sensor's own axes here and `v` the vehicle's forward, right, down; `q_vb` takes the one
//! to the other and is what `imu.mounting` states as roll, pitch, yaw (`docs/drive-file.md`).

mod search;

pub(crate) use search::{Search, Turned};

use alloc::{sync::Arc, vec::Vec};
use core::ops::AddAssign;
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
pub use undrift_events::Mounting;
use undrift_nav::{Matrix3, Quaternion, Vector3};

/// Speed above which the direction of motion counts on the straight [m/s].
const MIN_SPEED: f64 = 5.0;
/// Turn rate up to which driving is straight [rad/s].
const STRAIGHT: f64 = 0.05;
/// Speed above which it counts where turns do, too [m/s].
const MIN_SPEED_SLOW: f64 = 0.7;
/// Heading this uncertain \[rad\] or more says nothing of the forward axis.
const HEADING_STD: f64 = 0.05;
/// Driving that makes one value: errors of the attitude, bends and bumps live for about that long \[s\].
const BLOCK: f64 = 5.0;
/// Blocks needed for an estimate.
const MIN_BLOCKS: usize = 6;
/// Variance of the velocity's error, 0.1 m/s, times its correlation time, 5 s, over that of the lever before the drive, 2 m.
const LEVER: f64 = 0.0125;
/// Rounds in which forward axis and lever are found.
const ROUNDS: usize = 10;
/// What averages do not remove, one standard deviation \[rad\]: crown of the road and an uneven load
/// in roll; squat at speed in pitch; side slip of one-sided bends in yaw.
const FLOOR: [f64; 3] = [0.012, 0.004, 0.003];
/// Standard deviation of yaw that averages do not remove where turns count \[rad\]: they may all be to one side.
pub const FLOOR_TURNING: f64 = 0.015;
/// Longest part of a log, from its first sample, that an estimate ahead of the navigation looks at \[s\].
pub const LONGEST_PASS: f64 = 900.0;

/// Why there is no estimate of the mounting.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub enum MountingError {
    /// Not enough driving with a known heading.
    #[error(
        "the mounting could not be estimated: only {found:.0} s of driving above {MIN_SPEED_SLOW} m/s with a known \
         heading, {:.0} s are needed; set imu.mounting or imu.axes",
        MIN_BLOCKS as f64 * BLOCK
    )]
    TooLittle {
        /// Length of the driving that there was \[s\].
        found: f64,
    },
    /// The vehicle does not move along one of the sensor's directions.
    #[error(
        "the mounting could not be estimated: the direction of motion varies by {:.0} deg in sensor axes, \
         so this is not a wheeled vehicle, or the IMU is not fixed to it; set imu.mounting or imu.axes", wander.to_degrees()
    )]
    Wanders {
        /// Standard deviation of its direction \[rad\].
        wander: f64,
    },
    /// What driving there was leaves the directions too uncertain.
    #[error(
        "the mounting could not be estimated to better than {:.1} deg; set imu.mounting or imu.axes", std.to_degrees()
    )]
    Unsure {
        /// Standard deviation of pitch or yaw, the larger one \[rad\].
        std: f64,
    },
}

/// Direction of motion beyond this standard deviation is no axis \[rad\].
const WANDER: f64 = 0.2;

/// Sums over some seconds of motion.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
struct Block {
    /// Length of the motion in it \[s\].
    span: f64,
    /// Sums of products of the velocity, of velocity and angular rate, of the angular rate; in sensor axes.
    velocity: Matrix3,
    mixed: Matrix3,
    rate: Matrix3,
    /// Sum of the velocity, reversed where it is against those before.
    along: Vector3,
    /// Sum of the direction of down.
    down: Vector3,
    /// Sum of the heading's variance.
    variance: f64,
    /// Time moving with `along` less time against it \[s\].
    ahead: f64,
}

impl Block {
    /// Adds `dt` \[s\] of motion; `forward` is the direction of the motion so far, which a reversing vehicle goes against.
    fn add(&mut self, dt: f64, motion: &BodyMotion, forward: &Vector3) {
        let BodyMotion { v, omega, down, .. } = motion;
        // Reversing counts as the same axis the other way round; most of the driving is forward.
        let sign = if v.dot(forward) < 0.0 { -1.0 } else { 1.0 };
        self.span += dt;
        self.velocity += v * v.transpose() * dt;
        self.mixed += v * omega.transpose() * dt;
        self.rate += omega * omega.transpose() * dt;
        self.along += v * (sign * dt);
        self.down += down * dt;
        self.variance += motion.heading_variance * dt;
        self.ahead += sign * dt;
    }
}

impl AddAssign<&Block> for Block {
    fn add_assign(&mut self, other: &Block) {
        self.span += other.span;
        self.velocity += other.velocity;
        self.mixed += other.mixed;
        self.rate += other.rate;
        self.along += other.along;
        self.down += other.down;
        self.variance += other.variance;
        self.ahead += other.ahead;
    }
}

/// What moves, in sensor axes.
struct BodyMotion {
    v: Vector3,
    omega: Vector3,
    down: Vector3,
    heading_variance: f64,
}

/// Blocks of motion of one kind.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
struct Blocks {
    present: Block,
    /// Shared by the copies of a navigator.
    whole: Arc<Vec<Block>>,
    sum: Block,
}

impl Blocks {
    /// Adds `dt` \[s\] of motion; a block that has become long enough is put with the others.
    fn add(&mut self, dt: f64, motion: &BodyMotion) {
        let forward = self.sum.along + self.present.along;
        self.present.add(dt, motion, &forward);
        if self.present.span < BLOCK {
            return;
        }
        let block = core::mem::take(&mut self.present);
        self.sum += &block;
        Arc::make_mut(&mut self.whole).push(block);
    }

    /// Driving so far \[s\].
    fn duration(&self) -> f64 {
        self.whole.len() as f64 * BLOCK
    }

    /// The mounting by the blocks: by the mean direction where driving was `straight`, else with the lever to the axle.
    fn estimate(&self, straight: bool) -> Result<Mounting, MountingError> {
        if self.whole.len() < MIN_BLOCKS {
            return Err(MountingError::TooLittle {
                found: self.duration(),
            });
        }
        let n = self.whole.len() as f64;
        let lost = || MountingError::Wanders { wander: WANDER };
        let Block {
            velocity,
            mixed,
            rate,
            ..
        } = &self.sum;
        let mut forward = self.sum.along.try_normalize(1e-9).ok_or_else(lost)?;
        let mut lever = 0.0;
        let across = |forward: &Vector3| {
            let right = self.sum.down.cross(forward).try_normalize(1e-9);
            right.map(|right| (right, forward.cross(&right)))
        };
        for _ in 0..ROUNDS {
            let (right, down) = across(&forward).ok_or_else(lost)?;
            // Least squares: velocity to the right is yaw times speed plus lever times turn rate, downwards pitch times speed.
            let ahead = velocity * forward;
            let turning = mixed * down;
            let (speeds, both) = (forward.dot(&ahead), forward.dot(&turning));
            let rates = down.dot(&(rate * down)) + LEVER;
            let (of_speed, of_rate) = (right.dot(&ahead), right.dot(&turning));
            let yaw = if straight {
                of_speed / speeds
            } else {
                let determinant = speeds * rates - both * both;
                lever = (speeds * of_rate - both * of_speed) / determinant;
                (rates * of_speed - both * of_rate) / determinant
            };
            let next = forward + right * yaw + down * (down.dot(&ahead) / speeds);
            forward = next.try_normalize(1e-9).ok_or_else(lost)?;
        }
        if self.sum.ahead < 0.0 {
            forward = -forward;
            lever = -lever;
        }
        let (right, down) = across(&forward).ok_or_else(lost)?;
        let c_vb = Matrix3::from_rows(&[forward.transpose(), right.transpose(), down.transpose()]);

        // Scatter of the blocks' directions across forward, each with the weight that it has in the whole.
        let (mut pitch, mut yaw, mut roll, mut weights) = (0.0, 0.0, 0.0, 0.0);
        for block in self.whole.iter() {
            let ahead = block.velocity * forward;
            let turning = lever * forward.dot(&(block.mixed * down));
            pitch += down.dot(&ahead).powi(2);
            yaw += (right.dot(&ahead) - turning).powi(2);
            roll += (block.down.dot(&right) / block.span).powi(2);
            weights += forward.dot(&ahead);
        }
        let few = n / (n - 1.0) / (weights * weights);
        let (pitch, yaw, roll) = (pitch * few, yaw * few, roll / (n - 1.0) / n);
        let wander = (n * (pitch + yaw)).sqrt();
        if wander > WANDER {
            return Err(MountingError::Wanders { wander });
        }
        // The filter's heading error outlives a block; it is taken to be another one after a minute.
        let minutes = (self.duration() / 60.0).max(1.0);
        let heading = self.sum.variance / self.sum.span / minutes;
        let floor = match straight {
            true => FLOOR,
            false => [FLOOR[0], FLOOR[1], FLOOR_TURNING],
        };
        let std = Vector3::new(roll, pitch, yaw + heading);
        Ok(Mounting {
            q_vb: Quaternion::from_matrix(&c_vb),
            std: std.zip_map(&Vector3::from(floor), |variance, floor| {
                (variance + floor * floor).sqrt()
            }),
            duration: self.duration(),
            straight,
        })
    }
}

/// Gathers the directions of motion and of down. Streamed: kept are sums over blocks of 5 s.
///
/// ```
/// use undrift_engine::mounting::MountingEstimator;
/// use undrift_nav::{Vector3, attitude::from_rpy};
/// // A sensor that is turned 30° to the right in a vehicle that drives north-east on the level for two minutes.
/// let q_vb = from_rpy(&Vector3::new(0.0, 0.0, 30f64.to_radians()));
/// let q_nv = from_rpy(&Vector3::new(0.0, 0.0, 45f64.to_radians()));
/// let (v_n, std) = (q_nv * Vector3::new(15.0, 0.0, 0.0), Vector3::new(0.003, 0.003, 0.01));
/// let mut estimator = MountingEstimator::default();
/// for _ in 0..1200 {
///     estimator.add(0.1, &(q_nv * q_vb), &v_n, &Vector3::zeros(), &std);
/// }
/// let mounting = estimator.estimate()?;
/// assert!((mounting.rpy() - Vector3::new(0.0, 0.0, 30f64.to_radians())).norm() < 1e-6);
/// assert!(mounting.straight && mounting.std.z < 0.02);
/// # Ok::<(), undrift_engine::mounting::MountingError>(())
/// ```
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub struct MountingEstimator {
    /// Blocks of driving fast and straight, by unit vectors.
    straight: Blocks,
    /// Blocks of all driving, by velocities.
    all: Blocks,
}

impl MountingEstimator {
    /// Adds `dt` \[s\] of motion of a solution in the sensor's own axes: attitude `q_nb`, velocity `v_n` [m/s, north-east-down], angular rate ω_nb^b
    /// [rad/s, sensor axes], and the standard deviations of the misalignment about north, east, down \[rad\].
    pub fn add(
        &mut self,
        dt: f64,
        q_nb: &Quaternion,
        v_n: &Vector3,
        omega_nb_b: &Vector3,
        attitude_std: &Vector3,
    ) {
        let speed = v_n.norm();
        if speed < MIN_SPEED_SLOW || attitude_std.z >= HEADING_STD {
            return;
        }
        let v = q_nb.inverse() * v_n;
        let motion = BodyMotion {
            v,
            omega: *omega_nb_b,
            down: q_nb.inverse() * Vector3::z(),
            heading_variance: attitude_std.z * attitude_std.z,
        };
        self.all.add(dt, &motion);
        if speed > MIN_SPEED && omega_nb_b.norm() < STRAIGHT {
            let v = v / speed;
            self.straight.add(dt, &BodyMotion { v, ..motion });
        }
    }

    /// Whether an estimate would rest on straight driving.
    pub(crate) fn is_straight(&self) -> bool {
        self.straight.whole.len() >= MIN_BLOCKS
    }

    /// Length of the driving that an estimate would be based on \[s\].
    pub fn duration(&self) -> f64 {
        match self.is_straight() {
            true => self.straight.duration(),
            false => self.all.duration(),
        }
    }

    /// The mounting by all motion so far; may be asked at any time.
    ///
    /// # Errors
    /// [`MountingError::TooLittle`] before half a minute of driving with a known heading; [`MountingError::Wanders`] where the
    /// motion has no one direction in sensor axes; [`MountingError::Unsure`] where pitch or yaw stay too uncertain.
    pub fn estimate(&self) -> Result<Mounting, MountingError> {
        match self.straight.estimate(true) {
            Err(MountingError::TooLittle { .. }) => self.all.estimate(false),
            found => found,
        }
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
    fn standing_or_lost_says_nothing() {
        let mut estimator = MountingEstimator::default();
        let q = Quaternion::identity();
        let east = Vector3::y();
        for _ in 0..1000 {
            estimator.add(1.0, &q, &(east * 0.3), &Vector3::zeros(), &STD);
            estimator.add(1.0, &q, &(east * 10.0), &Vector3::zeros(), &(STD * 10.0));
        }
        let error = estimator.estimate().unwrap_err();
        assert!(matches!(error, MountingError::TooLittle { found } if found == 0.0));
    }

    #[test]
    fn a_slow_robot_that_always_turns_has_a_forward_axis() {
        let q_vb = from_rpy(&Vector3::new(0.1, -0.3, 2.2));
        let (mut estimator, lever, mut heading) = (MountingEstimator::default(), 0.8, 0.0_f64);
        for step in 0..3000 {
            let rate = if step < 1000 { 0.4 } else { 0.25 };
            heading += rate * 0.1;
            let q_nv = from_rpy(&Vector3::new(0.0, 0.0, heading));
            // Where the IMU sits before the axle it moves sideways.
            let v_n = q_nv * Vector3::new(1.5, lever * rate, 0.0);
            let omega = q_vb.inverse() * (Vector3::z() * rate);
            estimator.add(0.1, &(q_nv * q_vb), &v_n, &omega, &STD);
        }
        let found = estimator.estimate().unwrap();
        assert!(!found.straight);
        assert!(found.q_vb.angle_to(&q_vb) < 0.02, "{:?}", found.rpy());
        assert!(found.std.z > 0.01 && found.std.max() < 0.03, "{found:?}");
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

    #[test]
    fn the_yaw_is_no_better_known_than_the_heading() {
        // 100 s of straight driving without scatter: the filter's heading error is another one after each minute.
        let heading = 0.04;
        let mut estimator = MountingEstimator::default();
        for second in 0..100 {
            let q_nb = from_rpy(&Vector3::new(0.0, 0.0, f64::from(second)));
            let std = Vector3::new(0.003, 0.003, heading);
            estimator.add(
                1.0,
                &q_nb,
                &(q_nb * Vector3::x() * 10.0),
                &Vector3::zeros(),
                &std,
            );
        }
        let found = estimator.estimate().unwrap();
        let expected = (heading * heading / (100.0 / 60.0) + FLOOR[2] * FLOOR[2]).sqrt();
        // Rounding of directions, 1e-16.
        assert!((found.std.z - expected).abs() < 1e-12, "{}", found.std.z);
        assert!((found.std.y - FLOOR[1]).abs() < 1e-12 && (found.std.x - FLOOR[0]).abs() < 1e-12);
    }
}
