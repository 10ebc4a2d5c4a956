//! What wrong fixes do to a solution: gross outliers, jumps, spoofing, wrong accuracies, a frozen
//! receiver, wrong times and lever arms. Figures as in docs/lab/faults.md: those of the public drive. Each test is made on a
//! simulated drive too.
//!
//! Random numbers are xoshiro256++ from the seeds given.

mod estimates;
mod outliers;
mod receiver;
mod sensors;

use crate::public;
use std::path::Path;
use undrift::{
    drive::Drive,
    estimator::Estimator,
    io::ReadError,
    nav::{
        Vector3,
        mechanisation::NavState,
        sample::{GnssFix, ImuSample, Position},
        shaping::ShapingFilter,
    },
    navigate::settings,
    noise::BiasModel,
    outages::{self, Schedule},
    reference::HORIZONTAL,
    replay::{Measurement, Observer, ReplayError, Settings, Summary, replay},
    simulate::{GnssNoise, Trajectory, simulate},
};

/// A log in memory with its settings.
struct Log {
    imu: Vec<ImuSample>,
    gnss: Vec<GnssFix>,
    settings: Settings,
    /// When the vehicle is under way \[s\] after the first fix.
    from: f64,
}

/// The real drive, if it is there.
fn rtk_drive() -> Option<Log> {
    let folder = public::find("rtk-drive")?;
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/rtk-drive.toml");
    let drive = Drive::load(&example, Some(&folder)).unwrap();
    let imu: Result<Vec<_>, ReadError> = drive.open_imu().unwrap().collect();
    let gnss: Result<Vec<_>, ReadError> = drive.open_gnss().unwrap().collect();
    Some(Log {
        imu: imu.unwrap(),
        gnss: gnss.unwrap(),
        // The noise is that of this car, set by hand, and the fixes are taken at their word: it is the gate that is measured here.
        settings: Settings {
            vibration: None,
            from_fixes: None,
            ..settings(&drive, BiasModel::Arma).unwrap()
        },
        from: 40.0,
    })
}

/// A sensor of the class of the real drive's.
fn sensors(interval: f64) -> [ShapingFilter; 6] {
    let sensor = |white: f64, walk: f64, turn_on: f64| {
        ShapingFilter::white(white, interval)
            .and_then(|f| f.plus(&ShapingFilter::random_walk(walk, interval)?))
            .and_then(|f| f.plus(&ShapingFilter::constant(turn_on, interval)?))
            .unwrap()
    };
    let gyro = sensor(
        0.01f64.to_radians(),
        0.0005f64.to_radians(),
        0.3f64.to_radians(),
    );
    let accel = sensor(1e-3, 1e-4, 0.1);
    [gyro, gyro, gyro, accel, accel, accel]
}

/// Ten minutes of a simulated car with an antenna at (0.8, -0.4, -1.2) m.
fn simulated_car(seed: u64) -> Log {
    let lever_arm = Vector3::new(0.8, -0.4, -1.2);
    let noise = GnssNoise {
        position_std: [0.01, 0.01, 0.02],
        velocity_std: [0.05; 3],
        rate_hz: 5.0,
        start: 1.037,
        lever_arm,
        ..GnssNoise::default()
    };
    let car = Trajectory::car(600.0, seed);
    let log = simulate(&car, 100.0, Some(&sensors(0.01)), &noise, seed).unwrap();
    let settings = Settings {
        lever_arm,
        ..Settings::new(sensors(0.01))
    };
    Log {
        imu: log.imu,
        gnss: log.gnss,
        settings,
        from: 110.0,
    }
}

fn simulated() -> Log {
    simulated_car(1)
}

#[derive(Default)]
struct Track(Vec<NavState>);

impl Observer for Track {
    fn sample(&mut self, filter: &dyn Estimator) -> Result<(), ReplayError> {
        self.0.push(*filter.nav());
        Ok(())
    }
}

