//! What must hold for any numbers: likelihoods, Allan deviations, correlations, predictors.

use crate::common::generators::{partials, polynomial, record, reversed, seeded, stable};
use crate::common::with_best_scale;
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;
use undrift_nav::shaping::ShapingFilter;
use undrift_noise::allan::{DeviationKind, Grid, deviations, deviations_at};
use undrift_noise::arma::{Mean, burg, log_likelihood, yule_walker};
use undrift_noise::composite::{self, CompositeTerms, GaussMarkov, Level, block_average};
use undrift_noise::correlation::partial::durbin_levinson;
use undrift_noise::correlation::{Partial, autocovariance, partial_autocorrelation};

const KINDS: [DeviationKind; 4] = [
    DeviationKind::Overlapping,
    DeviationKind::Modified,
    DeviationKind::Hadamard,
    DeviationKind::Total,
];

/// Log-likelihood of an ARMA about a known mean of zero.
fn arma(x: &[f64], phi: &[f64], theta: &[f64]) -> f64 {
    log_likelihood(x, phi, theta, Mean::Known(0.0), false)
        .unwrap()
        .log_likelihood
}

fn lags(filter: &ShapingFilter, count: usize) -> Vec<f64> {
    let mut out = vec![0.0; count];
    filter.autocovariance(&mut out);
    out
}

/// A log-likelihood keeps some 1e-12 of its terms, times the gain of the slowest pole and zero.
fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-8 * a.abs().max(1.0)
}

