//! Where the search for the optimum starts. The likelihood of an ARMA model has many local optima
//! (18 for ARMA(4,3) on 48 samples); the one of a slow bias under white noise is a narrow gorge that
//! a start at zero or from a long autoregression never sees.
//!
//! All starts are given in search coordinates ([`super::polynomial`]): p numbers of φ, then q of θ.
//! They are proposals only: nothing here evaluates a likelihood, and a bad start costs time, not
//! correctness.
//!
//! | start | finds |
//! |---|---|
//! | [`hannan_rissanen`] | short memory: filter taps, resonances |
//! | [`slow_bias`] | a slow bias under white noise, φ ≈ θ ≈ 1 |
//! | [`real_pairs`] | any real pole and zero that nearly cancel |
//! | [`with_complex_pair`] | a resonance or notch |
//! | [`random_points`] | optima that none of these reach |

use super::autoregressive;
use super::polynomial::{from_search, multiply, to_search};
use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Most samples that a start of the short-memory kind is computed from.
const MOST_SAMPLES: usize = 100_000;
/// An estimate whose partial autocorrelations lie outside ±(1 − this) is clamped there.
const MARGIN: f64 = 0.02;

/// Search coordinates of given coefficients: φ's, then θ's.
/// Partial autocorrelations beyond 1 − `margin` are drawn in to it.
pub(super) fn encode(phi: &[f64], theta: &[f64], margin: f64) -> Vec<f64> {
    let mut z = to_search(phi, margin);
    z.extend(to_search(theta, margin));
    z
}

