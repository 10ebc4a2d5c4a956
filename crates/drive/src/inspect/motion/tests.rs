//! Drives whose sensors are altered, and what the inspection makes of them.

use super::super::inspect_held;
use super::axes::fit;
use super::*;
use std::fmt::Write as _;
use undrift_io::Memory;
use undrift_nav::earth::STANDARD_GRAVITY;
use undrift_nav::sample::Position;
use undrift_nav::shaping::ShapingFilter;
use undrift_results::inspect::Flight as Flies;
use undrift_simulate::{Craft, Flight, GnssNoise, Simulation, Trajectory, fly, simulate};

/// The IMU of a drive, in rad/s and g, z up, with `alter` on each of its samples, and its fixes, with velocities that are
/// alternately so much too large and too small [m/s].
fn files(alter: impl Fn(&mut Vector3, &mut Vector3), off: f64) -> [Inspection; 2] {
    files_of(&GnssNoise::default(), alter, off)
}

fn files_of(
    noise: &GnssNoise,
    alter: impl Fn(&mut Vector3, &mut Vector3),
    off: f64,
) -> [Inspection; 2] {
    let log = simulate(&Trajectory::car(180.0, 3), 50.0, None, noise, 3).unwrap();
    files_from(&log, alter, off)
}

fn files_from(
    log: &Simulation,
    alter: impl Fn(&mut Vector3, &mut Vector3),
    off: f64,
) -> [Inspection; 2] {
    let mut imu = "time_s,gx,gy,gz,ax,ay,az\n".to_owned();
    for (k, sample) in log.imu.iter().enumerate() {
        let up = Vector3::new(1.0, -1.0, -1.0) / sample.dt;
        // Enough white noise to distinguish rad/s from deg/s.
        let white = 0.002 * f64::from(k as u32 % 2 * 2) - 0.002;
        let mut gyro = sample.dtheta.component_mul(&up).add_scalar(white);
        let mut accel = sample.dvel.component_mul(&up) / STANDARD_GRAVITY;
        alter(&mut gyro, &mut accel);
        let ([p, q, r], [x, y, z]) = (gyro.into(), <[f64; 3]>::from(accel));
        let _ = writeln!(imu, "{:.3},{p},{q},{r},{x},{y},{z}", sample.time);
    }
    let mut gnss = "time_s,lat_deg,lon_deg,height_m,vn_mps,ve_mps,vd_mps\n".to_owned();
    for (fix, off) in log.gnss.iter().zip([off, -off].into_iter().cycle()) {
        let (Some((Position::Geodetic(place), _)), Some((v, _))) = (fix.position, fix.velocity)
        else {
            panic!("{fix:?}");
        };
        let (lat, lon) = (place.lat.to_degrees(), place.lon.to_degrees());
        let height = place.height;
        let _ = writeln!(
            gnss,
            "{},{lat},{lon},{height},{},{},{}",
            fix.time,
            v.x + off,
            v.y + off,
            v.z
        );
    }
    [("imu.csv", imu), ("gnss.csv", gnss)].map(|(name, text)| {
        let held = Memory::Bytes(text.into_bytes().into());
        inspect_held(Path::new(name), held).unwrap()
    })
}

