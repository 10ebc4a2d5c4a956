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
    // An outlier is nothing.
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
        // The omitted spans reach from the ends of the record to the part that is used.
        let spans = left_out.iter().map(|part| (part.start_s.0, part.end_s.0));
        let ends = [(0.0, start), (end, 1800.0)];
        let ends = ends.into_iter().filter(|(from, to)| to > from);
        assert!(spans.eq(ends), "{left_out:?}");
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
    // With a second to either side.
    assert_eq!(part.bumps[0], 44_950..45_150);
    let [left_out] = &part.left_out[..] else {
        panic!("{:?}", part.left_out);
    };
    assert_eq!(left_out.why, Omission::Bump);
    assert_eq!((left_out.start_s.0, left_out.end_s.0), (899.0, 903.0));
}

/// The mean of an axis between two times \[s\] after its first sample.
fn mean(samples: &[f64], from: f64, to: f64) -> f64 {
    let part = &samples[(from * RATE) as usize..(to * RATE) as usize];
    part.iter().sum::<f64>() / part.len() as f64
}

#[test]
fn a_warm_up_is_cut_off_and_what_is_left_of_it_subtracted() {
    // 0.5 deg/s and 20 mg in ten minutes, which is no step.
    let warm = record(|axis, t| (if axis < 3 { 0.5 * DEG } else { 0.2 }) * (-t / 600.0).exp());
    let part = part_at_rest(&warm, RATE).unwrap();
    assert_eq!(part.used, 45_000..90_000);
    let cut = &part.left_out[0];
    assert_eq!(
        (cut.why, cut.start_s.0, cut.end_s.0),
        (Omission::WarmUp, 0.0, 900.0)
    );
    let rest = part
        .left_out
        .iter()
        .filter(|one| one.why == Omission::WarmUpRest);
    assert_eq!(rest.count(), 6);
    let mut samples = warm.samples.clone();
    for samples in &mut samples {
        samples.drain(..part.used.start);
    }
    for one in &part.subtracted {
        one.subtract_from(&mut samples);
    }
    // 0.08 deg/s and 3 mg were left; of that no more than the walks do, 0.0015 deg/s and 0.04 mg.
    for (axis, samples) in samples.iter().enumerate() {
        let change = mean(samples, 0.0, 60.0) - mean(samples, 840.0, 900.0);
        let limit = if axis < 3 { 0.006 * DEG } else { 0.0015 };
        assert!(change.abs() < limit, "{axis}: {change}");
    }
    // One that is short costs little: a minute of half an hour.
    let short = record(|axis, t| {
        if axis == 2 {
            0.05 * DEG * (-t / 20.0).exp()
        } else {
            0.0
        }
    });
    let part = part_at_rest(&short, RATE).unwrap();
    assert!(
        (2_000..12_000).contains(&part.used.start),
        "{:?}",
        part.used
    );
    assert_eq!(part.left_out[0].axis.as_deref(), Some("gyro_z"));
    assert_eq!(part.subtracted.len(), 1);
    // What the temperature explains is not a warm-up.
    let mut explained = warm;
    explained.temperature = Some(
        (0..90_000)
            .map(|k| 40.0 - 15.0 * (-f64::from(k) / RATE / 600.0).exp())
            .collect(),
    );
    assert_eq!(found(&explained), ((0.0, 1800.0), Vec::new()));
}

#[test]
fn a_slow_cycle_is_subtracted() {
    let swing = |t: f64| 0.02 * DEG * (t / 130.0).sin();
    let cycle = record(|axis, t| if axis == 0 { swing(t) } else { 0.0 });
    let part = part_at_rest(&cycle, RATE).unwrap();
    assert_eq!(part.used, 0..90_000);
    let [one] = &part.left_out[..] else {
        panic!("{:?}", part.left_out);
    };
    assert_eq!(
        (one.why, one.axis.as_deref()),
        (Omission::Cycle, Some("gyro_x"))
    );
    assert!((one.step.0 / (0.02 * DEG) - 1.0).abs() < 0.1, "{one:?}");
    let period = 130.0 * std::f64::consts::TAU;
    assert!((one.time_s.0 / period - 1.0).abs() < 0.05, "{one:?}");
    let mut samples = cycle.samples.clone();
    part.subtracted[0].subtract_from(&mut samples);
    let quiet = record(|_, _| 0.0).samples;
    for at in [0.0, 150.0, 600.0, 1700.0] {
        let left = mean(&samples[0], at, at + 60.0) - mean(&quiet[0], at, at + 60.0);
        let constant = mean(&samples[0], 0.0, 1800.0) - mean(&quiet[0], 0.0, 1800.0);
        assert!((left - constant).abs() < 0.003 * DEG, "{at}: {left}");
    }
}

#[test]
fn small_steps_and_many_are_found_by_the_whole_of_the_level() {
    // Twice what a second's mean scatters by.
    let small = record(|axis, t| {
        if axis == 1 && t >= 600.0 {
            0.01 * DEG
        } else {
            0.0
        }
    });
    let ((start, end), left_out) = found(&small);
    assert!((600.0..=610.0).contains(&start) && end == 1800.0, "{start}");
    assert_eq!((left_out.len(), left_out[0].start_s.0), (1, 0.0));
    // A gyro that re-zeroes every five minutes.
    let levels = [0.0, 0.08, -0.03, 0.05, -0.06, 0.02];
    let many = record(|axis, t| {
        if axis == 1 {
            levels[(t / 300.0) as usize] * DEG
        } else {
            0.0
        }
    });
    let ((start, end), left_out) = found(&many);
    assert!(end - start > 285.0 && end - start <= 300.0, "{start} {end}");
    assert_eq!(left_out.len(), 5, "{left_out:?}");
}

#[test]
fn a_gentle_swing_is_a_bump() {
    // Half a sine of three seconds, 0.3 deg/s: less than motion, sixty times what a second's mean scatters by.
    let at = |middle: f64| {
        record(move |axis, t| match (t - middle).abs() < 1.5 && axis == 2 {
            true => 0.3 * DEG * ((t - middle) * std::f64::consts::PI / 3.0).cos(),
            false => 0.0,
        })
    };
    let part = part_at_rest(&at(900.5), RATE).unwrap();
    assert_eq!(part.used, 0..90_000);
    // And a second to either side.
    assert_eq!((part.bumps.len(), &part.bumps[0]), (1, &(44_900..45_150)));
    assert_eq!(part.left_out[0].why, Omission::Bump);
    for (middle, used) in [(1.5, (5.0, 1800.0)), (1798.5, (0.0, 1795.0))] {
        let (span, left_out) = found(&at(middle));
        assert_eq!((span, left_out[0].why), (used, Omission::Handled));
    }
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

#[test]
fn a_part_rests_where_half_of_its_windows_do() {
    assert!(mostly(5, 10) && mostly(10, 10) && mostly(4, 7) && mostly(0, 0));
    assert!(!mostly(4, 10) && !mostly(1, 10) && !mostly(3, 7));
}
