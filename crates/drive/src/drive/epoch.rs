//! The date of a drive, its logs on one clock, and how its inertial log begins.

use super::{Drive, error::ConfigError, logs::Logs};
use std::path::PathBuf;
use undrift_config::Section;
use undrift_io::{
    epoch::Epoch,
    gnss::Fixes,
    imu::{Imu, ImuFormat},
    magnetic::Fields,
    reader::Kind,
    scalar::Scalars,
    truth::Truth,
};
use undrift_nav::sample::ImuSample;

/// A `time_offset` of so much or more \[s\] puts a log onto the clock of another: its own dates do not count.
pub(crate) const OTHER_CLOCK: f64 = 3600.0;
/// Records that are read for a date.
const RECORDS: usize = 100;
/// Samples that are read for their interval.
const SAMPLES: usize = 2000;

/// Start and interval of an inertial log, as far as it can be read.
#[derive(Clone, Copy, Debug, Default)]
pub struct Beginning {
    /// Time of the first sample \[s\].
    pub time: Option<f64>,
    /// Mean interval of the samples without gaps \[s\]; `None` if one of them cannot be read.
    pub interval: Option<f64>,
}

/// `epoch = "2025-07-08T19:34:00Z"`, UTC of the IMU's time zero, or `epoch = "week 2374"`.
pub(super) fn read_epoch(top: &Section) -> Result<Option<Epoch>, ConfigError> {
    let Some(text) = top.text("epoch")? else {
        return Ok(None);
    };
    let epoch = Epoch::stated(text).ok_or_else(|| {
        let wanted = "\"2025-07-08T19:34:00Z\", the UTC of time 0, or \"week 2374\" of GPS";
        top.error("epoch", format!("\"{text}\": write {wanted}"))
    })?;
    Ok(Some(epoch))
}

impl Drive {
    /// Finds the date: that which is stated, else the IMU's, else that of the first other log that has one. The
    /// times of logs that count from other dates are brought onto it. What cannot be read is left as it is.
    pub(super) fn date(&mut self, stated: Option<Epoch>) {
        let logs = &self.logs;
        let (dated, beginning) = begin(logs, &self.imu);
        let imu = stated.or(dated);
        self.beginning = beginning;
        let (path, gnss) = &mut self.gnss;
        let offset = *gnss.time_offset();
        let mut others = vec![(
            epoch_of::<Fixes>(logs, (path, gnss), offset),
            gnss.time_offset(),
        )];
        if let Some((path, truth)) = &mut self.truth {
            let offset = *truth.time_offset();
            let epoch = epoch_of::<Truth>(logs, (path, truth), offset);
            others.push((epoch, truth.time_offset()));
        }
        for (path, format) in self.scalars.iter_mut().flatten() {
            let epoch = epoch_of::<Scalars>(logs, (path, format), format.time_offset);
            others.push((epoch, &mut format.time_offset));
        }
        if let Some((path, format)) = &mut self.magnetometer {
            let epoch = epoch_of::<Fields>(logs, (path, format), format.time_offset);
            others.push((epoch, &mut format.time_offset));
        }
        self.epoch = imu.or_else(|| others.iter().find_map(|(epoch, _)| *epoch));
        for (epoch, offset) in others {
            if let (Some(epoch), Some(of_drive)) = (epoch, self.epoch) {
                *offset += epoch.after(of_drive);
            }
        }
    }
}

/// What the times of a log count from, if it states that and its offset does not move it onto another clock.
fn epoch_of<K: Kind>(
    logs: &Logs,
    (path, options): (&PathBuf, &K::Options),
    offset: f64,
) -> Option<Epoch> {
    if offset.abs() >= OTHER_CLOCK {
        return None;
    }
    let mut reader = logs.read::<K>(path, options).ok()?;
    for _ in 0..RECORDS {
        if reader.epoch().is_some() || !matches!(reader.next(), Some(Ok(_))) {
            break;
        }
    }
    reader.epoch()
}

/// Epoch of the inertial log, as [`epoch_of`] finds it, and how the log begins.
fn begin(logs: &Logs, (path, format): &(PathBuf, ImuFormat)) -> (Option<Epoch>, Beginning) {
    let Ok(mut reader) = logs.read::<Imu>(path, format) else {
        return Default::default();
    };
    let mut epoch = reader.epoch();
    let (mut read, mut failed) = (Vec::with_capacity(SAMPLES), false);
    while read.len() < SAMPLES
        && let Some(sample) = reader.next()
    {
        let Ok(sample) = sample else {
            failed = true;
            break;
        };
        read.push(sample);
        if read.len() <= RECORDS {
            epoch = epoch.or(reader.epoch());
        }
    }
    // The first interval is made up.
    let intervals = read.iter().skip(1).map(|sample| sample.dt).collect();
    let beginning = Beginning {
        time: read.first().map(|sample: &ImuSample| sample.time),
        interval: mean_interval(intervals).filter(|_| !failed),
    };
    (
        epoch.filter(|_| format.time_offset.abs() < OTHER_CLOCK),
        beginning,
    )
}

/// Mean of the intervals that are no gaps: up to 1.5 times the median.
fn mean_interval(mut intervals: Vec<f64>) -> Option<f64> {
    intervals.sort_by(f64::total_cmp);
    let median = *intervals.get(intervals.len() / 2)?;
    let regular = intervals.partition_point(|dt| *dt <= 1.5 * median);
    Some(intervals[..regular].iter().sum::<f64>() / regular as f64)
}
