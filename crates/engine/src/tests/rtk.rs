//! Centimetre fixes that are not what they state: a wrong integer, a delay that wanders.

use super::{Navigated, Scenario, rest_then_turns};
use alloc::vec::Vec;
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use undrift_events::Part;
use undrift_nav::{
    Vector3,
    parameters::{Parameter, Prior},
    sample::Position,
};
use undrift_simulate::GnssNoise;

/// Fixes of 2 cm and 3 cm/s, four a second, whose delay is estimated.
fn drive(seed: u64) -> Scenario {
    let noise = GnssNoise {
        position_std: [0.02; 3],
        velocity_std: [0.03; 3],
        rate_hz: 4.0,
        start: 0.2,
        ..GnssNoise::default()
    };
    let mut scenario = Scenario::new(&rest_then_turns(seed), &noise, seed);
    let prior = Prior {
        walk: 6e-3,
        ..Prior::constant(0.1)
    };
    for kind in [Parameter::TimeOffset, Parameter::VelocityTimeOffset] {
        scenario.settings.parameters = scenario.settings.parameters.with(kind, prior);
    }
    scenario
}

/// Starts and sizes of the jumps of position that are found.
fn jumps(seen: &Navigated) -> Vec<(f64, f64)> {
    let found = seen.summary.contradictions.iter();
    let jumps = found.filter(|of| of.part == Part::Position && of.accepted_in_the_end);
    jumps.map(|of| (of.start, of.largest)).collect()
}

#[test]
fn a_wrong_integer_is_named_however_little_it_moves_the_fixes() {
    for (seed, size) in [(11, 0.4), (12, 0.6), (13, 1.5)] {
        let off = Vector3::new(0.6, -0.8, 0.0) * size;
        let seen = drive(seed).alter(60.0, 110.0, |fix| {
            if let Some((Position::Geodetic(place), _)) = &mut fix.position {
                *place = place.displaced(&off);
            }
        });
        let jumps = jumps(&seen.navigate());
        let near = |time: f64| {
            let at = |jump: &&(f64, f64)| (jump.0 - time).abs() < 0.5;
            jumps.iter().find(at).map(|jump| jump.1)
        };
        let there = near(60.2).unwrap_or_else(|| panic!("seed {seed}: {jumps:?}"));
        assert!((there / size - 1.0).abs() < 0.4, "seed {seed}: {there}");
        assert_eq!(self::jumps(&drive(seed).navigate()), []);
    }
}

/// Share of the epochs from 45 s on whose horizontal position is within three standard deviations.
fn covered(seen: &Navigated) -> f64 {
    let later = seen.epochs.iter().filter(|epoch| epoch.time > 45.0);
    let inside = later.map(|epoch| {
        let is = |i: usize| epoch.error[i].abs() < 3.0 * epoch.std[i];
        f64::from(u8::from(is(0) && is(1)))
    });
    let inside: Vec<f64> = inside.collect();
    inside.iter().sum::<f64>() / inside.len() as f64
}

#[test]
fn a_delay_that_wanders_with_the_stamps_is_covered() {
    for (seed, walk) in [(21, 0.012), (22, 0.02), (23, 0.03)] {
        let mut scenario = drive(seed);
        // Pulled back to its mean within some ten seconds.
        let mut delay = 0.0;
        for (k, fix) in scenario.log.gnss.iter_mut().enumerate() {
            let random = (((k as u64 + 1) * (seed + 7) * 2_654_435_761) >> 7) % 1000;
            delay = 0.975 * delay + walk * 0.5 * 3.46 * (random as f64 / 1000.0 - 0.5);
            fix.time += 0.1 + delay;
        }
        let share = covered(&scenario.navigate());
        assert!(share > 0.95, "seed {seed}: {share}");
    }
}

/// Accelerometers that read 2 % too much, as many do: the lever arm and the delays are not learned from that as if it were motion.
#[test]
fn scale_factors_of_accelerometers_that_are_not_estimated_are_covered() {
    for seed in [31, 32, 33, 34] {
        let mut scenario = drive(seed);
        let parameters = scenario.settings.parameters;
        let arm = Prior::constant(0.5);
        scenario.settings.parameters = parameters.with(Parameter::LeverArm, arm);
        scenario.settings.accel_scale_error = 0.007;
        for sample in &mut scenario.log.imu {
            sample.dvel *= 1.02;
        }
        let share = covered(&scenario.navigate());
        assert!(share > 0.95, "seed {seed}: {share}");
    }
}
