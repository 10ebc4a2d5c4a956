//! The Allan deviations of a record alone: what is there in a second, before tests and models.

use super::{
    Prepared, Settings,
    result::{deviation, unit},
};
use crate::results::{self, Identify, SCHEMA, VERSION};
use undrift_noise::{
    identify::{AllanDeviation, allan_deviation},
    parallel,
};

/// The Allan deviation of every axis of a recording and its terms, on all cores, as a result without tests and models.
#[must_use]
pub fn allan_deviations(prepared: &Prepared, settings: &Settings) -> Identify {
    let record = &prepared.record;
    let options = &settings.options(record, prepared.rate_hz);
    let axes = parallel::map(record.axes.len(), |k| {
        let (axis, samples) = (record.axes[k], &record.samples[k]);
        let found = match allan_deviation(samples, options) {
            Ok(AllanDeviation {
                curve,
                intervals,
                terms,
            }) => results::Axis {
                samples: samples.len() as u64,
                unit: unit(axis).into(),
                allan: deviation(&curve.points, &intervals, &terms),
                allan_terms: terms,
                ..results::Axis::default()
            },
            Err(error) => results::Axis {
                error: Some(error.to_string()),
                ..results::Axis::default()
            },
        };
        (axis, found)
    });
    Identify {
        undrift: VERSION.into(),
        schema: SCHEMA,
        record: prepared.name.clone(),
        rate_hz: prepared.rate_hz.into(),
        timing: record.timing.clone(),
        skipped_rows: record.skipped.total(),
        used: prepared.used.iter().cloned().collect(),
        axes: results::by_name(axes),
        pool: None,
    }
}
