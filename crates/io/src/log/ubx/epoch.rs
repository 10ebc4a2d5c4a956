//! The navigation messages of one epoch, those with the same time of week, as one fix.
//!
//! Positions are taken from NAV-HPPOSLLH before NAV-PVT before NAV-POSLLH, velocities from NAV-PVT
//! before NAV-VELNED; a covariance of NAV-COV goes before the accuracies of the messages
//! themselves.
//!
//! hAcc is that of the horizontal position, √(σ_n² + σ_e²): north and east get hAcc/√2 each. sAcc is
//! that of the speed, along a velocity that is mostly horizontal: north and east get all of it, and
//! down more by as much as the position is worse there, since both see the same satellites.

use undrift_nav::earth::Geodetic;
use undrift_nav::sample::{FixQuality, Position};
use undrift_nav::{Matrix3, Vector3};

use super::bytes::{i1, i4, r4, u1, u2, u4};
use crate::entry::{Fix, Heading};
use crate::epoch::ClockSource;
use crate::fix::{independent, is_covariance, on_earth};
use crate::log::receiver::Ready;
use crate::skipped::SkipKind;
use crate::time::{WEEK, WeekClock};

pub(super) const PVT: [u8; 2] = [0x01, 0x07];
pub(super) const HPPOSLLH: [u8; 2] = [0x01, 0x14];
pub(super) const POSLLH: [u8; 2] = [0x01, 0x02];
pub(super) const VELNED: [u8; 2] = [0x01, 0x12];
pub(super) const COV: [u8; 2] = [0x01, 0x36];
pub(super) const STATUS: [u8; 2] = [0x01, 0x03];
pub(super) const SOL: [u8; 2] = [0x01, 0x06];
pub(super) const TIMEGPS: [u8; 2] = [0x01, 0x20];
pub(super) const RELPOSNED: [u8; 2] = [0x01, 0x3c];

/// Messages with a position, the best first.
pub(super) const POSITIONS: [&str; 3] = ["NAV-HPPOSLLH", "NAV-PVT", "NAV-POSLLH"];
/// Messages with a velocity, the best first.
pub(super) const VELOCITIES: [&str; 2] = ["NAV-PVT", "NAV-VELNED"];

/// Messages with a heading.
pub(super) const HEADINGS: [&str; 1] = ["NAV-RELPOSNED"];
/// Two antennas on one vehicle are closer than this \[m\].
const LONGEST: f64 = 100.0;

/// The time of week of a message is rounded to 1 ms; what NAV-PVT adds may not be more \[s\].
const ROUNDED: f64 = 1e-3;

/// Time of week \[ms\] of a navigation message, by which an epoch's messages are found.
pub(super) fn time_of_week(kind: [u8; 2], payload: &[u8]) -> Option<u32> {
    match kind {
        HPPOSLLH | RELPOSNED => u4(payload, 4),
        PVT | POSLLH | VELNED | COV | STATUS | SOL | TIMEGPS => u4(payload, 0),
        _ => None,
    }
}

/// Milliseconds since startup, of NAV-STATUS.
pub(super) fn startup(kind: [u8; 2], payload: &[u8]) -> Option<u32> {
    (kind == STATUS).then(|| u4(payload, 12))?
}

/// Continues the time of week past the week's end.
#[derive(Default)]
pub(super) struct Weeks {
    last: Option<f64>,
    /// GPS week from whose beginning the times count.
    start: Option<i64>,
}

impl Weeks {
    /// Time of an epoch \[s\].
    pub(super) fn seconds(&mut self, epoch: &Epoch) -> f64 {
        let time_of_week = epoch.seconds();
        let last = *self.last.get_or_insert(time_of_week);
        // The week in which it is nearest to the time before.
        let later = ((last - time_of_week) / WEEK).round();
        let time = time_of_week + WEEK * later;
        self.last = Some(time);
        if let (Some(week), None) = (epoch.week, self.start) {
            self.start = Some(week - later as i64);
        }
        time
    }

    /// What the times count from, once a message had the date.
    pub(super) fn epoch(&self) -> Option<crate::epoch::Epoch> {
        let week = u32::try_from(self.start?).ok()?;
        Some(crate::epoch::Epoch::of_week(week, ClockSource::Gnss))
    }
}

