//! An IMU in a hand, with the poses of a marker.

use super::{DEG, RATE, at, imu};
use crate::{
    Aid, Navigator, Summary,
    align::AttitudeSource,
    settings::{
        Outage, Settings,
        fix_errors::{Correlated, FixErrors},
    },
};
use alloc::{vec, vec::Vec};
use undrift_nav::{
    Matrix3, Quaternion, Vector3,
    attitude::{from_rotation_vector, from_rpy},
    parameters::{Parameter, Parameters, Prior},
    sample::{FixQuality, GnssFix, Position},
};
use undrift_simulate::{GnssNoise, PoseNoise, Trajectory, simulate};

/// Of the filter's errors, the last ones of each run.
struct Ran {
    summary: Summary,
    /// Turn of the marker, tilt of the frame, lever arm, time offset: errors over their standard deviations.
    constants: Vec<f64>,
    /// Attitude and position at the end: errors over their standard deviations.
    solution: Vec<f64>,
}

/// A minute in a hand, a pose each tenth of a second of 2 mm and 0.1°; `settings` may be changed.
fn run(seed: u64, change: impl FnOnce(&mut Settings, &mut Vec<GnssFix>)) -> Ran {
    run_lasting(seed, 0.0, change)
}

/// The same with errors that last a second beside them, so many times as large.
fn run_lasting(
    seed: u64,
    lasting: f64,
    change: impl FnOnce(&mut Settings, &mut Vec<GnssFix>),
) -> Ran {
    let sensors = imu([5e-3 * DEG, 0.2 * DEG], [1e-3, 0.05]);
    let hand = Trajectory::handheld(60.0, 0.6, seed);
    let log = simulate(&hand, RATE, Some(&sensors), &GnssNoise::default(), seed).unwrap();
    // Stated 0.02 rad and 3 cm wrong.
    let stated = from_rpy(&Vector3::new(0.4, -0.3, 2.0));
    let turn = Vector3::new(0.02, -0.015, 0.01);
    let lever = Vector3::new(0.1, -0.05, 0.2);
    let tilt = Vector3::new(0.004, -0.003, 0.0);
    let clock = 0.02;
    let seen = PoseNoise {
        position_std: 2e-3,
        attitude_std: 0.1 * DEG,
        lasting: [lasting * 2e-3, lasting * 0.1 * DEG],
        marker: stated * from_rotation_vector(&turn),
        lever_arm: lever,
        frame: from_rotation_vector(&tilt),
        clock: -clock,
        ..PoseNoise::default()
    };
    let truth = log.truth.iter().copied().step_by(5);
    let variance = |std: f64| Matrix3::from_diagonal_element(std * std);
    let fix = |pose: undrift_simulate::Pose| GnssFix {
        time: pose.time,
        position: Some((
            Position::Baseline {
                base: hand.start,
                ned: pose.position,
            },
            variance(2e-3),
        )),
        velocity: None,
        mean_velocity: None,
        attitude: Some((pose.attitude, variance(0.1 * DEG))),
        quality: FixQuality::Unknown,
    };
    let poses = seen.measure(truth, &hand.start, seed);
    let mut fixes: Vec<GnssFix> = poses.into_iter().map(fix).collect();
    let mut settings = Settings {
        marker: Some(stated),
        lever_arm: lever + Vector3::new(0.03, 0.02, -0.03),
        parameters: Parameters::none()
            .with(Parameter::LeverArm, Prior::constant(0.05))
            .with(Parameter::TimeOffset, Prior::constant(0.1))
            .with(Parameter::MarkerRotation, Prior::constant(0.05))
            .with(Parameter::FrameTilt, Prior::constant(0.01)),
        ..Settings::new(sensors)
    };
    change(&mut settings, &mut fixes);
    let mut navigator = Navigator::new(settings);
    for fix in fixes {
        navigator.fix(fix).unwrap();
    }
    for sample in &log.imu {
        navigator.imu(*sample).unwrap();
    }
    let filter = navigator.filter().unwrap();
    let of = |kind, truth: &[f64]| -> Vec<f64> {
        let (value, std) = filter.parameter(kind).unwrap();
        let off = truth.iter().zip(value).zip(std);
        off.map(|((truth, value), std)| (value - truth) / std)
            .collect()
    };
    let mut constants = of(Parameter::MarkerRotation, turn.as_slice());
    constants.extend(of(Parameter::FrameTilt, &[tilt.x, tilt.y]));
    constants.extend(of(Parameter::LeverArm, &[-0.03, -0.02, 0.03]));
    // A stamp that is late by the clock holds that much earlier.
    constants.extend(of(Parameter::TimeOffset, &[-clock]));
    let (nav, std) = (filter.nav(), filter.nav_std());
    let truth = at(&log.truth, nav.time);
    let off = truth.position.offset_to(&nav.position);
    let turned: Quaternion = nav.q_nb * from_rpy(&truth.rpy.unwrap()).inverse();
    let turned = turned.scaled_axis();
    let errors = off.iter().copied().chain(turned.iter().copied());
    let solution = errors
        .zip([0, 1, 2, 6, 7, 8])
        .map(|(error, k)| error / std[k]);
    Ran {
        constants,
        solution: solution.collect(),
        summary: navigator.summary().clone(),
    }
}

