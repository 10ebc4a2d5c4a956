//! A copter and an aircraft in simulated wind and gusts, without GNSS for a minute: what the motion through the air is worth, and
//! whether the filter is honest about it.

use undrift::{
    align::{AlignSettings, Heading},
    nav::{
        parameters::{Parameter, Parameters},
        shaping::ShapingFilter,
    },
    outages::{self, ModelRun},
    replay::{Aid, Measurement, Outage, Settings},
    simulate::{Craft, Flight, GnssNoise, fly},
    vehicle::{Air, Profile},
};

const RATE: f64 = 50.0;
const GUSTS: f64 = 1.0;

/// A cheap IMU among rotors: 1 deg/√h and 0.6 m/s/√h, biases of 0.3 deg/s and 10 mg that walk.
fn sensors() -> [ShapingFilter; 6] {
    let dt = 1.0 / RATE;
    let axis = |white: f64, turn_on: f64, walk: f64| {
        let bias = ShapingFilter::random_walk(walk, dt).unwrap();
        let start = ShapingFilter::constant(turn_on, dt).unwrap();
        let white = ShapingFilter::white(white, dt).unwrap();
        white.plus(&bias).unwrap().plus(&start).unwrap()
    };
    let (gyro, accel) = (axis(3e-4, 5e-3, 2e-5), axis(1e-2, 0.1, 6e-4));
    [gyro, gyro, gyro, accel, accel, accel]
}

/// Three minutes of a flight in this wind without GNSS, as one of these vehicles.
fn run(craft: Craft, wind: [f64; 2], seed: u64, profiles: [Profile; 2]) -> [ModelRun; 2] {
    let flight = Flight {
        craft,
        wind,
        gusts: GUSTS,
        duration: 520.0,
    };
    let gnss = GnssNoise {
        position_std: [1.5, 1.5, 3.0],
        velocity_std: [0.1, 0.1, 0.2],
        ..GnssNoise::default()
    };
    let log = fly(&flight, RATE, Some(&sensors()), &gnss, seed).unwrap();
    let settings = profiles.map(|profile| {
        let constraints = profile.constraints();
        let mut parameters = Parameters::none();
        if let Some(air) = &constraints.air {
            parameters = parameters
                .with(Parameter::Wind, Air::WIND)
                .with(Parameter::TrimVelocity, air.trim());
            if let Air::Rotors { .. } = air {
                parameters = parameters.with(Parameter::RotorDrag, Air::ROTOR_DRAG);
            }
        }
        let outage = |start| Outage {
            start,
            end: start + 60.0,
        };
        let settings = Settings {
            constraints,
            parameters,
            outages: [200.0, 310.0, 420.0].map(outage).to_vec(),
            align: AlignSettings {
                heading: Heading::Given(log.truth[0].rpy.unwrap().z, 0.05),
                ..AlignSettings::default()
            },
            ..Settings::new(sensors())
        };
        (profile.name().to_owned(), settings)
    });
    let aiding = Measurement::from_fixes(&log.gnss);
    let runs = outages::run(&log.imu, &aiding, &log.truth, &settings, &|_| {});
    let runs: Vec<_> = runs.into_iter().map(|(_, run)| run.unwrap()).collect();
    runs.try_into().unwrap()
}

/// Horizontal drift in a minute, without and with the profile; NEES of both axes with it, and the share inside 3 σ.
fn judged(craft: Craft, profile: Profile) -> ([f64; 2], f64, f64) {
    let (mut squares, mut nees, mut inside, mut count) = ([0.0; 2], 0.0, 0.0, 0.0);
    // From any side, and none.
    let winds = [[0.0, 0.0], [6.0, 0.0], [0.0, 6.0], [-5.0, 3.0], [2.0, -7.0]];
    for (seed, wind) in (1..).zip(winds) {
        let runs = run(craft, wind, seed, [Profile::None, profile]);
        for (sum, run) in squares.iter_mut().zip(&runs) {
            let ends = run.errors.per_outage.iter();
            *sum += ends
                .map(|one| one.end.0[0].powi(2) + one.end.0[1].powi(2))
                .sum::<f64>();
        }
        for one in &runs[1].errors.per_outage {
            for axis in [0, 1] {
                let square = (one.end.0[axis] / one.sigma.0[axis]).powi(2);
                nees += square;
                inside += f64::from(u8::from(square < 9.0));
                count += 1.0;
            }
        }
        let aided = &runs[1].summary.innovations[Aid::Air];
        assert!(aided.updates > 1000 && aided.rejected == 0, "{aided:?}");
    }
    let drift = squares.map(|sum| (2.0 * sum / count).sqrt());
    println!(
        "{profile:?}: {drift:.0?} m, NEES {:.2}, inside {:.3}",
        nees / count,
        inside / count
    );
    (drift, nees / count, inside / count)
}

#[test]
fn rotors_and_wings_hold_a_flight_for_a_minute() {
    for (craft, profile) in [
        (Craft::Copter(0.3), Profile::Copter),
        (Craft::Aircraft(18.0), Profile::Aircraft),
    ] {
        let ([without, with], nees, inside) = judged(craft, profile);
        assert!(with < 0.4 * without, "{profile:?}: {without} {with}");
        assert!((0.2..1.6).contains(&nees), "{profile:?}: {nees}");
        assert!(inside >= 0.95, "{profile:?}: {inside}");
    }
}

#[test]
fn drag_of_the_rotors_is_estimated() {
    let [_, run] = run(
        Craft::Copter(0.33),
        [4.0, 2.0],
        7,
        [Profile::None, Profile::Copter],
    );
    let found = |kind| {
        let mut all = run.summary.parameters.iter();
        all.find(|(of, ..)| *of == kind)
            .map(|(_, value, std)| (value.clone(), std.clone()))
    };
    let (drag, std) = found(Parameter::RotorDrag).unwrap();
    let off = 0.33 - Air::DRAG - drag[0];
    assert!(
        std[0] < 0.03 && off.abs() < 3.0 * std[0],
        "{drag:?} {std:?}"
    );
    let (wind, std) = found(Parameter::Wind).unwrap();
    for (axis, truth) in [4.0, 2.0].into_iter().enumerate() {
        assert!(
            (wind[axis] - truth).abs() < 3.0 * std[axis],
            "{wind:?} {std:?}"
        );
        assert!(std[axis] < 1.5);
    }
}
