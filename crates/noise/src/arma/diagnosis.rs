//! What an optimum is worth: standard errors from the curvature, cancelling roots, flat directions,
//! unit roots.

use super::model::{ArmaFit, Warning};
use super::polynomial::{inverse_roots, less_unit_root};
use super::search::Problem;
use super::starts::encode;
use crate::quasi_newton::Point;
use nalgebra::{DMatrix, DVector};

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
    let mut phi = if unit_root {
        less_unit_root(phi)
    } else {
        phi.to_vec()
    };
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
    covariance_z: Option<DMatrix<f64>>,
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
        .map(|r| 1.0 - r.norm())
        .fold(f64::INFINITY, f64::min);
    let on_boundary = piled_up < PILED_UP / n;
    fit.flat_likelihood = d > 0
        && covariance_z
            .as_ref()
            .is_none_or(|c| c.diagonal().iter().any(|variance| variance.sqrt() > FLAT));
    // How the coefficients and the roots' distance move with the search coordinates.
    let full = fit.ar.len() + fit.ma.len();
    let mut slopes = DMatrix::zeros(full, d);
    let mut distance_slope = DVector::zeros(d);
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
            slopes[(k, i)] = (up.0[k] - down.0[k]) / (2.0 * h);
        }
        distance_slope[i] = (up.1 - down.1) / (2.0 * h);
    }
    let mut distance_error = None;
    if let Some(c) = &covariance_z
        && !on_boundary
    {
        let covariance = &slopes * c * slopes.transpose();
        let variance = distance_slope.dot(&(c * &distance_slope));
        distance_error = Some(variance.max(0.0).sqrt());
        let variances = covariance.diagonal();
        fit.standard_errors = Some(variances.iter().map(|v| v.max(0.0).sqrt()).collect());
        fit.covariance = Some(covariance.transpose().as_slice().to_vec());
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
        .map(|r| (r - 1.0).norm())
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
    let pairs = ar
        .iter()
        .flat_map(|a| ma.iter().map(move |m| (a - m).norm()));
    pairs.min_by(f64::total_cmp)
}
