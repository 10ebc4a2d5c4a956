//! What a record is identified with.

use crate::{hash, record::Record};
use undrift_noise::{
    Provenance,
    identify::Options,
    screening::{Timing, Trend},
};

/// Most that a stated rate may be off the time stamps, relative.
const RATE_TOLERANCE: f64 = 0.01;

/// Why a recording makes no model.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum RecordingError {
    /// Nothing gives the sample rate.
    #[error(
        "the recording has no time column; set its sample rate (--rate, or identify.rate in a manifest)"
    )]
    NoRate,
    /// The stated rate is not that of the time stamps.
    #[error(
        "--rate is {stated} Hz but the time stamps give {stamps:.3} Hz; omit it or correct the stamps"
    )]
    WrongRate {
        /// As stated \[Hz\].
        stated: f64,
        /// Of the stamps \[Hz\].
        stamps: f64,
    },
    /// No axis could be identified.
    #[error("no axis could be identified")]
    NoAxis,
}

/// The sample rate to go by \[Hz\]: stated, or from the stamps.
///
/// # Errors
/// When there is neither, or the two disagree by more than 1 %.
pub fn rate(stated: Option<f64>, timing: Option<&Timing>) -> Result<f64, RecordingError> {
    let stamps = timing.map(|timing| timing.rate_hz);
    if let (Some(stated), Some(stamps)) = (stated, stamps)
        && (stated / stamps - 1.0).abs() > RATE_TOLERANCE
    {
        return Err(RecordingError::WrongRate { stated, stamps });
    }
    stated.or(stamps).ok_or(RecordingError::NoRate)
}

/// The options for a record at a rate \[Hz\]; a record without temperatures has none taken out.
pub fn options(record: &Record, rate_hz: f64, n_max: usize, trend: Trend) -> Options<'_> {
    Options {
        n_max,
        trend,
        temperature: record.temperature.as_deref(),
        ..Options::at(rate_hz)
    }
}

/// Where a model comes from: a record called `name` at a rate \[Hz\], with the hash of its file, if it is one.
///
/// # Errors
/// If the file cannot be read.
pub fn provenance(record: &Record, name: &str, rate_hz: f64) -> std::io::Result<Provenance> {
    Ok(Provenance {
        record: Some(name.to_owned()),
        rate_hz: Some(rate_hz),
        samples: record.samples.first().map(|s| s.len() as u64),
        sha256: record.file.as_deref().map(hash::of_file).transpose()?,
        program: Some(format!("undrift {}", env!("CARGO_PKG_VERSION"))),
    })
}
