//! Drives and flights built from random segments.
//!
//! Each is drawn from xoshiro256++ (Blackman & Vigna 2021) seeded by the `seed`, a uniform number
//! being the top 53 bits of a draw: the same seed is the same motion on every machine.

use super::profile::{Channel, Profile, STEP_SLOPE, Wave};
use super::trajectory::Trajectory;
use rand::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::f64::consts::TAU;
use undrift_nav::earth::STANDARD_GRAVITY;

/// Time at rest before the first motion of a drive or flight \[s\].
pub const REST_BEFORE: f64 = 60.0;

/// Rounding of the car's turns: from straight to full turn rate \[s\].
const TURN_ROUNDING: f64 = 1.2;
/// Rounding of the car's accelerations \[s\].
const PEDAL_ROUNDING: f64 = 1.5;

struct Dice(Xoshiro256PlusPlus);

impl Dice {
    fn new(seed: u64) -> Self {
        Self(Xoshiro256PlusPlus::seed_from_u64(seed))
    }

    fn uniform(&mut self, low: f64, high: f64) -> f64 {
        let unit = (self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64;
        low + (high - low) * unit
    }

    fn chance(&mut self, probability: f64) -> bool {
        self.uniform(0.0, 1.0) < probability
    }

    fn sign(&mut self) -> f64 {
        if self.chance(0.5) { 1.0 } else { -1.0 }
    }

    /// One wave per period \[s\], each of 0.5 to 1 times the amplitude \[deg\], at random phases.
    fn waves(&mut self, amplitude_deg: f64, periods: &[f64]) -> Vec<Wave> {
        periods
            .iter()
            .map(|&period| Wave {
                amplitude: amplitude_deg.to_radians() * self.uniform(0.5, 1.0),
                period,
                phase: self.uniform(0.0, TAU),
            })
            .collect()
    }
}

/// A turn by `angle` \[rad\] from `start` \[s\] at the rate `rate` [rad/s, magnitude], entered and left
/// over `rounding` \[s\]; a turn too small to reach the rate is made slower. Returns its end \[s\].
fn turn(profile: &mut Profile, start: f64, angle: f64, rate: f64, rounding: f64) -> f64 {
    let rate = rate.min(angle.abs() / rounding);
    let hold = angle.abs() / rate - rounding;
    let full = profile.step_to(start, rounding, rate * angle.signum());
    profile.step_to(full + hold, rounding, 0.0)
}

impl Trajectory {
    /// A car drive in town: 60 s at rest, then segments until `duration` \[s\], at rest for the last
    /// 5 s. A segment accelerates at 0.8–1.8 m/s², cruises at 7–17 m/s with gentle bends, brakes to
    /// 4–6.5 m/s for a turn of 70–100° in 5–7 s, and may stop at a light.
    ///
    /// The body leans 0.012 rad per m/s² outwards, squats 0.008 rad per m/s², is mounted with a roll
    /// of up to 1.5°, and follows a terrain of up to 2° whose waves reach into road vibration at 7 to
    /// 12 Hz in climb, roll and pitch, so that coning and sculling are in the increments.
    pub fn car(duration: f64, seed: u64) -> Self {
        let mut dice = Dice::new(seed);
        let mut car = Self::rest(duration);
        car.course = dice.uniform(0.0, TAU);
        car.roll_per_lateral = -0.012;
        car.pitch_per_acceleration = 0.008;
        car.climb.waves = dice.waves(0.7, &[37.0, 71.0, 113.0]);
        car.climb.waves.extend(dice.waves(0.005, &[0.11, 0.083]));
        car.roll = Channel::hold(dice.uniform(-1.5, 1.5).to_radians());
        car.roll.waves = dice.waves(0.6, &[23.0, 41.0, 67.0]);
        car.roll.waves.extend(dice.waves(0.06, &[0.8, 1.3]));
        car.roll.waves.extend(dice.waves(0.01, &[0.11, 0.083]));
        car.pitch.waves = dice.waves(0.05, &[0.7, 1.1]);
        car.pitch.waves.extend(dice.waves(0.01, &[0.13, 0.091]));

        // Standing again by here; braking from 17 m/s at 1 m/s² takes 18.5 s.
        let deadline = car.duration - 5.0;
        let mut t = REST_BEFORE;
        while t + 45.0 < deadline {
            let cruise = dice.uniform(7.0, 17.0);
            let pedal = dice.uniform(0.8, 1.8);
            t = car.speed.ramp_to(t, pedal, PEDAL_ROUNDING, cruise);
            let cruised = (t + dice.uniform(8.0, 25.0)).min(deadline - 22.0);
            if dice.chance(0.7) {
                let angle = dice.uniform(4.0, 15.0).to_radians() * dice.sign();
                let rate = dice.uniform(2.0, 4.0).to_radians();
                let first = t + dice.uniform(1.0, 3.0);
                let back = dice.chance(0.5);
                let bend = angle.abs() / rate + TURN_ROUNDING;
                let bends = if back { 2.0 } else { 1.0 };
                if first + bends * bend < cruised {
                    let end = turn(&mut car.turn_rate, first, angle, rate, TURN_ROUNDING);
                    if back {
                        turn(&mut car.turn_rate, end, -angle, rate, TURN_ROUNDING);
                    }
                }
            }
            t = cruised.max(t);
            let slow = dice.uniform(4.0, 6.5);
            let brake = dice.uniform(1.0, 2.0);
            t = car.speed.ramp_to(t, brake, PEDAL_ROUNDING, slow);
            let angle = dice.uniform(70.0, 100.0).to_radians() * dice.sign();
            let length = dice.uniform(5.0, 7.0);
            let brake = dice.uniform(1.0, 1.8);
            let stop = dice.chance(0.3);
            let wait = dice.uniform(5.0, 20.0);
            // Turn, then stop, only where that still ends in time.
            if t + length + slow / brake + PEDAL_ROUNDING < deadline {
                let rate = angle.abs() / (length - TURN_ROUNDING);
                t = turn(&mut car.turn_rate, t, angle, rate, TURN_ROUNDING);
                if stop {
                    t = car.speed.ramp_to(t, brake, PEDAL_ROUNDING, 0.0) + wait;
                }
            }
        }
        // Home at 1.5 m/s², harder where less time is left.
        let speed = car.speed.last_value();
        if speed > 0.0 {
            let start = deadline - speed / 1.5 - PEDAL_ROUNDING;
            let (start, brake) = if start < t {
                (t, speed / (deadline - t - PEDAL_ROUNDING))
            } else {
                (start, 1.5)
            };
            car.speed.ramp_to(start, brake, PEDAL_ROUNDING, 0.0);
        }
        car
    }

