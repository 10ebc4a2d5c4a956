//! The exact sentence of everything that is found of a recording.

use super::*;
use crate::sentence;
use undrift_noise::{
    compared::Unfit,
    drift_score::{Choice, Reason},
    temperature::TemperatureError,
};
use undrift_results::Statement;

#[test]
fn every_remark_on_a_recording_has_its_sentence() {
    use RecordRemark as R;
    for (remark, text) in [
        (
            R::Moving {
                from_s: 5.0,
                ratio: 73.25,
            },
            "the recording is not static: from 5.0 s on, the variance of one-second means is 73.2 times what their noise allows; cut it to where the sensor rests",
        ),
        (
            R::Saturated {
                samples: 30,
                percent: 1.5,
                value: 4.5,
            },
            "the axis is saturated: 30 samples (1.50 %) are exactly 4.5, the end of its range, which clips the noise",
        ),
        (
            R::Frozen {
                samples: 1100,
                from_s: 2.5,
                stretches: 2,
            },
            "the sensor is frozen: 1100 equal samples from 2.50 s on, 2 such stretches in all",
        ),
        (
            R::Coarse { ratio: 3.04 },
            "the steps of the samples are 3.0 times the noise before rounding: the white noise is that of the rounded samples, and a slow error smaller than a step shows only in part, so there are no intervals",
        ),
        (
            R::HiddenNoise { factor: 4.0 },
            "nearly all samples are equal: the mean stays amid a step, which hides the noise; at another mean, as after another switch-on, it may be 4.0 times what is found, and the drift more",
        ),
        (
            R::TemperatureNotUsed(TemperatureError::Missing),
            "the temperature is not used: more than a tenth of the temperatures is missing",
        ),
        (
            R::Missing {
                samples: 15,
                percent: 0.75,
            },
            "15 samples (0.75 %) are missing",
        ),
        (
            R::Outliers {
                samples: 2,
                threshold: 12.0,
                first_s: 1.5,
            },
            "rejected 2 samples more than 12 robust standard deviations off, the first at 1.50 s",
        ),
    ] {
        assert_eq!(sentence(Statement::Record(&remark)), text);
    }
}

#[test]
fn every_remark_on_a_fit_has_its_sentence() {
    use Warning as W;
    let sum = |flag, tau_s| FitRemark::Composite { flag, tau_s };
    let near = |standard_error| W::NearCancelling {
        distance: 1.234e-3,
        standard_error,
    };
    let process = Term::GaussMarkov(1);
    for (remark, text) in [
        (
            FitRemark::Arma(near(Some(5.67e-3))),
            "an autoregressive and a moving-average root nearly cancel: 1.23e-3 apart with a standard error of 5.7e-3",
        ),
        (
            FitRemark::Arma(near(None)),
            "an autoregressive and a moving-average root nearly cancel: 1.23e-3 apart",
        ),
        (
            FitRemark::Arma(W::FlatLikelihood),
            "the likelihood is flat in some direction: the coefficients are poorly determined, but their predictions are not",
        ),
        (
            FitRemark::Arma(W::UnitRoot { distance: 1.2e-5 }),
            "an autoregressive root is indistinguishable from 1 (1.2e-5 away): effectively a random walk",
        ),
        (
            FitRemark::Arma(W::MovingAverageUnitRoot { distance: 3.4e-5 }),
            "a moving-average root is indistinguishable from the unit circle (3.4e-5 away)",
        ),
        (
            FitRemark::Arma(W::NoStandardErrors),
            "no standard errors: the likelihood is singular at its maximum",
        ),
        (
            FitRemark::Arma(W::NotConverged),
            "the search stopped before reaching its tolerance",
        ),
        (
            FitRemark::Arma(W::ShortRecord),
            "fewer than ten samples per parameter",
        ),
        (
            FitRemark::UnitRootHeld,
            "one autoregressive root is held at 1",
        ),
        (
            FitRemark::RemovedMean,
            "a pair of roots stands for the mean that was removed, so it is not recommended",
        ),
        (
            sum(Flag::Vanished(Term::RandomWalk), None),
            "the likelihood does not support the random walk",
        ),
        (
            sum(Flag::Vanished(process), None),
            "the likelihood does not support a Gauss-Markov process",
        ),
        (
            sum(Flag::NotNeeded(process), Some(70.25)),
            "the Gauss-Markov process of 70.250 s is not needed at the 5 % level",
        ),
        (
            sum(Flag::NotNeeded(Term::Quantisation), None),
            "the quantisation is not needed at the 5 % level",
        ),
        (
            sum(Flag::LongCorrelation(0), Some(300.0)),
            "the Gauss-Markov process of 300.000 s is effectively a random walk: its correlation time exceeds a tenth of the recording",
        ),
        (
            sum(Flag::ShortMemory(1.256), None),
            "short-term correlation that this model does not describe: the wavelet variance at one sample is 1.26 times the model's",
        ),
        (
            sum(Flag::Undetermined, None),
            "the likelihood is flat in some direction: no standard errors",
        ),
        (
            sum(Flag::NotConverged, None),
            "the search stopped before reaching its tolerance",
        ),
    ] {
        assert_eq!(sentence(Statement::Fit(&remark)), text);
    }
}

