//! Composite models: sums of independent terms, white noise, quantisation, random walk, flicker noise and up to
//! two Gauss-Markov processes, and their exact likelihood.
//!
//! The parameters are those of the continuous terms (IEEE Std 952-1997 annex C: Q, N, K; Groves 2013
//! section 14.2.6 for σ and τ), so one set of terms serves every sample rate;
//! [`CompositeTerms::to_shaping`] gives the shaping filter of a rate. [`log_likelihood`] is that of
//! any shaping filter, NaN a missing sample; [`fit()`] maximises it from starts given by
//! [`crate::wavelet`] moments; [`block_average`] is the exact model of block averages.
//! "unit" is the record's, [rad/s] or [m/s²].
//!
//! ```
//! use undrift_noise::composite::{self, CompositeTerms, FitOptions, GaussMarkov, TermSet};
//! use undrift_noise::synthesis::NoiseGenerator;
//! let truth = CompositeTerms {
//!     white: 0.01,
//!     gauss_markov: [GaussMarkov { sigma: 0.05, tau_s: 2.0 }, GaussMarkov::default()],
//!     ..CompositeTerms::default()
//! };
//! let mut record = vec![0.0; 20_000];
//! NoiseGenerator::new(&truth.to_shaping(0.01)?, 1).fill(&mut record);
//! let terms = TermSet { white: true, gauss_markov: 1, ..TermSet::default() };
//! let found = composite::fit(&record, 0.01, terms, &FitOptions::default())?;
//! assert!((found.terms.white / truth.white).ln().abs() < 0.05);
//! # Ok::<(), composite::CompositeError>(())
//! ```

mod averages;
mod blocks;
mod fit;
mod interval;
mod likelihood;
pub(crate) mod predictor;
pub(crate) mod search;

pub(crate) use averages::{Averages, Marginal, NO_MARGINAL, curve};
pub(crate) use blocks::{Blocks, Span, blocks_beyond_memory};
pub use blocks::{average_in_blocks, block_average};
pub(crate) use fit::fit_marginal;
pub use fit::{CompositeFit, FitOptions, Flag, Term, fit, fit_several};
pub(crate) use interval::intervals_marginal;
pub use interval::{Parameter, ParameterInterval, intervals, intervals_of_several};
pub use likelihood::{Level, RecordLikelihood, log_likelihood};

pub use crate::terms::{
    CompositeError, CompositeTerms, FLICKER_TAUS, GaussMarkov, MAX_GAUSS_MARKOV, TermSet, flicker,
};
