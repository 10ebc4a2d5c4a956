//! What rounding to coarse steps leaves of the noise.
//!
//! A slow error smaller than a step shows only through noise that carries samples over an edge: with σ above
//! half a step nearly in full, with σ below a fifth only while the mean is near an edge. A record in which
//! nearly all samples are equal may hide any noise up to [`largest_hidden`]; identification refuses it below
//! [`FEWEST_OFF`] samples off the mode or [`LEAST_SHOWN`] of the noise.

use super::record::mean_and_squares;
use statrs::distribution::{ContinuousCDF, Normal};
use std::f64::consts::PI;

/// Samples of a window, in which the mean is to stand still.
const WINDOW: usize = 2000;
/// Standard errors by which the halves of a window may differ: a drift passes for noise.
const STILL: f64 = 3.0;
/// Fewest samples on either side of an edge between two levels.
const FEWEST: usize = 5;
/// Fewest windows that show two edges.
const WINDOWS: usize = 3;
/// Samples off the most common value below which a record says nothing.
pub const FEWEST_OFF: usize = 30;
/// Share of the noise below which a record says nothing of another mean.
pub const LEAST_SHOWN: f64 = 0.2;
/// Share below which another mean may double the noise.
pub const MOSTLY_SHOWN: f64 = 0.5;

/// Standard deviation before rounding of samples on a grid of `step` \[unit\], by the shares of the levels: that of
/// a normal distribution whose quantiles two edges are (median over windows without drift). `None` where no two edges have samples
/// beyond them: the noise is then known together with the place of the mean only.
///
/// ```
/// use undrift_nav::shaping::ShapingFilter;
/// use undrift_noise::{screening::rounding::before_rounding, synthesis::NoiseGenerator};
/// // Noise of 0.5 steps: rounding adds 1/12 of a step² to the variance of the samples, a sixth in deviation.
/// let noise = NoiseGenerator::new(&ShapingFilter::white(0.05, 0.01)?, 1);
/// let rounded: Vec<f64> = noise.take(40_000).map(f64::round).collect();
/// assert!((before_rounding(&rounded, 1.0).expect("three levels") / 0.5 - 1.0).abs() < 0.05);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn before_rounding(x: &[f64], step: f64) -> Option<f64> {
    if !(step > 0.0 && step.is_finite()) {
        return None;
    }
    let windows = x
        .chunks_exact(WINDOW)
        .filter_map(|w| deviation_in_window(w, step));
    let mut found: Vec<f64> = windows.collect();
    found.sort_by(f64::total_cmp);
    (found.len() >= WINDOWS).then(|| found[found.len() / 2])
}

/// [`before_rounding`] of one window; `None` where it drifts or shows fewer than two edges.
fn deviation_in_window(x: &[f64], step: f64) -> Option<f64> {
    let origin = *x.first()?;
    let (first, second) = x.split_at(x.len() / 2);
    let ((a, u), (b, v)) = (mean_and_squares(first), mean_and_squares(second));
    let error = 2.0 * (u + v).sqrt() / x.len() as f64;
    if (a - b).abs() > STILL * error {
        return None;
    }
    let mut levels: Vec<f64> = x.iter().map(|v| ((v - origin) / step).round()).collect();
    levels.sort_by(f64::total_cmp);
    let n = levels.len();
    // Edges above a level, with the samples below them.
    let edges = (1..n).filter(|&k| levels[k] > levels[k - 1]);
    let mut edges = edges.filter(|k| (FEWEST..=n - FEWEST).contains(k));
    let first = edges.next()?;
    let last = edges.next_back()?;
    let normal = Normal::standard();
    let place = |below: usize| normal.inverse_cdf(below as f64 / n as f64);
    let apart = levels[last - 1] - levels[first - 1];
    Some(step * apart / (place(last) - place(first)))
}

