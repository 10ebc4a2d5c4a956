//! What fixes show of themselves, where it is known what they are wrong by: an S-shaped drive with errors of the kinds
//! that receivers have, PCG-like generator xoshiro256++ with the seeds given.

use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;
use undrift::fixes::{FixStudy, study};
use undrift_nav::{
    Matrix3, Vector3,
    earth::Geodetic,
    sample::{FixQuality, GnssFix, Position},
};

/// Errors of the fixes; everything in SI units.
struct Errors {
    rate: f64,
    seconds: f64,
    white: f64,
    correlated: (f64, f64),
    stated: f64,
    jitter: f64,
    step: f64,
    late: f64,
    bias: f64,
    hold: usize,
}

const CLEAN: Errors = Errors {
    rate: 4.0,
    seconds: 1200.0,
    white: 0.5,
    correlated: (0.0, 1.0),
    stated: 0.5,
    jitter: 0.0,
    step: 0.0,
    late: 0.0,
    bias: 0.0,
    hold: 1,
};

/// Place and velocity at a time: a speed that changes, on a road that winds.
fn motion(t: f64) -> (Vector3, Vector3) {
    let (along, across) = (t / 9.0, t / 23.0);
    (
        Vector3::new(10.0 * t + 45.0 * along.sin(), 230.0 * across.sin(), 0.0),
        Vector3::new(10.0 + 5.0 * along.cos(), 10.0 * across.cos(), 0.0),
    )
}

fn fixes(errors: &Errors, seed: u64) -> Vec<GnssFix> {
    let mut generator = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut normal = move || -> f64 { StandardNormal.sample(&mut generator) };
    let origin = Geodetic::from_degrees(47.0, 8.0, 400.0);
    let (sigma, tau) = errors.correlated;
    let left = (-1.0 / (errors.rate * tau)).exp();
    let mut correlated = Vector3::from_fn(|_, _| normal()) * sigma;
    let mut fixes: Vec<GnssFix> = Vec::new();
    for k in 0..(errors.seconds * errors.rate) as usize {
        let time = k as f64 / errors.rate;
        let drawn = Vector3::from_fn(|_, _| normal());
        correlated = correlated * left + drawn * (sigma * (1.0 - left * left).sqrt());
        let true_time = time + errors.jitter * normal();
        let (place, _) = motion(true_time.max(0.0));
        let (_, velocity) = motion((true_time - errors.late).max(0.0));
        let white = Vector3::from_fn(|_, _| normal()) * errors.white;
        let mut ned = place + correlated + white;
        if errors.step > 0.0 {
            ned = ned.map(|x| (x / errors.step).round() * errors.step);
        }
        let noise = Vector3::from_fn(|_, _| normal()) * 0.03;
        let fix = GnssFix {
            attitude: None,
            mean_velocity: None,
            time,
            position: Some((
                Position::Baseline { base: origin, ned },
                Matrix3::identity() * (errors.stated * errors.stated),
            )),
            velocity: Some((
                velocity + noise + Vector3::x() * errors.bias,
                Matrix3::identity() * (0.03 * 0.03),
            )),
            quality: FixQuality::Unknown,
        };
        fixes.push(match fixes.last() {
            Some(last) if k % errors.hold != 0 => GnssFix { time, ..*last },
            _ => fix,
        });
    }
    fixes
}

fn studied(errors: &Errors, seed: u64) -> FixStudy {
    study(fixes(errors, seed)).expect("fixes enough")
}

#[test]
fn fixes_that_are_as_they_state_are_left_alone() {
    for seed in 1..=5 {
        let seen = studied(&CLEAN, seed);
        println!("seed {seed}: {seen:?}");
        let errors = seen.errors;
        assert_eq!((seen.interval, seen.repeated), (0.25, 0));
        assert_eq!((errors.position_factor, errors.jitter), (1.0, 0.0));
        assert_eq!(errors.step, Vector3::zeros());
        assert_eq!(errors.velocity_bias, Vector3::zeros());
        assert!(errors.correlated.is_none() && errors.known);
    }
}

#[test]
fn a_correlated_error_is_found_with_its_time() {
    for (seed, (sigma, tau)) in (1..).zip([(5.0, 60.0), (2.0, 20.0), (1.0, 30.0), (5.0, 60.0)]) {
        let errors = Errors {
            white: 0.1 * sigma,
            correlated: (sigma, tau),
            stated: sigma,
            seconds: 1800.0,
            ..CLEAN
        };
        let found = studied(&errors, seed)
            .errors
            .correlated
            .expect("correlated");
        println!("σ {sigma} m, τ {tau} s: {found:?}");
        assert!((0.9..=0.99).contains(&found.share), "{found:?}");
        // Twice the time at which the differences have grown: a third of a decade either way for 30 to 90 spans.
        let ratio = found.time / tau;
        assert!((0.7..=4.0).contains(&ratio), "{found:?}");
    }
}

#[test]
fn the_correlated_share_is_what_white_noise_leaves_of_the_variance() {
    // A quarter white. Over one interval the rest changes by a hundredth.
    let tau = 60.0;
    let errors = Errors {
        white: 0.5,
        correlated: (0.75f64.sqrt(), tau),
        stated: 1.0,
        seconds: 1800.0,
        ..CLEAN
    };
    let expected = 0.75 * (-1.0 / (errors.rate * tau)).exp();
    for seed in 20..24 {
        let found = studied(&errors, seed)
            .errors
            .correlated
            .expect("correlated");
        // The white part by the median of 7200 squares that overlap, 4 % of 0.25; 3 of those.
        assert!((found.share - expected).abs() < 0.03, "{found:?}");
    }
}

