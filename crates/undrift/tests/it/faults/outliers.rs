//! Single fixes, and a few in a row, that are far off.

use super::{Log, apart, at, drift, hurried, moved, navigate, rtk_drive, simulated};
use rand::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use undrift::nav::{Vector3, sample::GnssFix};
use undrift::replay::Aid;

fn uniform(dice: &mut Xoshiro256PlusPlus) -> f64 {
    (dice.next_u64() >> 11) as f64 / (1u64 << 53) as f64
}

#[test]
fn gross_outliers() {
    check_gross_outliers(&simulated());
}

#[test]
fn gross_outliers_on_the_real_drive() {
    if let Some(log) = rtk_drive() {
        check_gross_outliers(&log);
    }
}

fn check_gross_outliers(log: &Log) {
    let (clean, summary) = navigate(log, &log.gnss);
    let nominal = drift(log, &log.gnss, &log.settings, &log.gnss);
    println!(
        "clean: drift {nominal:.3} m; left out {}",
        summary.innovations[Aid::Position].rejected + summary.innovations[Aid::Velocity].rejected
    );
    for seed in 1..=5 {
        let mut dice = Xoshiro256PlusPlus::seed_from_u64(seed);
        let mut count = 0;
        let shown: Vec<GnssFix> = log
            .gnss
            .iter()
            .map(|fix| {
                let (hit, size) = (uniform(&mut dice) < 0.02, 20.0 + 480.0 * uniform(&mut dice));
                let way = direction(&mut dice);
                count += u32::from(hit);
                if hit { moved(fix, way * size) } else { *fix }
            })
            .collect();
        let (track, summary) = navigate(log, &shown);
        let (distance, angle, rms) = apart(&track, &clean, summary.started.unwrap());
        let drift = drift(log, &shown, &log.settings, &log.gnss);
        println!(
            "seed {seed}: {count} outliers, {} positions left out; drift {drift:.3} m; from the clean solution at most {distance:.3} m, {angle:.3} deg, RMS {rms:.4} m",
            summary.innovations[Aid::Position].rejected
        );
        assert!((drift / nominal - 1.0).abs() < 0.1, "{drift} {nominal}");
        // The rest is what fifty fixes fewer make of the latencies, at 10 m/s.
        assert!(rms < 0.06 && distance < 0.5, "{rms} {distance}");
    }
}

#[test]
fn single_jump() {
    check_single_jump(&simulated());
}

#[test]
fn single_jump_on_the_real_drive() {
    if let Some(log) = rtk_drive() {
        check_single_jump(&log);
    }
}

fn check_single_jump(log: &Log) {
    let (clean, _) = navigate(log, &log.gnss);
    for (time, way) in [
        (60.0, Vector3::x()),
        (210.0, Vector3::y()),
        (360.0, -Vector3::x()),
    ] {
        let mut shown = log.gnss.clone();
        let k = at(&shown, log.from + time);
        shown[k] = moved(&shown[k], way * 50.0);
        let (track, summary) = navigate(log, &shown);
        let (distance, angle, _) = apart(&track, &clean, shown[k].time);
        let jump = summary
            .contradictions
            .iter()
            .find(|c| c.start == shown[k].time)
            .unwrap();
        println!(
            "50 m at {time} s: moved by {distance:.4} m, {angle:.4} deg; reported {:.1} m, {} fix",
            jump.largest, jump.fixes
        );
        // After a minute the heading of the real drive is still being found: known to a degree or two.
        assert!(distance < 0.3 && angle < 0.2);
        assert!((jump.largest - 50.0).abs() < 1.0 && jump.fixes == 1);
    }
}

#[test]
fn several_jumps_in_sequence() {
    check_several_jumps_in_sequence(&simulated());
}

#[test]
fn several_jumps_in_sequence_on_the_real_drive() {
    if let Some(log) = rtk_drive() {
        check_several_jumps_in_sequence(&log);
    }
}

fn check_several_jumps_in_sequence(log: &Log) {
    let (clean, _) = navigate(log, &log.gnss);
    let mut dice = Xoshiro256PlusPlus::seed_from_u64(11);
    // Eight fixes, two seconds, wherever.
    let mut shown = log.gnss.clone();
    let k = at(&shown, log.from + 160.0);
    for fix in &mut shown[k..k + 8] {
        let way = direction(&mut dice) * (20.0 + 100.0 * uniform(&mut dice));
        *fix = moved(fix, way);
    }
    let (track, summary) = navigate(log, &shown);
    let (distance, angle, _) = apart(&track, &clean, shown[k].time);
    println!(
        "eight wild fixes: moved by {distance:.3} m, {angle:.3} deg; {:?}",
        summary.contradictions
    );
    assert!(distance < 0.3 && angle < 0.5);

    // Five seconds 30 m to the north-east: multipath, or a wrong ambiguity.
    let mut shown = log.gnss.clone();
    for fix in &mut shown[k..k + 20] {
        *fix = moved(fix, Vector3::new(20.0, 20.0, 10.0));
    }
    let (track, summary) = navigate(log, &shown);
    let (distance, angle, _) = apart(&track, &clean, shown[k].time);
    println!(
        "5 s at 30 m: moved by {distance:.3} m, {angle:.3} deg; {:?}",
        summary.contradictions
    );
    assert!(distance < 0.5 && angle < 0.5);
    assert!(
        summary
            .contradictions
            .iter()
            .any(|c| c.fixes == 20 && !c.accepted_in_the_end)
    );
}

