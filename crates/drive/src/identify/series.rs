//! Data of an axis for plots: its record over time and over value, its spectrum, its correlations.

use undrift_noise::{correlation::white_bound, identify::Axis, spectrum::Density};
use undrift_results::{
    AxisSeries, Histogram, Number, Psd, Residuals,
    series::{Envelope, to_digits},
};

/// Buckets of the record.
const RECORD: usize = 2000;
/// Bars of the histogram, and how far it reaches [standard deviations].
const BARS: usize = 80;
const REACH: f64 = 5.0;
/// Bands of the spectrum, evenly spaced in the logarithm of the frequency.
const BANDS: usize = 300;

/// A record of one axis reduced for plots.
#[derive(Clone, Debug)]
pub struct RecordSeries {
    record: Envelope,
    mean: f64,
    deviation: f64,
    /// Centre \[unit\] of the first bar, width of a bar and its share of the samples over its width.
    first: f64,
    width: f64,
    density: Vec<f64>,
}

impl RecordSeries {
    /// Reduces samples at a rate \[Hz\] that lie on a grid of `step`, if they do.
    pub(super) fn new(samples: &[f64], rate_hz: f64, step: Option<f64>) -> Self {
        let mut record = Envelope::new(RECORD);
        for (k, value) in samples.iter().enumerate() {
            record.add(k as f64 / rate_hz, *value);
        }
        let finite = || samples.iter().copied().filter(|x| x.is_finite());
        let count = finite().count().max(1) as f64;
        let mean = finite().sum::<f64>() / count;
        let deviation = (finite().map(|x| (x - mean).powi(2)).sum::<f64>() / count).sqrt();
        // Whole steps of the grid, else some bars hold more of its lines than others.
        let plain = 2.0 * REACH * deviation / BARS as f64;
        let (width, first) = match step {
            Some(step) if step > 0.0 => {
                let width = step * (plain / step).ceil().max(1.0);
                let on_grid = samples.first().copied().unwrap_or(mean);
                let middle = on_grid + ((mean - on_grid) / width).round() * width;
                let half_step = if (width / step).round() % 2.0 == 0.0 {
                    0.5 * step
                } else {
                    0.0
                };
                let bars = (REACH * deviation / width).ceil();
                (width, middle + half_step - bars * width)
            }
            _ => (plain, mean - REACH * deviation + 0.5 * plain),
        };
        let bars = if width > 0.0 {
            (2.0 * REACH * deviation / width)
                .ceil()
                .min(2.0 * BARS as f64) as usize
                + 1
        } else {
            0
        };
        let mut counts = vec![0u64; bars];
        for x in finite() {
            let bar = ((x - first) / width + 0.5).floor();
            if bar >= 0.0
                && let Some(count) = counts.get_mut(bar as usize)
            {
                *count += 1;
            }
        }
        Self {
            record,
            mean,
            deviation,
            first,
            width,
            density: counts
                .into_iter()
                .map(|n| n as f64 / (count * width))
                .collect(),
        }
    }

    /// The data as a result, with what was found of the axis.
    pub(super) fn result(&self, axis: &Axis) -> AxisSeries {
        let centres = (0..self.density.len()).map(|bar| self.first + bar as f64 * self.width);
        AxisSeries {
            record: self.record.curve(),
            histogram: Histogram {
                centre: digits(centres),
                density: digits(self.density.iter().copied()),
                width: to_digits(self.width).into(),
                mean: to_digits(self.mean).into(),
                sigma: to_digits(self.deviation).into(),
            },
            psd: psd(&axis.psd),
            correlation_bound: to_digits(white_bound(axis.samples)).into(),
            residuals: axis.residuals.iter().map(residuals).collect(),
        }
    }
}

/// The residuals of a fit as a result.
pub fn residuals(of: &undrift_noise::identify::Residuals) -> Residuals {
    Residuals {
        model: of.model.clone(),
        samples: of.samples as u64,
        acf: digits(of.acf.iter().copied()),
        pacf: digits(of.pacf.iter().copied()),
        bound: to_digits(white_bound(of.samples)).into(),
    }
}

fn digits(values: impl Iterator<Item = f64>) -> Vec<Number> {
    values.map(|value| to_digits(value).into()).collect()
}

