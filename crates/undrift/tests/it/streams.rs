//! Odometer and barometer on a simulated car: what they are worth in an outage, whether their errors
//! are estimated, and whether the filter is honest about them.

use undrift::{
    align::{AlignSettings, Heading},
    nav::{
        Vector3,
        parameters::{Parameter, Parameters, Prior},
        sample::{GnssFix, Scalar},
        shaping::ShapingFilter,
    },
    outages::{self, ModelRun},
    reference::HORIZONTAL,
    replay::{Aid, Innovations, Measurement, Outage, Settings, merge},
    simulate::{Barometer, GnssNoise, Odometer, Simulation, Trajectory, simulate},
};

const RATE: f64 = 100.0;
const WHEEL: Vector3 = Vector3::new(-0.8, 0.7, 0.4);

/// A cheap IMU: white noise of gyros and accelerometers, the standard deviations of biases that stay, and by how much they walk.
pub(super) fn cheap_imu(gyro: [f64; 3], accel: [f64; 3], rate_hz: f64) -> [ShapingFilter; 6] {
    let dt = 1.0 / rate_hz;
    let [gyro, accel] = [gyro, accel].map(|[white, turn_on, walk]| {
        let bias = ShapingFilter::random_walk(walk, dt).unwrap();
        let start = ShapingFilter::constant(turn_on, dt).unwrap();
        let white = ShapingFilter::white(white, dt).unwrap();
        white.plus(&bias).unwrap().plus(&start).unwrap()
    });
    [gyro, gyro, gyro, accel, accel, accel]
}

/// 1 deg/√h and 0.18 m/s/√h, biases of 0.3 deg/s and 10 mg that walk 0.04 deg/s and 2 mg in a quarter of an hour.
fn sensors() -> [ShapingFilter; 6] {
    cheap_imu([3e-4, 5e-3, 2e-5], [3e-3, 0.1, 6e-4], RATE)
}

struct Drive {
    log: Simulation,
    odometer: Vec<Scalar>,
    barometer: Vec<Scalar>,
}

fn drive(seed: u64) -> Drive {
    let car = Trajectory::car(500.0, seed);
    let odometer = Odometer {
        lever_arm: WHEEL,
        ..Odometer::default()
    };
    let gnss = GnssNoise {
        position_std: [1.5, 1.5, 3.0],
        velocity_std: [0.05, 0.05, 0.1],
        ..GnssNoise::default()
    };
    Drive {
        log: simulate(&car, RATE, Some(&sensors()), &gnss, seed).unwrap(),
        odometer: odometer.measure(&car, seed).unwrap().collect(),
        barometer: Barometer::default().measure(&car, seed).unwrap().collect(),
    }
}

/// The GNSS cut for 60 s from each start on, with the logs given beside it.
fn run(drive: &Drive, starts: &[f64], odometer: bool, barometer: bool) -> ModelRun {
    let mut parameters = Parameters::none();
    let prior = |std, walk| Prior {
        std,
        walk,
        ..Prior::default()
    };
    if odometer {
        parameters = parameters.with(Parameter::OdometerScale, prior(0.03, 0.0));
    }
    if barometer {
        parameters = parameters.with(Parameter::BarometerBias, prior(100.0, 0.05));
    }
    // It is at rest at first, so this is its heading until it drives.
    let heading = drive.log.truth[0].rpy.unwrap().z;
    let mut settings = Settings {
        parameters,
        outages: starts
            .iter()
            .map(|&start| Outage {
                start,
                end: start + 60.0,
            })
            .collect(),
        align: AlignSettings {
            heading: Heading::Given(heading, 0.02),
            ..AlignSettings::default()
        },
        ..Settings::new(sensors())
    };
    settings.constraints.odometer_lever = WHEEL;
    let fix = |fix: &GnssFix| Ok::<_, ()>(Measurement::Gnss(*fix));
    let speeds = drive.odometer.iter().filter(|_| odometer);
    let heights = drive.barometer.iter().filter(|_| barometer);
    let aiding: Result<Vec<_>, ()> = merge(
        drive.log.gnss.iter().map(fix),
        merge(
            speeds.map(|s| Ok(Measurement::Odometer(*s))),
            heights.map(|s| Ok(Measurement::Barometer(*s))),
        ),
    )
    .collect();
    let models = [("test".to_owned(), settings)];
    let runs = outages::run(
        &drive.log.imu,
        &aiding.unwrap(),
        &drive.log.truth,
        &models,
        &|_| {},
    );
    runs.into_iter().next().unwrap().1.unwrap()
}

