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
