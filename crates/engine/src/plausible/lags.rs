//! By how much one record of the motion is later than another, by regressions at a row of lags.

use alloc::vec::Vec;
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;

/// Coefficient of determination that a lag needs to be believed.
const FITS: f64 = 0.7;
/// Standard deviations that a lag is from another one, at least, that it is not by chance.
pub(super) const SIGMAS: f64 = 4.0;

/// A lag and its standard deviation \[s\].
#[derive(Clone, Copy, Debug)]
pub(super) struct Lag {
    pub(super) lag: f64,
    pub(super) std: f64,
}

impl Lag {
    /// The difference of two lags that are found independently.
    pub(super) fn less(&self, other: &Self) -> Self {
        Self {
            lag: self.lag - other.lag,
            std: self.std.hypot(other.std),
        }
    }
}

/// The lag at which a regression leaves least, of regressions at `first`, `first + step`, … \[s\], each by its number of pairs and its coefficient
/// of determination, by a parabola through the three about the least; `None` where none explains enough, or the least is the first or the last.
///
/// A record y that is δ late of itself leaves δ² Σẏ² beside what noise does, Σ(y − ŷ)²: the curvature of what is left, c, is Σẏ² in units
/// of Σy², and δ has the variance (1 − r²) / (n c).
pub(super) fn best(
    regressions: impl Iterator<Item = (f64, f64)>,
    first: f64,
    step: f64,
) -> Option<Lag> {
    let rows = Vec::from_iter(regressions);
    let left = |k: usize| 1.0 - rows[k].1;
    let least = (0..rows.len()).min_by(|a, b| left(*a).total_cmp(&left(*b)))?;
    if least == 0 || least + 1 == rows.len() {
        return None;
    }
    let [before, here, after] = [least - 1, least, least + 1].map(left);
    let curvature = (before - 2.0 * here + after) / (2.0 * step * step);
    if here > 1.0 - FITS || curvature <= 0.0 {
        return None;
    }
    let beside = (before - after) / (4.0 * curvature * step);
    Some(Lag {
        lag: first + step * least as f64 + beside,
        std: (here / (rows[least].0 * curvature)).sqrt(),
    })
}
