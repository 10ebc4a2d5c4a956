//! The sentences of one time of day as one fix, and its time.

use undrift_nav::earth::Geodetic;
use undrift_nav::sample::{FixQuality, Position};
use undrift_nav::{Matrix3, Vector3};

use super::sentence::{Sentence, date};
use crate::entry::{Fix, Heading, Wanted, What};
use crate::epoch::ClockSource;
use crate::fix::{is_usable_std, on_earth};
use crate::log::receiver::Ready;
use crate::skipped::SkipKind;
use crate::time::{DAY, WeekClock};

/// Epochs that wait for a date: an hour at 1 Hz.
const MAX_HELD: usize = 3600;

/// Year, month, day.
type Date = (i64, i64, i64);

/// What GGA or GNS says.
struct Gga {
    lat_deg: f64,
    lon_deg: f64,
    /// Above sea level \[m\].
    altitude: f64,
    /// Of the sea above the ellipsoid \[m\].
    separation: Option<f64>,
    quality: FixQuality,
}

/// What the sentences of one time of day say.
#[derive(Default)]
pub(super) struct Epoch {
    /// Line of the first.
    at: u64,
    /// UTC \[s\].
    pub(super) time_of_day: f64,
    gga: Option<Gga>,
    /// Latitude and longitude of RMC \[deg\].
    flat: Option<(f64, f64)>,
    covariance: Option<Matrix3>,
    /// Over ground, down 0 [m/s].
    velocity: Option<Vector3>,
    /// Whether a standard deviation was unusable.
    unusable: bool,
    date: Option<Date>,
    /// Whether a sentence says that there is no fix by satellites.
    no_fix: bool,
    /// Heading, and its standard deviation where it is stated \[rad\].
    heading: Option<(f64, Option<f64>)>,
}

impl Epoch {
    pub(super) fn new(at: u64, time_of_day: f64) -> Self {
        Self {
            at,
            time_of_day,
            ..Self::default()
        }
    }

    /// Takes in a sentence, `for_heading` or for the fix, or says why it cannot be used.
    pub(super) fn add(&mut self, sentence: &Sentence, for_heading: bool) -> Result<(), SkipKind> {
        if for_heading {
            self.heading = Some(sentence.heading()?);
            return Ok(());
        }
        match sentence.kind() {
            b"GGA" => self.gga(sentence),
            b"GNS" => self.gns(sentence),
            b"GST" => {
                self.covariance = covariance(sentence);
                let given = (6..=8).any(|field| !sentence.field(field).is_empty());
                self.unusable = given && self.covariance.is_none();
                Ok(())
            }
            b"RMC" => {
                let mode = sentence.field(12);
                self.no_fix |=
                    sentence.field(2) != b"A" || matches!(mode, b"N" | b"E" | b"M" | b"S");
                self.date = date(sentence.field(9)).or(self.date);
                self.velocity = velocity(sentence, 7, 8).or(self.velocity);
                let lat = sentence.angle(3, [b"N", b"S"]);
                self.flat = lat.zip(sentence.angle(5, [b"E", b"W"])).or(self.flat);
                Ok(())
            }
            b"VTG" => {
                self.velocity = velocity(sentence, 5, 1).or(self.velocity);
                Ok(())
            }
            _ => {
                let part =
                    |field: usize| sentence.number(field).filter(|value| value.fract() == 0.0);
                if let (Some(day), Some(month), Some(year)) = (part(2), part(3), part(4)) {
                    self.date = Some((year as i64, month as i64, day as i64));
                }
                Ok(())
            }
        }
    }

    fn gga(&mut self, sentence: &Sentence) -> Result<(), SkipKind> {
        let quality = match sentence.field(6) {
            b"1" | b"3" => FixQuality::Single,
            b"2" | b"9" => FixQuality::Differential,
            b"4" => FixQuality::Fixed,
            b"5" => FixQuality::Float,
            // No fix, dead reckoning, by hand, simulated.
            b"" | b"0" | b"6" | b"7" | b"8" => {
                self.no_fix = true;
                return Ok(());
            }
            _ => FixQuality::Unknown,
        };
        self.gga = Some(place(sentence, 11, quality)?);
        Ok(())
    }

    /// By the mode of each system: the best counts.
    fn gns(&mut self, sentence: &Sentence) -> Result<(), SkipKind> {
        let modes = sentence.field(6);
        let has = |mode: u8| modes.contains(&mode);
        let quality = if has(b'R') {
            FixQuality::Fixed
        } else if has(b'F') {
            FixQuality::Float
        } else if has(b'D') {
            FixQuality::Differential
        } else if has(b'A') || has(b'P') {
            FixQuality::Single
        } else {
            self.no_fix = true;
            return Ok(());
        };
        if self.gga.is_none() {
            self.gga = Some(place(sentence, 10, quality)?);
        }
        Ok(())
    }

