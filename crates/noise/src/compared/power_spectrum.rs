//! White noise, flicker noise and random walk from the slopes of the power spectrum.
//!
//! Two-sided, `S(f) = N² + B²/(2πf) + (K/2π)²/f²`: the terms of slope 0, −1 and −2 of a log-log plot (IEEE Std 952-1997, annex C.1;
//! IEEE Std 1293-1998 has the same of accelerometers). The spectrum is Welch's, Hann windows half overlapped, averaged over frequency as
//! is usual for such plots, here in octaves; the terms are those whose logarithm is nearest the spectrum's in least squares, every octave
//! weighing the same and no term negative.
//!
//! The standards leave segments, averaging and fit to the reader: those are our choice. Frequencies above a tenth of the
//! sample rate are left out, where quantisation and the sensor's filter shape the spectrum; so are a ramp (slope −3), which no filter has a
//! state for, and the two lowest frequencies, which hold what the window and the mean leave of slower noise: of a walk it still
//! raises the lowest octave by a third and K by a fifth. Nothing slower than an eighth
//! of the record shows, and the lowest octave rests on a dozen values: how the power is split between B and K depends on the scatter.

use super::Unfit;
use crate::allan::nnls;
use crate::composite::CompositeTerms;
use crate::screening::RecordError;
use crate::spectrum::{self, Density};
use nalgebra::{DMatrix, DVector};
use std::f64::consts::TAU;

/// First frequency used, in steps of the spectrum.
const FIRST: usize = 2;
/// Highest frequency used, in sample rates.
const HIGHEST: f64 = 0.1;
/// Fewest octaves that three terms are fitted to.
const FEWEST: usize = 4;
/// Rounds of Gauss-Newton; a change of 1e-12 is reached after ten or so.
const ROUNDS: usize = 50;

/// An octave of the spectrum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Octave {
    /// Mean two-sided density [unit²/Hz].
    pub density: f64,
    /// Mean of 1/f over its frequencies \[s\].
    pub inverse: f64,
    /// Mean of 1/f² over its frequencies \[s²\].
    pub inverse_square: f64,
}

/// White noise N [unit·√s], flicker noise B \[unit\] and random walk K [unit/√s] of a record at `rate_hz` \[Hz\]; a term that
/// the fit leaves out is 0.
///
/// # Errors
/// A record that [`spectrum::welch()`] does not take, or too short for four octaves; one of white noise alone, or of
/// none.
pub fn fit(record: &[f64], rate_hz: f64) -> Result<CompositeTerms, Unfit> {
    let density = spectrum::welch(record, rate_hz, segment(record.len()))?;
    fit_octaves(&octaves(&density, HIGHEST * rate_hz))
}

/// Samples of a segment: the power of two between an eighth and a quarter of the record.
/// At least 4. Half overlapped, 7 to 15 of them fit into the record, which is what the mean of a frequency rests on.
pub fn segment(samples: usize) -> usize {
    let quarter = (samples / 4).max(4);
    1 << quarter.ilog2()
}

/// The octaves of a one-sided spectrum up to a frequency \[Hz\]; an incomplete last one is left out.
///
/// ```
/// use undrift_noise::{compared::power_spectrum::octaves, spectrum::Density};
/// let frequency_hz: Vec<f64> = (0..=64).map(f64::from).collect();
/// let flat = Density { density: vec![2.0; frequency_hz.len()], frequency_hz, segments: 8 };
/// // From the second frequency: 2-3 Hz and 4-7 Hz; 8-15 Hz goes beyond 10 Hz. Two-sided, a density of 2 is 1.
/// let found = octaves(&flat, 10.0);
/// assert_eq!(found.iter().map(|octave| octave.density).collect::<Vec<_>>(), [1.0, 1.0]);
/// assert!((found[0].inverse - 0.5 * (1.0 / 2.0 + 1.0 / 3.0)).abs() < 1e-15);
/// ```
pub fn octaves(density: &Density, highest_hz: f64) -> Vec<Octave> {
    let mut found = Vec::new();
    let mut first = FIRST;
    while let Some(&last) = density.frequency_hz.get(2 * first - 1) {
        if last > highest_hz {
            break;
        }
        let mean =
            |of: &dyn Fn(usize) -> f64| (first..2 * first).map(of).sum::<f64>() / first as f64;
        found.push(Octave {
            density: mean(&|k| 0.5 * density.density[k]),
            inverse: mean(&|k| 1.0 / density.frequency_hz[k]),
            inverse_square: mean(&|k| density.frequency_hz[k].powi(-2)),
        });
        first *= 2;
    }
    found
}