#[test]
fn outliers_of_velocity() {
    check_outliers_of_velocity(&simulated());
}

#[test]
fn outliers_of_velocity_on_the_real_drive() {
    if let Some(log) = rtk_drive() {
        check_outliers_of_velocity(&log);
    }
}

fn check_outliers_of_velocity(log: &Log) {
    let (clean, _) = navigate(log, &log.gnss);
    let nominal = drift(log, &log.gnss, &log.settings, &log.gnss);
    let mut dice = Xoshiro256PlusPlus::seed_from_u64(3);
    let shown: Vec<GnssFix> = log
        .gnss
        .iter()
        .map(|fix| {
            let (hit, size) = (uniform(&mut dice) < 0.02, 2.0 + 28.0 * uniform(&mut dice));
            let way = direction(&mut dice);
            if hit { hurried(fix, way * size) } else { *fix }
        })
        .collect();
    let (track, summary) = navigate(log, &shown);
    let (distance, angle, rms) = apart(&track, &clean, summary.started.unwrap());
    let drift = drift(log, &shown, &log.settings, &log.gnss);
    println!(
        "velocity outliers: {} left out; drift {drift:.3} m; at most {distance:.3} m, {angle:.3} deg, RMS {rms:.4} m",
        summary.innovations[Aid::Velocity].rejected
    );
    assert!((drift / nominal - 1.0).abs() < 0.1, "{drift} {nominal}");
    assert!(rms < 0.02);
}

#[test]
fn outlier_as_the_first_fix_after_an_outage() {
    check_outlier_as_the_first_fix_after_an_outage(&simulated());
}

#[test]
fn outlier_as_the_first_fix_after_an_outage_on_the_real_drive() {
    if let Some(log) = rtk_drive() {
        check_outlier_as_the_first_fix_after_an_outage(&log);
    }
}

fn check_outlier_as_the_first_fix_after_an_outage(log: &Log) {
    for (length, size) in [(10.0, 50.0), (10.0, 20.0), (30.0, 100.0), (30.0, 20.0)] {
        let (mut clean, mut shown) = (log.gnss.clone(), log.gnss.clone());
        let start = log.from + 160.0;
        let (from, to) = (at(&clean, start), at(&clean, start + length));
        shown[to] = moved(&shown[to], Vector3::new(size, 0.0, 0.0));
        clean.drain(from..to);
        shown.drain(from..to);
        let end = clean[from].time;
        let (reference, _) = navigate(log, &clean);
        let (track, summary) = navigate(log, &shown);
        let (distance, _, _) = apart(&track, &reference, end);
        let (later, angle, _) = apart(&track, &reference, end + 5.0);
        println!(
            "{size} m after {length} s without: at most {distance:.2} m apart, {later:.3} m and {angle:.3} deg after 5 s; {:?}",
            summary.contradictions
        );
        assert!(later < 0.3 && angle < 1.0);
    }
}

#[test]
fn outlier_during_alignment() {
    check_outlier_during_alignment(&simulated());
}

#[test]
fn outlier_during_alignment_on_the_real_drive() {
    if let Some(log) = rtk_drive() {
        check_outlier_during_alignment(&log);
    }
}

fn check_outlier_during_alignment(log: &Log) {
    let (clean, summary) = navigate(log, &log.gnss);
    let started = summary.started.unwrap();
    // The fix that completes the alignment, and one before it.
    let last = log
        .gnss
        .iter()
        .position(|f| f.time >= started - 1e-6)
        .unwrap();
    for k in [last, last - 1, last - 20] {
        let mut shown = log.gnss.clone();
        shown[k] = moved(&shown[k], Vector3::new(30.0, 40.0, 0.0));
        let (track, summary) = navigate(log, &shown);
        let (later, angle, _) = apart(&track, &clean, started + 10.0);
        println!(
            "50 m off at fix {} of {last}: after 10 s {later:.3} m, {angle:.3} deg; {:?}",
            k, summary.contradictions
        );
        assert!(later < 0.3 && angle < 2.0);
    }
}

/// Of any direction, uniform on the sphere.
fn direction(dice: &mut Xoshiro256PlusPlus) -> Vector3 {
    let z = 2.0 * uniform(dice) - 1.0;
    let azimuth = std::f64::consts::TAU * uniform(dice);
    let level = (1.0 - z * z).sqrt();
    Vector3::new(level * azimuth.cos(), level * azimuth.sin(), z)
}
