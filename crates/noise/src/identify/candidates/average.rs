//! The average of the sums of terms that a record does not tell apart.
//!
//! Ten minutes do not tell flicker noise from a random walk, but of five minutes without fixes these expect drifts that are
//! two or three times apart: whichever is chosen, a filter is now and then far too sure. So where the likely sums do not expect what
//! the recommended one does, the model has the mean of their spectra, each with its Akaike weight exp(−Δ/2) (Burnham &
//! Anderson 2002, section 2.9; Hoeting et al. 1999), as white noise, two Gauss-Markov processes and a random walk.
//!
//! Spectra add, and so do wavelet variances: the terms are fitted to the mean of these.

use crate::composite::{CompositeTerms, GaussMarkov, TermSet};
use crate::wavelet::{WaveletPoint, WaveletVariance, fit_moments, model_variance};
use std::ops::RangeInclusive;

/// A sum whose Akaike criterion is larger than the least by more has no weight to speak of, 2 %.
const UNLIKELY: f64 = 8.0;
/// Deviations apart by less are the same: of a record of 20 minutes a random walk is known to a quarter…
const SAME: f64 = 1.15;
/// …at these scales \[s\], those of the horizons that decide.
const SCALES_S: RangeInclusive<f64> = 10.0..=320.0;
/// Degrees of freedom of each scale in the fit, which has no errors of its own.
const EDF: f64 = 1e3;
/// Share of the variance at every scale below which a term is dropped.
const TRACE: f64 = 1e-3;

/// What the average is made of.
pub(super) const SET: TermSet = TermSet {
    white: true,
    quantisation: false,
    random_walk: true,
    flicker: false,
    gauss_markov: 2,
};

/// Akaike weights of candidates with these criteria; 0 of those without support.
pub(super) fn weights(criteria: &[f64]) -> Vec<f64> {
    let least = criteria.iter().copied().fold(f64::INFINITY, f64::min);
    let likely = |aic: &f64| match aic - least <= UNLIKELY {
        true => (-0.5 * (aic - least)).exp(),
        false => 0.0,
    };
    let weights = Vec::from_iter(criteria.iter().map(likely));
    let sum: f64 = weights.iter().sum();
    weights.iter().map(|weight| weight / sum).collect()
}

/// The mean wavelet variance of sums by weight, at the octaves of a record of so many samples.
pub(super) fn mean(
    sums: &[(f64, CompositeTerms)],
    interval: f64,
    samples: usize,
) -> WaveletVariance {
    let octaves = std::iter::successors(Some(1usize), |m| m.checked_mul(2));
    let point = |m: usize| {
        let of = |(weight, terms): &(f64, CompositeTerms)| match *weight > 0.0 {
            true => weight * model_variance(terms, m, interval),
            false => 0.0,
        };
        WaveletPoint {
            m,
            scale_s: m as f64 * interval,
            variance: sums.iter().map(of).sum(),
            edf: EDF,
            coefficients: samples / m,
        }
    };
    WaveletVariance {
        interval,
        samples,
        points: octaves
            .take_while(|m| 2 * m <= samples)
            .map(point)
            .collect(),
    }
}

/// Whether a sum expects another deviation than this at some scale that decides.
pub(super) fn differs(curve: &WaveletVariance, terms: &CompositeTerms) -> bool {
    let mut deciding = curve.points.iter();
    deciding.any(|point| {
        let ratio = point.variance / model_variance(terms, point.m, curve.interval);
        SCALES_S.contains(&point.scale_s) && ratio.ln().abs() > 2.0 * SAME.ln()
    })
}

/// The terms whose variance this is; `None` where they cannot be fitted.
pub(super) fn terms(curve: &WaveletVariance) -> Option<CompositeTerms> {
    let mut terms = fit_moments(curve, SET, false).ok()?.terms;
    let variance = |of: &CompositeTerms, m| model_variance(of, m, curve.interval);
    for term in 0..3 {
        let mut less = terms;
        match term {
            0 => less.random_walk = 0.0,
            i => less.gauss_markov[i - 1] = GaussMarkov::default(),
        }
        let mut points = curve.points.iter();
        if points.all(|p| variance(&less, p.m) >= (1.0 - TRACE) * variance(&terms, p.m)) {
            terms = less;
        }
    }
    Some(terms)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn walk(white: f64, random_walk: f64) -> CompositeTerms {
        CompositeTerms {
            white,
            random_walk,
            ..CompositeTerms::default()
        }
    }

    #[test]
    fn weights_fall_with_the_criterion_and_end_at_eight() {
        let found = weights(&[12.0, 10.0, 18.1, f64::INFINITY]);
        let second = 1.0 / (1.0 + (-1.0f64).exp());
        assert!((found[1] - second).abs() < 1e-12 && (found[0] - (1.0 - second)).abs() < 1e-12);
        assert_eq!(found[2..], [0.0, 0.0]);
        assert!(weights(&[0.0, 7.9])[1] > 0.0);
    }

    #[test]
    fn the_average_has_the_mean_of_the_variances_at_every_scale() {
        let flicker = CompositeTerms {
            white: 1.0,
            flicker: 0.2,
            ..CompositeTerms::default()
        };
        let sums = [(0.25, walk(1.0, 0.04)), (0.75, flicker)];
        let curve = mean(&sums, 0.01, 60_000);
        // Scales of 1 to 2¹⁴ samples: twice the next would be more than the record.
        assert_eq!((curve.points.len(), curve.points[14].m), (15, 1 << 14));
        let found = terms(&curve).unwrap();
        for point in &curve.points {
            let exact = 0.25 * model_variance(&sums[0].1, point.m, 0.01)
                + 0.75 * model_variance(&flicker, point.m, 0.01);
            assert!((point.variance / exact - 1.0).abs() < 1e-12);
            let ratio = model_variance(&found, point.m, 0.01) / exact;
            assert!((ratio - 1.0).abs() < 0.02, "{}: {ratio}", point.m);
        }
        assert!(differs(&curve, &sums[0].1) && differs(&curve, &flicker));
    }

    #[test]
    fn terms_that_add_nothing_are_left_out() {
        let curve = mean(
            &[(1.0, walk(1.0, 0.04)), (0.0, walk(9.0, 9.0))],
            0.01,
            60_000,
        );
        let found = terms(&curve).unwrap();
        assert_eq!(found.set().gauss_markov, 0, "{found:?}");
        assert!((found.random_walk / 0.04 - 1.0).abs() < 1e-2);
        assert!((found.white - 1.0).abs() < 1e-3);
    }

    #[test]
    fn deviations_within_a_seventh_are_the_same_and_scales_below_ten_seconds_do_not_count() {
        let curve = mean(&[(1.0, walk(0.0, 0.04))], 0.01, 60_000);
        assert!(!differs(&curve, &walk(0.0, 0.04 * 1.14)));
        assert!(
            differs(&curve, &walk(0.0, 0.04 * 1.16)) && differs(&curve, &walk(0.0, 0.04 / 1.16))
        );
        // White noise of 0.02 s is far below a walk at 10 s.
        assert!(!differs(&curve, &walk(0.02, 0.04)));
        let short = mean(&[(1.0, walk(0.0, 0.04))], 0.01, 2000);
        assert!(
            !differs(&short, &walk(0.0, 1.0)),
            "no scale decides in 20 s"
        );
    }
}
