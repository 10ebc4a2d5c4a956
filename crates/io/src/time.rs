//! Absolute times as GPS seconds of the week in which a file starts, counting on past its end, and
//! back to dates.

mod worded;

use chrono::{Datelike, NaiveDate};

use crate::number;

/// \[s\]
const HOUR: f64 = 3600.0;
/// \[s\]
pub(crate) const DAY: f64 = 86_400.0;
/// \[s\]
pub(crate) const WEEK: f64 = 604_800.0;

/// Time system of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TimeSystem {
    Gps,
    Utc,
    /// Japan: UTC + 9 h.
    Jst,
}

impl TimeSystem {
    pub(crate) fn named(name: &str) -> Option<Self> {
        match name {
            "GPST" => Some(Self::Gps),
            "UTC" => Some(Self::Utc),
            "JST" => Some(Self::Jst),
            _ => None,
        }
    }
}

/// Counts seconds from the beginning of the GPS week of the first time it is given.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct WeekClock {
    /// Days from the GPS epoch to that week.
    pub(crate) start: Option<i64>,
    /// Whether dates that end with the year begin with the month, once one was certain.
    month_first: Option<bool>,
}

/// Days from 31 December of the year before 1 AD to the GPS epoch.
const EPOCH: i64 = 722_820;
/// Days from the Unix to the GPS epoch.
const EPOCHS: i64 = 3657;

/// Unix time of the GPS epoch \[ns\].
pub(crate) const GPS_EPOCH_UNIX_NS: i64 = EPOCHS * DAY_MS * NS_OF_MS;

impl WeekClock {
    /// Seconds of the time that two fields give: date and time of day, or week and second.
    pub(crate) fn seconds(
        &mut self,
        first: &[u8],
        second: &[u8],
        system: TimeSystem,
    ) -> Option<f64> {
        let (day, seconds) = match date(first, b'/') {
            Some(day) => to_gps(day, time_of_day(second)?, system),
            None => {
                let week = number::parse(first)?;
                let seconds = number::parse(second)?;
                let plausible = (0.0..10_000.0).contains(&week) && week.fract() == 0.0;
                if !plausible || !(0.0..2.0 * WEEK).contains(&seconds) {
                    return None;
                }
                (week as i64 * 7, seconds)
            }
        };
        Some(self.gps(day, seconds))
    }

    /// Seconds of a GPS time: days from the GPS epoch, 6 January 1980 (a week is 7 of them), and
    /// seconds after their beginning.
    pub(crate) fn gps(&mut self, day: i64, seconds: f64) -> f64 {
        let start = *self.start.get_or_insert_with(|| {
            let whole = day + (seconds / DAY).floor() as i64;
            whole.div_euclid(7) * 7
        });
        (day - start) as f64 * DAY + seconds
    }

    /// Seconds of a UTC date and time of day \[s\]; `None` if that is no date.
    pub(crate) fn utc(&mut self, year: i64, month: i64, day: i64, seconds: f64) -> Option<f64> {
        Some(self.utc_day(day_of(year, month, day)?, seconds))
    }

    /// Seconds of a UTC day, from the GPS epoch, and time of day \[s\].
    pub(crate) fn utc_day(&mut self, day: i64, seconds: f64) -> f64 {
        let (day, seconds) = to_gps(day, seconds, TimeSystem::Utc);
        self.gps(day, seconds)
    }

    /// Seconds of a date and time `yyyy-mm-ddThh:mm:ss.sss` with `Z`, `+hh:mm`, `+hhmm` or nothing behind it
    /// (ISO 8601), which is UTC; a blank may stand for the T, strokes or points for the hyphens. Also `dd.mm.yyyy` and
    /// `dd/mm/yyyy` or, where that is no date or AM or PM follows the time, `mm/dd/yyyy`; and with the name of the month.
    pub(crate) fn date_time(&mut self, text: &[u8]) -> Option<f64> {
        self.of_numbers(text).or_else(|| {
            let (day, seconds, offset) = worded::date_time(text)?;
            Some(self.utc_day(day, seconds - offset))
        })
    }

