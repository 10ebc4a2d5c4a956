use super::*;
use crate::composite::predictor::Predictor;
use crate::composite::{CompositeTerms, GaussMarkov};
use crate::synthesis::NoiseGenerator;
use undrift_nav::shaping::ShapingFilter;

/// Squares, cross, ones and determinant by the Kalman filter, one sample after the other.
fn plainly<const N: usize>(record: &[f64], centre: f64, filter: &ShapingFilter) -> [f64; 4] {
    let mut filter = Predictor::<N>::new(filter);
    let mut ones = [0.0; N];
    let mut sums = [0.0; 4];
    for &y in record {
        if y.is_nan() {
            filter.skip();
            ones = filter.advance(&ones);
            continue;
        }
        let (variance, gain) = (filter.variance, filter.gain);
        filter.settled = false;
        let v = filter.observe(y - centre);
        let o = 1.0 - dot(&filter.h, &ones);
        ones = filter.advance(&ones);
        for i in 0..N {
            ones[i] += gain[i] * o;
        }
        for (sum, term) in sums.iter_mut().zip([v * v, v * o, o * o]) {
            *sum += term / variance;
        }
        sums[3] += variance.ln();
    }
    sums
}

fn process(sigma: f64, tau_s: f64) -> GaussMarkov {
    GaussMarkov { sigma, tau_s }
}

#[test]
fn the_steady_state_gives_the_filters_sums() {
    let models = [
        (0.002, 0.0, [process(0.01, 0.3), process(0.006, 40.0)]),
        (0.01, 1e-4, [process(0.0, 1.0), process(0.05, 300.0)]),
        // Hardly any slow part; hardly any white noise.
        (0.01, 0.0, [process(1e-7, 20.0), process(1e-5, 1e5)]),
        (1e-4, 0.0, [process(0.5, 0.05), process(0.1, 10.0)]),
    ];
    for (white, random_walk, gauss_markov) in models {
        let terms = CompositeTerms {
            white,
            random_walk,
            gauss_markov,
            ..CompositeTerms::default()
        };
        let filter = terms.to_shaping(0.01).unwrap();
        let mut record = vec![0.0; 6000];
        NoiseGenerator::new(&filter, 7).fill(&mut record);
        // Gaps at both ends, on the seam of two pieces, one after the other, and a long one.
        for missing in [
            0..0,
            0..3,
            63..64,
            64..65,
            700..703,
            704..705,
            2000..2600,
            5999..6000,
        ] {
            record[missing].fill(f64::NAN);
            let found = {
                let (model, v) = steady_state::<2>(&filter).unwrap();
                let p0 = std::array::from_fn(|i| std::array::from_fn(|j| filter.p0[i][j] / v));
                let found = sums(&record, 0.003, &model, &p0).unwrap();
                let determinant = found.log_determinant + found.present as f64 * v.ln();
                [
                    found.squares / v,
                    found.cross / v,
                    found.ones / v,
                    determinant,
                ]
            };
            let expected = plainly::<2>(&record, 0.003, &filter);
            // 6000 terms of 1e-16 each, and the state's zeros as far as it is off: 1e4 of variance at most.
            let scales = [
                expected[0],
                (expected[0] * expected[2]).sqrt(),
                expected[2],
                6000.0,
            ];
            for i in 0..4 {
                let miss = (found[i] - expected[i]).abs() / scales[i];
                assert!(miss < 1e-10, "{terms:?} {i}: {found:?} {expected:?}");
            }
        }
    }
}

#[test]
fn what_has_no_noise_of_a_sample_has_no_steady_state_here() {
    let filter = ShapingFilter::gauss_markov(0.1, 3.0, 0.01).unwrap();
    assert!(steady_state::<1>(&filter).is_none());
}

fn models() -> Vec<ShapingFilter> {
    let slow = |white, gauss_markov| CompositeTerms {
        white,
        gauss_markov,
        ..CompositeTerms::default()
    };
    let mut filters: Vec<ShapingFilter> = [
        slow(0.002, [process(0.01, 0.3), process(0.006, 40.0)]),
        slow(0.01, [process(1e-7, 20.0), process(1e-5, 1e5)]),
        slow(0.01, [process(1e-9, 1e4), process(1e-3, 1e3)]),
        slow(1e-4, [process(0.5, 0.05), process(0.1, 10.0)]),
    ]
    .iter()
    .map(|terms| terms.to_shaping(0.01).unwrap())
    .collect();
    // Correlated with the sample's own noise.
    filters.push(ShapingFilter::arma(&[1.2, -0.5], &[0.4, -0.3], 0.1, 0.01).unwrap());
    filters
}

