//! A receiver that is pulled away, frozen, wrong about its accuracy or about a sign.

use super::{Log, apart, at, drift, hurried, moved, navigate, navigate_with, rtk_drive, simulated};
use undrift::{
    nav::{Vector3, sample::GnssFix},
    replay::{Aid, Settings, Summary},
};

/// Right of the direction of travel, as a horizontal unit vector.
fn sideways(fix: &GnssFix) -> Vector3 {
    let v = fix.velocity.unwrap().0;
    Vector3::new(-v.y, v.x, 0.0).normalize()
}

/// A minute in which the position is pulled away sideways at 0.5 m/s, then left there.
fn spoofed(log: &Log, velocity_follows: bool, smooth: f64) -> Vec<GnssFix> {
    let first = &log.gnss[at(&log.gnss, log.from + 160.0)];
    let (start, way) = (first.time, sideways(first));
    log.gnss
        .iter()
        .map(|fix| {
            let since = fix.time - start;
            let ramp = |t: f64| {
                let t = t.clamp(0.0, 60.0);
                if smooth > 0.0 && t < smooth {
                    (0.5 * 0.5 * t * t / smooth, 0.5 * t / smooth)
                } else {
                    (0.5 * (t - 0.5 * smooth), 0.5)
                }
            };
            let (offset, speed) = ramp(since);
            let fix = moved(fix, way * if since > 0.0 { offset } else { 0.0 });
            if velocity_follows && since > 0.0 && since < 60.0 {
                hurried(&fix, way * speed)
            } else {
                fix
            }
        })
        .collect()
}

#[test]
fn slow_spoofing_is_reported() {
    check_slow_spoofing_is_reported(&simulated());
}

#[test]
fn slow_spoofing_is_reported_on_the_real_drive() {
    if let Some(log) = rtk_drive() {
        check_slow_spoofing_is_reported(&log);
    }
}

fn check_slow_spoofing_is_reported(log: &Log) {
    for (velocity_follows, smooth) in [(false, 0.0), (true, 0.0), (false, 10.0), (true, 10.0)] {
        let shown = spoofed(log, velocity_follows, smooth);
        let (_, summary) = navigate(log, &shown);
        println!("velocity follows: {velocity_follows}, smooth over {smooth} s:");
        for c in &summary.contradictions {
            println!("  {c:?}");
        }
        for c in &summary.heading_off {
            println!("  {c:?}");
        }
        for c in &summary.leans {
            println!("  {c:?}");
        }
        let start = shown[at(&shown, log.from + 160.0)].time;
        let during = |from: f64, to: f64| to > start && from < start + 60.0;
        let left_out = summary
            .contradictions
            .iter()
            .find(|c| during(c.start, c.end));
        let lean = summary.leans.iter().find(|c| during(c.start, c.end));
        match (velocity_follows, smooth > 0.0) {
            // At once, with its speed.
            (false, false) => assert!(left_out.is_some_and(|c| (c.growth - 0.5).abs() < 0.1)),
            // The step of the velocity at its beginning, at once.
            (true, false) => assert!(left_out.is_some_and(|c| c.start < start + 1.0)),
            // Each fix passes, all of them to one side.
            (false, true) => assert!(lean.is_some()),
            // 0.05 m/s² is within what the accelerometers may err: only the course shows it, or the sudden end.
            (true, true) => {
                let mut ends = summary.contradictions.iter();
                let course = summary.heading_off.iter().any(|h| during(h.start, h.end));
                assert!(course || ends.any(|c| c.start > start + 59.0));
            }
        }
    }
}

/// The fixes with standard deviations multiplied by `factor`.
fn stated(gnss: &[GnssFix], factor: f64) -> Vec<GnssFix> {
    let variance = factor * factor;
    gnss.iter()
        .map(|fix| GnssFix {
            position: fix.position.map(|(p, r)| (p, r * variance)),
            velocity: fix.velocity.map(|(v, r)| (v, r * variance)),
            ..*fix
        })
        .collect()
}

#[test]
fn wrong_accuracies_are_found() {
    check_wrong_accuracies_are_found(&simulated());
}

#[test]
fn wrong_accuracies_are_found_on_the_real_drive() {
    if let Some(log) = rtk_drive() {
        check_wrong_accuracies_are_found(&log);
    }
}

