//! What an ideal integrating IMU reports on a [`Trajectory`], and where it is.
//!
//! ω_ib^b = ω_nb^b + C_n^b (ω_ie^n + ω_en^n) and f^b = C_n^b (dv_n/dt − g^n + (2ω_ie^n + ω_en^n) × v_n)
//! (Groves eq. 5.44 and 5.53) are integrated by four Gauss-Legendre nodes per panel. Panels end at
//! the knots of the trajectory and are at most 10 ms, or an eighth of the fastest wave's period, so
//! that what is left of the integrals' error is rounding.

use super::trajectory::{MAX_DURATION, Motion, Trajectory};
use nalgebra::Matrix4;
use undrift_nav::{
    Vector3, attitude,
    earth::{Geodetic, LocalEarth},
    sample::{ImuSample, TruthSample},
};

/// Longest and shortest panel \[s\]; the shortest bounds the work that a silly wave can cause.
const PANEL: (f64, f64) = (1e-4, 0.01);

/// Four Gauss-Legendre nodes on [0, 1].
#[derive(Clone, Debug)]
struct Gauss {
    node: [f64; 4],
    weight: [f64; 4],
    /// Row i integrates the cubic through the four nodes from 0 to node i.
    partial: Matrix4<f64>,
}

impl Gauss {
    /// Abramowitz & Stegun 25.4.30, n = 4.
    fn new() -> Self {
        let inner = (3.0 / 7.0 - 2.0 / 7.0 * 1.2f64.sqrt()).sqrt() / 2.0;
        let outer = (3.0 / 7.0 + 2.0 / 7.0 * 1.2f64.sqrt()).sqrt() / 2.0;
        let heavy = (18.0 + 30f64.sqrt()) / 72.0;
        let light = (18.0 - 30f64.sqrt()) / 72.0;
        let node = [0.5 - outer, 0.5 - inner, 0.5 + inner, 0.5 + outer];
        // partial · V = M holds for the powers 0…3: V_jk = c_j^k, M_ik = c_i^(k+1)/(k+1).
        let v = Matrix4::from_fn(|j, k| node[j].powi(k as i32));
        let m = Matrix4::from_fn(|i, k| node[i].powi(k as i32 + 1) / (k as f64 + 1.0));
        let inverse = v.try_inverse().unwrap_or_else(Matrix4::zeros);
        Self {
            node,
            weight: [light, heavy, heavy, light],
            partial: m * inverse,
        }
    }
}

/// The vehicle at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// Time \[s\] from the trajectory's start.
    pub time: f64,
    /// Position of the IMU.
    pub position: Geodetic,
    /// Velocity, attitude and their derivatives.
    pub motion: Motion,
}

impl State {
    /// Angular rate ω_ib^b [rad/s] and specific force f^b [m/s²], what ideal sensors feel.
    pub fn felt(&self) -> (Vector3, Vector3) {
        felt(&self.motion, &LocalEarth::at(&self.position))
    }

    /// As a reference solution: position, velocity, roll, pitch and yaw.
    pub fn truth(&self) -> TruthSample {
        TruthSample {
            time: self.time,
            position: self.position,
            v_n: Some(self.motion.v_n),
            rpy: Some(attitude::to_rpy(&self.motion.q_nb)),
        }
    }
}

fn felt(motion: &Motion, earth: &LocalEarth) -> (Vector3, Vector3) {
    let earth_rate = earth.earth_rate();
    let transport = earth.transport_rate(&motion.v_n);
    let omega_in_n = earth_rate + transport;
    let gravity = Vector3::new(0.0, 0.0, earth.gravity);
    let force = motion.dv_n - gravity + (omega_in_n + earth_rate).cross(&motion.v_n);
    (
        motion.omega_nb_b + motion.q_nb.inverse_transform_vector(&omega_in_n),
        motion.q_nb.inverse_transform_vector(&force),
    )
}

