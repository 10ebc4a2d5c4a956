//! Flights in wind: a copter that is dragged by the air, an aircraft that keeps its velocity through it.
//!
//! The velocity over ground is a sum of sines with hovering between; the attitude is the one with which the craft
//! accelerates so. A copter's thrust is along −z and its drag `k` times the velocity through the air across it, so that
//! `f + k (v − w)` points along −z (Martin & Salaün 2010); its yaw is free. An aircraft points along its velocity through
//! the air but for angles of attack and side slip, and banks into its turns. Sampled at the IMU's rate: between samples
//! attitude and specific force change linearly.

use super::{
    GnssNoise, SensorErrors, Simulation, SimulationError, ideal_imu::epochs, sensors::GNSS_STREAM,
    stream_seed,
};
use core::f64::consts::PI;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;
use undrift_nav::{
    Matrix3, Quaternion, Vector3, attitude,
    earth::{Geodetic, LocalEarth},
    sample::{ImuSample, TruthSample},
    shaping::ShapingFilter,
};

/// What flies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Craft {
    /// A copter whose rotors drag by so much over its mass [1/s].
    Copter(f64),
    /// An aircraft with this airspeed [m/s].
    Aircraft(f64),
}

/// A flight of `duration` \[s\], its first 20 s at rest on the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flight {
    /// What flies.
    pub craft: Craft,
    /// Mean wind to north and east [m/s].
    pub wind: [f64; 2],
    /// Standard deviation of gusts, and of what an aircraft's velocity through the air varies by [m/s].
    pub gusts: f64,
    /// Length \[s\].
    pub duration: f64,
}

/// Time on the ground, and over which the craft gets under way \[s\].
const GROUND: f64 = 20.0;
const START: f64 = 10.0;
/// Correlation time of each of the two low-passes of gusts \[s\].
const GUST: f64 = 1.0;

/// Gusts along three axes, by two low-passes of white noise; standard deviation 1.
struct Gusts {
    draw: Xoshiro256PlusPlus,
    state: [Vector3; 2],
    decay: f64,
}

impl Gusts {
    fn new(seed: u64, dt: f64) -> Self {
        Self {
            draw: Xoshiro256PlusPlus::seed_from_u64(seed),
            state: [Vector3::zeros(); 2],
            decay: (-dt / GUST).exp(),
        }
    }

    fn next(&mut self) -> Vector3 {
        let white = Vector3::from_fn(|_, _| StandardNormal.sample(&mut self.draw));
        let a = self.decay;
        // The variance of both in a row, (1 − a)⁴ (1 + a²)/(1 − a²)³, taken out.
        let scale = ((1.0 - a * a).powi(3) / (1.0 + a * a)).sqrt();
        self.state[0] = self.state[0] * a + white * scale;
        self.state[1] = self.state[1] * a + self.state[0];
        self.state[1]
    }
}

impl Flight {
    /// Velocity over ground [m/s] and attitude at `time` \[s\] in these gusts.
    fn at(&self, time: f64, seed: u64, gust: &Vector3, gravity: f64) -> (Vector3, Quaternion) {
        let phase = (seed % 97) as f64;
        let wind = Vector3::new(self.wind[0], self.wind[1], 0.0);
        let gate = smooth((time - GROUND) / START);
        let wave = |period: f64, shift: f64| (2.0 * PI * time / period + phase + shift).sin();
        match self.craft {
            Craft::Copter(drag) => {
                let velocity = |t: f64| {
                    let wave =
                        |period: f64, shift: f64| (2.0 * PI * t / period + phase + shift).sin();
                    // It hovers for a third of the time.
                    let hover = smooth(2.0 * wave(90.0, 1.0) + 1.0);
                    let north = 4.0 * wave(23.0, 0.0) + 2.0 * wave(9.0, 2.0);
                    let east = 4.0 * wave(31.0, 1.0) + 2.0 * wave(11.0, 3.0);
                    let up = 0.5 * wave(40.0, 0.0);
                    Vector3::new(north, east, -up) * (hover * smooth((t - GROUND) / START))
                };
                let v_n = velocity(time);
                let step = 1e-3;
                let accel = (velocity(time + step) - velocity(time - step)) / (2.0 * step);
                let air = v_n - (wind + gust * self.gusts) * gate;
                let down = -(accel - Vector3::z() * gravity + air * drag).normalize();
                let yaw = 2.0 * wave(70.0, 0.5) * gate;
                let right = down
                    .cross(&Vector3::new(yaw.cos(), yaw.sin(), 0.0))
                    .normalize();
                let c_nb = Matrix3::from_columns(&[right.cross(&down), right, down]);
                (v_n, Quaternion::from_matrix(&c_nb))
            }
            Craft::Aircraft(speed) => {
                let amplitude = 0.8 * 60.0 / (2.0 * PI);
                let course = |t: f64| {
                    let wave =
                        |period: f64, shift: f64| (2.0 * PI * t / period + phase + shift).sin();
                    let gate = smooth((t - GROUND) / START);
                    gate * (0.06 * (t - GROUND) + 0.3 * amplitude * wave(60.0, 0.0))
                };
                let climb = 0.08 * wave(50.0, 1.0) * gate;
                let forward = (speed + self.gusts * gust.x) * gate;
                let turn = (course(time + 1e-3) - course(time - 1e-3)) / 2e-3;
                let path = attitude::from_rpy(&Vector3::new(0.0, climb, course(time)));
                let bank = (forward * turn / gravity).atan();
                // Angles of side slip and attack, the latter about 3°.
                let [slip, attack] = [gust.y, gust.z].map(|one| self.gusts * one / speed);
                let body = attitude::from_rpy(&Vector3::new(bank, 0.0, 0.0))
                    * attitude::from_rpy(&Vector3::new(0.0, (0.05 + attack) * gate, slip * gate));
                (path * Vector3::x() * forward + wind * gate, path * body)
            }
        }
    }
}

