//! Measurements that arrive late and out of order: the state is that of the measurements in order of their own time.

use crate::public;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::{
    ops::Range,
    path::{Path, PathBuf},
    process::Command,
};
use undrift::{
    Drive, Trajectory,
    engine::Navigator,
    io::ReadError,
    navigate::{resolve_mounting, settings},
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
    let settings = settings(&drive, BiasModel::Arma).unwrap();
    (
        imu.unwrap(),
        Measurement::from_fixes(&fixes.unwrap()),
        settings,
    )
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
    // Only what the samples reach belongs to the state; fixes that hold before their stamps may be stamped later than the last one.
    let last = imu[imu.len() - 1].time + navigator.ahead();
    for (_, m) in arriving.filter(|(_, m)| m.time() <= last) {
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

/// A drive by car of 200 s in this folder.
fn simulated(folder: &Path) -> Drive {
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
    .write(folder)
    .unwrap();
    Drive::load(&folder.join("drive.toml"), None).unwrap()
}

#[test]
fn fixes_up_to_two_seconds_late_give_the_state_of_the_fixes_in_order() {
    let folder = tempfile::tempdir().unwrap();
    in_any_order(&simulated(folder.path()));
}

/// Pushes what lies after `from` up to `until` \[s\] from the first sample.
fn push(
    navigator: &mut Navigator,
    logs: &(Vec<ImuSample>, Vec<Measurement>, Settings),
    span: Range<f64>,
) {
    let (imu, measured, _) = logs;
    let [from, until] = [span.start, span.end].map(|t| imu[0].time + t);
    let within = |time: f64| from < time && time <= until;
    let mut measured = measured.iter().filter(|m| within(m.time())).peekable();
    for sample in imu.iter().filter(|sample| within(sample.time)) {
        while let Some(m) = measured.next_if(|m| m.time() <= sample.time) {
            navigator.measure(*m).unwrap();
        }
        navigator.imu(*sample).unwrap();
    }
}

fn bits(navigator: &Navigator) -> Vec<u8> {
    let mut bits = Vec::new();
    let mut filter = navigator.filter().expect("aligned").boxed();
    filter.numbers(&mut |number| bits.extend(number.to_bits().to_le_bytes()));
    bits
}

/// The folder of the drive and the checkpoint, in the process that goes on with it.
const GOES_ON: &str = "UNDRIFT_TEST_GOES_ON";

#[test]
fn a_checkpoint_goes_on_in_another_process_to_the_last_bit() {
    if let Some(folder) = std::env::var_os(GOES_ON) {
        let folder = PathBuf::from(folder);
        let logs = read(&Drive::load(&folder.join("drive.toml"), None).unwrap());
        let kept = std::fs::read(folder.join("checkpoint")).unwrap();
        let mut navigator = Navigator::restore(logs.2.clone(), &kept).unwrap();
        push(&mut navigator, &logs, 90.0..200.0);
        std::fs::write(folder.join("went-on"), bits(&navigator)).unwrap();
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let logs = read(&simulated(folder.path()));
    let mut navigator = Navigator::new(logs.2.clone());
    push(&mut navigator, &logs, -1.0..90.0);
    std::fs::write(folder.path().join("checkpoint"), navigator.checkpoint()).unwrap();
    push(&mut navigator, &logs, 90.0..200.0);
    let name = "arrivals::a_checkpoint_goes_on_in_another_process_to_the_last_bit";
    let other = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", name])
        .env(GOES_ON, folder.path())
        .output()
        .unwrap();
    assert!(other.status.success(), "{other:?}");
    let went_on = std::fs::read(folder.path().join("went-on")).unwrap();
    assert!(went_on == bits(&navigator), "another state");
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
