//! Reads one stream of a ULog.

use std::collections::HashMap;

use undrift_nav::Vector3;

use super::layout::{Formats, TopicLayout};
use super::messages::{Messages, NextMessage};
use super::subscriptions::{appended, data, subscription, topic_of};
use super::topics::TopicReader;
use crate::entry::What;
use crate::error::{NAMES_SHOWN, the_file_has};
use crate::log::receiver::Ready;
use crate::skipped::SkipKind;
use crate::{Key, ReadError};

/// Intervals after which it is judged whether a stream is thinned.
const JUDGED: u32 = 100;
/// Fewer intervals than this are not judged at the end.
const JUDGED_LEAST: u32 = 10;

/// How far the samples are apart compared to what they cover.
#[derive(Default)]
struct Spacing {
    last: Option<f64>,
    pairs: u32,
    wide: u32,
}

impl Spacing {
    /// Takes in a sample's time and the length of its interval \[s\].
    fn add(&mut self, time: f64, span: f64) {
        if let Some(last) = self.last.replace(time)
            && self.pairs < JUDGED
        {
            self.pairs += 1;
            // Twice what is covered: jitter stays well below, thinning starts there.
            self.wide += u32::from(span > 0.0 && time - last > 1.9 * span);
        }
    }

    fn thinned(&self, least: u32) -> bool {
        self.pairs >= least && 2 * self.wide > self.pairs
    }
}

/// The entries of one stream.
pub(super) struct Reader {
    messages: Messages,
    formats: Formats,
    /// What the subscriptions that are needed are read with.
    subscribed: HashMap<u16, (TopicLayout, TopicReader)>,
    /// Streams met.
    there: Vec<String>,
    wanted: String,
    key: Key,
    poses: bool,
    /// Time and velocity of the last `vehicle_local_position`.
    local: Option<(f64, Vector3)>,
    spacing: Spacing,
    /// Whether an entry of the stream has been given.
    given: bool,
}

impl Reader {
    /// `poses`: whether velocities are wanted beside positions; `key` asked for the stream.
    pub(super) fn new(messages: Messages, wanted: String, key: Key, poses: bool) -> Self {
        Self {
            messages,
            formats: Formats::default(),
            subscribed: HashMap::new(),
            there: Vec::new(),
            wanted,
            key,
            poses,
            local: None,
            spacing: Spacing::default(),
            given: false,
        }
    }

    /// Reads the next message; false at the end.
    pub(super) fn step(&mut self, ready: &mut Ready) -> Result<bool, ReadError> {
        let step = self.messages.step();
        let at = self.messages.number().max(1);
        match step {
            NextMessage::Message(kind) => {
                if let Some(what) = self.message(kind)? {
                    ready.push(at, what);
                }
                return Ok(true);
            }
            NextMessage::Damaged(detail) => {
                ready.skip(at, SkipKind::Text, detail);
                return Ok(true);
            }
            NextMessage::End(why) => {
                self.check_end()?;
                if let Some(why) = why {
                    ready.skip(at, SkipKind::EndsEarly, why);
                }
            }
        }
        Ok(false)
    }

    fn message(&mut self, kind: u8) -> Result<Option<What>, ReadError> {
        let body = self.messages.body();
        match kind {
            b'B' => {
                let offsets = appended(body)?;
                self.messages.set_appended(offsets.into_iter());
            }
            b'F' if !self.formats.define(body) => {
                let detail = format!("format {}", crate::skipped::shown(body));
                return Ok(Some(What::Skipped(SkipKind::Text, detail)));
            }
            b'A' => self.subscribe()?,
            b'R' => {
                if let Some((id, _)) = data(body) {
                    self.subscribed.remove(&id);
                }
            }
            b'D' => return self.read(),
            _ => {}
        }
        Ok(None)
    }

    fn subscribe(&mut self) -> Result<(), ReadError> {
        let Some((id, name)) = subscription(self.messages.body()) else {
            return Ok(());
        };
        let topic = topic_of(&name).to_owned();
        let local = self.poses && name == "vehicle_local_position.0";
        if name == self.wanted || local {
            let error = |problem| ReadError::nameless(problem).key(self.key.clone());
            let layout = self
                .formats
                .layout(&topic)
                .ok_or_else(|| error(format!("{topic} is logged but not defined")))?;
            match TopicReader::new(&topic, &layout) {
                Ok(reading) => {
                    self.subscribed.insert(id, (layout, reading));
                }
                // Positions without velocities are what there is then.
                Err(_) if local => {}
                Err(field) => {
                    let problem = format!("{topic} has no field {field}");
                    return Err(error(problem));
                }
            }
        } else {
            self.subscribed.remove(&id);
        }
        if self.there.len() <= NAMES_SHOWN {
            self.there.push(name);
        }
        Ok(())
    }

    fn read(&mut self) -> Result<Option<What>, ReadError> {
        let Some((id, content)) = data(self.messages.body()) else {
            return Ok(None);
        };
        let Some((layout, reading)) = self.subscribed.get(&id) else {
            return Ok(None);
        };
        if !layout.fits(content.len()) {
            let detail = format!("a message of {} bytes", content.len());
            return Ok(Some(What::Skipped(SkipKind::MissingField, detail)));
        }
        let what = match reading {
            TopicReader::Imu(imu) => imu(content).map(|(what, span)| {
                if let Some((time, span)) = span {
                    self.spacing.add(time, span);
                }
                what
            }),
            TopicReader::Other(other) => other(content),
            TopicReader::Pose(pose) => pose(content, self.local),
            TopicReader::Velocity(velocity) => {
                self.local = Some(velocity(content));
                return Ok(None);
            }
        };
        if self.spacing.thinned(JUDGED) {
            return Err(self.thinned());
        }
        self.given = true;
        Ok(Some(What::from_read(what)))
    }

    /// Whether the stream was there and can be used.
    fn check_end(&self) -> Result<(), ReadError> {
        if !self.given {
            let problem = format!("no message of {}", self.wanted);
            return Err(ReadError::nameless(problem)
                .key(self.key.clone())
                .mend(the_file_has(&self.there, NAMES_SHOWN)));
        }
        if self.spacing.thinned(JUDGED_LEAST) {
            return Err(self.thinned());
        }
        Ok(())
    }

    fn thinned(&self) -> ReadError {
        let problem = format!(
            "{} was logged thinned: the samples do not join",
            self.wanted
        );
        ReadError::nameless(problem)
            .key(self.key.clone())
            .mend("take a topic that was logged in full, or set SDLOG_PROFILE to high rate")
    }
}
