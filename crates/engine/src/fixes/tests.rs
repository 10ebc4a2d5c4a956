//! What differences of positions say, in closed form.

use super::*;
use alloc::vec;
use undrift_nav::{
    Matrix3,
    earth::Geodetic,
    sample::{FixQuality, Position},
};

/// So many fixes a second apart whose errors grow by `step` each: differences of variance one.
fn steady(time: &[f64], step: Vector3) -> Differences<'_> {
    Differences {
        interval: 1.0,
        time,
        error: time.iter().map(|t| step * *t).collect(),
        variance: vec![Vector3::repeat(1.0); time.len()],
    }
}

fn seconds(count: usize) -> Vec<f64> {
    (0..count).map(|k| k as f64).collect()
}

/// Errors that grow steadily by this step have γ(L) = g L².
fn step_of(g: f64) -> f64 {
    (2.0 * MEDIAN * g).sqrt()
}

#[test]
fn gamma_is_half_the_mean_square_over_the_variance() {
    let time = seconds(100);
    let step = Vector3::new(3.0, 1.0, 2.0) * step_of(1e-3);
    let differences = steady(&time, step);
    for lag in [1, 2, 5] {
        let g = 1e-3 * (lag * lag) as f64;
        assert!((differences.gamma(lag, true).unwrap() / g - 1.0).abs() < 1e-9);
        // The middle one of the axes.
        assert!((differences.gamma(lag, false).unwrap() / (4.0 * g) - 1.0).abs() < 1e-9);
    }
    assert!(differences.gamma(100 - LEAST_PAIRS, true).is_some());
    assert!(differences.gamma(101 - LEAST_PAIRS, true).is_none());
    let mut louder = steady(&time, step);
    louder.variance = (0..100)
        .map(|k| Vector3::repeat(if k % 2 == 0 { 1.0 } else { 7.0 }))
        .collect();
    // The mean of both variances.
    assert!((louder.gamma(1, true).unwrap() / (1e-3 / 4.0) - 1.0).abs() < 1e-9);
}

#[test]
fn pairs_are_as_far_apart_as_their_lag() {
    // 0.6 s of slack from one to the next, 0.9 s of four.
    let time = [0.0, 1.0, 2.59, 3.59, 5.2, 5.61, 6.0];
    let differences = steady(&time, Vector3::zeros());
    let pairs: Vec<_> = differences.pairs(1).collect();
    // Of 1, 1.59 and 1, and of 0.41 s; not of 1.61 and of 0.39 s.
    assert_eq!(pairs, [(0, 1), (1, 2), (2, 3), (4, 5)]);
    let time = [0.0, 1.0, 2.0, 3.0, 4.89, 5.91];
    let differences = steady(&time, Vector3::zeros());
    assert_eq!(differences.pairs(4).collect::<Vec<_>>(), [(0, 4)]);
}

#[test]
fn a_correlation_time_is_that_at_which_a_power_law_has_grown() {
    let correlated = |g: f64, count: usize, interval: f64| {
        let time: Vec<f64> = seconds(count).iter().map(|t| t * interval).collect();
        let mut correlated = steady(&time, Vector3::repeat(step_of(g) / interval));
        correlated.interval = interval;
        correlated.correlated(correlated.gamma(1, false).unwrap(), false)
    };
    let part = 1.0 - (-1f64).exp();
    // Between lags it is found exactly: they are joined by a power of time.
    for (g, interval) in [(1e-3, 1.0), (5e-3, 1.0), (2e-3, 0.5)] {
        let grown = g + part * (1.0 - g);
        let time = interval * (grown / g).sqrt();
        let found = correlated(g, 1200, interval).unwrap();
        assert!(
            (found.time / (SOONER * time) - 1.0).abs() < 1e-9,
            "{g} {found:?}"
        );
        assert!((found.share - (1.0 - g).min(MOST_SHARE)).abs() < 1e-9);
    }
    // Ignores correlation times below five seconds.
    assert!(correlated(0.025, 600, 1.0).is_some() && correlated(0.027, 600, 1.0).is_none());
    assert_eq!(
        correlated(1e-3, 1200, 50.0).unwrap().time,
        LONGEST_CORRELATION
    );
    // Not grown by a quarter of the log, at lag 16: the time constant of an exponential follows from what has come.
    let g = 1e-3;
    let come = (256.0 * g - g) / (1.0 - g);
    let found = correlated(g, 100, 1.0).unwrap();
    let time = 16.0 / -(1f64 - come).ln();
    assert!(
        (found.time / (SOONER * time) - 1.0).abs() < 1e-9,
        "{found:?}"
    );
}

/// Fixes on a course of 30 deg that jump by `along` and `across` in turn.
fn jumping(speed: f64, along: f64, across: f64) -> f64 {
    let time = seconds(100);
    let forward = Vector3::new(0.75f64.sqrt(), 0.5, 0.0);
    let right = Vector3::new(-0.5, 0.75f64.sqrt(), 0.0);
    let mut differences = steady(&time, Vector3::zeros());
    for (k, error) in differences.error.iter_mut().enumerate() {
        let side = if k % 2 == 0 { 1.0 } else { -1.0 };
        *error = (forward * along + right * across) * side;
    }
    differences.jitter(&vec![forward * speed; 100])
}

