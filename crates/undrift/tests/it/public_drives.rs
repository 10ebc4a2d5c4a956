//! The example files on the public drives, with the figures that the project promises of them.

use crate::public;
use std::path::{Path, PathBuf};
use undrift::{
    drive::Drive,
    io::ReadError,
    navigate::{Wanted, navigate, resolve_mounting, settings},
    noise::BiasModel,
    outages::{self, ModelErrors, Schedule},
    reference::HORIZONTAL,
    replay::{Aid, Measurement},
};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The drive of an example file on the public data in `folder`, if it is there.
fn example(name: &str, folder: &str) -> Option<Drive> {
    Some(load(name, &public::find(folder)?))
}

fn load(name: &str, folder: &Path) -> Drive {
    let drive = Drive::load(&root().join("examples").join(name), Some(folder));
    drive.unwrap_or_else(|e| panic!("{e}"))
}

fn cut(drive: &Drive, models: &[BiasModel], plan: &Schedule, length: f64) -> Vec<ModelErrors> {
    let drive = &resolve_mounting(drive).unwrap().0;
    let imu: Result<Vec<_>, ReadError> = drive.open_imu().unwrap().collect();
    let gnss: Result<Vec<_>, ReadError> = drive.open_gnss().unwrap().collect();
    let gnss = gnss.unwrap();
    let truth = drive
        .open_truth()
        .unwrap()
        .map_or(Vec::new(), |t| t.collect::<Result<Vec<_>, _>>().unwrap());
    let (first, last) = (gnss[0].time, gnss[gnss.len() - 1].time);
    let cuts = outages::schedule(plan, length, first, last).unwrap();
    let models: Vec<_> = models
        .iter()
        .map(|kind| {
            let mut settings = settings(drive, *kind).unwrap();
            settings.outages = cuts.clone();
            (kind.name().to_owned(), settings)
        })
        .collect();
    outages::run(
        &imu.unwrap(),
        &Measurement::from_fixes(&gnss),
        &truth,
        &models,
        &|_| {},
    )
    .into_iter()
    .map(|(_, run)| run.unwrap().errors)
    .collect()
}

/// Outages as in docs/lab/results.md: 15 of 10 s from 60 s, every 24 s.
fn navego_plan() -> Schedule {
    Schedule::Every {
        start: 60.0,
        every: 24.0,
        count: Some(15),
    }
}

#[test]
fn navego_outages() {
    let Some(drive) = example("navego-adis16405.toml", "navego-adis16405") else {
        return;
    };
    let result = cut(
        &drive,
        &[BiasModel::Arma, BiasModel::White],
        &navego_plan(),
        10.0,
    );
    let (arma, white) = (result[0].max.0, result[1].max.0);
    println!(
        "arma N/E/D {:.2} {:.2} {:.2} m, yaw {:.2} deg",
        arma[0], arma[1], arma[2], arma[9]
    );
    // The first cut falls into a turn in which the heading is being found: one fix more or less moves these maxima, north
    // between 2.2 and 3.1 m, east between 3.6 and 5 m, the heading between 1.1 and 1.8 deg: see docs/lab/results.md.
    assert!(arma[0] < 3.3 && arma[1] < 5.2 && arma[2] < 1.9, "{arma:?}");
    assert!(arma[9] < 1.8, "{arma:?}");
    assert!(white[0] > 8.0 * arma[0] && white[1] > 8.0 * arma[1]);

    let removed = example(
        "navego-adis16405-constants-removed.toml",
        "navego-adis16405",
    )
    .unwrap();
    let white = cut(&removed, &[BiasModel::White], &navego_plan(), 10.0)[0]
        .max
        .0;
    println!(
        "white, constants removed, N/E/D {:.1} {:.1} {:.1} m",
        white[0], white[1], white[2]
    );
    // Less than eight times: the covariance of a filter that knows no drift grows with its innovations.
    assert!(
        white[0] > 6.0 * arma[0] && white[1] > 6.0 * arma[1],
        "{white:?}"
    );
}

#[test]
fn navego_whole_run() {
    let Some(drive) = example("navego-adis16405.toml", "navego-adis16405") else {
        return;
    };
    let report = navigate(&drive, BiasModel::Arma, Wanted::default()).unwrap();
    let (errors, _) = report.rmse.unwrap();
    println!("{errors:?}");
    assert!(errors.0[9] < 1.5, "yaw {} deg", errors.0[9]);
    // Better than the GNSS velocity alone, 0.049 m/s.
    assert!(errors.0[4..7].iter().all(|v| *v < 0.049), "{errors:?}");
    assert!(report.summary.suspect.is_none() && report.summary.diverged.is_none());
    // 6558 degrees of freedom: one standard deviation of the ratio is 0.017.
    let nis = report.summary.innovations[Aid::Velocity].per_dof().unwrap();
    assert!((nis - 1.0).abs() < 0.1, "{nis}");
}

