//! Strapdown mechanisation in the north-east-down frame, on increments.
//!
//! Attitude by quaternion with the second-order coning term, velocity with rotation and sculling
//! terms, both from the present and the previous increment; Earth rate, transport rate and Coriolis
//! at the middle of the step. Savage 1998 parts 1 and 2; Titterton & Weston 2004, chapter 11;
//! Groves 2013, section 5.5.
//!
//! ```
//! use undrift_nav::{Quaternion, Vector3, earth::{Geodetic, LocalEarth}};
//! use undrift_nav::mechanisation::{Increments, NavState};
//! let place = Geodetic::from_degrees(45.0, 7.0, 300.0);
//! let mut state = NavState { time: 0.0, position: place, v_n: Vector3::zeros(), q_nb: Quaternion::identity() };
//! // Ten seconds of 1 m/s² forward, which is north here, over the reaction to gravity.
//! let earth = LocalEarth::at(&place);
//! for _ in 0..1000 {
//!     let force = Vector3::new(1.0, 0.0, -earth.gravity);
//!     state.step(&Increments { dt: 0.01, rotation: earth.earth_rate() * 0.01, dvel: force * 0.01 });
//! }
//! assert!((state.v_n.x - 10.0).abs() < 0.01 && (state.time - 10.0).abs() < 1e-9);
//! ```

use crate::{
    Quaternion, Vector3, attitude,
    earth::{Geodetic, LocalEarth},
};

/// Position, velocity and attitude of the IMU at one instant: the solution itself, without its covariance.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct NavState {
    /// Time \[s\], in the log's time base.
    pub time: f64,
    /// Place of the IMU, not of the antenna.
    pub position: Geodetic,
    /// Velocity over ground (against the turning Earth), north-east-down [m/s].
    pub v_n: Vector3,
    /// Attitude, from body to navigation axes: `v_n = q_nb * v_b`.
    pub q_nb: Quaternion,
}

/// Increments of one interval with the change of direction within it accounted for, so that a part of the interval is that part of each
/// increment. Coning and sculling are what a body that turns while it turns and accelerates adds to the plain sums.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Increments {
    /// Length of the interval \[s\].
    pub dt: f64,
    /// Rotation vector, coning included \[rad\], body axes.
    pub rotation: Vector3,
    /// Velocity increment, sculling included but not the rotation within the interval [m/s], body axes.
    pub dvel: Vector3,
}

impl Increments {
    /// The increments of an interval from its raw ones, `dt` \[s\], `dtheta` \[rad\] and `dvel` [m/s] in body axes, and
    /// those of the interval before (`None` at the start: no coning and sculling).
    ///
    /// With angular rate and specific force linear in time over both intervals, lengths t₁ and t₂,
    /// coning is `c Δθ₁ × Δθ₂` and sculling `c (Δθ₁ × Δv₂ + Δv₁ × Δθ₂)` with
    /// `c = t₂² / (6 t₁ (t₁ + t₂))`, which is 1/12 for equal intervals. Savage 1998.
    ///
    /// ```
    /// use undrift_nav::{Vector3, mechanisation::{Increments, RawIncrements}};
    /// // A body that rolls in one sample and pitches in the next has yawed, too: coning.
    /// let roll = RawIncrements { dt: 0.01, dtheta: Vector3::new(0.01, 0.0, 0.0), dvel: Vector3::zeros() };
    /// let pitch = Increments::from_raw(0.01, Vector3::new(0.0, 0.01, 0.0), Vector3::zeros(), Some(&roll));
    /// assert!((pitch.rotation.z - 1e-4 / 12.0).abs() < 1e-12); // [rad]
    /// ```
    #[inline]
    pub fn from_raw(
        dt: f64,
        dtheta: Vector3,
        dvel: Vector3,
        previous: Option<&RawIncrements>,
    ) -> Self {
        let Some(before) = previous else {
            return Self {
                dt,
                rotation: dtheta,
                dvel,
            };
        };
        let c = dt * dt / (6.0 * before.dt * (before.dt + dt));
        Self {
            dt,
            rotation: dtheta + before.dtheta.cross(&dtheta) * c,
            dvel: dvel + (before.dtheta.cross(&dvel) + before.dvel.cross(&dtheta)) * c,
        }
    }

