//! Whether identification from a drive is right and knows how right: simulated drives of known noise, one a seed.
//!
//! ```text
//! cargo run --release -p undrift-lab --bin tune_coverage -- [seeds] [seconds] [first seed] [following]
//! ```
//!
//! For every parameter: in how many drives the true value lies inside the 95 % interval, in how many it is said to be
//! determined, and in how many of those it lies inside; and the drift of the noise found against that of the true one, on
//! another drive. With `following` of white noise that follows the vibration: the factors, which are 1 here.

use rayon::prelude::*;
use undrift::{
    nav::{parameters::Parameters, shaping::ShapingFilter},
    settings::fix_errors::StdFactors,
};
use undrift::{
    noise::ImuModel,
    outages::run,
    reference::HORIZONTAL,
    replay::{Measurement, Outage, Settings},
    simulate::{GnssNoise, Trajectory, simulate},
    tune::{
        fit::{FitLog, fit, under},
        noise::{COUNT, FIX, Noise, WALK},
        prior::{INTERVAL, Prior},
        rest_noise::RestNoise,
        vibrating,
    },
};

const RATE: f64 = 50.0;
/// The noise in the vehicle against that of the preset, axis by axis.
const LOUDER: [f64; 6] = [4.0, 12.0, 3.0, 8.0, 3.0, 6.0];
/// Random walks, gyros [rad/s/√s] and accelerometers [m/s²/√s].
const WALKS: [f64; 6] = [2e-5, 1e-5, 1.5e-5, 1e-3, 2e-3, 1e-3];

fn receiver() -> GnssNoise {
    GnssNoise {
        position_std: [0.5, 0.5, 1.0],
        velocity_std: [0.05; 3],
        rate_hz: 1.0,
        start: 0.2,
        ..GnssNoise::default()
    }
}

/// Of one seed: whether each parameter was determined, and what was found against the truth in standard deviations; and
/// the mean squares of the drift with the noise found and with the true one.
fn one(seed: u64, seconds: f64, following: bool) -> ([(bool, f64); COUNT], [f64; 2]) {
    let interval = 1.0 / RATE;
    let model = ImuModel::preset("mpu6050").expect("a preset");
    let mut start = RestNoise::from_model(&model, interval).expect("a model");
    start.turn_on = [8.7e-3, 8.7e-3, 8.7e-3, 0.3, 0.3, 0.3];
    let truth = Noise {
        white: std::array::from_fn(|i| start.white[i] * LOUDER[i]),
        walk: WALKS,
        factors: StdFactors::ONE,
        rule: [0.2, 0.4, 0.15],
    };
    let plain = Settings {
        parameters: Parameters::none(),
        ..Settings::new([ShapingFilter::white(0.0, interval).expect("white noise"); 6])
    };
    let of_truth = under(&plain, &truth, &start).expect("a filter");
    let (plain, truth) = match following {
        true => (
            Settings {
                vibration: Some([1.0; 6]),
                ..plain
            },
            Noise {
                white: [1.0; 6],
                ..truth
            },
        ),
        false => (plain, truth),
    };
    let drive = |seed| {
        let trajectory = Trajectory::car(seconds, seed);
        simulate(
            &trajectory,
            RATE,
            Some(&of_truth.sensors),
            &receiver(),
            seed,
        )
        .expect("a drive")
    };
    let aiding = |gnss: &[_]| {
        gnss.iter()
            .copied()
            .map(Measurement::Gnss)
            .collect::<Vec<_>>()
    };
    let log = drive(seed);
    let fixes = aiding(&log.gnss);
    let logs = [FitLog {
        imu: &log.imu,
        aiding: &fixes,
        settings: plain.clone(),
        until: f64::INFINITY,
    }];
    start.vibrating = vibrating(&logs);
    let prior = Prior::new(&start, &[&plain]);
    let found = fit(
        &logs,
        &start,
        &prior,
        Noise::new(&prior.centre),
        true,
        &|_| true,
    )
    .expect("a fit");
    let (z, at) = (found.noise.ln(), truth.ln());
    let off = std::array::from_fn(|i| {
        let (low, high) = found.interval[i];
        let side = if at[i] < z[i] {
            z[i] - low
        } else {
            high - z[i]
        };
        let std = side / INTERVAL;
        (found.determines(&prior, i), (z[i] - at[i]) / std)
    });
    // Another drive of the same sensor.
    let other = drive(seed + 1_000_000);
    let fixes = aiding(&other.gnss);
    let outages: Vec<Outage> = (0..)
        .map(|k| 90.0 + 60.0 * f64::from(k))
        .take_while(|start| start + 30.0 < seconds)
        .map(|start| Outage {
            start,
            end: start + 30.0,
        })
        .collect();
    let judged = [found.noise, truth].map(|noise| {
        let settings = Settings {
            outages: outages.clone(),
            ..under(&plain, &noise, &start).expect("a filter")
        };
        let done = run(
            &other.imu,
            &fixes,
            &other.truth,
            &[(String::new(), settings)],
            &|_| (),
        );
        let errors = &done[0].1.as_ref().expect("a run").errors.per_outage;
        errors
            .iter()
            .map(|o| o.max.0[HORIZONTAL].powi(2))
            .sum::<f64>()
            / errors.len() as f64
    });
    (off, judged)
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let following = std::env::args().any(|argument| argument == "following");
    let mut number = |default: f64| {
        let given = arguments.next();
        given.map_or(default, |n| n.parse().expect("a number"))
    };
    let (seeds, seconds) = (number(100.0) as u64, number(900.0));
    let first = number(1.0) as u64;
    let done: Vec<_> = (first..first + seeds)
        .into_par_iter()
        .map(|seed| one(seed, seconds, following))
        .collect();
    let name = |i: usize| match i {
        0..WALK => format!("white noise of {}", ["gx", "gy", "gz", "ax", "ay", "az"][i]),
        WALK..FIX => format!(
            "random walk of {}",
            ["gx", "gy", "gz", "ax", "ay", "az"][i - WALK]
        ),
        i => ["positions' σ", "velocities' σ"]
            .get(i - FIX)
            .copied()
            .unwrap_or("other")
            .to_owned(),
    };
    println!("{seeds} drives of {seconds} s");
    for i in 0..FIX + 2 {
        let held = |off: &f64| off.abs() < INTERVAL;
        let all = done.iter().filter(|(off, _)| held(&off[i].1)).count();
        let determined = done.iter().filter(|(off, _)| off[i].0);
        let off: Vec<f64> = determined.map(|(off, _)| off[i].1).collect();
        let inside = off.iter().filter(|off| held(off)).count();
        let n = off.len().max(1) as f64;
        let mean = off.iter().sum::<f64>() / n;
        let rms = (off.iter().map(|o| o * o).sum::<f64>() / n).sqrt();
        println!(
            "{:24} inside in {all:3}; determined in {:3}, of these inside {:3} ({:.0} %), mean {mean:+.2} σ, root mean square {rms:.2} σ",
            name(i),
            off.len(),
            inside,
            100.0 * inside as f64 / n
        );
    }
    let sum = |k: usize| done.iter().map(|(_, judged)| judged[k]).sum::<f64>();
    println!(
        "drift at 30 s against that of the true noise: {:.3} times",
        (sum(0) / sum(1)).sqrt()
    );
}
