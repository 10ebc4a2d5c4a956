//! The Allan deviations of a record alone: what is there in a second, before tests and models.

use super::result::{deviation, unit};
use crate::{
    record::Record,
    results::{self, Identify, SCHEMA, VERSION},
};
use rayon::prelude::*;
use undrift_noise::identify::{AllanDeviation, Options, allan_deviation};

/// The Allan deviation of every axis of a record and its terms, on all cores, as a result without tests and models;
/// `name` is what the record is called.
#[must_use]
pub fn allan_deviations(record: &Record, name: &str, options: &Options<'_>) -> Identify {
    let axes = record.axes.par_iter().zip(&record.samples);
    let axes = axes.map(|(axis, samples)| {
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
        ((*axis).to_owned(), found)
    });
    Identify {
        undrift: VERSION.into(),
        schema: SCHEMA,
        record: name.into(),
        rate_hz: options.rate_hz.into(),
        timing: record.timing.clone(),
        skipped_rows: record.skipped.total(),
        axes: axes.collect(),
        pool: None,
    }
}
