use super::*;
use crate::wavelet::wavelet_variance;

#[test]
fn variants_move_each_correlation_time_and_nothing_else() {
    let set = TermSet {
        white: true,
        gauss_markov: 2,
        ..TermSet::default()
    };
    let centre = [0.1, 0.2, 0.3, 1.0, 2.0];
    let found = variants(&centre, set, 1000.0);
    let ten = 10f64.ln();
    let moved = |at: usize, tau: f64| {
        let mut z = centre.to_vec();
        z[at] = tau;
        z
    };
    let slow = 300f64.ln();
    let of = |at: usize| [centre[at] - ten, centre[at] + ten, slow].map(|tau| moved(at, tau));
    let exact = [vec![centre.to_vec()], of(3).to_vec(), of(4).to_vec()].concat();
    assert_eq!(found.len(), 7);
    for (z, exact) in found.iter().zip(&exact) {
        assert!(
            z.iter().zip(exact).all(|(a, b)| (a - b).abs() < 1e-12),
            "{found:?}"
        );
    }
}

const PROCESS: GaussMarkov = GaussMarkov {
    sigma: 0.3,
    tau_s: 7.0,
};

fn all_terms() -> CompositeTerms {
    CompositeTerms {
        white: 0.1,
        quantisation: 0.02,
        random_walk: 0.03,
        flicker: 0.04,
        gauss_markov: [
            PROCESS,
            GaussMarkov {
                tau_s: 90.0,
                ..PROCESS
            },
        ],
    }
}

#[test]
fn each_term_can_be_taken_away_alone() {
    let all = all_terms();
    for term in TERMS {
        let mut exact = all;
        match term {
            Term::White => exact.white = 0.0,
            Term::Quantisation => exact.quantisation = 0.0,
            Term::RandomWalk => exact.random_walk = 0.0,
            Term::Flicker => exact.flicker = 0.0,
            Term::GaussMarkov(i) => exact.gauss_markov[i].sigma = 0.0,
        }
        let found = less(&all, term);
        assert_eq!(found.set(), exact.set(), "{term:?}");
        assert_eq!(
            (found.white, found.random_walk),
            (exact.white, exact.random_walk)
        );
    }
}

#[test]
fn the_full_rate_is_compared_at_one_sample() {
    let (terms, interval) = (all_terms(), 0.5);
    let point = |m: usize| crate::wavelet::WaveletPoint {
        m,
        scale_s: m as f64 * interval,
        variance: model_variance(&terms, m, interval),
        edf: 10.0,
        coefficients: 100,
    };
    let curve = WaveletVariance {
        interval,
        samples: 1000,
        points: [1, 2, 4, 8].map(point).to_vec(),
    };
    assert!((full_rate_ratio(&curve, &terms) - 1.0).abs() < 1e-12);
    assert!((full_rate_ratio(&curve, &terms.scaled(2.0)) - 0.25).abs() < 1e-12);
    assert!((full_rate_white(&curve, &terms) - terms.white).abs() < 1e-12);
    // Whatever the white noise of the terms; nothing where they are more than is there.
    let more = CompositeTerms {
        white: 9.0,
        ..terms
    };
    assert!((full_rate_white(&curve, &more) - terms.white).abs() < 1e-12);
    assert_eq!(full_rate_white(&curve, &terms.scaled(2.0)), 0.0);
    let scales: Vec<usize> = coarser(&curve, 2).points.iter().map(|p| p.m).collect();
    assert_eq!(scales, [2, 4, 8]);
    let none = coarser(&curve, 9);
    assert!(none.points.is_empty());
    assert_eq!(
        (
            full_rate_ratio(&none, &terms),
            full_rate_white(&none, &terms)
        ),
        (1.0, 0.0)
    );
}

