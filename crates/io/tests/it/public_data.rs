//! The readers on real logs, which are not part of the project.

use crate::public::find;
use undrift_io::Opened;
use undrift_io::format::Format;
use undrift_io::gnss::{
    FixOptions, GnssFormat, GnssLog, GnssReader, PositionColumns, VelocityAxes,
};
use undrift_io::imu::{ImuFormat, ImuReader};
use undrift_io::poses::{PoseReader, PoseSource, QuaternionOrder, detect};
use undrift_io::skipped::SkipKind;
use undrift_io::table::Column;
use undrift_io::truth::{TruthFormat, TruthReader};
use undrift_nav::earth::{Geodetic, STANDARD_GRAVITY};
use undrift_nav::sample::{FixQuality, GnssFix, ImuSample, Position, TruthSample};
use undrift_nav::{Matrix3, Vector3};

fn name(text: &str) -> Column {
    Column::Name(text.into())
}

fn names(list: [&str; 3]) -> [Column; 3] {
    list.map(name)
}

fn near(a: f64, b: f64) -> bool {
    // Some roundings of a product or difference of the numbers in the file.
    (a - b).abs() <= 1e-12 * b.abs().max(1.0)
}

fn degrees() -> f64 {
    1f64.to_radians()
}

/// All samples; nothing may have been skipped.
fn imu(file: &str, format: &ImuFormat) -> Option<(Vec<ImuSample>, u64)> {
    let mut reader = ImuReader::open(&find(file)?, format).unwrap();
    let samples: Vec<ImuSample> = reader.by_ref().map(Result::unwrap).collect();
    assert!(reader.skipped().is_empty(), "{file}: {}", reader.skipped());
    Some((samples, reader.gaps().count))
}

fn gnss_format(height: &str) -> GnssFormat {
    GnssFormat {
        time: name("t_s"),
        date: None,
        time_scale: 1.0,
        place: Some(PositionColumns::Geodetic {
            columns: names(["lat_deg", "lon_deg", height]),
            angle_scale: degrees(),
            degrees_minutes: false,
            height_scale: 1.0,
            height: None,
        }),
        position_std: None,
        velocity: Some(names(["vn_mps", "ve_mps", "vd_mps"])),
        velocity_axes: VelocityAxes::Down,
        velocity_scale: 1.0,
        velocity_std: None,
        quality: None,
        delimiter: None,
        fixes: FixOptions::default(),
    }
}

fn with_stds(height: &str, position_std: [f64; 3], velocity_std: [f64; 3]) -> GnssFormat {
    GnssFormat {
        fixes: FixOptions {
            position_std: Some(position_std),
            velocity_std: Some(velocity_std),
            ..FixOptions::default()
        },
        ..gnss_format(height)
    }
}

fn gnss(mut reader: GnssReader) -> Vec<GnssFix> {
    let fixes = reader.by_ref().map(Result::unwrap).collect();
    assert!(reader.skipped().is_empty(), "{}", reader.skipped());
    fixes
}

fn place(fix: &GnssFix) -> Geodetic {
    match fix.position.unwrap().0 {
        Position::Geodetic(place) => place,
        Position::Baseline { .. } => panic!("a baseline"),
    }
}

/// A part of a flight, with IMU, IMU2, GPS and GPA; the numbers are those that pymavlink reads.
#[test]
fn ardupilot() {
    let Some(path) = find("fixtures/ardupilot-test.BIN") else {
        return;
    };
    assert_eq!(Opened::open(&path).unwrap().format(), Format::DataFlash);
    let read = |topic: Option<&str>| {
        let format = ImuFormat::log(Format::DataFlash, topic.map(str::to_owned));
        let reader = ImuReader::open(&path, &format).unwrap();
        reader.collect::<Result<Vec<ImuSample>, _>>().unwrap()
    };
    let samples = read(None);
    assert_eq!((samples.len(), read(Some("IMU1")).len()), (45, 45));
    let force = samples[1].dvel / samples[1].dt;
    assert!((force.z + 9.945_431_709_289_55).abs() < 1e-9, "{force}");
    let mut reader = GnssReader::open(&path, &GnssLog::new(Format::DataFlash).into()).unwrap();
    let fixes: Vec<GnssFix> = reader.by_ref().map(Result::unwrap).collect();
    // The first 64 KiB of a log, in the middle of a message.
    assert_eq!(reader.skipped().count(SkipKind::EndsEarly), 1);
    assert_eq!(reader.skipped().total(), 1);
    assert_eq!(fixes.len(), 5);
    assert_eq!(fixes[0].time, 6448.0);
    assert_eq!(fixes[0].quality, FixQuality::Single);
    let expected = Geodetic::from_degrees(-35.362_627_7, 149.165_303_4, 588.82);
    let found = place(&fixes[0]);
    assert!((found.lat - expected.lat).abs() < 1e-14 && (found.lon - expected.lon).abs() < 1e-14);
    assert!((found.height - expected.height).abs() < 1e-9);
    let (_, covariance) = fixes[0].position.unwrap();
    assert!((covariance[(2, 2)] - 2.41 * 2.41).abs() < 1e-9);
    // The samples begin with the first fix.
    assert!(
        (samples[0].time - 6448.0).abs() < 0.3,
        "{}",
        samples[0].time
    );
}

