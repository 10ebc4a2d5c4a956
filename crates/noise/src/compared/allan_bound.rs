//! Random constant, Gauss-Markov process and white noise whose Allan variance is nowhere below the record's.
//!
//! Xing & Gebre-Egziabher, Modeling and bounding low cost inertial sensor errors, IEEE/ION PLANS 2008, pages 1122-1132: the error of a cheap
//! sensor as the sum of a random constant, a first-order Gauss-Markov process and wide-band (white) noise, with
//! parameters that bound the error rather than match it. The constant is the model's turn-on.
//!
//! What is known here of that paper is its model and its aim, not its text: how the parameters are chosen is ours. Of all sums
//! `N²/τ + σ² g(τ/τc)` (g: IEEE Std 952-1997, equation C.13) that are at or above the overlapping Allan variance at every octave of which the
//! record holds nine windows, the one whose mean ratio to it is least. For a τc that is a linear programme in N² and σ², solved at its
//! vertices; τc is searched over ten values an octave. The bound is of the measured variance, whose own scatter it so contains; it says nothing of
//! longer times.

use super::{Unfit, allan_minimum::determined};
use crate::allan::{Curve, gauss_markov::gauss_markov_variance};
use crate::composite::{CompositeTerms, GaussMarkov};

/// Correlation times tried an octave.
const AN_OCTAVE: i32 = 10;
/// Fewest averaging times that three parameters bound.
const FEWEST: usize = 4;
/// Share by which rounding may leave a bound below what it bounds.
const ROUNDING: f64 = 1e-9;

/// Averaging time \[s\] and measured Allan variance \[unit²\].
type Measured = (f64, f64);

/// White noise N [unit·√s] and Gauss-Markov process (σ \[unit\], τ \[s\]) that bound an overlapping Allan deviation.
///
/// # Errors
/// Fewer than four averaging times that the record determines; one that white noise alone bounds best.
///
/// ```
/// use undrift_noise::{allan, compared::allan_bound, composite::{CompositeTerms, GaussMarkov}, synthesis::NoiseGenerator};
/// let process = GaussMarkov { sigma: 0.01, tau_s: 10.0 };
/// let truth = CompositeTerms { white: 0.01, gauss_markov: [process, GaussMarkov::default()], ..CompositeTerms::default() };
/// let record: Vec<f64> = NoiseGenerator::new(&truth.to_shaping(0.01)?, 1).take(50_000).collect();
/// let curve = allan::deviations(&record, 100.0, allan::DeviationKind::Overlapping, allan::Grid::Octave)?;
/// let bound = allan_bound::fit(&curve)?;
/// let [slow, _] = bound.gauss_markov;
/// for point in curve.points.iter().filter(|point| 9 * point.m <= curve.samples) {
///     let process = allan::gauss_markov::gauss_markov_variance(point.tau_s, slow.sigma, slow.tau_s);
///     let model = bound.white * bound.white / point.tau_s + process;
///     assert!(model >= (1.0 - 1e-6) * point.deviation.powi(2), "the model is a bound at {} s", point.tau_s);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn fit(curve: &Curve) -> Result<CompositeTerms, Unfit> {
    let points: Vec<Measured> = determined(curve)
        .map(|p| (p.tau_s, p.deviation * p.deviation))
        .collect();
    if points.len() < FEWEST {
        return Err(Unfit::TooFew {
            what: "averaging times",
            got: points.len(),
            needed: FEWEST,
        });
    }
    let shortest = points[0].0;
    let record = curve.samples as f64 / curve.rate_hz;
    let steps = (f64::from(AN_OCTAVE) * (record / shortest).log2()) as i32;
    let times = (0..=steps).map(|i| shortest * (f64::from(i) / f64::from(AN_OCTAVE)).exp2());
    let bounds = times.map(|tau_s| (bound_at(&points, tau_s), tau_s));
    let best = bounds.min_by(|(a, _), (b, _)| a.excess.total_cmp(&b.excess));
    let Some((bound, tau_s)) = best.filter(|(bound, _)| bound.process > 0.0) else {
        return Err(Unfit::White);
    };
    let process = GaussMarkov {
        sigma: bound.process.sqrt(),
        tau_s,
    };
    Ok(CompositeTerms {
        white: bound.white.sqrt(),
        gauss_markov: [process, GaussMarkov::default()],
        ..CompositeTerms::default()
    })
}

/// Bound of measured Allan variances at one correlation time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// Square N² of its white noise density \[unit²·s\].
    pub white: f64,
    /// Variance σ² of its process \[unit²\].
    pub process: f64,
    /// Sum of its ratios to the measured variances.
    pub excess: f64,
}

/// The least bound of the points, averaging time \[s\] and variance \[unit²\], by white noise and a process of correlation time `tau_s`
/// \[s\]; infinite of none.
///
/// The optimum of a linear programme is at a vertex of the feasible set: at most two points are met exactly.
///
/// ```
/// use undrift_noise::compared::allan_bound::bound_at;
/// // Variances of white noise N = 2 alone: it bounds itself exactly, and every ratio is 1.
/// let points = [(1.0, 4.0), (2.0, 2.0), (4.0, 1.0)];
/// let bound = bound_at(&points, 1.0);
/// assert!((bound.white - 4.0).abs() < 1e-9 && bound.process.abs() < 1e-9);
/// assert!((bound.excess - 3.0).abs() < 1e-6);
/// ```
pub fn bound_at(points: &[Measured], tau_s: f64) -> Bound {
    // White noise and process of unit size over the measured variance: u N² + v σ² ≥ 1 at every point.
    let ratio = |&(tau, variance): &Measured| {
        let process = gauss_markov_variance(tau, 1.0, tau_s);
        [1.0 / (tau * variance), process / variance]
    };
    let rows: Vec<[f64; 2]> = points.iter().map(ratio).collect();
    let alone = |j: usize| rows.iter().map(|row| 1.0 / row[j]).fold(0.0, f64::max);
    let crossing = |a: &[f64; 2], b: &[f64; 2]| {
        let determinant = a[0] * b[1] - a[1] * b[0];
        [(b[1] - a[1]) / determinant, (a[0] - b[0]) / determinant]
    };
    let pairs = rows.iter().enumerate();
    let pairs = pairs.flat_map(|(i, a)| rows[i + 1..].iter().map(move |b| crossing(a, b)));
    let corners = pairs.chain([[alone(0), 0.0], [0.0, alone(1)]]);
    let value = |[white, process]: [f64; 2], row: &[f64; 2]| white * row[0] + process * row[1];
    let feasible = corners.filter(|&corner| {
        corner.iter().all(|c| *c >= 0.0 && c.is_finite())
            && rows.iter().all(|row| value(corner, row) >= 1.0 - ROUNDING)
    });
    let bounds = feasible.map(|corner| Bound {
        white: corner[0],
        process: corner[1],
        excess: rows.iter().map(|row| value(corner, row)).sum(),
    });
    let none = Bound {
        white: 0.0,
        process: 0.0,
        excess: f64::INFINITY,
    };
    bounds.fold(none, |least, bound| match bound.excess < least.excess {
        true => bound,
        false => least,
    })
}
