//! Real cars under the car profile, with the figures that the project promises.

use crate::public;
use std::path::{Path, PathBuf};
use undrift::{
    drive::Drive,
    io::ReadError,
    navigate::{look_ahead, resolve_mounting, settings, study},
    noise::BiasModel,
    outages::{self, ModelErrors, Schedule},
    reference::HORIZONTAL,
    replay::Measurement,
};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn example(name: &str, folder: &str) -> Option<Drive> {
    let folder = public::find(folder)?;
    let drive = Drive::load(&root().join("examples").join(name), Some(&folder));
    let (drive, _) = resolve_mounting(&drive.unwrap()).unwrap();
    Some(drive)
}

/// Outages of `length` every `every` seconds from `start` after the first fix.
fn cut(drive: &Drive, start: f64, length: f64, every: f64, nodes: Option<f64>) -> ModelErrors {
    let imu: Result<Vec<_>, ReadError> = drive.open_imu().unwrap().collect();
    let gnss: Result<Vec<_>, ReadError> = drive.open_gnss().unwrap().collect();
    let gnss = gnss.unwrap();
    let plan = Schedule::Every {
        start,
        every,
        count: None,
    };
    let (first, last) = (gnss[0].time, gnss[gnss.len() - 1].time);
    let mut settings = settings(drive, BiasModel::Arma).unwrap();
    if nodes.is_some() {
        let fixes = gnss.iter().copied().map(Ok::<_, ReadError>);
        look_ahead(&mut settings, study(drive, fixes).unwrap().as_ref());
    }
    settings.outages = outages::schedule(&plan, length, first, last - 30.0).unwrap();
    settings.nodes = nodes;
    let run = outages::run(
        &imu.unwrap(),
        &Measurement::from_fixes(&gnss),
        &[],
        &[("arma".to_owned(), settings)],
        &|_| {},
    );
    run.into_iter().next().unwrap().1.unwrap().errors
}

#[test]
#[ignore = "slow: a public drive six times"]
fn rtk_drive_through_outages() {
    let Some(drive) = example("rtk-drive-car.toml", "rtk-drive") else {
        return;
    };
    // From 40 s after the first fix until 30 s before the end; and shifted by 7 s.
    for start in [40.0, 47.0] {
        let ten = cut(&drive, start, 10.0, 30.0, None).rms.0[HORIZONTAL];
        let thirty = cut(&drive, start, 30.0, 90.0, None).rms.0[HORIZONTAL];
        let smoothed = cut(&drive, start, 15.0, 45.0, Some(0.2)).rms.0[HORIZONTAL];
        println!(
            "from {start} s: 10 s {ten:.3} m, 30 s {thirty:.3} m, smoothed 15 s {smoothed:.3} m"
        );
        assert!(ten < 2.4, "{ten}");
        assert!(thirty < 8.0, "{thirty}");
        assert!(smoothed < 0.35, "{smoothed}");
    }
}

#[test]
#[ignore = "slow: public drives"]
fn ublox_drives_through_outages() {
    let mut ten = Vec::new();
    for folder in [
        "mixed-road-long-drive-nominal-001",
        "parkinglot-maneuvers",
        "urban-stop-go-tight-turns-nominal-001",
    ] {
        let Some(drive) = example("ublox-drives-car.toml", &format!("ublox-drives/{folder}"))
        else {
            return;
        };
        let short = cut(&drive, 60.0, 10.0, 30.0, None);
        let long = cut(&drive, 60.0, 30.0, 90.0, None).rms.0[HORIZONTAL];
        println!(
            "{folder}: 10 s {:.3} m, 30 s {long:.3} m",
            short.rms.0[HORIZONTAL]
        );
        // Those before the solution began have no error.
        let errors = short.per_outage.iter().map(|o| o.max.0[HORIZONTAL]);
        ten.extend(errors.filter(|error| error.is_finite()));
        assert!(long < 6.0, "{folder} {long}");
    }
    let rms = (ten.iter().map(|e| e * e).sum::<f64>() / ten.len() as f64).sqrt();
    println!("all: 10 s {rms:.3} m over {} outages", ten.len());
    assert!(rms < 1.0, "{rms}");
}
