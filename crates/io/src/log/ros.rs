//! Recordings of robots, whatever container they are in: topics of sensor_msgs/Imu,
//! sensor_msgs/NavSatFix, sensor_msgs/MagneticField, and geometry_msgs/TwistStamped or TwistWithCovarianceStamped; poses of
//! geometry_msgs/PoseStamped, PoseWithCovarianceStamped, TransformStamped and nav_msgs/Odometry, and of tf2_msgs/TFMessage by pairs of frames.
//!
//! Times are the messages' own stamps (`header.stamp`, Unix time), or where one is not set the time
//! at which it was recorded. A topic of velocities that is not named is used, from the first position
//! on, if its frame is that of the positions, so that it comes from the same receiver; commands and
//! wheels have other frames. Gyroscopes and accelerometers that are topics of their own, as of some depth cameras, are
//! joined where both are named, `/gyro + /accel`.
//! Poses are in a frame that begins anywhere, so they are no reference solution.

mod container;
mod fixes;
mod message;
mod topics;
mod transforms;

use std::borrow::Cow;
use std::ops::Range;

use undrift_nav::sample::{FixQuality, Position};

use super::phone::Join;
use super::receiver::{Ready, by_steps};
use crate::entry::{Entries, FieldReading, Fix, ImuReading, Stream, StreamKind, Wanted, What};
use crate::epoch::ClockSource;
use crate::skipped::{SkipKind, Unfit};
use crate::time::WeekClock;
use crate::{Key, ReadError};

pub(crate) use container::{Container, Event, Events};
pub(super) use container::{Declared, File, Packed, Records, Stop};
pub(super) use message::Encoding;

use fixes::Waiting;
use message::Type;
use topics::{Choice, Topic, Topics};

/// The streams of a recording.
pub(super) fn streams(mut recording: impl Events) -> Result<Vec<Stream>, ReadError> {
    let mut topics = Topics::default();
    while let Some(event) = recording.next()? {
        match event {
            Event::Topic(topic) => topics.declare(topic),
            Event::Message { number, bytes, .. } => {
                if let Some((_, topic, Some(encoding))) = topics.count(number) {
                    let bytes = recording.bytes(bytes);
                    match topic.kind {
                        Some(Type::Transforms) => {
                            transforms::count(&mut topics, number, encoding, bytes);
                        }
                        _ => note_frame(topic, encoding, bytes),
                    }
                }
            }
            Event::Skipped(..) => {}
        }
    }
    Ok(topics.streams())
}

/// Whether messages of a type have to be looked at, by its name.
pub(super) fn reads(type_name: &str) -> bool {
    Type::named(&message::of_ros1(type_name)).is_some()
}

fn note_frame(topic: &mut Topic, encoding: Encoding, bytes: &[u8]) {
    if let Some(kind) = topic.kind
        && topic.frame.is_none()
        && let Some((header, mut fields)) = message::header(encoding, bytes)
    {
        topic.frame = Some(header.frame.into_owned());
        topic.child = message::child(kind, &mut fields).map(Cow::into_owned);
    }
}

/// The entries of a recording.
pub(super) fn entries(
    events: impl Events + 'static,
    wanted: &Wanted,
) -> Result<Entries, ReadError> {
    let choices = match wanted {
        Wanted::Imu(topic) => {
            let apart = topic.as_ref().and_then(|topics| topics.split_once(AND));
            let apart = apart.map(|(gyro, accel)| (gyro.to_owned(), accel.to_owned()));
            let (gyro, accel) = apart.map_or((topic.clone(), None), |(g, a)| (Some(g), Some(a)));
            let choice =
                |topic: &Option<String>| Choice::new(Key::Topic("imu"), StreamKind::Imu, topic);
            Choices {
                main: choice(&gyro),
                accel: accel.map(|accel| choice(&Some(accel))),
                velocity: None,
                frame: None,
            }
        }
        Wanted::Fixes {
            position, velocity, ..
        } => Choices {
            main: Choice::new(Key::Topic("gnss"), StreamKind::Fixes, position),
            velocity: Some(Choice::new(
                Key::VelocityTopic,
                StreamKind::Velocity,
                velocity,
            )),
            accel: None,
            frame: None,
        },
        Wanted::LocalPoses(topic) => Choices {
            main: Choice::new(Key::Topic("poses"), StreamKind::LocalPoses, topic),
            velocity: None,
            accel: None,
            frame: None,
        },
        Wanted::Fields(topic) => Choices {
            main: Choice::new(Key::Topic("magnetometer"), StreamKind::Fields, topic),
            velocity: None,
            accel: None,
            frame: None,
        },
        Wanted::Headings(_) => {
            return Err(
                ReadError::nameless("recordings of ROS have no headings by two antennas")
                    .key("heading.file"),
            );
        }
        Wanted::Poses(_) => {
            return Err(
                ReadError::nameless("recordings of ROS have no reference solution")
                    .key("truth.file")
                    .mend("nav_msgs/Odometry is in a local frame of unknown origin"),
            );
        }
    };
    let mut recording = Recording {
        events: Box::new(events),
        join: choices.accel.is_some().then(Join::slower),
        wanted: choices,
        topics: Topics::default(),
        weeks: WeekClock::default(),
        clock: None,
        child: None,
        messages: 0,
        waiting: Waiting::default(),
        at_once: matches!(wanted, Wanted::Fixes { at_once: true, .. }),
    };
    Ok(by_steps(wanted, move |ready| {
        let more = recording.step(ready)?;
        let epoch = recording
            .clock
            .and_then(|clock| recording.weeks.epoch(clock));
        Ok((more, epoch))
    }))
}