/// The smallest and largest density of each band. Half the sample rate is left out: there the
/// one-sided density is half of what it is beside.
fn psd(density: &Density) -> Option<Psd> {
    let end = density.frequency_hz.len().saturating_sub(1);
    let points = || {
        let all = density.frequency_hz.iter().zip(&density.density).take(end);
        all.map(|(f, d)| (*f, *d)).filter(|(f, _)| *f > 0.0)
    };
    let ((first, _), (last, _)) = (points().next()?, points().next_back()?);
    let band = |f: f64| ((f / first).ln() / (last / first).ln() * BANDS as f64) as usize;
    let mut psd = Psd::default();
    let mut rest = points().peekable();
    while let Some(one) = rest.next() {
        let (mut least, mut most) = (one, one);
        while let Some(next) = rest.next_if(|next| band(next.0) == band(one.0)) {
            if next.1 < least.1 {
                least = next;
            }
            if next.1 > most.1 {
                most = next;
            }
        }
        let mut ends = vec![least, most];
        ends.sort_by(|a, b| a.0.total_cmp(&b.0));
        ends.dedup_by(|a, b| a.0 == b.0);
        for (f, d) in ends {
            psd.frequency_hz.push(to_digits(f).into());
            psd.density.push(to_digits(d).into());
        }
    }
    Some(psd)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(numbers: &[Number]) -> Vec<f64> {
        numbers.iter().map(|number| number.0).collect()
    }

    /// 3000 frequencies over four decades, evenly spaced in the logarithm: band k·300/2999 of each in whole numbers.
    #[test]
    fn a_spectrum_keeps_the_extremes_of_each_band() {
        let last = 2999;
        let frequency = |k: usize| 0.01 * 1e4f64.powf(k as f64 / last as f64);
        let density = |k: usize| 1.0 + (k * 7919 % 3001) as f64;
        // Neither the mean nor half the sample rate belongs to it.
        let mut all = Density {
            frequency_hz: vec![0.0],
            density: vec![1e9],
            segments: 1,
        };
        for k in 0..=last {
            all.frequency_hz.push(frequency(k));
            all.density.push(density(k));
        }
        all.frequency_hz.push(200.0);
        all.density.push(1e-9);
        let mut expected = Vec::new();
        let points: Vec<usize> = (0..=last).collect();
        for band in points.chunk_by(|a, b| a * BANDS / last == b * BANDS / last) {
            let key = |k: &&usize| (density(**k) * 10.0) as u64;
            let least = *band.iter().min_by_key(key).unwrap();
            let most = *band.iter().max_by_key(key).unwrap();
            expected.push(least.min(most));
            if least != most {
                expected.push(least.max(most));
            }
        }
        let found = psd(&all).unwrap();
        let rounded = |of: &dyn Fn(usize) -> f64| -> Vec<f64> {
            expected.iter().map(|k| to_digits(of(*k))).collect()
        };
        assert_eq!(values(&found.frequency_hz), rounded(&frequency));
        assert_eq!(values(&found.density), rounded(&density));
        assert!(expected.len() > BANDS);
        let none = Density {
            frequency_hz: vec![0.0, 1.0],
            density: vec![1.0, 1.0],
            segments: 1,
        };
        assert_eq!(psd(&none), None);
    }

    /// Every value of −500 … 500 once: uniform, so that all bars inside are as high.
    #[test]
    fn a_histogram_is_a_density_over_value() {
        let samples: Vec<f64> = (0..1001).map(|k| f64::from(k * 10 % 1001 - 500)).collect();
        let series = RecordSeries::new(&samples, 10.0, None);
        let deviation = (1001f64.powi(2) - 1.0).sqrt() / 12f64.sqrt();
        assert!(series.mean.abs() < 1e-9 && (series.deviation / deviation - 1.0).abs() < 1e-12);
        // Five standard deviations either way in eighty bars.
        let width = 10.0 * deviation / 80.0;
        assert!((series.width / width - 1.0).abs() < 1e-12);
        assert!((series.first - (-5.0 * deviation + 0.5 * width)).abs() < 1e-9);
        let whole: f64 = series.density.iter().map(|d| d * series.width).sum();
        assert!((whole - 1.0).abs() < 1e-12, "{whole}");
        for (bar, density) in series.density.iter().enumerate() {
            let centre = series.first + bar as f64 * series.width;
            let expected = match centre.abs() {
                inside if inside < 500.0 - series.width => 1.0 / 1001.0,
                outside if outside > 500.0 + series.width => 0.0,
                _ => continue,
            };
            // A bar of 36.1 holds 36 or 37.
            assert!(
                (density - expected).abs() <= 1.0 / (1001.0 * series.width),
                "{centre}"
            );
        }
        let curve = series.record.curve();
        assert_eq!(curve.time_s[1].0 - curve.time_s[0].0, 0.1);
        assert_eq!(curve.value[1].0, -490.0);
    }

    /// Values on a grid: bars of whole steps, each with as many lines of the grid.
    #[test]
    fn bars_of_a_grid_hold_as_many_of_its_lines() {
        for (step, most) in [(0.5, 120), (0.5, 200), (2.0, 30), (0.125, 3)] {
            let count = 2 * most + 1;
            let samples: Vec<f64> = (0..10 * count)
                .map(|k| 0.3 + step * f64::from(k % count - most))
                .collect();
            let series = RecordSeries::new(&samples, 1.0, Some(step));
            let lines = series.width / step;
            assert!(
                (lines - lines.round()).abs() < 1e-9 && lines > 0.5,
                "{lines}"
            );
            let plain = 10.0 * series.deviation / 80.0;
            assert!(series.width >= plain && series.width < plain + step);
            let whole: f64 = series.density.iter().map(|d| d * series.width).sum();
            assert!((whole - 1.0).abs() < 1e-9, "{step} {most}: {whole}");
            let reach = f64::from(most) * step - series.width;
            for (bar, density) in series.density.iter().enumerate() {
                let centre = series.first + bar as f64 * series.width;
                if (centre - 0.3).abs() < reach {
                    let expected = 1.0 / (f64::from(count) * step);
                    assert!(
                        (density / expected - 1.0).abs() < 1e-9,
                        "{step} {most}: {centre}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_record_that_stands_has_no_bars_and_what_is_not_finite_does_not_count() {
        let still = RecordSeries::new(&[2.0; 50], 1.0, None);
        assert_eq!((still.mean, still.deviation), (2.0, 0.0));
        assert!(still.density.is_empty());
        let holes = [1.0, f64::NAN, 3.0, f64::INFINITY];
        let series = RecordSeries::new(&holes, 1.0, None);
        assert_eq!((series.mean, series.deviation), (2.0, 1.0));
        assert_eq!(series.record.points().count(), 2);
    }
}
