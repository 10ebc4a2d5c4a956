//! The solution as topics.

use crate::{
    dds_topic, dds_type, participant,
    raw::{AsIs, Raw},
    with_domain,
};
use rustdds::{
    Duration, QosPolicyBuilder, TopicKind,
    no_key::DataWriter,
    policy::{Durability, History, Reliability},
};
use std::{io, sync::Arc, thread};
use undrift_io::{
    epoch::Epoch,
    write::{
        Thinning,
        mcap::{Level, Messages, Stamp, Status},
        solution::SolutionRow,
    },
};
use undrift_live::{output::Broadcast, session::is_without_gnss, view::View};

/// Where the topics are unless stated.
const PLACE: &str = "/undrift";
/// From one state to the next in the diagnostics \[s\].
const STATE: f64 = 1.0;
/// Messages that are kept for whoever asks for them again.
const KEPT: i32 = 16;

/// Publishes `/undrift/odom` (nav_msgs/Odometry), `/undrift/fix` (sensor_msgs/NavSatFix) and `/diagnostics`
/// (diagnostic_msgs/DiagnosticArray). It is done on a thread of its own: a network that is slow delays nothing.
pub struct Publisher {
    messages: Messages,
    thinning: Thinning,
    states: Thinning,
    /// Of the newest row.
    stamp: Option<Stamp>,
    waiting: Arc<Broadcast>,
}

/// Topics by their numbers: odometry, fixes, diagnostics.
const ODOMETRY: u8 = 0;
const FIX: u8 = 1;
const DIAGNOSTICS: u8 = 2;

impl Publisher {
    /// Publishes at a place, `/undrift?domain=0`; both parts are optional. Rows are `every` \[s\] apart at least.
    ///
    /// # Errors
    /// If the place is written otherwise, or there can be no participant in the domain.
    pub fn open(text: &str, every: f64) -> io::Result<Self> {
        let (place, domain) = with_domain(text)?;
        let place = match place.trim_end_matches('/') {
            "" => PLACE,
            place if place.starts_with('/') => place,
            _ => {
                let problem = "a topic begins with /, such as ros2:/undrift";
                return Err(io::Error::new(io::ErrorKind::InvalidInput, problem));
            }
        };
        let participant = participant(domain)?;
        let qos = QosPolicyBuilder::new()
            .reliability(Reliability::Reliable {
                max_blocking_time: Duration::ZERO,
            })
            .durability(Durability::Volatile)
            .history(History::KeepLast { depth: KEPT })
            .build();
        let publisher = participant.create_publisher(&qos);
        let publisher = publisher.map_err(io::Error::other)?;
        let topics = [
            (format!("{place}/odom"), "nav_msgs/msg/Odometry"),
            (format!("{place}/fix"), "sensor_msgs/msg/NavSatFix"),
            (
                "/diagnostics".to_owned(),
                "diagnostic_msgs/msg/DiagnosticArray",
            ),
        ];
        let writers = topics.map(|(topic, type_name)| {
            let (name, dds) = (dds_topic(&topic), dds_type(type_name));
            let topic = participant.create_topic(name, dds, &qos, TopicKind::NoKey)?;
            publisher.create_datawriter_no_key::<Raw, AsIs>(&topic, None)
        });
        let writers = writers.into_iter().collect::<Result<Vec<_>, _>>();
        let writers = writers.map_err(io::Error::other)?;
        let waiting = Arc::new(Broadcast::default());
        let queue = waiting.join(Vec::new());
        thread::spawn(move || {
            while let Some(entry) = queue.next() {
                publish(&writers, &entry);
            }
        });
        Ok(Self {
            messages: Messages::new(None),
            thinning: Thinning::new(every),
            states: Thinning::new(STATE),
            stamp: None,
            waiting,
        })
    }

    fn diagnostics(&mut self, status: Status, stamp: Stamp) {
        let message = self.messages.diagnostics(&[status], stamp);
        self.waiting.give(entry(&[(DIAGNOSTICS, message)]));
    }
}

impl View for Publisher {
    fn ready(&mut self, epoch: Option<Epoch>) {
        self.messages = Messages::new(epoch);
    }

    fn row(&mut self, row: &SolutionRow, since_fix: Option<f64>) {
        let Ok(stamp) = self.messages.stamp(row) else {
            return;
        };
        self.stamp = Some(stamp);
        if self.thinning.takes(row.time) {
            let odometry = self.messages.odometry(row, stamp).to_vec();
            let fix = self.messages.fix(row, stamp);
            self.waiting
                .give(entry(&[(ODOMETRY, &odometry), (FIX, fix)]));
        }
        if self.states.takes(row.time) {
            let (level, message) = match is_without_gnss(since_fix) {
                true => (Level::Warn, "without GNSS"),
                false => (Level::Ok, "with GNSS"),
            };
            // The stamp is that of the message.
            let mut values = Vec::from_iter(row.named().skip(1));
            values.push(("since_fix_s", since_fix.unwrap_or(f64::NAN)));
            let status = Status {
                level,
                name: "undrift: solution",
                message,
                values,
            };
            self.diagnostics(status, stamp);
        }
    }

    fn notice(&mut self, time: Option<f64>, sentence: &str, is_warning: bool) {
        let stamp = self.stamp.unwrap_or(Stamp {
            seconds: 0,
            nanoseconds: 0,
        });
        let status = Status {
            level: if is_warning { Level::Warn } else { Level::Ok },
            name: "undrift: event",
            message: sentence,
            values: time.map(|time| ("time_s", time)).into_iter().collect(),
        };
        self.diagnostics(status, stamp);
    }

    fn dropped(&self) -> u64 {
        self.waiting.dropped()
    }
}

/// Messages of topics, each after the number of its topic and its length.
fn entry(messages: &[(u8, &[u8])]) -> Vec<u8> {
    let mut entry = Vec::new();
    for (topic, message) in messages {
        entry.push(*topic);
        entry.extend((message.len() as u32).to_le_bytes());
        entry.extend(*message);
    }
    entry
}

fn publish(writers: &[DataWriter<Raw, AsIs>], mut entry: &[u8]) {
    while let Some(([topic, length @ ..], rest)) = entry.split_first_chunk::<5>() {
        let length = u32::from_le_bytes(*length) as usize;
        let Some((message, rest)) = rest.split_at_checked(length) else {
            return;
        };
        entry = rest;
        if let Some(writer) = writers.get(usize::from(*topic)) {
            // Where it is not taken, the next row is newer.
            let _ = writer.write(message.to_vec(), None);
        }
    }
}
