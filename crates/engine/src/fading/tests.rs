use super::*;
use crate::tests::{DEG, Epoch, RATE, Scenario, imu, receiver};
use alloc::vec::Vec;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;
use undrift_simulate::{GnssNoise, Trajectory};

fn fading() -> Fading {
    Fading::new()
}

/// An update of three components whose NIS is `times` the median of χ²(3), whitened along north.
fn update(times: f64, way: f64) -> Update {
    let nis = 3.0 * MEDIAN * times;
    Update {
        nis,
        dof: 3,
        whitened: [way * nis.sqrt(), 0.0, 0.0],
        score: 0.0,
        information: 1.5,
        outcome: Outcome::Used,
    }
}

/// The factors of `count` updates, innovations of this size by turns north and south in pairs: uncorrelated.
fn white(fading: &mut Fading, count: usize, times: f64, known: bool) -> Vec<f64> {
    let way = |k: usize| if k % 4 < 2 { 1.0 } else { -1.0 };
    (0..count)
        .map(|k| fading.factor(&update(times, way(k)), known))
        .collect()
}

/// After innovations whose mean square is that predicted.
fn settled() -> Fading {
    let mut fading = fading();
    white(&mut fading, 200, 1.0 / MEDIAN, true);
    fading
}

/// The same, all of them north: as correlated as can be.
fn correlated(fading: &mut Fading, count: usize, times: f64) -> Vec<f64> {
    (0..count)
        .map(|_| fading.factor(&update(times, 1.0), true))
        .collect()
}

fn fade(factors: &[f64]) -> usize {
    factors.iter().filter(|factor| **factor > 1.0).count()
}

#[test]
fn innovations_of_their_predicted_size_leave_the_covariance_as_it_is() {
    let mut generator = Xoshiro256PlusPlus::seed_from_u64(1);
    for known in [false, true] {
        let mut fading = fading();
        for _ in 0..20_000 {
            let whitened: [f64; 3] =
                core::array::from_fn(|_| StandardNormal.sample(&mut generator));
            let nis = whitened.iter().map(|w| w * w).sum();
            let update = Update {
                nis,
                whitened,
                ..update(1.0, 1.0)
            };
            // The median of sixteen is four times that of χ² less than once in 10⁸.
            assert_eq!(fading.factor(&update, known), 1.0);
        }
    }
}

#[test]
fn the_covariance_grows_by_what_half_of_the_last_sixteen_innovations_exceed_four_times_it() {
    // Innovations squared of five times the predicted size: five quarters. Of three: nothing. Of a hundred: by half.
    for (times, factor) in [(3.9, 1.0), (5.0, 1.25), (100.0, 1.5)] {
        let factors = white(&mut settled(), 16, times, true);
        assert_eq!(factors[..7], [1.0; 7], "seven may be outliers");
        for found in &factors[8..] {
            assert!((found - factor).abs() < 1e-12, "{times}: {found}");
        }
    }
}

#[test]
fn outliers_and_rejected_fixes_are_no_fault_of_the_solution() {
    // Seven of sixteen, however large.
    let mut fading = settled();
    for _ in 0..20 {
        assert_eq!(fade(&white(&mut fading, 7, 1e4, true)), 0);
        assert_eq!(fade(&white(&mut fading, 9, 1.0, true)), 0);
    }
    // One that is not used counts for nothing.
    let rejected = Update {
        outcome: Outcome::Rejected,
        ..update(1e4, 1.0)
    };
    for _ in 0..100 {
        assert_eq!(fading.factor(&rejected, true), 1.0);
    }
    assert_eq!(fade(&white(&mut fading, 16, 1.0, true)), 0);
    // One that is weakened is as large as it is.
    let weakened = Update {
        outcome: Outcome::Weakened(3.0),
        ..update(100.0, 1.0)
    };
    let factors: Vec<f64> = (0..16).map(|_| fading.factor(&weakened, false)).collect();
    assert!(fade(&factors) > 0);
}

#[test]
fn a_log_whose_accuracies_were_always_wrong_is_not_the_solution_s_fault() {
    // Stated three times too small, from the start.
    assert_eq!(fade(&white(&mut fading(), 500, 9.0, false)), 0);
    // Where the fixes are known to be as stated, it is the solution that is wrong, …
    assert!(fade(&white(&mut fading(), 500, 9.0, true)) > 400);
    // … unless their errors are correlated: the receiver's own.
    assert_eq!(fade(&correlated(&mut fading(), 500, 9.0)), 0);
    // A wild one among these does not hide that.
    let mut wild = fading();
    assert_eq!(fade(&correlated(&mut wild, 300, 9.0)), 0);
    wild.factor(&update(1e6, 1.0), true);
    assert_eq!(fade(&correlated(&mut wild, 300, 9.0)), 0);
    // Stated twice too large, then right.
    let mut fading = fading();
    white(&mut fading, 2000, 0.25, false);
    assert_eq!(fade(&white(&mut fading, 16, 0.99, false)), 0);
}

#[test]
fn of_the_first_forty_innovations_nothing_is_concluded() {
    let factors = white(&mut fading(), 41, 100.0, true);
    assert_eq!(fade(&factors[..39]), 0);
    assert!(factors[39] > 1.0);
}

#[test]
fn innovations_that_stay_larger_become_the_usual_ones() {
    // From 1 to 8: each step of 0.005 towards four times the usual at most, so that the usual is e^(0.015 n) until it is
    // 2, a quarter of 8, after n = ln 2 / 0.015 = 46 updates from when half of the last sixteen are large.
    let mut fading = fading();
    // Their mean is the usual size: 1.
    white(&mut fading, 1000, 1.0 / MEDIAN, false);
    let factors = white(&mut fading, 400, 8.0, false);
    let count = fade(&factors);
    let expected = 2f64.ln() / 0.015;
    assert!((count as f64 - expected).abs() < 0.35 * expected, "{count}");
    assert_eq!(fade(&factors[100..]), 0);
}

