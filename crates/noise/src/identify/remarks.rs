//! What should be said with a record and with a fit, as values: `undrift-report` has their sentences.

use super::screened::Screened;
use crate::{
    arma::{ArmaFit, Warning},
    composite::{CompositeFit, Flag, GaussMarkov, Term},
    screening::{Hanging, rounding::MOSTLY_SHOWN},
    temperature::TemperatureError,
};

/// What should be said with a record.
///
/// None of them stops identification; what does is an [`IdentifyError`](super::IdentifyError).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RecordRemark {
    /// The recording is not static.
    Moving {
        /// Start of the first window that moves \[s\].
        from_s: f64,
        /// Variance of one-second means over what their noise allows.
        ratio: f64,
    },
    /// Samples pile up at an end of the axis' range, which clips the noise.
    Saturated {
        /// Samples at that end.
        samples: usize,
        /// Their share of the record \[%\].
        percent: f64,
        /// The end of the range \[unit\].
        value: f64,
    },
    /// The sensor repeats a value.
    Frozen {
        /// Equal samples of the first such stretch.
        samples: usize,
        /// Its start \[s\].
        from_s: f64,
        /// Such stretches.
        stretches: usize,
    },
    /// The steps of the samples are larger than the noise: a slow error smaller than a step shows only in part.
    Coarse {
        /// Step over the standard deviation before rounding.
        ratio: f64,
    },
    /// Nearly all samples are equal: the mean stays amid a step, which hides the noise.
    HiddenNoise {
        /// How many times the noise that is found it may be at another mean.
        factor: f64,
    },
    /// The temperature is not used.
    TemperatureNotUsed(TemperatureError),
    /// Samples are missing.
    Missing {
        /// How many.
        samples: usize,
        /// Their share of the record \[%\].
        percent: f64,
    },
    /// Outliers were rejected.
    Outliers {
        /// How many.
        samples: usize,
        /// How far off they are at least, in robust standard deviations.
        threshold: f64,
        /// Time of the first \[s\].
        first_s: f64,
    },
}

/// What should be said with a fitted model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FitRemark {
    /// Of an ARMA fit.
    Arma(Warning),
    /// One autoregressive root is held at 1.
    UnitRootHeld,
    /// A pair of roots is the mean that was removed ([`ArmaFit::is_removed_mean`]), so the model is not recommended.
    RemovedMean,
    /// Of a sum of terms.
    Composite {
        /// What.
        flag: Flag,
        /// Correlation time of the Gauss-Markov process that it is of, where there is one in the result \[s\].
        tau_s: Option<f64>,
    },
}

/// Remarks on a record of `samples` at `rate_hz`.
pub(super) fn of_record(of: &Screened, samples: usize, rate_hz: f64) -> Vec<RecordRemark> {
    let mut remarks = Vec::new();
    let second = |index: usize| index as f64 / rate_hz;
    let percent = |part: usize| 100.0 * part as f64 / samples as f64;
    if let Some(motion) = of.motion.as_ref().filter(|m| m.moving) {
        let first = motion.moving_windows.first().copied().unwrap_or(0);
        remarks.push(RecordRemark::Moving {
            from_s: second(first),
            ratio: motion.ratio,
        });
    }
    remarks.extend(of.saturation.iter().map(|stop| RecordRemark::Saturated {
        samples: stop.samples,
        percent: percent(stop.samples),
        value: stop.value,
    }));
    if let Some(&Hanging { index, samples }) = of.hanging.first() {
        remarks.push(RecordRemark::Frozen {
            samples,
            from_s: second(index),
            stretches: of.hanging.len(),
        });
    }
    if let (Some(grid), Some(deviation)) = (of.quantisation, of.before_rounding) {
        let ratio = grid.step / deviation;
        remarks.push(RecordRemark::Coarse { ratio });
    }
    if let Some(shown) = of.noise_shown.filter(|shown| *shown < MOSTLY_SHOWN) {
        let factor = 1.0 / shown;
        remarks.push(RecordRemark::HiddenNoise { factor });
    }
    if let Some(Err(why)) = &of.temperature {
        remarks.push(RecordRemark::TemperatureNotUsed(*why));
    }
    if of.missing > 0 {
        remarks.push(RecordRemark::Missing {
            samples: of.missing,
            percent: percent(of.missing),
        });
    }
    if let Some(first) = of.outliers.first() {
        remarks.push(RecordRemark::Outliers {
            samples: of.outliers.len(),
            threshold: of.threshold,
            first_s: second(first.index),
        });
    }
    remarks
}

