//! Septentrio Binary Format: fixes of PVTGeodetic with PosCovGeodetic and VelCovGeodetic or, in a file without these, of
//! PVTCartesian with PosCovCartesian and VelCovCartesian; headings of AttEuler with AttCovEuler; inertial samples of ExtSensorMeas, and the receiver's own inertial solution, INSNavGeod, as reference.
//!
//! By the reference guides of the AsteRx and mosaic receivers. Blocks with the same time make one fix; what
//! is between the blocks, NMEA or anything else, is passed over. Times are GPS seconds of the week in
//! which the file starts.

mod blocks;
mod frames;

use undrift_nav::Matrix3;
use undrift_nav::sample::Position;

use super::frames::any;
use super::receiver::{Ready, by_messages, check, check_name};
use crate::entry::{Entries, Fix, Heading, ImuReading, Stream, StreamKind, Wanted, What};
use crate::epoch::ClockSource;
use crate::fix::on_earth;
use crate::skipped::SkipKind;
use crate::source::Source;
use crate::time::WeekClock;
use crate::{Key, ReadError};
use blocks::Pvt;
use frames::LAYOUT;

const PVT: &str = "PVTGeodetic";
const CARTESIAN: &str = "PVTCartesian";
const INS: &str = "INSNavGeod";
const SENSORS: &str = "ExtSensorMeas";
const ATTITUDE: &str = "AttEuler";

/// Blocks that logs often have.
const NAMES: [(u16, &str); 17] = [
    (blocks::PVT, PVT),
    (blocks::POSITION_COVARIANCE, "PosCovGeodetic"),
    (blocks::VELOCITY_COVARIANCE, "VelCovGeodetic"),
    (blocks::END_OF_PVT, "EndOfPVT"),
    (blocks::SENSORS, SENSORS),
    (blocks::INS, INS),
    (blocks::CARTESIAN, CARTESIAN),
    (blocks::CARTESIAN_POSITION_COVARIANCE, "PosCovCartesian"),
    (blocks::CARTESIAN_VELOCITY_COVARIANCE, "VelCovCartesian"),
    (4027, "MeasEpoch"),
    (4013, "ChannelStatus"),
    (4014, "ReceiverStatus"),
    (4225, "INSNavCart"),
    (5904, "PVTGeodetic of version 1"),
    (5914, "ReceiverTime"),
    (blocks::ATTITUDE, ATTITUDE),
    (blocks::ATTITUDE_COVARIANCE, "AttCovEuler"),
];

/// Whether the first bytes of a file hold a block that is read here; a log of NMEA may have others in
/// between.
pub(crate) fn detect(start: &[u8]) -> bool {
    let read = [blocks::PVT, blocks::CARTESIAN, blocks::SENSORS, blocks::INS];
    any(start, &LAYOUT, |number| read.contains(number))
}

pub(super) fn entries(source: Source, wanted: &Wanted) -> Result<Entries, ReadError> {
    check(
        wanted,
        "SBF",
        [&[SENSORS], &[PVT, CARTESIAN, INS], &[PVT, CARTESIAN, INS]],
    )?;
    if let Wanted::Headings(name) = wanted {
        check_name(name, "SBF", &[ATTITUDE], "stream of headings")?;
    }
    let purpose = match wanted {
        Wanted::Headings(_) => Purpose::Headings(None),
        Wanted::Imu(_) => Purpose::Imu { source: None },
        Wanted::Poses(None) => Purpose::Ins {
            found: false,
            fixes: 0,
            poses: true,
        },
        Wanted::Poses(Some(name)) if name == INS => Purpose::Ins {
            found: true,
            fixes: 0,
            poses: true,
        },
        _ => match wanted.one_stream()?.0 {
            Some(name) if name == INS => Purpose::Ins {
                found: true,
                fixes: 0,
                poses: false,
            },
            _ => Purpose::Fixes(Box::new(None)),
        },
    };
    let reader = Reader {
        weeks: WeekClock::default(),
        purpose,
    };
    Ok(by_messages(
        wanted,
        source,
        &LAYOUT,
        reader,
        Reader::block,
        Reader::end,
        |reader| reader.weeks.epoch(ClockSource::Gnss),
    ))
}

pub(super) fn streams(source: Source) -> Result<Vec<Stream>, ReadError> {
    let described = |number: &u16| (name(*number), described(*number));
    let mut streams = super::frames::streams(source, &LAYOUT, |number| *number, described);
    // Of two that say the same, the one whose fixes are read.
    if streams.iter().any(|stream| stream.name == PVT) {
        let cartesian = streams.iter_mut().find(|stream| stream.name == CARTESIAN);
        cartesian
            .into_iter()
            .for_each(|stream| stream.kind = StreamKind::Other);
    }
    Ok(streams)
}

