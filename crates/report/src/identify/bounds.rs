//! Parameters of a recommended model with their intervals.

use super::units;
use crate::numbers::short;
use undrift_results::{Axis, Number, ParameterInterval};

/// What the record says of the parameters of an axis' model, each with its unit and factor from SI.
pub(crate) fn bounds(name: &str, axis: &Axis) -> Vec<Bound> {
    let units = units(name);
    let bound = |found: &ParameterInterval| {
        let (unit, factor) = match found.parameter.chars().next() {
            Some('N') => units.white,
            Some('K') => units.walk,
            Some('Q') => units.rounding,
            Some('τ') => ("s", 1.0),
            _ => units.bias,
        };
        let end = |end: Number| end.get().filter(|end| *end > 0.0).map(|end| end * factor);
        Bound {
            parameter: found.parameter.clone(),
            unit,
            estimate: found.estimate.0 * factor,
            low: end(found.low),
            high: end(found.high),
        }
    };
    axis.intervals.iter().map(bound).collect()
}

/// A parameter and its 95 % interval; an end that is missing is not bounded by the record.
pub(crate) struct Bound {
    pub parameter: String,
    pub unit: &'static str,
    pub estimate: f64,
    pub low: Option<f64>,
    pub high: Option<f64>,
}

impl Bound {
    /// "1.2 to 3.4", "above 1.2", "below 3.4" or "anything".
    pub(crate) fn interval(&self) -> String {
        match (self.low, self.high) {
            (Some(low), Some(high)) => format!("{} to {}", short(low), short(high)),
            (Some(low), None) => format!("above {}", short(low)),
            (None, Some(high)) => format!("below {}", short(high)),
            (None, None) => "not determined".to_owned(),
        }
    }
}
