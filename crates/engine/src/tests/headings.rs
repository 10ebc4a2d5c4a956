//! Two antennas: the start at rest, wrong numbers of wavelengths, antennas that lie otherwise than stated.

use super::{DEG, Navigated, Scenario, imu, receiver, rest_then_turns};
use crate::align::{AttitudeSource, HeadingSource};
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use undrift_nav::{
    earth::wrap_pi,
    parameters::{Parameter, Parameters, Prior},
};
use undrift_simulate::{DualAntenna, Trajectory};

/// An IMU just switched on, 0.3 deg/s and 30 mg; antennas of half a metre, 0.3° and 5 % wrong, the second on the right, at
/// `off` \[rad\] from where it is said to be to `std` \[rad\].
fn scenario(motion: &Trajectory, seed: u64, off: f64, std: f64) -> Scenario {
    let sensors = imu([5e-3 * DEG, 0.3 * DEG], [1e-3, 0.3]);
    let mut scenario = Scenario::of(sensors, motion, &receiver(), seed);
    let antennas = DualAntenna {
        baseline: 90.0 * DEG + off,
        wrong: 0.05,
        ..DualAntenna::default()
    };
    scenario.headings = antennas.measure(motion, seed).unwrap().collect();
    scenario.settings.align.attitude = None;
    scenario.settings.constraints.heading_baseline = 90.0 * DEG;
    if std > 0.0 {
        let prior = Prior::constant(std);
        scenario.settings.parameters = Parameters::none().with(Parameter::HeadingOffset, prior);
    }
    scenario
}

/// A number that is one of the standard normal ones, by the normal's quantiles, shuffled.
fn normal(seed: u64, of: u64) -> f64 {
    let share = ((seed * 37 % of) as f64 + 0.5) / of as f64;
    // Winitzki's inverse of the error function: to 0.002.
    let x = 2.0 * share - 1.0;
    let (l, a) = ((1.0 - x * x).ln(), 0.147);
    let m = 2.0 / (core::f64::consts::PI * a) + 0.5 * l;
    (2.0 * ((m * m - l / a).sqrt() - m)).sqrt() * x.signum()
}

fn nees(seen: &Navigated, time: f64) -> f64 {
    let (error, std) = seen.at(time).heading();
    (error / std).powi(2)
}

/// With antennas known exactly what is doubted of the gyros at rest makes σ somewhat too large; with those known to 1° both are.
#[test]
fn at_rest_the_first_heading_comes_within_five_seconds_and_is_honest() {
    const SEEDS: u64 = 200;
    for (std, least) in [(0.0, 0.6), (1.0 * DEG, 0.8)] {
        let (mut in_time, mut sums, mut worst) = (0, [0.0; 4], 0.0_f64);
        for seed in 0..SEEDS {
            let mut motion = Trajectory::rest(30.0);
            motion.course = seed as f64;
            let seen = scenario(&motion, seed, std * normal(seed, SEEDS), std).navigate();
            let AttitudeSource::Rest { heading, .. } = seen.summary.alignment.unwrap().source
            else {
                panic!("seed {seed}")
            };
            assert_eq!(heading, HeadingSource::Antennas);
            let started = seen.summary.started.unwrap();
            in_time += u64::from(started <= 5.0);
            for (sum, time) in sums.iter_mut().zip([started + 0.1, 8.0, 15.0, 29.0]) {
                let of = nees(&seen, time);
                (*sum, worst) = (*sum + of / SEEDS as f64, worst.max(of));
            }
        }
        let mean = sums.iter().sum::<f64>() / 4.0;
        std::println!(
            "antennas known to {:.0} deg: {in_time} of {SEEDS} start within 5 s; NEES of the heading {mean:.2} ({sums:.2?} at the start, 8, 15, 29 s), at most {worst:.1}",
            std / DEG
        );
        assert!(in_time * 100 > 99 * SEEDS && (least..1.25).contains(&mean) && worst < 20.0);
    }
}

