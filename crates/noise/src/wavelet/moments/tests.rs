use super::*;
use crate::synthesis::NoiseGenerator;
use crate::wavelet::wavelet_variance;

#[test]
fn a_drift_is_found_and_an_empty_set_refused() {
    let truth = CompositeTerms {
        white: 0.01,
        ..CompositeTerms::default()
    };
    let mut record = vec![0.0; 50_000];
    NoiseGenerator::new(&truth.to_shaping(0.01).unwrap(), 3).fill(&mut record);
    for (k, value) in record.iter_mut().enumerate() {
        *value -= 1e-4 * 0.01 * k as f64;
    }
    let curve = wavelet_variance(&record, 0.01).unwrap();
    let found = fit_moments(&curve, truth.set(), true).unwrap();
    // At 164 and 82 s, with white noise of 6e-7 and 3e-7 unit² beside 2e-5 and 4e-6 of drift.
    assert!((found.drift / 1e-4 - 1.0).abs() < 0.1, "{found:?}");
    assert!((found.terms.white / 0.01 - 1.0).abs() < 0.02, "{found:?}");
    assert_eq!(
        fit_moments(&curve, TermSet::default(), true),
        Err(CompositeError::BadTerms)
    );
    let crowded = TermSet {
        gauss_markov: 2,
        random_walk: true,
        quantisation: true,
        white: true,
        flicker: false,
    };
    let short = wavelet_variance(&record[..40], 0.01).unwrap();
    assert!(fit_moments(&short, crowded, false).is_err());
}

const INTERVAL: f64 = 0.1;

/// The wavelet variance of the terms themselves.
fn exact(terms: &CompositeTerms, drift: f64) -> WaveletVariance {
    let model = ModelCurve::new(terms, INTERVAL);
    let point = |j: u32| {
        let (m, scale_s) = (1 << j, f64::from(1 << j) * INTERVAL);
        WaveletPoint {
            m,
            scale_s,
            variance: model.at(m) + drift_variance(drift, scale_s),
            edf: 2000.0 / f64::from(1 << j),
            coefficients: 1000,
        }
    };
    WaveletVariance {
        interval: INTERVAL,
        samples: 4096,
        points: (0..10).map(point).collect(),
    }
}

fn process(sigma: f64, tau_s: f64) -> GaussMarkov {
    GaussMarkov { sigma, tau_s }
}

#[test]
fn an_exact_curve_gives_its_terms_back() {
    let terms = CompositeTerms {
        white: 0.02,
        quantisation: 0.003,
        random_walk: 0.005,
        ..CompositeTerms::default()
    };
    let slow = CompositeTerms {
        white: 0.02,
        gauss_markov: [process(0.03, 4.0), process(0.0, 0.0)],
        ..CompositeTerms::default()
    };
    let flat = CompositeTerms {
        white: 0.02,
        flicker: 0.01,
        ..CompositeTerms::default()
    };
    for (terms, drift) in [(terms, 0.0), (terms, 1e-3), (slow, 0.0), (flat, 0.0)] {
        let curve = exact(&terms, drift);
        let found = fit_moments(&curve, terms.set(), drift > 0.0).unwrap();
        let near = |found: f64, exact: f64| (found - exact).abs() <= 1e-3 * exact;
        assert!(near(found.terms.white, terms.white), "{found:?}");
        assert!(
            near(found.terms.quantisation, terms.quantisation),
            "{found:?}"
        );
        assert!(
            near(found.terms.random_walk, terms.random_walk),
            "{found:?}"
        );
        assert!(near(found.terms.flicker, terms.flicker), "{found:?}");
        let (a, b) = (found.terms.gauss_markov[0], terms.gauss_markov[0]);
        assert!(
            near(a.sigma, b.sigma) && near(a.tau_s, b.tau_s),
            "{found:?}"
        );
        assert!(near(found.drift, drift), "{found:?}");
        assert!(found.deviance < 1e-5 && found.converged, "{found:?}");
        let parameters = terms.set().parameters() + usize::from(drift > 0.0);
        assert_eq!(found.degrees_of_freedom, 10 - parameters);
    }
}

#[test]
fn a_deviance_is_that_of_chi_squared_variances() {
    let terms = CompositeTerms {
        white: 0.02,
        flicker: 0.01,
        ..CompositeTerms::default()
    };
    let unit = CompositeTerms {
        flicker: 1.0,
        ..CompositeTerms::default()
    };
    let unit = ModelCurve::new(&unit, INTERVAL);
    let mut points = exact(&terms, 1e-3).points;
    let flicker: Vec<f64> = points.iter().map(|p| unit.at(p.m)).collect();
    let at = |points: &[WaveletPoint]| deviance(points, &terms, &flicker, 1e-3, INTERVAL);
    assert!(at(&points).abs() < 1e-9);
    points[2].variance *= 1.5;
    points[7].variance *= 0.4;
    let part = |edf: f64, ratio: f64| edf * (ratio - 1.0 - ratio.ln());
    let sum = part(points[2].edf, 1.5) + part(points[7].edf, 0.4);
    assert!((at(&points) / sum - 1.0).abs() < 1e-9);
    let nothing = CompositeTerms::default();
    assert_eq!(
        deviance(&points, &nothing, &flicker, 0.0, INTERVAL),
        f64::INFINITY
    );
}

