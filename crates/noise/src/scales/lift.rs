//! From the ARMA(1,1) of block averages to the process at the full rate.
//!
//! Derivation: averages over m samples of an AR(1) of parameter ρ = e^{−a} have the variance C and
//! at lags k ≥ 1 the covariance B φᵏ, φ = ρᵐ, times the process's variance; white noise adds its
//! own over m at lag 0 only. Two moments of the ARMA(1,1), γ₀ and γ₁, thus give process and white
//! noise, and φ its correlation time.
//!
//! "Exact" is meant for the second moments: an ARMA(1,1) of averages has one such pre-image, if it
//! has any.

use crate::arma::ArmaFit;
use crate::composite::{CompositeTerms, GaussMarkov};
use serde::{Deserialize, Serialize};
use undrift_base::number::OrNull;

/// 1 − φ below which the averages' process is a random walk.
const UNIT_ROOT: f64 = 1e-12;

/// A slow process under white noise, at the full rate; or the standard errors of the logarithms of
/// these.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Lifted {
    /// White noise density N [unit·√s].
    #[serde(with = "OrNull")]
    pub white: f64,
    /// Standard deviation of the slow process \[unit\]; infinite for a random walk.
    #[serde(with = "OrNull")]
    pub sigma: f64,
    /// Correlation time \[s\]; infinite for a random walk.
    #[serde(with = "OrNull")]
    pub tau_s: f64,
    /// Drive σ √(2/τ), for a random walk K [unit/√s].
    #[serde(with = "OrNull")]
    pub drive: f64,
}

impl Lifted {
    /// Standard errors of which nothing is known: infinite.
    pub(super) fn unknown() -> Self {
        Self {
            white: f64::INFINITY,
            sigma: f64::INFINITY,
            tau_s: f64::INFINITY,
            drive: f64::INFINITY,
        }
    }

    /// The same as composite terms: white noise beside a Gauss-Markov process or a random walk.
    ///
    /// ```
    /// use undrift_noise::scales::lift;
    /// // Averages of one sample are the record: θ σ² of an ARMA(1,1) with a unit root is white, (1 − θ)² σ² drives the walk.
    /// let terms = lift(1.0, 0.9, 1e-3, 1, 0.01).expect("a slow part").terms();
    /// assert!((terms.white / (0.9_f64.sqrt() * 1e-3 * 0.1) - 1.0).abs() < 1e-12); // N = √(r T)
    /// assert!((terms.random_walk / (0.1 * 1e-3 / 0.1) - 1.0).abs() < 1e-12); // K = √(q/T)
    /// ```
    pub fn terms(&self) -> CompositeTerms {
        let mut terms = CompositeTerms {
            white: self.white,
            ..CompositeTerms::default()
        };
        if self.tau_s.is_finite() {
            terms.gauss_markov[0] = GaussMarkov {
                sigma: self.sigma,
                tau_s: self.tau_s,
            };
        } else {
            terms.random_walk = self.drive;
        }
        terms
    }
}

/// The AR(1) or random walk and white noise at a sample interval \[s\] whose averages over `block`
/// samples are the ARMA(1,1) `x_t − φ x_{t−1} = a_t − θ a_{t−1}`, a of standard deviation `sigma`
/// \[unit\]: exact, by moments. White noise that would be negative is 0. None where the slow part
/// would be negative, or φ is.
///
/// ```
/// use undrift_noise::scales::lift;
/// // A unit root in averages of 20 samples at 100 Hz: K² = (1 − θ)² σ²/(m² T).
/// let walk = lift(1.0, 0.9, 1e-3, 20, 0.01).expect("a slow part");
/// assert!(walk.tau_s.is_infinite() && (walk.drive - 1e-4 / 0.2_f64.sqrt()).abs() < 1e-12);
/// ```
///
/// Ranges: 0 < φ ≤ 1, −1 < θ < φ, σ > 0, `interval` > 0 \[s\]; O(`block`).
///
/// ```
/// use undrift_noise::scales::lift;
/// // Averages of 50 samples at 100 Hz with φ = e^{−0.01}: 100 averages of 0.5 s are the correlation time, 50 s.
/// let slow = lift((-0.01f64).exp(), 0.9, 1e-3, 50, 0.01).expect("a slow part");
/// assert!((slow.tau_s - 50.0).abs() < 1e-9);
/// assert!((slow.drive - slow.sigma * (2.0 / slow.tau_s).sqrt()).abs() < 1e-15);
/// assert!(lift(0.5, 0.9, 1e-3, 50, 0.01).is_none()); // θ > φ: no slow part, but its opposite.
/// ```
pub fn lift(phi: f64, theta: f64, sigma: f64, block: usize, interval: f64) -> Option<Lifted> {
    let m = block.max(1) as f64;
    let variance = sigma * sigma;
    let inside = phi > 0.0 && phi <= 1.0 && theta < phi && theta > -1.0;
    if !(inside && variance > 0.0 && variance.is_finite() && interval > 0.0) {
        return None;
    }
    let density = |white: f64| (white.max(0.0) * m * interval).sqrt();
    if 1.0 - phi < UNIT_ROOT {
        let step = (1.0 - theta) * (1.0 - theta) * variance / m;
        let white = theta * variance + step * (m * m - 1.0) / (6.0 * m);
        return Some(Lifted {
            white: density(white),
            sigma: f64::INFINITY,
            tau_s: f64::INFINITY,
            drive: (step / interval).sqrt(),
        });
    }
    let a = -phi.ln() / m;
    // C and B − C, sums of positive terms.
    let (mut c, mut excess) = (m, 0.0);
    for d in 1..block.max(1) {
        let weight = 2.0 * (m - d as f64);
        c += weight * (-a * d as f64).exp();
        excess += weight * (a * d as f64).sinh();
    }
    c /= m * m;
    excess /= m * m;
    // γ₁/φ of the ARMA(1,1): the AR(1) at lag 0 by continuity.
    let slow = (1.0 - phi * theta) * (phi - theta) / (phi * (1.0 - phi) * (1.0 + phi)) * variance;
    let process = slow / (c + excess);
    let white = theta / phi * variance + process * excess;
    let tau_s = interval / a;
    Some(Lifted {
        white: density(white),
        sigma: process.sqrt(),
        tau_s,
        drive: (2.0 * process / tau_s).sqrt(),
    })
}

