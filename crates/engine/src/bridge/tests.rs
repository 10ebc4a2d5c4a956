use super::*;
use crate::tests::{DEG, RATE, Scenario, receiver};
use alloc::vec::Vec;
use undrift_simulate::Trajectory;

const DT: f64 = 0.02;

/// A sample of `dt` \[s\] up to `time` \[s\] at a constant rate and force, as read.
fn sample(time: f64, dt: f64, rate: f64, force: f64) -> ImuSample {
    ImuSample {
        time,
        dt,
        dtheta: Vector3::new(0.0, 0.0, rate) * dt,
        dvel: Vector3::new(force, 0.0, -9.8) * dt,
    }
}

fn all(mut bridge: Bridge) -> Vec<ImuSample> {
    core::iter::from_fn(|| bridge.next()).collect()
}

#[test]
fn missing_samples_lie_on_the_line_between_those_around_them() {
    // Four are missing: rates 1 before, 2 at the end; forces 3 and −2.
    let after = sample(1.1, 5.0 * DT, 2.0, -2.0);
    let before = sample(1.0, DT, 1.0, 3.0);
    let bridge = Bridge::new(&after, Some(&before), DT, 0.2);
    assert_eq!(bridge.unknown_since, None);
    let made = all(bridge);
    assert_eq!(made.len(), 5);
    for (k, sample) in made.iter().enumerate() {
        let share = (k + 1) as f64 / 5.0;
        assert!((sample.time - (1.0 + DT * (k + 1) as f64)).abs() < 1e-12);
        assert!((sample.dt - DT).abs() < 1e-12);
        assert!((sample.dtheta.z / DT - (1.0 + share)).abs() < 1e-12);
        assert!((sample.dvel.x / DT - (3.0 - 5.0 * share)).abs() < 1e-12);
        assert!((sample.dvel.z / DT + 9.8).abs() < 1e-12);
    }
    // The last ends where the sample does, to the bit.
    assert_eq!(made[4].time, after.time);
}

#[test]
fn with_nothing_before_it_the_rates_of_the_sample_itself_are_taken() {
    let after = sample(1.0, 4.0 * DT, 0.5, 1.0);
    let made = all(Bridge::new(&after, None, DT, 0.2));
    let turn: f64 = made.iter().map(|sample| sample.dtheta.z).sum();
    assert!((turn - after.dtheta.z).abs() < 1e-12);
    assert!(
        made.iter()
            .all(|sample| (sample.dtheta.z / sample.dt - 0.5).abs() < 1e-12)
    );
}

#[test]
fn samples_are_made_of_the_usual_length_and_at_least_two() {
    let count = |dt: f64| all(Bridge::new(&sample(1.0, dt, 0.0, 0.0), None, DT, 0.2)).len();
    assert_eq!(count(3.4 * DT), 3);
    assert_eq!(count(3.6 * DT), 4);
    // Late by half an interval: there is one sample too little.
    assert_eq!(count(1.6 * DT), 2);
    assert_eq!(count(1.2 * DT), 2);
}

#[test]
fn how_far_it_has_come_is_the_end_of_the_last_one_made() {
    let mut bridge = Bridge::new(&sample(1.1, 5.0 * DT, 0.0, 0.0), None, DT, 0.2);
    assert!((bridge.reached() - 1.0).abs() < 1e-12);
    bridge.next();
    bridge.next();
    assert!((bridge.reached() - 1.04).abs() < 1e-12);
}

#[test]
fn beyond_a_fifth_of_a_second_nothing_is_known_since_the_last_sample() {
    let unknown = |dt: f64| Bridge::new(&sample(1.0, dt, 0.0, 0.0), None, DT, 0.2).unknown_since;
    assert_eq!(unknown(0.19), None);
    let since = unknown(0.21).unwrap();
    assert!((since - 0.79).abs() < 1e-12);
}

