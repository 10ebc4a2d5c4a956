//! A static record of six axes, or one, into a model file and the reasoning behind it.

mod json;
mod series;
mod settings;

pub use series::RecordSeries;
pub use settings::{RecordingError, Trend, options, provenance, rate, unevenness};

use crate::record::Record;
use rayon::prelude::*;
use undrift_noise::{
    ImuModel, Provenance,
    identify::{Axis, IdentifyError, Options, identify},
    model_file::AXES,
    screening::Timing,
};

/// The axes of a record, identified.
pub struct Identified {
    /// Sample rate [Hz].
    pub rate_hz: f64,
    /// What the time stamps say, where there are any.
    pub timing: Option<Timing>,
    /// Rows of the record that were left out.
    pub skipped_rows: u64,
    /// Name of each axis with what was found, or why nothing was.
    pub axes: Vec<(&'static str, Result<Axis, IdentifyError>)>,
    /// For plots of each axis' samples, in the order of the axes.
    pub series: Vec<RecordSeries>,
}

/// Identifies every axis of a record, on all cores. `done` is called after each axis.
pub fn run(record: &Record, options: &Options<'_>, done: impl Fn() + Sync) -> Identified {
    let (axes, series) = record
        .axes
        .par_iter()
        .zip(&record.samples)
        .map(|(name, samples)| {
            let found = identify(samples, name.starts_with("accel"), options);
            let step = found
                .as_ref()
                .ok()
                .and_then(|axis| axis.normality.quantisation);
            let series = RecordSeries::of(samples, options.rate_hz, step.map(|q| q.step));
            done();
            ((*name, found), series)
        })
        .unzip();
    Identified {
        rate_hz: options.rate_hz,
        timing: record.timing.clone(),
        skipped_rows: record.skipped.total(),
        axes,
        series,
    }
}

impl Identified {
    /// The model file's contents: identified axes over those of `base`; what neither has is left
    /// out. The standard deviation of the turn-on constant is the base's where it has one, else the
    /// constant seen in the record.
    ///
    /// # Errors
    /// When no axis is identified.
    pub fn model(
        &self,
        base: Option<&ImuModel>,
        name: &str,
        provenance: Provenance,
    ) -> Result<ImuModel, RecordingError> {
        let mut model = base.cloned().unwrap_or_default();
        model.name = name.to_owned();
        model.source = "identified from a static record".into();
        model.provenance = provenance;
        let mut any = false;
        for (name, found) in &self.axes {
            let Ok(found) = found else { continue };
            let Some(slot) = axis_of(&mut model, name) else {
                continue;
            };
            // One record shows one turn-on; a data sheet knows how they scatter.
            let known = slot.turn_on;
            *slot = found.model();
            if known > 0.0 {
                slot.turn_on = known;
            }
            any = true;
        }
        any.then_some(model).ok_or(RecordingError::NoAxis)
    }
}

fn axis_of<'a>(model: &'a mut ImuModel, name: &str) -> Option<&'a mut undrift_noise::AxisModel> {
    let index = AXES.iter().position(|axis| *axis == name)?;
    model.gyro.iter_mut().chain(&mut model.accel).nth(index)
}
