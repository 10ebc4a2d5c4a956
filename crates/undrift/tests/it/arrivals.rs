//! Measurements that arrive late and out of order: the state is that of the measurements in order of their own time.

use crate::public;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::path::{Path, PathBuf};
use undrift::{
    Drive, Trajectory,
    engine::Navigator,
    io::ReadError,
    navigate::{resolve_mounting, settings, study, tell},
    noise::{BiasModel, ImuModel},
    replay::{Measurement, Settings},
    simulate::{GnssNoise, SimulatedLog},
};
use undrift_nav::sample::ImuSample;

/// What a drive gives, all of it in memory.
fn read(drive: &Drive) -> (Vec<ImuSample>, Vec<Measurement>, Settings) {
    let (drive, _) = resolve_mounting(drive).unwrap();
    let imu: Result<Vec<_>, ReadError> = drive.open_imu().unwrap().collect();
    let fixes: Result<Vec<_>, ReadError> = drive.open_gnss().unwrap().collect();
    let fixes = fixes.unwrap();
    let mut settings = settings(&drive, BiasModel::Arma).unwrap();
    let found = study(&drive, fixes.iter().copied().map(Ok::<_, ReadError>)).unwrap();
    tell(&mut settings, &drive, found.as_ref());
    (imu.unwrap(), Measurement::of_fixes(&fixes), settings)
}

/// Every number of the filter at the end, to the bit, and how many measurements came too late.
fn end(
    (imu, measured, settings): &(Vec<ImuSample>, Vec<Measurement>, Settings),
    late: impl Fn() -> Option<u64>,
) -> (Vec<u64>, u64) {
    let mut rng = late().map(Xoshiro256PlusPlus::seed_from_u64);
    let horizon = if rng.is_some() { 2.2 } else { 0.0 };
    let mut navigator = Navigator::new(settings.clone()).with_horizon(horizon);
    let mut arriving: Vec<_> = measured
        .iter()
        .map(|m| {
            (
                m.time() + rng.as_mut().map_or(0.0, |rng| 2.0 * rng.random::<f64>()),
                m,
            )
        })
        .collect();
    arriving.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut arriving = arriving.into_iter().peekable();
    for sample in imu {
        let until = sample.time + navigator.ahead();
        while let Some((_, m)) = arriving.next_if(|(at, _)| *at <= until) {
            navigator.measure(*m).unwrap();
        }
        navigator.imu(*sample).unwrap();
    }
    // Only what the samples reach belongs to the state.
    let last = imu[imu.len() - 1].time;
    for (_, m) in arriving.filter(|(_, m)| m.time() < last) {
        navigator.measure(*m).unwrap();
    }
    let mut bits = Vec::new();
    let mut filter = navigator.filter().expect("aligned").boxed();
    filter.numbers(&mut |number| bits.push(number.to_bits()));
    (bits, navigator.too_late())
}

fn in_any_order(drive: &Drive) {
    let logs = read(drive);
    let (in_order, _) = end(&logs, || None);
    let (shuffled, too_late) = end(&logs, || Some(1));
    assert_eq!(too_late, 0);
    assert!(shuffled == in_order, "another state");
}

fn example(name: &str, folder: &str) -> Option<Drive> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    let folder: PathBuf = public::find(folder)?;
    Some(Drive::load(&root.join(name), Some(&folder)).unwrap())
}

#[test]
fn fixes_up_to_two_seconds_late_give_the_state_of_the_fixes_in_order() {
    let folder = tempfile::tempdir().unwrap();
    let model = ImuModel::preset("mpu6050").unwrap();
    SimulatedLog {
        trajectory: &Trajectory::car(200.0, 4),
        rate_hz: 100.0,
        filters: &model.shaping(BiasModel::Arma, 0.01).unwrap(),
        gnss: &GnssNoise {
            rate_hz: 5.0,
            ..GnssNoise::default()
        },
        seed: 4,
        model: "mpu6050",
        temperature_c: None,
    }
    .write(folder.path())
    .unwrap();
    in_any_order(&Drive::load(&folder.path().join("drive.toml"), None).unwrap());
}

#[test]
fn fixes_late_on_the_rtk_drive() {
    if let Some(drive) = example("rtk-drive.toml", "rtk-drive") {
        in_any_order(&drive);
    }
}

#[test]
fn fixes_late_on_the_navego_drive() {
    if let Some(drive) = example("navego-adis16405.toml", "navego-adis16405") {
        in_any_order(&drive);
    }
}

#[test]
fn fixes_late_on_a_drive_of_a_single_frequency_receiver() {
    if let Some(drive) = example("ublox-drives.toml", "ublox-drives/parkinglot-maneuvers") {
        in_any_order(&drive);
    }
}
