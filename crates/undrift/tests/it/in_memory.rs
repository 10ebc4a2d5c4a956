//! A drive in memory gives the answer of its files, to the last bit.

use crate::public;
use std::path::Path;
use undrift::nav::parameters::Parameter;
use undrift::{
    BiasModel, Drive, ImuModel, Logs, Schedule, Setup, Trajectory, Usability, identify, navigate,
    navigate::{Hindsight, Report, Wanted},
    navigate_drive, simulate,
    simulate::{Barometer, GnssNoise, Odometer, SimulatedLog},
    tune,
};

/// A car in files, of an ADIS16465 at 50 Hz.
fn written(folder: &Path, duration: f64) -> Drive {
    let model = ImuModel::preset("adis16465").unwrap();
    let filters = model.shaping(BiasModel::GaussMarkov, 0.02).unwrap();
    let log = SimulatedLog {
        trajectory: &Trajectory::car(duration, 1),
        rate_hz: 50.0,
        filters: &filters,
        gnss: &GnssNoise::default(),
        seed: 1,
        model: "adis16465",
        temperature_c: None,
    };
    log.write(folder).unwrap();
    Drive::load(&folder.join("drive.toml"), None).unwrap()
}

/// The drive in memory, what its file says of it set in the fields.
fn in_memory(files: &Drive) -> Drive {
    let imu: Result<Vec<_>, _> = files.open_imu().unwrap().collect();
    let fixes: Result<Vec<_>, _> = files.open_gnss().unwrap().collect();
    let drive = Drive {
        model: files.model.clone(),
        align: files.align.clone(),
        ..Drive::from_samples(&imu.unwrap(), &fixes.unwrap())
    }
    .with_lever_arm(files.lever_arm);
    match files.open_truth().unwrap() {
        Some(truth) => drive.with_truth(&truth.collect::<Result<Vec<_>, _>>().unwrap()),
        None => drive,
    }
}

fn same_navigation(files: &Drive, memory: &Drive, kind: BiasModel, smooth: bool) {
    let run = |drive: &Drive| {
        let wanted = Wanted {
            hindsight: Hindsight::asked(false, smooth),
            rows: true,
            ..Wanted::default()
        };
        navigate_drive(drive, kind, wanted).unwrap()
    };
    let (theirs, ours) = (run(files), run(memory));
    assert!(ours.rows.len() > 3000);
    assert!(ours.rows == theirs.rows);
    assert_eq!(ours.findings(), theirs.findings());
    let said = |of: &Report| format!("{:?} {:?}", of.rmse, of.summary);
    assert_eq!(said(&ours), said(&theirs));
}

trait Said: std::fmt::Debug {}
impl<T: std::fmt::Debug> Said for T {}

#[test]
fn a_simulated_drive() {
    let folder = tempfile::tempdir().unwrap();
    let files = written(folder.path(), 240.0);
    let memory = in_memory(&files);
    // What a drive file that says nothing more sets.
    let settings = |drive: &Drive| -> Vec<String> {
        let fields: [&dyn Said; 12] = [
            &drive.estimate_mounting,
            &drive.vibration,
            &drive.gnss_use,
            &drive.align,
            &drive.parameters,
            &drive.constraints,
            &drive.gating,
            &drive.adapt,
            &drive.quality,
            &drive.correlation,
            &drive.std_factors,
            &drive.beginning,
        ];
        fields.map(|field| format!("{field:?}")).to_vec()
    };
    assert_eq!(settings(&memory), settings(&files));
    assert_eq!(
        memory.sample_interval().unwrap(),
        files.sample_interval().unwrap()
    );
    same_navigation(&files, &memory, BiasModel::Arma, false);
    same_navigation(&files, &memory, BiasModel::GaussMarkov, true);

    let cut = |drive: &Drive| {
        let logs = Logs::load(drive, Hindsight::Causal).unwrap();
        let start = 120.0;
        let cuts = logs.plan(&Schedule::Count { start, count: 3 }, 10.0);
        let run = logs.run(
            &[BiasModel::Arma],
            &cuts.unwrap(),
            Hindsight::Causal,
            &|_| (),
        );
        let (_, run) = run.unwrap().runs.remove(0);
        format!("{:?}", run.unwrap().errors)
    };
    assert_eq!(cut(&memory), cut(&files));
    let tuned = |drive: &Drive| {
        let options = tune::Options::default();
        let drives = std::slice::from_ref(drive);
        let (tuned, _) = tune::tune(drives, &options, &|_| true).unwrap();
        format!("{:?}", tuned.fit)
    };
    assert_eq!(tuned(&memory), tuned(&files));
}

