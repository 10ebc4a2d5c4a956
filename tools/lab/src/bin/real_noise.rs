//! Closing the loop on real noise: models identified from static records, run through simulated
//! drives whose sensor errors are stretches of another record of the same sensor; beside them one that is
//! identified from three such drives alone, with the data sheet as the sensor at rest. In brackets per cent above the
//! best of all by hindsight.
//!
//! `cargo run --release -p undrift-lab --bin real_noise -- DATA/adis16405-static [DRIVES [RUN …]]`: noise of RUN …, or of
//! all three, models of the two others.

use std::path::Path;
use undrift::{
    identify,
    io::Opened,
    nav::sample::ImuSample,
    noise::{
        AxisModel, BiasModel, GaussMarkov, ImuModel,
        identify::{Axis, Options},
        model_file,
    },
    outages::{self, Schedule},
    record::{self, Record, RecordFormat},
    reference::{HORIZONTAL, rms},
    replay::{Measurement, Settings},
    simulate::{GnssNoise, RecordedErrors, Simulation, Trajectory, simulate},
    tune::{
        fit::{FitLog, fit},
        noise::Noise,
        prior::Prior,
        rest_noise::RestNoise,
        vibrating,
    },
};

const RATE: f64 = 100.0;
const DURATION: f64 = 500.0;
/// Drives that one model is identified from.
const TUNED: usize = 3;

/// Static records of one sensor.
const RUNS: [&str; 3] = ["run1", "run2", "run4"];

type Failure = Box<dyn std::error::Error>;
type Compared = (String, ImuModel, BiasModel);

fn main() -> Result<(), Failure> {
    let mut arguments = std::env::args().skip(1);
    let folder = arguments
        .next()
        .ok_or("usage: real_noise FOLDER [DRIVES [RUN …]]")?;
    let drives: usize = arguments.next().map_or(Ok(20), |n| n.parse())?;
    let ridden: Vec<String> = arguments.collect();
    let records = RUNS
        .map(|run| {
            let path = Path::new(&folder).join(format!("{run}.csv.gz"));
            record::read(Opened::open(&path)?, &RecordFormat::default())
        })
        .into_iter()
        .collect::<Result<Vec<_>, _>>()?;
    let mut models = Vec::new();
    for (run, record) in RUNS.iter().zip(&records) {
        println!("{run}");
        models.push(compared(run, record)?);
    }
    for (own, (run, record)) in RUNS.iter().zip(&records).enumerate() {
        if ridden.is_empty() || ridden.iter().any(|name| name == run) {
            let mut others: Vec<Compared> = Vec::new();
            for (_, models) in models.iter().enumerate().filter(|(of, _)| *of != own) {
                let new = |model: &&Compared| others.iter().all(|other| other.0 != model.0);
                let new: Vec<Compared> = models.iter().filter(new).cloned().collect();
                others.extend(new);
            }
            ride(run, &centred(record), others, drives)?;
        }
    }
    Ok(())
}

/// The models compared, all identified on the record of a run but the data sheet's.
fn compared(run: &str, record: &Record) -> Result<Vec<Compared>, Failure> {
    let found = identify::run(record, &Options::at(RATE), || {});
    let axes: Vec<&Axis> = found
        .axes
        .iter()
        .map(|(_, axis)| axis.as_ref().map_err(|e| e.to_string()))
        .collect::<Result<_, _>>()?;
    for ((name, _), axis) in found.axes.iter().zip(&axes) {
        let reason = model_file::reason(&axis.reason);
        println!("{name}: {} — {reason}", axis.recommended().name);
    }
    let from = |pick: &dyn Fn(&Axis) -> Option<AxisModel>| -> ImuModel {
        let mut model = ImuModel::default();
        for (index, axis) in axes.iter().enumerate() {
            let chosen = pick(axis).unwrap_or_else(|| axis.model());
            if index < 3 {
                model.gyro[index] = chosen;
            } else {
                model.accel[index - 3] = chosen;
            }
        }
        model
    };
    let named = |axis: &Axis, start: &str| {
        axis.candidates
            .iter()
            .find(|c| c.name.starts_with(start))
            .map(|c| c.model.clone())
    };
    let recommended = from(&|axis| Some(axis.model()));
    let mut sheet = ImuModel::preset("adis16405").ok_or("no preset")?;
    for (index, axis) in axes.iter().enumerate() {
        // The same turn-on for all: what differs is the model of what follows.
        let turn_on = axis.model().turn_on;
        if index < 3 {
            sheet.gyro[index].turn_on = turn_on
        } else {
            sheet.accel[index - 3].turn_on = turn_on
        }
    }
    let allan_process = from(&|axis| {
        let fit = axis.allan_gauss_markov?;
        let mut model = named(axis, "white")?;
        model.instability = vec![GaussMarkov {
            sigma: fit.sigma,
            tau_s: fit.tau_c_s,
        }];
        Some(model)
    });
    let of = |name: &str| format!("{name}, {run}");
    Ok(vec![
        (of("white"), recommended.clone(), BiasModel::White),
        (
            of("paper"),
            from(&|axis| named(axis, "ARMA(1,1)")),
            BiasModel::Paper,
        ),
        ("data sheet".to_owned(), sheet, BiasModel::GaussMarkov),
        (
            of("Allan random walk"),
            from(&|axis| named(axis, "white + random walk (Allan)")),
            BiasModel::RandomWalk,
        ),
        (
            of("Allan Gauss-Markov"),
            allan_process,
            BiasModel::GaussMarkov,
        ),
        (
            of("AR(p)"),
            from(&|axis| named(axis, "AR(")),
            BiasModel::Arma,
        ),
        (
            of("ARMA(1,1)"),
            from(&|axis| named(axis, "ARMA(1,1)")),
            BiasModel::Arma,
        ),
        (of("recommended"), recommended, BiasModel::Arma),
    ])
}

