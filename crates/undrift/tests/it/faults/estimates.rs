//! Wrong times and lever arms, which the filter can estimate.

use super::{drift_from, navigate, rtk_drive, simulated_car as simulated};
use undrift::{
    nav::{
        Vector3,
        parameters::{Parameter, Parameters, Prior},
        sample::GnssFix,
    },
    replay::{Aid, GnssUse, Summary},
};

fn estimate(summary: &Summary, kind: Parameter) -> (Vec<f64>, Vec<f64>) {
    let (_, value, std) = summary.parameters.iter().find(|p| p.0 == kind).unwrap();
    (value.clone(), std.clone())
}

fn time_offset() -> Parameters {
    let prior = Prior {
        std: 0.2,
        walk: 0.0,
        ..Prior::default()
    };
    Parameters::none().with(Parameter::TimeOffset, prior)
}

/// The fixes with their times earlier by `offset` [s].
fn hastened(gnss: &[GnssFix], offset: f64) -> Vec<GnssFix> {
    let earlier = |fix: &GnssFix| GnssFix {
        time: fix.time - offset,
        ..*fix
    };
    gnss.iter().map(earlier).collect()
}

#[test]
fn a_time_offset_is_estimated() {
    for seed in 1..=3 {
        let mut log = simulated(seed);
        log.settings.parameters = time_offset();
        for offset in [-0.2, 0.0, 0.2] {
            let shown = hastened(&log.gnss, offset);
            let (_, summary) = navigate(&log, &shown);
            let (value, std) = estimate(&summary, Parameter::TimeOffset);
            println!(
                "seed {seed}, offset {offset}: {:.4} ± {:.4} s; NIS {:.3} {:.3}; left out {} {}",
                value[0],
                std[0],
                summary.innovations[Aid::Position].per_dof().unwrap(),
                summary.innovations[Aid::Velocity].per_dof().unwrap(),
                summary.innovations[Aid::Position].rejected,
                summary.innovations[Aid::Velocity].rejected
            );
            assert!((value[0] - offset).abs() < 0.005, "{}", value[0]);
            let nis = summary.innovations[Aid::Position].per_dof().unwrap();
            assert!((nis - 1.0).abs() < 0.15, "{nis}");
        }
    }
}

#[test]
fn a_time_offset_is_estimated_on_the_real_drive() {
    let Some(mut log) = rtk_drive() else { return };
    // Its velocities hold 0.15 s before its positions do, so that both together have no one offset.
    log.settings.gnss_use = GnssUse::Position;
    log.settings.parameters = time_offset();
    let mut found = Vec::new();
    for offset in [-0.2, 0.0, 0.2] {
        let shown = hastened(&log.gnss, offset);
        let (_, summary) = navigate(&log, &shown);
        let (value, std) = estimate(&summary, Parameter::TimeOffset);
        println!(
            "offset {offset}: {:.4} ± {:.4} s; NIS {:.3}; left out {}",
            value[0],
            std[0],
            summary.innovations[Aid::Position].per_dof().unwrap(),
            summary.innovations[Aid::Position].rejected
        );
        found.push(value[0] - offset);
    }
    // What the log has of its own is in all three.
    assert!(
        (found[0] - found[1]).abs() < 0.005 && (found[2] - found[1]).abs() < 0.005,
        "{found:?}"
    );
}

#[test]
fn a_clock_rate_is_estimated() {
    for (seed, rate) in [(5, 500e-6), (6, -200e-6), (7, 0.0)] {
        let mut log = simulated(seed);
        let prior = Prior::constant(3e-4);
        log.settings.parameters = time_offset().with(Parameter::ClockRate, prior);
        let mut shown = log.gnss.clone();
        let first = shown[0].time;
        for fix in &mut shown {
            fix.time -= rate * (fix.time - first);
        }
        let (_, summary) = navigate(&log, &shown);
        let (value, std) = estimate(&summary, Parameter::ClockRate);
        // At the end of the log, not at its start.
        let (late, _) = estimate(&summary, Parameter::TimeOffset);
        let nis = summary.innovations[Aid::Position].per_dof().unwrap();
        println!(
            "{:.0} ppm: {:.1} ± {:.1} ppm, {:.4} s late at the end; NIS {nis:.3}",
            rate * 1e6,
            value[0] * 1e6,
            std[0] * 1e6,
            late[0]
        );
        assert!((value[0] - rate).abs() < 4.0 * std[0] && std[0] < 1e-5);
        assert!((late[0] - 599.0 * rate).abs() < 0.005);
        assert!((nis - 1.0).abs() < 0.15, "{nis}");
    }
}

