//! Inertial samples that are no motion.

use super::{Log, apart, navigate, rtk_drive, simulated};

#[test]
fn a_diverged_solution_begins_anew() {
    check_a_diverged_solution_begins_anew(simulated());
}

#[test]
fn a_diverged_solution_begins_anew_on_the_real_drive() {
    if let Some(log) = rtk_drive() {
        check_a_diverged_solution_begins_anew(log);
    }
}

fn check_a_diverged_solution_begins_anew(mut log: Log) {
    let (clean, _) = navigate(&log, &log.gnss);
    let start = log.gnss[0].time;
    // Two samples that are no motion; one alone would be replaced by its neighbours.
    let k = log
        .imu
        .iter()
        .position(|s| s.time > start + log.from + 160.0)
        .unwrap();
    let samples = [log.imu[k], log.imu[k + 1]];
    log.imu[k].dvel.x = 1e6;
    log.imu[k + 1].dvel.x = 2e6;
    let (track, summary) = navigate(&log, &log.gnss);
    let restart = &summary.restarts[0];
    println!("two absurd samples: {:?}", summary.restarts);
    assert!(restart.time < start + log.from + 161.0);
    if let Some(resumed) = restart.resumed {
        let (distance, angle, _) = apart(&track, &clean, resumed + 60.0);
        println!("a minute after that: {distance:.3} m, {angle:.3} deg");
        assert!(distance < 1.0);
    }
    // A gyro that reads 30 deg/s too much for twenty seconds.
    log.imu[k..k + 2].copy_from_slice(&samples);
    for sample in &mut log.imu[k..k + 2000] {
        sample.dtheta.z += 0.5 * sample.dt;
    }
    let (track, summary) = navigate(&log, &log.gnss);
    let end = log.gnss[log.gnss.len() - 1].time;
    let (distance, angle, _) = apart(&track, &clean, end - 30.0);
    println!(
        "a gyro gone wild: {:?}; suspect {:?}; heading {:?}; {} spans left out; at the end {distance:.3} m, {angle:.3} deg",
        summary.restarts,
        summary.suspect,
        summary.heading_off,
        summary.contradictions.len()
    );
    let mut courses = summary.heading_off.iter();
    let course = courses
        .any(|off| off.start > start + log.from + 160.0 && off.start < start + log.from + 220.0);
    assert!(!summary.restarts.is_empty() || summary.suspect.is_some() || course);
    assert!(distance < 5.0);
}
