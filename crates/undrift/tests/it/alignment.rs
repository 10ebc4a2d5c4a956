//! Alignment and mounting: simulated cars and flights that start in the middle, and the public drives.

use crate::public;
use std::path::{Path, PathBuf};
use undrift::{
    align::{AlignSettings, AttitudeSource, Heading},
    drive::Drive,
    estimator::Estimator,
    io::{
        Opened,
        table::{Column, TableOptions},
        write::{SolutionFile, SolutionFormat, SolutionOptions},
    },
    mounting,
    nav::{
        Quaternion, Vector3,
        attitude::{from_rotation_vector, from_rpy},
        sample::{GnssFix, ImuSample, TruthSample},
    },
    navigate::{Hindsight, Wanted, navigate},
    noise::{BiasModel, ImuModel},
    reference::HORIZONTAL,
    replay::{Measurement, Observer, ReplayError, Settings, Summary, replay},
    simulate::{GnssNoise, Simulation, Trajectory, simulate},
};

const RATE: f64 = 100.0;

/// A receiver as in the public synthetic drive: 5 Hz, 0.05 m/s.
fn receiver() -> GnssNoise {
    GnssNoise {
        position_std: [5.0, 5.0, 10.0],
        velocity_std: [0.05; 3],
        rate_hz: 5.0,
        start: 0.2,
        ..GnssNoise::default()
    }
}

/// Once a second, 0.1 m/s.
fn slow_receiver() -> GnssNoise {
    GnssNoise {
        rate_hz: 1.0,
        velocity_std: [0.1; 3],
        ..receiver()
    }
}

fn settings(heading: Heading) -> Settings {
    let model = ImuModel::preset("adis16405").unwrap();
    Settings {
        align: AlignSettings {
            heading,
            ..AlignSettings::default()
        },
        ..Settings::new(model.shaping(BiasModel::GaussMarkov, 1.0 / RATE).unwrap())
    }
}

/// The IMU turned in the vehicle: `q_vb` takes sensor axes to the vehicle's.
fn mounted(sample: &ImuSample, q_vb: &Quaternion) -> ImuSample {
    ImuSample {
        dtheta: q_vb.inverse() * sample.dtheta,
        dvel: q_vb.inverse() * sample.dvel,
        ..*sample
    }
}

/// Errors of the attitude in standard deviations, at alignment and for a minute after.
struct Watch<'a> {
    truth: &'a [TruthSample],
    q_vb: Quaternion,
    started: Option<f64>,
    /// Heading: error [rad] and standard deviation [rad] at alignment.
    first: (f64, f64),
    /// Normalised square of the whole misalignment at alignment, three degrees of freedom.
    nees: f64,
    /// Squares of heading error over variance in the minute after, and their number.
    sum: f64,
    count: f64,
    worst: f64,
    /// Heading error after the minute [rad].
    last: f64,
}

impl Observer for Watch<'_> {
    fn sample(&mut self, filter: &dyn Estimator) -> Result<(), ReplayError> {
        let time = filter.nav().time;
        let k = self.truth.partition_point(|t| t.time < time - 1e-6);
        let Some(truth) = self.truth.get(k) else {
            return Ok(());
        };
        let q_nb = from_rpy(&truth.rpy.unwrap()) * self.q_vb;
        let psi = (q_nb * filter.nav().q_nb.inverse()).scaled_axis();
        let p = filter.covariance().fixed_view::<3, 3>(6, 6).into_owned();
        let std = p[(2, 2)].sqrt();
        let started = match self.started {
            Some(started) => started,
            None => {
                self.first = (psi.z, std);
                self.nees = psi.dot(&(p.try_inverse().unwrap() * psi));
                *self.started.insert(time)
            }
        };
        if time - started < 60.0 {
            let ratio = psi.z / std;
            self.sum += ratio * ratio;
            self.count += 1.0;
            self.worst = self.worst.max(ratio.abs());
            self.last = psi.z;
        }
        Ok(())
    }
}