/// Drives of a minute after half a minute at rest, then turns: with 180° for half a minute in between.
#[test]
fn half_a_minute_of_wrong_headings_harms_nothing() {
    const SEEDS: u64 = 20;
    let (mut sums, mut count) = ([0.0; 2], 0.0);
    for seed in 0..SEEDS {
        let motion = rest_then_turns(seed);
        let off = 1.0 * DEG * normal(seed, SEEDS);
        let mut scenario = scenario(&motion, seed, off, 1.0 * DEG);
        let sound = scenario.navigate();
        let within = |time: f64| (100.0..130.0).contains(&time);
        for heading in scenario.headings.iter_mut().filter(|h| within(h.time)) {
            heading.value = wrap_pi(heading.value + 180.0 * DEG);
        }
        let seen = scenario.navigate();
        let rejected = &seen.summary.rejected_headings;
        let most = rejected.iter().max_by_key(|run| run.headings).unwrap();
        assert!(
            (25..=30).contains(&most.headings),
            "seed {seed}: {rejected:?}"
        );
        assert!(most.angle.abs() > 170.0 * DEG && !most.accepted_in_the_end);
        assert!(seen.summary.restarts.is_empty() && seen.summary.heading_off.is_empty());
        for time in (40..180).step_by(10).map(f64::from) {
            let both = [&sound, &seen].map(|seen| nees(seen, time));
            assert!(both[1] < 16.0, "seed {seed}, {time} s: {both:?}");
            sums = [sums[0] + both[0], sums[1] + both[1]];
            count += 1.0;
        }
    }
    let [sound, wrong] = sums.map(|sum| sum / count);
    std::println!(
        "in motion NEES of the heading {sound:.2}, with half a minute of 180 deg {wrong:.2}"
    );
    assert!((0.8..1.25).contains(&sound) && (0.8..1.25).contains(&wrong));
}

/// Antennas of which nothing is known say nothing at rest; in motion it is found where they are.
#[test]
fn where_the_antennas_are_is_found_in_motion() {
    for seed in 1..=4 {
        let mut motion = Trajectory::rest(90.0);
        motion.speed.step_to(20.0, 8.0, 12.0);
        motion.turn_rate.step_to(40.0, 2.0, 0.15);
        let truth = 2.5 * seed as f64;
        let mut scenario = scenario(&motion, seed, truth, 1.8);
        scenario.settings.constraints.heading_baseline = 0.0;
        let seen = scenario.navigate();
        assert!(seen.summary.started.unwrap() > 20.0);
        let (_, offset, std) = &seen.summary.parameters[0];
        let error = wrap_pi(offset[0] - truth - 90.0 * DEG);
        assert!(
            error.abs() < 4.0 * std[0] && std[0] < 1.0 * DEG,
            "seed {seed}: {error} {std:?}"
        );
        assert!(seen.last().worst() < 4.0);
    }
}

/// Antennas that are said to be where they are not: after a minute of motion it is their place that is doubted.
#[test]
fn antennas_the_other_way_round_are_found_in_motion() {
    let mut motion = Trajectory::rest(240.0);
    motion.speed.step_to(5.0, 8.0, 12.0);
    motion.turn_rate.step_to(40.0, 2.0, 0.15);
    let mut scenario = scenario(&motion, 3, 180.0 * DEG, 1.0 * DEG);
    scenario.headings.retain(|heading| heading.time > 20.0);
    let seen = scenario.navigate();
    let rejected = seen.summary.rejected_headings.last().unwrap();
    assert!(
        rejected.accepted_in_the_end && rejected.end < 90.0,
        "{rejected:?}"
    );
    let (_, offset, std) = &seen.summary.parameters[0];
    assert!(wrap_pi(offset[0] - 180.0 * DEG).abs() < 4.0 * std[0]);
    assert!(seen.last().worst() < 4.0);
}

/// A start by headings that all were wrong: at rest their successors are believed after a minute.
#[test]
fn a_start_by_wrong_headings_is_mended() {
    let mut scenario = scenario(&Trajectory::rest(120.0), 5, 0.0, 0.0);
    for heading in scenario.headings.iter_mut().filter(|h| h.time < 15.0) {
        heading.value = wrap_pi(heading.value + 60.0 * DEG);
    }
    let seen = scenario.navigate();
    assert!(seen.at(60.0).heading().0 > 50.0 * DEG);
    assert!(seen.most(90.0, 120.0, |epoch| epoch.heading().0 / epoch.heading().1) < 4.0);
    assert!(seen.last().heading().1 < 0.3 * DEG);
}