/// From 0 to 1 as `x` goes from 0 to 1, with two derivatives that are zero at both.
fn smooth(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * x * (10.0 - x * (15.0 - 6.0 * x))
}

/// Simulates a flight: the IMU at `rate_hz` with the errors of `filters` as in [`simulate`](super::simulate), and the GNSS receiver at the
/// IMU, whose lever arm and offsets are not used.
///
/// ```
/// use undrift_simulate::{Craft, Flight, GnssNoise, fly};
/// let copter = Flight { craft: Craft::Copter(0.25), wind: [5.0, -2.0], gusts: 1.0, duration: 60.0 };
/// let log = fly(&copter, 50.0, None, &GnssNoise::default(), 1)?;
/// assert_eq!((log.imu.len(), log.truth.len(), log.gnss.len()), (3000, 3001, 60));
/// # Ok::<(), undrift_simulate::SimulationError>(())
/// ```
///
/// # Errors
/// As [`simulate`](super::simulate).
pub fn fly(
    flight: &Flight,
    rate_hz: f64,
    filters: Option<&[ShapingFilter; 6]>,
    gnss: &GnssNoise,
    seed: u64,
) -> Result<Simulation, SimulationError> {
    super::check_rate(rate_hz)?;
    gnss.check()?;
    let samples = epochs(flight.duration, rate_hz);
    if samples > super::MAX_SAMPLES {
        return Err(SimulationError::TooLong);
    }
    let errors = filters.map(|filters| SensorErrors::new(filters, rate_hz, seed));
    let mut errors = errors.transpose()?;
    let dt = 1.0 / rate_hz;
    let mut gusts = Gusts::new(stream_seed(seed, 20), dt);
    let mut noise = Xoshiro256PlusPlus::seed_from_u64(stream_seed(seed, GNSS_STREAM));
    let mut place = Geodetic::from_degrees(47.0, 8.0, 500.0);
    let earth = LocalEarth::at(&place);
    let gravity = earth.gravity;
    let (mut v_n, mut q_nb) = flight.at(0.0, seed, &gusts.next(), gravity);
    let mut log = Simulation::default();
    let truth = |time: f64, place: &Geodetic, v_n: &Vector3, q_nb: &Quaternion| TruthSample {
        time,
        position: *place,
        v_n: Some(*v_n),
        rpy: Some(attitude::to_rpy(q_nb)),
    };
    log.truth.push(truth(0.0, &place, &v_n, &q_nb));
    let mut next_fix = gnss.start;
    for k in 1..=samples {
        let time = k as f64 * dt;
        let (v_next, q_next) = flight.at(time, seed, &gusts.next(), gravity);
        let mean = 0.5 * (v_n + v_next);
        let earth = LocalEarth::at(&place);
        let turned = q_nb.inverse() * q_next;
        let middle =
            (q_nb * attitude::from_rotation_vector(&(0.5 * turned.scaled_axis()))).inverse();
        let (turns, carried) = (earth.earth_rate(), earth.transport_rate(&mean));
        let down = Vector3::z() * earth.gravity;
        let coriolis = (2.0 * turns + carried).cross(&mean);
        let ideal = ImuSample {
            time,
            dt,
            dtheta: turned.scaled_axis() + middle * (turns + carried) * dt,
            dvel: middle * (v_next - v_n + (coriolis - down) * dt),
        };
        log.imu.push(match &mut errors {
            Some(errors) => errors.apply(&ideal),
            None => ideal,
        });
        place = place.displaced(&(mean * dt));
        (v_n, q_nb) = (v_next, q_next);
        log.truth.push(truth(time, &place, &v_n, &q_nb));
        if time > next_fix - 0.5 * dt {
            next_fix += 1.0 / gnss.rate_hz;
            log.gnss.push(gnss.fix(time, &place, &v_n, &mut noise));
        }
    }
    Ok(log)
}
