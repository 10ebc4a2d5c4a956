//! What should be said with a record and with a candidate, in words.

use super::screened::Screened;
use crate::{
    arma::{ArmaFit, Warning},
    composite::{CompositeFit, Flag, Term},
    screening::{Hanging, rounding::MOSTLY_SHOWN},
};

/// Remarks on a record of `samples` at `rate_hz`.
pub(super) fn of_record(of: &Screened, samples: usize, rate_hz: f64) -> Vec<String> {
    let mut remarks = Vec::new();
    let second = |index: usize| index as f64 / rate_hz;
    if let Some(motion) = of.motion.as_ref().filter(|m| m.moving) {
        let first = motion.moving_windows.first().copied().unwrap_or(0);
        remarks.push(format!(
            "the recording is not static: from {:.1} s on, the variance of one-second means is {:.1} times what their noise allows; cut it to where the sensor rests",
            second(first),
            motion.ratio
        ));
    }
    for stop in &of.saturation {
        remarks.push(format!(
            "the axis is saturated: {} samples ({:.2} %) are exactly {}, the end of its range, which clips the noise",
            stop.samples,
            100.0 * stop.samples as f64 / samples as f64,
            stop.value
        ));
    }
    if let Some(&Hanging { index, samples }) = of.hanging.first() {
        remarks.push(format!(
            "the sensor is frozen: {samples} equal samples from {:.2} s on, {} such stretches in all",
            second(index),
            of.hanging.len()
        ));
    }
    if let (Some(grid), Some(deviation)) = (of.quantisation, of.before_rounding) {
        remarks.push(format!(
            "the steps of the samples are {:.1} times the noise before rounding: the white noise is that of the rounded samples, and a slow error smaller than a step shows only in part, so there are no intervals",
            grid.step / deviation
        ));
    }
    if let Some(shown) = of.noise_shown.filter(|shown| *shown < MOSTLY_SHOWN) {
        remarks.push(format!(
            "nearly all samples are equal: the mean stays amid a step, which hides the noise; at another mean, as after another switch-on, it may be {:.1} times what is found, and the drift more",
            1.0 / shown
        ));
    }
    if let Some(Err(why)) = &of.temperature {
        remarks.push(format!("the temperature is not used: {why}"));
    }
    if of.missing > 0 {
        remarks.push(format!(
            "{} samples ({:.2} %) are missing",
            of.missing,
            100.0 * of.missing as f64 / samples as f64
        ));
    }
    if let Some(first) = of.outliers.first() {
        remarks.push(format!(
            "rejected {} samples more than {:.0} robust standard deviations off, the first at {:.2} s",
            of.outliers.len(),
            of.threshold,
            second(first.index)
        ));
    }
    remarks
}

/// Remarks on an ARMA fit.
pub(super) fn of_arma(fit: &ArmaFit) -> Vec<String> {
    let held = fit.has_unit_root.then_some(HELD.to_owned());
    let mean = fit.is_removed_mean().then_some(MEAN.to_owned());
    let warnings = fit.warnings.iter();
    warnings
        // A root held at 1 is no finding.
        .filter(|w| !(fit.has_unit_root && matches!(w, Warning::UnitRoot { .. })))
        .map(ToString::to_string)
        .chain(held)
        .chain(mean)
        .collect()
}

const MEAN: &str = "a pair of roots stands for the mean that was removed, so it is not recommended";
const HELD: &str = "one autoregressive root is held at 1";
const NOT_CONVERGED: &str = "the search stopped before reaching its tolerance";

