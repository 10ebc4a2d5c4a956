//! What an optimum is worth: standard errors from the curvature, cancelling roots, flat directions,
//! unit roots.
//!
//! | finding | where |
//! |---|---|
//! | roots cancel | their distance is below two of its standard errors, or the pair is worth less than 5.99 in 2 log L |
//! | flat | some search coordinate has a standard error above 1: its root's distance to the circle is open by e² |
//! | unit root | an AR root is so close to 1 that the record is shorter than ten of its correlation times |
//! | MA root on the circle | closer than 0.05/N |
//! | short record | fewer than ten samples a parameter |
//!
//! Standard errors are those of the search coordinates carried to the coefficients (delta method); on the edge of the
//! invertible region, where the likelihood is not quadratic, they are not given.
//!
//! Nothing here changes the fit: coefficients stay as the search left them, and findings are flags
//! and [`Warning`]s on the result. A near-cancelling pair is usual for a good gyro, φ = 0.9999 and
//! θ = 0.999 say: the warning then says that the record is too short to separate bias from white
//! noise, and block averages ([`crate::scales`]) show it better.

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
///
/// `None` where one of the orders is higher, so that the model is not inside.
///
/// Used to start a higher order from a lower one: added coefficients are zero, so that it begins
/// with the likelihood of the lower one.
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
///
/// Derivatives of the coefficients by the search coordinates are central differences with steps of
/// 1e-5. With an MA root on the circle standard errors are withheld.
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
///
/// In the z plane; `None` where one of the polynomials has no coefficient.
fn nearest_pair(phi: &[f64], theta: &[f64]) -> Option<f64> {
    let (ar, ma) = (inverse_roots(phi), inverse_roots(theta));
    let pairs = ar
        .iter()
        .flat_map(|a| ma.iter().map(move |m| (a - m).norm()));
    pairs.min_by(f64::total_cmp)
}

#[cfg(test)]
mod tests {
    use super::super::likelihood::Mean;
    use super::super::polynomial::multiply;
    use super::*;

    const PROBLEM: Problem = Problem {
        samples: &[],
        mean: Mean::Known(0.0),
        centre: 0.0,
        gaps: false,
        bridged: None,
        unit_root: false,
        rest: &[],
    };

    /// A converged fit of `n` samples, examined with this inverse curvature.
    fn examined(
        phi: &[f64],
        theta: &[f64],
        n: usize,
        covariance_z: &[f64],
        ratio: Option<f64>,
    ) -> ArmaFit {
        let fit = ArmaFit {
            ar: phi.to_vec(),
            ma: theta.to_vec(),
            n,
            parameters: phi.len() + theta.len() + 1,
            converged: true,
            ..ArmaFit::default()
        };
        let d = phi.len() + theta.len();
        let covariance = DMatrix::from_row_slice(d, d, covariance_z);
        after(fit, phi, theta, Some(covariance), ratio)
    }

    fn after(
        mut fit: ArmaFit,
        phi: &[f64],
        theta: &[f64],
        covariance_z: Option<DMatrix<f64>>,
        ratio: Option<f64>,
    ) -> ArmaFit {
        let best = Point::new(encode(phi, theta, 0.0), 100.0);
        let lower = ratio.map(|ratio| 100.0 + 0.5 * ratio);
        examine(&PROBLEM, &best, covariance_z, phi.len(), lower, &mut fit);
        fit
    }

    fn assert_near(found: &[f64], exact: &[f64]) {
        assert_eq!(found.len(), exact.len());
        for (a, b) in found.iter().zip(exact) {
            // Central differences of a step of 1e-5.
            assert!(
                (a - b).abs() < 1e-8 * (1.0 + b.abs()),
                "{found:?} {exact:?}"
            );
        }
    }

    fn cancelling(fit: &ArmaFit) -> Option<(f64, Option<f64>)> {
        fit.warnings.iter().find_map(|warning| match *warning {
            Warning::NearCancelling {
                distance,
                standard_error,
            } => Some((distance, standard_error)),
            _ => None,
        })
    }

