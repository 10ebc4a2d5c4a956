//! Unusual places, and the antenna's place on the vehicle.

use super::drives::{TOWN_RATE, good, is_sound, simulated};
use super::log::{Log, says};
use undrift::nav::earth::Geodetic;

/// The town drive at another place.
fn at(latitude: f64, longitude: f64, height: f64) -> Log {
    Log::of(&simulated(
        Geodetic::from_degrees(latitude, longitude, height),
        TOWN_RATE,
        2.0,
    ))
}

#[test]
fn near_the_poles() {
    for latitude in [88.99, -88.99] {
        let (outcome, _) = at(latitude, 30.0, 100.0)
            .write(&format!("pole_{latitude}"))
            .solution();
        assert_eq!(outcome.stderr, "");
        is_sound(&outcome);
    }
}

/// At rest at a pole itself, where there is no north.
#[test]
fn at_the_poles() {
    for latitude in ["90", "-90", "89.9999999"] {
        let mut log = good();
        let (drive, _) = log.drive.split_once("[truth]").unwrap();
        log.drive = format!("{drive}[initial]\nattitude = \"0, 0, 0 deg\"\n");
        log.imu.retain(|row| row.time < 15.0);
        log.gnss.retain(|row| row.time < 15.0);
        for row in &mut log.gnss {
            row.fields[1] = latitude.into();
        }
        let message = log.write(&format!("pole_{latitude}")).refusal();
        says(&message, &["position, velocity or covariance out of range"]);
    }
}

#[test]
fn across_the_date_line() {
    // 700 m of the drive go east from here.
    let log = at(52.0, 179.998, 10.0);
    let longitudes: Vec<f64> = log.gnss.iter().map(|row| row.number(2)).collect();
    assert!(longitudes.iter().any(|l| *l > 179.0) && longitudes.iter().any(|l| *l < -179.0));
    let (outcome, _) = log.write("date_line").solution();
    assert_eq!(outcome.stderr, "");
    is_sound(&outcome);
}

#[test]
fn at_thirty_kilometres() {
    let (outcome, nav) = at(30.0, 114.0, 30_000.0).write("balloon").solution();
    assert_eq!(outcome.stderr, "");
    is_sound(&outcome);
    assert!((nav.at(100.0, "height_m") - 30_000.0).abs() < 3.0);
}

#[test]
fn below_the_sea() {
    let (outcome, _) = at(31.5, 35.5, -430.0).write("dead_sea").solution();
    assert_eq!(outcome.stderr, "");
    is_sound(&outcome);
}

#[test]
fn an_orbit_is_none_of_a_vehicle() {
    let mut log = good();
    for row in &mut log.gnss {
        row.put(3, &[2e7]);
    }
    says(
        &log.write("orbit").refusal(),
        &["gnss.csv: no usable fix (key gnss.position)"],
    );
}

#[test]
fn a_lever_arm_of_zero() {
    let mut log = good();
    log.set("[truth]", "lever_arm = \"0 m\"\n[truth]");
    is_sound(&log.write("lever_zero").solution().0);
}

#[test]
fn a_lever_arm_that_is_wrong() {
    let mut log = good();
    log.set("[truth]", "lever_arm = \"10, 0, 0 m\"\n[truth]");
    log.write("lever_wrong")
        .doubted(&["times as large as predicted", "the lever arm"]);
}

#[test]
fn a_lever_arm_in_millimetres() {
    let mut log = good();
    log.set("[truth]", "lever_arm = \"1500, 0, -800 m\"\n[truth]");
    let message = log.write("lever_mm").refusal();
    says(
        &message,
        &["drive.toml line 16, gnss.lever_arm: 1700 m is longer than any vehicle: check the unit"],
    );
}
