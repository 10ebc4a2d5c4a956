//! Intervals from the profile of the likelihood.
//!
//! Near φ = 1 the estimate is far from normally distributed and its standard error says little. A
//! profile interval holds the values of one parameter that the record does not contradict: those at
//! which the log-likelihood, maximised over all other parameters, lies within half the χ²(1) point of
//! its maximum. It does not depend on how the parameter is written down (φ, log(1−φ), the
//! correlation time) and may be lopsided. Venzon & Moolgavkar 1988; Pawitan 2001, section 3.4.

use super::ArmaError;
use super::likelihood::{Mean, screen};
use super::model::ArmaFit;
use super::optimise::{EDGE, SCALES};
use super::search::Problem;
use crate::quasi_newton::{Objective, Point, bfgs};
use statrs::distribution::{ContinuousCDF, Normal};

/// Coefficient of an ARMA(1,1) whose interval is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Root {
    /// The autoregressive one, φ: how long the slow part lasts.
    Ar,
    /// The moving-average one, θ: with φ − θ, how large the slow part is.
    Ma,
}

/// Interval for `log(1 − c)`, c = φ or θ. Minus that of φ is about the logarithm of the correlation
/// time in samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProfileInterval {
    /// `log(1 − c)` at the optimum.
    pub estimate: f64,
    /// Lower end; −∞ where c = 1 is not contradicted.
    pub low: f64,
    /// Upper end; ln 2 where c = −1 is not contradicted.
    pub high: f64,
}

impl ProfileInterval {
    /// Whether the coefficient `c` is in the interval.
    ///
    /// ```
    /// use undrift_noise::arma::ProfileInterval;
    /// // Correlation times of 20 to 500 samples, the likeliest 100.
    /// let interval = ProfileInterval { estimate: 0.01_f64.ln(), low: 0.002_f64.ln(), high: 0.05_f64.ln() };
    /// assert!(interval.contains(0.99) && interval.contains(0.997) && !interval.contains(0.9));
    /// ```
    pub fn contains(&self, c: f64) -> bool {
        let at = (-c).ln_1p();
        self.low <= at && at <= self.high
    }
}

/// Predicted decrease at which the search over the other parameter stops: 1e-4 of the log-likelihood
/// moves an end by less than a ten-thousandth of the interval.
const TOLERANCE: f64 = 1e-4;
/// Accuracy of an end, as a share of its distance from the estimate.
const SHARE: f64 = 1e-3;

/// Profile-likelihood interval for `log(1 − φ)` or `log(1 − θ)` of the ARMA(1,1) `fit` of `samples`,
/// with probability `level` (0.95, say) for long records; the other coefficient, σ² and, where the
/// fit estimated it, the mean are at their best for every value. The part around the optimum is
/// returned, should the likelihood rise again further out. Tens of likelihood evaluations.
///
/// ```
/// use undrift_nav::shaping::ShapingFilter;
/// use undrift_noise::arma::{FitOptions, Root, fit, profile_interval};
/// use undrift_noise::synthesis::NoiseGenerator;
/// // A slow error of correlation time 100 samples under white noise.
/// let process = ShapingFilter::arma(&[0.99], &[0.9], 1e-3, 0.01)?;
/// let record: Vec<f64> = NoiseGenerator::new(&process, 1).take(3000).collect();
/// let fitted = fit(&record, 1, 1, &FitOptions::default())?;
/// let interval = profile_interval(&record, &fitted, Root::Ar, 0.95)?;
/// assert!(interval.contains(0.99) && !interval.contains(0.9));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// A fit that is not an ARMA(1,1) without unit root; a level outside (0, 1); a number of samples that
/// is not that of the fit; else as [`super::fit()`].
pub fn profile_interval(
    samples: &[f64],
    fit: &ArmaFit,
    root: Root,
    level: f64,
) -> Result<ProfileInterval, ArmaError> {
    if fit.order() != (1, 1) || fit.has_unit_root {
        return Err(ArmaError::BadOption("the order for a profile"));
    }
    if !(level > 0.0 && level < 1.0) {
        return Err(ArmaError::BadOption("the level of the interval"));
    }
    let (sample_mean, present) = screen(samples, 2)?;
    if present != fit.n {
        return Err(ArmaError::BadOption("the number of samples"));
    }
    // φ, θ, σ² and the mean.
    let mean = if fit.parameters == 4 {
        Mean::Estimated
    } else {
        Mean::Known(fit.mean)
    };
    let problem = Problem {
        samples,
        mean,
        centre: match mean {
            Mean::Known(value) => value,
            Mean::Estimated => sample_mean,
        },
        gaps: present < samples.len(),
        bridged: None,
        unit_root: false,
        rest: &[],
    };
    let (own, other) = match root {
        Root::Ar => (fit.ar[0], fit.ma[0]),
        Root::Ma => (fit.ma[0], fit.ar[0]),
    };
    let own = own.atanh().clamp(-EDGE, EDGE);
    let profile = Profile {
        problem: &problem,
        root,
        least: -fit.log_likelihood,
        optimum: (own, other.atanh().clamp(-EDGE, EDGE)),
    };
    let normal = Normal::standard();
    let depth = normal.inverse_cdf(0.5 + 0.5 * level);
    // Standard error in the search coordinate, z = artanh c: dz = dc/(1 − c²).
    let error = fit.standard_errors.as_ref().map_or(0.5, |errors| {
        let index = usize::from(root == Root::Ma);
        errors[index] * own.cosh().powi(2)
    });
    let step = error.clamp(0.01, 1.0) * depth;
    let upward = profile.endpoint(step, depth);
    let downward = profile.endpoint(-step, depth);
    Ok(ProfileInterval {
        estimate: distance(own),
        low: upward.map_or(f64::NEG_INFINITY, distance),
        high: downward.map_or(core::f64::consts::LN_2, distance),
    })
}

