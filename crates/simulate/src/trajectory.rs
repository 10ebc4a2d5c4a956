//! Analytic motion: position's rate, velocity, attitude and their derivatives in closed form.
//!
//! The path is speed v, climb angle γ and course χ: `v_n = v [cosγ cosχ, cosγ sinχ, −sinγ]`. The
//! body's roll, pitch and yaw are those of the path (0, γ, χ) plus what the vehicle does on top.
//! Only the position has to be integrated; that is [`super::ideal_imu`].

use super::profile::{Channel, Profile};
use undrift_nav::{Quaternion, Vector3, attitude, earth::Geodetic, earth::STANDARD_GRAVITY};

/// Longest trajectory \[s\], ten days; a longer duration is cut to it.
pub const MAX_DURATION: f64 = 864_000.0;

/// A motion as smooth functions of time from 0 to `duration`. Angles in radians, right-handed about
/// the body's forward-right-down axes: nose up, right side down and turning right are positive.
#[derive(Clone, Debug, PartialEq)]
pub struct Trajectory {
    /// Where the IMU is at time 0.
    pub start: Geodetic,
    /// Length in time \[s\].
    pub duration: f64,
    /// Speed v along the path over ground [m/s].
    pub speed: Profile,
    /// Course χ at time 0 \[rad\], clockwise from north.
    pub course: f64,
    /// Rate of the course [rad/s]; its exact integral is the course.
    pub turn_rate: Profile,
    /// Climb angle γ of the path \[rad\], up positive.
    pub climb: Channel,
    /// Roll of the body \[rad\], beside the couplings below.
    pub roll: Channel,
    /// Pitch of the body beyond the climb angle \[rad\].
    pub pitch: Channel,
    /// Yaw of the body beyond the course \[rad\]; a crab angle.
    pub yaw: Channel,
    /// Roll of the body per lateral acceleration v·χ̇ [rad/(m/s²)]; a car leans outwards: negative.
    pub roll_per_lateral: f64,
    /// Pitch of the body per acceleration v̇ [rad/(m/s²)]; a car squats: positive.
    pub pitch_per_acceleration: f64,
    /// Whether the vehicle banks by atan(v·χ̇/g) on top of everything else: a coordinated turn.
    pub coordinated: bool,
    /// Speed v₀ [m/s] that opens the gate `v²/(v² + v₀²)` of all waves by half; with 0 they never fade.
    pub gate_speed: f64,
}

/// Velocity and attitude at one instant, with their derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Velocity over ground north-east-down [m/s].
    pub v_n: Vector3,
    /// Derivative dv_n/dt of its three components [m/s²].
    pub dv_n: Vector3,
    /// Attitude, body to navigation.
    pub q_nb: Quaternion,
    /// Angular rate ω_nb^b of the body against the navigation frame [rad/s].
    pub omega_nb_b: Vector3,
}

/// The path's part of the motion, all that position needs.
#[derive(Clone, Copy, Debug)]
struct PathPoint {
    speed: super::profile::ProfileValue,
    turn_rate: super::profile::ProfileValue,
    gate: (f64, f64),
    climb: (f64, f64),
    sin_climb: f64,
    cos_climb: f64,
    sin_course: f64,
    cos_course: f64,
}

impl Trajectory {
    /// At rest, level, heading north, at 30.44° N, 114.47° E, 20 m. `duration` \[s\] outside 0 to
    /// [`MAX_DURATION`] is cut to it.
    pub fn rest(duration: f64) -> Self {
        Self {
            start: Geodetic::from_degrees(30.44, 114.47, 20.0),
            duration: Self::sane(duration),
            speed: Profile::hold(0.0),
            course: 0.0,
            turn_rate: Profile::hold(0.0),
            climb: Channel::hold(0.0),
            roll: Channel::hold(0.0),
            pitch: Channel::hold(0.0),
            yaw: Channel::hold(0.0),
            roll_per_lateral: 0.0,
            pitch_per_acceleration: 0.0,
            coordinated: false,
            gate_speed: 2.0,
        }
    }

    /// Constant `speed` [m/s] and `course` \[rad\], level; a loxodrome, already moving at time 0.
    pub fn straight(speed: f64, course: f64, duration: f64) -> Self {
        Self {
            speed: Profile::hold(speed),
            course,
            ..Self::rest(duration)
        }
    }

