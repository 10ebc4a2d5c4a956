//! Where the search for the optimum starts. The likelihood of an ARMA model has many local optima
//! (18 for ARMA(4,3) on 48 samples); the one of a slow bias under white noise is a narrow gorge that
//! a start at zero or from a long autoregression never sees.

use super::autoregressive;
use super::polynomial::{from_search, multiply, to_search};
use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Samples that a short-memory start looks at.
const GLANCE: usize = 100_000;
/// How close to ±1 a partial autocorrelation of a start may be where an estimate leaves the region.
const MARGIN: f64 = 0.02;

/// Search coordinates of given coefficients: φ's, then θ's.
pub(super) fn encode(phi: &[f64], theta: &[f64], margin: f64) -> Vec<f64> {
    let mut z = to_search(phi, margin);
    z.extend(to_search(theta, margin));
    z
}

/// Hannan-Rissanen: innovations from a long autoregression, then least squares of the record on its
/// own past and theirs. Hannan & Rissanen 1982. Missing samples count as the mean.
pub(super) fn hannan_rissanen(
    samples: &[f64],
    centre: f64,
    p: usize,
    q: usize,
) -> Option<Vec<f64>> {
    let x: Vec<f64> = samples
        .iter()
        .take(GLANCE)
        .map(|x| if x.is_nan() { 0.0 } else { x - centre })
        .collect();
    let n = x.len();
    let long = ((10.0 * (n as f64).log10()) as usize)
        .max(2 * (p + q))
        .min(n / 4);
    let ar = autoregressive::burg(&x, long).ok()?.ar;
    let a: Vec<f64> = (0..n)
        .map(|t| {
            let past: f64 = (1..=long.min(t)).map(|j| ar[j - 1] * x[t - j]).sum();
            x[t] - past
        })
        .collect();
    let k = p + q;
    let first = long + q.max(p);
    if n < first + 2 * k + 2 {
        return None;
    }
    let mut normal = DMatrix::zeros(k, k);
    let mut right = DVector::zeros(k);
    let mut row = DVector::zeros(k);
    for t in first..n {
        for i in 0..p {
            row[i] = x[t - 1 - i];
        }
        for i in 0..q {
            row[p + i] = -a[t - 1 - i];
        }
        right.axpy(x[t], &row, 1.0);
        normal.syger(1.0, &row, &row, 1.0);
    }
    // The lower triangle is all that the factorisation reads.
    for i in 0..k {
        normal[(i, i)] *= 1.0 + 1e-9;
    }
    let found = normal.cholesky()?.solve(&right);
    let (phi, theta) = found.as_slice().split_at(p);
    Some(encode(phi, theta, MARGIN))
}

/// (φ, θ) of a slow AR(1) under white noise, from the autocovariances of block means at scales m = 4,
/// 16, 64, …: the lag-2 to lag-1 ratio is φᵐ, their size gives the AR(1)'s variance, the rest is white.
/// (The Allan variance at two neighbouring scales carries the same information.)
pub(super) fn slow_bias(samples: &[f64], centre: f64) -> Vec<(f64, f64)> {
    let x = |v: f64| if v.is_nan() { 0.0 } else { v - centre };
    let n = samples.len();
    let total = samples.iter().map(|v| x(*v) * x(*v)).sum::<f64>() / n as f64;
    let mut starts = Vec::new();
    let mut means: Vec<f64> = samples
        .chunks_exact(4)
        .map(|c| c.iter().map(|v| x(*v)).sum::<f64>() / 4.0)
        .collect();
    let mut m = 4.0;
    while means.len() >= 16 {
        let lag = |k: usize| {
            let sum: f64 = (k..means.len()).map(|i| means[i] * means[i - k]).sum();
            sum / means.len() as f64
        };
        let ratio = (lag(2) / lag(1)).clamp(0.01, 0.999);
        if lag(1) > 0.0 && lag(2) > 0.0 {
            let phi: f64 = ratio.powf(1.0 / m);
            let smear = (1.0 - ratio) / (m * (1.0 - phi));
            let bias = (lag(1) / (smear * smear)).min(0.999 * total);
            if let Some(theta) = moving_average(phi, bias, total - bias) {
                starts.push((phi, theta));
            }
        }
        means = means
            .chunks_exact(4)
            .map(|c| c.iter().sum::<f64>() / 4.0)
            .collect();
        m *= 4.0;
    }
    starts
}

