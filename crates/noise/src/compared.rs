//! Methods that others fit noise models with, as far as the literature describes them: candidates of
//! [`crate::identify`] that are scored beside the others and never recommended.
//!
//! | module | method | source |
//! |---|---|---|
//! | [`power_spectrum`] | slopes of the averaged power spectrum | IEEE Std 952-1997, annex C; IEEE Std 1293-1998 |
//! | [`autocorrelation`] | exponential of the autocorrelation | Brown & Hwang 1997; Nassar 2003; Quinchia et al. 2013 |
//! | [`allan_minimum`] | Gauss-Markov process of the lowest Allan deviation | Gonzalez, Giribet & Patiño 2015 |
//! | [`allan_bound`] | white noise and Gauss-Markov process above the Allan variance | Xing & Gebre-Egziabher 2008 |
//!
//! White noise and random walk of the Allan variance, the fifth, are [`crate::allan::fit_terms`].
//!
//! ```
//! use undrift_noise::{compared, composite::CompositeTerms, synthesis::NoiseGenerator};
//! let truth = CompositeTerms { white: 0.01, random_walk: 0.002, ..CompositeTerms::default() };
//! let mut record = vec![0.0; 50_000];
//! NoiseGenerator::new(&truth.to_shaping(0.01)?, 1).fill(&mut record);
//! let found = compared::power_spectrum::fit(&record, 100.0)?;
//! assert!((found.white / truth.white - 1.0).abs() < 0.1);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod allan_bound;
pub mod allan_minimum;
pub mod autocorrelation;
pub mod power_spectrum;

use crate::{
    allan::{Curve, Terms},
    composite::{CompositeError, CompositeTerms},
    screening::RecordError,
};

/// A method of the literature, to be compared with.
///
/// ```
/// use undrift_noise::{allan, compared::Method, composite::{CompositeTerms, GaussMarkov}, synthesis::NoiseGenerator};
/// let process = GaussMarkov { sigma: 0.02, tau_s: 5.0 };
/// let truth = CompositeTerms { white: 0.01, gauss_markov: [process, GaussMarkov::default()], ..CompositeTerms::default() };
/// let record: Vec<f64> = NoiseGenerator::new(&truth.to_shaping(0.01)?, 1).take(100_000).collect();
/// let curve = allan::deviations(&record, 100.0, allan::DeviationKind::Overlapping, allan::Grid::Octave)?;
/// let terms = allan::fit_terms(&curve)?;
/// for method in Method::ALL {
///     // Whatever they make of the bias, or find no model of it: the white noise is the same.
///     let white = method.fit(&record, &curve, &terms).map(|found| found.white);
///     assert!(white.is_err() || white.is_ok_and(|white| (white / 0.01).ln().abs() < 0.3), "{}", method.name());
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// [`power_spectrum`].
    PowerSpectrum,
    /// [`autocorrelation`].
    Autocorrelation,
    /// [`allan_minimum`].
    AllanMinimum,
    /// [`allan_bound`].
    AllanBound,
}

impl Method {
    /// Every method, in the order of tables.
    pub const ALL: [Self; 4] = [
        Self::PowerSpectrum,
        Self::Autocorrelation,
        Self::AllanMinimum,
        Self::AllanBound,
    ];

    /// Name of its model among the candidates.
    pub const fn candidate(self) -> &'static str {
        match self {
            Self::PowerSpectrum => "white + flicker + walk (power spectrum)",
            Self::Autocorrelation => "white + Gauss-Markov (autocorrelation)",
            Self::AllanMinimum => "white + Gauss-Markov (Allan minimum)",
            Self::AllanBound => "white + Gauss-Markov (Xing bound)",
        }
    }

    /// Its name in results.
    pub fn name(self) -> &'static str {
        match self {
            Self::PowerSpectrum => "power spectrum",
            Self::Autocorrelation => "autocorrelation",
            Self::AllanMinimum => "allan minimum",
            Self::AllanBound => "allan bound",
        }
    }

    /// Number of parameters of its model: N, B, K or N, σ, τ.
    pub const PARAMETERS: usize = 3;

    /// Fits a record without missing samples by this method, given its overlapping Allan deviation `curve` and the `terms` of that.
    ///
    /// # Errors
    /// Where the method has no model of the record, or sees white noise alone.
    pub fn fit(
        self,
        record: &[f64],
        curve: &Curve,
        terms: &Terms,
    ) -> Result<CompositeTerms, Unfit> {
        match self {
            Self::PowerSpectrum => power_spectrum::fit(record, curve.rate_hz),
            Self::Autocorrelation => autocorrelation::fit(record, curve.rate_hz),
            Self::AllanMinimum => allan_minimum::fit(curve, terms.white.value),
            Self::AllanBound => allan_bound::fit(curve),
        }
    }
}

/// Why a method of the literature has no model of a record.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Unfit {
    /// The record cannot be used.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// The averages of the record cannot be made.
    #[error(transparent)]
    Averages(#[from] CompositeError),
    /// Fewer averages, frequencies or averaging times than the method needs.
    #[error("the recording is too short for it: {got} {what}, at least {needed} are needed")]
    TooFew {
        /// What is counted, in words.
        what: &'static str,
        /// Number that there is.
        got: usize,
        /// Number that is needed.
        needed: usize,
    },
    /// The method sees no slow part.
    #[error("it sees white noise alone")]
    White,
    /// The autocorrelation does not fall to 1/e of its first value.
    #[error(
        "the autocorrelation has not fallen to 1/e after {longest_s:.0} s, a quarter of the recording"
    )]
    NotFalling {
        /// Longest lag looked at \[s\].
        longest_s: f64,
    },
    /// The Gauss-Markov process explains all of the variance.
    #[error("the exponential leaves no variance to white noise")]
    NoWhite,
    /// The Allan deviation still falls at the longest averaging time that counts.
    #[error("the Allan deviation has no minimum up to {longest_s:.0} s, a ninth of the recording")]
    NoMinimum {
        /// Longest averaging time looked at \[s\].
        longest_s: f64,
    },
}
