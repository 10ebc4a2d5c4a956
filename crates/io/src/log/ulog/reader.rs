//! Reads one stream of a ULog.

use std::collections::HashMap;

use undrift_nav::Vector3;

use super::layout::{Formats, Layout};
use super::messages::{Messages, Step};
use super::subscriptions::{NAMES_SHOWN, appended, data, listing, subscription, topic_of};
use super::topics::Reading;
use crate::ReadError;
use crate::entry::{Entry, Stream, StreamKind, What};
use crate::skipped::SkipKind;

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

/// What a subscription that is needed is read with.
struct Subscribed {
    layout: Layout,
    reading: Reading,
}

/// The entries of one stream.
pub(super) struct Reader {
    messages: Messages,
    formats: Formats,
    subscribed: HashMap<u16, Subscribed>,
    /// Streams met.
    there: Vec<Stream>,
    wanted: String,
    key: &'static str,
    poses: bool,
    /// Time and velocity of the last `vehicle_local_position`.
    local: Option<(f64, Vector3)>,
    spacing: Spacing,
    /// Whether an entry of the stream has been given.
    given: bool,
    finished: bool,
}

impl Reader {
    /// `poses` tells whether velocities are wanted beside positions; `key` asked for the stream.
    pub(super) fn new(messages: Messages, wanted: String, key: &'static str, poses: bool) -> Self {
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
            finished: false,
        }
    }

    fn next_what(&mut self) -> Result<Option<What>, ReadError> {
        loop {
            let kind = match self.messages.step() {
                Step::Message(kind) => kind,
                Step::Damaged(detail) => {
                    return Ok(Some(What::Skipped(SkipKind::Text, detail)));
                }
                Step::End(why) => {
                    self.finished = true;
                    self.check_end()?;
                    return Ok(why.map(|why| What::Skipped(SkipKind::EndsEarly, why)));
                }
            };
            let what = match kind {
                b'B' => {
                    let offsets = appended(self.messages.body())?;
                    self.messages.set_appended(offsets.into_iter());
                    None
                }
                b'F' => {
                    let text = self.messages.body();
                    let refused = !self.formats.define(text);
                    let shown = || crate::skipped::shown(text);
                    refused.then(|| What::Skipped(SkipKind::Text, format!("format {}", shown())))
                }
                b'A' => {
                    self.subscribe()?;
                    None
                }
                b'R' => {
                    if let Some((id, _)) = data(self.messages.body()) {
                        self.subscribed.remove(&id);
                    }
                    None
                }
                b'D' => self.read()?,
                _ => None,
            };
            if what.is_some() {
                return Ok(what);
            }
        }
    }

    fn subscribe(&mut self) -> Result<(), ReadError> {
        let Some((id, name)) = subscription(self.messages.body()) else {
            return Ok(());
        };
        let topic = topic_of(&name).to_owned();
        let local = self.poses && name == "vehicle_local_position.0";
        if name == self.wanted || local {
            let error = |problem| ReadError::nameless(problem).key(self.key);
            let layout = self
                .formats
                .layout(&topic)
                .ok_or_else(|| error(format!("{topic} is logged but not defined")))?;
            match Reading::new(&topic, &layout) {
                Ok(reading) => {
                    self.subscribed.insert(id, Subscribed { layout, reading });
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
            self.there.push(Stream {
                name,
                kind: StreamKind::Other,
                about: String::new(),
                messages: 0,
            });
        }
        Ok(())
    }

    fn read(&mut self) -> Result<Option<What>, ReadError> {
        let Some((id, content)) = data(self.messages.body()) else {
            return Ok(None);
        };
        let Some(Subscribed { layout, reading }) = self.subscribed.get(&id) else {
            return Ok(None);
        };
        if !layout.fits(content.len()) {
            let detail = format!("a message of {} bytes", content.len());
            return Ok(Some(What::Skipped(SkipKind::MissingField, detail)));
        }
        let what = match reading {
            Reading::Imu(imu) => {
                let (what, span) = imu.read(content);
                if let Some((time, span)) = span {
                    self.spacing.add(time, span);
                    if self.spacing.thinned(JUDGED) {
                        return Err(self.thinned());
                    }
                }
                what
            }
            Reading::Gps(gps) => gps.read(content),
            Reading::Pose(pose) => pose.read(content, self.local),
            Reading::Velocity(velocity) => {
                self.local = Some(velocity.read(content));
                return Ok(None);
            }
        };
        self.given = true;
        Ok(Some(what))
    }

    /// Whether the stream was there and can be used.
    fn check_end(&self) -> Result<(), ReadError> {
        if !self.given {
            let problem = format!("no message of {}", self.wanted);
            return Err(ReadError::nameless(problem)
                .key(self.key)
                .mend(listing(&self.there)));
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
            .key(self.key)
            .mend("take a topic that was logged in full, or set SDLOG_PROFILE to high rate")
    }
}

impl Iterator for Reader {
    type Item = Result<Entry, ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.finished {
            return None;
        }
        let next = self.next_what();
        self.finished |= !matches!(next, Ok(Some(_)));
        let at = self.messages.number().max(1);
        next.map(|what| what.map(|what| Entry { at, what }))
            .transpose()
    }
}