/// The log from `cut` [s] on.
fn run<'a>(
    log: &'a Simulation,
    q_vb: &Quaternion,
    cut: f64,
    settings: &Settings,
) -> (Result<Summary, ReplayError>, Watch<'a>) {
    let mut watch = Watch {
        truth: &log.truth,
        q_vb: *q_vb,
        started: None,
        first: (0.0, 0.0),
        nees: 0.0,
        sum: 0.0,
        count: 0.0,
        worst: 0.0,
        last: 0.0,
    };
    let end = cut + 200.0;
    let mut imu = log
        .imu
        .iter()
        .filter(|s| s.time > cut && s.time < end)
        .map(|s| Ok(mounted(s, q_vb)));
    let mut gnss = log
        .gnss
        .iter()
        .filter(|f| f.time > cut && f.time < end)
        .map(|f| Ok(Measurement::Gnss(*f)));
    let result = replay(&mut imu, &mut gnss, settings, &mut watch);
    (result, watch)
}

/// A turn drawn from a seed: any axis, any angle.
fn any_mounting(seed: u64) -> Quaternion {
    let u = |k: f64| ((seed as f64 * 0.754_877 + k * 0.569_84).fract() - 0.5) * 2.0;
    from_rotation_vector(&(Vector3::new(u(1.0), u(2.0), u(3.0)) * 3.0))
}

/// Cuts drives of several seeds at several times and compares the errors with what the filter says of them.
fn started_in_the_middle(name: &str, make: fn(f64, u64) -> Trajectory, gnss: &GnssNoise) {
    let settings = settings(Heading::Auto);
    let seeds = std::env::var("SEEDS").map_or(2, |s| s.parse().unwrap());
    let (mut runs, mut beyond, mut worst) = (0.0, 0.0, 0.0f64);
    // Sums: normalised square of the misalignment, of the heading in the minute after, sigma, delay, last error².
    let mut sums = [0.0; 5];
    for seed in 0..seeds {
        let trajectory = make(600.0, seed);
        let log = simulate(&trajectory, RATE, Some(&settings.sensors), gnss, seed).unwrap();
        for (k, cut) in [75.0, 111.3, 150.0, 203.7, 240.0, 287.0, 330.0, 371.1]
            .into_iter()
            .enumerate()
        {
            let q_vb = any_mounting(seed * 8 + k as u64);
            let (result, watch) = run(&log, &q_vb, cut, &settings);
            let summary = result.unwrap_or_else(|e| panic!("{name} {seed} {cut}: {e}"));
            let ratio = (watch.first.0 / watch.first.1).abs();
            if ratio > 3.0 || watch.worst > 4.0 {
                println!(
                    "{name} {seed} {cut}: {:.2} deg, {ratio:.1} sigma, then at most {:.1}: {:?}",
                    watch.first.0.to_degrees(),
                    watch.worst,
                    summary.alignment
                );
            }
            runs += 1.0;
            beyond += f64::from(ratio > 3.0);
            worst = worst.max(watch.worst);
            let delay = watch.started.unwrap() - cut;
            let values = [
                watch.nees,
                watch.sum / watch.count,
                watch.first.1.to_degrees(),
                delay,
                watch.last.to_degrees().powi(2),
            ];
            for (sum, value) in sums.iter_mut().zip(values) {
                *sum += value;
            }
        }
    }
    let [nees, minute, std, delay, last] = sums.map(|s| s / runs);
    println!(
        "{name}: {runs} starts, {beyond} beyond 3 sigma; NEES {nees:.2} of 3; sigma {std:.2} deg after {delay:.1} s; \
         in the minute after: normalised square {minute:.2}, at most {worst:.1} sigma, {:.2} deg RMS at its end",
        last.sqrt()
    );
    // With 256 starts one is beyond 3 sigma (docs/lab/alignment.md); here one may be.
    assert!(beyond <= 1.0);
    // Of 16 starts: three standard errors of a chi-squared mean of 3 are 1.8.
    assert!(nees < 4.8, "{nees}");
    assert!(minute < 2.0 && worst < 6.0, "{minute} {worst}");
    assert!(std < 1.5 && last.sqrt() < 1.5);
}