/// Number of samples that differ from the most common value.
///
/// ```
/// use undrift_noise::screening::rounding::{largest_hidden, off_the_mode};
/// // Ten samples in ten thousand leave the step that the others have: the noise may have up to a seventh of a step.
/// let mut x = vec![3.0; 10_000];
/// x[..10].fill(4.0);
/// assert_eq!(off_the_mode(&x), 10);
/// let hidden = largest_hidden(1.0, 10, x.len());
/// assert!((0.1..0.25).contains(&hidden), "{hidden}");
/// ```
pub fn off_the_mode(x: &[f64]) -> usize {
    let mut sorted = x.to_vec();
    sorted.sort_by(f64::total_cmp);
    let runs = sorted.chunk_by(|a, b| a == b).map(<[f64]>::len);
    x.len() - runs.max().unwrap_or(0)
}

/// Largest standard deviation before rounding of which `off` in `samples` samples differ from the most common value,
/// at steps of `step`: with the mean amid two edges, and as many beyond one of them (95 %: three more).
pub fn largest_hidden(step: f64, off: usize, samples: usize) -> f64 {
    let share = ((off + 3) as f64 / samples as f64).min(0.5);
    let place = -Normal::standard().inverse_cdf(0.5 * share);
    0.5 * step / place
}

/// The noise that a record shows over that of a mean which wanders over the grid, both standard deviations: of `variance`
/// \[unit²\] after rounding, and of the largest that may be [hidden](largest_hidden), step² ∫ Φ(1 − Φ) σ dz/step = step σ/√π.
///
/// ```
/// use undrift_noise::screening::rounding::{LEAST_SHOWN, MOSTLY_SHOWN, share_shown};
/// // One sample in a thousand is a step off: a variance of 0.001 step², of noise that may be a sixth of a step.
/// assert!(share_shown(1.0, 10, 10_000, 0.001) < LEAST_SHOWN);
/// // Half of the samples are: the mean is near an edge, where noise shows most.
/// assert!(share_shown(1.0, 5000, 10_000, 0.25) > MOSTLY_SHOWN);
/// ```
pub fn share_shown(step: f64, off: usize, samples: usize, variance: f64) -> f64 {
    let everywhere = step * largest_hidden(step, off, samples) / PI.sqrt();
    (variance / everywhere).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn noise_before_rounding_is_found() {
        for (seed, step, tolerance) in [
            (1, 1.0, 0.02),
            (2, 3.7, 0.02),
            (3, 5.0, 0.03),
            (4, 5.5, 0.06),
        ] {
            let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(seed);
            let x: Vec<f64> = (0..72_000)
                .map(|_| {
                    let value: f64 = StandardNormal.sample(&mut rng);
                    step * ((value + 0.1) / step).round()
                })
                .collect();
            // Scatter of 0.3 to 0.8 % (eight simulated records each), and 2 % high at 5.5 steps, where the windows that
            // happen to show two edges have the most samples beyond them.
            let found = before_rounding(&x, step).unwrap();
            assert!((found - 1.0).abs() < tolerance, "{step}: {found}");
        }
        // Ten steps: an edge five deviations off.
        assert_eq!(before_rounding(&vec![0.3; 10_000], 0.1), None);
        assert_eq!(before_rounding(&[], 0.1), None);
        assert_eq!(before_rounding(&[1.0, 2.0], 0.0), None);
    }

    #[test]
    fn what_is_hidden_is_bounded() {
        // P(|z| > 4) = 6.33e-5: of 10⁵ samples 6.33 lie beyond edges four deviations off.
        let bound = largest_hidden(8.0, 6, 142_000);
        assert!((bound - 1.0).abs() < 0.01, "{bound}");
        assert_eq!(off_the_mode(&[1.0, 2.0, 1.0, 3.0, 1.0]), 2);
        assert_eq!(off_the_mode(&[]), 0);
        // With the mean amid a step of 6 σ, 0.27 % of the samples lie beyond the edges, step² 0.0027 of 6 σ²/√π; with the
        // mean on an edge half of them, and σ is not known from their number.
        let bound = 36.0 * 0.0027 / (6.0 / PI.sqrt());
        let shown = share_shown(6.0, 2700, 1_000_000, 36.0 * 0.0027);
        assert!((shown / bound.sqrt() - 1.0).abs() < 0.01, "{shown}");
    }

    /// As many samples as a window has, at the quantiles of a normal distribution: both halves alike.
    fn window(place: f64, deviation: f64) -> Vec<f64> {
        let normal = Normal::standard();
        let half = |k: usize| normal.inverse_cdf((k as f64 + 0.5) / (WINDOW / 2) as f64);
        let half = (0..WINDOW / 2).map(|k| place + deviation * half(k));
        let half: Vec<f64> = half.collect();
        [half.clone(), half].concat()
    }

    fn rounded(x: &[f64], step: f64) -> Vec<f64> {
        x.iter().map(|v| step * (v / step).round()).collect()
    }

    #[test]
    fn a_window_of_quantiles_gives_its_deviation_at_any_step_and_place() {
        for (step, place) in [
            (1.0, 0.1),
            (1.0, 7.1),
            (1.0, -40.3),
            (2.0, 0.6),
            (0.5, 0.0),
            (0.25, 3.0),
        ] {
            let found = deviation_in_window(&rounded(&window(place, 0.7), step), step).unwrap();
            // The shares below the edges are whole thousandths, of half of that beyond the last edges' five at least.
            assert!((found / 0.7 - 1.0).abs() < 0.02, "{step} {place}: {found}");
        }
    }

    #[test]
    fn an_edge_needs_five_samples_on_either_side() {
        let levels = |low: usize, high: usize| {
            let mut x = vec![1.0; WINDOW];
            for k in 0..low {
                x[k * 300 + 7] = 0.0;
            }
            for k in 0..high {
                x[k * 300 + 11] = 2.0;
            }
            deviation_in_window(&x, 1.0)
        };
        let exact = -1.0 / (2.0 * Normal::standard().inverse_cdf(5.0 / WINDOW as f64));
        assert!((levels(5, 5).unwrap() - exact).abs() < 1e-12);
        assert_eq!(levels(4, 5), None);
        assert_eq!(levels(5, 4), None);
        // One edge says nothing of the scale.
        assert_eq!(levels(0, 5), None);
    }

    #[test]
    fn a_window_whose_halves_differ_by_more_than_three_standard_errors_is_left_out() {
        let of = |errors: f64| {
            let mut x = window(0.1, 2.0);
            let error = 2.0 * 2.0 / (WINDOW as f64).sqrt();
            for v in &mut x[WINDOW / 2..] {
                *v += errors * error;
            }
            deviation_in_window(&rounded(&x, 1.0), 1.0)
        };
        // Rounding adds 1/12 to the variance of 4, and moves the means by little.
        assert!(of(2.8).is_some() && of(-2.8).is_some());
        assert!(of(3.3).is_none() && of(-3.3).is_none());
    }

    #[test]
    fn the_median_of_three_windows_at_least_is_taken() {
        let all = |deviations: &[f64]| {
            let windows: Vec<Vec<f64>> = deviations.iter().map(|s| window(0.1, *s)).collect();
            rounded(&windows.concat(), 1.0)
        };
        let each = |deviation: f64| deviation_in_window(&all(&[deviation]), 1.0).unwrap();
        assert_eq!(before_rounding(&all(&[0.6, 1.2]), 1.0), None);
        assert_eq!(
            before_rounding(&all(&[1.2, 0.6, 0.8]), 1.0),
            Some(each(0.8))
        );
        let with_constant = [all(&[1.2, 0.6, 0.8]), vec![0.0; WINDOW]].concat();
        assert_eq!(before_rounding(&with_constant, 1.0), Some(each(0.8)));
        assert_eq!(before_rounding(&all(&[0.8; 3]), f64::INFINITY), None);
    }
}
