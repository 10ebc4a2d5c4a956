use super::{
    recipe::{in_terms, terms, white},
    *,
};
use crate::{BiasModel, composite::CompositeTerms, synthesis::NoiseGenerator};
use std::sync::OnceLock;

const RATE: f64 = 10.0;

fn record() -> Vec<f64> {
    let terms = CompositeTerms {
        white: 0.02,
        random_walk: 0.002,
        ..CompositeTerms::default()
    };
    let mut record = vec![0.0; 20_000];
    NoiseGenerator::new(&terms.to_shaping(1.0 / RATE).unwrap(), 1).fill(&mut record);
    record
}

/// Each sample by itself.
const SINGLE: Blocks = Blocks {
    samples: 1,
    filtered: false,
};

#[test]
fn the_model_of_the_allan_deviation_has_its_white_noise_and_its_walk() {
    let record = record();
    let mut part = TrainingSet::new(vec![&record], RATE, SINGLE).unwrap();
    let walk = part.allan.random_walk.value;
    assert!((walk / 0.002 - 1.0).abs() < 0.3, "{walk}");
    let whole = Recipe::AllanWalk.fit(&part, None, &[]).unwrap();
    assert_eq!(whole.model.random_walk, Some(walk));
    assert_eq!(whole.model.white, Some(part.allan.white.value));
    // A level beside them.
    assert_eq!(whole.parameters, 3);
    let alone = Recipe::White.fit(&part, None, &[]).unwrap();
    assert_eq!(
        (alone.model.white, alone.model.random_walk),
        (Some(part.allan.white.value), None)
    );
    // A half may show no walk; the whole has to.
    part.allan.random_walk.value = 0.0;
    assert!(Recipe::AllanWalk.fit(&part, None, &[]).is_none());
    let half = Recipe::AllanWalk.fit(&part, Some(&whole), &[]).unwrap();
    assert_eq!(half.model.random_walk, None);
}

#[test]
fn every_recipe_has_its_name_and_parameters() {
    let set = |quantisation, gauss_markov, flicker, random_walk| TermSet {
        white: true,
        quantisation,
        gauss_markov,
        flicker,
        random_walk,
    };
    for (recipe, name, parameters, compared) in [
        (Recipe::White, "white", 1, false),
        (Recipe::AllanWalk, "white + random walk (Allan)", 2, true),
        (Recipe::UnitRoot, "ARMA(1,1), unit root", 2, false),
        (Recipe::Arma(2, 1), "ARMA(2,1)", 4, false),
        (Recipe::ArmaByTest(4, 3), "ARMA(4,3)", 8, true),
        (Recipe::Burg(3), "AR(3), Burg", 4, false),
        (
            Recipe::Compared(Method::ALL[0]),
            Method::ALL[0].candidate(),
            3,
            true,
        ),
        (
            Recipe::Terms(set(false, 0, false, true)),
            "white + random walk",
            2,
            false,
        ),
        (
            Recipe::Terms(set(false, 1, false, false)),
            "white + Gauss-Markov",
            3,
            false,
        ),
        (
            Recipe::Terms(set(true, 2, false, true)),
            "white + quantisation + two Gauss-Markov + random walk",
            7,
            false,
        ),
        (
            Recipe::Terms(set(false, 0, true, false)),
            "white + flicker",
            2,
            false,
        ),
    ] {
        assert_eq!(recipe.name(), name);
        assert_eq!(recipe.parameters(), parameters, "{name}");
        assert_eq!(recipe.is_compared(), compared, "{name}");
        // A level beside them.
        let fitted = recipe.fitted((AxisModel::default(), Origin::Burg));
        assert_eq!(fitted.parameters, parameters + 1);
    }
}

fn task<'a>(record: &'a [f64], part: &'a TrainingSet<'a>) -> Task<'a> {
    Task {
        records: vec![record],
        rate_hz: RATE,
        curve: &part.curve,
        allan: part.allan,
        turn_on: 0.5,
        quantised: false,
        n_max: 1,
        temperatures: Vec::new(),
        compared: OnceLock::new(),
    }
}

