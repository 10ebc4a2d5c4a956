//! Settings of an identification, and how a recording is made ready for it.

use super::{NotStatic, part::Part, rest::static_part};
use crate::record::Record;
use undrift_base::hash;
use undrift_noise::{Provenance, Recording, identify::Options, screening::Trend};
use undrift_results::{self as results, Number, Omitted, Used};

/// Most that a stated rate may be off the time stamps, relative.
const RATE_TOLERANCE: f64 = 0.01;

/// Why a recording makes no model; its text says what to change.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RecordingError {
    /// Nothing gives the sample rate.
    #[error(
        "the recording has no time column; name it with --time, or set its sample rate (--rate, or identify.rate in a manifest)"
    )]
    NoRate,
    /// The stated rate is not that of the time stamps.
    #[error(
        "--rate is {stated} Hz but the time stamps give {stamps:.3} Hz; omit it or correct the stamps"
    )]
    WrongRate {
        /// Stated rate \[Hz\].
        stated: f64,
        /// Rate of the stamps \[Hz\].
        stamps: f64,
    },
    /// The part to use begins after the end.
    #[error("--span begins at {start} s, after the end of the recording at {length:.1} s")]
    Span {
        /// Where the part begins \[s\].
        start: f64,
        /// Length of the recording \[s\].
        length: f64,
    },
    /// Recordings of different sample rates \[Hz\]: the first, and another.
    #[error(
        "{} has {:.3} Hz, {} {:.3} Hz: recordings that are identified together need the same sample rate", .1.0, .1.1, .0.0, .0.1
    )]
    Rates((String, f64), (String, f64)),
    /// Recordings of different axes: the first, and another.
    #[error(
        "{} has {}, {} {}: recordings that are identified together need the same axes", .1.0, .1.1, .0.0, .0.1
    )]
    Axes((String, String), (String, String)),
    /// It is no recording of a sensor at rest, in the units that it is said to be in.
    #[error(transparent)]
    NotStatic(#[from] NotStatic),
    /// No axis could be identified.
    #[error("no axis could be identified")]
    NoAxis,
}

/// Settings of an identification; the default finds the rate and the part at rest by itself.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Sample rate \[Hz\]; that of the time stamps if absent.
    pub rate_hz: Option<f64>,
    /// Part of a recording to use, from and to \[s\] after its first sample; all of it if absent.
    pub span: Option<(f64, f64)>,
    /// Largest n of ARMA(2n, 2n−1) that the Pandit-Wu search may choose.
    pub n_max: usize,
    /// Trend that is removed first; that of temperature is not, of a record without one.
    pub trend: Trend,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            rate_hz: None,
            span: None,
            n_max: 2,
            trend: Trend::default(),
        }
    }
}

impl Settings {
    /// The options for a record at a rate \[Hz\].
    pub(super) fn options<'a>(&self, record: &'a Record, rate_hz: f64) -> Options<'a> {
        Options {
            n_max: self.n_max,
            trend: self.trend,
            temperature: record.temperature.as_deref(),
            ..Options::at(rate_hz)
        }
    }
}

/// A recording ready to be identified: evenly sampled, NaN where a sample is missing.
#[derive(Clone, Debug)]
pub struct Prepared {
    /// Name of the recording in results.
    pub name: String,
    /// The samples.
    pub record: Record,
    /// Sample rate \[Hz\].
    pub rate_hz: f64,
    /// Reason why it is not a static recording, if so; it is whole then.
    pub not_static: Option<NotStatic>,
    /// Part that is used, where that is not all.
    pub used: Option<Used>,
}

