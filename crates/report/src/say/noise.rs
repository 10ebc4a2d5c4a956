//! Sentences: static recordings and the models fitted to them.

use undrift_noise::{
    arma::Warning,
    composite::{Flag, Term},
    identify::{FitRemark, RecordRemark},
    stationarity::{Conclusion, Verdict, Weighed},
};

/// What should be said with a recording.
pub(crate) fn record(of: &RecordRemark) -> String {
    use RecordRemark as R;
    match of {
        R::Moving { from_s, ratio } => format!(
            "the recording is not static: from {from_s:.1} s on, the variance of one-second means is {ratio:.1} times what their noise allows; cut it to where the sensor rests"
        ),
        R::Saturated {
            samples,
            percent,
            value,
        } => format!(
            "the axis is saturated: {samples} samples ({percent:.2} %) are exactly {value}, the end of its range, which clips the noise"
        ),
        R::Frozen {
            samples,
            from_s,
            stretches,
        } => format!(
            "the sensor is frozen: {samples} equal samples from {from_s:.2} s on, {stretches} such stretches in all"
        ),
        R::Coarse { ratio } => format!(
            "the steps of the samples are {ratio:.1} times the noise before rounding: the white noise is that of the rounded samples, and a slow error smaller than a step shows only in part, so there are no intervals"
        ),
        R::HiddenNoise { factor } => format!(
            "nearly all samples are equal: the mean stays amid a step, which hides the noise; at another mean, as after another switch-on, it may be {factor:.1} times what is found, and the drift more"
        ),
        R::TemperatureNotUsed(why) => format!("the temperature is not used: {why}"),
        R::Missing { samples, percent } => {
            format!("{samples} samples ({percent:.2} %) are missing")
        }
        R::Outliers {
            samples,
            threshold,
            first_s,
        } => format!(
            "rejected {samples} samples more than {threshold:.0} robust standard deviations off, the first at {first_s:.2} s"
        ),
    }
}

/// What should be said with a model fitted to it.
pub(crate) fn fit(of: &FitRemark) -> String {
    match of {
        FitRemark::Arma(warning) => arma(warning),
        FitRemark::UnitRootHeld => "one autoregressive root is held at 1".into(),
        FitRemark::RemovedMean => {
            "a pair of roots stands for the mean that was removed, so it is not recommended".into()
        }
        FitRemark::Composite { flag, tau_s } => composite(*flag, *tau_s),
    }
}

const NOT_CONVERGED: &str = "the search stopped before reaching its tolerance";

/// What should be said with an ARMA fit.
pub fn arma(of: &Warning) -> String {
    match of {
        Warning::NearCancelling {
            distance,
            standard_error: Some(error),
        } => format!(
            "an autoregressive and a moving-average root nearly cancel: {distance:.2e} apart with a standard error of {error:.1e}"
        ),
        Warning::NearCancelling { distance, .. } => format!(
            "an autoregressive and a moving-average root nearly cancel: {distance:.2e} apart"
        ),
        Warning::FlatLikelihood => "the likelihood is flat in some direction: the coefficients are poorly determined, but their predictions are not".into(),
        Warning::UnitRoot { distance } => format!(
            "an autoregressive root is indistinguishable from 1 ({distance:.1e} away): effectively a random walk"
        ),
        Warning::MovingAverageUnitRoot { distance } => format!(
            "a moving-average root is indistinguishable from the unit circle ({distance:.1e} away)"
        ),
        Warning::NoStandardErrors => {
            "no standard errors: the likelihood is singular at its maximum".into()
        }
        Warning::NotConverged => NOT_CONVERGED.into(),
        Warning::ShortRecord => "fewer than ten samples per parameter".into(),
    }
}

fn composite(flag: Flag, tau_s: Option<f64>) -> String {
    let process = || match tau_s {
        Some(tau_s) => format!("the Gauss-Markov process of {tau_s:.3} s"),
        None => "a Gauss-Markov process".to_owned(),
    };
    let named = |term| match term {
        Term::White => "the white noise".to_owned(),
        Term::Quantisation => "the quantisation".to_owned(),
        Term::RandomWalk => "the random walk".to_owned(),
        Term::Flicker => "the flicker noise".to_owned(),
        Term::GaussMarkov(_) => process(),
    };
    match flag {
        Flag::Vanished(term) => format!("the likelihood does not support {}", named(term)),
        Flag::NotNeeded(term) => format!("{} is not needed at the 5 % level", named(term)),
        Flag::LongCorrelation(_) => format!(
            "{} is effectively a random walk: its correlation time exceeds a tenth of the recording",
            process()
        ),
        Flag::ShortMemory(ratio) => format!(
            "short-term correlation that this model does not describe: the wavelet variance at one sample is {ratio:.2} times the model's"
        ),
        Flag::Undetermined => "the likelihood is flat in some direction: no standard errors".into(),
        Flag::NotConverged => NOT_CONVERGED.into(),
    }
}

/// Whether a recording is stationary, in one or two sentences.
pub fn stationarity(of: &Verdict) -> String {
    let Verdict {
        adf,
        phillips_perron,
        kpss,
        ..
    } = of;
    let numbers = format!(
        "ADF {:.2} (5 % {:.2}), Phillips-Perron {:.2} (5 % {:.2}), KPSS {:.3} (5 % {:.3})",
        adf.statistic,
        adf.critical,
        phillips_perron.statistic,
        phillips_perron.critical,
        kpss.statistic,
        kpss.critical
    );
    if let Some(root) = of.ma_root {
        let rest = match kpss.rejects {
            true => {
                "KPSS rejects stationarity: there is a slow part; the fitted model shows whether it is a random walk or has a correlation time"
            }
            false => "KPSS does not reject stationarity: no slow part is detected at this length",
        };
        return format!(
            "{numbers}. With a moving-average root of {root:.4}, Dickey-Fuller and Phillips-Perron reject a unit root whether or not there is one, so they carry no information here; {rest}."
        );
    }
    if adf.rejects != phillips_perron.rejects {
        let finds = |test: &Weighed| if test.rejects { "rejects" } else { "accepts" };
        let of_kpss = if kpss.rejects {
            "rejects"
        } else {
            "does not reject"
        };
        return format!(
            "{numbers}: the unit-root tests disagree (Dickey-Fuller {}, Phillips-Perron {}) and KPSS {of_kpss} stationarity: do not rely on a single one.",
            finds(adf),
            finds(phillips_perron)
        );
    }
    let reject = if adf.rejects {
        "reject"
    } else {
        "do not reject"
    };
    let reading = match of.conclusion {
        Conclusion::Stationary => "the recording is stationary at this length",
        Conclusion::UnitRoot => "the recording has a unit root: difference it",
        Conclusion::Undecided => {
            "neither hypothesis is rejected: the recording is too short to decide"
        }
        // The others have a moving-average root.
        Conclusion::Conflict | Conclusion::NothingSlowSeen | Conclusion::SlowPartSeen => {
            "both hypotheses are rejected: a slow bias below white noise, long memory or a break; fit a model and check its moving-average root"
        }
    };
    format!("{numbers}: the unit-root tests {reject} a unit root; {reading}.")
}

#[cfg(test)]
mod tests;
