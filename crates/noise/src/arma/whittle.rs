//! Whittle's likelihood: what a search over many starts looks at first.
//!
//! In the frequency domain the likelihood of N samples is nearly that of independent periodogram
//! ordinates of mean `σ² g(ω)`, `g = |θ(e^{−iω})|²/|φ(e^{−iω})|²` (Whittle 1953). Ordinates are summed in
//! [`bins`], narrow towards zero, where slow errors differ, and no wider than a line elsewhere: an evaluation costs
//! the same whatever the length of the record. It is approximate, most of all at the lowest frequencies; only the
//! exact likelihood decides. A sine taper keeps a slow error from leaking over the others.
//!
//! Bias: of order 1/N in the parameters for short-memory processes, but larger for roots near 1,
//! where the approximation of the covariance by a circulant one fails; a unit root must be
//! differenced away (`differenced`). It is used to rank starts only, and every result goes to the
//! exact likelihood.

use super::kernel::{Coefficients, PowerSum};
use realfft::RealFftPlanner;
use std::f64::consts::PI;

/// Shortest record of which it is a fair picture.
const SHORTEST: usize = 256;
/// Growth of the bins from one to the next.
const GROWTH: f64 = 0.06;
/// No bin is wider than this share of all frequencies.
const FINEST: usize = 384;
/// Ordinates of the bands that are looked at for lines.
const WIDTHS: [usize; 5] = [2, 5, 12, 30, 100];
/// Samples at the start of a record that it sees.
const MOST: usize = 1 << 21;

/// The periodogram of a record, in bins.
pub(crate) struct Whittle {
    /// N, after which the periodogram is normalised.
    samples: f64,
    /// Binned powers, with sine and cosine of the middle of each bin.
    sums: PowerSum,
    /// The ordinates themselves, from that of one cycle a record on.
    ordinates: Vec<f64>,
}

/// What a model leaves out of a narrow band: a resonance, or a notch.
pub(super) struct Narrow {
    /// Middle of the band [rad/sample].
    pub(super) omega: f64,
    /// Radius of the AR and of the MA roots that make it.
    pub(super) ar: f64,
    pub(super) ma: f64,
}

impl Whittle {
    /// The periodogram of a record about `centre`; missing samples are bridged by the one before. `None` of a short record.
    ///
    /// At most 2²¹ samples of the start of the record are used. Powers are |X|²/N with a sine taper
    /// of unit mean square, so that white noise of variance σ² has mean power σ².
    pub(super) fn new(record: &[f64], centre: f64, differenced: bool) -> Option<Self> {
        let record = &record[..record.len().min(MOST)];
        let mut last = 0.0;
        let mut x: Vec<f64> = Vec::with_capacity(record.len());
        for value in record {
            let before = last;
            if !value.is_nan() {
                last = value - centre;
            }
            x.push(if differenced { last - before } else { last });
        }
        let n = x.len();
        if n < SHORTEST {
            return None;
        }
        if differenced {
            x[0] = 0.0;
        }
        let step = PI / n as f64;
        for (t, value) in x.iter_mut().enumerate() {
            *value *= std::f64::consts::SQRT_2 * ((t as f64 + 0.5) * step).sin();
        }
        let plan = RealFftPlanner::<f64>::new().plan_fft_forward(n);
        let mut spectrum = plan.make_output_vec();
        plan.process(&mut x, &mut spectrum).ok()?;
        let mut sums = PowerSum::default();
        for (first, end) in bins(spectrum.len()) {
            let power: f64 = spectrum[first..end].iter().map(|v| v.norm_sqr()).sum();
            // Every frequency counts for its negative too.
            sums.push(step * (first + end - 1) as f64, 2.0 * power / n as f64);
        }
        let samples = n as f64;
        let ordinates = spectrum[1..].iter().map(|v| v.norm_sqr() / samples);
        let ordinates = ordinates.collect();
        Some(Self {
            samples,
            sums,
            ordinates,
        })
    }

    /// The bands of several widths in which a model's power is most wrong, one of each width: where a
    /// factor m on the power of w ordinates gains most, `w (m − 1 − ln m)`.
    ///
    /// At most ten: two shapes of each of five widths. AR radius above MA radius where the model
    /// has too little power there.
    pub(super) fn narrow(&self, phi: &[f64], theta: &[f64]) -> Vec<Narrow> {
        let step = 2.0 * PI / self.samples;
        let (squares, _) = self.sums.over(phi, theta, step);
        let variance = squares / self.samples;
        let mut sums = Vec::with_capacity(self.ordinates.len() + 1);
        let mut sum = 0.0;
        sums.push(sum);
        for (j, power) in self.ordinates.iter().enumerate() {
            sum += power / (variance * PowerSum::gain(phi, theta, (j + 1) as f64 * step));
            sums.push(sum);
        }
        let band = |width: usize| {
            let gain = |first: usize| {
                let mean = (sums[first + width] - sums[first]) / width as f64;
                mean - 1.0 - mean.ln()
            };
            let last = sums.len().checked_sub(width + 1)?;
            let first = (1..=last).max_by(|&a, &b| gain(a).total_cmp(&gain(b)))?;
            let mean = (sums[first + width] - sums[first]) / width as f64;
            let distance = (0.25 * step * width as f64).min(0.3);
            // A line may be narrower than what an ordinate resolves.
            Some([1.0, 0.2].map(|share| {
                let distance = share * distance;
                Narrow {
                    omega: step * (first as f64 + 0.5 * (width + 1) as f64),
                    ar: 1.0 - distance,
                    ma: 1.0 - (distance * mean.sqrt()).clamp(0.05 * distance, 0.5),
                }
            }))
        };
        WIDTHS.into_iter().filter_map(band).flatten().collect()
    }

