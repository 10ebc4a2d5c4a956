//! What a record is identified with.

use super::Pooled;
use crate::{hash, record::Record};
use undrift_noise::{
    Provenance, Recording,
    identify::Options,
    screening::{Timing, Trend},
};

/// Most that a stated rate may be off the time stamps, relative.
const RATE_TOLERANCE: f64 = 0.01;

/// Why a recording makes no model.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
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
    /// Recordings of different sample rates.
    #[error(
        "{other} has {other_hz:.3} Hz, {first} {first_hz:.3} Hz: recordings that are identified together need the same sample rate"
    )]
    Rates {
        /// The first record.
        first: String,
        /// Its rate \[Hz\].
        first_hz: f64,
        /// The other one.
        other: String,
        /// Its rate \[Hz\].
        other_hz: f64,
    },
    /// Recordings of different axes.
    #[error(
        "{other} has {other_axes}, {first} {first_axes}: recordings that are identified together need the same axes"
    )]
    Axes {
        /// The first record.
        first: String,
        /// Its axes.
        first_axes: String,
        /// The other one.
        other: String,
        /// Its axes.
        other_axes: String,
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

/// The sample rate \[Hz\] of several records: that of the longest, which the others' are within the accuracy of a nominal one.
///
/// # Errors
/// Rates that differ by more than 1 %, or different axes.
pub fn common_rate(records: &[Pooled<'_>]) -> Result<f64, RecordingError> {
    let longest = records.iter().max_by_key(|pooled| pooled.samples());
    let (Some(first), Some(longest)) = (records.first(), longest) else {
        return Err(RecordingError::NoRate);
    };
    for other in records {
        if (other.rate_hz / first.rate_hz - 1.0).abs() > RATE_TOLERANCE {
            return Err(RecordingError::Rates {
                first: first.name.to_owned(),
                first_hz: first.rate_hz,
                other: other.name.to_owned(),
                other_hz: other.rate_hz,
            });
        }
        if other.record.axes != first.record.axes {
            return Err(RecordingError::Axes {
                first: first.name.to_owned(),
                first_axes: first.record.axes.join(" "),
                other: other.name.to_owned(),
                other_axes: other.record.axes.join(" "),
            });
        }
    }
    Ok(longest.rate_hz)
}

/// Where the model of several records comes from, which `name` stands for, at a rate \[Hz\].
///
/// # Errors
/// If a file cannot be read.
pub fn provenance_of_several(
    records: &[Pooled<'_>],
    name: &str,
    rate_hz: f64,
) -> std::io::Result<Provenance> {
    let recording = |pooled: &Pooled<'_>| {
        let own = provenance(pooled.record, pooled.name, rate_hz)?;
        Ok(Recording {
            record: pooled.name.to_owned(),
            samples: own.samples,
            sha256: own.sha256,
        })
    };
    let recordings = records
        .iter()
        .map(recording)
        .collect::<std::io::Result<Vec<_>>>()?;
    Ok(Provenance {
        record: Some(name.to_owned()),
        rate_hz: Some(rate_hz),
        samples: recordings.iter().map(|recording| recording.samples).sum(),
        sha256: None,
        recordings,
        program: Some(program()),
    })
}

fn program() -> String {
    format!("undrift {}", env!("CARGO_PKG_VERSION"))
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
        program: Some(program()),
        recordings: Vec::new(),
    })
}
