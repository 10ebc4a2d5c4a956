//! GNSS epochs between samples, position or velocity alone, and gaps, on exact data.

use undrift::{
    align::AlignSettings,
    estimator::Estimator,
    nav::{Vector3, sample::GnssFix, shaping::ShapingFilter},
    reference::Errors,
    replay::{Aid, GnssUse, Measurement, Observer, Settings, Summary, replay},
    simulate::{GnssNoise, Simulation, Trajectory, simulate},
};

/// Largest horizontal innovation of position [m] and largest of velocity [m/s] before each fix.
#[derive(Default)]
struct Innovations {
    lever: Vector3,
    position: f64,
    velocity: f64,
}

impl Observer for Innovations {
    fn fix(&mut self, filter: &dyn Estimator, fix: &GnssFix, _: bool) {
        let e = Errors::against_fix(filter, fix, &self.lever).0;
        self.position = self.position.max(e[3]);
        self.velocity = self.velocity.max(e[4].abs().max(e[5].abs()));
    }
}

fn exact(time_offset: f64, seed: u64) -> (Simulation, Vector3) {
    let lever_arm = Vector3::new(0.4, -0.3, -1.1);
    let gnss = GnssNoise {
        rate_hz: 1.0,
        time_offset,
        lever_arm,
        noise_scale: 0.0,
        ..GnssNoise::default()
    };
    (
        simulate(&Trajectory::car(180.0, seed), 100.0, None, &gnss, seed).unwrap(),
        lever_arm,
    )
}

fn run(simulation: &Simulation, lever_arm: Vector3, gnss_use: GnssUse) -> (Innovations, Summary) {
    let interval = 0.01;
    let sensor = |density| {
        let white = ShapingFilter::white(density, interval).unwrap();
        white
            .plus(&ShapingFilter::random_walk(density / 100.0, interval).unwrap())
            .unwrap()
    };
    let (gyro, accel) = (sensor(1e-4), sensor(1e-3));
    let first = simulation.gnss[0].time;
    let truth = simulation
        .truth
        .iter()
        .min_by(|a, b| (a.time - first).abs().total_cmp(&(b.time - first).abs()))
        .unwrap();
    let settings = Settings {
        lever_arm,
        gnss_use,
        align: AlignSettings {
            attitude: Some((truth.rpy.unwrap(), Vector3::repeat(1e-4))),
            velocity: Some((Vector3::zeros(), Vector3::repeat(1e-3))),
            ..AlignSettings::default()
        },
        ..Settings::new([gyro, gyro, gyro, accel, accel, accel])
    };
    let mut seen = Innovations {
        lever: lever_arm,
        ..Innovations::default()
    };
    let mut imu = simulation.imu.iter().copied().map(Ok);
    let mut gnss = simulation
        .gnss
        .iter()
        .copied()
        .map(Measurement::Gnss)
        .map(Ok);
    let summary = replay(&mut imu, &mut gnss, &settings, &mut seen).unwrap();
    (seen, summary)
}

#[test]
fn an_epoch_between_samples_is_met_at_its_own_time() {
    // 3.7 ms into an interval of 10 ms, at up to 17 m/s: rounded to a sample it would be off by
    // 63 mm. What remains is there at offset 0 too: the road's shake at 12 Hz, 1e-4 rad, makes the
    // mean rate of 10 ms differ by 5 mrad/s from the rate at its end, times 1.2 m of lever arm.
    for offset in [0.0, 0.0037, 0.0099] {
        let (simulation, lever) = exact(offset, 3);
        let (seen, summary) = run(&simulation, lever, GnssUse::Both);
        println!(
            "offset {offset}: {:.2e} m, {:.2e} m/s",
            seen.position, seen.velocity
        );
        assert!(summary.fixes > 170);
        assert!(seen.position < 5e-3, "{offset}: {} m", seen.position);
        assert!(seen.velocity < 0.012, "{offset}: {} m/s", seen.velocity);
    }
}

#[test]
fn position_alone_and_velocity_alone() {
    let (simulation, lever) = exact(0.0037, 5);
    let (seen, summary) = run(&simulation, lever, GnssUse::Position);
    assert!(
        summary.innovations[Aid::Velocity].updates == 0
            && summary.innovations[Aid::Position].updates > 170
    );
    assert!(seen.position < 5e-3, "{}", seen.position);
    let (seen, summary) = run(&simulation, lever, GnssUse::Velocity);
    assert!(
        summary.innovations[Aid::Position].updates == 0
            && summary.innovations[Aid::Velocity].updates > 170
    );
    // The position is the integral of an exact velocity from an exact start.
    assert!(
        seen.position < 0.05 && seen.velocity < 0.012,
        "{} {}",
        seen.position,
        seen.velocity
    );
}

#[test]
fn a_short_gap_is_bridged_and_a_long_one_grows_the_covariance() {
    let (mut simulation, lever) = exact(0.0, 7);
    let cut = |simulation: &mut Simulation, from: f64, to: f64| {
        simulation.imu.retain(|s| !(s.time > from && s.time < to));
        let after = simulation.imu.iter_mut().find(|s| s.time >= to).unwrap();
        let missing = after.time - from;
        let scale = missing / after.dt;
        after.dt = missing;
        after.dtheta *= scale;
        after.dvel *= scale;
    };
    cut(&mut simulation, 100.0, 100.055);
    let (seen, summary) = run(&simulation, lever, GnssUse::Both);
    assert_eq!((summary.bridged, summary.long_gaps), (1, None));
    // 60 ms over which the rates are taken as straight lines: 10 deg/s² of change is 1e-2 deg.
    assert!(seen.position < 0.05, "{}", seen.position);

    cut(&mut simulation, 120.0, 123.0);
    let (_, summary) = run(&simulation, lever, GnssUse::Both);
    let (count, first, longest) = summary.long_gaps.unwrap();
    assert_eq!(count, 1);
    assert!(
        (first - 120.0).abs() < 1e-6 && (longest - 3.0).abs() < 0.02,
        "{first} {longest}"
    );
    // Grown by what a vehicle can do in 3 s, the filter takes the next fixes without complaint.
    assert!(
        summary.suspect.is_none() && summary.innovations[Aid::Position].per_dof().unwrap() < 2.0
    );
}
