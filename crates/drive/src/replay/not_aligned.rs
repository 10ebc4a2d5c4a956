//! Why a log has no alignment.

use super::{Implausible, Log};
use crate::align::{AlignmentFailure, ClockFault, RestFailure, Stamps, rounded};
use undrift_engine as engine;
use undrift_io::skipped::Skipped;

/// A log without an alignment, and what is known of why.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{}", self.reason())]
pub struct NotAligned {
    /// What the navigator knows of it.
    pub why: engine::NotAligned,
    /// Whether the mounting was to be found on the way.
    pub finds_mounting: bool,
    /// What was skipped in each log.
    pub skipped: Vec<(Log, Skipped)>,
}

impl NotAligned {
    fn reason(&self) -> Reason {
        let of_velocity = |what: &Implausible| matches!(what, Implausible::Velocity(_));
        let slow = matches!(
            self.why.failure,
            AlignmentFailure::NoAttitude(
                RestFailure::TooSlow { .. } | RestFailure::NeverMoved { .. },
                _
            )
        );
        match (self.why.failure, self.why.times) {
            (AlignmentFailure::NoOverlap, Some(([imu, gnss], fault))) => {
                Reason::of_clocks(imu, gnss, fault)
            }
            (failure, _) if slow && self.why.implausible.iter().any(of_velocity) => {
                Reason::ByVelocity(failure)
            }
            (failure, _) if slow => Reason::Slow(failure),
            (failure, _) if self.finds_mounting => Reason::InSensorAxes(failure),
            (failure, _) => Reason::Failure(failure),
        }
    }
}

/// The likeliest reason.
#[derive(Debug, thiserror::Error)]
enum Reason {
    #[error("the log could not be aligned: {0}")]
    Failure(AlignmentFailure),
    #[error(
        "the log could not be aligned: {0}; nor is it known how the IMU sits: set imu.mounting or imu.axes"
    )]
    InSensorAxes(AlignmentFailure),
    #[error("{0}")]
    Slow(AlignmentFailure),
    #[error("the log could not be aligned: by the GNSS velocity {0}")]
    ByVelocity(AlignmentFailure),
    #[error(
        "the IMU ({imu}) and GNSS ({gnss}) do not overlap; {log} times look like {unit}: set {table}.time_unit = \"{unit}\""
    )]
    Unit {
        imu: Stamps,
        gnss: Stamps,
        log: &'static str,
        table: &'static str,
        unit: &'static str,
    },
    #[error(
        "the logs use different clocks: {unix} has Unix time, {other} time since boot; if both begin at the same moment, add {start} s to gnss.time_offset"
    )]
    UnixAndBoot {
        unix: &'static str,
        other: &'static str,
        start: f64,
    },
    #[error(
        "the logs use different clocks: {unix} has Unix time, {other} another ({stamps}); if both begin at the same moment, add {start} s to gnss.time_offset"
    )]
    UnixAndOther {
        unix: &'static str,
        other: &'static str,
        stamps: Stamps,
        start: f64,
    },
    #[error(
        "GNSS begins at {} s, after the IMU ends at {} s: about {hours} h apart (time zone?); add {} s to gnss.time_offset",
        rounded(gnss.first), rounded(imu.last), -3600.0 * hours
    )]
    HoursLate {
        imu: Stamps,
        gnss: Stamps,
        hours: f64,
    },
    #[error(
        "GNSS ends at {} s, before the IMU begins at {} s: about {hours} h apart (time zone?); add {} s to gnss.time_offset",
        rounded(gnss.last), rounded(imu.first), 3600.0 * hours
    )]
    HoursEarly {
        imu: Stamps,
        gnss: Stamps,
        hours: f64,
    },
    #[error(
        "the IMU ({imu}) and GNSS ({gnss}) do not overlap: check both time columns; if both begin at the same moment, add {} s to gnss.time_offset",
        rounded(imu.first - gnss.first)
    )]
    Apart { imu: Stamps, gnss: Stamps },
    #[error(
        "no GNSS fix ({gnss}) lies within the IMU log ({imu}): check both time columns, or set gnss.time_offset"
    )]
    NoneWithin { imu: Stamps, gnss: Stamps },
}

impl Reason {
    /// The error of two logs without a common time.
    fn of_clocks(imu: Stamps, gnss: Stamps, fault: ClockFault) -> Self {
        const GNSS: &str = "GNSS";
        match fault {
            ClockFault::Unit(of, unit) => {
                let (log, table) = match of {
                    Log::Gnss => (GNSS, "gnss"),
                    _ => ("IMU", "imu"),
                };
                Self::Unit {
                    imu,
                    gnss,
                    log,
                    table,
                    unit,
                }
            }
            ClockFault::Unix(of) => {
                let (unix, other, stamps) = match of {
                    Log::Gnss => (GNSS, "the IMU", imu),
                    _ => ("the IMU", GNSS, gnss),
                };
                let start = rounded(imu.first - gnss.first);
                match (0.0..3600.0).contains(&stamps.first) {
                    true => Self::UnixAndBoot { unix, other, start },
                    false => Self::UnixAndOther {
                        unix,
                        other,
                        stamps,
                        start,
                    },
                }
            }
            ClockFault::Hours(hours) if hours > 0.0 => Self::HoursLate { imu, gnss, hours },
            ClockFault::Hours(hours) => Self::HoursEarly {
                imu,
                gnss,
                hours: -hours,
            },
            ClockFault::Apart if gnss.first > imu.last || gnss.last < imu.first => {
                Self::Apart { imu, gnss }
            }
            ClockFault::Apart => Self::NoneWithin { imu, gnss },
        }
    }
}