/// Takes the samples out that end after `start` and before `end` \[s\]; the next one covers the gap at its own rates, as in
/// a log.
fn cut(mut scenario: Scenario, start: f64, end: f64) -> Scenario {
    let inside = |s: &ImuSample| s.time > start + 1e-6 && s.time < end - 1e-6;
    scenario.log.imu.retain(|sample| !inside(sample));
    let mut after = scenario
        .log
        .imu
        .iter_mut()
        .skip_while(|s| s.time < end - 1e-6);
    let sample = after.next().unwrap();
    let longer = (end - start) * RATE;
    sample.dt *= longer;
    sample.dtheta *= longer;
    sample.dvel *= longer;
    scenario
}

/// A tenth of a second in the middle of a turn that begins: on a line between the rates around it.
#[test]
fn a_short_gap_costs_nothing_and_a_long_one_is_covered() {
    let mut motion = Trajectory::straight(10.0, 0.0, 40.0);
    motion.turn_rate.step_to(29.0, 2.0, 20.0 * DEG);
    for seed in 1..=3 {
        let drive = || Scenario::new(&motion, &receiver(), seed).withhold(28.0, 34.0);
        let whole = drive().navigate();
        let seen = cut(drive(), 29.9, 30.0).navigate();
        assert_eq!((seen.summary.bridged, seen.summary.long_gaps), (1, None));
        // The steepest rise is 22 deg/s², its change over the gap below 10 deg/s² : 0.1 s of that, twice, is 0.01°.
        let apart = (seen.at(34.0).error[8] - whole.at(34.0).error[8]).abs();
        assert!(apart < 0.01 * DEG, "seed {seed}: {} deg", apart / DEG);
        let std = |epoch: &crate::tests::Epoch| epoch.std[8];
        assert!((std(seen.at(34.0)) / std(whole.at(34.0)) - 1.0).abs() < 1e-3);

        let seen = cut(drive(), 29.7, 30.0).navigate();
        assert_eq!(seen.summary.bridged, 0, "a third of a second is too long");
        let seen = cut(drive(), 29.0, 31.0).navigate();
        assert_eq!(seen.summary.bridged, 0);
        let (count, start, length) = seen.summary.long_gaps.unwrap();
        assert_eq!(count, 1);
        assert!((start - 29.0).abs() < 1e-6 && (length - 2.0).abs() < 1e-6);
        let worst = seen.most(31.0, 40.0, crate::tests::Epoch::worst);
        assert!(worst < 4.0, "seed {seed}: {worst}");
    }
}

/// A fix within the gap, after one second of three: what comes before it is in the covariance then, and once only.
#[test]
fn each_part_of_a_long_gap_is_doubted_once() {
    let motion = Trajectory::straight(10.0, 0.0, 40.0);
    let drive = Scenario::new(&motion, &receiver(), 1)
        .withhold(29.0, 30.9)
        .withhold(31.1, 34.0);
    let seen = cut(drive, 30.0, 33.0).navigate();
    // Turned by 0.2 rad/s for 1 s, then for 2 s at another rate: the heading is not in the fix. 3 % of rounding.
    let expected = 0.2f64.hypot(0.4);
    let found = seen.at(33.0).std[8];
    assert!((found / expected - 1.0).abs() < 0.03, "{found} {expected}");
}

/// What a vehicle may do unseen in 3 s at 2 m/s² and 0.2 rad/s, with neither fixes nor samples.
#[test]
fn a_long_gap_adds_half_a_t_squared_to_the_position() {
    let motion = Trajectory::straight(10.0, 0.0, 40.0);
    let drive = Scenario::new(&motion, &receiver(), 1).withhold(29.0, 34.0);
    let seen = cut(drive, 30.0, 33.0).navigate();
    let (before, after) = (seen.at(30.0).std, seen.at(33.0).std);
    for axis in 0..3 {
        // Beside 9 m what the solution had before, and its velocity for 3 s, are 0.3 m: 0.1 % of the square. The
        // misalignment of a degree tilts gravity, and has done so before.
        let grown = |i: usize| (after[i].powi(2) - before[i].powi(2)).sqrt();
        assert!((grown(axis) / 9.0 - 1.0).abs() < 0.02, "{}", grown(axis));
        assert!(
            (grown(3 + axis) / 6.0 - 1.0).abs() < 0.02,
            "{}",
            grown(3 + axis)
        );
        assert!(
            (grown(6 + axis) / 0.6 - 1.0).abs() < 0.02,
            "{}",
            grown(6 + axis)
        );
    }
}