#[test]
fn a_delay_of_the_accelerometers_is_estimated() {
    for (seed, steps) in [(8, 10), (9, 4), (10, 0), (11, -10)] {
        let mut log = simulated(seed);
        let force = log.imu.clone();
        let interval = force[0].dt;
        // Later than the gyros by so many samples.
        for (k, sample) in log.imu.iter_mut().enumerate() {
            let from = k as i64 - steps;
            sample.dvel = force[from.clamp(0, force.len() as i64 - 1) as usize].dvel;
        }
        let shown = log.gnss.clone();
        let (_, without) = navigate(&log, &shown);
        log.settings.parameters =
            Parameters::none().with(Parameter::AccelDelay, Prior::constant(0.05));
        let (_, summary) = navigate(&log, &shown);
        let (value, std) = estimate(&summary, Parameter::AccelDelay);
        let delay = steps as f64 * interval;
        let nis = |summary: &Summary| summary.innovations[Aid::Velocity].per_dof().unwrap();
        println!(
            "{:.0} ms: {:.1} ± {:.1} ms; NIS {:.3}, without {:.3}",
            1e3 * delay,
            1e3 * value[0],
            1e3 * std[0],
            nis(&summary),
            nis(&without)
        );
        // Beside four standard deviations what a delay is more than a rate of change: a hundredth of it.
        assert!((value[0] - delay).abs() < 4.0 * std[0] + 0.01 * delay.abs());
        assert!(std[0] < 5e-3 && (nis(&summary) - 1.0).abs() < 0.15);
        assert!(steps.abs() < 10 || nis(&without) > 1.3);
    }
}

#[test]
fn a_time_offset_survives_outages() {
    let mut log = simulated(4);
    log.settings.parameters = time_offset();
    let nominal = drift_from(110.0, &log, &log.gnss, &log.settings, &log.gnss);
    for offset in [-0.2, 0.2] {
        let shown = hastened(&log.gnss, offset);
        let drift = drift_from(110.0, &log, &shown, &log.settings, &shown);
        println!("offset {offset}: drift {drift:.3} m, without offset {nominal:.3} m");
        assert!((drift / nominal - 1.0).abs() < 0.15, "{drift} {nominal}");
    }
}

#[test]
fn a_wrong_lever_arm_is_estimated() {
    for (seed, wrong) in [
        (1, Vector3::new(0.5, 0.0, 0.0)),
        (2, Vector3::new(0.3, -0.4, 0.0)),
        (3, Vector3::new(-0.3, 0.3, 0.27)),
    ] {
        let mut log = simulated(seed);
        log.settings.lever_arm += wrong;
        log.settings.parameters = Parameters::none().with(
            Parameter::LeverArm,
            Prior {
                std: 0.5,
                walk: 0.0,
                ..Prior::default()
            },
        );
        let (_, summary) = navigate(&log, &log.gnss);
        let (value, std) = estimate(&summary, Parameter::LeverArm);
        let miss: Vec<f64> = (0..3).map(|i| value[i] + wrong[i]).collect();
        println!(
            "seed {seed}, wrong by {:?}: missed by {miss:.3?} ± {std:.3?} m; NIS {:.3}; left out {}",
            wrong.as_slice(),
            summary.innovations[Aid::Position].per_dof().unwrap(),
            summary.innovations[Aid::Position].rejected
        );
        assert!(miss[0].abs() < 0.05 && miss[1].abs() < 0.05, "{miss:?}");
        assert!(
            miss[2].abs() < 4.0 * std[2] && miss[2].abs() < 0.3,
            "{miss:?}"
        );
    }
}