    /// Makes the fix of what has come and gives it to those that know its time.
    pub(super) fn end(self, heights: &mut Heights, times: &mut Times, ready: &mut Ready) {
        times.next(self.time_of_day, self.date, ready);
        if times.headings {
            if let Some((heading, std)) = self.heading {
                let time = 0.0;
                times.give(
                    self.at,
                    What::Heading(Heading { time, heading, std }),
                    ready,
                );
            }
            return;
        }
        if self.no_fix {
            let detail = format!("UTC {:.2} s of the day", self.time_of_day);
            ready.skip(self.at, SkipKind::NoFix, detail);
            return;
        }
        let Some((position, quality)) = self.position(heights, ready) else {
            return;
        };
        let Some(position) = ready.usable(self.at, on_earth(position)) else {
            return;
        };
        if self.unusable {
            let detail = "the standard deviations of GST";
            ready.skip(self.at, SkipKind::Uncertainty, detail);
        }
        let fix = Fix {
            mean_velocity: None,
            time: 0.0,
            position: Some((Position::Geodetic(position), self.covariance)),
            // No reference: half of it is missing.
            velocity: self.velocity.filter(|_| !times.poses).map(|v| (v, None)),
            quality,
        };
        times.give(self.at, What::Fix(fix), ready);
    }

    /// The position, and how it was found: that of RMC, without a height, in a log in which no other sentence has one.
    fn position(&self, heights: &mut Heights, ready: &mut Ready) -> Option<(Geodetic, FixQuality)> {
        if let Some(place) = &self.gga {
            heights.without = None;
            let height = heights.above_ellipsoid(place, self.at, ready);
            let position = Geodetic::from_degrees(place.lat_deg, place.lon_deg, height);
            return Some((position, place.quality));
        }
        let (lat, lon) = self.flat?;
        let before = heights.without.as_mut()?;
        *before += 1;
        if *before == FLAT {
            let detail = "neither GGA nor GNS: the heights are 0";
            ready.skip(self.at, SkipKind::MissingField, detail);
        }
        (*before >= FLAT).then(|| (Geodetic::from_degrees(lat, lon, 0.0), FixQuality::Unknown))
    }
}

/// The place of GGA or GNS, with the separation in this field.
fn place(sentence: &Sentence, separation: usize, quality: FixQuality) -> Result<Gga, SkipKind> {
    let is_empty = |field: &usize| sentence.field(*field).is_empty();
    if [2, 4, 9].iter().any(is_empty) {
        return Err(SkipKind::MissingField);
    }
    let lat_deg = sentence.angle(2, [b"N", b"S"]);
    let lon_deg = sentence.angle(4, [b"E", b"W"]);
    Ok(Gga {
        lat_deg: lat_deg.ok_or(SkipKind::Text)?,
        lon_deg: lon_deg.ok_or(SkipKind::Text)?,
        altitude: sentence.number(9).ok_or(SkipKind::Text)?,
        separation: sentence.number(separation),
        quality,
    })
}

/// North-east-down [m/s] by the fields of speed \[kn\] and true course [°]; the vertical speed is
/// unknown and given as 0.
fn velocity(sentence: &Sentence, speed: usize, course: usize) -> Option<Vector3> {
    /// The international knot [m/s].
    const KNOT: f64 = 1852.0 / 3600.0;
    let speed = sentence.number(speed).filter(|speed| *speed >= 0.0)? * KNOT;
    // At rest some receivers leave the course empty.
    let course = sentence.number(course).or((speed == 0.0).then_some(0.0))?;
    let (east, north) = course.to_radians().sin_cos();
    Some(Vector3::new(speed * north, speed * east, 0.0))
}

/// North-east-down \[m²\] by GST: standard deviations of latitude, longitude and altitude, or
/// semi-axes and the direction of the major one [°] from north with that of altitude.
fn covariance(gst: &Sentence) -> Option<Matrix3> {
    let std = |field: usize| gst.number(field).filter(|std| is_usable_std(*std));
    let down = std(8)?.powi(2);
    if !(gst.field(6).is_empty() && gst.field(7).is_empty()) {
        let variances = Vector3::new(std(6)?.powi(2), std(7)?.powi(2), down);
        return Some(Matrix3::from_diagonal(&variances));
    }
    let (major, minor) = (std(3)?.powi(2), std(4)?.powi(2));
    let (s, c) = gst.number(5)?.to_radians().sin_cos();
    let (nn, ee) = (major * c * c + minor * s * s, major * s * s + minor * c * c);
    let ne = (major - minor) * s * c;
    Some(Matrix3::new(nn, ne, 0.0, ne, ee, 0.0, 0.0, 0.0, down))
}

