use super::*;
use crate::tests::{Navigated, Scenario, receiver};
use undrift_nav::{filter::Outcome, parameters::Parameter};
use undrift_simulate::{GnssNoise, Trajectory};

/// An update with this NIS per degree of freedom and this whitened innovation.
fn update(nis: f64, whitened: [f64; 3]) -> Update {
    Update {
        nis: 3.0 * nis,
        dof: 3,
        whitened,
        score: 0.0,
        information: 1.5,
        outcome: Outcome::Used,
    }
}

/// Twenty updates of this NIS a block, two seconds long each, from `start` \[s\] on.
fn blocks(streak: &mut Streak, summary: &mut Summary, start: f64, nis: &[f64]) -> f64 {
    let mut time = start;
    for nis in nis {
        for _ in 0..20 {
            streak.watch(update(*nis, [0.0; 3]), time, summary);
            time += 0.1;
        }
    }
    time
}

fn streak() -> (Streak, Summary) {
    (Streak::default(), Summary::default())
}

#[test]
fn a_block_of_innovations_five_times_too_large_makes_a_solution_suspect_from_its_start_on() {
    let (mut streak, mut summary) = streak();
    blocks(&mut streak, &mut summary, 100.0, &[1.0, 24.0, 9.0, 24.9]);
    assert_eq!(summary.suspect, None);
    let end = blocks(&mut streak, &mut summary, 200.0, &[1.0, 26.0, 1.0, 900.0]);
    // The first such block is what is reported.
    assert!((summary.suspect.unwrap() - 202.0).abs() < 1e-9);
    assert!((end - 208.0).abs() < 1e-9);
    // Single wild ones are averaged: one of twenty at 400 is 20.95.
    let (mut streak, mut summary) = streak_of_singles(400.0);
    assert_eq!(summary.suspect, None);
    streak.judge(&mut summary);
    assert_eq!(summary.suspect, None);
}

fn streak_of_singles(wild: f64) -> (Streak, Summary) {
    let (mut streak, mut summary) = streak();
    for k in 0..200 {
        let nis = if k % 20 == 7 { wild } else { 1.0 };
        streak.watch(update(nis, [0.0; 3]), f64::from(k), &mut summary);
    }
    (streak, summary)
}

#[test]
fn fewer_updates_than_a_block_are_judged_at_the_end_of_the_log_and_none_are_not() {
    let (mut streak, mut summary) = streak();
    streak.judge(&mut summary);
    for k in 0..5 {
        streak.watch(update(100.0, [0.0; 3]), 7.0 + f64::from(k), &mut summary);
    }
    assert_eq!(summary.suspect, None);
    streak.judge(&mut summary);
    assert_eq!(summary.suspect, Some(7.0));
}

#[test]
fn a_sound_solution_is_sick_after_half_a_minute_beyond_its_size() {
    let (mut streak, mut summary) = streak();
    let start = blocks(&mut streak, &mut summary, 0.0, &[1.0]);
    let end = blocks(&mut streak, &mut summary, start, &[100.0; 15]);
    assert!(!streak.is_sick(start + 29.9, 0));
    assert!(streak.is_sick(start + 30.1, 0));
    // A block in between that is not begins the time afresh.
    let again = blocks(&mut streak, &mut summary, end, &[20.0]);
    assert!(!streak.is_sick(again + 100.0, 0));
    let end = blocks(&mut streak, &mut summary, again, &[100.0; 14]);
    assert!(!streak.is_sick(end, 0));
    assert!(streak.is_sick(again + 30.1, 0));
}

/// A start that failed is tried again, twice; of accuracies stated ten times too small no start is ever sound.
#[test]
fn a_solution_that_was_never_sound_is_tried_again_a_few_times() {
    for (sound, tried) in [(100.0, 2), (4.1, 2), (3.9, usize::MAX)] {
        let (mut streak, mut summary) = self::streak();
        let start = blocks(&mut streak, &mut summary, 0.0, &[sound]);
        let end = blocks(&mut streak, &mut summary, start, &[100.0; 40]);
        for restarts in [0, 1, 2, 9] {
            assert_eq!(
                streak.is_sick(end, restarts),
                restarts < tried,
                "first block {sound}, {restarts} restarts"
            );
        }
    }
}

/// Fixes of a part at 10 Hz.
struct Leaning {
    watch: LeanWatch,
    summary: Summary,
    time: f64,
}

impl Leaning {
    /// After five blocks of four seconds without a lean.
    fn new() -> Self {
        let mut leaning = Self::fresh();
        leaning.block(0.0);
        leaning.block(0.0);
        leaning.block(0.0);
        leaning.block(0.0);
        leaning.block(0.0);
        leaning
    }

