//! Starts in motion where the fixes are positions alone.

use super::{DEG, Epoch, Scenario, imu, receiver};
use crate::{
    Navigator, RestartCause,
    align::{AttitudeSource, Heading},
    estimator::STAMP_ROUNDING,
};
use alloc::vec::Vec;
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use undrift_nav::{
    Vector3,
    parameters::{Parameter, Parameters, Prior},
    sample::Position,
};
use undrift_simulate::{GnssNoise, Profile, Trajectory};

/// A slow robot that winds its way from the first sample on: 1.2 m/s, 35 deg/s to either side.
fn winding(seconds: f64) -> Trajectory {
    let mut motion = Trajectory::straight(1.2, 2.0, seconds);
    let (mut start, mut way) = (0.5, 1.0);
    while start < seconds - 5.0 {
        start = motion.turn_rate.step_to(start, 1.0, way * 35.0 * DEG) + 2.0;
        way = -way;
    }
    motion
}

/// An IMU just switched on, 0.3 deg/s and 30 mg, positions of 5 cm ten times a second that hold `late` \[s\] after their
/// stamps, nothing known of the attitude.
fn drive(seed: u64, late: f64) -> Scenario {
    along(&winding(90.0), seed, late)
}

fn along(motion: &Trajectory, seed: u64, late: f64) -> Scenario {
    let noise = GnssNoise {
        position_std: [0.05; 3],
        rate_hz: 10.0,
        ..receiver()
    };
    let sensors = imu([5e-3 * DEG, 0.3 * DEG], [1e-3, 0.3]);
    let mut scenario = Scenario::of(sensors, motion, &noise, seed);
    scenario.settings.align.attitude = None;
    scenario.settings.parameters =
        Parameters::none().with(Parameter::TimeOffset, Prior::constant(0.1));
    for fix in &mut scenario.log.gnss {
        fix.velocity = None;
        fix.time -= late;
    }
    scenario
}

#[test]
fn positions_alone_align_what_never_stood() {
    for (seed, late) in [(1, 0.0), (2, 0.15), (3, -0.1), (4, 0.35)] {
        let seen = drive(seed, late).navigate();
        let alignment = seen.summary.alignment.unwrap();
        assert!(matches!(alignment.source, AttitudeSource::Motion { .. }));
        let started = seen.summary.started.unwrap();
        assert!(started < 60.0, "seed {seed}: {started}");
        // The attitude at the start, and all that comes after.
        let first = seen.epochs[0];
        for i in 6..9 {
            assert!(
                first.error[i].abs() < 4.0 * first.std[i],
                "seed {seed}, axis {i}: {first:?}"
            );
        }
        let worst = seen.most(started + 10.0, 90.0, |epoch| {
            epoch.heading().0 / epoch.heading().1
        });
        assert!(worst < 4.0, "seed {seed}: {worst}");
        assert!(seen.last().heading().1 < 2.0 * DEG);
    }
}

/// The last of the window's fixes hold after its end, or long before it: the filter takes up those that the window did not
/// have, each at its own time.
#[test]
fn the_time_by_which_positions_are_late_is_found_with_the_attitude() {
    for late in [-0.2, 0.35] {
        let scenario = drive(5, late);
        let mut navigator = Navigator::new(scenario.settings.clone());
        let mut fixes = scenario.log.gnss.iter().peekable();
        for sample in &scenario.log.imu {
            let until = sample.time + navigator.ahead() + STAMP_ROUNDING;
            while let Some(fix) = fixes.next_if(|fix| fix.time <= until) {
                navigator.fix(*fix).unwrap();
            }
            navigator.imu(*sample).unwrap();
            if let Some(filter) = navigator.filter() {
                let (found, std) = filter.time_offset(Parameter::TimeOffset).unwrap();
                assert!((found - late).abs() < 4.0 * std, "{late}: {found} ± {std}");
                assert!(std < 0.06, "{std}");
                break;
            }
        }
        assert!(navigator.filter().is_some());
    }
}