/// Epochs with RMC and without a height that show that the log has none: its first may be cut.
const FLAT: u32 = 4;

/// Heights above the ellipsoid, as far as the file states them.
pub(super) struct Heights {
    /// Epochs without one from the start of the log; `None` once there was one.
    without: Option<u32>,
    separation: Option<f64>,
    above_sea: bool,
}

impl Default for Heights {
    fn default() -> Self {
        let (without, separation, above_sea) = (Some(0), None, false);
        Self {
            without,
            separation,
            above_sea,
        }
    }
}

impl Heights {
    fn above_ellipsoid(&mut self, place: &Gga, at: u64, ready: &mut Ready) -> f64 {
        if !self.above_sea {
            self.separation = place.separation.or(self.separation);
        }
        match self.separation {
            Some(separation) => place.altitude + separation,
            None => {
                if !self.above_sea {
                    let detail = "no geoid separation: heights stay above sea level";
                    ready.skip(at, SkipKind::MissingField, detail);
                }
                self.above_sea = true;
                place.altitude
            }
        }
    }
}

/// Makes times of dates and times of day.
#[derive(Default)]
pub(super) struct Times {
    /// Whether reference solutions are wanted, not fixes.
    poses: bool,
    /// Whether headings are.
    headings: bool,
    weeks: WeekClock,
    /// The last time of day \[s\].
    last: Option<f64>,
    /// The last date in the log.
    date: Option<Date>,
    /// Midnights since the last date, or since the file's start.
    midnights: i32,
    /// Fixes or headings that wait for a date: line, midnights before it, time of day, the thing itself.
    held: Vec<(u64, i32, f64, What)>,
    /// The file counts seconds of its first day, for good.
    undated: bool,
}

impl Times {
    pub(super) fn new(wanted: &Wanted) -> Self {
        Self {
            poses: matches!(wanted, Wanted::Poses(_)),
            headings: matches!(wanted, Wanted::Headings(_)),
            ..Self::default()
        }
    }

    /// What the times count from, once there was a date.
    pub(super) fn epoch(&self) -> Option<crate::epoch::Epoch> {
        self.weeks.epoch(ClockSource::Gnss)
    }

    /// Goes on to an epoch.
    fn next(&mut self, time_of_day: f64, date: Option<Date>, ready: &mut Ready) {
        let last = self.last.replace(time_of_day);
        if last.is_some_and(|last| last - time_of_day > DAY / 2.0) {
            self.midnights += 1;
        }
        let valid = |&(year, month, day): &Date| {
            // Asked of a clock of its own, so that this is not what sets the week.
            WeekClock::default().utc(year, month, day, 0.0).is_some()
        };
        let Some(date) = date.filter(valid).filter(|_| !self.undated) else {
            return;
        };
        self.date = Some(date);
        let since_start = std::mem::take(&mut self.midnights);
        for (at, midnights, time, what) in std::mem::take(&mut self.held) {
            self.dated((at, midnights - since_start, time, what), ready);
        }
    }

    /// Gives out a fix or heading of the epoch that this has gone on to, or keeps it until its date is known.
    fn give(&mut self, at: u64, what: What, ready: &mut Ready) {
        let held = (at, self.midnights, self.last.unwrap_or_default(), what);
        if self.undated || self.date.is_some() {
            self.dated(held, ready);
        } else {
            self.held.push(held);
            if self.held.len() >= MAX_HELD {
                self.end(ready);
            }
        }
    }

    /// Gives out what comes so many midnights after the date, or after the file's start without one.
    fn dated(&mut self, (at, midnights, time, what): (u64, i32, f64, What), ready: &mut Ready) {
        let seconds = time + DAY * f64::from(midnights);
        let time = match self.date.filter(|_| !self.undated) {
            Some((year, month, day)) => self.weeks.utc(year, month, day, seconds),
            None => Some(seconds),
        };
        match (time, what) {
            (Some(time), What::Fix(fix)) => ready.fix(at, Fix { time, ..fix }),
            (Some(time), What::Heading(heading)) => {
                ready.push(at, What::Heading(Heading { time, ..heading }));
            }
            _ => {}
        }
    }

    /// Gives out what still waits for a date, without one.
    pub(super) fn end(&mut self, ready: &mut Ready) {
        self.undated = self.date.is_none();
        for held in std::mem::take(&mut self.held) {
            self.dated(held, ready);
        }
    }
}