    fn fresh() -> Self {
        Self {
            watch: LeanWatch::new(Part::Position),
            summary: Summary::default(),
            time: 0.0,
        }
    }

    fn fix(&mut self, east: f64) {
        self.time += 0.1;
        // Half a metre is a standard deviation.
        let innovation = Vector3::new(0.0, 0.5 * east, 0.0);
        let update = update(1.0, [0.0, east, 0.0]);
        self.watch
            .add(self.time, &innovation, &update, &mut self.summary);
    }

    /// Forty innovations that scatter by one standard deviation about `mean` standard deviations east.
    fn block(&mut self, mean: f64) {
        for k in 0..40 {
            self.fix(mean + if k % 2 == 0 { 1.0 } else { -1.0 });
        }
    }
}

#[test]
fn innovations_that_lean_to_one_side_are_an_event_with_its_span_and_size() {
    let mut leaning = Leaning::new();
    // Of n innovations of mean m, Σ² / (3 n) = n m² / 3 is to be sixty: m = √4.5 = 2.12.
    leaning.block(2.1);
    assert!(leaning.summary.leans.is_empty());
    leaning.block(0.0);
    let start = leaning.time + 0.1;
    leaning.block(2.2);
    leaning.block(-2.8);
    leaning.block(2.5);
    let end = leaning.time;
    assert!(leaning.summary.leans.is_empty(), "it goes on");
    leaning.block(0.0);
    let [lean] = leaning.summary.leans[..] else {
        panic!("{:?}", leaning.summary.leans);
    };
    assert_eq!(lean.part, Part::Position);
    assert!((lean.start - start).abs() < 1e-9 && (lean.end - end).abs() < 1e-9);
    // The largest mean of a block.
    assert!(
        (lean.mean[1] + 1.4).abs() < 1e-9 && lean.mean[0] == 0.0,
        "{lean:?}"
    );
    // Another one is an event of its own.
    leaning.block(2.5);
    leaning.block(0.0);
    assert_eq!(leaning.summary.leans.len(), 2);
}

#[test]
fn a_lean_that_lasts_to_the_end_of_the_log_is_reported() {
    let mut leaning = Leaning::new();
    leaning.block(2.5);
    leaning.watch.close(&mut leaning.summary);
    assert_eq!(leaning.summary.leans.len(), 1);
    leaning.watch.close(&mut leaning.summary);
    assert_eq!(leaning.summary.leans.len(), 1);
}

#[test]
fn large_innovations_to_both_sides_and_single_wild_ones_are_no_lean() {
    let mut leaning = Leaning::new();
    for k in 0..400 {
        leaning.fix(if k % 2 == 0 { 5.0 } else { -5.0 });
    }
    // A fifth of the fixes is wild: each counts as four standard deviations, 0.8 in the mean.
    for k in 0..400 {
        leaning.fix(if k % 5 == 0 { 100.0 } else { 0.0 });
    }
    leaning.watch.close(&mut leaning.summary);
    assert!(leaning.summary.leans.is_empty());
}

#[test]
fn a_log_that_always_leans_is_judged_by_its_own_measure() {
    // A constant offset of the solution, as of a wrong lever arm: 75 instead of 1.
    let mut leaning = Leaning::fresh();
    for _ in 0..20 {
        leaning.block(2.37);
    }
    leaning.watch.close(&mut leaning.summary);
    assert!(leaning.summary.leans.is_empty());
    // Five blocks are to be known.
    let mut early = Leaning::fresh();
    for _ in 0..4 {
        early.block(0.0);
    }
    early.block(3.0);
    early.watch.close(&mut early.summary);
    assert!(early.summary.leans.is_empty());
}

/// Positions pulled away sideways at 0.3 m/s from 30 s on, each of which passes the gate; the velocities are right.
#[test]
fn positions_that_are_pulled_away_slowly_are_reported_before_they_are_rejected() {
    let motion = Trajectory::straight(10.0, 0.0, 60.0);
    let quick = GnssNoise {
        rate_hz: 10.0,
        ..receiver()
    };
    for seed in 1..=3 {
        let sound = Scenario::new(&motion, &quick, seed);
        assert!(sound.navigate().summary.leans.is_empty(), "seed {seed}");
        let mut pulled = sound;
        for fix in &mut pulled.log.gnss {
            let east = 0.3 * (fix.time - 30.0).max(0.0);
            let (position, _) = fix.position.as_mut().unwrap();
            if let undrift_nav::sample::Position::Geodetic(place) = position {
                *place = place.displaced(&Vector3::new(0.0, east, 0.0));
            }
        }
        let summary = pulled.navigate().summary;
        let lean = summary.leans[0];
        std::println!("seed {seed}: {lean:?} {:?}", summary.contradictions);
        assert_eq!(lean.part, Part::Position);
        let rejected = summary.contradictions.first();
        assert!(rejected.is_none_or(|first| lean.start < first.start));
        assert!((30.0..46.0).contains(&lean.start), "seed {seed}: {lean:?}");
        // Predicted less measured: the solution is west of the fixes.
        assert!(lean.mean[1] < -0.5, "seed {seed}: {lean:?}");
    }
}