/// GPS week of an epoch from UTC's date and time of NAV-PVT, if it says that they are valid.
fn week_of_date(payload: &[u8], time_of_week: u32) -> Option<i64> {
    let valid = u1(payload, 11)? & 0b11 == 0b11;
    let [month, day, hour, minute, second] = [
        u1(payload, 6)?,
        u1(payload, 7)?,
        u1(payload, 8)?,
        u1(payload, 9)?,
        u1(payload, 10)?,
    ]
    .map(i64::from);
    let of_day = (hour * 3600 + minute * 60 + second) as f64;
    let mut weeks = WeekClock::default();
    let seconds = weeks
        .utc(u2(payload, 4)?.into(), month, day, of_day)
        .filter(|_| valid)?;
    let (week, second) = weeks.epoch(ClockSource::Gnss)?.week_second(seconds);
    // Leap seconds that the receiver does not know yet may put it into the week beside.
    let whole = (second - f64::from(time_of_week) * 1e-3) / WEEK;
    Some(week + whole.round() as i64)
}

/// A position and its standard deviations north, east, down \[m\].
type PlaceAndStd = (Geodetic, Vector3);

/// What the messages of one epoch say.
#[derive(Default)]
pub(super) struct Epoch {
    /// Number of its first message.
    pub(super) at: u64,
    /// Time of week \[ms\].
    pub(super) time_of_week: u32,
    /// GPS week, where a message states it.
    week: Option<i64>,
    /// The sensors' counter when its first message came \[s\].
    pub(super) counter: Option<f64>,
    /// The sensors' counter at its time \[s\], where the messages tell that.
    pub(super) exact: Option<f64>,
    /// What NAV-PVT's fraction of the second adds to it \[s\].
    fraction: f64,
    /// Whether there is a fix by satellites, and of what quality; `None` where no message says so.
    fix: Option<(bool, FixQuality)>,
    /// By NAV-HPPOSLLH, NAV-PVT, NAV-POSLLH.
    positions: [Option<PlaceAndStd>; 3],
    /// By NAV-PVT, NAV-VELNED: north, east, down [m/s], and the standard deviation of each [m/s].
    velocities: [Option<(Vector3, f64)>; 2],
    covariances: [Option<Matrix3>; 2],
    /// Of NAV-RELPOSNED, without a time; `None` inside where the receiver does not vouch for it.
    pub(super) heading: Option<Option<Heading>>,
}

impl Epoch {
    pub(super) fn new(at: u64, time_of_week: u32) -> Self {
        Self {
            at,
            time_of_week,
            ..Self::default()
        }
    }

    /// Takes in a message; `None` if it is too short.
    pub(super) fn add(&mut self, kind: [u8; 2], payload: &[u8]) -> Option<()> {
        let [high_precision, with_velocity, plain] = &mut self.positions;
        match kind {
            PVT => {
                let flags = u1(payload, 21)?;
                self.week = week_of_date(payload, self.time_of_week).or(self.week);
                self.fix = Some((fixed(u1(payload, 20)?, flags), quality(flags, flags >> 6)));
                let invalid = u1(payload, 78)? & 1 != 0;
                *with_velocity = (!invalid).then_some(place(payload, 24, [40, 44], 1e-3)?);
                self.velocities[0] = Some((vector(payload, 48, 1e-3)?, std(payload, 68, 1e-3)?));
                // Time valid and fully resolved.
                if u1(payload, 11)? & 0b110 == 0b110 {
                    self.fraction = fraction(self.time_of_week, i4(payload, 16)?);
                }
            }
            HPPOSLLH => {
                let invalid = u1(payload, 3)? & 1 != 0;
                let (mut place, std) = place(payload, 8, [28, 32], 1e-4)?;
                place.lon += f64::from(i1(payload, 24)?) * 1e-9f64.to_radians();
                place.lat += f64::from(i1(payload, 25)?) * 1e-9f64.to_radians();
                place.height += f64::from(i1(payload, 26)?) * 1e-4;
                *high_precision = (!invalid).then_some((place, std));
            }
            POSLLH => *plain = Some(place(payload, 4, [20, 24], 1e-3)?),
            VELNED => {
                self.velocities[1] = Some((vector(payload, 4, 1e-2)?, std(payload, 28, 1e-2)?));
            }
            RELPOSNED => self.heading = Some(heading(payload)?),
            COV => {
                for (k, (valid, from)) in [(5, 16), (6, 40)].into_iter().enumerate() {
                    let full = covariance(payload, from)?;
                    self.covariances[k] = (u1(payload, valid)? == 1).then_some(full);
                }
            }
            STATUS => {
                let flags = u1(payload, 5)?;
                let said = (
                    fixed(u1(payload, 4)?, flags),
                    quality(flags, u1(payload, 7)? >> 6),
                );
                self.fix.get_or_insert(said);
            }
            SOL => {
                let flags = u1(payload, 11)?;
                // Week number valid.
                let week = i64::from(u2(payload, 8)?);
                self.week = self.week.or((flags & 4 != 0).then_some(week));
                let said = (fixed(u1(payload, 10)?, flags), quality(flags, 0));
                self.fix.get_or_insert(said);
            }
            // Week number valid.
            TIMEGPS if u1(payload, 11)? & 2 != 0 => {
                self.week = Some(u2(payload, 8)?.into());
            }
            _ => {}
        }
        Some(())
    }

