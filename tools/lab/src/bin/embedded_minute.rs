//! Writes the minute that the microcontroller and the C example navigate: testdata/golden/embedded/minute.bin.
//!
//! `cargo run --release -p undrift-lab --bin embedded_minute -- FILE`. Integers and floating point
//! numbers are little-endian:
//!
//! | bytes | what |
//! |---|---|
//! | 8 | `undrift1` |
//! | 4, 4 | number n of inertial samples, number m of fixes |
//! | 8 each | sample interval [s]; one count of an angle increment [rad], of a velocity increment [m/s] |
//! | 8 each | start, at time 0: latitude, longitude [rad], height [m], velocity north, east, down [m/s], roll, pitch, yaw [rad] |
//! | 8 each | its standard deviations, three each: position [m], velocity [m/s], attitude about north, east, down [rad] |
//! | 8 each | lever arm to the antenna, body axes [m] |
//! | 8 each | truth at the end, as the start |
//! | 12 n | six counts of 2 bytes: angle increment x, y, z, velocity increment x, y, z |
//! | 104 m | 8 each: time [s], latitude, longitude [rad], height [m], velocity [m/s], standard deviations of position [m] and velocity [m/s] |

use std::{fs::write, path::Path};
use undrift::{
    nav::{
        Vector3,
        earth::Geodetic,
        sample::{Position, TruthSample},
        shaping::ShapingFilter,
    },
    simulate::{GnssFixes, GnssNoise, IdealImu, SensorErrors, Trajectory},
};

type Failure = Box<dyn std::error::Error>;

/// Samples a second [Hz].
const RATE: f64 = 100.0;
/// Where the minute lies in the simulated drive [s]: it moves from 60 s on.
const BEGIN: f64 = 75.0;
const LENGTH: f64 = 60.0;
const SEED: u64 = 4;
/// One count of an angle increment [rad] and of a velocity increment [m/s]: 3.2 rad/s and 32 m/s² fit 16 bits.
const COUNTS: [f64; 2] = [1e-6, 1e-5];

fn main() -> Result<(), Failure> {
    let file = std::env::args().nth(1).ok_or("give a file to write to")?;
    let drive = Trajectory::car(300.0, SEED);

    // What crates/capi/examples/navigate.c and embedded/src/model.rs call the ARMA model.
    let (phi, theta) = ([1.8087, -0.81058], [1.65, -0.665]);
    let interval = 1.0 / RATE;
    let sensor = |sigma: f64, turn_on: f64| {
        ShapingFilter::arma(&phi, &theta, sigma, interval)?
            .plus(&ShapingFilter::constant(turn_on, interval)?)
    };
    let (gyro, accel) = (sensor(1e-3, 1.7e-3)?, sensor(5e-3, 0.05)?);
    let mut errors = SensorErrors::new(&[gyro, gyro, gyro, accel, accel, accel], RATE, SEED)?;

    let mut start = None;
    let mut end = None;
    let mut samples = Vec::new();
    for (ideal, truth) in IdealImu::new(&drive, RATE) {
        if truth.time < BEGIN + 0.5 / RATE {
            start = Some(truth);
        } else if truth.time < BEGIN + LENGTH + 0.5 / RATE {
            let sample = errors.apply(&ideal);
            samples.extend(counts(&sample.dtheta, COUNTS[0])?);
            samples.extend(counts(&sample.dvel, COUNTS[1])?);
            end = Some(truth);
        }
    }
    let (start, end) = (
        state(start.ok_or("no start")?)?,
        state(end.ok_or("no end")?)?,
    );

    // A code receiver, whose epochs fall inside the sample intervals.
    let receiver = GnssNoise {
        position_std: [1.0, 1.0, 2.0],
        velocity_std: [0.05, 0.05, 0.1],
        time_offset: 0.0037,
        lever_arm: Vector3::new(0.5, 0.2, -1.2),
        ..GnssNoise::default()
    };
    let mut fixes = Vec::new();
    for fix in GnssFixes::new(&drive, &receiver, SEED)? {
        let time = fix.time - BEGIN;
        let (Some((Position::Geodetic(place), _)), Some((v_n, _))) = (fix.position, fix.velocity)
        else {
            return Err("a fix lacks position or velocity".into());
        };
        if (0.0..LENGTH).contains(&time) {
            fixes.extend([time, place.lat, place.lon, place.height]);
            fixes.extend(v_n.iter());
            fixes.extend(receiver.position_std);
            fixes.extend(receiver.velocity_std);
        }
    }

    // The first guess is off by about its standard deviation.
    let std = [1.0, 1.0, 2.0, 0.1, 0.1, 0.1, 0.0175, 0.0175, 0.0524];
    let place = Geodetic {
        lat: start[0],
        lon: start[1],
        height: start[2],
    }
    .displaced(&Vector3::new(0.8, -1.1, 1.5));
    let mut guess = start;
    (guess[0], guess[1], guess[2]) = (place.lat, place.lon, place.height);
    for (number, off) in guess[3..]
        .iter_mut()
        .zip([0.1, -0.05, 0.08, 0.009, -0.007, 0.045])
    {
        *number += off;
    }

    let mut bytes = b"undrift1".to_vec();
    bytes.extend(u32::try_from(samples.len() / 6)?.to_le_bytes());
    bytes.extend(u32::try_from(fixes.len() / 13)?.to_le_bytes());
    let header = [interval, COUNTS[0], COUNTS[1]]
        .into_iter()
        .chain(guess)
        .chain(std)
        .chain(receiver.lever_arm.iter().copied())
        .chain(end);
    bytes.extend(header.flat_map(f64::to_le_bytes));
    bytes.extend(samples.into_iter().flat_map(i16::to_le_bytes));
    bytes.extend(fixes.into_iter().flat_map(f64::to_le_bytes));
    write(Path::new(&file), &bytes)?;
    println!("{file}: {} bytes", bytes.len());
    Ok(())
}

fn counts(increment: &Vector3, count: f64) -> Result<[i16; 3], Failure> {
    let mut out = [0; 3];
    for (slot, value) in out.iter_mut().zip(increment.iter()) {
        let number = (value / count).round();
        if number.abs() > f64::from(i16::MAX) {
            return Err("an increment does not fit 16 bits".into());
        }
        *slot = number as i16;
    }
    Ok(out)
}

fn state(truth: TruthSample) -> Result<[f64; 9], Failure> {
    let v = truth.v_n.ok_or("truth without velocity")?;
    let rpy = truth.rpy.ok_or("truth without attitude")?;
    let place = truth.position;
    Ok([
        place.lat,
        place.lon,
        place.height,
        v.x,
        v.y,
        v.z,
        rpy.x,
        rpy.y,
        rpy.z,
    ])
}