/// A vehicle with wheel speeds and heights is what its drive file's tables make of it.
#[test]
fn a_vehicle_and_its_scalars() {
    let folder = tempfile::tempdir().unwrap();
    let files = written(folder.path(), 150.0);
    let car = Trajectory::car(150.0, 1);
    let speeds: Vec<_> = Odometer::default().measure(&car, 1).unwrap().collect();
    let heights: Vec<_> = Barometer::default().measure(&car, 1).unwrap().collect();
    let text = |scalars: &[undrift::nav::sample::Scalar]| -> String {
        let row = |s: &undrift::nav::sample::Scalar| format!("{},{},{}\n", s.time, s.value, s.std);
        scalars.iter().map(row).collect()
    };
    std::fs::write(folder.path().join("wheel.csv"), text(&speeds)).unwrap();
    std::fs::write(folder.path().join("height.csv"), text(&heights)).unwrap();
    let drive_file = folder.path().join("drive.toml");
    let tables = r#"
        [vehicle]
        profile = "car"
        [odometer]
        file = "wheel.csv"
        time = 1
        speed = 2
        speed_unit = "m/s"
        speed_std_column = 3
        [barometer]
        file = "height.csv"
        time = 1
        height = 2
        std_column = 3
    "#;
    let plain = std::fs::read_to_string(&drive_file).unwrap();
    std::fs::write(&drive_file, plain + tables).unwrap();
    let whole = Drive::load(&drive_file, None).unwrap();
    let memory = in_memory(&files)
        .with_odometer(&speeds)
        .with_barometer(&heights)
        .with_vehicle(undrift::vehicle::Profile::Car);
    assert_eq!(memory.constraints, whole.constraints);
    let said = |drive: &Drive| format!("{:?}", drive.parameters);
    assert_eq!(said(&memory), said(&whole));
    same_navigation(&whole, &memory, BiasModel::Arma, false);
}

#[test]
fn a_real_drive() {
    let Some(data) = public::find("rtk-drive") else {
        return;
    };
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/rtk-drive.toml");
    let files = Drive::load(&file, Some(&data)).unwrap();
    same_navigation(&files, &in_memory(&files), BiasModel::Arma, false);
}

