//! The first heading by a magnetometer at rest, as uncertain as its hard iron makes it.

use super::{Aligner, HeadingSource, prior_std, rest::BLOCK, seen::Seen};
use crate::{
    estimator::{Aiding, Estimator},
    readings::Readings,
    settings::Settings,
};
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::{ComplexField, RealField};
use undrift_nav::{
    Matrix3, Vector3,
    earth::Geodetic,
    filter::{FilterError, Gate},
    parameters::Parameter,
    sample::{ImuSample, MagneticField},
};

/// Standard deviation from which on a direction is no heading \[rad\].
const UNKNOWN: f64 = 0.4;
/// Fewest readings of a mean.
const LEAST: u32 = 2;
/// Standard deviation of the readings of a rest from which on something moves nearby \[T\].
const RESTLESS: f64 = 5e-6;

/// The readings since a rest began.
#[derive(Clone, Copy, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct AtRest {
    start: f64,
    readings: Readings,
}

/// What a rest shows of the field: the mean, body axes \[T\], and the variance of its white noise.
#[derive(Clone, Copy)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct FieldAtRest {
    mean: Vector3,
    white: f64,
}

impl AtRest {
    /// The mean, of enough readings that agree.
    pub(super) fn mean(&self) -> Option<FieldAtRest> {
        let readings = &self.readings;
        let scatter = readings.scatter() / (3.0 * readings.number());
        let enough = readings.count >= LEAST && scatter < RESTLESS * RESTLESS;
        enough.then(|| FieldAtRest {
            mean: readings.mean(),
            white: readings.white_of_mean(scatter),
        })
    }
}

/// A heading, and what the hard iron has to be for it.
struct Found {
    heading: f64,
    std: f64,
    hard_iron: f64,
}

impl Aligner {
    /// Takes a reading within `sample`, body axes.
    pub fn magnetometer(&mut self, reading: &MagneticField, sample: &ImuSample) {
        self.advance(sample, reading.time);
        // A block that does not agree with those before begins another span.
        if self.field_so_far.start < reading.time - self.rest.span() - 2.0 * BLOCK {
            self.field_so_far = AtRest {
                start: reading.time,
                readings: Readings::default(),
            };
        }
        self.field_so_far.readings.add(&reading.field, reading.std);
    }

    /// Goes on beside a solution that began with the field: without it, to see whether motion shows the same heading.
    pub fn without_field(&mut self) {
        self.ignores_field = true;
    }

    /// Heading of the body with its standard deviation \[rad\].
    pub(super) fn heading_by_field(
        &self,
        seen: &Seen,
        settings: &Settings,
    ) -> Option<(f64, f64, HeadingSource)> {
        let found = self.by_field(&seen.position.0, settings)?;
        Some((found.heading, found.std, HeadingSource::Magnetometer))
    }

    /// With the hard iron b of the standard deviation σ in each axis the angle of the level field `H e + b` has the density
    /// `exp(h H cos(…)/σ²)` (von Mises), h its strength as measured. What strength and dip lack is of the hard iron: two numbers that show
    /// how large it is.
    fn by_field(&self, place: &Geodetic, settings: &Settings) -> Option<Found> {
        let (level_at_rest, ..) = self.rested?;
        let seen = self.field_at_rest.filter(|_| !self.ignores_field)?;
        let field = settings.magnetometer.field(place);
        let measured = level_at_rest * seen.mean;
        let (level, horizontal) = (measured.xy().norm(), field.xy().norm());
        let lacks = (level - horizontal).powi(2) + (measured.z - field.z).powi(2);
        let prior = prior_std(settings, Parameter::HardIron);
        let hard_iron = prior.max((0.5 * lacks).sqrt());
        let lasting = settings.magnetometer.lasting_variance() + seen.white;
        let std = ((hard_iron * hard_iron + lasting) / (level * horizontal)).sqrt();
        let north = field.y.atan2(field.x) - measured.y.atan2(measured.x);
        let forward = self.level * Vector3::x();
        (std < UNKNOWN).then(|| Found {
            heading: forward.y.atan2(forward.x) + north,
            std,
            hard_iron,
        })
    }

    /// Updates a filter that begins at the attitude of the rest, `at_rest`, with the field of then: what heading and hard iron are wrong
    /// by belongs together.
    pub(super) fn take_field_in(
        &self,
        filter: &mut dyn Estimator,
        settings: &Settings,
    ) -> Result<(), FilterError> {
        let place = filter.nav().position;
        let (Some(found), Some(seen)) = (self.by_field(&place, settings), self.field_at_rest)
        else {
            return Ok(());
        };
        if let Some(prior) = filter.parameters().prior(Parameter::HardIron)
            && found.hard_iron > prior.std
        {
            filter.renew(Parameter::HardIron, found.hard_iron);
        }
        let variance = seen.white + settings.magnetometer.lasting_variance();
        let aiding = Aiding::Magnetometer {
            measured: seen.mean,
            field: settings.magnetometer.field(&place),
        };
        filter.update(&aiding, &(Matrix3::identity() * variance), &Gate::OPEN)?;
        let lacking = found.std.powi(2) - filter.nav_std()[8].powi(2);
        filter.inflate_heading(lacking.max(0.0).sqrt(), 0.0);
        Ok(())
    }
}