#[test]
fn what_is_tried_is_every_sum_of_terms_and_quantisation_where_it_is_coarse() {
    let record = record();
    let part = TrainingSet::new(vec![&record], RATE, SINGLE).unwrap();
    let mut task = task(&record, &part);
    let names = |task: &Task| -> Vec<String> {
        let names = recipes(task, None).into_iter().map(Recipe::name);
        names.filter(|name| !name.ends_with("Burg")).collect()
    };
    let plain = [
        "white",
        "white + random walk",
        "white + Gauss-Markov",
        "white + Gauss-Markov + random walk",
        "white + two Gauss-Markov",
        "white + two Gauss-Markov + random walk",
    ];
    let rounded = [
        "white + quantisation + random walk",
        "white + quantisation + Gauss-Markov",
    ];
    let last = [
        "white + flicker",
        "white + flicker + random walk",
        "white + random walk (Allan)",
        "ARMA(1,1)",
        "ARMA(2,1)",
        "ARMA(1,1), unit root",
    ];
    let others = Method::ALL.map(Method::candidate);
    assert_eq!(names(&task), [&plain[..], &last, &others].concat());
    task.quantised = true;
    assert_eq!(
        names(&task),
        [&plain[..], &rounded, &last, &others].concat()
    );
    // White noise has an autoregression of order 0, of which 1 is tried.
    let mut white = vec![0.0; 4000];
    NoiseGenerator::new(&ShapingFilter::white(1.0, 0.1).unwrap(), 3).fill(&mut white);
    let part = TrainingSet::new(vec![&white], RATE, SINGLE).unwrap();
    let burg: Vec<Recipe> = recipes(&super::tests::task(&white, &part), None);
    let burg: Vec<String> = burg.into_iter().map(Recipe::name).collect();
    assert!(burg.contains(&"AR(1), Burg".to_owned()), "{burg:?}");
}

#[test]
fn orders_that_tests_choose_are_compared_and_that_of_bic_is_not() {
    let record = record();
    let part = TrainingSet::new(vec![&record], RATE, SINGLE).unwrap();
    let task = task(&record, &part);
    let options = PanditWuOptions {
        n_max: 1,
        table: 1,
        fit: with_effort(0.01),
        ..PanditWuOptions::default()
    };
    let table = pandit_wu::pandit_wu(&record[..2000], &options).unwrap();
    let with = |by_bic, by_f, by_aic| {
        let table = PanditWu {
            by_bic,
            by_f,
            by_aic,
            ..table.clone()
        };
        recipes(&task, Some(&table))
    };
    let found = with((3, 2), (4, 3), (4, 3));
    let has = |recipe| found.iter().filter(|other| **other == recipe).count();
    assert_eq!(has(Recipe::Arma(3, 2)), 1);
    assert_eq!(has(Recipe::ArmaByTest(4, 3)), 1);
    // What is tried already is not tried twice.
    assert_eq!(
        with((2, 1), (1, 1), (2, 1)).len(),
        recipes(&task, None).len()
    );
}

#[test]
fn a_candidate_is_scored_on_the_halves_it_was_not_fitted_to() {
    let record = record();
    let part = TrainingSet::new(vec![&record], RATE, SINGLE).unwrap();
    let task = task(&record, &part);
    let reversed: Vec<Vec<f64>> = vec![record.iter().rev().copied().collect()];
    let folds = Fold::all(&task.records, &reversed, RATE, SINGLE);
    let whole = Recipe::White.fit(&part, None, &[]).unwrap();
    let (found, sums) = task.candidate(Recipe::White, whole, &folds).unwrap();
    let fitted = std::iter::once(&part).chain(folds.iter().map(|fold| &fold.fitted));
    let densities = Vec::from_iter(fitted.map(|part| part.allan.white.value));
    assert_eq!(Vec::from_iter(sums.iter().map(|sum| sum.white)), densities);
    assert_eq!(
        (found.name.as_str(), found.compared, found.parameters),
        ("white", false, 2)
    );
    assert_eq!(
        (found.model.turn_on, found.model.white),
        (0.5, Some(part.allan.white.value))
    );
    // The turn-on constant is a state.
    assert_eq!(
        (found.states, found.ljung_box_p, found.remarks.len()),
        (1, None, 0)
    );
    let scores: Vec<Vec<HorizonScore>> = folds
        .iter()
        .map(|fold| {
            let model = AxisModel {
                turn_on: 0.5,
                ..white(&fold.fitted.allan)
            };
            let filter = model.shaping(BiasModel::Arma, 0.1).unwrap();
            let parts = fold.scored[0].as_ref().unwrap();
            let (record, first) = (parts.record, parts.first_part);
            drift_score::score(record, first, &filter, &[1.0, 10.0, 60.0]).unwrap()
        })
        .collect();
    assert_eq!(found.score, drift_score::pooled(&scores));
}

