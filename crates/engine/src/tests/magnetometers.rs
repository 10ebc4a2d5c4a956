//! A magnetometer: the start at rest, a magnet that passes by, hard iron that is other than stated.

use super::{DEG, Navigated, Scenario, imu, receiver};
use crate::{
    align::{AttitudeSource, HeadingSource},
    settings::magnetometer::Magnetometer as Known,
};
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use undrift_nav::{
    Vector3,
    parameters::{Parameter, Parameters},
};
use undrift_simulate::{Magnet, Magnetometer, Trajectory};

/// An IMU just switched on, 0.3 deg/s and 30 mg, of a vehicle whose course is not its heading.
fn scenario(motion: &Trajectory, seed: u64, sensor: Magnetometer) -> Scenario {
    let sensors = imu([5e-3 * DEG, 0.3 * DEG], [1e-3, 0.3]);
    let mut scenario = Scenario::of(sensors, motion, &receiver(), seed);
    scenario.fields = sensor.measure(motion, seed).unwrap().collect();
    let settings = &mut scenario.settings;
    settings.align.attitude = None;
    settings.align.heading = crate::align::Heading::Auto;
    settings.magnetometer.year = Some(sensor.year);
    settings.parameters = Parameters::none().with(Parameter::HardIron, Known::HARD_IRON);
    scenario
}

fn nees(seen: &Navigated, time: f64) -> f64 {
    let (error, std) = seen.at(time).heading();
    (error / std).powi(2)
}

/// Half a minute at rest, then driving with turns.
fn drive(seed: u64) -> Trajectory {
    let mut motion = Trajectory::rest(180.0);
    motion.course = seed as f64;
    motion.speed.step_to(30.0, 8.0, 12.0);
    for k in 0..6 {
        let start = 45.0 + 22.0 * f64::from(k);
        motion.turn_rate.step_to(start, 2.0, 0.15);
        motion.turn_rate.step_to(start + 8.0, 2.0, 0.0);
    }
    motion
}

#[test]
fn the_first_heading_and_those_in_motion_are_honest() {
    const SEEDS: u64 = 60;
    let times = [8.0, 25.0, 33.0, 36.0, 40.0, 50.0, 70.0, 100.0, 140.0, 175.0];
    let (mut sums, mut stds, mut worst) = ([0.0; 10], [0.0; 10], 0.0_f64);
    for seed in 0..SEEDS {
        let seen = scenario(&drive(seed), seed, Magnetometer::default()).navigate();
        let AttitudeSource::Rest { heading, .. } = seen.summary.alignment.unwrap().source else {
            panic!("seed {seed}")
        };
        assert_eq!(heading, HeadingSource::Magnetometer);
        assert!(seen.summary.started.unwrap() < 8.0);
        for (k, time) in times.into_iter().enumerate() {
            let of = nees(&seen, time);
            sums[k] += of / SEEDS as f64;
            stds[k] += seen.at(time).heading().1 / DEG / SEEDS as f64;
            if of > 9.0 {
                std::println!(
                    "seed {seed} time {time} nees {of:.1} restarts {:?}",
                    seen.summary.restarts
                );
            }
            worst = worst.max(of);
        }
    }
    std::println!("NEES {sums:.2?} σ {stds:.1?} worst {worst:.1}");
}