#[test]
#[ignore = "slow: 32 starts in 10-minute drives"]
fn cars_started_in_the_middle() {
    started_in_the_middle("car 5 Hz", Trajectory::car, &receiver());
    started_in_the_middle("car 1 Hz", Trajectory::car, &slow_receiver());
}

#[test]
#[ignore = "slow: 32 starts in 10-minute flights"]
fn flights_started_in_the_air() {
    started_in_the_middle("flight 5 Hz", Trajectory::flight, &receiver());
    started_in_the_middle("flight 1 Hz", Trajectory::flight, &slow_receiver());
}

#[test]
fn without_noise_the_attitude_is_exact() {
    let quiet = GnssNoise {
        noise_scale: 0.0,
        lever_arm: Vector3::new(0.4, -0.3, -1.1),
        ..receiver()
    };
    let log = simulate(&Trajectory::car(300.0, 4), RATE, None, &quiet, 4).unwrap();
    let q_vb = any_mounting(5);
    let settings = Settings {
        lever_arm: q_vb.inverse() * quiet.lever_arm,
        ..settings(Heading::Auto)
    };
    let (result, watch) = run(&log, &q_vb, 130.0, &settings);
    result.unwrap();
    // The road's shake at 12 Hz times the lever arm, a few mm/s, is all that is left.
    assert!(watch.first.0.abs() < 0.002, "{}", watch.first.0);
}

fn why_not(imu: &[ImuSample], gnss: &[GnssFix], heading: Heading) -> String {
    let mut imu = imu.iter().map(|s| Ok(*s));
    let mut gnss = gnss.iter().map(|f| Ok(Measurement::Gnss(*f)));
    let message = replay(&mut imu, &mut gnss, &settings(heading), &mut ())
        .unwrap_err()
        .to_string();
    println!("{message}");
    message
}

#[test]
fn a_log_that_cannot_be_aligned_says_why() {
    let make = |trajectory: &Trajectory| {
        let sensors = settings(Heading::Auto).sensors;
        simulate(trajectory, RATE, Some(&sensors), &receiver(), 1).unwrap()
    };
    let rest = make(&Trajectory::rest(60.0));
    for heading in [Heading::Auto, Heading::Course] {
        let why = why_not(&rest.imu, &rest.gnss, heading);
        let still = ["velocity changed by at most 0.", "the vehicle never moved"];
        assert!(still.iter().any(|still| why.contains(still)) && why.contains("initial.heading"));
    }
    let straight = make(&Trajectory::straight(20.0, 0.0, 90.0));
    let why = why_not(&straight.imu, &straight.gnss, Heading::Auto);
    assert!(why.contains("speeding up, braking or turning"));

    let drive = make(&Trajectory::car(200.0, 1));
    let moving: Vec<_> = drive
        .imu
        .iter()
        .filter(|s| s.time > 80.0)
        .copied()
        .collect();
    let mut fixes = drive.gnss.clone();
    fixes.iter_mut().for_each(|fix| fix.time += 1e4);
    let why = why_not(&moving, &fixes, Heading::Auto);
    assert!(why.contains("do not overlap"));
    // Axes mixed up: nothing fits, and it is said.
    let left_handed: Vec<_> = moving
        .iter()
        .map(|s| ImuSample {
            dvel: Vector3::new(-s.dvel.x, s.dvel.y, s.dvel.z),
            ..*s
        })
        .collect();
    let mut alone = drive.gnss.clone();
    alone.iter_mut().for_each(|fix| fix.velocity = None);
    for fixes in [&drive.gnss, &alone] {
        let why = why_not(&left_handed, fixes, Heading::Auto);
        let known = ["are inconsistent", "more than one attitude", "uncertain by"];
        assert!(known.iter().any(|known| why.contains(known)), "{why}");
    }
}

