//! Linear prediction order by order: the Levinson-Durbin recursion and Burg's reflections.
//!
//! A reflection κ of order p takes φ to `φ_j − κ φ_{p−j}` with κ last, and the variance of the error to (1 −
//! κ²) of itself: from autocovariances κ is the partial autocorrelation (Durbin 1960), from a record what
//! minimises forward and backward errors together (Burg 1967).
//!
//! Shared by autoregressions, partial autocorrelations and the search coordinates of ARMA fits. |κ|
//! < 1 at every order is what makes a predictor stable; neither Burg's κ nor those of sample
//! autocovariances exceed 1.

use crate::screening::record::dot;

/// The best linear predictor `x_t ≈ φ1 x_{t−1} + … + φp x_{t−p}`, grown one order at a time. Box,
/// Jenkins & Reinsel, appendix A3.2; Brockwell & Davis 1991, proposition 5.2.1.
#[derive(Clone, Debug)]
pub(crate) struct Predictor {
    /// φ1 … φp.
    pub(crate) phi: Vec<f64>,
    /// Variance of the prediction's error \[unit²\].
    pub(crate) variance: f64,
}

impl Predictor {
    /// Order 0, for a series of this variance \[unit²\].
    pub(crate) fn new(variance: f64) -> Self {
        Self {
            phi: Vec::new(),
            variance,
        }
    }

    /// The next partial autocorrelation, from the autocovariances γ_0 … γ_{p+1}; NaN where nothing is
    /// left to predict or a lag is missing.
    ///
    /// `covariance[k]` is γ_k \[unit²\].
    pub(crate) fn reflection(&self, covariance: &[f64]) -> f64 {
        let lag = self.phi.len() + 1;
        let (Some(&next), true) = (covariance.get(lag), self.variance != 0.0) else {
            return f64::NAN;
        };
        let before = covariance[1..lag].iter().rev();
        let predicted: f64 = self.phi.iter().zip(before).map(|(c, g)| c * g).sum();
        (next - predicted) / self.variance
    }

    /// Durbin's step: one order more, with this partial autocorrelation.
    ///
    /// O(p).
    pub(crate) fn extend(&mut self, reflection: f64) {
        let turned: Vec<f64> = self.phi.iter().rev().copied().collect();
        for (c, r) in self.phi.iter_mut().zip(&turned) {
            *c -= reflection * r;
        }
        self.phi.push(reflection);
        self.variance *= (1.0 - reflection) * (1.0 + reflection);
    }
}

/// Burg's method on a series about zero: at each of `lags` the reflection that minimises the forward
/// and backward errors together, 0 where none are left. O(N) a lag, one copy. Burg 1967; Percival &
/// Walden 1993, section 9.5.
pub(crate) fn burg(mut forward: Vec<f64>, lags: usize) -> Vec<f64> {
    let n = forward.len();
    let mut backward = forward.clone();
    (1..=lags)
        .map(|lag| {
            // The backward error of sample t − 1 keeps its index from lag − 1: it need not move.
            let (ahead, behind) = (&mut forward[lag..], &mut backward[..n - lag]);
            let (mut products, mut squares) = (0.0, 0.0);
            for (f, b) in ahead.chunks(1024).zip(behind.chunks(1024)) {
                products += dot(f, b);
                squares += dot(f, f) + dot(b, b);
            }
            let reflection = if squares > 0.0 {
                2.0 * products / squares
            } else {
                0.0
            };
            for (f, b) in ahead.iter_mut().zip(behind.iter_mut()) {
                (*f, *b) = (*f - reflection * *b, *b - reflection * *f);
            }
            reflection
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_second_order_autoregression_is_found_from_its_autocovariances() {
        // x_t = 0.6 x_{t−1} + 0.3 x_{t−2} + a_t: ρ1 = 0.6/0.7, ρ_k by the same recursion.
        let mut rho = vec![1.0, 0.6 / 0.7];
        for k in 2..5 {
            rho.push(0.6 * rho[k - 1] + 0.3 * rho[k - 2]);
        }
        let mut predictor = Predictor::new(rho[0]);
        for _ in 0..4 {
            predictor.extend(predictor.reflection(&rho));
        }
        for (found, exact) in predictor.phi.iter().zip([0.6, 0.3, 0.0, 0.0]) {
            assert!((found - exact).abs() < 1e-14, "{predictor:?}");
        }
        let variance = rho[0] - 0.6 * rho[1] - 0.3 * rho[2];
        assert!((predictor.variance - variance).abs() < 1e-14);
        assert!(predictor.reflection(&rho).is_nan());
    }

    #[test]
    fn burg_of_a_pure_decay_is_its_pole() {
        // Forward errors vanish, and backward ones are x (1 − 1/0.5²)·…: 2Σfb/(Σf²+Σb²) with f = b/2.
        let decay: Vec<f64> = (0..20).map(|k| 0.5f64.powi(k)).collect();
        let found = burg(decay, 1);
        assert!((found[0] - 2.0 * 0.5 / (1.0 + 0.25)).abs() < 1e-12);
    }
}
