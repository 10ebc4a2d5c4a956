//! What a run draws, and from when on it is looked at.

use super::*;
use std::path::Path;
use undrift_engine::settings::fix_errors::Correlated;
use undrift_simulate::Trajectory;

/// A car for two minutes that no test needs, with `trajectory` in its place.
fn spec(trajectory: Trajectory) -> Spec {
    let text = "model = \"mpu6050\"\n[drive]\nkind = \"car\"\nduration = \"120 s\"\nrate = \"10 Hz\"\n\
                [epochs]\nsettle = \"10 s\"\n";
    let spec = Spec::from_toml(text, "spec.toml", Path::new("")).unwrap();
    Spec { trajectory, ..spec }
}

#[test]
fn a_run_settles_from_its_own_beginning() {
    let spec = spec(Trajectory::rest(120.0));
    let stage = Shared::new(&spec).unwrap();
    let settings = &stage.models[0].1;
    let settled = |times: &[f64]| -> Vec<bool> {
        let mut watch = RunWatch {
            stage: &stage,
            settings,
            now: &Cell::new([(0, [0.0; AXES]); 2]),
            outcome: RunOutcome::default(),
        };
        times.iter().map(|time| watch.settled(*time)).collect()
    };
    // Ten seconds after the first time asked, to the rounding of stamps: a microsecond.
    let times = [5.0, 14.9, 15.0 - 2e-6, 15.0 - 0.5e-6, 15.0, 99.0];
    assert_eq!(settled(&times), [false, false, false, true, true, true]);
    assert_eq!(settled(&[7.0, 15.0, 17.0]), [false, false, true]);
}

#[test]
fn all_that_runs_share_is_on_the_same_samples() {
    let mut spec = spec(Trajectory::constant_turn(10.0, 0.1, 30.0));
    spec.every = 0.5;
    let stage = Shared::new(&spec).unwrap();
    assert_eq!((stage.ideal.len(), stage.stride), (300, 5));
    // An epoch is the end of each fifth sample.
    assert_eq!(stage.truth.len(), 60);
    for (k, truth) in stage.truth.iter().enumerate() {
        let sample = &stage.ideal[5 * k + 4];
        assert_eq!(truth.time, sample.time);
        assert!((truth.time - 0.5 * (k + 1) as f64).abs() < 1e-9);
    }
    let first = stage.fix_times[0];
    let mut stepper = Stepper::new(&spec.trajectory);
    stepper.advance_to(first);
    assert_eq!(stage.first_attitude, stepper.state().motion.q_nb);
}

/// A run's constants at will.
fn drawn(spec: &Spec) -> Drawn {
    Drawn {
        gyro_scale: [0.0; 3],
        late: [0.0; 2],
        ..Drawn::new(spec, 1)
    }
}