    #[test]
    fn standard_errors_follow_the_coefficients_slopes() {
        // φ = tanh z and θ = tanh z: slopes 1 − φ² and 1 − θ².
        let (a, b) = (1.0 - 0.8 * 0.8, 1.0 - 0.3 * 0.3);
        let fit = examined(&[0.8], &[0.3], 1000, &[0.01, 0.004, 0.004, 0.02], None);
        let (aa, ab, bb) = (a * a * 0.01, a * b * 0.004, b * b * 0.02);
        assert_near(fit.covariance.as_ref().unwrap(), &[aa, ab, ab, bb]);
        assert_near(
            fit.standard_errors.as_ref().unwrap(),
            &[aa.sqrt(), bb.sqrt()],
        );
        assert!(fit.warnings.is_empty() && !fit.near_cancelling && !fit.flat_likelihood);
        // φ1 = κ1 (1 − κ2), φ2 = κ2 = tanh z2.
        let (one, two) = (0.5f64, -0.4f64);
        let fit = examined(
            &[one * (1.0 - two), two],
            &[],
            1000,
            &[0.01, 0.0, 0.0, 0.02],
            None,
        );
        let slope = 1.0 - two * two;
        let first = ((1.0 - one * one) * (1.0 - two)).powi(2) * 0.01;
        let first = first + (one * slope).powi(2) * 0.02;
        let cross = -one * slope * slope * 0.02;
        let second = slope * slope * 0.02;
        assert_near(&fit.covariance.unwrap(), &[first, cross, cross, second]);
    }

    #[test]
    fn a_fixed_unit_root_stays_and_is_said() {
        let fit = ArmaFit {
            ar: multiply(&[0.4], &[1.0]),
            n: 1000,
            converged: true,
            has_unit_root: true,
            ..ArmaFit::default()
        };
        // φ1 = 1 + a and φ2 = −a.
        let covariance = DMatrix::from_element(1, 1, 0.01);
        let fit = after(fit, &[0.4], &[], Some(covariance), None);
        let error = 0.1 * (1.0 - 0.4 * 0.4);
        assert_near(fit.standard_errors.as_ref().unwrap(), &[error, error]);
        assert!(fit.unit_root);
        assert_eq!(fit.warnings, [Warning::UnitRoot { distance: 0.0 }]);
    }

    #[test]
    fn a_pair_cancels_within_two_errors_of_its_distance_or_where_it_brings_too_little() {
        let (a, b) = (1.0 - 0.8f64 * 0.8, 1.0 - 0.3f64 * 0.3);
        // Half of it along the difference: an error of 0.5/2 at `scale` 1.
        let error = (a * a + b * b - a * b).sqrt();
        let size = (0.25 / error).powi(2);
        for (scale, ratio, expected) in [
            (1.02, Some(100.0), true),
            (0.98, Some(100.0), false),
            (0.98, None, false),
            (0.98, Some(6.0), false),
            (0.98, Some(5.98), true),
        ] {
            let v = size * scale;
            let fit = examined(&[0.8], &[0.3], 1000, &[v, 0.5 * v, 0.5 * v, v], ratio);
            assert_eq!(fit.near_cancelling, expected, "{scale} {ratio:?}");
            let brought = fit.pair_likelihood_ratio.map(|r| (r * 1e6).round() / 1e6);
            assert_eq!(brought, ratio);
            let said = cancelling(&fit);
            assert_eq!(said.is_some(), expected);
            if let Some((distance, standard_error)) = said {
                assert_near(&[distance], &[0.5]);
                assert_near(&[standard_error.unwrap()], &[0.25 * f64::sqrt(scale)]);
            }
        }
        // Without an error, 2/√n: 0.1 of 400 samples.
        for (theta, expected) in [(0.41, true), (0.39, false), (0.59, true), (0.61, false)] {
            let fit = ArmaFit {
                ar: vec![0.5],
                ma: vec![theta],
                n: 400,
                converged: true,
                ..ArmaFit::default()
            };
            let fit = after(fit, &[0.5], &[theta], None, None);
            assert_eq!(fit.near_cancelling, expected, "{theta}");
            assert!(fit.standard_errors.is_none() && fit.flat_likelihood);
            assert!(fit.warnings.contains(&Warning::NoStandardErrors));
            assert!(cancelling(&fit).is_none_or(|(_, error)| error.is_none()));
        }
    }