/// Remarks on an ARMA fit.
pub(super) fn of_arma(fit: &ArmaFit) -> Vec<FitRemark> {
    let held = fit.has_unit_root.then_some(FitRemark::UnitRootHeld);
    let mean = fit.is_removed_mean().then_some(FitRemark::RemovedMean);
    let warnings = fit.warnings.iter();
    warnings
        // A root held at 1 is no finding.
        .filter(|w| !(fit.has_unit_root && matches!(w, Warning::UnitRoot { .. })))
        .map(|warning| FitRemark::Arma(*warning))
        .chain(held)
        .chain(mean)
        .collect()
}

/// Remarks on a composite fit.
pub(super) fn of_composite(fit: &CompositeFit) -> Vec<FitRemark> {
    of_flags(&fit.flags, &fit.terms.gauss_markov)
}

fn of_flags(flags: &[Flag], processes: &[GaussMarkov]) -> Vec<FitRemark> {
    let tau = |i: usize| {
        let process = processes.get(i);
        process.filter(|of| of.sigma > 0.0).map(|of| of.tau_s)
    };
    let remark = |flag: &Flag| FitRemark::Composite {
        flag: *flag,
        tau_s: match *flag {
            Flag::Vanished(Term::GaussMarkov(i))
            | Flag::NotNeeded(Term::GaussMarkov(i))
            | Flag::LongCorrelation(i) => tau(i),
            _ => None,
        },
    };
    flags.iter().map(remark).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::{
        normality::Quantisation,
        screening::{Motion, Outlier, Saturation},
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
    fn only(of: Screened) -> RecordRemark {
        let remarks = of_record(&of, 2000, 50.0);
        assert_eq!(remarks.len(), 1, "{remarks:?}");
        remarks[0]
    }

    #[test]
    fn what_was_seen_of_a_record_has_its_time_and_its_share() {
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
        let (from_s, ratio) = (5.0, 73.25);
        assert_eq!(said, RecordRemark::Moving { from_s, ratio });
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
        assert_eq!(
            said,
            RecordRemark::Saturated {
                samples: 30,
                percent: 1.5,
                value: 4.5
            }
        );
        let stretch = |index, samples| Hanging { index, samples };
        let hanging = vec![stretch(125, 1100), stretch(1500, 300)];
        let said = only(Screened {
            hanging,
            ..nothing()
        });
        assert_eq!(
            said,
            RecordRemark::Frozen {
                samples: 1100,
                from_s: 2.5,
                stretches: 2
            }
        );
        let said = only(Screened {
            missing: 15,
            ..nothing()
        });
        let (samples, percent) = (15, 0.75);
        assert_eq!(said, RecordRemark::Missing { samples, percent });
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
            RecordRemark::Outliers {
                samples: 2,
                threshold: 12.0,
                first_s: 1.5
            }
        );
        let temperature = Some(Err(TemperatureError::Missing));
        let said = only(Screened {
            temperature,
            ..nothing()
        });
        let why = TemperatureError::Missing;
        assert_eq!(said, RecordRemark::TemperatureNotUsed(why));
    }

    #[test]
    fn rounding_is_remarked_on_where_the_noise_before_it_is_known_or_hidden() {
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
        let ratio = 0.6 / 0.2;
        assert_eq!(said, RecordRemark::Coarse { ratio });
        let said = only(Screened {
            noise_shown: Some(0.25),
            ..nothing()
        });
        assert_eq!(said, RecordRemark::HiddenNoise { factor: 4.0 });
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
        let flat = FitRemark::Arma(Warning::FlatLikelihood);
        assert_eq!(of_arma(&free), [FitRemark::Arma(root), flat]);
        let held = ArmaFit {
            has_unit_root: true,
            ..free
        };
        assert_eq!(of_arma(&held), [flat, FitRemark::UnitRootHeld]);
        let mean = ArmaFit {
            ar: vec![0.99],
            ma: vec![0.999_9],
            n: 1000,
            ..ArmaFit::default()
        };
        assert!(mean.is_removed_mean());
        assert_eq!(of_arma(&mean), [FitRemark::RemovedMean]);
    }

    #[test]
    fn a_remark_on_a_process_has_its_correlation_time_where_it_is_in_the_result() {
        let process = |sigma, tau_s| GaussMarkov { sigma, tau_s };
        let gone = Flag::Vanished(Term::GaussMarkov(0));
        let needless = Flag::NotNeeded(Term::GaussMarkov(1));
        let flags = [gone, needless, Flag::LongCorrelation(1), Flag::Undetermined];
        let taus = [None, Some(70.0), Some(70.0), None];
        let remark = |(flag, tau_s)| FitRemark::Composite { flag, tau_s };
        assert_eq!(
            of_flags(&flags, &[process(0.0, 5.0), process(0.1, 70.0)]),
            flags.into_iter().zip(taus).map(remark).collect::<Vec<_>>()
        );
    }
}
