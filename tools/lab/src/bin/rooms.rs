//! Whether the noise that poses show is right and knows how right: simulated rooms of known noise, one a seed, as a user has them: a table
//! of samples and a TUM file, described by `inspect` and tuned.
//!
//! ```text
//! cargo run --release -p undrift-lab --bin rooms -- [seeds] [seconds] [first seed] [misalignment [deg]] [noise]
//! ```
//!
//! For each accuracy of the poses: how many rooms `inspect` describes, how far marker, lever arm and clock are off after `navigate` in their
//! standard deviations, in how many rooms errors of the axes are estimated beside the noise, and for every noise in how many rooms the truth lies inside the 95 % interval of what is said to be determined.
//! With `noise` behind it only the last, in a third of the time: nothing is held out, errors of the axes are not tried, nothing is navigated.

use nalgebra::UnitQuaternion;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use rayon::prelude::*;
use std::path::Path;
use undrift::{
    Drive,
    drive::Logs,
    inspect,
    nav::{
        Matrix3, Vector3,
        attitude::from_rpy,
        parameters::{Parameter, Parameters},
        shaping::ShapingFilter,
    },
    navigate::{Wanted, navigate},
    noise::{BiasModel, ImuModel},
    replay::Settings,
    settings::fix_errors::StdFactors,
    simulate::{GnssNoise, PoseNoise, Trajectory, simulate},
    tune::{self, fit::under, noise::Noise, rest_noise::RestNoise},
};
use undrift_io::Memory;