    fn of_numbers(&mut self, text: &[u8]) -> Option<f64> {
        let at = text
            .iter()
            .position(|byte| matches!(byte, b'T' | b't' | b' '))?;
        let (date_part, rest) = (text.get(..at)?, text.get(at + 1..)?.trim_ascii_start());
        let date_part = date_part.strip_suffix(b",").unwrap_or(date_part);
        let rest = rest.strip_suffix(b" UTC").unwrap_or(rest);
        let zone_at = rest
            .iter()
            .position(|byte| matches!(byte, b'Z' | b'z' | b'+' | b'-'));
        let (time, zone) = rest.split_at_checked(zone_at.unwrap_or(rest.len()))?;
        let offset = match zone {
            [] | b"Z" | b"z" => 0.0,
            [sign, zone @ ..] => {
                let (hour, minute) = match zone {
                    [a, b] => ([a, b], b"00".as_slice()),
                    [a, b, b':', rest @ ..] | [a, b, rest @ ..] => ([a, b], rest),
                    _ => return None,
                };
                let size = of_day(&hour.map(|digit| *digit), minute, b"00")?;
                if *sign == b'-' { -size } else { size }
            }
        };
        let time = time.trim_ascii_end();
        let day = self.day(date_part, half_of_day(time).is_some())?;
        let seconds = time_of_day(time).or_else(|| time_of_digits(number::parse(time)?))?;
        Some(self.utc_day(day, seconds - offset))
    }

    /// Days from the GPS epoch to a date with hyphens, strokes or points: the year first; or last, the day first, but
    /// behind strokes and hyphens the month where a date before had a day beyond 12 there, or else `month_first`.
    pub(crate) fn day(&mut self, text: &[u8], month_first: bool) -> Option<i64> {
        let Some(&stroke) = text.iter().find(|byte| !byte.is_ascii_digit()) else {
            return day_of_digits(number::parse(text)?);
        };
        if !matches!(stroke, b'-' | b'/' | b'.') {
            return None;
        }
        let mut parts = text.split(|byte| *byte == stroke);
        let year_first = parts.clone().next()?.len() == 4;
        if let Some(month) = parts.clone().nth(1).and_then(worded::month) {
            let (first, _, last) = (parts.next()?, parts.next()?, parts.next()?);
            let (year, day) = if year_first {
                (first, last)
            } else {
                (last, first)
            };
            return day_of(whole(year)?, month, whole(day)?).filter(|_| parts.next().is_none());
        }
        if year_first {
            return date(text, stroke);
        }
        let (first, second, year) = (parts.next()?, parts.next()?, parts.next()?);
        let (first, second) = (whole(first)?, whole(second)?);
        let year = whole(year).filter(|_| year.len() == 4 && parts.next().is_none())?;
        let certain = match (stroke, first > 12, second > 12) {
            (b'.', ..) | (_, true, false) => Some(false),
            (_, false, true) => Some(true),
            _ => None,
        };
        self.month_first = certain.or(self.month_first);
        match self.month_first.unwrap_or(month_first) {
            true => day_of(year, first, second),
            false => day_of(year, second, first),
        }
    }

    /// Seconds of a Unix time. One before the GPS epoch is that of a clock which does not know the
    /// date, and is given back as it is.
    pub(crate) fn unix(&mut self, seconds: i64, nanoseconds: u32) -> f64 {
        let (day, second) = (seconds.div_euclid(86_400), seconds.rem_euclid(86_400));
        let fraction = f64::from(nanoseconds) * 1e-9;
        if day < EPOCHS {
            return seconds as f64 + fraction;
        }
        let utc_day = day - EPOCHS;
        // The whole seconds first: they are exact.
        let whole = self.gps(utc_day, second as f64 + leap_seconds(utc_day));
        whole + fraction
    }
}

/// A date and a time of day to the millisecond; of a clock without a date, the day is arbitrary.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Utc {
    /// Days from the GPS epoch.
    day: i64,
    /// Milliseconds of the day; beyond its end in a leap second.
    milli: i64,
}

const DAY_MS: i64 = 86_400_000;
const NS_OF_MS: i64 = 1_000_000;

/// Day in UTC, counted from the GPS epoch, of a GPS time \[ms\] since then.
fn utc_day(gps_ms: i64) -> i64 {
    let leap = leap_seconds(gps_ms.div_euclid(DAY_MS)) as i64 * 1000;
    // By the difference of a time at most some seconds later.
    (gps_ms - leap).div_euclid(DAY_MS)
}

