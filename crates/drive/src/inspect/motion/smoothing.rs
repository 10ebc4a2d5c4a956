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
    let time = (2.0 * value[0]).sqrt();
    let known = Known::Smooths {
        variance_s2: [value[0], std[0]],
    };
    let lines = &mut inspections[file].parts[part].lines;
    lines.push(Line::new("smoothing", format!("{time:.1} s"), known));
}
