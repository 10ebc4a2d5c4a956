//! What an optimum is worth: standard errors from the curvature, cancelling roots, flat directions,
//! unit roots.

use super::fit::ArmaFit;
use super::optimise::Point;
use super::polynomial::{distance, inverse_roots};
use super::search::Problem;
use super::starts::encode;
use std::fmt;

/// What should be said with a fitted model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Warning {
    /// An AR root and an MA root cannot be told apart.
    NearCancelling {
        /// Distance of the two inverse roots.
        distance: f64,
        /// Its standard error, where the curvature gives one.
        standard_error: Option<f64>,
    },
    /// The likelihood hardly depends on some combination of the parameters.
    FlatLikelihood,
    /// An AR root is within ten correlation times a record of 1; standard errors of φ are then not normal.
    UnitRoot {
        /// `1 − |ρ|` of the inverse root nearest to 1.
        distance: f64,
    },
    /// An MA root is on the unit circle to the record's precision: over-differenced, or a piling-up
    /// of the likelihood at the boundary.
    MovingAverageUnitRoot {
        /// `1 − |ρ|` of that inverse root.
        distance: f64,
    },
    /// No standard errors: the curvature at the optimum is singular or the optimum on the boundary.
    NoStandardErrors,
    /// The search stopped before it met its tolerance.
    NotConverged,
    /// Fewer than ten samples a parameter.
    ShortRecord,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NearCancelling {
                distance,
                standard_error: Some(error),
            } => write!(
                f,
                "an autoregressive and a moving-average root nearly cancel: {distance:.2e} apart with a standard error of {error:.1e}"
            ),
            Self::NearCancelling { distance, .. } => write!(
                f,
                "an autoregressive and a moving-average root nearly cancel: {distance:.2e} apart"
            ),
            Self::FlatLikelihood => f.write_str(
                "the likelihood is flat in some direction: the coefficients are not well determined, what they predict is",
            ),
            Self::UnitRoot { distance } => write!(
                f,
                "an autoregressive root is 1 as far as the record can tell ({distance:.1e} from it): a random walk in effect"
            ),
            Self::MovingAverageUnitRoot { distance } => write!(
                f,
                "a moving-average root is on the unit circle as far as the record can tell ({distance:.1e} from it)"
            ),
            Self::NoStandardErrors => {
                f.write_str("no standard errors: the likelihood is singular at its best")
            }
            Self::NotConverged => f.write_str("the search stopped before it met its tolerance"),
            Self::ShortRecord => f.write_str("fewer than ten samples a parameter"),
        }
    }
}

/// Correlation times a record must be long for a root to count as clear of 1.
const CORRELATION_TIMES: f64 = 10.0;
/// An MA root closer to the circle than this over N counts as on it.
const PILED_UP: f64 = 0.05;
/// 5 % point of χ²(2). In truth the ratio has a heavier tail where the pair cancels, since its
/// place is then not identified: a conservative limit would be higher.
const PAIR: f64 = 5.99;
/// Standard error in a search coordinate beyond which its direction is flat.
const FLAT: f64 = 1.0;

/// A start of order (p, q) from coefficients of lower or equal order, or `None`.
pub(super) fn padded_start(
    phi: &[f64],
    theta: &[f64],
    p: usize,
    q: usize,
    unit_root: bool,
) -> Option<Vec<f64>> {
    let mut phi = phi.to_vec();
    if unit_root && !phi.is_empty() {
        phi = (0..phi.len() - 1)
            .map(|k| -phi[k + 1..].iter().sum::<f64>())
            .collect();
    }
    if phi.len() > p || theta.len() > q {
        return None;
    }
    phi.resize(p, 0.0);
    let mut theta = theta.to_vec();
    theta.resize(q, 0.0);
    Some(encode(&phi, &theta, 1e-9))
}