#[test]
#[ignore = "slow: four 10-minute drives"]
fn the_mounting_of_simulated_cars_is_found() {
    let settings = settings(Heading::Auto);
    for seed in 0..4 {
        let log = simulate(
            &Trajectory::car(600.0, seed),
            RATE,
            Some(&settings.sensors),
            &receiver(),
            seed,
        )
        .unwrap();
        let q_vb = any_mounting(seed);
        // From rest and from the middle.
        for cut in [0.0, 130.0] {
            let imu = log
                .imu
                .iter()
                .filter(|s| s.time > cut)
                .map(|s| Ok(mounted(s, &q_vb)));
            let gnss = log
                .gnss
                .iter()
                .filter(|f| f.time > cut)
                .map(|f| Ok(Measurement::Gnss(*f)));
            let found = mounting::estimate(&mut { imu }, &mut { gnss }, &settings).unwrap();
            let error = (found.q_vb * q_vb.inverse()).scaled_axis();
            println!(
                "{seed} {cut}: error {:.2?} deg, {found:?}",
                error.map(f64::to_degrees).as_slice()
            );
            for axis in 0..3 {
                assert!(error[axis].abs() < 3.0 * found.std[axis], "{axis}");
            }
            assert!(found.std.max() < 0.03);
        }
    }
}

#[test]
fn mounting_without_driving_is_refused() {
    let settings = settings(Heading::Auto);
    let log = simulate(&Trajectory::car(600.0, 1), RATE, None, &receiver(), 1).unwrap();
    let imu = log.imu.iter().filter(|s| s.time < 90.0).map(|s| Ok(*s));
    let gnss = log.gnss.iter().map(|f| Ok(Measurement::Gnss(*f)));
    let error = mounting::estimate(&mut { imu }, &mut { gnss }, &settings)
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("of driving above") && error.contains("imu.mounting"),
        "{error}"
    );
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The drive of an example file from `cut` [s] of its time base on, if its data is there.
fn example(name: &str, folder: &str, cut: f64, change: &[(&str, &str)]) -> Option<Drive> {
    let data = public::find(folder)?;
    let home = root().join("examples");
    let mut text = std::fs::read_to_string(home.join(name)).unwrap();
    for (from, to) in change {
        assert!(text.contains(from));
        text = text.replace(from, to);
    }
    text += &format!("\n[span]\nstart = \"{cut} s\"\n");
    Some(Drive::from_toml(&text, name, &home, &data).unwrap_or_else(|e| panic!("{e}")))
}

/// Median of the differences of a solution's and a reference's heading [deg], from `after` [s] on.
fn heading_error(solution: &Path, reference: &Path, after: f64) -> f64 {
    let read = |path: &Path, time: &str, yaw: &str| -> Vec<[f64; 2]> {
        let options = TableOptions {
            columns: vec![
                ("time".into(), Column::Name(time.into())),
                ("yaw".into(), Column::Name(yaw.into())),
            ],
            ..TableOptions::default()
        };
        let mut table = Opened::open(path).unwrap().table(&options).unwrap();
        let mut rows = Vec::new();
        let mut row = [0.0; 2];
        while table.next_row(&mut row).unwrap().is_some() {
            rows.push(row);
        }
        rows
    };
    let reference = read(reference, "t_s", "yaw_deg");
    let mut errors: Vec<f64> = read(solution, "time_s", "yaw_deg")
        .into_iter()
        .filter(|row| row[0] > after)
        .filter_map(|row| {
            let k = reference.partition_point(|r| r[0] < row[0]);
            let difference = row[1] - reference.get(k)?[1];
            Some(((difference + 540.0).rem_euclid(360.0) - 180.0).abs())
        })
        .collect();
    errors.sort_by(f64::total_cmp);
    errors[errors.len() / 2]
}