#[test]
fn stamps_that_jitter_move_fixes_along_the_track() {
    // 2a there and back: a variance of half of that, by the median.
    let of = |along: f64, across: f64| {
        let variance = 0.5 * 4.0 * (along * along - across * across) / MEDIAN;
        variance.sqrt() / 10.0
    };
    for (along, across) in [(1.0, 0.0), (1.0, 0.49), (2.0, 0.5)] {
        let found = jumping(10.0, along, across);
        assert!((found - of(along, across)).abs() < 1e-9, "{found}");
    }
    // Twice the cross-track ones are noise; below walking pace there is no along.
    assert_eq!(jumping(10.0, 1.0, 0.51), 0.0);
    assert_eq!(jumping(2.99, 1.0, 0.0), 0.0);
    assert!(jumping(3.0, 1.0, 0.0) > 0.0);
}

#[test]
fn a_velocity_that_is_wrong_beyond_doubt_is_reported() {
    let time = seconds(100);
    let bias = |bias: Vector3, stated: f64, count: usize| {
        let differences = steady(&time[..count], -bias);
        differences.velocity_bias(&vec![Vector3::repeat(stated * stated); count])
    };
    let wrong = Vector3::new(0.3, -0.2, 0.16);
    assert!((bias(wrong, 0.1, 100) - wrong).norm() < 1e-9);
    // Half of what it states: 0.25 m/s; at least 0.15 m/s.
    assert!((bias(wrong, 0.5, 100) - Vector3::x() * 0.3).norm() < 1e-9);
    assert_eq!(bias(Vector3::repeat(0.149), 0.01, 100), Vector3::zeros());
    assert_eq!(bias(wrong, 0.1, 49), Vector3::zeros(), "39 pairs");
    assert_ne!(bias(wrong, 0.1, 50), Vector3::zeros(), "40 pairs");
}

#[test]
fn a_velocity_that_is_late_is_found_by_its_changes_and_taken_out() {
    let time = seconds(400);
    let velocity: Vec<Vector3> = time
        .iter()
        .map(|t| Vector3::new(5.0 * (t / 3.0).sin(), 4.0 * (t / 5.0).cos(), 0.0))
        .collect();
    let noise = |k: usize, axis: usize| 0.05 * ((3 * k + axis) as f64 * 78.233).sin();
    for late in [0.2, -0.1] {
        let mut differences = steady(&time, Vector3::zeros());
        for (k, error) in differences.error.iter_mut().enumerate() {
            *error = velocity[k] * late + Vector3::from_fn(|i, _| noise(k, i));
        }
        let (found, error) = differences.remove_latency(&velocity).unwrap();
        assert!(
            (found - late).abs() < 4.0 * error && error < 0.01,
            "{found} {error}"
        );
        for (k, left) in differences.error.iter().enumerate() {
            let expected = velocity[k] * (late - found) + Vector3::from_fn(|i, _| noise(k, i));
            assert!((left - expected).norm() < 1e-9);
        }
    }
    // Ignores a latency below three standard errors: no correction is applied.
    let mut differences = steady(&time, Vector3::zeros());
    for (k, error) in differences.error.iter_mut().enumerate() {
        *error = Vector3::from_fn(|i, _| noise(k, i));
    }
    let before = differences.error.clone();
    assert!(differences.remove_latency(&velocity).is_none() && differences.error == before);
}

#[test]
fn a_grid_is_the_least_step_that_others_are_multiples_of() {
    let of = |moves: &[f64]| {
        let mut at = 0.0;
        let mut written = vec![Vector3::zeros()];
        for step in moves {
            at += step;
            written.push(Vector3::new(9.0, at, 9.0));
        }
        grid(&written, 1)
    };
    let whole: Vec<f64> = (0..100).map(|k| 0.5 * f64::from(k % 4 + 1)).collect();
    assert_eq!(of(&whole), 0.5);
    assert_eq!(of(&whole[..20]), 0.5);
    assert_eq!(of(&whole[..19]), 0.0);
    // Standing still is no move.
    let still: Vec<f64> = whole.iter().flat_map(|step| [*step, 0.0]).collect();
    assert_eq!(of(&still), 0.5);
    // Two in a hundred may be off.
    let off = |count: usize| {
        let mut moves = whole.clone();
        moves[1..=count].fill(0.75);
        of(&moves)
    };
    assert_eq!((off(2), off(3)), (0.5, 0.0));
}

fn track(time: &[f64], velocity: impl Fn(f64) -> f64, place: impl Fn(f64) -> f64) -> Track {
    let at = |value: f64| Vector3::new(value, -value, 2.0 * value);
    Track {
        time: time.to_vec(),
        place: time.iter().map(|t| at(place(*t))).collect(),
        velocity: time.iter().map(|t| at(velocity(*t))).collect(),
        ..Track::default()
    }
}