    #[test]
    fn a_root_is_1_where_the_record_is_not_ten_of_its_correlation_times() {
        for (phi, n, expected) in [(0.99, 999, true), (0.99, 1001, false), (-0.99, 999, false)] {
            let fit = examined(&[phi], &[], n, &[0.01], None);
            assert_eq!(fit.unit_root, expected, "{phi} {n}");
            let said = fit.warnings.iter().find_map(|warning| match warning {
                Warning::UnitRoot { distance } => Some(*distance),
                _ => None,
            });
            assert_eq!(said.is_some(), expected);
            assert!(said.is_none_or(|distance| (distance - 0.01).abs() < 1e-12));
        }
    }

    #[test]
    fn on_the_edge_of_the_invertible_region_there_are_no_standard_errors() {
        for (theta, on_edge) in [
            (1.0 - 4.9e-5, true),
            (1.0 - 5.1e-5, false),
            (5.1e-5 - 1.0, false),
        ] {
            let fit = examined(&[], &[theta], 1000, &[0.01], None);
            assert_eq!(fit.standard_errors.is_none(), on_edge, "{theta}");
            assert_eq!(fit.warnings.len(), if on_edge { 2 } else { 0 });
            if on_edge {
                assert_eq!(fit.warnings[0], Warning::NoStandardErrors);
                let Warning::MovingAverageUnitRoot { distance } = fit.warnings[1] else {
                    panic!("{:?}", fit.warnings);
                };
                assert!((distance - 4.9e-5).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn a_direction_is_flat_beyond_a_standard_error_of_one() {
        for (error, flat) in [(0.99, false), (1.01, true)] {
            let fit = examined(
                &[0.1, 0.2],
                &[],
                1000,
                &[0.01, 0.0, 0.0, error * error],
                None,
            );
            assert_eq!(fit.flat_likelihood, flat);
            assert_eq!(fit.warnings.contains(&Warning::FlatLikelihood), flat);
        }
        // White noise has no direction.
        let fit = examined(&[], &[], 1000, &[], None);
        assert!(!fit.flat_likelihood && fit.warnings.is_empty());
    }

    #[test]
    fn a_search_that_stopped_and_a_short_record_are_said() {
        let white = |n, converged| {
            let fit = ArmaFit {
                n,
                converged,
                parameters: 2,
                ..ArmaFit::default()
            };
            after(fit, &[], &[], None, None).warnings
        };
        assert_eq!(white(20, true), []);
        assert_eq!(white(19, true), [Warning::ShortRecord]);
        assert_eq!(white(20, false), [Warning::NotConverged]);
    }

    #[test]
    fn a_start_of_a_lower_order_is_the_same_model() {
        let padded = |phi: &[f64], theta: &[f64], p, q, unit_root| {
            let z = padded_start(phi, theta, p, q, unit_root)?;
            Some(PROBLEM.coefficients(&z, p))
        };
        let (phi, theta) = padded(&[0.5, -0.2], &[0.3], 3, 2, false).unwrap();
        assert_near(&phi, &[0.5, -0.2, 0.0]);
        assert_near(&theta, &[0.3, 0.0]);
        assert!(padded(&[0.5, -0.2], &[], 1, 2, false).is_none());
        assert!(padded(&[], &[0.5, -0.2], 2, 1, false).is_none());
        // The unit root is no part of the start.
        let (phi, _) = padded(&multiply(&[0.5], &[1.0]), &[], 1, 0, true).unwrap();
        assert_near(&phi, &[0.5]);
    }
}