/// The lines and notes of the IMU of a drive with `alter` on each of its samples.
fn inspected(
    alter: impl Fn(&mut Vector3, &mut Vector3),
) -> (Vec<(&'static str, String)>, Vec<Note>) {
    let mut of = files(alter, 0.0);
    motion(&mut of);
    let [imu, _] = of;
    let lines = imu.parts[0].lines.iter();
    let lines = lines
        .map(|line| (line.key, line.value.to_string()))
        .collect();
    (lines, imu.found)
}

#[track_caller]
fn units(alter: impl Fn(&mut Vector3, &mut Vector3)) -> [String; 2] {
    let (lines, found) = inspected(alter);
    assert!(
        lines.iter().any(|(key, _)| SITS.contains(key)) && found.is_empty(),
        "{lines:?} {found:?}"
    );
    ["gyro_unit", "accel_unit"].map(|of| {
        let line = lines.iter().find(|(key, _)| *key == of);
        line.unwrap().1.trim_matches('"').to_owned()
    })
}

#[test]
fn axes_with_a_wrong_sign_are_found_by_the_motion() {
    assert_eq!(units(|_, _| ()), ["rad/s", "g"]);
    let turned = units(|gyro, _| gyro.z = -gyro.z);
    assert_eq!(turned, ["rad/s, rad/s, -rad/s", "g"]);
    let forward = units(|_, accel| accel.y = -accel.y);
    assert_eq!(forward, ["rad/s", "g, -g, g"]);
    // Whichever of the axes of a left-handed triad is reversed is the same but for a rotation.
    let mirrored = units(|gyro, accel| {
        gyro.y = -gyro.y;
        accel.y = -accel.y;
    });
    assert_eq!(mirrored, ["rad/s, -rad/s, rad/s", "g, -g, g"]);
    let mirrored = units(|gyro, accel| {
        gyro.swap_rows(0, 1);
        accel.swap_rows(0, 1);
    });
    assert_eq!(mirrored, ["rad/s, -rad/s, rad/s", "g, -g, g"]);
}

#[test]
fn forces_without_gravity_show_no_mounting() {
    let (lines, found) = inspected(|_, accel| accel.z -= 1.0);
    assert!(
        !lines.iter().any(|(key, _)| SITS.contains(key)),
        "{lines:?}"
    );
    assert!(
        matches!(found[..], [Note::NoGravity { ratio }] if ratio < 0.05),
        "{found:?}"
    );
}

#[test]
fn a_drive_fits_whose_velocities_differ_by_no_more_than_is_stated() {
    let of = |off: f64| {
        let files = files(|_, _| (), off);
        let parts = files.each_ref().map(|of| (&*of.file, &of.parts[0]));
        let drive = drive_of(&parts, logs(&files, Path::new("")), Some("auto")).unwrap();
        let resolved = resolve_mounting(&drive).unwrap();
        // Neither implausible nor with fixes that are rejected.
        assert!(fit(resolved.clone()).is_some(), "{off}");
        is_fitting(resolved)
    };
    // Half of σ, and one and a half.
    assert!(of(0.1));
    assert!(!of(0.3));
}

#[test]
fn a_car_is_known_by_its_motion() {
    let mut of = files(|_, _| (), 0.0);
    assert_eq!(motion(&mut of).wheels, Wheels::Shown);
}

/// What is found of a flight with gyros and accelerometers of this white noise [rad/s/√Hz, m/s²/√Hz].
fn flies(craft: Craft, white: [f64; 2], seed: u64) -> Option<Flies> {
    let dt = 0.02;
    let axis = |white: f64, turn_on: f64| {
        let start = ShapingFilter::constant(turn_on, dt).unwrap();
        ShapingFilter::white(white, dt)
            .unwrap()
            .plus(&start)
            .unwrap()
    };
    let (gyro, accel) = (axis(white[0], 3e-3), axis(white[1], 0.1));
    let sensors = [gyro, gyro, gyro, accel, accel, accel];
    let noise = GnssNoise {
        position_std: [1.5, 1.5, 3.0],
        velocity_std: [0.1, 0.1, 0.2],
        ..GnssNoise::default()
    };
    let flight = Flight {
        craft,
        wind: [4.0, -2.0],
        gusts: 0.7,
        duration: 420.0,
    };
    let log = fly(&flight, 50.0, Some(&sensors), &noise, seed).unwrap();
    motion(&mut files_from(&log, |_, _| (), 0.0)).flight
}

/// With velocities of a copter that hovers at times an aircraft would predict withheld fixes better, by its rests on the ground.
#[test]
fn what_hovers_is_no_aircraft() {
    assert_ne!(
        flies(Craft::Copter(0.3), [2e-3, 5e-2], 2),
        Some(Flies::Aircraft)
    );
}

/// A sensor that shakes shows what the air adds to it; one that predicts twenty seconds by itself does not need it.
#[test]
fn an_aircraft_is_known_where_its_sensor_shakes() {
    for seed in [3, 7] {
        let found = flies(Craft::Aircraft(16.0), [2e-3, 5e-2], seed);
        assert_eq!(found, Some(Flies::Aircraft), "{seed}");
    }
    assert_eq!(flies(Craft::Aircraft(16.0), [2e-4, 2e-3], 3), None);
}

/// Positions good to centimetres are not left at a guess of 3 m; those good to 3 m are.
#[test]
fn positions_that_do_not_say_their_accuracy_show_it() {
    let std = |position: f64| {
        let noise = GnssNoise {
            position_std: [position, position, 2.0 * position],
            ..GnssNoise::default()
        };
        let mut of = files_of(&noise, |_, _| (), 0.0);
        motion(&mut of);
        let mut lines = of[1].parts[0].lines.iter();
        let line = lines.find(|line| line.key == "position_std").unwrap();
        (line.value.to_string(), line.known.clone())
    };
    let (value, known) = std(0.02);
    assert!(
        value.starts_with("\"0.1,") && matches!(known, Known::Withheld { spans: 10.. }),
        "{value} {known:?}"
    );
    assert_eq!(std(3.0), ("\"3, 3, 6 m\"".into(), Known::NoColumns));
}

/// A receiver behind a filter of 0.3 s has it written, one that is only late by as much has not.
#[test]
fn a_receiver_s_filter_is_written() {
    let noise = GnssNoise {
        position_std: [0.02; 3],
        velocity_std: [0.03; 3],
        rate_hz: 5.0,
        ..GnssNoise::default()
    };
    let written = |filtered: f64, time_offset: f64| {
        let receiver = GnssNoise {
            time_offset,
            ..noise
        };
        let mut log = simulate(&Trajectory::car(240.0, 5), 50.0, None, &receiver, 5).unwrap();
        if filtered > 0.0 {
            log.filter_fixes(filtered);
        }
        let mut of = files_from(&log, |_, _| (), 0.0);
        motion(&mut of);
        let mut lines = of[1].parts[0].lines.iter();
        let line = lines.find(|line| line.key == "smoothing");
        line.map(|line| line.value.to_string())
    };
    assert_eq!(written(0.3, 0.0), Some("\"0.3 s\"".into()));
    assert_eq!(written(0.0, 0.0), None);
    assert_eq!(written(0.0, -0.3), None);
}