/// Standard errors of the logarithms of what [`lift`] gives, from the covariance of φ and θ (σ is
/// independent of them, its error √(1/2n)); infinite where the fit has none.
///
/// By the delta method: central differences of the logarithms along φ and θ, steps well inside 1 > φ > θ.
pub(super) fn relative_errors(model: &ArmaFit, block: usize, interval: f64) -> Lifted {
    let (Some(covariance), [phi], [theta]) = (&model.covariance, &model.ar[..], &model.ma[..])
    else {
        return Lifted::unknown();
    };
    let (phi, theta, sigma) = (*phi, *theta, model.sigma);
    let at = |phi: f64, theta: f64| lift(phi, theta, sigma, block, interval);
    // Steps well inside 1 > φ > θ.
    let step = 1e-4 * (1.0 - phi).min(phi - theta).min(phi);
    if step.is_nan() || step <= 0.0 {
        return Lifted::unknown();
    }
    let points = [
        at(phi + step, theta),
        at(phi - step, theta),
        at(phi, theta + step),
        at(phi, theta - step),
    ];
    let [Some(p), Some(q), Some(u), Some(v)] = points else {
        return Lifted::unknown();
    };
    let error = |of: fn(&Lifted) -> f64, scales: bool| {
        let along = |a: &Lifted, b: &Lifted| (of(a) / of(b)).ln() / (2.0 * step);
        let (dp, dt) = (along(&p, &q), along(&u, &v));
        let mut square =
            dp * dp * covariance[0] + 2.0 * dp * dt * covariance[1] + dt * dt * covariance[3];
        if scales {
            square += 0.5 / model.n as f64;
        }
        if square >= 0.0 {
            square.sqrt()
        } else {
            f64::INFINITY
        }
    };
    Lifted {
        white: error(|l| l.white, true),
        sigma: error(|l| l.sigma, true),
        tau_s: error(|l| l.tau_s, false),
        drive: error(|l| l.drive, true),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::composite::block_average;

    #[test]
    fn averaging_and_lifting_is_the_identity() {
        let t = 0.01;
        for (white, sigma, tau_s) in [(0.01, 0.05, 3.0), (6.6e-4, 4.4e-4, 500.0), (0.0, 1.0, 20.0)]
        {
            let terms = CompositeTerms {
                white,
                gauss_markov: [GaussMarkov { sigma, tau_s }, GaussMarkov::default()],
                ..CompositeTerms::default()
            };
            for block in [1usize, 5, 20, 100] {
                let averages = block_average(&terms.to_shaping(t).unwrap(), block).unwrap();
                if white == 0.0 && block == 1 {
                    continue; // no noise of a sample's own: no innovations form
                }
                let arma = averages.arma_coefficients().unwrap();
                let found = lift(arma.phi[0], arma.theta[0], arma.sigma, block, t).unwrap();
                // 1 − φ keeps 1e-16/(1 − φ) of itself, and φ − θ is found by a recursion to 1e-13.
                let tolerance = 1e-6;
                assert!(
                    (found.sigma / sigma - 1.0).abs() < tolerance,
                    "{block}: {found:?}"
                );
                assert!(
                    (found.tau_s / tau_s - 1.0).abs() < tolerance,
                    "{block}: {found:?}"
                );
                let near_white = (found.white - white).abs() < tolerance * white
                    || (white == 0.0 && found.white < 1e-3 * sigma * t.sqrt());
                assert!(near_white, "{block}: {found:?}");
            }
        }
    }

    #[test]
    fn a_random_walk_is_lifted_from_its_unit_root() {
        let (t, white, k) = (0.01, 0.01, 0.003);
        let terms = CompositeTerms {
            white,
            random_walk: k,
            ..CompositeTerms::default()
        };
        for block in [1usize, 5, 20, 100, 500] {
            let averages = block_average(&terms.to_shaping(t).unwrap(), block).unwrap();
            let arma = averages.arma_coefficients().unwrap();
            let found = lift(arma.phi[0], arma.theta[0], arma.sigma, block, t).unwrap();
            assert!((found.drive / k - 1.0).abs() < 1e-7, "{block}: {found:?}");
            assert!(
                (found.white / white - 1.0).abs() < 1e-7,
                "{block}: {found:?}"
            );
            assert_eq!(found.tau_s, f64::INFINITY);
        }
    }

    #[test]
    fn what_has_no_slow_part_is_none() {
        for (phi, theta) in [
            (-0.19, -0.51),
            (0.5, 0.6),
            (0.0, -0.5),
            (f64::NAN, 0.0),
            (1.1, 0.2),
        ] {
            assert_eq!(lift(phi, theta, 1.0, 5, 0.01), None);
        }
        assert_eq!(lift(0.9, 0.5, f64::INFINITY, 5, 0.01), None);
        // Nor is there a rate of samples that take no time, or noise without variance.
        assert_eq!(lift(0.9, 0.5, 1.0, 5, 0.0), None);
        assert_eq!(lift(0.9, 0.5, 0.0, 5, 0.01), None);
    }

    #[test]
    fn relative_errors_of_single_samples_are_in_closed_form() {
        let samples: Vec<f64> = (0..60).map(|k| f64::from(k * k * 37 % 17)).collect();
        let options = crate::arma::FitOptions {
            effort: 0.1,
            ..Default::default()
        };
        let made = crate::arma::fit(&samples, 1, 1, &options).unwrap();
        let (phi, theta) = (0.9, 0.6);
        let (vp, c, vt, n) = (4e-4, 1.5e-4, 9e-4, 1000);
        let model = ArmaFit {
            ar: vec![phi],
            ma: vec![theta],
            sigma: 0.3,
            n,
            covariance: Some(vec![vp, c, c, vt]),
            ..made
        };
        let found = relative_errors(&model, 1, 0.5);
        // The delta method: τ = −T/ln φ.
        let tau = vp.sqrt() / (phi * -phi.ln());
        // N² = θ/φ σ² T.
        let white = 0.25 * (vp / (phi * phi) - 2.0 * c / (phi * theta) + vt / (theta * theta));
        // σ² of the process: (1 − φθ)(φ − θ)/(φ(1 − φ²)) times that of the innovations.
        let by_phi = -theta / (1.0 - phi * theta) + 1.0 / (phi - theta) - 1.0 / phi
            + 2.0 * phi / (1.0 - phi * phi);
        let by_theta = -phi / (1.0 - phi * theta) - 1.0 / (phi - theta);
        let form = |a: f64, b: f64| 0.25 * (a * a * vp + 2.0 * a * b * c + b * b * vt);
        let own = 0.5 / n as f64;
        // The drive is σ √(2/τ): half of τ's slope, d ln τ/dφ = −1/(φ ln φ).
        let drive = form(by_phi + 1.0 / (phi * phi.ln()), by_theta);
        for (found, exact) in [
            (found.tau_s, tau),
            (found.white, (white + own).sqrt()),
            (found.sigma, (form(by_phi, by_theta) + own).sqrt()),
            (found.drive, (drive + own).sqrt()),
        ] {
            assert!((found / exact - 1.0).abs() < 1e-6, "{found} {exact}");
        }
        let without = ArmaFit {
            covariance: None,
            ..model.clone()
        };
        assert_eq!(relative_errors(&without, 1, 0.5), Lifted::unknown());
        // No step to either side of what has no slow part.
        let none = ArmaFit {
            ma: vec![phi],
            ..model
        };
        assert_eq!(relative_errors(&none, 1, 0.5), Lifted::unknown());
    }

    #[test]
    fn terms_are_a_process_or_a_walk() {
        let process = Lifted {
            white: 0.1,
            sigma: 0.2,
            tau_s: 8.0,
            drive: 0.1,
        };
        let terms = process.terms();
        assert_eq!((terms.white, terms.random_walk), (0.1, 0.0));
        assert_eq!(
            terms.gauss_markov[0],
            GaussMarkov {
                sigma: 0.2,
                tau_s: 8.0
            }
        );
        let walk = Lifted {
            tau_s: f64::INFINITY,
            ..process
        };
        assert_eq!(
            (walk.terms().random_walk, walk.terms().gauss_markov[0]),
            (0.1, GaussMarkov::default())
        );
    }
}