fn described(number: u16) -> (StreamKind, &'static str) {
    match number {
        blocks::PVT => (StreamKind::Fixes, "position and velocity"),
        blocks::CARTESIAN => (StreamKind::Fixes, "Earth-fixed position and velocity"),
        blocks::ATTITUDE => (
            StreamKind::Headings,
            "heading of the vehicle by its antennas",
        ),
        blocks::POSITION_COVARIANCE | blocks::CARTESIAN_POSITION_COVARIANCE => {
            (StreamKind::Other, "covariances of the position")
        }
        blocks::VELOCITY_COVARIANCE | blocks::CARTESIAN_VELOCITY_COVARIANCE => {
            (StreamKind::Other, "covariances of the velocity")
        }
        blocks::SENSORS => (StreamKind::Imu, "rates and specific forces of a sensor"),
        blocks::INS => (StreamKind::Poses, "position, velocity and attitude"),
        _ => (StreamKind::Other, ""),
    }
}

fn name(number: u16) -> String {
    let known = NAMES.iter().find(|(known, _)| *known == number);
    known.map_or_else(|| format!("block {number}"), |(_, name)| (*name).to_owned())
}

struct Reader {
    weeks: WeekClock,
    purpose: Purpose,
}

/// What is made of the blocks.
enum Purpose {
    Imu {
        /// The sensor whose samples are taken.
        source: Option<u8>,
    },
    Ins {
        /// Whether there was a block of it, or it is asked for.
        found: bool,
        /// Fixes that could serve in its place.
        fixes: u64,
        poses: bool,
    },
    /// The blocks of the last time.
    Fixes(Box<Option<Epoch>>),
    /// The last heading, which waits for its accuracy, and its block.
    Headings(Option<(u64, Heading)>),
}

/// The blocks of one time.
struct Epoch {
    at: u64,
    time: f64,
    geodetic: Blocks,
    cartesian: Blocks,
}

/// A PVT, and the covariances along its axes.
#[derive(Default)]
struct Blocks {
    /// `None` inside without a fix.
    pvt: Option<Option<Pvt>>,
    /// Of position and velocity.
    covariances: [Option<Matrix3>; 2],
}

impl Reader {
    fn end(&mut self, ready: &mut Ready) -> Result<(), ReadError> {
        match &mut self.purpose {
            Purpose::Fixes(epoch) => end(epoch, ready),
            Purpose::Ins {
                found: false,
                fixes: 1..,
                ..
            } => return Err(without_ins()),
            Purpose::Headings(last) => give(last, ready),
            Purpose::Ins { .. } | Purpose::Imu { .. } => {}
        }
        Ok(())
    }

    fn block(
        &mut self,
        at: u64,
        number: u16,
        body: &[u8],
        ready: &mut Ready,
    ) -> Result<(), ReadError> {
        let known = [
            blocks::PVT,
            blocks::POSITION_COVARIANCE,
            blocks::VELOCITY_COVARIANCE,
            blocks::CARTESIAN,
            blocks::CARTESIAN_POSITION_COVARIANCE,
            blocks::CARTESIAN_VELOCITY_COVARIANCE,
            blocks::END_OF_PVT,
            blocks::SENSORS,
            blocks::INS,
            blocks::ATTITUDE,
            blocks::ATTITUDE_COVARIANCE,
        ];
        if !known.contains(&number) {
            return Ok(());
        }
        // Without a time the receiver has no fix either.
        let Some((milli, week)) = blocks::stamp(body) else {
            return Ok(());
        };
        let weeks = &mut self.weeks;
        let mut time = || weeks.gps(i64::from(week) * 7, f64::from(milli) * 1e-3);
        let had = match (&mut self.purpose, number) {
            (Purpose::Imu { source }, blocks::SENSORS) => {
                let sample = blocks::sample(body, source);
                match sample {
                    Some(Some(blocks::Sample { gyro, accel })) => {
                        let time = time();
                        ready.push(at, What::Imu(ImuReading::new(time, gyro, accel)));
                    }
                    Some(None) => {
                        ready.skip(at, SkipKind::MissingField, "a sample without all six axes");
                    }
                    None => {}
                }
                Some(Some(()))
            }
            (Purpose::Ins { found, poses, .. }, blocks::INS) => {
                *found = true;
                blocks::ins(body).map(|ins| {
                    ins.map(|ins| {
                        let time = time();
                        match poses {
                            true => ready.push(
                                at,
                                What::Pose(undrift_nav::sample::TruthSample { time, ..ins.pose }),
                            ),
                            false => fix_of(at, time, &ins, ready),
                        }
                    })
                })
            }
            (Purpose::Ins { fixes, .. }, blocks::PVT | blocks::CARTESIAN) => {
                *fixes += 1;
                Some(Some(()))
            }
            (Purpose::Headings(last), blocks::ATTITUDE) => {
                give(last, ready);
                blocks::heading(body).map(|heading| {
                    heading.map(|heading| {
                        let (time, std) = (time(), None);
                        *last = Some((at, Heading { time, heading, std }));
                    })
                })
            }
            (Purpose::Headings(last), blocks::ATTITUDE_COVARIANCE) => {
                let time = time();
                let same = last.as_mut().filter(|(_, heading)| heading.time == time);
                let std = blocks::heading_std(body);
                if let (Some((_, heading)), Some(std)) = (same, std) {
                    heading.std = std;
                    give(last, ready);
                }
                std.map(|_| Some(()))
            }
            (Purpose::Fixes(epoch), _)
                if !matches!(
                    number,
                    blocks::SENSORS | blocks::INS | blocks::ATTITUDE | blocks::ATTITUDE_COVARIANCE
                ) =>
            {
                let time = time();
                if number == blocks::END_OF_PVT
                    || epoch.as_ref().as_ref().is_some_and(|e| e.time != time)
                {
                    end(epoch, ready);
                }
                if number == blocks::END_OF_PVT {
                    return Ok(());
                }
                let epoch = epoch.get_or_insert_with(|| Epoch::new(at, time));
                epoch.add(number, body).map(Some)
            }
            _ => Some(Some(())),
        };
        match had {
            Some(Some(())) => {}
            Some(None) => ready.skip(at, SkipKind::NoFix, name(number)),
            None => ready.skip(at, SkipKind::MissingField, name(number)),
        }
        Ok(())
    }
}