/// Of white noise with its level integrated out, −2 ln L is (n − 1) (ln 2πσ² + 1) + ln n at σ² = Σ(x − x̄)²/(n − 1).
#[test]
fn white_noise_has_the_likelihood_criteria_and_error_of_its_variance() {
    let interval = 0.25;
    let record: Vec<f64> = (0..600).map(|k| f64::from(k * 7919 % 101)).collect();
    let set = TermSet {
        white: true,
        ..TermSet::default()
    };
    let found = fit(&record, interval, set, &FitOptions::default()).unwrap();
    let n = record.len() as f64;
    let mean = record.iter().sum::<f64>() / n;
    let variance = record.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0);
    let twice = (n - 1.0) * ((std::f64::consts::TAU * variance).ln() + 1.0) + n.ln();
    assert!((found.log_likelihood + 0.5 * twice).abs() < 1e-4);
    assert!((found.terms.white / (variance * interval).sqrt() - 1.0).abs() < 1e-3);
    assert_eq!((found.parameters, found.points, found.block), (2, 600, 1));
    assert!((found.level - mean).abs() < 1e-9);
    assert!((found.aic - (4.0 - 2.0 * found.log_likelihood)).abs() < 1e-9);
    assert!((found.bic - (2.0 * n.ln() - 2.0 * found.log_likelihood)).abs() < 1e-9);
    let error = found.relative_errors.unwrap().white;
    assert!(
        (error * (2.0 * (n - 1.0)).sqrt() - 1.0).abs() < 0.01,
        "{error}"
    );
    // Several records have a level each.
    let two = fit_several(
        &[&record, &record[..300]],
        interval,
        set,
        &FitOptions::default(),
    );
    let two = two.unwrap();
    assert_eq!((two.parameters, two.points), (3, 900));
    // Blocks of so many samples that the points are enough, or of as many as asked for.
    let of = |max_points, block| {
        let options = FitOptions {
            filtered: false,
            max_points,
            block,
            start: None,
        };
        let found = fit(&record, interval, set, &options).unwrap();
        (found.block, found.points)
    };
    assert_eq!(of(200, None), (3, 200));
    assert_eq!(of(1, None), (6, 100));
    assert_eq!(of(200, Some(5)), (5, 120));
    assert_eq!(of(200, Some(0)), (1, 600));
}

#[test]
fn what_the_likelihood_does_not_want_is_taken_away_and_what_it_hardly_wants_is_flagged() {
    let truth = CompositeTerms {
        white: 1.0,
        gauss_markov: [
            GaussMarkov {
                sigma: 1.0,
                tau_s: 20.0,
            },
            GaussMarkov::default(),
        ],
        ..CompositeTerms::default()
    };
    let mut record = vec![0.0; 4000];
    crate::synthesis::NoiseGenerator::new(&truth.to_shaping(1.0).unwrap(), 2).fill(&mut record);
    let averages = Averages::new(&[&record], 1, 1.0).unwrap();
    let at = -averages.cost(&truth);
    let mut flags = Vec::new();
    assert_eq!(without_useless(truth, at, &averages, &mut flags), truth);
    assert_eq!(flags, []);
    // A walk too small to matter, whatever else is there.
    let with = CompositeTerms {
        random_walk: 1e-9,
        ..truth
    };
    let at = -averages.cost(&with);
    assert_eq!(without_useless(with, at, &averages, &mut flags), truth);
    assert_eq!(flags, [Flag::Vanished(Term::RandomWalk)]);
    // Likelihoods that the terms do not reach: what is lost without one is measured from these.
    flags.clear();
    let fall = averages.cost(&truth) - averages.cost(&with);
    let at = 1.0 - averages.cost(&truth) - fall;
    let kept = without_useless(with, at, &averages, &mut flags);
    assert_eq!(kept, with);
    assert_eq!(flags, [Flag::NotNeeded(Term::RandomWalk)]);
    flags.clear();
    let at = 2.0 - averages.cost(&truth);
    assert_eq!(without_useless(with, at, &averages, &mut flags), with);
    assert_eq!(flags, []);
}

#[test]
fn a_search_starts_at_the_moments_of_blocks_and_of_the_full_rate() {
    let set = TermSet {
        white: true,
        gauss_markov: 1,
        ..TermSet::default()
    };
    let record: Vec<f64> = (0..600).map(|k| f64::from(k * 7919 % 101)).collect();
    let curve = wavelet_variance(&record, 0.5).unwrap();
    let moments = fit_moments(&curve, set, false).unwrap();
    let of = |full| starts(set, &moments, full, 300.0);
    assert_eq!((of(None).len(), of(Some(moments)).len()), (4, 5));
    assert_eq!(of(None)[0], set.coordinates(&moments.terms));
    assert_eq!(of(Some(moments))[4], of(None)[0]);
}