    /// Constant `speed` [m/s] and `turn_rate` [rad/s, right positive], level and without bank,
    /// heading north at time 0.
    pub fn constant_turn(speed: f64, turn_rate: f64, duration: f64) -> Self {
        Self {
            turn_rate: Profile::hold(turn_rate),
            ..Self::straight(speed, 0.0, duration)
        }
    }

    /// A duration cut to 0 … [`MAX_DURATION`]; 0 for what is not a number.
    pub(super) fn sane(duration: f64) -> f64 {
        if duration > 0.0 {
            duration.min(MAX_DURATION)
        } else {
            0.0
        }
    }

    /// All profiles, for their knots.
    fn profiles(&self) -> [&Profile; 6] {
        [
            &self.speed,
            &self.turn_rate,
            &self.climb.profile,
            &self.roll.profile,
            &self.pitch.profile,
            &self.yaw.profile,
        ]
    }

    /// The times \[s\], sorted and each once, where some third derivative jumps.
    pub fn knots(&self) -> Vec<f64> {
        let mut knots: Vec<f64> = self
            .profiles()
            .iter()
            .flat_map(|profile| profile.knots())
            .collect();
        knots.sort_by(f64::total_cmp);
        knots.dedup();
        knots
    }

    /// Period of the fastest wave \[s\]; infinite without waves.
    pub fn shortest_period(&self) -> f64 {
        [&self.climb, &self.roll, &self.pitch, &self.yaw]
            .iter()
            .flat_map(|channel| &channel.waves)
            .fold(f64::INFINITY, |least, wave| least.min(wave.period.abs()))
    }

    /// The gate of the waves and its rate [1/s], from the speed [m/s] and its rate [m/s²].
    fn gate(&self, speed: f64, rate: f64) -> (f64, f64) {
        let half = self.gate_speed * self.gate_speed;
        if half <= 0.0 {
            return (1.0, 0.0);
        }
        let sum = speed * speed + half;
        (speed * speed / sum, 2.0 * speed * rate * half / (sum * sum))
    }

    fn path(&self, time: f64) -> PathPoint {
        let speed = self.speed.at(time);
        let turn_rate = self.turn_rate.at(time);
        let gate = self.gate(speed.value, speed.rate);
        let climb = self.climb.at(time, gate.0, gate.1);
        let (sin_climb, cos_climb) = climb.0.sin_cos();
        let (sin_course, cos_course) = (self.course + turn_rate.integral).sin_cos();
        PathPoint {
            speed,
            turn_rate,
            gate,
            climb,
            sin_climb,
            cos_climb,
            sin_course,
            cos_course,
        }
    }

    /// Velocity over ground north-east-down [m/s] at `time` \[s\].
    pub fn velocity(&self, time: f64) -> Vector3 {
        self.path(time).velocity()
    }

    /// Velocity, attitude and their derivatives at `time` \[s\].
    pub fn motion(&self, time: f64) -> Motion {
        let path = self.path(time);
        let (v, turn) = (path.speed, path.turn_rate);
        let (climb, climb_rate) = path.climb;
        let course = self.course + turn.integral;

        let forward = Vector3::new(
            path.cos_climb * path.cos_course,
            path.cos_climb * path.sin_course,
            -path.sin_climb,
        );
        let by_climb = Vector3::new(
            -path.sin_climb * path.cos_course,
            -path.sin_climb * path.sin_course,
            -path.cos_climb,
        );
        let by_course = Vector3::new(
            -path.cos_climb * path.sin_course,
            path.cos_climb * path.cos_course,
            0.0,
        );
        let v_n = v.value * forward;
        let dv_n = v.rate * forward + v.value * (climb_rate * by_climb + turn.value * by_course);

        let (mut roll, mut roll_rate) = self.roll.at(time, path.gate.0, path.gate.1);
        let lateral = v.value * turn.value;
        let lateral_rate = v.rate * turn.value + v.value * turn.rate;
        roll += self.roll_per_lateral * lateral;
        roll_rate += self.roll_per_lateral * lateral_rate;
        if self.coordinated {
            let tan_bank = lateral / STANDARD_GRAVITY;
            roll += tan_bank.atan();
            roll_rate += lateral_rate / STANDARD_GRAVITY / (1.0 + tan_bank * tan_bank);
        }
        let (extra, extra_rate) = self.pitch.at(time, path.gate.0, path.gate.1);
        let pitch = climb + extra + self.pitch_per_acceleration * v.rate;
        let pitch_rate = climb_rate + extra_rate + self.pitch_per_acceleration * v.acceleration;
        let (extra, extra_rate) = self.yaw.at(time, path.gate.0, path.gate.1);
        let (yaw, yaw_rate) = (course + extra, turn.value + extra_rate);

        // Groves eq. 2.58: ω_nb^b from the rates of roll, pitch and yaw.
        let (sr, cr) = roll.sin_cos();
        let (sp, cp) = pitch.sin_cos();
        Motion {
            v_n,
            dv_n,
            q_nb: attitude::from_rpy(&Vector3::new(roll, pitch, yaw)),
            omega_nb_b: Vector3::new(
                roll_rate - yaw_rate * sp,
                pitch_rate * cr + yaw_rate * sr * cp,
                -pitch_rate * sr + yaw_rate * cr * cp,
            ),
        }
    }
}