#[test]
fn navego() {
    let format = ImuFormat::new(
        Some(name("t_s")),
        names(["gx_radps", "gy_radps", "gz_radps"]),
        names(["fx_mps2", "fy_mps2", "fz_mps2"]),
    );
    let Some((samples, gaps)) = imu("navego-adis16405/imu.csv.gz", &format) else {
        return;
    };
    assert_eq!((samples.len(), gaps), (87_450, 0));
    let (first, last) = (samples[0], samples[87_449]);
    assert!(near(first.dt, 0.005) && near(last.dt, 0.005));
    assert!(near(first.dtheta.x, 0.051_975_152_3 * 0.005));
    assert_eq!(last.time, 437.245);
    assert!(near(last.dvel.z, -9.980_594_91 * last.dt));

    let constant = with_stds("height_m", [5.0, 5.0, 10.0], [0.05; 3]);
    let path = find("navego-adis16405/gnss.csv.gz").unwrap();
    assert_ne!(Opened::open(&path).unwrap().format(), Format::Rtklib);
    let fixes = gnss(GnssReader::open(&path, &constant.clone().into()).unwrap());
    assert_eq!(fixes.len(), 2187);
    let expected = Geodetic::from_degrees(-32.830_785_312_1, -68.792_863_784_2, 707.421);
    assert_eq!(place(&fixes[0]), expected);
    assert_eq!(fixes[2186].time, 437.2);
    let (velocity, covariance) = fixes[2186].velocity.unwrap();
    assert_eq!(velocity, Vector3::new(15.478_68, -4.174_22, 0.0116));
    assert!(near(covariance[(0, 0)], 0.0025));

    let format = TruthFormat {
        velocity: Some(names(["vn_mps", "ve_mps", "vd_mps"])),
        attitude: Some(names(["roll_deg", "pitch_deg", "yaw_deg"])),
        ..TruthFormat::degrees(name("t_s"), names(["lat_deg", "lon_deg", "height_m"]))
    };
    let path = find("navego-adis16405/truth.csv.gz").unwrap();
    let truth: Result<Vec<TruthSample>, _> = TruthReader::open(&path, &format.clone().into())
        .unwrap()
        .collect();
    let truth = truth.unwrap();
    assert_eq!(truth.len(), 87_450);
    assert!(near(truth[0].rpy.unwrap().z, -15.0 * degrees()));
    let last = truth[87_449];
    let expected = Geodetic::from_degrees(-32.821_458_972_9, -68.789_742_095_8, 700.0903);
    assert_eq!((last.time, last.position), (437.245, expected));
    assert_eq!(last.v_n, Some(Vector3::new(15.454_81, -4.1411, 0.0)));
}

