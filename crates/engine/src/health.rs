//! Whether the covariance of a filter is still symmetric and positive definite after a long log.

use crate::estimator::Estimator;
use alloc::vec::Vec;
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use nalgebra::DMatrix;

/// What rounding has left of a covariance.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CovarianceHealth {
    /// States with a variance: those of navigation, sensors and parameters.
    pub states: usize,
    /// Largest |P_ij − P_ji| over √(P_ii P_jj).
    pub asymmetry: f64,
    /// Least eigenvalue of the matrix of correlations, P_ij over √(P_ii P_jj): negative where it is no
    /// covariance any more.
    pub least_eigenvalue: f64,
}

impl CovarianceHealth {
    /// Of the present state of a filter.
    pub fn new(filter: &dyn Estimator) -> Self {
        let p = filter.covariance();
        let kept: Vec<usize> = (0..filter.states()).filter(|i| p[(*i, *i)] > 0.0).collect();
        let scaled = DMatrix::from_fn(kept.len(), kept.len(), |i, j| {
            let (i, j) = (kept[i], kept[j]);
            p[(i, j)] / (p[(i, i)].sqrt() * p[(j, j)].sqrt())
        });
        let asymmetry = (&scaled - scaled.transpose()).amax();
        let eigenvalues = scaled.symmetric_eigenvalues();
        Self {
            states: kept.len(),
            asymmetry,
            least_eigenvalue: eigenvalues.min(),
        }
    }
}

#[cfg(test)]
mod tests;
