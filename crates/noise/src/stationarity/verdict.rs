//! The three tests weighed in one sentence.

use super::{Adf, Kpss, PhillipsPerron};

/// A moving-average root from which on Dickey-Fuller and Phillips-Perron reject a true unit root most
/// of the time (Schwert 1989, table 6: at 0.8 already in 30 to 100 % of series).
const NEAR_CANCELLING: f64 = 0.8;

/// Conclusion of the three tests together at 5 %.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Conclusion {
    /// The unit root is rejected and stationarity is not.
    Stationary,
    /// Stationarity is rejected and the unit root is not.
    UnitRoot,
    /// Both are rejected: white noise hides a slow bias, or memory is long.
    Conflict,
    /// Neither is rejected: the recording is too short to decide.
    Undecided,
    /// A moving-average root near 1 makes the unit-root tests uninformative, and KPSS detects no slow part.
    NothingSlowSeen,
    /// A moving-average root near 1 makes the unit-root tests uninformative, and KPSS detects a slow part:
    /// a unit root or a long correlation time, which no test distinguishes.
    SlowPartSeen,
}

/// The conclusion and the sentence to print.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// Conclusion of the tests together.
    pub conclusion: Conclusion,
    /// The reasoning in one or two sentences.
    pub sentence: String,
}

/// Weighs the tests at 5 %. `ma_root` is the largest inverse root of the moving-average part where a
/// model has been fitted (θ of an ARMA(1,1), sign of docs/theory.md, section 1); near 1 it makes augmented
/// Dickey-Fuller and Phillips-Perron reject a unit root that is there.
pub fn verdict(
    adf: &Adf,
    kpss: &Kpss,
    phillips_perron: &PhillipsPerron,
    ma_root: Option<f64>,
) -> Verdict {
    let adf_rejects = adf.statistic < adf.critical.five;
    let pp_rejects = phillips_perron.z_tau < phillips_perron.critical.five;
    let kpss_rejects = kpss.statistic > kpss.critical.five;
    let word = |rejects: bool| if rejects { "reject" } else { "do not reject" };
    let numbers = format!(
        "ADF {:.2} (5 % {:.2}), Phillips-Perron {:.2} (5 % {:.2}), KPSS {:.3} (5 % {:.3})",
        adf.statistic,
        adf.critical.five,
        phillips_perron.z_tau,
        phillips_perron.critical.five,
        kpss.statistic,
        kpss.critical.five
    );
    if let Some(root) = ma_root.filter(|root| *root > NEAR_CANCELLING) {
        let (conclusion, rest) = if kpss_rejects {
            let rest = "KPSS rejects stationarity: there is a slow part; the fitted model shows whether it is a \
                        random walk or has a correlation time";
            (Conclusion::SlowPartSeen, rest)
        } else {
            let rest = "KPSS does not reject stationarity: no slow part is detected at this length";
            (Conclusion::NothingSlowSeen, rest)
        };
        let sentence = format!(
            "{numbers}. With a moving-average root of {root:.4}, Dickey-Fuller and Phillips-Perron reject a unit root \
             whether or not there is one, so they carry no information here; {rest}."
        );
        return Verdict {
            conclusion,
            sentence,
        };
    }
    let finds = |rejects: bool| if rejects { "rejects" } else { "accepts" };
    let disagree = format!(
        "the unit-root tests disagree (Dickey-Fuller {}, Phillips-Perron {}) and KPSS {} stationarity: do not rely on a single one",
        finds(adf_rejects),
        finds(pp_rejects),
        if kpss_rejects {
            "rejects"
        } else {
            "does not reject"
        }
    );
    let (conclusion, reading) = match (adf_rejects, pp_rejects, kpss_rejects) {
        (true, true, false) => (
            Conclusion::Stationary,
            "the recording is stationary at this length",
        ),
        (false, false, true) => (
            Conclusion::UnitRoot,
            "the recording has a unit root: difference it",
        ),
        (false, false, false) => (
            Conclusion::Undecided,
            "neither hypothesis is rejected: the recording is too short to decide",
        ),
        (true, true, true) => (
            Conclusion::Conflict,
            "both hypotheses are rejected: a slow bias below white noise, long memory or a break; fit a model and \
             check its moving-average root",
        ),
        _ => (Conclusion::Conflict, disagree.as_str()),
    };
    let both = if adf_rejects == pp_rejects {
        format!("the unit-root tests {} a unit root; ", word(adf_rejects))
    } else {
        String::new()
    };
    Verdict {
        conclusion,
        sentence: format!("{numbers}: {both}{reading}."),
    }
}

#[cfg(test)]
mod tests {
    use super::super::Critical;
    use super::*;

    fn judged(
        adf_rejects: bool,
        pp_rejects: bool,
        kpss_rejects: bool,
        root: Option<f64>,
    ) -> Verdict {
        // Between the critical values of 5 % and of the others, which decide nothing.
        let critical = |five: f64| Critical {
            one: 2.0 * five,
            five,
            ten: 0.5 * five,
        };
        let adf = Adf {
            statistic: if adf_rejects { -3.0 } else { -2.8 },
            critical: critical(-2.9),
            ..Adf::default()
        };
        let perron = PhillipsPerron {
            z_tau: if pp_rejects { -3.0 } else { -2.8 },
            critical: critical(-2.9),
            ..PhillipsPerron::default()
        };
        let kpss = Kpss {
            statistic: if kpss_rejects { 0.5 } else { 0.4 },
            critical: critical(0.46),
            ..Kpss::default()
        };
        verdict(&adf, &kpss, &perron, root)
    }

    #[test]
    fn every_combination_of_the_tests_has_its_conclusion() {
        use Conclusion::*;
        for (adf, pp, kpss, expected, word) in [
            (
                true,
                true,
                false,
                Stationary,
                "tests reject a unit root; the recording is stationary",
            ),
            (
                false,
                false,
                true,
                UnitRoot,
                "tests do not reject a unit root; the recording has",
            ),
            (
                false,
                false,
                false,
                Undecided,
                "tests do not reject a unit root; neither",
            ),
            (true, true, true, Conflict, "tests reject a unit root; both"),
            (
                true,
                false,
                true,
                Conflict,
                "(Dickey-Fuller rejects, Phillips-Perron accepts) and KPSS rejects",
            ),
            (
                false,
                true,
                true,
                Conflict,
                "(Dickey-Fuller accepts, Phillips-Perron rejects) and KPSS rejects",
            ),
            (true, false, false, Conflict, "and KPSS does not reject"),
            (false, true, false, Conflict, "and KPSS does not reject"),
        ] {
            // A root of no more than 0.8 leaves the tests their say.
            for root in [None, Some(0.8), Some(-0.99)] {
                let found = judged(adf, pp, kpss, root);
                assert_eq!(found.conclusion, expected);
                assert!(found.sentence.contains(word), "{}", found.sentence);
                assert_eq!(found.sentence.contains("disagree"), adf != pp);
            }
            let seen = if kpss { SlowPartSeen } else { NothingSlowSeen };
            let found = judged(adf, pp, kpss, Some(0.81));
            assert_eq!(found.conclusion, seen);
            assert!(found.sentence.contains("no information") && found.sentence.contains("0.8100"));
        }
    }
}
