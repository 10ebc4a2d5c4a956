//! A receiver that smooths its positions and velocities.

use super::{Epoch, Scenario, rest_then_turns};
use undrift_nav::parameters::{Parameter, Parameters, Prior};
use undrift_simulate::GnssNoise;

/// Centimetre fixes of a car that leans, behind a first-order filter of the time constant `tau` \[s\], at an antenna of which nothing is known.
fn smoothed(seed: u64, tau: f64, parameters: Parameters) -> Scenario {
    let mut motion = rest_then_turns(seed);
    motion.roll_per_lateral = -0.012;
    motion.pitch_per_acceleration = 0.008;
    let noise = GnssNoise {
        position_std: [0.02; 3],
        velocity_std: [0.03; 3],
        rate_hz: 2.0,
        start: 0.5,
        ..GnssNoise::default()
    };
    let mut scenario = Scenario::new(&motion, &noise, seed);
    scenario.settings.parameters = parameters;
    scenario.log.filter_fixes(tau);
    scenario
}

#[test]
fn a_receiver_s_filter_is_no_antenna_at_another_height() {
    const TAU: f64 = 0.3;
    let times = Parameters::none()
        .with(Parameter::LeverArm, Prior::constant(0.5))
        .with(Parameter::TimeOffset, Prior::constant(0.1))
        .with(Parameter::VelocityTimeOffset, Prior::constant(0.1));
    let smoothing = times.with(Parameter::Smoothing, Prior::constant(0.02));
    let height = |epoch: &Epoch| epoch.error[2].abs() / epoch.std[2];
    for seed in 1..=3 {
        let seen = smoothed(seed, TAU, smoothing).navigate();
        let worst = seen.most(60.0, 180.0, height);
        assert!(worst < 3.0, "seed {seed}: {worst}");
        let found = seen.summary.parameters.iter();
        let found = found.clone().find(|of| of.0 == Parameter::Smoothing);
        let (_, value, std) = found.unwrap();
        // A mean of TAU with the variance TAU².
        for (value, std) in value.iter().zip(std) {
            let off = (value - 0.5 * TAU * TAU).abs();
            assert!(off < 4.0 * std, "seed {seed}: {value} {std}");
        }
        // Without it the height is that of an antenna elsewhere.
        let taken = smoothed(seed, TAU, times).navigate();
        let worst = taken.most(60.0, 180.0, height);
        assert!(worst > 4.0, "seed {seed}: {worst}");
    }
}