/// `log(1 − tanh z)`.
fn distance(z: f64) -> f64 {
    core::f64::consts::LN_2 - (2.0 * z).exp().ln_1p()
}

/// The profile over one search coordinate.
struct Profile<'a> {
    problem: &'a Problem<'a>,
    root: Root,
    /// Negative log-likelihood at the optimum, its minimum.
    least: f64,
    /// The optimum: the coordinate of the profile, and the other one.
    optimum: (f64, f64),
}

impl Profile<'_> {
    /// Root of twice the log-likelihood that is lost at `z`, maximised over the other coordinate: nearly linear in z. `near` is that
    /// coordinate's best value nearby, with its curvature, from which the search starts, and becomes that at `z`; `moved` is z
    /// less that of `near`.
    ///
    /// Signed square roots of deviances are nearly linear where the likelihood is nearly normal,
    /// which is why ends are sought on this scale and not on the deviance itself.
    fn root_deviance(&self, z: f64, moved: f64, near: &mut Point) -> f64 {
        let function = |others: &[Vec<f64>]| {
            let point = |other: &Vec<f64>| match self.root {
                Root::Ar => vec![z, other[0]],
                Root::Ma => vec![other[0], z],
            };
            let points: Vec<_> = others.iter().map(point).collect();
            self.problem.objective(&points, 1)
        };
        let mut objective = Objective::new(&function, SCALES);
        // Where it was, moved along the ridge φ ≈ θ, and a grid: 1 − c in steps of e² ≈ 7.
        let mut starts = vec![vec![near.z[0]], vec![near.z[0] + moved]];
        starts.extend((-1..=8).map(|k| vec![f64::from(k)]));
        let start = objective
            .points(starts)
            .into_iter()
            .min_by(|a, b| a.value.total_cmp(&b.value));
        if let Some(mut start) = start {
            start.inverse.clone_from(&near.inverse);
            *near = bfgs(&mut objective, &start, TOLERANCE, 50);
        }
        (2.0 * (near.value - self.least)).max(0.0).sqrt()
    }

    /// The coordinate on the side of `step` at which the root deviance is `target`; `None` where it
    /// is not within the range of the search.
    fn endpoint(&self, step: f64, target: f64) -> Option<f64> {
        let mut near = Point::new(vec![self.optimum.1], self.least);
        // Outwards, until too deep.
        let mut inner = (self.optimum.0, -target);
        let mut step = step;
        let mut outer = loop {
            let z = (inner.0 + step).clamp(-EDGE, EDGE);
            let excess = self.root_deviance(z, z - inner.0, &mut near) - target;
            if excess > 0.0 {
                break (z, excess);
            }
            if z.abs() >= EDGE {
                return None;
            }
            // As far again as the depth gained suggests is missing, within limits.
            let gained = excess - inner.1;
            let missing = -excess / gained;
            step *= if missing.is_finite() && missing > 0.0 {
                (1.1 * missing).clamp(0.2, 3.0)
            } else {
                3.0
            };
            inner = (z, excess);
        };
        // Between: false position, halving the weight of an end that stays twice (Illinois).
        let (mut last, mut weights, mut side) = (outer.0, (inner.1, outer.1), 0.0);
        for _ in 0..40 {
            if (outer.0 - inner.0).abs() < SHARE * (outer.0 - self.optimum.0).abs() {
                break;
            }
            let z = outer.0 - weights.1 * (outer.0 - inner.0) / (weights.1 - weights.0);
            let excess = self.root_deviance(z, z - last, &mut near) - target;
            if excess.abs() < SHARE * target {
                return Some(z);
            }
            let stays = if side * excess > 0.0 { 0.5 } else { 1.0 };
            if excess > 0.0 {
                outer = (z, excess);
                weights = (stays * weights.0, excess);
            } else {
                inner = (z, excess);
                weights = (excess, stays * weights.1);
            }
            (last, side) = (z, excess);
        }
        Some(outer.0)
    }
}
