//! A drive through a town, with turns and stops, at any place and rate, and how good its solution is.

use super::log::{Log, Outcome};
use std::sync::OnceLock;
use undrift::nav::earth::Geodetic;
use undrift::noise::{BiasModel, ImuModel};
use undrift::simulate::{GnssNoise, Simulation, Trajectory, simulate};

/// Sampling rate of the town drive [Hz].
pub const TOWN_RATE: f64 = 100.0;
/// Length of the town drive [s].
pub const TOWN_DURATION: f64 = 140.0;

/// At rest until 15 s, then two turns to the right and one to the left at 12 m/s, a stop from 98 to
/// 106 s, and straight on. Its heading is 34 degrees at first.
pub fn town(start: Geodetic) -> Trajectory {
    let mut car = Trajectory::rest(TOWN_DURATION);
    car.start = start;
    car.course = 0.6;
    let speed = &mut car.speed;
    speed.ramp_to(15.0, 1.5, 1.0, 12.0);
    speed.ramp_to(90.0, 2.0, 1.0, 0.0);
    speed.ramp_to(106.0, 1.5, 1.0, 12.0);
    // A quarter of a turn each: 0.3 rad/s for five seconds, in and out of it over a second.
    for (time, rate) in [(35.0, 0.3), (55.0, -0.3), (75.0, 0.3)] {
        car.turn_rate.step_to(time, 1.0, rate);
        car.turn_rate.step_to(time + 5.2, 1.0, 0.0);
    }
    car
}

/// The town drive at another place, the IMU at `rate` and the fixes at `gnss_rate` [Hz].
pub fn simulated(start: Geodetic, rate: f64, gnss_rate: f64) -> Simulation {
    let model = ImuModel::preset("adis16465").unwrap();
    let sensors = model.shaping(BiasModel::GaussMarkov, 1.0 / rate).unwrap();
    let gnss = GnssNoise {
        position_std: [0.5, 0.5, 1.0],
        velocity_std: [0.05; 3],
        rate_hz: gnss_rate,
        ..GnssNoise::default()
    };
    simulate(&town(start), rate, Some(&sensors), &gnss, 7).unwrap()
}

/// The town drive without a fault, at 100 and 2 Hz.
pub fn good() -> Log {
    static ONCE: OnceLock<Log> = OnceLock::new();
    ONCE.get_or_init(|| Log::of(&simulated(Trajectory::rest(0.0).start, TOWN_RATE, 2.0)))
        .clone()
}

/// RMS errors that a sound solution of the town drive stays below: horizontally [m], where the fixes have
/// 0.5 m an axis and the filter 0.2 m, and of the heading [deg], which is 0.2.
pub const SOUND: (f64, f64) = (0.5, 1.0);

/// Asserts that a solution is as good as that of the drive without a fault.
#[track_caller]
pub fn is_sound(outcome: &Outcome) {
    let errors = (outcome.rms("horizontal_m"), outcome.rms("yaw_deg"));
    let sound = errors.0 < SOUND.0 && errors.1 < SOUND.1;
    assert!(sound, "{errors:?} {}", outcome.stderr);
}

#[test]
fn the_town_drive_is_navigated_without_complaint() {
    let (outcome, _) = good().write("town").solution();
    assert_eq!(outcome.stderr, "");
    is_sound(&outcome);
}
