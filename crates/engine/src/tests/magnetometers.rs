//! A magnetometer: the start at rest, a magnet that passes by, hard iron that is other than stated.

use super::{DEG, Navigated, Scenario, imu, receiver, rest_then_turns};
use crate::{
    align::{AttitudeSource, HeadingSource},
    settings::magnetometer::Magnetometer as Known,
};
use alloc::vec::Vec;
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

/// The same drive without the sensor.
fn without(scenario: &Scenario) -> Navigated {
    let mut without = Scenario {
        log: scenario.log.clone(),
        headings: Vec::new(),
        fields: Vec::new(),
        settings: scenario.settings.clone(),
    };
    without.settings.parameters = Parameters::none();
    without.navigate()
}

#[test]
fn the_first_heading_and_those_in_motion_are_honest() {
    const SEEDS: u64 = 60;
    const AT_REST: [f64; 2] = [8.0, 25.0];
    const IN_MOTION: [f64; 6] = [33.0, 50.0, 75.0, 100.0, 140.0, 175.0];
    let (mut rest, mut motion, mut worst) = (0.0, 0.0, 0.0_f64);
    for seed in 0..SEEDS {
        let seen = scenario(&rest_then_turns(seed), seed, Magnetometer::default()).navigate();
        let alignment = seen.summary.alignment.unwrap();
        let AttitudeSource::Rest { heading, .. } = alignment.source else {
            panic!("seed {seed}")
        };
        assert_eq!(heading, HeadingSource::Magnetometer);
        assert!((5.0 * DEG..25.0 * DEG).contains(&alignment.heading_std));
        assert!(seen.summary.started.unwrap() < 8.0 && seen.summary.restarts.is_empty());
        for (sum, times) in [(&mut rest, &AT_REST[..]), (&mut motion, &IN_MOTION[..])] {
            for time in times {
                let of = nees(&seen, *time);
                *sum += of / (SEEDS * times.len() as u64) as f64;
                worst = worst.max(of);
            }
        }
    }
    std::println!(
        "NEES of the heading by a magnetometer of 5 uT: at rest {rest:.2}, in motion {motion:.2}, at most {worst:.1}"
    );
    assert!((0.7..1.4).contains(&rest) && (0.7..1.4).contains(&motion) && worst < 16.0);
}

/// A magnet of 30 µT passes by: at rest before the start, at rest after it, in motion, and in motion without GNSS.
#[test]
fn a_magnet_that_passes_by_harms_nothing() {
    const SEEDS: u64 = 12;
    for (time, passage, outage) in [
        (2.0, 1.0, None),
        (20.0, 3.0, None),
        (100.0, 1.0, None),
        (100.0, 8.0, None),
        (100.0, 3.0, Some((80.0, 140.0))),
    ] {
        let (mut sums, mut noticed) = ([0.0; 3], 0);
        for seed in 0..SEEDS {
            let angle = 2.0 * seed as f64;
            let magnet = Magnet {
                time,
                field: Vector3::new(angle.cos(), angle.sin(), 0.3) * 30e-6,
                passage,
            };
            let sensor = Magnetometer {
                magnet: Some(magnet),
                ..Magnetometer::default()
            };
            let mut scenario = scenario(&rest_then_turns(seed), seed, sensor);
            if let Some((start, end)) = outage {
                scenario = scenario.withhold(start, end);
            }
            let disturbed = scenario.navigate();
            scenario.fields = Magnetometer::default()
                .measure(&rest_then_turns(seed), seed)
                .unwrap()
                .collect();
            let sound = scenario.navigate();
            noticed += u64::from(!disturbed.summary.disturbed_fields.is_empty());
            for (sum, seen) in sums
                .iter_mut()
                .zip([&disturbed, &sound, &without(&scenario)])
            {
                for time in (60..180).map(f64::from) {
                    *sum += (seen.at(time).heading().0 / DEG).powi(2) / 120.0 / SEEDS as f64;
                }
            }
        }
        let [disturbed, sound, without] = sums.map(f64::sqrt);
        std::println!(
            "magnet of 30 uT at {time} s, {passage} s, without GNSS {outage:?}: heading off by {disturbed:.3} deg rms, without the magnet {sound:.3}, without the sensor {without:.3}; noticed {noticed} of {SEEDS}"
        );
        assert!(disturbed < 1.1 * without);
    }
}

/// Hard iron of 25 µT where 5 are stated: a heading that is far off, which the first seconds of motion mend.
#[test]
fn hard_iron_that_is_other_than_stated_is_mended_in_motion() {
    const SEEDS: u64 = 20;
    let (mut sums, mut starts, mut mended) = ([0.0; 2], 0, 0);
    for seed in 0..SEEDS {
        let sensor = Magnetometer {
            hard_iron_std: 25e-6,
            ..Magnetometer::default()
        };
        let scenario = scenario(&rest_then_turns(seed), seed, sensor);
        let seen = scenario.navigate();
        let source = seen.summary.alignment.unwrap().source;
        starts += u64::from(source.is_by(HeadingSource::Magnetometer));
        mended += u64::from(!seen.summary.restarts.is_empty());
        for (sum, seen) in sums.iter_mut().zip([&seen, &without(&scenario)]) {
            for time in (60..180).map(f64::from) {
                *sum += (seen.at(time).heading().0 / DEG).powi(2) / 120.0 / SEEDS as f64;
            }
        }
    }
    let [with, without] = sums.map(f64::sqrt);
    std::println!(
        "hard iron of 25 uT, 5 stated: {starts} of {SEEDS} start with it, {mended} are aligned again; heading off by {with:.3} deg rms, without the sensor {without:.3}"
    );
    assert!(starts >= 5 && with < 1.5 * without);
}
