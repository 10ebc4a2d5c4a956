//! How a smooth function of a few logarithms is minimised, and how certain its minimum is.
//!
//! For normal noise the inverse of the second derivatives at the optimum is the covariance of the estimates in
//! long records (Cramér & Rao's bound is reached). In short ones, and for correlation times that are not short
//! against a record, [`super::interval`] is better.

use crate::quasi_newton::{Objective, Point, moved};
use nalgebra::DMatrix;

/// Covariance at a minimum of a negative log-likelihood: the inverse of its second differences, with
/// steps that raise the function by about a tenth. None where it is not curved upwards in every
/// direction.
pub(crate) fn covariance(objective: &mut Objective, least: &Point) -> Option<DMatrix<f64>> {
    let (_, metric) = objective.differences(&least.z, least.value, true);
    let steps = metric.diagonal().map(|m| (0.2 * m).sqrt().min(0.3));
    let around =
        (0..steps.len()).flat_map(|i| [1.0, -1.0].map(|s| moved(&least.z, i, s * steps[i])));
    let around = objective.at_all(&Vec::from_iter(around));
    let beside = Vec::from_iter(around.chunks(2).map(|pair| [pair[0], pair[1]]));
    let hessian = objective.second_differences(&least.z, least.value, steps.as_slice(), &beside)?;
    Some(hessian.cholesky()?.inverse())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quasi_newton::best_of;
    use crate::terms::SCALES;

    fn minimise(f: &dyn Fn(&[f64]) -> f64, start: &[f64], tolerance: f64) -> Point {
        let all = |z: &[Vec<f64>]| z.iter().map(|z| f(z)).collect();
        let mut objective = Objective::new(&all, SCALES);
        best_of(&mut objective, vec![start.to_vec()], 1, tolerance, 200).unwrap()
    }

    #[test]
    fn a_curved_valley_and_its_covariance() {
        let rosenbrock = |z: &[f64]| (1.0 - z[0]).powi(2) + 100.0 * (z[1] - z[0] * z[0]).powi(2);
        let least = minimise(&rosenbrock, &[-1.2, 1.0], 1e-9);
        assert!(least.converged && least.value < 1e-7, "{least:?}");
        let quadratic = |z: &[f64]| 2.0 * z[0] * z[0] + z[0] * z[1] + 50.0 * z[1] * z[1];
        let least = minimise(&quadratic, &[1.0, -1.0], 1e-12);
        let all = |z: &[Vec<f64>]| z.iter().map(|z| quadratic(z)).collect();
        // Inverse of [[4, 1], [1, 100]].
        let found = covariance(&mut Objective::new(&all, SCALES), &least).unwrap();
        for (ours, exact) in found.iter().zip([100.0, -1.0, -1.0, 4.0]) {
            assert!((ours - exact / 399.0).abs() < 1e-8, "{found:?}");
        }
    }

    #[test]
    fn walls_are_kept_away_from() {
        let walled = |z: &[f64]| match z[0] < 0.5 {
            true => f64::INFINITY,
            false => z[0] * z[0],
        };
        let least = minimise(&walled, &[2.0], 1e-9);
        assert!(least.value.is_finite() && least.z[0] >= 0.5 && least.z[0] < 0.6);
    }
}