/// UTC of a GPS time: nanoseconds since 6 January 1980.
pub(crate) fn utc(gps_ns: i64) -> Utc {
    let gps = gps_ns.div_euclid(NS_OF_MS) + i64::from(gps_ns.rem_euclid(NS_OF_MS) * 2 >= NS_OF_MS);
    let day = utc_day(gps);
    Utc {
        day,
        milli: gps - leap_seconds(day) as i64 * 1000 - day * DAY_MS,
    }
}

/// GPS time less UTC \[s\] at a GPS time: nanoseconds since 6 January 1980.
pub(crate) fn leap_seconds_at(gps_ns: i64) -> f64 {
    leap_seconds(utc_day(gps_ns.div_euclid(NS_OF_MS)))
}

/// The time of day of a clock that counts seconds from a midnight.
pub(crate) fn time_of_clock(seconds: f64) -> Option<Utc> {
    let known = seconds.is_finite() && seconds.abs() < 1e12;
    known.then(|| Utc {
        day: 0,
        milli: ((seconds * 1e3).round() as i64).rem_euclid(DAY_MS),
    })
}

impl Utc {
    /// Year, month, day.
    pub(crate) fn date(&self) -> [i64; 3] {
        let days = i32::try_from(self.day + EPOCH).unwrap_or_default();
        let date = NaiveDate::from_num_days_from_ce_opt(days).unwrap_or_default();
        let of_year = [date.month(), date.day()].map(i64::from);
        [i64::from(date.year()), of_year[0], of_year[1]]
    }

    /// Hour, minute, and milliseconds of the minute: 60 000 and more in a leap second.
    pub(crate) fn hms(&self) -> [i64; 3] {
        let minute = (self.milli / 60_000).min(24 * 60 - 1);
        [minute / 60, minute % 60, self.milli - minute * 60_000]
    }

    /// `yyyy-mm-ddThh:mm:ss.sssZ`; a leap second, which XML does not know, is its beginning.
    pub(crate) fn iso(&self) -> String {
        let ([year, month, day], [hour, minute, milli]) = (self.date(), self.hms());
        let milli = milli.min(59_999);
        format!(
            "{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{:02}.{:03}Z",
            milli / 1000,
            milli % 1000
        )
    }
}

/// Day and second of day in GPS time; the second may be outside of the day.
fn to_gps(day: i64, seconds: f64, system: TimeSystem) -> (i64, f64) {
    match system {
        TimeSystem::Gps => (day, seconds),
        TimeSystem::Utc => (day, seconds + leap_seconds(day)),
        TimeSystem::Jst => {
            let utc = seconds - 9.0 * 3600.0;
            let utc_day = if utc < 0.0 { day - 1 } else { day };
            (day, utc + leap_seconds(utc_day))
        }
    }
}

/// Days from the GPS epoch, 6 January 1980, to a date `yyyy/mm/dd`, with `stroke` as the separator.
pub(crate) fn date(field: &[u8], stroke: u8) -> Option<i64> {
    let mut parts = field.split(|&byte| byte == stroke).map(whole);
    let (year, month, day) = (parts.next()??, parts.next()??, parts.next()??);
    day_of(year, month, day).filter(|_| parts.next().is_none())
}

/// Days from the GPS epoch to a date whose digits are a number, `yyyymmdd` or, as NMEA has it, `ddmmyy`.
pub(crate) fn day_of_digits(number: f64) -> Option<i64> {
    let digits = Some(number as i64).filter(|whole| *whole as f64 == number)?;
    let (high, middle, low) = (digits / 10_000, digits / 100 % 100, digits % 100);
    match digits {
        10_000..1_000_000 => day_of(full_year(low), middle, high),
        _ => day_of(high, middle, low),
    }
}

/// The year of its last two digits; GPS began in 1980.
pub(crate) fn full_year(two: i64) -> i64 {
    if two < 80 { 2000 + two } else { 1900 + two }
}

/// Seconds of day of a time whose digits are a number, `hhmmss.sss`, or with hundredths or thousandths behind the seconds.
pub(crate) fn time_of_digits(number: f64) -> Option<f64> {
    let of_second = [1.0, 100.0, 1000.0]
        .into_iter()
        .find(|parts| number / parts < 240_000.0)?;
    let number = number / of_second;
    let [hour, minute, second] = [
        (number / 1e4).floor(),
        (number / 100.0).floor() % 100.0,
        number % 100.0,
    ];
    let plausible = number >= 0.0 && minute < 60.0 && second < 61.0;
    plausible.then_some(3600.0 * hour + 60.0 * minute + second)
}

