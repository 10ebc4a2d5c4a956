//! Where the level of a record steps: a gyro that re-zeroes, a sensor that is tilted.

use super::windows::{STEPS, Windows};
use std::ops::Range;
use undrift_base::order_statistics::{MAD_TO_SIGMA, upper_median};

/// Windows to either side that a line is laid through, for large steps and for small ones.
const SIDES: [usize; 2] = [8, 32];
/// A step is so many robust standard deviations of what the record's own noise, slow noise included, does at that
/// length: beyond 4 is chance in a day of six axes.
const SIGMAS: f64 = 8.0;
/// More steps than this are noise or motion.
const MOST: usize = 4;

/// A step of an axis.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Step {
    /// Axis that steps.
    pub(super) axis: &'static str,
    /// Height of the step \[unit\].
    pub(super) size: f64,
    /// The windows before and after which the level is another: the first of them, and the one after the last.
    pub(super) at: Range<usize>,
}

/// The steps in a part of a record, in order; none where there are so many that they are motion or noise. `left_out`
/// are windows of the part that are not looked at.
///
/// A step is the difference of two straight lines, through the windows before and after, where they meet: a steady
/// drift has none, and a warm-up hardly any.
pub(super) fn steps(windows: &Windows, part: &Range<usize>, left_out: &[bool]) -> Vec<Step> {
    let mut found: Vec<(f64, Step)> = Vec::new();
    for (axis, levels) in &windows.axes {
        let places = part.clone().zip(left_out).filter(|(_, out)| !**out);
        let (places, means): (Vec<usize>, Vec<f64>) = places
            .map(|(place, _)| (place, levels.means[place]))
            .filter(|(_, mean)| !mean.is_nan())
            .unzip();
        for side in SIDES {
            for (at, size, sigmas) in jumps(&means, side, STEPS * levels.step) {
                let at = places[at - 1] + 1..places[at];
                found.push((sigmas, Step { axis, size, at }));
            }
        }
    }
    // Of those that are one, the clearest.
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut steps: Vec<Step> = Vec::new();
    for (_, step) in found {
        let near = |other: &Step| step.at.start.abs_diff(other.at.start) <= SIDES[1];
        if !steps.iter().any(near) {
            steps.push(step);
        }
    }
    steps.sort_by_key(|step| step.at.start);
    match steps.len() > MOST {
        true => Vec::new(),
        false => steps,
    }
}

/// Positions before which a series jumps, by how much, and by how many standard deviations; `least` is the smallest jump.
fn jumps(means: &[f64], side: usize, least: f64) -> Vec<(usize, f64, f64)> {
    if means.len() < 4 * side {
        return Vec::new();
    }
    // What a line by least squares through `side` points has half an interval beyond its last.
    let n = side as f64;
    let weight = |k: usize| {
        let (x, end) = (k as f64 - 0.5 * (n - 1.0), 0.5 * n);
        1.0 / n + end * x / (n * (n * n - 1.0) / 12.0)
    };
    let weights: Vec<f64> = (0..side).map(weight).collect();
    let jump = |at: usize| -> f64 {
        let before = means[at - side..at].iter().zip(&weights);
        let after = means[at..at + side].iter().rev().zip(&weights);
        after.map(|(x, w)| x * w).sum::<f64>() - before.map(|(x, w)| x * w).sum::<f64>()
    };
    let places = side..=means.len() - side;
    let jumps: Vec<f64> = places.map(jump).collect();
    let mut sizes: Vec<f64> = jumps.iter().map(|jump| jump.abs()).collect();
    let sigma = MAD_TO_SIGMA * upper_median(&mut sizes);
    let enough = (SIGMAS * sigma).max(least);
    let mut found: Vec<(usize, f64, f64)> = Vec::new();
    for (k, jump) in jumps.iter().enumerate() {
        if jump.abs() <= enough {
            continue;
        }
        let (at, sigmas) = (k + side, jump.abs() / sigma.max(f64::MIN_POSITIVE));
        match found.last_mut() {
            Some(last) if at - last.0 <= side => {
                if sigmas > last.2 {
                    *last = (at, *jump, sigmas);
                }
            }
            _ => found.push((at, *jump, sigmas)),
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_jump_is_the_difference_of_two_lines_where_they_meet() {
        // A drift of 0.1 a window that jumps by 3 before window 50; the noise is a small fixed pattern.
        let noise = |k: usize| 0.01 * ((k * 7919 % 101) as f64 / 50.0 - 1.0);
        let level = |k: usize| 0.1 * k as f64 + if k < 50 { 0.0 } else { 3.0 };
        let means: Vec<f64> = (0..100).map(|k| level(k) + noise(k)).collect();
        let found = jumps(&means, 8, 0.0);
        let [(at, size, _)] = found[..] else {
            panic!("{found:?}");
        };
        assert_eq!(at, 50);
        assert!((size - 3.0).abs() < 0.05, "{size}");
        // Without it nothing, and nothing of a jump that is smaller than a step of the samples.
        let drift: Vec<f64> = (0..100).map(|k| 0.1 * k as f64 + noise(k)).collect();
        assert_eq!(jumps(&drift, 8, 0.0), []);
        assert_eq!(jumps(&means, 8, 3.5), []);
        assert_eq!(jumps(&means[..31], 8, 0.0), []);
    }
}
