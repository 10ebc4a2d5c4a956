//! A dead band: samples near the rest value that the sensor, or its driver, replaces by it.
//!
//! What is left of the noise are its tails, of which no model of the noise at rest can be made: identification
//! refuses such a record.

/// Samples that the rest value is looked for in, and that the grid of the others is taken from.
const PROBE: usize = 10_000;
/// Least share of the samples that have the rest value, and how many others there are at least.
const SHARE: f64 = 0.1;
const FEWEST: usize = 50;
/// Steps of the others that the nearest of them is off, and the share of their root mean square distance that this is.
const STEPS: f64 = 3.0;
const WIDE: f64 = 0.1;

/// A dead band: the value that samples near it are replaced by, and its width.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeadBand {
    /// The value that samples inside have \[unit\].
    pub value: f64,
    /// Distance of the nearest other sample \[unit\].
    pub width: f64,
    /// Share of the samples inside [–].
    pub share: f64,
}

/// The dead band of a record without missing samples, if it has one: a value of many samples with no neighbour in reach
/// of some steps of the others. Rounding alone leaves the next step occupied.
///
/// ```
/// use undrift_nav::shaping::ShapingFilter;
/// use undrift_noise::{screening::dead_band, synthesis::NoiseGenerator};
/// let noise: Vec<f64> = NoiseGenerator::new(&ShapingFilter::white(0.1, 0.01)?, 1).take(10_000).collect();
/// let cut: Vec<f64> = noise.iter().map(|x| if x.abs() < 0.5 { 0.0 } else { *x }).collect();
/// assert_eq!(dead_band(&noise), None);
/// let band = dead_band(&cut).expect("samples within ±0.5 read 0");
/// assert!(band.value == 0.0 && (band.width - 0.5).abs() < 0.01 && band.share > 0.3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn dead_band(x: &[f64]) -> Option<DeadBand> {
    let sorted = |values: Vec<f64>| {
        let mut values = values;
        values.sort_by(f64::total_cmp);
        values
    };
    let strided = |values: &[f64]| {
        let stride = values.len().div_ceil(PROBE).max(1);
        sorted(values.iter().step_by(stride).copied().collect())
    };
    let probe = strided(x);
    let runs = probe.chunk_by(|a, b| a == b);
    let longest = runs.max_by_key(|run| run.len())?;
    let value = longest[0];
    let others: Vec<f64> = x.iter().copied().filter(|v| *v != value).collect();
    let share = (x.len() - others.len()) as f64 / x.len() as f64;
    if share < SHARE || others.len() < FEWEST {
        return None;
    }
    let off = || others.iter().map(|v| (v - value).abs());
    let width = off().fold(f64::INFINITY, f64::min);
    let square = off().map(|d| d * d).sum::<f64>() / others.len() as f64;
    if width < WIDE * square.sqrt() {
        return None;
    }
    let grid = strided(&others);
    let steps = grid.windows(2).map(|pair| pair[1] - pair[0]);
    // Across the band lies no step.
    let steps = steps.filter(|step| *step > 0.0 && *step < 1.5 * width);
    let step = steps.fold(f64::INFINITY, f64::min);
    (step.is_finite() && width > STEPS * step).then_some(DeadBand {
        value,
        width,
        share,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sums of twelve uniform numbers, bell-shaped about `mean`.
    fn bell(mean: f64) -> Vec<f64> {
        let mut seed = 1u64;
        let mut uniform = || {
            seed = seed
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (seed >> 33) as f64 / (1u64 << 31) as f64
        };
        let mut one = || (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
        (0..20_000).map(|_| mean + one()).collect()
    }

    #[test]
    fn a_dead_band_is_distinguished_from_rounding_and_from_a_sensor_that_hangs() {
        let clamped = |x: f64| if x.abs() < 1.0 { 0.0 } else { x };
        let of =
            |f: &dyn Fn(f64) -> f64| dead_band(&bell(0.3).into_iter().map(f).collect::<Vec<_>>());
        let found = of(&clamped).unwrap();
        assert_eq!(found.value, 0.0);
        // A normal distribution about 0.3: 0.758 − 0.097 of it inside.
        assert!((found.share - 0.661).abs() < 0.02 && (found.width - 1.0).abs() < 0.01);
        let rounded = |step: f64| move |x: f64| clamped((x / step).round() * step);
        let found = of(&rounded(0.05)).unwrap();
        assert!((found.width - 1.0).abs() < 0.01, "{found:?}");
        // Steps alone, fine and coarse; a stretch of one value.
        for step in [0.01, 0.5, 2.0, 6.0] {
            assert_eq!(of(&|x: f64| (x / step).round() * step), None, "{step}");
        }
        let mut hanging = bell(0.3);
        hanging[5000..9000].fill(0.1234);
        assert_eq!(dead_band(&hanging), None);
        assert_eq!(dead_band(&[]), None);
    }

    /// So many samples at zero, and others from `from` on, `apart` from each other, on both sides.
    fn banded(inside: usize, others: usize, from: f64, apart: f64) -> Vec<f64> {
        let other = |k: usize| {
            (from + apart * (k / 2) as f64) * if k.is_multiple_of(2) { 1.0 } else { -1.0 }
        };
        let mut x = vec![0.0; inside];
        x.extend((0..others).map(other));
        x
    }

    #[test]
    fn a_band_is_wide_against_the_steps_and_the_size_of_the_others() {
        let found = dead_band(&banded(40, 60, 1.0, 0.1)).unwrap();
        assert_eq!((found.value, found.width, found.share), (0.0, 1.0, 0.4));
        // A tenth of the samples inside, and fifty others.
        assert!(dead_band(&banded(10, 90, 1.0, 0.1)).is_some());
        assert!(dead_band(&banded(9, 91, 1.0, 0.1)).is_none());
        assert!(dead_band(&banded(40, 50, 1.0, 0.1)).is_some());
        assert!(dead_band(&banded(40, 49, 1.0, 0.1)).is_none());
        // Three steps.
        assert!(dead_band(&banded(40, 60, 1.0, 0.33)).is_some());
        assert!(dead_band(&banded(40, 60, 1.0, 0.34)).is_none());
        // A tenth of the others' root mean square: width 1, thirty of 0.1 (k + k₀).
        let square = |last: f64| {
            (0..30)
                .map(|k| (1.0 + last * f64::from(k) / 29.0).powi(2))
                .sum::<f64>()
                / 30.0
        };
        let far = (0..100)
            .map(|k| 10.0 + 0.1 * f64::from(k))
            .find(|last| square(*last) > 100.0)
            .unwrap();
        assert!(far > 15.0 && far < 20.0);
        let grown = |last: f64| {
            let mut x = banded(40, 0, 1.0, 0.0);
            // A fine grid among them, that the steps are taken from.
            x.extend(
                (0..30).flat_map(|k| [1.0, -1.0].map(|s| s * (1.0 + last * f64::from(k) / 29.0))),
            );
            x.extend([1.05, -1.05]);
            x
        };
        assert!(dead_band(&grown(far - 0.5)).is_some());
        assert!(dead_band(&grown(far + 0.8)).is_none());
    }
}