/// Days from the GPS epoch to a date; `None` for a day that its month does not have.
pub(crate) fn day_of(year: i64, month: i64, day: i64) -> Option<i64> {
    let [month, day] = [u32::try_from(month).ok()?, u32::try_from(day).ok()?];
    let year = i32::try_from(year).ok()?;
    let date = NaiveDate::from_ymd_opt(year, month, day)?;
    let plausible = (1980..2200).contains(&year);
    plausible.then(|| i64::from(date.num_days_from_ce()) - EPOCH)
}

/// Seconds of day of `hh:mm:ss.sss` or `hh:mm:ss:sss`, to 12 hours with AM or PM behind; the second may be 60. Also minutes
/// and seconds with a fraction, `mm:ss.s`.
pub(crate) fn time_of_day(field: &[u8]) -> Option<f64> {
    let half = half_of_day(field);
    let field = half.map_or(field, |(time, _)| time);
    let mut parts = field.split(|&byte| byte == b':');
    let (first, second) = (parts.next()?, parts.next()?);
    let time = match (parts.next(), parts.next(), parts.next()) {
        (Some(third), None, _) => of_day(first, second, third)?,
        (Some(third), Some(thousandths), None) if thousandths.len() == 3 => {
            of_day(first, second, third)? + whole(thousandths)? as f64 * 1e-3
        }
        (None, ..) if second.iter().any(|byte| matches!(byte, b'.' | b',')) => {
            let second = number::parse_with_comma(second).filter(|s| (0.0..61.0).contains(s))?;
            whole(first)? as f64 * 60.0 + second
        }
        _ => return None,
    };
    match half {
        None => Some(time),
        Some((_, after)) if (HOUR..13.0 * HOUR).contains(&time) => Some(time % (DAY / 2.0) + after),
        Some(_) => None,
    }
}

/// A time of day before `AM` or `PM`, and the seconds of the half of the day that this adds.
fn half_of_day(field: &[u8]) -> Option<(&[u8], f64)> {
    let (time, half) = field.split_at_checked(field.len().checked_sub(2)?)?;
    let after = match half {
        b"AM" | b"am" => 0.0,
        b"PM" | b"pm" => DAY / 2.0,
        _ => return None,
    };
    Some((time.trim_ascii_end(), after))
}

/// Seconds of day of an hour, a minute and a second, which may be 60 and have a decimal comma (ISO 8601).
pub(crate) fn of_day(hour: &[u8], minute: &[u8], second: &[u8]) -> Option<f64> {
    let second = number::parse_with_comma(second)?;
    let (hour, minute) = (whole(hour)?, whole(minute)?);
    let plausible = hour < 24 && minute < 60 && (0.0..61.0).contains(&second);
    plausible.then(|| (hour * 3600 + minute * 60) as f64 + second)
}

/// A whole number of at most four digits.
pub(crate) fn whole(field: &[u8]) -> Option<i64> {
    if field.is_empty() || field.len() > 4 {
        return None;
    }
    field.iter().try_fold(0, |sum, byte| match byte {
        b'0'..=b'9' => Some(sum * 10 + i64::from(byte - b'0')),
        _ => None,
    })
}

/// GPS time minus UTC \[s\] on a UTC day counted from the GPS epoch (IERS Bulletin C).
fn leap_seconds(day: i64) -> f64 {
    /// Year and month on whose first day the difference grew by one second.
    const STEPS: [(i64, i64); 18] = [
        (1981, 7),
        (1982, 7),
        (1983, 7),
        (1985, 7),
        (1988, 1),
        (1990, 1),
        (1991, 1),
        (1992, 7),
        (1993, 7),
        (1994, 7),
        (1996, 1),
        (1997, 7),
        (1999, 1),
        (2006, 1),
        (2009, 1),
        (2012, 7),
        (2015, 7),
        (2017, 1),
    ];
    let before = |&&(year, month): &&(i64, i64)| day_of(year, month, 1).is_some_and(|at| at <= day);
    STEPS.iter().take_while(before).count() as f64
}

#[cfg(test)]
mod tests;
