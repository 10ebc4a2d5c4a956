//! Where the second antenna of a receiver is, as a drive shows it.

use crate::{
    drive::Drive,
    navigate::{Wanted, navigate},
};
use undrift_nav::{
    earth::wrap_pi,
    parameters::{Parameter, Prior},
};
use undrift_noise::BiasModel;
use undrift_results::inspect::{Known, Line, Part};

/// Standard deviation of a direction that may be any, of one that is known, and of one in motion at the least \[rad\]: the
/// course of a vehicle is not its heading to less than half a degree.
const ANY: f64 = 1.8;
const KNOWN: f64 = 0.1;
const FLOOR: f64 = 0.0087;
/// A direction that is assumed agrees with one of the motion within this \[rad\], or three standard deviations.
const AGREES: f64 = 0.09;

/// Writes the direction that `drive` shows into the part of its headings, where that assumes none or another one.
pub(super) fn write(part: &mut Part, drive: Drive) {
    let Some((angle, std)) = baseline(drive) else {
        return;
    };
    let assumed = part.lines.iter().any(|line| line.key == "baseline");
    if assumed && angle.abs() < AGREES.max(3.0 * std) {
        return;
    }
    let degrees = |angle: f64| format!("{:.1} deg", angle.to_degrees() + 0.0);
    let std_deg = std.to_degrees();
    part.lines.retain(|line| line.key != "baseline");
    part.lines.extend([
        Line::new("baseline", degrees(angle), Known::Antennas { std_deg }),
        Line::new("baseline_std", degrees(std), Known::Antennas { std_deg }),
    ]);
}

/// The direction of the second antenna as seen from the first in the body and its standard deviation \[rad\].
fn baseline(mut drive: Drive) -> Option<(f64, f64)> {
    drive.constraints.heading_baseline = 0.0;
    let any = Prior::constant(ANY);
    drive.parameters = drive.parameters.with(Parameter::HeadingOffset, any);
    let report = navigate(&drive, BiasModel::Arma, Wanted::default()).ok()?;
    let mut estimated = report.summary.parameters.into_iter();
    let (_, value, std) = estimated.find(|(kind, ..)| *kind == Parameter::HeadingOffset)?;
    (std[0] < KNOWN).then(|| (wrap_pi(value[0]), std[0].hypot(FLOOR)))
}