/// A car with fixes of centimetres whose stamps are late by `late` of their number \[s\].
fn with_stamps(late: impl Fn(usize) -> f64) -> Navigated {
    use undrift_nav::parameters::{Parameters, Prior};
    let noise = GnssNoise {
        position_std: [0.02; 3],
        ..receiver()
    };
    let mut scenario = Scenario::new(&Trajectory::car(240.0, 4), &noise, 5);
    let prior = Prior {
        walk: 6e-3,
        ..Prior::constant(0.1)
    };
    scenario.settings.parameters = Parameters::none()
        .with(Parameter::TimeOffset, prior)
        .with(Parameter::VelocityTimeOffset, prior);
    for (k, fix) in scenario.log.gnss.iter_mut().enumerate() {
        fix.time += late(k);
    }
    scenario.navigate()
}

/// Fixes that are stamped late are the receiver's delay; with stamps that are early it is the samples that are late.
#[test]
fn samples_are_late_where_fixes_are_stamped_before_they_hold() {
    for late in [0.0, 0.1] {
        let samples = with_stamps(|_| late).summary.late_samples;
        assert_eq!(samples.behind, 0, "{late}");
        assert!(samples.positions > 590);
    }
    let samples = with_stamps(|_| -0.1).summary.late_samples;
    assert!(samples.behind as f64 > 0.4 * samples.positions as f64);
    let fastest = 15.0;
    assert!(samples.most < 0.12 * fastest, "{}", samples.most);
    let (delay, std) = samples.delay;
    assert!(
        (delay - 0.1).abs() < 4.0 * std && std < 0.02,
        "{delay} {std}"
    );
}

/// Data come late: only of a slow log are samples early, and by less than an interval. One standard deviation is chance.
#[test]
fn lateness_is_what_filters_and_buffers_do() {
    use crate::estimator::ReceiverClock;
    let late = |offset, interval| {
        let clock = ReceiverClock {
            offset,
            offset_std: 0.01,
            interval,
            ..ReceiverClock::default()
        };
        clock.lateness()
    };
    assert!((late(0.1, 0.01) - 0.09).abs() < 1e-12);
    assert_eq!((late(0.009, 0.01), late(-0.1, 0.01)), (0.0, 0.0));
    assert!((late(-0.05, 0.1) + 0.04).abs() < 1e-12);
    assert_eq!((late(-0.15, 0.1), late(-0.05, 0.02)), (0.0, 0.0));
}

/// At 15 m/s north an offset known to 20 ms is 0.3 m, which a position on the receiver's clock does not have: its error is
/// that of the fixes, whatever both clocks are off by.
#[test]
fn on_the_receivers_clock_the_position_is_as_good_as_the_fixes() {
    use crate::estimator::position_std_on_receiver_clock;
    use undrift_nav::parameters::{Parameters, Prior};
    let prior = Prior::constant(1.0);
    let parameters = Parameters::none()
        .with(Parameter::TimeOffset, prior)
        .with(Parameter::ClockRate, prior);
    // Errors north δ + 15 (τ + 100 ρ), east δ, down δ: δ of 2 cm, τ of 20 ms, ρ of 0.1 ms/s.
    let clock = |i: usize| [15.0, 0.0, 0.0, 1.0, 0.0].get(i).copied().unwrap_or(0.0);
    let rate = |i: usize| [1500.0, 0.0, 0.0, 0.0, 1.0].get(i).copied().unwrap_or(0.0);
    let own = |i: usize, j: usize| if i == j && i < 3 { 4e-4 } else { 0.0 };
    let p = |i: usize, j: usize| own(i, j) + 4e-4 * clock(i) * clock(j) + 1e-8 * rate(i) * rate(j);
    let v_n = Vector3::new(15.0, 0.0, 0.0);
    for std in position_std_on_receiver_clock((&parameters, 3, 100.0), &v_n, p) {
        assert!((std - 0.02).abs() < 1e-9, "{std}");
    }
    // Without a clock they are those of the position.
    let [north, ..] = position_std_on_receiver_clock((&Parameters::none(), 3, 100.0), &v_n, p);
    assert!((north - p(0, 0).sqrt()).abs() < 1e-12);
}
