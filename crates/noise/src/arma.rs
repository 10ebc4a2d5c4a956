//! ARMA(p, q) models of a record by exact Gaussian maximum likelihood.
//!
//! Sign convention: `x_t − φ1 x_{t−1} − … − φp x_{t−p} = a_t − θ1 a_{t−1} − … − θq a_{t−q}`,
//! `a_t ~ N(0, σ²)`, x about its mean; "unit" is the record's. A record is a slice; NaN marks a
//! missing sample. Gardner, Harvey & Phillips 1980; Box, Jenkins & Reinsel chapter 7.
//!
//! [`log_likelihood`] evaluates, [`fit()`] searches the global optimum, [`select`] compares a grid of
//! orders, [`profile_interval`] says what the record leaves open about an ARMA(1,1), [`burg`] and
//! [`yule_walker`] fit AR(p) without a search.
//!
//! ```
//! use undrift_noise::arma::{FitOptions, fit};
//! // A slow error under white noise.
//! let (mut slow, mut seed) = (0.0, 1u64);
//! let mut uniform = || {
//!     seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
//!     (seed >> 11) as f64 / (1u64 << 53) as f64 - 0.5
//! };
//! let record: Vec<f64> = (0..2000)
//!     .map(|_| { slow = 0.99 * slow + 0.2 * uniform(); slow + uniform() })
//!     .collect();
//! let model = fit(&record, 1, 1, &FitOptions::default())?;
//! assert!(model.ar[0] > 0.95 && model.ma[0] > 0.6 && model.ma[0] < model.ar[0]);
//! # Ok::<(), undrift_noise::arma::ArmaError>(())
//! ```
//!
//! What each is for:
//!
//! | question | function |
//! |---|---|
//! | how likely is the record under coefficients of mine | [`log_likelihood`] |
//! | the best model of a given order | [`fit()`], with starts of mine [`fit_from`], of several records [`fit_several`] |
//! | which order | [`select`]; after Pandit and Wu, [`crate::pandit_wu`] |
//! | how far φ or θ may be off | [`profile_interval`] |
//! | a quick autoregression | [`burg`], [`yule_walker`], [`order_by_aicc`] |
//! | is anything left of the record | [`ArmaFit::residuals`], then [`crate::whiteness`] |
//!
//! An ARMA describes the record at its own rate; [`crate::scales`] finds the slow part of block averages and
//! takes it to the full rate, and [`crate::composite`] fits sums of continuous processes, which hold at every
//! rate.

mod autoregressive;
mod diagnosis;
mod fit;
mod gradient;
mod kalman;
mod kernel;
mod likelihood;
mod linear;
mod model;
mod optimise;
mod polynomial;
mod profile;
mod search;
mod selection;
mod starts;
mod whittle;

pub use autoregressive::{ArFit, burg, order_by_aicc, yule_walker};
pub use fit::{FitOptions, fit, fit_from, fit_several, log_likelihood};
pub(crate) use fit::{climb_to, refit};
pub use likelihood::{Likelihood, Mean};
pub use model::{ArmaFit, Warning};
pub(crate) use polynomial::inverse_roots;
pub use profile::{ProfileInterval, Root, profile_interval};
pub(crate) use search::Ladder;
pub(crate) use selection::select_with_starts;
pub use selection::{Selection, select};

/// Highest p or q that is fitted.
pub const MAX_FIT_ORDER: usize = 24;

/// Why a record has no ARMA fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ArmaError {
    /// Fewer samples than the order needs.
    #[error("too few samples: {present}, this order needs {needed}")]
    TooShort {
        /// Samples present (missing ones not counted).
        present: usize,
        /// Samples needed.
        needed: usize,
    },
    /// All samples present are equal.
    #[error("the recording is constant")]
    Constant,
    /// An infinite sample, or a mean that is not finite.
    #[error("the recording or its mean is not finite")]
    NotFinite,
    /// The method needs an unbroken record.
    #[error("samples are missing, which this method does not support")]
    Missing,
    /// An order above [`MAX_FIT_ORDER`].
    #[error("orders above 24 are not supported")]
    OrderTooHigh,
    /// An option outside its range.
    #[error("{0} is outside its range")]
    BadOption(&'static str),
    /// A unit root was asked for with p = 0.
    #[error("a unit root needs an autoregressive part")]
    NoUnitRootWithoutAr,
    /// φ has a root on or outside the unit circle (or, with a unit root, none at 1).
    #[error("the autoregressive part is not stationary")]
    NotStationary,
    /// θ has a root on or outside the unit circle.
    #[error("the moving-average part is not invertible")]
    NotInvertible,
    /// No start gave a finite likelihood.
    #[error("the likelihood is not finite at any start")]
    NoOptimum,
}