#[test]
fn rtk_drive() {
    let format = ImuFormat {
        gyro_scale: Vector3::repeat(degrees()),
        accel_scale: Vector3::repeat(STANDARD_GRAVITY),
        rate_hz: Some(100.0),
        ..ImuFormat::new(
            Some(name("gps_sow_s")),
            names(["gx_dps", "gy_dps", "gz_dps"]),
            names(["ax_g", "ay_g", "az_g"]),
        )
    };
    let Some((samples, _)) = imu("rtk-drive/imu.csv.gz", &format) else {
        return;
    };
    assert_eq!(samples.len(), 54_858);
    let (first, last) = (samples[0], samples[54_857]);
    assert_eq!((first.time, first.dt), (243_261.729, 0.01));
    assert!(near(first.dtheta.x, -0.359 * degrees() * 0.01));
    assert!(near(first.dvel.z, 0.985 * STANDARD_GRAVITY * 0.01));
    assert_eq!(last.time, 243_810.46);
    assert!(near(last.dtheta.z, 0.221 * degrees() * last.dt));

    let path = find("rtk-drive/gnss.pos").unwrap();
    assert_eq!(Opened::open(&path).unwrap().format(), Format::Rtklib);
    let fixes = gnss(GnssReader::open(&path, &GnssLog::new(Format::Rtklib).into()).unwrap());
    assert_eq!(fixes.len(), 2197);
    // Tuesday 19:34:18.499; the rounding of a time of 2.4e5 s is 3e-11 s.
    assert!((fixes[0].time - 243_258.499).abs() < 1e-10);
    assert!((fixes[2196].time - 243_807.499).abs() < 1e-10);
    let steps = fixes.windows(2).map(|pair| pair[1].time - pair[0].time);
    assert!(steps.into_iter().all(|step| (step - 0.25).abs() < 2e-3));
    assert!(
        fixes
            .iter()
            .all(|fix| fix.position.is_some() && fix.velocity.is_some())
    );
    let expected = Geodetic::from_degrees(40.096_626_8, -105.147_448_3, 1601.474);
    assert_eq!(place(&fixes[0]), expected);
    let (velocity, covariance) = fixes[0].velocity.unwrap();
    assert_eq!(velocity, Vector3::new(0.01, -0.002, -0.009));
    assert!(near(covariance[(2, 2)], 0.058_689_9 * 0.058_689_9));
    let fixed = fixes.iter().filter(|fix| fix.quality == FixQuality::Fixed);
    assert_eq!(fixed.count(), 2189);
}

#[test]
fn uav_flight() {
    let format = ImuFormat::new(
        Some(name("t_s")),
        names(["p_radps", "q_radps", "r_radps"]),
        names(["ax_mps2", "ay_mps2", "az_mps2"]),
    );
    let Some((samples, _)) = imu("uav-flight/imu.csv.gz", &format) else {
        return;
    };
    assert_eq!(samples.len(), 34_812);
    assert_eq!((samples[0].time, samples[34_811].time), (0.021, 696.241));
    assert!(near(
        samples[34_811].dvel.z,
        -9.633_111 * samples[34_811].dt
    ));
    let constant = with_stds("alt_m", [3.0; 3], [0.5; 3]);
    let path = find("uav-flight/gnss.csv.gz").unwrap();
    let fixes = gnss(GnssReader::open(&path, &constant.clone().into()).unwrap());
    assert_eq!((fixes.len(), fixes[0].time), (674, 22.041));
    let expected = Geodetic::from_degrees(45.328_828_935, -93.230_936_428, 247.396);
    assert_eq!(place(&fixes[673]), expected);

    // The aircraft's own solution is 0°, 0° until its first fix.
    let format = TruthFormat::degrees(name("t_s"), names(["lat_deg", "lon_deg", "alt_m"]));
    let path = find("uav-flight/onboard.csv.gz").unwrap();
    let mut reader = TruthReader::open(&path, &format.clone().into()).unwrap();
    let count = reader.by_ref().map(Result::unwrap).count() as u64;
    assert_eq!(count, 34_812 - 1239);
    assert_eq!(reader.skipped().count(SkipKind::OutOfRange), 1239);
}

