//! The grid that samples of a sensor lie on.
//!
//! A grid matters twice: tests of normality see it, and a slow error much smaller than the step shows only
//! through the noise that dithers it ([`crate::screening::rounding`]).

/// Steps off the grid that a sample may lie, for steps written with few digits.
const OFF_GRID: f64 = 0.1;

/// The step of quantised samples: what an analogue-digital converter, or a logger that rounds, leaves.
///
/// ```
/// use undrift_noise::normality::quantisation;
/// // A gyro logged in counts of 1/131 deg/s, four digits behind the point.
/// let counts = (0..500).map(|k| f64::from(k * 7919 % 13 - 6));
/// let logged: Vec<f64> = counts.map(|count| (count / 131.0 * 1e4).round() / 1e4).collect();
/// let grid = quantisation(&logged).expect("13 levels");
/// assert!((grid.step * 131.0 - 1.0).abs() < 1e-3 && grid.levels == 13);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantisation {
    /// Step \[unit\].
    pub step: f64,
    /// Step over the record's standard deviation: above about 0.1 normality tests reject at 10⁶ samples.
    pub step_over_deviation: f64,
    /// Number of different values in the record.
    pub levels: usize,
}

/// The grid of `sorted` samples with this standard `deviation` \[unit\]; `None` where there is no grid: more than half of the samples differ, or
/// more than 1 % of the levels lie off it. The first step is the smallest gap; it grows more exact as
/// the levels are walked through, so that a step of 1/300 written with five digits is found.
pub fn quantisation_of_sorted(sorted: &[f64], deviation: f64) -> Option<Quantisation> {
    let (&first, &last) = (sorted.first()?, sorted.last()?);
    let rounding = 8.0 * f64::EPSILON * first.abs().max(last.abs());
    let mut step = f64::INFINITY;
    let mut levels = 1;
    for pair in sorted.windows(2) {
        let gap = pair[1] - pair[0];
        if gap > rounding {
            levels += 1;
            step = step.min(gap);
        }
    }
    if levels < 2 || 2 * levels > sorted.len() {
        return None;
    }
    let (mut count, mut off, mut previous) = (0.0, 0, first);
    for &value in sorted {
        if value - previous <= rounding {
            continue;
        }
        let steps = (value - previous) / step;
        off += usize::from(
            (steps - steps.round()).abs() > OFF_GRID * if steps < 1.5 { 1.0 } else { 2.0 },
        );
        count += steps.round().max(1.0);
        if (value - first) / count < 1.5 * step {
            step = (value - first) / count;
        }
        previous = value;
    }
    (100 * off <= levels).then(|| Quantisation {
        step,
        step_over_deviation: step / deviation,
        levels,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Levels 0 … count − 1, each three times, with longer gaps before some.
    fn levels(count: usize, longer: &[(usize, f64)]) -> Vec<f64> {
        let mut at = 0.0;
        let mut sorted = Vec::new();
        for k in 0..count {
            if k > 0 {
                at += longer
                    .iter()
                    .find(|(of, _)| *of == k)
                    .map_or(1.0, |(_, gap)| *gap);
            }
            sorted.extend([at; 3]);
        }
        sorted
    }

    #[test]
    fn a_grid_is_its_step_and_levels_whatever_steps_are_left_out() {
        let sorted = [-1.0, -1.0, -0.5, -0.5, 0.0, 1.5, 1.5, 1.5, 1.5];
        let found = quantisation_of_sorted(&sorted, 2.0).unwrap();
        assert_eq!((found.step, found.levels), (0.5, 4));
        assert_eq!(found.step_over_deviation, 0.25);
        // Two samples a level at least.
        assert!(quantisation_of_sorted(&[0.0, 0.0, 1.0, 1.0], 1.0).is_some());
        assert!(quantisation_of_sorted(&[0.0, 0.0, 1.0], 1.0).is_none());
        assert!(quantisation_of_sorted(&[1.0; 9], 1.0).is_none());
        assert!(quantisation_of_sorted(&[], 1.0).is_none());
    }

    #[test]
    fn one_percent_of_the_levels_may_lie_off_the_grid() {
        let is_grid = |count, longer: &[(usize, f64)]| {
            quantisation_of_sorted(&levels(count, longer), 1.0).is_some()
        };
        // A tenth of a step from the level below, two of them over more than one step.
        for (gap, off) in [
            (1.08, false),
            (1.12, true),
            (2.18, false),
            (2.25, true),
            (1.82, false),
            (1.75, true),
        ] {
            assert_eq!(is_grid(99, &[(50, gap)]), !off, "{gap}");
            assert!(is_grid(100, &[(50, gap)]), "{gap}");
            assert_eq!(is_grid(199, &[(50, gap), (120, gap)]), !off, "{gap}");
        }
    }

    #[test]
    fn a_step_written_with_few_digits_grows_more_exact_over_the_levels() {
        let value = |k: i32| (f64::from(k) / 300.0 * 1e5).round() / 1e5;
        let sorted: Vec<f64> = (-100..500).flat_map(|k| [value(k); 2]).collect();
        let found = quantisation_of_sorted(&sorted, 1.0).unwrap();
        assert_eq!(found.levels, 600);
        // Half a unit of the last digit at either end, over 599 steps.
        assert!(
            (found.step - 1.0 / 300.0).abs() < 1.1e-5 / 599.0,
            "{found:?}"
        );
    }

    #[test]
    fn what_lies_within_rounding_is_one_level() {
        // Eight units of rounding of 1e6 are 1.8e-9.
        for sign in [1.0, -1.0] {
            let of = |jitter: f64| {
                let mut sorted: Vec<f64> = (0..10)
                    .flat_map(|k| {
                        [0.0, jitter, 2.0 * jitter].map(|by| sign * 1e6 + f64::from(k) + by)
                    })
                    .collect();
                sorted.sort_by(f64::total_cmp);
                quantisation_of_sorted(&sorted, 1.0)
            };
            assert_eq!(of(1e-9).unwrap().levels, 10);
            assert!(of(1e-8).is_none());
        }
    }

    #[test]
    fn a_record_is_held_against_its_own_standard_deviation() {
        // Of 0, 0, 1, 1 it is √(1/3).
        let found = super::super::quantisation(&[1.0, 0.0, 0.0, 1.0]).unwrap();
        assert!((found.step_over_deviation - 3f64.sqrt()).abs() < 1e-12);
        assert_eq!(super::super::quantisation(&[1.0]), None);
    }
}