    /// Whether there is something, and the receiver does not say that it has no fix.
    pub(super) fn has_fix(&self) -> bool {
        let something = self.positions.iter().any(Option::is_some)
            || self.velocities.iter().any(Option::is_some);
        something && !self.lacks_fix()
    }

    /// Time of week \[s\], as exact as the messages are.
    pub(super) fn seconds(&self) -> f64 {
        f64::from(self.time_of_week) * 1e-3 + self.fraction
    }

    /// The fix of the epoch at a time, by the messages with the names or the best that there are;
    /// what cannot be used is counted.
    pub(super) fn fix(
        &self,
        time: f64,
        names: &[Option<String>; 2],
        ready: &mut Ready,
    ) -> Option<Fix> {
        let [position, velocity] = names;
        let position = chosen(&self.positions, POSITIONS, position);
        let velocity = chosen(&self.velocities, VELOCITIES, velocity);
        let worse_down = position.map_or(1.0, |(_, std)| (std.z / std.x).max(1.0));
        let position = position.and_then(|(place, std)| {
            let place = ready.usable(self.at, on_earth(*place))?;
            Some((Position::Geodetic(place), self.usable(0, *std, ready)))
        });
        let velocity = velocity.map(|(v_n, std)| {
            let std = Vector3::new(*std, *std, std * worse_down);
            (*v_n, self.usable(1, std, ready))
        });
        let quality = self
            .fix
            .map_or_else(Default::default, |(_, quality)| quality);
        (position.is_some() || velocity.is_some()).then_some(Fix {
            mean_velocity: None,
            time,
            position,
            velocity,
            quality,
        })
    }

    /// Whether the receiver says that it has no fix.
    pub(super) fn lacks_fix(&self) -> bool {
        matches!(self.fix, Some((false, _)))
    }

    /// Counts the epoch where it has no fix.
    pub(super) fn skip(&self, ready: &mut Ready) {
        if self.lacks_fix() {
            let detail = format!("time of week {} ms", self.time_of_week);
            ready.skip(self.at, SkipKind::NoFix, detail);
        }
    }

    /// The covariance of NAV-COV, else that of the accuracies, else none: counted.
    fn usable(&self, which: usize, std: Vector3, ready: &mut Ready) -> Option<Matrix3> {
        if let Some(full) = self.covariances.get(which).copied().flatten() {
            if is_covariance(&full) {
                return Some(full);
            }
            ready.skip(self.at, SkipKind::Uncertainty, "a covariance of NAV-COV");
        }
        let covariance = independent(&std);
        if covariance.is_none() {
            ready.skip(self.at, SkipKind::Uncertainty, "an accuracy of 0");
        }
        covariance
    }
}

/// The first that is there, of those with the name if there is one.
fn chosen<'a, T, const N: usize>(
    all: &'a [Option<T>; N],
    names: [&str; N],
    name: &Option<String>,
) -> Option<&'a T> {
    let named = |known: &str| name.as_ref().is_none_or(|name| name == known);
    let mut all = all.iter().zip(names).filter(|(_, known)| named(known));
    all.find_map(|(one, _)| one.as_ref())
}