#[test]
fn rtk_drive_outages() {
    let Some(drive) = example("rtk-drive.toml", "rtk-drive") else {
        return;
    };
    // Where the cuts fall moves the figure of one start between 2.9 and 4.1 m.
    let squares: Vec<f64> = [40.0, 43.0, 51.0, 57.0, 63.0]
        .into_iter()
        .flat_map(|start| {
            let plan = Schedule::Every {
                start,
                every: 30.0,
                count: Some(16),
            };
            let result = cut(&drive, &[BiasModel::RandomWalk], &plan, 10.0);
            let largest = result[0].per_outage.iter().map(|o| o.max.0[HORIZONTAL]);
            largest.map(|e| e * e).collect::<Vec<_>>()
        })
        .collect();
    let rms = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    println!("RMS of the largest horizontal error, five starts: {rms:.2} m");
    assert!(rms < 3.5, "{rms}");
}

#[test]
fn uav_flight_aligns_and_stays_with_the_aircrafts_own_filter() {
    let Some(drive) = example("uav-flight.toml", "uav-flight") else {
        return;
    };
    let report = navigate(&drive, BiasModel::Arma, Wanted::default()).unwrap();
    let (errors, _) = report.rmse.unwrap();
    println!("{errors:?}");
    // The reference is a filter of its own on the same sensors, its attitude a sample late: at
    // roll rates of 0.5 rad/s RMS that alone is 0.6 deg. A lost alignment shows as tens of degrees.
    assert!(
        errors.0[HORIZONTAL] < 2.0 && errors.0[7] < 3.0 && errors.0[8] < 1.5,
        "{errors:?}"
    );
    assert!(report.summary.suspect.is_none());
}

#[test]
fn ublox_drives_align_without_a_stated_mounting() {
    for drive_name in [
        "mixed-road-long-drive-nominal-001",
        "parkinglot-maneuvers",
        "urban-stop-go-tight-turns-nominal-001",
    ] {
        let folder = format!("ublox-drives/{drive_name}");
        let Some(drive) = example("ublox-drives.toml", &folder) else {
            return;
        };
        let report = navigate(&drive, BiasModel::Arma, Wanted::default()).unwrap();
        let (errors, _) = report.rmse.unwrap();
        println!(
            "{drive_name}: {:.2} m, {:?}",
            errors.0[HORIZONTAL], report.summary.alignment
        );
        // The reference is the receiver's own fused track, metres off at its start.
        assert!(errors.0[HORIZONTAL] < 2.0, "{drive_name}: {errors:?}");
        assert!(report.summary.suspect.is_none());
        let plan = Schedule::Every {
            start: 60.0,
            every: 30.0,
            count: None,
        };
        let outages = &cut(&drive, &[BiasModel::Arma], &plan, 10.0)[0];
        println!("10 s outages: RMS {:.2} m", outages.rms.0[HORIZONTAL]);
        assert!(outages.rms.0[HORIZONTAL] < 4.0);
    }
}

/// Made by `tools/make-drive30` at the project's root, which `.ci/run` runs.
fn drive30(name: &str, variant: &str) -> Option<Drive> {
    let folder = format!("target/drive30/{variant}");
    if root().join(&folder).is_dir() {
        return Some(load(name, &root().join(&folder)));
    }
    public::skipped(&folder);
    None
}

#[test]
fn simulated_half_hour_agrees_with_other_implementations() {
    let Some(drive) = drive30("drive30.toml", "seed1") else {
        return;
    };
    // Fifteen starts, 240 s after the first sample and then every 104 s: its outages.json.
    let starts: Vec<f64> = (0..15).map(|i| 100_240.0 + 104.0 * f64::from(i)).collect();
    // Two independent open implementations agree with each other on these to 0.3 %.
    for (length, published) in [(10.0, 0.204), (30.0, 1.757), (60.0, 8.828)] {
        let result = cut(
            &drive,
            &[BiasModel::GaussMarkov],
            &Schedule::At(starts.clone()),
            length,
        );
        let ours = result[0].end_rms.0[HORIZONTAL];
        println!("{length} s: {ours:.4} m, published {published} m");
        assert!((ours / published - 1.0).abs() < 0.01, "{length} s: {ours}");
    }
}

#[test]
fn simulated_half_hour_without_noise() {
    let Some(drive) = drive30("drive30-noise-free.toml", "noise-free") else {
        return;
    };
    let report = navigate(&drive, BiasModel::GaussMarkov, Wanted::default()).unwrap();
    let (errors, _) = report.rmse.unwrap();
    println!("{errors:?}");
    assert!(errors.0[..3].iter().all(|e| *e < 1e-3), "{errors:?}");
}
