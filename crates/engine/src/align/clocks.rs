//! How the clocks of two logs differ that do not overlap.

use core::{fmt, ops::Range};
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use undrift_events::Log;

/// First and last time stamp of a log, and how many there are. Its text gives the span to the millisecond.
///
/// ```
/// use undrift_engine::align::Stamps;
/// let imu = Stamps { first: 1.00049, last: 61.0, count: 6000 };
/// assert_eq!(imu.to_string(), "1 to 61 s");
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub struct Stamps {
    /// First stamp \[s\], in the log's own time base.
    pub first: f64,
    /// Last stamp \[s\].
    pub last: f64,
    /// Number of stamps.
    pub count: u64,
}

/// The likeliest reason why an inertial and a GNSS log have no time in common.
///
/// Found from the stamps alone: a factor between the spans that is a unit's, a first stamp that only Unix time
/// has, a difference of whole hours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ClockFault {
    /// This log counts in this unit (`"ms"`, `"us"`, `"ns"`, `"d"`), not in seconds.
    Unit(Log, &'static str),
    /// This log has Unix time, the other has not.
    Unix(Log),
    /// GNSS is this many whole hours ahead of the inertial log, as by a time zone.
    Hours(f64),
    /// Anything else: logs of different drives, perhaps.
    Apart,
}

/// Units of time, by which the other log is as many times shorter.
const UNITS: [(&str, f64); 4] = [("ms", 1e3), ("us", 1e6), ("ns", 1e9), ("d", 1.0 / 86_400.0)];
const HOUR: f64 = 3600.0;
/// Spans of the same drive differ by less than this factor.
const SAME_DRIVE: f64 = 2.0;
/// No receiver has a shorter interval \[s\].
const SHORTEST_FIX: f64 = 0.01;
/// No IMU has a shorter interval \[s\].
const SHORTEST_SAMPLE: f64 = 2e-5;
/// Unix times of the years 2001 to 2065 \[s\].
const UNIX: Range<f64> = 1e9..3e9;
/// Times since boot, of the day and of the week are less than this \[s\].
const NOT_UNIX: f64 = 1e8;
/// Time zones and days: logs that are more hours apart differ in something else.
const MOST_HOURS: f64 = 24.0;
/// Logs of a drive begin at most so long one after the other to be whole hours apart \[s\].
const TOGETHER: f64 = 300.0;

impl fmt::Display for Stamps {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} to {} s", rounded(self.first), rounded(self.last))
    }
}

/// `time` \[s\] rounded to the millisecond, for messages.
///
/// ```
/// assert_eq!(undrift_engine::align::rounded(12.345_678), 12.346);
/// ```
pub fn rounded(time: f64) -> f64 {
    (time * 1e3).round() / 1e3
}

impl Stamps {
    /// These stamps with one more, later stamp \[s\].
    pub(crate) fn and(before: Option<Self>, time: f64) -> Self {
        before.map_or(
            Self {
                first: time,
                last: time,
                count: 1,
            },
            |before| Self {
                last: time,
                count: before.count + 1,
                ..before
            },
        )
    }

    /// Time from the first stamp to the last \[s\].
    fn span(&self) -> f64 {
        self.last - self.first
    }

    /// Mean time between two stamps \[s\].
    fn interval(&self) -> f64 {
        self.span() / self.count.saturating_sub(1).max(1) as f64
    }
}

/// The likeliest difference between the clocks of two logs without a common time.
pub(crate) fn compare(imu: &Stamps, gnss: &Stamps) -> ClockFault {
    let longer = |long: &Stamps, short: &Stamps, shortest: f64| {
        let is = |(_, factor): &&(&str, f64)| {
            let ratio = long.span() / short.span() / factor;
            (1.0 / SAME_DRIVE..SAME_DRIVE).contains(&ratio) && long.interval() / factor >= shortest
        };
        UNITS.iter().find(is).map(|(unit, _)| *unit)
    };
    if let Some(unit) = longer(gnss, imu, SHORTEST_FIX) {
        return ClockFault::Unit(Log::Gnss, unit);
    }
    if let Some(unit) = longer(imu, gnss, SHORTEST_SAMPLE) {
        return ClockFault::Unit(Log::Imu, unit);
    }
    match (UNIX.contains(&imu.first), UNIX.contains(&gnss.first)) {
        (false, true) if imu.last.abs() < NOT_UNIX => return ClockFault::Unix(Log::Gnss),
        (true, false) if gnss.last.abs() < NOT_UNIX => return ClockFault::Unix(Log::Imu),
        _ => {}
    }
    let apart = gnss.first - imu.first;
    let hours = (apart / HOUR).round();
    let rest = apart - hours * HOUR;
    let overlap = imu.last.min(gnss.last - hours * HOUR) - imu.first.max(imu.first + rest);
    if hours != 0.0 && hours.abs() <= MOST_HOURS && rest.abs() < TOGETHER && overlap > 0.0 {
        return ClockFault::Hours(hours);
    }
    ClockFault::Apart
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From a time on, at a rate \[Hz\], so long \[s\].
    fn stamps(first: f64, rate: f64, length: f64) -> Stamps {
        Stamps {
            first,
            last: first + length,
            count: (rate * length) as u64 + 1,
        }
    }

    #[test]
    fn differences_of_clocks() {
        let imu = stamps(0.01, 100.0, 140.0);
        let times = |s: Stamps, factor: f64| Stamps {
            first: s.first * factor,
            last: s.last * factor,
            ..s
        };
        let fixes = |first| stamps(first, 2.0, 139.0);
        for (gnss, fault) in [
            (times(fixes(1.0), 1e3), ClockFault::Unit(Log::Gnss, "ms")),
            (times(fixes(1.0), 1e6), ClockFault::Unit(Log::Gnss, "us")),
            (times(fixes(1.7e9), 1e9), ClockFault::Unit(Log::Gnss, "ns")),
            (
                times(fixes(4e9), 1.0 / 86_400.0),
                ClockFault::Unit(Log::Gnss, "d"),
            ),
            (fixes(1.7e9), ClockFault::Unix(Log::Gnss)),
            (fixes(3601.0), ClockFault::Hours(1.0)),
            (fixes(-7200.0), ClockFault::Hours(-2.0)),
            (fixes(243_000.0), ClockFault::Apart),
            // A longer drive of another day; as many times longer as a unit, but at a rate that no receiver has.
            (stamps(1e6, 1.0, 5000.0), ClockFault::Apart),
            (stamps(1e6, 1.0, 140_000.0), ClockFault::Apart),
            (stamps(500.0, 1.0, 100.0), ClockFault::Apart),
        ] {
            assert_eq!(compare(&imu, &gnss), fault, "{gnss:?}");
        }
        assert_eq!(
            compare(&stamps(1.7e9, 100.0, 140.0), &fixes(1.0)),
            ClockFault::Unix(Log::Imu)
        );
        let in_ms = times(stamps(1e6, 100.0, 140.0), 1e3);
        assert_eq!(
            compare(&in_ms, &fixes(1.0)),
            ClockFault::Unit(Log::Imu, "ms")
        );
    }

    #[test]
    fn stamps_are_collected() {
        let all = [1.0, 2.0, 5.0]
            .into_iter()
            .fold(None, |before, time| Some(Stamps::and(before, time)));
        assert_eq!(
            all,
            Some(Stamps {
                first: 1.0,
                last: 5.0,
                count: 3
            })
        );
    }
}