/// Half a minute of turns on the spot, steady for two seconds each, which are no rest, then the winding way.
#[test]
fn positions_alone_have_to_move_for_fifteen_seconds() {
    let mut motion = winding(90.0);
    motion.speed = Profile::hold(0.0);
    motion.speed.step_to(30.0, 1.0, 1.2);
    let mut scenario = along(&motion, 1, 0.0);
    scenario.settings.align.heading = Heading::Auto;
    let started = scenario.navigate().summary.started.unwrap();
    assert!(started > 45.0, "{started}");
}

/// A bias of ten standard deviations of its prior: an attitude that explains it is invalid.
#[test]
fn an_accelerometer_that_is_far_off_aligns_nothing() {
    let mut scenario = drive(1, 0.0);
    for sample in &mut scenario.log.imu {
        sample.dvel.x += 3.0 * sample.dt;
    }
    assert!(scenario.try_navigate().is_none());
}

/// Without turns and changes of speed there is no heading to find, and none is made up.
#[test]
fn steady_motion_by_positions_alone_does_not_start() {
    let scenario = along(&Trajectory::straight(1.2, 2.0, 90.0), 1, 0.0);
    assert!(scenario.try_navigate().is_none());
}

/// Accelerometers that nobody calibrated, 0.1 g, so a level known to 6 deg, and fixes of centimetres: the first turns show tilt and
/// constants together, to the product of their errors.
#[test]
fn a_level_that_is_hardly_known_is_found_with_what_is_known_of_it() {
    let noise = GnssNoise {
        position_std: [0.02, 0.02, 0.04],
        velocity_std: [0.03; 3],
        rate_hz: 1.0,
        ..receiver()
    };
    let sensors = imu([5e-3 * DEG, DEG], [1e-3, 0.98]);
    for seed in 1..=6 {
        let mut scenario = Scenario::of(sensors, &Trajectory::car(200.0, 1), &noise, seed);
        scenario.settings.align.attitude = None;
        let seen = scenario.navigate();
        let tilts = |epoch: &&Epoch| epoch.time > 90.0;
        let late: Vec<_> = seen.epochs.iter().filter(tilts).collect();
        let nees = |epoch: &&Epoch| {
            [6, 7]
                .map(|i| (epoch.error[i] / epoch.std[i]).powi(2))
                .iter()
                .sum::<f64>()
                / 2.0
        };
        let mean = late.iter().map(nees).sum::<f64>() / late.len() as f64;
        // About 1 of small errors; without the products it is 4 to 2700.
        assert!(mean < 10.0, "seed {seed}: {mean}");
    }
}

/// A minute of positions that are up to 230 m off as the vehicle sets off: the solution that began with them is replaced by
/// one from the fixes after them, by which the run is judged. Without velocities nothing begins with them: their scatter
/// makes no course.
#[test]
fn a_bad_minute_at_the_start_does_not_spoil_the_rest() {
    let noise = GnssNoise {
        rate_hz: 1.0,
        ..receiver()
    };
    let sensors = imu([5e-3 * DEG, 0.3 * DEG], [1e-3, 0.3]);
    for (seed, velocities) in [(1, true), (2, true), (3, true), (4, false), (5, false)] {
        let mut scenario = Scenario::of(sensors, &Trajectory::car(300.0, 1), &noise, seed);
        scenario.settings.align.attitude = None;
        scenario.settings.parameters = Parameters::none()
            .with(Parameter::TimeOffset, Prior::constant(0.1))
            .with(Parameter::GyroScale, Prior::constant(0.02))
            .with(Parameter::LeverArm, Prior::constant(0.5));
        for (k, fix) in scenario.log.gnss.iter_mut().enumerate() {
            if !velocities {
                fix.velocity = None;
            }
            let away = 200.0 * (k as f64 * 2.4).sin();
            if (65.0..125.0).contains(&fix.time)
                && let Some((Position::Geodetic(place), _)) = &mut fix.position
            {
                *place = place.displaced(&Vector3::new(away, -0.6 * away, 0.0));
            }
        }
        let seen = scenario.navigate();
        let summary = &seen.summary;
        let began = match summary.restarts.last() {
            Some(restart) if velocities => {
                assert_eq!(restart.why, RestartCause::LargeInnovations, "seed {seed}");
                restart.resumed
            }
            None if !velocities => summary.started.filter(|time| *time > 125.0),
            restart => panic!("seed {seed}: {restart:?}"),
        };
        assert!(
            began.is_some_and(|time| time < 200.0),
            "seed {seed}: {began:?}"
        );
        let away = seen.most(220.0, 300.0, Epoch::distance);
        assert!(away < 3.0, "seed {seed}: {away} m");
        let (heading, std) = seen.last().heading();
        assert!(
            heading < 4.0 * std && std < 2.0 * DEG,
            "seed {seed}: {heading} ± {std}"
        );
        assert_eq!(summary.suspect, None, "seed {seed}");
    }
}

