//! Allan variance of a first-order Gauss-Markov process, closed form and series, and its fit beside
//! white noise and quantisation.

use super::deviation::{Curve, DeviationKind};
use super::fit::{Problem, described, points_for_fit};
use crate::screening::record::RecordError;

/// τ / τc below which the closed form loses digits and the series is used.
const SERIES: f64 = 0.5;

/// Allan variance \[unit²\] at averaging time `tau_s` \[s\] of a continuous Gauss-Markov process of
/// standard deviation `sigma` \[unit\] and correlation time `tau_c_s` \[s\] whose samples are averages
/// (IEEE Std 952-1997 equation C.13, there with q_c = σ √(2/τc)):
/// `(2σ²/x) [1 − (3 − 4 e^{−x} + e^{−2x}) / (2x)]`, x = τ/τc; a series below x = 0.5.
///
/// ```
/// use undrift_noise::allan::gauss_markov::gauss_markov_variance;
/// // The deviation is largest near τ = 1.89 τc, where it is 0.617 σ.
/// let deviation = |tau_s| gauss_markov_variance(tau_s, 2e-5, 100.0).sqrt();
/// assert!((deviation(189.0) / 2e-5 - 0.617).abs() < 1e-3);
/// assert!(deviation(150.0) < deviation(189.0) && deviation(240.0) < deviation(189.0));
/// ```
pub fn gauss_markov_variance(tau_s: f64, sigma: f64, tau_c_s: f64) -> f64 {
    let x = tau_s / tau_c_s;
    let unit = if x < SERIES {
        // Σ_{k≥3} −(−1)^k (2^k − 4) x^{k−2} / k!; 24 terms: (2·0.5)^24/24! is below 1e-23.
        let (mut power, mut doubled, mut sum) = (x / 6.0, 8.0, 0.0);
        let mut sign = 1.0;
        for k in 3..27 {
            sum += sign * (doubled - 4.0) * power;
            sign = -sign;
            doubled *= 2.0;
            power *= x / f64::from(k + 1);
        }
        sum
    } else {
        2.0 / x * (1.0 - (3.0 - 4.0 * (-x).exp() + (-2.0 * x).exp()) / (2.0 * x))
    };
    sigma * sigma * unit
}

/// Allan variance \[unit²\] at `m` samples of a sampled AR(1) `x_{k+1} = e^{−a} x_k + w` of standard
/// deviation `sigma` \[unit\]; `a` = T/τc > 0 or 1−φ ≈ a where φ is near 1. With φ = e^{−a}:
/// `σ² [m(1−φ²) − φ(3 − 4φ^m + φ^{2m})] / (m²(1−φ)²)` by summing the autocovariances; a series in a
/// where a·m < 0.5, exact down to a = 1e-300.
///
/// ```
/// use undrift_noise::allan::gauss_markov::{ar1_variance, gauss_markov_variance};
/// // Over many samples the sampled process is the continuous one: 100 Hz, τc = 100 s, at τ = 10 s.
/// let (sampled, continuous) = (ar1_variance(1000, 1e-4, 1e-4), gauss_markov_variance(10.0, 1e-4, 100.0));
/// assert!((sampled / continuous - 1.0).abs() < 1e-3);
/// ```
pub fn ar1_variance(m: usize, sigma: f64, a: f64) -> f64 {
    Ar1::new(sigma, a).variance(m)
}

/// An AR(1) whose variance is asked for at several lengths.
pub(crate) struct Ar1 {
    square: f64,
    a: f64,
    /// 1 − φ.
    decay: f64,
}

impl Ar1 {
    /// An AR(1) of standard deviation `sigma` \[unit\] and `a` = T/τc, from which 1 − φ keeps its digits.
    pub(crate) fn new(sigma: f64, a: f64) -> Self {
        Self {
            square: sigma * sigma,
            a,
            decay: -(-a).exp_m1(),
        }
    }