/// θ of AR(1) with variance `bias` plus white noise: the invertible root of
/// `(1 + θ²)/θ = (q + r (1 + φ²))/(r φ)`, `q = bias (1 − φ²)`. docs/theory.md, section 1.
fn moving_average(phi: f64, bias: f64, white: f64) -> Option<f64> {
    let q = bias * (1.0 - phi) * (1.0 + phi);
    // With d = 1 − θ: d²/(1 − d) = q/(r φ) + (1 − φ)²/φ.
    let c = q / (white * phi) + (1.0 - phi) * (1.0 - phi) / phi;
    let d = 0.5 * (-c + (c * c + 4.0 * c).sqrt());
    let theta = 1.0 - d;
    (theta > 0.0 && theta < 1.0).then_some(theta)
}

/// Pairs (α, μ) of an AR and an MA root to lay over a model: near 1 at every distance the record can
/// tell apart (1 − α = 10^−a), near −1 and in between.
pub(super) fn real_pairs(n: usize, per_decade: f64) -> Vec<(f64, f64)> {
    let far = (n as f64).log10() + 0.5;
    let count = (far * per_decade) as usize;
    let place = |k: usize| 1.0 - 10f64.powf(-0.25 - k as f64 / per_decade);
    let mut pairs = Vec::new();
    for i in 0..=count {
        for j in 0..=count {
            let close = i.abs_diff(j) as f64 <= 2.0 * per_decade;
            if i != j && close {
                pairs.push((place(i), place(j)));
            }
        }
    }
    let mirror = count.min((2.0 * per_decade) as usize);
    for i in 0..=mirror {
        for j in 0..=mirror {
            if i != j {
                pairs.push((-place(i), -place(j)));
            }
        }
    }
    for (alpha, mu) in [
        (0.5, -0.5),
        (-0.5, 0.5),
        (0.3, 0.0),
        (-0.3, 0.0),
        (0.0, 0.3),
        (0.0, -0.3),
    ] {
        pairs.push((alpha, mu));
    }
    pairs
}

/// A lower-order optimum with one more AR and MA root on it.
pub(super) fn with_real_pair(z: &[f64], p: usize, alpha: f64, mu: f64) -> Vec<f64> {
    let phi = multiply(&from_search(&z[..p]), &[alpha]);
    let theta = multiply(&from_search(&z[p..]), &[mu]);
    encode(&phi, &theta, 1e-9)
}

/// A lower-order optimum (order two less) with a complex pair of AR roots and one of MA roots on
/// it: a resonance or a notch at the frequency `omega` [rad/sample].
pub(super) fn with_complex_pair(
    z: &[f64],
    p: usize,
    omega: f64,
    ar_radius: f64,
    ma_radius: f64,
) -> Vec<f64> {
    let quadratic = |r: f64| [2.0 * r * omega.cos(), -r * r];
    let phi = multiply(&from_search(&z[..p]), &quadratic(ar_radius));
    let theta = multiply(&from_search(&z[p..]), &quadratic(ma_radius));
    encode(&phi, &theta, 1e-9)
}

/// Random partial autocorrelations in (−1, 1), the same ones every time.
pub(super) fn random(dimension: usize, count: usize) -> Vec<Vec<f64>> {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(0x5eed + dimension as u64);
    (0..count)
        .map(|_| {
            (0..dimension)
                .map(|_| (1.98 * rng.random::<f64>() - 0.99).atanh())
                .collect()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slow_plus_white_gives_theta_back() {
        let (phi, theta) = (0.9999f64, 0.998f64);
        // S and W of docs/theory.md, section 1, σ = 1.
        let q = (1.0 - phi * theta) * (phi - theta) / phi;
        let bias = q / ((1.0 - phi) * (1.0 + phi));
        let found = moving_average(phi, bias, theta / phi).unwrap();
        // 1 − φ has twelve digits.
        assert!((found - theta).abs() < 1e-10, "{found}");
    }
}