    /// The increments of a `fraction` (0…1) of the interval: a fix inside a sample splits it.
    #[inline]
    pub fn part(&self, fraction: f64) -> Self {
        Self {
            dt: self.dt * fraction,
            rotation: self.rotation * fraction,
            dvel: self.dvel * fraction,
        }
    }
}

/// Increments of one interval as the sensor gives them, less its predicted error: the plain integrals, without coning and sculling.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RawIncrements {
    /// Length of the interval \[s\].
    pub dt: f64,
    /// Integrated angular rate \[rad\], body axes.
    pub dtheta: Vector3,
    /// Integrated specific force [m/s], body axes.
    pub dvel: Vector3,
}

/// The local quantities that one step used, for the transition of the error state
/// ([`Transition::new`](crate::covariance::Transition::new)).
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// Length of the step \[s\].
    pub dt: f64,
    /// Radii of curvature and gravity at the start of the step.
    pub earth: LocalEarth,
    /// Velocity at the middle of the step, north-east-down [m/s].
    pub v_mid: Vector3,
    /// Specific force integrated over the step, north-east-down [m/s]; gravity and Coriolis are not in it.
    pub dvel_n: Vector3,
    /// Earth rate ω_ie^n [rad/s] at the start of the step.
    pub earth_rate: Vector3,
    /// Transport rate ω_en^n [rad/s] at the velocity of the middle of the step.
    pub transport_rate: Vector3,
}

impl NavState {
    /// Carries the state over one interval of `increments`; `time` grows by their `dt`. Groves section 5.5.
    ///
    /// Nothing is checked: a state near a pole, or increments that are not finite, leave a state that [`NavState::is_valid`] refuses.
    #[inline]
    pub fn step(&mut self, increments: &Increments) -> Step {
        self.step_over(increments, LocalEarth::at(&self.position))
    }

    /// Does [`NavState::step`] over `earth`, which is that of the state's position, or one that does not turn.
    #[inline]
    pub fn step_over(&mut self, increments: &Increments, earth: LocalEarth) -> Step {
        let Increments { dt, rotation, dvel } = *increments;
        let gravity = Vector3::new(0.0, 0.0, earth.gravity);

        // Specific force, turned from the body at the start of the step to the navigation frame.
        let turned = dvel + rotation.cross(&dvel) * 0.5;
        let dvel_start = self.q_nb * turned;
        let v_mid = self.v_n + (dvel_start + gravity * dt) * 0.5;

        let earth_rate = earth.earth_rate();
        let transport_rate = earth.transport_rate(&v_mid);
        let frame_turn = (earth_rate + transport_rate) * dt;
        let dvel_n = dvel_start - frame_turn.cross(&dvel_start) * 0.5;

        let coriolis = (earth_rate * 2.0 + transport_rate).cross(&v_mid);
        let v_new = self.v_n + dvel_n + (gravity - coriolis) * dt;

        let travel = (self.v_n + v_new) * (0.5 * dt);
        let climb = -travel.z;
        let dlat = travel.x / (earth.rm_h + 0.5 * climb);
        let cos_mid = earth.cos_lat - earth.sin_lat * 0.5 * dlat;
        self.position.lat += dlat;
        self.position.lon += travel.y / ((earth.rn_h + 0.5 * climb) * cos_mid);
        self.position.height += climb;

        self.v_n = v_new;
        self.q_nb = attitude::from_rotation_vector(&-frame_turn)
            * self.q_nb
            * attitude::from_rotation_vector(&rotation);
        self.q_nb.renormalize_fast();
        self.time += dt;
        Step {
            dt,
            earth,
            v_mid,
            dvel_n,
            earth_rate,
            transport_rate,
        }
    }

