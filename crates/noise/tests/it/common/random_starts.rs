//! A search for the optimum of ARMA(1,1) that shares nothing with the crate's own but the likelihood:
//! Nelder-Mead from random places. Nelder & Mead 1965.

use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use undrift_noise::arma::{Mean, log_likelihood};

/// The highest log-likelihood of `starts` local searches from `log(1 − φ)` and `log(1 − θ)` drawn uniformly and
/// independently between `log(1/(10 N))` and 0 (xoshiro256++ seeded with `seed`).
pub fn best(record: &[f64], mean: Mean, starts: usize, seed: u64) -> f64 {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    let furthest = (10.0 * record.len() as f64).ln();
    let mut place = || -furthest * rng.random::<f64>();
    (0..starts)
        .map(|_| local(record, mean, [place(), place()]))
        .fold(f64::NEG_INFINITY, f64::max)
}

fn value(record: &[f64], mean: Mean, at: [f64; 2]) -> f64 {
    let [phi, theta] = at.map(|log| -log.exp_m1());
    log_likelihood(record, &[phi], &[theta], mean, false)
        .map_or(f64::NEG_INFINITY, |found| found.log_likelihood)
}

/// Nelder-Mead in `log(1 − φ)`, `log(1 − θ)`, until the triangle spans 1e-4 of log-likelihood; started
/// again once around where it ended.
fn local(record: &[f64], mean: Mean, start: [f64; 2]) -> f64 {
    let mut best = (start, value(record, mean, start));
    for size in [1.0, 0.2] {
        let mut corners = [best; 3];
        for i in 0..2 {
            corners[i + 1].0[i] += size;
            corners[i + 1].1 = value(record, mean, corners[i + 1].0);
        }
        for _ in 0..80 {
            corners.sort_by(|a, b| b.1.total_cmp(&a.1));
            if corners[0].1 - corners[2].1 < 1e-4 {
                break;
            }
            let along = |t: f64| {
                let at: [f64; 2] = core::array::from_fn(|i| {
                    let middle = 0.5 * (corners[0].0[i] + corners[1].0[i]);
                    middle + t * (corners[2].0[i] - middle)
                });
                (at, value(record, mean, at))
            };
            let reflected = along(-1.0);
            corners[2] = if reflected.1 > corners[0].1 {
                let expanded = along(-2.0);
                if expanded.1 > reflected.1 {
                    expanded
                } else {
                    reflected
                }
            } else if reflected.1 > corners[1].1 {
                reflected
            } else {
                let contracted = along(if reflected.1 > corners[2].1 {
                    -0.5
                } else {
                    0.5
                });
                if contracted.1 > corners[2].1.max(reflected.1) {
                    contracted
                } else {
                    // Towards the best corner.
                    for k in 1..3 {
                        let best = corners[0].0;
                        let at = core::array::from_fn(|i| 0.5 * (best[i] + corners[k].0[i]));
                        corners[k] = (at, value(record, mean, at));
                    }
                    continue;
                }
            };
        }
        corners.sort_by(|a, b| b.1.total_cmp(&a.1));
        best = corners[0];
    }
    best.1
}