/// Position and velocity over ground of an antenna at `lever_arm` [m, body axes, IMU → antenna]:
/// exact, the velocity [m/s] in the north-east-down frame at the antenna itself.
pub fn antenna(state: &State, lever_arm: &Vector3) -> (Geodetic, Vector3) {
    let motion = &state.motion;
    let ecef_from_ned = state.position.ned_from_ecef().transpose();
    let transport = LocalEarth::at(&state.position).transport_rate(&motion.v_n);
    // Against the Earth the body turns with ω_nb + ω_en.
    let omega_eb_b = motion.omega_nb_b + motion.q_nb.inverse_transform_vector(&transport);
    let arm_n = motion.q_nb * lever_arm;
    let v_n = motion.v_n + motion.q_nb * omega_eb_b.cross(lever_arm);
    let position = Geodetic::from_ecef(&(state.position.to_ecef() + ecef_from_ned * arm_n));
    (position, position.ned_from_ecef() * (ecef_from_ned * v_n))
}

/// Walks along a trajectory, integrating its position.
#[derive(Clone, Debug)]
pub struct Stepper<'a> {
    trajectory: &'a Trajectory,
    gauss: Gauss,
    knots: Vec<f64>,
    next_knot: usize,
    panel: f64,
    time: f64,
    position: Geodetic,
}

impl<'a> Stepper<'a> {
    /// At time 0.
    pub fn new(trajectory: &'a Trajectory) -> Self {
        let (least, most) = PANEL;
        Self {
            trajectory,
            gauss: Gauss::new(),
            knots: trajectory.knots(),
            next_knot: 0,
            panel: (trajectory.shortest_period() / 8.0).max(least).min(most),
            time: 0.0,
            position: trajectory.start,
        }
    }

    /// The vehicle here and now.
    pub fn state(&self) -> State {
        State {
            time: self.time,
            position: self.position,
            motion: self.trajectory.motion(self.time),
        }
    }

    /// Walks to `time` \[s\], at most to [`MAX_DURATION`]; an earlier time or a NaN does nothing.
    /// The position does not depend on the steps it was reached by, up to rounding.
    pub fn advance_to(&mut self, time: f64) {
        if time > self.time && self.time < MAX_DURATION {
            let time = time.min(MAX_DURATION);
            self.panels(time - self.time, |stepper, from, length| {
                stepper.position_panel(from, length);
            });
            self.time = time;
        }
    }

    /// Walks on by `length` \[s\] and returns the increments ∫ω_ib^b dt \[rad\] and ∫f^b dt [m/s] over it.
    pub fn increments(&mut self, length: f64) -> (Vector3, Vector3) {
        let (mut dtheta, mut dvel) = (Vector3::zeros(), Vector3::zeros());
        if length > 0.0 && self.time + length <= 2.0 * MAX_DURATION {
            self.panels(length, |stepper, from, panel| {
                let (turn, push) = stepper.sensor_panel(from, panel);
                dtheta += turn;
                dvel += push;
            });
            self.time += length;
        }
        (dtheta, dvel)
    }

    /// Cuts `length` from now on at the knots and into panels. In lengths, not in times: a
    /// difference of large times would carry their rounding into the increments.
    fn panels(&mut self, length: f64, mut each: impl FnMut(&mut Self, f64, f64)) {
        let start = self.time;
        let mut done = 0.0;
        while done < length {
            let knot = loop {
                let ahead = self.knots.get(self.next_knot).map(|knot| knot - start);
                match ahead {
                    // A millionth of the step beside a knot the kink is below rounding.
                    Some(ahead) if ahead <= done + 1e-6 * length => self.next_knot += 1,
                    Some(ahead) if ahead < length * (1.0 - 1e-6) => break ahead,
                    _ => break length,
                }
            };
            let pieces = ((knot - done) / self.panel * (1.0 - 1e-9)).ceil().max(1.0);
            let panel = (knot - done) / pieces;
            for piece in 0..pieces as u64 {
                each(self, start + done + panel * piece as f64, panel);
            }
            done = knot;
        }
    }

    /// Positions at the nodes from the velocities there, by the cubic through them. The radii at the
    /// panel's start do for that: they change by 1e-8 over it.
    fn node_earth(&self, length: f64, v_n: &[Vector3; 4]) -> [LocalEarth; 4] {
        let here = LocalEarth::at(&self.position);
        let partial = &self.gauss.partial;
        std::array::from_fn(|i| {
            let moved: Vector3 = (0..4).map(|j| v_n[j] * (partial[(i, j)] * length)).sum();
            LocalEarth::at(&Geodetic {
                lat: self.position.lat + moved.x / here.rm_h,
                lon: self.position.lon,
                height: self.position.height - moved.z,
            })
        })
    }

