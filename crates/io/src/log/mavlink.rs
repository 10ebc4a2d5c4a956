//! MAVLink, versions 1 and 2: the stream of an autopilot, as it comes or as a .tlog; inertial samples of HIGHRES_IMU, RAW_IMU and
//! SCALED_IMU, fixes of GPS_RAW_INT and GPS2_RAW.
//!
//! By the common message set of mavlink.io. Times are those of the messages: since the autopilot's start, with the date of
//! SYSTEM_TIME; or GPS seconds of the week in which the file starts, where a message is stamped by Unix time. What a
//! .tlog has before each message, when it was received, is passed over. Samples are along the axes of the autopilot, forward, right, down.

pub(crate) mod frames;
mod messages;

use super::frames::any;
use super::receiver::{Ready, by_messages, check};
use crate::entry::{Entries, Fix, ImuReading, Stream, StreamKind, Wanted, What};
use crate::epoch::{ClockSource, Epoch};
use crate::fix::{independent, on_earth};
use crate::skipped::SkipKind;
use crate::source::Source;
use crate::time::WeekClock;
use crate::{Key, ReadError};
use frames::{Head, LAYOUT};
use messages::{Gps, Stamp};
use undrift_nav::{Vector3, sample::Position};

/// Streams of inertial samples and of fixes.
const INERTIAL: [&str; 5] = [
    "HIGHRES_IMU",
    "SCALED_IMU",
    "RAW_IMU",
    "SCALED_IMU2",
    "SCALED_IMU3",
];
const FIXES: [&str; 2] = ["GPS_RAW_INT", "GPS2_RAW"];
/// Stamps from here on are Unix times \[µs\]: 2001.
const UNIX: u64 = 1_000_000_000_000_000;
/// The messages have no vertical speed: its standard deviation [m/s].
const NO_VERTICAL_SPEED: f64 = 20.0;

/// Whether the first bytes of a file hold a message that is read here.
pub(crate) fn detect(start: &[u8]) -> bool {
    any(start, &LAYOUT, |head| {
        messages::crc_extra(head.number).is_some() && described(head.number).0 != StreamKind::Other
    })
}

pub(super) fn entries(source: Source, wanted: &Wanted) -> Result<Entries, ReadError> {
    check(wanted, "MAVLink", [&INERTIAL, &FIXES, &[]])?;
    let (asked, of_imu) = match wanted {
        Wanted::Imu(name) => (name, true),
        Wanted::Fixes { position, .. } => (position, false),
        Wanted::Poses(name)
        | Wanted::LocalPoses(name)
        | Wanted::Headings(name)
        | Wanted::Fields(name) => (name, false),
    };
    let reader = Reader {
        asked: asked.clone(),
        of_imu,
        sender: None,
        found: None,
        milli: None,
        weeks: WeekClock::default(),
        epoch: None,
    };
    Ok(by_messages(
        wanted,
        source,
        &LAYOUT,
        reader,
        Reader::message,
        |_, _| Ok(()),
        |reader| reader.weeks.epoch(ClockSource::Utc).or(reader.epoch),
    ))
}

pub(super) fn streams(source: Source) -> Result<Vec<Stream>, ReadError> {
    let described = |head: &Head| {
        (
            messages::name(head.number).to_owned(),
            described(head.number),
        )
    };
    let number = |head: &Head| head.number;
    Ok(super::frames::streams(source, &LAYOUT, number, described))
}

fn described(number: u32) -> (StreamKind, &'static str) {
    match number {
        messages::HIGHRES_IMU
        | messages::RAW_IMU
        | messages::SCALED_IMU
        | messages::SCALED_IMU2
        | messages::SCALED_IMU3 => (StreamKind::Imu, "rates and specific forces"),
        messages::GPS_RAW_INT | messages::GPS2_RAW => {
            (StreamKind::Fixes, "position, speed and course")
        }
        messages::SYSTEM_TIME => (StreamKind::Other, "date of the autopilot's clock"),
        _ => (StreamKind::Other, ""),
    }
}

struct Reader {
    asked: Option<String>,
    of_imu: bool,
    /// The system and component whose messages are taken: the first that sends what is wanted.
    sender: Option<[u8; 2]>,
    /// The stream that is taken.
    found: Option<u32>,
    /// The last stamp of 32 bits \[ms\], and how often they began again.
    milli: Option<(u32, u64)>,
    weeks: WeekClock,
    /// Of times since the start.
    epoch: Option<Epoch>,
}