/// Between the topics of gyroscopes and accelerometers that are apart.
pub const AND: &str = " + ";

/// The topics that are meant.
struct Choices {
    /// Of inertial samples, or of positions.
    main: Choice,
    /// Of accelerometers, where those samples are of gyroscopes alone.
    accel: Option<Choice>,
    /// Of velocities, which go with positions.
    velocity: Option<Choice>,
    /// Frame of the positions.
    frame: Option<String>,
}

impl Choices {
    /// Whether a message of this topic and frame, where it states one, is meant.
    fn takes(&mut self, index: usize, topic: &Topic, frame: Option<&str>) -> bool {
        if self.main.takes(index, topic) {
            if self.frame.is_none() {
                self.frame = frame.map(str::to_owned);
            }
            return true;
        }
        let of_receiver = frame.is_some() && self.frame.as_deref() == frame;
        self.velocity.as_mut().is_some_and(|velocity| {
            (velocity.is_named() || of_receiver) && velocity.takes(index, topic)
        })
    }

    fn are_ambiguous(&self) -> bool {
        let velocity = self.velocity.as_ref();
        self.main.is_ambiguous() || velocity.is_some_and(Choice::is_ambiguous)
    }

    fn verdict(&self, topics: &Topics) -> Result<(), ReadError> {
        self.main.verdict(topics, true)?;
        let accel = self.accel.as_ref();
        accel.map_or(Ok(()), |accel| accel.verdict(topics, true))?;
        let velocity = self.velocity.as_ref();
        velocity.map_or(Ok(()), |velocity| velocity.verdict(topics, false))
    }
}

/// A recording being read.
struct Recording {
    events: Box<dyn Events>,
    wanted: Choices,
    /// Of gyroscopes and accelerometers that are apart.
    join: Option<Join>,
    topics: Topics,
    weeks: WeekClock,
    /// Whose the first stamp of a topic that is meant was.
    clock: Option<ClockSource>,
    /// Of poses, the frame that the first is of.
    child: Option<String>,
    /// Messages of all topics so far.
    messages: u64,
    waiting: Waiting,
    /// Whether fixes are given as soon as they can be.
    at_once: bool,
}

impl Recording {
    /// Reads the next entry of the file; false at its end. Where several topics could be meant, the rest
    /// is read for their names only.
    fn step(&mut self, ready: &mut Ready) -> Result<bool, ReadError> {
        let Some(event) = self.events.next()? else {
            self.wanted.verdict(&self.topics)?;
            if self.join.as_ref().is_some_and(|join| !join.given) {
                let problem = "gyroscopes and accelerometers at no common time";
                return Err(ReadError::nameless(problem)
                    .key(Key::Topic("imu"))
                    .mend("name topics that were recorded together"));
            }
            while let Some((at, fix)) = self.waiting.next() {
                ready.push(at, What::Fix(fix));
            }
            return Ok(false);
        };
        let entry = match event {
            Event::Topic(topic) => {
                self.topics.declare(topic);
                None
            }
            Event::Message {
                number,
                time,
                bytes,
            } => {
                self.messages += 1;
                if self.of_accelerometers(number, time, bytes.clone(), ready)?
                    || self.of_transforms(number, time, bytes.clone(), ready)
                {
                    return Ok(true);
                }
                let read = self.message(number, time, bytes);
                read.unwrap_or_else(|unfit| Some((self.messages, What::from_read(Err(unfit)))))
            }
            Event::Skipped(kind, detail) => Some((self.messages, What::Skipped(kind, detail))),
        };
        if let Some((at, what)) = entry
            && !self.wanted.are_ambiguous()
        {
            match (&mut self.join, what) {
                (Some(join), What::Imu(of)) => join.gyro((at, of.time, of.gyro), ready)?,
                (_, what) => ready.push(at, what),
            }
        }
        Ok(true)
    }

