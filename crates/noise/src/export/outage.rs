//! The random walk that serves a filter which knows no other bias: the one under which its drift over an outage is least and what it expects.
//! The least drift alone would take none for a process that is over before the outage is, and a σ of a hundredth of the error.
//!
//! The filter has a bias that walks by K beside white noise N, and has settled on a sensor whose bias is a sum of Gauss-Markov
//! processes and a walk of its own. What it holds of the bias at the start of an outage, and so the RMS error of the
//! integral at its end, is a sum over the sensor's terms, each in closed form.
//!
//! With T the step, `q = K² T` and `r = N²/T` the filter settles at the variance `P = q/2 + √(q²/4 + q r)`
//! before a sample and the gain `g = P/(P + r)`. It holds `x̂ ← (1 − g) x̂ + g y` of the samples y, so that
//! after n steps without fixes the integral is wrong by `T (Σ b − n x̂)` and the white noise of the n samples.
//! Of a process b of variance σ² and φ = exp(−T/τ), with c = 1 − g,
//!
//! ```text
//! E[x̂ b] = φ g σ²/(1 − φ c)     E[x̂²] = (g² σ² + 2 g c E[x̂ b])/(1 − c²)
//! E[(Σ b)²] = σ² (n (1 + φ) − 2 φ s)/(1 − φ),     s = (1 − φⁿ)/(1 − φ)
//! ```
//!
//! and of a walk each step counts for as many samples as follow it.

use crate::bias_model::Slow;
use crate::composite::GaussMarkov;

/// Steps of an outage, and the longest of them \[s\].
const STEPS: f64 = 200.0;
const LONGEST: f64 = 1.0;
/// Walks that are tried are powers of ten to these hundredths, about the driving noise.
const TRIED: std::ops::RangeInclusive<i32> = -200..=100;

/// A filter of white noise and a random walk over a sensor.
pub(super) struct WalkFilter<'a> {
    white: f64,
    slow: &'a Slow,
}

/// RMS error of the integral at an outage's end, and what the filter expects [unit·s].
#[derive(Clone, Copy, Debug)]
pub(super) struct Drift {
    pub real: f64,
    pub expected: f64,
}

impl Drift {
    /// −2 ln likelihood of the error, on the average: least where the drift is and is expected.
    fn loss(self) -> f64 {
        let ratio = self.real / self.expected;
        2.0 * self.expected.ln() + ratio * ratio
    }
}

impl<'a> WalkFilter<'a> {
    /// Over a sensor of this white noise [unit·√s] and bias.
    pub(super) fn new(white: f64, slow: &'a Slow) -> Self {
        Self { white, slow }
    }

    /// The random walk [unit/√s] of the likeliest errors after an outage \[s\], small ones of a σ that holds; that of the bias where it has no processes or no white
    /// noise hides it.
    pub(super) fn best(&self, outage_s: f64) -> f64 {
        let driving = self.slow.drive();
        if self.slow.processes.is_empty() || self.white <= 0.0 || driving <= 0.0 {
            return driving;
        }
        let walks = TRIED.map(|power| driving * 10f64.powf(0.01 * f64::from(power)));
        let losses = walks.map(|walk| (walk, self.drift(walk, outage_s).loss()));
        let best = losses.min_by(|a, b| a.1.total_cmp(&b.1));
        best.map_or(driving, |(walk, _)| walk)
    }