#[test]
fn akaike_s_criterion_is_that_of_averages_beyond_the_memory() {
    let record = record();
    let part = TrainingSet::new(vec![&record], RATE, SINGLE).unwrap();
    let task = task(&record, &part);
    let aic = |recipe: Recipe| {
        let fitted = recipe.fit(&part, None, &[]).unwrap();
        (
            task.aic(&fitted, recipe),
            fitted.shaping(0.0, RATE).unwrap(),
        )
    };
    // 2.5 s are 25 samples, of which the record has fewer than a hundred times as many: shorter ones, of a hundred averages at least.
    let block = (record.len() / 100).min(25);
    let averages = Averages::new(&[&record], block, 1.0 / RATE).unwrap();
    let (found, filter) = aic(Recipe::AllanWalk);
    let exact = 4.0 - 2.0 * averages.restricted(&filter).unwrap();
    assert!((found - exact).abs() < 1e-9, "{found} {exact}");
    let (found, filter) = aic(Recipe::White);
    let exact = 2.0 - 2.0 * averages.restricted_at_best_level(&filter).unwrap();
    assert!((found - exact).abs() < 1e-9, "{found} {exact}");
    // At most 20 000 averages, and 50 000 points of a likelihood.
    let long = vec![0.5; 150_001];
    let slow = Task {
        records: vec![&long],
        rate_hz: 1.0,
        ..task
    };
    assert_eq!(slow.blocks().samples, 4);
    assert_eq!(slow.searched().len(), SEARCH_SAMPLES);
}

#[test]
fn a_term_that_vanishes_is_no_model_of_the_whole_but_may_vanish_in_a_half() {
    let mut white = vec![0.0; 4000];
    NoiseGenerator::new(&ShapingFilter::white(1.0, 0.1).unwrap(), 3).fill(&mut white);
    let part = TrainingSet::new(vec![&white], RATE, SINGLE).unwrap();
    let set = TermSet {
        white: true,
        quantisation: true,
        random_walk: true,
        ..TermSet::default()
    };
    assert!(terms(set, &part, None).is_none());
    let whole = Recipe::White.fit(&part, None, &[]).unwrap();
    assert!(terms(set, &part, Some(&whole)).is_some());
}

#[test]
fn terms_are_those_of_the_model_file_without_what_is_not_there() {
    let none = in_terms(&CompositeTerms {
        white: 0.3,
        ..CompositeTerms::default()
    });
    assert_eq!(
        (none.white, none.quantisation, none.random_walk),
        (Some(0.3), None, None)
    );
    assert!(none.instability.is_empty());
    let all = in_terms(&CompositeTerms {
        white: 0.3,
        quantisation: 0.2,
        random_walk: 0.1,
        gauss_markov: [composite::GaussMarkov {
            sigma: 2.0,
            tau_s: 3.0,
        }; 2],
        ..CompositeTerms::default()
    });
    assert_eq!((all.quantisation, all.random_walk), (Some(0.2), Some(0.1)));
    assert_eq!((all.instability.len(), all.instability[0].sigma), (2, 2.0));
    let flicker = in_terms(&CompositeTerms {
        white: 0.3,
        flicker: 0.1,
        ..CompositeTerms::default()
    });
    assert!(flicker.instability.len() == 4 && flicker.random_walk.is_some());
}

#[test]
fn halves_are_fitted_and_scored_both_ways_and_of_several_records_each_is_left_out() {
    let record = record();
    let of = |lengths: &[usize]| {
        let records: Vec<&[f64]> = lengths.iter().map(|n| &record[..*n]).collect();
        let backward = |record: &&[f64]| record.iter().rev().copied().collect();
        let reversed: Vec<Vec<f64>> = records.iter().map(backward).collect();
        let blocks = Blocks {
            samples: 3,
            filtered: true,
        };
        let folds = Fold::all(&records, &reversed, RATE, blocks);
        let lengths = |records: &[&[f64]]| records.iter().map(|r| r.len()).collect::<Vec<_>>();
        let fold = |fold: &Fold| {
            assert_eq!(fold.fitted.blocks, blocks);
            assert_eq!(
                fold.fitted.end_to_end.len(),
                lengths(&fold.fitted.records).iter().sum::<usize>()
            );
            let scored = fold.scored.iter().flatten();
            let scored = scored.map(|of| (of.record.len(), of.first_part));
            (lengths(&fold.fitted.records), scored.collect::<Vec<_>>())
        };
        folds.iter().map(fold).collect::<Vec<_>>()
    };
    // Of an odd record the first half has one sample less, forward and backward.
    assert_eq!(
        of(&[1001]),
        [
            (vec![500], vec![(1001, 500)]),
            (vec![501], vec![(1001, 501)])
        ]
    );
    assert_eq!(
        of(&[1001, 800, 600]),
        [
            (vec![800, 600], vec![(1001, 500), (1001, 501)]),
            (vec![1001, 600], vec![(800, 400), (800, 400)]),
            (vec![1001, 800], vec![(600, 300), (600, 300)]),
        ]
    );
    let six = of(&[600; 6]);
    assert!(
        six.len() == 6
            && six
                .iter()
                .all(|(fitted, scored)| fitted.len() == 5 && scored.len() == 2)
    );
    // Of more every second one.
    let seven = of(&[700, 701, 702, 703, 704, 705, 706]);
    assert_eq!(seven[0].0, [701, 703, 705]);
    assert_eq!(seven[1].0, [700, 702, 704, 706]);
    assert_eq!(
        seven[0].1.iter().map(|s| s.0).collect::<Vec<_>>(),
        [700, 700, 702, 702, 704, 704, 706, 706]
    );
}