#[test]
fn the_front_door_has_the_verdict_of_the_command() {
    let folder = tempfile::tempdir().unwrap();
    let files = written(folder.path(), 150.0);
    let imu: Vec<_> = files.open_imu().unwrap().map(Result::unwrap).collect();
    let fixes: Vec<_> = files.open_gnss().unwrap().map(Result::unwrap).collect();
    let model = files.model.clone().unwrap();
    let setup = Setup {
        lever_arm: Some(files.lever_arm),
        ..Setup::default()
    };
    let done = navigate(&imu, &fixes, &model, &setup).unwrap();
    let wanted = Wanted {
        rows: true,
        ..Wanted::default()
    };
    let report = navigate_drive(&files, BiasModel::Arma, wanted).unwrap();
    assert!(done.solution == report.rows);
    assert_eq!((done.verdict, done.cause()), (Usability::Usable, None));

    // Pushed as they come: that of the navigator's own, to its last sample but one.
    let mut navigator = setup.navigator(&model, 0.02).unwrap();
    let mut fixes = fixes.iter().peekable();
    for sample in &imu {
        while let Some(fix) = fixes.next_if(|fix| fix.time <= sample.time + navigator.ahead()) {
            navigator.fix(*fix).unwrap();
        }
        navigator.imu(*sample).unwrap();
    }
    let (now, row) = (
        navigator.filter().unwrap().nav(),
        &report.rows[report.rows.len() - 2],
    );
    assert_eq!(now.time, row.time);
    // A replay knows from the first fix on what all of them show of their errors.
    assert!(now.position.offset_to(&row.position).norm() < 1.0);

    // Of one clock nothing is left of the offset's doubt.
    let one_clock = Setup {
        one_clock: true,
        ..setup.clone()
    };
    let of_offset = |setup: &Setup| {
        let parameters = setup.settings(&model, 0.02).unwrap().parameters;
        let kinds = [
            Parameter::TimeOffset,
            Parameter::VelocityTimeOffset,
            Parameter::ClockRate,
            Parameter::LeverArm,
        ];
        kinds.map(|kind| parameters.prior(kind).is_some())
    };
    assert_eq!(of_offset(&setup), [true; 4]);
    assert_eq!(of_offset(&one_clock), [false, false, false, true]);

    // Degrees where radians belong.
    let off = |sample: &undrift::ImuSample| undrift::ImuSample {
        dtheta: sample.dtheta.map(f64::to_degrees),
        ..*sample
    };
    let wrong: Vec<_> = imu.iter().map(off).collect();
    let fixes: Vec<_> = files.open_gnss().unwrap().map(Result::unwrap).collect();
    match navigate(&wrong, &fixes, &model, &setup) {
        Ok(done) => {
            assert_eq!(done.verdict, Usability::NotUsable);
            assert!(done.cause().is_some());
        }
        Err(error) => assert!(!error.findings().is_empty(), "{error}"),
    }
}

#[test]
fn the_front_door_identifies_a_recording_at_rest() {
    let model = ImuModel::preset("mpu6050").unwrap();
    let filters = model.shaping(BiasModel::GaussMarkov, 0.02).unwrap();
    let rest = Trajectory::rest(120.0);
    let log = simulate(&rest, 50.0, Some(&filters), &GnssNoise::default(), 1).unwrap();
    let row = |s: &undrift::ImuSample| {
        let (w, f) = (s.dtheta / s.dt, s.dvel / s.dt);
        [w.x, w.y, w.z, f.x, f.y, f.z]
    };
    let mut rows: Vec<[f64; 6]> = log.imu.iter().map(row).collect();
    let found = identify(&rows, 50.0).unwrap();
    assert_eq!((found.verdict, found.doubts.len()), (Usability::Usable, 0));
    let white = |model: &ImuModel| model.gyro[2].white_density();
    assert!((white(&found.model) / white(&model) - 1.0).abs() < 0.1);
    // One axis alone, the same.
    let alone: Vec<[f64; 6]> = rows
        .iter()
        .map(|row| [0, 1, 2, 3, 4, 5].map(|axis| if axis == 2 { row[axis] } else { f64::NAN }))
        .collect();
    let of_one = identify(&alone, 50.0).unwrap();
    assert_eq!(
        (of_one.verdict, of_one.doubts.len()),
        (Usability::Usable, 0)
    );
    // A constant is what the gyros show together.
    let noise = |model: &ImuModel| (model.gyro[2].white, model.gyro[2].random_walk);
    assert_eq!(noise(&of_one.model), noise(&found.model));
    // An axis that is not connected, and no gravity.
    rows.iter_mut().for_each(|row| row[1] = 0.0);
    let found = identify(&rows, 50.0).unwrap();
    assert_eq!(found.verdict, Usability::WithCare);
    assert_eq!(
        found.doubts,
        [("gyro_y".into(), undrift::results::AxisDoubt::Constant)]
    );
    rows.iter_mut().for_each(|row| row[5] += 9.81);
    let refused = identify(&rows, 50.0).err().unwrap().to_string();
    assert!(refused.contains("9.81"), "{refused}");
}
