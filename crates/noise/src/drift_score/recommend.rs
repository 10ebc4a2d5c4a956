//! The choice by drift score: the simplest model within the sampling error of the best.

use super::HorizonScore;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Probability of a paired difference that is beyond its sampling error, three standard errors of many batches: the best is the
/// luckiest of several, at several horizons, and windows reach over the ends of their batches. Of few batches the scatter itself is
/// uncertain (Student's t).
const BEYOND: f64 = 0.001_35;
/// A score worse by less than this share is as good as the best, however precise the comparison.
const SAME: f64 = 0.01;
/// A score worse by more than this share is not as good as the best, however much a few batches scatter…
const WORSE: f64 = 0.05;
/// …unless so many sampling errors of independent windows are more.
const INDEPENDENT_ERRORS: f64 = 2.0;

/// Horizons that decide are this long \[s\] or longer.
const SHORTEST_S: f64 = 10.0;
/// Candidates whose Akaike criteria differ by less are as likely (Burnham & Anderson 2002, section 2.6).
pub(crate) const EQUAL_AIC: f64 = 2.0;
/// A criterion larger by more is that of a model without support (the same section): what the few windows of one record
/// say of the drift counts for less, as long as …
const DECISIVE_AIC: f64 = 10.0;
/// … the likelier model's drift is above the least by no more than this share.
const WITHIN: f64 = 0.1;

/// Fewest batches whose scatter means anything; with fewer the best score's own error decides.
const FEWEST: usize = 4;

/// A candidate with its scores.
///
/// All candidates of one choice are scored on the same windows; [`recommend`] leaves out one that misses a horizon.
#[derive(Clone, Debug, PartialEq)]
pub struct Scored {
    /// Name.
    pub name: String,
    /// States of its shaping filter.
    pub states: usize,
    /// Fitted parameters.
    pub parameters: usize,
    /// Akaike's criterion, on the same data for every candidate.
    pub aic: f64,
    /// Scores, the same horizons in the same order for every candidate.
    pub horizons: Vec<HorizonScore>,
}

/// The choice.
#[derive(Clone, Debug, PartialEq)]
pub struct Recommendation {
    /// Position of the candidate chosen.
    pub index: usize,
    /// Why.
    pub reason: Reason,
}

/// Why a candidate is recommended; its sentence is [`crate::model_file::reason`].
#[derive(Clone, Debug, PartialEq)]
pub struct Reason {
    /// Name of the candidate.
    pub name: String,
    /// States of its shaping filter.
    pub states: usize,
    /// Fitted parameters.
    pub parameters: usize,
    /// The horizons that were compared \[s\].
    pub horizons_s: Vec<f64>,
    /// What decided.
    pub choice: Choice,
}

/// What decides for a candidate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Choice {
    /// It drifts least at every horizon, and no simpler candidate is as likely.
    LeastDrift,
    /// It is the simplest of the likeliest candidates within the sampling error of the least drift.
    Simplest {
        /// How far its drift is above the least, at the worst horizon \[%\].
        excess_percent: f64,
    },
    /// No candidate is within the sampling error of the least drift at all horizons: this one is the nearest.
    LeastExcess {
        /// How far its drift is above the least, at the worst horizon \[%\].
        excess_percent: f64,
    },
    /// The simplest of the likeliest and others that the record does not exclude expect other drifts: it is their average.
    Average {
        /// How many.
        models: usize,
    },
}

/// Standard error of the mean of the batches; 0 of fewer than two.
pub(super) fn standard_error(batches: &[f64]) -> f64 {
    let (mut n, mut mean, mut squares) = (0.0, 0.0, 0.0);
    for &value in batches.iter().filter(|v| v.is_finite()) {
        n += 1.0;
        let step = value - mean;
        mean += step / n;
        squares += step * (value - mean);
    }
    if n < 2.0 {
        0.0
    } else {
        (squares / (n * (n - 1.0))).sqrt()
    }
}