#[test]
fn ublox_drives_from_any_start() {
    // From when the receiver's own attitude is usable.
    for (name, usable) in [
        ("mixed-road-long-drive-nominal-001", 55.0),
        ("parkinglot-maneuvers", 150.0),
        ("urban-stop-go-tight-turns-nominal-001", 255.0),
    ] {
        for cut in [-1.0, 60.0, 120.0, 200.0] {
            let folder = format!("ublox-drives/{name}");
            let Some(drive) = example("ublox-drives.toml", &folder, cut, &[]) else {
                return;
            };
            let folder = tempfile::tempdir().unwrap();
            let output = folder.path().join("nav.csv");
            let csv = SolutionFormat::Csv;
            let file = SolutionFile::create(&output, csv, &SolutionOptions::default());
            // With the mounting from the whole drive: of a part there may be too little driving to find it on the way.
            let wanted = Wanted {
                files: vec![file.unwrap()],
                hindsight: Hindsight::LookAhead,
                ..Wanted::default()
            };
            let report = navigate(&drive, BiasModel::Arma, wanted).unwrap();
            let reference = drive.imu.0.with_file_name("reference_attitude.csv.gz");
            let heading = heading_error(&output, &reference, usable);
            let (errors, _) = report.rmse.unwrap();
            println!(
                "{name} from {cut} s: {:.2} m RMS, heading {heading:.2} deg median; {:?}\n  {:?}",
                errors.0[HORIZONTAL],
                report.mounting.unwrap(),
                report.summary.alignment
            );
            assert!(report.summary.suspect.is_none());
            assert!(errors.0[HORIZONTAL] < 2.0, "{errors:?}");
            assert!(heading < 1.6, "{heading}");
        }
    }
}

#[test]
fn rtk_drive_mounting_and_starts_in_motion() {
    let auto = (
        "mounting = \"-179.3639, 6.7603, -174.6124 deg\"",
        "mounting = \"auto\"",
    );
    let truth = from_rpy(&Vector3::new(-179.3639, 6.7603, -174.6124).map(f64::to_radians));
    for start in [0.0, 60.0, 150.0] {
        let cut = 243_261.729 + start;
        let Some(drive) = example("rtk-drive.toml", "rtk-drive", cut, &[auto]) else {
            return;
        };
        let wanted = Wanted {
            hindsight: Hindsight::LookAhead,
            ..Wanted::default()
        };
        let report = navigate(&drive, BiasModel::Arma, wanted).unwrap();
        let found = report.mounting.unwrap();
        let error = (found.q_vb * truth.inverse()).scaled_axis();
        println!(
            "{start}: {:.2?} deg, {found:?}; {:?}",
            error.map(f64::to_degrees).as_slice(),
            report.summary.alignment
        );
        for axis in 0..3 {
            assert!(
                error[axis].abs() < 1f64.to_radians().min(3.0 * found.std[axis]),
                "{axis}"
            );
        }
        assert!(report.summary.suspect.is_none());
    }
}

#[test]
fn uav_flight_started_in_the_air() {
    for cut in [400.0, 450.0, 500.0] {
        let Some(drive) = example("uav-flight.toml", "uav-flight", cut, &[]) else {
            return;
        };
        let report = navigate(&drive, BiasModel::Arma, Wanted::default()).unwrap();
        let (errors, _) = report.rmse.unwrap();
        println!("{cut}: {errors:?}, {:?}", report.summary.alignment);
        let source = report.summary.alignment.map(|alignment| alignment.source);
        assert!(matches!(source, Some(AttitudeSource::Motion { .. })));
        assert!(errors.0[7] < 1.5 && errors.0[8] < 1.5 && errors.0[9] < 4.0);
        assert!(errors.0[HORIZONTAL] < 2.0);
    }
}
