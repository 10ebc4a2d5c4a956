//! Which statistic is of what, and which noise the errors are judged by.

use super::*;
use crate::{outages::result::result, replay::Outage};
use undrift_nav::{
    Matrix3, Quaternion, Vector3, covariance::AXES, earth::Geodetic, shaping::ShapingFilter,
};
use undrift_results::Number;
use undrift_simulate::{GnssNoise, Trajectory, simulate};

const RATE: f64 = 50.0;

fn outage(start: f64, length: f64) -> Outage {
    Outage {
        start,
        end: start + length,
    }
}

fn nav(time: f64) -> NavState {
    NavState {
        time,
        position: Geodetic::from_degrees(45.0, 7.0, 300.0),
        v_n: Vector3::zeros(),
        q_nb: Quaternion::identity(),
    }
}

/// Standard deviations of 1 m, 2 m/s and 3°, turned no way.
fn predicted() -> Predicted {
    Predicted([1.0, 2.0, 3f64.to_radians()].map(|std| Matrix3::identity() * (std * std)))
}

/// Three outages of two samples each; the larger error comes first, so that neither the largest errors nor those at the
/// end are the last ones seen.
#[test]
fn largest_errors_and_errors_at_the_end_have_statistics_of_their_own() {
    let settings = Settings {
        outages: [100.0, 200.0, 300.0]
            .map(|start| outage(start, 10.0))
            .into(),
        ..Settings::new([ShapingFilter::white(1e-3, 1.0 / RATE).unwrap(); AXES])
    };
    let rejected = Rejected::default();
    let reference = Reference {
        truth: &[],
        rejected: &rejected,
    };
    let mut watch = OutageWatch::new(&settings, reference);
    // Each component another multiple, so that none can stand for another.
    let row = |size: f64| Errors(std::array::from_fn(|i| size * (1.0 + i as f64)));
    for (k, (largest, end)) in [(-6.0, 1.0), (10.0, -2.0), (-8.0, 4.0)]
        .into_iter()
        .enumerate()
    {
        let start = settings.outages[k].start;
        watch.note(k, &nav(start + 5.0), row(largest), &predicted());
        watch.note(k, &nav(start + 10.0), row(end), &predicted());
    }
    let found = watch.finish(&Summary::default());
    let rms = |values: [f64; 3]| (values.iter().map(|v| v * v).sum::<f64>() / 3.0).sqrt();
    let expected = [
        ("max", found.max, 10.0),
        ("rms", found.rms, rms([6.0, 10.0, 8.0])),
        ("median", found.median, 8.0),
        ("end_rms", found.end_rms, rms([1.0, 2.0, 4.0])),
    ];
    for (what, errors, size) in expected {
        for (i, error) in errors.0.into_iter().enumerate() {
            let wanted = size * (1.0 + i as f64);
            assert!(
                (error / wanted - 1.0).abs() < 1e-12,
                "{what} {i}: {error}, not {wanted}"
            );
        }
    }
    // Of both samples of each outage: |error| of 1 m lies within 1 σ of 1 m, 2 m within 2 σ, 3 m within 3 σ, the others not.
    let north = [6.0, 10.0, 8.0, 1.0, 2.0, 4.0];
    let inside = |i: f64, sigma: f64| {
        let within = |k: f64| north.iter().filter(|e| i * **e <= k * sigma).count();
        [within(1.0), within(2.0), within(3.0)]
    };
    let shares = |components: [f64; 3], sigma: f64| -> [f64; 3] {
        let of = components.map(|i| inside(i, sigma));
        std::array::from_fn(|k| of.iter().map(|inside| inside[k]).sum::<usize>() as f64 / 18.0)
    };
    assert_eq!(found.coverage.shares(0), Some(shares([1.0, 2.0, 3.0], 1.0)));
    assert_eq!(found.coverage.shares(1), Some(shares([5.0, 6.0, 7.0], 2.0)));

    // The result has each in its own place, of every component and outage.
    let run = ModelRun {
        name: "white".into(),
        errors: found.clone(),
        summary: Summary::default(),
    };
    let result = result(
        &settings.outages,
        &[("white".into(), Ok(run))],
        &[],
        &|of| format!("{of:?}"),
    );
    let model = &result.models["white"];
    for (what, numbers, errors) in [
        ("max", &model.max, &found.max),
        ("rms", &model.rms, &found.rms),
        ("median", &model.median, &found.median),
        ("end_rms", &model.end_rms, &found.end_rms),
    ] {
        for (name, value) in reference::COMPONENTS.into_iter().zip(errors.0) {
            assert_eq!(numbers[name], Number(value), "{what} {name}");
        }
    }
    let second = &model.per_outage[1];
    assert_eq!(second.start_s, Number(200.0));
    assert_eq!(second.max["north_m"], Number(10.0));
    assert_eq!(second.end["north_m"], Number(-2.0));
    assert_eq!(second.sigma["north_m"], Number(1.0));
    assert_eq!(
        model.inside_sigma["position"],
        found.coverage.shares(0).unwrap().map(Number)
    );
}