fn without_ins() -> ReadError {
    ReadError::nameless("no INSNavGeod, the receiver's inertial solution, in this log")
        .key(Key::Topic("truth"))
        .mend("topic = \"PVTGeodetic\" takes the receiver's positions and velocities, without attitude")
}

/// Gives out a heading that waits.
fn give(last: &mut Option<(u64, Heading)>, ready: &mut Ready) {
    if let Some((at, heading)) = last.take() {
        ready.push(at, What::Heading(heading));
    }
}

/// A fix of the inertial solution.
fn fix_of(at: u64, time: f64, ins: &blocks::Ins, ready: &mut Ready) {
    let [position, velocity] = ins.covariances;
    let Some(place) = ready.usable(at, on_earth(ins.pose.position)) else {
        return;
    };
    let fix = Fix {
        mean_velocity: None,
        time,
        position: Some((Position::Geodetic(place), position)),
        velocity: ins.pose.v_n.map(|v_n| (v_n, velocity)),
        quality: ins.quality,
    };
    ready.fix(at, fix);
}

/// Makes a fix of what there is.
fn end(epoch: &mut Option<Epoch>, ready: &mut Ready) {
    let Some(Epoch {
        at,
        time,
        geodetic,
        cartesian,
    }) = epoch.take()
    else {
        return;
    };
    let (Blocks { pvt, covariances }, name) = match geodetic.pvt {
        Some(_) => (geodetic, PVT),
        None => (cartesian, CARTESIAN),
    };
    let pvt = match pvt {
        Some(Some(pvt)) => pvt,
        Some(None) => return ready.skip(at, SkipKind::NoFix, name),
        None => return,
    };
    let turn = pvt.ned_from_axes;
    let turned = |own: Option<Matrix3>| own.map(|own| turn * own * turn.transpose());
    let [of_position, of_velocity] = covariances.map(turned);
    let position = pvt.position.and_then(|place| {
        let place = ready.usable(at, on_earth(place))?;
        Some((Position::Geodetic(place), of_position.or(pvt.covariance)))
    });
    let velocity = pvt.velocity.map(|v_n| (v_n, of_velocity));
    if position.is_some() || velocity.is_some() {
        let quality = pvt.quality;
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

impl Epoch {
    fn new(at: u64, time: f64) -> Self {
        Self {
            at,
            time,
            geodetic: Blocks::default(),
            cartesian: Blocks::default(),
        }
    }

    /// Takes in a block; `None` if it is too short.
    fn add(&mut self, number: u16, body: &[u8]) -> Option<()> {
        match number {
            blocks::PVT => self.geodetic.pvt = Some(blocks::pvt(body)?),
            blocks::POSITION_COVARIANCE => {
                self.geodetic.covariances[0] = blocks::covariance(body)?;
            }
            blocks::VELOCITY_COVARIANCE => {
                self.geodetic.covariances[1] = blocks::covariance(body)?;
            }
            blocks::CARTESIAN => self.cartesian.pvt = Some(blocks::cartesian_pvt(body)?),
            blocks::CARTESIAN_POSITION_COVARIANCE => {
                self.cartesian.covariances[0] = blocks::own_covariance(body)?;
            }
            _ => self.cartesian.covariances[1] = blocks::own_covariance(body)?,
        }
        Some(())
    }
}

#[cfg(test)]
mod tests;