fn mean_square(all: &[f64]) -> f64 {
    all.iter().map(|x| x * x).sum::<f64>() / all.len() as f64
}

/// Begins with the first pose, without a rest; the errors of what it estimates are as large as it says, over twelve seeds.
#[test]
fn the_marker_its_frame_and_its_clock_are_found_within_what_is_stated_of_them() {
    let (mut constants, mut solution) = (Vec::new(), Vec::new());
    for seed in 1..=12 {
        let ran = run(seed, |_, _| ());
        let alignment = ran.summary.alignment.unwrap();
        assert_eq!(alignment.source, AttitudeSource::Pose);
        assert!(ran.summary.started.unwrap() < 0.5);
        let attitudes = ran.summary.innovations[Aid::Attitude];
        assert!(attitudes.updates > 580 && attitudes.rejected == 0);
        // 1800 numbers: a standard deviation of 0.033, and the nonlinear beginning.
        let nis = attitudes.per_dof().unwrap();
        assert!((0.85..1.15).contains(&nis), "{nis}");
        constants.extend(ran.constants);
        solution.extend(ran.solution);
    }
    // 108 and 72 numbers, correlated in a run.
    let [constants, solution] = [constants, solution].map(|all| mean_square(&all));
    assert!((0.6..1.6).contains(&constants), "{constants}");
    assert!((0.6..1.6).contains(&solution), "{solution}");
}

/// Positions and attitudes that err for a second, too, by three times what is white of them, over twelve seeds: the solution is as good as it
/// says where the filter knows, and three times as bad where all of it is taken for white.
#[test]
fn errors_of_attitudes_that_last_are_estimated() {
    let part = Some(Correlated {
        share: 0.9,
        time: 1.0,
    });
    let whole = FixErrors {
        position_factor: 10f64.sqrt(),
        velocity_factor: Vector3::repeat(10f64.sqrt()),
        ..FixErrors::default()
    };
    let lasting = FixErrors {
        correlated: part,
        velocity_correlated: part,
        ..whole
    };
    let square = |errors: FixErrors| {
        let of = |seed: u64| {
            let ran = run_lasting(seed, 3.0, |settings, _| {
                settings.fix_errors = errors;
                settings.parameters = errors.with_states(settings.parameters);
            });
            ran.solution[3..].to_vec()
        };
        mean_square(&(1..=12).flat_map(of).collect::<Vec<_>>())
    };
    let [white, known] = [whole, lasting].map(square);
    assert!((0.6..1.6).contains(&known), "{known}");
    assert!(white > 2.0 * known, "{white} {known}");
}

/// An outage cuts the attitude as well: the heading of a room is then the gyros' alone.
#[test]
fn an_outage_withholds_the_attitude_too() {
    let whole = run(3, |_, _| ());
    let cut = run(3, |settings, _| {
        settings.outages = vec![Outage {
            start: 50.0,
            end: 60.0,
        }];
    });
    let updates = |ran: &Ran| ran.summary.innovations[Aid::Attitude].updates;
    assert!((95..=101).contains(&(updates(&whole) - updates(&cut))));
    assert!(mean_square(&cut.solution) < 9.0, "{:?}", cut.solution);
}

/// A marker that is taken for another one for a second turns the solution by nothing.
#[test]
fn attitudes_far_off_are_rejected() {
    let ran = run(5, |_, fixes| {
        for fix in fixes
            .iter_mut()
            .filter(|fix| (40.0..41.0).contains(&fix.time))
        {
            let (attitude, _) = fix.attitude.as_mut().unwrap();
            *attitude = from_rotation_vector(&Vector3::new(0.0, 0.0, 1.5)) * *attitude;
        }
    });
    assert_eq!(ran.summary.innovations[Aid::Attitude].rejected, 10);
    assert!(mean_square(&ran.solution) < 6.0, "{:?}", ran.solution);
}

/// Without the Earth's rotation in the mechanisation, what the gyros measure of it is estimated as their bias.
#[test]
fn a_room_without_the_earth_s_rate_has_it_as_a_bias() {
    let still = run(7, |settings, _| settings.earth_rate = false);
    // 15°/h in a minute against 0.3°/√h of the gyros.
    assert!(mean_square(&still.solution) < 9.0, "{:?}", still.solution);
}

/// A pose that is a metre off counts for less in the first ten seconds of a solution, and is rejected later.
#[test]
fn no_pose_is_rejected_by_a_solution_that_has_just_begun() {
    let rejected = |after: f64| {
        let ran = run(3, |_, poses| {
            let wrong = poses.iter_mut().find(|pose| pose.time > after).unwrap();
            if let Some((Position::Baseline { ned, .. }, _)) = &mut wrong.position {
                ned.x += 1.0;
            }
        });
        ran.summary.innovations[Aid::Position].rejected
    };
    assert_eq!([3.0, 30.0].map(rejected), [0, 1]);
}
