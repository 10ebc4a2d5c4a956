//! Alignment and mounting: simulated cars and flights that start in the middle, and the public drives in
//! `../shared/data`. Skipped, and said so, where the data is missing.

use undrift::{
    align::{AlignSettings, Heading},
    nav::{
        Quaternion, Vector3,
        attitude::{from_rotation_vector, from_rpy},
        filter::Filter,
        sample::{GnssFix, ImuSample, TruthSample},
    },
    noise::{BiasModel, ImuModel},
    replay::{GnssUse, Observer, ReplayError, Settings, Summary, replay},
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

fn settings(heading: Heading) -> Settings {
    let model = ImuModel::preset("adis16405").unwrap();
    Settings {
        sensors: if std::env::var("NOGM").is_ok() {
            let w = |d: f64, c: f64| {
                undrift::nav::shaping::ShapingFilter::white(d, 0.01)
                    .unwrap()
                    .plus(&undrift::nav::shaping::ShapingFilter::constant(c, 0.01).unwrap())
                    .unwrap()
            };
            let g = w(
                std::env::var("GN")
                    .map_or(2.0, |g| g.parse::<f64>().unwrap())
                    .to_radians()
                    / 60.0,
                std::env::var("GB")
                    .map_or(3.0, |g| g.parse::<f64>().unwrap())
                    .to_radians(),
            );
            let a = w(
                0.2 / 60.0,
                std::env::var("AB").map_or(0.05, |g| g.parse::<f64>().unwrap()) * 9.80665,
            );
            [g, g, g, a, a, a]
        } else {
            model.shaping(BiasModel::GaussMarkov, 1.0 / RATE).unwrap()
        },
        lever_arm: Vector3::zeros(),
        gnss_use: GnssUse::Both,
        align: AlignSettings {
            heading,
            ..AlignSettings::default()
        },
        outages: Vec::new(),
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
    fn sample<const N: usize>(&mut self, filter: &Filter<N>) -> Result<(), ReplayError> {
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

    fn fix<const N: usize>(&mut self, _: &Filter<N>, _: &GnssFix, _: bool) {}
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
    let imu = log
        .imu
        .iter()
        .filter(|s| s.time > cut && s.time < end)
        .map(|s| Ok(mounted(s, q_vb)));
    let gnss = log
        .gnss
        .iter()
        .filter(|f| f.time > cut && f.time < end)
        .map(|f| Ok(*f));
    let result = replay(imu, gnss, settings, &mut watch);
    (result, watch)
}

/// A turn drawn from a seed: any axis, any angle.
fn any_mounting(seed: u64) -> Quaternion {
    let u = |k: f64| ((seed as f64 * 0.754_877 + k * 0.569_84).fract() - 0.5) * 2.0;
    from_rotation_vector(&(Vector3::new(u(1.0), u(2.0), u(3.0)) * 3.0))
}

fn started_in_the_middle(name: &str, make: fn(f64, u64) -> Trajectory, gnss: &GnssNoise) {
    let settings = settings(Heading::Auto);
    let (mut runs, mut failed, mut beyond) = (0, 0, 0);
    let (mut nees, mut minute, mut delay, mut std) = (0.0, 0.0, 0.0, 0.0);
    let mut lasts: Vec<f64> = Vec::new();
    let mut worst: f64 = 0.0;
    let seeds = std::env::var("SEEDS").map_or(4, |s| s.parse().unwrap());
    for seed in 0..seeds {
        let trajectory = make(600.0, seed);
        let exact = std::env::var("EXACT").is_ok();
        let quiet = GnssNoise {
            noise_scale: 0.0,
            ..*gnss
        };
        let log = simulate(
            &trajectory,
            RATE,
            if exact { None } else { Some(&settings.sensors) },
            if exact { &quiet } else { gnss },
            seed,
        )
        .unwrap();
        if exact {
            println!("exact");
        }
        for (k, cut) in [75.0, 111.3, 150.0, 203.7, 240.0, 287.0, 330.0, 371.1]
            .into_iter()
            .enumerate()
        {
            let q_vb = any_mounting(seed * 8 + k as u64);
            let (result, watch) = run(&log, &q_vb, cut, &settings);
            runs += 1;
            let Some(started) = watch.started else {
                println!("{name} {seed} {cut}: {}", result.unwrap_err());
                failed += 1;
                continue;
            };
            let ratio = watch.first.0 / watch.first.1;
            if true {
                println!(
                    "{name} {seed} {cut}: {:.2} deg, {ratio:.1} sigma, nees {:.1}, worst {:.1}, {:.2} deg after a minute: {}",
                    watch.first.0.to_degrees(),
                    watch.nees,
                    watch.worst,
                    watch.last.to_degrees(),
                    result.unwrap().alignment
                );
            }
            beyond += usize::from(ratio.abs() > 3.0);
            nees += watch.nees;
            minute += watch.sum / watch.count;
            delay += started - cut;
            std += watch.first.1;
            lasts.push(watch.last);
            worst = worst.max(watch.worst);
        }
    }
    let n = (runs - failed) as f64;
    let rms = (lasts.iter().map(|l| l * l).sum::<f64>() / n)
        .sqrt()
        .to_degrees();
    println!(
        "{name}: {runs} starts, {failed} not aligned, {beyond} beyond 3 sigma; NEES {:.2} of 3; sigma {:.2} deg after {:.1} s; \
         minute after: normalised square {:.2}, worst {worst:.1} sigma, {rms:.2} deg at its end",
        nees / n,
        (std / n).to_degrees(),
        delay / n,
        minute / n
    );
}

#[test]
fn cars_started_in_the_middle() {
    started_in_the_middle("car 5 Hz", Trajectory::car, &receiver());
    let slow = GnssNoise {
        rate_hz: 1.0,
        velocity_std: [0.1; 3],
        ..receiver()
    };
    started_in_the_middle("car 1 Hz", Trajectory::car, &slow);
}

#[test]
fn flights_started_in_the_air() {
    started_in_the_middle("flight 5 Hz", Trajectory::flight, &receiver());
    let slow = GnssNoise {
        rate_hz: 1.0,
        velocity_std: [0.1; 3],
        ..receiver()
    };
    started_in_the_middle("flight 1 Hz", Trajectory::flight, &slow);
}

#[test]
fn zz_baseline() {
    let settings = settings(Heading::Course);
    for (name, make) in [
        ("car", Trajectory::car as fn(f64, u64) -> Trajectory),
        ("flight", Trajectory::flight),
    ] {
        for (what, gnss) in [
            ("5 Hz", receiver()),
            (
                "1 Hz",
                GnssNoise {
                    rate_hz: 1.0,
                    velocity_std: [0.1; 3],
                    ..receiver()
                },
            ),
        ] {
            let (mut sum, mut worst, mut first) = (0.0, 0.0f64, 0.0f64);
            for seed in 0..12 {
                let log = simulate(
                    &make(300.0, seed),
                    RATE,
                    Some(&settings.sensors),
                    &gnss,
                    seed,
                )
                .unwrap();
                let (result, watch) = run(&log, &Quaternion::identity(), 0.0, &settings);
                if seed == 0 {
                    println!("{}", result.unwrap().alignment);
                }
                sum += watch.sum / watch.count / 12.0;
                worst = worst.max(watch.worst);
                first = first.max((watch.first.0 / watch.first.1).abs());
            }
            println!(
                "baseline {name} {what}: normalised square {sum:.2}, worst {worst:.1}, at start worst {first:.1}"
            );
        }
    }
}

#[test]
fn zz_case() {
    let settings = settings(Heading::Auto);
    let trajectory = Trajectory::car(600.0, 3);
    let log = simulate(&trajectory, RATE, Some(&settings.sensors), &receiver(), 3).unwrap();
    let ideal = simulate(&trajectory, RATE, None, &receiver(), 3).unwrap();
    let bias = log
        .imu
        .iter()
        .zip(&ideal.imu)
        .filter(|(a, _)| a.time > 240.0 && a.time < 255.0)
        .fold(Vector3::zeros(), |s, (a, b)| {
            s + (a.dtheta - b.dtheta) / 0.01
        })
        / 1500.0;
    println!("true bias {}", bias.map(f64::to_degrees));
    for t in log
        .truth
        .iter()
        .filter(|t| t.time > 240.0 && t.time < 262.0)
        .step_by(50)
    {
        println!(
            "{:.1} {:.2} {:.2}",
            t.time,
            t.v_n.unwrap().norm(),
            t.rpy.unwrap().z.to_degrees()
        );
    }
    let (r, _w) = run(&log, &Quaternion::identity(), 240.0, &settings);
    println!("{}", r.unwrap().alignment);
}
