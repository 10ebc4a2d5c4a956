//! The date of a log: what its time zero is in GPS time and UTC.

use crate::time::{self, DAY, Utc, WEEK, WeekClock};

const NANOS: f64 = 1e9;
/// Nanoseconds of a week.
const WEEK_NS: i64 = 604_800_000_000_000;
/// Numbers of a table that are Unix times \[s\]: 2001 to 2096.
const UNIX_TIMES: std::ops::Range<f64> = 1e9..4e9;
/// GPS seconds since 1980 up to 2030, which are Unix times too: up to 2020.
const GPS_TIMES: std::ops::Range<f64> = 1e9..1.6e9;

/// Day numbers of spreadsheets between 1982 and 2119.
const DAY_NUMBERS: std::ops::Range<f64> = 30_000.0..80_000.0;
/// That of the Unix epoch.
const UNIX_DAY: f64 = 25_569.0;

/// Source of the date of a log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClockSource {
    /// A GNSS receiver.
    Gnss,
    /// Dates of UTC, or Unix times, whatever clock they are from.
    Utc,
    /// The clock of the computer or telephone that recorded.
    Host,
    /// That clock at the time of receipt: the records have no stamps of their own.
    Receipt,
    /// Dates without a time zone, read as UTC.
    NoZone,
    /// The user.
    Stated,
}

impl ClockSource {
    /// Its name in results.
    pub fn name(self) -> &'static str {
        match self {
            Self::Gnss => "gnss",
            Self::Utc => "utc",
            Self::Host => "host",
            Self::Receipt => "receipt",
            Self::NoZone => "no-zone",
            Self::Stated => "stated",
        }
    }
}

/// Time zero of a log. From there its times go on as GPS time does, without leap seconds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Epoch {
    /// GPS time: nanoseconds since 6 January 1980.
    gps_ns: i64,
    /// Its source.
    pub clock: ClockSource,
}

impl Epoch {
    /// The beginning of a GPS week, not rolled over.
    pub fn of_week(week: u32, clock: ClockSource) -> Self {
        Self {
            gps_ns: i64::from(week) * WEEK_NS,
            clock,
        }
    }

    /// Of a log whose time `at` \[s\] is the Unix time `unix` \[s\]; `None` before 1980.
    pub fn of_unix(unix: f64, at: f64, clock: ClockSource) -> Option<Self> {
        let mut weeks = WeekClock::default();
        let plausible = (0.0..1e11).contains(&unix) && at.is_finite() && at.abs() < 1e10;
        let whole = unix.floor();
        let nanos = ((unix - whole) * NANOS) as u32;
        let seconds = plausible.then(|| weeks.unix(whole as i64, nanos))?;
        Some(weeks.epoch(clock)?.shifted(seconds - at))
    }

    /// Of a table's first time \[s\], if that is a Unix time; not where its column's name speaks of GPS and the
    /// number may be seconds since 1980.
    pub(crate) fn of_number(first: f64, column: &str) -> Option<Self> {
        let ambiguous = column.to_ascii_lowercase().contains("gps") && GPS_TIMES.contains(&first);
        if ambiguous || !UNIX_TIMES.contains(&first) {
            return None;
        }
        Self::of_unix(first, first, ClockSource::Utc)
    }

    /// Of a table whose first time, in days of 86 400 s, is the day number of a spreadsheet, in no stated time zone.
    pub(crate) fn of_days(first: f64) -> Option<Self> {
        let unix = (first - UNIX_DAY) * DAY;
        let known = DAY_NUMBERS.contains(&first);
        known.then(|| Self::of_unix(unix, first * DAY, ClockSource::NoZone))?
    }

    /// As users state it: a date and time of day in UTC, or `week 2374` of GPS.
    pub fn stated(text: &str) -> Option<Self> {
        let clock = ClockSource::Stated;
        if let Some(week) = text.trim().strip_prefix("week ") {
            let week = week.trim().parse().ok().filter(|week| *week < 10_000)?;
            return Some(Self::of_week(week, clock));
        }
        let mut weeks = WeekClock::default();
        let seconds = weeks.date_time(text.trim().as_bytes())?;
        Some(weeks.epoch(clock)?.shifted(seconds))
    }

    /// The epoch of times that count from `seconds` \[s\] later.
    #[must_use]
    pub fn shifted(self, seconds: f64) -> Self {
        Self {
            gps_ns: self.gps_ns.saturating_add(nanoseconds(seconds)),
            ..self
        }
    }

    /// How much later than another epoch it is \[s\]: what is added to times of this one for those of the other.
    pub fn after(self, other: Self) -> f64 {
        let ns = self.gps_ns.saturating_sub(other.gps_ns);
        (ns / 1_000_000_000) as f64 + (ns % 1_000_000_000) as f64 / NANOS
    }