#[test]
fn the_error_of_one_amplitude_is_the_weighted_sum_of_the_scales_covariances() {
    let terms = CompositeTerms {
        white: 0.02,
        ..CompositeTerms::default()
    };
    let curve = exact(&terms, 0.0);
    let error = fit_moments(&curve, terms.set(), false).unwrap();
    let error = error.relative_errors.unwrap().white;
    // ν² ∝ N²: twice the relative error of N is that of Σ edf ν̂²/ν² over Σ edf.
    let covariance = scatter::covariance(&curve.points, &terms, INTERVAL, curve.samples);
    let (mut sum, mut edf) = (0.0, 0.0);
    for (i, p) in curve.points.iter().enumerate() {
        for (j, q) in curve.points.iter().enumerate() {
            sum += p.edf * q.edf * covariance[(i, j)] / (p.variance * q.variance);
        }
        edf += p.edf;
    }
    let expected = sum.sqrt() / edf / 2.0;
    assert!((error / expected - 1.0).abs() < 1e-3, "{error} {expected}");
}

#[test]
fn starts_are_least_squares_at_each_choice_of_correlation_times() {
    let terms = CompositeTerms {
        white: 0.02,
        random_walk: 0.005,
        ..CompositeTerms::default()
    };
    let points = exact(&terms, 1e-3).points;
    let starts = grid(&points, terms.set(), true, INTERVAL);
    assert_eq!(starts.len(), 1);
    for (z, exact) in starts[0].iter().zip([0.02, 0.005, 1e-3f64]) {
        assert!((z - exact.ln()).abs() < 1e-6, "{starts:?}");
    }
    // A term that least squares leave out is a thousandth of the curve where it is largest: the first scale.
    let more = TermSet {
        quantisation: true,
        ..terms.set()
    };
    let start = &grid(&exact(&terms, 0.0).points, more, false, INTERVAL)[0];
    let left_out = 0.5 * (TRACE * ModelCurve::new(&terms, INTERVAL).at(1) / quantisation(1.0)).ln();
    assert!((start[1] - left_out).abs() < 1e-6, "{start:?} {left_out}");
    // From half a sample to 20 times the longest scale: 0.05 s · 3^k below 1024 s.
    let slow = |gauss_markov| TermSet {
        gauss_markov,
        ..terms.set()
    };
    let one = grid(&points, slow(1), false, INTERVAL);
    assert_eq!(one.len(), 10);
    for (k, start) in one.iter().enumerate() {
        assert!((start[3].exp() / (0.05 * 3f64.powi(k as i32)) - 1.0).abs() < 1e-9);
    }
    let two = grid(&points, slow(2), false, INTERVAL);
    assert_eq!(two.len(), 45);
    assert!(
        two.iter()
            .all(|start| start.len() == 6 && start[4] < start[5])
    );
    // With the drive of a process of a grid's correlation time, σ √(2/τ).
    let tau_s = 0.05 * 81.0;
    let alone = CompositeTerms {
        white: 0.02,
        gauss_markov: [process(0.03, tau_s), process(0.0, 0.0)],
        ..CompositeTerms::default()
    };
    let start = &grid(&exact(&alone, 0.0).points, alone.set(), false, INTERVAL)[4];
    assert!((start[0] - 0.02f64.ln()).abs() < 1e-6, "{start:?}");
    assert!(
        (start[1] - (0.03 * (2.0 / tau_s).sqrt()).ln()).abs() < 1e-6,
        "{start:?}"
    );
}

fn quantisation(q: f64) -> f64 {
    super::super::quantisation_variance(q, INTERVAL)
}

#[test]
fn scales_without_a_variance_or_its_certainty_are_left_out() {
    let good = exact(
        &CompositeTerms {
            white: 1.0,
            ..CompositeTerms::default()
        },
        0.0,
    )
    .points[0];
    assert!(usable(&good));
    for bad in [
        WaveletPoint {
            variance: 0.0,
            ..good
        },
        WaveletPoint { edf: 0.0, ..good },
        WaveletPoint {
            edf: f64::INFINITY,
            ..good
        },
        WaveletPoint {
            edf: f64::NAN,
            ..good
        },
    ] {
        assert!(!usable(&bad), "{bad:?}");
    }
    let terms = CompositeTerms {
        white: 0.02,
        ..CompositeTerms::default()
    };
    let mut curve = exact(&terms, 0.0);
    curve.points[3].variance = 0.0;
    assert_eq!(
        fit_moments(&curve, terms.set(), false)
            .unwrap()
            .degrees_of_freedom,
        8
    );
    // As many scales as parameters are enough.
    curve.points.truncate(1);
    assert!(fit_moments(&curve, terms.set(), false).is_ok());
    let error = fit_moments(&curve, terms.set(), true).unwrap_err();
    assert_eq!(
        error,
        CompositeError::TooShort {
            present: 4096,
            needed: 16
        }
    );
}
