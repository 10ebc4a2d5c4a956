//! What a log holds: its streams, and how its clock is tied to GPS time.

use std::collections::BTreeMap;

use super::Which;
use super::formats::{MessageKind, Values, time};
use super::link::{Link, Ties};
use super::messages::{Messages, Next};
use super::reader::fix_time;
use crate::entry::{Stream, StreamKind};
use crate::time::WeekClock;

/// Intervals that tell the ordinary one.
const INTERVALS: usize = 256;
/// Raw samples of which fewer are there have been lost on the way to the log.
const COMPLETE: f64 = 0.98;
/// Names of messages that are counted at most.
const MAX_NAMES: usize = 1024;

/// The messages of a kind and instance.
#[derive(Debug, Default)]
struct Count {
    messages: u64,
    first: f64,
    last: f64,
    intervals: Vec<f64>,
}

impl Count {
    fn add(&mut self, time: f64) {
        self.messages += 1;
        if self.messages == 1 {
            self.first = time;
        } else if self.intervals.len() < INTERVALS {
            self.intervals.push(time - self.last);
        }
        self.last = time;
    }

    /// Whether hardly any is missing, by the ordinary interval.
    fn is_complete(&self) -> bool {
        let mut intervals = self.intervals.clone();
        intervals.sort_by(f64::total_cmp);
        let usual = intervals.get(intervals.len() / 2).copied();
        usual.is_some_and(|usual| {
            usual > 0.0 && self.messages as f64 * usual > COMPLETE * self.span()
        })
    }

    /// From the first to the last \[s\].
    fn span(&self) -> f64 {
        self.last - self.first
    }
}

/// What was found in a log.
#[derive(Debug, Default)]
pub(super) struct Survey {
    counts: BTreeMap<Which, Count>,
    /// Messages that are not read, by their names.
    others: BTreeMap<String, u64>,
    /// By receiver.
    ties: BTreeMap<u8, Ties>,
    weeks: WeekClock,
}

impl Survey {
    /// Reads a log to its end.
    pub(super) fn new(mut messages: Messages) -> Self {
        let mut survey = Self::default();
        loop {
            match messages.next() {
                Next::Message(kind, instance, values) => survey.add(kind, instance, &values),
                Next::Other(name) => {
                    if survey.others.len() < MAX_NAMES || survey.others.contains_key(&name) {
                        *survey.others.entry(name).or_default() += 1;
                    }
                }
                Next::Damaged(_) => {}
                Next::End(_) => return survey,
            }
        }
    }

    fn add(&mut self, kind: MessageKind, instance: u8, values: &Values) {
        let sampled = match (kind, values) {
            (MessageKind::Gyro | MessageKind::Accel, [_, _, _, _, _, _, sampled, ..]) => {
                sampled / 1e6
            }
            _ => time(values),
        };
        self.counts
            .entry((kind, instance))
            .or_default()
            .add(sampled);
        if kind == MessageKind::Gps
            && let Some(gps) = fix_time(values, &mut self.weeks)
        {
            self.ties
                .entry(instance)
                .or_default()
                .add(time(values), gps);
        }
    }

    /// The clock of GPS weeks, and the link of the first receiver that has fixes.
    pub(super) fn clock(&self) -> (WeekClock, Option<Link>) {
        (self.weeks, self.ties.values().find_map(Ties::link))
    }

    /// The streams that are read, with their messages and whether all samples are there.
    fn read(&self) -> Vec<(Which, u64, bool)> {
        let stream = |(&(kind, instance), count): (&Which, &Count)| {
            let messages = match kind {
                MessageKind::Accel | MessageKind::Accuracy => return None,
                // As many as have both halves.
                MessageKind::Gyro => match self.counts.get(&(MessageKind::Accel, instance)) {
                    Some(accel) => count.messages.min(accel.messages),
                    None => return None,
                },
                MessageKind::Imu | MessageKind::Gps | MessageKind::Mag => count.messages,
            };
            let of = |kind: MessageKind| self.counts.get(&(kind, instance));
            // Raw samples are often logged for a part of the flight only.
            let throughout =
                of(MessageKind::Imu).is_none_or(|imu| count.span() > COMPLETE * imu.span());
            let accel = of(MessageKind::Accel).is_some_and(Count::is_complete);
            let complete = throughout && accel && count.is_complete();
            Some(((kind, instance), messages, complete))
        };
        self.counts.iter().filter_map(stream).collect()
    }

    pub(super) fn streams(&self) -> Vec<Stream> {
        let stream = |((kind, instance), messages, complete): (Which, u64, bool)| Stream {
            name: name((kind, instance)),
            kind: holds(kind),
            about: match kind {
                MessageKind::Mag => {
                    "magnetic fields, with the autopilot's calibration, forward-right-down"
                }
                MessageKind::Imu => "filtered by the autopilot, forward-right-down",
                MessageKind::Gyro if complete => "GYR and ACC of the sensor, forward-right-down",
                MessageKind::Gyro => "GYR and ACC of the sensor, with gaps, forward-right-down",
                _ if self.counts.contains_key(&(MessageKind::Accuracy, instance)) => {
                    "fixes of one receiver, with accuracies"
                }
                _ => "fixes of one receiver",
            }
            .to_owned(),
            messages,
        };
        let other = |(name, messages): (&String, &u64)| Stream {
            name: name.clone(),
            kind: StreamKind::Other,
            about: "not read".to_owned(),
            messages: *messages,
        };
        let read = self.read().into_iter().map(stream);
        read.chain(self.others.iter().map(other)).collect()
    }

    /// The stream of a name; without a number it is instance 0.
    pub(super) fn named(&self, wanted: &str, kind: StreamKind) -> Option<Which> {
        let of_kind = |which: &Which| holds(which.0) == kind;
        let streams = self.read().into_iter().map(|stream| stream.0);
        let mut those = streams.filter(of_kind);
        those.find(|which| name(*which) == wanted || name(*which) == format!("{wanted}0"))
    }

    /// The stream that is meant where none is named.
    pub(super) fn usual(&self, kind: StreamKind) -> Option<Which> {
        let mut those = self.read();
        those.retain(|((of, _), _, complete)| {
            holds(*of) == kind && (*of != MessageKind::Gyro || *complete)
        });
        if those.is_empty() {
            those = self.read();
            those.retain(|((of, _), ..)| holds(*of) == kind);
        }
        let raw = those.iter().any(|((of, _), ..)| *of == MessageKind::Gyro);
        those.retain(|((of, _), ..)| !raw || *of == MessageKind::Gyro);
        let most = those.iter().map(|stream| stream.1).max()?;
        let mut those = those.iter().filter(|stream| stream.1 >= most.div_ceil(2));
        those.next().map(|stream| stream.0)
    }
}

fn holds(kind: MessageKind) -> StreamKind {
    match kind {
        MessageKind::Imu | MessageKind::Gyro => StreamKind::Imu,
        MessageKind::Gps => StreamKind::Fixes,
        MessageKind::Mag => StreamKind::Fields,
        MessageKind::Accel | MessageKind::Accuracy => StreamKind::Other,
    }
}

fn name((kind, instance): Which) -> String {
    let name = match kind {
        MessageKind::Gyro => "RAW",
        MessageKind::Gps => "GPS",
        MessageKind::Mag => "MAG",
        _ => "IMU",
    };
    format!("{name}{instance}")
}
