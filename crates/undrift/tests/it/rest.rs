//! The rest detector on a simulated car and on the public drives: what it takes
//! for rest while GNSS says that the vehicle moves, and how many of the stops it finds, with the
//! GNSS and where it is cut. Skipped, and said so, where the data is missing.

use std::path::Path;
use undrift::{
    align::Heading,
    drive::Drive,
    estimator::Estimator,
    nav::{
        sample::{GnssFix, ImuSample},
        shaping::ShapingFilter,
    },
    navigate::settings,
    noise::BiasModel,
    replay::{Measurement, Observer, Outage, Settings, replay},
    simulate::{GnssNoise, Trajectory, simulate},
    vehicle::Profile,
};

/// Speed above which a vehicle moves, and below which it is at rest [m/s].
const MOVES: f64 = 0.5;
const AT_REST: f64 = 0.1;

/// Blocks judged: in motion and taken for rest, at rest and found, all at rest; without GNSS apart.
#[derive(Default)]
struct Verdicts {
    gnss: Counts,
    cut: Counts,
}

#[derive(Default)]
struct Counts {
    moving: u32,
    wrong: u32,
    first_wrong: Option<f64>,
    standing: u32,
    found: u32,
}

impl Counts {
    /// Nothing in motion was taken for rest, and this part of the stops was found.
    #[track_caller]
    fn check(&self, found: f64) {
        assert_eq!(self.wrong, 0, "at {:?} s", self.first_wrong);
        assert!(f64::from(self.found) >= found * f64::from(self.standing));
    }
}

struct Watch<'a> {
    /// Times and speeds over ground.
    speeds: &'a [(f64, f64)],
    outages: &'a [Outage],
    at: usize,
    seen: Verdicts,
}

impl Observer for Watch<'_> {
    fn judged(&mut self, filter: &dyn Estimator, rest: bool) {
        let end = filter.nav().time;
        // Known only from fixes that are not far apart, from before the block to after it.
        while self.at + 1 < self.speeds.len() && self.speeds[self.at + 1].0 <= end - 0.5 {
            self.at += 1;
        }
        let around: Vec<_> = self.speeds[self.at..]
            .iter()
            .take_while(|(time, _)| *time < end + 1.0)
            .collect();
        if around.is_empty()
            || around[0].0 > end - 0.5
            || around[around.len() - 1].0 < end
            || around.windows(2).any(|w| w[1].0 - w[0].0 > 1.1)
        {
            return;
        }
        let outage = self.outages.iter().find(|o| o.contains(end));
        let counts = match outage {
            // Past the time for which the last speed holds.
            Some(outage) if end > outage.start + 2.5 => &mut self.seen.cut,
            Some(_) => return,
            None => &mut self.seen.gnss,
        };
        if around.iter().all(|(_, v)| *v > MOVES) {
            counts.moving += 1;
            counts.wrong += u32::from(rest);
            if rest {
                counts.first_wrong.get_or_insert(end);
            }
        } else if around.iter().all(|(_, v)| *v < AT_REST) {
            counts.standing += 1;
            counts.found += u32::from(rest);
        }
    }
}

fn judge(name: &str, imu: &[ImuSample], gnss: &[GnssFix], settings: &Settings) -> [Verdicts; 2] {
    let speeds: Vec<(f64, f64)> = gnss
        .iter()
        .filter_map(|fix| Some((fix.time, fix.velocity?.0.xy().norm())))
        .collect();
    let first = speeds[0].0;
    // Cut for 40 s of every minute.
    let cuts: Vec<Outage> = (1..)
        .map(|k| first + 60.0 * f64::from(k))
        .take_while(|start| *start < speeds[speeds.len() - 1].0)
        .map(|start| Outage {
            start,
            end: start + 40.0,
        })
        .collect();
    [&[][..], &cuts].map(|outages| {
        let mut settings = Settings {
            constraints: Profile::Pedestrian.constraints(),
            ..settings.clone()
        };
        settings.outages = outages.to_vec();
        let mut watch = Watch {
            speeds: &speeds,
            outages,
            at: 0,
            seen: Verdicts::default(),
        };
        let mut fixes = gnss.iter().copied().map(Measurement::Gnss).map(Ok);
        replay(&mut imu.iter().copied().map(Ok), &mut fixes, &settings, &mut watch).unwrap();
        for (what, counts) in [("GNSS", &watch.seen.gnss), ("cut", &watch.seen.cut)] {
            if counts.moving + counts.standing > 0 {
                println!(
                    "{name}, {what}: {} of {} blocks in motion taken for rest (first at {:?}), {} of {} at rest found",
                    counts.wrong, counts.moving, counts.first_wrong, counts.found, counts.standing
                );
            }
        }
        watch.seen
    })
}

