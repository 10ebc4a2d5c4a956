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
