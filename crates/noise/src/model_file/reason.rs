//! The reason that a model file has for its model.

use crate::drift_score::{Choice, Reason};

/// Why a candidate was recommended, for the key `reason` of a model file: one sentence.
///
/// ```
/// use undrift_noise::{drift_score::{Choice, Reason}, model_file::reason};
/// let why = Reason {
///     name: "ARMA(1,1)".into(),
///     states: 1,
///     parameters: 4,
///     horizons_s: vec![10.0, 60.0],
///     choice: Choice::LeastDrift,
/// };
/// assert_eq!(reason(&why), "ARMA(1,1) (1 state, 4 parameters) drifts least at 10, 60 s, and no simpler candidate is as likely.");
/// ```
pub fn reason(of: &Reason) -> String {
    let counted = |n: usize, what: &str| match n {
        1 => format!("1 {what}"),
        _ => format!("{n} {what}s"),
    };
    let states = counted(of.states, "state");
    let parameters = counted(of.parameters, "parameter");
    let name = format!("{} ({states}, {parameters})", of.name);
    let span = Vec::from_iter(of.horizons_s.iter().map(f64::to_string)).join(", ");
    match of.choice {
        Choice::LeastDrift => {
            format!("{name} drifts least at {span} s, and no simpler candidate is as likely.")
        }
        Choice::Simplest { excess_percent } => format!(
            "{name} is the simplest of the likeliest candidates whose drift at {span} s is within the sampling error of the least (at most {excess_percent:.1} % above it)."
        ),
        Choice::Average { models } => format!(
            "{name} has the mean spectrum of {models} models, each with its Akaike weight: the recording does not tell them apart, and they expect other drifts."
        ),
        Choice::LeastExcess { excess_percent } => format!(
            "No candidate is within the sampling error of the least drift at all of {span} s; {name} has the smallest excess, at most {excess_percent:.1} %."
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reason_is_a_sentence_with_the_size_of_the_model_and_the_horizons() {
        let with = |states, choice| {
            reason(&Reason {
                name: "white".into(),
                states,
                parameters: 1,
                horizons_s: vec![1.0, 10.0],
                choice,
            })
        };
        assert_eq!(
            with(2, Choice::LeastDrift),
            "white (2 states, 1 parameter) drifts least at 1, 10 s, and no simpler candidate is as likely."
        );
        let excess_percent = 2.345;
        assert_eq!(
            with(0, Choice::Simplest { excess_percent }),
            "white (0 states, 1 parameter) is the simplest of the likeliest candidates whose drift at 1, 10 s is within the sampling error of the least (at most 2.3 % above it)."
        );
        assert_eq!(
            with(3, Choice::Average { models: 4 }),
            "white (3 states, 1 parameter) has the mean spectrum of 4 models, each with its Akaike weight: the recording does not tell them apart, and they expect other drifts."
        );
        assert_eq!(
            with(1, Choice::LeastExcess { excess_percent }),
            "No candidate is within the sampling error of the least drift at all of 1, 10 s; white (1 state, 1 parameter) has the smallest excess, at most 2.3 %."
        );
    }
}
