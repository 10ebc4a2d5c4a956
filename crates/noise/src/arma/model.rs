//! A fitted ARMA model and what should be said with it.

use super::{ArmaError, kalman, polynomial::inverse_roots};
use realfft::num_complex::Complex64;

/// A moving-average root is on the unit circle where it is closer than this over N: the mean of N samples takes out what is slower.
const ON_CIRCLE: f64 = 10.0;
/// An autoregressive root that cancels it is closer to 1 than this: rounding of an integrated signal has one on the circle alone.
const NEAR_ONE: f64 = 0.1;

/// An ARMA model `x_t − φ1 x_{t−1} − … = a_t − θ1 a_{t−1} − …` fitted to a record.
///
/// An ARMA(1,1) with 1 ≥ φ > θ > 0 is an AR(1) of driving variance `(1 − φθ)(φ − θ)/φ · σ²` under white noise
/// of variance `θ/φ · σ²` a sample (docs/theory.md, section 1): what a bias model needs.
/// [`crate::model_file::Arma`] takes the coefficients as they are.
///
/// ```
/// use undrift_nav::shaping::ShapingFilter;
/// use undrift_noise::{Arma, AxisModel, BiasModel, arma::{FitOptions, fit}, synthesis::NoiseGenerator};
/// let truth = ShapingFilter::arma(&[0.99], &[0.8], 1e-3, 0.01)?;
/// let record: Vec<f64> = NoiseGenerator::new(&truth, 1).take(5000).collect();
/// let found = fit(&record, 1, 1, &FitOptions::default())?;
/// let arma = Arma { ar: found.ar.clone(), ma: found.ma.clone(), sigma: found.sigma, rate_hz: 100.0 };
/// let filter = AxisModel { arma: Some(arma), ..AxisModel::default() }.shaping(BiasModel::Arma, 0.01)?;
/// assert_eq!((filter.order, filter.f[0][0]), (1, found.ar[0])); // x_{k+1} = φ x_k + (φ − θ) a_k, ε_k = x_k + a_k.
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ArmaFit {
    /// φ1 … φp. With a unit root, the factor (1 − B) is multiplied in.
    pub ar: Vec<f64>,
    /// θ1 … θq, subtracted (the sign of docs/theory.md).
    pub ma: Vec<f64>,
    /// Standard deviation of a \[unit of the record\].
    pub sigma: f64,
    /// Its square, `Σ v²/V / N` \[unit²\].
    pub variance: f64,
    /// Mean of the record, or the starting level with a unit root \[unit\].
    pub mean: f64,
    /// Standard error of an estimated mean \[unit\]; 0 for a known one.
    pub mean_standard_error: f64,
    /// Exact Gaussian log-likelihood, constants included; with a unit root, the diffuse one.
    pub log_likelihood: f64,
    /// Sum of squares of the one-step prediction errors over their relative variances, `Σ v²/V` \[unit²\].
    pub residual_sum_of_squares: f64,
    /// Parameters counted by the criteria: φ (without the unit root), θ, σ², an estimated mean.
    pub parameters: usize,
    /// Akaike's criterion, `−2 log L + 2k`.
    pub aic: f64,
    /// AIC with the small-sample term `2k(k+1)/(n−k−1)`; infinite where n ≤ k + 1.
    pub aicc: f64,
    /// Bayes' criterion, `−2 log L + k ln n`.
    pub bic: f64,
    /// Standard errors of φ1…φp, θ1…θq from the curvature of the likelihood at the optimum; `None`
    /// where it is singular there or the optimum lies on the edge of the invertible region. With a
    /// unit root those of φ hold the root fixed.
    pub standard_errors: Option<Vec<f64>>,
    /// Covariance of φ1…φp, θ1…θq, row-major, where the standard errors exist.
    pub covariance: Option<Vec<f64>>,
    /// Samples present, less one with a unit root.
    pub n: usize,
    /// One AR root was fixed at exactly 1.
    pub has_unit_root: bool,
    /// Distinct local optima that the search ended in (at least; a measure of how hard it was).
    pub local_optima: usize,
    /// The search met its tolerance (1e-5 in log-likelihood to go).
    pub converged: bool,
    /// `2 (log L − log L′)` with L′ the best likelihood of ARMA(p−1, q−1): what one pair of roots
    /// brings. `None` where p or q has none to give.
    pub pair_likelihood_ratio: Option<f64>,
    /// An AR and an MA root are not distinguishable: closer than two standard errors of their
    /// distance, or worth less than 5.99, the 5 % point of χ²(2), in `pair_likelihood_ratio`.
    pub near_cancelling: bool,
    /// Some direction of the parameters is hardly determined: the log-likelihood falls by less
    /// than ½ when a root's distance to the unit circle changes seven-fold along it.
    pub flat_likelihood: bool,
    /// An AR root is 1, or so close that the record is shorter than ten of its correlation times.
    pub unit_root: bool,
    /// All that should be said with the result.
    pub warnings: Vec<Warning>,
}