/// Fills in standard errors, flags and warnings.
/// `covariance_z` is the inverse curvature in the search coordinates, where there is one, `lower` the negative
/// log-likelihood at ARMA(p−1, q−1).
pub(super) fn examine(
    problem: &Problem,
    best: &Point,
    covariance_z: Option<Vec<f64>>,
    p: usize,
    lower: Option<f64>,
    fit: &mut ArmaFit,
) {
    fit.pair_likelihood_ratio = lower.map(|lower| 2.0 * (lower - best.value));
    let n = fit.n as f64;
    let z = &best.z;
    let d = z.len();
    let ma_roots = inverse_roots(&fit.ma);
    let ar_roots = inverse_roots(&fit.ar);
    let piled_up = ma_roots
        .iter()
        .map(|r| 1.0 - r.0.hypot(r.1))
        .fold(f64::INFINITY, f64::min);
    let on_boundary = piled_up < PILED_UP / n;
    fit.flat_likelihood = d > 0
        && covariance_z
            .as_ref()
            .is_none_or(|c| (0..d).any(|i| c[i * d + i].sqrt() > FLAT));
    // How the coefficients and the roots' distance move with the search coordinates.
    let full = fit.ar.len() + fit.ma.len();
    let mut slopes = vec![0.0; full * d];
    let mut distance_slope = vec![0.0; d];
    let nearest = nearest_pair(&fit.ar, &fit.ma);
    for i in 0..d {
        let h = 1e-5;
        let shifted = |by: f64| {
            let mut moved = z.clone();
            moved[i] += by;
            let (mut phi, theta) = problem.coefficients(&moved, p);
            if fit.has_unit_root && !problem.unit_root {
                phi = super::polynomial::multiply(&phi, &[1.0]);
            }
            let distance = nearest_pair(&phi, &theta).unwrap_or(0.0);
            phi.extend(theta);
            (phi, distance)
        };
        let (up, down) = (shifted(h), shifted(-h));
        for k in 0..full {
            slopes[k * d + i] = (up.0[k] - down.0[k]) / (2.0 * h);
        }
        distance_slope[i] = (up.1 - down.1) / (2.0 * h);
    }
    let mut distance_error = None;
    if let Some(c) = &covariance_z
        && !on_boundary
    {
        let mut covariance = vec![0.0; full * full];
        for a in 0..full {
            for b in 0..full {
                let mut sum = 0.0;
                for i in 0..d {
                    for j in 0..d {
                        sum += slopes[a * d + i] * c[i * d + j] * slopes[b * d + j];
                    }
                }
                covariance[a * full + b] = sum;
            }
        }
        let mut variance = 0.0;
        for i in 0..d {
            for j in 0..d {
                variance += distance_slope[i] * c[i * d + j] * distance_slope[j];
            }
        }
        distance_error = Some(variance.max(0.0).sqrt());
        fit.standard_errors = Some(
            (0..full)
                .map(|k| covariance[k * full + k].max(0.0).sqrt())
                .collect(),
        );
        fit.covariance = Some(covariance);
    } else if d > 0 {
        fit.warnings.push(Warning::NoStandardErrors);
    }
    if let Some(distance) = nearest {
        // Without a standard error, two roots that the record's length cannot resolve.
        let limit = distance_error.map_or(2.0 / n.sqrt(), |e| 2.0 * e);
        let worth_it = fit.pair_likelihood_ratio.is_none_or(|ratio| ratio > PAIR);
        fit.near_cancelling = distance < limit || !worth_it;
        if fit.near_cancelling {
            fit.warnings.push(Warning::NearCancelling {
                distance,
                standard_error: distance_error,
            });
        }
    }
    if fit.flat_likelihood {
        fit.warnings.push(Warning::FlatLikelihood);
    }
    let to_one = ar_roots
        .iter()
        .map(|r| distance(*r, (1.0, 0.0)))
        .fold(f64::INFINITY, f64::min);
    if fit.has_unit_root || to_one * n < CORRELATION_TIMES {
        fit.unit_root = true;
        fit.warnings.push(Warning::UnitRoot {
            distance: if fit.has_unit_root { 0.0 } else { to_one },
        });
    }
    if on_boundary {
        fit.warnings
            .push(Warning::MovingAverageUnitRoot { distance: piled_up });
    }
    if !fit.converged {
        fit.warnings.push(Warning::NotConverged);
    }
    if n < 10.0 * fit.parameters as f64 {
        fit.warnings.push(Warning::ShortRecord);
    }
}

/// Smallest distance between an AR and an MA inverse root.
fn nearest_pair(phi: &[f64], theta: &[f64]) -> Option<f64> {
    let (ar, ma) = (inverse_roots(phi), inverse_roots(theta));
    let pairs = ar.iter().flat_map(|a| ma.iter().map(|m| distance(*a, *m)));
    pairs.min_by(f64::total_cmp)
}
