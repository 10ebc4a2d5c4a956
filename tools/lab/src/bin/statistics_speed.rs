//! Times of the tests and statistics at 2 000 000 samples, one thread.
//!
//! `cargo run --release -p undrift-lab --bin statistics_speed`

use std::hint::black_box;
use std::time::Instant;
use undrift_noise::correlation::{Partial, partial_autocorrelation};
use undrift_noise::normality::normality;
use undrift_noise::screening::{MotionRule, OutlierRule, motion, outliers};
use undrift_noise::spectrum::welch;
use undrift_noise::stationarity::{Deterministic, KpssLags, Lags, adf, kpss, phillips_perron};
use undrift_noise::synthesis::NoiseGenerator;
use undrift_noise::whiteness::portmanteau;

/// Prints the fastest of three runs.
fn time<T>(name: &str, run: impl Fn() -> T) {
    let mut fastest = f64::INFINITY;
    for _ in 0..3 {
        let start = Instant::now();
        black_box(run());
        fastest = fastest.min(start.elapsed().as_secs_f64());
    }
    println!("{name}: {:.0} ms", 1e3 * fastest);
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let filter = undrift_nav::shaping::ShapingFilter::arma(&[0.99995], &[0.9994], 0.006, 0.01)?;
    let mut record = vec![0.0; 2_000_000];
    NoiseGenerator::new(&filter, 1).fill(&mut record);
    let x = black_box(record.as_slice());
    let constant = Deterministic::Constant;
    time("ADF, 20 lags", || adf(x, constant, Lags::Fixed(20)));
    time("ADF, AIC up to 143 lags", || {
        adf(x, constant, Lags::Aic(None))
    });
    time("KPSS, 143 lags", || kpss(x, constant, KpssLags::Legacy));
    time("Phillips-Perron, 143 lags", || {
        phillips_perron(x, constant, None)
    });
    time("normality (sort, KS, Lilliefors)", || normality(x));
    time("Ljung-Box, 20 lags", || portmanteau(x, &[20], 0));
    time("Ljung-Box, 20 000 lags", || portmanteau(x, &[20_000], 0));
    time("PACF by Burg, 50 lags", || {
        partial_autocorrelation(x, 50, Partial::Burg)
    });
    time("Welch, segments of 16 384", || welch(x, 100.0, 16_384));
    time("outliers", || outliers(x, OutlierRule::default()));
    time("motion", || motion(x, MotionRule::default()));
    Ok(())
}