    fn move_on(&mut self, length: f64, v_n: &[Vector3; 4], earth: &[LocalEarth; 4]) {
        let (mut lat, mut lon, mut height) = (0.0, 0.0, 0.0);
        for ((v, e), w) in v_n.iter().zip(earth).zip(self.gauss.weight) {
            lat += w * v.x / e.rm_h;
            lon += w * v.y / (e.rn_h * e.cos_lat);
            height -= w * v.z;
        }
        self.position.lat += length * lat;
        self.position.lon += length * lon;
        self.position.height += length * height;
    }

    fn position_panel(&mut self, from: f64, length: f64) {
        let v_n = self
            .gauss
            .node
            .map(|c| self.trajectory.velocity(from + c * length));
        let earth = self.node_earth(length, &v_n);
        self.move_on(length, &v_n, &earth);
    }

    fn sensor_panel(&mut self, from: f64, length: f64) -> (Vector3, Vector3) {
        let motion = self
            .gauss
            .node
            .map(|c| self.trajectory.motion(from + c * length));
        let v_n = motion.map(|m| m.v_n);
        let earth = self.node_earth(length, &v_n);
        let (mut dtheta, mut dvel) = (Vector3::zeros(), Vector3::zeros());
        for ((m, e), w) in motion.iter().zip(&earth).zip(self.gauss.weight) {
            let (omega, force) = felt(m, e);
            dtheta += w * length * omega;
            dvel += w * length * force;
        }
        self.move_on(length, &v_n, &earth);
        (dtheta, dvel)
    }
}

/// The noise-free IMU samples of a trajectory with the truth at their ends, at times k/rate for
/// k = 1, 2, … up to the trajectory's duration. Streamed: memory does not grow.
#[derive(Clone, Debug)]
pub struct IdealImu<'a> {
    stepper: Stepper<'a>,
    rate_hz: f64,
    done: u64,
    samples: u64,
}

impl<'a> IdealImu<'a> {
    /// At `rate_hz` samples per second; none where that is not positive and finite.
    pub fn new(trajectory: &'a Trajectory, rate_hz: f64) -> Self {
        Self {
            stepper: Stepper::new(trajectory),
            rate_hz,
            done: 0,
            samples: epochs(trajectory.duration, rate_hz),
        }
    }

    /// The true state at the last sample, at first that at time 0.
    pub fn state(&self) -> State {
        self.stepper.state()
    }
}

/// Whole intervals 1/rate that fit in a duration \[s\].
pub(super) fn epochs(duration: f64, rate_hz: f64) -> u64 {
    let duration = Trajectory::sane(duration);
    if rate_hz > 0.0 && rate_hz.is_finite() {
        // 600 s · 199.9… Hz may be a rounding short of a whole number. `as` saturates.
        (duration * rate_hz * (1.0 + 1e-12)).floor() as u64
    } else {
        0
    }
}

impl Iterator for IdealImu<'_> {
    type Item = (ImuSample, TruthSample);

    fn next(&mut self) -> Option<Self::Item> {
        if self.done >= self.samples {
            return None;
        }
        self.done += 1;
        let dt = self.rate_hz.recip();
        let (dtheta, dvel) = self.stepper.increments(dt);
        let time = self.done as f64 / self.rate_hz;
        self.stepper.time = time;
        let sample = ImuSample {
            time,
            dt,
            dtheta,
            dvel,
        };
        Some((sample, self.stepper.state().truth()))
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        let left = self.samples - self.done;
        (
            usize::try_from(left).unwrap_or(usize::MAX),
            usize::try_from(left).ok(),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_is_cut_into_no_more_panels_than_the_longest_needs() {
        let trajectory = Trajectory::rest(100.0);
        for (length, count) in [
            (1e-3, 1),
            (0.01, 1),
            // Steps of a time that is rounded are a little longer.
            (0.01 * (1.0 + 1e-12), 1),
            (0.0101, 2),
            (0.1, 10),
            (0.105, 11),
        ] {
            let mut panels = Vec::new();
            Stepper::new(&trajectory).panels(length, |_, from, panel| panels.push((from, panel)));
            assert_eq!(panels.len(), count, "{length}");
            let each = length / count as f64;
            for (k, (from, panel)) in panels.iter().enumerate() {
                assert!((from - each * k as f64).abs() < 1e-15 && (panel - each).abs() < 1e-15);
            }
        }
    }
}
