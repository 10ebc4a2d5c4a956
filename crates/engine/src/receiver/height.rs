//! Heights that contradict the solution while the rest of the position does not: another height reference (sea level
//! against ellipsoid), or a receiver that has lost its vertical solution. Then the height alone is rejected.
//!
//! Judged only while nothing else is in doubt, and only where the horizontal part agrees with the solution:
//! else the whole fix is in question. A rejected height keeps its place in the update with ten times its
//! innovation as standard deviation, so that the horizontal part is used as it is.
//!
//! NIS here is of single axes, ν²/(r + σ²), from the diagonal of the covariances; the full gate of
//! the position follows with the widened height. A reset inflates the height of the solution alone
//! \[m\].

use crate::{
    estimator::Estimator,
    gate::{FixGate, Verdict},
    summary::Summary,
};
use undrift_nav::{
    Matrix3, Vector3,
    filter::{Outcome, Update},
};

/// NIS per degree of freedom below which the horizontal part agrees with the solution: three standard deviations.
const AGREES: f64 = 9.0;
/// Standard deviation of a rejected height, in multiples of its innovation.
const BLIND: f64 = 10.0;

/// The gate of heights alone.
#[derive(Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct HeightGate(FixGate);

impl HeightGate {
    pub(super) fn new(time: f64) -> Self {
        Self(FixGate::for_height(time))
    }

    /// What is added to the vertical variance of a position with this innovation and covariance \[m, m²\]: nothing, unless
    /// its height alone contradicts the solution. Heights that go on doing so for `patience` \[s\] and agree with each
    /// other are followed, with all the doubt that this means for the solution's height and for nothing else.
    ///
    /// Called for positions in no other doubt; returns \[m²\].
    pub(super) fn judge(
        &mut self,
        filter: &mut dyn Estimator,
        time: f64,
        innovation: &Vector3,
        r: &Matrix3,
        patience: f64,
        summary: &mut Summary,
    ) -> f64 {
        let std = filter.nav_std();
        let nis = |i: usize| innovation[i] * innovation[i] / (r[(i, i)] + std[i] * std[i]);
        if 0.5 * (nis(0) + nis(1)) > AGREES {
            return 0.0;
        }
        let height = Vector3::new(0.0, 0.0, innovation.z);
        let variance = Matrix3::from_diagonal(&Vector3::new(0.0, 0.0, r[(2, 2)]));
        let outcome = match self.0.judge(time, &height, &variance, patience) {
            Verdict::ResetToFixes(_) => {
                filter.inflate(&height.abs(), 0.0, 0.0);
                self.0.reset_to_fix(time, &height, summary);
                return 0.0;
            }
            Verdict::Limits(gate) if nis(2) > gate.reject => Outcome::Rejected,
            Verdict::Limits(_) => Outcome::Used,
        };
        let update = Update {
            nis: nis(2),
            dof: 1,
            whitened: [0.0; 3],
            score: 0.0,
            information: 0.0,
            outcome,
        };
        self.0.note(time, &height, &update, false, summary);
        match outcome {
            Outcome::Rejected => {
                let blind = BLIND * innovation.z;
                blind * blind
            }
            _ => 0.0,
        }
    }

    /// Writes down what goes on at the end.
    pub(super) fn close(&mut self, summary: &mut Summary) {
        self.0.close(summary);
    }
}