#[test]
fn ublox_drives() {
    let drives = [
        ("mixed-road-long-drive-nominal-001", 141_403, 2737, 1420.236),
        ("parkinglot-maneuvers", 65_893, 1292, 661.907),
        (
            "urban-stop-go-tight-turns-nominal-001",
            52_994,
            1065,
            532.025,
        ),
    ];
    // x up in the sensor: forward-right-down is (z, y, −x) up to the unknown angle.
    let rotation = Matrix3::new(0.0, 0.0, 1.0, 0.0, 1.0, 0.0, -1.0, 0.0, 0.0);
    let format = ImuFormat {
        rotation,
        ..ImuFormat::new(
            Some(name("t_s")),
            names(["gx_radps", "gy_radps", "gz_radps"]),
            names(["ax_mps2", "ay_mps2", "az_mps2"]),
        )
    };
    let in_file = GnssFormat {
        position_std: Some(names(["pos_std_n_m", "pos_std_e_m", "pos_std_d_m"])),
        velocity_std: Some(names(["vel_std_n_mps", "vel_std_e_mps", "vel_std_d_mps"])),
        ..gnss_format("height_m")
    };
    for (drive, rows, fix_rows, last_fix) in drives {
        let Some((samples, _)) = imu(&format!("ublox-drives/{drive}/imu.csv.gz"), &format) else {
            return;
        };
        assert_eq!(samples.len(), rows, "{drive}");
        let path = find(&format!("ublox-drives/{drive}/gnss.csv.gz")).unwrap();
        let fixes = gnss(GnssReader::open(&path, &in_file.clone().into()).unwrap());
        assert_eq!(
            (fixes.len(), fixes[fix_rows - 1].time),
            (fix_rows, last_fix)
        );
        if drive.starts_with("mixed") {
            assert_eq!(samples[0].time, -0.031_669_895_291_328_43);
            assert!(near(samples[0].dvel.z, 9.769_531_25 * samples[0].dt));
            let (_, covariance) = fixes[0].position.unwrap();
            assert!(near(covariance[(2, 2)], 10.758_701_055_424_86f64.powi(2)));
        }
    }
}

#[test]
fn static_record_without_times() {
    let format = ImuFormat {
        gyro_scale: Vector3::repeat(degrees()),
        accel_scale: Vector3::repeat(STANDARD_GRAVITY),
        rate_hz: Some(100.0),
        ..ImuFormat::new(
            None,
            names(["gx_dps", "gy_dps", "gz_dps"]),
            names(["ax_g", "ay_g", "az_g"]),
        )
    };
    let Some((samples, gaps)) = imu("adis16405-static/run2.csv.gz", &format) else {
        return;
    };
    assert_eq!((samples.len(), gaps), (1_000_000, 0));
    assert_eq!((samples[0].time, samples[999_999].time), (0.0, 9999.99));
    let last = samples[999_999];
    assert!(near(last.dtheta.y, 0.3 * degrees() * last.dt));
}

/// Poses of a visual-inertial benchmark as TUM and EuRoC write them; their layouts are found unaided.
#[test]
fn euroc_poses() {
    let read = |file: &str| {
        let path = find(file)?;
        let source = detect(&mut Opened::open(&path).unwrap(), None)
            .unwrap()
            .unwrap();
        let mut reader = PoseReader::open(&path, &source).unwrap();
        let poses: Vec<_> = reader.by_ref().map(Result::unwrap).collect();
        assert!(reader.skipped().is_empty(), "{file}: {}", reader.skipped());
        let PoseSource::Table(format) = source else {
            panic!("{file} is no table");
        };
        Some((poses, format.quaternion_order))
    };
    let Some((poses, order)) = read("euroc-mh01/truth_tum.txt.gz") else {
        return;
    };
    assert_eq!((poses.len(), order), (36_382, QuaternionOrder::Stated));
    let (first, last) = (poses[0], poses[36_381]);
    assert_eq!(
        (first.time, last.time),
        (1_403_636_580.838_56, 1_403_636_762.743_56)
    );
    assert_eq!(
        last.position,
        Some(Vector3::new(4.572_531, -1.942_023, 0.619_62))
    );
    // Six digits, so that the norm is off by as much.
    let q = first.attitude.unwrap();
    assert!((q.w - 0.534_108).abs() < 1e-6 && (q.i + 0.153_029).abs() < 1e-6);
    // At 200 Hz the drone turns by less than two degrees from pose to pose.
    let turned = poses.windows(2).map(|pair| {
        let [before, after] = [0, 1].map(|k| pair[k].attitude.unwrap());
        before.angle_to(&after)
    });
    assert!(turned.fold(0.0, f64::max) < 2.0 * degrees());

    let (poses, _) = read("euroc-mh01/leica0.csv.gz").unwrap();
    assert_eq!(poses.len(), 3099);
    assert!((poses[0].time - 1_403_636_578.922_881_4).abs() < 1e-6);
    let last = Vector3::new(
        4.687_147_660_154_591,
        -1.936_876_261_852_066,
        0.688_083_689_984_525,
    );
    assert_eq!(
        (poses[3098].position, poses[3098].attitude),
        (Some(last), None)
    );
}
