//! Which part of a record is used.

use super::*;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;

const RATE: f64 = 50.0;
const DEG: f64 = std::f64::consts::PI / 180.0;

/// Half an hour of six axes [rad/s, m/s²] with the white noise of a cheap sensor and random walks, seed 1, to which
/// `add` adds what it likes at a time \[s\].
fn record(add: impl Fn(usize, f64) -> f64) -> Record {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
    let mut normal = move || -> f64 { StandardNormal.sample(&mut random) };
    let mut level = [0.02, -0.05, 0.01, 0.1, -0.2, -9.7];
    let mut samples = vec![Vec::new(); 6];
    for k in 0..90_000 {
        for (axis, level) in level.iter_mut().enumerate() {
            // 0.005 deg/s/√Hz and 120 µg/√Hz, walks of a hundredth of that a second.
            let density = if axis < 3 { 0.005 * DEG } else { 0.0012 };
            *level += 0.01 * density * normal() / RATE.sqrt();
            let noise = density * RATE.sqrt() * normal();
            samples[axis].push(*level + noise + add(axis, f64::from(k) / RATE));
        }
    }
    Record {
        axes: undrift_noise::model_file::AXES.to_vec(),
        samples,
        units: Some(("rad/s".into(), "m/s^2".into())),
        ..Record::default()
    }
}

/// Span used \[s\] and what is left out of a record.
fn found(record: &Record) -> ((f64, f64), Vec<Omitted>) {
    let part = part_at_rest(record, RATE).unwrap();
    let seconds = |samples: usize| samples as f64 / RATE;
    (
        (seconds(part.used.start), seconds(part.used.end)),
        part.left_out,
    )
}

fn in_hand(axis: usize, t: f64) -> f64 {
    let size = if axis < 3 { 0.7 } else { 2.0 };
    size * (3.0 * t + axis as f64).sin() + 0.5 * size * (17.0 * t).sin()
}

#[test]
fn what_lies_still_is_used_whole() {
    assert_eq!(found(&record(|_, _| 0.0)), ((0.0, 1800.0), Vec::new()));
    // A warm-up of 0.5 deg/s and 20 mg in ten minutes is no step.
    let warm = record(|axis, t| (if axis < 3 { 0.5 * DEG } else { 0.2 }) * (-t / 600.0).exp());
    assert_eq!(found(&warm), ((0.0, 1800.0), Vec::new()));
    // Nor is an outlier anything.
    let outlier = record(|_, t| if t == 900.0 { 10.0 } else { 0.0 });
    assert_eq!(found(&outlier), ((0.0, 1800.0), Vec::new()));
}

#[test]
fn the_seconds_in_the_hand_are_left_out() {
    for (from, to) in [(4.5, 1800.0), (0.0, 1795.5), (25.0, 1790.0)] {
        let handled = record(|axis, t| match (from..to).contains(&t) {
            true => 0.0,
            false => in_hand(axis, t),
        });
        let ((start, end), left_out) = found(&handled);
        // All of it, and two seconds more at most.
        let near = |cut: f64| (0.0..=3.0).contains(&cut);
        assert!(near(start - from) && near(to - end), "{start} {end}");
        assert!(left_out.iter().all(|part| part.why == Omission::Handled));
    }
    // Most of it in the hand is no static record; the error gives the rest.
    let mostly = record(|axis, t| if t < 1000.0 { in_hand(axis, t) } else { 0.0 });
    let Err(NotStatic::Moving { rest, .. }) = part_at_rest(&mostly, RATE) else {
        panic!("not refused");
    };
    let (start, end) = rest.unwrap();
    assert!((1000.0..1004.0).contains(&start) && end == 1800.0);
}

#[test]
fn a_step_ends_the_part_that_is_used() {
    // A gyro that re-zeroes, 0.05 deg/s; a tilt of 0.2 and of 3 degrees within two seconds.
    let zero = |axis: usize, t: f64| {
        if axis == 1 && t >= 600.0 {
            0.05 * DEG
        } else {
            0.0
        }
    };
    let tilt = |size: f64| {
        move |axis: usize, t: f64| match axis {
            3 => 9.8 * size * DEG * ((t - 600.0) / 2.0).clamp(0.0, 1.0),
            4 if (600.0..602.0).contains(&t) => 0.5 * size * DEG,
            _ => 0.0,
        }
    };
    let cases = [
        ("gyro_y", 0.05 * DEG, record(zero)),
        ("accel_x", 9.8 * 0.2 * DEG, record(tilt(0.2))),
        ("accel_x", 9.8 * 3.0 * DEG, record(tilt(3.0))),
    ];
    for (axis, size, record) in cases {
        let ((start, end), left_out) = found(&record);
        assert!((600.0..=604.0).contains(&start) && end == 1800.0, "{start}");
        let steps = left_out.iter().filter(|part| part.why == Omission::Step);
        let steps: Vec<&Omitted> = steps.collect();
        assert_eq!(steps.len(), 1, "{left_out:?}");
        assert_eq!(steps[0].axis.as_deref(), Some(axis));
        assert!((steps[0].step.0 / size - 1.0).abs() < 0.2, "{:?}", steps[0]);
    }
}

#[test]
fn a_bump_is_cut_out_of_the_middle() {
    let bump = record(|axis, t| match (900.2..901.5).contains(&t) {
        true => in_hand(axis, 40.0 * t),
        false => 0.0,
    });
    let part = part_at_rest(&bump, RATE).unwrap();
    assert_eq!(part.used, 0..90_000);
    assert_eq!(part.bumps.len(), 1);
    assert_eq!(part.bumps[0], 45_000..45_100);
    assert_eq!(part.left_out[0].why, Omission::Bump);
}

#[test]
fn of_two_sessions_the_longer_is_used() {
    // The stamps restart after ten minutes, or an hour is between.
    for second in [0.0, 4200.0] {
        let mut record = record(|_, _| 0.0);
        let stamp = |k: u32| {
            let t = f64::from(k) / RATE;
            if t < 600.0 { t } else { t - 600.0 + second }
        };
        record.stamps = (0..90_000).map(stamp).collect();
        record.timing = undrift_noise::screening::timing(&record.stamps).ok();
        let ((start, end), left_out) = found(&record.with_gaps());
        assert_eq!((start, end), (600.0, 1800.0));
        assert_eq!(left_out.len(), 1);
        assert_eq!(left_out[0].why, Omission::Session);
    }
}