impl PathPoint {
    fn velocity(&self) -> Vector3 {
        self.speed.value
            * Vector3::new(
                self.cos_climb * self.cos_course,
                self.cos_climb * self.sin_course,
                -self.sin_climb,
            )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Central difference over ±h by five points.
    fn difference(f: impl Fn(f64) -> Vector3, h: f64) -> Vector3 {
        (8.0 * (f(h) - f(-h)) - (f(2.0 * h) - f(-2.0 * h))) / (12.0 * h)
    }

    #[test]
    fn derivatives_are_those_of_velocity_and_attitude() {
        let mut crabbing = Trajectory::car(400.0, 5);
        crabbing.yaw = crabbing.roll.clone();
        for trajectory in [
            Trajectory::car(400.0, 3),
            Trajectory::flight(400.0, 3),
            crabbing,
        ] {
            let mut largest = (0.0f64, 0.0f64);
            for i in 0..4000 {
                let t = 50.0 + f64::from(i) * 0.0871;
                let m = trajectory.motion(t);
                assert_eq!(m.v_n, trajectory.velocity(t));
                let dv = difference(|h| trajectory.velocity(t + h), 1e-4);
                let turned = |h| (m.q_nb.inverse() * trajectory.motion(t + h).q_nb).scaled_axis();
                let omega = difference(turned, 1e-4);
                // Rounding: 60 m/s · 1e-16 / 1e-4 s = 1e-10; truncation h⁴/30 times a fifth
                // derivative below 1e6 is 1e-11, a jump of the third across a knot h²·10 = 1e-7.
                assert!((dv - m.dv_n).norm() < 2e-7, "{t} {dv} {}", m.dv_n);
                assert!((omega - m.omega_nb_b).norm() < 2e-7, "{t} {omega}");
                largest.0 = largest.0.max(m.dv_n.norm());
                largest.1 = largest.1.max(m.omega_nb_b.norm());
            }
            // It moved.
            assert!(largest.0 > 1.0 && largest.1 > 0.1, "{largest:?}");
        }
    }

    #[test]
    fn coordinated_turn_feels_no_lateral_force() {
        let (speed, rate) = (50.0, 0.1);
        let trajectory = Trajectory {
            coordinated: true,
            ..Trajectory::constant_turn(speed, rate, 10.0)
        };
        let m = trajectory.motion(3.0);
        let felt = m
            .q_nb
            .inverse_transform_vector(&(m.dv_n - STANDARD_GRAVITY * Vector3::z()));
        assert!(felt.y.abs() < 1e-13 && felt.z < -STANDARD_GRAVITY);
        // Turning right banks to the right.
        assert!(attitude::to_rpy(&m.q_nb).x > 0.4);
    }

    #[test]
    fn odd_durations_are_cut() {
        assert_eq!(Trajectory::rest(f64::NAN).duration, 0.0);
        assert_eq!(Trajectory::rest(-1.0).duration, 0.0);
        assert_eq!(Trajectory::rest(f64::INFINITY).duration, MAX_DURATION);
    }
}
