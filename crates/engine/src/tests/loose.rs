//! An IMU that is loose in its mount.

use super::{DEG, Scenario, rest_then_turns};
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use undrift_events::Mismatch;
use undrift_nav::{Vector3, attitude::from_rotation_vector};
use undrift_simulate::GnssNoise;

/// Centimetre fixes of an IMU that nods by so much \[rad\] (RMS), `rate` \[Hz\].
fn nodding(seed: u64, rms: f64, rate: f64) -> Scenario {
    let noise = GnssNoise {
        position_std: [0.02; 3],
        velocity_std: [0.1; 3],
        rate_hz: 2.0,
        start: 0.2,
        ..GnssNoise::default()
    };
    let mut scenario = Scenario::new(&rest_then_turns(seed), &noise, seed);
    // At rest for half a minute, the IMU, too.
    let angle = |time: f64| {
        let swing = (core::f64::consts::TAU * rate * (time - 30.0).max(0.0)).sin();
        rms * core::f64::consts::SQRT_2 * swing
    };
    for sample in &mut scenario.log.imu {
        let [before, after] = [sample.time - sample.dt, sample.time].map(angle);
        let level = from_rotation_vector(&(Vector3::y() * (-0.5 * (before + after))));
        sample.dvel = level * sample.dvel;
        sample.dtheta = level * sample.dtheta + Vector3::y() * (after - before);
    }
    scenario
}

#[test]
fn a_loose_mount_is_named_and_the_attitude_as_uncertain() {
    for (seed, rms, rate) in [(1, 3.0, 0.6), (2, 2.5, 1.0), (3, 3.0, 0.3)] {
        let seen = nodding(seed, rms * DEG, rate).navigate();
        let nods = seen.summary.mismatches.iter().find_map(|of| match of {
            Mismatch::Nods(nods) => Some(nods / DEG),
            _ => None,
        });
        let nods = nods.unwrap_or_else(|| panic!("seed {seed}: {:?}", seen.summary.mismatches));
        assert!((nods / rms - 1.0).abs() < 0.15, "seed {seed}: {nods}");
        // The vehicle's own pitch is as uncertain, while the IMU's is known.
        let [north, east, _] = seen.last().vehicle_std;
        let of_vehicle = north.hypot(east);
        assert!(
            (of_vehicle / DEG / rms - 1.0).abs() < 0.2,
            "seed {seed}: {of_vehicle}"
        );
    }
    for seed in [4, 5] {
        let seen = nodding(seed, 0.9 * DEG, 0.8).navigate();
        assert_eq!(seen.summary.mismatches, [], "seed {seed}");
    }
}
