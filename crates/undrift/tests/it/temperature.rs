//! A bias that follows the temperature: estimated from a recording, stored, taken out of a drive.

use std::{fmt::Write, fs, path::PathBuf};
use undrift::findings::{Finding, Severity, TemperatureUse};
use undrift::nav::Vector3;
use undrift::noise::{
    BiasModel, ImuModel,
    synthesis::NoiseGenerator,
    temperature::{Regressors, Temperature},
};
use undrift::reference::HORIZONTAL;
use undrift::simulate::{GnssNoise, SimulatedLog};
use undrift::{Drive, Logs, Schedule, Trajectory, navigate, navigate_drive};

const RATE: f64 = 100.0;
const SEED: u64 = 1;
/// Of the z gyro: 60 deg/h/K.
const SLOPE: f64 = 60.0 / 3600.0 * std::f64::consts::PI / 180.0;

/// Temperature of the drive [°C].
fn temperature(time: f64) -> f64 {
    30.0 + 5.0 * (time / 40.0).sin()
}

fn model() -> ImuModel {
    ImuModel::preset("adis16465").unwrap()
}

/// A car's drive with the bias, and a column of temperatures as `column` writes them.
fn drive(name: &str, column: impl Fn(f64) -> String) -> Drive {
    let folder: PathBuf = [env!("CARGO_TARGET_TMPDIR"), &format!("temperature-{name}")]
        .iter()
        .collect();
    let gnss = GnssNoise {
        position_std: [0.5, 0.5, 1.0],
        velocity_std: [0.05, 0.05, 0.1],
        rate_hz: 5.0,
        lever_arm: Vector3::new(0.3, 0.0, -1.2),
        ..GnssNoise::default()
    };
    let sensors = model().shaping(BiasModel::GaussMarkov, 1.0 / RATE);
    SimulatedLog {
        trajectory: &Trajectory::car(900.0, SEED),
        rate_hz: RATE,
        filters: &sensors.unwrap(),
        gnss: &gnss,
        seed: SEED,
        model: "adis16465",
        temperature_c: None,
    }
    .write(&folder)
    .unwrap();
    let log = folder.join("imu.csv");
    let mut text = String::new();
    for (k, line) in fs::read_to_string(&log).unwrap().lines().enumerate() {
        let fields: Vec<&str> = line.split(',').collect();
        if k == 0 {
            let _ = writeln!(text, "{line},temp_C");
            continue;
        }
        let [time, rate] = [0, 3].map(|at| fields[at].parse::<f64>().unwrap());
        let rate = rate + SLOPE * (temperature(time) - 30.0);
        let (before, after) = (fields[..3].join(","), fields[4..].join(","));
        let _ = writeln!(text, "{before},{rate:.9},{after},{}", column(time));
    }
    fs::write(log, text).unwrap();
    Drive::load(&folder.join("drive.toml"), None).unwrap()
}

/// The effect as half an hour at rest shows it, at 10 Hz, seed 7.
fn recorded() -> Temperature {
    let sensors = model().shaping(BiasModel::GaussMarkov, 0.1).unwrap();
    let mut record = vec![0.0; 18_000];
    NoiseGenerator::new(&sensors[2], 7).fill(&mut record);
    let warmth: Vec<f64> = (0..record.len())
        .map(|k| 36.0 - 14.0 * (-(k as f64) / 4000.0).exp())
        .collect();
    let record = record.iter().zip(&warmth);
    let record: Vec<f64> = record.map(|(x, t)| x + SLOPE * (t - 30.0)).collect();
    let found = Regressors::new(&record, &warmth, 0.1).unwrap().estimate();
    found.unwrap().in_model().unwrap()
}

fn with(drive: &Drive, effect: Temperature) -> Drive {
    let mut model = model();
    model.gyro[2].temperature = Some(effect);
    // As read from a file.
    let model = ImuModel::from_toml(&model.to_toml(), "imu.toml").unwrap();
    Drive {
        model: Some(model),
        ..drive.clone()
    }
}

/// Of 15 outages of 30 s the median horizontal error, NEES of position, velocity, attitude at the end, and the share of position errors inside 3 σ.
fn drift(drive: &Drive) -> (f64, [f64; 3], f64, Vec<Finding>) {
    let logs = Logs::load(drive, navigate::Hindsight::Causal).unwrap();
    let plan = Schedule::Count {
        start: 200.0,
        count: 15,
    };
    let cuts = logs.plan(&plan, 30.0).unwrap();
    let runs = logs.run(
        &[BiasModel::GaussMarkov],
        &cuts,
        navigate::Hindsight::Causal,
        &|_| (),
    );
    let runs = runs.unwrap();
    let errors = &runs.runs[0].1.as_ref().unwrap().errors;
    let inside = errors.coverage.shares(0).unwrap()[2];
    (
        errors.median.0[HORIZONTAL],
        errors.nees,
        inside,
        logs.findings(&runs),
    )
}