/// Whether a score is within the sampling error of the best: the difference of their mean squares is
/// within three standard errors (by Student's t of few batches more), from the differences batch by batch (both saw the same record), and the RMS
/// within 5 %, or two sampling errors of as many independent windows; or the RMS is within 1 % anyway.
///
/// Paired, since both models saw the same record: what moves both scores is no difference between them.
fn is_as_good(score: &HorizonScore, best: &HorizonScore) -> bool {
    if score.rms <= (1.0 + SAME) * best.rms {
        return true;
    }
    let chance = INDEPENDENT_ERRORS / (2.0 * best.windows.max(1.0)).sqrt();
    if score.rms > (1.0 + chance.max(WORSE)) * best.rms {
        return false;
    }
    if score.batches.len() < FEWEST {
        return score.rms - best.rms <= best.standard_error;
    }
    let pairs = score.batches.iter().zip(&best.batches);
    let differences: Vec<f64> = pairs.map(|(a, b)| a - b).collect();
    let gap = score.rms * score.rms - best.rms * best.rms;
    gap <= errors(differences.len()) * standard_error(&differences)
}

/// Standard errors of the mean of so many batches that are beyond chance.
fn errors(batches: usize) -> f64 {
    let freedom = batches.saturating_sub(1) as f64;
    StudentsT::new(0.0, 1.0, freedom).map_or(f64::INFINITY, |t| t.inverse_cdf(1.0 - BEYOND))
}