fn check_wrong_accuracies_are_found(log: &Log) {
    let adaptive = Settings {
        adapt: true,
        ..log.settings.clone()
    };
    let nominal = drift(log, &log.gnss, &log.settings, &log.gnss);
    let (_, summary) = navigate_with(log, &log.gnss, &adaptive);
    let own = summary.adapted.map(Option::unwrap);
    println!("as stated: drift {nominal:.3} m; factors found {own:.3?}");
    for factor in [0.15, 1.0, 7.0] {
        let shown = stated(&log.gnss, factor);
        let (_, plain) = navigate(log, &shown);
        let (_, summary) = navigate_with(log, &shown, &adaptive);
        let found = summary.adapted.map(Option::unwrap);
        let (before, after) = (
            drift(log, &shown, &log.settings, &log.gnss),
            drift(log, &shown, &adaptive, &log.gnss),
        );
        let nis = |s: &Summary| {
            [
                s.innovations[Aid::Position].per_dof().unwrap(),
                s.innovations[Aid::Velocity].per_dof().unwrap(),
            ]
        };
        println!(
            "stated times {factor}: NIS {:.3?}, adapted {:.3?}; factors found {found:.3?}; drift {before:.3} m, adapted {after:.3} m",
            nis(&plain),
            nis(&summary),
        );
        for (found, own) in found.into_iter().zip(own) {
            let ratio = found * factor / own;
            assert!((1.0 / 1.3..1.3).contains(&ratio), "{ratio}");
        }
        assert!((after / nominal - 1.0).abs() < 0.1, "{after} {nominal}");
        assert!(nis(&summary).iter().all(|r| (0.7..1.4).contains(r)));
    }
}

#[test]
fn a_frozen_receiver_is_not_believed() {
    check_a_frozen_receiver_is_not_believed(&simulated());
}

#[test]
fn a_frozen_receiver_is_not_believed_on_the_real_drive() {
    if let Some(log) = rtk_drive() {
        check_a_frozen_receiver_is_not_believed(&log);
    }
}

fn check_a_frozen_receiver_is_not_believed(log: &Log) {
    let (clean, _) = navigate(log, &log.gnss);
    // In motion; and standing at a light, where the start is at first no more than an odd acceleration.
    for (when, keeps_velocity) in [(80.0, false), (80.0, true), (160.0, false)] {
        let when = log.from + when;
        let mut shown = log.gnss.clone();
        let (from, to) = (at(&shown, when), at(&shown, when + 20.0));
        let held = shown[from];
        for fix in &mut shown[from..to] {
            fix.position = held.position;
            fix.velocity = held
                .velocity
                .map(|(v, r)| (if keeps_velocity { v } else { Vector3::zeros() }, r));
        }
        let (track, summary) = navigate(log, &shown);
        let (distance, _, _) = apart(&track, &clean, held.time);
        let (later, angle, _) = apart(&track, &clean, shown[to].time + 10.0);
        println!(
            "frozen for 20 s at {when} s, {:.1} m/s, velocity {}: at most {distance:.1} m apart, {later:.3} m, {angle:.3} deg 10 s after; {:?} {:?}",
            held.velocity.unwrap().0.norm(),
            if keeps_velocity { "held" } else { "zero" },
            summary.contradictions,
            summary.leans
        );
        assert!(summary.contradictions.iter().any(|c| c.frozen));
        // The start from the light is at first taken for errors of the sensors.
        let limit = if when > log.from + 100.0 {
            (1.0, 6.0)
        } else {
            (0.3, 2.0)
        };
        assert!(later < limit.0 && angle < limit.1);
    }
}

#[test]
fn a_wrong_sign_is_named() {
    check_a_wrong_sign_is_named(&simulated());
}

#[test]
fn a_wrong_sign_is_named_on_the_real_drive() {
    if let Some(log) = rtk_drive() {
        check_a_wrong_sign_is_named(&log);
    }
}

fn check_a_wrong_sign_is_named(log: &Log) {
    let (_, summary) = navigate(log, &log.gnss);
    assert!(summary.wrong_signs.is_empty());
    let mut shown = log.gnss.clone();
    for fix in &mut shown {
        if let Some((v, _)) = &mut fix.velocity {
            v.z = -v.z;
        }
    }
    let (_, summary) = navigate(log, &shown);
    let wrong = summary.wrong_signs;
    println!(
        "velocity down reversed: named {wrong:?}; NIS {:?} {:?}, left out {} {}; leans {}, suspect {:?}, restarts {:?}",
        summary.innovations[Aid::Position].per_dof(),
        summary.innovations[Aid::Velocity].per_dof(),
        summary.innovations[Aid::Position].rejected,
        summary.innovations[Aid::Velocity].rejected,
        summary.leans.len(),
        summary.suspect,
        summary.restarts
    );
    assert_eq!(wrong, [2]);
}