/// A car at rest for a minute, positions alone whose noise looks like a speed: no course is taken from it, and the heading that
/// is taken later is within its σ.
#[test]
fn noise_of_positions_is_no_course() {
    for (std, rate_hz) in [(1.5, 1.0), (3.0, 1.0), (3.0, 5.0)] {
        for seed in 1..=20 {
            let noise = GnssNoise {
                position_std: [std; 3],
                rate_hz,
                ..receiver()
            };
            let sensors = imu([5e-3 * DEG, 0.3 * DEG], [1e-3, 0.3]);
            let mut scenario = Scenario::of(sensors, &Trajectory::car(130.0, 1), &noise, seed);
            scenario.settings.align.attitude = None;
            for fix in &mut scenario.log.gnss {
                fix.velocity = None;
            }
            let seen = scenario.navigate();
            let first = &seen.epochs[0];
            assert!(first.time > 60.0, "{std} m, seed {seed}: {}", first.time);
            let (heading, std) = first.heading();
            assert!(
                heading.abs() < 3.5 * std,
                "{std} m, seed {seed}: {heading} ± {std}"
            );
        }
    }
}

/// Positions and velocities that are late alike, in motion from the first sample on: the window takes the delay neither for attitude nor
/// for none, and what follows finds it.
#[test]
fn a_start_in_motion_leaves_the_delay_of_fixes_open() {
    let sensors = imu([4e-3 * DEG, 0.3 * DEG], [3e-3, 0.3]);
    let noise = GnssNoise {
        position_std: [0.05; 3],
        velocity_std: [0.05; 3],
        rate_hz: 4.0,
        ..receiver()
    };
    for (seed, late) in [(1, 0.2), (2, -0.15), (3, 0.1), (4, 0.2)] {
        let mut scenario = Scenario::of(sensors, &Trajectory::car(200.0, seed), &noise, seed);
        scenario.settings.align.attitude = None;
        scenario.settings.align.heading = Heading::Auto;
        let kinds = [Parameter::TimeOffset, Parameter::VelocityTimeOffset];
        for kind in kinds {
            let parameters = scenario.settings.parameters;
            scenario.settings.parameters = parameters.with(kind, Prior::constant(0.1));
        }
        scenario
            .log
            .imu
            .retain(|sample| sample.time > 80.0 && sample.time < 130.0);
        for fix in &mut scenario.log.gnss {
            fix.time += late;
        }
        let seen = scenario.navigate();
        for (kind, value, std) in &seen.summary.parameters {
            let off = (value[0] + late).abs();
            assert!(
                !kinds.contains(kind) || off < 3.0 * std[0],
                "seed {seed}: {kind:?} {value:?} ± {std:?}"
            );
        }
        let is_inside = |epoch: &&Epoch| (0..3).all(|i| epoch.error[i].abs() < 3.0 * epoch.std[i]);
        let inside = seen.epochs.iter().filter(is_inside).count();
        assert!(
            20 * inside >= 19 * seen.epochs.len(),
            "seed {seed}: {inside}"
        );
    }
}