    /// The state with a small error removed: `dr` \[m\], `dv` [m/s] and `psi` \[rad\], north-east-down, are estimate less truth, with
    /// `Ĉ_b^n = (I − [ψ×]) C_b^n`: the attitude turns by `+ψ` in `n`. First order in the position, exact in the rotation. Groves
    /// section 14.1.1.
    ///
    /// ```
    /// use undrift_nav::{Quaternion, Vector3, earth::Geodetic, mechanisation::NavState};
    /// let place = Geodetic::from_degrees(47.0, 8.0, 400.0);
    /// let nav = NavState { time: 0.0, position: place, v_n: Vector3::zeros(), q_nb: Quaternion::identity() };
    /// // Estimated 3 m too far north, and 0.01 rad off about down.
    /// let corrected = nav.without_error(&Vector3::new(3.0, 0.0, 0.0), &Vector3::zeros(), &Vector3::new(0.0, 0.0, 0.01));
    /// assert!((place.offset_to(&corrected.position).x + 3.0).abs() < 1e-6);
    /// assert!((undrift_nav::attitude::to_rpy(&corrected.q_nb).z - 0.01).abs() < 1e-12);
    /// ```
    #[inline]
    pub fn without_error(&self, dr: &Vector3, dv: &Vector3, psi: &Vector3) -> Self {
        let mut q_nb = attitude::from_rotation_vector(psi) * self.q_nb;
        q_nb.renormalize();
        Self {
            time: self.time,
            position: self.position.displaced(&-dr),
            v_n: self.v_n - dv,
            q_nb,
        }
    }

    /// Whether every number is finite, the place valid and away from the poles (within 0.1° of one
    /// north and east lose their meaning), and the speed below 10 km/s.
    #[inline]
    pub fn is_valid(&self) -> bool {
        self.position.is_valid()
            && self.position.lat.abs() < MAX_LATITUDE
            && self.v_n.norm_squared() < MAX_SPEED * MAX_SPEED
            && self.q_nb.coords.as_slice().iter().all(|c| c.is_finite())
    }
}

/// Latitude \[rad\] beyond which a north-east-down frame is refused: 89.9°.
pub const MAX_LATITUDE: f64 = 89.9 * core::f64::consts::PI / 180.0;
/// Speed [m/s] beyond which a solution is refused.
pub const MAX_SPEED: f64 = 10_000.0;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coning_motion_does_not_drift() {
        // Classical coning: body axis sweeping a cone of half angle a at rate w. The exact
        // increments over [t, t+T] are the integrals of ω(t). Savage 1998, section "coning".
        let (a, w, t_step) = (0.01f64, 2.0 * core::f64::consts::PI * 5.0, 0.005);
        let omega_integral = |t: f64| {
            Vector3::new(
                libm::sin(a) * libm::cos(w * t),
                libm::sin(a) * libm::sin(w * t),
                (libm::cos(a) - 1.0) * w * t,
            )
        };
        let rotation_drift = |with_coning: bool| {
            let mut q = Quaternion::identity();
            let mut before: Option<RawIncrements> = None;
            let steps = 2000;
            for k in 0..steps {
                let dtheta =
                    omega_integral((k + 1) as f64 * t_step) - omega_integral(k as f64 * t_step);
                let previous = before.as_ref().filter(|_| with_coning);
                let inc = Increments::from_raw(t_step, dtheta, Vector3::zeros(), previous);
                q *= attitude::from_rotation_vector(&inc.rotation);
                before = Some(RawIncrements {
                    dt: t_step,
                    dtheta,
                    dvel: Vector3::zeros(),
                });
            }
            // After whole periods the body is back where it began.
            q.angle()
        };
        let (without, with) = (rotation_drift(false), rotation_drift(true));
        // The drift without the term, about a² w³ T² / 24 a second over 10 s, is reduced by more than 20.
        assert!(without > 1e-5, "{without}");
        assert!(with < without / 20.0, "{with} {without}");
    }

    #[test]
    fn rest_stays_at_rest() {
        let position = Geodetic::from_degrees(45.0, 7.0, 300.0);
        let q_nb = attitude::from_rpy(&Vector3::new(0.1, -0.2, 2.0));
        let mut state = NavState {
            time: 0.0,
            position,
            v_n: Vector3::zeros(),
            q_nb,
        };
        let dt = 0.01;
        let earth = LocalEarth::at(&position);
        let f = q_nb.inverse() * Vector3::new(0.0, 0.0, -earth.gravity) * dt;
        let w = q_nb.inverse() * earth.earth_rate() * dt;
        for _ in 0..6000 {
            state.step(&Increments {
                dt,
                rotation: w,
                dvel: f,
            });
        }
        // The specific force turns with the body by ω_ie·T = 7e-7 rad a step; what is left is
        // rounding: 60 s at 1e-15·g·6000 steps.
        assert!(state.v_n.norm() < 1e-9, "{}", state.v_n);
        assert!(position.offset_to(&state.position).norm() < 1e-7);
        assert!(state.q_nb.angle_to(&q_nb) < 1e-11);
    }
}