impl ArmaFit {
    /// Number of AR and of MA coefficients.
    pub fn order(&self) -> (usize, usize) {
        (self.ar.len(), self.ma.len())
    }

    /// Whether a pair of roots is the mean that was removed, and no noise: a moving-average root on the unit circle, to the length
    /// of the record, beside an autoregressive one that is farther away. The spectrum of such a model falls to nothing below
    /// a few cycles in the record, as that of any record about its own mean does, and its drift stays far too small.
    pub fn is_removed_mean(&self) -> bool {
        let from_one = |roots: Vec<Complex64>| {
            let distances = roots.iter().map(|root| (root - 1.0).norm());
            distances.fold(f64::INFINITY, f64::min)
        };
        let ma = from_one(inverse_roots(&self.ma));
        let ar = from_one(inverse_roots(&self.ar));
        ma * (self.n as f64) < ON_CIRCLE && ma < ar && ar < NEAR_ONE
    }

    /// Exact one-step prediction errors of `samples` under this model over their standard
    /// deviations: independent N(0, 1) when it is right; NaN where a sample is missing.
    ///
    /// ```
    /// use undrift_nav::shaping::ShapingFilter;
    /// use undrift_noise::{arma::{FitOptions, fit}, synthesis::NoiseGenerator, whiteness::portmanteau};
    /// let process = ShapingFilter::ar(&[0.8], 1e-3, 0.01)?;
    /// let record: Vec<f64> = NoiseGenerator::new(&process, 1).take(2000).collect();
    /// let white = |x: &[f64], fitted| Ok::<_, Box<dyn std::error::Error>>(portmanteau(x, &[20], fitted)?[0].ljung_box_p > 0.01);
    /// let model = fit(&record, 1, 0, &FitOptions::default())?;
    /// assert!(!white(&record, 0)? && white(&model.residuals(&record)?, 1)?);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// φ not stationary to working precision.
    pub fn residuals(&self, samples: &[f64]) -> Result<Vec<f64>, ArmaError> {
        kalman::standardised(
            samples,
            self.mean,
            &self.ar,
            &self.ma,
            self.sigma,
            self.has_unit_root,
        )
        .ok_or(ArmaError::NotStationary)
    }
}

/// What should be said with a fitted model.
///
/// None of them makes the fit an error: a filter predicts as well with a pair of roots that cancels. They say
/// what not to read into the coefficients and their standard errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Warning {
    /// An AR root and an MA root cannot be distinguished.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_root_on_the_circle_beside_one_near_it_is_the_mean_that_was_removed() {
        let is_mean = |ar: &[f64], ma: &[f64], n| {
            let fit = ArmaFit {
                ar: ar.to_vec(),
                ma: ma.to_vec(),
                n,
                ..ArmaFit::default()
            };
            fit.is_removed_mean()
        };
        assert!(is_mean(&[0.9996], &[0.9999997], 120_000));
        // Beside a pair that is noise: roots 0.99 and 0.5 over 0.9999999 and −0.3.
        assert!(is_mean(&[1.49, -0.495], &[0.6999999, 0.29999997], 120_000));
        // A bias that wanders: the autoregressive root is the nearer one.
        assert!(!is_mean(&[0.9999], &[0.998], 120_000));
        assert!(!is_mean(&[1.0], &[0.9999997], 120_000));
        // Within the record's length, by ten over N; rounding of an integrated signal; moving averages alone.
        assert!(!is_mean(&[0.9996], &[0.9999], 120_000));
        assert!(!is_mean(&[0.2], &[0.9999997], 120_000));
        assert!(!is_mean(&[], &[0.9999997], 120_000));
        assert!(!is_mean(&[0.9996], &[], 120_000));
    }
}