    /// GPS week and the seconds of it at a time of the log \[s\].
    pub fn week_second(self, time: f64) -> (i64, f64) {
        let (weeks, second) = (
            self.gps_ns.div_euclid(WEEK_NS),
            self.gps_ns.rem_euclid(WEEK_NS) as f64 / NANOS + time,
        );
        let more = (second / WEEK).floor();
        (weeks + more as i64, second - more * WEEK)
    }

    /// GPS time less UTC at a time of the log \[s\].
    pub fn leap_seconds(self, time: f64) -> f64 {
        time::leap_seconds_at(self.gps_ns(time))
    }

    /// Nanoseconds of Unix time at a time of the log \[s\].
    pub fn unix_ns(self, time: f64) -> i64 {
        let unix = self.gps_ns(time).saturating_add(time::GPS_EPOCH_UNIX_NS);
        unix.saturating_sub((self.leap_seconds(time) * NANOS) as i64)
    }

    /// Unix time at a time of the log \[s\].
    pub fn unix(self, time: f64) -> f64 {
        let ns = self.unix_ns(time);
        ns.div_euclid(1_000_000_000) as f64 + ns.rem_euclid(1_000_000_000) as f64 / NANOS
    }

    /// UTC at a time of the log \[s\] as `yyyy-mm-ddThh:mm:ss.sssZ`.
    pub fn iso(self, time: f64) -> String {
        self.utc(time).iso()
    }

    /// UTC at a time of the log \[s\].
    pub(crate) fn utc(self, time: f64) -> Utc {
        time::utc(self.gps_ns(time))
    }

    fn gps_ns(self, time: f64) -> i64 {
        self.gps_ns.saturating_add(nanoseconds(time))
    }
}

/// Counts on from the GPS week of the first row of a table.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Weeks {
    first: Option<f64>,
}

impl Weeks {
    /// From the beginning of the first row's week to that of this row's \[s\]; 0 of a table without weeks.
    pub(crate) fn since_first(&mut self, week: Option<f64>) -> f64 {
        let first = *self.first.get_or_insert(week.unwrap_or(0.0));
        WEEK * (week.unwrap_or(first) - first)
    }

    /// Their time zero, once there was a row.
    pub(crate) fn epoch(&self) -> Option<Epoch> {
        // 0 is what programs write that do not know it.
        let week = self.first.filter(|week| (1.0..10_000.0).contains(week))?;
        Some(Epoch::of_week(week as u32, ClockSource::Gnss))
    }
}

impl WeekClock {
    /// What the seconds count from, once a time was given.
    pub(crate) fn epoch(&self, clock: ClockSource) -> Option<Epoch> {
        let week = u32::try_from(self.start?.div_euclid(7)).ok()?;
        Some(Epoch::of_week(week, clock))
    }
}

/// Seconds in nanoseconds, the whole ones exactly.
pub(crate) fn nanoseconds(seconds: f64) -> i64 {
    let whole = seconds.floor();
    (whole as i64)
        .saturating_mul(1_000_000_000)
        .saturating_add(((seconds - whole) * NANOS).round() as i64)
}

#[cfg(test)]
mod tests {
    use super::*;

    const GNSS: ClockSource = ClockSource::Gnss;

    #[test]
    fn one_instant_by_every_clock() {
        // 8 July 2025 19:34:00.5 UTC: week 2374, second 243258.5; Unix time by `date -u +%s`.
        let unix = 1_752_003_240.5;
        let week = Epoch::of_week(2374, GNSS);
        assert_eq!(week.iso(243_258.5), "2025-07-08T19:34:00.500Z");
        assert_eq!(week.unix(243_258.5), unix);
        assert_eq!(week.unix_ns(243_258.5), 1_752_003_240_500_000_000);
        assert_eq!(week.leap_seconds(243_258.5), 18.0);
        let boot = Epoch::of_unix(unix, 12.25, GNSS).unwrap();
        assert_eq!(boot.iso(12.25), "2025-07-08T19:34:00.500Z");
        assert_eq!(boot.after(week), 243_258.5 - 12.25);
        assert_eq!(boot.week_second(12.25), (2374, 243_258.5));
        let numbers = Epoch::of_number(unix, "timestamp").unwrap();
        assert_eq!(numbers.unix(unix + 60.0), unix + 60.0);
        let stated = Epoch::stated("2025-07-08T21:34:00.5+02:00").unwrap();
        assert_eq!(stated.after(week), 243_258.5);
        assert_eq!(Epoch::stated("week 2374").unwrap().after(week), 0.0);
        assert_eq!(week.shifted(1.5).after(week), 1.5);
        assert_eq!(week.after(week.shifted(1.5)), -1.5);
    }