/// The same noise in a unit `1/factor` as large.
fn in_unit(filter: &ShapingFilter, factor: f64) -> ShapingFilter {
    let square = factor * factor;
    let mut filter = *filter;
    filter.r *= square;
    filter.s.iter_mut().for_each(|s| *s *= square);
    for rows in [&mut filter.q, &mut filter.p0] {
        rows.iter_mut().flatten().for_each(|v| *v *= square);
    }
    filter
}

#[test]
fn the_steady_state_is_where_the_filter_stays() {
    for filter in models() {
        let (model, v) = steady_state::<2>(&filter).unwrap();
        let ph = apply(&model.p, &model.h);
        assert!((dot(&model.h, &ph) + filter.r / v - 1.0).abs() < 1e-14);
        // P = F P Fᵀ + Q − K Kᵀ and K = F P h + s, in units of V.
        let fp = product(&model.f, &product(&model.p, &transposed(&model.f)));
        for i in 0..2 {
            let gain = dot(&model.f[i], &ph) + filter.s[i] / v;
            assert!((model.gain[i] - gain).abs() < 1e-14);
            for j in 0..2 {
                let next = fp[i][j] + model.q[i][j] - model.gain[i] * model.gain[j];
                let size = (model.p[i][i] * model.p[j][j]).sqrt();
                // EXACT, or what is not seen.
                assert!((next - model.p[i][j]).abs() <= 1e-11 * size + 1e-15);
                assert!(
                    (model.q[i][j] * v / filter.q[i][j] - 1.0).abs() < 1e-14
                        || filter.q[i][j] == 0.0
                );
            }
        }
    }
}

fn assert_free_of_the_unit<const N: usize>(filter: &ShapingFilter) {
    let (model, v) = steady_state::<N>(filter).unwrap();
    // Powers of two: no rounding at all.
    for factor in [2f64.powi(60), 2f64.powi(-60)] {
        let (scaled, variance) = steady_state::<N>(&in_unit(filter, factor)).unwrap();
        assert_eq!(variance, v * factor * factor);
        assert_eq!(scaled.gain, model.gain);
        assert_eq!((scaled.p, scaled.q), (model.p, model.q));
    }
}

#[test]
fn the_steady_state_does_not_depend_on_the_unit() {
    for filter in models() {
        assert_free_of_the_unit::<2>(&filter);
    }
    // Far below a process the rounding's share of P is known to some nine digits only, which are enough.
    let terms = CompositeTerms {
        white: 1e-6,
        quantisation: 1e-8,
        gauss_markov: [process(1e-10, 0.1), process(1.0, 0.101)],
        ..CompositeTerms::default()
    };
    let filter = terms.to_shaping(0.01).unwrap();
    assert_free_of_the_unit::<3>(&filter);
    // Nor on that of the states.
    let (model, v) = steady_state::<3>(&filter).unwrap();
    let factor = 2f64.powi(30);
    let mut scaled = filter;
    scaled.h.iter_mut().for_each(|h| *h /= factor);
    scaled.s.iter_mut().for_each(|s| *s *= factor);
    for rows in [&mut scaled.q, &mut scaled.p0] {
        rows.iter_mut()
            .flatten()
            .for_each(|v| *v *= factor * factor);
    }
    let (scaled, variance) = steady_state::<3>(&scaled).unwrap();
    assert_eq!(
        (variance, scaled.gain),
        (v, model.gain.map(|gain| gain * factor))
    );
}

#[test]
fn doubled_steps_are_the_filters_own() {
    for filter in models() {
        let mut before = [[0.0; 2]; 2];
        for (i, row) in before.iter_mut().enumerate() {
            row.copy_from_slice(&filter.p0[i][..2]);
        }
        for k in [0, 1, 5] {
            let found = Steps::<2>::doubled(&filter, k)
                .unwrap()
                .after(&before)
                .unwrap();
            let mut plain = Predictor::<2>::new(&filter);
            for _ in 0..1 << k {
                plain.settled = false;
                plain.observe(0.0);
            }
            for i in 0..2 {
                for j in 0..2 {
                    let exact = plain.p[i][j];
                    // Of an invertible model nothing is left but rounding.
                    let size = (plain.p[i][i] * plain.p[j][j]).sqrt();
                    assert!(
                        (found[i][j] - exact).abs() <= 1e-10 * size + 1e-15 * filter.r,
                        "{k}: {found:?} {:?}",
                        plain.p
                    );
                }
            }
        }
    }
}
