//! The first heading by two antennas: what most of a few seconds of them agree on, at rest or while the vehicle still moves slowly.

use super::{Aligner, HeadingSource, prior_std};
use crate::{
    estimator::{Aiding, Estimator},
    settings::Settings,
};
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::{ComplexField, RealField};
use undrift_nav::{
    Matrix3, Quaternion, Vector3,
    filter::{FilterError, Gate},
    parameters::Parameter,
    sample::{ImuSample, Scalar},
};

/// Standard deviation from which on a direction counts as unknown \[rad\].
const UNKNOWN: f64 = 0.5;
/// Standard deviations of the heading that a filter starts with before it takes the antennas' in: so much wider that it adds nothing.
const WIDER: f64 = 10.0;

/// Azimuth of the second antenna as seen from the first in the frame that `q` turns body axes to \[rad\].
fn azimuth(q: &Quaternion, settings: &Settings) -> f64 {
    let (sin, cos) = settings.constraints.heading_baseline.sin_cos();
    let b = q * Vector3::new(cos, sin, 0.0);
    b.y.atan2(b.x)
}

impl Aligner {
    /// Takes a heading within `sample`.
    pub fn antennas(&mut self, measured: &Scalar, sample: &ImuSample, settings: &Settings) {
        self.advance(sample, measured.time);
        let off = measured.value - azimuth(&self.level, settings);
        self.antennas.add(measured, off);
    }

    /// Heading of the body with its standard deviation \[rad\], where it is known how the antennas lie.
    pub(super) fn heading_by_antennas(
        &mut self,
        time: f64,
        settings: &Settings,
    ) -> Option<(f64, f64, HeadingSource)> {
        let baseline = prior_std(settings, Parameter::HeadingOffset);
        if baseline > UNKNOWN {
            return None;
        }
        if let Some((.., duration, end)) = self.rested {
            // Within a rest neither the gyros' bias nor the tilt that was not known yet turn anything.
            self.antennas
                .at_rest(end - duration, end, azimuth(&self.level, settings));
        }
        let (angle, std) = self.antennas.agreed(time)?;
        let forward = self.level * Vector3::x();
        let heading = forward.y.atan2(forward.x) + angle;
        Some((heading, std.hypot(baseline), HeadingSource::Antennas))
    }
}

/// Standard deviation of the heading before [`take_in`] \[rad\], of one that is known to `std`.
pub(super) fn wide(std: f64) -> f64 {
    (WIDER * std).min(1.0).max(std)
}

/// Updates a filter that begins with a heading by antennas that are known to `std` together with their direction in the body: what
/// both are wrong by is the same.
pub(super) fn take_in(
    filter: &mut dyn Estimator,
    std: f64,
    settings: &Settings,
) -> Result<(), FilterError> {
    let baseline = prior_std(settings, Parameter::HeadingOffset);
    let heading = Aiding::Heading {
        heading: azimuth(&filter.nav().q_nb, settings),
        baseline: settings.constraints.heading_baseline,
    };
    let variance = std * std - baseline * baseline;
    filter.update(&heading, &(Matrix3::identity() * variance), &Gate::OPEN)?;
    Ok(())
}
