//! One task on a raw little-endian f64 record, for the comparison with Python packages: prints the
//! result, the CPU time of the task alone and the peak memory of the process as one line of JSON.
//!
//! `cargo run --release -p undrift-lab --bin peers TASK FILE [REPEATS]`, TASK an arm of `run`
//! below. Linux only. `benches/peers/run` drives it.

#[path = "../../../../benches/peers/process.rs"]
mod process;

use process::measured;
use std::error::Error;
use std::fs::File;
use std::hint::black_box;
use std::io::{BufReader, Read};
use undrift_noise::allan::{DeviationKind, Grid, deviations, intervals};
use undrift_noise::arma::{FitOptions, Mean, fit};
use undrift_noise::correlation::autocorrelation;
use undrift_noise::normality::{jarque_bera, normality};
use undrift_noise::pandit_wu::{PanditWuOptions, pandit_wu};
use undrift_noise::stationarity::{Deterministic, KpssLags, Lags, adf, kpss, phillips_perron};
use undrift_noise::whiteness::portmanteau;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(task), Some(path)) = (arguments.next(), arguments.next()) else {
        return Err("usage: peers TASK FILE [REPEATS]".into());
    };
    let repeats: usize = arguments.next().map_or(Ok(1), |text| text.parse())?;
    let record = read(&path)?;
    let (values, taken) = measured(repeats, || Ok(black_box(run(&task, black_box(&record))?)))?;
    println!("{{\"values\":{values:?},{taken}}}");
    Ok(())
}

/// The numbers that the task answers with, in the order that `compare.py` expects.
fn run(task: &str, record: &[f64]) -> Result<Vec<f64>, Box<dyn Error>> {
    Ok(match task {
        "arma_1_1" => arma(record, 1, 1)?,
        "arma_2_1" => arma(record, 2, 1)?,
        "arma_4_3" => arma(record, 4, 3)?,
        "pandit_wu" => {
            let options = PanditWuOptions {
                n_max: 2,
                fit: known_mean(),
                ..PanditWuOptions::default()
            };
            let table = pandit_wu(record, &options)?;
            let orders = [table.by_f, table.by_bic_step_down];
            let likelihoods = [(1, 0), (1, 1), (2, 1), (3, 2), (4, 3)]
                .map(|order| table.fit(order).map_or(f64::NAN, |fit| fit.log_likelihood));
            orders
                .iter()
                .flat_map(|&(p, q)| [p as f64, q as f64])
                .chain(likelihoods)
                .collect()
        }
        "allan" => allan(record, DeviationKind::Overlapping, Grid::Octave)?,
        "allan_all" => allan(record, DeviationKind::Overlapping, Grid::All)?,
        "allan_modified" => allan(record, DeviationKind::Modified, Grid::Octave)?,
        "allan_hadamard" => allan(record, DeviationKind::Hadamard, Grid::Octave)?,
        "allan_intervals" => {
            let curve = deviations(record, 100.0, DeviationKind::Overlapping, Grid::Octave)?;
            black_box(intervals(record, &curve, 0.683)?);
            let points = curve.points.iter();
            points.flat_map(|p| [p.tau_s, p.deviation]).collect()
        }
        "adf" => {
            let test = adf(record, Deterministic::Constant, Lags::Fixed(20))?;
            vec![test.statistic, test.p_value]
        }
        "kpss" => {
            let test = kpss(record, Deterministic::Constant, KpssLags::Fixed(40))?;
            vec![test.statistic, test.p_value]
        }
        "acf" => autocorrelation(record, 100)?,
        "ljung_box" => {
            let test = portmanteau(record, &[20], 0)?[0];
            vec![test.ljung_box, test.ljung_box_p]
        }
        "jarque_bera" => {
            let test = jarque_bera(record)?;
            vec![test.statistic, test.p_value]
        }
        "normality" => {
            let test = normality(record)?;
            vec![
                test.jarque_bera.statistic,
                test.jarque_bera.p_value,
                test.ks.statistic,
            ]
        }
        "phillips_perron" => {
            let test = phillips_perron(record, Deterministic::Constant, None)?;
            vec![test.z_tau, test.p_value, test.lags as f64]
        }
        _ => return Err(format!("no task {task}").into()),
    })
}

fn known_mean() -> FitOptions {
    FitOptions {
        mean: Mean::Known(0.0),
        ..FitOptions::default()
    }
}

/// φ, θ, σ and the log-likelihood.
fn arma(record: &[f64], p: usize, q: usize) -> Result<Vec<f64>, Box<dyn Error>> {
    let model = fit(record, p, q, &known_mean())?;
    let rest = [model.sigma, model.log_likelihood];
    Ok([model.ar, model.ma, rest.to_vec()].concat())
}

/// τ and deviation in turns; of all τ at most 50 000.
fn allan(record: &[f64], kind: DeviationKind, grid: Grid) -> Result<Vec<f64>, Box<dyn Error>> {
    let curve = deviations(record, 100.0, kind, grid)?;
    let stride = match grid {
        Grid::All => (record.len() / 100_000).max(1),
        _ => 1,
    };
    let points = curve.points.iter().step_by(stride);
    Ok(points.flat_map(|p| [p.tau_s, p.deviation]).collect())
}

fn read(path: &str) -> Result<Vec<f64>, Box<dyn Error>> {
    let file = File::open(path)?;
    let count = file.metadata()?.len() / 8;
    let mut reader = BufReader::with_capacity(1 << 16, file);
    let mut record = Vec::with_capacity(usize::try_from(count)?);
    let mut bytes = [0; 8];
    for _ in 0..count {
        reader.read_exact(&mut bytes)?;
        record.push(f64::from_le_bytes(bytes));
    }
    Ok(record)
}