/// Remarks on a composite fit.
pub(super) fn of_composite(fit: &CompositeFit) -> Vec<String> {
    let named = |term: &Term| match term {
        Term::White => "the white noise".to_owned(),
        Term::Quantisation => "the quantisation".to_owned(),
        Term::RandomWalk => "the random walk".to_owned(),
        Term::Flicker => "the flicker noise".to_owned(),
        Term::GaussMarkov(i) => match fit.terms.gauss_markov.get(*i) {
            Some(process) if process.sigma > 0.0 => {
                format!("the Gauss-Markov process of {:.3} s", process.tau_s)
            }
            _ => "a Gauss-Markov process".to_owned(),
        },
    };
    fit.flags
        .iter()
        .map(|flag| match flag {
            Flag::Vanished(term) => format!("the likelihood does not support {}", named(term)),
            Flag::NotNeeded(term) => format!("{} is not needed at the 5 % level", named(term)),
            Flag::LongCorrelation(i) => format!(
                "{} is effectively a random walk: its correlation time exceeds a tenth of the recording",
                named(&Term::GaussMarkov(*i))
            ),
            Flag::ShortMemory(ratio) => format!(
                "short-term correlation that this model does not describe: the wavelet variance at one sample is {ratio:.2} times the model's"
            ),
            Flag::Undetermined => {
                "the likelihood is flat in some direction: no standard errors".into()
            }
            Flag::NotConverged => NOT_CONVERGED.into(),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::{
        normality::Quantisation,
        screening::{Motion, Outlier, Saturation},
        temperature::TemperatureError,
    };

    fn nothing() -> Screened {
        Screened {
            mean: 0.0,
            removed: super::super::Detrend::Constant,
            temperature: None,
            cleaned: Vec::new(),
            bridged: Vec::new(),
            outliers: Vec::new(),
            missing: 0,
            motion: None,
            saturation: Vec::new(),
            hanging: Vec::new(),
            threshold: 8.0,
            quantisation: None,
            before_rounding: None,
            noise_shown: None,
            coarse: false,
        }
    }

    /// The only remark on a record of 2000 samples at 50 Hz.
    fn only(of: Screened) -> String {
        let remarks = of_record(&of, 2000, 50.0);
        assert_eq!(remarks.len(), 1, "{remarks:?}");
        remarks[0].clone()
    }

    #[test]
    fn what_was_seen_of_a_record_is_said_with_its_time_and_its_share() {
        assert!(of_record(&nothing(), 2000, 50.0).is_empty());
        let motion = |moving| Motion {
            ratio: 73.25,
            moving_windows: vec![250, 900],
            windows: 39,
            moving,
        };
        let said = only(Screened {
            motion: Some(motion(true)),
            ..nothing()
        });
        assert!(
            said.contains("not static: from 5.0 s on") && said.contains("73.2 times"),
            "{said}"
        );
        let still = Screened {
            motion: Some(motion(false)),
            ..nothing()
        };
        assert!(of_record(&still, 2000, 50.0).is_empty());
        let saturation = vec![Saturation {
            value: 4.5,
            samples: 30,
        }];
        let said = only(Screened {
            saturation,
            ..nothing()
        });
        assert!(
            said.contains("30 samples (1.50 %) are exactly 4.5,"),
            "{said}"
        );
        let stretch = |index, samples| Hanging { index, samples };
        let hanging = vec![stretch(125, 1100), stretch(1500, 300)];
        let said = only(Screened {
            hanging,
            ..nothing()
        });
        assert!(
            said.contains("1100 equal samples from 2.50 s on, 2 such"),
            "{said}"
        );
        let said = only(Screened {
            missing: 15,
            ..nothing()
        });
        assert_eq!(said, "15 samples (0.75 %) are missing");
        let outlier = |index| Outlier {
            index,
            value: 1.0,
            sigmas: 9.0,
        };
        let outliers = vec![outlier(75), outlier(80)];
        let said = only(Screened {
            outliers,
            threshold: 12.0,
            ..nothing()
        });
        assert_eq!(
            said,
            "rejected 2 samples more than 12 robust standard deviations off, the first at 1.50 s"
        );
        let temperature = Some(Err(TemperatureError::Missing));
        let said = only(Screened {
            temperature,
            ..nothing()
        });
        assert_eq!(
            said,
            "the temperature is not used: more than a tenth of the temperatures is missing"
        );
    }

    #[test]
    fn rounding_is_said_where_the_noise_before_it_is_known_or_hidden() {
        let quantisation = Some(Quantisation {
            step: 0.6,
            step_over_deviation: 2.0,
            levels: 5,
        });
        let of = Screened {
            quantisation,
            ..nothing()
        };
        assert!(of_record(&of, 2000, 50.0).is_empty());
        let said = only(Screened {
            before_rounding: Some(0.2),
            ..of
        });
        assert!(
            said.contains("are 3.0 times the noise before rounding"),
            "{said}"
        );
        let said = only(Screened {
            noise_shown: Some(0.25),
            ..nothing()
        });
        assert!(said.contains("it may be 4.0 times what is found"), "{said}");
        let enough = Screened {
            noise_shown: Some(MOSTLY_SHOWN),
            ..nothing()
        };
        assert!(of_record(&enough, 2000, 50.0).is_empty());
    }

    #[test]
    fn a_root_that_is_held_at_one_is_no_finding() {
        let root = Warning::UnitRoot { distance: 1e-3 };
        let free = ArmaFit {
            warnings: vec![root, Warning::FlatLikelihood],
            ..ArmaFit::default()
        };
        assert_eq!(
            of_arma(&free),
            [root.to_string(), Warning::FlatLikelihood.to_string()]
        );
        let held = ArmaFit {
            has_unit_root: true,
            ..free
        };
        assert_eq!(
            of_arma(&held),
            [Warning::FlatLikelihood.to_string(), HELD.to_owned()]
        );
        let mean = ArmaFit {
            ar: vec![0.99],
            ma: vec![0.999_9],
            n: 1000,
            ..ArmaFit::default()
        };
        assert!(mean.is_removed_mean());
        assert_eq!(of_arma(&mean), [MEAN]);
    }
}