/// Without a truth the withheld fixes are the reference, and they have noise of their own: of a receiver that errs by
/// 3 m while the solution is good to half a metre, σ covers the differences only with the fixes' share in it. Of the
/// solution as it went and of the smoothed one.
#[test]
fn the_noise_of_the_withheld_fixes_is_in_what_is_expected_of_them() {
    let sensor = |white: f64, turn_on: f64| {
        let white = ShapingFilter::white(white, 1.0 / RATE).unwrap();
        let constant = ShapingFilter::constant(turn_on, 1.0 / RATE).unwrap();
        white.plus(&constant).unwrap()
    };
    let (gyro, accel) = (sensor(1e-4, 1e-3), sensor(1e-3, 0.02));
    let sensors = [gyro, gyro, gyro, accel, accel, accel];
    let receiver = GnssNoise {
        position_std: [3.0, 3.0, 5.0],
        velocity_std: [0.5; 3],
        ..GnssNoise::default()
    };
    for nodes in [None, Some(0.5)] {
        let mut inside = [[0.0; 3]; 2];
        let seeds = 4;
        for seed in 0..seeds {
            let car = Trajectory::car(240.0, seed);
            let log = simulate(&car, RATE, Some(&sensors), &receiver, seed).unwrap();
            let fixes = log.gnss.iter().copied().map(Measurement::Gnss);
            let settings = Settings {
                // As simulated: the fixes state what they err by.
                gating: false,
                adapt: false,
                nodes,
                outages: (0..11)
                    .map(|k| outage(70.5 + 15.0 * f64::from(k), 5.0))
                    .collect(),
                ..Settings::new(sensors)
            };
            let models = [("known".to_owned(), settings)];
            let run = run(&log.imu, &Vec::from_iter(fixes), &[], &models, &|_| ());
            let errors = &run[0].1.as_ref().unwrap().errors;
            for (sum, group) in inside.iter_mut().zip([0, 1]) {
                let shares = errors.coverage.shares(group).unwrap();
                assert_eq!(errors.coverage.shares(2), None, "a fix has no attitude");
                for (sum, share) in sum.iter_mut().zip(shares) {
                    *sum += share / seeds as f64;
                }
            }
        }
        println!("{nodes:?} {inside:?}");
        for shares in inside {
            // 660 differences, mostly the fixes' own noise: binomial deviations of 1.8, 0.8 and 0.2 %.
            for (share, (expected, allowed)) in
                shares
                    .into_iter()
                    .zip([(0.683, 0.06), (0.954, 0.03), (0.997, 0.008)])
            {
                assert!((share - expected).abs() < allowed, "{nodes:?}: {inside:?}");
            }
        }
    }
}
