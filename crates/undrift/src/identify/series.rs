//! What an axis is drawn from: its record over time and over value, its spectrum, its correlations.

use crate::{
    results::{AxisSeries, Histogram, Number, Psd, Residuals},
    series::{Envelope, to_digits},
};
use undrift_noise::{correlation::white_bound, identify::Axis, spectrum::Density};

/// Buckets of the record.
const RECORD: usize = 2000;
/// Bars of the histogram, and how far it reaches [standard deviations].
const BARS: usize = 80;
const REACH: f64 = 5.0;
/// Bands of the spectrum, evenly spaced in the logarithm of the frequency.
const BANDS: usize = 300;

/// A record of one axis for plots.
#[derive(Clone, Debug)]
pub struct RecordSeries {
    record: Envelope,
    mean: f64,
    deviation: f64,
    /// Centre [unit] of the first bar, width of a bar and its share of the samples over its width.
    first: f64,
    width: f64,
    density: Vec<f64>,
}

impl RecordSeries {
    /// Of samples at a rate \[Hz\] that lie on a grid of `step`, if they do.
    pub(super) fn of(samples: &[f64], rate_hz: f64, step: Option<f64>) -> Self {
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

    /// With what was found of the axis.
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
            residuals: axis.residuals.iter().map(Into::into).collect(),
        }
    }
}

impl From<&undrift_noise::identify::Residuals> for Residuals {
    fn from(of: &undrift_noise::identify::Residuals) -> Self {
        Self {
            model: of.model.clone(),
            samples: of.samples as u64,
            acf: digits(of.acf.iter().copied()),
            pacf: digits(of.pacf.iter().copied()),
            bound: to_digits(white_bound(of.samples)).into(),
        }
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