#[test]
fn simulated_car() {
    for (seed, white) in [(1, (1e-4, 1e-3)), (2, (3e-4, 3e-3)), (3, (1e-3, 1e-2))] {
        let dt = 0.01;
        let axis = |white: f64, walk: f64, turn_on: f64| {
            let white = ShapingFilter::white(white, dt).unwrap();
            let walk = ShapingFilter::random_walk(walk, dt).unwrap();
            let turn_on = ShapingFilter::constant(turn_on, dt).unwrap();
            white.plus(&walk).unwrap().plus(&turn_on).unwrap()
        };
        let gyro = axis(white.0, 1e-5, 5e-3);
        let accel = axis(white.1, 1e-4, 0.1);
        let sensors = [gyro, gyro, gyro, accel, accel, accel];
        let car = Trajectory::car(1200.0, seed);
        let gnss = GnssNoise {
            rate_hz: 2.0,
            ..GnssNoise::default()
        };
        let log = simulate(&car, 100.0, Some(&sensors), &gnss, seed).unwrap();
        let mut settings = Settings::new(sensors);
        settings.align.heading = Heading::Given(log.truth[0].rpy.unwrap().z, 0.02);
        let [whole, with_cuts] = judge(&format!("car {seed}"), &log.imu, &log.gnss, &settings);
        whole.gnss.check(0.98);
        with_cuts.gnss.check(0.98);
        // The simulated road is smoother than any real one: under a noisy IMU only GNSS distinguishes driving from
        // rest, and without it rest must not be taken for granted.
        with_cuts.cut.check(if seed == 1 { 0.98 } else { 0.0 });
    }
}

/// An example file on a public drive, its heading given so that it starts at rest.
fn public(example: &str, folder: &str, heading: Option<f64>, found: [f64; 3]) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let Some(data) = crate::public::find(folder) else {
        return;
    };
    let drive = Drive::load(&root.join("examples").join(example), Some(&data)).unwrap();
    let mut settings = settings(&drive, BiasModel::Arma).unwrap();
    if let Some(heading) = heading {
        settings.align.heading = Heading::Given(heading, 0.3);
    }
    let imu: Result<Vec<_>, _> = drive.open_imu().unwrap().collect();
    let gnss: Result<Vec<_>, _> = drive.open_gnss().unwrap().collect();
    let [whole, with_cuts] = judge(folder, &imu.unwrap(), &gnss.unwrap(), &settings);
    whole.gnss.check(found[0]);
    with_cuts.gnss.check(found[1]);
    with_cuts.cut.check(found[2]);
}

#[test]
fn public_drives() {
    public("rtk-drive.toml", "rtk-drive", Some(0.0), [0.95; 3]);
    // 122 of 157, 22 of 49 and 8 of 94: the solution has a wrong heading and gyro bias, and
    // rest is only what agrees with the solution. None of it is false, which is what matters.
    public(
        "uav-flight.toml",
        "uav-flight",
        Some(2.4),
        [0.75, 0.4, 0.05],
    );
    for drive in [
        "mixed-road-long-drive-nominal-001",
        "parkinglot-maneuvers",
        "urban-stop-go-tight-turns-nominal-001",
    ] {
        public(
            "ublox-drives.toml",
            &format!("ublox-drives/{drive}"),
            None,
            [0.98, 0.98, 0.91],
        );
    }
}