/// The record about its means, axis by axis.
fn centred(record: &Record) -> Vec<Vec<f64>> {
    record
        .samples
        .iter()
        .map(|axis| {
            let mean = axis.iter().sum::<f64>() / axis.len() as f64;
            axis.iter().map(|x| x - mean).collect()
        })
        .collect()
}

fn receiver() -> GnssNoise {
    GnssNoise {
        rate_hz: 5.0,
        ..GnssNoise::default()
    }
}

/// An exact drive, and its samples with a stretch of the record's errors.
fn with_errors(axes: &[&[f64]; 6], drive: usize) -> Result<(Simulation, Vec<ImuSample>), Failure> {
    let seed = drive as u64 + 1;
    let trajectory = Trajectory::car(DURATION, seed);
    let simulation = simulate(&trajectory, RATE, None, &receiver(), seed)?;
    let mut noise = RecordedErrors::new(*axes, drive * (DURATION * RATE) as usize);
    let imu = simulation
        .imu
        .iter()
        .map_while(|s| noise.apply(s))
        .collect();
    Ok((simulation, imu))
}

/// The model that drives alone give.
fn tuned(drives: &[(Simulation, Vec<ImuSample>)]) -> Result<ImuModel, Failure> {
    let sheet = ImuModel::preset("adis16405").ok_or("no preset")?;
    let mut start = RestNoise::from_model(&sheet, 1.0 / RATE)?;
    let settings = Settings {
        lever_arm: receiver().lever_arm,
        ..Settings::new(sheet.shaping(BiasModel::RandomWalk, 1.0 / RATE)?)
    };
    let aiding: Vec<_> = drives
        .iter()
        .map(|(drive, _)| Measurement::from_fixes(&drive.gnss))
        .collect();
    let logs: Vec<FitLog> = drives
        .iter()
        .zip(&aiding)
        .map(|((_, imu), aiding)| FitLog {
            imu,
            aiding,
            settings: settings.clone(),
            until: f64::INFINITY,
        })
        .collect();
    start.vibrating = vibrating(&logs);
    let prior = Prior::new(&start, &[&settings]);
    let from = Noise::new(&prior.centre);
    let found = fit(&logs, &start, &prior, from, false, &|_| true)?;
    Ok(start.model(&found.noise.white, &found.noise.walk))
}

fn ride(
    run: &str,
    errors: &[Vec<f64>],
    mut models: Vec<Compared>,
    drives: usize,
) -> Result<(), Failure> {
    let axes: [&[f64]; 6] = std::array::from_fn(|i| errors[i].as_slice());
    println!(
        "\n{run}, {drives} drives of {DURATION} s; RMS over all outages of the largest horizontal error [m]"
    );
    print!("{:28}", "outage");
    let lengths = [(10.0, 35.0), (30.0, 60.0), (60.0, 100.0)];
    for (length, _) in lengths {
        print!(" {:>16}", format!("{length} s"));
    }
    println!();
    // Tuned on the first, which do not judge.
    let seen = (0..TUNED)
        .map(|drive| with_errors(&axes, drive))
        .collect::<Result<Vec<_>, _>>()?;
    models.push(("tuned on drives".to_owned(), tuned(&seen)?, BiasModel::Arma));
    let mut sums = vec![vec![Vec::new(); lengths.len()]; models.len()];
    for drive in TUNED..TUNED + drives {
        let (simulation, imu) = with_errors(&axes, drive)?;
        let gnss = receiver();
        let last = imu
            .last()
            .ok_or("the record is too short for so many drives")?
            .time;
        for (column, (length, every)) in lengths.into_iter().enumerate() {
            let plan = Schedule::Every {
                start: 100.0,
                every,
                count: None,
            };
            let cuts = outages::schedule(&plan, length, 0.0, last - 10.0)?;
            let runs: Vec<(String, Settings)> = models
                .iter()
                .map(|(name, model, kind)| {
                    let settings = Settings {
                        lever_arm: gnss.lever_arm,
                        outages: cuts.clone(),
                        ..Settings::new(model.shaping(*kind, 1.0 / RATE)?)
                    };
                    Ok((name.clone(), settings))
                })
                .collect::<Result<_, Failure>>()?;
            let fixes = Measurement::from_fixes(&simulation.gnss);
            let outcomes = outages::run(&imu, &fixes, &simulation.truth, &runs, &|_| {});
            for (row, (_, result)) in outcomes.into_iter().enumerate() {
                sums[row][column].extend(result?.errors.per_outage.iter().map(|o| o.max));
            }
        }
    }
    let drifts: Vec<Vec<f64>> = sums
        .iter()
        .map(|row| row.iter().map(|errors| rms(errors).0[HORIZONTAL]).collect())
        .collect();
    for ((name, ..), row) in models.iter().zip(&drifts) {
        print!("{name:28}");
        for (column, drift) in row.iter().enumerate() {
            let best = drifts
                .iter()
                .map(|row| row[column])
                .fold(f64::INFINITY, f64::min);
            print!(" {drift:>8.2} ({:>4.1})", 100.0 * (drift / best - 1.0));
        }
        println!();
    }
    Ok(())
}
