//! What is expected of a sensor in a vehicle before its drive is seen.

use super::*;
use crate::noise::LASTING;
use undrift_nav::shaping::ShapingFilter;

/// A sensor whose axes differ in everything.
fn start() -> RestNoise {
    RestNoise {
        name: "a sensor".into(),
        guessed: false,
        white: [1e-4, 2e-4, 3e-4, 1e-3, 2e-3, 3e-3],
        walk: [1e-6, 1e-5, 2e-5, 1e-4, 1e-3, 2e-3],
        turn_on: [0.01; AXES],
        idle: None,
        vibrating: None,
        temperature: [None; AXES],
    }
}

fn steady() -> Settings {
    Settings::new([ShapingFilter::white(0.0, 0.01).unwrap(); AXES])
}

fn following() -> Settings {
    Settings {
        vibration: Some([1.0; AXES]),
        ..steady()
    }
}

/// The middle of what is expected of the white noise of each axis, the prior's standard deviations below and above.
fn white(prior: &Prior) -> [(f64, f64, f64); AXES] {
    let centre = Noise::new(&prior.centre).white;
    std::array::from_fn(|i| (centre[i], prior.below[WHITE + i], prior.above[WHITE + i]))
}

fn near(found: f64, expected: f64) {
    // Through the logarithm and back.
    assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
}

/// 3 to 30 times as loud as on a table has been seen, quieter hardly ever: the middle is 5 times, and the sides differ.
#[test]
fn a_vehicle_is_five_times_as_loud_as_a_table_and_seldom_quieter() {
    let start = start();
    let prior = Prior::new(&start, &[&steady()]);
    for (i, (centre, below, above)) in white(&prior).into_iter().enumerate() {
        near(centre, 5.0 * start.white[i]);
        assert_eq!((below, above), (0.8, 1.5), "axis {i}");
    }
    // Random walks are those of the model, but no less than a sensor in a vehicle has.
    let walk = Noise::new(&prior.centre).walk;
    for (found, expected) in walk.into_iter().zip([5e-6, 1e-5, 2e-5, 5e-4, 1e-3, 2e-3]) {
        near(found, expected);
    }
    for i in WALK..FIX {
        assert_eq!((prior.below[i], prior.above[i]), (1.5, 1.5));
    }
    for i in FIX..RULE {
        assert_eq!((prior.below[i], prior.above[i]), (0.2, 0.2));
    }
}

/// Where the samples show noise above the band of motion, half of it is expected; never less than at rest.
#[test]
fn half_of_the_vibration_is_expected_in_navigation() {
    let start = RestNoise {
        vibrating: Some([4e-4, 2e-4, 3e-3, 8e-3, 2e-3, 0.0]),
        ..start()
    };
    let expected = [2e-4, 2e-4, 1.5e-3, 4e-3, 2e-3, 3e-3];
    let prior = Prior::new(&start, &[&steady()]);
    for ((centre, below, above), expected) in white(&prior).into_iter().zip(expected) {
        near(centre, expected);
        assert_eq!((below, above), (0.8, 1.0));
    }
    // Noise that follows the vibration has the factor as its parameter, where there is any vibration to follow.
    let prior = Prior::new(&start, &[&following()]);
    for (centre, ..) in white(&prior) {
        near(centre, 0.5);
    }
    let used: Vec<bool> = (0..AXES).map(|i| prior.used[WHITE + i]).collect();
    let shakes: Vec<bool> = (0..AXES).map(|i| start.shakes(i)).collect();
    assert_eq!(used, shakes);
    assert!(shakes[2] && !shakes[1] && !shakes[5]);
}

/// Driving is louder than standing with the engine running: twice is expected, and hardly less.
#[test]
fn driving_is_louder_than_idling() {
    let start = RestNoise {
        idle: Some([1e-3, 1e-4, 1e-3, 1e-2, 1e-3, 1e-2]),
        ..start()
    };
    let prior = Prior::new(&start, &[&steady()]);
    let expected = [
        (2e-3, 0.4),
        (1e-3, 0.8),
        (2e-3, 0.4),
        (2e-2, 0.4),
        (1e-2, 0.8),
        (2e-2, 0.4),
    ];
    for ((centre, below, above), expected) in white(&prior).into_iter().zip(expected) {
        near(centre, expected.0);
        assert_eq!((below, above), (expected.1, 1.5));
    }
}

/// Minus the logarithm of a normal density whose standard deviation is another on either side: one of them off costs ½.
#[test]
fn a_standard_deviation_off_costs_a_half_on_either_side() {
    let prior = Prior::new(&start(), &[&steady()]);
    assert_eq!(prior.penalty(&prior.centre), (0.0, [0.0; COUNT]));
    for i in 0..COUNT {
        let moved = |by: f64| {
            let mut z = prior.centre;
            z[i] += by;
            prior.penalty(&z)
        };
        for (side, std) in [(-1.0, prior.below[i]), (1.0, prior.above[i])] {
            for sigmas in [0.5, 1.0, 2.0] {
                let off = side * sigmas * std;
                let (cost, slope) = moved(off);
                // Sums of logarithms near 10 round at 1e-15.
                assert!((cost - 0.5 * sigmas * sigmas).abs() < 1e-12, "{i}: {cost}");
                // Exact of a parabola but for rounding, 1e-15 over the step.
                let difference = (moved(off + 1e-5).0 - moved(off - 1e-5).0) / 2e-5;
                assert!(
                    (slope[i] - difference).abs() < 1e-8,
                    "{i}: {} {difference}",
                    slope[i]
                );
            }
        }
        assert_eq!(prior.std(i, prior.centre[i] - 1e-3), prior.below[i]);
        assert_eq!(prior.std(i, prior.centre[i] + 1e-3), prior.above[i]);
    }
    // A vehicle that makes a sensor half as loud as expected is less likely than one that makes it twice as loud.
    let cost = |factor: f64| {
        let mut z = prior.centre;
        z[WHITE] += factor.ln();
        prior.penalty(&z).0
    };
    assert!((cost(0.5) / cost(2.0) - (1.5f64 / 0.8).powi(2)).abs() < 1e-9);
}

/// What the drives do not have is not looked for.
#[test]
fn only_what_the_drives_have_is_sought() {
    use undrift_engine::settings::fix_errors::Correlated;
    let mut settings = steady();
    settings.gnss_use = GnssUse::Position;
    let prior = Prior::new(&start(), &[&settings]);
    assert_eq!(prior.used[FIX..LASTING], [true, false]);
    assert_eq!(prior.used[LASTING..], [false; 5]);
    settings.gnss_use = GnssUse::Velocity;
    settings.constraints.non_holonomic = Some(NonHolonomic::CAR);
    settings.fix_errors.velocity_correlated = Some(Correlated {
        share: 0.5,
        time: 20.0,
    });
    let prior = Prior::new(&start(), &[&settings]);
    assert_eq!(prior.used[FIX..LASTING], [false, true]);
    assert_eq!(prior.used[LASTING..], [false, true, true, true, true]);
}