    /// Negative log-likelihoods, but for a constant.
    ///
    /// `½ (N ln S/N − ln g(1/N))`, S the sum of the periodogram over g; the second term stands for the
    /// frequency 0, which is not in the sum, while the logarithms of g over all frequencies add up to nothing.
    pub(super) fn objective(&self, points: &[Coefficients]) -> Vec<f64> {
        let one = |(phi, theta): &Coefficients| {
            let (squares, lowest) = self.sums.over(phi, theta, 1.0 / self.samples);
            // The logarithms of g over all N frequencies add up to nothing (Szegő); zero is not among ours.
            0.5 * (self.samples * (squares / self.samples).ln() - lowest.ln())
        };
        points.iter().map(one).collect()
    }

    /// Derivatives of the negative log-likelihood by φ and by θ.
    ///
    /// The analytic derivative of [`Self::objective`]; chain rule to search coordinates is the
    /// caller's.
    pub(super) fn gradient(&self, phi: &[f64], theta: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let lowest = 1.0 / self.samples;
        let (squares, _) = self.sums.over(phi, theta, lowest);
        let sums = self.sums.gradient(phi, theta);
        let gains = PowerSum::gain_gradient(phi, theta, lowest);
        let by = |sum: &f64, gain: &f64| 0.5 * (self.samples * sum / squares - gain);
        let all = |sums: &[f64], gains: &[f64]| {
            sums.iter()
                .zip(gains)
                .map(|(sum, gain)| by(sum, gain))
                .collect()
        };
        (all(&sums.0, &gains.0), all(&sums.1, &gains.1))
    }
}