/// Makes a record ready to be identified: its rate, repeated samples, its gaps, whether it is static, and the part in which it lies still.
///
/// # Errors
/// [`RecordingError::NoRate`] when neither settings nor time stamps give the rate, [`RecordingError::WrongRate`] when the one stated
/// is off the time stamps by more than 1 %, [`RecordingError::Span`] when the part to use is empty. A record that is not static is
/// no error here: see [`Prepared::not_static`].
///
/// ```
/// # use undrift_drive as undrift;
/// use undrift::{Record, identify::{Settings, prepare}};
/// // Twenty seconds at 50 Hz, of which the first two were handled.
/// let mut rows: Vec<[f64; 6]> = (0..1500)
///     .map(|k| f64::from(k * 7919 % 101 - 50) * 2e-5)
///     .map(|noise| [noise, -noise, noise, noise, noise, noise - 9.81])
///     .collect();
/// for row in &mut rows[..100] {
///     row[2] += 1.5; // [rad/s]
/// }
/// let prepared = prepare(Record::from_samples(&rows), &Settings { rate_hz: Some(50.0), ..Settings::default() })?;
/// assert!(prepared.not_static.is_none());
/// assert!(prepared.record.length() < 1450 && prepared.used.is_some());
/// # Ok::<(), undrift::identify::RecordingError>(())
/// ```
pub fn prepare(record: Record, settings: &Settings) -> Result<Prepared, RecordingError> {
    let stamps = record.timing.as_ref().map(|timing| timing.rate_hz);
    let rate_hz = match (settings.rate_hz, stamps) {
        (Some(stated), Some(stamps)) if (stated / stamps - 1.0).abs() > RATE_TOLERANCE => {
            return Err(RecordingError::WrongRate { stated, stamps });
        }
        (stated, stamps) => stated.or(stamps).ok_or(RecordingError::NoRate)?,
    };
    let mut name = results::name(&record.name);
    let record = match settings.span {
        Some(span) => {
            let (start, length) = (span.0, record.length() as f64);
            if start * rate_hz >= length {
                let length = length / rate_hz;
                return Err(RecordingError::Span { start, length });
            }
            name += &format!(", {start} to {} s", span.1);
            record.within(span, rate_hz)
        }
        None => record,
    };
    let (record, times) = record.without_repeats();
    let rate_hz = rate_hz / times;
    let mut record = record.with_gaps();
    let (part, not_static) = match static_part(&record, rate_hz) {
        Ok(part) => (Some(part), None),
        Err(problem) => (None, Some(problem)),
    };
    let part = part.filter(|part| !part.left_out.is_empty());
    let used = part.map(|part| {
        let from = settings.span.map_or(0.0, |span| span.0);
        let mut used = used_of(&part, &record, rate_hz, from);
        record.keep(&part.used, &part.bumps);
        for one in &part.subtracted {
            one.subtract_from(&mut record.samples);
        }
        used.record = name.clone();
        if settings.span.is_none() && (used.start_s.0 > 0.0 || used.end_s != used.length_s) {
            name += &format!(", {:.0} to {:.0} s", used.start_s.0, used.end_s.0);
        }
        used
    });
    Ok(Prepared {
        name,
        not_static,
        record,
        rate_hz,
        used,
    })
}

/// A part of a record that begins `from` \[s\] after its own first sample, as a result.
fn used_of(part: &Part, record: &Record, rate_hz: f64, from: f64) -> Used {
    let at = |sample: usize| Number(from + sample as f64 / rate_hz);
    let left_out = part.left_out.iter().map(|one| Omitted {
        start_s: Number(from + one.start_s.0),
        end_s: Number(from + one.end_s.0),
        ..one.clone()
    });
    Used {
        record: String::new(),
        start_s: at(part.used.start),
        end_s: at(part.used.end),
        length_s: at(record.length()),
        left_out: left_out.collect(),
    }
}

/// The sample rate \[Hz\] of several records: that of the longest, which the others' are within the accuracy of a nominal one.
///
/// # Errors
/// Rates that differ by more than 1 %, or different axes.
pub(super) fn common_rate(records: &[Prepared]) -> Result<f64, RecordingError> {
    let longest = records.iter().max_by_key(|one| one.record.length());
    let (Some(first), Some(longest)) = (records.first(), longest) else {
        return Err(RecordingError::NoRate);
    };
    for other in records {
        if (other.rate_hz / first.rate_hz - 1.0).abs() > RATE_TOLERANCE {
            let rate = |one: &Prepared| (one.name.clone(), one.rate_hz);
            return Err(RecordingError::Rates(rate(first), rate(other)));
        }
        if other.record.axes != first.record.axes {
            let axes = |one: &Prepared| (one.name.clone(), one.record.axes.join(" "));
            return Err(RecordingError::Axes(axes(first), axes(other)));
        }
    }
    Ok(longest.rate_hz)
}

/// Provenance of a model: recordings, called `name`, at a rate \[Hz\], with the hashes of their files.
///
/// # Errors
/// If a file cannot be read.
pub fn provenance(
    recordings: &[Prepared],
    name: &str,
    rate_hz: f64,
) -> std::io::Result<Provenance> {
    let recording = |one: &Prepared| {
        Ok(Recording {
            record: one.name.clone(),
            samples: one.record.samples.first().map(|s| s.len() as u64),
            sha256: one.record.file.as_deref().map(hash::of_file).transpose()?,
        })
    };
    let mut recordings = recordings
        .iter()
        .map(recording)
        .collect::<std::io::Result<Vec<_>>>()?;
    let samples = recordings.iter().map(|one| one.samples).sum();
    // One has no list of its own.
    let sha256 = match recordings.len() {
        1 => recordings.remove(0).sha256,
        _ => None,
    };
    Ok(Provenance {
        record: Some(name.to_owned()),
        rate_hz: Some(rate_hz),
        samples,
        sha256,
        recordings,
        program: Some(format!("undrift {}", env!("CARGO_PKG_VERSION"))),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_asked_for_is_what_an_axis_is_identified_with() {
        let record = Record {
            temperature: Some(vec![21.0, 22.0]),
            ..Record::default()
        };
        for (n_max, trend) in [(1, Trend::Linear), (3, Trend::Temperature)] {
            let settings = Settings {
                n_max,
                trend,
                ..Settings::default()
            };
            let options = settings.options(&record, 49.6);
            assert_eq!((options.n_max, options.rate_hz), (n_max, 49.6));
            assert!(options.trend == trend && options.temperature == Some(&[21.0, 22.0][..]));
        }
    }
}
