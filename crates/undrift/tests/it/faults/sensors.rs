//! Inertial samples that are no motion.

use super::{apart, navigate, rtk_drive};

#[test]
fn a_diverged_solution_begins_anew() {
    let Some(mut log) = rtk_drive() else { return };
    let (clean, _) = navigate(&log, &log.gnss);
    let start = log.gnss[0].time;
    // A sample that is no motion.
    let k = log.imu.iter().position(|s| s.time > start + 200.0).unwrap();
    let sample = log.imu[k];
    log.imu[k].dvel.x = 1e6;
    let (track, summary) = navigate(&log, &log.gnss);
    let restart = &summary.restarts[0];
    println!("one absurd sample: {:?}", summary.restarts);
    assert!(restart.time < start + 201.0);
    if let Some(resumed) = restart.resumed {
        let (distance, angle, _) = apart(&track, &clean, resumed + 60.0);
        println!("a minute after that: {distance:.3} m, {angle:.3} deg");
        assert!(distance < 1.0);
    }
    // A gyro that reads 30 deg/s too much for twenty seconds.
    log.imu[k] = sample;
    for sample in &mut log.imu[k..k + 2000] {
        sample.dtheta.z += 0.5 * sample.dt;
    }
    let (track, summary) = navigate(&log, &log.gnss);
    let end = log.gnss[log.gnss.len() - 1].time;
    let (distance, angle, _) = apart(&track, &clean, end - 30.0);
    println!(
        "a gyro gone wild: {:?}; suspect {:?}; {} spans left out; at the end {distance:.3} m, {angle:.3} deg",
        summary.restarts,
        summary.suspect,
        summary.contradictions.len()
    );
    assert!(!summary.restarts.is_empty() || summary.suspect.is_some());
    assert!(distance < 5.0);
}
