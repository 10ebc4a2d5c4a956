//! Comments of exported files: what was derived or left out of a model.
//!
//! One sentence a remark, with the axis or sensor in front. They are for whoever opens the file of another
//! program a year later.
//!
//! The comment sign is put in front by the format ([`super::formats`]), which makes one line of each.
//! Numbers have three digits and units; names of axes are those of the model file.

use super::equivalent::Remark;
use super::nearest::TIMES_S;
use crate::bias_model::{HORIZON, SLOW};
use undrift_base::number::rounded;

/// A comment, a sentence or two, on an axis or sensor of this name.
pub(super) fn comment((name, remark): &(&str, Remark)) -> String {
    let what = match remark {
        Remark::Undetected { length } => format!(
            "no slow bias was detected in {length:.0} s of recording. The random walk is the largest that could go undetected, 10 √3 N / T: an upper bound, which a longer recording lowers."
        ),
        Remark::FastBias(taus) => format!(
            "a bias of less than {SLOW} s of correlation time ({}) counts as white noise.",
            list(taus, "s")
        ),
        Remark::WalkAlone { outage_s, factors } => format!(
            "its bias is not a random walk. The one used is the best for an outage of {} s: after it a filter's standard deviation is {} its error, after ten times as long {}.",
            rounded(*outage_s, 3),
            times(factors[0]),
            times(factors[1])
        ),
        Remark::Nearest { factor } => format!(
            "its bias is not what the program draws. Simulated noise has an Allan deviation within a factor of {} of the model's from {} to {} s.",
            rounded(*factor, 3),
            TIMES_S[0],
            TIMES_S[1]
        ),
        Remark::JoinedBias => format!(
            "its Gauss-Markov processes but the slowest count as a random walk, which has their variance after {HORIZON} s."
        ),
        Remark::Quantisation => "its quantisation is omitted.".into(),
        Remark::Temperature => {
            "the bias over temperature is omitted: subtract it from the samples first.".into()
        }
        Remark::Lines(frequencies) => format!(
            "its lines and narrow resonances are omitted: {}.",
            list(frequencies, "Hz")
        ),
        Remark::ExactSum => "the terms whose sum is exactly its ARMA(1,1).".into(),
        Remark::SlowPoles => "the bias is the slow poles of its ARMA; white noise is the density at low frequencies of all others.".into(),
        Remark::ComplexPoles(frequencies) => format!(
            "complex poles of its ARMA are no bias and are omitted beyond that: {}.",
            list(frequencies, "Hz")
        ),
        Remark::FastPoles(taus) => format!(
            "poles of its ARMA with less than {SLOW} s of correlation time are no bias and are omitted beyond that: {}.",
            list(taus, "s")
        ),
        Remark::JoinedPoles => "the slow poles of its ARMA are no sum of Gauss-Markov processes; over short times they are the random walk used.".into(),
        Remark::Innovations => "without its bias its ARMA has no noise at low frequencies; its innovations serve as white noise.".into(),
    };
    format!("{name}: {what}")
}

/// "1.3 times".
///
/// One decimal: factors here are estimates.
fn times(factor: f64) -> String {
    format!("{factor:.1} times")
}

/// Three digits each, with the unit.
///
/// Separated by commas, as in a sentence.
fn list(values: &[f64], unit: &str) -> String {
    let values = values.iter();
    let values = values.map(|value| format!("{} {unit}", rounded(*value, 3)));
    Vec::from_iter(values).join(", ")
}