    /// Allan variance at `m` samples, by [`ar1_variance`].
    pub(crate) fn variance(&self, m: usize) -> f64 {
        let width = m.max(1) as f64;
        let (decay, phi) = (self.decay, 1.0 - self.decay);
        let b = self.a * width;
        if b >= SERIES {
            let power = (-b).exp();
            let tail = 3.0 - 4.0 * power + power * power;
            let bracket = width * decay * (1.0 + phi) - phi * tail;
            return self.square * bracket / (width * decay * width * decay);
        }
        // Numerator Σ_{k≥3} (−a)^k/k! [4(m+1)^k − (2m+1)^k − m 2^k − 3], divided by (m a)² at once.
        let inverse = 1.0 / width;
        let (mut power, mut sign, mut sum) = (b / 6.0, -1.0, 0.0f64);
        let (one, two, twice) = (1.0 + inverse, 2.0 + inverse, 2.0 * inverse);
        let (mut p1, mut p2, mut p3, mut p4) =
            (one.powi(3), two.powi(3), twice.powi(3), inverse.powi(3));
        for k in 3..40 {
            let term = power * (4.0 * p1 - p2 - width * p3 - 3.0 * p4);
            sum += sign * term;
            // Terms alternate and shrink, each by b at least.
            if term.abs() < 1e-17 * sum.abs() {
                break;
            }
            sign = -sign;
            power *= b / f64::from(k + 1);
            (p1, p2, p3, p4) = (p1 * one, p2 * two, p3 * twice, p4 * inverse);
        }
        let ratio = self.a / decay;
        self.square * sum * ratio * ratio
    }
}

/// White noise, quantisation and one Gauss-Markov process fitted to an Allan variance: what a data sheet's "bias instability" amounts
/// to as a model of a filter.
///
/// IEEE Std 952 reads the bias instability B from the flat of the deviation, 0.664 B; a process of this σ has
/// its highest deviation, 0.617 σ, near τ = 1.89 τc, so that σ is about 1.08 B where the flat is that maximum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GaussMarkovFit {
    /// Quantisation Q [unit·s].
    pub quantisation: f64,
    /// White noise N [unit·√s, that is unit/√Hz].
    pub white: f64,
    /// Standard deviation of the process \[unit\].
    pub sigma: f64,
    /// Correlation time τc \[s\].
    pub tau_c_s: f64,
    /// Squared residuals in units of their covariance, over the degrees of freedom; about 1 where
    /// the model holds.
    pub reduced_chi2: f64,
    /// Whether τc is at an end of the range searched: the record does not determine it.
    pub at_limit: bool,
}

/// Fits white noise, quantisation and a Gauss-Markov process to an overlapping Allan deviation by
/// searching τc between a fifth of the shortest τ and five times the record, the other terms by
/// non-negative weighted least squares at each; from the shortest τ on from which they describe the
/// curve: below, a sensor's filter or resonance may add what neither term is.
///
/// ```
/// use undrift_noise::{allan::{DeviationKind, Grid, deviations, fit_gauss_markov}, composite::{CompositeTerms, GaussMarkov}};
/// use undrift_noise::synthesis::NoiseGenerator;
/// let truth = CompositeTerms {
///     white: 0.01,
///     gauss_markov: [GaussMarkov { sigma: 0.01, tau_s: 20.0 }, GaussMarkov::default()],
///     ..CompositeTerms::default()
/// };
/// let record: Vec<f64> = NoiseGenerator::new(&truth.to_shaping(0.01)?, 1).take(200_000).collect();
/// let found = fit_gauss_markov(&deviations(&record, 100.0, DeviationKind::Overlapping, Grid::Octave)?)?;
/// assert!((found.white / 0.01 - 1.0).abs() < 0.05 && !found.at_limit, "{found:?}");
/// assert!((found.sigma / 0.01).ln().abs() < 0.3 && (found.tau_c_s / 20.0).ln().abs() < 0.6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// A curve that is not [`DeviationKind::Overlapping`], or fewer than 5 usable points.
pub fn fit_gauss_markov(curve: &Curve) -> Result<GaussMarkovFit, RecordError> {
    described(curve, |from| {
        let fit = fit_gauss_markov_from(curve, from)?;
        Ok((fit.reduced_chi2, fit.white > 0.0, fit))
    })
}

