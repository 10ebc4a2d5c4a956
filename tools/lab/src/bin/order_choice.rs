//! How often Pandit and Wu's F rule, its step down by F and by BIC, AIC and BIC choose the true order,
//! on simulated series; and what F really exceeds where the extra pairs of roots cancel.
//!
//! `cargo run --release -p undrift-lab --bin order_choice [-- SERIES [PAPER_SAMPLES [CASE]]]`, CASE one
//! of the truths below, or `null` for the last table alone.

use rayon::prelude::*;
use undrift_nav::shaping::ShapingFilter;
use undrift_noise::{
    arma::{FitOptions, fit},
    pandit_wu::{PanditWuOptions, critical_value, f_test, pandit_wu},
    synthesis::NoiseGenerator,
};

/// One case: name, φ, θ, samples, largest n.
type Case = (&'static str, Vec<f64>, Vec<f64>, usize, usize);

/// Coefficients of Π (1 − 2 r cos(a) B + r² B²), sign of φ and θ.
fn pairs(roots: &[(f64, f64)], real: &[f64]) -> Vec<f64> {
    let mut polynomial = vec![1.0];
    let mut times = |factor: &[f64]| {
        let mut product = vec![0.0; polynomial.len() + factor.len() - 1];
        for (i, a) in polynomial.iter().enumerate() {
            for (j, b) in factor.iter().enumerate() {
                product[i + j] += a * b;
            }
        }
        polynomial = product;
    };
    for (radius, angle) in roots {
        times(&[1.0, -2.0 * radius * angle.cos(), radius * radius]);
    }
    for root in real {
        times(&[1.0, -root]);
    }
    polynomial[1..].iter().map(|c| -c).collect()
}

/// How each order is fitted here.
fn options() -> FitOptions {
    FitOptions {
        effort: 0.3,
        ..FitOptions::default()
    }
}

/// 90 %, 95 % and 99 % points of F, ARMA(k, k) against white noise, on white noise.
fn cancelling(k: usize, samples: usize, series: u64) -> [f64; 3] {
    let mut statistics: Vec<f64> = (0..series)
        .into_par_iter()
        .filter_map(|seed| {
            let filter = ShapingFilter::white(1.0, 0.01).ok()?;
            let mut record = vec![0.0; samples];
            NoiseGenerator::new(&filter, 9000 + seed).fill(&mut record);
            let smaller = fit(&record, 0, 0, &options()).ok()?;
            let larger = fit(&record, k, k, &options()).ok()?;
            Some(f_test(&smaller, &larger, 0.05)?.f)
        })
        .collect();
    statistics.sort_by(f64::total_cmp);
    let last = statistics.len() - 1;
    [0.90, 0.95, 0.99].map(|share| statistics[(share * last as f64).round() as usize])
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let series: u64 = arguments.next().and_then(|n| n.parse().ok()).unwrap_or(100);
    let paper: usize = arguments
        .next()
        .and_then(|n| n.parse().ok())
        .unwrap_or(100_000);
    let only = arguments.next();
    let wanted = |name: &str| only.as_deref().is_none_or(|only| only == name);
    let cases: [Case; 4] = [
        ("ARMA(1,1)", vec![0.8], vec![-0.5], 2000, 3),
        ("ARMA(2,1)", pairs(&[(0.9, 0.8)], &[]), vec![-0.5], 2000, 3),
        (
            "ARMA(4,3)",
            pairs(&[(0.95, 0.4), (0.9, 2.2)], &[]),
            pairs(&[(0.8, 1.2)], &[-0.6]),
            5000,
            3,
        ),
        ("paper", vec![0.99995], vec![0.9994], paper, 2),
    ];
    println!(
        "{:12} {:>8} {:>10} {:>12} {:>8} {:>14} {:>8} {:>8}",
        "truth", "samples", "F too far", "F, stepped", "(1,1)", "BIC, stepped", "AIC", "BIC"
    );
    for (name, phi, theta, samples, n_max) in cases {
        if !wanted(name) {
            continue;
        }
        let order = (phi.len(), theta.len());
        let needed = order.0.div_ceil(2);
        let counts = (0..series)
            .into_par_iter()
            .filter_map(|seed| {
                let filter = ShapingFilter::arma(&phi, &theta, 1.0, 0.01).ok()?;
                let mut record = vec![0.0; samples];
                NoiseGenerator::new(&filter, 1000 + seed).fill(&mut record);
                let options = PanditWuOptions {
                    n_max,
                    fit: options(),
                    ..PanditWuOptions::default()
                };
                let found = pandit_wu(&record, &options).ok()?;
                Some([
                    found.n > needed,
                    found.by_f == order,
                    found.by_f == (1, 1),
                    found.by_bic_step_down == order,
                    found.by_aic == order,
                    found.by_bic == order,
                ])
            })
            .map(|hits| hits.map(u32::from))
            .reduce(|| [0; 6], |a, b| std::array::from_fn(|i| a[i] + b[i]));
        let [too_far, by_f, at_11, stepped, by_aic, by_bic] = counts;
        println!(
            "{name:12} {samples:8} {too_far:10} {by_f:12} {at_11:8} {stepped:14} {by_aic:8} {by_bic:8}"
        );
    }
    if !wanted("null") {
        return;
    }
    println!(
        "F of cancelling pairs, by pairs and samples: 90 %, 95 %, 99 % points; 95 % of F itself"
    );
    for (pairs, samples) in [(1, 500), (1, 2000), (2, 500), (2, 2000)] {
        let [a, b, c] = cancelling(pairs, samples, series);
        let nominal = critical_value(2 * pairs, samples, 0.05).unwrap_or(f64::NAN);
        println!("{pairs} {samples:5}: {a:.2} {b:.2} {c:.2}; {nominal:.2}");
    }
}
