//! A copter and an aircraft in wind and gusts, without GNSS for a minute: what the motion through the air is worth, and
//! whether the filter is honest about it.

use super::{Navigated, RATE, Scenario, imu};
use crate::vehicle::{Air, Profile};
use alloc::{vec, vec::Vec};
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use undrift_events::Aid;
use undrift_nav::{
    Vector3,
    parameters::{Parameter, Parameters},
};
use undrift_simulate::{Craft, Flight, GnssNoise, Simulation, fly};

/// Starts of the spans without GNSS, and their length \[s\].
const STARTS: [f64; 3] = [200.0, 310.0, 420.0];
const LENGTH: f64 = 60.0;

/// A flight in this wind with a cheap IMU among rotors, 0.1 deg/s/√Hz, 0.3 deg/s and 10 mg, under this profile.
fn scenario(craft: Craft, wind: [f64; 2], seed: u64, profile: Profile) -> Scenario {
    let sensors = imu([2e-3, 5e-3], [5e-2, 0.1]);
    let gnss = GnssNoise {
        position_std: [1.5, 1.5, 3.0],
        velocity_std: [0.1, 0.1, 0.2],
        ..GnssNoise::default()
    };
    let flight = Flight {
        craft,
        wind,
        gusts: 1.0,
        duration: STARTS[2] + LENGTH + 1.0,
    };
    let log: Simulation = fly(&flight, RATE, Some(&sensors), &gnss, seed).unwrap();
    let mut settings = crate::settings::Settings::new(sensors);
    settings.align.attitude = Some((log.truth[0].rpy.unwrap(), Vector3::repeat(0.05)));
    settings.constraints = profile.constraints();
    if let Some(air) = &settings.constraints.air {
        settings.parameters = air.with_states(Parameters::none(), Some(Air::WIND.std));
    }
    let scenario = Scenario {
        log,
        headings: Vec::new(),
        fields: Vec::new(),
        settings,
    };
    STARTS.into_iter().fold(scenario, |scenario, start| {
        scenario.withhold(start, start + LENGTH)
    })
}

/// Squared horizontal errors at the ends of the spans \[m²\], and both axes in variances.
fn ends(seen: &Navigated) -> (f64, Vec<f64>) {
    let (mut drift, mut scaled) = (0.0, vec![]);
    for start in STARTS {
        let end = seen.at(start + LENGTH - 0.5);
        drift += end.distance().powi(2);
        scaled.extend([0, 1].map(|i| (end.error[i] / end.std[i]).powi(2)));
    }
    (drift, scaled)
}

#[test]
fn rotors_and_wings_hold_a_flight_for_a_minute() {
    for (craft, profile) in [
        (Craft::Copter(0.3), Profile::Copter),
        (Craft::Aircraft(18.0), Profile::Aircraft),
    ] {
        let (mut without, mut with, mut scaled) = (0.0, 0.0, vec![]);
        // From any side, and none.
        let winds = [[0.0, 0.0], [6.0, 0.0], [0.0, 6.0], [-5.0, 3.0], [2.0, -7.0]];
        for (seed, wind) in (1..).zip(winds) {
            without += ends(&scenario(craft, wind, seed, Profile::None).navigate()).0;
            let seen = scenario(craft, wind, seed, profile).navigate();
            let (drift, of) = ends(&seen);
            with += drift;
            scaled.extend(of);
            let counted = &seen.summary.innovations[Aid::Air];
            assert!(
                counted.updates > 1500 && counted.rejected == 0,
                "{counted:?}"
            );
        }
        let count = scaled.len() as f64;
        let nees = scaled.iter().sum::<f64>() / count;
        let inside = scaled.iter().filter(|one| **one < 9.0).count() as f64 / count;
        let [without, with] = [without, with].map(|sum: f64| (2.0 * sum / count).sqrt());
        std::println!(
            "{}: {without:.0} m without, {with:.1} m with, NEES {nees:.2}, inside {inside:.3}",
            profile.name()
        );
        assert!(with < 0.4 * without, "{profile:?}: {without} {with}");
        assert!((0.2..1.6).contains(&nees), "{profile:?}: {nees}");
        assert!(inside >= 0.95, "{profile:?}: {inside}");
    }
}

#[test]
fn drag_and_wind_are_estimated() {
    let seen = scenario(Craft::Copter(0.33), [4.0, 2.0], 7, Profile::Copter).navigate();
    let found = |kind| {
        let mut all = seen.summary.parameters.iter();
        let (_, value, std) = all.find(|(of, ..)| *of == kind).unwrap();
        (value.clone(), std.clone())
    };
    let (drag, std) = found(Parameter::RotorDrag);
    let off = 0.33 - Air::DRAG - drag[0];
    assert!(
        std[0] < 0.03 && off.abs() < 3.0 * std[0],
        "{drag:?} {std:?}"
    );
    let (wind, std) = found(Parameter::Wind);
    for (axis, truth) in [4.0, 2.0].into_iter().enumerate() {
        assert!(
            (wind[axis] - truth).abs() < 3.0 * std[axis],
            "{wind:?} {std:?}"
        );
        assert!(std[axis] < 1.5, "{std:?}");
    }
}