#[test]
fn a_method_without_a_model_and_a_choice_have_their_reasons() {
    assert_eq!(
        sentence(Statement::NotFitted(&Unfit::White)),
        "it sees white noise alone"
    );
    let reason = Reason {
        name: "white".into(),
        states: 0,
        parameters: 1,
        horizons_s: vec![1.0, 10.0],
        choice: Choice::LeastDrift,
    };
    assert_eq!(
        sentence(Statement::Recommended(&reason)),
        "white (0 states, 1 parameter) drifts least at 1, 10 s, and no simpler candidate is as likely."
    );
}

/// A verdict of tests that reject or not, and what it says after the numbers.
fn reading(rejects: [bool; 3], conclusion: Conclusion, ma_root: Option<f64>) -> String {
    let [adf, phillips_perron, kpss] = rejects.map(|rejects| Weighed {
        statistic: -3.0,
        critical: -2.9,
        rejects,
    });
    let verdict = Verdict {
        conclusion,
        adf,
        phillips_perron,
        kpss,
        ma_root,
    };
    let said = sentence(Statement::Stationarity(&verdict));
    let numbers =
        "ADF -3.00 (5 % -2.90), Phillips-Perron -3.00 (5 % -2.90), KPSS -3.000 (5 % -2.900)";
    let rest = said.strip_prefix(numbers);
    rest.unwrap_or_else(|| panic!("{said}")).to_owned()
}

#[test]
fn every_conclusion_on_stationarity_has_its_sentence() {
    use Conclusion as C;
    for (rejects, conclusion, text) in [
        (
            [true, true, false],
            C::Stationary,
            ": the unit-root tests reject a unit root; the recording is stationary at this length.",
        ),
        (
            [false, false, true],
            C::UnitRoot,
            ": the unit-root tests do not reject a unit root; the recording has a unit root: difference it.",
        ),
        (
            [false; 3],
            C::Undecided,
            ": the unit-root tests do not reject a unit root; neither hypothesis is rejected: the recording is too short to decide.",
        ),
        (
            [true; 3],
            C::Conflict,
            ": the unit-root tests reject a unit root; both hypotheses are rejected: a slow bias below white noise, long memory or a break; fit a model and check its moving-average root.",
        ),
        (
            [true, false, true],
            C::Conflict,
            ": the unit-root tests disagree (Dickey-Fuller rejects, Phillips-Perron accepts) and KPSS rejects stationarity: do not rely on a single one.",
        ),
        (
            [false, true, false],
            C::Conflict,
            ": the unit-root tests disagree (Dickey-Fuller accepts, Phillips-Perron rejects) and KPSS does not reject stationarity: do not rely on a single one.",
        ),
    ] {
        assert_eq!(reading(rejects, conclusion, None), text);
    }
    let without_information = ". With a moving-average root of 0.8100, Dickey-Fuller and Phillips-Perron reject a unit root whether or not there is one, so they carry no information here; ";
    for (seen, conclusion, rest) in [
        (
            true,
            C::SlowPartSeen,
            "KPSS rejects stationarity: there is a slow part; the fitted model shows whether it is a random walk or has a correlation time.",
        ),
        (
            false,
            C::NothingSlowSeen,
            "KPSS does not reject stationarity: no slow part is detected at this length.",
        ),
    ] {
        assert_eq!(
            reading([true, true, seen], conclusion, Some(0.81)),
            format!("{without_information}{rest}")
        );
    }
}