/// Hannan-Rissanen: innovations from a long autoregression, then least squares of the record on its
/// own past and theirs. Hannan & Rissanen 1982. Missing samples count as the mean.
///
/// At most 100 000 samples are used; the long autoregression has 10 log₁₀ N coefficients, by Burg's
/// method. `None` where the record is too short for the regression, or its normal matrix is not
/// positive definite.
pub(super) fn hannan_rissanen(
    samples: &[f64],
    centre: f64,
    p: usize,
    q: usize,
) -> Option<Vec<f64>> {
    let x: Vec<f64> = samples
        .iter()
        .take(MOST_SAMPLES)
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
///
/// For φ near 1 block means of m samples have the autocovariance `bias·s²·φ^{m(k−1)}` at lags k ≥
/// 1, with the smear s = (1 − φᵐ)/(m (1 − φ)); white noise has none. So the ratio of lags 2 and 1
/// is φᵐ whatever the white noise. Scales at which one of the two is not positive are skipped.
/// Missing samples count as `centre`.
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
            if let Some(theta) = ma_coefficient(phi, bias, total - bias) {
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

/// θ of an AR(1) process of variance `bias` plus white noise of variance r = `white`: the invertible root of
/// `(1 + θ²)/θ = (q + r (1 + φ²))/(r φ)`, `q = bias (1 − φ²)`.
///
/// `None` where the root is outside of (0, 1).
fn ma_coefficient(phi: f64, bias: f64, white: f64) -> Option<f64> {
    let q = bias * (1.0 - phi) * (1.0 + phi);
    // With d = 1 − θ: d²/(1 − d) = q/(r φ) + (1 − φ)²/φ.
    let c = q / (white * phi) + (1.0 - phi) * (1.0 - phi) / phi;
    let d = 0.5 * (-c + (c * c + 4.0 * c).sqrt());
    let theta = 1.0 - d;
    (theta > 0.0 && theta < 1.0).then_some(theta)
}

/// Pairs (α, μ) of an AR and an MA root, which nearly cancel, to multiply into a model of lower order: 1 − α in equal steps of its
/// logarithm down to below 1/n, near −1, and between.
///
/// `per_decade` values of 1 − α in each factor of ten. Pairs further apart than two decades are not
/// tried: they do not cancel, and other starts reach them.
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

/// A lower-order optimum multiplied by one more AR and one more MA root, in search coordinates.
pub(super) fn with_real_pair(z: &[f64], p: usize, alpha: f64, mu: f64) -> Vec<f64> {
    let phi = multiply(&from_search(&z[..p]), &[alpha]);
    let theta = multiply(&from_search(&z[p..]), &[mu]);
    encode(&phi, &theta, 1e-9)
}

/// A lower-order optimum (order two less) multiplied by a complex pair of AR roots and one of MA roots, in
/// search coordinates: a resonance or a notch at the frequency `omega` [rad/sample].
///
/// `ar_radius` and `ma_radius` are moduli of the inverse roots, below 1: AR roots of radius ρ near
/// 1 are a line of about (1 − ρ)/π cycles per sample full width at half power.
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

/// Random points in search coordinates: artanh of partial autocorrelations uniform in (−0.99, 0.99), from a fixed seed.
/// The same points at every call: a fit is reproducible.
pub(super) fn random_points(dimension: usize, count: usize) -> Vec<Vec<f64>> {
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
        let found = ma_coefficient(phi, bias, theta / phi).unwrap();
        // 1 − φ has twelve digits.
        assert!((found - theta).abs() < 1e-10, "{found}");
    }

    use super::super::polynomial::inverse_roots;
    use realfft::num_complex::Complex64;

    /// White noise of unit variance.
    fn white(seed: u64, samples: usize) -> Vec<f64> {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
        let mut uniform = || 12f64.sqrt() * (rng.random::<f64>() - 0.5);
        (0..samples).map(|_| uniform()).collect()
    }

    #[test]
    fn theta_gives_the_autocorrelation_of_the_sum() {
        for (phi, bias, white) in [(0.9, 2.0, 1.0), (0.5, 0.1, 3.0), (0.999, 0.01, 1.0)] {
            let theta = ma_coefficient(phi, bias, white).unwrap();
            // ρ1 of an ARMA(1,1), Box, Jenkins & Reinsel, equation 3.4.8.
            let arma =
                (1.0 - phi * theta) * (phi - theta) / (1.0 - 2.0 * phi * theta + theta * theta);
            assert!((arma - phi * bias / (bias + white)).abs() < 1e-12);
            assert!(theta < phi);
        }
    }

    #[test]
    fn a_pair_laid_over_a_model_adds_its_roots_and_no_others() {
        let (phi, theta) = (multiply(&[0.7], &[-0.4]), vec![0.2]);
        let z = encode(&phi, &theta, 0.0);
        let has = |c: &[f64], root: Complex64| {
            let nearest = inverse_roots(c).into_iter().map(|r| (r - root).norm());
            nearest.fold(f64::INFINITY, f64::min) < 1e-9
        };
        let real = |x: f64| Complex64::new(x, 0.0);
        let found = with_real_pair(&z, 2, 0.95, -0.6);
        let (ar, ma) = (from_search(&found[..3]), from_search(&found[3..]));
        assert!(
            [0.7, -0.4, 0.95]
                .into_iter()
                .all(|root| has(&ar, real(root)))
        );
        assert!([0.2, -0.6].into_iter().all(|root| has(&ma, real(root))));
        assert_eq!((ar.len(), ma.len()), (3, 2));
        let found = with_complex_pair(&z, 2, 1.1, 0.9, 0.8);
        let (ar, ma) = (from_search(&found[..4]), from_search(&found[4..]));
        for sign in [1.0, -1.0] {
            assert!(has(&ar, Complex64::from_polar(0.9, sign * 1.1)));
            assert!(has(&ma, Complex64::from_polar(0.8, sign * 1.1)));
        }
        assert!(has(&ar, real(0.7)) && has(&ar, real(-0.4)) && has(&ma, real(0.2)));
        assert_eq!((ar.len(), ma.len()), (4, 3));
    }

    #[test]
    fn pairs_are_at_every_distance_from_1_that_the_record_tells_apart() {
        for (n, per_decade) in [(1000, 1.0), (100_000, 2.0)] {
            let pairs = real_pairs(n, per_decade);
            assert!(
                pairs
                    .iter()
                    .all(|(a, m)| a != m && a.abs() < 1.0 && m.abs() < 1.0)
            );
            let above: Vec<_> = pairs
                .iter()
                .filter(|(a, m)| *a > 0.0 && *m > 0.0 && a.min(*m) > 0.4)
                .collect();
            for (alpha, mu) in &above {
                let apart = ((1.0 - alpha) / (1.0 - mu)).log10().abs();
                assert!(apart < 2.0 + 1e-6 && apart > 1.0 / per_decade - 1e-6);
                assert!(pairs.contains(&(*mu, *alpha)));
            }
            let nearest = above
                .iter()
                .map(|(alpha, _)| 1.0 - alpha)
                .fold(1.0, f64::min);
            // To three quarters of a decade beyond 1/n, less the grid's step.
            let beyond = -(nearest * n as f64).log10();
            let range = 0.75 - 1.0 / per_decade - 1e-6..0.75 + 1e-6;
            assert!(range.contains(&beyond), "{beyond}");
            for k in 0..(2.0 * per_decade) as i32 {
                let root = 10f64.powf(-0.25 - f64::from(k) / per_decade) - 1.0;
                assert!(pairs.iter().any(|(alpha, _)| (alpha - root).abs() < 1e-12));
                assert!(pairs.iter().any(|(_, mu)| (mu - root).abs() < 1e-12));
            }
        }
        // Four places: twelve pairs less the two that are three decades apart; three mirrored places; six others.
        assert_eq!(real_pairs(1000, 1.0).len(), 10 + 6 + 6);
    }

    #[test]
    fn random_partial_autocorrelations_are_uniform_and_the_same_each_time() {
        let points = random_points(3, 2000);
        assert_eq!(points, random_points(3, 2000));
        let values: Vec<f64> = points.iter().flatten().map(|z| z.tanh()).collect();
        assert_eq!(values.len(), 6000);
        assert!(values.iter().all(|kappa| kappa.abs() < 0.99 + 1e-12));
        let mean = values.iter().sum::<f64>() / 6000.0;
        let square = values.iter().map(|kappa| kappa * kappa).sum::<f64>() / 6000.0;
        // Standard errors 0.0074 and 0.0038; four of them.
        assert!(mean.abs() < 0.03, "{mean}");
        assert!((square - 0.99 * 0.99 / 3.0).abs() < 0.015, "{square}");
    }

    #[test]
    fn least_squares_on_past_and_innovations_find_the_model() {
        // Roots 0.6 ± 0.6i, θ = −0.7, about 5.
        let (mut one, mut two, mut before) = (0.0, 0.0, 0.0);
        let mut next = |drive: f64| {
            let x = 1.2 * one - 0.72 * two + drive + 0.7 * before;
            (two, one, before) = (one, x, drive);
            5.0 + x
        };
        let mut x: Vec<f64> = white(4, 20_000).into_iter().map(&mut next).collect();
        x[500] = f64::NAN;
        let z = hannan_rissanen(&x, 5.0, 2, 1).unwrap();
        let found = [from_search(&z[..2]), from_search(&z[2..])].concat();
        for (found, exact) in found.iter().zip([1.2, -0.72, -0.7]) {
            // Standard errors up to √(0.5/20 000), twice that by this method; four of them, and the missing sample.
            assert!((found - exact).abs() < 0.04, "{found} {exact}");
        }
        // As many rows as coefficients and two at least: 12 samples have a long autoregression of 3.
        assert!(hannan_rissanen(&x[..12], 5.0, 2, 1).is_none());
        assert!(hannan_rissanen(&x[..20], 5.0, 2, 1).is_some());
    }

    #[test]
    fn a_slow_part_under_white_noise_is_among_the_starts() {
        let mut slow = 0.0;
        let drive = white(5, 100_000).into_iter().zip(white(6, 100_000));
        // An AR(1) of 100 samples, as large as the noise.
        let step = (1.0 - 0.99 * 0.99f64).sqrt();
        let mut x: Vec<f64> = drive
            .map(|(drive, white)| {
                slow = 0.99 * slow + step * drive;
                3.0 + slow + white
            })
            .collect();
        x[70] = f64::NAN;
        let theta = ma_coefficient(0.99, 1.0, 1.0).unwrap();
        let starts = slow_bias(&x, 3.0);
        let miss = |(phi, mu): &(f64, f64)| {
            let distance = |found: f64, exact: f64| ((1.0 - found) / (1.0 - exact)).ln().abs();
            distance(*phi, 0.99).max(distance(*mu, theta))
        };
        // A thousand correlation times give the correlation time to √(2/1000), the variances likewise; four of these.
        let best = starts.iter().map(miss).fold(f64::INFINITY, f64::min);
        assert!(best < 0.18, "{best} {starts:?}");
        // Every scale below the correlation time gives a start near it.
        assert!(
            starts.iter().filter(|start| miss(start) < 0.5).count() >= 3,
            "{starts:?}"
        );
        assert!(slow_bias(&x[..63], 3.0).is_empty());
    }
}
