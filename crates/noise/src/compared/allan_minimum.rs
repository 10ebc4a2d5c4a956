//! White noise and Gauss-Markov process from the lowest point of the Allan deviation.
//!
//! Practice in GNSS/INS simulation and filters (Gonzalez, Giribet & Patiño, NaveGo, Control Engineering and Applied Informatics 17(2), 2015): N where the −1/2
//! slope passes 1 s, the standard deviation of the bias the lowest deviation, its correlation time the averaging time
//! there. Bias instability in the sense of IEEE Std 952-1997, annex C.1.3, is that deviation over 0.664; the practice followed here does not divide.
//! N is that of [`crate::allan::fit_terms`]. Where the lowest deviation lies depends on white noise as much as on the bias: a
//! stronger N moves the same process to a longer τ and a larger σ.

use super::Unfit;
use crate::allan::{Curve, Point};
use crate::composite::{CompositeTerms, GaussMarkov};

/// Averaging times of which a record holds fewer are not looked at: their deviations scatter by more than a quarter (IEEE Std 952-1997, annex C).
const WINDOWS: usize = 9;

/// The points of a curve whose deviation the record determines.
pub(super) fn determined(curve: &Curve) -> impl Iterator<Item = &Point> {
    let points = curve.points.iter();
    points
        .filter(|p| WINDOWS * p.m <= curve.samples && p.deviation > 0.0 && p.deviation.is_finite())
}

/// Process (σ \[unit\], τ \[s\]) of the lowest deviation, beside white noise of density `white` [unit·√s].
///
/// # Errors
/// A deviation that has no minimum between the shortest and the longest averaging time that the record determines, a ninth
/// of it.
///
/// ```
/// use undrift_noise::{allan::{Curve, DeviationKind, Point}, compared::allan_minimum};
/// let point = |m: usize, deviation| Point { m, tau_s: m as f64, deviation, terms: 100 };
/// let points = vec![point(1, 4e-5), point(4, 2e-5), point(16, 1e-5), point(64, 3e-5)];
/// let curve = Curve { kind: DeviationKind::Overlapping, rate_hz: 1.0, samples: 1000, points };
/// let found = allan_minimum::fit(&curve, 4e-5)?;
/// assert_eq!((found.white, found.gauss_markov[0].sigma, found.gauss_markov[0].tau_s), (4e-5, 1e-5, 16.0));
/// # Ok::<(), undrift_noise::compared::Unfit>(())
/// ```
pub fn fit(curve: &Curve, white: f64) -> Result<CompositeTerms, Unfit> {
    let points: Vec<&Point> = determined(curve).collect();
    let longest_s = points.last().map_or(0.0, |p| p.tau_s);
    let dips = points
        .windows(3)
        .filter(|w| w[1].deviation < w[0].deviation.min(w[2].deviation));
    let lowest = dips
        .map(|w| w[1])
        .min_by(|a, b| a.deviation.total_cmp(&b.deviation));
    let lowest = lowest.ok_or(Unfit::NoMinimum { longest_s })?;
    let process = GaussMarkov {
        sigma: lowest.deviation,
        tau_s: lowest.tau_s,
    };
    Ok(CompositeTerms {
        white,
        gauss_markov: [process, GaussMarkov::default()],
        ..CompositeTerms::default()
    })
}
