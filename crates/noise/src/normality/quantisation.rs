//! The grid that samples of a sensor lie on.

/// Steps off the grid that a sample may lie, for steps written with few digits.
const OFF_GRID: f64 = 0.1;

/// The step of quantised samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantisation {
    /// Step [unit].
    pub step: f64,
    /// Step over the record's standard deviation: above about 0.1 normality tests reject at 10⁶ samples.
    pub step_over_deviation: f64,
    /// Different values in the record.
    pub levels: usize,
}

/// The grid of sorted samples, None where there is none: more than half of the samples differ, or
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
