//! A sensor driven against its stops.
//!
//! At a stop of the range the distribution ends in a heap: all that would have been beyond reads the last
//! value. Noise that is cut so has too small a variance and a mean that moves with it.

use serde::{Deserialize, Serialize};

/// Fewest samples at a stop.
const FEWEST: usize = 10;
/// A stop holds so many times the samples of the level next to it.
const PILED_UP: usize = 3;
/// Fewest different values: with fewer nothing can be said.
const LEVELS: usize = 4;

/// An end of the range at which samples pile up.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Saturation {
    /// Value of the end, the largest or smallest of the record \[unit\].
    pub value: f64,
    /// Number of samples that have it.
    pub samples: usize,
}

/// The ends of the range where samples pile up: ten or more, three times as many as at the value
/// next to it. Noise that is only quantised has fewer and fewer samples towards its ends. O(N); NaN is
/// skipped.
///
/// ```
/// use undrift_noise::screening::saturation;
/// // A sine of amplitude 1.2 in a sensor whose range ends at 1.
/// let clipped: Vec<f64> = (0..1000).map(|k| (1.2 * (0.1 * f64::from(k)).sin()).clamp(-1.0, 1.0)).collect();
/// assert_eq!(saturation(&clipped).iter().map(|end| end.value).collect::<Vec<_>>(), [1.0, -1.0]);
/// ```
pub fn saturation(x: &[f64]) -> Vec<Saturation> {
    [1.0, -1.0]
        .into_iter()
        .filter_map(|sign| at_top(x, sign))
        .collect()
}

/// The top of `sign · x`.
fn at_top(x: &[f64], sign: f64) -> Option<Saturation> {
    // The highest values, falling, and how many samples have each.
    let mut top = [(f64::NEG_INFINITY, 0usize); LEVELS];
    for value in x.iter().map(|v| sign * v).filter(|v| !v.is_nan()) {
        if value < top[LEVELS - 1].0 {
            continue;
        }
        if let Some(level) = top.iter_mut().find(|level| level.0 == value) {
            level.1 += 1;
            continue;
        }
        let place = top.iter().take_while(|level| level.0 > value).count();
        top[place..].rotate_right(1);
        top[place] = (value, 1);
    }
    let [(value, samples), (_, next), ..] = top;
    let enough = top[LEVELS - 1].1 > 0;
    (enough && samples >= FEWEST && samples >= PILED_UP * next).then_some(Saturation {
        value: sign * value,
        samples,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clipping_is_distinguished_from_quantisation() {
        // Sums of uniform numbers: bell-shaped, with a step of 1.
        let mut seed = 1u64;
        let mut uniform = || {
            seed = seed
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (seed >> 33) as f64 / (1u64 << 31) as f64
        };
        let bell: Vec<f64> = (0..20_000)
            .map(|_| ((0..12).map(|_| uniform()).sum::<f64>() * 5.0).round())
            .collect();
        assert_eq!(saturation(&bell), []);
        let clipped: Vec<f64> = bell.iter().map(|v| v.min(35.0)).collect();
        let found = saturation(&clipped);
        assert!(found.len() == 1 && found[0].value == 35.0 && found[0].samples > 2000);
        let low: Vec<f64> = bell.iter().map(|v| 0.1 * v.max(27.0)).collect();
        assert_eq!(saturation(&low)[0].value, 0.1 * 27.0);
        for nothing in [&[][..], &[1.0; 100], &[f64::NAN; 20]] {
            assert_eq!(saturation(nothing), []);
        }
    }

    #[test]
    fn a_stop_holds_ten_samples_and_thrice_those_of_the_level_next_to_it() {
        let of = |counts: [usize; 4]| {
            let levels = counts.iter().enumerate();
            let x: Vec<f64> = levels
                .flat_map(|(level, n)| vec![level as f64; *n])
                .collect();
            [
                x.clone(),
                x.iter().map(|v| -v).collect(),
                x.into_iter().rev().collect(),
            ]
            .map(|x| saturation(&x))
        };
        let stop = |value: f64, samples| vec![Saturation { value, samples }];
        // The top, the bottom, and in another order.
        assert_eq!(
            of([20, 30, 3, 10]),
            [stop(3.0, 10), stop(-3.0, 10), stop(3.0, 10)]
        );
        assert_eq!(of([20, 30, 3, 9]), [vec![], vec![], vec![]]);
        assert_eq!(of([20, 30, 4, 12])[0], stop(3.0, 12));
        assert_eq!(of([20, 30, 4, 11])[0], []);
        // Three levels are too few.
        assert_eq!(of([0, 30, 3, 10])[0], []);
    }
}
