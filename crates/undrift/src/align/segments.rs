//! Motion between fixes, integrated once in body axes so that attitude and sensor biases can be
//! tried out without the samples (preintegration; Forster et al. 2017, section VI).

use crate::estimator::STAMP_ROUNDING;
use undrift_nav::{
    Matrix3, Quaternion, Vector3,
    attitude::{from_rotation_vector, skew},
    sample::{GnssFix, ImuSample},
};

/// Motion from the fix before to this one, with its derivatives by constant biases: gyro `g` [rad/s],
/// accelerometer `a` [m/s²], both what the sensor reads too much.
#[derive(Clone, Copy, Debug)]
pub(super) struct Segment {
    /// Length \[s\].
    pub(super) dt: f64,
    /// Attitude at the end against that at the start, end to start.
    pub(super) turn: Quaternion,
    /// Derivative of the turn, as a rotation vector at the end, by the gyro bias \[s\].
    pub(super) turn_by_g: Matrix3,
    /// Specific force integrated in the axes of the start [m/s].
    pub(super) dvel: Vector3,
    /// Its derivatives by the gyro bias \[m\] and the accelerometer bias \[s\].
    pub(super) dvel_by_g: Matrix3,
    pub(super) dvel_by_a: Matrix3,
    /// Angular rate at the end [rad/s].
    pub(super) omega_b: Vector3,
    /// Velocity of the antenna at the end [m/s] and its variances.
    pub(super) v_n: Vector3,
    pub(super) variance: Vector3,
}

impl Segment {
    fn new() -> Self {
        Self {
            dt: 0.0,
            turn: Quaternion::identity(),
            turn_by_g: Matrix3::zeros(),
            dvel: Vector3::zeros(),
            dvel_by_g: Matrix3::zeros(),
            dvel_by_a: Matrix3::zeros(),
            omega_b: Vector3::zeros(),
            v_n: Vector3::zeros(),
            variance: Vector3::zeros(),
        }
    }

    /// Adds `dt` \[s\] of a sample, whose gyros read too much by `gyro`.
    fn add(&mut self, sample: &ImuSample, dt: f64, gyro: &Vector3) {
        let part = dt / sample.dt;
        let (dtheta, dvel) = (sample.dtheta * part - gyro * dt, sample.dvel * part);
        // Specific force in the middle of the part's turn.
        let force = dvel + dtheta.cross(&dvel) * 0.5;
        let c = self.turn.to_rotation_matrix().into_inner();
        self.dvel_by_g -= c * skew(&force) * self.turn_by_g;
        self.dvel_by_a -= c * dt;
        self.dvel += c * force;
        let turn = from_rotation_vector(&dtheta);
        self.turn_by_g =
            turn.to_rotation_matrix().transpose() * self.turn_by_g - Matrix3::identity() * dt;
        self.turn *= turn;
        self.dt += dt;
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
    let mut open = Segment::new();
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
            if segments.is_empty() || open.dt >= spacing || last && open.dt > 0.0 {
                segments.push(Segment {
                    v_n,
                    variance,
                    ..open
                });
                open = Segment::new();
            }
        }
        if !segments.is_empty() && sample.time > done {
            open.add(sample, sample.time - done, gyro);
        }
    }
    segments
}