/// First ordinate and end of each bin; the mean, ordinate 0, is in none.
///
/// Width 6 % of the frequency, at least one ordinate, at most 1/384 of all.
fn bins(ordinates: usize) -> impl Iterator<Item = (usize, usize)> {
    let widest = ordinates.div_ceil(FINEST);
    let mut at = 1;
    std::iter::from_fn(move || {
        let first = at;
        let width = ((GROWTH * first as f64) as usize).clamp(1, widest);
        at = (first + width).min(ordinates);
        (first < ordinates).then_some((first, at))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gradient_is_that_of_the_likelihood() {
        let mut seed = 1u64;
        let record: Vec<f64> = (0..3000)
            .map(|_| {
                seed = seed
                    .wrapping_mul(6364136223846793005)
                    .wrapping_add(1442695040888963407);
                (seed >> 11) as f64 / (1u64 << 53) as f64 - 0.5
            })
            .collect();
        let whittle = Whittle::new(&record, 0.0, false).unwrap();
        let at =
            |phi: &[f64], theta: &[f64]| whittle.objective(&[(phi.to_vec(), theta.to_vec())])[0];
        let (phi, theta) = ([1.2, -0.5, 0.1], [0.6, -0.3]);
        let (by_phi, by_theta) = whittle.gradient(&phi, &theta);
        let step = 1e-6;
        for i in 0..5 {
            let moved = |by: f64| {
                let (mut phi, mut theta) = (phi, theta);
                match i {
                    0..3 => phi[i] += by,
                    _ => theta[i - 3] += by,
                }
                at(&phi, &theta)
            };
            let numeric = (moved(step) - moved(-step)) / (2.0 * step);
            let exact = if i < 3 { by_phi[i] } else { by_theta[i - 3] };
            // Rounding of a value of 1e4 over the step.
            assert!(
                (numeric - exact).abs() < 1e-4 + 1e-6 * exact.abs(),
                "{i}: {numeric} {exact}"
            );
        }
    }

    /// A flat spectrum but for a band of `width` ordinates from the `first` on, seen through a model's gain.
    fn banded((first, width): (usize, usize), times: f64, phi: &[f64], theta: &[f64]) -> Whittle {
        let (samples, mut sums, mut ordinates) = (4000.0, PowerSum::default(), Vec::new());
        for j in 1..=2000 {
            let omega = 2.0 * PI * j as f64 / samples;
            let factor = if (first..first + width).contains(&j) {
                times
            } else {
                1.0
            };
            let power = factor * PowerSum::gain(phi, theta, omega);
            sums.push(omega, 2.0 * power);
            ordinates.push(power);
        }
        Whittle {
            samples,
            sums,
            ordinates,
        }
    }

    #[test]
    fn what_a_model_leaves_out_of_a_band_is_found_and_the_roots_make_it_up() {
        let step = 2.0 * PI / 4000.0;
        for (phi, theta) in [(&[][..], &[][..]), (&[1.2, -0.5], &[0.4])] {
            for (k, width) in WIDTHS.into_iter().enumerate() {
                for times in [9.0, 0.04, 1e-5, 1e8] {
                    let whittle = banded((700, width), times, phi, theta);
                    let found = whittle.narrow(phi, theta);
                    assert_eq!(found.len(), 2 * WIDTHS.len());
                    let centre = step * (700.0 + 0.5 * (width as f64 - 1.0));
                    for (of, other) in found.iter().zip(WIDTHS.iter().flat_map(|w| [w, w])) {
                        let apart = (of.omega - centre).abs() / step;
                        assert!(
                            apart < 0.5 * (width + other) as f64,
                            "{width} {other} {apart}"
                        );
                    }
                    // The band's own width, as broad as its half and a fifth of that; the variance is the mean of all.
                    let mean = times / (1.0 + width as f64 * (times - 1.0) / 2000.0);
                    for (of, share) in found[2 * k..2 * k + 2].iter().zip([1.0, 0.2]) {
                        // Sums of a thousand terms.
                        assert!((of.omega - centre).abs() < 1e-12, "{width}: {}", of.omega);
                        let near = share * 0.25 * step * width as f64;
                        assert!((1.0 - of.ar - near).abs() < 1e-12);
                        let far = (near * mean.sqrt()).max(0.05 * near).min(0.5);
                        assert!((1.0 - of.ma - far).abs() < 1e-9 * far, "{width} {times}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_record_too_short_for_a_band_has_none_of_it() {
        let whittle = Whittle {
            samples: 100.0,
            ..banded((5, 1), 1.0, &[], &[])
        };
        let short = Whittle {
            ordinates: whittle.ordinates[..30].to_vec(),
            ..whittle
        };
        // The ordinate of one cycle a record is in no band: of thirty, bands of 2, 5 and 12.
        assert_eq!(short.narrow(&[], &[]).len(), 6);
    }

    fn some(samples: usize) -> Vec<f64> {
        let next = |x: &f64| Some((x * 29.0 + 0.31).fract());
        let values = std::iter::successors(Some(0.2), next);
        values.take(samples).collect()
    }

    fn squares(whittle: &Whittle) -> f64 {
        whittle.sums.over(&[], &[], 1.0).0
    }

    #[test]
    fn the_power_is_that_of_the_tapered_record() {
        // Parseval, an odd number of samples: all but the mean's.
        let (x, centre) = (some(301), 0.3);
        let tapered = x
            .iter()
            .enumerate()
            .map(|(t, x)| 2f64.sqrt() * ((t as f64 + 0.5) * PI / 301.0).sin() * (x - centre));
        let tapered: Vec<f64> = tapered.collect();
        let sum: f64 = tapered.iter().sum();
        let power = tapered.iter().map(|x| x * x).sum::<f64>() - sum * sum / 301.0;
        let whittle = Whittle::new(&x, centre, false).unwrap();
        assert!((squares(&whittle) / power - 1.0).abs() < 1e-12);
        let ordinates: f64 = whittle.ordinates.iter().sum();
        assert!((2.0 * ordinates / power - 1.0).abs() < 1e-12);
        assert_eq!((whittle.samples, whittle.ordinates.len()), (301.0, 150));
    }

    #[test]
    fn a_missing_sample_is_the_one_before_and_differences_begin_with_nothing() {
        let x = some(300);
        let (mut gappy, mut bridged) = (x.clone(), x.clone());
        for at in [7, 8, 200] {
            (gappy[at], bridged[at]) = (f64::NAN, bridged[at - 1]);
        }
        let of = |x: &[f64], differenced| Whittle::new(x, 0.4, differenced).unwrap();
        assert_eq!(of(&gappy, false).ordinates, of(&bridged, false).ordinates);
        let mut steps: Vec<f64> = x.windows(2).map(|w| w[1] - w[0]).collect();
        steps.insert(0, 0.0);
        let plain = Whittle::new(&steps, 0.0, false).unwrap();
        let pairs = of(&x, true).ordinates.into_iter().zip(plain.ordinates);
        for (a, b) in pairs {
            // The centre goes in and out again: 1e-16 of it a sample.
            assert!((a - b).abs() < 1e-13 * (1.0 + b), "{a} {b}");
        }
        assert!(Whittle::new(&x[..255], 0.4, false).is_none());
        assert!(Whittle::new(&x[..256], 0.4, false).is_some());
    }

    #[test]
    fn each_ordinate_but_the_mean_is_in_one_bin_that_is_narrow() {
        for ordinates in [2, 129, 5000, 300_001] {
            let mut next = 1;
            for (first, end) in bins(ordinates) {
                assert!(first == next && end > first && end <= ordinates);
                let width = (end - first) as f64;
                assert!(width <= (0.06 * first as f64).max(1.0));
                assert!(width <= (ordinates as f64 / 384.0).ceil());
                next = end;
            }
            assert_eq!(next, ordinates);
        }
    }
}