#[test]
fn positions_are_taken_less_the_integral_of_the_velocities() {
    // Cubic velocities are integrated exactly but at the ends, where the trapezoidal rule has ∫ t³ too large.
    let time = seconds(12);
    let less = track(&time, |t| t.powi(3), |t| 7.0 + 0.25 * t.powi(4)).less_velocity(1.0);
    assert_eq!(less[0], Vector3::new(7.0, -7.0, 14.0));
    for k in 1..10 {
        assert!((less[k + 1] - less[k]).norm() < 1e-9, "{k}");
    }
    assert!((less[1].x - less[0].x + 0.25).abs() < 1e-9);
    // Of linear ones both rules are exact, whatever the intervals.
    let uneven = [0.0, 1.0, 2.0, 3.5, 4.5, 5.5, 6.5];
    let less = track(&uneven, |t| 2.0 * t, |t| 3.0 + t * t).less_velocity(1.0);
    for one in less {
        assert!((one.x - 3.0).abs() < 1e-9);
    }
    // Next to an uneven interval the four points are not taken.
    let less = track(&uneven, |t| t.powi(3), |t| 0.25 * t.powi(4)).less_velocity(1.0);
    for k in [1, 2, 3] {
        assert!((less[k + 1] - less[k]).norm() > 0.1, "{k}");
    }
    assert!((less[5] - less[4]).norm() < 1e-9);
}

#[test]
fn a_track_is_of_sound_fixes_in_metres() {
    let start = Geodetic::from_degrees(60.0, 7.0, 300.0);
    let fix = |k: usize, variance: f64, velocity_variance: f64| {
        let place = start.displaced(&(Vector3::new(10.0, 20.0, -30.0) * k as f64));
        GnssFix {
            attitude: None,
            mean_velocity: None,
            time: k as f64,
            position: Some((Position::Geodetic(place), Matrix3::identity() * variance)),
            velocity: Some((Vector3::x(), Matrix3::identity() * velocity_variance)),
            quality: FixQuality::Unknown,
        }
    };
    let mut without = fix(9, 1.0, 1.0);
    without.velocity = None;
    let fixes = [
        fix(0, 4.0, 0.25),
        without,
        fix(1, 0.0, 1.0),
        fix(1, f64::INFINITY, 1.0),
        fix(1, 1.0, -1.0),
        fix(2, 4.0, 0.25),
    ];
    let seen: Vec<Seen> = fixes.iter().filter_map(Seen::from_fix).collect();
    let track = Track::from_fixes(seen.iter());
    assert_eq!(track.time, [0.0, 2.0]);
    assert_eq!(track.stated[1], Vector3::repeat(4.0));
    assert_eq!(track.stated_velocity[1], Vector3::repeat(0.25));
    // From the first; on a curved Earth 40 m are straight to a millimetre.
    assert_eq!(track.place[0], Vector3::zeros());
    assert!((track.place[1] - Vector3::new(20.0, 40.0, -60.0)).norm() < 0.01);
    // A radian is some 6380 km, of longitude half of that at 60 deg.
    let metres = track.metres;
    assert!((6.3e6..6.45e6).contains(&metres.x) && metres.z == 1.0);
    assert!((metres.y / metres.x - 0.5).abs() < 0.005, "{metres}");
}

/// Positions without velocities that jump to either side in turn, which state 3 m.
fn positions(wobble: f64) -> FixStudy {
    let start = Geodetic::from_degrees(47.0, 8.0, 400.0);
    study((0..100).map(|k| {
        let time = 0.2 * f64::from(k);
        let side = if k % 2 == 0 { wobble } else { -wobble };
        let place = Vector3::new(4.0 * time + side, side, side);
        GnssFix {
            attitude: None,
            mean_velocity: None,
            time,
            position: Some((
                Position::Geodetic(start.displaced(&place)),
                Matrix3::identity() * 9.0,
            )),
            velocity: None,
            quality: FixQuality::Unknown,
        }
    }))
    .unwrap()
}

#[test]
fn what_positions_alone_do_not_scatter_by_lasts() {
    let share = |wobble: f64| positions(wobble).errors.correlated.map(|c| c.share);
    // Differences of eight times as much, over 20 variances; of χ²(1) 0.8 are below 1.642.
    let white = |wobble: f64| 64.0 * wobble * wobble / (20.0 * 1.642) / 9.0;
    let found = share(0.5).unwrap();
    assert!((found / (1.0 - white(0.5)) - 1.0).abs() < 1e-4, "{found}");
    assert_eq!(positions(0.5).errors.correlated.unwrap().time, UNSEEN_TIME);
    assert_eq!(share(0.01), Some(MOST_SHARE));
    // As white as they state, or more: nothing of it lasts.
    assert!(white(2.1) > WHITE_SHARE && share(2.1).is_none() && share(5.0).is_none());
    let study = positions(5.0);
    assert_eq!(
        (study.errors.position_factor, study.velocity_late),
        (1.0, None)
    );
    assert!((study.interval - 0.2).abs() < 1e-9 && study.errors.known);
}