/// The whitened innovations of an honest filter are independent, so the mean of n squares has a
/// standard deviation of √(2/n): it must lie within the 95 % bounds of six drives together.
fn honest(what: &str, sums: &[Innovations]) {
    let n: u64 = sums.iter().map(|s| s.dof_sum).sum();
    let nis = sums.iter().map(|s| s.nis_sum).sum::<f64>() / n as f64;
    let left_out: u64 = sums.iter().map(|s| s.rejected).sum();
    println!("{what}: NIS {nis:.4} of {n}, {left_out} left out");
    let bound = 1.96 * (2.0 / n as f64).sqrt();
    assert!((nis - 1.0).abs() < bound, "{what}: {nis}, bound {bound}");
    assert_eq!(left_out, 0);
}

#[test]
#[ignore = "slow: 18 drives of 500 s"]
fn odometer_and_barometer_hold_a_drive_through_outages() {
    let (mut odometer, mut barometer) = (Vec::new(), Vec::new());
    let (mut alone, mut aided) = ([0.0; 2], [0.0; 2]);
    for seed in 1..=6 {
        let drive = drive(seed);
        let starts = [200.0, 300.0, 400.0];
        let without = run(&drive, &starts, false, false);
        let with = run(&drive, &starts, true, true);
        // In an outage the heading's error is degrees, and its square, which no covariance has, is
        // centimetres a second of forward speed: judged without outages.
        let with_gnss = run(&drive, &[], true, true);
        for (sums, run) in [(&mut alone, &without), (&mut aided, &with)] {
            let rms = run.errors.rms.0;
            sums[0] += rms[HORIZONTAL] * rms[HORIZONTAL] / 6.0;
            sums[1] += rms[2] * rms[2] / 6.0;
        }
        println!(
            "seed {seed}: largest horizontal error {:.1} m, with odometer {:.1} m; height {:.1} m, with barometer {:.2} m",
            without.errors.rms.0[HORIZONTAL],
            with.errors.rms.0[HORIZONTAL],
            without.errors.rms.0[2],
            with.errors.rms.0[2]
        );
        odometer.push(with_gnss.summary.innovations[Aid::Odometer]);
        barometer.push(with_gnss.summary.innovations[Aid::Barometer]);
        let of = |kind| {
            let found = with.summary.parameters.iter().find(|p| p.0 == kind);
            let (_, value, std) = found.unwrap();
            (value[0], std[0])
        };
        let (scale, std) = of(Parameter::OdometerScale);
        println!("scale {scale:.5} ± {std:.5}");
        assert!(
            std < 5e-4 && (scale - 0.02).abs() < 4.0 * std,
            "{scale} {std}"
        );
        let (bias, std) = of(Parameter::BarometerBias);
        let last = drive.log.truth.last().unwrap();
        let error = drive.barometer.last().unwrap().value - last.position.height;
        // The last height's own noise is 0.3 m.
        assert!(
            std < 1.0 && (bias - error).abs() < 4.0 * 0.3f64.hypot(std),
            "{bias} {error}"
        );
    }
    let [alone, aided] = [alone, aided].map(|squares| squares.map(f64::sqrt));
    println!("RMS of the largest: horizontal and height {alone:.2?} m, aided {aided:.2?} m");
    // What is left is mostly the heading's: the odometer says how far, not where to.
    assert!(aided[0] < alone[0] / 4.0 && aided[1] < alone[1] / 8.0);
    honest("odometer", &odometer);
    honest("barometer", &barometer);
}
