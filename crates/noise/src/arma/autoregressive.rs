//! AR(p) without a search: Burg's method and Yule-Walker by the Levinson recursion. (By likelihood:
//! [`super::fit`] with q = 0.)

use super::ArmaError;
use super::likelihood::screen;

/// An autoregression `x_t − φ1 x_{t−1} − … − φp x_{t−p} = a_t` about a mean.
#[derive(Clone, Debug, PartialEq)]
pub struct ArFit {
    /// φ1 … φp; stationary.
    pub ar: Vec<f64>,
    /// Variance of a [unit²].
    pub variance: f64,
    /// Sample mean that was removed [unit].
    pub mean: f64,
    /// Partial autocorrelations at lags 1 … p (reflection coefficients).
    pub partial_autocorrelations: Vec<f64>,
    /// Variance of a at orders 0 … p [unit²].
    pub variance_by_order: Vec<f64>,
}

fn checked(samples: &[f64], p: usize) -> Result<f64, ArmaError> {
    let (mean, present) = screen(samples, p)?;
    if present < samples.len() {
        return Err(ArmaError::Missing);
    }
    if present <= 2 * p {
        return Err(ArmaError::TooShort {
            present,
            needed: 2 * p + 1,
        });
    }
    Ok(mean)
}

impl ArFit {
    /// Order 0: white noise about a mean.
    fn white(mean: f64, variance: f64) -> Self {
        Self {
            ar: Vec::new(),
            variance,
            mean,
            partial_autocorrelations: Vec::new(),
            variance_by_order: vec![variance],
        }
    }

    /// Durbin's step: the next reflection coefficient extends φ.
    fn add_order(&mut self, kappa: f64) {
        let old = self.ar.clone();
        for j in 0..old.len() {
            self.ar[j] = old[j] - kappa * old[old.len() - 1 - j];
        }
        self.ar.push(kappa);
        self.variance *= (1.0 - kappa) * (1.0 + kappa);
        self.partial_autocorrelations.push(kappa);
        self.variance_by_order.push(self.variance);
    }
}

/// AR(p) by Burg's method: each reflection coefficient minimises the forward and backward
/// prediction errors together. Least biased of the direct methods for a slow pole. Burg 1967;
/// Percival & Walden 1993, section 9.5. O(N p) time, two copies of the record.
///
/// # Errors
/// A record too short, constant, infinite or with missing samples.
pub fn burg(samples: &[f64], p: usize) -> Result<ArFit, ArmaError> {
    let mean = checked(samples, p)?;
    let n = samples.len();
    let mut forward: Vec<f64> = samples.iter().map(|x| x - mean).collect();
    let mut backward = forward.clone();
    let variance = forward.iter().map(|x| x * x).sum::<f64>() / n as f64;
    let mut fit = ArFit::white(mean, variance);
    for order in 1..=p {
        // forward[t] at order−1 pairs with backward[t−1]; backward is kept shifted by one an order.
        let (mut cross, mut power) = (0.0, 0.0);
        for t in order..n {
            let (f, b) = (forward[t], backward[t - order]);
            cross += f * b;
            power += f * f + b * b;
        }
        let kappa = if power > 0.0 {
            2.0 * cross / power
        } else {
            0.0
        };
        for t in order..n {
            let (f, b) = (forward[t], backward[t - order]);
            forward[t] = f - kappa * b;
            backward[t - order] = b - kappa * f;
        }
        fit.add_order(kappa);
    }
    Ok(fit)
}

/// AR(p) by the Yule-Walker equations, from the biased autocovariances (divisor N, so the result
/// is always stationary), solved by the Levinson-Durbin recursion. Box, Jenkins & Reinsel section
/// 3.2. Strongly biased towards zero for a slow pole: Burg or the likelihood are better there.
///
/// # Errors
/// A record too short, constant, infinite or with missing samples.
pub fn yule_walker(samples: &[f64], p: usize) -> Result<ArFit, ArmaError> {
    let mean = checked(samples, p)?;
    let n = samples.len();
    let gamma: Vec<f64> = (0..=p)
        .map(|lag| {
            let sum: f64 = (lag..n)
                .map(|t| (samples[t] - mean) * (samples[t - lag] - mean))
                .sum();
            sum / n as f64
        })
        .collect();
    let mut fit = ArFit::white(mean, gamma[0]);
    for order in 1..=p {
        let predicted: f64 = (1..order).map(|j| fit.ar[j - 1] * gamma[order - j]).sum();
        let kappa = if fit.variance > 0.0 {
            (gamma[order] - predicted) / fit.variance
        } else {
            0.0
        };
        fit.add_order(kappa);
    }
    Ok(fit)
}

/// The order up to `p_max` with the least AICc, `N ln σ²_p + 2 (p+2) N/(N−p−3)`, by Burg's variances.
///
/// # Errors
/// As [`burg`].
pub fn order_by_aicc(samples: &[f64], p_max: usize) -> Result<usize, ArmaError> {
    let fit = burg(samples, p_max)?;
    let n = samples.len() as f64;
    let score = |p: usize| {
        let spare = (n - p as f64 - 3.0).max(0.5);
        n * fit.variance_by_order[p].max(f64::MIN_POSITIVE).ln()
            + 2.0 * (p as f64 + 2.0) * n / spare
    };
    let mut best = 0;
    for p in 1..=p_max {
        if score(p) < score(best) {
            best = p;
        }
    }
    Ok(best)
}