proptest! {
    #![proptest_config(seeded())]

    #[test]
    fn the_likelihood_knows_no_sign_no_unit_and_no_direction_of_time(
        x in record(20..150), phi in stable(4), theta in stable(4), unit in -6.0..6.0f64,
    ) {
        let value = arma(&x, &phi, &theta);
        let scale = 10f64.powf(unit);
        let scaled: Vec<f64> = x.iter().map(|v| v * scale).collect();
        let flipped: Vec<f64> = x.iter().map(|v| -v).collect();
        prop_assert!(close(value, arma(&scaled, &phi, &theta) + x.len() as f64 * scale.ln()));
        prop_assert_eq!(value, arma(&flipped, &phi, &theta));
        let back = arma(&reversed(&x), &phi, &theta);
        prop_assert!(close(value, back), "{value} {back}");
    }

    #[test]
    fn an_estimated_mean_moves_with_the_record_and_knows_no_direction(
        x in record(20..150), phi in stable(3), theta in stable(3), level in -100.0..100.0f64,
    ) {
        let of = |x: &[f64]| log_likelihood(x, &phi, &theta, Mean::Estimated, false).unwrap();
        let (here, back) = (of(&x), of(&reversed(&x)));
        let lifted = of(&x.iter().map(|v| v + level).collect::<Vec<f64>>());
        for other in [back, lifted] {
            prop_assert!(close(here.log_likelihood, other.log_likelihood), "{here:?} {other:?}");
            prop_assert!((here.mean_standard_error / other.mean_standard_error - 1.0).abs() < 1e-6);
        }
        // In units of its own standard error.
        let allowed = 1e-6 * here.mean_standard_error;
        prop_assert!((here.mean - back.mean).abs() < allowed, "{here:?} {back:?}");
        prop_assert!((here.mean + level - lifted.mean).abs() < allowed + 1e-9, "{here:?} {lifted:?}");
        prop_assert!(here.log_likelihood >= arma(&x, &phi, &theta) - 1e-8);
    }

    #[test]
    fn gaps_and_a_unit_root_leave_time_without_direction(
        x in record(20..100), phi in stable(3), theta in stable(3),
        gaps in prop::collection::vec(any::<prop::sample::Index>(), 0..10),
    ) {
        let mut holed = x.clone();
        for gap in gaps {
            holed[gap.index(x.len())] = f64::NAN;
        }
        let (there, back) = (arma(&holed, &phi, &theta), arma(&reversed(&holed), &phi, &theta));
        prop_assert!(close(there, back), "{there} {back}");
        // (1 − B) φ(B): the level is free, and the record may be read from its end.
        let walking = with_unit_root(&phi);
        let of = |x: &[f64]| {
            log_likelihood(x, &walking, &theta, Mean::Estimated, true).unwrap().log_likelihood
        };
        // A second root near 1 can hardly be distinguished from the level: P grows with the square of 1 − Σφ.
        let apart = (1.0 - phi.iter().sum::<f64>()).min(1.0);
        let (there, back) = (of(&holed), of(&reversed(&holed)));
        prop_assert!((there - back).abs() < 1e-8 * there.abs().max(1.0) / apart.powi(2), "{there} {back}");
    }

    #[test]
    fn the_filter_of_the_composite_models_gives_an_arma_its_own_likelihood(
        x in record(20..100), phi in stable(4), theta in stable(4), sigma in 0.1..3.0f64,
    ) {
        let filter = ShapingFilter::arma(&phi, &theta, sigma, 0.01).unwrap();
        let found = composite::log_likelihood(&x, &filter, Level::Known(0.0)).unwrap();
        let exact = arma(&x, &phi, &theta);
        let scaled = with_best_scale(&found);
        prop_assert!(close(scaled, exact), "{scaled} {exact}");
        let back = composite::log_likelihood(&reversed(&x), &filter, Level::Known(0.0)).unwrap();
        prop_assert!(close(found.log_likelihood, back.log_likelihood));
    }

    #[test]
    fn partial_autocorrelations_of_an_autoregression_are_those_that_made_it(kappa in partials(6)) {
        let filter = ShapingFilter::ar(&polynomial(&kappa), 0.3, 0.01).unwrap();
        let found = durbin_levinson(&lags(&filter, 10));
        // The condition of Durbin's recursion, Cybenko 1980.
        let lost: f64 = kappa.iter().map(|k| (1.0 + k.abs()) / (1.0 - k.abs())).product();
        for k in 1..10 {
            let exact = kappa.get(k - 1).copied().unwrap_or(0.0);
            prop_assert!((found[k] - exact).abs() < 1e-14 * lost, "lag {k}: {} {exact}", found[k]);
        }
    }

    #[test]
    fn yule_walker_solves_its_equations(x in record(30..200), p in 1usize..10) {
        let fit = yule_walker(&x, p).unwrap();
        let gamma = autocovariance(&x, p).unwrap();
        let toeplitz = DMatrix::from_fn(p, p, |i, j| gamma[i.abs_diff(j)]);
        let right = DVector::from_fn(p, |i, _| gamma[i + 1]);
        let dense = toeplitz.lu().solve(&right).unwrap();
        let variance = gamma[0] - dense.dot(&right);
        // Numbers drawn at random are nearly white: the matrix is well conditioned.
        for (a, b) in fit.ar.iter().zip(&dense) {
            prop_assert!((a - b).abs() < 1e-11, "{a} {b}");
        }
        prop_assert!((fit.variance / variance - 1.0).abs() < 1e-11);
        let partial = partial_autocorrelation(&x, p, Partial::YuleWalker).unwrap();
        for (a, b) in fit.partial_autocorrelations.iter().zip(&partial[1..]) {
            prop_assert!((a - b).abs() < 1e-12 && a.abs() < 1.0);
        }
        let burg = burg(&x, p).unwrap();
        prop_assert!(burg.partial_autocorrelations.iter().all(|k| k.abs() <= 1.0));
        prop_assert!(log_likelihood(&x, &burg.ar, &[], Mean::Estimated, false).is_ok());
    }

    #[test]
    fn autocovariances_are_sums_of_products_in_either_direction(x in record(100..400), level in -1e3..1e3f64) {
        // From 48 lags on by FFT.
        for count in [5, 60, 99] {
            let found = autocovariance(&x, count).unwrap();
            let mean = x.iter().sum::<f64>() / x.len() as f64;
            let lifted: Vec<f64> = x.iter().map(|v| v + level).collect();
            let (back, above) = (autocovariance(&reversed(&x), count).unwrap(), autocovariance(&lifted, count).unwrap());
            for lag in 0..=count {
                let exact = (lag..x.len()).map(|t| (x[t] - mean) * (x[t - lag] - mean)).sum::<f64>() / x.len() as f64;
                prop_assert!((found[lag] - exact).abs() < 1e-14, "{lag}: {} {exact}", found[lag]);
                prop_assert!((found[lag] - back[lag]).abs() < 1e-14);
                // The level's own rounding, 1e-13, enters each product once.
                prop_assert!((found[lag] - above[lag]).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn block_averages_have_the_averages_of_the_autocovariance(
        phi in stable(3), theta in stable(3), m in 1usize..12,
    ) {
        let filter = ShapingFilter::arma(&phi, &theta, 0.3, 0.01).unwrap();
        let found = lags(&block_average(&filter, m).unwrap(), 5);
        let gamma = lags(&filter, 6 * m);
        for k in 0..5 {
            let mut sum = 0.0;
            for i in 0..m {
                for j in 0..m {
                    sum += gamma[(k * m + i).abs_diff(j)];
                }
            }
            let exact = sum / (m * m) as f64;
            prop_assert!((found[k] - exact).abs() < 1e-12 * gamma[0], "{k}: {} {exact}", found[k]);
        }
    }

    #[test]
    fn scaled_terms_have_the_scaled_autocovariance(
        white in 0.0..1.0f64, quantisation in 0.0..0.1f64, sigma in 0.0..1.0f64, tau in -2.0..3.0f64,
        factor in 0.01..100.0f64,
    ) {
        let mut terms = CompositeTerms { white, quantisation, ..CompositeTerms::default() };
        terms.gauss_markov[0] = GaussMarkov { sigma, tau_s: 10f64.powf(tau) };
        let (one, many) = (terms.to_shaping(0.01).unwrap(), terms.scaled(factor).to_shaping(0.01).unwrap());
        let (one, many) = (lags(&one, 8), lags(&many, 8));
        // Lag 1 of the quantisation alone is −Q²/T².
        let exact = -(quantisation / 0.01).powi(2) + sigma * sigma * (-0.01 / 10f64.powf(tau)).exp();
        prop_assert!((one[1] - exact).abs() < 1e-12 * one[0].max(1e-12));
        for (a, b) in one.iter().zip(many) {
            prop_assert!((a * factor * factor - b).abs() <= 1e-13 * one[0] * factor * factor);
        }
    }

    #[test]
    fn allan_deviations_see_no_constant_no_sign_and_no_direction_of_time(
        x in record(3..300), level in -1e3..1e3f64, unit in -6.0..6.0f64,
    ) {
        let scale = 10f64.powf(unit);
        for kind in KINDS {
            let of = |x: &[f64]| -> Vec<f64> {
                let curve = deviations(x, 100.0, kind, Grid::All).unwrap();
                curve.points.iter().map(|p| p.deviation).collect()
            };
            let here = of(&x);
            let with = |change: &dyn Fn(f64) -> f64| of(&x.iter().map(|v| change(*v)).collect::<Vec<f64>>());
            let (back, lifted) = (of(&reversed(&x)), with(&|v| v + level));
            let (scaled, flipped) = (with(&|v| v * scale), with(&|v| -v));
            for i in 0..here.len() {
                // Rounding of prefix sums of up to some 1e2, and of the level's own 1e-13.
                prop_assert!((here[i] - back[i]).abs() < 1e-13, "{kind:?} {i}: {} {}", here[i], back[i]);
                prop_assert!((here[i] - lifted[i]).abs() < 1e-12, "{kind:?} {i}: {} {}", here[i], lifted[i]);
                prop_assert!((here[i] - scaled[i] / scale).abs() < 1e-13);
                prop_assert!((here[i] - flipped[i]).abs() < 1e-13);
            }
        }
    }

    #[test]
    fn a_ramp_adds_to_the_allan_and_not_to_the_hadamard_deviation(x in record(6..200), slope in -1.0..1.0f64) {
        let ramped: Vec<f64> = x.iter().enumerate().map(|(k, v)| v + slope * k as f64).collect();
        let of = |x: &[f64], kind| deviations(x, 1.0, kind, Grid::Octave).unwrap().points;
        for (a, b) in of(&x, DeviationKind::Hadamard).iter().zip(of(&ramped, DeviationKind::Hadamard)) {
            // Sums of a ramp of up to 200 over 200 samples.
            prop_assert!((a.deviation - b.deviation).abs() < 1e-10, "{a:?} {b:?}");
        }
        let pure: Vec<f64> = (0..x.len()).map(|k| slope * k as f64).collect();
        for point in of(&pure, DeviationKind::Overlapping) {
            let exact = slope.abs() * point.tau_s / 2f64.sqrt();
            prop_assert!((point.deviation - exact).abs() < 1e-10, "{point:?} {exact}");
        }
    }

    #[test]
    fn overlapping_deviations_are_differences_of_means_on_every_grid(x in record(2..200)) {
        let octaves = deviations(&x, 50.0, DeviationKind::Overlapping, Grid::Octave).unwrap();
        for point in &octaves.points {
            let m = point.m;
            let mean = |from: usize| x[from..from + m].iter().sum::<f64>() / m as f64;
            let squares: Vec<f64> =
                (0..=x.len() - 2 * m).map(|t| (mean(t + m) - mean(t)).powi(2)).collect();
            prop_assert_eq!(squares.len(), point.terms);
            let exact = (squares.iter().sum::<f64>() / (2.0 * squares.len() as f64)).sqrt();
            prop_assert!((point.deviation - exact).abs() < 1e-13, "{point:?} {exact}");
            // 3 and 5 are no octaves: the other way through the record.
            let other = deviations_at(&x, 50.0, DeviationKind::Overlapping, &[m, 3, 5]).unwrap();
            prop_assert!((other.points[0].deviation - point.deviation).abs() < 1e-13);
        }
    }
}

/// `(1 − B) φ(B)`.
fn with_unit_root(phi: &[f64]) -> Vec<f64> {
    let mut walking = vec![1.0];
    walking.extend(phi.iter().map(|c| -c));
    walking.iter_mut().zip(phi).for_each(|(w, c)| *w += c);
    walking
}
