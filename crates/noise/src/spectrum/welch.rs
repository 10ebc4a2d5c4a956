//! Welch's method (IEEE Trans. Audio Electroacoustics 15, 1967).

use crate::screening::record::{RecordError, check, check_rate, mean};
use realfft::RealFftPlanner;
use std::f64::consts::TAU;

/// One-sided power spectral density.
/// A plot shows its root [unit/√Hz], whose flat is `√2 N`.
#[derive(Clone, Debug, PartialEq)]
pub struct Density {
    /// Frequencies from 0 on, evenly spaced \[Hz\].
    pub frequency_hz: Vec<f64>,
    /// Density [unit²/Hz]; its integral over frequency is the variance. That of white noise N
    /// [unit/√Hz, two-sided as in the Allan variance] is 2 N².
    pub density: Vec<f64>,
    /// Number of segments averaged: the relative standard error of a density is about `1/√segments`.
    pub segments: usize,
}

impl Density {
    /// Spacing of the frequencies \[Hz\].
    /// The sample rate over the segment's length; 0 of a density with one frequency.
    pub fn resolution_hz(&self) -> f64 {
        self.frequency_hz.get(1).copied().unwrap_or(0.0)
    }
}

/// Samples of a segment by default: an eighth of the record, at least 256, at most 8192.
///
/// ```
/// use undrift_noise::spectrum::default_segment;
/// assert_eq!([1000, 10_000, 1_000_000].map(default_segment), [256, 1250, 8192]);
/// ```
pub fn default_segment(samples: usize) -> usize {
    (samples / 8).clamp(256, 8192)
}

/// Density of `x` sampled at `rate_hz` \[Hz\] from segments of `segment` samples (cut to the record),
/// periodic Hann window, half overlapped, the mean of each segment taken out: `scipy.signal.welch`
/// with its defaults. Samples at the end that fill no segment are left out. O(N log segment).
///
/// ```
/// use undrift_nav::shaping::ShapingFilter;
/// use undrift_noise::{spectrum::welch, synthesis::NoiseGenerator};
/// let white = ShapingFilter::white(1e-3, 0.01)?; // N [unit·√s] at 100 Hz.
/// let record: Vec<f64> = NoiseGenerator::new(&white, 1).take(50_000).collect();
/// let density = welch(&record, 100.0, 1024)?;
/// let inner = &density.density[2..500];
/// let mean = inner.iter().sum::<f64>() / inner.len() as f64;
/// assert!((mean / (2.0 * 1e-6) - 1.0).abs() < 0.02, "2 N², one-sided");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Fewer than 4 samples or a segment shorter than 4, a sample that is not finite,
/// a rate that is not positive.
pub fn welch(x: &[f64], rate_hz: f64, segment: usize) -> Result<Density, RecordError> {
    check(x, 4)?;
    if segment < 4 {
        return Err(RecordError::Argument("a segment needs at least 4 samples"));
    }
    check_rate(rate_hz)?;
    let segment = segment.min(x.len());
    let step = segment - segment / 2;
    let window: Vec<f64> = (0..segment)
        .map(|k| 0.5 - 0.5 * (TAU * k as f64 / segment as f64).cos())
        .collect();
    let plan = RealFftPlanner::<f64>::new().plan_fft_forward(segment);
    let (mut time, mut spectrum, mut scratch) = (
        plan.make_input_vec(),
        plan.make_output_vec(),
        plan.make_scratch_vec(),
    );
    let mut density = vec![0.0; spectrum.len()];
    let mut segments = 0;
    for start in (0..=x.len() - segment).step_by(step) {
        let part = &x[start..start + segment];
        let centre = mean(part);
        for ((slot, value), weight) in time.iter_mut().zip(part).zip(&window) {
            *slot = (value - centre) * weight;
        }
        // The buffers have the plan's own sizes: this cannot fail.
        let _ = plan.process_with_scratch(&mut time, &mut spectrum, &mut scratch);
        for (sum, value) in density.iter_mut().zip(&spectrum) {
            *sum += value.norm_sqr();
        }
        segments += 1;
    }
    let squares: f64 = window.iter().map(|w| w * w).sum();
    let scale = 1.0 / (rate_hz * squares * segments as f64);
    let last = density.len() - 1;
    for (k, value) in density.iter_mut().enumerate() {
        // Negative frequencies are folded in; 0 and the Nyquist frequency have no partner.
        let folded = if k == 0 || (k == last && segment.is_multiple_of(2)) {
            1.0
        } else {
            2.0
        };
        *value *= folded * scale;
    }
    let frequency_hz = (0..density.len())
        .map(|k| k as f64 * rate_hz / segment as f64)
        .collect();
    Ok(Density {
        frequency_hz,
        density,
        segments,
    })
}