    #[test]
    fn day_numbers_are_dates() {
        // 8 July 2025 19:34:00 UTC: 45846 in Excel, DATEVALUE("2025-07-08").
        let day = 45_846.0 + 70_440.0 / DAY;
        let epoch = Epoch::of_days(day).unwrap();
        // Doubles of 45 846 days have steps of 6e-7 s.
        assert!((epoch.unix(day * DAY) - 1_752_003_240.0).abs() < 2e-6);
        assert_eq!(epoch.clock, ClockSource::NoZone);
        for number in [0.5, 20_000.0, 100_000.0, 1e6, f64::NAN] {
            assert_eq!(Epoch::of_days(number), None, "{number}");
        }
    }

    #[test]
    fn numbers_that_are_no_dates() {
        for (number, column) in [
            (243_258.5, "t"),
            (1.4e9, "GPSTime"),
            (5e9, "t"),
            (-1.0, "t"),
        ] {
            assert_eq!(Epoch::of_number(number, column), None, "{column} {number}");
        }
        assert!(Epoch::of_number(1.7e9, "gps_time").is_some());
        assert_eq!(Epoch::of_unix(12.0, 0.0, GNSS), None);
        assert_eq!(Epoch::of_unix(f64::NAN, 0.0, GNSS), None);
        for text in [
            "",
            "week",
            "week x",
            "week 10000",
            "2374",
            "2025-13-01T00:00:00Z",
            "12:00:00",
        ] {
            assert_eq!(Epoch::stated(text), None, "{text}");
        }
    }

    #[test]
    fn a_leap_second_is_counted() {
        // The end of 2016: week 1930 began 17 s before it.
        let week = Epoch::of_week(1930, GNSS);
        assert_eq!(week.leap_seconds(16.9), 17.0);
        assert_eq!(week.leap_seconds(18.1), 18.0);
        assert_eq!(week.iso(18.0), "2017-01-01T00:00:00.000Z");
        assert_eq!(week.unix(18.0), 1_483_228_800.0);
        assert_eq!(week.unix(16.0), 1_483_228_799.0);
    }

    #[test]
    fn gps_times_become_dates() {
        let utc = |week, seconds| Epoch::of_week(week, GNSS).utc(seconds);
        let iso = |week, seconds| utc(week, seconds).iso();
        assert_eq!(iso(2374, 243_258.5), "2025-07-08T19:34:00.500Z");
        assert_eq!(iso(0, 0.0), "1980-01-06T00:00:00.000Z");
        // 29 February 2024, a Thursday, 18 s of leap seconds later.
        assert_eq!(iso(2303, 4.0 * DAY + 18.0), "2024-02-29T00:00:00.000Z");
        assert_eq!(iso(2303, 5.0 * DAY + 17.0), "2024-02-29T23:59:59.000Z");
        assert_eq!(iso(2303, 5.0 * DAY + 17.9996), "2024-03-01T00:00:00.000Z");
        // Counting on past the end of the week is the next one, and back.
        assert_eq!(utc(2373, WEEK + 5.0), utc(2374, 5.0));
        assert_eq!(utc(2375, 5.0 - WEEK), utc(2374, 5.0));
        // The leap second before 1 January 2017, a Sunday of GPS week 1930.
        let leap = utc(1930, 17.25);
        assert_eq!(
            (leap.date(), leap.hms()),
            ([2016, 12, 31], [23, 59, 60_250])
        );
        assert_eq!(iso(1930, 18.0), "2017-01-01T00:00:00.000Z");
        assert_eq!(iso(1930, 16.999), "2016-12-31T23:59:59.999Z");
    }

    proptest::proptest! {
        #[test]
        fn any_gps_time_survives_its_date(week in 0u32..9_000, milli in 0i64..604_800_000) {
            let seconds = milli as f64 / 1e3;
            let there = Epoch::of_week(week, GNSS).utc(seconds);
            let ([year, month, day], [hour, minute, rest]) = (there.date(), there.hms());
            let of_day = (hour * 3600 + minute * 60) as f64 + rest as f64 / 1e3;
            let mut weeks = WeekClock::default();
            // The clock starts at the week before.
            weeks.gps(i64::from(week) * 7 - 7, 0.0);
            let back = weeks.utc(year, month, day, of_day).unwrap() - WEEK;
            proptest::prop_assert!((back - seconds).abs() < 1e-6, "{there:?}: {back} {seconds}");
        }
    }
}