#[test]
fn the_stored_slope_takes_the_temperature_out_of_a_drive() {
    let effect = recorded();
    // The bias' 2 deg/h of 100 s over half an hour: 0.7 deg/h over the 3 K of the temperature.
    assert!((effect.slope / SLOPE - 1.0).abs() < 0.012, "{effect:?}");
    let drive = drive("drift", |time| format!("{:.2}", temperature(time)));
    let (without, blind, _, silent) = drift(&drive);
    let (with, nees, inside, found) = drift(&with(&drive, effect));
    // 300 deg/h that come and go in four minutes against a bias of 2 deg/h.
    assert!(with < 0.35 * without, "{with} {without}");
    // Of 15 outages: 1 per degree of freedom, within chance.
    let [position, _, attitude] = nees;
    assert!(
        position < 2.0 && attitude < 2.0 && inside > 0.97,
        "{nees:?} {inside}"
    );
    assert!(blind[0] > 3.0 * nees[0], "{blind:?} {nees:?}");
    let about = |found: &[Finding]| {
        found
            .iter()
            .any(|f| matches!(f, Finding::Temperature { .. }))
    };
    // Where all samples are corrected there is nothing to report.
    assert!(!about(&found) && !about(&silent));
}

#[test]
fn what_has_no_temperature_or_one_beyond_the_recording_is_reported() {
    let effect = Temperature {
        range_c: [28.0, 40.0],
        ..recorded()
    };
    // Nothing for 100 s: a minute holds. Empty, not a number, text.
    let column = |time: f64| match time {
        t if !(300.0..400.0).contains(&t) => format!("{:.2}", temperature(t)),
        t if t < 330.0 => String::new(),
        t if t < 360.0 => "nan".into(),
        _ => "n/a".into(),
    };
    let drive = drive("gap", column);
    let report = |drive: &Drive| {
        let report = navigate_drive(drive, BiasModel::GaussMarkov, navigate::Wanted::default());
        let report = report.unwrap();
        assert_eq!(report.imu_skipped.total(), 0);
        let found = report.findings().into_iter();
        found
            .filter(|f| matches!(f, Finding::Temperature { .. }))
            .collect::<Vec<_>>()
    };
    let found = report(&with(&drive, effect));
    let [
        Finding::Temperature(TemperatureUse {
            corrected,
            without,
            without_from,
            beyond,
            seen_c,
        }),
    ] = &found[..]
    else {
        panic!("{found:?}");
    };
    assert!(without.abs_diff(4000) <= 2 && without_from.is_some_and(|t| (t - 360.0).abs() < 0.1));
    assert!(corrected.abs_diff(86_000) <= 3);
    let cold = |t: &f64| (*t < 300.0 || *t >= 400.0) && temperature(*t) < 28.0;
    let cold = (0..=90_000)
        .map(|k| f64::from(k) / RATE)
        .filter(cold)
        .count();
    // Temperatures at its edge are rounded to 0.01 K.
    assert!(beyond.abs_diff(cold as u64) < 30, "{beyond} {cold}");
    assert!(seen_c.is_some_and(|[low, high]| low < 25.1 && high > 34.9));
    assert_eq!(found[0].severity(), Severity::Note);
    // A model without it: nothing to say.
    assert!(report(&drive).is_empty());
    // Axes of the sensor, turned in the vehicle: the correction turns with them.
    let mut turned = with(&drive, effect);
    let model = turned.model.as_mut().unwrap();
    model.gyro[2].temperature = None;
    model.gyro[0].temperature = Some(effect);
    turned.imu.1.rotation = undrift::nav::Matrix3::new(0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0);
    let [plain, corrected] = [&drive.clone(), &turned].map(|d| {
        let rotation = turned.imu.1.rotation;
        let d = Drive {
            imu: (
                d.imu.0.clone(),
                undrift::io::imu::ImuFormat {
                    rotation,
                    ..d.imu.1.clone()
                },
            ),
            ..d.clone()
        };
        d.open_imu().unwrap().next().unwrap().unwrap()
    });
    let bias = (plain.dtheta - corrected.dtheta) / plain.dt;
    let expected = effect.bias((temperature(plain.time) * 100.0).round() / 100.0);
    assert!(
        (bias - Vector3::new(0.0, 0.0, expected)).norm() < 1e-12,
        "{bias} {expected}"
    );
}