/// The choice among models of one record. Of the candidates whose drift is within the sampling error of the least at
/// every horizon of 10 s and more (of the longest, where none is), or within 10 % where the likelihood decides for them, those whose Akaike criterion is within 2 of the least; of these the one with the fewest parameters, then states,
/// then the first. The windows of a long horizon are few: where drift does not tell two models apart, the likelihood may.
/// Where no candidate is as good as the best everywhere, the one whose worst ratio to the best is least. None of an empty list,
/// or where scores are missing or not finite in every candidate.
///
/// ```
/// use undrift_noise::drift_score::{Choice, HorizonScore, Scored, recommend};
/// let scored = |name: &str, states, parameters, aic, rms: f64| {
///     let standard_error = 0.05 * rms;
///     let score = HorizonScore { horizon_s: 60.0, rms, standard_error, predicted_rms: rms, origins: 900, windows: 30.0, batches: vec![] };
///     Scored { name: name.into(), states, parameters, aic, horizons: vec![score] }
/// };
/// // The walk drifts half a percent more than two processes, is as likely, and has three parameters less.
/// let all = [
///     scored("white", 0, 1, 900.0, 0.02),
///     scored("white + random walk", 1, 2, 101.0, 0.01005),
///     scored("white + 2 Gauss-Markov", 2, 5, 100.0, 0.01),
/// ];
/// let chosen = recommend(&all).expect("candidates");
/// assert_eq!(all[chosen.index].name, "white + random walk");
/// assert!(matches!(chosen.reason.choice, Choice::Simplest { excess_percent } if (excess_percent - 0.5).abs() < 1e-9));
/// ```
pub fn recommend(candidates: &[Scored]) -> Option<Recommendation> {
    let horizons = candidates.iter().map(|c| c.horizons.len()).max()?;
    let valid =
        |c: &&Scored| c.horizons.len() == horizons && c.horizons.iter().all(|h| h.rms.is_finite());
    let usable: Vec<(usize, &Scored)> = candidates
        .iter()
        .enumerate()
        .filter(|(_, c)| valid(c))
        .collect();
    if horizons == 0 || usable.is_empty() {
        return None;
    }
    let best: Vec<&Scored> = (0..horizons)
        .filter_map(|h| {
            let rms = |c: &Scored| c.horizons[h].rms;
            let least = usable.iter().min_by(|a, b| rms(a.1).total_cmp(&rms(b.1)));
            least.map(|(_, c)| *c)
        })
        .collect();
    let ratio =
        |c: &Scored, h: usize| c.horizons[h].rms / best[h].horizons[h].rms.max(f64::MIN_POSITIVE);
    // One second of an integral is white noise and what is faster than any bias: it decides where there is nothing longer.
    let longest = best
        .last()
        .map_or(0.0, |c| c.horizons[horizons - 1].horizon_s);
    let decides = |h: &usize| best[*h].horizons[*h].horizon_s >= SHORTEST_S.min(longest);
    let deciding: Vec<usize> = (0..horizons).filter(decides).collect();
    let worst = |c: &Scored| deciding.iter().map(|h| ratio(c, *h)).fold(0.0, f64::max);
    let good = |c: &Scored| {
        let mut deciding = deciding.iter();
        deciding.all(|&h| is_as_good(&c.horizons[h], &best[h].horizons[h]))
    };
    // The likelihood sees more of a record than the few windows of a long horizon do.
    let lower = |aic: f64, of: &(usize, &Scored)| aic.min(of.1.aic);
    let least_drift = usable.iter().filter(|(_, c)| good(c));
    let least_drift = least_drift.fold(f64::INFINITY, lower);
    let decided = |c: &Scored| c.aic < least_drift - DECISIVE_AIC && worst(c) <= 1.0 + WITHIN;
    let good = |c: &Scored| good(c) || decided(c);
    let least_aic = usable.iter().filter(|(_, c)| good(c));
    let least_aic = least_aic.fold(f64::INFINITY, lower);
    let likely = |c: &Scored| c.aic <= least_aic + EQUAL_AIC;
    let simplest = usable
        .iter()
        .filter(|(_, c)| good(c) && likely(c))
        .min_by_key(|(_, c)| (c.parameters, c.states));
    let recommended = |index: usize, chosen: &Scored, choice| Recommendation {
        index,
        reason: Reason {
            name: chosen.name.clone(),
            states: chosen.states,
            parameters: chosen.parameters,
            horizons_s: deciding
                .iter()
                .map(|&h| best[h].horizons[h].horizon_s)
                .collect(),
            choice,
        },
    };
    let excess = |c: &Scored| 100.0 * (worst(c) - 1.0);
    if let Some(&(index, chosen)) = simplest {
        let choice = if deciding.iter().all(|&h| std::ptr::eq(best[h], chosen)) {
            Choice::LeastDrift
        } else {
            let excess_percent = excess(chosen);
            Choice::Simplest { excess_percent }
        };
        return Some(recommended(index, chosen, choice));
    }
    let least = usable
        .iter()
        .min_by(|a, b| worst(a.1).total_cmp(&worst(b.1)));
    least.map(|&(index, chosen)| {
        let excess_percent = excess(chosen);
        recommended(index, chosen, Choice::LeastExcess { excess_percent })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn candidate(name: &str, states: usize, rms: &[f64], scatter: f64) -> Scored {
        let horizons = rms.iter().enumerate().map(|(h, &rms)| HorizonScore {
            horizon_s: [10.0, 60.0][h],
            rms,
            standard_error: 0.1 * rms,
            predicted_rms: rms,
            origins: 1000,
            windows: 100.0,
            batches: (0..8)
                .map(|b| rms * rms * (1.0 + scatter * f64::from(b % 2 * 2 - 1)))
                .collect(),
        });
        Scored {
            name: name.into(),
            states,
            parameters: 2 * states + 1,
            aic: f64::INFINITY,
            horizons: horizons.collect(),
        }
    }

    #[test]
    fn the_simplest_within_the_sampling_error_is_chosen() {
        let list = [
            candidate("white", 0, &[1.0, 5.0], 0.1),
            candidate("two", 2, &[0.995, 2.00], 0.1),
            candidate("one", 1, &[1.0, 2.01], 0.1),
        ];
        let choice = recommend(&list).unwrap();
        assert_eq!(choice.index, 2);
        let reason = choice.reason;
        assert_eq!(
            (&*reason.name, reason.states, reason.parameters),
            ("one", 1, 3)
        );
        assert_eq!(reason.horizons_s, [10.0, 60.0]);
        // 1.0 over 0.995 and 2.01 over 2.00: the first is the worse.
        let Choice::Simplest { excess_percent } = reason.choice else {
            panic!("{reason:?}");
        };
        assert!((excess_percent - 0.5025).abs() < 1e-3, "{excess_percent}");
        let alone = recommend(&list[2..]).unwrap().reason;
        assert_eq!(alone.choice, Choice::LeastDrift);
    }

    /// White noise behind a filter with a walk: by luck the halves of the record drift less without the walk, which the likelihood
    /// of the whole excludes.
    #[test]
    fn a_likelihood_that_decides_counts_for_more_than_a_drift_of_little_difference() {
        let of = |aic: f64, of: Scored| Scored { aic, ..of };
        let white = of(41.4, candidate("white", 0, &[1.03, 4.64], 0.0));
        let walk = |aic: f64, excess: f64| {
            let rms = [1.037, 4.64 * (1.0 + excess)];
            of(aic, candidate("white + random walk", 1, &rms, 0.0))
        };
        let chosen = |walk| recommend(&[white.clone(), walk]).unwrap().index;
        assert_eq!(chosen(walk(0.0, 0.09)), 1);
        // Without support of the likelihood, or with more drift than that, it is not.
        assert_eq!(chosen(walk(31.5, 0.09)), 0);
        assert_eq!(chosen(walk(31.3, 0.09)), 1);
        assert_eq!(chosen(walk(0.0, 0.11)), 0);
    }

    #[test]
    fn a_paired_difference_decides_where_the_scores_overlap() {
        // 3 % worse in every batch alike is worse, though each score scatters by 10 %.
        let best = candidate("best", 2, &[1.0, 2.0], 0.1);
        let alike = candidate("alike", 1, &[1.0, 2.06], 0.1);
        assert_eq!(recommend(&[alike, best.clone()]).unwrap().index, 1);
        // The same 3 % with batches that scatter the other way is nothing.
        let apart = candidate("apart", 1, &[1.0, 2.06], -0.1);
        assert_eq!(recommend(&[apart, best]).unwrap().index, 0);
    }

    /// A score at one horizon whose mean square is `square`, its batches `spread` to both sides of it in turn, and of so
    /// many independent windows.
    fn score(square: f64, spread: f64, windows: f64) -> HorizonScore {
        HorizonScore {
            horizon_s: 10.0,
            rms: square.sqrt(),
            standard_error: 0.0,
            predicted_rms: 1.0,
            origins: 1000,
            windows,
            batches: [1.0, -1.0]
                .repeat(4)
                .iter()
                .map(|side| square + side * spread)
                .collect(),
        }
    }

    /// So many windows that their own sampling error is far below 5 %.
    const MANY: f64 = 1e6;

    #[test]
    fn a_score_within_three_standard_errors_of_the_paired_difference_is_as_good() {
        let best = score(1.0, 0.0, MANY);
        // 3 % above in RMS: between what is the same anyway and what is worse anyway.
        let gap = 1.03f64.powi(2) - 1.0;
        // Eight differences `gap ± spread`: the standard error of their mean is spread/√7.
        let of_errors = |errors: f64| score(1.0 + gap, gap * 7f64.sqrt() / errors, MANY);
        // Student's t of seven degrees of freedom at 0.99865; of many batches three.
        assert!((errors(8) - 4.530).abs() < 1e-3 && (errors(1_000_001) - 3.0).abs() < 1e-3);
        assert!(is_as_good(&of_errors(4.4), &best));
        assert!(!is_as_good(&of_errors(4.7), &best));
        assert!(!is_as_good(&of_errors(8.0), &best));
    }

    #[test]
    fn a_score_within_one_percent_is_as_good_however_precise() {
        let best = score(1.0, 0.0, MANY);
        assert!(is_as_good(&score(1.009f64.powi(2), 0.0, MANY), &best));
        assert!(!is_as_good(&score(1.011f64.powi(2), 0.0, MANY), &best));
    }

    #[test]
    fn a_score_more_than_five_percent_above_is_worse_however_uncertain() {
        let best = score(1.0, 0.0, MANY);
        assert!(is_as_good(&score(1.049f64.powi(2), 10.0, MANY), &best));
        assert!(!is_as_good(&score(1.051f64.powi(2), 10.0, MANY), &best));
        // Of 50 windows the sampling error of an RMS is 1/√100: two of them are 20 %.
        let few = score(1.0, 0.0, 50.0);
        assert!(is_as_good(&score(1.19f64.powi(2), 10.0, 50.0), &few));
        assert!(!is_as_good(&score(1.21f64.powi(2), 10.0, 50.0), &few));
    }

    #[test]
    fn with_fewer_than_four_batches_the_best_score_s_own_error_decides() {
        let of_batches = |rms: f64, count: usize| {
            let mut score = score(rms * rms, 0.0, MANY);
            score.standard_error = 0.025;
            score.batches.truncate(count);
            score
        };
        let good = |rms, count| is_as_good(&of_batches(rms, count), &of_batches(1.0, count));
        assert!(good(1.02, 3) && !good(1.03, 3));
        // Four batches that differ alike leave no doubt.
        assert!(!good(1.02, 4));
    }

    #[test]
    fn of_equal_drift_the_simpler_is_chosen_unless_it_is_less_likely_by_two() {
        let simple = |aic| Scored {
            aic,
            ..candidate("simple", 1, &[1.0, 2.0], 0.1)
        };
        let large = Scored {
            aic: 100.0,
            ..candidate("large", 3, &[1.0, 2.0], 0.1)
        };
        assert_eq!(recommend(&[large.clone(), simple(101.9)]).unwrap().index, 1);
        assert_eq!(recommend(&[large, simple(102.1)]).unwrap().index, 0);
    }

    #[test]
    fn a_second_decides_only_where_there_is_nothing_longer() {
        let at = |first: f64, candidate: Scored| {
            let mut candidate = candidate;
            candidate.horizons[0].horizon_s = first;
            candidate
        };
        let list = |first| {
            [
                at(first, candidate("line", 4, &[1.0, 2.2], 0.01)),
                at(first, candidate("walk", 1, &[1.3, 2.0], 0.01)),
            ]
        };
        let choice = recommend(&list(1.0)).unwrap();
        assert_eq!(
            (choice.index, choice.reason.choice),
            (1, Choice::LeastDrift)
        );
        assert_eq!(choice.reason.horizons_s, [60.0]);
        // Ten seconds count: 30 % there are more than 10 % later.
        assert_eq!(recommend(&list(10.0)).unwrap().index, 0);
        let alone = list(1.0).map(|mut one| {
            one.horizons.truncate(1);
            one
        });
        assert_eq!(recommend(&alone).unwrap().index, 0);
    }

    #[test]
    fn no_candidate_good_everywhere() {
        let list = [
            candidate("short", 1, &[1.0, 4.0], 0.01),
            candidate("long", 1, &[1.2, 2.0], 0.01),
        ];
        let choice = recommend(&list).unwrap();
        assert_eq!(choice.index, 1);
        let Choice::LeastExcess { excess_percent } = choice.reason.choice else {
            panic!("{:?}", choice.reason);
        };
        assert!((excess_percent - 20.0).abs() < 1e-9, "{excess_percent}");
        assert_eq!(recommend(&[]), None);
        assert_eq!(recommend(&[candidate("bad", 0, &[f64::NAN], 0.1)]), None);
    }
}