    /// Takes a message of the topic of accelerometers; false of any other.
    fn of_accelerometers(
        &mut self,
        number: u32,
        recorded: (i64, u32),
        range: Range<usize>,
        ready: &mut Ready,
    ) -> Result<bool, ReadError> {
        let Some(accel) = &mut self.wanted.accel else {
            return Ok(false);
        };
        let topic = self.topics.topic(number);
        if !topic.is_some_and(|(index, topic)| accel.takes(index, topic)) {
            return Ok(false);
        }
        // Read as a message of the topic that is meant.
        std::mem::swap(&mut self.wanted.main, accel);
        let read = self.message(number, recorded, range);
        if let Some(accel) = &mut self.wanted.accel {
            std::mem::swap(&mut self.wanted.main, accel);
        }
        match read.unwrap_or_else(|unfit| Some((self.messages, What::from_read(Err(unfit))))) {
            Some((at, What::Imu(of))) => {
                if let Some(join) = &mut self.join {
                    join.accel((at, of.time, of.accel), ready)?;
                }
            }
            Some((at, what)) => ready.push(at, what),
            None => {}
        }
        Ok(true)
    }

    /// What a message gives, if it is of a topic that is meant.
    fn message(
        &mut self,
        number: u32,
        recorded: (i64, u32),
        range: Range<usize>,
    ) -> Result<Option<(u64, What)>, Unfit> {
        let Some((index, topic, encoding)) = self.topics.count(number) else {
            let detail = format!("a message of topic number {number}, which is not declared");
            return Err((SkipKind::Damaged, detail));
        };
        let (Some(kind), Some(encoding)) = (topic.kind, encoding) else {
            return Ok(None);
        };
        // Poses may be of another computer, whose clock is not to choose the week of what is read.
        let foreign = kind.kind() == StreamKind::LocalPoses && kind != Type::Odometry;
        if foreign && !self.wanted.takes(index, topic, None) {
            return Ok(None);
        }
        let bytes = self.events.bytes(range);
        let Some((header, mut fields)) = message::header(encoding, bytes) else {
            let meant = self.wanted.takes(index, topic, None);
            return if meant {
                Err(message::too_short())
            } else {
                Ok(None)
            };
        };
        // Every stamp is given to the clock, so that all readings of a file count from one week.
        let ((seconds, nanoseconds), clock) = match header.stamp {
            (0, 0) => (recorded, ClockSource::Receipt),
            stamp => (stamp, ClockSource::Host),
        };
        let in_second = nanoseconds < 1_000_000_000;
        let time = in_second.then(|| self.weeks.unix(seconds, nanoseconds));
        if !self.wanted.takes(index, topic, Some(&header.frame)) {
            return Ok(None);
        }
        let time = time.ok_or_else(|| {
            let detail = format!("stamp of {nanoseconds} ns");
            (SkipKind::OutOfRange, detail)
        })?;
        self.clock.get_or_insert(clock);
        let at = self.messages;
        let fix = match kind {
            Type::Imu => {
                let (gyro, accel) = message::imu(&mut fields)?;
                let reading = ImuReading::new(time, gyro, accel);
                return Ok(Some((at, What::Imu(reading))));
            }
            Type::MagneticField => {
                let field = message::field(&mut fields)?;
                return Ok(Some((at, What::Field(FieldReading { time, field }))));
            }
            Type::NavSatFix => {
                let (place, covariance, quality) = message::fix(&mut fields)?;
                Fix {
                    mean_velocity: None,
                    time,
                    position: Some((Position::Geodetic(place), covariance)),
                    velocity: None,
                    quality,
                }
            }
            Type::TwistStamped | Type::TwistWithCovarianceStamped => {
                let with_covariance = kind == Type::TwistWithCovarianceStamped;
                Fix {
                    mean_velocity: None,
                    time,
                    position: None,
                    velocity: Some(message::velocity(&mut fields, with_covariance)?),
                    quality: FixQuality::Unknown,
                }
            }
            // Taken before.
            Type::Transforms => return Ok(None),
            Type::PoseStamped
            | Type::PoseWithCovarianceStamped
            | Type::TransformStamped
            | Type::Odometry => {
                let child = message::child(kind, &mut fields).unwrap_or_default();
                let first = self.child.get_or_insert_with(|| child.clone().into_owned());
                if *first != child {
                    let detail = format!("a pose of {child}, not of {first}");
                    return Err((SkipKind::OutOfRange, detail));
                }
                let pose = message::pose(time, kind, &mut fields)?;
                return Ok(Some((at, What::LocalPose(pose))));
            }
        };
        let earliest = match self.at_once {
            true => {
                let velocity = self.wanted.velocity.as_ref();
                let has_velocities = velocity.is_some_and(Choice::is_found);
                self.waiting.add_live(at, fix, has_velocities)
            }
            false => self.waiting.add(at, fix),
        };
        Ok(earliest.map(|(at, fix)| (at, What::Fix(fix))))
    }
}

#[cfg(test)]
mod tests;