    /// An IMU in a hand in a room until `duration` \[s\], moving from the first sample on: circles of about a metre at about 1 m/s, up and
    /// down by some decimetres, turned about all axes by up to `swing` \[rad\] within seconds.
    pub fn handheld(duration: f64, swing: f64, seed: u64) -> Self {
        let mut dice = Dice::new(seed);
        let mut hand = Self::rest(duration);
        hand.gate_speed = 0.0;
        hand.course = dice.uniform(0.0, TAU);
        hand.speed = Profile::hold(dice.uniform(0.7, 1.2));
        hand.turn_rate = Profile::hold(dice.uniform(0.7, 1.1) * dice.sign());
        let swing = swing.to_degrees();
        hand.climb.waves = dice.waves(15.0, &[1.7, 2.9]);
        hand.roll.waves = dice.waves(0.5 * swing, &[1.9, 3.7]);
        hand.roll.waves.extend(dice.waves(0.05 * swing, &[0.41]));
        hand.pitch.waves = dice.waves(0.4 * swing, &[2.3, 5.3]);
        hand.pitch.waves.extend(dice.waves(0.05 * swing, &[0.37]));
        hand.yaw.waves = dice.waves(0.5 * swing, &[3.1, 7.9]);
        hand
    }

    /// A flight of a small aeroplane: 60 s at rest, a take-off run to 40–60 m/s, a climb at 4–7° to
    /// 250–500 m, then until `duration` \[s\] level segments, coordinated turns of 60–270° at 20–45° of
    /// bank, changes of speed and height. It ends in the air, level.
    ///
    /// Gusts move roll, pitch, yaw and the path by up to a degree with periods of seconds; a motor
    /// shakes roll, pitch and yaw at 22 to 25 Hz.
    pub fn flight(duration: f64, seed: u64) -> Self {
        let mut dice = Dice::new(seed);
        let mut flight = Self::rest(duration);
        flight.course = dice.uniform(0.0, TAU);
        flight.coordinated = true;
        flight.gate_speed = 20.0;
        flight.climb.waves = dice.waves(0.2, &[7.1, 11.3]);
        flight.roll.waves = dice.waves(0.6, &[3.1, 4.7, 7.9]);
        flight.roll.waves.extend(dice.waves(0.01, &[0.045, 0.041]));
        flight.pitch.waves = dice.waves(0.3, &[2.3, 5.3]);
        flight.pitch.waves.extend(dice.waves(0.01, &[0.045]));
        flight.yaw.waves = dice.waves(0.3, &[3.7, 6.1]);
        flight.yaw.waves.extend(dice.waves(0.01, &[0.041]));

        // Run, rotation at 70 % of the speed, climb.
        let mut speed = dice.uniform(40.0, 60.0);
        let thrust = dice.uniform(2.0, 3.0);
        flight.speed.ramp_to(REST_BEFORE, thrust, 3.0, speed);
        let lift_off = REST_BEFORE + 1.5 + 0.7 * speed / thrust;
        flight
            .pitch
            .profile
            .step_to(lift_off - 1.5, 3.0, 3f64.to_radians());
        let slope = dice.uniform(4.0, 7.0).to_radians();
        let mut height = dice.uniform(250.0, 500.0); // above the start
        let climbing = flight.climb.profile.step_to(lift_off, 5.0, slope);
        let top = climbing + height / (speed * slope.sin());
        let mut t = flight.climb.profile.step_to(top, 5.0, 0.0);

        loop {
            t += dice.uniform(8.0, 25.0);
            if dice.chance(0.4) {
                speed = dice.uniform(40.0, 60.0);
                t = flight.speed.ramp_to(t, 1.0, 2.0, speed);
            }
            if dice.chance(0.4) {
                let up = if (200.0..800.0).contains(&height) {
                    dice.sign()
                } else if height < 200.0 {
                    1.0
                } else {
                    -1.0
                };
                let slope = up * dice.uniform(2.0, 4.0).to_radians();
                let sloping = flight.climb.profile.step_to(t, 4.0, slope);
                let length = dice.uniform(5.0, 20.0);
                t = flight.climb.profile.step_to(sloping + length, 4.0, 0.0);
                height += speed * slope.sin() * (length + 4.0);
            }
            let bank = dice.uniform(20.0, 45.0).to_radians();
            let angle = dice.uniform(60.0, 270.0).to_radians() * dice.sign();
            let rate = STANDARD_GRAVITY * bank.tan() / speed;
            // Rolling in at 15°/s at most.
            let rounding = STEP_SLOPE * bank / 15f64.to_radians();
            if t + angle.abs() / rate + rounding > flight.duration {
                break;
            }
            t = turn(&mut flight.turn_rate, t, angle, rate, rounding);
        }
        flight
    }
}
