//! Errors of the sensors' axes. What poses of millimetres show of them would otherwise be found as noise of the sensors: in fast turns a
//! rate about one axis that enters another by half a per cent is a white noise many times that at rest.

use super::{
    Way, first_of,
    fit::{Fit, FitLog, unseen_likelihood},
    noise::Noise,
    rest_noise::RestNoise,
};
use undrift_engine::settings::Settings;
use undrift_nav::parameters::{Parameter, Parameters, Prior as Of};

/// Standard deviations of the misalignment of the sensors' axes \[rad\] and of their scale factors \[–\]: data sheets of consumer's
/// sensors have 1 to 2 % of both.
pub const MISALIGNMENT_DEG: f64 = 0.6;
/// See there.
pub const SCALE_FACTOR: f64 = 0.01;
/// They are estimated where both what the fit has seen and what it has not is likelier by this logarithm with them. The windows overlap,
/// so that it counts what they say two to four times: that is at least 20 to 1.
const LIKELIER: f64 = 12.0;

/// What was tried.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axes {
    /// Whether the scale factors were estimated beside the misalignment.
    pub scale_factors: bool,
    /// By how much the log-likelihood of what the fit has not seen is larger with them.
    pub gain: f64,
    /// Whether they are estimated from now on.
    pub kept: bool,
}

/// The parameters with those of the axes.
fn with_axes(mut parameters: Parameters, scale_factors: bool) -> Parameters {
    let misalignment = Of::constant(MISALIGNMENT_DEG.to_radians());
    for kind in [Parameter::GyroMisalignment, Parameter::AccelMisalignment] {
        parameters = parameters.with(kind, misalignment);
    }
    if scale_factors {
        let walk = parameters
            .prior(Parameter::GyroScale)
            .map_or(0.0, |prior| prior.walk);
        let gyro = Of {
            walk,
            ..Of::constant(SCALE_FACTOR)
        };
        parameters = parameters
            .with(Parameter::GyroScale, gyro)
            .with(Parameter::AccelScale, Of::constant(SCALE_FACTOR));
    }
    parameters
}

/// The way of drives by poses with the errors of the axes that are likeliest beside the noise, in place of `way` where they are kept; the
/// fits begin with the noises that its own began with.
pub(super) fn tried<'a>(
    way: Way<'a>,
    start: &RestNoise,
    from: &[Noise],
    spans: &[(f64, f64)],
    sure: bool,
    goes_on: &dyn Fn(f64) -> bool,
) -> (Way<'a>, Option<Axes>) {
    let unseen =
        |logs: &[FitLog], fit: &Fit| unseen_likelihood(logs, start, &fit.noise, spans).ok();
    let Some(unseen_before) = unseen(&way.logs, &way.fit) else {
        return (way, None);
    };
    // What is too short to hold out anything is judged by what the fit has seen.
    let judges = unseen_before != 0.0;
    let candidate = |scale_factors: bool| {
        let logs = way.logs.iter().map(|log| FitLog {
            settings: Settings {
                parameters: with_axes(log.settings.parameters, scale_factors),
                ..log.settings.clone()
            },
            ..*log
        });
        let logs = Vec::from_iter(logs);
        let fit = first_of(from, &logs, start, &way.prior, sure, goes_on).ok()?;
        let gain = unseen(&logs, &fit)? - unseen_before;
        let axes = Axes {
            scale_factors,
            gain,
            kept: (!judges || gain > LIKELIER) && fit.likelihood - way.fit.likelihood > LIKELIER,
        };
        let prior = way.prior.clone();
        Some((Way { logs, prior, fit }, axes))
    };
    let both = [false, true].into_iter().filter_map(candidate);
    let better = |a: (Way<'a>, Axes), b: (Way<'a>, Axes)| {
        if (b.1.kept, b.1.gain) > (a.1.kept, a.1.gain) {
            b
        } else {
            a
        }
    };
    match both.reduce(better) {
        Some((with, axes)) if axes.kept => (with, Some(axes)),
        found => (way, found.map(|(_, axes)| axes)),
    }
}