/// Half a minute of wide bends, in which the sensors' constants become known, then slow figures of eight to the end of the
/// minute: 4 m/s, 37 deg/s to either side.
fn figures_of_eight() -> Trajectory {
    let mut motion = Trajectory::straight(4.0, 0.3, 60.0);
    let mut start = 2.0;
    let mut way = 1.0;
    while start < 55.0 {
        let tight = start > 28.0;
        let (rounding, rate, hold) = if tight {
            (1.0, 37.0, 8.0)
        } else {
            (2.0, 10.0, 4.0)
        };
        start = motion.turn_rate.step_to(start, rounding, way * rate * DEG) + hold;
        way = -way;
    }
    motion
}

/// An IMU just switched on, 3 deg/s and 30 mg, and a receiver of 0.07 m/s in calm motion, which is known.
fn drive(seed: u64) -> Scenario {
    let noise = GnssNoise {
        velocity_std: [0.07; 3],
        ..receiver()
    };
    let sensors = imu([5e-3 * DEG, 3.0 * DEG], [1e-3, 0.3]);
    let mut scenario = Scenario::of(sensors, &figures_of_eight(), &noise, seed);
    scenario.settings.fix_errors.known = true;
    scenario
}

/// Velocities behind a tracking loop of this time constant \[s\].
fn lagging(mut scenario: Scenario, constant: f64) -> Scenario {
    let keep = (-1.0 / (RATE * constant)).exp();
    let mut lag = Vec::new();
    let mut slow = scenario.log.truth[0].v_n.unwrap();
    for truth in &scenario.log.truth {
        let v = truth.v_n.unwrap();
        slow = slow * keep + v * (1.0 - keep);
        lag.push(slow - v);
    }
    for fix in &mut scenario.log.gnss {
        let (v, _) = fix.velocity.as_mut().unwrap();
        *v += lag[(fix.time * RATE).round() as usize];
    }
    scenario
}

/// The same drive with the covariance left as it is.
fn unfaded(mut scenario: Scenario) -> Scenario {
    scenario.settings.gating = false;
    scenario
}

#[test]
fn a_gyro_that_really_changed_costs_less_than_half_of_what_it_does_without_fading() {
    for seed in 1..=3 {
        // By 3 deg/s in the second figure: a hundred times what it is known to.
        let faulty = || drive(seed).gyro_off(40.0, 3.0 * DEG);
        let (seen, without) = (faulty().navigate(), unfaded(faulty()).navigate());
        assert!(seen.summary.faded > 0 && without.summary.faded == 0);
        let (error, lost) = (seen.last().heading().0, without.last().heading().0);
        assert!(
            lost > 15.0 * DEG && error < 0.5 * lost,
            "seed {seed}: {error} {lost}"
        );
        // What it is in doubt about is the gyro, too: up to what it was before the first sample.
        let gyro = seen.most(40.0, 60.0, |epoch| epoch.gyro_std);
        assert!(
            gyro > 5.0 * seen.at(40.0).gyro_std && gyro < 3.1 * DEG,
            "seed {seed}: {gyro}"
        );
    }
}

#[test]
#[ignore = "not yet so: the covariance grows too late and by too little, 4 to 9° off at σ below 1°"]
#[should_panic(expected = "standard deviations")]
fn a_gyro_that_really_changed_is_covered_after_ten_seconds() {
    for seed in 1..=3 {
        let seen = drive(seed).gyro_off(40.0, 3.0 * DEG).navigate();
        let worst = seen.most(50.0, 60.0, |epoch| epoch.heading().0 / epoch.heading().1);
        assert!(worst < 4.0, "seed {seed}: {worst} standard deviations");
    }
}

#[test]
fn a_receiver_that_is_as_good_as_it_says_dissolves_nothing_in_tight_turns() {
    for seed in 1..=3 {
        let seen = drive(seed).navigate();
        assert_eq!(seen.summary.faded, 0, "seed {seed}");
        // In turns the heading becomes better known from fix to fix, and so does the gyro.
        let (before, after) = (seen.at(28.0), seen.last());
        assert!(after.heading().1 < before.heading().1 && after.gyro_std < before.gyro_std);
        let worst = seen.most(28.0, 60.0, Epoch::worst);
        assert!(worst < 4.0, "seed {seed}: {worst}");
    }
}

#[test]
#[ignore = "not yet so: the solution is doubted for what the receiver is wrong by, σ of the heading 4° and of the gyro 0.6 deg/s"]
#[should_panic(expected = "dissolved")]
fn a_receiver_that_lags_in_tight_turns_does_not_dissolve_a_right_attitude() {
    // 0.3 s behind, at 2.6 m/s²: 0.8 m/s, eleven of the standard deviations that hold in calm motion.
    for seed in 1..=3 {
        let seen = lagging(drive(seed), 0.3).navigate();
        let before = seen.at(28.0);
        let heading = seen.most(28.0, 60.0, |epoch| epoch.heading().1);
        let gyro = seen.most(28.0, 60.0, |epoch| epoch.gyro_std);
        assert!(
            heading < 2.0 * before.heading().1 && gyro < 2.0 * before.gyro_std,
            "seed {seed}: dissolved to {} deg, {} deg/s",
            heading / DEG,
            gyro / DEG
        );
    }
}
