//! Times that are text: a date with a time of day, a time of day alone, or one with the date in a column of its
//! own,
//! or with the GPS week there; and angles in degrees, minutes and seconds, or with a column of hemispheres behind them.
//!
//! Dates are UTC and become GPS seconds of the week in which the file starts, as in the logs that have
//! absolute times; GPS weeks with seconds of the week are GPS time. Times of day without a date are seconds of the day in which the file starts, counting on
//! past midnight.

use super::wanted::{Angles, Defect, TableOptions};
use crate::angle;
use crate::epoch::{ClockSource, Epoch};
use crate::skipped::shown;
use crate::time::{self, DAY, WeekClock};

/// Places of the columns of hemispheres behind latitude and longitude, which are not in the row read.
pub(super) const HEMISPHERES: [usize; 2] = [usize::MAX - 1, usize::MAX];

/// Makes numbers of the texts in the columns of times and angles.
#[derive(Clone, Debug)]
pub(super) struct Stamps {
    /// Places of time and date in the row read; that of the date is behind all others.
    time: usize,
    date: Option<usize>,
    /// What the numbers of the column are to be multiplied by for seconds.
    scale: f64,
    weeks: WeekClock,
    /// What the first date was.
    clock: Option<ClockSource>,
    /// Of this row: the GPS week, days from the GPS epoch, and the time of day where it is text \[s\].
    week: Option<i64>,
    day: Option<i64>,
    of_day: Option<f64>,
    /// Date and time of day are numbers of their digits.
    in_digits: bool,
    /// The last time of day, and midnights since the first \[s\].
    last: f64,
    midnights: f64,
    angles: Option<Angles>,
    /// Whether latitude and longitude have columns of hemispheres, and what these have in this row.
    pub(super) hemispheres: [bool; 2],
    signs: [f64; 2],
}

impl Stamps {
    /// Of the column of times that is wanted.
    pub(super) fn from_options(options: &TableOptions) -> Option<Self> {
        let stamp = options.stamp.as_ref()?;
        Some(Self {
            time: stamp.place,
            date: stamp.date.as_ref().map(|_| options.columns.len()),
            scale: stamp.scale,
            weeks: WeekClock::default(),
            clock: None,
            week: None,
            day: None,
            of_day: None,
            in_digits: false,
            last: 0.0,
            midnights: 0.0,
            angles: options.angles,
            hemispheres: [false; 2],
            signs: [f64::NAN; 2],
        })
    }

    /// Forgets the row before, which may have had one part alone.
    pub(super) fn start(&mut self) {
        (self.week, self.day, self.of_day) = (None, None, None);
        self.signs = [f64::NAN; 2];
    }

    /// Whether times, or what belongs to them, are in this place of the row read.
    pub(super) fn is_time(&self, slot: usize) -> bool {
        slot == self.time || Some(slot) == self.date
    }

    /// What the dates count from, once there was one.
    pub(super) fn epoch(&self) -> Option<Epoch> {
        self.weeks.epoch(self.clock?)
    }

    /// Takes a number in this place of the row read: in the column of dates it is a GPS week, or the digits of a date.
    pub(super) fn number(&mut self, slot: usize, value: f64) {
        if self.date != Some(slot) {
            return;
        }
        if value.fract() == 0.0 && (1.0..10_000.0).contains(&value) {
            self.week = Some(value as i64);
        } else {
            self.day = time::day_of_digits(value);
            self.in_digits = true;
        }
    }

    /// The number for a text in this place of the row read; `None` if it is neither time nor angle.
    pub(super) fn read(&mut self, slot: usize, text: &[u8]) -> Option<f64> {
        if let Some(k) = HEMISPHERES.iter().position(|place| *place == slot) {
            self.signs[k] = angle::hemisphere(text)?;
            return Some(0.0);
        }
        if let Some(angles) = self.angles.filter(|angles| angles.places().contains(&slot)) {
            return angles.number(text);
        }
        if self.date == Some(slot) {
            self.day = Some(self.weeks.day(text, false)?);
            return Some(0.0);
        }
        if self.time != slot {
            return None;
        }
        if self.date.is_some() {
            self.of_day = Some(time::time_of_day(text)?);
            return Some(0.0);
        }
        let seconds = match self.weeks.date_time(text) {
            Some(seconds) => {
                self.clock.get_or_insert(zone(text));
                seconds
            }
            None => self.counted_on(time::time_of_day(text)?),
        };
        Some(seconds / self.scale)
    }

    /// A time of day, counting on past midnight.
    fn counted_on(&mut self, of_day: f64) -> f64 {
        // A step back by more than half a day is midnight, one forward by as much a row that overtook.
        let step = ((of_day - self.last) / DAY).round();
        if self.last + self.midnights > 0.0 {
            self.midnights -= step * DAY;
        }
        self.last = of_day;
        of_day + self.midnights
    }

    /// Puts the time of day and the date of a row together, and angles and their hemispheres.
    ///
    /// # Errors
    /// If there is no such date.
    pub(super) fn finish(&mut self, out: &mut [f64]) -> Result<(), Defect> {
        for (k, place) in self.angles.iter().flat_map(Angles::places).enumerate() {
            if let (true, Some(angle)) = (self.hemispheres[k], out.get_mut(place)) {
                *angle = angle.abs() * self.signs[k];
            }
        }
        let (week, day, of_day) = (self.week.take(), self.day.take(), self.of_day.take());
        let Some(place) = out.get_mut(self.time).filter(|_| self.date.is_some()) else {
            return Ok(());
        };
        let of_digits = || time::time_of_digits(*place).filter(|_| self.in_digits);
        let seconds = of_day.or_else(of_digits).unwrap_or(*place * self.scale);
        let (time, clock) = match (day, week.filter(|_| of_day.is_none())) {
            (Some(day), _) => (self.weeks.utc_day(day, seconds), ClockSource::NoZone),
            (None, Some(week)) => (self.weeks.gps(week * 7, seconds), ClockSource::Gnss),
            (None, None) => {
                let wanted = shown(b"yyyy-mm-dd");
                return Err(Defect::Text(format!("no date {wanted} … or GPS week")));
            }
        };
        self.clock.get_or_insert(clock);
        *place = time / self.scale;
        Ok(())
    }
}

/// Whether a date and time states its zone.
fn zone(text: &[u8]) -> ClockSource {
    let time = text.get(10..).unwrap_or_default();
    match time
        .iter()
        .any(|byte| matches!(byte, b'Z' | b'z' | b'+' | b'-' | b'C'))
    {
        true => ClockSource::Utc,
        false => ClockSource::NoZone,
    }
}

/// The time that a text in any column may stand for, to look at a table.
pub(super) fn any(weeks: &mut WeekClock, text: &[u8]) -> Option<f64> {
    weeks.date_time(text).or_else(|| time::time_of_day(text))
}

impl Angles {
    /// The number, in the unit of the columns, of a text.
    fn number(self, text: &[u8]) -> Option<f64> {
        let (degrees, parts) = angle::degrees(text)?;
        Some(match self.minutes && parts > 1 {
            true => angle::degrees_minutes(degrees),
            false => degrees,
        })
    }

    /// Places of latitude and longitude in the row read.
    pub(super) fn places(&self) -> std::ops::Range<usize> {
        self.place..self.place + 2
    }
}
