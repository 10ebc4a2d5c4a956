//! The three tests weighed together.
//!
//! | unit root rejected (ADF and PP) | stationarity rejected (KPSS) | conclusion |
//! |---|---|---|
//! | yes | no | stationary |
//! | no | yes | unit root |
//! | no | no | undecided: too short |
//! | yes | yes | conflict |
//! | by one of the two | yes or no | conflict |
//! | a moving-average root above 0.8 | no | nothing slow seen |
//! | a moving-average root above 0.8 | yes | slow part seen |

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

/// A statistic against its critical value at 5 %.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weighed {
    /// The statistic.
    pub statistic: f64,
    /// Its critical value at 5 %.
    pub critical: f64,
    /// Whether the test rejects what it assumes: a unit root, for KPSS stationarity.
    pub rejects: bool,
}

/// The three tests weighed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Verdict {
    /// Conclusion of the tests together.
    pub conclusion: Conclusion,
    /// Augmented Dickey-Fuller.
    pub adf: Weighed,
    /// Phillips-Perron.
    pub phillips_perron: Weighed,
    /// KPSS.
    pub kpss: Weighed,
    /// The moving-average root, where it is so near 1 that the unit-root tests carry no information.
    pub ma_root: Option<f64>,
}

/// Weighs the tests at 5 %. `ma_root` is the largest inverse root of the moving-average part where a
/// model has been fitted (θ of an ARMA(1,1), sign of docs/theory.md, section 1); near 1 it makes augmented
/// Dickey-Fuller and Phillips-Perron reject a unit root that is there.
///
/// ```
/// use undrift_noise::stationarity::{Adf, Conclusion, Critical, Kpss, PhillipsPerron, verdict};
/// let critical = Critical { one: -3.43, five: -2.86, ten: -2.57 };
/// let adf = Adf { statistic: -9.0, critical, ..Adf::default() };
/// let corrected = PhillipsPerron { z_tau: -40.0, critical, ..PhillipsPerron::default() };
/// let kpss = Kpss { statistic: 0.9, critical: Critical { one: 0.739, five: 0.463, ten: 0.347 }, ..Kpss::default() };
/// // All three reject. With θ = 0.999 the first two would reject a random walk as well: KPSS alone counts.
/// assert_eq!(verdict(&adf, &kpss, &corrected, None).conclusion, Conclusion::Conflict);
/// assert_eq!(verdict(&adf, &kpss, &corrected, Some(0.999)).conclusion, Conclusion::SlowPartSeen);
/// ```
pub fn verdict(
    adf: &Adf,
    kpss: &Kpss,
    phillips_perron: &PhillipsPerron,
    ma_root: Option<f64>,
) -> Verdict {
    let unit_root = |statistic: f64, critical: f64| Weighed {
        statistic,
        critical,
        rejects: statistic < critical,
    };
    let adf = unit_root(adf.statistic, adf.critical.five);
    let phillips_perron = unit_root(phillips_perron.z_tau, phillips_perron.critical.five);
    let kpss = Weighed {
        statistic: kpss.statistic,
        critical: kpss.critical.five,
        rejects: kpss.statistic > kpss.critical.five,
    };
    let ma_root = ma_root.filter(|root| *root > NEAR_CANCELLING);
    let conclusion = match (adf.rejects, phillips_perron.rejects, kpss.rejects) {
        (_, _, true) if ma_root.is_some() => Conclusion::SlowPartSeen,
        (_, _, false) if ma_root.is_some() => Conclusion::NothingSlowSeen,
        (true, true, false) => Conclusion::Stationary,
        (false, false, true) => Conclusion::UnitRoot,
        (false, false, false) => Conclusion::Undecided,
        _ => Conclusion::Conflict,
    };
    Verdict {
        conclusion,
        adf,
        phillips_perron,
        kpss,
        ma_root,
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
        for (adf, pp, kpss, expected) in [
            (true, true, false, Stationary),
            (false, false, true, UnitRoot),
            (false, false, false, Undecided),
            (true, true, true, Conflict),
            (true, false, true, Conflict),
            (false, true, true, Conflict),
            (true, false, false, Conflict),
            (false, true, false, Conflict),
        ] {
            // A root of no more than 0.8 leaves the tests their say.
            for root in [None, Some(0.8), Some(-0.99)] {
                let found = judged(adf, pp, kpss, root);
                assert_eq!(found.conclusion, expected);
                let rejects = [found.adf, found.phillips_perron, found.kpss].map(|of| of.rejects);
                assert_eq!((rejects, found.ma_root), ([adf, pp, kpss], None));
            }
            let seen = if kpss { SlowPartSeen } else { NothingSlowSeen };
            let found = judged(adf, pp, kpss, Some(0.81));
            assert_eq!(found.conclusion, seen);
            assert_eq!(found.ma_root, Some(0.81));
        }
    }
}