fn navigate(log: &Log, gnss: &[GnssFix]) -> (Vec<NavState>, Summary) {
    navigate_with(log, gnss, &log.settings)
}

fn navigate_with(log: &Log, gnss: &[GnssFix], settings: &Settings) -> (Vec<NavState>, Summary) {
    let mut track = Track::default();
    let mut imu = log.imu.iter().copied().map(Ok);
    let mut aiding = gnss.iter().copied().map(Measurement::Gnss).map(Ok);
    let summary = replay(&mut imu, &mut aiding, settings, &mut track).unwrap();
    (track.0, summary)
}

/// RMS over 10 s outages, every 30 s from `start` seconds after the first fix, of the largest horizontal error
/// against the fixes of `reference`, the filter being shown `gnss`.
fn drift_from(
    start: f64,
    log: &Log,
    gnss: &[GnssFix],
    settings: &Settings,
    reference: &[GnssFix],
) -> f64 {
    let plan = Schedule::Every {
        start,
        every: 30.0,
        count: Some(16),
    };
    let (first, last) = (reference[0].time, reference[reference.len() - 1].time);
    let cuts = outages::schedule(&plan, 10.0, first, last).unwrap();
    // What is withheld serves as the reference, so it is to be the clean one.
    let shown: Vec<GnssFix> = gnss
        .iter()
        .zip(reference)
        .map(|(shown, clean)| {
            let withheld = cuts.iter().any(|cut| cut.contains(clean.time));
            if withheld { *clean } else { *shown }
        })
        .collect();
    let settings = Settings {
        outages: cuts,
        ..settings.clone()
    };
    let results = outages::run(
        &log.imu,
        &Measurement::from_fixes(&shown),
        &[],
        &[("arma".into(), settings)],
        &|_| {},
    );
    results[0].1.as_ref().unwrap().errors.rms.0[HORIZONTAL]
}

/// As the project's figures for the real drive.
fn drift(log: &Log, gnss: &[GnssFix], settings: &Settings, reference: &[GnssFix]) -> f64 {
    drift_from(log.from, log, gnss, settings, reference)
}

/// Largest horizontal distance [m] and angle of roll, pitch, yaw [deg] between two tracks, at the
/// instants both have from `from` on, and the root mean square of the distance.
fn apart(a: &[NavState], b: &[NavState], from: f64) -> (f64, f64, f64) {
    let (mut distance, mut angle, mut square, mut n) = (0.0f64, 0.0f64, 0.0, 0.0);
    let mut others = b.iter().peekable();
    for x in a.iter().filter(|x| x.time >= from) {
        while others.next_if(|y| y.time < x.time - 1e-6).is_some() {}
        let Some(y) = others.peek().filter(|y| y.time < x.time + 1e-6) else {
            continue;
        };
        let d = x.position.offset_to(&y.position).xy().norm();
        distance = distance.max(d);
        angle = angle.max((x.q_nb.inverse() * y.q_nb).angle().to_degrees());
        square += d * d;
        n += 1.0;
    }
    (distance, angle, f64::sqrt(square / n))
}

fn moved(fix: &GnssFix, by: Vector3) -> GnssFix {
    let mut fix = *fix;
    if let Some((position, _)) = &mut fix.position {
        *position = match position {
            Position::Geodetic(place) => Position::Geodetic(place.displaced(&by)),
            Position::Baseline { base, ned } => Position::Baseline {
                base: *base,
                ned: *ned + by,
            },
        };
    }
    fix
}

fn hurried(fix: &GnssFix, by: Vector3) -> GnssFix {
    let mut fix = *fix;
    if let Some((velocity, _)) = &mut fix.velocity {
        *velocity += by;
    }
    fix
}

/// Index of the first fix at or after `time` seconds from the first.
fn at(gnss: &[GnssFix], time: f64) -> usize {
    let start = gnss[0].time;
    gnss.iter().position(|f| f.time >= start + time).unwrap()
}