#[test]
fn the_table_of_a_short_record_goes_on_to_twice_the_orders() {
    assert_eq!([1, 10_000].map(|samples| last_row(samples, 2)), [4, 4]);
    assert_eq!(
        [10_001, 497_000].map(|samples| last_row(samples, 2)),
        [2, 2]
    );
    assert_eq!([10_000, 10_001].map(|samples| last_row(samples, 3)), [6, 3]);
}

#[test]
fn of_blocks_behind_a_filter_the_overlap_is_estimated() {
    let record = record();
    let set = TermSet {
        white: true,
        random_walk: true,
        ..TermSet::default()
    };
    let overlap = |filtered| {
        let blocks = Blocks {
            samples: 3,
            filtered,
        };
        let part = TrainingSet::new(vec![&record], RATE, blocks).unwrap();
        let found = terms(set, &part, None).unwrap();
        assert_eq!(found.block, 3);
        found.overlap
    };
    // White noise has no overlap; its standard error, of 6667 blocks, is 0.012.
    assert_eq!(overlap(false), 0.0);
    let found = overlap(true);
    assert!(found != 0.0 && found.abs() < 0.04, "{found}");
}

/// White noise over a walk for ten minutes at 10 Hz.
fn short_walk(seed: u64) -> Vec<f64> {
    let terms = CompositeTerms {
        white: 1.0,
        random_walk: 1.0 / 30.0,
        ..CompositeTerms::default()
    };
    let filter = terms.to_shaping(1.0 / RATE).unwrap();
    NoiseGenerator::new(&filter, seed).take(6000).collect()
}

#[test]
fn what_ten_minutes_do_not_tell_apart_is_averaged() {
    let tried = |seed| {
        let record = short_walk(seed);
        let part = TrainingSet::new(vec![&record], RATE, SINGLE).unwrap();
        let tried = candidates(&task(&record, &part));
        let (at, reason) = tried.chosen.unwrap();
        (tried.candidates, at, reason)
    };
    let is_average = |name: &str| name == "average of likely models";
    let of_seeds = Vec::from_iter((1..9).map(tried));
    let (all, at, reason) = of_seeds
        .iter()
        .find(|(all, at, _)| is_average(&all[*at].name))
        .unwrap();
    let at = *at;
    assert_eq!(at, all.len() - 1, "it is the last");
    let average = &all[at];
    assert_eq!(
        (reason.name.as_str(), reason.states, reason.parameters),
        (average.name.as_str(), average.states, 7)
    );
    assert!(matches!(reason.choice, Choice::Average { models } if models > 2));
    assert!(!average.compared && average.model.turn_on == 0.5);
    // Its variance at two minutes is among those of the sums, and so is its drift on the halves.
    let mut found = CompositeTerms {
        white: average.model.white.unwrap(),
        random_walk: average.model.random_walk.unwrap_or(0.0),
        ..CompositeTerms::default()
    };
    for (term, process) in found
        .gauss_markov
        .iter_mut()
        .zip(&average.model.instability)
    {
        *term = *process;
    }
    let sums = || all.iter().filter(|one| one.composite().is_some());
    let is_among = |value: f64, of: &dyn Fn(&Candidate) -> f64| {
        let least = sums().map(of).fold(f64::INFINITY, f64::min);
        least < value && value < sums().map(of).fold(0.0, f64::max)
    };
    let at_two_minutes = |terms: &CompositeTerms| crate::wavelet::model_variance(terms, 1200, 0.1);
    let of_sum = |one: &Candidate| at_two_minutes(&one.composite().unwrap().terms);
    assert!(is_among(at_two_minutes(&found), &of_sum));
    let drift = |one: &Candidate| one.score[2].predicted_rms;
    assert!(is_among(drift(average), &drift));
    // A walk that is plain is one.
    let (all, at, reason) = &of_seeds[1];
    assert_eq!(all[*at].name, "white + random walk");
    assert_eq!(reason.choice, Choice::LeastDrift);
}
