//! Who watches a replay, and why one stops.

use super::{
    events::{Implausible, Log},
    measurement::Measurement,
};
use crate::{
    align::{AlignmentFailure, ClockFault, RestFailure, Stamps, compare},
    estimator::{Adjoint, Estimator},
};
use undrift_io::{ReadError, skipped::Skipped};
use undrift_nav::{
    filter::{FilterError, Update},
    sample::{GnssFix, ImuSample},
};

/// Inertial samples in order of time.
pub type Samples<'a> = dyn Iterator<Item = Result<ImuSample, ReadError>> + 'a;
/// Measurements in order of time.
pub type Measurements<'a> = dyn Iterator<Item = Result<Measurement, ReadError>> + 'a;

/// Called with everything that happens, in order of time; what is not implemented is not looked at.
pub trait Observer {
    /// A sample was processed, and every fix up to its end; the filter stands at the sample's end.
    ///
    /// # Errors
    /// Its own; the replay ends with it.
    fn sample(&mut self, _filter: &dyn Estimator) -> Result<(), ReplayError> {
        Ok(())
    }
    /// A fix was reached; the filter stands at its time, before any update with it.
    fn fix(&mut self, _filter: &dyn Estimator, _fix: &GnssFix, _withheld: bool) {}
    /// A fix at `time` \[s\] went into the solution, or began it.
    fn used(&mut self, _time: f64) {}
    /// What became of the position and the velocity of the fix of this time \[s\], where they were
    /// shown to the filter.
    fn updated(&mut self, _time: f64, _updates: [Option<Update>; 2]) {}
    /// A block of samples was judged to be rest or motion; the filter stands at its end.
    fn judged(&mut self, _filter: &dyn Estimator, _rest: bool) {}
    /// A node of a smoother: the filter after all that happened up to now, and the adjoint of what
    /// happened since the node before; `None` at the first one.
    ///
    /// # Errors
    /// Its own; the replay ends with it.
    fn node(
        &mut self,
        _filter: &dyn Estimator,
        _since: Option<&Adjoint>,
    ) -> Result<(), ReplayError> {
        Ok(())
    }
}

/// Watches nothing.
impl Observer for () {}

/// Why a replay stopped without a result.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// Reading the log failed.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// Writing the result failed.
    #[error("cannot write the result: {0}")]
    Write(#[from] std::io::Error),
    /// No alignment before the log ended.
    #[error(transparent)]
    NotAligned(Box<NotAligned>),
    /// The filter cannot be built.
    #[error(transparent)]
    Filter(#[from] FilterError),
}

/// A log without an alignment, and what is known of why.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{}", self.reason())]
pub struct NotAligned {
    /// What was missing.
    pub failure: AlignmentFailure,
    /// The stamps of samples and fixes, where there were both.
    pub times: Option<[Stamps; 2]>,
    /// Units, axes, signs or times that cannot be right.
    pub implausible: Vec<Implausible>,
    /// What was skipped in each log.
    pub skipped: Vec<(Log, Skipped)>,
}

impl NotAligned {
    fn reason(&self) -> String {
        let of_velocity = |what: &Implausible| matches!(what, Implausible::Velocity(_));
        let velocity = self.implausible.iter().any(of_velocity);
        match (self.failure, &self.times) {
            (AlignmentFailure::NoOverlap, Some([imu, gnss])) => no_overlap(imu, gnss),
            (AlignmentFailure::NoAttitude(RestFailure::TooSlow { .. }, _), _) if !velocity => {
                self.failure.to_string()
            }
            (failure @ AlignmentFailure::NoAttitude(RestFailure::TooSlow { .. }, _), _) => {
                format!("the log could not be aligned: by the GNSS velocity {failure}")
            }
            (failure, _) => format!("the log could not be aligned: {failure}"),
        }
    }
}

/// Two logs without a common time.
fn no_overlap(imu: &Stamps, gnss: &Stamps) -> String {
    let span = |of: &Stamps| format!("{} to {} s", rounded(of.first), rounded(of.last));
    let both = format!("the IMU ({}) and GNSS ({})", span(imu), span(gnss));
    match compare(imu, gnss) {
        ClockFault::Unit(log, unit) => {
            let (name, table) = match log {
                Log::Gnss => ("GNSS", "gnss"),
                _ => ("IMU", "imu"),
            };
            format!(
                "{both} do not overlap; {name} times look like {unit}: set {table}.time_unit = \"{unit}\""
            )
        }
        ClockFault::Unix(log) => {
            let (one, other, stamps) = match log {
                Log::Gnss => ("GNSS", "the IMU", imu),
                _ => ("the IMU", "GNSS", gnss),
            };
            format!(
                "the logs use different clocks: {one} has Unix time, {other} {}; set gnss.time_offset, or record both on one clock",
                match stamps.first {
                    first if (0.0..3600.0).contains(&first) => "time since boot".to_owned(),
                    _ => format!("another ({})", span(stamps)),
                }
            )
        }
        ClockFault::Hours(hours) => {
            let order = match hours > 0.0 {
                true => format!(
                    "GNSS begins at {} s, after the IMU ends at {} s",
                    rounded(gnss.first),
                    rounded(imu.last)
                ),
                false => format!(
                    "GNSS ends at {} s, before the IMU begins at {} s",
                    rounded(gnss.last),
                    rounded(imu.first)
                ),
            };
            format!(
                "{order}: about {} h apart (time zone?); add {} s to gnss.time_offset",
                hours.abs(),
                -3600.0 * hours
            )
        }
        ClockFault::Apart if gnss.first > imu.last || gnss.last < imu.first => {
            format!("{both} do not overlap: check both time columns, or set gnss.time_offset")
        }
        ClockFault::Apart => format!(
            "no GNSS fix ({}) lies within the IMU log ({}): check both time columns, or set gnss.time_offset",
            span(gnss),
            span(imu)
        ),
    }
}

/// A time to the millisecond.
fn rounded(time: f64) -> f64 {
    (time * 1e3).round() / 1e3
}