/// The terms whose spectrum is nearest that of the octaves in logarithms.
///
/// # Errors
/// Fewer than four octaves, white noise alone or none.
///
/// ```
/// use undrift_noise::compared::power_spectrum::{Octave, fit_octaves};
/// // Octaves made of N = 2, B = 3 and K = 5 give these back: S = N² + B²/(2πf) + (K/2π)²/f².
/// let tau = std::f64::consts::TAU;
/// let octave = |k: i32| {
///     let (inverse, inverse_square) = (2f64.powi(-k), 4f64.powi(-k));
///     Octave { density: 4.0 + 9.0 * inverse / tau + 25.0 * inverse_square / (tau * tau), inverse, inverse_square }
/// };
/// let octaves: Vec<Octave> = (-4..4).map(octave).collect();
/// let found = fit_octaves(&octaves)?;
/// assert!((found.white - 2.0).abs() < 1e-6 && (found.flicker - 3.0).abs() < 1e-6 && (found.random_walk - 5.0).abs() < 1e-6);
/// # Ok::<(), undrift_noise::compared::Unfit>(())
/// ```
pub fn fit_octaves(octaves: &[Octave]) -> Result<CompositeTerms, Unfit> {
    if octaves.len() < FEWEST {
        return Err(Unfit::TooFew {
            what: "octaves of the spectrum",
            got: octaves.len(),
            needed: FEWEST,
        });
    }
    if octaves.iter().any(|octave| octave.density <= 0.0) {
        return Err(RecordError::Constant.into());
    }
    let shapes = DMatrix::from_fn(octaves.len(), 3, |i, j| match j {
        0 => 1.0,
        1 => octaves[i].inverse / TAU,
        _ => octaves[i].inverse_square / (TAU * TAU),
    });
    let measured = DVector::from_iterator(octaves.len(), octaves.iter().map(|o| o.density));
    // ln m(c + δ) = ln m(c) + S δ/m: with S c = m, rows S/m and right-hand side ln(P/m) + 1.
    let mut model = measured.clone();
    let mut squares = DVector::zeros(3);
    for _ in 0..ROUNDS {
        let rows = DMatrix::from_fn(octaves.len(), 3, |i, j| shapes[(i, j)] / model[i]);
        let wanted = measured.zip_map(&model, |p, m| (p / m).ln() + 1.0);
        let next = nnls::solve(&rows, &wanted);
        let fitted = &shapes * &next;
        if !fitted.iter().all(|value| *value > 0.0) {
            break;
        }
        let change = fitted.zip_map(&model, |a, b| (a / b - 1.0).abs()).max();
        (model, squares) = (fitted, next);
        if change < 1e-12 {
            break;
        }
    }
    let [white, flicker, random_walk] = [0, 1, 2].map(|j: usize| squares[j].sqrt());
    if white == 0.0 {
        return Err(Unfit::NoWhite);
    }
    if flicker == 0.0 && random_walk == 0.0 {
        return Err(Unfit::White);
    }
    Ok(CompositeTerms {
        white,
        flicker,
        random_walk,
        ..CompositeTerms::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn density_of(bins: usize, step: f64, two_sided: impl Fn(f64) -> f64) -> Density {
        let frequency_hz: Vec<f64> = (0..bins).map(|k| step * k as f64).collect();
        Density {
            density: frequency_hz.iter().map(|f| 2.0 * two_sided(*f)).collect(),
            frequency_hz,
            segments: 1,
        }
    }

    #[test]
    fn octaves_are_means_over_twice_as_many_frequencies_each() {
        let spectrum = density_of(8, 0.5, |f| 3.0 + f);
        let found = octaves(&spectrum, 100.0);
        assert_eq!(found.len(), 2);
        // 1 and 1.5 Hz, then 2 to 3.5 Hz.
        assert!((found[0].density - 4.25).abs() < 1e-12);
        assert!((found[0].inverse - 0.5 * (1.0 + 1.0 / 1.5)).abs() < 1e-12);
        assert!((found[0].inverse_square - 0.5 * (1.0 + 1.0 / 2.25)).abs() < 1e-12);
        assert!((found[1].density - 5.75).abs() < 1e-12);
        // One frequency less, and the second is incomplete; the highest counts.
        assert_eq!(octaves(&density_of(7, 0.5, |_| 1.0), 100.0).len(), 1);
        assert_eq!(octaves(&spectrum, 3.5).len(), 2);
        assert_eq!(octaves(&spectrum, 3.4).len(), 1);
        for (samples, length) in [(100, 16), (128, 32), (127, 16), (3, 4)] {
            assert_eq!(segment(samples), length);
        }
    }

    #[test]
    fn terms_are_those_of_the_slopes() {
        let of = |white: f64, flicker: f64, walk: f64| {
            let exact = move |f: f64| {
                white * white + flicker * flicker / (TAU * f) + (walk / (TAU * f)).powi(2)
            };
            fit_octaves(&octaves(&density_of(1024, 0.01, exact), 10.0))
        };
        for exact in [(0.2, 0.05, 0.03), (0.2, 0.05, 0.0), (0.2, 0.0, 0.03)] {
            let found = of(exact.0, exact.1, exact.2).unwrap();
            let near = |a: f64, b: f64| (a - b).abs() < 1e-5;
            assert!(near(found.white, exact.0), "{found:?}");
            assert!(
                near(found.flicker, exact.1) && near(found.random_walk, exact.2),
                "{found:?}"
            );
        }
        assert_eq!(of(0.0, 0.0, 0.03), Err(Unfit::NoWhite));
        let few = octaves(&density_of(16, 0.01, |_| 1.0), 10.0);
        assert!(matches!(
            fit_octaves(&few),
            Err(Unfit::TooFew {
                got: 3,
                needed: 4,
                ..
            })
        ));
        let mut four = octaves(&density_of(32, 0.01, |f| 1.0 + 0.01 / f), 10.0);
        assert!(fit_octaves(&four).is_ok());
        four[1].density = 0.0;
        assert_eq!(fit_octaves(&four), Err(RecordError::Constant.into()));
    }
}