impl Reader {
    fn message(
        &mut self,
        at: u64,
        head: Head,
        body: &[u8],
        ready: &mut Ready,
    ) -> Result<(), ReadError> {
        let kind = described(head.number).0;
        if head.number == messages::SYSTEM_TIME && self.epoch.is_none() {
            let date = messages::system_time(body).and_then(|(unix, boot)| {
                Epoch::of_unix(unix as f64 * 1e-6, f64::from(boot) * 1e-3, ClockSource::Utc)
            });
            self.epoch = date;
        }
        let is_wanted = match self.of_imu {
            true => kind == StreamKind::Imu,
            false => kind == StreamKind::Fixes,
        };
        if !is_wanted || !self.is_meant(head)? {
            return Ok(());
        }
        if let Some(sample) = messages::sample(head.number, body) {
            let time = self.seconds(sample.stamp);
            let mut reading = ImuReading::new(time, sample.gyro, sample.accel);
            reading.temperature_c = sample.temperature;
            ready.push(at, What::Imu(reading));
        }
        match messages::gps(head.number, body) {
            Some(Some(gps)) => self.fix(at, &gps, ready),
            Some(None) => ready.skip(at, SkipKind::NoFix, messages::name(head.number)),
            None => {}
        }
        Ok(())
    }

    /// Whether messages of this kind and sender are taken.
    fn is_meant(&mut self, head: Head) -> Result<bool, ReadError> {
        let name = messages::name(head.number);
        if self.asked.as_ref().is_some_and(|asked| asked != name) {
            return Ok(false);
        }
        if *self.sender.get_or_insert(head.sender) != head.sender {
            return Ok(false);
        }
        let found = *self.found.get_or_insert(head.number);
        if found == head.number || !self.of_imu {
            return Ok(found == head.number);
        }
        let problem = format!(
            "two streams of inertial samples: {} and {name}",
            messages::name(found)
        );
        Err(ReadError::nameless(problem)
            .key(Key::Topic("imu"))
            .mend("choose one with topic"))
    }

    /// The time of a stamp \[s\].
    fn seconds(&mut self, stamp: Stamp) -> f64 {
        match stamp {
            Stamp::Micro(micro) if micro >= UNIX => {
                let (seconds, rest) = (micro / 1_000_000, micro % 1_000_000);
                self.weeks.unix(seconds as i64, rest as u32 * 1000)
            }
            Stamp::Micro(micro) => micro as f64 * 1e-6,
            Stamp::Milli(milli) => {
                let (last, mut times) = self.milli.unwrap_or((milli, 0));
                if last > milli && last - milli > u32::MAX / 2 {
                    times += 1;
                }
                self.milli = Some((milli, times));
                (times as f64 * 2f64.powi(32) + f64::from(milli)) * 1e-3
            }
        }
    }

    fn fix(&mut self, at: u64, gps: &Gps, ready: &mut Ready) {
        let time = self.seconds(gps.stamp);
        let [horizontal, vertical, speed] = gps.std;
        let position = match gps.has_position {
            true => {
                let Some(place) = ready.usable(at, on_earth(gps.place)) else {
                    return;
                };
                let std = horizontal.zip(vertical).and_then(|(horizontal, vertical)| {
                    // Of the horizontal position, north and east together.
                    let each = horizontal * std::f64::consts::FRAC_1_SQRT_2;
                    independent(&Vector3::new(each, each, vertical))
                });
                Some((Position::Geodetic(place), std))
            }
            false => None,
        };
        let velocity = gps.motion.map(|[fast, course]| {
            let std = speed.and_then(|speed| {
                let each = speed * std::f64::consts::FRAC_1_SQRT_2;
                independent(&Vector3::new(each, each, NO_VERTICAL_SPEED))
            });
            (
                Vector3::new(fast * course.cos(), fast * course.sin(), 0.0),
                std,
            )
        });
        let quality = gps.quality;
        ready.fix(
            at,
            Fix {
                mean_velocity: None,
                time,
                position,
                velocity,
                quality,
            },
        );
    }
}

#[cfg(test)]
mod tests;