#[test]
fn the_correlation_time_is_twice_that_at_which_the_differences_have_grown() {
    // Twice, since velocities in error make them grow sooner; here they do not.
    let tau = 8.0;
    let errors = Errors {
        white: 0.5,
        correlated: (5.0, tau),
        stated: 5.0,
        seconds: 5000.0,
        ..CLEAN
    };
    let time = |seed| {
        studied(&errors, seed)
            .errors
            .correlated
            .expect("correlated")
            .time
    };
    let mean = (30..38).map(time).sum::<f64>() / 8.0;
    println!("τ {tau} s: {mean:.2}");
    // A log has 600 spans: 7 % of the mean square of three axes' median, 12 % of the time at which it is grown, 4 % of
    // the mean of eight logs; 4 of those, and the interpolation between lags.
    assert!((mean / (2.0 * tau) - 1.0).abs() < 0.2, "{mean}");
}

#[test]
fn what_a_latency_explains_is_no_noise() {
    // Once a second and late by 0.15 s a velocity is off by 6 cm a fix. Taken out, fixes of 2 cm are as they state.
    let errors = Errors {
        rate: 1.0,
        late: 0.15,
        white: 0.02,
        stated: 0.02,
        ..CLEAN
    };
    for seed in 40..44 {
        let seen = studied(&errors, seed);
        assert!(seen.velocity_late.is_some());
        assert_eq!(seen.errors.position_factor, 1.0, "{seen:?}");
        assert!(seen.errors.correlated.is_none(), "{seen:?}");
    }
}

#[test]
fn white_noise_beyond_what_is_stated_is_measured() {
    let errors = Errors {
        white: 2.0,
        stated: 0.1,
        ..CLEAN
    };
    let factor = studied(&errors, 7).errors.position_factor;
    // 4800 squares of the median: 3 %.
    assert!((factor / 20.0 - 1.0).abs() < 0.05, "{factor}");
}

#[test]
fn stamps_that_jitter_are_distinguished_from_noise() {
    let errors = Errors {
        white: 0.02,
        stated: 0.02,
        jitter: 0.02,
        ..CLEAN
    };
    let jitter = studied(&errors, 8).errors.jitter;
    assert!((0.015..0.025).contains(&jitter), "{jitter}");
}

#[test]
fn steps_repeats_latency_and_a_wrong_velocity_are_found() {
    let steps = Errors {
        white: 0.01,
        stated: 0.02,
        step: 1.0,
        ..CLEAN
    };
    let step = studied(&steps, 9).errors.step;
    assert!(
        (step - Vector3::new(1.0, 1.0, 0.0)).xy().norm() < 1e-9,
        "{step}"
    );

    let held = Errors { hold: 4, ..CLEAN };
    let seen = studied(&held, 10);
    assert_eq!((seen.interval, seen.repeated), (1.0, 3600));

    let late = Errors {
        late: 0.15,
        white: 0.02,
        stated: 0.02,
        ..CLEAN
    };
    let (delay, error) = studied(&late, 11).velocity_late.expect("late");
    assert!(
        (delay - 0.15).abs() < 0.01 && error < 0.01,
        "{delay} ± {error}"
    );

    let biased = Errors { bias: 0.5, ..CLEAN };
    let bias = studied(&biased, 12).errors.velocity_bias;
    assert!((bias - Vector3::x() * 0.5).norm() < 0.03, "{bias}");
}

#[test]
fn velocities_count_as_better_than_they_state_only_after_a_minute_of_motion() {
    // Positions whose error lasts, velocities a hundred times as good as they state.
    let errors = Errors {
        white: 0.0,
        correlated: (1.5, 60.0),
        stated: 1.5,
        seconds: 100.0,
        ..CLEAN
    };
    let factor = |moves_until: f64| {
        let mut shown = fixes(&errors, 1);
        for fix in &mut shown {
            let at_rest = fix.time > moves_until;
            let (place, speed) = motion(fix.time);
            let (stop, _) = motion(moves_until);
            if let Some((Position::Baseline { ned, .. }, _)) = &mut fix.position
                && at_rest
            {
                *ned += stop - place;
            }
            if let Some((velocity, covariance)) = &mut fix.velocity {
                *velocity -= if at_rest { speed } else { Vector3::zeros() };
                *covariance = Matrix3::identity() * 9.0;
            }
        }
        study(shown).unwrap().errors.velocity_factor.max()
    };
    for (moves_until, better) in [(0.0, false), (55.0, false), (65.0, true), (100.0, true)] {
        let found = factor(moves_until);
        assert_eq!(found < 0.5, better, "{moves_until} {found}");
        assert!(better || found == 1.0);
    }
}

/// A vertical velocity of which nothing is known says nothing of the horizontal ones.
#[test]
fn velocities_are_judged_axis_by_axis() {
    let errors = Errors {
        seconds: 100.0,
        ..CLEAN
    };
    for vertical in [0.1, 20.0] {
        let mut shown = fixes(&errors, 1);
        for fix in &mut shown {
            let (_, covariance) = fix.velocity.as_mut().unwrap();
            *covariance = Matrix3::from_diagonal(&Vector3::new(0.01, 0.01, vertical * vertical));
        }
        let factor = study(shown).unwrap().errors.velocity_factor;
        assert_eq!(factor.xy(), Vector3::repeat(1.0).xy(), "{vertical}");
        assert_eq!(factor.z == 1.0, vertical < 1.0, "{vertical} {factor}");
    }
}