/// The fit of [`fit_gauss_markov`] with the averaging times from `shortest_s` \[s\] on; with quantisation only where that leaves out no τ.
///
/// # Errors
/// As [`fit_gauss_markov`], of the points that are left.
pub fn fit_gauss_markov_from(
    curve: &Curve,
    shortest_s: f64,
) -> Result<GaussMarkovFit, RecordError> {
    let mut points = points_for_fit(curve)?;
    points.retain(|p| p.tau_s >= shortest_s * (1.0 - 1e-9));
    if curve.kind != DeviationKind::Overlapping || points.len() < 5 {
        return Err(RecordError::TooShort {
            needed: 5,
            got: points.len(),
        });
    }
    let quantised = f64::from(u8::from(points[0].m == curve.points[0].m));
    let mut problem = Problem::new(curve, &points);
    let mut solve = |log_tau_c: f64| {
        let tau_c = log_tau_c.exp();
        let columns: [&dyn Fn(f64) -> f64; 3] = [
            &|tau| quantised * 3.0 / (tau * tau),
            &|tau| 1.0 / tau,
            &|tau| gauss_markov_variance(tau, 1.0, tau_c),
        ];
        problem.set_shapes(&columns);
        problem.solve()
    };
    let mut cost = |log_tau_c: f64| solve(log_tau_c).deviance;
    let low = (points[0].tau_s / 5.0).ln();
    let high = (5.0 * curve.samples as f64 / curve.rate_hz).ln();
    let steps = 60;
    let at = |i: i32| low + (high - low) * f64::from(i) / f64::from(steps);
    let costs: Vec<f64> = (0..=steps).map(|i| cost(at(i))).collect();
    let best = (0..=steps)
        .min_by(|&i, &j| costs[i as usize].total_cmp(&costs[j as usize]))
        .unwrap_or(0);
    let (mut left, mut right) = (at((best - 1).max(0)), at((best + 1).min(steps)));
    // Golden section: 40 cuts shrink the bracket to 1e-8 of itself.
    let golden = 0.618_033_988_749_894_9;
    let (mut x1, mut x2) = (
        right - golden * (right - left),
        left + golden * (right - left),
    );
    let (mut f1, mut f2) = (cost(x1), cost(x2));
    for _ in 0..40 {
        if f1 <= f2 {
            (right, x2, f2) = (x2, x1, f1);
            x1 = right - golden * (right - left);
            f1 = cost(x1);
        } else {
            (left, x1, f1) = (x1, x2, f2);
            x2 = left + golden * (right - left);
            f2 = cost(x2);
        }
    }
    let log_tau_c = 0.5 * (left + right);
    let solution = solve(log_tau_c);
    let term = |i: usize| solution.coefficients[i].sqrt();
    Ok(GaussMarkovFit {
        quantisation: term(0),
        white: term(1),
        sigma: term(2),
        tau_c_s: log_tau_c.exp(),
        reduced_chi2: solution.chi2 / (points.len() as f64 - 4.0),
        at_limit: best == 0 || best == steps,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By definition: half the mean square difference of two neighbouring block means.
    fn ar1_by_sum(m: usize, phi: f64) -> f64 {
        let mut sum = 0.0;
        for i in 0..2 * m {
            for j in 0..2 * m {
                let sign = if (i < m) == (j < m) { 1.0 } else { -1.0 };
                sum += sign * phi.powi(i.abs_diff(j) as i32);
            }
        }
        sum / (2.0 * (m * m) as f64)
    }

    #[test]
    fn ar1_matches_the_double_sum_on_both_sides_of_the_series() {
        for phi in [0.3f64, 0.9, 0.97, 0.99, 0.999] {
            for m in [1, 2, 7, 40] {
                let value = ar1_variance(m, 1.0, -phi.ln());
                let sum = ar1_by_sum(m, phi);
                // The sum itself cancels to (1 − φ) of its terms: 1e-16 · m² / 1e-3.
                assert!(
                    (value / sum - 1.0).abs() < 2e-10,
                    "φ {phi}, m {m}: {value} {sum}"
                );
            }
        }
    }

    #[test]
    fn near_the_unit_root_it_is_the_random_walk() {
        for a in [1e-9f64, 1e-12, 1e-100] {
            for m in [1usize, 3, 1000] {
                let q = -(-2.0 * a).exp_m1();
                let walk = q * (2.0 * (m * m) as f64 + 1.0) / (6.0 * m as f64);
                let value = ar1_variance(m, 1.0, a);
                // The next term of the series is a·m of it.
                assert!(
                    (value / walk - 1.0).abs() < 2.0 * a * m as f64 + 1e-14,
                    "{a} {m}"
                );
            }
        }
    }

    #[test]
    fn continuous_form_is_smooth_over_the_switch_and_has_the_right_ends() {
        let below = gauss_markov_variance(0.5 - 1e-12, 1.0, 1.0);
        let above = gauss_markov_variance(0.5 + 1e-12, 1.0, 1.0);
        // The closed form loses a digit to cancellation at x = 0.5.
        assert!((below / above - 1.0).abs() < 1e-11);
        assert!((gauss_markov_variance(1e-9, 2.0, 1.0) / (4.0 * 2e-9 / 3.0) - 1.0).abs() < 1e-8);
        assert!((gauss_markov_variance(1e6, 2.0, 1.0) / (8.0 / 1e6) - 1.0).abs() < 1e-5);
        // IEEE Std 952: the largest deviation is 0.437 q_c √τc = 0.437 √2 σ at τ = 1.89 τc.
        let peak = gauss_markov_variance(1.89, 1.0, 1.0).sqrt();
        assert!((peak - 0.437 * 2f64.sqrt()).abs() < 1e-3);
        assert!(peak > gauss_markov_variance(1.8, 1.0, 1.0).sqrt());
        assert!(peak > gauss_markov_variance(2.0, 1.0, 1.0).sqrt());
    }

    #[test]
    fn many_samples_a_correlation_time_are_the_continuous_process() {
        for m in [1000usize, 20_000, 300_000] {
            let discrete = ar1_variance(m, 1.0, 1e-5);
            let continuous = gauss_markov_variance(m as f64, 1.0, 1e5);
            // Sampling adds 1/(2m²) at small τ and the term of order a.
            assert!(
                (discrete / continuous - 1.0).abs() < 2e-5,
                "{m}: {discrete} {continuous}"
            );
        }
    }

    /// The variances of white noise of density 0.02 and a process of 0.05 themselves, at 10 Hz and 10⁵ samples.
    fn exact(tau_c_s: f64) -> Curve {
        let point = |octave: u32| {
            let m = 1usize << octave;
            let tau_s = m as f64 / 10.0;
            let variance = 4e-4 / tau_s + gauss_markov_variance(tau_s, 0.05, tau_c_s);
            super::super::deviation::Point {
                m,
                tau_s,
                deviation: variance.sqrt(),
                terms: 100_001 - 2 * m,
            }
        };
        Curve {
            kind: DeviationKind::Overlapping,
            rate_hz: 10.0,
            samples: 100_000,
            points: (0..15).map(point).collect(),
        }
    }

    #[test]
    fn the_process_of_an_exact_curve_is_found_from_a_sample_to_the_record() {
        for tau_c_s in [2.0, 20.0, 200.0] {
            let fit = fit_gauss_markov(&exact(tau_c_s)).unwrap();
            for (found, exact) in [(fit.tau_c_s, tau_c_s), (fit.sigma, 0.05), (fit.white, 0.02)] {
                assert!((found / exact - 1.0).abs() < 1e-3, "{fit:?}");
            }
            assert!(!fit.at_limit && fit.reduced_chi2 < 1e-3, "{fit:?}");
        }
        // Beyond five records of 10⁴ s the search ends.
        let fit = fit_gauss_markov(&exact(1e7)).unwrap();
        assert!(fit.at_limit, "{fit:?}");
        assert!(fit.tau_c_s > 3e4 && fit.tau_c_s < 5.01e4, "{fit:?}");
    }
}