    /// The drift of a filter of this walk [unit/√s] over an outage \[s\].
    pub(super) fn drift(&self, walk: f64, outage_s: f64) -> Drift {
        let step = LONGEST.min(outage_s / STEPS);
        let count = (outage_s / step).round();
        let white = self.white * self.white / step;
        // The settled filter: its variance before a sample, and its gain.
        let driven = walk * walk * step;
        let before = 0.5 * driven + (0.25 * driven * driven + driven * white).sqrt();
        let gain = before / (before + white);
        let kept = 1.0 - gain;
        let decay = gain * (1.0 + kept);
        // Sum of the squares of 1 to count − 1: how a walk's steps add up.
        let squares = (count - 1.0) * count * (2.0 * count - 1.0) / 6.0;
        let own = self.slow.walk.map_or(0.0, |k| k * k * step);
        let level = (own + gain * gain * white) / decay;
        let mut real = count * count * level + squares * own + count * white;
        for GaussMarkov { sigma, tau_s } in &self.slow.processes {
            let phi = (-step / tau_s).exp();
            let variance = sigma * sigma;
            // The part of the filter's error that the process makes: its variance, and its covariance with the process.
            let shared = -phi * gain * variance / (1.0 - phi * kept);
            let error = (gain * gain * variance - 2.0 * gain * kept * shared) / decay;
            let power = phi.powf(count);
            let sum = (1.0 - power) / (1.0 - phi);
            let whole = variance * (count * (1.0 + phi) - 2.0 * phi * sum) / (1.0 - phi);
            real += count * count * error + 2.0 * count * sum * shared + whole;
        }
        let expected = count * count * before + squares * driven + count * white;
        Drift {
            real: step * real.sqrt(),
            expected: step * expected.sqrt(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::composite::CompositeTerms;
    use crate::drift_score;
    use crate::synthesis::NoiseGenerator;
    use undrift_nav::shaping::ShapingFilter;

    fn bias() -> Slow {
        Slow {
            processes: vec![
                GaussMarkov {
                    sigma: 0.3,
                    tau_s: 10.0,
                },
                GaussMarkov {
                    sigma: 0.4,
                    tau_s: 200.0,
                },
            ],
            walk: Some(0.005),
        }
    }

    /// Against the drift score of the same filter on simulated noise, seed 1: 28 hours have 3000 windows of 30 s.
    #[test]
    fn the_drift_is_that_of_the_filter_on_the_noise() {
        let (slow, interval) = (bias(), 0.15);
        let terms = CompositeTerms {
            white: 1.0,
            random_walk: 0.005,
            gauss_markov: [slow.processes[0], slow.processes[1]],
            ..CompositeTerms::default()
        };
        let mut record = vec![0.0; 670_000];
        NoiseGenerator::new(&terms.to_shaping(interval).unwrap(), 1).fill(&mut record);
        for walk in [0.01, 0.05] {
            let filter = ShapingFilter::white(1.0, interval).unwrap();
            let filter = filter.plus(&ShapingFilter::random_walk(walk, interval).unwrap());
            let score = drift_score::score(&record, 70_000, &filter.unwrap(), &[30.0]).unwrap();
            let found = WalkFilter::new(1.0, &slow).drift(walk, 30.0);
            // √(1/6000) of the RMS, thrice.
            let near = |a: f64, b: f64| (a / b - 1.0).abs() < 0.04;
            assert!(near(found.real, score[0].rms), "{found:?} {score:?}");
            assert!(near(found.expected, score[0].predicted_rms), "{found:?}");
        }
    }

    #[test]
    fn the_best_walk_drifts_little_as_expected_and_is_the_bias_own_where_that_is_one() {
        let slow = bias();
        let filter = WalkFilter::new(1.0, &slow);
        let best = filter.best(30.0);
        // Within 5 % of the least drift of all walks (3 % here), and 15 % of what the filter expects (9 %).
        let found = filter.drift(best, 30.0);
        let walks = (-200..=100).map(|power| slow.drive() * 10f64.powf(0.01 * f64::from(power)));
        let least = walks.map(|walk| filter.drift(walk, 30.0).real);
        let least = least.fold(f64::INFINITY, f64::min);
        assert!(found.real < 1.05 * least, "{found:?} {least}");
        assert!(
            (found.expected / found.real - 1.0).abs() < 0.15,
            "{found:?}"
        );
        // The driving noise is right for times far below 10 s, and expects too much after 30.
        let driving = filter.drift(slow.drive(), 30.0);
        assert!(driving.expected > 1.1 * driving.real, "{driving:?}");
        // σ also contains a process whose correlation time is shorter than the outage.
        let fast = Slow {
            processes: vec![GaussMarkov {
                sigma: 200.0,
                tau_s: 10.0,
            }],
            walk: None,
        };
        let filter = WalkFilter::new(1.0, &fast);
        let found = filter.drift(filter.best(30.0), 30.0);
        assert!(found.expected > 0.8 * found.real, "{found:?}");
        let walk = Slow {
            processes: Vec::new(),
            walk: Some(0.02),
        };
        assert_eq!(WalkFilter::new(1.0, &walk).best(30.0), 0.02);
    }
}