#[test]
fn a_gyro_with_a_scale_factor_reads_more_and_its_bias_is_of_the_true_rate() {
    let drawn = Drawn {
        gyro_scale: [0.25, 0.0, -0.5],
        ..drawn(&spec(Trajectory::rest(120.0)))
    };
    let ideal = ImuSample {
        time: 1.0,
        dt: 0.1,
        dtheta: Vector3::new(4.0, 5.0, 6.0),
        dvel: Vector3::new(1.0, 2.0, 3.0),
    };
    let read = drawn.scaled(&ideal);
    assert_eq!(read.dtheta, Vector3::new(5.0, 5.0, 3.0));
    assert_eq!((read.dvel, read.time, read.dt), (ideal.dvel, 1.0, 0.1));
    // (1 + s) ω + b, less s/(1 + s) of it, is ω + b/(1 + s).
    let bias = drawn.bias([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    assert_eq!(bias, [0.8, 2.0, 6.0, 4.0, 5.0, 6.0]);
}

#[test]
fn constants_are_drawn_with_the_standard_deviations_of_the_specification() {
    let spec = Spec {
        scale_factor: 0.01,
        time_offset: 0.2,
        ..spec(Trajectory::rest(120.0))
    };
    let (mut scale, mut late) = (0.0, 0.0);
    let runs = 2000;
    for seed in 0..runs {
        let drawn = Drawn::new(&spec, seed);
        scale += drawn.gyro_scale.map(|s| s * s).iter().sum::<f64>();
        late += drawn.late.map(|s| s * s).iter().sum::<f64>();
    }
    let runs = runs as f64;
    // 6000 and 4000 squares: 1.8 % and 2.2 %; five of those, halved by the root.
    assert!(((scale / (3.0 * runs)).sqrt() / 0.01 - 1.0).abs() < 0.05);
    assert!(((late / (2.0 * runs)).sqrt() / 0.2 - 1.0).abs() < 0.06);
}

fn places(fixes: &[GnssFix]) -> Vec<undrift_nav::earth::Geodetic> {
    let place = |fix: &GnssFix| match fix.position {
        Some((Position::Geodetic(place), _)) => place,
        _ => panic!("{fix:?}"),
    };
    fixes.iter().map(place).collect()
}

#[test]
fn what_lasts_of_a_fix_has_its_share_and_its_time() {
    let mut spec = spec(Trajectory::rest(1000.0));
    spec.gnss.rate_hz = 4.0;
    spec.gnss.position_std = [1.0, 2.0, 4.0];
    let (share, time) = (0.6, 0.5);
    spec.correlated = Some(Correlated { share, time });
    let drawn = drawn(&spec);
    let fixes = drawn.fixes(&spec, 3).unwrap();
    let truth = spec.trajectory.start;
    let errors: Vec<Vector3> = places(&fixes)
        .iter()
        .map(|place| truth.offset_to(place))
        .collect();
    let n = errors.len() as f64;
    let stated = fixes[0].position.unwrap().1;
    for (axis, std) in spec.gnss.position_std.into_iter().enumerate() {
        assert_eq!(stated[(axis, axis)], std * std, "the whole is stated");
        let scaled: Vec<f64> = errors.iter().map(|e| e[axis] / std).collect();
        let at = |lag: usize| {
            let pairs = scaled.iter().zip(&scaled[lag..]);
            pairs.map(|(a, b)| a * b).sum::<f64>() / n
        };
        // 4000 fixes, of which four depend on each other: 4 % of the variance; 3.5 of those.
        let phi = (-0.25f64 / time).exp();
        for (lag, expected) in [(0, 1.0), (1, share * phi), (2, share * phi * phi)] {
            assert!(
                (at(lag) - expected).abs() < 0.14,
                "{axis} {lag}: {}",
                at(lag)
            );
        }
    }
    // Twice the noise is twice what lasts, stated as before.
    let louder = Spec {
        gnss: GnssNoise {
            noise_scale: 2.0 * spec.gnss.noise_scale,
            ..spec.gnss
        },
        ..spec.clone()
    };
    let loud = drawn.fixes(&louder, 3).unwrap();
    assert_eq!(loud[0].position.unwrap().1, stated);
    for (place, error) in places(&loud).iter().zip(&errors).take(100) {
        // Rounding of an offset of metres on the Earth: 1e-8 m.
        assert!((truth.offset_to(place) - error * 2.0).norm() < 1e-5);
    }
}

#[test]
fn positions_and_velocities_are_late_each_by_its_own_time() {
    let mut spec = spec(Trajectory::straight(20.0, 0.0, 60.0));
    spec.gnss.position_std = [1e-6; 3];
    spec.gnss.velocity_std = [1e-9; 3];
    spec.trajectory.speed.ramp_to(0.0, 0.5, 1.0, 30.0);
    let exact = drawn(&spec).fixes(&spec, 1).unwrap();
    let late = Drawn {
        late: [0.1, 0.4],
        ..drawn(&spec)
    };
    let late = late.fixes(&spec, 1).unwrap();
    let k = exact.iter().position(|fix| fix.time >= 10.0).unwrap();
    let (a, b) = (&exact[k], &late[k]);
    assert_eq!(a.time, b.time);
    let (v, dv) = (
        a.velocity.unwrap().0,
        b.velocity.unwrap().0 - a.velocity.unwrap().0,
    );
    // At 0.5 m/s² forward.
    assert!((dv.norm() - 0.5 * 0.4).abs() < 1e-6, "{dv}");
    let moved = places(std::slice::from_ref(a))[0].offset_to(&places(std::slice::from_ref(b))[0]);
    let expected = v.norm() * 0.1 + dv.dot(&v).signum() * 0.5 * 0.5 * 0.1 * 0.1;
    // A micrometre of noise each.
    assert!((moved.norm() - expected).abs() < 1e-4, "{moved} {expected}");
    // Of what was so much before, or will be: both the same way.
    assert_eq!(moved.dot(&v).signum(), dv.dot(&v).signum());
}

#[test]
fn an_error_says_in_which_run() {
    let error = MonteCarloError::Replay {
        model: "arma".into(),
        run: 0,
        error: Box::new(ReplayError::Filter(
            undrift_nav::filter::FilterError::BadMeasurement,
        )),
    };
    let text = error.at_run(65).to_string();
    assert!(text.starts_with("arma, run 65: "), "{text}");
}

#[test]
fn measurements_without_an_update_are_not_reported() {
    let mut sums = report::RunSums::new(0, 0);
    let none = sums.report("a".into(), &[], &[], 0.0);
    assert!(none.nis.is_empty() && none.nees.is_empty());
    let mut outcome = RunOutcome::default();
    outcome.innovations[1].add(1.0, &[0.5, -1.0, 2.0]);
    sums.add(&outcome);
    let velocity = sums.report("a".into(), &[], &[], 0.0);
    let [kind] = &velocity.nis[..] else {
        panic!("{:?}", velocity.nis);
    };
    assert_eq!((&*kind.name, kind.updates), ("velocity", 1));
    // (0.25 + 1 + 4) / 3
    assert!((kind.nis_per_freedom.0 - 1.75).abs() < 1e-12);
}
