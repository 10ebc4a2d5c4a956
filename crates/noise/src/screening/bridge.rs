//! Records without missing samples.
//!
//! For spectra, Allan deviations, correlations and tests, which need an unbroken record; likelihoods see the
//! gaps themselves. A line across a gap of g samples is smoother than the noise was: up to 64 samples its ends
//! are the samples beside it, over more the means of 64 on either side.
//!
//! What a bridge does to a statistic: white noise of a bridged record has a higher level at long
//! times ([`inflation`], by which Allan terms are corrected), and less power at frequencies above
//! the inverse of twice a gap.

/// Missing samples replaced by the straight line between their neighbours, across a long gap between the means of those on either
/// side, that the error of one sample is not in all of it; at either end by the record's `mean`.
///
/// The samples that are there are not changed. `mean` \[unit\] fills a record's beginning and end.
pub(crate) fn bridge(cleaned: &[f64], mean: f64) -> Vec<f64> {
    let mut whole = cleaned.to_vec();
    let mut last: Option<usize> = None;
    let mut at = 0;
    while at < whole.len() {
        if whole[at].is_nan() {
            at += 1;
            continue;
        }
        if let Some(from) = last
            && at - from > 1
        {
            let (a, b) = match (at - from - 1) as f64 > LONG {
                true => (
                    mean_of(cleaned.get(..=from).unwrap_or_default().iter().rev()),
                    mean_of(cleaned.get(at..).unwrap_or_default().iter()),
                ),
                false => (whole[from], whole[at]),
            };
            for k in from + 1..at {
                whole[k] = a + (b - a) * (k - from) as f64 / (at - from) as f64;
            }
        }
        last = Some(at);
        at += 1;
    }
    for value in whole.iter_mut().filter(|v| v.is_nan()) {
        *value = mean;
    }
    whole
}

/// Samples of a gap that is long.
const LONG: f64 = 64.0;

/// Mean of the samples that are there among the next ones, as many as a long gap has.
///
/// NaN of a record without any sample.
fn mean_of<'a>(samples: impl Iterator<Item = &'a f64>) -> f64 {
    let there = samples.take(LONG as usize).filter(|x| !x.is_nan());
    let (sum, count) = there.fold((0.0, 0.0), |(sum, count), x| (sum + x, count + 1.0));
    sum / count
}

/// Factor by which straight lines over missing samples raise the level of white noise near zero frequency: a neighbour of a gap
/// of g samples counts 1 + g/2 times, so that the variance of a long sum is Σw², not the samples'. A gap that is itself long, as of
/// a bump, does not count: the level is that of sums shorter than it.
///
/// 1 of records without gaps. The white noise of an Allan deviation of a bridged record is divided by its root.
pub(crate) fn inflation(records: &[&[f64]]) -> f64 {
    let (mut squares, mut samples) = (0.0, 0.0);
    let mut add = |weight: f64, gap: f64| {
        squares += weight * weight;
        samples += 1.0 + gap;
    };
    for record in records {
        // Of the last sample seen, the weight so far.
        let (mut gap, mut last) = (0.0, None);
        for value in *record {
            if value.is_nan() {
                gap += 1.0;
                continue;
            }
            let is_long = gap > LONG;
            gap = if is_long { 0.0 } else { gap };
            let before = match last {
                Some(weight) => {
                    add(weight + 0.5 * gap, gap);
                    0.5 * gap
                }
                None => 0.0,
            };
            last = Some(1.0 + before);
            gap = 0.0;
        }
        last.into_iter().for_each(|weight| add(weight, 0.0));
    }
    if samples > 0.0 {
        squares / samples
    } else {
        1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_over_gaps_raise_the_level_of_white_noise() {
        let nan = f64::NAN;
        assert_eq!(inflation(&[&[1.0; 10]]), 1.0);
        assert_eq!(inflation(&[&[nan; 10]]), 1.0);
        // Weights 1, 2, 2, 1 of six samples; a gap at the end does not count.
        let found = inflation(&[&[1.0, 1.0, nan, nan, 1.0, 1.0, nan]]);
        assert!((found - 10.0 / 6.0).abs() < 1e-12, "{found}");
        // 64 missing samples count, 65 do not.
        let around = |gap: usize| [vec![1.0; 100], vec![nan; gap], vec![1.0; 100]].concat();
        let found = inflation(&[&around(64)]);
        assert!(
            (found - (198.0 + 2.0 * 33.0 * 33.0) / 264.0).abs() < 1e-12,
            "{found}"
        );
        assert_eq!(inflation(&[&around(65)]), 1.0);
    }

    #[test]
    fn what_is_missing_lies_on_the_line_between_its_neighbours_and_at_the_mean_outside() {
        let nan = f64::NAN;
        let found = bridge(
            &[nan, nan, 1.0, nan, nan, nan, 9.0, 8.0, nan, 6.0, nan],
            4.5,
        );
        assert_eq!(
            found,
            [4.5, 4.5, 1.0, 3.0, 5.0, 7.0, 9.0, 8.0, 7.0, 6.0, 4.5]
        );
        assert_eq!(bridge(&[nan, nan], 2.0), [2.0, 2.0]);
        assert!(bridge(&[], 2.0).is_empty());
        // 65 missing samples lie between the means of 64 on either side, 64 between their neighbours.
        let around = |gap: usize| {
            let side =
                |edge: f64| -> Vec<f64> { (0..64).map(|k| edge * f64::from(k % 2)).collect() };
            bridge(&[side(4.0), vec![nan; gap], side(8.0)].concat(), 0.0)
        };
        let long = around(65);
        assert!((long[64] - (2.0 + 2.0 / 66.0)).abs() < 1e-12 && long[63] == 4.0);
        let short = around(64);
        assert!((short[64] - (4.0 - 4.0 / 65.0)).abs() < 1e-12);
    }
}
