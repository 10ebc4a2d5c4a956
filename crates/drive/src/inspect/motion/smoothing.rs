//! Whether the receiver filters its positions and velocities: a filter does more than a delay.

use super::{At, Inspection, Line, Motion, accuracy};
use crate::{
    drive::Logs,
    navigate::{Wanted, navigate},
};
use undrift_nav::parameters::{Parameter, Prior};
use undrift_noise::BiasModel;
use undrift_results::inspect::Known;

/// Time constant of a filter that is looked for \[s\], one standard deviation.
const LOOKED_FOR: f64 = 0.3;
/// The least that is written \[s\]: it is no more than a prior, and one of zero would be refused.
const LEAST: f64 = 0.1;
/// Standard deviations by which it has to show.
const SHOWN: f64 = 5.0;

/// Writes the time constant of the receiver's filter into the part of the fixes, where positions show one.
pub(super) fn write(inspections: &mut [Inspection], places: [At; 2], logs: Logs, motion: Motion) {
    let [_, (file, part)] = places;
    let Some(mut drive) = accuracy::so_far(inspections, places, logs, motion) else {
        return;
    };
    let prior = Prior::constant(0.5 * LOOKED_FOR * LOOKED_FOR);
    drive.parameters = drive.parameters.with(Parameter::Smoothing, prior);
    let Ok(report) = navigate(&drive, BiasModel::Arma, Wanted::default()) else {
        return;
    };
    let mut estimated = report.summary.parameters.iter();
    let Some((_, value, std)) = estimated.find(|(kind, ..)| *kind == Parameter::Smoothing) else {
        return;
    };
    if value[0] < SHOWN * std[0] {
        return;
    }
    let known = Known::Smooths {
        variance_s2: [value[0], std[0]],
    };
    let lines = &mut inspections[file].parts[part].lines;
    lines.push(Line::new("smoothing", written(value[0]), known));
}

/// The time constant `τ` for a drive file, from `½ τ²` \[s²\].
fn written(variance: f64) -> String {
    format!("{:.1} s", (2.0 * variance).sqrt().max(LEAST))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_short_time_constant_is_not_written_as_none() {
        for (time, text) in [(0.01, "0.1 s"), (0.32, "0.3 s"), (1.5, "1.5 s")] {
            assert_eq!(written(0.5 * time * time), text);
        }
    }
}