/// Whether satellites made the fix: 2D, 3D, or with dead reckoning; not dead reckoning alone or
/// time.
fn fixed(fix_type: u8, flags: u8) -> bool {
    (2..=4).contains(&fix_type) && flags & 1 != 0
}

fn quality(flags: u8, carrier: u8) -> FixQuality {
    match (carrier & 3, flags & 2) {
        (2, _) => FixQuality::Fixed,
        (1, _) => FixQuality::Float,
        (_, 0) => FixQuality::Single,
        _ => FixQuality::Differential,
    }
}

/// What a fraction of the second \[ns\] adds to a time of week \[ms\] that is rounded \[s\].
fn fraction(time_of_week: u32, nanoseconds: i32) -> f64 {
    let rounded = f64::from(time_of_week % 1000) * 1e-3;
    let more = f64::from(nanoseconds) * 1e-9 - rounded;
    let more = more - more.round();
    if more.abs() <= ROUNDED { more } else { 0.0 }
}

/// Longitude, latitude, height, and the accuracies horizontal and vertical in their unit \[m\].
fn place(payload: &[u8], from: usize, accuracies: [usize; 2], unit: f64) -> Option<PlaceAndStd> {
    let degrees = |at: usize| i4(payload, at).map(|value| f64::from(value) * 1e-7);
    let height = f64::from(i4(payload, from + 8)?) * 1e-3;
    let place = Geodetic::from_degrees(degrees(from + 4)?, degrees(from)?, height);
    let [horizontal, vertical] = accuracies;
    let each = std(payload, horizontal, unit)? * std::f64::consts::FRAC_1_SQRT_2;
    Some((
        place,
        Vector3::new(each, each, std(payload, vertical, unit)?),
    ))
}

fn vector(payload: &[u8], from: usize, unit: f64) -> Option<Vector3> {
    let number = |at: usize| i4(payload, at).map(|value| f64::from(value) * unit);
    Some(Vector3::new(
        number(from)?,
        number(from + 4)?,
        number(from + 8)?,
    ))
}

fn std(payload: &[u8], at: usize, unit: f64) -> Option<f64> {
    u4(payload, at).map(|value| f64::from(value) * unit)
}

/// The upper triangle of a symmetric matrix, by rows.
fn covariance(payload: &[u8], from: usize) -> Option<Matrix3> {
    let mut numbers = [0.0; 6];
    for (k, number) in numbers.iter_mut().enumerate() {
        *number = f64::from(r4(payload, from + 4 * k)?);
    }
    let [nn, ne, nd, ee, ed, dd] = numbers;
    Some(Matrix3::new(nn, ne, nd, ne, ee, ed, nd, ed, dd))
}

/// The heading of NAV-RELPOSNED of version 0, by north and east, or 1: `None` if it is too short, `None` inside unless base and rover move
/// together and their vector is one of whole wavelengths.
fn heading(payload: &[u8]) -> Option<Option<Heading>> {
    let first = u1(payload, 0)? == 0;
    let metres = |at: usize, fine: usize| {
        let (whole, fine) = (i4(payload, at)?, i1(payload, fine)?);
        Some(f64::from(whole) * 1e-2 + f64::from(fine) * 1e-4)
    };
    let (flags, needed, length, heading, std) = if first {
        let (north, east) = (metres(8, 20)?, metres(12, 21)?);
        let (of_north, of_east) = (std(payload, 24, 1e-4)?, std(payload, 28, 1e-4)?);
        let length = north.hypot(east);
        let across = (east * of_north).hypot(north * of_east) / length;
        let heading = east.atan2(north);
        (
            u4(payload, 36)?,
            0b11_0101,
            length,
            heading,
            across / length,
        )
    } else {
        let degrees = 1e-5_f64.to_radians();
        let heading = f64::from(i4(payload, 24)?) * degrees;
        let of_heading = std(payload, 52, degrees)?;
        let length = metres(20, 35)?;
        (u4(payload, 60)?, 0b1_0011_0101, length, heading, of_heading)
    };
    // Fix, vector valid, whole wavelengths (2 of 0 to 2), moving base, heading valid.
    let vouched = flags & (needed | 0b1000) == needed;
    let usable = vouched && (0.0..LONGEST).contains(&length) && std.is_finite();
    Some(usable.then_some(Heading {
        time: 0.0,
        heading,
        std: (std > 0.0).then_some(std),
    }))
}