const RATE: f64 = 200.0;
/// The noise in the hand against that of the preset.
const LOUDER: [f64; 6] = [4.0, 8.0, 3.0, 6.0, 3.0, 5.0];
/// Random walks, gyros [rad/s/√s] and accelerometers [m/s²/√s].
const WALKS: [f64; 6] = [2e-5, 1e-5, 1.5e-5, 1e-3, 2e-3, 1e-3];
/// Poses: standard deviations of position \[m\] and attitude \[rad\], samples from one to the next, and of errors that last, in those, with how long \[s\].
type Poses = (&'static str, f64, f64, usize, f64, f64);
const POSES: [Poses; 4] = [
    ("1 mm, 0.1°, 100 Hz", 0.001, 0.001_745, 2, 0.0, 1.0),
    ("1 cm, 0.5°, 20 Hz", 0.01, 0.008_727, 10, 0.0, 1.0),
    (
        "1 mm, 0.1°, as much lasting 2 s",
        0.001,
        0.001_745,
        2,
        1.0,
        2.0,
    ),
    (
        "1 mm, 0.1°, as much lasting 10 s",
        0.001,
        0.001_745,
        2,
        1.0,
        10.0,
    ),
];

/// What came of one room.
#[derive(Default)]
struct Room {
    /// Whether errors of the axes are estimated beside the noise.
    axes: bool,
    /// Errors of marker, lever arm and clock in standard deviations.
    off: [f64; 7],
    /// Of each noise: whether it is determined, its true value over the one found, and whether that lies inside the interval.
    noise: Vec<(String, bool, f64, bool)>,
    /// Lengths of the outages of the half that the fit has not seen \[s\], and NEES of position and attitude at their ends.
    nees: Vec<(f64, [f64; 2])>,
}

fn room(
    seed: u64,
    seconds: f64,
    misalignment: f64,
    noise_alone: bool,
    (_, position, attitude, every, lasting, correlation_time): Poses,
) -> Result<Room, String> {
    let mut dice = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut vector = |scale: f64| Vector3::from_fn(|_, _| scale * dice.random_range(-1.0..1.0));
    let (marker, lever) = (from_rpy(&vector(3.0)), vector(0.3));
    // Another heading, and a tilt of tenths of a degree.
    let tilt = vector(0.005);
    let rpy = Vector3::new(std::f64::consts::PI + tilt.x, tilt.y, vector(3.0).z);
    let clock = 0.05 * vector(1.0).x;
    let seen = PoseNoise {
        position_std: position,
        attitude_std: attitude,
        lasting: [lasting * position, lasting * attitude],
        correlation_time,
        marker,
        lever_arm: lever,
        frame: from_rpy(&rpy),
        clock,
    };
    let interval = 1.0 / RATE;
    let model = ImuModel::preset("mpu6050").ok_or("a preset")?;
    let mut start = RestNoise::from_model(&model, interval).map_err(|e| e.to_string())?;
    start.turn_on = [8.7e-3, 8.7e-3, 8.7e-3, 0.3, 0.3, 0.3];
    let truth = Noise {
        white: std::array::from_fn(|i| start.white[i] * LOUDER[i]),
        walk: WALKS,
        factors: StdFactors::ONE,
        rule: [0.2, 0.4, 0.15],
    };
    let plain = Settings {
        parameters: Parameters::none(),
        ..Settings::new([ShapingFilter::white(0.0, interval).map_err(|e| e.to_string())?; 6])
    };
    let sensors = under(&plain, &truth, &start)
        .map_err(|e| e.to_string())?
        .sensors;
    let hand = Trajectory::handheld(seconds, 0.6, seed);
    let log = simulate(&hand, RATE, Some(&sensors), &GnssNoise::default(), seed)
        .map_err(|e| e.to_string())?;
    let mut crossed = || 3f64.sqrt() * misalignment * dice.random_range(-1.0..1.0);
    let mut axes = || Matrix3::from_fn(|i, j| if i == j { 1.0 } else { crossed() });
    let (gyros, accelerometers) = (axes(), axes());
    let mut imu = String::from("t,gx,gy,gz,ax,ay,az\n");
    for s in &log.imu {
        let (w, f) = (gyros * s.dtheta / s.dt, accelerometers * s.dvel / s.dt);
        imu += &format!(
            "{:.6},{},{},{},{},{},{}\n",
            s.time, w.x, w.y, w.z, f.x, f.y, f.z
        );
    }
    let mut poses = String::new();
    let rows = log.truth.iter().step_by(every).copied();
    for pose in seen.measure(rows, &hand.start, seed) {
        let (p, q) = (pose.position, pose.attitude);
        poses += &format!(
            "{:.6} {:.6} {:.6} {:.6} {:.8} {:.8} {:.8} {:.8}\n",
            pose.time, p.x, p.y, p.z, q.i, q.j, q.k, q.w
        );
    }
    let held = |text: String| Memory::Bytes(text.into_bytes().into());
    let files = [("imu.csv", held(imu)), ("poses.txt", held(poses))];
    let found = files
        .into_iter()
        .map(|(name, held)| inspect::inspect_held(Path::new(name), held));
    let mut found = found
        .collect::<Result<Vec<_>, _>>()
        .map_err(|e| e.to_string())?;
    let motion = inspect::motion(&mut found);
    let model = inspect::Model {
        preset: "mpu6050",
        known: inspect::Known::Certain,
    };
    let home = Path::new("");
    let say = |_: inspect::Comment| String::new();
    let text = inspect::drive_file(&model, &found, home, None, motion, &say);
    if std::env::var_os("SHOW").is_some() {
        let notes = Vec::from_iter(found.iter().map(|file| &file.found));
        println!("{text}\n{marker:?} {lever:?} {clock} {notes:?}");
    }
    let logs: Logs = inspect::logs(&found, home);
    let read = |text: &str| {
        let read = Drive::with_logs(text, "room.toml", home, logs.clone());
        read.map_err(|e| format!("{e}\n{text}"))
    };
    let mut drive = read(&text)?;
    if let Some(poses) = &mut drive.poses {
        poses.axes_stated = noise_alone;
    }
    let options = tune::Options {
        hold_out: noise_alone.then_some(0.0),
        ..tune::Options::default()
    };
    let goes_on = |stage| !(noise_alone && stage == tune::Stage::Judging);
    let (tuned, _) =
        tune::tune(std::slice::from_ref(&drive), &options, &goes_on).map_err(|e| e.to_string())?;
    let result = tuned.result([]);
    let true_values = truth.white.into_iter().chain(truth.walk);
    let noise = result.parameters.iter().zip(true_values).map(|(p, truth)| {
        let inside = p.low.0 < truth && truth < p.high.0;
        (p.name.clone(), p.determined, truth / p.value.0, inside)
    });
    let noise = noise.collect();
    if noise_alone {
        return Ok(Room {
            noise,
            ..Room::default()
        });
    }
    let model = tuned.model(&["room"]);
    let drive = read(&tune::file::tuned(&text, &tuned, &model, None).map_err(|e| e.to_string())?)?;
    let report = navigate(&drive, BiasModel::Arma, Wanted::default()).map_err(|e| e.to_string())?;
    let get = |kind| {
        let found = report
            .summary
            .parameters
            .iter()
            .find(|(of, ..)| *of == kind);
        found
            .map(|(_, value, std)| (value.clone(), std.clone()))
            .ok_or(format!("{kind:?}"))
    };
    let mut off = [0.0; 7];
    let (turn, std) = get(Parameter::MarkerRotation)?;
    let q_bk = drive.poses.ok_or("poses")?.marker
        * UnitQuaternion::from_scaled_axis(Vector3::from_row_slice(&turn));
    let miss = (q_bk.inverse() * marker).scaled_axis();
    let (arm, arm_std) = get(Parameter::LeverArm)?;
    let arm = drive.lever_arm + Vector3::from_row_slice(&arm) - lever;
    for i in 0..3 {
        off[i] = miss[i] / std[i];
        off[3 + i] = arm[i] / arm_std[i];
    }
    let (late, late_std) = get(Parameter::TimeOffset)?;
    let mut gnss = drive.gnss.1.clone();
    off[6] = (late[0] + *gnss.time_offset() - clock) / late_std[0];
    let nees = tuned.judged.iter().map(|of| {
        let mean = |group: usize| {
            let all = of.nees.iter().map(|nees| nees[1][group]);
            all.sum::<f64>() / of.nees.len() as f64
        };
        (of.length, [mean(0), mean(1)])
    });
    Ok(Room {
        axes: tuned.axes.is_some_and(|axes| axes.kept),
        off,
        noise,
        nees: nees.collect(),
    })
}

/// Prints of how many rooms errors of the axes are estimated, by how much marker, lever arm and clock are off, and NEES.
fn print_states(rooms: &[&Room]) {
    let with = rooms.iter().filter(|room| room.axes).count();
    println!("  errors of the axes are estimated in {with}");
    for (what, at) in [("marker", 0..3), ("lever arm", 3..6), ("clock", 6..7)] {
        let all: Vec<f64> = rooms
            .iter()
            .flat_map(|room| room.off[at.clone()].to_vec())
            .collect();
        let inside = all.iter().filter(|x| x.abs() < 3.0).count() as f64 / all.len() as f64;
        let square = all.iter().map(|x| x * x).sum::<f64>() / all.len() as f64;
        println!(
            "  {what:10} inside 3σ {:.3}, mean square of errors over σ {square:.2}",
            inside
        );
    }
    for length in [1.0, 3.0, 10.0] {
        let of = |group: usize| {
            let all = rooms.iter().flat_map(|room| &room.nees);
            let all = all.filter(|(of, _)| *of == length);
            let all = Vec::from_iter(all.map(|(_, nees)| nees[group]));
            let n = all.len() as f64;
            let mean = all.iter().sum::<f64>() / n;
            let square = all.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
            format!("{mean:.2} ± {:.2}", (square / (n * (n - 1.0))).sqrt())
        };
        println!(
            "  NEES after {length} s: position {}, attitude {}",
            of(0),
            of(1)
        );
    }
}

fn main() {
    let noise_alone = std::env::args().any(|argument| argument == "noise");
    let mut arguments = std::env::args()
        .skip(1)
        .filter(|argument| argument != "noise")
        .map(|a| a.parse::<f64>().expect("a number"));
    let seeds = arguments.next().unwrap_or(20.0) as u64;
    let seconds = arguments.next().unwrap_or(180.0);
    let first = arguments.next().unwrap_or(1.0) as u64;
    let misalignment = arguments.next().unwrap_or(0.0).to_radians();
    for poses in POSES {
        println!("poses of {}, {seeds} rooms of {seconds} s", poses.0);
        let rooms: Vec<_> = (first..first + seeds)
            .into_par_iter()
            .map(|seed| room(seed, seconds, misalignment, noise_alone, poses))
            .collect();
        for (seed, error) in rooms
            .iter()
            .enumerate()
            .filter_map(|(k, room)| Some((k, room.as_ref().err()?)))
        {
            println!("  seed {}: {error}", first + seed as u64);
        }
        let rooms: Vec<&Room> = rooms.iter().flatten().collect();
        let n = rooms.len() as f64;
        if !noise_alone {
            print_states(&rooms);
        }
        println!("  noise                  determined  inside  true/found (geometric mean)");
        let (mut determined, mut inside) = (0, 0);
        for k in 0..12 {
            let of: Vec<_> = rooms.iter().filter_map(|room| room.noise.get(k)).collect();
            let sure: Vec<_> = of
                .iter()
                .filter(|(_, determined, ..)| *determined)
                .collect();
            let within = sure.iter().filter(|(.., inside)| *inside).count();
            let mean = of.iter().map(|(_, _, ratio, _)| ratio.ln()).sum::<f64>() / n;
            (determined, inside) = (determined + sure.len(), inside + within);
            let name = of.first().map_or("", |of| of.0.as_str());
            println!(
                "  {name:22} {:>3} of {n:<4} {within:>5}   {:.2}",
                sure.len(),
                mean.exp()
            );
        }
        println!("  all: {inside} of {determined} inside");
    }
}
