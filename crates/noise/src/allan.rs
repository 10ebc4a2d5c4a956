//! Allan variance of a static record: deviations over averaging time, their confidence, and the
//! noise terms read from them.
//!
//! Samples are rates (angular rate [rad/s], specific force [m/s²]) at a constant rate; the deviation
//! has their unit. Conventions: IEEE Std 952-1997 annex C for the noise terms, Riley, NIST SP 1065
//! (2008), section 5 for the deviations and their equivalent degrees of freedom.
//!
//! The overlapping Allan deviation at octave τ takes one pass over the record, in which each octave
//! builds on the one below. At all τ, and at any long list of them, FFTs give it in O(N log² N): a
//! second at 2 million samples. Any other takes one prefix sum and one strided pass per τ: O(N) a τ, and at
//! all τ of the other kinds O(N²).
//!
//! ```
//! use undrift_noise::allan::{self, Grid, DeviationKind};
//! let rates: Vec<f64> = (0..1000).map(|k| f64::from(k * 7919 % 101)).collect();
//! let curve = allan::deviations(&rates, 100.0, DeviationKind::Overlapping, Grid::Octave)?;
//! assert_eq!(curve.points[1].tau_s, 0.02);
//! # Ok::<(), undrift_noise::screening::RecordError>(())
//! ```
//!
//! What the deviation of each noise term looks like on double logarithmic axes, and where its coefficient is
//! read by eye (IEEE Std 952-1997, annex C.1; [`fit_terms`] does it by least squares, with errors):
//!
//! | term | deviation | slope | read |
//! |---|---|---|---|
//! | quantisation Q | `√3 Q/τ` | −1 | at τ = √3 s |
//! | white noise N | `N/√τ` | −½ | at τ = 1 s |
//! | bias instability B | `0.664 B` | 0 | the flat part, over 0.664 |
//! | random walk K | `K √(τ/3)` | +½ | at τ = 3 s |
//! | ramp R | `R τ/√2` | +1 | at τ = √2 s |
//!
//! A record longer than ten times the longest τ of interest is needed: the last octaves rest on a handful of
//! averages, which [`intervals`] shows. A gap must be bridged and a motion cut out first
//! ([`crate::screening`]), and the temperature of a record that warms up looks like a ramp
//! ([`crate::temperature`]).

pub mod confidence;
mod covariance;
pub mod deviation;
mod every_factor;
pub mod fit;
pub mod gauss_markov;
pub mod nnls;
pub mod noise_type;
mod octaves;
mod sliding_products;

pub use confidence::{Interval, intervals};
pub use deviation::{
    Curve, DeviationKind, Grid, Point, deviations, deviations_at, factors_of, pooled,
};
pub use fit::{Term, Terms, fit_terms, fit_terms_from};
pub use gauss_markov::{GaussMarkovFit, fit_gauss_markov, fit_gauss_markov_from};
pub use noise_type::noise_types;
